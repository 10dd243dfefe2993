//! Lights that a tree chooses: by what they send to a point, as likely as it says, and none left
//! out.

use glam::Vec3;
use raystream::exec::cpu::CpuExecutor;
use raystream::render::{
    BvhQuality, IntegratorKind, LightChoice, PreparedScene, Settings, Techniques,
};
use raystream::scene::{Material, Principled, Scene};
use raystream_shaders::math::random::{CHOICES, LIGHT_POINT, RandomNumbers, hash, unit_float};
use raystream_shaders::scene::abilities::LIGHT_TREE;
use raystream_shaders::scene::light::tree::Vantage;
use raystream_shaders::scene::ray::{Clearance, SurfacePoint};
use raystream_tests::histogram::{SAMPLERS, histogram};
use raystream_tests::statistics::{assert_chi_square, assert_same_expectation};
use raystream_tests::{prepare, render, render_on, scenes, settings, with_gpu};

const COUNT: u32 = 1 << 18;

fn lamps() -> Scene {
    scenes::many_lamps(scenes::diffuse(0.7), 120)
}

fn prepared(scene: &Scene, choice: LightChoice) -> PreparedScene {
    PreparedScene::choosing_lights(scene, BvhQuality::Fast, choice).expect("the scene is small")
}

/// Points in and about the room, facing any way, some of them two-sided, with their normals.
fn vantages(count: u32) -> impl Iterator<Item = (Vantage, Vec3)> {
    (0..count).map(|k| {
        let number = |salt: u32| unit_float(hash(k * 7 + salt)) * 2.0 - 1.0;
        let position = Vec3::new(number(0), number(1), number(2)) * 1.2 + 0.4;
        let normal = Vec3::new(number(3), number(4), number(5)).normalize();
        (Vantage::new(position, normal, k % 4 == 3), normal)
    })
}

/// The chances of all lights.
fn chances(scene: &PreparedScene, vantage: &Vantage) -> Vec<f64> {
    let lights = scene.view().lights;
    (0..lights.count).map(|light| f64::from(lights.tree.chance(vantage, light))).collect()
}

#[test]
fn chances_add_up_to_1() {
    for lamps in [1, 2, 3, 120, 1000] {
        let scene = scenes::many_lamps(scenes::diffuse(0.7), lamps);
        let scene = prepared(&scene, LightChoice::Tree);
        for (vantage, _) in vantages(200) {
            let sum: f64 = chances(&scene, &vantage).iter().sum();
            assert!((sum - 1.0).abs() < 1e-5, "{lamps} lamps: {sum}");
        }
    }
}

fn assert_chosen_by(chances_at: u32) {
    let scene = prepared(&lamps(), LightChoice::Tree);
    let lights = scene.view().lights;
    for (vantage, name) in vantages(6).map(|(vantage, normal)| (vantage, normal.to_string())) {
        let other = vantages(6 + chances_at).nth(chances_at as usize).map(|(other, _)| other);
        let from = if chances_at == 0 { vantage } else { other.expect("there are more") };
        let expected: Vec<f64> =
            chances(&scene, &from).iter().map(|chance| chance * f64::from(COUNT)).collect();
        for (kind, sampler) in SAMPLERS {
            let chosen = (0..COUNT).map(|index| {
                let bits = RandomNumbers::new(kind, 1, 5, index).bits(CHOICES)[0];
                let choice = lights.tree.choose(&vantage, bits);
                let known = lights.tree.chance(&vantage, choice.light);
                assert_eq!(choice.chance, known, "light {}", choice.light);
                choice.light as usize
            });
            let counts = histogram(expected.len(), chosen);
            assert_chi_square(&counts, &expected, &format!("{sampler}, facing {name}"));
        }
    }
}

#[test]
fn lights_are_chosen_as_often_as_is_said() {
    assert_chosen_by(0);
}

/// The test can fail.
#[test]
#[should_panic(expected = "facing")]
fn chances_of_another_point_are_rejected() {
    assert_chosen_by(7);
}

#[test]
fn no_light_is_left_out_that_shines() {
    let scene = prepared(&lamps(), LightChoice::Tree);
    let lights = scene.view().lights;
    let mut shining = 0;
    for (vantage, normal) in vantages(500) {
        let clearance = Clearance::of_world(32.0);
        let point = SurfacePoint { position: vantage.position, normal, clearance };
        let is_two_sided = vantage.facing >> 31 == 1;
        let chances = chances(&scene, &vantage);
        for k in 0..1000 {
            let numbers = RandomNumbers::new(0, 3, 9, k);
            let choice = numbers.bits(CHOICES)[0];
            let light = lights.choose(choice);
            let sample = lights.sample(&point, choice, numbers.bits(LIGHT_POINT));
            let arrives = is_two_sided || sample.direction.dot(normal) > 0.0;
            if sample.pdf > 0.0 && sample.radiance.max_element() > 0.0 && arrives {
                shining += 1;
                assert!(chances[light as usize] > 0.0, "light {light} at {}", point.position);
            }
        }
    }
    assert!(shining > 50_000, "{shining}");
}

/// One light is the only one that shines on a point near it: then it is chosen almost always,
/// whatever the power of those that turn away.
#[test]
fn what_turns_away_is_not_chosen() {
    let mut scene = scenes::empty(Vec3::Z, Vec3::ZERO);
    let add = |scene: &mut Scene, x: f32, radiance: f32, up: bool| {
        let lamp = scene.add_material(scenes::emissive(radiance, 0.0));
        let [a, b, c] =
            [Vec3::ZERO, Vec3::X * 0.1, Vec3::Z * 0.1].map(|p| p + Vec3::new(x, 1.0, 0.0));
        scenes::add_triangle(scene, if up { [a, c, b] } else { [a, b, c] }, lamp);
    };
    add(&mut scene, 0.0, 1.0, false);
    for k in 1..20 {
        add(&mut scene, k as f32 * 0.2, 1e3, true);
    }
    let scene = prepared(&scene, LightChoice::Tree);
    let below = Vantage::new(Vec3::ZERO, Vec3::Y, false);
    assert!(chances(&scene, &below)[0] > 0.9, "{:?}", chances(&scene, &below));
}

#[test]
fn many_lights_are_chosen_by_a_tree_and_few_are_not() {
    let has_tree = |lamps: u32| {
        let mut scene = scenes::many_lamps(scenes::diffuse(0.7), lamps);
        // What the room has of its own.
        scene.meshes.retain(|mesh| mesh.material.0 > 2);
        prepare(&scene).abilities & LIGHT_TREE != 0
    };
    assert!(!has_tree(63) && has_tree(64));
}

/// Both ways to choose, and each technique alone.
#[test]
fn a_tree_changes_no_expectation() {
    let metal = Principled::metal(Vec3::new(0.9, 0.7, 0.4), 0.4);
    let rough = Principled::glass(1.5, 0.5);
    for (name, ball) in [
        ("paint", scenes::diffuse(0.7)),
        ("metal", Material::Principled(metal)),
        ("rough glass", Material::Principled(rough)),
    ] {
        let scene = scenes::many_lamps(ball, 120);
        let by_power = prepared(&scene, LightChoice::Power);
        let by_tree = prepared(&scene, LightChoice::Tree);
        let film = |prepared, techniques, seed| {
            render(prepared, &Settings { seed, techniques, ..settings(&scene) }, 4096)
        };
        let expected = film(&by_power, Techniques::Both, 1);
        for (seed, techniques) in [(2, Techniques::Both), (3, Techniques::LightSampling)] {
            let found = film(&by_tree, techniques, seed);
            assert_same_expectation(&expected, &found, &format!("{name}, {techniques:?}"));
        }
    }
}

/// The comparison can fail.
#[test]
#[should_panic(expected = "another light")]
fn a_chance_that_is_wrong_is_noticed() {
    let scene = scenes::many_lamps(scenes::diffuse(0.7), 2);
    let film = |prepared: &PreparedScene, seed| {
        render(prepared, &Settings { seed, ..settings(&scene) }, 4096)
    };
    let by_tree = prepared(&scene, LightChoice::Tree);
    let expected = film(&by_tree, 1);
    let mut wrong = by_tree;
    // All ways are that to light 2, a small one: paths that run into the large lamp ask for that.
    let first = wrong.params.first_light_tree as usize;
    let rows = wrong.params.lights.div_ceil(4) as usize;
    let way = wrong.surfaces[first].z;
    wrong.surfaces[first..first + rows].fill(glam::UVec4::splat(way));
    assert_same_expectation(&expected, &film(&wrong, 2), "another light");
}

/// It chooses by power, since its paths from the lights do.
#[test]
fn lvc_knows_no_tree() {
    let scene = lamps();
    let film = |choice| {
        let settings = Settings { integrator: IntegratorKind::Lvc, ..settings(&scene) };
        render(&prepared(&scene, choice), &settings, 16)
    };
    let (by_tree, by_power) = (film(LightChoice::Tree), film(LightChoice::Power));
    assert!(by_tree.color().iter().any(|color| color.max_element() > 0.0));
    assert_eq!(by_tree.color(), by_power.color());
}

#[test]
fn devices_agree() {
    with_gpu(|gpu| {
        let scene = lamps();
        let prepared = prepared(&scene, LightChoice::Tree);
        let cpu = render_on(&CpuExecutor, &prepared, &settings(&scene), 256);
        let gpu = render_on(gpu, &prepared, &Settings { seed: 2, ..settings(&scene) }, 256);
        assert_same_expectation(&cpu, &gpu, "a tree of lights on CPU and GPU");
    });
}
