//! Random numbers: Owen-scrambled Sobol points, or independent ones. Integers only, so that every
//! processor draws the same.
//!
//! Each half of a pixel's samples (see [`crate::film`]) has one sequence per **dimension**, a pair
//! of numbers: the camera takes the first and, with a lens, [`LENS`]; every vertex of a path takes
//! the next [`DIMENSIONS_PER_VERTEX`]. The sequence is indexed by the half's running sample count,
//! so adaptive rounds continue where the last one stopped.

/// Pairs of numbers that a path vertex may draw: [`BSDF`], [`LIGHT_POINT`], [`CHOICES`].
pub const DIMENSIONS_PER_VERTEX: u32 = 3;
/// Dimension of the point inside the pixel.
pub const PIXEL: u32 = 0;
/// The dimension `dimension` of the path's vertex number `vertex`, counted from 0 at the first
/// surface.
pub fn of_vertex(vertex: u32, dimension: u32) -> u32 {
    vertex * DIMENSIONS_PER_VERTEX + dimension
}

/// Dimension of a vertex that picks the direction.
pub const BSDF: u32 = 1;
/// Dimension of a vertex that picks the point on the light.
pub const LIGHT_POINT: u32 = 2;
/// Dimension of a vertex that picks the light or the lobe (first number) and plays roulette
/// (second).
pub const CHOICES: u32 = 3;

/// Dimension of the point on the lens, beyond those of all vertices.
pub const LENS: u32 = 1 << 30;

/// [`RandomNumbers::new`]'s `kind` for Owen-scrambled Sobol points.
pub const SOBOL: u32 = 0;
/// [`RandomNumbers::new`]'s `kind` for independent uniform numbers.
pub const INDEPENDENT: u32 = 1;

/// The bit of a sample's number that says that it is of the pixel's second half.
pub const SECOND_HALF: u32 = 1 << 31;

/// The random numbers of one path.
#[derive(Clone, Copy)]
pub struct RandomNumbers {
    kind: u32,
    pixel_seed: u32,
    index: u32,
}

impl RandomNumbers {
    /// The numbers of sample `sample` of a pixel, as [`Slot::sample`](crate::film::stream::Slot)
    /// has it: each half has a scramble of its own. `pixel` is any number below 2^31 that is the
    /// pixel's own; renders with different `seed`s are independent of each other.
    pub fn new(kind: u32, seed: u32, pixel: u32, sample: u32) -> Self {
        // For the second half the pixel is another one, which no picture has.
        let pixel = pixel ^ sample & SECOND_HALF;
        Self { kind, pixel_seed: hash(pixel ^ hash(seed)), index: sample & !SECOND_HALF }
    }

    /// Two numbers in [0, 1), uniform over the unit square.
    pub fn pair(&self, dimension: u32) -> [f32; 2] {
        let bits = self.bits(dimension);
        [unit_float(bits[0]), unit_float(bits[1])]
    }

    /// [`Self::pair`] as integers, uniform over all of u32: for choices among many.
    pub fn bits(&self, dimension: u32) -> [u32; 2] {
        if self.kind == INDEPENDENT {
            pcg3(self.pixel_seed, self.index, dimension)
        } else {
            scrambled_sobol(self.index, hash(self.pixel_seed ^ dimension.wrapping_mul(0x9e37_79b9)))
        }
    }
}

/// The 24 upper bits as a number in [0, 1): exact, and never 1.
pub fn unit_float(bits: u32) -> f32 {
    (bits >> 8) as f32 * (1.0 / 16_777_216.0)
}

/// An integer hash of full avalanche: `lowbias32` of Wellons' hash-prospector.
pub fn hash(mut x: u32) -> u32 {
    x ^= x >> 16;
    x = x.wrapping_mul(0x7feb_352d);
    x ^= x >> 15;
    x = x.wrapping_mul(0x846c_a68b);
    x ^ x >> 16
}

/// Two of the three outputs of pcg3d: Jarzynski and Olano, "Hash Functions for GPU Rendering", JCGT
/// 9(3), 2020.
fn pcg3(x: u32, y: u32, z: u32) -> [u32; 2] {
    let step = |v: u32| v.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
    let (mut x, mut y, mut z) = (step(x), step(y), step(z));
    x = x.wrapping_add(y.wrapping_mul(z));
    y = y.wrapping_add(z.wrapping_mul(x));
    z = z.wrapping_add(x.wrapping_mul(y));
    x ^= x >> 16;
    y ^= y >> 16;
    z ^= z >> 16;
    x = x.wrapping_add(y.wrapping_mul(z));
    y = y.wrapping_add(z.wrapping_mul(x));
    [x, y]
}

/// The point `index` of the two-dimensional Sobol sequence, its order shuffled and both axes
/// scrambled, each by a nested uniform (Owen) scramble: Burley, "Practical Hash-based Owen
/// Scrambling", JCGT 9(4), 2020. Shuffling lets sequences of different seeds be put together into
/// points of more dimensions.
pub fn scrambled_sobol(index: u32, seed: u32) -> [u32; 2] {
    let shuffled = reversed_owen_scramble(index.reverse_bits(), seed).reverse_bits();
    // Both axes stay bit-reversed until after their scramble, which works in that order. The first
    // axis of Sobol's sequence is the reversed index, so here it is the index itself.
    let x = reversed_owen_scramble(shuffled, hash(seed ^ 0xa511_e9b3));
    let y = reversed_owen_scramble(reversed_sobol_y(shuffled), hash(seed ^ 0x63d8_3595));
    [x.reverse_bits(), y.reverse_bits()]
}

/// The second axis of Sobol's sequence, bit-reversed. Its generator matrix is Pascal's triangle
/// modulo 2, which is a product of five sparse factors.
fn reversed_sobol_y(mut x: u32) -> u32 {
    x ^= x >> 1 & 0x5555_5555;
    x ^= x >> 2 & 0x3333_3333;
    x ^= x >> 4 & 0x0f0f_0f0f;
    x ^= x >> 8 & 0x00ff_00ff;
    x ^ x >> 16
}

/// An Owen scramble of a bit-reversed number: each bit is flipped or not by a hash of the bits
/// below it. The hash is Vegdahl's improvement ("Building a Better LK Hash", 2021) of Laine and
/// Karras's.
fn reversed_owen_scramble(mut x: u32, seed: u32) -> u32 {
    x ^= x.wrapping_mul(0x3d20_adea);
    x = x.wrapping_add(seed);
    x = x.wrapping_mul(seed >> 16 | 1);
    x ^= x.wrapping_mul(0x0552_6c56);
    x ^ x.wrapping_mul(0x53a2_2864)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The textbook construction, direction numbers and all.
    fn sobol(index: u32) -> [u32; 2] {
        let mut direction = 1_u32 << 31;
        let mut point = [index.reverse_bits(), 0];
        for bit in 0..32 {
            if index >> bit & 1 == 1 {
                point[1] ^= direction;
            }
            direction ^= direction >> 1;
        }
        point
    }

    #[test]
    fn the_second_axis_is_sobols() {
        for index in (0..4096).chain([u32::MAX, 0x8000_0000, 0xdead_beef]) {
            assert_eq!(reversed_sobol_y(index).reverse_bits(), sobol(index)[1], "{index}");
        }
    }

    /// Every elementary interval of a (0, m, 2)-net holds one point: for each prefix of 2^m
    /// samples, scrambled or not.
    #[test]
    fn every_prefix_is_a_net() {
        for seed in [1, 77, 0xffff_0001] {
            for m in 0..=10_u32 {
                for split in 0..=m {
                    let mut seen = [false; 1024];
                    for index in 0..1_u32 << m {
                        let [x, y] = scrambled_sobol(index, seed);
                        let column = (x as u64 >> (32 - split)) as usize;
                        let row = (y as u64 >> (32 - (m - split))) as usize;
                        let cell = column << (m - split) | row;
                        assert!(!seen[cell], "seed {seed}, m {m}, split {split}");
                        seen[cell] = true;
                    }
                }
            }
        }
    }
}
