//! The hierarchies of a scene in the forms that CPUs traverse, made when one is asked for.

use super::bvh::wide::collapse;
use super::hierarchies::WideSource;
use crate::clock::Instant;
use glam::UVec4;
use raystream_shaders::scene::bvh::wide::lanes::Simd;
use raystream_shaders::scene::bvh::wide::{Tree, WideBvh};
use std::sync::{Arc, OnceLock};

/// The forms, and what they are made from.
pub struct WideForms {
    source: WideSource,
    eight: OnceLock<Option<Arc<Tree<8>>>>,
    #[cfg(target_arch = "x86_64")]
    sixteen: OnceLock<Option<Arc<Tree<16>>>>,
}

impl WideForms {
    /// None as yet.
    pub fn of(source: WideSource) -> Self {
        Self {
            source,
            eight: OnceLock::new(),
            #[cfg(target_arch = "x86_64")]
            sixteen: OnceLock::new(),
        }
    }

    /// That for these instructions; `planes` are the rows of all leaf entries. [`None`] of a scene
    /// that is too large for it.
    pub fn form(&self, simd: Simd, planes: &[UVec4]) -> Option<WideBvh> {
        match simd {
            Simd::Simd128(proof) => Some(WideBvh::Simd128(proof, self.eight(planes)?)),
            #[cfg(target_arch = "x86_64")]
            Simd::Avx2(proof) => Some(WideBvh::Avx2(proof, self.eight(planes)?)),
            #[cfg(target_arch = "x86_64")]
            Simd::Avx512(proof) => Some(WideBvh::Avx512(proof, self.sixteen(planes)?)),
        }
    }

    fn eight(&self, planes: &[UVec4]) -> Option<Arc<Tree<8>>> {
        self.eight.get_or_init(|| self.collapsed(planes)).clone()
    }

    #[cfg(target_arch = "x86_64")]
    fn sixteen(&self, planes: &[UVec4]) -> Option<Arc<Tree<16>>> {
        self.sixteen.get_or_init(|| self.collapsed(planes)).clone()
    }

    fn collapsed<const N: usize>(&self, planes: &[UVec4]) -> Option<Arc<Tree<N>>> {
        let start = Instant::now();
        let tree = collapse(&self.source.hierarchies, planes, &self.source.shapes);
        match &tree {
            Some(tree) => tracing::debug!(
                "the CPU's hierarchy has {} nodes of {N} and {} leaves, {:.1} MiB, made in {:.2?}",
                tree.nodes.len(),
                tree.leaves.len(),
                (size_of_val(&tree.nodes[..]) + size_of_val(&tree.leaves[..])) as f64
                    / f64::from(1 << 20),
                start.elapsed()
            ),
            None => tracing::warn!(
                "the scene is too large for the CPU's own hierarchy; that of GPUs is traversed, \
                 which is slower"
            ),
        }
        tree.map(Arc::new)
    }
}
