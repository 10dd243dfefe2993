//! The textures of a scene in one buffer, in the layout of [`raystream_shaders::scene::texture`].

use crate::color::srgb_decode;
use crate::scene::{CoordinateSet, Texels, Texture, TextureFilter, Wrap};
use raystream_shaders::scene::texture::{
    BYTES, CLAMP, DECODE_WORDS, FLOATS, MIRROR, NEAREST, PLACED, PLACEMENT_WORDS, REPEAT, SECOND,
    SHORTS,
};
use std::collections::HashMap;
use std::sync::Arc;

/// The textures of a scene.
pub struct Textures {
    /// The buffer.
    pub words: Vec<u32>,
    /// For each texture of the scene, where it lies in the buffer: what names it to the kernels.
    pub places: Vec<u32>,
}

/// Puts textures into one buffer, behind the table that decodes them.
pub fn pack<'a>(textures: impl IntoIterator<Item = &'a Texture>) -> Textures {
    let words = (0..DECODE_WORDS).map(|code| srgb_to_linear(code).to_bits()).collect();
    let mut packed = Packed { words, texels: HashMap::new() };
    let textures: Vec<&Texture> = textures.into_iter().collect();
    let mut places = vec![0; textures.len()];
    // Those that are placed find the texels of those that are not.
    for is_placed in [false, true] {
        for (place, texture) in places.iter_mut().zip(&textures) {
            if texture.is_placed() == is_placed {
                *place = packed.add(texture);
            }
        }
    }
    Textures { words: packed.words, places }
}

/// The buffer as it grows.
struct Packed {
    words: Vec<u32>,
    /// Where texels begin, by their place in memory.
    texels: HashMap<*const Texels, u32>,
}

impl Packed {
    /// Adds a texture; where it begins.
    fn add(&mut self, texture: &Texture) -> u32 {
        let place = self.words.len() as u32;
        let [across, down] = texture.wrap.map(|wrap| match wrap {
            Wrap::Repeat => REPEAT,
            Wrap::Clamp => CLAMP,
            Wrap::Mirror => MIRROR,
        });
        let filter = match texture.filter {
            TextureFilter::Linear => 0,
            TextureFilter::Nearest => NEAREST,
        };
        let format = match *texture.texels {
            Texels::Bytes(_) => BYTES,
            Texels::Shorts(_) => SHORTS,
            Texels::Floats(_) => FLOATS,
        };
        self.words.extend([texture.width | across | format | filter, texture.height | down]);
        let texels = Arc::as_ptr(&texture.texels);
        let behind = self.words.len() as u32;
        if !texture.is_placed() {
            self.texels.entry(texels).or_insert(behind);
            self.add_texels(&texture.texels);
            return place;
        }
        let set = match texture.placement.set {
            CoordinateSet::First => PLACED,
            CoordinateSet::Second => PLACED | SECOND,
        };
        self.words[place as usize + 1] |= set;
        let known = self.texels.get(&texels).copied();
        let first = known.unwrap_or(behind + PLACEMENT_WORDS);
        self.words.push(first);
        self.words.extend(texture.placement.numbers().map(f32::to_bits));
        if known.is_none() {
            self.texels.insert(texels, first);
            self.add_texels(&texture.texels);
        }
        place
    }

    fn add_texels(&mut self, texels: &Texels) {
        let words = &mut self.words;
        let pair = |low: u16, high: u16| u32::from(low) | u32::from(high) << 16;
        match texels {
            Texels::Bytes(texels) => {
                words.extend(texels.iter().map(|&texel| u32::from_le_bytes(texel)));
            }
            Texels::Shorts(texels) => {
                words.extend(texels.iter().flat_map(|&[r, g, b, a]| [pair(r, g), pair(b, a)]));
            }
            Texels::Floats(texels) => {
                words.extend(texels.as_flattened().iter().map(|value| value.to_bits()));
            }
        }
    }
}

/// The linear value, in [0, 1], of an sRGB code in [0, 255].
fn srgb_to_linear(code: u32) -> f32 {
    srgb_decode(f64::from(code) / 255.0) as f32
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::Placement;
    use glam::{Mat2, Vec2, Vec3};
    use raystream_shaders::scene::abilities::{ALL, Fixed};
    use raystream_shaders::scene::texture::{Coordinates, TextureView};

    /// The buffer as the kernels see it.
    fn view(words: &[u32]) -> TextureView<'_, Fixed<ALL>> {
        TextureView::new(words, Fixed)
    }

    fn point(u: f32, v: f32) -> Coordinates {
        Coordinates { first: Vec2::new(u, v), second: Vec2::NAN }
    }

    #[test]
    fn placed_textures_share_texels_and_lie_by_themselves() {
        let plain = Texture::new(2, 2, [0, 51, 102, 255].map(|code| [code; 4]).to_vec());
        // A quarter turn, twice as small, moved; in the second set.
        let placement = Placement {
            set: CoordinateSet::Second,
            matrix: Mat2::from_cols_array_2d(&[[0.0, 2.0], [-2.0, 0.0]]),
            offset: Vec2::new(0.125, -0.25),
        };
        let wrap = [Wrap::Clamp, Wrap::Mirror];
        let placed = Texture { placement, wrap, ..plain.clone() };
        let first = Texture {
            placement: Placement { set: CoordinateSet::First, ..placement },
            ..placed.clone()
        };
        let alone = Texture { texels: Arc::new(Texels::clone(&plain.texels)), ..placed.clone() };
        let there = Texture { wrap, ..plain.clone() };
        let textures = [placed, first, alone, plain.clone(), there];
        let Textures { words, places } = pack(&textures);
        // Texels of those that are not placed, and of the one that has its own.
        let headers = 5 * 2 + 3 * PLACEMENT_WORDS as usize;
        assert_eq!(words.len(), DECODE_WORDS as usize + headers + 3 * 4);
        let view = view(&words);
        for (u, v) in [(0.1, 0.2), (0.7, 0.3), (-0.4, 1.9), (0.55, 0.95)] {
            let uv = placement.of(Vec2::new(u, v));
            assert_eq!(uv, Vec2::new(-2.0 * v + 0.125, 2.0 * u - 0.25));
            let expected = view.codes(places[4], point(uv.x, uv.y));
            let at = Coordinates { first: Vec2::NAN, second: Vec2::new(u, v) };
            assert_eq!(view.codes(places[0], at), expected);
            assert_eq!(view.codes(places[1], point(u, v)), expected);
            assert_eq!(view.codes(places[2], at), expected);
            assert_eq!(
                view.sample(places[1], point(u, v)),
                view.sample(places[4], point(uv.x, uv.y))
            );
        }
    }

    #[test]
    fn texels_of_all_formats_are_found_where_the_kernels_look() {
        // Behind each other, so that a wrong length is seen.
        let shorts = Texels::Shorts(vec![[1000, 20_000, 65_535, 30_000], [3, 2, 1, 0]]);
        let floats = Texels::Floats(vec![[0.25, 7.5, 1e-3], [2.0, 0.5, 1.0]]);
        let bytes = vec![[255, 0, 51, 102]];
        let all = [
            Texture::of(1, 2, shorts),
            Texture::of(2, 1, floats),
            Texture { filter: TextureFilter::Nearest, ..Texture::new(1, 1, bytes) },
        ];
        let Textures { words, places } = pack(&all);
        let looked_up = view(&words);
        let close = |a: Vec3, b: Vec3| (a - b).abs().max_element() < 1e-6;
        let codes = looked_up.codes(places[0], point(0.5, 0.75));
        assert!(close(codes.truncate(), Vec3::new(1000.0, 20_000.0, 65_535.0) / 65_535.0));
        assert!((codes.w * 65_535.0 - 30_000.0).abs() < 0.01, "{codes}");
        let expected = [1000.0, 20_000.0, 65_535.0].map(|c: f64| srgb_decode(c / 65_535.0) as f32);
        assert!(close(looked_up.sample(places[0], point(0.5, 0.75)), Vec3::from(expected)));
        assert_eq!(looked_up.sample(places[1], point(0.25, 0.5)), Vec3::new(0.25, 7.5, 1e-3));
        assert_eq!(looked_up.reflectance(places[1], point(0.25, 0.5)), Vec3::new(0.25, 1.0, 1e-3));
        assert_eq!(
            looked_up.codes(places[1], point(0.75, 0.5)),
            glam::Vec4::new(1.0, 0.5, 1.0, 1.0)
        );
        assert_eq!(looked_up.sample(places[1], point(0.5, 0.5)), Vec3::new(1.125, 4.0, 0.5005));
        let codes = looked_up.codes(places[2], point(0.5, 0.5));
        assert!(close(codes.truncate(), Vec3::new(1.0, 0.0, 0.2)), "{codes}");
        assert!((codes.w - 0.4).abs() < 1e-6, "{codes}");
    }

    #[test]
    fn the_nearest_texel_is_shown_whole() {
        let texels: Vec<[u8; 4]> = [0, 51, 255].map(|code| [code; 4]).to_vec();
        for wrap in [Wrap::Repeat, Wrap::Clamp, Wrap::Mirror] {
            let texture = Texture {
                wrap: [wrap; 2],
                filter: TextureFilter::Nearest,
                ..Texture::new(3, 1, texels.clone())
            };
            let Textures { words, places } = pack(&[texture]);
            for (u, expected) in
                [(0.01, 0.0), (0.32, 0.0), (0.34, 0.2), (0.66, 0.2), (0.67, 1.0), (0.99, 1.0)]
            {
                let found = view(&words).codes(places[0], point(u, 0.1)).x;
                assert!((found - expected).abs() < 1e-6, "{wrap:?} at {u}: {found}");
            }
        }
    }

    #[test]
    fn texels_are_found_where_the_kernels_look() {
        // Red above blue.
        let texels = vec![[255, 0, 0, 255], [0, 0, 128, 255]];
        let Textures { words, places } = pack(&[Texture::new(1, 2, texels)]);
        assert_eq!(places, [DECODE_WORDS]);
        assert_eq!(words[256..], [1, 2, 0xff00_00ff, 0xff80_0000]);
        let view = view(&words);
        assert_eq!(view.sample(places[0], point(0.5, 0.75)), Vec3::X);
        let blue = view.sample(places[0], point(0.5, 0.25));
        assert!((blue.z - 0.215_860_5).abs() < 1e-6 && blue.x == 0.0, "{blue}");
    }

    /// What is looked up at `u`, in the middle between two rows, of three texels that are 0, 51 and
    /// 255 and go on by `wrap`.
    fn looked_up(wrap: Wrap, u: f32) -> f32 {
        let texels = [0, 51, 255].map(|code| [code; 4]).to_vec();
        let texture = Texture { wrap: [wrap, Wrap::Repeat], ..Texture::new(3, 1, texels) };
        let Textures { words, places } = pack(&[texture]);
        view(&words).codes(places[0], point(u, 0.5)).x
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
        let view = view(&words);
        // The upper texel is black; v = 0 is the bottom.
        let found = [-3.0, 0.25, 0.75, 7.0].map(|v| view.codes(places[0], point(9.0, v)).x);
        assert_eq!(found, [1.0, 1.0, 0.0, 0.0]);
    }

    #[test]
    fn the_ends_of_the_srgb_table_are_exact() {
        assert_eq!(srgb_to_linear(0), 0.0);
        assert_eq!(srgb_to_linear(255), 1.0);
        assert!((srgb_to_linear(10) - 0.003_035_27).abs() < 1e-8);
    }
}
