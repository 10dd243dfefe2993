//! Lines and words of OBJ and MTL, whatever wrote them.

use super::encoding::UTF8_MARK;
use memchr::memchr2;
use std::borrow::Cow;

/// The statements of a text, each with the number (from 1) of the line that it begins in, without
/// white space around it.
///
/// Lines end in `\n`, `\r\n` or `\r`; a `\` at the end joins a line to the next one.
pub(in crate::scene) struct Lines<'a> {
    rest: &'a [u8],
    /// The number of the last line that was taken.
    number: usize,
}

impl<'a> Lines<'a> {
    pub(in crate::scene) fn new(text: &'a [u8]) -> Self {
        Self { rest: text, number: 0 }
    }

    /// The next line as it is in the file.
    fn physical(&mut self) -> Option<&'a [u8]> {
        if self.rest.is_empty() {
            return None;
        }
        self.number += 1;
        let end = memchr2(b'\n', b'\r', self.rest).unwrap_or(self.rest.len());
        let (line, rest) = self.rest.split_at(end);
        let ending = if rest.starts_with(b"\r\n") { 2 } else { rest.len().min(1) };
        self.rest = &rest[ending..];
        // Files that were put together have marks within.
        Some(trimmed(line.strip_prefix(UTF8_MARK).unwrap_or(line)))
    }
}

impl<'a> Iterator for Lines<'a> {
    type Item = (usize, Cow<'a, [u8]>);

    fn next(&mut self) -> Option<Self::Item> {
        let first = self.physical()?;
        let number = self.number;
        let Some(start) = continued(first) else { return Some((number, Cow::Borrowed(first))) };
        let mut joined = start.to_vec();
        while let Some(line) = self.physical() {
            joined.push(b' ');
            let Some(part) = continued(line) else {
                joined.extend_from_slice(line);
                break;
            };
            joined.extend_from_slice(part);
        }
        let end = joined.trim_ascii_end().len();
        joined.truncate(end);
        Some((number, Cow::Owned(joined)))
    }
}

/// Without white space, and without the sign that ends files of DOS.
fn trimmed(line: &[u8]) -> &[u8] {
    let line = line.trim_ascii();
    line.strip_suffix(b"\x1a").map_or(line, <[u8]>::trim_ascii_end)
}

/// A line that goes on in the next one, without its `\`. A comment does not: paths of folders end
/// in `\`. Nor does a name in Shift-JIS or GBK, where that byte may be half of a character.
fn continued(line: &[u8]) -> Option<&[u8]> {
    let start = line.strip_suffix(b"\\")?;
    if start.last().is_some_and(|&byte| byte > 0x80) && std::str::from_utf8(start).is_err() {
        return None;
    }
    let has_comment = start.starts_with(b"#")
        || start.windows(2).any(|pair| pair[0].is_ascii_whitespace() && pair[1] == b'#');
    (!has_comment).then_some(start)
}

/// A statement's keyword, and what follows it.
pub(in crate::scene) fn split_keyword(line: &[u8]) -> (&[u8], &[u8]) {
    let end = line.iter().position(u8::is_ascii_whitespace).unwrap_or(line.len());
    let (keyword, rest) = line.split_at(end);
    (keyword, rest.trim_ascii_start())
}

/// The words of a statement without names, up to a comment.
pub(in crate::scene) fn words(statement: &[u8]) -> Words<'_> {
    Words { rest: statement }
}

/// See [`words`].
pub(in crate::scene) struct Words<'a> {
    rest: &'a [u8],
}

impl<'a> Iterator for Words<'a> {
    type Item = &'a [u8];

    fn next(&mut self) -> Option<&'a [u8]> {
        let start = self.rest.trim_ascii_start();
        let end = start.iter().position(u8::is_ascii_whitespace).unwrap_or(start.len());
        let (mut word, mut rest) = start.split_at(end);
        if let Some(hash) = comment_in(word) {
            (word, rest) = (&word[..hash], &[]);
        }
        self.rest = rest;
        (!word.is_empty()).then_some(word)
    }
}

/// Where a comment begins in a word. Some libraries write `1.#IND` for what is not a number.
fn comment_in(word: &[u8]) -> Option<usize> {
    let hash = word.iter().position(|&byte| byte == b'#')?;
    let is_number = hash > 0
        && word[hash - 1] == b'.'
        && word.get(hash + 1).is_some_and(u8::is_ascii_alphabetic);
    (!is_number).then_some(hash)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn lines(text: &str) -> Vec<(usize, String)> {
        Lines::new(text.as_bytes())
            .map(|(number, line)| (number, String::from_utf8(line.into_owned()).unwrap()))
            .collect()
    }

    fn in_words(text: &str) -> Vec<&str> {
        words(text.as_bytes()).map(|word| std::str::from_utf8(word).unwrap()).collect()
    }

    fn numbered(lines: &[(usize, &str)]) -> Vec<(usize, String)> {
        lines.iter().map(|&(number, line)| (number, line.to_owned())).collect()
    }

    #[test]
    fn lines_end_as_on_any_system() {
        let expected = numbered(&[(1, "a"), (2, "b"), (3, ""), (4, "c"), (5, "d")]);
        assert_eq!(lines("a\nb\r\n\rc\r d \t"), expected);
        assert_eq!(lines("a\n\u{1a}"), numbered(&[(1, "a"), (2, "")]));
        assert_eq!(lines("\u{feff}a\n\u{feff}b"), numbered(&[(1, "a"), (2, "b")]));
    }

    #[test]
    fn a_backslash_joins_lines_of_any_ending() {
        for end in ["\n", "\r\n", "\r"] {
            let text = format!("f 1 \\{end} 2 \\ {end}3{end}v 1\\{end}\\{end}");
            assert_eq!(lines(&text), numbered(&[(1, "f 1  2  3"), (4, "v 1")]));
        }
        let japanese = Lines::new(b"usemtl \x95\\\nf 1").collect::<Vec<_>>();
        assert_eq!(japanese, [(1, b"usemtl \x95\\".into()), (2, b"f 1".into())]);
        assert_eq!(lines("usemtl \u{e9}\\\nf"), numbered(&[(1, "usemtl \u{e9} f")]));
        let comments = "# from C:\\models\\\nv 1 # x \\\nv 2\\";
        let expected = [(1, "# from C:\\models\\"), (2, "v 1 # x \\"), (3, "v 2")];
        assert_eq!(lines(comments), numbered(&expected));
    }

    #[test]
    fn words_end_at_a_comment() {
        assert_eq!(in_words(" 1\t2  3 # 4"), ["1", "2", "3"]);
        assert_eq!(in_words("1 2#3 4"), ["1", "2"]);
        assert_eq!(in_words("-1.#IND 1.#QNAN 1."), ["-1.#IND", "1.#QNAN", "1."]);
        assert_eq!(in_words("#"), [""; 0]);
        assert_eq!(split_keyword(b"usemtl\t a b"), (b"usemtl".as_slice(), b"a b".as_slice()));
        assert_eq!(split_keyword(b"f"), (b"f".as_slice(), b"".as_slice()));
    }
}
