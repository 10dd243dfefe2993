//! The sums of a pixel, as the film keeps them: exact, so that neither the order of samples nor the
//! device that traced them nor the number of films that were added up shows; see [`fixed`].

#[cfg(not(target_arch = "spirv"))]
use crate::film::Contribution;
use crate::film::FilmPixel;
use crate::glam::{UVec4, Vec3};
use crate::math::fixed;
use crate::memory::device_struct;

device_struct! {
    /// The sums of one component of radiance. 48 bytes.
    pub struct ComponentSums {
        /// Over the samples of the first half, in units.
        pub first: UVec4,
        /// Over the samples of the second half, in units.
        pub second: UVec4,
        /// Of the squares of all samples, in units of [squares](fixed::square_unit_exponent).
        pub squares: UVec4,
    }
}

device_struct! {
    /// The radiance of one pixel: sums over its samples, in units of a power of two. 160 bytes.
    pub struct PixelSums {
        /// The first component.
        pub red: ComponentSums,
        /// The second component.
        pub green: ComponentSums,
        /// The third component.
        pub blue: ComponentSums,
        /// Samples of the first half.
        pub first_samples: u32,
        /// Samples of the second half.
        pub second_samples: u32,
        /// Rays traced, modulo 2^32.
        pub rays: u32,
        /// Components that were no number: negative, infinite, NaN or beyond what
        /// [fits](fixed::BITS). They are in no sum.
        pub not_numbers: u32,
    }
}

/// Words of [`ComponentSums`].
pub const COMPONENT_WORDS: u32 = 3 * fixed::WORDS;
/// The word of [`PixelSums`] where counts begin.
pub const COUNTS: u32 = 3 * COMPONENT_WORDS;
/// The word of [`PixelSums`] that counts components which were no number.
pub const NOT_NUMBERS: u32 = COUNTS + 3;
/// Words of [`PixelSums`].
pub const PIXEL_WORDS: u32 = COUNTS + 4;

impl ComponentSums {
    /// Of no samples.
    pub const NOTHING: Self =
        Self { first: UVec4::ZERO, second: UVec4::ZERO, squares: UVec4::ZERO };

    /// Adds a component of a sample. Returns whether it was a number.
    #[inline(always)]
    pub fn add(&mut self, value: f32, is_second: bool, unit_exponent: i32) -> bool {
        let number = fixed::Fixed::new(value, unit_exponent);
        if number.fits {
            if is_second {
                self.second = fixed::add(self.second, number.words);
            } else {
                self.first = fixed::add(self.first, number.words);
            }
            self.squares = fixed::add(self.squares, fixed::square(value, unit_exponent));
        }
        number.fits
    }
}

impl PixelSums {
    /// Samples accumulated.
    pub fn samples(&self) -> u32 {
        self.first_samples + self.second_samples
    }

    /// What they come to where the unit is 2 to the power of `unit_exponent`.
    pub fn to_pixel(&self, unit_exponent: i32) -> FilmPixel {
        let nan = if self.not_numbers == 0 { 0 } else { NAN };
        let sum = |red, green, blue, exponent| {
            let component = |words| f32::from_bits(fixed::to_float_bits(words, exponent) | nan);
            Vec3::new(component(red), component(green), component(blue))
        };
        let Self { red, green, blue, .. } = self;
        let squares_exponent = fixed::square_unit_exponent(unit_exponent);
        FilmPixel {
            first_sum: sum(red.first, green.first, blue.first, unit_exponent),
            first_samples: self.first_samples,
            second_sum: sum(red.second, green.second, blue.second, unit_exponent),
            second_samples: self.second_samples,
            sum_of_squares: sum(red.squares, green.squares, blue.squares, squares_exponent),
            rays: self.rays,
        }
    }
}

/// Bits that make any number NaN.
const NAN: u32 = 0x7fc0_0000;

#[cfg(not(target_arch = "spirv"))]
impl PixelSums {
    /// Adds a sample.
    pub fn add(&mut self, contribution: &Contribution, is_second: bool, unit_exponent: i32) {
        let radiance = contribution.radiance.to_array();
        for (sums, value) in
            [&mut self.red, &mut self.green, &mut self.blue].into_iter().zip(radiance)
        {
            let is_number = sums.add(value, is_second, unit_exponent);
            self.not_numbers += u32::from(!is_number);
        }
        self.first_samples += u32::from(!is_second);
        self.second_samples += u32::from(is_second);
        self.rays = self.rays.wrapping_add(contribution.rays);
    }

    /// Adds the sums of other samples of the pixel, in the same unit.
    pub fn add_sums(&mut self, other: &Self) {
        let others = [&other.red, &other.green, &other.blue];
        for (own, other) in [&mut self.red, &mut self.green, &mut self.blue].into_iter().zip(others)
        {
            own.first = fixed::add(own.first, other.first);
            own.second = fixed::add(own.second, other.second);
            own.squares = fixed::add(own.squares, other.squares);
        }
        self.first_samples += other.first_samples;
        self.second_samples += other.second_samples;
        self.rays = self.rays.wrapping_add(other.rays);
        self.not_numbers = self.not_numbers.saturating_add(other.not_numbers);
    }

    /// Sums that come to `pixel`, but for roundings to the units.
    pub fn of_pixel(pixel: &FilmPixel, unit_exponent: i32) -> Self {
        let mut not_numbers = 0;
        let mut in_units = |value: f32, unit_exponent: i32| {
            let number = fixed::Fixed::of_sum(value, unit_exponent);
            not_numbers += u32::from(!number.fits);
            number.words
        };
        let squares_exponent = fixed::square_unit_exponent(unit_exponent);
        let mut component = |index: usize| ComponentSums {
            first: in_units(pixel.first_sum[index], unit_exponent),
            second: in_units(pixel.second_sum[index], unit_exponent),
            squares: in_units(pixel.sum_of_squares[index], squares_exponent),
        };
        let [red, green, blue] = [component(0), component(1), component(2)];
        Self {
            red,
            green,
            blue,
            first_samples: pixel.first_samples,
            second_samples: pixel.second_samples,
            rays: pixel.rays,
            not_numbers,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::fixed::unit_exponent;
    use crate::math::random::{hash, unit_float};
    use core::mem::{offset_of, size_of};

    #[test]
    fn words_are_where_kernels_look_for_them() {
        let words = [
            size_of::<ComponentSums>(),
            offset_of!(ComponentSums, second),
            offset_of!(ComponentSums, squares),
            size_of::<PixelSums>(),
            offset_of!(PixelSums, green),
            offset_of!(PixelSums, first_samples),
            offset_of!(PixelSums, second_samples),
            offset_of!(PixelSums, rays),
            offset_of!(PixelSums, not_numbers),
        ];
        let expected = [
            COMPONENT_WORDS,
            fixed::WORDS,
            2 * fixed::WORDS,
            PIXEL_WORDS,
            COMPONENT_WORDS,
            COUNTS,
            COUNTS + 1,
            COUNTS + 2,
            NOT_NUMBERS,
        ];
        assert_eq!(words, expected.map(|word| 4 * word as usize));
    }

    #[test]
    fn sums_are_those_of_the_samples_in_any_order() {
        let unit = unit_exponent(3.0);
        // Mostly dim, at times brighter than all before together.
        let contribution = |k: u32| {
            let bits = hash(k);
            let scale = f32::exp2(if bits & 0xff == 0 { 12.0 } else { -20.0 });
            let number = |j: u32| unit_float(hash(bits ^ j)) * scale;
            Contribution { radiance: Vec3::new(number(0), number(1), 0.0), rays: bits & 7 }
        };
        let count = 4096;
        let add =
            |sums: &mut PixelSums, k: u32| sums.add(&contribution(k), k.is_multiple_of(3), unit);
        let (mut sums, mut backwards, mut halves) =
            <(PixelSums, PixelSums, [PixelSums; 2])>::default();
        for k in 0..count {
            add(&mut sums, k);
            add(&mut backwards, count - 1 - k);
            add(&mut halves[(k * 2 / count) as usize], k);
        }
        let [mut one, other] = halves;
        one.add_sums(&other);
        assert!(sums == backwards && sums == one);
        let all = 0..count;
        let of = |is_second: bool| all.clone().filter(move |k| (k.is_multiple_of(3)) == is_second);
        let sum = |is_second| of(is_second).map(|k| contribution(k).radiance.as_dvec3()).sum();
        let squares = all.clone().map(|k| contribution(k).radiance.as_dvec3().powf(2.0)).sum();
        let pixel = sums.to_pixel(unit);
        for (sum, expected) in [
            (pixel.first_sum, sum(false)),
            (pixel.second_sum, sum(true)),
            (pixel.sum_of_squares, squares),
        ] {
            let expected: glam::DVec3 = expected;
            // One rounding.
            let error = (sum.as_dvec3() - expected).abs();
            assert!(error.cmple(expected * 2_f64.powi(-24)).all(), "{sum} for {expected}");
        }
        assert_eq!(pixel.rays, all.map(|k| contribution(k).rays).sum());
        assert_eq!((pixel.first_samples, pixel.second_samples), (2730, 1366));
    }

    #[test]
    fn what_is_no_number_is_counted_and_shown() {
        let mut sums = PixelSums::default();
        let unit = unit_exponent(1.0);
        for bad in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY, -1.0, 1e30] {
            let before = sums.not_numbers;
            sums.add(&Contribution { radiance: Vec3::new(1.0, bad, 1.0), rays: 1 }, false, unit);
            assert_eq!(sums.not_numbers, before + 1, "{bad}");
        }
        let pixel = sums.to_pixel(unit);
        assert!(pixel.first_sum.is_nan() && pixel.sum_of_squares.is_nan());
        assert_eq!((pixel.first_samples, pixel.rays), (5, 5));
    }

    #[test]
    fn pixels_come_back() {
        let pixel = FilmPixel {
            first_sum: Vec3::new(0.1, 7.0, 1e-6),
            first_samples: 3,
            second_sum: Vec3::new(1e5, 0.0, 0.3),
            second_samples: 2,
            sum_of_squares: Vec3::new(1e9, 13.0, 0.2),
            rays: 40,
        };
        let unit = unit_exponent(1.0);
        assert_eq!(PixelSums::of_pixel(&pixel, unit).to_pixel(unit), pixel);
        let infinite = FilmPixel { sum_of_squares: Vec3::INFINITY, ..pixel };
        assert!(PixelSums::of_pixel(&infinite, unit).to_pixel(unit).first_sum.is_nan());
    }
}
