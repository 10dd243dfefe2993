//! Instances in pictures: those of the repeated shapes, by all techniques.

use super::lvc::renders::{lvc, rounds};
use glam::Vec3;
use raystream::exec::cpu::CpuExecutor;
use raystream::render::{Settings, Techniques};
use raystream::scene::{Attenuation, Material, Principled, Scene};
use raystream_tests::scenes;
use raystream_tests::statistics::{assert_rounds_have_expectation, assert_same_expectation};
use raystream_tests::{prepare, render, settings};

fn materials() -> [(&'static str, Material); 4] {
    let attenuation = Some(Attenuation { colour: Vec3::new(0.9, 0.5, 0.2), distance: 0.3 });
    let tinted = Principled { attenuation, priority: Some(1), ..Principled::glass(1.5, 0.0) };
    [
        ("matt paint", Material::Principled(Principled::paint(Vec3::splat(0.7), 0.9))),
        ("rough metal", Material::Principled(Principled::metal(Vec3::splat(0.9), 0.3))),
        ("glass", scenes::glass(1.5)),
        ("tinted glass", Material::Principled(tinted)),
    ]
}

/// Both have the same random numbers, so that all but the paths that a rounding turns are the same.
#[test]
fn pictures_and_features_are_those_of_repeated_shapes() {
    for (name, ball) in materials() {
        let scene = scenes::instanced(ball);
        let flat = scene.without_instances();
        let of = |scene: &Scene, seed| {
            let prepared = prepare(scene);
            let settings = Settings { seed, ..settings(scene) };
            (prepared.instances, render(&prepared, &settings, 512))
        };
        let ((instances, instanced), (none, repeated)) = (of(&scene, 1), of(&flat, 1));
        assert_eq!((instances, none), (5, 0));
        let rounding = |a: Vec3, b: Vec3| (a - b).abs().max_element();
        for (a, b) in instanced.features.iter().zip(&repeated.features) {
            assert_eq!(a.hits, b.hits, "{name}");
            // Packed tangents have 15 bits.
            assert!(rounding(a.normal, b.normal) < 2e-3 * b.hits as f32, "{name}: {a:?} {b:?}");
            assert!(rounding(a.albedo, b.albedo) < 1e-3 * b.hits as f32, "{name}: {a:?} {b:?}");
        }
        let (_, other) = of(&flat, 2);
        assert_same_expectation(&instanced, &other, name);
    }
}

#[test]
fn techniques_agree_on_instances() {
    for (name, ball) in materials() {
        let scene = scenes::instanced(ball);
        let prepared = prepare(&scene);
        let of = |techniques, seed, samples| {
            render(&prepared, &Settings { seed, techniques, ..settings(&scene) }, samples)
        };
        let both = of(Techniques::Both, 1, 512);
        assert_same_expectation(&both, &of(Techniques::BsdfSampling, 3, 8192), name);
        if !matches!(ball, Material::Dielectric { .. }) && name != "tinted glass" {
            assert_same_expectation(&both, &of(Techniques::LightSampling, 2, 1024), name);
        }
        let pictures = rounds(&CpuExecutor, &prepared, &lvc(&scene, 300), 256, 2);
        let long = of(Techniques::Both, 4, 4096);
        assert_rounds_have_expectation(&long, &pictures, &format!("lvc, {name}"));
    }
}
