//! The light of scenes that have none: a soft studio.

use super::environment::Environment;
use glam::{DVec3, Vec3};
use std::f64::consts::{PI, TAU};

/// Texels of the picture: the lamps are wide and have soft edges.
const WIDTH: u32 = 128;
const HEIGHT: u32 = WIDTH / 2;

/// Radiance at the horizon, and how much more there is at the zenith and less at the nadir: walls
/// and a floor, so that no side of a thing is black and none is as bright as its top.
const HORIZON: f64 = 0.42;
const SLOPE: f64 = 0.22;
/// The key light, from the left over a camera that looks towards -z: it gives form and shadows.
const KEY: Lamp = Lamp { towards: DVec3::new(-0.6, 0.9, 0.8), radiance: 2.38 };
/// The rim light, from behind and the right: what is seen from the back has form, too.
const RIM: Lamp = Lamp { towards: DVec3::new(0.7, 0.5, -0.8), radiance: 1.19 };
/// Cosines of the angles from a lamp's middle to where it begins to fade, and to its edge: of 15
/// and 35 degrees.
const FADES: f64 = 0.965_926;
const EDGE: f64 = 0.819_152;
/// Radiances are whole multiples of this, so that all systems have the same ones, however they
/// round sines.
const STEP: f64 = 1.0 / 1024.0;

/// A wide lamp with soft edges.
struct Lamp {
    /// To its middle, of any length.
    towards: DVec3,
    /// In its middle.
    radiance: f64,
}

impl Lamp {
    /// Radiance from a direction, of length 1.
    fn from(&self, direction: DVec3) -> f64 {
        let cosine = direction.dot(self.towards) / self.towards.length();
        let t = ((cosine - EDGE) * (1.0 / (FADES - EDGE))).clamp(0.0, 1.0);
        self.radiance * t * t * (3.0 - 2.0 * t)
    }
}

impl Environment {
    /// A soft studio of white light, for what has no light: a bright ceiling and a darker floor, a
    /// wide key light from the upper left of a camera that looks towards -z, and half of it from
    /// behind.
    ///
    /// Its exposure is that of a meter in the scene: what faces the key light has an irradiance of
    /// pi, so that matt surfaces are as bright there as their colour says, and nowhere more than
    /// 3 % brighter.
    pub fn studio() -> Self {
        let row = |y: u32| (0..WIDTH).map(move |x| radiance(direction(x, y)));
        let texels = (0..HEIGHT).flat_map(row).map(|value| Vec3::splat(value as f32)).collect();
        Self::new(WIDTH, HEIGHT, texels)
    }
}

/// The direction of a texel's middle; see [`Environment`].
fn direction(x: u32, y: u32) -> DVec3 {
    let (sin, cos) = (PI * (f64::from(y) + 0.5) / f64::from(HEIGHT)).sin_cos();
    let (east, south) = (TAU * (f64::from(x) + 0.5) / f64::from(WIDTH) - PI).sin_cos();
    DVec3::new(sin * east, cos, -sin * south)
}

/// Radiance from a direction.
fn radiance(direction: DVec3) -> f64 {
    let value = HORIZON + SLOPE * direction.y + KEY.from(direction) + RIM.from(direction);
    (value / STEP).round() * STEP
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Irradiance of a surface with this normal, by all texels of the picture.
    fn irradiance(studio: &Environment, normal: DVec3) -> f64 {
        let texels = studio.texels.iter().enumerate();
        let light = texels.map(|(index, texel)| {
            let (x, y) = (index as u32 % WIDTH, index as u32 / WIDTH);
            let end = |row: u32| (PI * f64::from(row) / f64::from(HEIGHT)).cos();
            let solid_angle = TAU / f64::from(WIDTH) * (end(y) - end(y + 1));
            f64::from(texel.x) * solid_angle * direction(x, y).dot(normal).max(0.0)
        });
        light.sum()
    }

    #[test]
    fn grey_that_faces_the_key_light_is_as_grey_as_it_is() {
        let studio = Environment::studio();
        assert_eq!(studio.check(), Ok(()));
        let key = irradiance(&studio, KEY.towards.normalize()) / PI;
        assert!((key - 1.0).abs() < 0.01, "{key}");
    }

    #[test]
    fn nothing_matt_is_too_bright_and_nothing_is_black() {
        let studio = Environment::studio();
        let normals =
            (0..HEIGHT).step_by(4).flat_map(|y| (0..WIDTH).step_by(4).map(move |x| (x, y)));
        let all: Vec<f64> =
            normals.map(|(x, y)| irradiance(&studio, direction(x, y)) / PI).collect();
        let (low, high) =
            all.iter().fold((f64::MAX, 0.0), |(low, high), &e| (e.min(low), e.max(high)));
        assert!(high < 1.03 && (0.2..0.4).contains(&low), "{low} {high}");
    }

    #[test]
    fn every_side_has_form() {
        let studio = Environment::studio();
        let lit = |normal: DVec3| irradiance(&studio, normal) / PI;
        for side in [DVec3::Z, DVec3::X, DVec3::NEG_Z, DVec3::NEG_X] {
            // A ball that is seen from there: its left, its right, its top and its bottom.
            let right = DVec3::Y.cross(side);
            let normals = [right, -right, DVec3::Y, DVec3::NEG_Y];
            let ends = normals.map(|end| lit((side + end).normalize()));
            let (low, high) =
                ends.iter().fold((9.0, 0.0), |(l, h): (f64, f64), &e| (l.min(e), h.max(e)));
            assert!(high > 1.5 * low, "{side}: {ends:?}");
        }
    }
}
