//! The environment as kernels read it, see [`raystream_shaders::scene::environment`].

use crate::scene::Environment;
use glam::Vec3;
use rayon::prelude::*;
use raystream_shaders::scene::environment::{EnvironmentHeader, WHOLE, unpack};
use raystream_shaders::scene::light::importance;
use std::f64::consts::{PI, TAU};

/// Cells of the distribution in a row, at most.
const MAX_COLUMNS: u32 = 1024;
/// Rows of the distribution, at most.
const MAX_ROWS: u32 = 512;
/// The largest texel is brought between half of this and this: RGB9E5's largest number.
const LARGEST: f64 = 65408.0;
/// A compensated distribution that leaves less than this share of the whole is not used: it would
/// be made of roundings.
const LEAST_LEFT: f64 = 1e-3;
/// The ball around the scene is so much larger than it must be.
const MARGIN: f32 = 1.001;

/// An environment in the layout of the kernels, and what lights are chosen by.
pub struct PackedEnvironment {
    texels: Vec<u32>,
    scale: f32,
    environment: Turned,
    plain: Distribution,
    compensated: Distribution,
    /// Integral of importance over all directions.
    pub power: f64,
    /// The largest component of its radiance.
    pub brightest: f32,
}

/// What is kept of an environment beside its texels.
struct Turned {
    width: u32,
    height: u32,
    rotation: f32,
}

/// A ball around the scene, in world units.
#[derive(Clone, Copy)]
pub struct Ball {
    /// Its middle.
    pub centre: Vec3,
    /// Its radius, above 0.
    pub radius: f32,
}

impl Ball {
    /// One around all of `points`, a little larger than the box around them.
    pub fn around(points: impl Iterator<Item = Vec3>) -> Self {
        let boxed = points.fold(None, |range: Option<(Vec3, Vec3)>, point| {
            let (low, high) = range.unwrap_or((point, point));
            Some((low.min(point), high.max(point)))
        });
        let (low, high) = boxed.unwrap_or_default();
        let radius = 0.5 * (high - low).length() * MARGIN;
        let radius = if radius > 0.0 { radius } else { 1.0 };
        Self { centre: low + 0.5 * (high - low), radius }
    }

    /// In squared world units.
    pub fn radius_squared(&self) -> f64 {
        f64::from(self.radius).powi(2)
    }
}

impl PackedEnvironment {
    /// Packs an environment that was checked; none if it is black.
    pub fn new(environment: &Environment) -> Option<Self> {
        let components = environment.texels.par_iter().map(|texel| texel.max_element());
        let largest = f64::from(components.reduce(|| 0.0, f32::max));
        if largest * f64::from(environment.strength) <= 0.0 {
            return None;
        }
        // A power of two: what has mantissas of 9 bits or fewer, as Radiance's pictures do, is kept
        // as it is.
        let unit = (largest / LARGEST).log2().ceil().exp2();
        let texels: Vec<u32> =
            environment.texels.par_iter().map(|&texel| pack(texel.as_dvec3() / unit)).collect();
        let scale = unit * f64::from(environment.strength);
        let cells = Cells::of(environment.width, environment.height, &texels);
        let whole = cells.integral(|mean| mean);
        let average = whole / (2.0 * TAU);
        let plain = cells.distribution(|mean| mean);
        let left = |mean: f64| (mean - average).max(0.0);
        let compensated = if cells.integral(left) > LEAST_LEFT * whole {
            cells.distribution(left)
        } else {
            cells.distribution(|mean| mean)
        };
        let Environment { width, height, rotation, .. } = *environment;
        Some(Self {
            texels,
            scale: scale as f32,
            environment: Turned { width, height, rotation },
            plain,
            compensated,
            power: whole * scale,
            brightest: (largest * f64::from(environment.strength)) as f32,
        })
    }

    /// Adds it to the words of the scene: two headers, for the distribution as it is and for the
    /// compensated one, and what they mean. `chance` is the probability of the environment among
    /// the lights. Returns the word of the first header.
    pub fn append(&self, words: &mut Vec<u32>, chance: f32, ball: Ball) -> u32 {
        let first = words.len() as u32;
        let first_texel = first + 2 * EnvironmentHeader::WORDS;
        let plain = first_texel + self.texels.len() as u32;
        let compensated = plain + self.plain.words.len() as u32;
        for (distribution, part) in [(plain, &self.plain), (compensated, &self.compensated)] {
            let header = EnvironmentHeader {
                width: self.environment.width,
                height: self.environment.height,
                first_texel,
                columns: part.columns,
                rows: part.rows,
                distribution,
                rotation: (f64::from(self.environment.rotation) / 360.0).rem_euclid(1.0) as f32,
                scale: self.scale,
                centre: ball.centre,
                radius: ball.radius,
                chance,
                ..EnvironmentHeader::default()
            };
            words.extend(bytemuck::cast_slice::<_, u32>(&[header]));
        }
        words.extend(&self.texels);
        words.extend(&self.plain.words);
        words.extend(&self.compensated.words);
        first
    }
}

/// The word of a colour whose components are at most [`LARGEST`]: RGB9E5, rounded to nearest
/// (Khronos Data Format Specification, section 10.1.4).
fn pack(colour: glam::DVec3) -> u32 {
    let largest = colour.max_element();
    let exponent = (largest.max(1e-30).log2().floor() as i32 + 16).max(0);
    let round =
        |exponent: i32, component: f64| (component / f64::from(exponent - 24).exp2()).round();
    // The largest mantissa may round up to the next power of two.
    let exponent = if round(exponent, largest) > 511.0 { exponent + 1 } else { exponent };
    let [red, green, blue] = colour.to_array().map(|component| round(exponent, component) as u32);
    (exponent as u32) << 27 | blue << 18 | green << 9 | red
}

/// The mean importance in each cell of a grid over the picture, of what the kernels interpolate
/// between texels.
struct Cells {
    columns: u32,
    rows: u32,
    means: Vec<f64>,
}

impl Cells {
    fn of(width: u32, height: u32, texels: &[u32]) -> Self {
        let (columns, rows) = (width.min(MAX_COLUMNS), height.min(MAX_ROWS));
        let across = averages(width, columns);
        let down = averages(height, rows);
        let wrap = |x: i64| x.rem_euclid(i64::from(width)) as usize;
        let clamp = |y: i64| y.clamp(0, i64::from(height) - 1) as usize;
        let narrow: Vec<Vec<f64>> = texels
            .par_chunks(width as usize)
            .map(|row| {
                let row: Vec<f64> =
                    row.iter().map(|&texel| f64::from(importance(unpack(texel)))).collect();
                across.iter().map(|a| a.of(|x| row[wrap(x)])).collect()
            })
            .collect();
        let means = down.par_iter().flat_map_iter(|a| {
            let narrow = &narrow;
            (0..columns as usize).map(move |column| a.of(|y| narrow[clamp(y)][column]))
        });
        Self { columns, rows, means: means.collect() }
    }

    /// Solid angle of a cell of a row.
    fn solid_angle(&self, row: u32) -> f64 {
        let step = PI / f64::from(self.rows);
        // The difference of two cosines.
        let height = 2.0 * ((f64::from(row) + 0.5) * step).sin() * (0.5 * step).sin();
        height * TAU / f64::from(self.columns)
    }

    fn row(&self, row: u32) -> &[f64] {
        &self.means[(row * self.columns) as usize..][..self.columns as usize]
    }

    /// The integral of a function of the means over all directions.
    fn integral(&self, of: impl Fn(f64) -> f64) -> f64 {
        let row = |row| self.row(row).iter().map(|&mean| of(mean)).sum::<f64>();
        (0..self.rows).map(|number| row(number) * self.solid_angle(number)).sum()
    }

    /// What draws cells in proportion to that function times their solid angles.
    fn distribution(&self, of: impl Fn(f64) -> f64) -> Distribution {
        let weights = |row| self.row(row).iter().map(|&mean| of(mean)).collect::<Vec<f64>>();
        let per_row =
            (0..self.rows).map(|row| weights(row).iter().sum::<f64>() * self.solid_angle(row));
        let mut words: Vec<u32> =
            (0..self.rows).map(|row| (self.solid_angle(row).recip() as f32).to_bits()).collect();
        words.extend(sums(&per_row.collect::<Vec<_>>()));
        for row in 0..self.rows {
            words.extend(sums(&weights(row)));
        }
        Distribution { columns: self.columns, rows: self.rows, words }
    }
}

/// The words of a distribution, as the kernels' module lays them out.
struct Distribution {
    columns: u32,
    rows: u32,
    words: Vec<u32>,
}

/// The average over an interval of what is interpolated between texels: the first texel, and the
/// weight of it and those after it.
struct Average {
    first: i64,
    weights: Vec<f64>,
}

impl Average {
    fn of(&self, value: impl Fn(i64) -> f64) -> f64 {
        self.weights.iter().zip(self.first..).map(|(weight, texel)| weight * value(texel)).sum()
    }
}

/// The averages over `cells` equal parts of `texels`. Texels beyond the ends have weights, too.
fn averages(texels: u32, cells: u32) -> Vec<Average> {
    let per_cell = f64::from(texels) / f64::from(cells);
    // The integral, up to a place, of a hat from -1 to 1.
    let hat = |place: f64| {
        let place = place.clamp(-1.0, 1.0);
        if place < 0.0 { 0.5 * (1.0 + place).powi(2) } else { 1.0 - 0.5 * (1.0 - place).powi(2) }
    };
    let average = |cell: u32| {
        let (from, to) = (f64::from(cell) * per_cell, f64::from(cell + 1) * per_cell);
        let (first, last) = ((from - 1.5).floor() as i64, (to + 0.5).ceil() as i64);
        let weight = |texel: i64| {
            let centre = texel as f64 + 0.5;
            (hat(to - centre) - hat(from - centre)) / per_cell
        };
        Average { first, weights: (first..=last).map(weight).collect() }
    };
    (0..cells).map(average).collect()
}

/// For each of `weights` the sum of those before, in units of 2^-31 of the whole. What has a weight
/// has a share, too. Where none has, all are alike.
fn sums(weights: &[f64]) -> Vec<u32> {
    let total: f64 = weights.iter().sum();
    let share = |weight: f64| {
        if total <= 0.0 {
            WHOLE / weights.len() as u32
        } else if weight > 0.0 {
            ((weight / total * f64::from(WHOLE)) as u32).max(1)
        } else {
            0
        }
    };
    let mut shares: Vec<u32> = weights.iter().map(|&weight| share(weight)).collect();
    // Rounding leaves a few units more or less than the whole: the largest will not miss them.
    let given: i64 = shares.iter().copied().map(i64::from).sum();
    if let Some(largest) = shares.iter_mut().max() {
        *largest = (i64::from(*largest) + i64::from(WHOLE) - given) as u32;
    }
    let mut sum = 0;
    let before = |share| {
        sum += share;
        sum - share
    };
    shares.into_iter().map(before).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DVec3;
    use raystream_shaders::math::random::hash;

    #[test]
    fn texels_keep_nine_bits_of_their_brightest_component() {
        let mut sum = DVec3::ZERO;
        for seed in 0..30_000 {
            let random = |k: u32| f64::from(hash(3 * seed + k)) / f64::from(u32::MAX);
            let scale = (f64::from(seed % 26) - 10.0).exp2();
            let colour = DVec3::new(random(0), random(1), random(2)) * scale;
            let kept = unpack(pack(colour)).as_dvec3();
            let off = (kept - colour) / colour.max_element();
            // Half a unit; the brightest has 256 of them, or 255.5 where it is rounded up to that.
            assert!(off.abs().max_element() <= 0.5 / 255.5, "{colour} {kept}");
            sum += off;
        }
        // The errors of 30 000 texels, each up to 2^-9 and of either sign.
        assert!((sum / 30_000.0).abs().max_element() < 5e-5, "{sum}");
        assert_eq!(unpack(pack(DVec3::splat(LARGEST))), Vec3::splat(LARGEST as f32));
        for mantissa in 128..=255 {
            let colour = DVec3::new(f64::from(mantissa), 1.0, 77.0) / 1024.0;
            assert_eq!(unpack(pack(colour)).as_dvec3(), colour, "as Radiance's pictures have it");
        }
    }

    #[test]
    fn whatever_has_a_weight_has_a_share() {
        let weights = [0.0, 1e-20, 3.0, 0.0, 1.0, 0.0];
        let ends = [&sums(&weights)[1..], &[WHOLE]].concat();
        let shares: Vec<u32> =
            sums(&weights).iter().zip(&ends).map(|(start, end)| end - start).collect();
        assert_eq!((shares[0], shares[1], shares[3], shares[5]), (0, 1, 0, 0));
        assert!(shares[2].abs_diff(WHOLE / 4 * 3) <= 2 && shares[4].abs_diff(WHOLE / 4) <= 2);
        assert_eq!(sums(&[0.0; 4]), [0, WHOLE / 4, WHOLE / 2, WHOLE / 4 * 3]);
    }

    #[test]
    fn averages_are_of_what_is_interpolated() {
        for (texels, cells) in [(7, 7), (9, 4), (1000, 3), (1, 1)] {
            for (index, average) in averages(texels, cells).iter().enumerate() {
                assert!((average.weights.iter().sum::<f64>() - 1.0).abs() < 1e-12);
                // A slope is interpolated as it is: its average is in the middle of the cell.
                let middle = (index as f64 + 0.5) * f64::from(texels) / f64::from(cells);
                assert!((average.of(|texel| texel as f64 + 0.5) - middle).abs() < 1e-9);
            }
        }
    }

    #[test]
    fn a_constant_environment_has_no_compensated_distribution() {
        let packed = PackedEnvironment::new(&Environment {
            strength: 2.0,
            ..Environment::new(30, 20, vec![Vec3::splat(3.0); 600])
        })
        .unwrap();
        assert!((packed.power / (2.0 * TAU * 6.0) - 1.0).abs() < 1e-6, "{}", packed.power);
        assert_eq!(packed.plain.words, packed.compensated.words);
        assert_eq!(packed.brightest, 6.0);
        assert!(PackedEnvironment::new(&Environment::new(1, 1, vec![Vec3::ZERO])).is_none());
    }
}
