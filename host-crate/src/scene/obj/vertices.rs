//! The lines v, vt and vn of an OBJ.

use super::problem::{BadLine, Cost};
use crate::scene::bounds::{MAX_COORDINATE, MAX_PLACE};
use crate::scene::text::{Lines, shown, split_keyword, words};
use glam::DVec3;
use std::fmt::Write as _;

/// The lists of an OBJ, as indices of arrays.
pub(super) const V: usize = 0;
pub(super) const VT: usize = 1;
pub(super) const VN: usize = 2;

/// What the lists are called in messages.
pub(super) const LISTS: [&str; 3] = ["vertex", "texture coordinate", "normal"];

/// Texture coordinates go up to this: an f64 has a thousandth left of them.
const MAX_TEXTURE_COORDINATE: f64 = 1e12;

/// All vertices, texture coordinates and, if wanted, normals of an OBJ.
#[derive(Default)]
pub(super) struct Vertices {
    /// Lines `v x y z`, `vt u v` and `vn x y z`. Zeros stand for what is unusable.
    pub text: String,
    /// How many there are of each list.
    pub counts: [usize; 3],
    /// The indices, from 1, of those that are unusable, with their lines: an error only if a face
    /// that is shown uses them.
    unusable: [Vec<(usize, usize)>; 3],
    /// How many vertices have another colour than white.
    pub coloured: usize,
    /// Red, green and blue of all vertices so far, in [0, 1] as they stand there, once one of them
    /// is not white.
    colours: Vec<[f32; 3]>,
}

const WHITE: [f32; 3] = [1.0; 3];

/// Which list a keyword adds to.
pub(super) fn list_of(keyword: &[u8]) -> Option<usize> {
    match keyword {
        b"v" => Some(V),
        b"vt" => Some(VT),
        b"vn" => Some(VN),
        _ => None,
    }
}

impl Vertices {
    /// Reads them; without `normals` no vn is looked at.
    pub(super) fn parse(text: &[u8], normals: bool, cost: &mut Cost) -> Result<Self, BadLine> {
        let mut vertices = Self::default();
        for (number, line) in Lines::new(text) {
            let (keyword, rest) = split_keyword(&line);
            let Some(list) = list_of(keyword) else { continue };
            if list == VN && !normals {
                continue;
            }
            cost.vertex(number, rest.len())?;
            vertices.add(list, number, rest);
        }
        if vertices.coloured > 0 {
            vertices.text = with_colours(&vertices.text, &vertices.colours);
        }
        Ok(vertices)
    }

    fn add(&mut self, list: usize, number: usize, rest: &[u8]) {
        let before = self.text.len();
        self.counts[list] += 1;
        let mut words = words(rest);
        if append(&mut self.text, list, &mut words).is_err() {
            self.text.truncate(before);
            self.text.push_str(["v 0 0 0", "vt 0 0", "vn 0 0 0"][list]);
            self.unusable[list].push((self.counts[list], number));
        } else if list == V {
            let colour = colour(words).unwrap_or(WHITE);
            if colour != WHITE {
                self.colours.resize(self.counts[V] - 1, WHITE);
                self.coloured += 1;
            }
            if self.coloured > 0 {
                self.colours.push(colour);
            }
        }
        self.text.push('\n');
    }

    /// The line of an element, by its index from 1, if it is unusable.
    pub(super) fn unusable_line(&self, list: usize, index: usize) -> Option<usize> {
        let unusable = &self.unusable[list];
        let found = unusable.binary_search_by_key(&index, |&(index, _)| index).ok()?;
        Some(unusable[found].1)
    }

    /// How many lines are unusable, and the first of them.
    pub(super) fn unusable(&self) -> Option<(usize, usize)> {
        let first = self.unusable.iter().flatten().map(|&(_, line)| line).min()?;
        Some((self.unusable.iter().map(Vec::len).sum(), first))
    }
}

/// What is wrong with the line `number` of `text`, which is unusable.
pub(super) fn explain(text: &[u8], number: usize) -> BadLine {
    let line = Lines::new(text).find(|(found, _)| *found == number);
    let what = line.and_then(|(_, line)| {
        let (keyword, rest) = split_keyword(&line);
        append(&mut String::new(), list_of(keyword)?, &mut words(rest)).err()
    });
    BadLine::new(number, what.unwrap_or_default())
}

/// The first line of `text` with a vertex that is too far from `origin`.
pub(super) fn too_far(text: &[u8], origin: DVec3) -> BadLine {
    let is_too_far = |line: &[u8]| {
        let (keyword, rest) = split_keyword(line);
        let place = words(rest).zip(origin.to_array()).map(|(word, origin)| {
            std::str::from_utf8(word).ok()?.parse::<f64>().ok().map(|place| place - origin)
        });
        keyword == b"v" && place.flatten().any(|place| place.abs() > MAX_COORDINATE)
    };
    let line = Lines::new(text).find(|(_, line)| is_too_far(line)).map_or(0, |(line, _)| line);
    let what = format!("a coordinate is more than {MAX_COORDINATE:e} from the middle of the scene");
    BadLine::new(line, what)
}

/// Adds a line in plain form. Weights and colours are left out, and so is the w of a vt.
fn append<'a>(
    text: &mut String,
    list: usize,
    words: &mut impl Iterator<Item = &'a [u8]>,
) -> Result<(), String> {
    text.push_str(["v", "vt", "vn"][list]);
    let (wanted, needed) = [(3, 3), (2, 1), (3, 3)][list];
    let limit = [MAX_PLACE, MAX_TEXTURE_COORDINATE, f64::MAX][list];
    let mut found = 0;
    for word in words.take(wanted) {
        let word = std::str::from_utf8(word).map_err(|_| not_a_number(word))?;
        let number: f64 = word.parse().map_err(|_| not_a_number(word.as_bytes()))?;
        if number.is_nan() || number.abs() > limit {
            return Err(if limit < f64::MAX {
                format!("`{word}` is not a number from -{limit:e} to {limit:e}")
            } else {
                format!("`{word}` is not a finite number")
            });
        }
        text.push(' ');
        text.push_str(word);
        found += 1;
    }
    if found < needed {
        let numbers = if needed == 1 { "a number" } else { "3 numbers" };
        return Err(format!("a {} needs {numbers}, this has {found}", LISTS[list]));
    }
    (found..wanted).for_each(|_| text.push_str(" 0"));
    Ok(())
}

fn not_a_number(word: &[u8]) -> String {
    format!("`{}` is not a number", shown(word))
}

/// The colour that follows a position, if that are numbers: behind a weight, if there is one more.
/// Alone, a number is a weight.
fn colour<'a>(words: impl Iterator<Item = &'a [u8]>) -> Option<[f32; 3]> {
    let number = |word: &[u8]| std::str::from_utf8(word).ok()?.parse::<f32>().ok();
    let numbers: Vec<f32> = words.map(number).collect::<Option<_>>()?;
    let &[.., red, green, blue] = &numbers[..] else { return None };
    let share = |value: f32| if value.is_nan() { 1.0 } else { value.clamp(0.0, 1.0) };
    Some([red, green, blue].map(share))
}

/// The lines with the colours of their vertices; those behind the last one are white.
fn with_colours(text: &str, colours: &[[f32; 3]]) -> String {
    let mut colours = colours.iter();
    let mut coloured = String::with_capacity(2 * text.len());
    for line in text.lines() {
        coloured.push_str(line);
        if line.starts_with("v ") {
            let [red, green, blue] = colours.next().unwrap_or(&WHITE);
            // A string takes whatever is written to it.
            let _ = write!(coloured, " {red} {green} {blue}");
        }
        coloured.push('\n');
    }
    coloured
}

#[cfg(test)]
mod tests {
    use super::*;

    fn parse(text: &str) -> Vertices {
        Vertices::parse(text.as_bytes(), true, &mut Cost::new(1 << 20)).unwrap()
    }

    fn explained(text: &str) -> String {
        format!("{:?}", explain(text.as_bytes(), 1).what)
    }

    #[test]
    fn the_plain_form_has_what_is_read() {
        let vertices = parse("v 1 2 3 1 0 0 # red\r\nvt 1 2 0\n# v 9 9 9\nvt .5\nvn 0 0 1e200\n");
        assert_eq!(vertices.text, "v 1 2 3 1 0 0\nvt 1 2\nvt .5 0\nvn 0 0 1e200\n");
        assert_eq!(vertices.counts, [1, 2, 1]);
        let white = parse("v 1 2 3 1 1 1\nv 1 2 3 .5\nv 1 2 3 a b c\n");
        assert_eq!(white.text, "v 1 2 3\nv 1 2 3\nv 1 2 3\n");
        let flat = Vertices::parse(b"vn 0 x\nv 1 2 3", false, &mut Cost::new(1 << 20)).unwrap();
        assert_eq!((flat.text.as_str(), flat.counts), ("v 1 2 3\n", [1, 0, 0]));
    }

    #[test]
    fn colours_are_those_of_their_vertices() {
        let text = "v 1 2 3\nv x 0 0\nv 1 1 1 .5 0 2\nvn 0 0 1\nv 9 9 9 0.7 1 nan -1\nv 8 8 8 1\n";
        let expected = "v 1 2 3 1 1 1\nv 0 0 0 1 1 1\nv 1 1 1 0.5 0 1\nvn 0 0 1\n\
                        v 9 9 9 1 1 0\nv 8 8 8 1 1 1\n";
        assert_eq!(parse(text).text, expected);
    }

    #[test]
    fn what_is_unusable_is_kept_in_mind() {
        let vertices = parse("v 0 0 0\nvn nan 0 0\nv -1.#IND 0 0\nvt\nv 1 2\nv x 0 0\nvt 1e30\n");
        assert_eq!(vertices.text, "v 0 0 0\nvn 0 0 0\nv 0 0 0\nvt 0 0\nv 0 0 0\nv 0 0 0\nvt 0 0\n");
        let lines = [1, 2, 3, 4, 5].map(|index| vertices.unusable_line(V, index));
        assert_eq!(lines, [None, Some(3), Some(5), Some(6), None]);
        assert_eq!(vertices.unusable_line(VN, 1), Some(2));
        assert_eq!(vertices.unusable_line(VT, 2), Some(7));
        assert_eq!(vertices.unusable(), Some((6, 2)));
    }

    #[test]
    fn what_is_wrong_with_a_line_is_said_in_words() {
        assert!(explained("v 0 0").contains("a vertex needs 3 numbers, this has 2"));
        assert!(explained("vt # u").contains("a texture coordinate needs a number, this has 0"));
        assert!(explained("v 0 nan 0").contains("`nan` is not a number from -1e12 to 1e12"));
        assert!(explained("v 0 -inf 0").contains("`-inf`"));
        assert!(explained("v 0 1e13 0").contains("`1e13`"));
        assert!(explained("vn 0 nan 0").contains("`nan` is not a finite number"));
        assert!(explained("vn 0 1.#QNAN 0").contains("`1.#QNAN` is not a number"));
        assert!(explained("v 0 x\u{fc} 0").contains("is not a number"));
        let far = too_far(b"v 5e9 0 0\nvt 1e12\nv 5e9 -2e9 0", DVec3::X * 5e9);
        assert!(far.line == 3 && format!("{far:?}").contains("1e9"), "{far:?}");
    }
}
