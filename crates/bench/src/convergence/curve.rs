//! Error over time: what is recorded at a checkpoint, and how repetitions become one curve.

use super::errors::Errors;
use crate::median;
use raystream::render::Timings;
use std::time::Duration;

/// How far a render was when it passed a checkpoint.
#[derive(Clone, Copy, Debug)]
pub struct Point {
    /// Samples per pixel of the checkpoint.
    pub checkpoint: u32,
    /// Samples per pixel that there were, on average over the pixels.
    pub samples: f64,
    /// Time of all rounds so far by the clock on the wall.
    pub wall: Duration,
    /// The same by the device's clock.
    pub device: Timings,
    /// Rays traced so far.
    pub rays: u64,
    /// How far the picture was from the reference.
    pub errors: Errors,
}

/// Samples per pixel at which to measure: 1, and on by factors of the square root of 2 to `last`,
/// with all of `extra` up to there; rising, each once.
pub fn checkpoints(last: u32, extra: &[u32]) -> Vec<u32> {
    let mut all: Vec<u32> = (0..)
        .map(|k| 2.0_f64.powf(f64::from(k) / 2.0).round() as u32)
        .take_while(|&samples| samples < last)
        .chain(extra.iter().copied().filter(|&samples| samples < last))
        .chain([last])
        .collect();
    all.sort_unstable();
    all.dedup();
    all
}

/// The curve of several repetitions: errors as root of the mean of squares (means, where they are
/// squares, similarities or ratios), times as medians. Checkpoints that some repetition jumped over
/// are left out.
pub fn aggregate(repetitions: &[Vec<Point>]) -> Vec<Point> {
    let Some((first, others)) = repetitions.split_first() else { return Vec::new() };
    let at_checkpoint = |point: &Point| {
        let others = others
            .iter()
            .map(|points| points.iter().find(|p| p.checkpoint == point.checkpoint).copied());
        std::iter::once(Some(*point)).chain(others).collect::<Option<Vec<Point>>>()
    };
    first.iter().filter_map(at_checkpoint).map(|points| average(&points)).collect()
}

/// `points` of one checkpoint, at least one.
fn average(points: &[Point]) -> Point {
    let mean =
        |value: &dyn Fn(&Point) -> f64| points.iter().map(value).sum::<f64>() / points.len() as f64;
    let middle = |value: &dyn Fn(&Point) -> Duration| median(points.iter().map(value).collect());
    let ssims: Option<Vec<f64>> = points.iter().map(|p| p.errors.ssim).collect();
    Point {
        checkpoint: points[0].checkpoint,
        samples: mean(&|p| p.samples),
        wall: middle(&|p| p.wall),
        device: Timings::from_fn(|part| middle(&|p| p.device[part])),
        rays: mean(&|p| p.rays as f64).round() as u64,
        errors: Errors {
            rmse: mean(&|p| p.errors.rmse.powi(2)).sqrt(),
            trimmed_rmse: mean(&|p| p.errors.trimmed_rmse.powi(2)).sqrt(),
            relative_mse: mean(&|p| p.errors.relative_mse),
            ssim: ssims.map(|all| all.iter().sum::<f64>() / all.len() as f64),
            mean_ratio: mean(&|p| p.errors.mean_ratio),
        },
    }
}

#[cfg(test)]
pub mod tests {
    use super::*;

    /// A point with both errors `error` and no device times.
    pub fn point(samples: f64, seconds: f64, error: f64) -> Point {
        Point {
            checkpoint: samples as u32,
            samples,
            wall: Duration::from_secs_f64(seconds),
            device: Timings::default(),
            rays: 0,
            errors: Errors {
                rmse: error,
                trimmed_rmse: error,
                relative_mse: error * error,
                ssim: Some(1.0 - error / 10.0),
                mean_ratio: 1.0,
            },
        }
    }

    #[test]
    fn checkpoints_rise_to_the_last() {
        assert_eq!(checkpoints(23, &[16, 5, 64]), [1, 2, 3, 4, 5, 6, 8, 11, 16, 23]);
        assert_eq!(checkpoints(1, &[]), [1]);
        assert_eq!(checkpoints(512, &[]).last(), Some(&512));
    }

    #[test]
    fn repetitions_become_one_curve() {
        let run = |seconds: f64, error: f64| {
            vec![point(1.0, seconds, error), point(2.0, 2.0 * seconds, error / 2.0)]
        };
        let curve = aggregate(&[run(1.0, 3.0), run(9.0, 4.0), run(2.0, 5.0)]);
        assert_eq!(curve.len(), 2);
        assert_eq!(curve[0].wall, Duration::from_secs(2));
        assert_eq!(curve[1].wall, Duration::from_secs(4));
        assert!((curve[0].errors.rmse - (50.0_f64 / 3.0).sqrt()).abs() < 1e-12);
        assert!((curve[1].errors.relative_mse - 50.0 / 12.0).abs() < 1e-12);
        assert!((curve[0].errors.ssim.unwrap() - 0.6).abs() < 1e-12);
    }

    #[test]
    fn what_a_repetition_jumped_over_is_left_out() {
        let whole = vec![point(1.0, 1.0, 1.0), point(2.0, 2.0, 0.7)];
        let checkpoints: Vec<_> =
            aggregate(&[whole.clone(), whole[1..].to_vec()]).iter().map(|p| p.checkpoint).collect();
        assert_eq!(checkpoints, [2]);
        assert!(aggregate(&[]).is_empty());
    }
}
