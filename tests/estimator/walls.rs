//! Films of a flat wall, made sample by sample of known distributions, and their estimates.

use glam::Vec3;
use raystream::exec::cpu::CpuExecutor;
use raystream::exec::{ExecError, Executor};
use raystream::film::Film;
use raystream::render::estimator::{ComingRound, EstimateBuffers, Noise};
use raystream::render::{AllocatorKind, EstimationSettings, Estimator, FilmBuffers, Sampling};
use raystream::scene::FilmSize;
use raystream_shaders::estimator::Estimate;
use raystream_shaders::film::Contribution;
use raystream_shaders::film::sums::PixelSums;
use raystream_shaders::film::tiles::rank_of_pixel;
use raystream_shaders::integrator::first_hits::FeaturePixel;
use raystream_shaders::math::random::{hash, unit_float};
use raystream_shaders::scene::abilities::{BASIC, Fixed};
use raystream_shaders::scene::camera::{Camera, PINHOLE};

/// Samples of a pixel, unless a test says otherwise.
pub const SAMPLES: u32 = 16;

/// A camera at the origin that looks along -z; a pixel covers 0.01 at distance 1.
pub fn camera(width: u32, height: u32) -> Camera {
    Camera {
        origin: Vec3::ZERO,
        width,
        top_left: Vec3::new(-0.005 * width as f32, 0.005 * height as f32, -1.0),
        height,
        right: Vec3::X * 0.01,
        projection: PINHOLE,
        down: Vec3::NEG_Y * 0.01,
        lens_radius: 0.0,
    }
}

/// A uniform random number in [0, 1), the same on every call.
pub fn random(seed: u32, pixel: usize, sample: u32) -> f32 {
    unit_float(hash(hash(hash(seed) ^ pixel as u32) ^ sample))
}

/// The unit of sums is 2 to this power.
const UNIT: i32 = -64;

/// A grey wall at z = -1, whose pixels have the samples `radiance(x, y, sample)`.
pub fn wall(
    width: u32,
    height: u32,
    samples: u32,
    mut radiance: impl FnMut(u32, u32, u32) -> Vec3,
) -> Film {
    let camera = camera(width, height);
    let pixels = (0..width * height).map(|p| (p % width, p / width));
    let film = |(x, y)| {
        let mut sums = PixelSums::default();
        for sample in 0..samples {
            let c = radiance(x, y, sample);
            sums.add(&Contribution { radiance: c, rays: RAYS }, sample % 2 == 1, UNIT);
        }
        sums.to_pixel(UNIT)
    };
    let features = |(x, y)| {
        let place = [x as f32 + 0.5, y as f32 + 0.5];
        let ray = camera.ray(Fixed::<BASIC>, place, [0.0; 2]);
        let position = ray.direction / -ray.direction.z;
        FeaturePixel {
            albedo: Vec3::splat(0.5) * samples as f32,
            hits: samples,
            normal: Vec3::Z * samples as f32,
            depth: position.length() * samples as f32,
            position: position * samples as f32,
            samples,
        }
    };
    Film::new(width, height, pixels.clone().map(film).collect(), pixels.map(features).collect())
}

/// What an estimator made of a film, in rows.
pub struct Estimates {
    pub estimates: Vec<Estimate>,
    pub errors: Vec<f32>,
    pub noise: Noise,
}

/// By `estimator`, with absolute errors that never converge, for an allocator that goes by what a
/// round takes away.
pub fn absolute(estimator: Estimator) -> Sampling {
    Sampling { allocator: AllocatorKind::Paper, estimator, ..Sampling::UNIFORM }
}

/// Rays of each sample of a [`wall`].
pub const RAYS: u32 = 3;

/// A round of as many samples as the film has and a film of mean radiance 1.
pub const ROUND: ComingRound = ComingRound { samples: SAMPLES as f32, mean_radiance: 1.0 };

/// Estimates on a device.
pub fn estimate_on<E: Executor>(
    executor: &E,
    film: &Film,
    camera: &Camera,
    sampling: &Sampling,
    settings: &EstimationSettings,
    round: ComingRound,
) -> Result<Estimates, ExecError> {
    let sampling = Sampling { estimation: *settings, ..*sampling };
    let size = FilmSize { width: film.width, height: film.height };
    let estimation = EstimateBuffers::new(executor, size, &sampling)?;
    let FilmSize { width, height } = size;
    let buffers = FilmBuffers::from_film(executor, film)?;
    executor.run(&estimation.launches(&buffers, camera, &sampling, round))?;
    let errors = estimation.errors().read(executor)?;
    let rows = (0..width * height)
        .map(|p| errors[rank_of_pixel(p % width, p / width, width, height) as usize]);
    Ok(Estimates {
        estimates: estimation.read(executor)?,
        errors: rows.collect(),
        noise: estimation.noise(executor, round.mean_radiance)?,
    })
}

/// Estimates of a wall, on the CPU.
pub fn estimate(film: &Film, sampling: &Sampling, settings: &EstimationSettings) -> Estimates {
    estimate_on(&CpuExecutor, film, &camera(film.width, film.height), sampling, settings, ROUND)
        .expect("it fits")
}

/// The settings without the colour term and without smoothing.
pub fn plain() -> EstimationSettings {
    EstimationSettings { filter: raystream::render::FilterSettings::paper(), smooth: false }
}
