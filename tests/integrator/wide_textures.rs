//! Textures of 16 bits, of floats and of whole texels, on each device.

use super::tracing::Case;
use glam::{Vec2, Vec3};
use raystream::exec::Executor;
use raystream::exec::cpu::CpuExecutor;
use raystream::scene::{
    Maps, Material, Mesh, Principled, Scene, Texels, Texture, TextureFilter, TextureId,
};
use raystream_tests::{scenes, with_gpu};

/// What the sky emits.
const SKY: Vec3 = Vec3::new(1.0, 1.0, 2.0);
/// What a device's power function may round, as a share.
const ROUNDING: f32 = 1e-4;

/// A floor under the sky that shows one point of a texture.
fn floor(texture: Texture, material: impl Fn(TextureId) -> Material, u: f32) -> Scene {
    let mut scene = scenes::empty(Vec3::new(0.0, 1.0, 3.0), Vec3::ZERO);
    let texture = scene.add_texture(texture);
    let material = scene.add_material(material(texture));
    let positions =
        [Vec3::new(-9.0, 0.0, 9.0), Vec3::new(9.0, 0.0, 9.0), Vec3::new(0.0, 0.0, -9.0)];
    let mut floor = Mesh::new(material, positions.to_vec(), vec![[0, 1, 2]]);
    floor.texture_coordinates = Some(vec![[Vec2::new(u, 0.5); 3]]);
    scene.add_mesh(floor);
    scene.background = SKY;
    scene
}

/// Asserts that all paths that meet the floor bring this radiance.
fn assert_seen<E: Executor>(executor: &E, what: &str, floor: Scene, depth: u32, expected: Vec3) {
    let case = Case::new("a floor with a texture", floor, 100).with(|s| s.max_depth = depth);
    let made = case.megakernel(executor, case.all());
    let seen: Vec<Vec3> =
        made.iter().map(|made| made.radiance).filter(|radiance| *radiance != SKY).collect();
    assert!(seen.len() > 20, "{what}: {} of {}", seen.len(), made.len());
    let is_off = |radiance: &&Vec3| {
        (**radiance - expected).abs().max_element() > ROUNDING * expected.max_element()
    };
    assert_eq!(seen.iter().find(is_off), None, "{what}: not {expected}");
}

fn assert_shown<E: Executor>(executor: &E) {
    let grey = f64::from(40_000_u16) / 65_535.0;
    let linear = ((grey + 0.055) / 1.055).powf(2.4) as f32;
    let shorts = || Texture::of(1, 1, Texels::Shorts(vec![[40_000, 40_000, 40_000, 0]]));
    assert_seen(executor, "16 bits", floor(shorts(), Material::textured, 0.5), 2, SKY * linear);

    // What reflects does not reflect more than there is; what emits may be as bright as it is.
    let floats = || Texture::of(1, 1, Texels::Floats(vec![[7.5, 0.125, 1.5]]));
    let reflected = SKY * Vec3::new(1.0, 0.125, 1.0);
    assert_seen(executor, "a reflectance", floor(floats(), Material::textured, 0.5), 2, reflected);
    let lamp = |map| {
        let emission = Vec3::splat(2.0);
        let maps = Maps { emission: Some(map), ..Maps::default() };
        let black = Principled { specular: Vec3::ZERO, ..Principled::paint(Vec3::ZERO, 1.0) };
        Material::Principled(Principled { emission, maps, ..black })
    };
    let emitted = Vec3::new(15.0, 0.25, 3.0);
    assert_seen(executor, "an emission", floor(floats(), lamp, 0.5), 1, emitted);

    let texels = || vec![[0, 0, 0, 255], [255, 0, 0, 255]];
    let nearest = || Texture { filter: TextureFilter::Nearest, ..Texture::new(2, 1, texels()) };
    for (u, shown) in [(0.45, 0.0), (0.55, 1.0)] {
        let floor = |texture| floor(texture, Material::textured, u);
        assert_seen(executor, "whole texels", floor(nearest()), 2, Vec3::X * shown);
        let mixed = ((u - 0.25) * 2.0).clamp(0.0, 1.0);
        assert_seen(executor, "a mixture", floor(Texture::new(2, 1, texels())), 2, Vec3::X * mixed);
    }
}

#[test]
fn wide_textures_are_shown_on_the_cpu() {
    assert_shown(&CpuExecutor);
}

#[test]
fn wide_textures_are_shown_on_the_gpu() {
    with_gpu(assert_shown);
}
