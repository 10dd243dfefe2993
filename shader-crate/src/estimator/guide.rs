//! Guides: what the estimators ask of a pixel, in 48 bytes, so that looking at a neighbour is one
//! short read.

use crate::film::FilmPixel;
use crate::film::sums::PixelSums;
use crate::glam::Vec3;
use crate::integrator::first_hits::FeaturePixel;
use crate::math::{is_finite, is_finite_vector};
use crate::memory::access::at;
use crate::memory::device_struct;

/// [`GuideParams::spread`]: [`Guide::variance`] comes of the sums of squares.
pub const SUM_OF_SQUARES: u32 = 0;
/// [`GuideParams::spread`]: [`Guide::variance`] comes of the difference of the halves' means,
/// where a pixel has samples of both.
pub const HALVES: u32 = 1;

/// [`Guide::normal`] where the camera saw no surface; no normal is packed like this.
pub const NO_SURFACE: u32 = u32::MAX;

device_struct! {
    /// One pixel, as estimators see it. 48 bytes.
    pub struct Guide {
        /// Mean radiance, linear Rec.709.
        pub color: Vec3,
        /// Estimated variance of `color` as a mean over samples, itself the mean over the
        /// components, in squared radiance.
        pub variance: f32,
        /// Mean position of the first surface, in world units; zero where there is none.
        pub position: Vec3,
        /// Mean shading normal by [`pack_normal`], or [`NO_SURFACE`].
        pub normal: u32,
        /// Mean reflectance of the first surface; zero where there is none.
        pub albedo: Vec3,
        /// Samples in `color`; 0 where nothing is known: no sample, or a radiance that is not
        /// finite.
        pub samples: u32,
    }
}

device_struct! {
    /// The parameters of a band of guides. 16 bytes.
    pub struct GuideParams {
        /// Pixels in the band.
        pub threads: u32,
        /// [`SUM_OF_SQUARES`] or [`HALVES`].
        pub spread: u32,
        /// The unit of the film is 2 to this power.
        pub unit_exponent: i32,
        /// Unused; zero.
        pub pad: u32,
    }
}

impl Guide {
    /// Whether anything is known of the pixel.
    pub fn is_measured(&self) -> bool {
        self.samples != 0
    }

    /// Whether the camera saw a surface.
    pub fn has_surface(&self) -> bool {
        self.normal != NO_SURFACE
    }

    /// A guide of nothing.
    fn nothing() -> Self {
        Self {
            color: Vec3::ZERO,
            variance: 0.0,
            position: Vec3::ZERO,
            normal: NO_SURFACE,
            albedo: Vec3::ZERO,
            samples: 0,
        }
    }
}

/// Kernel: the guide of the pixel `lane` of a band, of its film and features.
pub fn make_guides(
    lane: u32,
    params: &GuideParams,
    film: &[PixelSums],
    features: &[FeaturePixel],
    guide: &mut Guide,
) {
    let pixel = at(film, lane).to_pixel(params.unit_exponent);
    *guide = guide_of(&pixel, &at(features, lane), params.spread);
}

/// The guide of one pixel.
pub fn guide_of(film: &FilmPixel, features: &FeaturePixel, spread: u32) -> Guide {
    let mut guide = Guide::nothing();
    let (sum, samples) = (film.sum(), film.samples());
    if samples == 0 || !is_finite_vector(sum) {
        return guide;
    }
    guide.color = sum / samples as f32;
    guide.variance = if samples < 2 {
        // One sample says nothing about its spread: taken to be as large as itself.
        mean_of_squares(guide.color)
    } else if spread == HALVES && film.first_samples > 0 && film.second_samples > 0 {
        halves_variance(film)
    } else {
        mean_variance(film)
    };
    if !is_finite(guide.variance) {
        return Guide::nothing();
    }
    guide.samples = samples;
    if features.hits != 0
        && is_finite_vector(features.position)
        && is_finite_vector(features.normal)
        && is_finite_vector(features.albedo)
    {
        guide.position = features.position / features.hits as f32;
        guide.normal = pack_normal(features.normal);
        guide.albedo = features.albedo / features.samples as f32;
    }
    guide
}

/// The variance of the mean, of at least two samples.
pub(crate) fn mean_variance(film: &FilmPixel) -> f32 {
    let n = film.samples() as f32;
    let mean = film.sum() / n;
    let variance = (film.sum_of_squares / n - mean * mean).dot(Vec3::ONE) / (3.0 * (n - 1.0));
    // Rounding can take a constant pixel below zero. NaN stays: `max` would hide it.
    if variance < 0.0 { 0.0 } else { variance }
}

/// The variance of the mean, by the means of the two halves, of at least one sample each.
///
/// With `a` samples in one half and `b` in the other, the squared difference of their means has the
/// expectation `v (1/a + 1/b)`, `v` being the variance of a sample; that of the mean is `v / (a +
/// b)`. So the factor is `a b / (a + b)^2`: a quarter for equal halves.
pub(crate) fn halves_variance(film: &FilmPixel) -> f32 {
    let (first, second) = (film.first_samples as f32, film.second_samples as f32);
    let n = first + second;
    let difference = film.first_sum / first - film.second_sum / second;
    mean_of_squares(difference) * (first / n) * (second / n)
}

/// The mean over the components of their squares.
pub fn mean_of_squares(v: Vec3) -> f32 {
    v.dot(v) * (1.0 / 3.0)
}

/// Steps from 0 to 1 of a packed coordinate.
const STEPS: f32 = 32767.0;

/// The direction of `v` (any length; +z if zero) as a point of the octahedron, two signed
/// coordinates of 16 bits. They are stored `+ 32767`, so that they are never negative, and 0xffff
/// is not among them.
///
/// Meyer et al., "On Floating-Point Normal Vectors", EGSR 2010.
pub fn pack_normal(v: Vec3) -> u32 {
    let length = v.x.abs() + v.y.abs() + v.z.abs();
    if length == 0.0 {
        return pack_coordinate(0.0) | pack_coordinate(0.0) << 16;
    }
    let (x, y) = (v.x / length, v.y / length);
    let (x, y) = if v.z < 0.0 { fold(x, y) } else { (x, y) };
    pack_coordinate(x) | pack_coordinate(y) << 16
}

/// The unit vector that [`pack_normal`] packed, within 1e-4 of it.
pub fn unpack_normal(packed: u32) -> Vec3 {
    let x = (packed & 0xffff) as f32 * (1.0 / STEPS) - 1.0;
    let y = (packed >> 16) as f32 * (1.0 / STEPS) - 1.0;
    let z = 1.0 - x.abs() - y.abs();
    let (x, y) = if z < 0.0 { fold(x, y) } else { (x, y) };
    Vec3::new(x, y, z).normalize()
}

/// Turns the lower half of the octahedron outwards, and back.
fn fold(x: f32, y: f32) -> (f32, f32) {
    let signed = |magnitude: f32, of: f32| if of < 0.0 { -magnitude } else { magnitude };
    (signed(1.0 - y.abs(), x), signed(1.0 - x.abs(), y))
}

fn pack_coordinate(coordinate: f32) -> u32 {
    (coordinate * STEPS + (STEPS + 0.5)) as u32
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::film::Contribution;
    use crate::math::fixed::unit_exponent;
    use crate::math::random::{hash, unit_float};

    #[test]
    fn packed_normals_come_back() {
        let axes = [Vec3::X, Vec3::Y, Vec3::Z].into_iter().flat_map(|axis| [axis, -axis]);
        let random = (0..10_000_u32).map(|k| {
            let number = |j: u32| unit_float(hash(3 * k + j)) - 0.5;
            Vec3::new(number(0), number(1), number(2))
        });
        for v in axes.chain(random) {
            let packed = pack_normal(v * 7.0);
            assert!(
                packed != NO_SURFACE && packed & 0xffff <= 65_534 && packed >> 16 <= 65_534,
                "{v}: {packed:x}"
            );
            let error = (unpack_normal(packed) - v.normalize()).length();
            assert!(error < 1e-4, "{v} is off by {error}");
        }
        for axis in [Vec3::X, Vec3::Y, Vec3::Z, -Vec3::X, -Vec3::Y, -Vec3::Z] {
            assert!(
                (unpack_normal(pack_normal(axis)) - axis).length() < 1e-6,
                "{axis} is exact but for the scaling"
            );
        }
        assert_eq!(unpack_normal(pack_normal(Vec3::ZERO)), unpack_normal(pack_normal(Vec3::Z)));
    }

    fn film(samples: &[f32]) -> FilmPixel {
        let (mut sums, unit) = (PixelSums::default(), unit_exponent(1.0));
        for (k, &sample) in samples.iter().enumerate() {
            let radiance = Vec3::new(sample, 2.0 * sample, 0.0);
            sums.add(&Contribution { radiance, rays: 1 }, k % 2 == 1, unit);
        }
        sums.to_pixel(unit)
    }

    #[test]
    fn spreads_are_those_of_the_formulas() {
        // Of 1, 2, 6: mean 3, variance 7, of the mean 7/3. Halves: 3.5 and 2, squared difference
        // 2.25, times 2/9.
        let film = film(&[1.0, 2.0, 6.0]);
        let components = (1.0 + 4.0) / 3.0;
        let close = |a: f32, b: f32| assert!((a - b).abs() < 1e-5 * b, "{a} and {b}");
        let guide = |spread| guide_of(&film, &FeaturePixel::default(), spread);
        close(guide(SUM_OF_SQUARES).variance, 7.0 / 3.0 * components);
        close(guide(HALVES).variance, 0.5 * components);
        assert_eq!(guide(HALVES).color, Vec3::new(3.0, 6.0, 0.0));
        assert!(!guide(HALVES).has_surface() && guide(HALVES).is_measured());
    }

    #[test]
    fn one_sample_is_as_uncertain_as_itself_and_none_is_no_measurement() {
        let features = FeaturePixel::default();
        assert_eq!(guide_of(&film(&[3.0]), &features, HALVES).variance, 15.0);
        assert!(!guide_of(&film(&[]), &features, SUM_OF_SQUARES).is_measured());
    }

    #[test]
    fn what_is_not_finite_is_no_measurement() {
        for bad in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY, 1e30] {
            let guide = guide_of(&film(&[1.0, bad, 2.0]), &FeaturePixel::default(), SUM_OF_SQUARES);
            assert_eq!(guide, Guide::nothing(), "{bad}");
        }
        let features =
            FeaturePixel { position: Vec3::NAN, hits: 1, samples: 1, ..FeaturePixel::default() };
        let guide = guide_of(&film(&[1.0, 2.0]), &features, SUM_OF_SQUARES);
        assert!(guide.is_measured() && !guide.has_surface() && guide.position == Vec3::ZERO);
    }
}
