//! A scene built in code: a mirror between two walls under a lamp.
//!
//! `cargo run --release --example own_scene -- [PICTURE] [SAMPLES] [DEVICE]`

use glam::Vec3;
use raystream::prelude::*;
use raystream::scene::{Camera, Material, Mesh, QuadLight};

/// Adds a parallelogram.
fn add_quad(scene: &mut Scene, corner: Vec3, u: Vec3, v: Vec3, material: Material) {
    let material = scene.add_material(material);
    let corners = vec![corner, corner + u, corner + u + v, corner + v];
    scene.add_mesh(Mesh::new(material, corners, vec![[0, 1, 2], [0, 2, 3]]));
}

fn own_scene() -> Scene {
    let (x, y, z) = (Vec3::X, Vec3::Y, Vec3::Z);
    let camera = Camera::new(y + 4.0 * z, 0.8 * y, 45.0);
    let mut scene = Scene::new(camera, FilmSize { width: 320, height: 240 });
    let corner = -2.0 * x - 2.0 * z;
    add_quad(&mut scene, corner, 4.0 * z, 4.0 * x, Material::diffuse(Vec3::splat(0.7)));
    add_quad(&mut scene, corner, 4.0 * x, 3.0 * y, Material::diffuse(Vec3::splat(0.7)));
    add_quad(&mut scene, corner, 3.0 * y, 4.0 * z, Material::diffuse(Vec3::new(0.7, 0.2, 0.1)));
    let mirror = Material::mirror(Vec3::splat(0.9));
    add_quad(&mut scene, -0.5 * x - z, 1.5 * x, 1.2 * y, mirror);
    scene.add_quad_light(QuadLight::new(-0.5 * x + 2.5 * y, x, z, Vec3::splat(10.0)));
    scene
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut arguments = std::env::args().skip(1);
    let picture = arguments.next().unwrap_or("own_scene.png".into());
    let samples = arguments.next().map_or(Ok(16), |text| text.parse())?;
    let device = Device::open(&arguments.next().unwrap_or("auto".into()))?;

    let scene = own_scene();
    let film = render(&scene, &Settings::for_scene(&scene), Budget::samples(samples), device)?;
    image::write_film(picture, &film)?;
    Ok(())
}
