//! Inputs made of others.

use fastrand::Rng;

/// The most bytes of an input.
pub const LONGEST: usize = 1 << 16;

/// Numbers at the edges of what programs take.
const NUMBERS: [&str; 24] = [
    "0",
    "-0",
    "1",
    "-1",
    "2",
    "3",
    "7",
    "255",
    "256",
    "65535",
    "65536",
    "2147483647",
    "2147483648",
    "-2147483648",
    "4294967295",
    "4294967296",
    "9223372036854775807",
    "18446744073709551616",
    "1e-45",
    "1e38",
    "1e39",
    "-1e300",
    "nan",
    "-inf",
];
/// The same for binary formats.
const INTEGERS: [u32; 14] = [
    0,
    1,
    2,
    3,
    0x7f,
    0x80,
    0xff,
    0x100,
    0x7fff,
    0xffff,
    0x1_0000,
    0x7fff_ffff,
    0x8000_0000,
    0xffff_ffff,
];

/// Makes inputs.
pub struct Mutator<'a> {
    seeds: &'a [Vec<u8>],
    words: &'a [&'a str],
    seed: u64,
    input: Vec<u8>,
}

impl<'a> Mutator<'a> {
    /// Makes inputs of `seeds` and `words`; all follow from `seed`.
    pub fn new(seeds: &'a [Vec<u8>], words: &'a [&'a str], seed: u64) -> Self {
        Self { seeds, words, seed, input: Vec::new() }
    }

    /// The input of that number.
    pub fn input(&mut self, number: u64) -> &mut [u8] {
        // Numbers that lie together must not make random numbers that do.
        let mut rng = Rng::with_seed(number.wrapping_mul(0x9e37_79b9_7f4a_7c15) ^ self.seed);
        self.input.clear();
        self.input.extend_from_slice(&self.seeds[rng.usize(..self.seeds.len())]);
        // Mostly few changes: what is wrong in many places is refused at the first.
        let changes = 1 << rng.u32(..5);
        for _ in 0..rng.u32(1..=changes) {
            self.change(&mut rng);
        }
        self.input.truncate(LONGEST);
        &mut self.input
    }

    fn change(&mut self, rng: &mut Rng) {
        let length = self.input.len();
        let at = rng.usize(..=length);
        let scale = 1 << rng.u32(..8);
        let end = length.min(at + rng.usize(..scale));
        let random = rng.u32(..);
        match rng.u32(..14) {
            0 => self.set(at, |byte| byte ^ (1 << (random % 8))),
            1 => self.set(at, |_| random as u8),
            2 => drop(self.input.drain(at..end)),
            3 => self.insert(at, self.input[at..end].to_vec()),
            4 => self.insert(at, random.to_le_bytes()[..1 + random as usize % 4].to_vec()),
            5 => {
                let other = &self.seeds[rng.usize(..self.seeds.len())];
                let from = rng.usize(..=other.len());
                let to = other.len().min(from + rng.usize(..256));
                self.insert(at, other[from..to].to_vec());
            }
            6 | 7 => self.word(rng, at),
            8 | 9 => self.number(rng, at),
            10 => self.integer(rng, at),
            11 => self.swap_lines(rng),
            12 => self.repeat(rng, at, end),
            _ => self.input.truncate(at.max(length / 2)),
        }
    }

    fn set(&mut self, at: usize, change: impl Fn(u8) -> u8) {
        if let Some(byte) = self.input.get_mut(at) {
            *byte = change(*byte);
        }
    }

    fn insert(&mut self, at: usize, bytes: Vec<u8>) {
        if self.input.len() + bytes.len() <= LONGEST {
            self.input.splice(at..at, bytes);
        }
    }

    /// A word of the format, in place of one or before it.
    fn word(&mut self, rng: &mut Rng, at: usize) {
        if self.words.is_empty() {
            return;
        }
        let word = self.words[rng.usize(..self.words.len())].as_bytes().to_vec();
        let end = if rng.bool() { self.end_of(at, |byte| !byte.is_ascii_whitespace()) } else { at };
        self.input.splice(at..end, word);
    }

    /// Another number in place of the first one behind `at`.
    fn number(&mut self, rng: &mut Rng, at: usize) {
        let is_digit = |byte: u8| byte.is_ascii_digit() || matches!(byte, b'.' | b'-' | b'e');
        let start = self.end_of(at, |byte| !is_digit(byte));
        let end = self.end_of(start, is_digit);
        let number = match rng.u32(..4) {
            0 => (rng.f64() * 10.0 - 5.0).to_string(),
            1 => rng.i32(-9..10).to_string(),
            _ => NUMBERS[rng.usize(..NUMBERS.len())].to_owned(),
        };
        self.input.splice(start..end, number.into_bytes());
    }

    /// Another integer in four bytes.
    fn integer(&mut self, rng: &mut Rng, at: usize) {
        let integer = INTEGERS[rng.usize(..INTEGERS.len())];
        let bytes = if rng.bool() { integer.to_le_bytes() } else { integer.to_be_bytes() };
        for (byte, new) in self.input.iter_mut().skip(at).zip(bytes) {
            *byte = new;
        }
    }

    fn swap_lines(&mut self, rng: &mut Rng) {
        let mut lines: Vec<&[u8]> = self.input.split_inclusive(|&byte| byte == b'\n').collect();
        if lines.len() > 1 {
            let (a, b) = (rng.usize(..lines.len()), rng.usize(..lines.len()));
            lines.swap(a, b);
            self.input = lines.concat();
        }
    }

    /// A piece many times.
    fn repeat(&mut self, rng: &mut Rng, at: usize, end: usize) {
        let most = (LONGEST - self.input.len().min(LONGEST)) / (end - at).max(1);
        let scale = 1 << rng.u32(..10);
        let times = rng.usize(..scale).min(most);
        self.insert(at, self.input[at..end].repeat(times));
    }

    /// The first place from `at` on where something else stands.
    fn end_of(&self, at: usize, is: impl Fn(u8) -> bool) -> usize {
        let rest = self.input[at..].iter();
        at + rest.take_while(|&&byte| is(byte)).count()
    }
}
