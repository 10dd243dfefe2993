//! Scenes under an environment.

use crate::program::render;
use glam::Vec3;
use raystream::image::{ColorImage, Display, read_color, write_color};
use raystream_tests::scene_folder::SceneFolder;

/// A scene without a light of its own, and an environment with one bright side, `sky.exr`.
fn folder() -> SceneFolder {
    let scene = SceneFolder::new().json(|scene| scene["quads"] = serde_json::json!([]));
    let texel = |k: u32| if k % 32 < 16 { Vec3::X } else { Vec3::Y };
    let sky = ColorImage { width: 32, height: 16, pixels: (0..512).map(texel).collect() };
    write_color(&scene.path("sky.exr"), &sky, &[], &Display::default()).unwrap();
    scene
}

#[test]
fn an_environment_lights_a_scene_without_lights() {
    let scene = folder();
    let folder = &scene.path("");
    let lit = "scene.json --spp 4 --environment sky.exr";
    let dark = render(folder, "scene.json --spp 4 -o dark.exr").succeeded();
    dark.says(&["nothing emits light"]);
    let run = render(folder, &format!("{lit} -o a.exr")).succeeded();
    assert!(!run.stderr.contains("nothing emits light"), "{}", run.stderr);
    render(folder, &format!("{lit} --environment-rotation 180 -o b.exr")).succeeded();
    render(folder, &format!("{lit} --environment-strength 2 -o c.exr")).succeeded();
    let corner = |name: &str| read_color(&scene.path(name)).unwrap().pixels[0];
    // The camera looks at the middle of the picture; at its left is red.
    assert_eq!(corner("a.exr"), Vec3::X);
    assert_eq!(corner("b.exr"), Vec3::Y);
    assert_eq!(corner("c.exr"), Vec3::X * 2.0);
}

#[test]
fn a_sky_lights_a_scene() {
    let scene = folder();
    let folder = &scene.path("");
    let lit = "scene.json --spp 1 --sky 30 --environment-strength 0.1";
    let run = render(folder, &format!("{lit} -o a.exr")).succeeded();
    assert!(!run.stderr.contains("nothing emits light"), "{}", run.stderr);
    let corner = read_color(&scene.path("a.exr")).unwrap().pixels[0];
    assert!(corner.min_element() > 0.0, "{corner}");
}

#[test]
fn environments_that_are_of_no_use() {
    let scene = folder().with("sky.png", "no picture");
    let folder = &scene.path("");
    for (options, says) in [
        ("--environment missing.hdr", "missing.hdr"),
        ("--environment sky.png", "sky.png: not a usable environment"),
        ("--environment scene.json", "neither a Radiance HDR nor an EXR"),
        ("--environment sky.exr --environment-strength -1", "--environment-strength"),
        ("--environment sky.exr --environment-rotation nan", "--environment-rotation"),
        ("--environment-rotation 5", "<--environment <FILE>|--sky <DEGREES>>"),
        ("--environment sky.exr --sky 30", "cannot be used with"),
        ("--sky -1", "'-1' is not an angle in degrees, from 0 to 90"),
    ] {
        render(folder, &format!("scene.json --spp 1 -o a.png {options}")).failed(&[says]);
    }
    assert!(!scene.path("a.png").exists());
}
