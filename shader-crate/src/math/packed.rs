//! Numbers that share words: codes of 16 bits, and tangents.
//!
//! A tangent is one word: a unit vector in octahedral form, and a sign.
//! Cigolle et al., "A Survey of Efficient Representations for Independent Unit Vectors", JCGT 3(2),
//! 2014. 15 bits for each of two coordinates are good to 1.5e-4; bit 30 says that there
//! is a tangent, bit 31 that texture coordinates are mirrored.

use crate::glam::{Vec3, Vec4};

/// The largest code of 16 bits.
pub const LARGEST_SHORT: f32 = 65_535.0;

/// Four codes of 16 bits, two to a word, the first one in its lower half.
pub fn shorts(low: u32, high: u32) -> Vec4 {
    Vec4::new(
        (low & 0xffff) as f32,
        (low >> 16) as f32,
        (high & 0xffff) as f32,
        (high >> 16) as f32,
    )
}

/// Of what has no texture coordinates that span it.
pub const NO_TANGENT: u32 = 0;

/// A direction along a surface, in which the texture coordinate `u` grows.
#[cfg_attr(not(target_arch = "spirv"), derive(Debug, PartialEq))]
#[derive(Clone, Copy)]
pub struct Tangent {
    /// Unit length.
    pub direction: Vec3,
    /// Whether `v` grows along `direction x normal`, not along `normal x direction`.
    pub is_mirrored: bool,
}

/// Steps from -1 to 1.
const STEPS: f32 = 32_766.0;
const HAS_TANGENT: u32 = 1 << 30;
const IS_MIRRORED: u32 = 1 << 31;

impl Tangent {
    /// The word.
    pub fn pack(&self) -> u32 {
        let d = self.direction / self.direction.abs().element_sum();
        let (x, y) = if d.z < 0.0 {
            ((1.0 - d.y.abs()) * sign(d.x), (1.0 - d.x.abs()) * sign(d.y))
        } else {
            (d.x, d.y)
        };
        let code = |x: f32| ((x * 0.5 + 0.5) * STEPS + 0.5) as u32;
        let mirrored = if self.is_mirrored { IS_MIRRORED } else { 0 };
        code(x) | code(y) << 15 | HAS_TANGENT | mirrored
    }

    /// What a word that is not [`NO_TANGENT`] stands for.
    pub fn unpack(word: u32) -> Self {
        let value = |code: u32| (code & 0x7fff) as f32 * (2.0 / STEPS) - 1.0;
        let (x, y) = (value(word), value(word >> 15));
        let z = 1.0 - x.abs() - y.abs();
        let direction = if z < 0.0 {
            Vec3::new((1.0 - y.abs()) * sign(x), (1.0 - x.abs()) * sign(y), z)
        } else {
            Vec3::new(x, y, z)
        };
        Self { direction: direction.normalize(), is_mirrored: word & IS_MIRRORED != 0 }
    }
}

fn sign(x: f32) -> f32 {
    if x < 0.0 { -1.0 } else { 1.0 }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn directions_come_back() {
        let mut worst = 0.0_f32;
        for k in 0..10_000 {
            let (sin, cos) = (k as f32 * 2.4).sin_cos();
            let z = k as f32 / 4999.5 - 1.0;
            let radius = (1.0 - z * z).max(0.0).sqrt();
            let direction = Vec3::new(radius * sin, radius * cos, z).normalize();
            let tangent = Tangent { direction, is_mirrored: k % 3 == 0 };
            let word = tangent.pack();
            assert_ne!(word, NO_TANGENT);
            let back = Tangent::unpack(word);
            assert_eq!(back.is_mirrored, tangent.is_mirrored);
            worst = worst.max((back.direction - direction).length());
        }
        assert!(worst < 1.5e-4, "{worst}");
        for axis in Vec3::AXES {
            for direction in [axis, -axis] {
                let tangent = Tangent { direction, is_mirrored: false };
                assert!((Tangent::unpack(tangent.pack()).direction - direction).length() < 1e-4);
            }
        }
    }
}
