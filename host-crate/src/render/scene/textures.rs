//! The textures of a scene in one buffer, in the layout of [`raystream_shaders::scene::texture`].

use crate::color::srgb_decode;
use crate::scene::{Texture, Wrap};
use raystream_shaders::scene::texture::{CLAMP, DECODE_WORDS, MIRROR, REPEAT};

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
        let [across, down] = texture.wrap.map(|wrap| match wrap {
            Wrap::Repeat => REPEAT,
            Wrap::Clamp => CLAMP,
            Wrap::Mirror => MIRROR,
        });
        words.extend([texture.width | across, texture.height | down]);
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
        let Textures { words, places } = pack(&[Texture::new(1, 2, texels)]);
        assert_eq!(places, [DECODE_WORDS]);
        assert_eq!(words[256..], [1, 2, 0xff00_00ff, 0xff80_0000]);
        let view = TextureView::new(&words);
        assert_eq!(view.sample(places[0], 0.5, 0.75), glam::Vec3::X);
        let blue = view.sample(places[0], 0.5, 0.25);
        assert!((blue.z - 0.215_860_5).abs() < 1e-6 && blue.x == 0.0, "{blue}");
    }

    /// What is looked up at `u`, in the middle between two rows, of three texels that are 0, 51 and
    /// 255 and go on by `wrap`.
    fn looked_up(wrap: Wrap, u: f32) -> f32 {
        let texels = [0, 51, 255].map(|code| [code; 4]).to_vec();
        let texture = Texture { wrap: [wrap, Wrap::Repeat], ..Texture::new(3, 1, texels) };
        let Textures { words, places } = pack(&[texture]);
        TextureView::new(&words).codes(places[0], u, 0.5).x
    }

    #[test]
    fn textures_go_on_beyond_their_edges() {
        let (a, b, c) = (0.0, 0.2, 1.0);
        // At each centre of a texel from two lengths before the texture to two behind it.
        let expected = [
            (Wrap::Repeat, [a, b, c, a, b, c, a, b, c, a, b, c, a, b, c]),
            (Wrap::Clamp, [a, a, a, a, a, a, a, b, c, c, c, c, c, c, c]),
            (Wrap::Mirror, [a, b, c, c, b, a, a, b, c, c, b, a, a, b, c]),
        ];
        for (wrap, row) in expected {
            for (texel, expected) in row.into_iter().enumerate() {
                let u = (texel as f32 - 5.5) / 3.0;
                let found = looked_up(wrap, u);
                assert!((found - expected).abs() < 1e-5, "{wrap:?} at {u}: {found}");
            }
        }
        // Half way beyond an edge: with the other end, with itself, with itself.
        for (wrap, left, right) in
            [(Wrap::Repeat, 0.5, 0.5), (Wrap::Clamp, 0.0, 1.0), (Wrap::Mirror, 0.0, 1.0)]
        {
            let found = [looked_up(wrap, 0.0), looked_up(wrap, 1.0)];
            assert!((found[0] - left).abs() < 1e-5, "{wrap:?}: {found:?}");
            assert!((found[1] - right).abs() < 1e-5, "{wrap:?}: {found:?}");
        }
    }

    #[test]
    fn each_direction_goes_on_by_itself() {
        let texels = vec![[0; 4], [255; 4]];
        let wrap = [Wrap::Repeat, Wrap::Clamp];
        let Textures { words, places } = pack(&[Texture { wrap, ..Texture::new(1, 2, texels) }]);
        let view = TextureView::new(&words);
        // The upper texel is black; v = 0 is the bottom.
        let found = [-3.0, 0.25, 0.75, 7.0].map(|v| view.codes(places[0], 9.0, v).x);
        assert_eq!(found, [1.0, 1.0, 0.0, 0.0]);
    }

    #[test]
    fn the_ends_of_the_srgb_table_are_exact() {
        assert_eq!(srgb_to_linear(0), 0.0);
        assert_eq!(srgb_to_linear(255), 1.0);
        assert!((srgb_to_linear(10) - 0.003_035_27).abs() < 1e-8);
    }
}
