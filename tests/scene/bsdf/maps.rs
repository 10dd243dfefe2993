//! Textures of principled materials: what they multiply, and normals that they bend.

use super::principled::{arriving, met, samples};
use glam::{Quat, Vec2, Vec3};
use raystream::render::PreparedScene;
use raystream::scene::{
    BumpMap, Camera, Channel, FilmSize, Maps, Material, Mesh, NormalMap, Principled, Scene, Texels,
    Texture,
};
use raystream_shaders::math::random::SOBOL;
use raystream_tests::prepare;

/// What a code of a byte can round.
const ROUNDING: f32 = 1e-3;

/// A floor of normal +z with a texture of one `texel`, whose `u` grows along `along` and whose `v`
/// along `across`.
fn floor(
    texel: [u8; 4],
    [along, across]: [Vec2; 2],
    material: impl Fn(raystream::scene::TextureId) -> Principled,
) -> PreparedScene {
    let camera = Camera::new(Vec3::Z, Vec3::ZERO, 40.0);
    let mut scene = Scene::new(camera, FilmSize { width: 4, height: 3 });
    let texture = scene.add_texture(Texture::new(1, 1, vec![texel]));
    let material = scene.add_material(Material::Principled(material(texture)));
    let corners = [Vec2::new(-9.0, -9.0), Vec2::new(9.0, -9.0), Vec2::new(0.0, 9.0)];
    let positions = corners.map(|corner| corner.extend(0.0)).to_vec();
    let mut mesh = Mesh::new(material, positions, vec![[0, 1, 2]]);
    mesh.texture_coordinates =
        Some(vec![corners.map(|corner| Vec2::new(corner.dot(along), corner.dot(across)))]);
    scene.add_mesh(mesh);
    prepare(&scene)
}

/// The normal of a floor whose texture rises from black to white along `along`, as it is met.
#[test]
fn bumps_tilt_by_their_height_over_the_size_of_the_texture() {
    let size = 32;
    let mut scene =
        Scene::new(Camera::new(Vec3::Z, Vec3::ZERO, 40.0), FilmSize { width: 4, height: 3 });
    let ramp = (0..size).map(|k| [k as f32 / size as f32; 3]).collect();
    let texture = scene.add_texture(Texture::of(size, 1, Texels::Floats(ramp)));
    let bump = Some(BumpMap { texture, height: 3.0 });
    let maps = Maps { bump, ..Maps::default() };
    let material = scene.add_material(Material::Principled(Principled { maps, ..material() }));
    // One texture is 6 units long along x, and mirrored: 3 units high, falling with x.
    let corners = [Vec2::new(-9.0, -9.0), Vec2::new(9.0, -9.0), Vec2::new(0.0, 9.0)];
    let positions = corners.map(|corner| corner.extend(0.0)).to_vec();
    let mut mesh = Mesh::new(material, positions, vec![[0, 1, 2]]);
    let uv = |corner: Vec2| Vec2::new(0.5 - corner.x / 6.0, corner.y);
    mesh.texture_coordinates = Some(vec![corners.map(uv)]);
    scene.add_mesh(mesh);
    let floor = prepare(&scene);
    let bsdf = met(&floor, arriving(30.0, true));
    let expected = Vec3::new(0.5, 0.0, 1.0).normalize();
    assert!((bsdf.normal - expected).length() < ROUNDING, "{} {expected}", bsdf.normal);
}

fn material() -> Principled {
    Principled { metallic: 0.5, ..Principled::paint(Vec3::new(1.0, 0.5, 0.25), 0.8) }
}

#[test]
fn maps_multiply_what_the_material_has() {
    let floor = floor([128, 51, 204, 255], [Vec2::X, Vec2::Y], |texture| Principled {
        maps: Maps {
            base_colour: Some(texture),
            roughness: Some(Channel { texture, channel: 1 }),
            metallic: Some(Channel { texture, channel: 2 }),
            ..Maps::default()
        },
        ..material()
    });
    let bsdf = met(&floor, arriving(30.0, true));
    assert!((bsdf.layers.roughness - 0.8 * 0.2).abs() < ROUNDING, "{:?}", bsdf.layers);
    assert!((bsdf.layers.metallic - 0.5 * 0.8).abs() < ROUNDING, "{:?}", bsdf.layers);
    // Colours are sRGB, the others are not.
    let expected = Vec3::new(0.2159, 0.5 * 0.0331, 0.25 * 0.6038);
    assert!((bsdf.reflectance - expected).abs().max_element() < ROUNDING, "{}", bsdf.reflectance);
    assert_eq!(bsdf.normal, Vec3::Z);
}

#[test]
fn normals_bend_along_the_texture_coordinates() {
    // Half a unit along u, none along v.
    let texel = [191, 128, 255, 255];
    let slope = 2.0 * 191.0 / 255.0 - 1.0;
    let tilted = |along: Vec2| (along.extend(0.0) * slope + Vec3::Z).normalize();
    let turned = Vec2::new(0.6, 0.8);
    for (axes, expected) in [
        ([Vec2::X, Vec2::Y], tilted(Vec2::X)),
        ([turned, turned.perp()], tilted(turned)),
        ([-Vec2::X, Vec2::Y], tilted(-Vec2::X)),
    ] {
        for (scale, expected) in [(1.0, expected), (0.0, Vec3::Z)] {
            let floor = floor(texel, axes, |texture| Principled {
                maps: Maps { normal: Some(NormalMap { texture, scale }), ..Maps::default() },
                ..material()
            });
            let above = met(&floor, arriving(10.0, true));
            assert!((above.normal - expected).length() < 0.01, "{axes:?}: {}", above.normal);
            let below = met(&floor, arriving(10.0, false));
            assert!((below.normal + expected).length() < 0.01, "{axes:?}: {}", below.normal);
            assert!(above.from_outside && !below.from_outside);
        }
    }
    // Green along v, which is to the left of u where texture coordinates are mirrored as well.
    for (axes, expected) in
        [([Vec2::X, Vec2::Y], tilted(Vec2::Y)), ([Vec2::X, -Vec2::Y], tilted(-Vec2::Y))]
    {
        let floor = floor([128, 191, 255, 255], axes, |texture| Principled {
            maps: Maps { normal: Some(NormalMap { texture, scale: 1.0 }), ..Maps::default() },
            ..material()
        });
        let normal = met(&floor, arriving(10.0, true)).normal;
        assert!((normal - expected).length() < 0.01, "{axes:?}: {normal}");
    }
}

#[test]
fn no_map_turns_the_seen_side_away() {
    for texel in [[255, 128, 128, 255], [0, 0, 128, 255], [128, 128, 0, 255]] {
        let floor = floor(texel, [Vec2::X, Vec2::Y], |texture| Principled {
            maps: Maps { normal: Some(NormalMap { texture, scale: 2.0 }), ..Maps::default() },
            ..material()
        });
        for degrees in [5.0, 60.0, 89.0] {
            for is_above in [true, false] {
                let incoming = arriving(degrees, is_above);
                let bsdf = met(&floor, incoming);
                assert_eq!(bsdf.from_outside, is_above, "{texel:?}, {degrees} degrees");
                assert!(bsdf.normal.dot(incoming) < 0.0, "{texel:?}: {}", bsdf.normal);
            }
        }
    }
}

/// A floor that is tilted by 45 degrees towards +x, by its map alone.
fn steep_floor() -> PreparedScene {
    floor([255, 128, 255, 255], [Vec2::X, Vec2::Y], |texture| Principled {
        maps: Maps { normal: Some(NormalMap { texture, scale: 1.0 }), ..Maps::default() },
        ..material()
    })
}

#[test]
fn a_mirror_image_is_above_what_is_bent() {
    for texel in [[255, 128, 200, 255], [0, 0, 128, 255], [160, 90, 255, 255], [128, 128, 0, 255]] {
        let floor = floor(texel, [Vec2::X, Vec2::Y], |texture| Principled {
            maps: Maps { normal: Some(NormalMap { texture, scale: 1.0 }), ..Maps::default() },
            ..material()
        });
        let mut bent = 0;
        for incoming in directions().filter(|direction| direction.z.abs() > 1e-3) {
            let bsdf = met(&floor, incoming);
            let height = |direction: Vec3| direction.dot(bsdf.geometric);
            let (mirrored, own) = (height(incoming.reflect(bsdf.normal)), height(-incoming));
            let least = (0.9 * own).min(0.01);
            assert!(mirrored > least - 1e-3, "{texel:?} {incoming}: {mirrored} of {own}");
            // No more than it takes.
            if bsdf.normal.dot(bsdf.mapped.shading) < 1.0 - 1e-6 {
                let is_least = (mirrored - least).abs() < 1e-3;
                let is_flat = bsdf.normal.dot(bsdf.geometric) > 1.0 - 1e-5;
                assert!(is_least || is_flat, "{texel:?} {incoming}: {mirrored} of {own}");
                bent += 1;
            }
        }
        assert!(bent > 20, "{texel:?}: {bent}");
    }
}

/// Directions all around.
fn directions() -> impl Iterator<Item = Vec3> {
    (0..400).map(|k| {
        let (sin, cos) = (k as f32 * 2.4).sin_cos();
        let z = k as f32 / 199.5 - 1.0;
        let radius = (1.0 - z * z).max(0.0).sqrt();
        Vec3::new(radius * cos, radius * sin, z).normalize()
    })
}

#[test]
fn light_passes_no_wall_for_being_above_its_map() {
    let floor = steep_floor();
    for is_above in [true, false] {
        let incoming = arriving(10.0, is_above);
        let bsdf = met(&floor, incoming);
        let keeps = |direction: Vec3| direction.z * incoming.z < 0.0;
        let mut between = 0;
        for direction in directions() {
            let is_lit = direction.dot(bsdf.normal) > 0.0;
            between += u32::from(is_lit && !keeps(direction));
            let found = bsdf.eval(incoming, direction);
            assert_eq!(found.pdf > 0.0, is_lit && keeps(direction), "{direction}");
            assert_eq!(found.weight.max_element() > 0.0, found.pdf > 0.0, "{direction}");
        }
        assert!(between > 20, "{between}");
        let mut left = 0;
        for sample in samples(bsdf, incoming, SOBOL) {
            let goes_on = sample.weight.max_element() > 0.0;
            assert!(!goes_on || keeps(sample.direction), "{}", sample.direction);
            left += u32::from(goes_on);
        }
        assert!(left > 40_000, "{left}");
    }
}

#[test]
fn a_tilted_map_is_a_tilted_floor() {
    let tilted = steep_floor();
    // From where what the map mirrors is above the floor.
    let incoming = Vec3::new(-0.4, 0.1, -1.0).normalize();
    let bsdf = met(&tilted, incoming);
    let to_flat = Quat::from_rotation_arc(bsdf.normal, Vec3::Z);
    let flat = super::principled::floor(material());
    let turned = to_flat * incoming;
    let expected = met(&flat, turned);
    let mut compared = 0;
    for direction in directions().filter(|d| d.z > 0.0 && d.dot(bsdf.normal) > 0.01) {
        let here = bsdf.eval(incoming, direction);
        let there = expected.eval(turned, to_flat * direction);
        let (value, wanted) = (here.weight * here.pdf, there.weight * there.pdf);
        assert!((value - wanted).length() < 1e-4 * wanted.length(), "{value} {wanted}");
        compared += 1;
    }
    assert!(compared > 80, "{compared}");
}
