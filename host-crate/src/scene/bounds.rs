//! What the numbers of a scene may be, for its loaders and for [`check`](super::check).
//!
//! Every function returns the number as a scene stores it; its error is what to say after the
//! number's name, as in "must be from 0 to 1, has 2".

use glam::{DVec3, Vec3};
use std::ops::RangeInclusive;

/// Coordinates go up to this: beyond, squares of areas overflow an f32.
pub(super) const MAX_COORDINATE: f64 = 1e9;
/// Positions in files go up to this, before scenes far from the origin are brought near: an f64
/// has a thousandth left of them.
pub(super) const MAX_PLACE: f64 = 1e12;
/// Radiances go up to this: beyond, sums of squares over a picture overflow an f32.
pub(super) const MAX_RADIANCE: f64 = 1e12;
/// Factors of shares go up to this: what is bright by then is white.
const MAX_FACTOR: f64 = 1e4;
/// Environments are turned by at most so many degrees: beyond, an f32 has few digits of one.
const MAX_ROTATION: f64 = 1e5;
/// Environments are made so many times as bright, at most.
const MAX_STRENGTH: f64 = 1e6;
/// Pictures have at most this many pixels a side, so that all of them are numbered by a u32.
pub(super) const MAX_FILM_SIDE: u32 = 16_384;
/// Indices of refraction lie between the inverse of this and this.
const MAX_IOR: f64 = 100.0;
/// Indices of refraction of metals lie between this and [`MAX_IOR`], and coefficients of extinction
/// between 0 and that.
const MIN_ETA: f64 = 1e-3;
/// Light is coloured after a distance between the inverse of this and this.
const MAX_ATTENUATION_DISTANCE: f64 = 1e12;
/// Priorities of bodies lie between the negative of this and this.
pub(super) const MAX_PRIORITY: i32 = 1000;
/// Apertures have at most so many corners.
pub(super) const MAX_BLADES: u32 = 64;
/// Textures are at most this wide and high, in texels.
pub(super) const MAX_TEXTURE_SIDE: u32 = 16_384;
/// Texels of all textures together, with what a device's buffer of them holds besides: 1 GiB.
pub(super) const MAX_TEXELS: usize = 1 << 28;

/// A position or a direction in world units.
pub(super) fn coordinates(values: &[f64]) -> Result<DVec3, String> {
    triple(values, -MAX_COORDINATE..=MAX_COORDINATE)
}

/// A position as a file has it.
pub(super) fn place(values: &[f64]) -> Result<DVec3, String> {
    triple(values, -MAX_PLACE..=MAX_PLACE)
}

/// A share of light: linear Rec.709, each component in [0, 1].
pub(super) fn reflectance(values: &[f64]) -> Result<Vec3, String> {
    triple(values, 0.0..=1.0).map(DVec3::as_vec3)
}

/// A share of something, in [0, 1].
pub(super) fn share(value: f64) -> Result<f32, String> {
    let allowed = 0.0..=1.0;
    if allowed.contains(&value) {
        Ok(value as f32)
    } else {
        Err(format!("must be from 0 to 1, is {value}"))
    }
}

/// What a share of light is multiplied by: linear Rec.709, no component negative.
pub(super) fn factor(values: &[f64]) -> Result<Vec3, String> {
    triple(values, 0.0..=MAX_FACTOR).map(DVec3::as_vec3)
}

/// What slopes are multiplied by.
pub(super) fn scale(value: f64) -> Result<f32, String> {
    if value.abs() <= MAX_FACTOR {
        Ok(value as f32)
    } else {
        Err(format!("must be from {} to {MAX_FACTOR}, is {value}", -MAX_FACTOR))
    }
}

/// Emitted light: linear Rec.709, no component negative.
pub(super) fn radiance(values: &[f64]) -> Result<Vec3, String> {
    triple(values, 0.0..=MAX_RADIANCE).map(DVec3::as_vec3)
}

/// An index of refraction.
pub(super) fn ior(value: f64) -> Result<f32, String> {
    let (low, high) = (MAX_IOR.recip(), MAX_IOR);
    rounded(value, low, high).ok_or_else(|| format!("must be from {low} to {high}, is {value}"))
}

/// An index of refraction of a metal, for red, green and blue.
pub(super) fn eta(values: &[f64]) -> Result<Vec3, String> {
    triple(values, f64::from(MIN_ETA as f32)..=MAX_IOR).map(DVec3::as_vec3)
}

/// A coefficient of extinction of a metal, for red, green and blue.
pub(super) fn extinction(values: &[f64]) -> Result<Vec3, String> {
    triple(values, 0.0..=MAX_IOR).map(DVec3::as_vec3)
}

/// A distance after which light in a body is coloured, in world units.
pub(super) fn attenuation_distance(value: f64) -> Result<f32, String> {
    let (low, high) = (MAX_ATTENUATION_DISTANCE.recip(), MAX_ATTENUATION_DISTANCE);
    rounded(value, low, high).ok_or_else(|| format!("must be from {low:e} to {high:e}, is {value}"))
}

/// The priority of a body.
pub(super) fn priority(value: i64) -> Result<i32, String> {
    let priority = i32::try_from(value).ok().filter(|value| value.abs() <= MAX_PRIORITY);
    priority.ok_or_else(|| format!("must be from {} to {MAX_PRIORITY}, is {value}", -MAX_PRIORITY))
}

/// An angle of view in degrees.
pub(super) fn angle_of_view(value: f64) -> Result<f32, String> {
    let rounded = value as f32;
    if rounded > 0.0 && rounded < 180.0 {
        Ok(rounded)
    } else {
        Err(format!("must be an angle in degrees, above 0 and below 180, is {value}"))
    }
}

/// Radius of an aperture, in world units.
pub(super) fn lens_radius(value: f64) -> Result<f32, String> {
    within(value, 0.0..=MAX_COORDINATE)
}

/// A distance or a width in world units, above 0.
pub(super) fn distance(value: f64) -> Result<f32, String> {
    let rounded = value as f32;
    if rounded >= f32::MIN_POSITIVE && value <= MAX_COORDINATE {
        Ok(rounded)
    } else {
        Err(format!("must be above 0 and at most {MAX_COORDINATE}, is {value}"))
    }
}

/// The corners of an aperture.
pub(super) fn blades(value: i64) -> Result<u32, String> {
    let blades = u32::try_from(value).ok().filter(|&n| n == 0 || (3..=MAX_BLADES).contains(&n));
    blades.ok_or_else(|| {
        format!("must be from 3 to {MAX_BLADES}, or 0 for a round aperture, is {value}")
    })
}

/// A direction of any length but 0.
pub(super) fn direction(value: DVec3) -> Result<(), &'static str> {
    match value.as_vec3().as_dvec3().try_normalize() {
        Some(_) => Ok(()),
        None => Err("is zero: it must point somewhere"),
    }
}

/// The angles of a cone from its axis, in degrees: the name of the wrong one, and why.
pub(super) fn cone(inner: f64, outer: f64) -> Result<(), (&'static str, String)> {
    if !(outer > 0.0 && outer <= 180.0) {
        let what = format!("must be an angle in degrees, above 0 and at most 180, is {outer}");
        return Err(("outer_angle", what));
    }
    if !(0.0..=outer).contains(&inner) {
        let what = format!("must be an angle in degrees, from 0 to outer_angle, is {inner}");
        return Err(("inner_angle", what));
    }
    Ok(())
}

/// An angle in degrees from an axis.
pub(super) fn angle(value: f64) -> Result<f32, String> {
    within(value, 0.0..=180.0)
}

/// The diameter of a light at infinity, in degrees.
pub(super) fn angular_diameter(value: f64) -> Result<f32, String> {
    within(value, 0.0..=90.0)
}

/// A rotation in degrees.
pub(super) fn rotation(value: f64) -> Result<f32, String> {
    within(value, -MAX_ROTATION..=MAX_ROTATION)
}

/// The height of a sun over the horizon, in degrees.
pub(super) fn elevation(value: f64) -> Result<f32, String> {
    within(value, 0.0..=90.0)
}

/// How much haze there is in the air.
pub(super) fn turbidity(value: f64) -> Result<f32, String> {
    within(value, 2.0..=10.0)
}

/// What the radiances of an environment are multiplied by.
pub(super) fn strength(value: f64) -> Result<f32, String> {
    within(value, 0.0..=MAX_STRENGTH)
}

/// A number as an f32 has it, if that lies between these as an f32 has them: what was accepted once
/// is accepted when it comes back as an f32.
fn rounded(value: f64, low: f64, high: f64) -> Option<f32> {
    Some(value as f32).filter(|rounded| (low as f32..=high as f32).contains(rounded))
}

/// A number within `allowed`.
fn within(value: f64, allowed: RangeInclusive<f64>) -> Result<f32, String> {
    if allowed.contains(&value) {
        Ok(value as f32)
    } else {
        Err(format!("must be from {} to {}, is {value}", allowed.start(), allowed.end()))
    }
}

/// A width or height in pixels.
pub(super) fn film_side(value: i64) -> Result<u32, String> {
    let side = u32::try_from(value).ok().filter(|side| (1..=MAX_FILM_SIDE).contains(side));
    side.ok_or_else(|| format!("must be from 1 to {MAX_FILM_SIDE} pixels, is {value}"))
}

/// A number of path segments.
pub(super) fn depth(value: i64) -> Result<u32, String> {
    let depth = u32::try_from(value).ok().filter(|&depth| depth > 0);
    depth.ok_or_else(|| format!("must be from 1 to {}, is {value}", u32::MAX))
}

/// Three numbers, each within `allowed`.
fn triple(values: &[f64], allowed: RangeInclusive<f64>) -> Result<DVec3, String> {
    let &[x, y, z] = values else {
        return Err(format!("must be three numbers, has {}", values.len()));
    };
    match values.iter().find(|value| !allowed.contains(value)) {
        Some(value) => {
            Err(format!("must be from {} to {}, has {value}", allowed.start(), allowed.end()))
        }
        None => Ok(DVec3::new(x, y, z)),
    }
}
