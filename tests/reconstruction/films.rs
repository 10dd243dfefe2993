//! Films of known truth, and what filters make of them.

use crate::estimator::walls::{camera, random, wall};
use glam::Vec3;
use raystream::exec::Executor;
use raystream::exec::cpu::CpuExecutor;
use raystream::film::Film;
use raystream::render::reconstruction::{FilterView, FilteredPicture, Reconstruction};
use raystream::render::{FilmBuffers, FilterKind, FilterSettings};
use raystream::scene::FilmSize;
use raystream_shaders::estimator::Estimate;
use raystream_shaders::film::tiles::rank_of_pixel;

/// A wall of the radiance `truth(x, y)`, of which each sample sees `2 p` as much with the chance of
/// one half and nothing else: its variance is the squared radiance.
pub fn noisy_wall(
    size: [u32; 2],
    samples: u32,
    seed: u32,
    truth: impl Fn(u32, u32) -> Vec3,
) -> Film {
    wall(size[0], size[1], samples, |x, y, sample| {
        let number = random(seed, (y * size[0] + x) as usize, sample);
        truth(x, y) * if number < 0.5 { 2.0 } else { 0.0 }
    })
}

/// The truth of a picture, in rows.
pub fn picture_of(size: [u32; 2], truth: impl Fn(u32, u32) -> Vec3) -> Vec<Vec3> {
    (0..size[0] * size[1]).map(|p| truth(p % size[0], p / size[0])).collect()
}

/// The mean squared error, over pixels and components.
pub fn mean_squared_error(picture: &[Vec3], truth: &[Vec3]) -> f64 {
    let squares =
        picture.iter().zip(truth).map(|(a, b)| (a.as_dvec3() - b.as_dvec3()).length_squared());
    squares.sum::<f64>() / (3 * truth.len()) as f64
}

fn filtered_picture<E: Executor>(
    executor: &E,
    film: &Film,
    kind: FilterKind,
) -> (FilteredPicture<E::Buffer>, FilterView) {
    let size = FilmSize { width: film.width, height: film.height };
    let settings = FilterSettings::default();
    let picture = FilteredPicture::new(executor, size, kind, settings).expect("it fits");
    (picture, view(size))
}

/// From where walls are seen.
pub fn view(size: FilmSize) -> FilterView {
    FilterView { camera: camera(size.width, size.height), mean_radiance: 1.0 }
}

/// A film after a filter alone, in rows, on the CPU.
pub fn filter(film: &Film, kind: FilterKind) -> Vec<Vec3> {
    let executor = &CpuExecutor;
    let (picture, view) = filtered_picture(executor, film, kind);
    let buffers = FilmBuffers::from_film(executor, film).expect("it fits");
    let before = picture.inputs().launches(&buffers);
    picture.run(executor, before, &view, Vec::new()).expect("the device works");
    let ranks = picture.filtered().read(executor).expect("the device works");
    let (width, height) = (film.width, film.height);
    let rank = |p: u32| rank_of_pixel(p % width, p / width, width, height) as usize;
    (0..width * height).map(|p| ranks[rank(p)].color).collect()
}

/// A film after a filter, its guard and its mean, in rows; `control` says that the first half is a
/// control film.
pub fn denoise_on<E: Executor>(
    executor: &E,
    film: &Film,
    kind: FilterKind,
    control: bool,
) -> Vec<Estimate> {
    let (picture, view) = filtered_picture(executor, film, kind);
    let reconstruction = Reconstruction::new(executor, picture).expect("it fits");
    let buffers = FilmBuffers::from_film(executor, film).expect("it fits");
    reconstruction.run(executor, &buffers, &view, control).expect("the device works");
    reconstruction.read(executor).expect("the device works")
}

/// The same on the CPU, without a control film: picture and squared errors.
pub fn denoise(film: &Film, kind: FilterKind) -> (Vec<Vec3>, Vec<f32>) {
    let estimates = denoise_on(&CpuExecutor, film, kind, false);
    estimates.iter().map(|e| (e.filtered, e.squared_error)).unzip()
}
