//! OBJ files, read by tobj from their [plain form](text), with their MTL files.

pub(super) mod mtl;
mod text;

use self::text::{FaceGroup, ObjText};
use super::error::SceneError;
use super::material::MaterialId;
use super::mesh::Mesh;
use glam::{DVec3, Vec2, Vec3};
use std::fmt::Write as _;
use std::path::Path;

/// The geometry of a scene.
#[derive(Debug)]
pub(super) struct Obj {
    /// The MTL files that it names, in order.
    pub libraries: Vec<String>,
    /// The triangles by material, in the order of the first `usemtl`.
    pub parts: Vec<Part>,
}

/// All triangles of one material.
#[derive(Debug)]
pub(super) struct Part {
    /// The material's name.
    pub material: String,
    /// Positions, texture coordinates and normals, each with indices.
    mesh: tobj::Mesh,
    /// Whether every corner has a texture coordinate.
    pub has_texture_coordinates: bool,
    /// Whether every corner has a normal.
    pub has_normals: bool,
}

/// Polygons become fans around their first corner; positions, texture coordinates and normals keep
/// their own indices.
const OPTIONS: tobj::LoadOptions = tobj::LoadOptions {
    triangulate: true,
    single_index: false,
    ignore_points: true,
    ignore_lines: true,
};

impl Obj {
    /// Reads an OBJ file; `path` is for messages only.
    pub(super) fn parse(path: &Path, bytes: &[u8]) -> Result<Self, SceneError> {
        let ObjText { vertices, groups, libraries } = text::parse(&String::from_utf8_lossy(bytes))
            .map_err(|bad| SceneError::Obj {
                path: path.to_owned(),
                line: bad.line,
                what: bad.what,
            })?;
        let fail = |what: String| SceneError::ObjContent { path: path.to_owned(), what };
        if groups.is_empty() {
            return Err(fail(
                "has no faces; a scene needs an OBJ with at least one `f` line".to_owned(),
            ));
        }
        let text = single_text(&vertices, &groups);
        let (models, _) = tobj::load_obj_buf(&mut text.as_bytes(), &OPTIONS, |_| {
            numbered_materials(groups.len())
        })
        .map_err(|error| fail(format!("cannot be read as OBJ: {error}")))?;
        let parts = models.into_iter().filter_map(|model| {
            let group = groups.get(model.mesh.material_id?)?;
            Some(Part {
                material: group.material.clone(),
                mesh: model.mesh,
                has_texture_coordinates: group.has_texture_coordinates,
                has_normals: group.has_normals,
            })
        });
        Ok(Self { libraries, parts: parts.collect() })
    }
}

impl Part {
    /// Its triangles, with its normals and its texture coordinates if wanted: then it must have
    /// them.
    pub(super) fn mesh(
        &self,
        material: MaterialId,
        normals: bool,
        texture_coordinates: bool,
    ) -> Mesh {
        let tobj::Mesh { positions, indices, normal_indices, texcoord_indices, .. } = &self.mesh;
        let normal = |index: u32| unit(vec3(&self.mesh.normals, index));
        let uv = |index: u32| {
            let at = index as usize * 2;
            Vec2::new(self.mesh.texcoords[at], self.mesh.texcoords[at + 1])
        };
        Mesh {
            material,
            positions: positions.chunks_exact(3).map(Vec3::from_slice).collect(),
            triangles: corners(indices, |index| index),
            normals: normals.then(|| corners(normal_indices, normal)),
            texture_coordinates: texture_coordinates.then(|| corners(texcoord_indices, uv)),
        }
    }
}

/// What `of` makes of the indices of each triangle.
fn corners<T>(indices: &[u32], of: impl Fn(u32) -> T) -> Vec<[T; 3]> {
    indices.chunks_exact(3).map(|corners| [corners[0], corners[1], corners[2]].map(&of)).collect()
}

/// The unit vector; zero stays zero.
fn unit(normal: Vec3) -> Vec3 {
    let normal: DVec3 = normal.as_dvec3();
    normal.normalize_or_zero().as_vec3()
}

fn vec3(values: &[f32], index: u32) -> Vec3 {
    Vec3::from_slice(&values[index as usize * 3..])
}

/// One OBJ text for all groups, in which materials are called by their number.
fn single_text(vertices: &str, groups: &[FaceGroup]) -> String {
    let length = vertices.len() + groups.iter().map(|group| group.faces.len() + 24).sum::<usize>();
    let mut text = String::with_capacity(length);
    text.push_str("mtllib all\n");
    text.push_str(vertices);
    for (number, group) in groups.iter().enumerate() {
        // Writing to a String cannot fail.
        let _ = writeln!(text, "usemtl {number}");
        text.push_str(&group.faces);
    }
    text
}

/// The materials `0`, `1` ... : tobj tells apart only those that a library has.
fn numbered_materials(count: usize) -> tobj::MTLLoadResult {
    let materials =
        (0..count).map(|number| tobj::Material { name: number.to_string(), ..Default::default() });
    Ok((materials.collect(), (0..count).map(|number| (number.to_string(), number)).collect()))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn parse(text: &str) -> Obj {
        Obj::parse(Path::new("test.obj"), text.as_bytes()).unwrap()
    }

    #[test]
    fn polygons_become_fans() {
        let obj = parse("v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv -1 .5 0\nf 1 2 3 4 5\nf 1 2 3 4\n");
        assert_eq!(obj.parts[0].mesh.indices, [0, 1, 2, 0, 2, 3, 0, 3, 4, 0, 1, 2, 0, 2, 3]);
    }

    #[test]
    fn materials_keep_their_names_without_any_library() {
        let obj = parse(
            "mtllib my file.mtl\nv 0 0 0\nv 1 0 0\nv 1 1 0\nusemtl red wall\nf 1 2 3\ng x\nusemtl b\nf 1 2 3",
        );
        assert_eq!(obj.libraries, ["my file.mtl"]);
        assert_eq!(
            obj.parts.iter().map(|part| part.material.as_str()).collect::<Vec<_>>(),
            ["red wall", "b"]
        );
    }

    #[test]
    fn text_that_is_not_utf8_is_read() {
        let bytes = b"# caf\xe9\nv 0 0 0\nv 1 0 0\nv 1 1 0\nusemtl caf\xe9\nf 1 2 3\n";
        assert_eq!(Obj::parse(Path::new("x"), bytes).unwrap().parts[0].material, "caf\u{fffd}");
    }
}
