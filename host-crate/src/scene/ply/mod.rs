//! PLY files: meshes alone, such as scans.

mod element;

use self::element::{Face, Has, Nothing, Vertex};
use crate::scene::bounds::MAX_COORDINATE;
use crate::scene::clean::Cleaner;
use crate::scene::description::Scene;
use crate::scene::environment::{Environment, LIT_BY_DEFAULT};
use crate::scene::error::SceneError;
use crate::scene::film::FilmSize;
use crate::scene::framing::{FRAMED, TO_BE_FRAMED};
use crate::scene::material::Material;
use crate::scene::obj::texture_map::Laid;
use crate::scene::obj::{NO_MATERIAL, Obj, Part, Placement};
use crate::scene::options::LoadOptions;
use crate::scene::recentre::{origin_of, warn_if_moved};
use crate::scene::source::SceneBytes;
use crate::scene::text::Name;
use glam::{DVec2, DVec3, Vec3};
use ply_rs_bw::parser::{ParseError, Parser, Reader};
use ply_rs_bw::ply::{ElementDef, Encoding, Header, PropertyAccess, PropertyType, ScalarType};
use std::path::Path;

/// Grey paint, where a file says nothing of its surface.
const PAINT: Vec3 = Vec3::splat(0.5);
/// Memory that each triangle takes at the peak, by an estimate; that of an OBJ was measured.
const PER_TRIANGLE: u64 = 400;
/// Memory that each vertex takes.
const PER_VERTEX: u64 = 232;

/// Whether a file is a PLY.
pub(in crate::scene) fn is_ply(bytes: &[u8]) -> bool {
    bytes
        .strip_prefix(b"ply")
        .is_some_and(|rest| rest.starts_with(b"\n") || rest.starts_with(b"\r"))
}

/// Loads a PLY as a scene.
pub(in crate::scene) fn load(
    file: SceneBytes<'_>,
    options: &LoadOptions,
) -> Result<Scene, SceneError> {
    let path = file.path;
    let geometry = parse(path, file.bytes, true, options.max_memory)?;
    let origin = origin_of(geometry.parts.iter().map(Part::positions));
    let mut scene = Scene::new(TO_BE_FRAMED, FilmSize::default());
    scene.name = path.file_stem().map_or_else(String::new, |s| s.to_string_lossy().into());
    let is_coloured = geometry.coloured > 0;
    let paint = if is_coloured { Vec3::ONE } else { PAINT };
    let paint = scene.add_material(Material::diffuse(paint));
    let mut cleaner = Cleaner::new(false);
    for part in &geometry.parts {
        let laid = part.has_texture_coordinates.then(Laid::default);
        let mut mesh = part.mesh(paint, &Placement { transform: None, origin }, laid.as_ref());
        cleaner.clean(&mut mesh);
        scene.add_mesh(mesh);
    }
    scene.frame_all();
    scene.set_environment(Environment::studio());
    warn_if_moved(path, origin, &mut scene);
    let path = path.display();
    let mut warn = |what: String| scene.warnings.push(format!("{path}: {what}"));
    if cleaner.degenerate > 0 {
        warn(format!("{} triangles without area were dropped.", cleaner.degenerate));
    }
    let unread: Vec<_> = geometry.unread.keys().map(Name::to_string).collect();
    if !unread.is_empty() {
        warn(format!("these are not read: {}.", crate::scene::error::list(&unread)));
    }
    warn(format!("a PLY has no camera; {FRAMED}"));
    warn(format!("a PLY has no light; {LIT_BY_DEFAULT}"));
    scene.check().map_err(|wrong| SceneError::Part {
        path: file.path.to_owned(),
        place: wrong.place,
        what: wrong.what,
    })?;
    Ok(scene)
}

/// Reads the geometry of a PLY as that of an OBJ whose faces name no material; `path` is for
/// messages only. Without `normals` it has none. The scene may take so much `memory`, in bytes.
pub(in crate::scene) fn parse(
    path: &Path,
    bytes: &[u8],
    normals: bool,
    memory: u64,
) -> Result<Obj, SceneError> {
    let mut file = File { path, bytes, left: memory, memory };
    let (header, mut reader) = file.header()?;
    let mut geometry = Gathered::default();
    for element in header.elements.values() {
        file.check_size(element, header.encoding)?;
        match element.name.as_str() {
            "vertex" => {
                file.charge(element, PER_VERTEX)?;
                geometry.has = Has::of(element, normals);
                geometry.vertices = file.read(&mut reader, element, &header)?;
            }
            "face" => {
                file.charge(element, PER_TRIANGLE)?;
                geometry.faces = file.read(&mut reader, element, &header)?;
            }
            name => {
                geometry.unread.push(format!("element {name}"));
                // Read all the same: what follows lies behind it.
                let _: Vec<Nothing> = file.read(&mut reader, element, &header)?;
            }
        }
    }
    geometry.finish(&mut file)
}

/// A file, and how much memory it may still take.
struct File<'a> {
    path: &'a Path,
    bytes: &'a [u8],
    left: u64,
    memory: u64,
}

impl<'a> File<'a> {
    fn wrong(&self, place: &str, what: impl Into<String>) -> SceneError {
        SceneError::Part { path: self.path.to_owned(), place: place.to_owned(), what: what.into() }
    }

    fn header(&self) -> Result<(Header, Reader<&'a [u8]>), SceneError> {
        if !is_ply(self.bytes) {
            let what = "does not begin with `ply`, as a PLY does".to_owned();
            return Err(SceneError::WrongKind { path: self.path.to_owned(), what });
        }
        let mut reader = Reader::new(self.bytes);
        let header = Parser::<Nothing>::new()
            .read_header(&mut reader)
            .map_err(|error| self.wrong("the header", said(&error)))?;
        Ok((header, reader))
    }

    /// Fails if a file is too short for what its header promises.
    fn check_size(&self, element: &ElementDef, encoding: Encoding) -> Result<(), SceneError> {
        let least: usize = match encoding {
            // A line with a digit and a space for each.
            Encoding::Ascii => (2 * element.properties.len()).saturating_sub(1),
            _ => element.properties.values().map(|property| least_bytes(&property.data_type)).sum(),
        };
        let place = format!("element {}", element.name);
        if least == 0 && element.count > 0 {
            return Err(self.wrong(&place, "has no properties"));
        }
        if element.count.saturating_mul(least) > self.bytes.len() {
            let what =
                format!("there are {} by the header, but the file is shorter", element.count);
            return Err(self.wrong(&place, what));
        }
        Ok(())
    }

    fn charge(&mut self, element: &ElementDef, each: u64) -> Result<(), SceneError> {
        let bytes = (element.count as u64).saturating_mul(each);
        self.charge_bytes(bytes, &format!("element {}", element.name))
    }

    fn charge_bytes(&mut self, bytes: u64, place: &str) -> Result<(), SceneError> {
        let too_large = || SceneError::TooLarge {
            path: self.path.to_owned(),
            place: place.to_owned(),
            limit: self.memory,
        };
        self.left = self.left.checked_sub(bytes).ok_or_else(too_large)?;
        Ok(())
    }

    fn read<E: PropertyAccess>(
        &self,
        reader: &mut Reader<&[u8]>,
        element: &ElementDef,
        header: &Header,
    ) -> Result<Vec<E>, SceneError> {
        Parser::<E>::new()
            .read_payload_for_element(reader, element, header)
            .map_err(|error| self.wrong(&format!("element {}", element.name), said(&error)))
    }
}

/// What the crate says, in one line.
fn said(error: &ParseError) -> String {
    const LONGEST: usize = 300;
    let text = error.to_string();
    let words: Vec<_> = text.split_whitespace().collect();
    words.join(" ").chars().filter(|c| !c.is_control()).take(LONGEST).collect()
}

fn least_bytes(property: &PropertyType) -> usize {
    let (PropertyType::Scalar(scalar) | PropertyType::List(scalar, _)) = property;
    match scalar {
        ScalarType::Char | ScalarType::UChar => 1,
        ScalarType::Short | ScalarType::UShort => 2,
        ScalarType::Int | ScalarType::UInt | ScalarType::Float => 4,
        ScalarType::Double => 8,
    }
}

/// The elements of a file.
#[derive(Default)]
struct Gathered {
    vertices: Vec<Vertex>,
    faces: Vec<Face>,
    has: Has,
    unread: Vec<String>,
}

impl Gathered {
    fn finish(self, file: &mut File<'_>) -> Result<Obj, SceneError> {
        let mut mesh = tobj::Mesh::default();
        let used = self.faces_into(&mut mesh, file)?;
        let origin = self.origin(&used, file)?;
        self.vertices_into(&mut mesh, &used, origin);
        let Self { vertices, has, mut unread, .. } = self;
        if vertices.iter().any(|vertex| vertex.colour[3] != 1.0) {
            unread.push("alpha of vertices".to_owned());
        }
        let part = Part {
            material: Name::new(NO_MATERIAL),
            faces: mesh.face_arities.len(),
            first_line: 0,
            has_texture_coordinates: has.texture_coordinates,
            second_coordinates: has.second_coordinates.then(|| second_coordinates(&vertices)),
            has_normals: has.normals,
            unusable: [None; 3],
            dangling: [(0, 0); 2],
            mesh,
        };
        Ok(Obj {
            libraries: Vec::new(),
            parts: vec![part],
            unread: unread.into_iter().map(|name| (Name::new(name.as_bytes()), (1, 0))).collect(),
            coloured: if has.colours { vertices.len() } else { 0 },
            unusable: None,
        })
    }

    /// Puts the faces into a mesh; tells for each vertex whether a face uses it.
    fn faces_into(
        &self,
        mesh: &mut tobj::Mesh,
        file: &mut File<'_>,
    ) -> Result<Vec<bool>, SceneError> {
        let Self { vertices, faces, .. } = self;
        if faces.is_empty() {
            let what = if vertices.is_empty() { "it is empty" } else { "it is a cloud of points" };
            return Err(file.wrong("element face", format!("there are no faces: {what}")));
        }
        let mut used = vec![false; vertices.len()];
        for (number, face) in faces.iter().enumerate() {
            let place = || format!("element face, number {number}");
            let corners = face.corners.as_deref().ok_or_else(|| {
                file.wrong(
                    &place(),
                    "needs a list vertex_indices of integers that are not negative",
                )
            })?;
            if let Some(beyond) = corners.iter().find(|&&at| at as usize >= vertices.len()) {
                let what = format!("names vertex {beyond}, but there are {}", vertices.len());
                return Err(file.wrong(&place(), what));
            }
            // A fan of the corners has two triangles less than they are.
            if corners.len() > 4 {
                file.charge_bytes(PER_TRIANGLE * (corners.len() - 4) as u64, &place())?;
            }
            if corners.len() >= 3 {
                corners.iter().for_each(|&at| used[at as usize] = true);
                mesh.indices.extend(corners);
                mesh.face_arities.push(corners.len() as u32);
            }
        }
        Ok(used)
    }

    /// The middle of the vertices, which those that faces use must be near.
    fn origin(&self, used: &[bool], file: &File<'_>) -> Result<DVec3, SceneError> {
        let places = || self.vertices.iter().map(|vertex| DVec3::from_array(vertex.position));
        let finite: Vec<DVec3> = places().filter(|place| place.is_finite()).collect();
        let origin = origin_of(std::iter::once(finite.into_iter()));
        let is_near = |place: DVec3| (place - origin).abs().max_element() <= MAX_COORDINATE;
        let far = places().zip(used).position(|(place, used)| *used && !is_near(place));
        let Some(vertex) = far else { return Ok(origin) };
        let what = format!(
            "is more than {MAX_COORDINATE:e} from the middle of the others, or is no number"
        );
        Err(file.wrong(&format!("element vertex, number {vertex}"), what))
    }

    /// Puts the vertices into a mesh that has its faces.
    fn vertices_into(&self, mesh: &mut tobj::Mesh, used: &[bool], origin: DVec3) {
        for (vertex, used) in self.vertices.iter().zip(used) {
            // What no face uses need not be a place.
            mesh.positions.extend(if *used { vertex.position } else { origin.to_array() });
            if self.has.normals {
                mesh.normals.extend(vertex.normal);
            }
            if self.has.colours {
                let [colour @ .., _] = vertex.colour;
                let share = |value: f64| if value.is_nan() { 1.0 } else { value.clamp(0.0, 1.0) };
                mesh.vertex_color.extend(colour.map(share));
            }
            if self.has.texture_coordinates {
                mesh.texcoords.extend(vertex.texture_coordinates.map(usable));
            }
        }
        if self.has.normals {
            mesh.normal_indices.clone_from(&mesh.indices);
        }
        if self.has.texture_coordinates {
            mesh.texcoord_indices.clone_from(&mesh.indices);
        }
    }
}

/// The second texture coordinates of vertices.
fn second_coordinates(vertices: &[Vertex]) -> Vec<DVec2> {
    vertices.iter().map(|vertex| DVec2::from(vertex.second_coordinates.map(usable))).collect()
}

/// A texture coordinate, or 0 where it is none.
fn usable(coordinate: f64) -> f64 {
    if coordinate.abs() <= 1e12 { coordinate } else { 0.0 }
}
