//! Lamps whose emission a texture says.

use glam::{DVec3, Vec2, Vec3};
use raystream::exec::cpu::CpuExecutor;
use raystream::render::{PreparedScene, Settings, Techniques};
use raystream::scene::{
    Camera, FilmSize, Maps, Material, Mesh, Principled, Scene, Texels, Texture,
};
use raystream_shaders::scene::light::{Light, MAPPED};
use raystream_tests::scenes::{self, add_quad};
use raystream_tests::statistics::assert_same_expectation;
use raystream_tests::{prepare, render, render_on, settings, with_gpu};
use std::f64::consts::PI;

pub const TECHNIQUES: [Techniques; 3] =
    [Techniques::Both, Techniques::LightSampling, Techniques::BsdfSampling];
/// Side of the lamp, and how high it hangs.
const SIDE: f32 = 2.0;
const HEIGHT: f32 = 1.5;

/// A picture of 5x3 texels, most of them black.
fn picture() -> Texture {
    let mut texels = vec![[0, 0, 0, 255]; 15];
    texels[3] = [255, 128, 0, 255];
    texels[11] = [40, 90, 250, 255];
    texels[12] = [200, 200, 200, 0];
    Texture::new(5, 3, texels)
}

/// A square lamp that hangs over a floor and shows the picture once, cut into `parts` strips; a
/// pixel that sees the floor around the origin.
fn scene(parts: u32) -> Scene {
    let mut scene = scenes::empty(Vec3::new(0.0, 1.0, 0.0), Vec3::ZERO);
    scene.camera = Camera { up: Vec3::NEG_Z, ..Camera::new(Vec3::Y, Vec3::ZERO, 0.01) };
    scene.film = FilmSize { width: 1, height: 1 };
    scene.limits.max_depth = 2;
    let floor = scene.add_material(scenes::diffuse(0.5));
    add_quad(&mut scene, Vec3::new(-5.0, 0.0, -5.0), Vec3::Z * 10.0, Vec3::X * 10.0, floor);
    let emission = Some(scene.add_texture(picture()));
    let maps = Maps { emission, ..Maps::default() };
    let paint = Principled::paint(Vec3::ZERO, 1.0);
    let glowing = Principled { emission: Vec3::new(3.0, 4.0, 5.0), maps, ..paint };
    let lamp = scene.add_material(Material::Principled(glowing));
    let mut mesh = Mesh::new(lamp, Vec::new(), Vec::new());
    let corner = |u: f32, v: f32| Vec3::new((u - 0.5) * SIDE, HEIGHT, (v - 0.5) * SIDE);
    let mut coordinates = Vec::new();
    for part in 0..parts {
        let [from, to] = [part, part + 1].map(|part| part as f32 / parts as f32);
        let uv = [(from, 0.0), (to, 0.0), (to, 1.0), (from, 1.0)];
        let first = mesh.positions.len() as u32;
        mesh.positions.extend(uv.map(|(u, v)| corner(u, v)));
        for [a, b, c] in [[0, 1, 2], [0, 2, 3]] {
            mesh.triangles.push([first + a, first + b, first + c]);
            coordinates.push([a, b, c].map(|k| Vec2::from(uv[k as usize])));
        }
    }
    mesh.texture_coordinates = Some(coordinates);
    scene.add_mesh(mesh);
    scene
}

/// The radiance of the floor at the origin, as a sum over points of the lamp of what the picture
/// says there, between texel centres and around its edges.
fn summed() -> DVec3 {
    const FINE: usize = 900;
    let decode = |code: u8| {
        let c = f64::from(code) / 255.0;
        if c <= 0.04045 { c / 12.92 } else { ((c + 0.055) / 1.055).powf(2.4) }
    };
    let Texels::Bytes(texels) = Texels::clone(&picture().texels) else { panic!("bytes") };
    let texel = |x: i64, y: i64| {
        let (x, y) = (x.rem_euclid(5) as usize, y.rem_euclid(3) as usize);
        let [r, g, b, _] = texels[y * 5 + x];
        DVec3::new(decode(r), decode(g), decode(b))
    };
    let radiance = |u: f64, v: f64| {
        let (x, y) = (u * 5.0 - 0.5, (1.0 - v) * 3.0 - 0.5);
        let (left, top) = (x.floor(), y.floor());
        let row = |y: i64| texel(left as i64, y).lerp(texel(left as i64 + 1, y), x - left);
        row(top as i64).lerp(row(top as i64 + 1), y - top) * DVec3::new(3.0, 4.0, 5.0)
    };
    let (side, height) = (f64::from(SIDE), f64::from(HEIGHT));
    let mut irradiance = DVec3::ZERO;
    for row in 0..FINE {
        for column in 0..FINE {
            let [u, v] = [column, row].map(|k| (k as f64 + 0.5) / FINE as f64);
            let at = DVec3::new((u - 0.5) * side, height, (v - 0.5) * side);
            let form = height * height / at.length_squared().powi(2);
            irradiance += radiance(u, v) * form * (side / FINE as f64).powi(2);
        }
    }
    irradiance * 0.5 / PI
}

#[test]
fn a_floor_is_lit_by_the_sum_over_all_texels() {
    let expected = summed();
    for parts in [1, 7] {
        let scene = scene(parts);
        let prepared = prepare(&scene);
        for techniques in TECHNIQUES {
            let settings = Settings { techniques, ..settings(&scene) };
            let film = render(&prepared, &settings, 1 << 16);
            let found = film.color()[0].as_dvec3();
            let error = film.variance()[0].as_dvec3().map(f64::sqrt);
            let off = (found - expected).abs();
            let what = format!("{techniques:?}, {parts}: {found} {expected} {error}");
            assert!(off.cmple(4.5 * error + 5e-4 * expected).all(), "{what}");
        }
    }
}

/// The more strips, the better a choice by what is under each of them is: fewer samples go to black
/// ones.
#[test]
fn triangles_are_chosen_by_what_is_under_them() {
    let noise = |parts| {
        let scene = scene(parts);
        let techniques = Techniques::LightSampling;
        let film = render(&prepare(&scene), &Settings { techniques, ..settings(&scene) }, 4096);
        f64::from(film.variance()[0].x)
    };
    assert!(noise(20) < noise(1), "{} {}", noise(20), noise(1));
}

fn lights(scene: &PreparedScene) -> Vec<Light> {
    let view = scene.view().lights;
    (0..view.count).map(|index| view.light(index)).collect()
}

#[test]
fn densities_integrate_to_1() {
    for parts in [1, 7] {
        let prepared = prepare(&scene(parts));
        let area =
            |light: &Light| 0.5 * light.edge1.as_dvec3().cross(light.edge2.as_dvec3()).length();
        let lights = lights(&prepared);
        assert!(lights.iter().all(|light| light.kind >= MAPPED));
        let whole: f64 = lights.iter().map(|light| area(light) * f64::from(light.pdf)).sum();
        assert!((whole - 1.0).abs() < 1e-5, "{parts}: {whole}");
    }
}

/// A white picture is none.
#[test]
fn a_white_picture_changes_nothing() {
    let mut plain = scene(3);
    let texels = vec![[255; 4]; 15];
    plain.textures[0] = Texture::new(5, 3, texels);
    let mapped = plain.clone();
    let Material::Principled(lamp) = &mut plain.materials[1] else { unreachable!() };
    lamp.maps.emission = None;
    let film = |scene: &Scene| render(&prepare(scene), &settings(scene), 4096);
    let (plain, mapped) = (film(&plain).color()[0], film(&mapped).color()[0]);
    assert!((plain - mapped).abs().max_element() < 1e-4 * plain.x, "{plain} {mapped}");
}

#[test]
fn a_black_picture_emits_nothing() {
    let mut scene = scene(1);
    scene.textures[0] = Texture::new(5, 3, vec![[0, 0, 0, 255]; 15]);
    let prepared = prepare(&scene);
    assert_eq!(prepared.params.lights, 0);
    assert_eq!(render(&prepared, &settings(&scene), 64).color()[0], Vec3::ZERO);
}

#[test]
fn techniques_agree_in_a_room() {
    let scene = scenes::picture_lamp(scenes::glass(1.5));
    let prepared = prepare(&scene);
    let film = |techniques, seed, samples| {
        render(&prepared, &Settings { seed, techniques, ..settings(&scene) }, samples)
    };
    let both = film(Techniques::Both, 1, 1024);
    assert_same_expectation(&both, &film(Techniques::LightSampling, 2, 2048), "light sampling");
    assert_same_expectation(&both, &film(Techniques::BsdfSampling, 3, 8192), "BSDF sampling");
}

#[test]
fn devices_agree() {
    with_gpu(|gpu| {
        let scene = scenes::picture_lamp(scenes::glass(1.5));
        let prepared = prepare(&scene);
        let cpu = render_on(&CpuExecutor, &prepared, &settings(&scene), 128);
        let gpu = render_on(gpu, &prepared, &Settings { seed: 2, ..settings(&scene) }, 128);
        assert_same_expectation(&cpu, &gpu, "a picture as lamp on CPU and GPU");
    });
}

/// What floats have above 1 is chosen and weighed as it is seen.
#[test]
fn a_lamp_of_floats_lights_as_the_same_lamp_of_bytes() {
    let bytes = scenes::picture_lamp(scenes::diffuse(0.6));
    let mut floats = bytes.clone();
    let Texels::Bytes(texels) = &*bytes.textures[0].texels else { panic!("bytes") };
    let brighter = |&[r, g, b, _]: &[u8; 4]| {
        [r, g, b].map(|code| 8.0 * raystream::color::srgb_decode(f64::from(code) / 255.0) as f32)
    };
    floats.textures[0].texels = Texels::Floats(texels.iter().map(brighter).collect()).into();
    for material in &mut floats.materials {
        if let Material::Principled(principled) = material {
            principled.emission /= 8.0;
        }
    }
    for techniques in TECHNIQUES {
        let film = |scene: &Scene, seed| {
            let settings = Settings { seed, techniques, ..settings(scene) };
            render(&prepare(scene), &settings, 2048)
        };
        let what = format!("{techniques:?}");
        assert_same_expectation(&film(&bytes, 1), &film(&floats, 2), &what);
    }
}

/// The comparisons above can fail.
#[test]
#[should_panic(expected = "another picture")]
fn another_picture_is_noticed() {
    let scene = scenes::picture_lamp(scenes::diffuse(0.6));
    let mut other = scene.clone();
    let texels = std::sync::Arc::make_mut(&mut other.textures[0].texels);
    let Texels::Bytes(texels) = texels else { panic!("bytes") };
    texels[..16].fill([0, 0, 0, 255]);
    let film =
        |scene: &Scene, seed| render(&prepare(scene), &Settings { seed, ..settings(scene) }, 2048);
    assert_same_expectation(&film(&scene, 1), &film(&other, 2), "another picture");
}
