//! Rows: sixteen bytes of a vector and a word, read and written at once.
//!
//! The words are bits of f32 where they are lengths. They travel as integers because a small
//! integer, read as a float, is a denormal, which a GPU may flush to zero.

use crate::glam::{UVec4, Vec3};
use crate::memory::access::at;

/// The row of a vector and a word.
#[inline(always)]
pub fn row(vector: Vec3, word: u32) -> UVec4 {
    UVec4::new(vector.x.to_bits(), vector.y.to_bits(), vector.z.to_bits(), word)
}

/// The vector of a row.
#[inline(always)]
pub fn vector(row: UVec4) -> Vec3 {
    Vec3::new(f32::from_bits(row.x), f32::from_bits(row.y), f32::from_bits(row.z))
}

/// The word of a row, as a float.
#[inline(always)]
pub fn float(row: UVec4) -> f32 {
    f32::from_bits(row.w)
}

/// Word number `index` of those that lie four to a row, from row `first` on.
#[inline(always)]
pub fn word(rows: &[UVec4], first: u32, index: u32) -> u32 {
    let row = at(rows, first + index / 4);
    let [low, high] = [[row.x, row.y], [row.z, row.w]];
    let [even, odd] = if index & 2 == 0 { low } else { high };
    if index & 1 == 0 { even } else { odd }
}

/// Two rows of a buffer, from row `first` on.
#[inline(always)]
pub fn two_rows(rows: &[UVec4], first: u32) -> [UVec4; 2] {
    [at(rows, first), at(rows, first + 1)]
}

/// Three rows of a buffer, from row `first` on.
#[inline(always)]
pub fn three_rows(rows: &[UVec4], first: u32) -> [UVec4; 3] {
    [at(rows, first), at(rows, first + 1), at(rows, first + 2)]
}

/// Four rows of a buffer, from row `first` on.
#[inline(always)]
pub fn four_rows(rows: &[UVec4], first: u32) -> [UVec4; 4] {
    [at(rows, first), at(rows, first + 1), at(rows, first + 2), at(rows, first + 3)]
}

/// Five rows of a buffer, from row `first` on.
#[inline(always)]
pub fn five_rows(rows: &[UVec4], first: u32) -> [UVec4; 5] {
    let [a, b, c, d] = four_rows(rows, first);
    [a, b, c, d, at(rows, first + 4)]
}

/// Six rows of a buffer, from row `first` on.
#[inline(always)]
pub fn six_rows(rows: &[UVec4], first: u32) -> [UVec4; 6] {
    let [a, b, c, d, e] = five_rows(rows, first);
    [a, b, c, d, e, at(rows, first + 5)]
}
