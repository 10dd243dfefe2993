//! Renders to learn from: films of few samples, and pictures of many.

use anyhow::{Context, Result};
use bytemuck::{Pod, cast_slice};
use glam::{Vec3, Vec4};
use rayon::prelude::*;
use raystream::exec::cpu::CpuExecutor;
use raystream::film::Film;
use raystream::render::reconstruction::{FilterInputs, FilterView, learned};
use raystream::render::scene::camera::camera;
use raystream::render::{
    Budget, BvhQuality, FilmBuffers, PreparedScene, Renderer, Sampling, Settings, run,
};
use raystream::scene::Scene;
use raystream_shaders::estimator::bilateral::FilterParams;
use raystream_shaders::estimator::guide::Guide;
use raystream_shaders::film::FilmPixel;
use raystream_shaders::integrator::first_hits::FeaturePixel;
use raystream_shaders::reconstruction::learned::description::Description;
use raystream_shaders::reconstruction::learned::network::INPUTS;
use std::path::Path;

/// A film of few samples, and what it would be with many.
pub struct Noisy {
    /// The film.
    pub film: Film,
    /// The picture of many samples, in rows.
    pub reference: Vec<Vec3>,
}

/// Who gets how many samples.
#[derive(Clone, Copy, Debug)]
pub struct Sampled {
    /// Samples per pixel on average.
    pub samples: u32,
    /// Whether they go by errors.
    pub is_adaptive: bool,
    /// Of random numbers.
    pub seed: u32,
}

/// Renders a film of a scene on the CPU.
pub fn render(scene: &Scene, prepared: &PreparedScene, sampled: Sampled) -> Result<Film> {
    render_from(scene, prepared, sampled, Settings::for_scene(scene).ray_offset)
}

/// The same with rays that start so far from surfaces, in roundings.
pub fn render_from(
    scene: &Scene,
    prepared: &PreparedScene,
    sampled: Sampled,
    ray_offset: f32,
) -> Result<Film> {
    let Sampled { samples, is_adaptive, seed } = sampled;
    let sampling = if is_adaptive { Sampling::ADAPTIVE } else { Sampling::UNIFORM };
    let sampling = Sampling { halves: true, ..sampling };
    let settings = Settings { seed, sampling, ray_offset, ..Settings::for_scene(scene) };
    let mut renderer = Renderer::new(&CpuExecutor, prepared, &settings)?;
    run(&mut renderer, Budget::samples(samples), &|| false, &mut |_| ())?;
    renderer.finish_features()?;
    Ok(renderer.film()?)
}

/// The picture of a scene with many samples.
pub fn reference(scene: &Scene, prepared: &PreparedScene, samples: u32) -> Result<Vec<Vec3>> {
    let sampled = Sampled { samples, is_adaptive: false, seed: 0xffff };
    Ok(render(scene, prepared, sampled)?.color())
}

/// Builds a scene's BVH and lights.
pub fn prepare(scene: &Scene) -> Result<PreparedScene> {
    Ok(PreparedScene::new(scene, BvhQuality::High)?)
}

impl Noisy {
    /// Reads what [`Self::write`] has written, of a picture of this size.
    pub fn read(path: &Path, width: u32, height: u32) -> Result<Self> {
        let bytes =
            std::fs::read(path).with_context(|| format!("cannot read {}", path.display()))?;
        let pixels = (width * height) as usize;
        let radiance = pixels * size_of::<FilmPixel>();
        let features = radiance + pixels * size_of::<FeaturePixel>();
        let is_whole = bytes.len() == features + pixels * size_of::<Vec3>();
        anyhow::ensure!(is_whole, "{} is damaged; remove it", path.display());
        let film = Film::new(
            width,
            height,
            elements(&bytes[..radiance]),
            elements(&bytes[radiance..features]),
        );
        Ok(Self { film, reference: elements(&bytes[features..]) })
    }

    /// Writes all of it to a file.
    pub fn write(&self, path: &Path) -> Result<()> {
        let Film { radiance, features, .. } = &self.film;
        let parts = [cast_slice(radiance), cast_slice(features), cast_slice(&self.reference)];
        std::fs::write(path, parts.concat())
            .with_context(|| format!("cannot write {}", path.display()))
    }
}

fn elements<T: Pod>(bytes: &[u8]) -> Vec<T> {
    bytes.chunks_exact(size_of::<T>()).map(bytemuck::pod_read_unaligned).collect()
}

/// A film as the filter sees it, in rank order.
pub struct Example {
    /// Parameters of the filter's kernels.
    pub parameters: FilterParams,
    /// All pixels.
    pub guides: Vec<Guide>,
    /// Their smoothed colours.
    pub smoothed: Vec<Vec4>,
    /// Their descriptions, and how far smoothed colours follow the pixel's own.
    pub described: Vec<([f32; INPUTS], f32)>,
    /// What the picture should be.
    pub reference: Vec<Vec3>,
    /// The mean of that over pixels and components.
    pub mean: f32,
}

/// From where a film of a scene was taken.
pub fn view(scene: &Scene, film: &Film) -> FilterView {
    let color = film.plain();
    let mean = color.iter().map(|c| c.element_sum()).sum::<f32>() / (3 * color.len()) as f32;
    FilterView { camera: camera(&scene.camera, scene.film), mean_radiance: mean }
}

impl Example {
    /// Of a film of a scene.
    pub fn new(scene: &Scene, noisy: &Noisy) -> Result<Self> {
        let executor = &CpuExecutor;
        let inputs = FilterInputs::new(executor, scene.film)?;
        let buffers = FilmBuffers::from_film(executor, &noisy.film)?;
        raystream::exec::Executor::run(executor, &inputs.launches(&buffers))?;
        let guides = inputs.guides.read(executor)?;
        let (first, second) = (inputs.first.read(executor)?, inputs.second.read(executor)?);
        let parameters = learned::parameters(&view(scene, &noisy.film));
        let pixels: Vec<Description> = (0..parameters.threads)
            .into_par_iter()
            .map(|rank| Description::of(&parameters, &guides, &first, &second, rank))
            .collect();
        let of_rank = |rank| noisy.reference[raystream::render::film::row_place(scene.film, rank)];
        let reference: Vec<Vec3> = (0..parameters.threads).map(of_rank).collect();
        let sum = reference.iter().map(|c| f64::from(c.element_sum())).sum::<f64>();
        Ok(Self {
            parameters,
            guides,
            smoothed: pixels.iter().map(|p| p.smoothed).collect(),
            described: pixels.iter().map(|p| (p.inputs, p.own)).collect(),
            mean: (sum / (3 * reference.len()) as f64) as f32,
            reference,
        })
    }

    /// The squared errors of a colour of the pixel of a rank, absolute and over brightness with a
    /// soft floor, and their derivatives.
    pub fn errors(&self, rank: u32, color: Vec3) -> ([f32; 2], [Vec3; 2]) {
        let reference = self.reference[rank as usize];
        let radiance = reference.element_sum() / 3.0;
        let floor = SOFT_FLOOR * self.mean;
        let scale = 1.0 / (radiance * radiance + floor * floor);
        let difference = color - reference;
        let square = difference.length_squared() / 3.0;
        let slope = difference * (2.0 / 3.0);
        ([square, square * scale], [slope, slope * scale])
    }
}

/// What is darker than this part of the mean counts by its absolute error.
const SOFT_FLOOR: f32 = 0.2;
