//! The megakernel as CPUs run it: as many paths at once as a register has numbers.
//!
//! A processor shades one path with one number of a register, and the others idle. Here `N` paths
//! are shaded together, a lane each, and a lane whose path has ended takes the next slot. Rays are
//! traced one after the other: a single ray fills the registers with boxes and triangles.
//!
//! **The kernels are the definition** ([`raystream_shaders::integrator::megakernel`] and what it
//! calls). What is here does the same operations in the same order, lane by lane, so every
//! contribution is the same, bit for bit: `tests/integrator/instructions.rs`. It knows the
//! [basic](raystream_shaders::scene::abilities::BASIC) abilities; for all else, and for the other
//! integrators, the kernels themselves run. What is rare among paths is done by calls of the
//! kernels' functions, lane by lane.
//!
//! - `numbers`, `vectors`: what is computed with;
//! - `random`, `directions`, `start`, `surface`, `light`, `bsdf`: the steps of a path;
//! - `path`: the loop.

mod bsdf;
mod directions;
mod light;
mod numbers;
mod path;
mod random;
mod scene;
mod start;
mod surface;
mod texture;
mod vectors;

use super::kernels::{slice, slice_mut};
use super::native::{Job, NativeArguments, part_of, run_all};
use raystream_shaders::film::Contribution;
use raystream_shaders::film::stream::Slot;
use raystream_shaders::integrator::params::{BOTH_TECHNIQUES, PathParams};
use raystream_shaders::math::random::SOBOL;
use raystream_shaders::scene::SceneView;
use raystream_shaders::scene::abilities::{BASIC, Fixed};
use raystream_shaders::scene::bvh::wide::WideBvh;
use scene::Scene;

/// Slots of one job at least: of fewer many lanes would be idle while the last paths end.
const SMALLEST_PART: u32 = 256;

/// Runs a launch of the megakernel, or gives back the arguments of one that asks for more than
/// paths in lanes know.
pub fn trace_paths(arguments: NativeArguments<'_, u32>) -> Result<(), NativeArguments<'_, u32>> {
    let params: PathParams = arguments.parameters();
    let is_known = knows(arguments.abilities, &params);
    let trace = arguments.scene.wide.and_then(trace_by).filter(|_| is_known);
    let Some(trace) = trace else { return Err(arguments) };
    let mut views = arguments.views.into_iter();
    let (geometry, surfaces) = (slice(views.next()), slice(views.next()));
    let texels = slice(views.next());
    let view = SceneView::new(Fixed::<BASIC>, &params.scene, geometry, surfaces, texels)
        .with_wide(arguments.scene.wide);
    let slots: &[Slot] = slice(views.next());
    let contributions: &mut [Contribution] = slice_mut(views.next());
    let scene = Scene { view, geometry, texels, params: &params };
    let threads = params.threads as usize;
    let part = part_of(params.threads).max(SMALLEST_PART) as usize;
    let parts = slots[..threads].chunks(part).zip(contributions[..threads].chunks_mut(part));
    let jobs = parts.map(|(slots, contributions)| -> Job<'_> {
        Box::new(move || trace(&scene, slots, contributions))
    });
    run_all(jobs.collect());
    Ok(())
}

/// Whether lanes know all that the paths of a scene with these abilities ask for.
fn knows(abilities: u32, params: &PathParams) -> bool {
    let PathParams { sampler, techniques, .. } = *params;
    abilities & !BASIC == 0 && sampler == SOBOL && techniques == BOTH_TECHNIQUES
}

/// Traces the paths of slots.
type Trace = fn(&Scene<'_>, &[Slot], &mut [Contribution]);

/// By the instructions that the hierarchy is for, if their registers are wide enough: by those of
/// 128 bits lanes gain too little for the time that they take to compile.
fn trace_by(wide: &WideBvh) -> Option<Trace> {
    match wide {
        WideBvh::Simd128(..) => None,
        WideBvh::Avx2(..) => Some(|scene, slots, contributions| {
            // SAFETY: the hierarchy has a proof that the processor has the instructions.
            unsafe { avx2(scene, slots, contributions) }
        }),
        WideBvh::Avx512(..) => Some(|scene, slots, contributions| {
            // SAFETY: the hierarchy has a proof that the processor has the instructions.
            unsafe { avx512(scene, slots, contributions) }
        }),
    }
}

/// [`path::trace`] by registers of 256 bits.
#[target_feature(enable = "avx2,bmi1,bmi2,lzcnt,popcnt")]
fn avx2(scene: &Scene<'_>, slots: &[Slot], contributions: &mut [Contribution]) {
    path::trace::<8>(scene, slots, contributions);
}

/// [`path::trace`] by registers of 512 bits.
#[target_feature(enable = "avx512f,avx512vl,avx2,bmi1,bmi2,lzcnt,popcnt")]
fn avx512(scene: &Scene<'_>, slots: &[Slot], contributions: &mut [Contribution]) {
    path::trace::<16>(scene, slots, contributions);
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "what fails is a test")]

    use super::*;
    use crate::exec::Device;
    use crate::exec::cpu::CpuExecutor;
    use crate::exec::scene_buffers::SceneUses;
    use crate::render::{BvhQuality, PreparedScene, Settings};
    use crate::scene::embedded;
    use raystream_shaders::math::random::INDEPENDENT;
    use raystream_shaders::scene::abilities::PRINCIPLED;
    use raystream_shaders::scene::bvh::wide::lanes::Simd;

    /// That lanes do what the kernel does says nothing where the kernel itself runs.
    #[test]
    fn lanes_have_the_default_scene_by_wide_registers() {
        let scene = embedded().unwrap();
        let prepared = PreparedScene::new(&scene, BvhQuality::High).unwrap();
        let settings = Settings::for_scene(&scene);
        let params = prepared.parameters(&settings);
        for simd in Simd::all() {
            let device = Device::Cpu(CpuExecutor, Some(simd));
            let buffers = prepared.buffers_for(&device, settings.abilities()).unwrap();
            let SceneUses { abilities, wide } = buffers.uses();
            let is_wide = simd.name() != "simd128";
            assert_eq!(wide.and_then(trace_by).is_some(), is_wide, "{}", simd.name());
            assert!(knows(abilities, &params));
            assert!(!knows(abilities | PRINCIPLED, &params));
            assert!(!knows(abilities, &PathParams { sampler: INDEPENDENT, ..params }));
            assert!(!knows(abilities, &PathParams { techniques: 1, ..params }));
        }
    }
}
