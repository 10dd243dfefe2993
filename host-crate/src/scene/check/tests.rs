//! What is wrong with a scene is named, and where.

use crate::scene::camera::Camera;
use crate::scene::description::Scene;
use crate::scene::environment::Environment;
use crate::scene::film::FilmSize;
use crate::scene::light::QuadLight;
use crate::scene::material::{
    Attenuation, BumpMap, Material, MaterialId, NormalMap, Opacity, Principled,
};
use crate::scene::mesh::Mesh;
use crate::scene::metal::{Conductor, Metal};
use crate::scene::texture::{Texels, Texture, TextureId, Wrap};
use glam::{Vec2, Vec3, Vec4};

/// A triangle under a lamp.
fn scene() -> Scene {
    let camera = Camera::new(Vec3::Z, Vec3::ZERO, 40.0);
    let mut scene = Scene::new(camera, FilmSize { width: 4, height: 3 });
    let material = scene.add_material(Material::diffuse(Vec3::ONE));
    let positions = vec![Vec3::ZERO, Vec3::X, Vec3::Y];
    scene.add_mesh(Mesh::new(material, positions, vec![[0, 1, 2]]));
    scene.add_quad_light(QuadLight::new(Vec3::Z, Vec3::X, Vec3::Y, Vec3::ONE));
    scene
}

#[test]
fn good_scenes_pass() {
    assert_eq!(scene().check(), Ok(()));
    let mut flat = scene();
    flat.meshes[0].triangles.push([1, 1, 1]);
    assert_eq!(flat.check(), Ok(()), "a triangle without area is left out later");
    let mut limits = scene();
    limits.add_material(Material::glass(0.01));
    limits.add_material(Material::emissive(Vec3::splat(1e12)));
    limits.add_material(Material::Principled(Principled::glass(100.0, 1.0)));
    assert_eq!(limits.check(), Ok(()), "limits survive being rounded to an f32");
}

/// A place and what spoils a scene there.
type Case<'a> = (&'a str, &'a dyn Fn(&mut Scene));

/// Spoils scenes and asserts that the place is named.
fn assert_named(cases: &[Case<'_>]) {
    for (place, spoil) in cases {
        let mut scene = scene();
        spoil(&mut scene);
        assert_eq!(scene.check().unwrap_err().place, *place);
    }
}

const NAN: Vec3 = Vec3::new(0.0, f32::NAN, 0.0);

fn texture(width: u32, texels: usize) -> Texture {
    Texture::new(width, 1, vec![[0; 4]; texels])
}

fn number(texel: [f32; 3]) -> Texture {
    Texture::of(1, 1, Texels::Floats(vec![texel]))
}

/// Paint with something changed.
fn paint(change: impl Fn(&mut Principled)) -> Material {
    let mut material = Principled::paint(Vec3::ONE, 0.5);
    change(&mut material);
    Material::Principled(material)
}

#[test]
fn what_is_wrong_with_a_material_is_named() {
    assert_named(&[
        ("materials[0]", &|s| s.materials[0] = Material::textured(TextureId(0))),
        ("materials[0]", &|s| s.materials[0] = Material::mirror(Vec3::splat(1.1))),
        ("materials[0]", &|s| s.materials[0] = Material::glass(0.0)),
        ("materials[0]", &|s| s.materials[0] = Material::emissive(NAN)),
        ("materials[0]", &|s| s.materials[0] = paint(|m| m.roughness = 1.1)),
        ("materials[0]", &|s| {
            let texture = s.add_texture(texture(1, 1));
            s.materials[0] = paint(|m| m.maps.bump = Some(BumpMap { texture, height: 1e5 }));
        }),
        ("materials[0]", &|s| {
            let texture = s.add_texture(Texture { wrap: [Wrap::Mirror; 2], ..texture(1, 1) });
            s.materials[0] = paint(|m| m.maps.bump = Some(BumpMap { texture, height: 1.0 }));
        }),
        ("materials[0]", &|s| {
            let texture = s.add_texture(texture(1, 1));
            s.materials[0] = paint(|m| {
                m.maps.bump = Some(BumpMap { texture, height: 1.0 });
                m.maps.normal = Some(NormalMap { texture, scale: 1.0 });
            });
        }),
        ("materials[0]", &|s| s.materials[0] = paint(|m| m.coat = -0.1)),
        ("materials[0]", &|s| s.materials[0] = paint(|m| m.anisotropy.strength = 1.1)),
        ("materials[0]", &|s| s.materials[0] = paint(|m| m.anisotropy.rotation = f32::NAN)),
        ("materials[0]", &|s| s.materials[0] = paint(|m| m.sheen.x = 1.1)),
        ("materials[0]", &|s| {
            let map = Some(s.add_texture(number([1e7; 3])));
            s.materials[0] = paint(|m| (m.emission, m.maps.emission) = (Vec3::splat(1e6), map));
        }),
        ("materials[0]", &|s| {
            s.materials[0] = Material::Principled(Principled::metal(NAN, 0.1));
        }),
        ("materials[0]", &|s| {
            s.materials[0] = Material::Principled(Principled::glass(0.0, 0.1));
        }),
        ("materials[0]", &|s| {
            s.materials[0] = paint(|m| m.opacity = Opacity::Blend { alpha: f32::NAN });
        }),
        ("materials[0]", &|s| {
            s.materials[0] = paint(|m| {
                m.opacity = Opacity::Mask { alpha: 1.0, cutoff: 0.5 };
                m.emission = Vec3::ONE;
            });
        }),
        ("materials[0]", &|s| {
            let gold = Principled::conductor(Metal::Gold.conductor(), 0.1);
            s.materials[0] = Material::Principled(Principled { metallic: 0.5, ..gold });
        }),
        ("materials[0]", &|s| {
            let of_nothing = Conductor { eta: Vec3::ZERO, k: Vec3::ONE };
            let metal = Principled::conductor(of_nothing, 0.1);
            s.materials[0] = Material::Principled(metal);
        }),
    ]);
}

#[test]
fn what_is_wrong_with_a_body_is_named() {
    assert_named(&[
        ("materials[0]", &|s| s.materials[0] = paint(|m| m.priority = Some(1))),
        ("materials[0]", &|s| {
            s.materials[0] = paint(|m| (m.transmission, m.priority) = (1.0, Some(1001)));
        }),
        ("materials[0]", &|s| {
            s.materials[0] = paint(|m| {
                (m.transmission, m.thin_walled, m.priority) = (1.0, true, Some(1));
            });
        }),
        ("materials[0]", &|s| {
            s.materials[0] = paint(|m| {
                m.attenuation = Some(Attenuation { colour: Vec3::ONE, distance: 0.0 });
            });
        }),
        ("materials", &|s| {
            let water = Principled { priority: Some(1), ..Principled::glass(1.3, 0.0) };
            let liquids = (0..256).map(|k| Principled { ior: 1.3 + k as f32 * 1e-3, ..water });
            s.materials.extend(liquids.map(Material::Principled));
        }),
    ]);
}

#[test]
fn what_is_wrong_around_the_meshes_is_named() {
    let environment = |texel| Some(Environment::new(1, 1, vec![texel]));
    let bright = Environment { strength: 2e6, ..Environment::new(1, 1, vec![Vec3::ONE]) };
    assert_named(&[
        ("environment", &|s| s.environment = environment(NAN)),
        ("environment", &|s| s.environment = Some(Environment::new(2, 1, vec![Vec3::ONE]))),
        ("environment", &|s| s.environment = Some(bright.clone())),
        ("film", &|s| s.film.width = 0),
        ("camera", &|s| s.camera.target = s.camera.origin),
        ("camera", &|s| s.camera.up = Vec3::ZERO),
        ("camera", &|s| s.camera = Camera::new(Vec3::Z, Vec3::ZERO, f32::NAN)),
        ("limits.max_depth", &|s| s.limits.max_depth = 0),
        ("background", &|s| s.background = Vec3::NEG_X),
        ("textures[0]", &|s| s.textures.push(texture(0, 0))),
        ("textures[0]", &|s| s.textures.push(texture(2, 1))),
        ("textures[0]", &|s| s.textures.push(number([0.0, -1.0, 0.0]))),
        ("textures[0]", &|s| s.textures.push(number([f32::NAN; 3]))),
        ("quad_lights[0]", &|s| s.quad_lights[0].v = s.quad_lights[0].u),
        ("quad_lights[0].radiance", &|s| s.quad_lights[0].radiance = NAN),
    ]);
}

#[test]
fn what_is_wrong_with_a_mesh_is_named() {
    assert_named(&[
        ("meshes[0].material", &|s| s.meshes[0].material = MaterialId(1)),
        ("meshes[0].positions[1]", &|s| s.meshes[0].positions[1] = NAN),
        ("meshes[0].triangles[0]", &|s| s.meshes[0].triangles[0][2] = 3),
        ("meshes[0].normals", &|s| s.meshes[0].normals = Some(Vec::new())),
        ("meshes[0].normals[0]", &|s| s.meshes[0].normals = Some(vec![[Vec3::ONE; 3]])),
        ("meshes[0].texture_coordinates[0]", &|s| {
            s.meshes[0].texture_coordinates = Some(vec![[Vec2::INFINITY; 3]]);
        }),
        ("meshes[0].colours", &|s| s.meshes[0].colours = Some(Vec::new())),
        ("meshes[0].colours[0]", &|s| {
            s.meshes[0].colours = Some(vec![[Vec4::ONE, Vec4::NAN, Vec4::ONE]]);
        }),
        ("meshes[0].colours", &|s| {
            s.materials[0] = Material::mirror(Vec3::ONE);
            s.meshes[0].colours = Some(vec![[Vec4::ONE; 3]]);
        }),
        ("meshes[0].colours", &|s| {
            s.materials[0] = paint(|m| {
                (m.transmission, m.opacity) = (1.0, Opacity::Blend { alpha: 1.0 });
            });
            s.meshes[0].colours = Some(vec![[Vec4::splat(0.5); 3]]);
        }),
        ("meshes[0].texture_coordinates", &|s| {
            let texture = s.add_texture(texture(1, 1));
            s.materials[0] = Material::textured(texture);
        }),
    ]);
}
