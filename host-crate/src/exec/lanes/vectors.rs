//! Vectors of `N` paths side by side, as [`glam::Vec3`] computes with one.

use super::numbers::{Floats, Mask, Words, floats};
use glam::{UVec4, Vec3};
use std::ops::{Add, Div, Mul, Neg, Sub};

/// A vector of each lane.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Vectors<const N: usize> {
    /// The first components.
    pub x: Floats<N>,
    /// The second ones.
    pub y: Floats<N>,
    /// The third ones.
    pub z: Floats<N>,
}

/// An operator by components.
macro_rules! operators {
    ($($Operator:ident $operator:ident $sign:tt $Other:ty, $other:ident => [$($by:tt)*];)*) => {$(
        impl<const N: usize> $Operator<$Other> for Vectors<N> {
            type Output = Self;

            #[inline(always)]
            fn $operator(self, $other: $Other) -> Self {
                let [x, y, z] = $($by)*;
                Self { x: self.x $sign x, y: self.y $sign y, z: self.z $sign z }
            }
        }
    )*};
}

operators! {
    Add add + Self, other => [[other.x, other.y, other.z]];
    Sub sub - Self, other => [[other.x, other.y, other.z]];
    Mul mul * Self, other => [[other.x, other.y, other.z]];
    Mul mul * Floats<N>, factor => [[factor; 3]];
    Div div / Floats<N>, divisor => [[divisor; 3]];
}

impl<const N: usize> Neg for Vectors<N> {
    type Output = Self;

    #[inline(always)]
    fn neg(self) -> Self {
        Self { x: -self.x, y: -self.y, z: -self.z }
    }
}

impl<const N: usize> Vectors<N> {
    /// The same vector in all lanes.
    #[inline(always)]
    pub fn splat(vector: Vec3) -> Self {
        let Vec3 { x, y, z } = vector;
        Self { x: Floats::splat(x), y: Floats::splat(y), z: Floats::splat(z) }
    }

    /// The vector of a lane.
    #[inline(always)]
    pub fn get(&self, lane: usize) -> Vec3 {
        Vec3::new(self.x.0[lane], self.y.0[lane], self.z.0[lane])
    }

    /// Replaces the vector of a lane.
    #[inline(always)]
    pub fn set(&mut self, lane: usize, vector: Vec3) {
        [self.x.0[lane], self.y.0[lane], self.z.0[lane]] = vector.to_array();
    }

    /// [`Vec3::dot`].
    #[inline(always)]
    pub fn dot(self, other: Self) -> Floats<N> {
        self.x * other.x + self.y * other.y + self.z * other.z
    }

    /// [`Vec3::normalize`].
    #[inline(always)]
    pub fn normalize(self) -> Self {
        self * (Floats::splat(1.0) / self.dot(self).sqrt())
    }

    /// [`Vec3::max_element`].
    #[inline(always)]
    pub fn max_element(self) -> Floats<N> {
        let larger = |a: Floats<N>, b: Floats<N>| {
            floats(|lane| if a.0[lane] > b.0[lane] { a.0[lane] } else { b.0[lane] })
        };
        larger(self.x, larger(self.y, self.z))
    }

    /// [`Vec3::max_element`] of [`Vec3::abs`].
    #[inline(always)]
    pub fn magnitude(self) -> Floats<N> {
        Self { x: self.x.abs(), y: self.y.abs(), z: self.z.abs() }.max_element()
    }
}

impl<const N: usize> Mask<N> {
    /// The first vector in lanes that it holds for, else the other.
    #[inline(always)]
    pub fn choose_vectors(self, first: Vectors<N>, other: Vectors<N>) -> Vectors<N> {
        Vectors {
            x: self.choose(first.x, other.x),
            y: self.choose(first.y, other.y),
            z: self.choose(first.z, other.z),
        }
    }
}

/// A row of a buffer for each lane.
pub struct Rows<const N: usize>(pub [Words<N>; 4]);

impl<const N: usize> Rows<N> {
    /// Those that lie `offset` rows behind the `first` of each lane.
    #[inline(always)]
    pub fn of(rows: &[UVec4], first: &Words<N>, offset: u32) -> Self {
        let [mut a, mut b, mut c, mut d] = [[0; N]; 4];
        for lane in 0..N {
            let row = rows[(first.0[lane] + offset) as usize];
            [a[lane], b[lane], c[lane], d[lane]] = row.to_array();
        }
        Self([Words(a), Words(b), Words(c), Words(d)])
    }

    /// [`raystream_shaders::memory::rows::vector`].
    #[inline(always)]
    pub fn vectors(&self) -> Vectors<N> {
        let [x, y, z, _] = &self.0;
        Vectors { x: x.to_floats(), y: y.to_floats(), z: z.to_floats() }
    }

    /// The last words.
    #[inline(always)]
    pub fn words(&self) -> Words<N> {
        self.0[3]
    }

    /// [`raystream_shaders::memory::rows::float`].
    #[inline(always)]
    pub fn floats(&self) -> Floats<N> {
        self.0[3].to_floats()
    }
}
