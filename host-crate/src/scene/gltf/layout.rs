//! Where a texture lies on a surface.

use super::document::Document;
use super::extensions::TRANSFORM;
use crate::scene::error::SceneError;
use crate::scene::texture::{CoordinateSet, Placement};
use glam::{DMat2, DVec2, Vec2};
use gltf::json::Value;
use serde::Deserialize;

/// A set of texture coordinates, and what is done to them (KHR_texture_transform).
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Layout {
    /// The number of the set.
    pub set: u32,
    offset: DVec2,
    /// Radians.
    rotation: f64,
    scale: DVec2,
}

/// What the extension says.
#[derive(Deserialize)]
#[serde(rename_all = "camelCase", default)]
struct Transform {
    offset: [f64; 2],
    rotation: f64,
    scale: [f64; 2],
    tex_coord: Option<u32>,
}

impl Default for Transform {
    fn default() -> Self {
        Self { offset: [0.0; 2], rotation: 0.0, scale: [1.0; 2], tex_coord: None }
    }
}

impl Layout {
    /// The first set as it is.
    pub(super) const FIRST: Self =
        Self { set: 0, offset: DVec2::ZERO, rotation: 0.0, scale: DVec2::ONE };

    /// The layout of a texture with this set of coordinates and this extension, if it has that.
    pub(super) fn new(
        document: &Document<'_>,
        set: u32,
        transform: Option<&Value>,
        place: &str,
    ) -> Result<Self, SceneError> {
        let transform = transform
            .map(Transform::deserialize)
            .transpose()
            .map_err(|error| document.wrong(&format!("{place}.{TRANSFORM}"), error.to_string()))?
            .unwrap_or_default();
        Ok(Self {
            set: transform.tex_coord.unwrap_or(set),
            offset: DVec2::from_array(transform.offset),
            rotation: transform.rotation,
            scale: DVec2::from_array(transform.scale),
        })
    }

    /// Where a texture is looked up. The file's second coordinate points down, ours up.
    pub(super) fn of(&self, coordinates: [f32; 2]) -> Vec2 {
        let scaled = DVec2::from_array(coordinates.map(f64::from)) * self.scale;
        let (sine, cosine) = self.rotation.sin_cos();
        let turned =
            DVec2::new(cosine * scaled.x + sine * scaled.y, cosine * scaled.y - sine * scaled.x);
        let DVec2 { x, y } = turned + self.offset;
        DVec2::new(x, 1.0 - y).as_vec2()
    }

    /// The same, for a texture to do that itself with coordinates of a set that are as
    /// [`Self::of_set`] has them.
    pub(super) fn placement(&self, set: CoordinateSet) -> Placement {
        let (sine, cosine) = self.rotation.sin_cos();
        let (across, down) = (self.scale.x, self.scale.y);
        // Our second coordinate is 1 less the file's, before and after.
        let x = DVec2::new(cosine * across, -sine * down);
        let y = DVec2::new(sine * across, cosine * down);
        let offset = DVec2::new(sine * down + self.offset.x, 1.0 - cosine * down - self.offset.y);
        let matrix = DMat2::from_cols(x, y).transpose().as_mat2();
        Placement { set, matrix, offset: offset.as_vec2() }
    }

    /// The set of this number as it is.
    pub(super) fn of_set(set: u32) -> Self {
        Self { set, ..Self::FIRST }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::FRAC_PI_2;

    #[test]
    fn coordinates_are_scaled_then_turned_then_moved() {
        let plain = Layout { set: 0, offset: DVec2::ZERO, rotation: 0.0, scale: DVec2::ONE };
        assert_eq!(plain.of([0.25, 0.25]), Vec2::new(0.25, 0.75));
        let scaled = Layout { scale: DVec2::new(2.0, 4.0), ..plain };
        assert_eq!(scaled.of([0.25, 0.25]), Vec2::new(0.5, 0.0));
        let turned = Layout { rotation: FRAC_PI_2, ..scaled };
        // A quarter turn takes (0.5, 1) to (1, -0.5).
        assert!((turned.of([0.25, 0.25]) - Vec2::new(1.0, 1.5)).length() < 1e-6);
        let moved = Layout { offset: DVec2::new(0.5, 0.25), ..turned };
        assert!((moved.of([0.25, 0.25]) - Vec2::new(1.5, 1.25)).length() < 1e-6);
    }

    #[test]
    fn a_texture_can_do_the_same_itself() {
        let layout = Layout {
            set: 3,
            offset: DVec2::new(0.3, -0.7),
            rotation: 0.4,
            scale: DVec2::new(2.0, -3.0),
        };
        let placement = layout.placement(CoordinateSet::Second);
        assert_eq!(placement.set, CoordinateSet::Second);
        for uv in [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [0.3, -2.5]] {
            let there = placement.of(Layout::of_set(3).of(uv));
            assert!((there - layout.of(uv)).length() < 1e-5, "{uv:?}: {there}");
        }
    }
}
