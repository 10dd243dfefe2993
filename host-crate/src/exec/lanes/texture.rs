//! Texture lookup for `N` points: [`raystream_shaders::scene::texture`] side by side, of textures
//! of bytes that repeat along both sides. Others are looked up one by one.

use super::numbers::{Floats, Mask, Words, floats, words};
use super::scene::Scene;
use super::vectors::Vectors;
use glam::{Vec2, Vec3};
use raystream_shaders::scene::texture::{CLAMP, Coordinates, DECODE_WORDS};

/// What is added to a whole number of less than 23 bits to have it as an integer in the lowest
/// bits. Of no number it makes one that no texture has room for.
const WHOLE: f32 = 12_582_912.0;

/// [`TextureView::reflectance`](raystream_shaders::scene::texture::TextureView::reflectance) of
/// lanes that `have_one`, of these `textures` at these coordinates; zero in others.
#[inline(always)]
pub fn reflectances<const N: usize>(
    scene: &Scene<'_>,
    have_one: Mask<N>,
    textures: Words<N>,
    [u, v]: [Floats<N>; 2],
) -> Vectors<N> {
    let side = |offset: u32| {
        words(|lane| {
            let place = (textures.0[lane].wrapping_add(offset)) as usize;
            if have_one.holds(lane) { scene.texels[place] } else { 1 }
        })
    };
    let (widths, heights) = (side(0), side(1));
    let edge = Words::splat(CLAMP);
    let repeat = have_one & widths.below(edge) & heights.below(edge);
    let mut colours = bilinear(scene, repeat, textures, [widths, heights], [u, v]);
    let others = have_one & !repeat;
    if others.any() {
        for lane in 0..N {
            if others.holds(lane) {
                let place = Coordinates::both(Vec2::new(u.0[lane], v.0[lane]));
                let view = &scene.view.surfaces.textures;
                colours.set(lane, view.reflectance(textures.0[lane], place));
            }
        }
    }
    colours
}

#[inline(always)]
fn bilinear<const N: usize>(
    scene: &Scene<'_>,
    have_one: Mask<N>,
    textures: Words<N>,
    [widths, heights]: [Words<N>; 2],
    [u, v]: [Floats<N>; 2],
) -> Vectors<N> {
    let one = Floats::splat(1.0);
    let fold = |coordinate: Floats<N>| coordinate - coordinate.floor();
    let x = fold(u) * floats(|lane| widths.0[lane] as i32 as f32) - 0.5;
    let y = (one - fold(v)) * floats(|lane| heights.0[lane] as i32 as f32) - 0.5;
    let (left, top) = (x.floor(), y.floor());
    let (x0, x1) = (wrapped(left, widths), wrapped(left + one, widths));
    let (y0, y1) = (wrapped(top, heights), wrapped(top + one, heights));
    let texels = Texels::of(scene, have_one, |lane| {
        let row = |y: u32| textures.0[lane] + 2 + y * widths.0[lane];
        let (upper, lower) = (row(y0.0[lane]), row(y1.0[lane]));
        let (x0, x1) = (x0.0[lane], x1.0[lane]);
        [upper + x0, upper + x1, lower + x0, lower + x1]
    });
    let [a, b, c, d] = texels.colours;
    let (across, down) = (x - left, y - top);
    lerp(lerp(a, b, across), lerp(c, d, across), down)
}

/// The four texels around a point for each lane.
struct Texels<const N: usize> {
    colours: [Vectors<N>; 4],
}

impl<const N: usize> Texels<N> {
    /// Those at the `places` of lanes that `have_one`; black in others.
    #[inline(always)]
    fn of(scene: &Scene<'_>, have_one: Mask<N>, places: impl Fn(usize) -> [u32; 4]) -> Self {
        let mut colours = [Vectors::splat(Vec3::ZERO); 4];
        let Some(table) = scene.texels.first_chunk::<{ DECODE_WORDS as usize }>() else {
            return Self { colours };
        };
        let linear = |code: u32| f32::from_bits(table[(code & 0xff) as usize]);
        for lane in 0..N {
            if have_one.holds(lane) {
                for (colour, place) in colours.iter_mut().zip(places(lane)) {
                    let code = scene.texels[place as usize];
                    let texel = Vec3::new(linear(code), linear(code >> 8), linear(code >> 16));
                    colour.set(lane, texel);
                }
            }
        }
        Self { colours }
    }
}

/// The texel column (or row) of an integral coordinate in [-1, size].
#[inline(always)]
fn wrapped<const N: usize>(coordinates: Floats<N>, sizes: Words<N>) -> Words<N> {
    words(|lane| {
        let (coordinate, size) = (coordinates.0[lane], sizes.0[lane]);
        let index = (coordinate + WHOLE).to_bits().wrapping_sub(WHOLE.to_bits());
        let inside = if index < size { index } else { 0 };
        if coordinate < 0.0 { size - 1 } else { inside }
    })
}

#[inline(always)]
fn lerp<const N: usize>(a: Vectors<N>, b: Vectors<N>, share: Floats<N>) -> Vectors<N> {
    a * (Floats::splat(1.0) - share) + b * share
}
