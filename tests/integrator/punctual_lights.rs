//! Lights without surfaces, against what is known of them, and by all devices.

use glam::{DVec3, Vec3};
use raystream::exec::cpu::CpuExecutor;
use raystream::render::{Settings, Techniques};
use raystream::scene::{
    Camera, FilmSize, Lens, Material, Principled, Projection, PunctualLight, Scene,
};
use raystream_tests::scenes::{self, add_quad};
use raystream_tests::statistics::assert_same_expectation;
use raystream_tests::{prepare, render, render_on, settings, with_gpu};
use std::f64::consts::PI;

/// What the floor reflects.
const REFLECTANCE: f64 = 0.5;

/// A floor, lit by `lights`. Its one pixel sees so little of it, around the origin, that the
/// irradiance is the same all over.
fn floor(lights: &[PunctualLight]) -> Scene {
    let mut scene = scenes::empty(Vec3::Y * 3.0, Vec3::ZERO);
    let camera = Camera::new(scene.camera.origin, Vec3::ZERO, 0.001);
    scene.camera = Camera { up: Vec3::NEG_Z, ..camera };
    scene.film = FilmSize { width: 1, height: 1 };
    let floor = scene.add_material(scenes::diffuse(REFLECTANCE as f32));
    add_quad(&mut scene, Vec3::new(-5.0, 0.0, -5.0), Vec3::Z * 10.0, Vec3::X * 10.0, floor);
    scene.punctual_lights = lights.to_vec();
    scene
}

/// The irradiance of the floor at the origin, with its standard error.
fn irradiance(lights: &[PunctualLight], samples: u32) -> (DVec3, f64) {
    let scene = floor(lights);
    let film = render(&prepare(&scene), &settings(&scene), samples);
    let scale = PI / REFLECTANCE;
    let error = f64::from(film.variance()[0].max_element()).sqrt();
    (film.color()[0].as_dvec3() * scale, error * scale)
}

/// One light alone is chosen always, and its light has no noise.
fn assert_irradiance(light: PunctualLight, expected: f64, what: &str) {
    let (found, _) = irradiance(&[light], 16);
    // The patch that the pixel sees is 5e-5 wide; where a spot's edge is near, that is 3e-4 of the
    // way to it.
    assert!((found.x - expected).abs() <= 3e-4 * expected.max(1e-3), "{what}: {found} {expected}");
}

#[test]
fn a_point_lights_by_the_inverse_square_and_the_cosine() {
    for position in [Vec3::Y * 2.0, Vec3::new(1.5, 0.8, -0.4), Vec3::new(0.0, 20.0, 15.0)] {
        let at = position.as_dvec3();
        let expected = 7.0 * at.y / at.length().powi(3);
        assert_irradiance(PunctualLight::point(position, Vec3::splat(7.0)), expected, "a point");
    }
    let below = PunctualLight::point(Vec3::NEG_Y, Vec3::ONE);
    assert_irradiance(below, 0.0, "a point below the floor");
}

#[test]
fn a_spot_falls_off_between_its_angles() {
    // It shines downwards from above the point (x, 0, 0), so the origin is seen under this angle.
    for degrees in [0.0_f64, 10.0, 19.0, 21.0, 27.0, 33.0, 39.0, 41.0, 80.0] {
        let angle = degrees.to_radians();
        let light = PunctualLight::Spot {
            position: Vec3::new(2.0 * angle.tan() as f32, 2.0, 0.0),
            direction: Vec3::NEG_Y * 3.0,
            intensity: Vec3::splat(5.0),
            inner_angle: 20.0,
            outer_angle: 40.0,
        };
        let [inner, outer] = [20.0_f64, 40.0].map(|degrees| degrees.to_radians().cos());
        let share = ((angle.cos() - outer) / (inner - outer)).clamp(0.0, 1.0);
        let expected = 5.0 * share * share * angle.cos().powi(3) / 4.0;
        assert_irradiance(light, expected, &format!("a spot, {degrees} degrees off"));
    }
}

#[test]
fn a_direction_lights_by_its_cosine() {
    for (direction, cosine) in
        [(Vec3::NEG_Y, 1.0), (Vec3::new(3.0, -4.0, 0.0), 0.8), (Vec3::new(0.0, 1.0, -1.0), 0.0)]
    {
        let light = PunctualLight::directional(direction, Vec3::splat(2.0));
        assert_irradiance(light, 2.0 * cosine, "a direction");
    }
}

/// A sun of any size lights as its middle alone would, as long as all of it is above the horizon.
#[test]
fn a_sun_has_the_irradiance_that_it_says() {
    for angle in [0.53, 10.0, 60.0] {
        let light = PunctualLight::Directional {
            direction: Vec3::new(3.0, -4.0, 0.0),
            irradiance: Vec3::splat(2.0),
            angle,
        };
        let (found, error) = irradiance(&[light], 4096);
        assert!((found.x - 1.6).abs() <= 4.5 * error + 1e-4, "{angle}: {found} {error}");
    }
}

/// Whoever chooses among several finds the sum of all.
#[test]
fn several_lights_add_up() {
    let spot = PunctualLight::Spot {
        position: Vec3::new(1.0, 1.0, 0.0),
        direction: Vec3::new(-1.0, -1.2, 0.0),
        intensity: Vec3::new(0.0, 3.0, 1.0),
        inner_angle: 3.0,
        outer_angle: 50.0,
    };
    let lights = [
        PunctualLight::point(Vec3::Y * 2.0, Vec3::new(4.0, 1.0, 0.0)),
        PunctualLight::directional(Vec3::NEG_Y, Vec3::splat(0.5)),
        spot,
        PunctualLight::point(Vec3::new(-1.0, 3.0, 1.0), Vec3::new(0.0, 0.0, 9.0)),
    ];
    let expected: DVec3 = lights.iter().map(|&light| irradiance(&[light], 16).0).sum();
    let (found, error) = irradiance(&lights, 1 << 16);
    let off = (found - expected).abs().max_element();
    assert!(off <= 4.5 * error + 1e-3 * expected.max_element(), "{found} {expected} {error}");
}

/// What is between the light and the floor casts a shadow, also if it is near to the light.
#[test]
fn shadows_are_cast() {
    for height in [0.01, 1.0, 1.999] {
        let mut scene = floor(&[PunctualLight::point(Vec3::Y * 2.0, Vec3::ONE)]);
        // From the side: from above the camera would see the shade.
        scene.camera.origin = Vec3::new(3.0, 0.05, 0.0);
        let shade = scene.add_material(scenes::diffuse(0.0));
        let corner = Vec3::new(-0.1, height, -0.1);
        add_quad(&mut scene, corner, Vec3::Z * 0.2, Vec3::X * 0.2, shade);
        let film = render(&prepare(&scene), &settings(&scene), 64);
        assert_eq!(film.color()[0], Vec3::ZERO, "{height}");
    }
}

/// No path runs into them: samples of lights alone find all that there is.
#[test]
fn light_sampling_has_them_alone() {
    let metal = Principled::metal(Vec3::new(0.9, 0.7, 0.4), 0.3);
    for (name, ball) in [("glass", scenes::glass(1.5)), ("metal", Material::Principled(metal))] {
        let scene = scenes::punctual(ball);
        let prepared = prepare(&scene);
        let film = |techniques, seed| {
            render(&prepared, &Settings { seed, techniques, ..settings(&scene) }, 2048)
        };
        let both = film(Techniques::Both, 1);
        assert_same_expectation(&both, &film(Techniques::LightSampling, 2), name);
        let by_bsdf = film(Techniques::BsdfSampling, 3);
        assert!(by_bsdf.color().iter().all(|color| *color == Vec3::ZERO), "{name}");
    }
}

/// However strong the sun is, lamps are not forgotten; however strong the lamps, the sun is not.
#[test]
fn what_is_strong_does_not_starve_the_rest() {
    let lights = |sun: f32| {
        let mut scene = floor(&[
            PunctualLight::directional(Vec3::NEG_Y, Vec3::splat(sun)),
            PunctualLight::point(Vec3::Y * 2.0, Vec3::ONE),
        ]);
        scene.film = FilmSize { width: 1, height: 1 };
        let prepared = prepare(&scene);
        let view = prepared.view().lights;
        (0..view.count).map(|index| view.light(index).pdf).collect::<Vec<_>>()
    };
    for sun in [1e-9, 1.0, 1e9] {
        let chances = lights(sun);
        assert!(chances.iter().all(|&chance| chance > 0.0999), "{sun}: {chances:?}");
        assert!((chances.iter().sum::<f32>() - 1.0).abs() < 1e-5, "{sun}: {chances:?}");
    }
}

#[test]
fn lights_that_are_black_are_none() {
    let scene = floor(&[PunctualLight::point(Vec3::Y, Vec3::ZERO)]);
    assert_eq!((prepare(&scene).abilities, prepare(&scene).params.lights), (0, 0));
    assert!(!scene.emits() && floor(&[PunctualLight::point(Vec3::Y, Vec3::X)]).emits());
}

/// The noise of a spot that a lens sees: everything at once, on both devices.
#[test]
fn devices_agree() {
    with_gpu(|gpu| {
        let mut scene = scenes::punctual(scenes::glass(1.5));
        let lens = Lens { radius: 0.05, focus_distance: 2.0, blades: 0 };
        scene.camera.projection = Projection::Perspective { fov_y: 40.0, lens: Some(lens) };
        let prepared = prepare(&scene);
        let cpu = render_on(&CpuExecutor, &prepared, &settings(&scene), 256);
        let gpu = render_on(gpu, &prepared, &Settings { seed: 2, ..settings(&scene) }, 256);
        assert_same_expectation(&cpu, &gpu, "lights without surfaces on CPU and GPU");
    });
}

/// The comparisons above can fail.
#[test]
#[should_panic(expected = "another spot")]
fn another_light_is_noticed() {
    let scene = scenes::punctual(scenes::diffuse(0.6));
    let mut other = scene.clone();
    if let PunctualLight::Spot { outer_angle, .. } = &mut other.punctual_lights[1] {
        *outer_angle += 10.0;
    }
    let film =
        |scene: &Scene, seed| render(&prepare(scene), &Settings { seed, ..settings(scene) }, 2048);
    assert_same_expectation(&film(&scene, 1), &film(&other, 2), "another spot");
}
