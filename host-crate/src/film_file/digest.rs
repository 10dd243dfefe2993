//! What a film is of, in few bytes.

use crate::render::PreparedScene;
use sha2::{Digest, Sha256};

/// SHA-256 of all that a device knows of a scene, in hexadecimal: two scenes with the same one look
/// the same.
pub fn scene_digest(scene: &PreparedScene) -> String {
    let mut hash = Sha256::new();
    // Lengths keep the end of one buffer from being taken for the start of the next.
    for words in [bytemuck::cast_slice(&scene.geometry), bytemuck::cast_slice(&scene.surfaces)] {
        update(&mut hash, words);
    }
    update(&mut hash, bytemuck::cast_slice(&scene.texels));
    update(&mut hash, bytemuck::bytes_of(&scene.params));
    hash.update(scene.abilities.to_le_bytes());
    hash.update(format!("{:?} {:?}", scene.camera, scene.limits));
    hexadecimal(&hash.finalize())
}

/// SHA-256 of the list of what the kernels were compiled from, in hexadecimal: films of kernels
/// with different ones need not go together.
pub fn kernels_digest() -> String {
    hexadecimal(&Sha256::digest(include_bytes!("../../shaders/kernels.digest")))
}

fn update(hash: &mut Sha256, bytes: &[u8]) {
    hash.update((bytes.len() as u64).to_le_bytes());
    hash.update(bytes);
}

/// Bytes in hexadecimal: two lower-case digits for each.
pub fn hexadecimal(bytes: &[u8]) -> String {
    bytes.iter().map(|byte| format!("{byte:02x}")).collect()
}
