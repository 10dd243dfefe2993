//! Light from all around: a picture of it, an environment map.
//!
//! The picture is equirectangular. Its rows are circles of latitude from the zenith (+y) down, its
//! columns meridians; without rotation its middle lies in the direction -z and its right side
//! towards +x, as it is seen from within.
//!
//! Directions are drawn in proportion to what comes from them: first a row of a grid of cells, then
//! a cell of the row, both by bisection of sums (the mapping is monotone, so that points that are
//! well spread stay so; an alias table would scatter them), then a place in the cell, uniform per
//! solid angle. The sums are integers, so that every processor draws the same cell.
//!
//! In the scene's buffer `texels`, all as words:
//!
//! ```text
//! header:       see EnvironmentHeader
//! texels:       row by row from the top, see `unpack`
//! distribution: 1 / (solid angle of a cell) of each row, as f32 | sums of rows
//!               | sums of cells, row by row
//! ```
//!
//! A sum is that of all before, in units of 2^-31 of the whole.

use crate::glam::Vec3;
use crate::math::angles::sin_cos_of_turns;
use crate::math::elementary::arc_tangent;
use crate::math::random::unit_float;
use crate::math::tangent_frame;
use crate::memory::access::at;
use crate::memory::device_struct;
use core::f32::consts::{PI, TAU};
#[cfg(target_arch = "spirv")]
use spirv_std::num_traits::Float as _;

device_struct! {
    /// What lies where, and how it is turned and scaled. 64 bytes.
    pub struct EnvironmentHeader {
        /// Width of the picture in texels.
        pub width: u32,
        /// Height of the picture in texels.
        pub height: u32,
        /// Word of the first texel.
        pub first_texel: u32,
        /// Cells in a row of the distribution.
        pub columns: u32,
        /// Rows of the distribution.
        pub rows: u32,
        /// First word of the distribution.
        pub distribution: u32,
        /// Turns about +y.
        pub rotation: f32,
        /// What texels are multiplied by.
        pub scale: f32,
        /// Middle of a ball around the scene, in world units.
        pub centre: Vec3,
        /// Its radius.
        pub radius: f32,
        /// Probability that a light that is chosen by power is the environment.
        pub chance: f32,
        /// Unused; zero.
        pub pad0: u32,
        /// Unused; zero.
        pub pad1: u32,
        /// Unused; zero.
        pub pad2: u32,
    }
}

impl EnvironmentHeader {
    /// Words of one.
    pub const WORDS: u32 = 16;

    /// The first word of the sums of a row's cells.
    fn sums_of_cells(&self, row: u32) -> u32 {
        self.distribution + 2 * self.rows + row * self.columns
    }
}

/// Where the header begins if there is none.
pub const NO_ENVIRONMENT: u32 = 0;

/// What all cells, or all rows, come to.
pub const WHOLE: u32 = 1 << 31;

/// How much farther than a ball's radius a segment reaches that is to leave it from any point
/// inside.
pub const REACH: f32 = 4.0;

/// The environment of a scene.
#[derive(Clone, Copy)]
pub struct EnvironmentView<'a> {
    words: &'a [u32],
    header: u32,
}

/// A direction that was drawn.
#[derive(Clone, Copy)]
pub struct EnvironmentSample {
    /// From the scene to the environment, unit length.
    pub direction: Vec3,
    /// Its density per solid angle, the choice of the environment among the lights included.
    pub pdf: f32,
}

impl<'a> EnvironmentView<'a> {
    /// The one whose header begins at word `header` of the buffer; [`NO_ENVIRONMENT`] for none.
    pub fn new(words: &'a [u32], header: u32) -> Self {
        Self { words, header }
    }

    /// Whether there is one. If not, there is nothing else to ask.
    pub fn is_some(&self) -> bool {
        self.header != NO_ENVIRONMENT
    }

    fn word(&self, index: u32) -> u32 {
        at(self.words, self.header + index)
    }

    fn number(&self, index: u32) -> f32 {
        f32::from_bits(self.word(index))
    }

    fn header(&self) -> EnvironmentHeader {
        EnvironmentHeader {
            width: self.word(0),
            height: self.word(1),
            first_texel: self.word(2),
            columns: self.word(3),
            rows: self.word(4),
            distribution: self.word(5),
            rotation: self.number(6),
            scale: self.number(7),
            centre: Vec3::new(self.number(8), self.number(9), self.number(10)),
            radius: self.number(11),
            chance: self.number(12),
            pad0: 0,
            pad1: 0,
            pad2: 0,
        }
    }

    /// Radiance from `direction` (unit length), linear Rec.709: bilinear between texel centres.
    pub fn radiance(&self, direction: Vec3) -> Vec3 {
        let header = self.header();
        let (u, v) = place(direction, header.rotation);
        let (x, y) = (u * header.width as f32 - 0.5, v * header.height as f32 - 0.5);
        let (left, top) = (x.floor(), y.floor());
        let (x0, x1) = (wrap(left, header.width), wrap(left + 1.0, header.width));
        let (y0, y1) = (clamp(top, header.height), clamp(top + 1.0, header.height));
        let row0 = header.first_texel + y0 * header.width;
        let row1 = header.first_texel + y1 * header.width;
        let upper = self.texel(row0 + x0).lerp(self.texel(row0 + x1), x - left);
        let lower = self.texel(row1 + x0).lerp(self.texel(row1 + x1), x - left);
        upper.lerp(lower, y - top) * header.scale
    }

    fn texel(&self, word: u32) -> Vec3 {
        unpack(at(self.words, word))
    }

    /// Draws a direction by 64 random `bits`.
    pub fn sample(&self, bits: [u32; 2]) -> EnvironmentSample {
        let header = self.header();
        let row = self.draw(header.distribution + header.rows, header.rows, bits[1]);
        let column = self.draw(header.sums_of_cells(row.index), header.columns, bits[0]);
        let u = (column.index as f32 + column.offset) / header.columns as f32;
        let height = |row: u32| sin_cos_of_turns(row as f32 * (0.5 / header.rows as f32)).1;
        let (top, bottom) = (height(row.index), height(row.index + 1));
        let y = top + (bottom - top) * row.offset;
        let across = (1.0 - y * y).max(0.0).sqrt();
        let (sine, cosine) = sin_cos_of_turns(u - 0.5 - header.rotation);
        EnvironmentSample {
            direction: Vec3::new(across * sine, y, -across * cosine),
            pdf: self.density(&header, row.index, row.share, column.share),
        }
    }

    /// The density per solid angle with which [`Self::sample`] draws `direction` (unit length).
    pub fn pdf(&self, direction: Vec3) -> f32 {
        let header = self.header();
        let (u, v) = place(direction, header.rotation);
        let column = ((u * header.columns as f32) as u32).min(header.columns - 1);
        let row = ((v * header.rows as f32) as u32).min(header.rows - 1);
        let row_share = self.share(header.distribution + header.rows, header.rows, row);
        let share = self.share(header.sums_of_cells(row), header.columns, column);
        self.density(&header, row, row_share, share)
    }

    /// The density in a cell, from the shares of its row and of its own in the row.
    fn density(&self, header: &EnvironmentHeader, row: u32, row_share: u32, share: u32) -> f32 {
        let unit = 1.0 / WHOLE as f32;
        let probability = row_share as f32 * unit * (share as f32 * unit);
        let per_solid_angle = f32::from_bits(at(self.words, header.distribution + row));
        probability * per_solid_angle * header.chance
    }

    /// What element `index` of the `count` whose sums begin at word `first` has of the whole.
    fn share(&self, first: u32, count: u32, index: u32) -> u32 {
        let end = if index + 1 < count { at(self.words, first + index + 1) } else { WHOLE };
        end - at(self.words, first + index)
    }

    /// One of these elements, as often as it has shares, by 32 random bits.
    fn draw(&self, first: u32, count: u32, bits: u32) -> Drawn {
        let number = bits >> 1;
        // The last element whose sum is not above the number: it has a share.
        let (mut index, mut left) = (0, count);
        while left > 1 {
            let half = left / 2;
            if at(self.words, first + index + half) <= number {
                index += half;
            }
            left -= half;
        }
        let share = self.share(first, count, index);
        let offset = (number - at(self.words, first + index)) as f32 / share as f32;
        Drawn { index, share, offset: offset.min(unit_float(u32::MAX)) }
    }

    /// Where a segment along `direction` from `point`, within the ball around the scene, has left
    /// that.
    pub fn far_end(&self, point: Vec3, direction: Vec3) -> Vec3 {
        point + direction * (self.header().radius * REACH)
    }

    /// Area of the disc through which light from one direction reaches the scene, in squared world
    /// units.
    pub fn disc_area(&self) -> f32 {
        let radius = self.header().radius;
        PI * radius * radius
    }

    /// The point of that disc, at the edge of the ball around the scene, where light from
    /// `direction` starts; uniform for a uniform point `u` of the unit square.
    pub fn disc_point(&self, direction: Vec3, u: [f32; 2]) -> Vec3 {
        let header = self.header();
        let (x, y) = tangent_frame(direction);
        let (sine, cosine) = sin_cos_of_turns(u[1]);
        let offset = direction + (x * cosine + y * sine) * u[0].sqrt();
        header.centre + offset * header.radius
    }
}

/// Where a picture that is turned by `rotation` has what comes from `direction`: from its left and
/// from its top, in [0, 1].
fn place(direction: Vec3, rotation: f32) -> (f32, f32) {
    let across = (direction.x * direction.x + direction.z * direction.z).sqrt();
    // At the poles any meridian will do, but the arc tangent of nothing is undefined.
    let ahead = if across > 0.0 { -direction.z } else { 1.0 };
    let turns = 0.5 + arc_tangent(direction.x, ahead) * (1.0 / TAU) + rotation;
    (turns - turns.floor(), arc_tangent(across, direction.y) * (1.0 / PI))
}

/// An element that was drawn.
struct Drawn {
    index: u32,
    /// What it has of the whole.
    share: u32,
    /// How far in its share the number was, in [0, 1).
    offset: f32,
}

/// The colour of a texel: three mantissas of 9 bits and, in the upper five, the exponent that they
/// share (RGB9E5).
pub fn unpack(word: u32) -> Vec3 {
    const EXPONENT_OF_0: u32 = 127 - 24;
    let unit = f32::from_bits((EXPONENT_OF_0 + (word >> 27)) << 23);
    let mantissa = |shift: u32| (word >> shift & 0x1ff) as f32;
    Vec3::new(mantissa(0), mantissa(9), mantissa(18)) * unit
}

/// The texel column of an integral coordinate in [-1, width], around the picture.
fn wrap(coordinate: f32, width: u32) -> u32 {
    if coordinate < 0.0 {
        width - 1
    } else {
        let index = coordinate as u32;
        if index >= width { 0 } else { index }
    }
}

/// The texel row of an integral coordinate in [-1, height], at most to the pole.
fn clamp(coordinate: f32, height: u32) -> u32 {
    (coordinate.max(0.0) as u32).min(height - 1)
}
