//! Pictures by cameras that are no pinholes.

use glam::Vec3;
use raystream::exec::cpu::CpuExecutor;
use raystream::render::Settings;
use raystream::scene::{Camera, FilmSize, Lens, Projection};
use raystream_tests::cameras::seen_by_others;
use raystream_tests::scenes::{self, add_ball, add_quad};
use raystream_tests::statistics::assert_same_expectation;
use raystream_tests::{prepare, render, render_on, settings, with_gpu};

#[test]
fn a_white_furnace_stays_white_by_every_camera() {
    let mut scene = scenes::empty(Vec3::new(0.0, 0.3, 4.0), Vec3::ZERO);
    let white = scene.add_material(scenes::diffuse(1.0));
    add_ball(&mut scene, Vec3::new(-0.8, 0.0, 0.0), 0.8, 3, white);
    add_ball(&mut scene, Vec3::new(0.7, 0.1, 0.3), 0.6, 2, white);
    scene.background = Vec3::ONE;
    for (name, scene) in seen_by_others(&scene) {
        let settings = Settings { max_depth: 1000, roulette_depth: 2000, ..settings(&scene) };
        let film = render(&prepare(&scene), &settings, 16);
        let hits: u32 = film.features.iter().map(|f| f.hits).sum();
        assert!(hits > 20, "{name}: the camera sees the balls");
        for color in film.color() {
            assert!((color - Vec3::ONE).abs().max_element() < 1e-3, "{name}: {color}");
        }
    }
}

/// A lamp at the distance of focus covers half of the picture with a sharp edge between two
/// columns; nearer or farther, the edge is blurred over many.
#[test]
fn what_is_in_focus_stays_in_its_pixels() {
    let columns_between = |focus_distance: f32| {
        let mut scene = scenes::empty(Vec3::Z * 4.0, Vec3::ZERO);
        let lens = Lens { radius: 0.5, focus_distance, blades: 6 };
        scene.camera.projection = Projection::Perspective { fov_y: 40.0, lens: Some(lens) };
        let lamp = scene.add_material(scenes::emissive(1.0, 0.0));
        add_quad(&mut scene, Vec3::new(-9.0, -9.0, 0.0), Vec3::X * 9.0, Vec3::Y * 18.0, lamp);
        let film = render(&prepare(&scene), &settings(&scene), 64);
        let row = &film.color()[6 * 16..7 * 16];
        assert_eq!((row[0].x, row[15].x), (1.0, 0.0));
        row.iter().filter(|color| color.x > 0.0 && color.x < 1.0).count()
    };
    assert_eq!(columns_between(4.0), 0);
    assert!(columns_between(2.0) >= 4);
    assert!(columns_between(16.0) >= 2);
}

/// A wall is as large by parallel rays, however far away it is.
#[test]
fn parallel_rays_do_not_diminish() {
    for distance in [0.5, 40.0] {
        let mut scene = scenes::empty(Vec3::Z * distance, Vec3::ZERO);
        scene.film = FilmSize { width: 16, height: 16 };
        scene.camera.projection = Projection::Orthographic { width: 4.0 };
        let lamp = scene.add_material(scenes::emissive(1.0, 0.0));
        add_quad(&mut scene, Vec3::new(-1.0, -1.0, 0.0), Vec3::X * 2.0, Vec3::Y * 2.0, lamp);
        let film = render(&prepare(&scene), &settings(&scene), 16);
        let lit = film.color().iter().filter(|color| color.x == 1.0).count();
        let dark = film.color().iter().filter(|color| color.x == 0.0).count();
        assert_eq!((lit, dark), (64, 192), "at {distance}");
    }
}

/// The middle of a panorama, an environment's picture and the camera's view agree.
#[test]
fn a_panorama_of_an_environment_is_its_picture() {
    let mut scene = scenes::empty(Vec3::ZERO, Vec3::NEG_Z);
    scene.film = FilmSize { width: 24, height: 12 };
    scene.camera.projection = Projection::Panorama;
    scene.set_environment(scenes::sky());
    let film = render(&prepare(&scene), &settings(&scene), 256);
    let texels = &scene.environment.as_ref().unwrap().texels;
    let color = film.color();
    // The sun's texel, and one of plain sky that has alike ones on both sides.
    let (sun, sky) = (2 * 24 + 5, 24 + 15);
    assert!(color[sun].x > 20.0 && color[sun + 2].x < 1.0, "{}", color[sun]);
    assert!((color[sky].y / texels[sky].y - 1.0).abs() < 0.1, "{} {}", color[sky], texels[sky]);
}

#[test]
fn devices_agree_by_every_camera() {
    with_gpu(|gpu| {
        for (name, scene) in seen_by_others(&scenes::room(scenes::glass(1.5), 1.0)) {
            let prepared = prepare(&scene);
            let cpu = render_on(&CpuExecutor, &prepared, &settings(&scene), 128);
            let settings = Settings { seed: 2, ..settings(&scene) };
            let gpu = render_on(gpu, &prepared, &settings, 128);
            assert_same_expectation(&cpu, &gpu, &format!("{name} on CPU and GPU"));
        }
    });
}

/// The comparison can fail.
#[test]
#[should_panic(expected = "another lens")]
fn another_lens_is_noticed() {
    let mut scene = scenes::room(scenes::diffuse(0.5), 1.0);
    let film = |scene: &raystream::scene::Scene, seed| {
        render(&prepare(scene), &Settings { seed, ..settings(scene) }, 2048)
    };
    let sharp = film(&scene, 1);
    let lens = Lens { radius: 0.1, focus_distance: 0.3, blades: 0 };
    scene.camera = Camera {
        projection: Projection::Perspective { fov_y: 70.0, lens: Some(lens) },
        ..scene.camera
    };
    assert_same_expectation(&sharp, &film(&scene, 2), "another lens");
}
