//! glTF files whose views are compressed (`EXT_meshopt_compression`).

use crate::gltf::{Gltf, U16};
use serde_json::{Value, json};

/// Rows as a stream that stores each difference as a byte.
pub fn attributes(rows: &[u8], stride: usize) -> Vec<u8> {
    let count = rows.len() / stride;
    let groups = count.div_ceil(16);
    let mut stream = vec![0xa0];
    for column in 0..stride {
        stream.extend(vec![0xff; groups.div_ceil(4)]);
        let mut last = 0_u8;
        for row in 0..groups * 16 {
            let value = if row < count { rows[row * stride + column] } else { last };
            let step = value.wrapping_sub(last) as i8;
            stream.push((step << 1 ^ step >> 7) as u8);
            last = value;
        }
    }
    stream.extend(vec![0; stride.max(32)]);
    stream
}

/// Adds a compressed view; the one that it stands for lies in a buffer without bytes.
pub fn add(gltf: &mut Gltf, stream: &[u8], [count, stride]: [usize; 2], more: Value) -> usize {
    let stored = gltf.view(stream);
    let mut extension = gltf.json["bufferViews"][stored].clone();
    extension["byteStride"] = json!(stride);
    extension["count"] = json!(count);
    extension.as_object_mut().unwrap().extend(more.as_object().unwrap().clone());
    if gltf.json["buffers"].as_array().unwrap().len() < 2 {
        let fallback = json!({"EXT_meshopt_compression": {"fallback": true}});
        gltf.add("buffers", json!({"byteLength": 100_000, "extensions": fallback}));
    }
    gltf.json["extensionsUsed"] = json!(["EXT_meshopt_compression"]);
    gltf.json["extensionsRequired"] = json!(["EXT_meshopt_compression"]);
    let extensions = json!({"EXT_meshopt_compression": extension});
    let view = json!({"buffer": 1, "byteLength": count * stride, "extensions": extensions});
    gltf.add("bufferViews", view)
}

/// Two triangles whose positions and indices are compressed.
pub fn compressed() -> Gltf {
    let mut gltf = Gltf::new().with_camera();
    let corners = [[0.0_f32, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.5]];
    let bytes: Vec<u8> = corners.iter().flatten().flat_map(|x| x.to_le_bytes()).collect();
    let view = add(&mut gltf, &attributes(&bytes, 12), [4, 12], json!({"mode": "ATTRIBUTES"}));
    let positions = gltf.add(
        "accessors",
        json!({"bufferView": view, "componentType": 5126, "type": "VEC3", "count": 4}),
    );
    // Three new vertices, then one at the edge from 0 to 2.
    let triangles = [&[0xe1, 0xf0, 0x00][..], &[0; 16]].concat();
    let view = add(&mut gltf, &triangles, [6, 2], json!({"mode": "TRIANGLES"}));
    let indices = gltf.add(
        "accessors",
        json!({"bufferView": view, "componentType": U16, "type": "SCALAR", "count": 6}),
    );
    let mesh = gltf.mesh(json!({"attributes": {"POSITION": positions}, "indices": indices}));
    gltf.node(json!({"mesh": mesh}));
    gltf
}
