//! glTF files whose primitives are compressed (`KHR_draco_mesh_compression`).

use crate::gltf::{F32, Gltf, U8, U32};
use draco_core::{
    DataType, EncoderBuffer, EncoderOptions, FaceIndex, GeometryAttributeType, Mesh, MeshEncoder,
    PointAttribute, PointIndex,
};
use serde_json::json;

/// Vertices along a side of the ground.
const SIDE: u32 = 6;

/// An attribute of the ground: its name, its kind there and in compressed meshes, the type of its
/// components and how many there are, its bytes.
struct Attribute {
    name: &'static str,
    kind: GeometryAttributeType,
    component: u32,
    components: u8,
    bytes: Vec<u8>,
}

/// The vertices of a hilly ground and its triangles.
fn ground() -> (Vec<Attribute>, Vec<[u32; 3]>) {
    let places: Vec<[f32; 2]> = (0..SIDE * SIDE)
        .map(|k| [k % SIDE, k / SIDE].map(|c| c as f32 / (SIDE - 1) as f32))
        .collect();
    let floats = |of: &dyn Fn([f32; 2]) -> Vec<f32>| -> Vec<u8> {
        places.iter().flat_map(|&place| of(place)).flat_map(f32::to_le_bytes).collect()
    };
    let attribute = |name, kind, component, components, bytes| Attribute {
        name,
        kind,
        component,
        components,
        bytes,
    };
    let colours = places.iter().flat_map(|[u, v]| [(u * 255.0) as u8, (v * 255.0) as u8, 7, 255]);
    let attributes = vec![
        attribute(
            "POSITION",
            GeometryAttributeType::Position,
            F32,
            3,
            floats(&|[u, v]| vec![u, (7.0 * u).sin() * (5.0 * v).cos() * 0.2, v]),
        ),
        attribute(
            "NORMAL",
            GeometryAttributeType::Normal,
            F32,
            3,
            floats(&|[u, _]| vec![u.sin(), u.cos(), 0.0]),
        ),
        attribute(
            "TEXCOORD_0",
            GeometryAttributeType::TexCoord,
            F32,
            2,
            floats(&|[u, v]| vec![2.0 * u, 1.0 - v]),
        ),
        attribute("COLOR_0", GeometryAttributeType::Color, U8, 4, colours.collect()),
    ];
    let quad = |k: u32| {
        let first = k / (SIDE - 1) * SIDE + k % (SIDE - 1);
        let [a, b, c, d] = [first, first + 1, first + SIDE, first + SIDE + 1];
        [[a, c, b], [b, c, d]]
    };
    (attributes, (0..(SIDE - 1) * (SIDE - 1)).flat_map(quad).collect())
}

/// A hilly ground with normals, texture coordinates and colours, as it is.
pub fn plain() -> Gltf {
    file(false, &EncoderOptions::new())
}

/// The same, compressed by a level, 0 to 10, with so many bits for a component of its positions, or
/// without loss.
pub fn compressed(level: i32, bits: Option<i32>) -> Gltf {
    let mut options = EncoderOptions::new();
    options.set_compression_level(level);
    if let Some(bits) = bits {
        options.set_attribute_quantization(0, bits);
    }
    file(true, &options)
}

fn file(is_compressed: bool, options: &EncoderOptions) -> Gltf {
    let mut gltf = Gltf::new().with_camera();
    let (attributes, triangles) = ground();
    let mut mesh = Mesh::new();
    let (mut accessors, mut ids) = (json!({}), json!({}));
    let count = (SIDE * SIDE) as usize;
    for attribute in &attributes {
        let Attribute { name, kind, component, components, ref bytes } = *attribute;
        let data = if component == F32 { DataType::Float32 } else { DataType::Uint8 };
        let mut points = PointAttribute::new();
        points.init(kind, components, data, component == U8, count);
        points.buffer_mut().write(0, bytes);
        ids[name] = json!(mesh.add_attribute(points));
        let kind = ["SCALAR", "VEC2", "VEC3", "VEC4"][usize::from(components) - 1];
        let accessor = json!({"componentType": component, "type": kind, "count": count,
            "normalized": component == U8});
        let accessor = gltf.add("accessors", accessor);
        accessors[name] = json!(accessor);
        if !is_compressed {
            gltf.json["accessors"][accessor]["bufferView"] = json!(gltf.view(bytes));
        }
    }
    mesh.set_num_faces(triangles.len());
    for (face, corners) in triangles.iter().enumerate() {
        mesh.set_face(FaceIndex(face as u32), corners.map(PointIndex));
    }
    let accessor = json!({"componentType": U32, "type": "SCALAR", "count": 3 * triangles.len()});
    let indices = gltf.add("accessors", accessor);
    let mut primitive = json!({"attributes": accessors, "indices": indices});
    if is_compressed {
        let mut encoder = MeshEncoder::new();
        encoder.set_mesh(mesh);
        let mut bytes = EncoderBuffer::new();
        encoder.encode(options, &mut bytes).unwrap();
        let view = gltf.view(bytes.data());
        let extension = json!({"bufferView": view, "attributes": ids});
        primitive["extensions"] = json!({"KHR_draco_mesh_compression": extension});
        gltf.json["extensionsUsed"] = json!(["KHR_draco_mesh_compression"]);
        gltf.json["extensionsRequired"] = json!(["KHR_draco_mesh_compression"]);
    } else {
        let bytes: Vec<u8> = triangles.iter().flatten().flat_map(|at| at.to_le_bytes()).collect();
        gltf.json["accessors"][indices]["bufferView"] = json!(gltf.view(&bytes));
    }
    let material = json!({"extensions": {"KHR_materials_anisotropy": {"anisotropyStrength": 0.5}}});
    primitive["material"] = json!(gltf.add("materials", material));
    let mesh = gltf.mesh(primitive);
    gltf.node(json!({"mesh": mesh}));
    gltf
}
