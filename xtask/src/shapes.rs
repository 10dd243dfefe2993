//! The shapes that scenes of the project's own making are put together from: surfaces by formulas,
//! as OBJ files with normals.

use crate::Outcome;
use anyhow::{Context, Result};
use glam::DVec3;
use std::f64::consts::{FRAC_PI_2, PI, TAU};
use std::fmt::Write;
use std::path::Path;

/// Where they lie.
const FOLDER: &str = "scenes/shapes";
/// Sides of what is turned about the axis y.
const SIDES: u32 = 72;

/// Quadrilaterals whose corners run counter-clockwise as seen from outside.
#[derive(Default)]
struct Shape {
    /// Positions and normals, of unit length.
    corners: Vec<(DVec3, DVec3)>,
    faces: Vec<[u32; 4]>,
}

impl Shape {
    /// A surface over a grid of `columns` times `rows` cells: the position at a corner, and the
    /// normal. Columns go on to the right of rows as seen from outside, where rows go up.
    fn grid(columns: u32, rows: u32, at: impl Fn(u32, u32) -> (DVec3, DVec3)) -> Self {
        let mut shape = Self::default();
        for row in 0..=rows {
            shape.corners.extend((0..=columns).map(|column| at(column, row)));
        }
        let index = |column: u32, row: u32| row * (columns + 1) + column;
        for (row, column) in (0..rows).flat_map(|row| (0..columns).map(move |c| (row, c))) {
            let (right, up) = (column + 1, row + 1);
            shape.faces.push([
                index(column, row),
                index(right, row),
                index(right, up),
                index(column, up),
            ]);
        }
        shape
    }

    fn add(&mut self, other: Self) {
        let first = self.corners.len() as u32;
        self.corners.extend(other.corners);
        self.faces.extend(other.faces.iter().map(|face| face.map(|corner| first + corner)));
    }

    /// What `profile` sweeps about the axis y: radii and heights with the outside on the right, in
    /// pieces that are smooth each.
    fn turned(profile: &[Vec<[f64; 2]>]) -> Self {
        let mut shape = Self::default();
        for piece in profile {
            let slope = |index: usize| {
                let (before, after) = (index.saturating_sub(1), (index + 1).min(piece.len() - 1));
                [piece[after][0] - piece[before][0], piece[after][1] - piece[before][1]]
            };
            shape.add(Self::grid(SIDES, piece.len() as u32 - 1, |side, row| {
                // The seam is in one place, so that the surface is closed.
                let (sin, cos) = (TAU * f64::from(side % SIDES) / f64::from(SIDES)).sin_cos();
                let [radius, height] = piece[row as usize];
                let [out, up] = slope(row as usize);
                let around = DVec3::new(cos, 0.0, -sin);
                let normal = (around * up - DVec3::Y * out).normalize();
                (around * radius + DVec3::Y * height, normal)
            }));
        }
        shape
    }

    /// The text of an OBJ; corners that print alike are one.
    fn to_obj(&self, about: &str) -> Result<String> {
        let mut text = format!("# {about}, by `cargo xtask shapes`.\n");
        let (mut places, mut normals) = (Vec::new(), Vec::new());
        let number = |kind: &mut Vec<String>, line: String| {
            let known = kind.iter().position(|other| *other == line);
            known.unwrap_or_else(|| {
                kind.push(line);
                kind.len() - 1
            }) + 1
        };
        let print = |name: &str, v: DVec3| {
            let [x, y, z] = v.to_array().map(|c| (c * 1e4).round() / 1e4 + 0.0);
            format!("{name} {x} {y} {z}")
        };
        let numbers: Vec<[usize; 2]> = self
            .corners
            .iter()
            .map(|&(position, normal)| {
                [
                    number(&mut places, print("v", position)),
                    number(&mut normals, print("vn", normal)),
                ]
            })
            .collect();
        for line in places.iter().chain(&normals) {
            writeln!(text, "{line}")?;
        }
        for face in &self.faces {
            let mut corners: Vec<[usize; 2]> = face.iter().map(|&c| numbers[c as usize]).collect();
            // At the axis two of them are one.
            corners.dedup_by_key(|corner| corner[0]);
            if corners.first().map(|c| c[0]) == corners.last().map(|c| c[0]) {
                corners.pop();
            }
            text.push('f');
            for [position, normal] in corners {
                write!(text, " {position}//{normal}")?;
            }
            text.push('\n');
        }
        Ok(text)
    }
}

/// A quarter of a circle, or as much as lies between two angles counter-clockwise from the radius.
fn arc(middle: [f64; 2], radius: f64, from: f64, to: f64) -> Vec<[f64; 2]> {
    const STEPS: u32 = 6;
    let at = |step: u32| {
        let (sin, cos) = (from + (to - from) * f64::from(step) / f64::from(STEPS)).sin_cos();
        [middle[0] + radius * cos, middle[1] + radius * sin]
    };
    (0..=STEPS).map(at).collect()
}

/// A tumbler, 1 high: a thick bottom and a round rim.
fn tumbler() -> Shape {
    let outside = [vec![[0.0, 0.0]], arc([0.36, 0.05], 0.05, -FRAC_PI_2, 0.0)].concat();
    let wall = [vec![[0.41, 0.05]], arc([0.425, 1.0], 0.02, 0.0, PI), vec![[0.38, 0.19]]].concat();
    let inside = [arc([0.3, 0.19], 0.08, 0.0, -FRAC_PI_2), vec![[0.0, 0.11]]].concat();
    Shape::turned(&[outside, wall, inside])
}

/// What is in it: it reaches half into the wall.
fn drink() -> Shape {
    let bottom = [vec![[0.0, 0.08]], arc([0.31, 0.18], 0.09, -FRAC_PI_2, 0.0)].concat();
    Shape::turned(&[bottom, vec![[0.4, 0.18], [0.41, 0.72]], vec![[0.41, 0.72], [0.0, 0.72]]])
}

/// A ball of radius 1.
fn ball() -> Shape {
    let steps = SIDES / 2;
    let profile = (0..=steps).map(|step| {
        let (sin, cos) = (PI * f64::from(step) / f64::from(steps)).sin_cos();
        [if step % steps == 0 { 0.0 } else { sin }, -cos]
    });
    Shape::turned(&[profile.collect()])
}

/// A ring of radius 1, as thick as 0.6, that lies.
fn ring() -> Shape {
    let steps = 36;
    let at = |step: u32| {
        let (sin, cos) = (TAU * f64::from(step % steps) / f64::from(steps) - PI).sin_cos();
        [1.0 + 0.3 * cos, 0.3 * sin]
    };
    Shape::turned(&[(0..=steps).map(at).collect()])
}

/// A cube from -1 to 1 with round edges.
fn cube() -> Shape {
    const CELLS: u32 = 10;
    const ROUND: f64 = 0.3;
    let mut shape = Shape::default();
    let axes = [DVec3::X, DVec3::Y, DVec3::Z];
    for (axis, sign) in (0..3).flat_map(|axis| [(axis, 1.0), (axis, -1.0)]) {
        let out = axes[axis] * sign;
        let right = axes[(axis + 1) % 3] * sign;
        let up = axes[(axis + 2) % 3];
        shape.add(Shape::grid(CELLS, CELLS, |column, row| {
            let place = |step: u32| 2.0 * f64::from(step) / f64::from(CELLS) - 1.0;
            let point = out + right * place(column) + up * place(row);
            let core = point.clamp(DVec3::splat(ROUND - 1.0), DVec3::splat(1.0 - ROUND));
            let normal = (point - core).normalize();
            (core + normal * ROUND, normal)
        }));
    }
    shape
}

/// A cloth from -1 to 1 in x and z, with folds, flat in the middle.
fn cloth() -> Shape {
    const CELLS: u32 = 56;
    let height = |x: f64, z: f64| {
        let far = ((x * x + z * z) - 0.12).clamp(0.0, 1.0);
        let folds = (7.0 * x + 2.5 * z + (3.0 * z).sin()).sin() + 0.5 * (9.0 * z - 4.0 * x).sin();
        0.05 * far * folds
    };
    Shape::grid(CELLS, CELLS, |column, row| {
        let place = |step: u32| 2.0 * f64::from(step) / f64::from(CELLS) - 1.0;
        let (x, z) = (place(column), -place(row));
        let step = 1e-4;
        let along =
            |dx: f64, dz: f64| (height(x + dx, z + dz) - height(x - dx, z - dz)) / (2.0 * step);
        let normal = DVec3::new(-along(step, 0.0), 1.0, -along(0.0, step)).normalize();
        (DVec3::new(x, height(x, z), z), normal)
    })
}

/// Name, what it is, and the shape.
fn all() -> [(&'static str, &'static str, Shape); 6] {
    [
        ("ball", "A ball of radius 1", ball()),
        ("cloth", "A cloth from -1 to 1 in x and z", cloth()),
        ("cube", "A cube from -1 to 1 with round edges", cube()),
        ("drink", "What is in the tumbler; reaches half into its wall", drink()),
        ("ring", "A ring of radius 1", ring()),
        ("tumbler", "A tumbler, 1 high", tumbler()),
    ]
}

/// Writes the shapes, or compares them with those that are there.
pub fn run(check: bool) -> Result<Outcome> {
    let mut differ = Vec::new();
    for (name, about, shape) in all() {
        let path = Path::new(FOLDER).join(name).with_extension("obj");
        let text = shape.to_obj(about)?;
        if check {
            let found = std::fs::read_to_string(&path).unwrap_or_default();
            differ.extend((found != text).then(|| path.display().to_string()));
        } else {
            std::fs::write(&path, text)
                .with_context(|| format!("cannot write {}", path.display()))?;
        }
    }
    if differ.is_empty() {
        return Ok(Outcome::Good(format!("{FOLDER} has the shapes.")));
    }
    Ok(Outcome::Bad(format!("others than `cargo xtask shapes` makes: {}", differ.join(", "))))
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::HashMap;

    /// Every edge of what is a body has a face on both sides, which runs along it the other way,
    /// and fronts are outside.
    #[test]
    fn bodies_are_closed_and_their_fronts_are_outside() {
        for (name, about, shape) in all() {
            if name == "cloth" {
                continue;
            }
            let text = shape.to_obj(about).unwrap();
            let numbers = |line: &str| -> Vec<usize> {
                line.split(' ')
                    .skip(1)
                    .map(|c| c.split('/').next().unwrap().parse().unwrap())
                    .collect()
            };
            let position = |line: &str| {
                let mut values = line.split(' ').skip(1).map(|value| value.parse().unwrap());
                DVec3::new(values.next().unwrap(), values.next().unwrap(), values.next().unwrap())
            };
            let places: Vec<DVec3> =
                text.lines().filter(|line| line.starts_with("v ")).map(position).collect();
            let mut edges: HashMap<(usize, usize), i32> = HashMap::new();
            let mut volume = 0.0;
            for face in text.lines().filter(|line| line.starts_with('f')).map(numbers) {
                for (index, &from) in face.iter().enumerate() {
                    let to = face[(index + 1) % face.len()];
                    *edges.entry((from.min(to), from.max(to))).or_default() +=
                        if from < to { 1 } else { -1 };
                }
                for pair in face[1..].windows(2) {
                    let [a, b, c] = [face[0], pair[0], pair[1]].map(|n| places[n - 1]);
                    volume += a.dot(b.cross(c)) / 6.0;
                }
            }
            assert!(edges.values().all(|sum| *sum == 0), "{name} is open");
            assert!(volume > 0.05, "{name} has the volume {volume}");
        }
    }

    #[test]
    fn normals_point_outside() {
        for (name, _, shape) in all() {
            for face in &shape.faces {
                let [a, b, c, d] = face.map(|corner| shape.corners[corner as usize]);
                let across = (c.0 - a.0).cross(d.0 - b.0);
                let mean = a.1 + b.1 + c.1 + d.1;
                assert!(across.dot(mean) > 0.0, "{name}: {face:?}");
            }
        }
    }

    #[test]
    fn the_shapes_that_ship_are_these() {
        for (name, about, shape) in all() {
            let path = Path::new("..").join(FOLDER).join(name).with_extension("obj");
            let found = std::fs::read_to_string(&path).unwrap_or_default();
            assert!(found == shape.to_obj(about).unwrap(), "{}", path.display());
        }
    }
}
