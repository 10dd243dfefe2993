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
pub(super) struct Vertex {
    pub position: [f64; 3],
    pub normal: [f64; 3],
    pub texture_coordinates: [f64; 2],
    pub second_coordinates: [f64; 2],
    /// Red, green, blue and alpha; numbers that are integers in the file are shares of the largest.
    pub colour: [f64; 4],
}

impl Default for Vertex {
    fn default() -> Self {
        Self {
            position: [0.0; 3],
            normal: [0.0; 3],
            texture_coordinates: [0.0; 2],
            second_coordinates: [0.0; 2],
            colour: [1.0; 4],
        }
    }
}

impl PropertyAccess for Vertex {
    fn new() -> Self {
        Self::default()
    }

    fn set_property(&mut self, name: &str, value: Property) -> PropertyAccessResult {
        let largest = match value {
            Property::UChar(_) => u8::MAX.into(),
            Property::UShort(_) => u16::MAX.into(),
            _ => 1.0,
        };
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
            "u1" | "s1" => &mut self.second_coordinates[0],
            "v1" | "t1" => &mut self.second_coordinates[1],
            _ => {
                let Some(channel) = channel(name) else { return PropertyAccessResult::Ignored };
                self.colour[channel] = value / largest;
                return PropertyAccessResult::Set;
            }
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
    /// A second set of them, beside the first.
    pub second_coordinates: bool,
    pub colours: bool,
}

impl Has {
    pub(super) fn of(element: &ElementDef, normals: bool) -> Self {
        let has = |names: &[&str]| names.iter().any(|name| element.properties.contains_key(*name));
        let texture_coordinates = has(&["u", "s", "texture_u", "texture_s"])
            && has(&["v", "t", "texture_v", "texture_t"]);
        Self {
            texture_coordinates,
            second_coordinates: texture_coordinates && has(&["u1", "s1"]) && has(&["v1", "t1"]),
            normals: normals && has(&["nx"]) && has(&["ny"]) && has(&["nz"]),
            colours: (0..3)
                .all(|wanted| element.properties.keys().any(|name| channel(name) == Some(wanted))),
        }
    }
}

/// Which channel of a colour a property is.
fn channel(name: &str) -> Option<usize> {
    Some(match name {
        "red" | "diffuse_red" | "r" => 0,
        "green" | "diffuse_green" | "g" => 1,
        "blue" | "diffuse_blue" | "b" => 2,
        "alpha" | "diffuse_alpha" | "a" => 3,
        _ => return None,
    })
}
