//! What a device computes in a render's rounds, kernel by kernel, as digests: two devices with the
//! same ones have the same bytes.

use crate::recording::{Keep, Recording, Step};
use raystream::exec::{Executor, Kernel, SceneBuffers, UNORDERED};
use raystream::film_file::{hexadecimal, scene_digest};
use raystream::render::{AllocatorKind, Estimator};
use raystream::render::{
    BvhQuality, IntegratorKind, PreparedScene, RenderError, Renderer, Sampling, Settings,
};
use raystream::scene::{FilmSize, Scene};
use serde::Serialize;
use sha2::{Digest as _, Sha256};

/// What one launch wrote to one of its bindings.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Digest {
    /// The settings of the render: integrator and allocator.
    pub render: String,
    /// The kernel.
    pub kernel: &'static str,
    /// Which of the render's launches it was, from 1 on.
    pub launch: usize,
    /// The binding.
    pub binding: &'static str,
    /// SHA-256 of its bytes, in hexadecimal.
    pub sha256: String,
}

/// What a device computes of a scene.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Digests {
    /// SHA-256 of all that the device knows of the scene. The host has prepared it, and on another
    /// system its last bits may differ: only of scenes with the same digest do all devices compute
    /// the same.
    pub scene: String,
    /// What of that is in which buffer: the name of each and its SHA-256.
    pub prepared: Vec<(&'static str, String)>,
    /// What was written, in the order of the launches.
    pub written: Vec<Digest>,
}

/// Rounds of each render, of a sample a pixel: one without looking at errors, and then adaptive
/// ones. They are so short that no device is slow enough to cut them: launches must not depend on
/// time.
const ROUNDS: usize = 4;

/// The digests of small renders of `scene`: of the integrators and allocators that share no
/// kernels, all that each kernel wrote.
///
/// # Errors
/// If the scene cannot be rendered, or the device fails.
pub fn digests<E: Executor>(executor: &E, scene: &Scene) -> Result<Digests, RenderError> {
    use IntegratorKind::{Compaction, Lvc, Megakernel, Regeneration, Streaming};
    let (mut all, mut prepared) = (Vec::new(), Vec::new());
    let scene_with = PreparedScene::new(scene, BvhQuality::Fast)?;
    for (integrator, allocator, estimator) in [
        (Megakernel, AllocatorKind::Runs, Estimator::Bilateral),
        (Compaction, AllocatorKind::Paper, Estimator::Halves),
        (Regeneration, AllocatorKind::Uniform, Estimator::Bilateral),
        (Streaming, AllocatorKind::Runs, Estimator::Halves),
        (Lvc, AllocatorKind::Runs, Estimator::Bilateral),
    ] {
        let settings = Settings {
            size: FilmSize { width: 20, height: 12 },
            sampling: Sampling { allocator, estimator, initial_samples: 1, ..Sampling::default() },
            integrator,
            stream_slots: Some(1024),
            ..Settings::for_scene(scene)
        };
        let render = format!("{integrator}, {allocator}, {estimator}");
        let recording = Recording::new(executor, keep);
        render_rounds(recording.clone(), &scene_with, &settings)?;
        let steps = recording.take();
        if let Some(first) = steps.iter().find(|step| step.kernel.name == FIRST_HITS) {
            prepared = buffers_of_scene(first);
        }
        all.extend((1..).zip(&steps).flat_map(|(launch, step)| of_step(&render, launch, step)));
    }
    Ok(Digests { scene: scene_digest(&scene_with), prepared, written: all })
}

/// A kernel that is given all of a scene, in few launches.
const FIRST_HITS: &str = "first_hits";

fn keep(kernel: &Kernel) -> Keep {
    if kernel.name == FIRST_HITS { Keep::All } else { Keep::Written }
}

/// The digests of what a launch was given of its scene.
fn buffers_of_scene(step: &Step) -> Vec<(&'static str, String)> {
    let names = SceneBuffers::<()>::NAMES;
    let buffers = step.given.iter().filter(|bound| names.contains(&bound.name));
    let parameters = ("parameters", sha256(&step.parameters));
    buffers.map(|bound| (bound.name, sha256(&bound.bytes))).chain([parameters]).collect()
}

fn render_rounds<E: Executor>(
    executor: E,
    scene: &PreparedScene,
    settings: &Settings,
) -> Result<(), RenderError> {
    let mut renderer = Renderer::new(executor, scene, settings)?;
    for _ in 0..ROUNDS {
        renderer.step(u64::from(renderer.pixels()))?;
    }
    renderer.film()?;
    Ok(())
}

fn of_step<'s>(
    render: &'s str,
    launch: usize,
    step: &'s Step,
) -> impl Iterator<Item = Digest> + 's {
    let name = step.kernel.name;
    let ordered = step.written.iter().filter(move |to| !UNORDERED.contains(&(name, to.name)));
    ordered.map(move |written| Digest {
        render: render.to_owned(),
        kernel: name,
        launch,
        binding: written.name,
        sha256: sha256(&written.bytes),
    })
}

/// SHA-256 in hexadecimal.
fn sha256(bytes: &[u8]) -> String {
    hexadecimal(&Sha256::digest(bytes))
}
