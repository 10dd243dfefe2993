//! Textures of layers, and textures that lie by themselves, in pictures.

use super::emission_maps::TECHNIQUES;
use glam::{Mat2, Vec2, Vec3};
use raystream::film::Film;
use raystream::render::Settings;
use raystream::scene::{
    Channel, CoordinateSet, Maps, Material, Mesh, Placement, Principled, Scene, Texture,
};
use raystream_tests::statistics::assert_same_expectation;
use raystream_tests::{prepare, render, render_on, scenes, settings, with_gpu};
use std::sync::Arc;

const CODE: u8 = 51;

fn film(scene: &Scene, seed: u32, samples: u32) -> Film {
    render(&prepare(scene), &Settings { seed, ..settings(scene) }, samples)
}

/// The room with a ball of this material, which has texture coordinates.
fn ball(material: Principled, texel: [u8; 4]) -> Scene {
    let mut scene = scenes::room(Material::Principled(material), 1.0);
    scene.add_texture(Texture::new(1, 1, vec![texel]));
    let mesh = scene.meshes.last_mut().expect("there is a ball");
    mesh.texture_coordinates = Some(vec![[Vec2::ZERO, Vec2::X, Vec2::Y]; mesh.triangles.len()]);
    scene
}

/// A texture that says one number everywhere is that number as a factor, bit for bit.
#[test]
fn a_texture_of_one_number_is_the_number() {
    let texture = raystream::scene::TextureId(0);
    let share = f32::from(CODE) * (1.0 / 255.0);
    let tint = raystream::color::srgb_decode(f64::from(CODE) / 255.0) as f32;
    let plain = Principled {
        coat: 1.0,
        coat_roughness: 1.0,
        sheen: Vec3::ONE,
        sheen_roughness: 1.0,
        transmission: 0.5,
        ..Principled::paint(Vec3::new(0.8, 0.6, 0.4), 0.5)
    };
    let channel = |channel: u32| Some(Channel { texture, channel });
    let maps = Maps::default();
    let pairs = [
        ("coat", Maps { coat: channel(0), ..maps }, Principled { coat: share, ..plain }),
        (
            "coat_roughness",
            Maps { coat_roughness: channel(1), ..maps },
            Principled { coat_roughness: share, ..plain },
        ),
        (
            "sheen",
            Maps { sheen: Some(texture), ..maps },
            Principled { sheen: Vec3::splat(tint), ..plain },
        ),
        (
            "sheen_roughness",
            Maps { sheen_roughness: channel(3), ..maps },
            Principled { sheen_roughness: share, ..plain },
        ),
        (
            "transmission",
            Maps { transmission: channel(0), ..maps },
            Principled { transmission: 0.5 * share, ..plain },
        ),
        (
            "specular",
            Maps { specular: channel(3), ..maps },
            Principled { specular: Vec3::splat(share), f90: share, ..plain },
        ),
        (
            "specular_colour",
            Maps { specular_colour: Some(texture), ..maps },
            Principled { specular: Vec3::splat(tint), ..plain },
        ),
    ];
    let untouched = film(&ball(plain, [CODE; 4]), 1, 4);
    for (name, maps, factor) in pairs {
        let by_texture = film(&ball(Principled { maps, ..plain }, [CODE; 4]), 1, 4);
        let by_number = film(&ball(factor, [CODE; 4]), 1, 4);
        assert!(by_texture.radiance == by_number.radiance, "{name}");
        assert!(by_texture.radiance != untouched.radiance, "{name} shows nothing");
        let white = film(&ball(Principled { maps, ..plain }, [255; 4]), 1, 4);
        assert!(white.radiance == untouched.radiance, "{name}: white");
    }
}

#[test]
fn a_painted_ball_is_the_same_on_cpu_and_gpu() {
    with_gpu(|gpu| {
        let scene = scenes::painted();
        let prepared = prepare(&scene);
        let on_gpu = render_on(gpu, &prepared, &Settings { seed: 2, ..settings(&scene) }, 256);
        let on_cpu = film(&scene, 1, 256);
        assert_same_expectation(&on_cpu, &on_gpu, "a painted ball on CPU and GPU");
    });
}

/// The matrix and the offset of a place, and what undoes them.
fn there_and_back() -> (Placement, impl Fn(Vec2) -> Vec2) {
    let matrix = Mat2::from_cols_array_2d(&[[0.8, 1.7], [-0.6, 0.9]]);
    let offset = Vec2::new(0.3, -1.2);
    let inverse = matrix.inverse();
    (Placement { set: CoordinateSet::Second, matrix, offset }, move |uv| inverse * (uv - offset))
}

/// The scene with its textures where they are, by themselves: of second texture coordinates that
/// are elsewhere, as the first ones are now.
fn placed(mut scene: Scene) -> Scene {
    let (placement, back) = there_and_back();
    for texture in &mut scene.textures {
        texture.placement = placement;
        assert!(Arc::strong_count(&texture.texels) > 0);
    }
    let meshes: &mut Vec<Mesh> = &mut scene.meshes;
    for mesh in meshes.iter_mut().filter(|mesh| mesh.texture_coordinates.is_some()) {
        let coordinates = mesh.texture_coordinates.as_mut().expect("there are some");
        mesh.second_coordinates =
            Some(coordinates.iter().map(|corners| corners.map(&back)).collect());
        coordinates.fill([Vec2::new(0.7, 0.1); 3]);
    }
    scene
}

/// A lamp is chosen, sampled and seen as what its picture says where that lies.
#[test]
fn a_placed_picture_lights_as_it_does_elsewhere() {
    let scene = scenes::picture_lamp(scenes::diffuse(0.6));
    let moved = placed(scene.clone());
    for techniques in TECHNIQUES {
        let film = |scene: &Scene, seed| {
            let settings = Settings { seed, techniques, ..settings(scene) };
            render(&prepare(scene), &settings, 1024)
        };
        let what = format!("{techniques:?}");
        assert_same_expectation(&film(&scene, 1), &film(&moved, 2), &what);
    }
}

/// The comparison above can fail.
#[test]
#[should_panic(expected = "another place")]
fn another_place_is_noticed() {
    let scene = scenes::picture_lamp(scenes::diffuse(0.6));
    let mut moved = placed(scene.clone());
    moved.textures[0].placement.offset.x += 0.5;
    assert_same_expectation(&film(&scene, 1, 1024), &film(&moved, 2, 1024), "another place");
}

/// Holes lie where the texture does.
#[test]
fn holes_lie_where_their_texture_does() {
    let holes = |is_placed: bool| {
        let texels = (0..16).map(|k| [200, 200, 200, if k % 3 == 0 { 0 } else { 255 }]).collect();
        let mut scene = scenes::room(scenes::diffuse(0.5), 1.0);
        let texture = scene.add_texture(Texture::new(4, 4, texels));
        let opacity = raystream::scene::Opacity::Mask { alpha: 1.0, cutoff: 0.5 };
        let maps = Maps { base_colour: Some(texture), ..Maps::default() };
        let paint = Principled { opacity, maps, ..Principled::paint(Vec3::splat(0.9), 0.6) };
        let mesh = scene.meshes.last_mut().expect("there is a ball");
        let material = mesh.material;
        let uv = |p: Vec3| Vec2::new(p.x, p.y) * 9.0;
        mesh.texture_coordinates =
            Some((0..mesh.triangles.len()).map(|at| mesh.corners(at).map(uv)).collect());
        scene.materials[material.0 as usize] = Material::Principled(paint);
        if is_placed { placed(scene) } else { scene }
    };
    let what = "holes at a place of their own";
    assert_same_expectation(&film(&holes(false), 1, 512), &film(&holes(true), 2, 512), what);
}
