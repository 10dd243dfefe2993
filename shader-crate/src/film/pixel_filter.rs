//! The filters of pixels: how light that falls beside a pixel's centre counts.
//!
//! A pixel is the mean of radiance over the film, weighed by its filter. Camera rays are drawn in
//! proportion to it (filter importance sampling: Ernst, Stamminger, Greiner, "Filter Importance
//! Sampling", IEEE Symposium on Interactive Ray Tracing 2006), so a sample has the weight 1, is of
//! one pixel, and pixels stay independent of each other. What lands anywhere on the film, as
//! [splats](super::splats) do, counts for all pixels around it; one of them is drawn, and stands
//! for all.
//!
//! All but the pixel itself is behind the ability
//! [`PIXEL_FILTERS`](crate::scene::abilities::PIXEL_FILTERS).

use crate::math::angles::sin_cos_of_turns;
use crate::math::elementary::{exp, ln};
use core::f32::consts::TAU;
#[cfg(target_arch = "spirv")]
use spirv_std::num_traits::Float as _;

/// [`PixelFilter::kind`]: the pixel itself.
pub const PIXEL: u32 = 0;
/// [`PixelFilter::kind`]: the same everywhere in a square.
pub const BOX: u32 = 1;
/// [`PixelFilter::kind`]: falls off in a straight line, along both axes.
pub const TENT: u32 = 2;
/// [`PixelFilter::kind`]: a normal distribution in a disc of three standard deviations.
pub const GAUSSIAN: u32 = 3;
/// [`PixelFilter::kind`]: Harris's window of four terms along both axes ("On the Use of Windows for
/// Harmonic Analysis with the Discrete Fourier Transform", Proc. IEEE 66(1), 1978).
pub const BLACKMAN_HARRIS: u32 = 4;

/// The largest radius in pixels.
pub const MAX_RADIUS: f32 = 8.0;

/// Standard deviations of [`GAUSSIAN`] in its radius.
const DEVIATIONS: f32 = 3.0;
/// `exp(-DEVIATIONS^2 / 2)`: what is beyond the disc.
const BEYOND: f32 = 0.011_108_997;
/// The terms of [`BLACKMAN_HARRIS`].
const TERMS: [f32; 4] = [0.358_75, 0.488_29, 0.141_28, 0.011_68];
/// Steps of a bisection: no f32 between 0 and 1 has more.
const STEPS: u32 = 24;

/// The filter of a render's pixels.
#[derive(Clone, Copy)]
pub struct PixelFilter {
    /// Its shape.
    pub kind: u32,
    /// How far it reaches to each side, in pixels; at most [`MAX_RADIUS`].
    pub radius: f32,
}

/// The pixel that a splat is to be added to.
#[derive(Clone, Copy)]
pub struct Chosen {
    /// Its column and row; may lie outside of the picture.
    pub pixel: [i32; 2],
    /// What the splat is multiplied by.
    pub weight: f32,
}

impl PixelFilter {
    /// An offset from the pixel's centre, in pixels, drawn in proportion to the filter by a uniform
    /// point of the unit square.
    pub fn offset(&self, u: [f32; 2]) -> [f32; 2] {
        let radius = self.radius;
        if self.kind == TENT {
            [radius * tent_place(u[0]), radius * tent_place(u[1])]
        } else if self.kind == GAUSSIAN {
            let deviations = (-2.0 * ln(1.0 - u[0] * (1.0 - BEYOND))).max(0.0).sqrt();
            let distance = deviations * (radius * (1.0 / DEVIATIONS));
            let (sine, cosine) = sin_cos_of_turns(u[1]);
            [distance * cosine, distance * sine]
        } else if self.kind == BLACKMAN_HARRIS {
            [radius * window_place(u[0]), radius * window_place(u[1])]
        } else {
            [radius * (2.0 * u[0] - 1.0), radius * (2.0 * u[1] - 1.0)]
        }
    }

    /// The filter at an offset from the pixel's centre, in pixels: the density of
    /// [`Self::offset`], whose integral is 1.
    pub fn density(&self, [x, y]: [f32; 2]) -> f32 {
        let (x, y) = (x / self.radius, y / self.radius);
        let per_area = 1.0 / (self.radius * self.radius);
        if self.kind == GAUSSIAN {
            let squared = (x * x + y * y) * (DEVIATIONS * DEVIATIONS);
            let whole = TAU * (1.0 - BEYOND) / (DEVIATIONS * DEVIATIONS);
            return if squared < DEVIATIONS * DEVIATIONS {
                exp(-0.5 * squared) / whole * per_area
            } else {
                0.0
            };
        }
        if x.abs() >= 1.0 || y.abs() >= 1.0 {
            return 0.0;
        }
        if self.kind == TENT {
            (1.0 - x.abs()) * (1.0 - y.abs()) * per_area
        } else if self.kind == BLACKMAN_HARRIS {
            window(x) * window(y) * per_area
        } else {
            0.25 * per_area
        }
    }

    /// One of the pixels whose filters reach a `place` on the film, drawn in proportion to them by
    /// `u` in [0, 1).
    pub fn choose(&self, place: [f32; 2], u: f32) -> Chosen {
        // Pixel (i, j) has its centre at (i + 1/2, j + 1/2).
        let first = |place: f32| (place - 0.5 - self.radius).ceil() as i32;
        let last = |place: f32| (place - 0.5 + self.radius).floor() as i32;
        let (left, right) = (first(place[0]), last(place[0]));
        let (top, bottom) = (first(place[1]), last(place[1]));
        let mut chosen = Chosen { pixel: [left, top], weight: 0.0 };
        let mut u = u;
        let mut row = top;
        while row <= bottom {
            let mut column = left;
            while column <= right {
                let centre = [column as f32 + 0.5, row as f32 + 0.5];
                let density = self.density([place[0] - centre[0], place[1] - centre[1]]);
                if density > 0.0 {
                    chosen.weight += density;
                    // The later one of two takes its share of the number, the other one the rest.
                    let share = density / chosen.weight;
                    if u < share {
                        u /= share;
                        chosen.pixel = [column, row];
                    } else {
                        u = (u - share) / (1.0 - share);
                    }
                }
                column += 1;
            }
            row += 1;
        }
        chosen
    }
}

/// The place in (-1, 1) below which a tent over it has the share `u`.
fn tent_place(u: f32) -> f32 {
    if u < 0.5 { (2.0 * u).sqrt() - 1.0 } else { 1.0 - (2.0 * (1.0 - u)).sqrt() }
}

/// Blackman and Harris's window over (-1, 1), of integral 1.
fn window(x: f32) -> f32 {
    let (_, cosine) = sin_cos_of_turns(0.5 * x);
    let twice = 2.0 * cosine * cosine - 1.0;
    let thrice = cosine * (2.0 * twice - 1.0);
    let sum = TERMS[0] + TERMS[1] * cosine + TERMS[2] * twice + TERMS[3] * thrice;
    sum * (0.5 / TERMS[0])
}

/// What of it lies below `x`.
fn window_below(x: f32) -> f32 {
    let (sine, cosine) = sin_cos_of_turns(0.5 * x);
    let twice = 2.0 * sine * cosine;
    let thrice = sine * (4.0 * cosine * cosine - 1.0);
    let sum = TERMS[1] * sine + TERMS[2] * 0.5 * twice + TERMS[3] * (1.0 / 3.0) * thrice;
    0.5 + 0.5 * x + sum * (1.0 / (TAU * TERMS[0]))
}

/// The place in (-1, 1) below which it has the share `u`, by bisection.
fn window_place(u: f32) -> f32 {
    let (mut place, mut step) = (0.0, 0.5);
    let mut done = 0;
    while done < STEPS {
        place += if window_below(place) <= u { step } else { -step };
        step *= 0.5;
        done += 1;
    }
    place
}
