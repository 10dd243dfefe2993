//! Structs that lie in memory as structures of arrays, 16 bytes wide.
//!
//! Lanes of a workgroup that each load the same field of neighbouring structs should read
//! neighbouring words, and as many at once as the device can: four. So a struct that many lanes
//! keep is cut into **rows** of a `UVec4`, a vector and a word each, and row `r` of struct `i` of a
//! table of `n` is element `r * n + i`. `soa!` declares such a struct and makes its loads and
//! stores.

/// A word of a row.
pub trait Word {
    /// Its bits.
    fn to_word(self) -> u32;
    /// From its bits.
    fn from_word(word: u32) -> Self;
}

impl Word for u32 {
    fn to_word(self) -> u32 {
        self
    }

    fn from_word(word: u32) -> Self {
        word
    }
}

impl Word for f32 {
    fn to_word(self) -> u32 {
        self.to_bits()
    }

    fn from_word(word: u32) -> Self {
        Self::from_bits(word)
    }
}

/// Where the rows of one struct lie in a buffer of `UVec4`s.
#[derive(Clone, Copy)]
pub struct Place {
    /// Element of its first row.
    pub first: u32,
    /// Elements from a row to the next: the number of structs in the table.
    pub stride: u32,
}

impl Place {
    /// The element of the first row; from then on the place begins at the next.
    pub fn next_row(&mut self) -> u32 {
        let element = self.first;
        self.first += self.stride;
        element
    }
}

/// Declares a struct as rows, each `vector: Vec3, word: u32 or f32;`, with
///
/// - `ROWS`, their number;
/// - `load(&Scatter<UVec4>, Place) -> Self` and `store(self, &mut Scatter<UVec4>, Place)`.
macro_rules! soa {
    (
        $(#[$doc:meta])*
        $visibility:vis struct $name:ident {
            $($(#[$vector_doc:meta])* $vector:ident: Vec3, $(#[$word_doc:meta])* $word:ident: $Word:ty;)*
        }
    ) => {
        $(#[$doc])*
        #[derive(Clone, Copy)]
        $visibility struct $name {
            $($(#[$vector_doc])* pub $vector: $crate::glam::Vec3, $(#[$word_doc])* pub $word: $Word,)*
        }

        impl $name {
            /// Rows of one.
            pub const ROWS: u32 = [$(stringify!($vector)),*].len() as u32;

            /// Reads the one at `place`.
            pub fn load(rows: &$crate::memory::access::Scatter<'_, $crate::glam::UVec4>, place: $crate::memory::soa::Place) -> Self {
                let mut place = place;
                $(
                    let row = rows.get(place.next_row());
                    let $vector = $crate::memory::rows::vector(row);
                    let $word = <$Word as $crate::memory::soa::Word>::from_word(row.w);
                )*
                Self { $($vector, $word),* }
            }

            /// Replaces the one at `place`.
            pub fn store(self, rows: &mut $crate::memory::access::Scatter<'_, $crate::glam::UVec4>, place: $crate::memory::soa::Place) {
                let mut place = place;
                $(
                    let word = $crate::memory::soa::Word::to_word(self.$word);
                    rows.set(place.next_row(), $crate::memory::rows::row(self.$vector, word));
                )*
            }
        }
    };
}
pub(crate) use soa;
