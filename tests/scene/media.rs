//! Bodies that overlap, touch and absorb light, against what is known of slabs.

use glam::{DVec3, Vec3};
use raystream::film::Film;
use raystream::render::Settings;
use raystream::scene::{Attenuation, Material, Principled, Projection, Scene};
use raystream_shaders::scene::media::{Body, Media, PASSES_ALL, Sides};
use raystream_tests::scenes::{self, add_ball, add_box, add_quad};
use raystream_tests::statistics::mean_and_error;
use raystream_tests::{prepare, render, settings};

/// Colours that a unit of length leaves of light.
const RED: Vec3 = Vec3::new(0.9, 0.5, 0.2);
const BLUE: Vec3 = Vec3::new(0.3, 0.6, 0.95);

/// A white background, seen by rays that hardly spread along -z.
fn bench() -> Scene {
    let mut scene = scenes::empty(Vec3::new(0.1, 0.2, 9.0), Vec3::new(0.1, 0.2, 0.0));
    scene.camera.projection = Projection::Perspective { fov_y: 0.1, lens: None };
    scene.background = Vec3::ONE;
    scene
}

/// Adds a slab between two heights along z.
fn add_slab(scene: &mut Scene, low: f32, high: f32, material: Material) {
    let material = scene.add_material(material);
    let far = Vec3::new(500.0, 500.0, 0.0);
    add_box(scene, Vec3::Z * low - far, Vec3::Z * high + far, false, material);
}

fn attenuation(colour: Vec3) -> Option<Attenuation> {
    Some(Attenuation { colour, distance: 1.0 })
}

/// Smooth glass that leaves this colour after a unit.
fn glass(ior: f32, colour: Vec3, priority: Option<i32>) -> Material {
    Material::Dielectric {
        ior,
        transmittance: Vec3::ONE,
        reflectance: Vec3::ONE,
        attenuation: attenuation(colour),
        priority,
    }
}

/// As preparing the scene anew finds, for a camera that goes into a body and comes out again.
#[test]
fn a_camera_that_is_moved_is_in_what_is_there() {
    let mut scene = bench();
    add_slab(&mut scene, 0.0, 4.0, glass(1.5, RED, None));
    let outside = prepare(&scene);
    let mut moved = prepare(&scene);
    let camera = scene.camera;
    scene.camera.origin = Vec3::new(0.1, 0.2, 2.0);
    let inside = prepare(&scene);
    assert!(inside.surfaces != outside.surfaces, "it matters where the camera is");
    moved.set_camera(scene.camera).unwrap();
    assert!(moved.surfaces == inside.surfaces);
    moved.set_camera(camera).unwrap();
    assert!(moved.surfaces == outside.surfaces);
}

/// A picture without roulette, by paths as long as they like.
fn picture(scene: &Scene, samples: u32) -> Film {
    let settings = Settings { roulette_depth: 2000, max_depth: 1000, ..settings(scene) };
    render(&prepare(scene), &settings, samples)
}

/// The mean over the picture is this, unless chance is 1 in a million.
fn assert_mean(film: &Film, expected: DVec3, what: &str) {
    for channel in 0..3 {
        let values: Vec<f64> = film.plain().iter().map(|c| f64::from(c[channel])).collect();
        let (mean, error) = mean_and_error(&values);
        let rounding = 1e-5 * expected[channel];
        assert!(
            (mean - expected[channel]).abs() <= 5.0 * error + rounding,
            "{what}, channel {channel}: {mean} is not {} within 5 of {error}",
            expected[channel]
        );
    }
}

/// What is seen, against white from all sides, of layers of these indices of refraction, colours
/// after a unit, and thicknesses: what they let pass and what they reflect, by adding them up
/// (Stokes 1862), straight on.
fn seen(layers: &[(f64, Vec3, f64)]) -> DVec3 {
    let fresnel = |a: f64, b: f64| ((a - b) / (a + b)).powi(2);
    let of_channel = |channel: usize| {
        // Of the layers so far: reflected from before, from behind, and passed.
        let (mut before, mut behind, mut passed) = (0.0, 0.0, 1.0);
        let mut index = 1.0;
        for &(ior, colour, thickness) in layers.iter().chain(&[(1.0, Vec3::ONE, 0.0)]) {
            let r = fresnel(index, ior);
            let once = 1.0 / (1.0 - behind * r);
            before += passed * passed * r * once;
            let back = r + (1.0 - r) * (1.0 - r) * behind * once;
            let left = f64::from(colour[channel]).powf(thickness);
            (passed, behind) = (passed * (1.0 - r) * once * left, back * left * left);
            index = ior;
        }
        passed + before
    };
    DVec3::new(of_channel(0), of_channel(1), of_channel(2))
}

#[test]
fn light_is_lost_by_beers_law() {
    let colour = Vec3::new(0.9, 0.5, 0.1);
    let attenuation = Some(Attenuation { colour, distance: 2.0 });
    let glass = Principled { attenuation, ..Principled::glass(1.0, 0.0) };
    for (thickness, material, expected) in [
        (2.0, glass, colour),
        (4.0, glass, colour * colour),
        (2.0, Principled { attenuation: None, ..glass }, Vec3::ONE),
        (2.0, Principled { thin_walled: true, ..glass }, Vec3::ONE),
    ] {
        let mut scene = bench();
        add_slab(&mut scene, -thickness, 0.0, Material::Principled(material));
        for pixel in picture(&scene, 16).plain() {
            // All paths go straight through, but for what microfacets as flat as possible hide.
            let off = (pixel - expected).abs().max_element();
            assert!(off < 1e-3, "{thickness}: {pixel} instead of {expected}");
        }
    }
}

/// A liquid between two panes that are thicker than what is seen of them, or of it.
#[test]
fn the_higher_priority_is_there() {
    for (of_glass, of_liquid, layers) in [
        (2, 1, [(2.2, RED, 1.0), (1.4, BLUE, 1.7), (2.2, RED, 1.3)]),
        (1, 2, [(2.2, RED, 0.6), (1.4, BLUE, 2.4), (2.2, RED, 1.0)]),
    ] {
        let mut scene = bench();
        add_slab(&mut scene, 0.0, 1.0, glass(2.2, RED, Some(of_glass)));
        add_slab(&mut scene, -2.0, 0.4, glass(1.4, BLUE, Some(of_liquid)));
        add_slab(&mut scene, -3.0, -1.7, glass(2.2, RED, Some(of_glass)));
        let what = format!("priorities {of_glass} and {of_liquid}");
        assert_mean(&picture(&scene, 4096), seen(&layers), &what);
    }
}

/// The test above can fail: with the layers of the other priority.
#[test]
#[should_panic(expected = "is not")]
fn the_lower_priority_is_not() {
    let mut scene = bench();
    add_slab(&mut scene, 0.0, 1.0, glass(2.2, RED, Some(2)));
    add_slab(&mut scene, -2.0, 0.4, glass(1.4, BLUE, Some(1)));
    let layers = [(2.2, RED, 0.6), (1.4, BLUE, 2.4)];
    assert_mean(&picture(&scene, 4096), seen(&layers), "the other priority");
}

/// Bodies whose boundaries lie in one place, whichever comes first in the scene.
#[test]
fn bodies_that_touch_have_one_interface() {
    let layers = [(1.4, BLUE, 1.0), (2.2, RED, 0.5), (1.4, BLUE, 0.7)];
    for reversed in [false, true] {
        for priorities in [[1, 2], [2, 1]] {
            let [of_liquid, of_glass] = priorities.map(Some);
            let mut slabs = vec![
                (0.0, 1.0, glass(1.4, BLUE, of_liquid)),
                (-0.5, 0.0, glass(2.2, RED, of_glass)),
                (-1.2, -0.5, glass(1.4, BLUE, of_liquid)),
            ];
            if reversed {
                slabs.reverse();
            }
            let mut scene = bench();
            for (low, high, material) in slabs {
                add_slab(&mut scene, low, high, material);
            }
            let what = format!("touching, {priorities:?}, reversed: {reversed}");
            assert_mean(&picture(&scene, 4096), seen(&layers), &what);
        }
    }
}

/// Two ice cubes of one material that touch or overlap are one, and so are their copies.
#[test]
fn bodies_of_one_material_are_one() {
    for low in [0.0, 0.3] {
        let mut scene = bench();
        let ice = scene.add_material(glass(2.0, RED, Some(0)));
        let far = Vec3::new(500.0, 500.0, 0.0);
        add_box(&mut scene, -far - Vec3::Z, far + Vec3::Z * low, false, ice);
        add_box(&mut scene, -far, far + Vec3::Z, false, ice);
        assert_mean(&picture(&scene, 4096), seen(&[(2.0, RED, 2.0)]), &format!("from {low}"));
    }
}

/// What has no priority is there where it was entered last, and refracts relative to what has one.
#[test]
fn a_body_without_a_priority_is_there_in_water() {
    let mut scene = bench();
    add_slab(&mut scene, -2.0, 0.0, glass(1.33, BLUE, Some(1)));
    add_slab(&mut scene, -1.5, -0.5, glass(2.4, RED, None));
    let layers = [(1.33, BLUE, 0.5), (2.4, RED, 1.0), (1.33, BLUE, 0.5)];
    assert_mean(&picture(&scene, 4096), seen(&layers), "a marble in water");
    // Without any priority its index is relative to what is around it.
    let mut scene = bench();
    add_slab(&mut scene, -2.0, 0.0, glass(1.0, BLUE, None));
    add_slab(&mut scene, -1.5, -0.5, glass(2.4, RED, None));
    let layers = [(1.0, BLUE, 0.5), (2.4, RED, 1.0), (1.0, BLUE, 0.5)];
    assert_mean(&picture(&scene, 4096), seen(&layers), "relative to what is around it");
}

/// Light is absorbed up to what it comes from, and up to the eye.
#[test]
fn a_lamp_and_a_camera_within_a_liquid() {
    let mut scene = bench();
    add_slab(&mut scene, -3.0, 0.0, glass(1.0, BLUE, Some(1)));
    let lamp = scene.add_material(scenes::emissive(1.0, 0.0));
    add_quad(&mut scene, Vec3::new(-9.0, -9.0, -2.0), Vec3::X * 18.0, Vec3::Y * 18.0, lamp);
    let left = |thickness: f32| BLUE.as_dvec3().map(|c| c.powf(f64::from(thickness)));
    assert_mean(&picture(&scene, 4), left(2.0), "a lamp");
    (scene.camera.origin.z, scene.camera.target.z) = (-0.5, -1.0);
    assert_mean(&picture(&scene, 4), left(1.5), "a lamp, seen from within");
    scene.camera.target.z = 9.0;
    assert_mean(&picture(&scene, 4), left(0.5), "the outside, seen from within");
    // A liquid of a higher priority around both.
    add_slab(&mut scene, -4.0, 1.0, glass(1.0, RED, Some(2)));
    let left = RED.as_dvec3().map(|c| c.powf(1.5));
    assert_mean(&picture(&scene, 4), left, "the outside, from within two");
}

/// Rough bodies in each other neither lose nor make light, whatever their indices of refraction
/// are relative to each other.
#[test]
fn a_furnace_of_rough_bodies_in_each_other() {
    let mut scene = scenes::empty(Vec3::new(0.0, 0.4, 5.0), Vec3::ZERO);
    scene.background = Vec3::ONE;
    let rough = |ior, roughness, priority| {
        let principled = Principled { priority, ..Principled::glass(ior, roughness) };
        Material::Principled(principled)
    };
    let glass = scene.add_material(rough(1.5, 0.3, Some(2)));
    let water = scene.add_material(rough(1.33, 0.5, Some(1)));
    let ice = scene.add_material(rough(1.31, 0.8, Some(3)));
    let marble = scene.add_material(rough(1.6, 0.4, None));
    add_ball(&mut scene, Vec3::new(-0.4, 0.0, 0.0), 1.0, 3, glass);
    add_ball(&mut scene, Vec3::new(0.5, 0.0, 0.0), 1.0, 3, water);
    add_box(&mut scene, Vec3::new(0.0, 0.2, 0.2), Vec3::new(0.6, 1.2, 0.7), false, ice);
    add_ball(&mut scene, Vec3::new(0.9, -0.3, 0.0), 0.3, 2, marble);
    assert_mean(&picture(&scene, 256), DVec3::ONE, "rough bodies");
}

#[test]
fn a_list_of_bodies_keeps_their_order() {
    // Two without a priority, then two of one, then one of a higher.
    let body = |number, stays_below| Body { number, stays_below };
    let (a, b) = (body(1, PASSES_ALL), body(2, PASSES_ALL));
    let (c, d, e) = (body(3, 4), body(4, 4), body(5, 5));
    let inside = |bodies: &[Body]| bodies.iter().fold(Media::NONE, |media, b| media.entered(*b));
    for (entered, there) in [
        (&[c, d][..], [4, 3, 0, 0]),
        (&[d, c], [3, 4, 0, 0]),
        (&[e, c], [5, 3, 0, 0]),
        (&[c, e, d], [5, 4, 3, 0]),
        (&[e, a], [1, 5, 0, 0]),
        (&[a, e], [5, 1, 0, 0]),
        (&[b, e, a, d], [4, 1, 5, 2]),
        // The one at the bottom is forgotten.
        (&[b, c, d, e, e], [5, 5, 4, 3]),
        (&[e, e, e, e, c], [5, 5, 5, 5]),
    ] {
        let media = inside(entered);
        assert_eq!(media.0.to_le_bytes(), there);
        assert_eq!(media.there(), u32::from(there[0]));
        // Left in any order nothing remains.
        let left = there.iter().rev().fold(media, |m, &number| m.left(body(number.into(), 0)));
        assert_eq!(left, Media::NONE);
    }
    assert_eq!(inside(&[c, e]).left(a), inside(&[c, e]));
    let sides = Sides::both(inside(&[c])).crossed(e, false);
    assert_eq!((sides.here, sides.beyond), (inside(&[c, e]), inside(&[c])));
}
