//! The textures of a scene in one buffer, in the layout of [`raystream_shaders::scene::texture`].

use crate::color::srgb_decode;
use crate::scene::Texture;
use raystream_shaders::scene::texture::DECODE_WORDS;

/// The textures of a scene.
pub struct Textures {
    /// The buffer.
    pub words: Vec<u32>,
    /// For each texture of the scene, where it lies in the buffer: what names it to the kernels.
    pub places: Vec<u32>,
}

/// Puts textures into one buffer, behind the table that decodes them.
pub fn pack(textures: &[Texture]) -> Textures {
    let mut words: Vec<u32> =
        (0..DECODE_WORDS).map(|code| srgb_to_linear(code).to_bits()).collect();
    let mut places = Vec::with_capacity(textures.len());
    for texture in textures {
        places.push(words.len() as u32);
        words.extend([texture.width, texture.height]);
        words.extend(texture.texels.iter().map(|&texel| u32::from_le_bytes(texel)));
    }
    Textures { words, places }
}

/// The linear value, in [0, 1], of an sRGB code in [0, 255].
fn srgb_to_linear(code: u32) -> f32 {
    srgb_decode(f64::from(code) / 255.0) as f32
}

#[cfg(test)]
mod tests {
    use super::*;
    use raystream_shaders::scene::texture::TextureView;

    #[test]
    fn texels_are_found_where_the_kernels_look() {
        // Red above blue.
        let texels = vec![[255, 0, 0, 255], [0, 0, 128, 255]];
        let Textures { words, places } = pack(&[Texture { width: 1, height: 2, texels }]);
        assert_eq!(places, [DECODE_WORDS]);
        assert_eq!(words[256..], [1, 2, 0xff00_00ff, 0xff80_0000]);
        let view = TextureView::new(&words);
        assert_eq!(view.sample(places[0], 0.5, 0.75), glam::Vec3::X);
        let blue = view.sample(places[0], 0.5, 0.25);
        assert!((blue.z - 0.215_860_5).abs() < 1e-6 && blue.x == 0.0, "{blue}");
    }

    #[test]
    fn the_ends_of_the_srgb_table_are_exact() {
        assert_eq!(srgb_to_linear(0), 0.0);
        assert_eq!(srgb_to_linear(255), 1.0);
        assert!((srgb_to_linear(10) - 0.003_035_27).abs() < 1e-8);
    }
}
