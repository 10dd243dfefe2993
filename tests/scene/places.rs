//! Where a scene is and how large does not show: files of all sizes, near the origin and far from
//! it, with their lights and cameras.

use glam::DVec3;
use raystream::exec::cpu::CpuExecutor;
use raystream::render::Settings;
use raystream::scene::Scene;
use raystream_tests::scene_folder::{SceneFolder, obj_of};
use raystream_tests::statistics::assert_same_expectation;
use raystream_tests::{prepare, render_on, scenes, settings, with_gpu};
use serde_json::json;

/// Where and how large a scene is: a unit of it in world units, and where its origin is.
#[derive(Clone, Copy, Debug)]
struct Place {
    scale: f64,
    origin: DVec3,
}

impl Place {
    fn of(self, point: DVec3) -> DVec3 {
        point * self.scale + self.origin
    }

    fn json(self, x: f64, y: f64, z: f64) -> serde_json::Value {
        json!(self.of(DVec3::new(x, y, z)).to_array())
    }
}

const HOME: Place = Place { scale: 1.0, origin: DVec3::ZERO };

/// The room with a lamp, a block and a ball of glass as an OBJ, with a quad light besides, at a
/// place.
fn room(place: Place) -> Scene {
    let obj = obj_of(&scenes::room(scenes::glass(1.5), 1.0), |point| place.of(point));
    let edge = |x: f64, y: f64, z: f64| json!((DVec3::new(x, y, z) * place.scale).to_array());
    let folder = SceneFolder::new().with("a.obj", obj).json(|scene| {
        scene["film"] = json!({"width": 16, "height": 12});
        scene["camera"]["origin"] = place.json(0.5, 0.5, 0.05);
        scene["camera"]["target"] = place.json(0.5, 0.45, 1.0);
        scene["camera"]["fov_y"] = json!(70);
        scene["quads"] = json!([{
            "corner": place.json(0.02, 0.5, 0.3),
            "u": edge(0.0, 0.1, 0.0),
            "v": edge(0.0, 0.0, 0.2),
            "radiance": [5, 3, 9],
        }]);
        scene["materials"] = json!({
            "m0": {"type": "diffuse", "reflectance": [0.6, 0.6, 0.6]},
            "m1": {"type": "emissive", "radiance": [12, 12, 12], "reflectance": [0.3, 0.3, 0.3]},
            "m2": {"type": "diffuse", "reflectance": [0.7, 0.3, 0.2]},
            "m3": {"type": "dielectric", "ior": 1.5},
        });
    });
    folder.load().unwrap()
}

#[test]
fn the_picture_is_the_same_at_any_size_and_in_any_place() {
    let picture = |place, seed, samples| {
        let scene = room(place);
        let settings = Settings { seed, ..settings(&scene) };
        (render_on(&CpuExecutor, &prepare(&scene), &settings, samples), scene, settings)
    };
    let (home, scene, _) = picture(HOME, 1, 2048);
    assert!(!scene.warnings.iter().any(|warning| warning.contains("far from the origin")));
    let far = DVec3::new(1e6, -3e5, 7e5);
    let places = [
        (1e-6, DVec3::ZERO),
        (1e6, DVec3::ZERO),
        (1.0, far),
        (1e-6, far * 1e-6),
        (1e6, far * 9e5),
        // Millimetres in map coordinates.
        (1e3, DVec3::new(448_250e3, 95e3, 5_411_780e3)),
        // As far as is still near: nothing is moved.
        (1.0, DVec3::splat(5.0)),
    ];
    for (seed, (scale, origin)) in (2..).zip(places) {
        let place = Place { scale, origin };
        let (film, scene, settings) = picture(place, seed, 1024);
        assert_same_expectation(&home, &film, &format!("{place:?}"));
        let says = scene.warnings.iter().any(|warning| warning.contains("far from the origin"));
        assert_eq!(says, origin.abs().max_element() > 16.0 * scale, "{place:?}");
        if seed % 2 == 0 {
            continue;
        }
        with_gpu(|gpu| {
            let film = render_on(gpu, &prepare(&scene), &settings, 256);
            assert_same_expectation(&home, &film, &format!("{place:?} on a GPU"));
        });
    }
}
