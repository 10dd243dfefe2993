//! Lists of renders and what became of them, as text, and how two of them differ.

use anyhow::{Context, Result};
use std::collections::HashMap;
use std::fmt;

/// What stands in a list for the digest of a render that does not reproduce itself.
const VARIES: &str = "varies";
/// Hexadecimal digits of a SHA-256.
const DIGITS: usize = 64;

/// What a render's pixels are.
#[derive(Clone, Debug, PartialEq)]
pub enum Digest {
    /// The same on every run: their SHA-256.
    Pixels(String),
    /// Not the same on every run.
    Varies,
}

/// A line of a list.
#[derive(Clone, Debug, PartialEq)]
pub struct Line {
    /// What came of the render.
    pub digest: Digest,
    /// `scene integrator allocator device`.
    pub render: String,
}

impl Line {
    /// The device, which is what follows the third space: its name may have spaces.
    pub fn device(&self) -> &str {
        self.render.splitn(4, ' ').nth(3).unwrap_or_default()
    }
}

impl fmt::Display for Line {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let digest = match &self.digest {
            Digest::Pixels(digest) => digest,
            Digest::Varies => VARIES,
        };
        write!(f, "{digest:DIGITS$}  {}", self.render)
    }
}

/// The lines of a list. Empty ones do not count.
///
/// # Errors
///
/// When a line is none; the message has its number.
pub fn parse(text: &str) -> Result<Vec<Line>> {
    let lines = (1..).zip(text.lines()).filter(|(_, line)| !line.trim().is_empty());
    lines
        .map(|(number, line)| {
            parse_line(line)
                .with_context(|| format!("line {number} is not a digest and a render: {line}"))
        })
        .collect()
}

fn parse_line(line: &str) -> Option<Line> {
    let (digest, render) = line.split_once(' ')?;
    let digest = match digest {
        VARIES => Digest::Varies,
        _ if digest.len() == DIGITS && digest.bytes().all(|byte| byte.is_ascii_hexdigit()) => {
            Digest::Pixels(digest.to_owned())
        }
        _ => return None,
    };
    let line = Line { digest, render: render.trim().to_owned() };
    (!line.device().is_empty()).then_some(line)
}

/// How a list differs from an earlier one.
#[derive(Debug, Default, PartialEq)]
pub struct Comparison {
    /// Renders whose pixels are the same.
    pub same: usize,
    /// A sentence for each render whose pixels differ, or that only one of the lists has.
    pub differences: Vec<String>,
    /// A sentence for each render of which neither can be said.
    pub undecided: Vec<String>,
}

/// Compares the list `now` with the list `earlier`.
pub fn compare(earlier: &[Line], now: &[Line]) -> Comparison {
    let mut comparison = Comparison::default();
    let mut left: HashMap<_, _> = earlier.iter().map(|line| (&line.render, line)).collect();
    for line in now {
        let render = &line.render;
        match (left.remove(render).map(|earlier| &earlier.digest), &line.digest) {
            (None, _) => comparison.differences.push(format!("new:     {render}")),
            (Some(Digest::Varies), _) | (_, Digest::Varies) => {
                comparison.undecided.push(format!("varies:  {render}"));
            }
            (Some(earlier), now) if earlier == now => comparison.same += 1,
            _ => comparison.differences.push(format!("differs: {render}")),
        }
    }
    let absent = earlier.iter().filter(|line| left.contains_key(&line.render));
    comparison.differences.extend(absent.map(|line| format!("absent:  {}", line.render)));
    comparison
}

#[cfg(test)]
mod tests {
    use super::*;

    fn pixels(digit: char, render: &str) -> Line {
        let digest = Digest::Pixels(digit.to_string().repeat(DIGITS));
        Line { digest, render: render.to_owned() }
    }

    fn varies(render: &str) -> Line {
        Line { digest: Digest::Varies, render: render.to_owned() }
    }

    #[test]
    fn what_is_written_is_read() {
        let lines = [pixels('a', "box lvc runs cpu"), varies("box lvc atomic Some Card:2")];
        let text = lines.iter().map(|line| format!("{line}\n")).collect::<String>() + "\n";
        assert_eq!(parse(&text).unwrap(), lines);
        assert_eq!(lines[1].device(), "Some Card:2");
    }

    #[test]
    fn what_is_no_line_is_named() {
        let digest = "0".repeat(DIGITS);
        for line in [
            "varies".to_owned(),
            "varies  box lvc runs".to_owned(),
            format!("{digest}0  box lvc runs cpu"),
            format!("{}g  box lvc runs cpu", &digest[1..]),
        ] {
            let error = parse(&format!("{digest}  box lvc runs gpu\n{line}\n")).unwrap_err();
            assert!(error.to_string().starts_with("line 2 is not"), "{error}");
        }
    }

    #[test]
    fn lists_are_compared_by_render() {
        let earlier = [
            pixels('a', "box lvc uniform cpu"),
            pixels('a', "box lvc uniform gpu"),
            pixels('a', "box lvc runs cpu"),
            pixels('a', "box lvc runs gpu"),
            varies("box lvc atomic cpu"),
            pixels('a', "box lvc atomic gpu"),
        ];
        assert_eq!(compare(&earlier, &earlier[..4]).same, 4);
        let now = [
            varies("box lvc atomic gpu"),
            pixels('a', "box lvc atomic cpu"),
            pixels('b', "box lvc runs cpu"),
            pixels('a', "box lvc uniform cpu"),
            pixels('a', "box lvc uniform gpu"),
            pixels('a', "box lvc paper gpu"),
        ];
        let expected = Comparison {
            same: 2,
            differences: vec![
                "differs: box lvc runs cpu".into(),
                "new:     box lvc paper gpu".into(),
                "absent:  box lvc runs gpu".into(),
            ],
            undecided: vec![
                "varies:  box lvc atomic gpu".into(),
                "varies:  box lvc atomic cpu".into(),
            ],
        };
        assert_eq!(compare(&earlier, &now), expected);
        assert_eq!(compare(&[], &[]), Comparison::default());
    }
}
