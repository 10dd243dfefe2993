//! The values of a scene file, checked as they are read.

use crate::scene::bounds;
use glam::{DVec3, Vec3};
use serde::de::{Error, MapAccess, Unexpected, Visitor, value};
use serde::{Deserialize, Deserializer};
use std::marker::PhantomData;

/// What is written as an object `{...}`; for structs alone, serde takes an array of the values as
/// well.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Object<T>(pub T);

impl<'de, T: Deserialize<'de>> Deserialize<'de> for Object<T> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct Keys<T>(PhantomData<T>);

        impl<'de, T: Deserialize<'de>> Visitor<'de> for Keys<T> {
            type Value = Object<T>;

            fn expecting(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
                f.write_str("an object {...}")
            }

            fn visit_map<A: MapAccess<'de>>(self, keys: A) -> Result<Object<T>, A::Error> {
                T::deserialize(value::MapAccessDeserializer::new(keys)).map(Object)
            }
        }

        deserializer.deserialize_map(Keys(PhantomData))
    }
}

/// An optional key; unlike serde's own `Option`, null does not stand for its absence.
pub(super) fn present<'de, D: Deserializer<'de>, T: Deserialize<'de>>(
    deserializer: D,
) -> Result<Option<T>, D::Error> {
    T::deserialize(deserializer).map(Some)
}

/// An integer; the error says what was `expected`.
pub(super) fn integer<'de, D: Deserializer<'de>>(
    deserializer: D,
    expected: &str,
) -> Result<i64, D::Error> {
    struct Integer<'a>(&'a str);

    impl Visitor<'_> for Integer<'_> {
        type Value = i64;

        fn expecting(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
            f.write_str(self.0)
        }

        fn visit_i64<E: Error>(self, value: i64) -> Result<i64, E> {
            Ok(value)
        }

        fn visit_u64<E: Error>(self, value: u64) -> Result<i64, E> {
            i64::try_from(value).map_err(|_| E::invalid_value(Unexpected::Unsigned(value), &self))
        }
    }

    deserializer.deserialize_i64(Integer(expected))
}

/// A number of any kind.
#[derive(Clone, Copy, Debug)]
pub(super) struct Number(pub f64);

impl<'de> Deserialize<'de> for Number {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct AnyNumber;

        impl Visitor<'_> for AnyNumber {
            type Value = Number;

            fn expecting(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
                f.write_str("a number")
            }

            fn visit_f64<E: Error>(self, value: f64) -> Result<Number, E> {
                Ok(Number(value))
            }

            fn visit_i64<E: Error>(self, value: i64) -> Result<Number, E> {
                Ok(Number(value as f64))
            }

            fn visit_u64<E: Error>(self, value: u64) -> Result<Number, E> {
                Ok(Number(value as f64))
            }
        }

        deserializer.deserialize_f64(AnyNumber)
    }
}

impl Number {
    /// As a function wants it that checks it.
    fn plain(&self) -> f64 {
        self.0
    }
}

/// Numbers of any kind.
#[derive(Clone, Debug, Deserialize)]
#[serde(from = "Vec<Number>")]
pub(super) struct Numbers(Vec<f64>);

impl From<Vec<Number>> for Numbers {
    fn from(numbers: Vec<Number>) -> Self {
        Self(numbers.into_iter().map(|Number(value)| value).collect())
    }
}

impl Numbers {
    /// Likewise.
    pub(super) fn plain(&self) -> &[f64] {
        &self.0
    }
}

/// Types of values that are read as a number or as several and kept as what a function makes of
/// them that checks them.
macro_rules! checked {
    ($source:ident: $(
        $(#[$doc:meta])*
        $name:ident($kept:ty) = $check:expr;
    )*) => {$(
        $(#[$doc])*
        #[derive(Clone, Copy, Debug)]
        pub(super) struct $name(pub $kept);

        impl<'de> Deserialize<'de> for $name {
            fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
                let read = $source::deserialize(deserializer)?;
                $check(read.plain()).map(Self).map_err(D::Error::custom)
            }
        }
    )*};
}

/// The same of integers, of which an error says what they are to be.
macro_rules! checked_integers {
    ($(
        $(#[$doc:meta])*
        $name:ident($kept:ty) = $check:expr, $expected:literal $(% $bound:expr)*;
    )*) => {$(
        $(#[$doc])*
        #[derive(Clone, Copy, Debug)]
        pub(super) struct $name(pub $kept);

        impl<'de> Deserialize<'de> for $name {
            fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
                let expected = format!($expected $(, $bound)*);
                let value = integer(deserializer, &expected)?;
                $check(value).map(Self).map_err(D::Error::custom)
            }
        }
    )*};
}

checked_integers! {
    /// Corners of an aperture.
    Blades(u32) = bounds::blades, "an integer from 3 to {}, or 0" % bounds::MAX_BLADES;
    /// A width or height in pixels.
    FilmSide(u32) = bounds::film_side, "an integer from 1 to {}" % bounds::MAX_FILM_SIDE;
    /// The priority of a body.
    Priority(i32) =
        bounds::priority, "an integer from -{0} to {0}" % bounds::MAX_PRIORITY;
    /// A number of path segments.
    Depth(u32) = bounds::depth, "an integer from 1 to {}" % u32::MAX;
}

checked! { Numbers:
    /// A direction in world units.
    Coordinates(DVec3) = bounds::coordinates;
    /// A position in world units, which may be far from the origin.
    Place(DVec3) = bounds::place;
    /// A share of light: linear Rec.709, each component in [0, 1].
    Colour(Vec3) = bounds::reflectance;
    /// Emitted light: linear Rec.709, no component negative.
    Radiance(Vec3) = bounds::radiance;
    /// An index of refraction of a metal.
    Eta(Vec3) = bounds::eta;
    /// A coefficient of extinction of a metal.
    Extinction(Vec3) = bounds::extinction;
    /// What a share of light is multiplied by: linear Rec.709, no component negative.
    Factor(Vec3) = bounds::factor;
}

checked! { Number:
    /// A share of something, in [0, 1].
    Share(f32) = bounds::share;
    /// An index of refraction.
    Ior(f32) = bounds::ior;
    /// A distance or a width in world units, above 0.
    Distance(f32) = bounds::distance;
    /// Radius of an aperture in world units.
    LensRadius(f32) = bounds::lens_radius;
    /// An angle in degrees from an axis, from 0 to 180.
    Angle(f32) = bounds::angle;
    /// A rotation in degrees.
    Rotation(f32) = bounds::rotation;
    /// The height of a sun over the horizon, in degrees.
    Elevation(f32) = bounds::elevation;
    /// How much haze there is in the air.
    Turbidity(f32) = bounds::turbidity;
    /// What radiances are multiplied by.
    Strength(f32) = bounds::strength;
    /// The diameter of a light at infinity, in degrees.
    AngularDiameter(f32) = bounds::angular_diameter;
    /// How high a bump map is, in world units.
    Height(f32) = bounds::scale;
    /// What slopes are multiplied by.
    Slope(f32) = bounds::scale;
    /// An angle of view in degrees.
    AngleOfView(f32) = bounds::angle_of_view;
    /// A distance after which light is coloured, in world units.
    AttenuationDistance(f32) = bounds::attenuation_distance;
}
