//! The values of a scene file, checked as they are read.

use crate::scene::bounds;
use glam::{DVec3, Vec3};
use serde::de::{MapAccess, Visitor, value};
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

/// Types of values that are read as one type, the second, and kept as another, the first, by a
/// function that checks them.
macro_rules! checked {
    ($(
        $(#[$doc:meta])*
        $name:ident($kept:ty) = $check:expr, of $read:ty as $read_text:literal;
    )*) => {$(
        $(#[$doc])*
        #[derive(Clone, Copy, Debug, Deserialize)]
        #[serde(try_from = $read_text)]
        pub(super) struct $name(pub $kept);

        impl TryFrom<$read> for $name {
            type Error = String;

            fn try_from(value: $read) -> Result<Self, String> {
                $check(value).map(Self)
            }
        }
    )*};
}

checked! {
    /// A direction in world units.
    Coordinates(DVec3) = |v: Vec<f64>| bounds::coordinates(&v), of Vec<f64> as "Vec<f64>";
    /// A position in world units, which may be far from the origin.
    Place(DVec3) = |v: Vec<f64>| bounds::place(&v), of Vec<f64> as "Vec<f64>";
    /// A share of light: linear Rec.709, each component in [0, 1].
    Colour(Vec3) = |v: Vec<f64>| bounds::reflectance(&v), of Vec<f64> as "Vec<f64>";
    /// A share of something, in [0, 1].
    Share(f32) = bounds::share, of f64 as "f64";
    /// Emitted light: linear Rec.709, no component negative.
    Radiance(Vec3) = |v: Vec<f64>| bounds::radiance(&v), of Vec<f64> as "Vec<f64>";
    /// An index of refraction.
    Ior(f32) = bounds::ior, of f64 as "f64";
    /// An index of refraction of a metal.
    Eta(Vec3) = |v: Vec<f64>| bounds::eta(&v), of Vec<f64> as "Vec<f64>";
    /// A coefficient of extinction of a metal.
    Extinction(Vec3) = |v: Vec<f64>| bounds::extinction(&v), of Vec<f64> as "Vec<f64>";
    /// A distance or a width in world units, above 0.
    Distance(f32) = bounds::distance, of f64 as "f64";
    /// Radius of an aperture in world units.
    LensRadius(f32) = bounds::lens_radius, of f64 as "f64";
    /// Corners of an aperture.
    Blades(u32) = bounds::blades, of i64 as "i64";
    /// An angle in degrees from an axis, from 0 to 180.
    Angle(f32) = bounds::angle, of f64 as "f64";
    /// A rotation in degrees.
    Rotation(f32) = bounds::rotation, of f64 as "f64";
    /// The height of a sun over the horizon, in degrees.
    Elevation(f32) = bounds::elevation, of f64 as "f64";
    /// How much haze there is in the air.
    Turbidity(f32) = bounds::turbidity, of f64 as "f64";
    /// What radiances are multiplied by.
    Strength(f32) = bounds::strength, of f64 as "f64";
    /// The diameter of a light at infinity, in degrees.
    AngularDiameter(f32) = bounds::angular_diameter, of f64 as "f64";
    /// What a share of light is multiplied by: linear Rec.709, no component negative.
    Factor(Vec3) = |v: Vec<f64>| bounds::factor(&v), of Vec<f64> as "Vec<f64>";
    /// What slopes are multiplied by.
    Slope(f32) = bounds::scale, of f64 as "f64";
    /// An angle of view in degrees.
    AngleOfView(f32) = bounds::angle_of_view, of f64 as "f64";
    /// A width or height in pixels.
    FilmSide(u32) = bounds::film_side, of i64 as "i64";
    /// A distance after which light is coloured, in world units.
    AttenuationDistance(f32) = bounds::attenuation_distance, of f64 as "f64";
    /// The priority of a body.
    Priority(i32) = bounds::priority, of i64 as "i64";
    /// A number of path segments.
    Depth(u32) = bounds::depth, of i64 as "i64";
}
