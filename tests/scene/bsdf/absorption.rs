//! What light loses on its way through a body.

use glam::Vec3;
use raystream::render::Settings;
use raystream::scene::{Attenuation, Material, Principled, Projection, Scene};
use raystream_tests::scenes::{self, add_box};
use raystream_tests::{prepare, render, settings};

/// A slab that bends nothing, so thick, before a white background.
fn slab(thickness: f32, material: Principled) -> Scene {
    let mut scene = scenes::empty(Vec3::new(0.0, 0.0, 3.0), Vec3::ZERO);
    scene.camera.projection = Projection::Perspective { fov_y: 0.5, lens: None };
    let material = scene.add_material(Material::Principled(material));
    let far = Vec3::new(5.0, 5.0, 0.0);
    add_box(&mut scene, -far - Vec3::Z * thickness, far, false, material);
    scene.background = Vec3::ONE;
    scene
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
        let scene = slab(thickness, material);
        // Roulette would make noise of what is dim.
        let settings = Settings { roulette_depth: 99, ..settings(&scene) };
        let film = render(&prepare(&scene), &settings, 16);
        for pixel in film.plain() {
            // All paths go straight through, but for what microfacets as flat as possible hide.
            let off = (pixel - expected).abs().max_element();
            assert!(off < 1e-3, "{thickness}: {pixel} instead of {expected}");
        }
    }
}
