//! Numbers side by side: what is done to all of them is what is done to each.

use raystream_shaders::scene::bvh::wide::lanes::{Baseline, Lanes, Simd, Two128};
#[cfg(target_arch = "x86_64")]
use raystream_shaders::scene::bvh::wide::lanes::{One256, One512};
use raystream_tests::not_tested;

/// Numbers of all kinds, and of all signs.
const NUMBERS: [f32; 16] = [
    0.0,
    -0.0,
    1.0,
    -1.5,
    3.0e-39,
    -3.0e38,
    f32::INFINITY,
    f32::NEG_INFINITY,
    0.1,
    1.0e-7,
    7.0,
    -1.0 / 3.0,
    f32::MIN_POSITIVE,
    2.0,
    f32::NAN,
    1.0 + f32::EPSILON,
];

/// Bits, of which NaN has many.
fn bits(x: f32) -> Option<u32> {
    (!x.is_nan()).then(|| x.to_bits())
}

fn check<const N: usize, L: Lanes<N>>(proof: L::Proof, name: &str) {
    for turn in 0..NUMBERS.len() {
        let a: [f32; N] = std::array::from_fn(|k| NUMBERS[k % NUMBERS.len()]);
        let b: [f32; N] = std::array::from_fn(|k| NUMBERS[(k + turn) % NUMBERS.len()]);
        let (x, y) = (L::load(proof, &a), L::load(proof, &b));
        let each = |combine: fn(f32, f32) -> f32| -> [f32; N] {
            std::array::from_fn(|k| combine(a[k], b[k]))
        };
        let sums = [
            ("a sum", x + y, each(|a, b| a + b)),
            ("a difference", x - y, each(|a, b| a - b)),
            ("a product", x * y, each(|a, b| a * b)),
            ("a quotient", x / y, each(|a, b| a / b)),
            ("numbers", x, a),
            ("one number", L::splat(proof, b[3]), [b[3]; N]),
        ];
        for (what, found, expected) in sums {
            assert_eq!(found.to_array().map(bits), expected.map(bits), "{name}: {what}");
        }
        let are_numbers = |k: usize| !a[k].is_nan() && !b[k].is_nan();
        let (least, most) = (x.min(y).to_array(), x.max(y).to_array());
        for k in (0..N).filter(|&k| are_numbers(k)) {
            assert_eq!((least[k], most[k]), (a[k].min(b[k]), a[k].max(b[k])), "{name}");
        }
        let mask = |holds: fn(f32, f32) -> bool| {
            (0..N).map(|k| u32::from(holds(a[k], b[k])) << k).sum::<u32>()
        };
        assert_eq!(L::bits(x.le(y)), mask(|a, b| a <= b), "{name}");
        assert_eq!(L::bits(x.lt(y)), mask(|a, b| a < b), "{name}");
        assert_eq!(L::bits(x.le(y) & y.le(x)), mask(|a, b| a == b), "{name}");
    }
}

#[test]
fn lanes_compute_as_single_numbers_do() {
    check::<8, Two128>(Baseline, "simd128");
    let mut tested = 1;
    #[cfg(target_arch = "x86_64")]
    for simd in Simd::all() {
        match simd {
            Simd::Simd128(_) => continue,
            Simd::Avx2(proof) => check::<8, One256>(proof, simd.name()),
            Simd::Avx512(proof) => check::<16, One512>(proof, simd.name()),
        }
        tested += 1;
    }
    assert_eq!(tested, Simd::all().count());
    if tested < 3 {
        not_tested("instructions that this processor lacks: AVX2 or AVX-512");
    }
}
