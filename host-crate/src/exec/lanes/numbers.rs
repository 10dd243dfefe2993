//! Numbers of `N` paths side by side, a lane each.
//!
//! They are plain arrays, and an operation is a loop over the lanes, of which the compiler makes
//! the vector instructions of the function that it is inlined into. Each loop does what the scalar
//! code does with one number, so that the bits are the same.

use std::ops::{Add, BitAnd, BitXor, Div, Mul, Neg, Not, Shr, Sub};

/// A number of each lane.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Floats<const N: usize>(pub [f32; N]);

/// A word of each lane.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Words<const N: usize>(pub [u32; N]);

/// Which lanes something holds for: all bits of their words are set, else none.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Mask<const N: usize>(pub [u32; N]);

/// What a function makes of the number of each lane.
#[inline(always)]
pub fn floats<const N: usize>(number: impl Fn(usize) -> f32) -> Floats<N> {
    let mut all = [0.0; N];
    for (lane, x) in all.iter_mut().enumerate() {
        *x = number(lane);
    }
    Floats(all)
}

/// What a function makes of the number of each lane.
#[inline(always)]
pub fn words<const N: usize>(word: impl Fn(usize) -> u32) -> Words<N> {
    let mut all = [0; N];
    for (lane, x) in all.iter_mut().enumerate() {
        *x = word(lane);
    }
    Words(all)
}

/// Those lanes that something holds for.
#[inline(always)]
pub fn mask<const N: usize>(holds: impl Fn(usize) -> bool) -> Mask<N> {
    Mask(words(|lane| if holds(lane) { u32::MAX } else { 0 }).0)
}

/// An operator of two numbers, or of a number and one that is the same in all lanes.
macro_rules! operators {
    ($($Operator:ident $operator:ident $sign:tt;)*) => {$(
        impl<const N: usize> $Operator for Floats<N> {
            type Output = Self;

            #[inline(always)]
            fn $operator(self, other: Self) -> Self {
                floats(|lane| self.0[lane] $sign other.0[lane])
            }
        }

        impl<const N: usize> $Operator<f32> for Floats<N> {
            type Output = Self;

            #[inline(always)]
            fn $operator(self, other: f32) -> Self {
                floats(|lane| self.0[lane] $sign other)
            }
        }
    )*};
}

operators! {
    Add add +;
    Sub sub -;
    Mul mul *;
    Div div /;
}

impl<const N: usize> Neg for Floats<N> {
    type Output = Self;

    #[inline(always)]
    fn neg(self) -> Self {
        floats(|lane| -self.0[lane])
    }
}

impl<const N: usize> Floats<N> {
    /// The same number in all lanes.
    #[inline(always)]
    pub fn splat(number: f32) -> Self {
        Self([number; N])
    }

    /// The square root.
    #[inline(always)]
    pub fn sqrt(self) -> Self {
        floats(|lane| self.0[lane].sqrt())
    }

    /// The largest whole number that is not above it.
    #[inline(always)]
    pub fn floor(self) -> Self {
        floats(|lane| self.0[lane].floor())
    }

    /// The number without its sign.
    #[inline(always)]
    pub fn abs(self) -> Self {
        floats(|lane| self.0[lane].abs())
    }

    /// The larger one; the first where one is not a number.
    #[inline(always)]
    pub fn max(self, other: Self) -> Self {
        floats(|lane| if self.0[lane] < other.0[lane] { other.0[lane] } else { self.0[lane] })
    }

    /// The smaller one; the first where one is not a number.
    #[inline(always)]
    pub fn min(self, other: Self) -> Self {
        floats(|lane| if self.0[lane] > other.0[lane] { other.0[lane] } else { self.0[lane] })
    }

    /// Lanes whose number is below the other.
    #[inline(always)]
    pub fn below(self, other: Self) -> Mask<N> {
        mask(|lane| self.0[lane] < other.0[lane])
    }

    /// Lanes whose number is above the other.
    #[inline(always)]
    pub fn above(self, other: Self) -> Mask<N> {
        mask(|lane| self.0[lane] > other.0[lane])
    }

    /// Lanes whose number is this one.
    #[inline(always)]
    pub fn is(self, number: f32) -> Mask<N> {
        mask(|lane| self.0[lane] == number)
    }
}

impl<const N: usize> Words<N> {
    /// The same word in all lanes.
    #[inline(always)]
    pub fn splat(word: u32) -> Self {
        Self([word; N])
    }

    /// The sum modulo 2^32.
    #[inline(always)]
    pub fn plus(self, other: Self) -> Self {
        words(|lane| self.0[lane].wrapping_add(other.0[lane]))
    }

    /// The product modulo 2^32.
    #[inline(always)]
    pub fn times(self, other: Self) -> Self {
        words(|lane| self.0[lane].wrapping_mul(other.0[lane]))
    }

    /// The upper half of the product of 64 bits.
    #[inline(always)]
    pub fn times_high(self, other: u32) -> Self {
        words(|lane| ((u64::from(self.0[lane]) * u64::from(other)) >> u32::BITS) as u32)
    }

    /// The bits in reverse order.
    #[inline(always)]
    pub fn reversed(self) -> Self {
        words(|lane| self.0[lane].reverse_bits())
    }

    /// Lanes whose word is below the other.
    #[inline(always)]
    pub fn below(self, other: Self) -> Mask<N> {
        mask(|lane| self.0[lane] < other.0[lane])
    }

    /// Lanes whose word is this one.
    #[inline(always)]
    pub fn is(self, word: u32) -> Mask<N> {
        mask(|lane| self.0[lane] == word)
    }

    /// The words as bits of numbers.
    #[inline(always)]
    pub fn to_floats(self) -> Floats<N> {
        floats(|lane| f32::from_bits(self.0[lane]))
    }
}

impl<const N: usize> BitXor for Words<N> {
    type Output = Self;

    #[inline(always)]
    fn bitxor(self, other: Self) -> Self {
        words(|lane| self.0[lane] ^ other.0[lane])
    }
}

impl<const N: usize> BitAnd<u32> for Words<N> {
    type Output = Self;

    #[inline(always)]
    fn bitand(self, other: u32) -> Self {
        words(|lane| self.0[lane] & other)
    }
}

impl<const N: usize> Shr<u32> for Words<N> {
    type Output = Self;

    #[inline(always)]
    fn shr(self, bits: u32) -> Self {
        words(|lane| self.0[lane] >> bits)
    }
}

impl<const N: usize> BitAnd for Mask<N> {
    type Output = Self;

    #[inline(always)]
    fn bitand(self, other: Self) -> Self {
        Self(words(|lane| self.0[lane] & other.0[lane]).0)
    }
}

impl<const N: usize> Not for Mask<N> {
    type Output = Self;

    #[inline(always)]
    fn not(self) -> Self {
        Self(words(|lane| !self.0[lane]).0)
    }
}

impl<const N: usize> Mask<N> {
    /// No lane.
    pub const NONE: Self = Self([0; N]);

    /// Whether it holds for a lane.
    #[inline(always)]
    pub fn holds(&self, lane: usize) -> bool {
        self.0[lane] != 0
    }

    /// Whether it holds for any lane.
    #[inline(always)]
    pub fn any(self) -> bool {
        self.0.iter().fold(0, |some, word| some | word) != 0
    }

    /// The first number in lanes that it holds for, else the other.
    #[inline(always)]
    pub fn choose(self, first: Floats<N>, other: Floats<N>) -> Floats<N> {
        floats(|lane| if self.holds(lane) { first.0[lane] } else { other.0[lane] })
    }

    /// The first word in lanes that it holds for, else the other.
    #[inline(always)]
    pub fn choose_words(self, first: Words<N>, other: Words<N>) -> Words<N> {
        words(|lane| if self.holds(lane) { first.0[lane] } else { other.0[lane] })
    }

    /// 1 in lanes that it holds for, else 0.
    #[inline(always)]
    pub fn count(self) -> Words<N> {
        words(|lane| self.0[lane] & 1)
    }
}
