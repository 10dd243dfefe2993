//! Sines and cosines. GPUs have their own, each with other errors, and processors' libraries
//! others: these are the same polynomials everywhere.

#[cfg(target_arch = "spirv")]
use spirv_std::num_traits::Float as _;

/// Sine and cosine of an `angle` in radians within an eighth of a turn, [-pi/4, pi/4], each with an
/// error of at most 2^-24.
///
/// The sine is `x + x z (s0 + s1 z + s2 z^2)` and the cosine `1 - z/2 + z^2 (c0 + c1 z + c2 z^2)`,
/// `z = x^2`, whose coefficients make the largest relative error least; before roundings that is
/// 4e-9 and 1e-10.
#[inline(always)]
pub fn sin_cos_within_eighth(angle: f32) -> (f32, f32) {
    let z = angle * angle;
    let sine = ((z * -1.951_529e-4 + 8.332_161e-3) * z - 0.166_666_55) * z * angle + angle;
    let cosine = ((z * 2.443_315_9e-5 - 1.388_731_6e-3) * z + 4.166_664_6e-2) * (z * z);
    (sine, cosine - z * 0.5 + 1.0)
}

/// Sine and cosine of an angle in whole turns, of at most 2^20 of them. The angle to the nearest
/// quarter turn is exact, so a sine near 0 has no more relative error than others.
#[inline(always)]
pub fn sin_cos_of_turns(turns: f32) -> (f32, f32) {
    let quarters = (turns * 4.0 + 0.5).floor();
    let (sine, cosine) = sin_cos_within_eighth((turns - quarters * 0.25) * core::f32::consts::TAU);
    let quarter = quarters as i32;
    let (s, c) = if quarter & 1 == 0 { (sine, cosine) } else { (cosine, sine) };
    (if quarter & 2 == 0 { s } else { -s }, if (quarter + 1) & 2 == 0 { c } else { -c })
}

#[cfg(test)]
mod tests {
    use super::*;
    use core::f64::consts::{FRAC_PI_4, TAU};

    #[test]
    fn sines_and_cosines_are_right_to_an_ulp_of_one() {
        const STEPS: i32 = 1 << 20;
        const LARGEST: f64 = 1.0 / (1 << 24) as f64;
        for step in -STEPS..=STEPS {
            let angle = (FRAC_PI_4 * f64::from(step) / f64::from(STEPS)) as f32;
            let (sine, cosine) = sin_cos_within_eighth(angle);
            let exact = f64::from(angle).sin_cos();
            let (off_sine, off_cosine) = (f64::from(sine) - exact.0, f64::from(cosine) - exact.1);
            assert!(off_sine.abs() <= LARGEST && off_cosine.abs() <= LARGEST, "{angle}");
            assert!(off_sine.abs() <= 1.5 * 2.0 * LARGEST * exact.0.abs(), "{angle}: {sine}");
        }
        for step in -3 * STEPS..=3 * STEPS {
            let turns = step as f32 / STEPS as f32;
            let (sine, cosine) = sin_cos_of_turns(turns);
            let exact = (TAU * f64::from(turns)).sin_cos();
            let largest =
                (f64::from(sine) - exact.0).abs().max((f64::from(cosine) - exact.1).abs());
            // The angle, of at most pi / 4, has two roundings besides.
            assert!(largest <= 2.6 * LARGEST, "{turns}: {sine} {cosine}, not {exact:?}");
        }
    }

    #[test]
    fn quarter_turns_are_exact() {
        let found: [_; 5] = core::array::from_fn(|k| sin_cos_of_turns(k as f32 * 0.25));
        assert_eq!(found, [(0.0, 1.0), (1.0, 0.0), (0.0, -1.0), (-1.0, 0.0), (0.0, 1.0)]);
    }
}
