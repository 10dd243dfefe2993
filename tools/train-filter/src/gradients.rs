//! Derivatives: of the filter by its parameters' logarithms, and of the network by its weights.

use crate::films::Example;
use glam::{Vec3, Vec4};
use raystream_shaders::estimator::bilateral::{Centre, LARGEST_EXPONENT};
use raystream_shaders::film::tiles::{pixel_of_rank, rank_of_pixel};
use raystream_shaders::math::dot;
use raystream_shaders::reconstruction::learned::filter::Contrast;
use raystream_shaders::reconstruction::learned::network::{
    HIDDEN, INPUTS, LEAK, OUTPUTS, SECOND, THIRD, group, hidden,
};
use raystream_shaders::reconstruction::learned::{LARGEST, LEAST, PixelFilter};

/// A filtered colour, with its derivatives by the logarithms of the filter's eight parameters.
pub struct Filtered {
    /// The colour.
    pub color: Vec3,
    /// Its derivatives.
    pub slopes: [Vec3; OUTPUTS],
}

/// Filters the pixel of a rank, which is measured, as
/// [`filter_by_pixel`](raystream_shaders::reconstruction::learned::filter::filter_by_pixel) does.
pub fn filter(example: &Example, filter: &PixelFilter, rank: u32) -> Filtered {
    let Example { parameters, guides, smoothed, .. } = example;
    let (width, height) = (parameters.width, parameters.height);
    let guide = guides[rank as usize];
    let own = guide.color.extend(guide.variance);
    let centre = Centre::new(parameters, &guide);
    let floor = centre.color_floor();
    let (x, y) = pixel_of_rank(rank, width, height);
    let reach = |place: u32, end: u32| {
        place.saturating_sub(parameters.radius)..=(place + parameters.radius).min(end - 1)
    };
    let (mut color, mut weights) = (guide.color, 1.0);
    let (mut sums, mut products) = ([0.0; OUTPUTS], [Vec3::ZERO; OUTPUTS]);
    let [raw_slope, raw_tolerance, smooth_slope, smooth_tolerance] = filter.colors.to_array();
    for (row, column) in reach(y, height).flat_map(|y| reach(x, width).map(move |x| (y, x))) {
        let tap_rank = rank_of_pixel(column, row, width, height);
        let tap = guides[tap_rank as usize];
        if tap_rank == rank || !centre.is_comparable(&tap) {
            continue;
        }
        let (dx, dy) = (column.abs_diff(x), row.abs_diff(y));
        let features = filter.features * centre.distances(&tap, dx * dx + dy * dy);
        let raw = Contrast::of(own, tap.color.extend(tap.variance), floor);
        let smooth = Contrast::of(smoothed[rank as usize], smoothed[tap_rank as usize], floor);
        let by_raw = raw.exponent(raw_slope, raw_tolerance);
        let by_smooth = smooth.exponent(smooth_slope, smooth_tolerance);
        let exponent = dot(features, Vec4::ONE) + by_raw + by_smooth;
        if exponent < LARGEST_EXPONENT {
            let weight = (-exponent).exp();
            color += tap.color * weight;
            weights += weight;
            let tolerated = |exponent: f32, part: f32, slope: f32, tolerance: f32| {
                if exponent > 0.0 { -slope * tolerance * part } else { 0.0 }
            };
            let slopes = [
                features.x,
                features.y,
                features.z,
                features.w,
                by_raw,
                tolerated(by_raw, raw.part, raw_slope, raw_tolerance),
                by_smooth,
                tolerated(by_smooth, smooth.part, smooth_slope, smooth_tolerance),
            ];
            for (k, slope) in slopes.into_iter().enumerate() {
                sums[k] += weight * slope;
                products[k] += tap.color * (weight * slope);
            }
        }
    }
    let color = color / weights;
    let slope = |k: usize| (color * sums[k] - products[k]) / weights;
    Filtered { color, slopes: std::array::from_fn(slope) }
}

/// What the network makes of a description, and what its layers make on the way.
pub struct Activations {
    inputs: [f32; INPUTS],
    first: [f32; HIDDEN],
    second: [f32; HIDDEN],
    /// The outputs.
    pub outputs: [Vec4; 2],
}

impl Activations {
    /// Of a description.
    pub fn new(weights: &[Vec4], inputs: [f32; INPUTS]) -> Self {
        let (mut first, mut second) = ([0.0; HIDDEN], [0.0; HIDDEN]);
        hidden(weights, 0, &inputs, &mut first);
        hidden(weights, SECOND, &first, &mut second);
        let outputs = [0, 1].map(|four| group(weights, THIRD, &second, four));
        Self { inputs, first, second, outputs }
    }

    /// Adds the derivatives by the weights, given those by the outputs.
    pub fn add_gradients(&self, weights: &[Vec4], outputs: [f32; OUTPUTS], gradients: &mut [Vec4]) {
        let numbers = |of: [Vec4; 2]| of.into_iter().flat_map(|four| four.to_array());
        let bounds = numbers(LEAST).zip(numbers(LARGEST)).zip(numbers(self.outputs));
        let mut by_output = outputs;
        for (slope, ((least, largest), output)) in by_output.iter_mut().zip(bounds) {
            // What would go further beyond a bound does not change.
            if output <= least && *slope > 0.0 || output >= largest && *slope < 0.0 {
                *slope = 0.0;
            }
        }
        let by_second = back(weights, THIRD, &self.second, &by_output, gradients);
        let by_second = leaked(&self.second, by_second);
        let by_first = back(weights, SECOND, &self.first, &by_second, gradients);
        let by_first = leaked(&self.first, by_first);
        back(weights, 0, &self.inputs, &by_first, gradients);
    }
}

/// Derivatives by a hidden layer's sums, given those by what it makes of them.
fn leaked(values: &[f32; HIDDEN], slopes: [f32; HIDDEN]) -> [f32; HIDDEN] {
    std::array::from_fn(|k| if values[k] < 0.0 { slopes[k] * LEAK } else { slopes[k] })
}

/// Adds the derivatives by the weights of a layer, and returns those by what goes into it.
fn back<const I: usize, const O: usize>(
    weights: &[Vec4],
    start: u32,
    inputs: &[f32; I],
    outputs: &[f32; O],
    gradients: &mut [Vec4],
) -> [f32; I] {
    let mut by_input = [0.0; I];
    for four in 0..O / 4 {
        let slope = Vec4::from_slice(&outputs[4 * four..]);
        let row = start as usize + four * (I + 1);
        gradients[row] += slope;
        for (input, sum) in by_input.iter_mut().enumerate() {
            gradients[row + 1 + input] += slope * inputs[input];
            *sum += dot(slope, weights[row + 1 + input]);
        }
    }
    by_input
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::films::{Noisy, Sampled, prepare, render};
    use crate::rooms::room;
    use raystream::scene::FilmSize;
    use raystream_shaders::reconstruction::learned::filter::filter as filter_of_kernel;
    use raystream_shaders::reconstruction::learned::network::{ROWS, evaluate};

    fn example() -> Example {
        let scene = room(0, FilmSize { width: 24, height: 20 });
        let prepared = prepare(&scene).expect("a room can be rendered");
        let sampled = Sampled { samples: 8, is_adaptive: false, seed: 1 };
        let film = render(&scene, &prepared, sampled).expect("the CPU works");
        let reference = film.color();
        Example::new(&scene, &Noisy { film, reference }).expect("the CPU works")
    }

    fn weights() -> Vec<Vec4> {
        let number = |k: u32| ((k as f32 * 0.618).fract() - 0.5) * 0.4;
        (0..ROWS).map(|row| Vec4::from_array([0, 1, 2, 3].map(|k| number(4 * row + k)))).collect()
    }

    /// Four digits are left of differences of f32 over steps of a hundredth, and the third
    /// derivative takes as much away.
    fn is_close(a: f32, b: f32, scale: f32) -> bool {
        (a - b).abs() <= 1e-2 * scale.max(1e-3)
    }

    #[test]
    fn filters_are_those_of_the_kernel_and_their_slopes_right() {
        let example = example();
        let Example { parameters, guides, smoothed, described, .. } = &example;
        let mut close = [0, 0];
        for rank in (0..parameters.threads).filter(|&r| guides[r as usize].is_measured()) {
            let own = described[rank as usize].1;
            let of = |outputs| PixelFilter::new(outputs, own);
            let filtered = filter(&example, &of([Vec4::ZERO; 2]), rank);
            let kernel = filter_of_kernel(parameters, guides, smoothed, &of([Vec4::ZERO; 2]), rank);
            let scale = filtered.color.abs().max_element();
            // The order of sums is the same but for that of the exponent's terms.
            let off = (filtered.color - kernel.color).abs().max_element();
            assert!(off <= 1e-4 * scale, "{} and {}", filtered.color, kernel.color);
            for (k, slope) in filtered.slopes.iter().enumerate() {
                const STEP: f32 = 0.01;
                let at = |step: f32| {
                    let mut outputs = [0.0; OUTPUTS];
                    outputs[k] = step;
                    let outputs = [0, 4].map(|first| Vec4::from_slice(&outputs[first..]));
                    filter(&example, &of(outputs), rank).color
                };
                let measured = (at(STEP) - at(-STEP)) / (2.0 * STEP);
                close[usize::from(is_close(measured.x, slope.x, scale))] += 1;
            }
        }
        // Weights end at an exponent, and differences begin to count at a tolerance: where a pixel
        // passes these within a step, there is no slope.
        assert!(close[1] > 50 * close[0] && close[1] > 1000, "{close:?}");
    }

    #[test]
    fn gradients_of_the_network_are_differences() {
        let weights = weights();
        let inputs = std::array::from_fn(|k| (k as f32 * 0.37).sin());
        let by_output = std::array::from_fn(|k| 1.0 - 0.3 * k as f32);
        let value = |weights: &[Vec4]| {
            let outputs = evaluate(weights, &inputs).map(|four| four.to_array());
            outputs.iter().flatten().zip(by_output).map(|(o, s): (&f32, f32)| o * s).sum::<f32>()
        };
        let activations = Activations::new(&weights, inputs);
        assert_eq!(activations.outputs, evaluate(&weights, &inputs));
        let mut gradients = vec![Vec4::ZERO; ROWS as usize];
        activations.add_gradients(&weights, by_output, &mut gradients);
        for row in 0..ROWS as usize {
            const STEP: f32 = 0.01;
            let at = |step: f32| {
                let mut weights = weights.clone();
                weights[row].x += step;
                value(&weights)
            };
            let measured = (at(STEP) - at(-STEP)) / (2.0 * STEP);
            assert!(is_close(measured, gradients[row].x, 1.0), "{row}: {measured}");
        }
    }
}
