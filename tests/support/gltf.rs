//! glTF files, made in place.

use raystream::scene::{LoadOptions, Scene, SceneError};
use serde_json::{Value, json};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// Component types of accessors.
pub const U8: u32 = 5121;
/// See [`U8`].
pub const I8: u32 = 5120;
/// See [`U8`].
pub const I16: u32 = 5122;
/// See [`U8`].
pub const U16: u32 = 5123;
/// See [`U8`].
pub const U32: u32 = 5125;
/// See [`U8`].
pub const F32: u32 = 5126;

/// A glTF as it is made: JSON to change at will, and its one buffer.
#[derive(Clone)]
pub struct Gltf {
    /// The JSON, but for the length of the buffer.
    pub json: Value,
    /// The buffer.
    pub binary: Vec<u8>,
}

impl Default for Gltf {
    fn default() -> Self {
        Self::new()
    }
}

impl Gltf {
    /// One without anything.
    pub fn new() -> Self {
        let json = json!({
            "asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": []}], "nodes": [],
            "meshes": [], "materials": [], "accessors": [], "bufferViews": [],
            "buffers": [{"byteLength": 0}], "cameras": [], "skins": [], "textures": [],
            "images": [], "samplers": [],
        });
        Self { json, binary: Vec::new() }
    }

    /// A triangle, lit and seen by a camera: what most tests begin with.
    pub fn triangle() -> Self {
        let mut gltf = Self::new();
        let positions = gltf.floats(&[[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]);
        let mesh = gltf.mesh(json!({"attributes": {"POSITION": positions}}));
        gltf.node(json!({"mesh": mesh}));
        gltf.with_camera()
    }

    /// With a camera at (0, 0, 5) that looks along -z.
    pub fn with_camera(mut self) -> Self {
        let camera = json!({"type": "perspective", "perspective":
            {"yfov": 0.7, "znear": 0.1, "aspectRatio": 1.25}});
        let camera = self.add("cameras", camera);
        self.node(json!({"camera": camera, "name": "front", "translation": [0, 0, 5]}));
        self
    }

    /// Adds an element to a list; its number.
    pub fn add(&mut self, list: &str, element: Value) -> usize {
        let list = self.json[list].as_array_mut().unwrap();
        list.push(element);
        list.len() - 1
    }

    /// Adds a node to the scene.
    pub fn node(&mut self, node: Value) -> usize {
        let index = self.add("nodes", node);
        self.json["scenes"][0]["nodes"].as_array_mut().unwrap().push(json!(index));
        index
    }

    /// Adds a mesh of one primitive.
    pub fn mesh(&mut self, primitive: Value) -> usize {
        self.add("meshes", json!({"primitives": [primitive]}))
    }

    /// Adds bytes to the buffer; the number of their view.
    pub fn view(&mut self, bytes: &[u8]) -> usize {
        while !self.binary.len().is_multiple_of(4) {
            self.binary.push(0);
        }
        let view = json!({"buffer": 0, "byteOffset": self.binary.len(), "byteLength": bytes.len()});
        self.binary.extend(bytes);
        self.add("bufferViews", view)
    }

    /// Adds an accessor of all of these bytes.
    pub fn accessor(&mut self, bytes: &[u8], component: u32, kind: &str, count: usize) -> usize {
        let view = self.view(bytes);
        self.add(
            "accessors",
            json!({"bufferView": view, "componentType": component, "type": kind, "count": count}),
        )
    }

    /// Adds an accessor of vectors or scalars.
    pub fn floats<const N: usize>(&mut self, elements: &[[f32; N]]) -> usize {
        let kind = ["SCALAR", "VEC2", "VEC3", "VEC4"].get(N - 1).unwrap_or(&"MAT4");
        let bytes: Vec<u8> = elements.iter().flatten().flat_map(|c| c.to_le_bytes()).collect();
        self.accessor(&bytes, F32, kind, elements.len())
    }

    /// Adds an accessor of indices.
    pub fn indices(&mut self, indices: &[u16]) -> usize {
        let bytes: Vec<u8> = indices.iter().flat_map(|index| index.to_le_bytes()).collect();
        self.accessor(&bytes, U16, "SCALAR", indices.len())
    }

    /// Adds a PNG of these texels, and a texture that shows it with a sampler.
    pub fn texture(&mut self, width: u32, texels: &[[u8; 4]], sampler: Value) -> usize {
        let image = self.image(&png(width, texels));
        let sampler = self.add("samplers", sampler);
        self.add("textures", json!({"source": image, "sampler": sampler}))
    }

    /// Adds a picture file.
    pub fn image(&mut self, bytes: &[u8]) -> usize {
        let view = self.view(bytes);
        self.add("images", json!({"bufferView": view, "mimeType": "image/png"}))
    }

    /// The JSON with the buffer's length.
    pub fn text(&self) -> Value {
        let mut json = self.json.clone();
        if json["buffers"][0]["byteLength"] == 0 {
            json["buffers"][0]["byteLength"] = json!(self.binary.len());
        }
        json
    }

    /// The file, binary.
    pub fn glb(&self) -> Vec<u8> {
        glb(self.text().to_string().as_bytes(), &self.binary)
    }

    /// The scene that it is.
    pub fn load(&self) -> Result<Scene, SceneError> {
        load_bytes(&self.glb())
    }

    /// The scene that it is.
    ///
    /// # Panics
    /// When it is none.
    #[track_caller]
    pub fn scene(&self) -> Scene {
        self.load().unwrap_or_else(|error| panic!("{error}"))
    }
}

/// Loads a file called `a.glb`.
pub fn load_bytes(bytes: &[u8]) -> Result<Scene, SceneError> {
    let files: BTreeMap<PathBuf, Vec<u8>> = [("a.glb".into(), bytes.to_vec())].into();
    LoadOptions { max_memory: 256 << 20, ..LoadOptions::default() }
        .load_files(&files, Path::new("a.glb"))
}

/// A binary glTF of this JSON and this buffer.
pub fn glb(json: &[u8], binary: &[u8]) -> Vec<u8> {
    let padded = |bytes: &[u8], by: u8| {
        let mut bytes = bytes.to_vec();
        bytes.resize(bytes.len().next_multiple_of(4), by);
        bytes
    };
    let (json, binary) = (padded(json, b' '), padded(binary, 0));
    let word = |number: usize| (number as u32).to_le_bytes().to_vec();
    [
        b"glTF".to_vec(),
        word(2),
        word(12 + 8 + json.len() + 8 + binary.len()),
        word(json.len()),
        b"JSON".to_vec(),
        json,
        word(binary.len()),
        b"BIN\0".to_vec(),
        binary,
    ]
    .concat()
}

/// A PNG of these texels, row by row from the top.
pub fn png(width: u32, texels: &[[u8; 4]]) -> Vec<u8> {
    let mut bytes = std::io::Cursor::new(Vec::new());
    let height = texels.len() as u32 / width;
    image::RgbaImage::from_raw(width, height, texels.concat())
        .unwrap()
        .write_to(&mut bytes, image::ImageFormat::Png)
        .unwrap();
    bytes.into_inner()
}
