//! The filter `axis-aligned`: as wide as the distance of what throws light or shadow lets it be
//! (Mehta et al., "Axis-Aligned Filtering for Interactive Physically-Based Diffuse Indirect
//! Lighting", 2013).
//!
//! Light that a diffuse surface reflects changes along it no faster than what it comes from is far
//! away: of a Gaussian in world distance, the standard deviation is a part of the distance of the
//! nearest occluder. Nothing of it depends on samples, neither the weights nor the rate at which
//! a pixel should be sampled.
//!
//! The paper takes distances from the paths' own rays. The film does not keep these; here they are
//! those of the surfaces that the camera sees, along spokes about the pixel. What is out of its
//! sight throws no shadow, and the guard has to see to that. The paper filters indirect light
//! alone, before it is multiplied by the albedo; here all light is filtered, over the albedo.

use crate::estimator::filtered::FilteredPixel;
use crate::estimator::guide::{Guide, unpack_normal};
use crate::estimator::{CONVERGED, ErrorForm, Estimate};
use crate::film::sums::PixelSums;
use crate::film::tiles::{pixel_of_rank, rank_of_pixel};
use crate::glam::{Vec2, Vec3};
use crate::math::angles::sin_cos_of_turns;
use crate::math::elementary::exp;
use crate::memory::access::at;
use crate::memory::device_struct;
#[cfg(target_arch = "spirv")]
use spirv_std::num_traits::Float as _;

/// Bandwidth of a diffuse surface's cosine, in the units of the paper.
pub const BANDWIDTH: f32 = 2.8;
/// Smallest cosine of the normals of pixels that are filtered together: 5 degrees.
const SMALLEST_COSINE: f32 = 0.996_195;
/// Standard deviations' squares beyond which a weight is none, see `exp(-2 s)`.
const LARGEST_EXPONENT: f32 = 2.0;
/// Sine of the elevation above a surface below which what is seen there is the surface itself.
const SMALLEST_SINE: f32 = 0.15;
/// Spokes about a pixel, and places on each, of which each is this much further than the one
/// before.
const SPOKES: u32 = 16;
const PLACES: u32 = 12;
const GROWTH: f32 = 1.5;
/// What is added to albedos before light is divided by them, so that black surfaces have light.
const DARKEST: f32 = 0.05;

device_struct! {
    /// The parameters of the filter and of the estimator. 64 bytes.
    pub struct AxisParams {
        /// Pixels of the launch.
        pub threads: u32,
        /// Rank of the first; film, estimates and errors that are bound start there.
        pub first_rank: u32,
        /// Picture width in pixels.
        pub width: u32,
        /// Picture height in pixels.
        pub height: u32,
        /// The camera's pinhole, in world units.
        pub origin: Vec3,
        /// Side of a pixel at distance 1 from the pinhole.
        pub pixel_pitch: f32,
        /// What becomes of the estimate.
        pub form: ErrorForm,
        /// Pixels to each side that the filter sees.
        pub radius: u32,
        /// What the bandwidth is multiplied by: the larger, the narrower the filter. Above 0.
        pub narrowness: f32,
        /// Unused; zero.
        pub pad1: u32,
        /// Unused; zero.
        pub pad2: u32,
    }
}

device_struct! {
    /// How far what throws light or shadow is from a pixel. 8 bytes.
    pub struct Occluders {
        /// Distance of the nearest, in world units; [`FAR`] where there is none, or no surface.
        pub nearest: f32,
        /// Of the farthest.
        pub farthest: f32,
    }
}

/// A distance beyond everything.
pub const FAR: f32 = 1e30;

/// Kernel: the occluders of pixel `lane`, in rank order.
pub fn find_occluders(lane: u32, params: &AxisParams, guides: &[Guide], occluders: &mut Occluders) {
    *occluders = occluders_of(params, guides, lane);
}

/// What throws light or shadow on the pixel of a rank.
fn occluders_of(params: &AxisParams, guides: &[Guide], rank: u32) -> Occluders {
    let guide = at(guides, rank);
    let mut found = Occluders { nearest: FAR, farthest: FAR };
    if !guide.is_measured() || !guide.has_surface() {
        return found;
    }
    let (x, y) = pixel_of_rank(rank, params.width, params.height);
    let normal = facing(&guide, params.origin);
    let (mut nearest, mut farthest) = (FAR, 0.0_f32);
    let mut spoke = 0;
    while spoke < SPOKES {
        let (sine, cosine) = sin_cos_of_turns(spoke as f32 * (1.0 / SPOKES as f32));
        let direction = Vec2::new(cosine, sine);
        let (mut reach, mut place) = (2.0, 0);
        while place < PLACES {
            let column = (x as f32 + 0.5 + direction.x * reach).floor();
            let row = (y as f32 + 0.5 + direction.y * reach).floor();
            let is_inside = column >= 0.0
                && row >= 0.0
                && column < params.width as f32
                && row < params.height as f32;
            if is_inside {
                let rank = rank_of_pixel(column as u32, row as u32, params.width, params.height);
                let tap = at(guides, rank);
                let step = tap.position - guide.position;
                let distance = step.length();
                let is_above = normal.dot(step) > SMALLEST_SINE * distance;
                if tap.is_measured() && tap.has_surface() && is_above {
                    nearest = nearest.min(distance);
                    farthest = farthest.max(distance);
                }
            }
            reach *= GROWTH;
            place += 1;
        }
        spoke += 1;
    }
    if nearest < FAR {
        found = Occluders { nearest, farthest };
    }
    found
}

/// The normal of a pixel with a surface, on the camera's side.
fn facing(guide: &Guide, origin: Vec3) -> Vec3 {
    let normal = unpack_normal(guide.normal);
    if normal.dot(origin - guide.position) < 0.0 { -normal } else { normal }
}

/// Kernel: the filtered colour of pixel `lane` of the picture; black where nothing is measured.
pub fn filter_axis_aligned(
    lane: u32,
    params: &AxisParams,
    guides: &[Guide],
    occluders: &[Occluders],
    filtered: &mut FilteredPixel,
) {
    let guide = at(guides, lane);
    *filtered = FilteredPixel { color: guide.color, own: 1.0 };
    if !guide.is_measured() || !guide.has_surface() {
        return;
    }
    let (x, y) = pixel_of_rank(lane, params.width, params.height);
    let normal = unpack_normal(guide.normal);
    let nearest = at(occluders, lane).nearest;
    // Equation of the filter: exp(-2 s), s = d^2 (Omega mu / z)^2.
    let falloff = BANDWIDTH * params.narrowness / nearest;
    let falloff = falloff * falloff;
    let albedo = guide.albedo + Vec3::splat(DARKEST);
    let right = (x + params.radius).min(params.width - 1);
    let bottom = (y + params.radius).min(params.height - 1);
    let (mut light, mut weights) = (Vec3::ZERO, 0.0);
    let mut row = y - y.min(params.radius);
    while row <= bottom {
        let mut column = x - x.min(params.radius);
        while column <= right {
            let tap = at(guides, rank_of_pixel(column, row, params.width, params.height));
            column += 1;
            if !tap.is_measured() || !tap.has_surface() {
                continue;
            }
            let step = tap.position - guide.position;
            let along = step - normal * normal.dot(step);
            let exponent = along.length_squared() * falloff;
            if exponent <= LARGEST_EXPONENT
                && step.length_squared() <= nearest * nearest
                && unpack_normal(tap.normal).dot(normal) >= SMALLEST_COSINE
            {
                let weight = exp(-2.0 * exponent);
                light += tap.color / (tap.albedo + Vec3::splat(DARKEST)) * weight;
                weights += weight;
            }
        }
        row += 1;
    }
    // The pixel itself is among them unless its normal has lost its length to rounding.
    if weights > 0.0 {
        *filtered =
            FilteredPixel { color: light * albedo / weights, own: (1.0 / weights).min(1.0) };
    }
}

/// Kernel: the estimator `axis-aligned`, for the pixel `first_rank + lane`. The estimate is the
/// variance of the mean; but allocators go by its rate (`rate_of`), until the pixel has converged.
pub fn axis_rates(
    lane: u32,
    params: &AxisParams,
    guides: &[Guide],
    film: &[PixelSums],
    estimate: &mut Estimate,
    error: &mut f32,
) {
    let rank = params.first_rank + lane;
    let guide = at(guides, rank);
    let mut result = Estimate { filtered: guide.color, squared_error: 0.0 };
    let mut number = 0.0;
    if guide.is_measured() {
        result.squared_error = params.form.unseen_light(&guide).max(guide.variance);
        number = params.form.of(&result, guide.variance, &guide, at(film, lane).rays);
        if number != CONVERGED {
            let samples = params.form.samples_of_round;
            // Those who go by what the coming round takes away give in proportion to the error.
            let coming =
                if samples > 0.0 { samples / (samples + guide.samples as f32) } else { 1.0 };
            number = rate_of(params, &guide, &occluders_of(params, guides, rank)) * coming;
        }
    }
    *estimate = result;
    *error = number;
}

/// Samples that the light of a pixel needs, a priori: `(Omega mu l / z + 1)^2 (1 + mu Z / z)^2
/// Omega^2` with the side `l` of what a pixel covers there, and the distances of the nearest
/// occluder, `z`, and of the farthest, `Z`. (Of the paper's equation the form for one bounce.)
fn rate_of(params: &AxisParams, guide: &Guide, occluders: &Occluders) -> f32 {
    let Occluders { nearest, farthest } = *occluders;
    let pitch = params.pixel_pitch * (guide.position - params.origin).length();
    let across = (BANDWIDTH * params.narrowness * pitch / nearest + 1.0) * BANDWIDTH;
    let depth = 1.0 + params.narrowness * farthest / nearest;
    across * across * depth * depth
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::estimator::guide::pack_normal;

    const SIZE: u32 = 32;

    fn parameters() -> AxisParams {
        AxisParams {
            width: SIZE,
            height: SIZE,
            origin: Vec3::new(0.0, 0.0, 10.0),
            pixel_pitch: 0.01,
            narrowness: 1.0,
            ..AxisParams::default()
        }
    }

    /// A floor seen from above, of pixels as wide as 0.1, and a wall that rises from a column on.
    fn guides(wall: u32) -> [Guide; (SIZE * SIZE) as usize] {
        core::array::from_fn(|rank| {
            let (x, y) = pixel_of_rank(rank as u32, SIZE, SIZE);
            let (across, rise) = (x.min(wall) as f32 * 0.1, x.max(wall) as f32 * 0.1);
            let position = Vec3::new(across, y as f32 * 0.1, rise - wall as f32 * 0.1);
            let normal = if x > wall { Vec3::NEG_X } else { Vec3::Z };
            Guide { position, normal: pack_normal(normal), samples: 4, ..Guide::default() }
        })
    }

    #[test]
    fn pixels_near_a_wall_need_more_samples() {
        let (params, guides) = (parameters(), guides(20));
        let of = |x: u32| {
            let rank = rank_of_pixel(x, 16, SIZE, SIZE);
            let occluders = occluders_of(&params, &guides, rank);
            (occluders.nearest, rate_of(&params, &guides[rank as usize], &occluders))
        };
        let (near, far) = (of(18), of(6));
        // The wall is 0.2 and 1.4 away; places on the spokes are half as far again each.
        assert!(near.0 >= 0.2 && near.0 < 0.6 && far.0 >= 1.4 && far.0 < 2.4, "{near:?} {far:?}");
        assert!(near.1 > 2.0 * far.1, "{near:?} {far:?}");
    }

    #[test]
    fn a_floor_alone_has_no_occluders() {
        let (params, guides) = (parameters(), guides(SIZE));
        for rank in 0..SIZE * SIZE {
            assert_eq!(occluders_of(&params, &guides, rank).nearest, FAR);
        }
    }
}
