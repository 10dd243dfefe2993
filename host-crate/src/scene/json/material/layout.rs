//! Where a scene file lays a texture.

use crate::scene::bounds;
use crate::scene::json::values::{Numbers, Rotation, present};
use crate::scene::obj::texture_map::TextureMap;
use glam::{DVec2, DVec3};
use serde::Deserialize;

/// What is done to texture coordinates before a texture is looked up.
#[derive(Clone, Copy, Debug, Default, Deserialize)]
#[serde(try_from = "LayoutKeys")]
pub(super) struct Layout(pub TextureMap);

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct LayoutKeys {
    #[serde(default, deserialize_with = "present")]
    scale: Option<Scale>,
    #[serde(default, deserialize_with = "present")]
    rotate: Option<Rotation>,
    #[serde(default, deserialize_with = "present")]
    translate: Option<Numbers>,
}

/// A factor for both axes, or one for each.
#[derive(Debug, Deserialize)]
#[serde(untagged, expecting = "a number, or two numbers")]
enum Scale {
    One(f64),
    Two(Vec<f64>),
}

impl TryFrom<LayoutKeys> for Layout {
    type Error = String;

    fn try_from(keys: LayoutKeys) -> Result<Self, String> {
        let scale = match keys.scale {
            None => DVec2::ONE,
            Some(Scale::One(factor)) => pair(&[factor; 2])?,
            Some(Scale::Two(factors)) => pair(&factors)?,
        };
        let rotation = keys.rotate.map_or(0.0, |Rotation(degrees)| f64::from(degrees));
        let offset = keys.translate.map_or(Ok(DVec2::ZERO), |moved| pair(moved.plain()))?;
        Ok(Self(TextureMap { scale, rotation: rotation.to_radians(), offset }))
    }
}

/// Two numbers in the range of coordinates.
fn pair(numbers: &[f64]) -> Result<DVec2, String> {
    match *numbers {
        [x, y] => bounds::coordinates(&[x, y, 0.0]).map(DVec3::truncate),
        _ => Err(format!("must be two numbers, are {}", numbers.len())),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::texture::CoordinateSet;
    use glam::Vec2;

    fn layout(json: &str) -> Result<TextureMap, String> {
        let parsed: Result<Layout, _> = serde_json::from_str(json);
        parsed.map(|Layout(map)| map).map_err(|error| error.to_string())
    }

    #[test]
    fn steps_are_taken_in_order() {
        let at = |json: &str, u: f32, v: f32| {
            layout(json).unwrap().placement(CoordinateSet::First).of(Vec2::new(u, v))
        };
        let close = |a: Vec2, x: f32, y: f32| assert!((a - Vec2::new(x, y)).length() < 1e-6, "{a}");
        close(at("{}", 0.25, 0.5), 0.25, 0.5);
        close(at(r#"{"scale": 2, "translate": [1, 0]}"#, 0.25, 0.5), 1.5, 1.0);
        close(at(r#"{"scale": [1, -3]}"#, 0.25, 0.5), 0.25, -1.5);
        close(at(r#"{"rotate": 90}"#, 1.0, 0.0), 0.0, 1.0);
        close(at(r#"{"scale": [2, 1], "rotate": 90, "translate": [0, 1]}"#, 1.0, 0.0), 0.0, 3.0);
    }

    #[test]
    fn what_is_no_layout_is_refused() {
        for (json, expected) in [
            (r#"{"scale": [1]}"#, "two numbers"),
            (r#"{"scale": "1"}"#, "a number, or two numbers"),
            (r#"{"translate": [1, 2, 3]}"#, "two numbers"),
            (r#"{"translate": [1e10, 2]}"#, "1000000000"),
            (r#"{"rotate": 1e9}"#, "100000"),
            (r#"{"matrix": []}"#, "unknown field `matrix`"),
        ] {
            let error = layout(json).unwrap_err();
            assert!(error.contains(expected), "{json}: {error}");
        }
    }
}
