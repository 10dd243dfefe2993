//! The bias of adaptive pictures: of their mean, and of the mean of every block of their pixels,
//! over many renders with seeds of their own.

use super::BenchError;
use super::calibration::Calibration;
use super::convergence::{gray, render_timed, squared_errors, variance};
use glam::Vec3;
use raystream::exec::Executor;
use raystream::render::{PreparedScene, Sampling, Settings};
use raystream::scene::FilmSize;

/// Side lengths of a block, in pixels.
pub const BLOCK: [u32; 2] = [40, 30];

/// Uniform renders that the truth is the mean of.
const TRUTH_RENDERS: u32 = 8;

/// What is rendered.
#[derive(Clone, Copy, Debug)]
pub struct Options {
    /// Renders of each number of samples, at least 2.
    pub renders: u32,
    /// Samples per pixel of the truth.
    pub truth_samples: u32,
}

/// A mean over renders, with its standard error.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Estimate {
    /// The mean.
    pub mean: f64,
    /// Its standard error.
    pub error: f64,
}

impl Estimate {
    /// Of at least two values.
    fn of(values: &[f64]) -> Self {
        let n = values.len() as f64;
        Self { mean: values.iter().sum::<f64>() / n, error: (variance(values) / n).sqrt() }
    }

    /// Its difference from another one, independent of it.
    fn minus(self, other: Self) -> Self {
        Self { mean: self.mean - other.mean, error: self.error.hypot(other.error) }
    }

    fn over(self, scale: f64) -> Self {
        Self { mean: self.mean / scale, error: self.error / scale }
    }

    /// The mean in standard errors; 0 for a mean of 0.
    pub fn standard_errors(&self) -> f64 {
        if self.mean == 0.0 { 0.0 } else { self.mean.abs() / self.error }
    }
}

/// A block whose bias is known.
#[derive(Clone, Copy, Debug)]
pub struct BlockBias {
    /// Its left upper pixel.
    pub x: u32,
    /// Likewise.
    pub y: u32,
    /// Its bias relative to its own mean.
    pub bias: Estimate,
}

/// What is known of the pictures of one number of samples.
#[derive(Clone, Debug)]
pub struct Bias {
    /// Samples per pixel.
    pub samples: u32,
    /// Relative bias of the picture's mean.
    pub whole: Estimate,
    /// That of the plain mean over all samples.
    pub plain: Estimate,
    /// Root of the mean squared error of the pictures.
    pub rmse: f64,
    /// That of the plain means.
    pub plain_rmse: f64,
    /// Seconds of a render.
    pub seconds: f64,
    /// How near the estimates of pixels' errors are to their errors.
    pub calibration: Calibration,
    /// All blocks, the one that is the most standard errors off first.
    pub blocks: Vec<BlockBias>,
}

/// Means over renders of a kind.
struct Statistics {
    mean: Vec<Vec3>,
    whole: Vec<f64>,
    blocks: Vec<Vec<f64>>,
}

impl Statistics {
    fn new() -> Self {
        Self { mean: Vec::new(), whole: Vec::new(), blocks: Vec::new() }
    }

    fn add(&mut self, picture: &[Vec3], size: FilmSize) {
        let blocks = block_means(picture, size);
        let n = self.whole.len() as f32;
        self.mean.resize(picture.len(), Vec3::ZERO);
        for (mean, &pixel) in self.mean.iter_mut().zip(picture) {
            *mean = (*mean * n + pixel) / (n + 1.0);
        }
        self.whole.push(gray_mean(picture));
        self.blocks.resize(blocks.len(), Vec::new());
        self.blocks.iter_mut().zip(blocks).for_each(|(values, block)| values.push(block));
    }
}

/// The mean of each block of a picture, row by row.
fn block_means(picture: &[Vec3], size: FilmSize) -> Vec<f64> {
    let columns = size.width.div_ceil(BLOCK[0]);
    let mut sums = vec![(0.0, 0_u32); (columns * size.height.div_ceil(BLOCK[1])) as usize];
    for (row, y) in picture.chunks(size.width as usize).zip(0..) {
        for (pixel, x) in row.iter().zip(0..) {
            let (sum, count) = &mut sums[(y / BLOCK[1] * columns + x / BLOCK[0]) as usize];
            *sum += gray(*pixel);
            *count += 1;
        }
    }
    sums.into_iter().map(|(sum, count)| sum / f64::from(count)).collect()
}

fn gray_mean(picture: &[Vec3]) -> f64 {
    picture.iter().map(|&pixel| gray(pixel)).sum::<f64>() / picture.len() as f64
}

/// The bias of pictures as `settings` make them, with each of the numbers of `samples` per pixel.
///
/// # Errors
/// [`BenchError::Wrong`] for a black scene; whatever the device cannot do.
pub fn measure<E: Executor>(
    executor: &E,
    scene: &PreparedScene,
    settings: &Settings,
    samples: &[u32],
    options: Options,
) -> Result<Vec<Bias>, BenchError> {
    let truth = truth(executor, scene, settings, options.truth_samples)?;
    let whole = Estimate::of(&truth.whole);
    if whole.mean <= 0.0 {
        return Err(BenchError::Wrong("the scene is black: nothing lights what is seen".into()));
    }
    samples
        .iter()
        .map(|&samples| {
            let (mut pictures, mut plain) = (Statistics::new(), Vec::new());
            let mut calibration = Calibration::default();
            let (mut squares, mut plain_squares, mut seconds) = (0.0, 0.0, 0.0);
            for seed in 0..options.renders {
                let settings = Settings { seed: settings.seed.wrapping_add(seed), ..*settings };
                let (film, time) = render_timed(executor, scene, &settings, samples)?;
                let (color, plain_color) = (film.color(), film.plain());
                squares += mean_square(&color, &truth.mean);
                plain_squares += mean_square(&plain_color, &truth.mean);
                seconds += time.as_secs_f64();
                pictures.add(&color, settings.size);
                calibration.add(&film, &truth.mean);
                plain.push(gray_mean(&plain_color));
            }
            let mut blocks = block_biases(&pictures, &truth, settings);
            blocks.sort_by(|a, b| b.bias.standard_errors().total_cmp(&a.bias.standard_errors()));
            let renders = f64::from(options.renders);
            Ok(Bias {
                samples,
                rmse: (squares / renders).sqrt(),
                plain_rmse: (plain_squares / renders).sqrt(),
                seconds: seconds / renders,
                whole: Estimate::of(&pictures.whole).minus(whole).over(whole.mean),
                plain: Estimate::of(&plain).minus(whole).over(whole.mean),
                calibration,
                blocks,
            })
        })
        .collect()
}

fn block_biases(pictures: &Statistics, truth: &Statistics, settings: &Settings) -> Vec<BlockBias> {
    let columns = settings.size.width.div_ceil(BLOCK[0]);
    let blocks = pictures.blocks.iter().zip(&truth.blocks).zip(0..);
    blocks
        .map(|((pictures, truth), index)| {
            let truth = Estimate::of(truth);
            let scale = if truth.mean > 0.0 { truth.mean } else { 1.0 };
            BlockBias {
                x: index % columns * BLOCK[0],
                y: index / columns * BLOCK[1],
                bias: Estimate::of(pictures).minus(truth).over(scale),
            }
        })
        .collect()
}

/// Uniform pictures of together so many samples, with seeds that no measured render has.
fn truth<E: Executor>(
    executor: &E,
    scene: &PreparedScene,
    settings: &Settings,
    samples: u32,
) -> Result<Statistics, BenchError> {
    let mut truth = Statistics::new();
    for seed in 0..TRUTH_RENDERS {
        let seed = settings.seed.wrapping_sub(1 + seed);
        let settings = Settings { seed, sampling: Sampling::UNIFORM, ..*settings };
        let (film, _) = render_timed(executor, scene, &settings, samples.div_ceil(TRUTH_RENDERS))?;
        truth.add(&film.color(), settings.size);
    }
    Ok(truth)
}

fn mean_square(picture: &[Vec3], truth: &[Vec3]) -> f64 {
    squared_errors(picture, truth).iter().sum::<f64>() / picture.len() as f64
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn estimates_are_means_with_their_errors() {
        let estimate = Estimate::of(&[1.0, 3.0, 5.0]);
        assert_eq!((estimate.mean, estimate.error), (3.0, (4.0_f64 / 3.0).sqrt()));
        let other = Estimate { mean: 2.0, error: 0.5 };
        let difference = Estimate { mean: 3.0, error: 1.2 }.minus(other);
        assert_eq!((difference.mean, difference.error), (1.0, 1.3));
        assert_eq!(difference.over(2.0), Estimate { mean: 0.5, error: 0.65 });
        assert_eq!(Estimate { mean: -2.0, error: 0.5 }.standard_errors(), 4.0);
        assert_eq!(Estimate { mean: 0.0, error: 0.0 }.standard_errors(), 0.0);
    }

    #[test]
    fn blocks_are_means_of_their_pixels() {
        let size = FilmSize { width: 90, height: 31 };
        let picture: Vec<Vec3> = (0..90 * 31)
            .map(
                |p| if p / 90 == 30 { Vec3::splat(7.0) } else { Vec3::splat((p % 90 / 40) as f32) },
            )
            .collect();
        assert_eq!(block_means(&picture, size), [0.0, 1.0, 2.0, 7.0, 7.0, 7.0]);
    }
}
