//! Frames: numbers in the names of files.

use std::ops::RangeInclusive;
use std::path::{Path, PathBuf};
use std::str::FromStr;
use std::time::Duration;

/// Some numbers of frames, in order.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Frames {
    range: RangeInclusive<u32>,
    step: u32,
}

impl Frames {
    /// Their numbers.
    pub fn numbers(&self) -> impl Iterator<Item = u32> {
        self.range.clone().step_by(self.step as usize)
    }
}

impl FromStr for Frames {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let parsed = || {
            let (range, step) = text.split_once('x').unwrap_or((text, "1"));
            let (first, last) = range.split_once('-').unwrap_or((range, range));
            let (first, last) = (first.parse().ok()?, last.parse().ok()?);
            let step = step.parse().ok().filter(|&step| step > 0)?;
            (first <= last).then_some(Self { range: first..=last, step })
        };
        parsed().ok_or_else(|| {
            format!("'{text}' are not frames, such as 17, 1-240 or, every tenth, 1-240x10")
        })
    }
}

/// The time of a frame, of which there are so many in a second.
pub fn time(frame: u32, rate: f64) -> Duration {
    Duration::from_secs_f64(f64::from(frame) / rate)
}

/// A number of frames in a second.
pub fn parse_rate(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(rate) if (0.001..=1e6).contains(&rate) => Ok(rate),
        _ => Err(format!("'{text}' is not a number of frames in a second, such as 24 or 29.97")),
    }
}

/// Whether a name has a place for the number of a frame: one or more `#`.
pub fn has_place(name: &Path) -> bool {
    name.to_string_lossy().contains('#')
}

/// The name with each run of `#` as the number, filled up with zeros to as many digits.
pub fn fill(name: &str, frame: u32) -> String {
    let mut filled = String::new();
    let mut rest = name;
    while let Some(start) = rest.find('#') {
        let digits = rest[start..].chars().take_while(|&c| c == '#').count();
        filled.push_str(&rest[..start]);
        filled.push_str(&format!("{frame:0digits$}"));
        rest = &rest[start + digits..];
    }
    filled + rest
}

/// As [`fill`], of a path; one that is not in UTF-8 stays as it is.
pub fn fill_path(path: &Path, frame: u32) -> PathBuf {
    path.to_str().map_or_else(|| path.to_owned(), |name| fill(name, frame).into())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn frames_are_read() {
        let numbers = |text: &str| text.parse::<Frames>().unwrap().numbers().collect::<Vec<_>>();
        assert_eq!(numbers("7"), [7]);
        assert_eq!(numbers("1-4"), [1, 2, 3, 4]);
        assert_eq!(numbers("10-31x10"), [10, 20, 30]);
        for wrong in ["", "a", "4-1", "1-", "-1", "1-4x0", "1-4x", "1,2", "4294967296"] {
            assert!(wrong.parse::<Frames>().unwrap_err().contains("1-240"), "{wrong}");
        }
    }

    #[test]
    fn frames_have_times() {
        assert_eq!(time(36, parse_rate("24").unwrap()), Duration::from_millis(1500));
        for wrong in ["", "0", "-24", "inf", "NaN", "1e9"] {
            assert!(parse_rate(wrong).unwrap_err().contains("29.97"), "{wrong}");
        }
    }

    #[test]
    fn numbers_take_the_place_of_signs() {
        for (name, filled) in [
            ("a.####.exr", "a.0017.exr"),
            ("#", "17"),
            ("a", "a"),
            ("##/b##########.png", "17/b0000000017.png"),
        ] {
            assert_eq!(fill(name, 17), filled);
            assert_eq!(fill_path(Path::new(name), 17), Path::new(filled));
        }
        assert!(has_place(Path::new("a#")) && !has_place(Path::new("a")));
    }
}
