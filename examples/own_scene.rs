//! A scene built in code: a mirror between two walls under a lamp.
//!
//! `cargo run --release --example own_scene -- [PICTURE] [SAMPLES] [DEVICE]`

use glam::Vec3;
use raystream::prelude::*;
use raystream::scene::{CameraSettings, PathLimits};
use raystream_shaders::scene::bsdf::{Material, MaterialKind};
use raystream_shaders::scene::texture::NO_TEXTURE;
use raystream_shaders::scene::triangle::{NO_ATTRIBUTES, Triangle};

fn diffuse(reflectance: Vec3) -> Material {
    Material {
        reflectance,
        kind: MaterialKind::DIFFUSE,
        emission: Vec3::ZERO,
        texture: NO_TEXTURE,
        transmittance: Vec3::ONE,
        ior: 1.0,
    }
}

/// Adds a parallelogram whose front is the side of `cross(u, v)`.
fn add_quad(scene: &mut Scene, corner: Vec3, u: Vec3, v: Vec3, material: Material) {
    let number = scene.materials.len() as u32;
    scene.materials.push(material);
    for [edge1, edge2] in [[u, u + v], [u + v, v]] {
        scene.triangles.push(Triangle {
            corner,
            edge1,
            edge2,
            material: number,
            attributes: NO_ATTRIBUTES,
        });
    }
}

fn own_scene() -> Scene {
    let mut scene = Scene {
        name: "two walls".into(),
        film: FilmSize { width: 320, height: 240 },
        camera: CameraSettings {
            origin: Vec3::new(0.0, 1.0, 4.0),
            target: Vec3::new(0.0, 0.8, 0.0),
            up: Vec3::Y,
            fov_y: 45.0,
        },
        limits: PathLimits { max_depth: 8, roulette_depth: 5 },
        triangles: Vec::new(),
        attributes: Vec::new(),
        materials: Vec::new(),
        // The table that decodes sRGB, which no texture here needs.
        texels: vec![0; 256],
        warnings: Vec::new(),
    };
    let (x, y, z) = (Vec3::X, Vec3::Y, Vec3::Z);
    let (white, red) = (diffuse(Vec3::splat(0.7)), diffuse(Vec3::new(0.7, 0.2, 0.1)));
    let mirror = Material { kind: MaterialKind::MIRROR, ..diffuse(Vec3::splat(0.9)) };
    let lamp = Material { emission: Vec3::splat(10.0), ..diffuse(Vec3::splat(0.3)) };
    add_quad(&mut scene, -2.0 * x - 2.0 * z, 4.0 * z, 4.0 * x, white);
    add_quad(&mut scene, -2.0 * x - 2.0 * z, 4.0 * x, 3.0 * y, white);
    add_quad(&mut scene, -2.0 * x - 2.0 * z, 3.0 * y, 4.0 * z, red);
    add_quad(&mut scene, -0.5 * x - z, 1.5 * x, 1.2 * y, mirror);
    add_quad(&mut scene, -0.5 * x + 2.5 * y, x, z, lamp);
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
