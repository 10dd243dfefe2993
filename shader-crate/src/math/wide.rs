//! Numbers of 64 bits as pairs of words: GPUs need not have larger ones.

/// A number of 64 bits.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Wide {
    /// The upper 32 bits.
    pub high: u32,
    /// The lower 32 bits.
    pub low: u32,
}

impl Wide {
    /// 0.
    pub const ZERO: Self = Self { high: 0, low: 0 };

    /// `self + other`, modulo 2^64.
    pub fn plus(self, other: Self) -> Self {
        let low = self.low.wrapping_add(other.low);
        let carry = (low < other.low) as u32;
        Self { high: self.high.wrapping_add(other.high).wrapping_add(carry), low }
    }

    /// `self - other`, modulo 2^64.
    pub fn minus(self, other: Self) -> Self {
        let borrow = (self.low < other.low) as u32;
        Self {
            high: self.high.wrapping_sub(other.high).wrapping_sub(borrow),
            low: self.low.wrapping_sub(other.low),
        }
    }

    /// Whether it is less than `other`.
    pub fn is_below(self, other: Self) -> bool {
        self.high < other.high || self.high == other.high && self.low < other.low
    }

    /// `self << shift`, modulo 2^64; zero from 64 on.
    pub fn shifted_left(self, shift: u32) -> Self {
        if shift == 0 {
            self
        } else if shift < 32 {
            Self { high: self.high << shift | self.low >> (32 - shift), low: self.low << shift }
        } else if shift < 64 {
            Self { high: self.low << (shift - 32), low: 0 }
        } else {
            Self::ZERO
        }
    }

    /// `self >> shift`; zero from 64 on.
    pub fn shifted_right(self, shift: u32) -> Self {
        if shift == 0 {
            self
        } else if shift < 32 {
            Self { high: self.high >> shift, low: self.low >> shift | self.high << (32 - shift) }
        } else if shift < 64 {
            Self { high: 0, low: self.high >> (shift - 32) }
        } else {
            Self::ZERO
        }
    }

    /// Number of bits without leading zeros.
    pub fn bits(self) -> u32 {
        if self.high > 0 { 64 - self.high.leading_zeros() } else { 32 - self.low.leading_zeros() }
    }
}

/// `a * b`.
pub fn multiply(a: u32, b: u32) -> Wide {
    let (a1, a0, b1, b0) = (a >> 16, a & 0xffff, b >> 16, b & 0xffff);
    let middle = a1 * b0 + ((a0 * b0) >> 16);
    let cross = (middle & 0xffff) + a0 * b1;
    Wide { high: a1 * b1 + (middle >> 16) + (cross >> 16), low: a.wrapping_mul(b) }
}

/// `a * a` of an `a` below 2^24.
pub fn square_of_24_bits(a: u32) -> Wide {
    let (high, low) = (a >> 12, a & 0xfff);
    let upper = high * high + ((2 * high * low + ((low * low) >> 12)) >> 12);
    Wide { high: upper >> 8, low: a.wrapping_mul(a) }
}

/// `a * b / c`, rounded down. `c > 0`, and the quotient must fit 32 bits, as it does where `a <=
/// c`.
pub fn multiply_divide(a: u32, b: u32, c: u32) -> u32 {
    divide(multiply(a, b), c)
}

/// `product / c`, rounded down; `c > product.high`.
pub fn divide(product: Wide, c: u32) -> u32 {
    // Long division, a bit at a time; the remainder stays below c, doubled it needs one bit more.
    let (mut remainder, mut quotient) = (product.high, 0_u32);
    let mut bit = 32;
    while bit > 0 {
        bit -= 1;
        let carry = remainder >> 31;
        remainder = remainder << 1 | (product.low >> bit & 1);
        quotient <<= 1;
        if carry == 1 || remainder >= c {
            remainder = remainder.wrapping_sub(c);
            quotient |= 1;
        }
    }
    quotient
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::random::hash;

    fn number(wide: Wide) -> u64 {
        u64::from(wide.high) << 32 | u64::from(wide.low)
    }

    fn wide(number: u64) -> Wide {
        Wide { high: (number >> 32) as u32, low: number as u32 }
    }

    #[test]
    fn arithmetic_is_that_of_u64() {
        let edges = [0, 1, 2, 0xffff, 0x1_0000, 0x7fff_ffff, 0x8000_0000, u32::MAX - 1, u32::MAX];
        // The edges, and numbers of all sizes.
        let word = |i: usize| edges.get(i).copied().unwrap_or_else(|| hash(i as u32) >> (i % 32));
        let count = 120;
        for (i, j) in (0..count).flat_map(|i| (0..count).map(move |j| (i, j))) {
            let (a, b) = (word(i), word(j));
            assert_eq!(number(multiply(a, b)), u64::from(a) * u64::from(b), "{a} * {b}");
            let (x, y) = (u64::from(a) << 32 | u64::from(b), u64::from(b) << 31 | u64::from(a));
            assert_eq!(number(wide(x).plus(wide(y))), x.wrapping_add(y));
            assert_eq!(number(wide(x).minus(wide(y))), x.wrapping_sub(y));
            assert_eq!(wide(x).is_below(wide(y)), x < y);
            assert_eq!(wide(x).bits(), 64 - x.leading_zeros());
            for shift in [0, 1, 31, 32, 33, 63, 64, 100] {
                assert_eq!(number(wide(x).shifted_right(shift)), x.checked_shr(shift).unwrap_or(0));
                assert_eq!(number(wide(x).shifted_left(shift)), x.checked_shl(shift).unwrap_or(0));
            }
            let c = word((i * 7 + j * 13) % count).max(1);
            if let Ok(expected) = u32::try_from(u64::from(a) * u64::from(b) / u64::from(c)) {
                assert_eq!(multiply_divide(a, b, c), expected, "{a} * {b} / {c}");
            }
        }
    }

    #[test]
    fn squares_are_those_of_u64() {
        let numbers = (0..4096).map(|k| hash(k) >> 8).chain([0, 1, 0xfff, 0x1000, 0xff_ffff]);
        for a in numbers {
            assert_eq!(number(square_of_24_bits(a)), u64::from(a) * u64::from(a), "{a}");
        }
    }

    #[test]
    fn the_product_is_that_of_64_bits() {
        for a in [0, 1, 0xffff, 0x1_0000, 0x8000_0001, 0xdead_beef, u32::MAX] {
            for b in [0, 1, 3, 0xffff, 0x1_0001, 0x7fff_ffff, u32::MAX] {
                assert_eq!(number(multiply(a, b)), u64::from(a) * u64::from(b), "{a} * {b}");
            }
        }
    }
}
