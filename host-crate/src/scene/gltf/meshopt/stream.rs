//! Bytes that are read from the front.

use super::Broken;

/// What is left of a stream.
pub struct Stream<'a> {
    bytes: &'a [u8],
}

impl<'a> Stream<'a> {
    /// The part of `bytes` between a `header` byte and a tail of this many bytes, and the tail.
    pub fn between(bytes: &'a [u8], header: u8, tail: usize) -> Result<(Self, &'a [u8]), Broken> {
        match bytes.split_first() {
            Some((&found, rest)) if found == header => {
                let at = rest.len().checked_sub(tail).ok_or(Broken::CutShort)?;
                let (bytes, tail) = rest.split_at(at);
                Ok((Self { bytes }, tail))
            }
            Some((&found, _)) => Err(Broken::Header { found, expected: header }),
            None => Err(Broken::CutShort),
        }
    }

    /// The next bytes, so many.
    pub fn take(&mut self, count: usize) -> Result<&'a [u8], Broken> {
        let (taken, rest) = self.bytes.split_at_checked(count).ok_or(Broken::CutShort)?;
        self.bytes = rest;
        Ok(taken)
    }

    /// The next byte.
    pub fn byte(&mut self) -> Result<u8, Broken> {
        let (&byte, rest) = self.bytes.split_first().ok_or(Broken::CutShort)?;
        self.bytes = rest;
        Ok(byte)
    }

    /// An integer of up to five bytes, seven bits in each from the lowest on; the eighth says that
    /// another follows.
    pub fn integer(&mut self) -> Result<u32, Broken> {
        let mut value = 0;
        for shift in [0, 7, 14, 21, 28] {
            let byte = u32::from(self.byte()?);
            value |= (byte & 0x7f) << shift;
            if byte < 0x80 {
                return Ok(value);
            }
        }
        Err(Broken::Integer)
    }

    /// Fails if anything is left.
    pub fn end(self) -> Result<(), Broken> {
        if self.bytes.is_empty() { Ok(()) } else { Err(Broken::TooLong(self.bytes.len())) }
    }
}

/// The number with a sign that stands for one without: 0, -1, 1, -2 ...
pub fn signed(code: u32) -> u32 {
    code >> 1 ^ (code & 1).wrapping_neg()
}
