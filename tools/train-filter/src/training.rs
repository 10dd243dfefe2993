//! Training: stochastic gradient descent through the filter.

use crate::films::Example;
use crate::gradients::{Activations, filter};
use fastrand::Rng;
use glam::{Vec3, Vec4};
use rayon::prelude::*;
use raystream_shaders::reconstruction::learned::PixelFilter;
use raystream_shaders::reconstruction::learned::network::{
    HIDDEN, INPUTS, OUTPUTS, ROWS, SECOND, THIRD,
};

/// Pixels of a step.
const BATCH: usize = 256;
/// The first steps' length, and what it falls to.
const RATES: [f32; 2] = [3e-3, 3e-5];
/// How much of the mean gradient, and of its square, is kept from step to step (Kingma and Ba,
/// "Adam: A Method for Stochastic Optimization", 2015).
const KEPT: [f32; 2] = [0.9, 0.999];
/// The largest gradient of a pixel, so that none decides alone.
const LARGEST_GRADIENT: f32 = 10.0;
/// An error of so many first errors is one that hardly anything helps.
const MUCH: f32 = 100.0;
/// What absolute and relative errors cost beside each other.
const PARTS: [f32; 2] = [0.3, 1.0];

/// How inputs are brought to a mean of 0 and a deviation of 1.
pub struct Standard {
    means: [f32; INPUTS],
    deviations: [f32; INPUTS],
}

impl Standard {
    /// Of all pixels of the examples.
    pub fn of(examples: &[Example]) -> Self {
        let pixels = || {
            let all = examples.iter().flat_map(|e| e.guides.iter().zip(&e.described));
            all.filter(|(guide, _)| guide.is_measured()).map(|(_, (inputs, _))| inputs)
        };
        let count = pixels().count() as f64;
        let mean = |k: usize| pixels().map(|i| f64::from(i[k])).sum::<f64>() / count;
        let means: [f64; INPUTS] = std::array::from_fn(mean);
        let square = |k: usize| pixels().map(|i| (f64::from(i[k]) - means[k]).powi(2)).sum::<f64>();
        let deviations = std::array::from_fn(|k| (square(k) / count).sqrt().max(1e-3) as f32);
        Self { means: means.map(|m| m as f32), deviations }
    }

    fn apply(&self, inputs: &[f32; INPUTS]) -> [f32; INPUTS] {
        std::array::from_fn(|k| (inputs[k] - self.means[k]) / self.deviations[k])
    }

    /// Weights for inputs as they are, of those for inputs that are brought to it.
    pub fn folded(&self, weights: &[Vec4]) -> Vec<Vec4> {
        let mut folded = weights.to_vec();
        for four in 0..HIDDEN / 4 {
            let row = four * (INPUTS + 1);
            for input in 0..INPUTS {
                let weight = weights[row + 1 + input] / self.deviations[input];
                folded[row + 1 + input] = weight;
                folded[row] -= weight * self.means[input];
            }
        }
        folded
    }
}

/// Weights by chance, of the size at which layers neither swell nor fade (He et al., 2015); those
/// of the last are 0, so that training begins with the filter of the estimator `bilateral`.
fn initial(rng: &mut Rng) -> Vec<Vec4> {
    let mut weights = vec![Vec4::ZERO; ROWS as usize];
    for (start, end, inputs) in [(0, SECOND, INPUTS), (SECOND, THIRD, HIDDEN)] {
        let size = (6.0 / inputs as f32).sqrt();
        for row in start..end {
            let is_bias = ((row - start) as usize).is_multiple_of(inputs + 1);
            if !is_bias {
                weights[row as usize] =
                    Vec4::from_array([0; 4].map(|_| size * (2.0 * rng.f32() - 1.0)));
            }
        }
    }
    weights
}

/// A pixel to learn from.
type Place = (usize, u32);

/// What errors are measured by in an example: the inverse of its first errors.
type Scales = [f32; 2];

/// What an error costs, in first errors, and the derivative: few pixels that nothing can help do
/// not decide about all others.
fn cost(error: f32) -> (f32, f32) {
    let part = 1.0 + error / MUCH;
    (MUCH * part.ln(), 1.0 / part)
}

/// The loss of a pixel; adds its gradients.
fn learn(
    example: &Example,
    (standard, scales): (&Standard, Scales),
    rank: u32,
    weights: &[Vec4],
    gradients: &mut [Vec4],
) -> f32 {
    let (inputs, own) = &example.described[rank as usize];
    let activations = Activations::new(weights, standard.apply(inputs));
    let filtered = filter(example, &PixelFilter::new(activations.outputs, *own), rank);
    let (errors, slopes) = example.errors(rank, filtered.color);
    let (mut loss, mut slope) = (0.0, Vec3::ZERO);
    for k in 0..2 {
        let (cost, by_error) = cost(errors[k] * scales[k]);
        loss += PARTS[k] * cost;
        slope += slopes[k] * (PARTS[k] * scales[k] * by_error);
    }
    let slopes: [f32; OUTPUTS] = filtered.slopes.map(|s| slope.dot(s));
    let largest = slopes.iter().fold(0.0_f32, |a, b| a.max(b.abs()));
    let bounded = (LARGEST_GRADIENT / largest).min(1.0);
    activations.add_gradients(weights, slopes.map(|s| s * bounded), gradients);
    loss
}

/// The inverse of an example's mean errors as training begins.
fn scales(example: &Example) -> Scales {
    let start = |rank: &u32| {
        let own = example.described[*rank as usize].1;
        let filtered = filter(example, &PixelFilter::new([Vec4::ZERO; 2], own), *rank);
        example.errors(*rank, filtered.color).0
    };
    let ranks: Vec<u32> = measured(example).step_by(4).collect();
    let errors: Vec<[f32; 2]> = ranks.par_iter().map(start).collect();
    [0, 1].map(|k| {
        let sum = errors.iter().map(|errors| f64::from(errors[k])).sum::<f64>();
        (errors.len() as f64 / sum.max(f64::MIN_POSITIVE)).min(1e12) as f32
    })
}

fn measured(example: &Example) -> impl Iterator<Item = u32> + '_ {
    (0..example.guides.len() as u32).filter(|&rank| example.guides[rank as usize].is_measured())
}

/// Trains for a number of steps; the weights are those for inputs as they are. Says how it goes.
pub fn train(examples: &[Example], steps: u32, seed: u64, say: impl Fn(&str)) -> Vec<Vec4> {
    let standard = Standard::of(examples);
    let scales: Vec<Scales> = examples.iter().map(scales).collect();
    let mut rng = Rng::with_seed(seed);
    let mut weights = initial(&mut rng);
    let mut means = [vec![Vec4::ZERO; ROWS as usize], vec![Vec4::ZERO; ROWS as usize]];
    let (mut loss, mut count) = (0.0, 0);
    for step in 0..steps {
        let batch: Vec<Place> = std::iter::repeat_with(|| {
            let example = rng.usize(..examples.len());
            (example, rng.u32(..examples[example].parameters.threads))
        })
        .filter(|&(example, rank)| examples[example].guides[rank as usize].is_measured())
        .take(BATCH)
        .collect();
        // In pieces of a fixed size, and added in order: sums are the same on any machine.
        let pieces: Vec<(f32, Vec<Vec4>)> = batch
            .par_chunks(BATCH / 8)
            .map(|piece| {
                let mut gradients = vec![Vec4::ZERO; ROWS as usize];
                let losses = piece.iter().map(|&(e, rank)| {
                    let scales = (&standard, scales[e]);
                    learn(&examples[e], scales, rank, &weights, &mut gradients)
                });
                (losses.sum(), gradients)
            })
            .collect();
        let done = step as f32 / steps as f32;
        let rate =
            RATES[1] + 0.5 * (RATES[0] - RATES[1]) * (1.0 + (done * std::f32::consts::PI).cos());
        let kept = KEPT.map(|kept| 1.0 - kept.powi(step as i32 + 1));
        for row in 0..ROWS as usize {
            let gradient = pieces.iter().map(|p| p.1[row]).sum::<Vec4>() / BATCH as f32;
            means[0][row] = means[0][row] * KEPT[0] + gradient * (1.0 - KEPT[0]);
            means[1][row] = means[1][row] * KEPT[1] + gradient * gradient * (1.0 - KEPT[1]);
            let [mean, square] = [means[0][row] / kept[0], means[1][row] / kept[1]];
            let root = Vec4::from_array(square.to_array().map(f32::sqrt));
            weights[row] -= mean * rate / (root + 1e-8);
        }
        loss += pieces.iter().map(|p| f64::from(p.0)).sum::<f64>() / BATCH as f64;
        count += 1;
        if (step + 1) % 1000 == 0 {
            say(&format!("step {}: loss {:.4}", step + 1, loss / f64::from(count)));
            (loss, count) = (0.0, 0);
        }
    }
    standard.folded(&weights)
}
