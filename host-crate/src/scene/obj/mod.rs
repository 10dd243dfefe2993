//! OBJ files, read by tobj from their [plain form](faces), with their MTL files.

mod faces;
mod indices;
pub(super) mod mtl;
mod part;
mod pieces;
mod polygon;
mod problem;
pub(super) mod texture_map;
mod vertices;

pub(super) use faces::NO_MATERIAL;
pub(super) use part::{Part, Placement};

use self::faces::{FaceGroup, Faces};
use self::pieces::Pieces;
use self::problem::{BadLine, Cost};
use self::vertices::{VN, VT, Vertices};
use super::error::SceneError;
use super::text::{Lines, Name, plain_text, split_keyword};
use glam::DVec3;
use std::collections::BTreeMap;
use std::path::Path;

/// The geometry of a scene.
#[derive(Debug)]
pub(super) struct Obj {
    /// What each `mtllib` names, in order.
    pub libraries: Vec<Name>,
    /// The triangles by material, in the order of the first faces.
    pub parts: Vec<Part>,
    /// The keywords of lines that are not read, with how many there are and the first.
    pub unread: BTreeMap<Name, (usize, usize)>,
    /// How many vertices have colours, and the line of the first.
    pub coloured: usize,
    /// How many vertices, texture coordinates and normals are unusable, and the first such line.
    pub unusable: Option<(usize, usize)>,
}

/// Whether the first statement that is no comment is one of an OBJ.
pub(super) fn is_obj(content: &[u8]) -> bool {
    let mut keywords = Lines::new(content).map(|(_, line)| split_keyword(&line).0.to_vec());
    let first = keywords.find(|keyword| !keyword.is_empty() && !keyword.starts_with(b"#"));
    let known: [&[u8]; 8] = [b"v", b"vt", b"vn", b"f", b"o", b"g", b"mtllib", b"usemtl"];
    first.is_some_and(|keyword| known.contains(&keyword.as_slice()))
}

/// Polygons stay whole; positions, texture coordinates and normals keep their own indices.
const OPTIONS: tobj::LoadOptions = tobj::LoadOptions {
    triangulate: false,
    single_index: false,
    ignore_points: true,
    ignore_lines: true,
};

impl Obj {
    /// Reads an OBJ file; `path` is for messages only. Without `normals` it has none. The scene may
    /// take so much `memory`, in bytes.
    pub(super) fn parse(
        path: &Path,
        bytes: &[u8],
        normals: bool,
        memory: u64,
    ) -> Result<Self, SceneError> {
        let fail = |what: String| SceneError::ObjContent { path: path.to_owned(), what };
        let text = plain_text(bytes).map_err(fail)?;
        let (vertices, Faces { groups, libraries, unread }) =
            read(text, normals, memory).map_err(|bad| bad.error(path))?;
        if groups.is_empty() {
            return Err(fail(without_faces(text, &unread)));
        }
        let names: Vec<_> = (0..groups.len()).map(|n| format!("usemtl {n}\n")).collect();
        let mut text = plain_form(&vertices.text, &groups, &names);
        let (models, _) =
            tobj::load_obj_buf(&mut text, &OPTIONS, |_| numbered_materials(groups.len()))
                .map_err(|error| fail(format!("cannot be read as OBJ: {error}")))?;
        let parts = models.into_iter().filter_map(|model| {
            let group = groups.get(model.mesh.material_id?)?;
            Some(Part {
                material: group.material.clone(),
                faces: group.faces,
                first_line: group.first_line,
                has_texture_coordinates: group.has[VT],
                second_coordinates: None,
                has_normals: group.has[VN],
                unusable: group.unusable,
                dangling: [group.dangling[VT], group.dangling[VN]],
                mesh: model.mesh,
            })
        });
        let (coloured, unusable) = (vertices.coloured, vertices.unusable());
        Ok(Self { libraries, parts: parts.collect(), unread, coloured, unusable })
    }

    /// The error of a scene with the file `path` that has vertices too far from its `origin`.
    pub(super) fn too_far(path: &Path, bytes: &[u8], origin: DVec3) -> SceneError {
        vertices::too_far(plain_text(bytes).unwrap_or_default(), origin).error(path)
    }

    /// The error of a scene that uses what is unusable, in this line of the file `path`.
    pub(super) fn unusable(path: &Path, bytes: &[u8], line: usize) -> SceneError {
        vertices::explain(plain_text(bytes).unwrap_or_default(), line).error(path)
    }
}

/// What to say of an OBJ without faces, which may be something else.
fn without_faces(text: &[u8], unread: &BTreeMap<Name, (usize, usize)>) -> String {
    let kind = if unread.contains_key(&Name::new(b"newmtl")) {
        " and looks like an MTL"
    } else if text.trim_ascii_start().starts_with(b"{") {
        " and looks like a scene file"
    } else {
        ""
    };
    format!("has no faces{kind}; a scene needs an OBJ with at least one `f` line")
}

fn read(text: &[u8], normals: bool, memory: u64) -> Result<(Vertices, Faces), BadLine> {
    let mut cost = Cost::new(memory);
    let vertices = Vertices::parse(text, normals, &mut cost)?;
    let faces = Faces::parse(text, &vertices, normals, &mut cost)?;
    Ok((vertices, faces))
}

/// One OBJ text for all groups. `names` are the statements that set their materials.
fn plain_form<'a>(vertices: &'a str, groups: &'a [FaceGroup], names: &'a [String]) -> Pieces<'a> {
    let groups = groups.iter().zip(names);
    let faces = groups.flat_map(|(group, name)| [name.as_bytes(), group.text.as_bytes()]);
    let head = [b"mtllib all\n".as_slice(), vertices.as_bytes()];
    Pieces::new(head.into_iter().chain(faces).collect())
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
    use crate::scene::material::MaterialId;
    use glam::{DVec2, Vec2};

    fn parse(text: &str) -> Obj {
        Obj::parse(Path::new("test.obj"), text.as_bytes(), true, 1 << 20).unwrap()
    }

    const AT_ORIGIN: Placement = Placement { transform: None, origin: DVec3::ZERO };

    const SQUARE: &str = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n";

    #[test]
    fn polygons_become_triangles() {
        let obj = parse(&format!("{SQUARE}v -1 .5 0\nf 1 2 3 4 5\nf 1 2 3\nf 1 2 3 4\n"));
        let mesh = obj.parts[0].mesh(MaterialId(0), &AT_ORIGIN, None);
        let fans = [[0, 1, 2], [0, 2, 3], [0, 3, 4], [0, 1, 2], [0, 1, 2], [0, 2, 3]];
        assert_eq!(mesh.triangles, fans);
        assert_eq!(obj.parts[0].triangle_count(), fans.len());
        let alone = parse(&format!("{SQUARE}f 1 2 3\nf 1 3 4\n"));
        assert_eq!(alone.parts[0].triangle_count(), 2);
    }

    #[test]
    fn materials_keep_their_names_without_any_library() {
        let obj = parse(&format!(
            "mtllib my file.mtl\n{SQUARE}usemtl red wall\nf 1 2 3\ng x\nusemtl b\nf 1 2 3"
        ));
        assert_eq!(obj.libraries, [Name::new(b"my file.mtl")]);
        let names: Vec<_> = obj.parts.iter().map(|part| part.material.to_string()).collect();
        assert_eq!(names, ["red wall", "b"]);
    }

    #[test]
    fn names_that_are_not_utf8_stay_apart() {
        let bytes = [SQUARE.as_bytes(), b"usemtl T\xfcr\nf 1 2 3\nusemtl T\xf6r\nf 1 2 3\n"];
        let obj = Obj::parse(Path::new("x"), &bytes.concat(), false, 1 << 20).unwrap();
        let names: Vec<_> = obj.parts.iter().map(|part| part.material.clone()).collect();
        assert_eq!(names, [Name::new(b"T\xfcr"), Name::new(b"T\xf6r")]);
    }

    #[test]
    fn whole_numbers_are_taken_off_texture_coordinates_of_each_triangle() {
        let text = format!(
            "{SQUARE}vt 1000000 -8000000.75\nvt 1000001.25 -8000000.75\nvt 1000000 -7999999.5\n\
             vt 0.25 0.5\nf 1/1 2/2 3/3\nf 1/4 2/4 3/4\n"
        );
        let map = texture_map::TextureMap {
            scale: DVec2::new(2.0, 1.0),
            offset: DVec2::X,
            ..texture_map::TextureMap::default()
        };
        let of = |map| {
            let laid = texture_map::Laid { map, takes_second: false };
            let mesh = parse(&text).parts[0].mesh(MaterialId(0), &AT_ORIGIN, Some(&laid));
            mesh.texture_coordinates.unwrap()
        };
        let corners = |corners: [(f32, f32); 3]| corners.map(|(u, v)| Vec2::new(u, v));
        let plain = of(texture_map::TextureMap::default());
        assert_eq!(plain[0], corners([(0.0, 0.25), (1.25, 0.25), (0.0, 1.5)]));
        assert_eq!(plain[1], [Vec2::new(0.25, 0.5); 3]);
        assert_eq!(of(map)[0], corners([(0.0, 0.25), (2.5, 0.25), (0.0, 1.5)]));
        assert_eq!(of(map)[1], [Vec2::new(0.5, 0.5); 3]);
    }

    #[test]
    fn positions_keep_their_digits_until_the_origin_is_taken_off() {
        let text = "v 5411780.125 0 0\nv 5411780.25 0 0\nv 5411780.125 1 0\nf 1 2 3\n";
        let far = Placement { origin: DVec3::X * 5_411_780.0, ..AT_ORIGIN };
        let mesh = parse(text).parts[0].mesh(MaterialId(0), &far, None);
        assert_eq!(mesh.positions.iter().map(|p| p.x).collect::<Vec<_>>(), [0.125, 0.25, 0.125]);
    }
}
