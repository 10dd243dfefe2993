//! Modes 1 and 2: indices of triangles, and any others.

use super::Broken;
use super::stream::{Stream, signed};

const TRIANGLES: u8 = 0xe1;
const INDICES: u8 = 0xd1;
/// Bytes behind triangles: how a code stands for two vertices.
const TABLE: usize = 16;
/// Bytes behind other indices.
const RESERVED: usize = 4;

/// Those of triangles, three each: `count` in all, a multiple of 3.
pub fn triangles(bytes: &[u8], count: usize) -> Result<Vec<u32>, Broken> {
    let (mut stream, table) = Stream::between(bytes, TRIANGLES, TABLE)?;
    let codes = stream.take(count / 3)?;
    let mut decoder =
        Triangles { stream, next: 0, last: 0, edges: Recent::new(), seen: Recent::new() };
    let mut indices = Vec::with_capacity(count);
    for &code in codes {
        indices.extend(decoder.triangle(code, table)?);
    }
    decoder.stream.end()?;
    Ok(indices)
}

/// Any others, `count` of them.
pub fn indices(bytes: &[u8], count: usize) -> Result<Vec<u32>, Broken> {
    let (mut stream, _) = Stream::between(bytes, INDICES, RESERVED)?;
    let mut last = [0_u32; 2];
    let mut indices = Vec::with_capacity(count);
    for _ in 0..count {
        let code = stream.integer()?;
        let last = &mut last[(code & 1) as usize];
        *last = last.wrapping_add(signed(code >> 1));
        indices.push(*last);
    }
    stream.end()?;
    Ok(indices)
}

/// The last 16 of something.
struct Recent<T> {
    ring: [T; 16],
    end: usize,
}

impl<T: Copy + Default> Recent<T> {
    fn new() -> Self {
        Self { ring: [T::default(); 16], end: 0 }
    }

    fn push(&mut self, element: T) {
        self.ring[self.end] = element;
        self.end = (self.end + 1) % 16;
    }

    /// The one that was pushed this many before the last.
    fn get(&self, before: u8) -> T {
        self.ring[(self.end + 15 - usize::from(before)) % 16]
    }
}

/// What the triangles so far leave for the next one.
struct Triangles<'a> {
    stream: Stream<'a>,
    /// The next vertex that has not been seen.
    next: u32,
    /// The last vertex that was given by its number.
    last: u32,
    edges: Recent<[u32; 2]>,
    seen: Recent<u32>,
}

impl Triangles<'_> {
    fn triangle(&mut self, code: u8, table: &[u8]) -> Result<[u32; 3], Broken> {
        let (high, low) = (code >> 4, code & 15);
        if high < 15 {
            return self.beside(high, low);
        }
        if low < 14 {
            let pair = table[usize::from(low)];
            let a = self.fresh();
            return self.apart(a, true, pair);
        }
        let pair = self.stream.byte()?;
        if pair == 0 {
            self.next = 0;
        }
        let a = if low == 14 { self.fresh() } else { self.numbered()? };
        self.apart(a, false, pair)
    }

    /// One at an edge.
    fn beside(&mut self, edge: u8, third: u8) -> Result<[u32; 3], Broken> {
        let [a, b] = self.edges.get(edge);
        let c = match third {
            0 => self.fresh(),
            13 | 14 => {
                self.last =
                    if third == 13 { self.last.wrapping_sub(1) } else { self.last.wrapping_add(1) };
                self.last
            }
            15 => self.numbered()?,
            _ => self.seen.get(third),
        };
        if third == 0 || third > 12 {
            self.seen.push(c);
        }
        self.edges.push([c, b]);
        self.edges.push([a, c]);
        Ok([a, b, c])
    }

    /// One that begins with `a`; what the other two are is a half of `pair` each. In the table there
    /// are no numbers.
    fn apart(&mut self, a: u32, in_table: bool, pair: u8) -> Result<[u32; 3], Broken> {
        let (high, low) = (pair >> 4, pair & 15);
        if in_table && (high == 15 || low == 15) {
            return Err(Broken::Table);
        }
        let mut other = |half: u8| match half {
            0 => Ok(self.fresh()),
            15 => self.numbered(),
            _ => Ok(self.seen.get(half - 1)),
        };
        let (b, c) = (other(high)?, other(low)?);
        self.edges.push([b, a]);
        self.edges.push([c, b]);
        self.edges.push([a, c]);
        self.seen.push(a);
        for (half, vertex) in [(high, b), (low, c)] {
            if half == 0 || half == 15 {
                self.seen.push(vertex);
            }
        }
        Ok([a, b, c])
    }

    fn fresh(&mut self) -> u32 {
        let vertex = self.next;
        self.next = self.next.wrapping_add(1);
        vertex
    }

    fn numbered(&mut self) -> Result<u32, Broken> {
        self.last = self.last.wrapping_add(signed(self.stream.integer()?));
        Ok(self.last)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// One triangle of each kind of code, worked out by the specification.
    #[test]
    fn every_code_makes_its_triangle() {
        let stream = [
            vec![0xe1],
            // Three new; at an edge: a new one, a recent one, a number, the one before, behind it.
            vec![0xf0, 0x10, 0x03, 0x0f, 0x0d, 0x0e, 0xfe, 0xff, 0xf1],
            // + 10 | a number, - 1, and a recent one | from 0 on: + 2 | -
            vec![20, 0xf1, 1, 0, 4],
            vec![0, 0x20, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0],
        ]
        .concat();
        let expected = [
            [0, 1, 2],
            [2, 1, 3],
            [2, 3, 0],
            [2, 0, 10],
            [2, 10, 9],
            [2, 9, 10],
            [4, 9, 10],
            [11, 0, 1],
            [2, 0, 3],
        ];
        assert_eq!(triangles(&stream, 27).unwrap(), expected.concat());
        let cut = [&stream[..14], &stream[15..]].concat();
        assert!(matches!(triangles(&cut, 27), Err(Broken::CutShort)));
        let longer = [&stream[..15], &[0], &stream[15..]].concat();
        assert!(matches!(triangles(&longer, 27), Err(Broken::TooLong(1))));
    }

    #[test]
    fn indices_follow_one_of_two_others() {
        // + 5, the other + 100, - 2, the other + 1.
        let stream = [0xd1, 20, 0x91, 0x03, 6, 5, 0, 0, 0, 0];
        assert_eq!(indices(&stream, 4).unwrap(), [5, 100, 3, 101]);
        assert!(matches!(indices(&stream, 5), Err(Broken::CutShort)));
        let endless = [0xd1, 0xff, 0xff, 0xff, 0xff, 0xff, 0, 0, 0, 0, 0];
        assert!(matches!(indices(&endless, 1), Err(Broken::Integer)));
    }
}
