//! Numbers side by side, in the registers of a processor.
//!
//! A value of such a type exists only where the processor has the instructions: a [`Simd`] that
//! names them is made by asking the processor, and every value is made from its proof or from
//! another value. So arithmetic on them is safe. It is that of the scalar code, operation by
//! operation, and so has the same bits.

use crate::glam::{BVec4A, Vec4};
#[cfg(target_arch = "x86_64")]
use core::arch::x86_64::{
    __m256, __m512, __mmask16, _CMP_LE_OQ, _CMP_LT_OQ, _mm256_add_ps, _mm256_and_ps, _mm256_cmp_ps,
    _mm256_div_ps, _mm256_max_ps, _mm256_min_ps, _mm256_movemask_ps, _mm256_mul_ps, _mm256_set1_ps,
    _mm256_sub_ps, _mm512_add_ps, _mm512_cmp_ps_mask, _mm512_div_ps, _mm512_max_ps, _mm512_min_ps,
    _mm512_mul_ps, _mm512_set1_ps, _mm512_sub_ps,
};
use core::ops::{Add, BitAnd, Div, Mul, Sub};

/// What the CPU's traversal is compiled for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Simd {
    /// Registers of 128 bits, which every processor has: SSE2, NEON, or what there is instead.
    Simd128(Baseline),
    /// Registers of 256 bits.
    #[cfg(target_arch = "x86_64")]
    Avx2(Avx2),
    /// Registers of 512 bits.
    #[cfg(target_arch = "x86_64")]
    Avx512(Avx512),
}

/// Needs no proof.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Baseline;

/// Proof that the processor has AVX2.
#[cfg(target_arch = "x86_64")]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Avx2(());

/// Proof that the processor has AVX-512 (F, VL) and AVX2.
#[cfg(target_arch = "x86_64")]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Avx512(Avx2);

impl Simd {
    /// All that this processor has, the widest last.
    pub fn all() -> impl DoubleEndedIterator<Item = Self> {
        let baseline = [Some(Self::Simd128(Baseline))];
        #[cfg(target_arch = "x86_64")]
        let wider = {
            let avx2 = Avx2::detect();
            [avx2.map(Self::Avx2), avx2.and_then(Avx512::detect).map(Self::Avx512)]
        };
        #[cfg(not(target_arch = "x86_64"))]
        let wider = [];
        baseline.into_iter().chain(wider).flatten()
    }

    /// The widest that this processor has.
    pub fn widest() -> Self {
        Self::all().next_back().unwrap_or(Self::Simd128(Baseline))
    }

    /// What to call it: `simd128`, `avx2`, `avx512`.
    pub fn name(self) -> &'static str {
        match self {
            Self::Simd128(_) => "simd128",
            #[cfg(target_arch = "x86_64")]
            Self::Avx2(_) => "avx2",
            #[cfg(target_arch = "x86_64")]
            Self::Avx512(_) => "avx512",
        }
    }
}

#[cfg(target_arch = "x86_64")]
impl Avx2 {
    fn detect() -> Option<Self> {
        use std::arch::is_x86_feature_detected;
        let has_them = is_x86_feature_detected!("avx2")
            && is_x86_feature_detected!("bmi1")
            && is_x86_feature_detected!("bmi2")
            && is_x86_feature_detected!("lzcnt")
            && is_x86_feature_detected!("popcnt");
        has_them.then_some(Self(()))
    }
}

#[cfg(target_arch = "x86_64")]
impl Avx512 {
    fn detect(avx2: Avx2) -> Option<Self> {
        use std::arch::is_x86_feature_detected;
        let has_them = is_x86_feature_detected!("avx512f") && is_x86_feature_detected!("avx512vl");
        has_them.then_some(Self(avx2))
    }

    /// AVX2 is part of it.
    pub fn avx2(self) -> Avx2 {
        self.0
    }
}

/// `N` numbers.
pub trait Lanes<const N: usize>:
    Copy + Add<Output = Self> + Sub<Output = Self> + Mul<Output = Self> + Div<Output = Self>
{
    /// That the processor has what they need.
    type Proof: Copy;
    /// Which of them a comparison holds for.
    type Mask: Copy + BitAnd<Output = Self::Mask>;

    /// All of them `x`.
    fn splat(proof: Self::Proof, x: f32) -> Self;
    /// These numbers.
    fn load(proof: Self::Proof, numbers: &[f32; N]) -> Self;
    /// They, one by one.
    fn to_array(self) -> [f32; N];
    /// The smaller of each two, neither of which is NaN.
    fn min(self, other: Self) -> Self;
    /// The larger of each two, neither of which is NaN.
    fn max(self, other: Self) -> Self;
    /// Which are not above those of `other`.
    fn le(self, other: Self) -> Self::Mask;
    /// Which are below those of `other`.
    fn lt(self, other: Self) -> Self::Mask;
    /// A bit for each of them, that of the first lowest.
    fn bits(mask: Self::Mask) -> u32;
}

/// Eight numbers in two registers of 128 bits.
#[derive(Clone, Copy)]
pub struct Two128([Vec4; 2]);

/// Which of eight a comparison holds for.
#[derive(Clone, Copy)]
pub struct TwoMasks([BVec4A; 2]);

impl BitAnd for TwoMasks {
    type Output = Self;

    #[inline(always)]
    fn bitand(self, Self([c, d]): Self) -> Self {
        let Self([a, b]) = self;
        Self([a & c, b & d])
    }
}

impl Two128 {
    #[inline(always)]
    fn zip(self, Self([c, d]): Self, combine: impl Fn(Vec4, Vec4) -> Vec4) -> Self {
        let Self([a, b]) = self;
        Self([combine(a, c), combine(b, d)])
    }
}

macro_rules! operators {
    ($Lanes:ident { $($Operator:ident $operator:ident = |$a:ident, $b:ident| $result:expr;)* }) => {
        $(
            impl $Operator for $Lanes {
                type Output = Self;

                #[inline(always)]
                fn $operator(self, other: Self) -> Self {
                    let ($a, $b) = (self, other);
                    $result
                }
            }
        )*
    };
}

operators! {
    Two128 {
        Add add = |a, b| a.zip(b, Vec4::add);
        Sub sub = |a, b| a.zip(b, Vec4::sub);
        Mul mul = |a, b| a.zip(b, Vec4::mul);
        Div div = |a, b| a.zip(b, Vec4::div);
    }
}

impl Lanes<8> for Two128 {
    type Proof = Baseline;
    type Mask = TwoMasks;

    #[inline(always)]
    fn splat(_: Baseline, x: f32) -> Self {
        Self([Vec4::splat(x); 2])
    }

    #[inline(always)]
    fn load(_: Baseline, numbers: &[f32; 8]) -> Self {
        Self(bytemuck::must_cast(*numbers))
    }

    #[inline(always)]
    fn to_array(self) -> [f32; 8] {
        bytemuck::must_cast(self.0)
    }

    #[inline(always)]
    fn min(self, other: Self) -> Self {
        self.zip(other, Vec4::min)
    }

    #[inline(always)]
    fn max(self, other: Self) -> Self {
        self.zip(other, Vec4::max)
    }

    #[inline(always)]
    fn le(self, Self([c, d]): Self) -> TwoMasks {
        let Self([a, b]) = self;
        TwoMasks([a.cmple(c), b.cmple(d)])
    }

    #[inline(always)]
    fn lt(self, Self([c, d]): Self) -> TwoMasks {
        let Self([a, b]) = self;
        TwoMasks([a.cmplt(c), b.cmplt(d)])
    }

    #[inline(always)]
    fn bits(TwoMasks([a, b]): TwoMasks) -> u32 {
        a.bitmask() | b.bitmask() << 4
    }
}

/// Eight numbers in a register of 256 bits.
#[cfg(target_arch = "x86_64")]
#[derive(Clone, Copy)]
pub struct One256(__m256);

/// Sixteen numbers in a register of 512 bits.
#[cfg(target_arch = "x86_64")]
#[derive(Clone, Copy)]
pub struct One512(__m512);

#[cfg(target_arch = "x86_64")]
impl BitAnd for One256 {
    type Output = Self;

    #[inline(always)]
    fn bitand(self, other: Self) -> Self {
        // SAFETY: there is a value, so there is a proof that the processor has AVX.
        Self(unsafe { _mm256_and_ps(self.0, other.0) })
    }
}

/// The arithmetic of a type that wraps a register. Its safety is that of all of them: there is a
/// value or a proof of it, so the processor has the instructions.
#[cfg(target_arch = "x86_64")]
macro_rules! register {
    (
        $Lanes:ident of $N:literal, $Proof:ident, $Mask:ty {
            $add:ident $sub:ident $mul:ident $div:ident $min:ident $max:ident $splat:ident
            le = |$a:ident, $b:ident| $le:expr;
            lt = $lt:expr;
            bits = |$mask:ident| $bits:expr;
        }
    ) => {
        operators! {
            $Lanes {
                // SAFETY: see the macro.
                Add add = |a, b| Self(unsafe { $add(a.0, b.0) });
                // SAFETY: see the macro.
                Sub sub = |a, b| Self(unsafe { $sub(a.0, b.0) });
                // SAFETY: see the macro.
                Mul mul = |a, b| Self(unsafe { $mul(a.0, b.0) });
                // SAFETY: see the macro.
                Div div = |a, b| Self(unsafe { $div(a.0, b.0) });
            }
        }

        impl Lanes<$N> for $Lanes {
            type Proof = $Proof;
            type Mask = $Mask;

            #[inline(always)]
            fn splat(_: $Proof, x: f32) -> Self {
                // SAFETY: see the macro.
                Self(unsafe { $splat(x) })
            }

            #[inline(always)]
            fn load(_: $Proof, numbers: &[f32; $N]) -> Self {
                Self(bytemuck::must_cast(*numbers))
            }

            #[inline(always)]
            fn to_array(self) -> [f32; $N] {
                bytemuck::must_cast(self.0)
            }

            #[inline(always)]
            fn min(self, other: Self) -> Self {
                // SAFETY: see the macro.
                Self(unsafe { $min(self.0, other.0) })
            }

            #[inline(always)]
            fn max(self, other: Self) -> Self {
                // SAFETY: see the macro.
                Self(unsafe { $max(self.0, other.0) })
            }

            #[inline(always)]
            fn le(self, other: Self) -> $Mask {
                let ($a, $b) = (self.0, other.0);
                // SAFETY: see the macro.
                unsafe { $le }
            }

            #[inline(always)]
            fn lt(self, other: Self) -> $Mask {
                let ($a, $b) = (self.0, other.0);
                // SAFETY: see the macro.
                unsafe { $lt }
            }

            #[inline(always)]
            fn bits($mask: $Mask) -> u32 {
                $bits
            }
        }
    };
}

#[cfg(target_arch = "x86_64")]
register! {
    One256 of 8, Avx2, One256 {
        _mm256_add_ps _mm256_sub_ps _mm256_mul_ps _mm256_div_ps _mm256_min_ps _mm256_max_ps
        _mm256_set1_ps
        le = |a, b| One256(_mm256_cmp_ps::<_CMP_LE_OQ>(a, b));
        lt = One256(_mm256_cmp_ps::<_CMP_LT_OQ>(a, b));
        // SAFETY: see the macro.
        bits = |mask| unsafe { _mm256_movemask_ps(mask.0) as u32 };
    }
}

#[cfg(target_arch = "x86_64")]
register! {
    One512 of 16, Avx512, __mmask16 {
        _mm512_add_ps _mm512_sub_ps _mm512_mul_ps _mm512_div_ps _mm512_min_ps _mm512_max_ps
        _mm512_set1_ps
        le = |a, b| _mm512_cmp_ps_mask::<_CMP_LE_OQ>(a, b);
        lt = _mm512_cmp_ps_mask::<_CMP_LT_OQ>(a, b);
        bits = |mask| u32::from(mask);
    }
}
