//! The triangles whose emission a texture says, see [`raystream_shaders::scene::light`].

use super::geometry::Corners;
use super::scene_triangle::SceneTriangle;
use super::textures::Textures;
use crate::scene::{Material, Placement, Scene, Texture, TextureId};
use glam::{Vec2, Vec3};
use rayon::prelude::*;
use raystream_shaders::scene::abilities::{ALL, Fixed};
use raystream_shaders::scene::light::{EmissionMap, importance};
use raystream_shaders::scene::texture::{Coordinates, TextureView};

/// A triangle is looked at in at most this many parts along a side.
const MAX_PARTS: u32 = 64;
/// A triangle is chosen at least as often as if it had this share of what its texture has in the
/// mean: a bright texel that just touches it may have been overlooked.
const LEAST_SHARE: f32 = 1e-3;

/// What textures say of emissive triangles.
#[derive(Clone, Copy)]
pub struct MappedEmission {
    /// The importance by which the triangle is chosen: about the mean under it.
    pub importance: f32,
    /// What the texture multiplies the radiance by at most.
    pub peak: f32,
    /// For the kernels.
    pub map: EmissionMap,
}

/// For each triangle what a texture says of its emission, if one does; an empty list if none does.
/// The scene was checked, so such triangles have texture coordinates.
pub fn of_triangles(
    scene: &Scene,
    triangles: &[SceneTriangle],
    corners: &Corners,
    textures: &Textures,
) -> Vec<Option<MappedEmission>> {
    let mapped: Vec<Option<(Vec3, TextureId)>> = scene.materials.iter().map(mapped).collect();
    if mapped.iter().all(Option::is_none) {
        return Vec::new();
    }
    let means: Vec<f32> =
        scene.textures.iter().map(|texture| importance(texture.mean_emission())).collect();
    let peaks: Vec<f32> = scene.textures.iter().map(Texture::brightest).collect();
    let view = TextureView::new(&textures.words, Fixed::<ALL>);
    let of_triangle = |triangle: &SceneTriangle| {
        let (emission, texture) = (*mapped.get(triangle.material as usize)?)?;
        let picture = &scene.textures[texture.0 as usize];
        let [uv0, uv1, uv2] = corners.coordinates(triangle.attributes, picture.placement.set)?;
        let texture_place = textures.places[texture.0 as usize];
        let map = EmissionMap { uv0, uv1, uv2, texture: texture_place, pad: 0 };
        let size = Vec2::new(picture.width as f32, picture.height as f32);
        let found = mean(&view, &map, emission, size, picture.placement);
        let least = LEAST_SHARE * importance(emission) * means[texture.0 as usize];
        let (importance, peak) = (found.max(least), peaks[texture.0 as usize]);
        Some(MappedEmission { importance, peak, map })
    };
    triangles.par_iter().map(of_triangle).collect()
}

/// The emission of a material and the texture that multiplies it, if both are there.
fn mapped(material: &Material) -> Option<(Vec3, TextureId)> {
    let Material::Principled(principled) = material else { return None };
    let emits = principled.emission.max_element() > 0.0;
    principled.maps.emission.filter(|_| emits).map(|texture| (principled.emission, texture))
}

/// The mean importance under a triangle, of what the kernels look up: at the middles of parts no
/// larger than a texel, unless these would be too many.
fn mean(
    view: &TextureView<'_, Fixed<ALL>>,
    map: &EmissionMap,
    emission: Vec3,
    size: Vec2,
    placement: Placement,
) -> f32 {
    let [a, b, c] = [map.uv0, map.uv1, map.uv2].map(Vec2::from);
    let on_texture = |edge: Vec2| (placement.matrix * edge * size).length();
    let longest = [b - a, c - b, a - c].map(on_texture).into_iter().fold(0.0, f32::max);
    let parts = (longest.ceil() as u32).clamp(1, MAX_PARTS);
    let mut sum = 0.0;
    for row in 0..parts {
        for column in 0..parts - row {
            let mut add = |third: f32| {
                let (s, t) = (row as f32 + third, column as f32 + third);
                let uv = a + ((b - a) * s + (c - a) * t) / parts as f32;
                sum += f64::from(importance(
                    emission * view.sample(map.texture, Coordinates::both(uv)),
                ));
            };
            add(1.0 / 3.0);
            if column + 1 < parts - row {
                add(2.0 / 3.0);
            }
        }
    }
    (sum / f64::from(parts * parts)) as f32
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::render::scene::textures::pack;

    #[test]
    fn the_mean_is_that_under_the_triangle() {
        // The left half is black, the right half is white.
        let texels = (0..64).map(|k| [if k % 8 < 4 { 0 } else { 255 }; 4]).collect();
        let textures = pack(&[Texture::new(8, 8, texels)]);
        let view = TextureView::new(&textures.words, Fixed::<ALL>);
        let of = |uv0: [f32; 2], uv1: [f32; 2], uv2: [f32; 2]| {
            let map = EmissionMap { uv0, uv1, uv2, texture: textures.places[0], pad: 0 };
            let (white, size) = (Vec3::splat(3.0), Vec2::splat(8.0));
            mean(&view, &map, white, size, Placement::default())
        };
        let dark = of([0.1, 0.1], [0.4, 0.1], [0.1, 0.9]);
        let bright = of([0.6, 0.1], [0.9, 0.1], [0.6, 0.9]);
        assert!(dark == 0.0 && (bright - 3.0).abs() < 1e-6, "{dark} {bright}");
        // Three quarters of this one lie in the dark half, away from the texture's edges.
        let both = of([0.1, 0.1], [0.9, 0.1], [0.1, 0.9]);
        assert!((both / 3.0 - 0.25).abs() < 0.02, "{both}");
        let point = of([0.75, 0.5], [0.75, 0.5], [0.75, 0.5]);
        assert!((point - 3.0).abs() < 1e-6, "{point}");
    }
}
