//! What is kept of a PLY's elements.

use ply_rs_bw::ply::{ElementDef, Property, PropertyAccess, PropertyAccessResult};

/// An element of which nothing is kept.
pub(super) struct Nothing;

impl PropertyAccess for Nothing {
    fn new() -> Self {
        Self
    }
}

/// A vertex.
#[derive(Default)]
pub(super) struct Vertex {
    pub position: [f64; 3],
    pub normal: [f64; 3],
    pub texture_coordinates: [f64; 2],
}

impl PropertyAccess for Vertex {
    fn new() -> Self {
        Self::default()
    }

    fn set_property(&mut self, name: &str, value: Property) -> PropertyAccessResult {
        let value = match value {
            Property::Double(value) => value,
            other => match other.to_f32_lossy() {
                Some(value) => value.into(),
                None => return PropertyAccessResult::Ignored,
            },
        };
        let place = match name {
            "x" => &mut self.position[0],
            "y" => &mut self.position[1],
            "z" => &mut self.position[2],
            "nx" => &mut self.normal[0],
            "ny" => &mut self.normal[1],
            "nz" => &mut self.normal[2],
            "u" | "s" | "texture_u" | "texture_s" => &mut self.texture_coordinates[0],
            "v" | "t" | "texture_v" | "texture_t" => &mut self.texture_coordinates[1],
            _ => return PropertyAccessResult::Ignored,
        };
        *place = value;
        PropertyAccessResult::Set
    }
}

/// A polygon.
#[derive(Default)]
pub(super) struct Face {
    /// None where an index is negative.
    pub corners: Option<Vec<u32>>,
}

impl PropertyAccess for Face {
    fn new() -> Self {
        Self::default()
    }

    fn set_property(&mut self, name: &str, value: Property) -> PropertyAccessResult {
        if !matches!(name, "vertex_indices" | "vertex_index") {
            return PropertyAccessResult::Ignored;
        }
        self.corners = value.to_u32_list();
        PropertyAccessResult::Set
    }
}

/// What vertices have.
#[derive(Clone, Copy, Default)]
pub(super) struct Has {
    pub normals: bool,
    pub texture_coordinates: bool,
    pub colours: bool,
}

impl Has {
    pub(super) fn of(element: &ElementDef, normals: bool) -> Self {
        let has = |names: &[&str]| names.iter().any(|name| element.properties.contains_key(*name));
        Self {
            normals: normals && has(&["nx"]) && has(&["ny"]) && has(&["nz"]),
            texture_coordinates: has(&["u", "s", "texture_u", "texture_s"])
                && has(&["v", "t", "texture_v", "texture_t"]),
            colours: has(&["red", "diffuse_red", "r"]),
        }
    }
}
