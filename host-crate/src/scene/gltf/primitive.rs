//! The parts of meshes.

use super::document::Document;
use super::geometry::Geometry;
use super::layout::Layout;
use super::material::{CornersHave, Materials, Surface, VertexColour};
use super::variants::Variants;
use crate::scene::bounds::MAX_COORDINATE;
use crate::scene::description::Scene;
use crate::scene::error::SceneError;
use glam::{Vec2, Vec3, Vec4};
use gltf::json;
use gltf::json::mesh::{Mode, Semantic};
use gltf::json::validation::Checked::Valid;
use std::rc::Rc;

/// A part of a mesh, by its place in the file.
pub(super) struct Primitive<'a, 'd> {
    pub document: &'a Document<'d>,
    /// The number of the mesh, which is there.
    pub mesh: usize,
    /// Its own number in the mesh, which is there.
    pub number: usize,
}

/// What is shown of a primitive.
#[derive(Clone)]
pub(super) struct Shape {
    /// None where it has no triangles.
    pub geometry: Option<Rc<Geometry>>,
    pub surface: Surface,
}

impl Shape {
    const NOTHING: Self = Self { geometry: None, surface: Surface::Nothing };
}

/// How many primitives lack something.
#[derive(Default)]
pub(super) struct Lacks {
    points_and_lines: usize,
    positions: usize,
    numbers: usize,
}

impl Lacks {
    /// Says what is lacking.
    pub(super) fn finish(self, document: &Document<'_>, scene: &mut Scene) {
        let remarks = [
            (self.points_and_lines, "parts of meshes that are points or lines are not shown"),
            (self.positions, "parts of meshes without POSITION are not shown"),
            (
                self.numbers,
                "parts of meshes have normals, tangents or texture coordinates that are no numbers",
            ),
        ];
        for (count, what) in remarks.into_iter().filter(|(count, _)| *count > 0) {
            scene.warnings.push(document.warning(&format!("{what}: {count}.")));
        }
    }
}

impl Primitive<'_, '_> {
    /// The primitive as the file has it.
    pub(super) fn json(&self) -> &json::mesh::Primitive {
        &self.document.root.meshes[self.mesh].primitives[self.number]
    }

    /// Where it is in the file.
    pub(super) fn place(&self) -> String {
        format!("meshes[{}].primitives[{}]", self.mesh, self.number)
    }

    /// The accessor of an attribute.
    pub(super) fn attribute(&self, semantic: Semantic) -> Option<usize> {
        self.json().attributes.get(&Valid(semantic)).map(json::Index::value)
    }

    /// An attribute of `count` vertices.
    pub(super) fn vectors<const N: usize>(
        &self,
        accessor: usize,
        name: &str,
        count: usize,
    ) -> Result<Vec<[f32; N]>, SceneError> {
        let vectors = self.document.numbers(accessor, &self.attribute_place(name))?;
        self.check_count(name, vectors.len(), count)?;
        Ok(vectors)
    }

    /// Fails if an attribute has not an element for each position.
    pub(super) fn check_count(
        &self,
        name: &str,
        found: usize,
        count: usize,
    ) -> Result<(), SceneError> {
        if found == count {
            return Ok(());
        }
        let what = format!("has {found} elements, but there are {count} positions");
        Err(self.document.wrong(&self.attribute_place(name), what))
    }

    /// Where an attribute is in the file.
    pub(super) fn attribute_place(&self, name: &str) -> String {
        format!("{}.attributes.{name}", self.place())
    }

    /// Its triangles and what they are made of, in the space of the mesh.
    pub(super) fn shape(
        &self,
        variants: &Variants,
        materials: &mut Materials<'_>,
        scene: &mut Scene,
        lacks: &mut Lacks,
    ) -> Result<Shape, SceneError> {
        let Valid(mode) = self.json().mode else {
            return Err(self
                .document
                .wrong(&format!("{}.mode", self.place()), "is none of glTF's"));
        };
        if matches!(mode, Mode::Points | Mode::Lines | Mode::LineLoop | Mode::LineStrip) {
            lacks.points_and_lines += 1;
            return Ok(Shape::NOTHING);
        }
        let Some(positions) = self.attribute(Semantic::Positions) else {
            lacks.positions += 1;
            return Ok(Shape::NOTHING);
        };
        let place = self.attribute_place("POSITION");
        let positions = self.document.numbers::<3>(positions, &place)?;
        let count = positions.len();
        let triangles = self.triangles(mode, count)?;
        if triangles.is_empty() {
            return Ok(Shape::NOTHING);
        }
        let mut has_all_numbers = true;
        let normals = self.normals(count, &mut has_all_numbers)?;
        let (colour, colours) = self.colours(count)?;
        let has_set = |set: u32| self.attribute(Semantic::TexCoords(set)).is_some();
        let material = variants.material(self)?;
        let has_tangents = normals.is_some() && self.attribute(Semantic::Tangents).is_some();
        let corners = CornersHave { set: &has_set, tangents: has_tangents };
        let made = materials.surface(material, colour, corners, &self.place(), scene)?;
        let mut coordinates = |layout: Option<Layout>| match layout {
            Some(layout) => self.texture_coordinates(&layout, count, &mut has_all_numbers),
            None => Ok(None),
        };
        let [first, second] = made.layouts;
        let (texture_coordinates, second_coordinates) = (coordinates(first)?, coordinates(second)?);
        let takes_tangents = match made.surface {
            Surface::Of(id) => scene.materials[id.0 as usize].takes_tangents(),
            Surface::Nothing => false,
        };
        let tangents = match takes_tangents && has_tangents {
            true => self.tangents(count, &mut has_all_numbers)?,
            false => None,
        };
        lacks.numbers += usize::from(!has_all_numbers);
        let geometry = Geometry {
            positions: positions.into_iter().map(Vec3::from_array).collect(),
            normals,
            texture_coordinates,
            second_coordinates,
            colours,
            tangents,
            triangles,
            is_joined: mode == Mode::TriangleStrip,
        };
        Ok(Shape { geometry: Some(Rc::new(geometry)), surface: made.surface })
    }

    /// The normals of its vertices, if it has any. One that is no vector is zero, and is noted.
    fn normals(
        &self,
        count: usize,
        has_all_numbers: &mut bool,
    ) -> Result<Option<Vec<Vec3>>, SceneError> {
        let Some(accessor) = self.attribute(Semantic::Normals) else { return Ok(None) };
        let usable = |normal: [f32; 3]| {
            let normal = Vec3::from_array(normal);
            *has_all_numbers &= normal.is_finite();
            if normal.is_finite() { normal } else { Vec3::ZERO }
        };
        let normals = self.vectors::<3>(accessor, "NORMAL", count)?;
        Ok(Some(normals.into_iter().map(usable).collect()))
    }

    /// The tangents of its vertices, if it has any. One that is no vector is zero, and is noted.
    fn tangents(
        &self,
        count: usize,
        has_all_numbers: &mut bool,
    ) -> Result<Option<Vec<Vec4>>, SceneError> {
        let Some(accessor) = self.attribute(Semantic::Tangents) else { return Ok(None) };
        let usable = |[x, y, z, side]: [f32; 4]| {
            let along = Vec3::new(x, y, z);
            *has_all_numbers &= along.is_finite() && !side.is_nan();
            let along = if along.is_finite() { along.normalize_or_zero() } else { Vec3::ZERO };
            if along == Vec3::ZERO {
                return Vec4::ZERO;
            }
            along.extend(if side < 0.0 { -1.0 } else { 1.0 })
        };
        let tangents = self.vectors::<4>(accessor, "TANGENT", count)?;
        Ok(Some(tangents.into_iter().map(usable).collect()))
    }

    /// The texture coordinates of its vertices, if it has any, in a layout. Some that are no
    /// numbers of use are zero, and are noted.
    fn texture_coordinates(
        &self,
        layout: &Layout,
        count: usize,
        has_all_numbers: &mut bool,
    ) -> Result<Option<Vec<Vec2>>, SceneError> {
        let Some(accessor) = self.attribute(Semantic::TexCoords(layout.set)) else {
            return Ok(None);
        };
        let name = format!("TEXCOORD_{}", layout.set);
        let usable = |uv: [f32; 2]| {
            let uv = layout.of(uv);
            let is_usable = uv.abs().max_element() <= MAX_COORDINATE as f32;
            *has_all_numbers &= is_usable && !uv.is_nan();
            if is_usable && !uv.is_nan() { uv } else { Vec2::ZERO }
        };
        let coordinates = self.vectors::<2>(accessor, &name, count)?;
        Ok(Some(coordinates.into_iter().map(usable).collect()))
    }

    /// The colour that all of its vertices have, and those of each where they differ or let light
    /// pass.
    fn colours(&self, count: usize) -> Result<(VertexColour, Option<Vec<Vec4>>), SceneError> {
        let Some(accessor) = self.attribute(Semantic::Colors(0)) else {
            return Ok((VertexColour::WHITE, None));
        };
        let name = "COLOR_0";
        let components = self.document.components(accessor, &self.attribute_place(name))?;
        let colours: Vec<[f32; 4]> = if components == 3 {
            let opaque = |[r, g, b]: [f32; 3]| [r, g, b, 1.0];
            self.vectors::<3>(accessor, name, count)?.into_iter().map(opaque).collect()
        } else {
            self.vectors::<4>(accessor, name, count)?
        };
        let share = |c: f32| if c.is_nan() { 0.0 } else { c.clamp(0.0, 1.0) };
        let colours: Vec<Vec4> = colours.iter().map(|colour| colour.map(share).into()).collect();
        let first = colours.first().copied().unwrap_or(Vec4::ONE);
        let is_opaque = colours.iter().all(|colour| colour.w == 1.0);
        if is_opaque && colours.iter().all(|colour| *colour == first) {
            return Ok((VertexColour { colour: first.truncate(), is_opaque }, None));
        }
        Ok((VertexColour { colour: Vec3::ONE, is_opaque }, Some(colours)))
    }

    /// The corners of its triangles among `count` vertices.
    fn triangles(&self, mode: Mode, count: usize) -> Result<Vec<[u32; 3]>, SceneError> {
        let place = format!("{}.indices", self.place());
        let indices: Vec<u32> = match self.json().indices {
            Some(accessor) => {
                let indices = self.document.indices::<1>(accessor.value(), &place)?;
                indices.into_iter().flatten().collect()
            }
            None => (0..count as u32).collect(),
        };
        if let Some(at) = indices.iter().position(|&index| index as usize >= count) {
            let what = format!("names vertex {}, but there are {count}", indices[at]);
            return Err(self.document.wrong(&format!("{place}, number {at}"), what));
        }
        Ok(match mode {
            Mode::TriangleStrip => {
                let turn = |(at, corners): (usize, &[u32])| match at % 2 {
                    0 => [corners[0], corners[1], corners[2]],
                    _ => [corners[1], corners[0], corners[2]],
                };
                indices.windows(3).enumerate().map(turn).collect()
            }
            Mode::TriangleFan => {
                let fan = indices.get(1..).unwrap_or_default().windows(2);
                fan.map(|pair| [indices[0], pair[0], pair[1]]).collect()
            }
            _ => indices
                .chunks_exact(3)
                .map(|corners| [corners[0], corners[1], corners[2]])
                .collect(),
        })
    }
}
