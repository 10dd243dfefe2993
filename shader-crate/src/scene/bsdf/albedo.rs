//! How much a rough surface reflects in all: tables that keep the energy of the
//! [principled](super::principled) material.
//!
//! By Schlick's approximation, `F = F0 + (1 - F0) (1 - c)^5`, the albedo of microfacets is `F0 a +
//! b`, with `a` and `b` functions of the roughness and of the angle alone (Karis, "Real Shading in
//! Unreal Engine 4", 2013). The table has them for [`SIDE`] roughnesses from 0 to 1, each for
//! [`SIDE`] cosines, the squares of equal steps from 0 to 1, as `a` falls steeply at grazing
//! angles; then, for each roughness, their means over the cosine-weighted hemisphere. A row holds
//! two neighbours:
//!
//! ```text
//! of an angle: a(i), b(i), a(i + 1), b(i + 1) for i in 0..SIDE - 1, SIDE times
//! of the mean: a(j), b(j), a(j + 1), b(j + 1) for j in 0..SIDE - 1
//! ```
//!
//! Tables of the same layout have, for the [boundary](super::boundary) of an index of refraction,
//! the shares of light that one microfacet sends on, from outside (`a`) and from inside (`b`); and
//! for [sheen](super::sheen) what it reflects (`a`).

use crate::glam::{UVec4, Vec2};
use crate::memory::access::at;
#[cfg(target_arch = "spirv")]
use spirv_std::num_traits::Float as _;

/// Roughnesses of the table, and cosines.
pub const SIDE: u32 = 32;
/// Rows for one roughness.
pub const ROWS_PER_ROUGHNESS: u32 = SIDE - 1;
/// Rows of the table.
pub const ROWS: u32 = (SIDE + 1) * ROWS_PER_ROUGHNESS;

/// The table. All results are pairs of `a` and `b`.
#[derive(Clone, Copy)]
pub struct AlbedoView<'a> {
    /// The buffer.
    pub rows: &'a [UVec4],
    /// Row where the table begins.
    pub first: u32,
    /// Row where that of [anisotropic](super::anisotropic) surfaces begins, if there are any.
    pub anisotropic: u32,
}

impl AlbedoView<'_> {
    /// The albedo under a `cosine`, both in [0, 1].
    pub fn directional(&self, roughness: f32, cosine: f32) -> Vec2 {
        let (lower, share) = cell(roughness, SIDE);
        let (column, along) = cell(cosine.sqrt(), SIDE);
        let row = self.first + lower * ROWS_PER_ROUGHNESS + column;
        let below = between(at(self.rows, row), along);
        below.lerp(between(at(self.rows, row + ROWS_PER_ROUGHNESS), along), share)
    }

    /// The mean albedo of a `roughness` in [0, 1].
    pub fn mean(&self, roughness: f32) -> Vec2 {
        let (lower, share) = cell(roughness, SIDE);
        between(at(self.rows, self.first + SIDE * ROWS_PER_ROUGHNESS + lower), share)
    }
}

/// Which pair of neighbours, of `count` from 0 to 1, `x` in [0, 1] lies between, and where.
pub(super) fn cell(x: f32, count: u32) -> (u32, f32) {
    // `abs` changes nothing. It keeps the factor from being joined with that of `x`.
    let place = x.abs() * (count - 1) as f32;
    let lower = (place as u32).min(count - 2);
    (lower, place - lower as f32)
}

/// What lies between the two neighbours of a row.
pub(super) fn between(row: UVec4, share: f32) -> Vec2 {
    let low = Vec2::new(f32::from_bits(row.x), f32::from_bits(row.y));
    low.lerp(Vec2::new(f32::from_bits(row.z), f32::from_bits(row.w)), share)
}
