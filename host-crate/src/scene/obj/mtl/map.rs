//! The value of a `map_` key: options, then the name of a file.

use crate::scene::obj::texture_map::TextureMap;
use glam::{DVec2, DVec3};

/// What stands behind a `map_` key.
#[derive(Debug, Default, PartialEq)]
pub(super) struct MapStatement<'a> {
    /// What is left of the options: the name of a file, which may hold spaces.
    pub file: &'a [u8],
    /// Where the texture lies.
    pub map: TextureMap,
    /// What the values of a bump map are multiplied by, if that is given.
    pub height: Option<f64>,
    /// Options that change the look and have no effect here.
    pub without_effect: Vec<String>,
}

/// How far a texture may be scaled and shifted.
const MAX_FACTOR: f64 = 1e6;

impl<'a> MapStatement<'a> {
    pub(super) fn parse(value: &'a [u8]) -> Self {
        let mut statement = Self { file: value.trim_ascii(), ..Self::default() };
        while let Some(rest) = statement.option() {
            statement.file = rest;
        }
        statement
    }

    /// Reads an option; what follows it, if there is one.
    fn option(&mut self) -> Option<&'a [u8]> {
        let (word, rest) = word(self.file);
        let option = std::str::from_utf8(word.strip_prefix(b"-")?).ok()?.to_lowercase();
        let rest = match option.as_str() {
            "s" => self.vector(rest, DVec3::ONE, |map, scale| map.scale = scale)?,
            "o" => self.vector(rest, DVec3::ZERO, |map, offset| map.offset = offset)?,
            "t" => {
                let (values, rest) = numbers(rest, 3);
                self.note(values.iter().any(|&value| value != 0.0), "-t");
                rest
            }
            "mm" => {
                let (values, rest) = numbers(rest, 2);
                let is_plain =
                    values.first() == Some(&0.0) && values.get(1).is_none_or(|&gain| gain == 1.0);
                self.note(!is_plain, "-mm");
                rest
            }
            "bm" => {
                let (values, rest) = numbers(rest, 1);
                self.height = values.first().copied().or(self.height);
                rest
            }
            // These say how a texture is filtered, not what it is.
            "boost" | "texres" => numbers(rest, 1).1,
            "blendu" | "blendv" | "clamp" | "cc" | "imfchan" | "type" => {
                let (value, rest) = self::word(rest);
                let default: &[u8] = if option.starts_with("blend") { b"on" } else { b"off" };
                self.note(!value.eq_ignore_ascii_case(default), &format!("-{option}"));
                rest
            }
            _ => return None,
        };
        Some(rest)
    }

    /// Reads up to three numbers; `default` are those that are left out.
    fn vector(
        &mut self,
        rest: &'a [u8],
        default: DVec3,
        set: impl Fn(&mut TextureMap, DVec2),
    ) -> Option<&'a [u8]> {
        let (values, rest) = numbers(rest, 3);
        let mut vector = default.to_array();
        vector[..values.len()].copy_from_slice(&values);
        if vector.iter().all(|value| value.abs() <= MAX_FACTOR) {
            set(&mut self.map, DVec2::new(vector[0], vector[1]));
        } else {
            self.note(true, "-s or -o of such a size");
        }
        Some(rest)
    }

    fn note(&mut self, changes_the_look: bool, option: &str) {
        if changes_the_look {
            self.without_effect.push(option.to_owned());
        }
    }
}

/// The first word, and what follows it.
fn word(text: &[u8]) -> (&[u8], &[u8]) {
    let end = text.iter().position(u8::is_ascii_whitespace).unwrap_or(text.len());
    let (word, rest) = text.split_at(end);
    (word, rest.trim_ascii_start())
}

/// Up to `most` numbers, and what follows them. The last word is never one: it is a file's name.
fn numbers(text: &[u8], most: usize) -> (Vec<f64>, &[u8]) {
    let (mut values, mut rest) = (Vec::new(), text);
    while values.len() < most {
        let (first, after) = word(rest);
        let number = std::str::from_utf8(first).ok().and_then(|first| first.parse::<f64>().ok());
        match number.filter(|number| number.is_finite() && !after.is_empty()) {
            Some(number) => values.push(number),
            None => break,
        }
        rest = after;
    }
    (values, rest)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn parsed(text: &str) -> (&str, [f64; 4], Vec<String>) {
        let statement = MapStatement::parse(text.as_bytes());
        let MapStatement { file, map, without_effect, .. } = statement;
        let TextureMap { scale, offset, .. } = map;
        let file = std::str::from_utf8(file).unwrap();
        (file, [scale.x, scale.y, offset.x, offset.y], without_effect)
    }

    #[test]
    fn options_stand_before_the_name() {
        let none = Vec::new();
        assert_eq!(parsed("my wall.png"), ("my wall.png", [1., 1., 0., 0.], none.clone()));
        let both = "-s 4 2 1 -o .5\t-0.25 0  my wall.png";
        assert_eq!(parsed(both), ("my wall.png", [4., 2., 0.5, -0.25], none.clone()));
        assert_eq!(parsed("-s 4 w.png"), ("w.png", [4., 1., 0., 0.], none.clone()));
        assert_eq!(parsed("-o 1 2 3 4.png"), ("4.png", [1., 1., 1., 2.], none.clone()));
        assert_eq!(parsed("-s 2 2 2 7"), ("7", [2., 2., 0., 0.], none.clone()));
        assert_eq!(parsed("-blendu on -clamp off -mm 0 1 -boost 2 w.png").2, none);
        assert_eq!(parsed("-wall.png").0, "-wall.png");
        assert_eq!(parsed(""), ("", [1., 1., 0., 0.], none));
    }

    #[test]
    fn options_that_change_the_look_without_effect_are_noted() {
        let (file, _, noted) =
            parsed("-clamp on -BM 0.5 -mm .1 .9 -imfchan r -t 1 1 1 -blendv off -cc on a b.png");
        assert_eq!(file, "a b.png");
        assert_eq!(noted, ["-clamp", "-mm", "-imfchan", "-t", "-blendv", "-cc"]);
        assert_eq!(parsed("-s 1e9 1 1 w.png").2.len(), 1);
        let heights = ["-BM 0.5 w.png", "-bm w.png", "w.png", "-bm -2 -o 1 w.png"];
        let heights = heights.map(|text| MapStatement::parse(text.as_bytes()).height);
        assert_eq!(heights, [Some(0.5), None, None, Some(-2.0)]);
    }
}
