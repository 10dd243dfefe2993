//! Several texts read as one.

use std::io::{self, BufRead, Read};

/// Texts, one after the other, without a copy of them all.
pub(super) struct Pieces<'a> {
    current: &'a [u8],
    rest: std::vec::IntoIter<&'a [u8]>,
}

impl<'a> Pieces<'a> {
    pub(super) fn new(pieces: Vec<&'a [u8]>) -> Self {
        Self { current: &[], rest: pieces.into_iter() }
    }
}

impl Read for Pieces<'_> {
    fn read(&mut self, into: &mut [u8]) -> io::Result<usize> {
        let count = self.fill_buf()?.read(into)?;
        self.consume(count);
        Ok(count)
    }
}

impl BufRead for Pieces<'_> {
    fn fill_buf(&mut self) -> io::Result<&[u8]> {
        while self.current.is_empty() {
            let Some(next) = self.rest.next() else { break };
            self.current = next;
        }
        Ok(self.current)
    }

    fn consume(&mut self, count: usize) {
        self.current = &self.current[count..];
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pieces_are_read_in_order() {
        let pieces = || Pieces::new(vec![b"ab", b"", b"c\nd".as_slice(), b""]);
        assert_eq!(pieces().lines().map(Result::unwrap).collect::<Vec<_>>(), ["abc", "d"]);
        let mut text = String::new();
        pieces().read_to_string(&mut text).unwrap();
        assert_eq!(text, "abc\nd");
    }
}
