//! The random numbers of `N` paths: [`raystream_shaders::math::random`] side by side.

use super::numbers::{Floats, Words, floats, words};
use raystream_shaders::math::random::{SECOND_HALF, hash};

/// The [`RandomNumbers`](raystream_shaders::math::random::RandomNumbers) of each lane, which are
/// Owen-scrambled Sobol points.
#[derive(Clone, Copy)]
pub struct Sequences<const N: usize> {
    /// The seed of the pixel.
    pub seeds: Words<N>,
    /// The number in the sequence, its bits in reverse order.
    pub reversed_indices: Words<N>,
}

impl<const N: usize> Sequences<N> {
    /// Those of these samples of these pixels, by the `seed` of the render.
    #[inline(always)]
    pub fn new(seed: u32, pixels: Words<N>, samples: Words<N>) -> Self {
        let pixels = pixels ^ (samples & SECOND_HALF);
        Self {
            seeds: hashed(pixels ^ Words::splat(hash(seed))),
            reversed_indices: (samples & !SECOND_HALF).reversed(),
        }
    }

    /// Two words of each lane for its `dimension`.
    #[inline(always)]
    pub fn bits(&self, dimension: Words<N>) -> [Words<N>; 2] {
        let seeds = hashed(self.seeds ^ dimension.times(Words::splat(0x9e37_79b9)));
        let shuffled = owen_scrambled(self.reversed_indices, seeds).reversed();
        let of_axis = |axis: u32| hashed(seeds ^ Words::splat(axis));
        let x = owen_scrambled(shuffled, of_axis(0xa511_e9b3));
        let y = owen_scrambled(second_axis(shuffled), of_axis(0x63d8_3595));
        [x.reversed(), y.reversed()]
    }

    /// The same as numbers in [0, 1).
    #[inline(always)]
    pub fn pair(&self, dimension: Words<N>) -> [Floats<N>; 2] {
        let [first, second] = self.bits(dimension);
        [unit_floats(first), unit_floats(second)]
    }
}

/// [`raystream_shaders::math::random::unit_float`].
#[inline(always)]
pub fn unit_floats<const N: usize>(bits: Words<N>) -> Floats<N> {
    // Of 24 bits, for which a signed integer has room: every processor has its conversion.
    floats(|lane| (bits.0[lane] >> 8) as i32 as f32 * (1.0 / 16_777_216.0))
}

#[inline(always)]
fn hashed<const N: usize>(x: Words<N>) -> Words<N> {
    words(|lane| {
        let mut x = x.0[lane];
        x ^= x >> 16;
        x = x.wrapping_mul(0x7feb_352d);
        x ^= x >> 15;
        x = x.wrapping_mul(0x846c_a68b);
        x ^ x >> 16
    })
}

/// Of bits in reverse order.
#[inline(always)]
fn owen_scrambled<const N: usize>(x: Words<N>, seeds: Words<N>) -> Words<N> {
    words(|lane| {
        let (mut x, seed) = (x.0[lane], seeds.0[lane]);
        x ^= x.wrapping_mul(0x3d20_adea);
        x = x.wrapping_add(seed);
        x = x.wrapping_mul(seed >> 16 | 1);
        x ^= x.wrapping_mul(0x0552_6c56);
        x ^ x.wrapping_mul(0x53a2_2864)
    })
}

/// The second axis of Sobol's sequence, bits in reverse order.
#[inline(always)]
fn second_axis<const N: usize>(x: Words<N>) -> Words<N> {
    words(|lane| {
        let mut x = x.0[lane];
        x ^= x >> 1 & 0x5555_5555;
        x ^= x >> 2 & 0x3333_3333;
        x ^= x >> 4 & 0x0f0f_0f0f;
        x ^= x >> 8 & 0x00ff_00ff;
        x ^ x >> 16
    })
}
