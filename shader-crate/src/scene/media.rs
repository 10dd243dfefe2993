//! What light is in on its way: the bodies around a point, and which of them is there.
//!
//! Where bodies overlap, the one of the highest priority is there and hides the others: a glass has
//! a higher priority than the water in it, whose surface may then lie anywhere within the wall.
//! Boundaries of what is hidden are passed as if they were not there (Schmidt and Budge, "Simple
//! Nested Dielectrics in Ray Traced Images", Journal of Graphics Tools 7(2), 2002). Between a body
//! without a priority and any other, the one that was entered last is there.
//!
//! Bodies that touch are told apart from those that are a hair's breadth away by the distance that
//! rays start off surfaces: boundaries within it are crossed together, and are one interface
//! between what is before them and what is behind.
//!
//! A body has a number, from 1. Those with a priority are numbered by it, above all others.
//!
//! ```text
//! header: bodies, what the camera is in, rows to the words of lights, 0
//! bodies: absorption xyz, 0
//! interfaces, for each body with nothing and with each other one:
//!         index of refraction of the body relative to the other, rows to its albedos, 0, 0
//! words, four to a row, of materials:
//!         number of the body | what it does not pass in a list, 8 bits further; 0 for no body
//! words, four to a row, of lights: what their front is in
//! ```

use crate::glam::{UVec4, Vec3};
use crate::math::elementary::exp;
use crate::memory::access::at;
use crate::memory::rows::{vector, word};

/// [`MediaView::first`] of a scene whose bodies are known by nothing but their boundaries.
pub const NO_MEDIA: u32 = u32::MAX;

/// Bodies that a scene may have, at most.
pub const MOST_BODIES: u32 = 255;

/// The end of numbers that a body may not pass in a list, see [`Body::stays_below`].
pub const PASSES_ALL: u32 = MOST_BODIES;

/// Logarithm of a share that is 0 in an f32: light that goes on for ever in what absorbs it.
const FAINTEST: f32 = -200.0;

/// The bodies that a point is in, four at most: a byte for the number of each, the lowest that of
/// the one that is there.
#[cfg_attr(not(target_arch = "spirv"), derive(Debug, PartialEq, Eq))]
#[derive(Clone, Copy)]
pub struct Media(pub u32);

/// A body, as its boundary knows it.
#[derive(Clone, Copy)]
pub struct Body {
    /// Its number; 0 for none.
    pub number: u32,
    /// It comes below those in a list whose numbers are above this: those of a higher priority.
    pub stays_below: u32,
}

impl Body {
    /// None.
    pub const NONE: Self = Self { number: 0, stays_below: 0 };

    /// The body in a word of the table.
    pub fn from_word(word: u32) -> Self {
        Self { number: word & 0xff, stays_below: word >> 8 & 0xff }
    }

    /// The word of a body.
    pub fn to_word(self) -> u32 {
        self.number | self.stays_below << 8
    }

    /// Whether there is one.
    pub fn is_some(&self) -> bool {
        self.number != 0
    }
}

impl Media {
    /// In no body.
    pub const NONE: Self = Self(0);

    /// The number of the body that is there, or 0.
    pub fn there(self) -> u32 {
        self.0 & 0xff
    }

    /// Whether `body` is among them.
    pub fn contains(self, body: Body) -> bool {
        self.place_of(body) < u32::BITS
    }

    /// Behind the front of `body`. Of more than four the one that is hidden most is forgotten.
    pub fn entered(self, body: Body) -> Self {
        let mut place = 0;
        while place < u32::BITS && (self.0 >> place & 0xff) > body.stays_below {
            place += 8;
        }
        if place >= u32::BITS {
            return self;
        }
        let above = (1 << place) - 1;
        Self(self.0 & above | body.number << place | (self.0 & !above) << 8)
    }

    /// Before the front of `body`; the same where it is not among them.
    pub fn left(self, body: Body) -> Self {
        let place = self.place_of(body);
        if place >= u32::BITS {
            return self;
        }
        let above = (1 << place) - 1;
        Self(self.0 & above | self.0 >> 8 & !above)
    }

    /// Where the bits of a body begin; beyond all bits if it is not there.
    fn place_of(self, body: Body) -> u32 {
        let mut place = 0;
        while place < u32::BITS && (self.0 >> place & 0xff) != body.number {
            place += 8;
        }
        place
    }
}

/// What is on the two sides of a surface.
#[derive(Clone, Copy)]
pub struct Sides {
    /// On the side that a ray came from.
    pub here: Media,
    /// On the other; the same where the surface is not the boundary of a body.
    pub beyond: Media,
}

impl Sides {
    /// The same on both.
    pub fn both(media: Media) -> Self {
        Self { here: media, beyond: media }
    }

    /// After the boundary of `body`, seen `from_front`. A body that is left without having been
    /// entered, since the path began in it, or since it is one of too many, was there all along.
    pub fn crossed(self, body: Body, from_front: bool) -> Self {
        if from_front {
            return Self { beyond: self.beyond.entered(body), ..self };
        }
        if self.beyond.contains(body) {
            return Self { beyond: self.beyond.left(body), ..self };
        }
        Self { here: self.here.entered(body), ..self }
    }

    /// Whether another body is there beyond than here.
    pub fn differ(&self) -> bool {
        self.here.there() != self.beyond.there()
    }
}

/// How a body is bounded where it meets another, or none.
#[derive(Clone, Copy)]
pub struct Interface {
    /// Index of refraction of the body relative to the other.
    pub ior: f32,
    /// See [`Layers::boundary_albedos`](crate::scene::bsdf::layers::Layers::boundary_albedos).
    pub albedos: u32,
}

/// The bodies of a scene.
#[derive(Clone, Copy)]
pub struct MediaView<'a> {
    /// The scene's buffer `surfaces`, see [`crate::scene`].
    pub rows: &'a [UVec4],
    /// Row of the header, or [`NO_MEDIA`].
    pub first: u32,
}

impl MediaView<'_> {
    /// Whether paths know what they are in.
    pub fn is_some(&self) -> bool {
        self.first != NO_MEDIA
    }

    fn header(&self) -> UVec4 {
        at(self.rows, self.first)
    }

    /// What the camera is in.
    pub fn of_camera(&self) -> Media {
        Media(self.header().y)
    }

    /// What the front of the light number `index` is in.
    pub fn of_light(&self, index: u32) -> Media {
        Media(word(self.rows, self.first + self.header().z, index))
    }

    /// The body behind the fronts of the material number `index`.
    pub fn body(&self, index: u32) -> Body {
        let bodies = self.header().x;
        Body::from_word(word(self.rows, self.first + (bodies + 1) * (bodies + 1), index))
    }

    /// The interface between the body of this number and another, or none if that is 0.
    pub fn interface(&self, body: u32, other: u32) -> Interface {
        let bodies = self.header().x;
        let row = at(self.rows, self.first + body * (bodies + 1) + other);
        Interface { ior: f32::from_bits(row.x), albedos: row.y }
    }

    /// The share of light that is left after this `distance` through what is there, in world units,
    /// by Beer's law.
    pub fn transmittance(&self, media: Media, distance: f32) -> Vec3 {
        if media.there() == 0 {
            return Vec3::ONE;
        }
        let absorption = vector(at(self.rows, self.first + media.there()));
        let lost = (absorption * -distance).max(Vec3::splat(FAINTEST));
        Vec3::new(exp(lost.x), exp(lost.y), exp(lost.z))
    }
}
