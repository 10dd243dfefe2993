//! Where a scene file puts a mesh.

use super::values::{Numbers, Place, present};
use crate::scene::bounds;
use glam::{DAffine3, DMat3, DVec3, EulerRot};
use serde::Deserialize;

/// How a mesh is moved from where its file has it; it can be undone.
#[derive(Clone, Copy, Debug, Deserialize)]
#[serde(try_from = "TransformKeys")]
pub(super) struct FileTransform(pub DAffine3);

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct TransformKeys {
    #[serde(default, deserialize_with = "present")]
    matrix: Option<Matrix>,
    #[serde(default, deserialize_with = "present")]
    translate: Option<Place>,
    #[serde(default, deserialize_with = "present")]
    rotate: Option<Angles>,
    #[serde(default, deserialize_with = "present")]
    scale: Option<Scale>,
}

/// Three rows of four numbers.
#[derive(Debug, Deserialize)]
#[serde(try_from = "Vec<Numbers>")]
struct Matrix(DAffine3);

/// Degrees about x, then y, then z.
#[derive(Debug, Deserialize)]
#[serde(try_from = "Numbers")]
struct Angles(DMat3);

/// A factor for all axes, or one for each.
#[derive(Debug, Deserialize)]
#[serde(untagged, expecting = "a number, or three numbers")]
enum Scale {
    One(f64),
    Three(Vec<f64>),
}

impl TryFrom<Vec<Numbers>> for Matrix {
    type Error = String;

    fn try_from(rows: Vec<Numbers>) -> Result<Self, String> {
        let rows: Vec<&[f64]> = rows.iter().map(Numbers::plain).collect();
        let is_matrix = rows.len() == 3 && rows.iter().all(|row| row.len() == 4);
        if !is_matrix {
            return Err("must be three rows of four numbers each".to_owned());
        }
        for row in &rows {
            bounds::place(&row[..3]).and(bounds::place(&[row[3], 0.0, 0.0]))?;
        }
        let column = |at: usize| DVec3::new(rows[0][at], rows[1][at], rows[2][at]);
        Ok(Self(DAffine3::from_cols(column(0), column(1), column(2), column(3))))
    }
}

impl TryFrom<Numbers> for Angles {
    type Error = String;

    fn try_from(degrees: Numbers) -> Result<Self, String> {
        let radians = bounds::coordinates(degrees.plain())?.map(f64::to_radians);
        Ok(Self(DMat3::from_euler(EulerRot::ZYX, radians.z, radians.y, radians.x)))
    }
}

impl TryFrom<TransformKeys> for FileTransform {
    type Error = String;

    fn try_from(keys: TransformKeys) -> Result<Self, String> {
        let has_steps = keys.translate.is_some() || keys.rotate.is_some() || keys.scale.is_some();
        let transform = match keys.matrix {
            Some(_) if has_steps => {
                let what = "give either `matrix` or `translate`, `rotate` and `scale`";
                return Err(what.to_owned());
            }
            Some(Matrix(matrix)) => matrix,
            None => {
                let scale = match keys.scale {
                    None => DVec3::ONE,
                    Some(Scale::One(factor)) => bounds::coordinates(&[factor; 3])?,
                    Some(Scale::Three(factors)) => bounds::coordinates(&factors)?,
                };
                let turned = keys.rotate.map_or(DMat3::IDENTITY, |Angles(turned)| turned);
                let moved = keys.translate.map_or(DVec3::ZERO, |Place(moved)| moved);
                DAffine3::from_mat3_translation(turned * DMat3::from_diagonal(scale), moved)
            }
        };
        let inverse = transform.matrix3.inverse();
        if transform.matrix3.determinant() == 0.0 || !inverse.is_finite() {
            return Err("flattens the mesh: its determinant is 0".to_owned());
        }
        Ok(Self(transform))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn transform(json: &str) -> Result<DAffine3, String> {
        let parsed: Result<FileTransform, _> = serde_json::from_str(json);
        parsed.map(|FileTransform(transform)| transform).map_err(|error| error.to_string())
    }

    #[test]
    fn steps_are_taken_in_order() {
        let at = |json: &str, point: DVec3| transform(json).unwrap().transform_point3(point);
        let close = |a: DVec3, b: DVec3| assert!((a - b).length() < 1e-12, "{a} {b}");
        let p = DVec3::new(1.0, 2.0, 3.0);
        close(at("{}", p), p);
        close(at(r#"{"scale": 2, "translate": [1, 0, 0]}"#, p), DVec3::new(3.0, 4.0, 6.0));
        close(at(r#"{"scale": [1, -1, 2]}"#, p), DVec3::new(1.0, -2.0, 6.0));
        close(at(r#"{"rotate": [90, 0, 0]}"#, DVec3::Y), DVec3::Z);
        close(at(r#"{"rotate": [0, 90, 0]}"#, DVec3::Z), DVec3::X);
        close(at(r#"{"rotate": [0, 0, 90]}"#, DVec3::X), DVec3::Y);
        close(at(r#"{"rotate": [90, 0, 90]}"#, DVec3::Y), DVec3::Z);
        close(at(r#"{"rotate": [0, 90, 90]}"#, DVec3::Z), DVec3::Y);
        let matrix = r#"{"matrix": [[0, -1, 0, 5], [1, 0, 0, 6], [0, 0, 1, 7]]}"#;
        close(at(matrix, p), DVec3::new(3.0, 7.0, 10.0));
    }

    #[test]
    fn what_is_no_transform_is_refused() {
        for (json, expected) in [
            (r#"{"scale": 0}"#, "determinant"),
            (r#"{"scale": [1, 1]}"#, "three numbers"),
            (r#"{"scale": "1"}"#, "a number, or three numbers"),
            (r#"{"matrix": [[1, 0, 0, 0]]}"#, "three rows"),
            (r#"{"matrix": [[1, 0, 0, 0], [1, 0, 0, 0], [0, 0, 1, 0]]}"#, "determinant"),
            (r#"{"matrix": [[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 0]], "scale": 2}"#, "either"),
            (r#"{"rotation": [0, 0, 0]}"#, "unknown field `rotation`"),
        ] {
            let error = transform(json).unwrap_err();
            assert!(error.contains(expected), "{json}: {error}");
        }
    }
}
