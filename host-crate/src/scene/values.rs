//! The values of scene and material files, checked as they are read.

use glam::{DVec3, Vec3};
use serde::de::{MapAccess, Visitor, value};
use serde::{Deserialize, Deserializer};
use std::marker::PhantomData;

/// Coordinates go up to this: beyond, squares of areas overflow an f32.
pub(super) const MAX_COORDINATE: f64 = 1e9;
/// Radiances go up to this: beyond, sums of squares over a picture overflow an f32.
pub(super) const MAX_RADIANCE: f64 = 1e12;
/// Pictures have at most this many pixels a side, so that all of them are numbered by a u32.
pub(super) const MAX_FILM_SIDE: u32 = 16_384;
/// Indices of refraction lie between the inverse of this and this.
pub(super) const MAX_IOR: f64 = 100.0;

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

/// A position or a direction in world units.
#[derive(Clone, Copy, Debug, Deserialize)]
#[serde(try_from = "Vec<f64>")]
pub(super) struct Coordinates(pub DVec3);

impl TryFrom<Vec<f64>> for Coordinates {
    type Error = String;

    fn try_from(values: Vec<f64>) -> Result<Self, String> {
        triple(values, -MAX_COORDINATE..=MAX_COORDINATE).map(Self)
    }
}

/// A share of light: linear Rec.709, each component in [0, 1].
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(try_from = "Vec<f64>")]
pub(super) struct Reflectance(pub Vec3);

impl TryFrom<Vec<f64>> for Reflectance {
    type Error = String;

    fn try_from(values: Vec<f64>) -> Result<Self, String> {
        triple(values, 0.0..=1.0).map(|v| Self(v.as_vec3()))
    }
}

/// Emitted light: linear Rec.709, no component negative.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(try_from = "Vec<f64>")]
pub(super) struct Radiance(pub Vec3);

impl TryFrom<Vec<f64>> for Radiance {
    type Error = String;

    fn try_from(values: Vec<f64>) -> Result<Self, String> {
        triple(values, 0.0..=MAX_RADIANCE).map(|v| Self(v.as_vec3()))
    }
}

/// An index of refraction.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(try_from = "f64")]
pub(super) struct Ior(pub f32);

impl TryFrom<f64> for Ior {
    type Error = String;

    fn try_from(value: f64) -> Result<Self, String> {
        let allowed = MAX_IOR.recip()..=MAX_IOR;
        let bounds = format!("from {} to {}", allowed.start(), allowed.end());
        if allowed.contains(&value) {
            Ok(Self(value as f32))
        } else {
            Err(format!("must be {bounds}, is {value}"))
        }
    }
}

/// An angle of view in degrees.
#[derive(Clone, Copy, Debug, Deserialize)]
#[serde(try_from = "f64")]
pub(super) struct AngleOfView(pub f32);

impl TryFrom<f64> for AngleOfView {
    type Error = String;

    fn try_from(value: f64) -> Result<Self, String> {
        let rounded = value as f32;
        if rounded > 0.0 && rounded < 180.0 {
            Ok(Self(rounded))
        } else {
            Err(format!("must be an angle in degrees, above 0 and below 180, is {value}"))
        }
    }
}

/// A width or height in pixels.
#[derive(Clone, Copy, Debug, Deserialize)]
#[serde(try_from = "i64")]
pub(super) struct FilmSide(pub u32);

impl TryFrom<i64> for FilmSide {
    type Error = String;

    fn try_from(value: i64) -> Result<Self, String> {
        let side = u32::try_from(value).ok().filter(|side| (1..=MAX_FILM_SIDE).contains(side));
        side.map(Self)
            .ok_or_else(|| format!("must be from 1 to {MAX_FILM_SIDE} pixels, is {value}"))
    }
}

/// A number of path segments.
#[derive(Clone, Copy, Debug, Deserialize)]
#[serde(try_from = "i64")]
pub(super) struct Depth(pub u32);

impl TryFrom<i64> for Depth {
    type Error = String;

    fn try_from(value: i64) -> Result<Self, String> {
        let depth = u32::try_from(value).ok().filter(|&depth| depth > 0);
        depth.map(Self).ok_or_else(|| format!("must be from 1 to {}, is {value}", u32::MAX))
    }
}

/// Three numbers, each within `allowed`.
fn triple(values: Vec<f64>, allowed: std::ops::RangeInclusive<f64>) -> Result<DVec3, String> {
    let [x, y, z] = values[..] else {
        return Err(format!("must be three numbers, has {}", values.len()));
    };
    match values.iter().find(|value| !allowed.contains(value)) {
        Some(value) => {
            Err(format!("must be from {} to {}, has {value}", allowed.start(), allowed.end()))
        }
        None => Ok(DVec3::new(x, y, z)),
    }
}
