//! Textures of cover, passage, reflection and grain: what they multiply, and coats with a normal of
//! their own.

use super::principled::{ANGLES, arriving, assert_directions_follow_the_density, energy, met};
use glam::{Mat2, Vec2, Vec3};
use raystream::render::PreparedScene;
use raystream::scene::{
    Anisotropy, Camera, Channel, CoordinateSet, FilmSize, Maps, Material, Mesh, NormalMap,
    Placement, Principled, Scene, Texture, TextureId,
};
use raystream_tests::prepare;

/// What a code of a byte can round.
const ROUNDING: f32 = 2e-3;
/// What a texture says in the tests of numbers.
const TEXEL: [u8; 4] = [102, 51, 204, 153];

/// A floor of normal +z whose textures have one texel each; the first texture coordinates grow
/// along x and y.
fn floor(texels: &[[u8; 4]], material: impl Fn(&[TextureId]) -> Principled) -> PreparedScene {
    let camera = Camera::new(Vec3::Z, Vec3::ZERO, 40.0);
    let mut scene = Scene::new(camera, FilmSize { width: 4, height: 3 });
    let add = |texel: &[u8; 4]| scene.add_texture(Texture::new(1, 1, vec![*texel]));
    let textures: Vec<TextureId> = texels.iter().map(add).collect();
    // A material without any of these textures comes first, so that a wrong number is seen.
    scene.add_material(Material::Principled(Principled::paint(Vec3::ONE, 0.5)));
    let material = scene.add_material(Material::Principled(material(&textures)));
    let corners = [Vec2::new(-9.0, -9.0), Vec2::new(9.0, -9.0), Vec2::new(0.0, 9.0)];
    let positions = corners.map(|corner| corner.extend(0.0)).to_vec();
    let mut mesh = Mesh::new(material, positions, vec![[0, 1, 2]]);
    mesh.texture_coordinates = Some(vec![corners]);
    scene.add_mesh(mesh);
    prepare(&scene)
}

fn material() -> Principled {
    Principled {
        coat: 0.5,
        coat_roughness: 0.8,
        sheen: Vec3::new(1.0, 0.5, 0.25),
        sheen_roughness: 0.9,
        transmission: 0.6,
        specular: Vec3::new(1.0, 2.0, 0.5),
        ..Principled::paint(Vec3::splat(0.8), 0.4)
    }
}

#[test]
fn maps_multiply_what_the_layers_have() {
    let plain = met(&floor(&[TEXEL], |_| material()), arriving(30.0, true)).layers;
    let channel = |texture, channel| Some(Channel { texture, channel });
    let [red, green, blue, alpha] = TEXEL.map(|code| f32::from(code) / 255.0);
    let colour = Vec3::new(0.1329, 0.0331, 0.6038);
    let mut expected = plain;
    let mut maps = Maps::default();
    // Each by itself, and all that came before.
    for number in 0..7 {
        let changed = |texture: TextureId, maps: &mut Maps| match number {
            0 => maps.coat = channel(texture, 0),
            1 => maps.coat_roughness = channel(texture, 1),
            2 => maps.sheen = Some(texture),
            3 => maps.sheen_roughness = channel(texture, 3),
            4 => maps.transmission = channel(texture, 2),
            5 => maps.specular = channel(texture, 3),
            _ => maps.specular_colour = Some(texture),
        };
        match number {
            0 => expected.coat *= red,
            1 => expected.coat_roughness *= green,
            2 => expected.sheen *= colour,
            3 => expected.sheen_roughness *= alpha,
            4 => expected.transmission *= blue,
            5 => {
                expected.specular *= alpha;
                expected = expected.with_f90(expected.f90() * alpha);
            }
            _ => expected.specular *= colour,
        }
        changed(TextureId(0), &mut maps);
        let floor = floor(&[TEXEL], |_| Principled { maps, ..material() });
        let found = met(&floor, arriving(9.0, true));
        let numbers = |layers: &raystream_shaders::scene::bsdf::layers::Layers| {
            let cover = [layers.coat, layers.coat_roughness, layers.sheen_roughness];
            let colours = [layers.sheen.to_array(), layers.specular.to_array(), cover].concat();
            [colours, vec![layers.transmission, layers.f90()]].concat()
        };
        let pairs = numbers(&found.layers).into_iter().zip(numbers(&expected));
        for (found, expected) in pairs {
            assert!((found - expected).abs() < ROUNDING, "{number}: {found}, not {expected}");
        }
    }
}

#[test]
fn a_texture_turns_a_grain_and_makes_it_weaker() {
    let turned = Vec2::new(0.6, 0.8);
    let code = |share: f32| ((share * 0.5 + 0.5) * 255.0).round() as u8;
    let texel = [code(turned.x), code(turned.y), 102, 0];
    for rotation in [0.0_f32, 90.0] {
        let floor = floor(&[texel], |textures| Principled {
            anisotropy: Anisotropy { strength: 0.5, rotation },
            maps: Maps { anisotropy: Some(textures[0]), ..Maps::default() },
            ..material()
        });
        let bsdf = met(&floor, arriving(20.0, true));
        let expected = if rotation == 0.0 { turned } else { turned.perp() };
        assert!((bsdf.grain - expected.extend(0.0)).length() < 0.01, "{rotation}: {}", bsdf.grain);
        assert!((bsdf.layers.strength() - 0.2).abs() < ROUNDING, "{}", bsdf.layers.strength());
    }
}

/// A texel of normals that lean towards (x, y).
fn leaning(x: f32, y: f32) -> [u8; 4] {
    let code = |share: f32| ((share * 0.5 + 0.5) * 255.0).round() as u8;
    [code(x), code(y), 255, 255]
}

#[test]
fn a_coat_is_bent_by_a_map_of_its_own_alone() {
    let texels = [leaning(0.5, 0.0), leaning(0.0, -0.5)];
    let normal =
        |texture: Option<TextureId>| texture.map(|texture| NormalMap { texture, scale: 1.0 });
    for (below, above) in [(false, false), (true, false), (false, true), (true, true)] {
        let floor = floor(&texels, |textures| Principled {
            maps: Maps {
                normal: normal(below.then_some(textures[0])),
                coat_normal: normal(above.then_some(textures[1])),
                ..Maps::default()
            },
            ..material()
        });
        for is_above in [true, false] {
            let side = if is_above { 1.0 } else { -1.0 };
            let bsdf = met(&floor, arriving(5.0, is_above));
            let lean = |leans: bool, x: f32, y: f32| {
                let towards = if leans { Vec3::new(x, y, 1.0) } else { Vec3::Z };
                towards.normalize() * side
            };
            let [base, coat] = [lean(below, 0.5, 0.0), lean(above, 0.0, -0.5)];
            assert!((bsdf.normal - base).length() < 0.01, "{below} {above}: {}", bsdf.normal);
            assert!((bsdf.coat - coat).length() < 0.01, "{below} {above}: {}", bsdf.coat);
        }
    }
}

/// Floors whose coats face elsewhere than what is below them.
fn bent() -> Vec<(&'static str, PreparedScene)> {
    let texels = [leaning(0.3, 0.1), leaning(-0.2, -0.3)];
    let normal = |texture: TextureId| Some(NormalMap { texture, scale: 1.0 });
    let coated = Principled { coat: 0.9, coat_roughness: 0.5, ..material() };
    let opaque = Principled { transmission: 0.0, sheen: Vec3::ZERO, ..coated };
    let both = |textures: &[TextureId]| Maps {
        normal: normal(textures[0]),
        coat_normal: normal(textures[1]),
        ..Maps::default()
    };
    let below = |textures: &[TextureId]| Maps { normal: normal(textures[0]), ..Maps::default() };
    vec![
        ("paint", floor(&texels, |it| Principled { maps: both(it), ..opaque })),
        ("what is below", floor(&texels, |it| Principled { maps: below(it), ..opaque })),
        ("coated velvet", floor(&texels, |it| Principled { maps: both(it), ..coated })),
    ]
}

#[test]
fn directions_off_bent_coats_follow_the_density() {
    for (name, floor) in bent() {
        assert_directions_follow_the_density(name, &floor);
    }
}

/// Light that a bent lobe sends into the surface is lost, and there is no more of it than that. The
/// least that is left is printed.
#[test]
fn white_furnaces_of_bent_coats_make_no_light() {
    let normal = |texture: TextureId| Some(NormalMap { texture, scale: 1.0 });
    for lean in [0.02, 0.1, 0.4] {
        let mut least = [[1.0_f64; ANGLES.len()]; 2];
        let texels = [leaning(lean, 0.0), leaning(0.0, -lean)];
        for (roughness, bends) in [0.0, 0.2, 0.5, 1.0].into_iter().zip([[true, false]; 4]) {
            for own in bends {
                let floor = floor(&texels, |textures| Principled {
                    maps: Maps {
                        normal: normal(textures[0]),
                        coat_normal: normal(textures[1]).filter(|_| own),
                        ..Maps::default()
                    },
                    coat: 1.0,
                    coat_roughness: roughness,
                    ..Principled::paint(Vec3::ONE, 0.3)
                });
                for (degrees, is_above) in ANGLES.into_iter().flat_map(|a| [(a, true), (a, false)])
                {
                    let (mean, error) = energy(&floor, arriving(degrees, is_above));
                    let what = format!("{lean} {roughness} {own} {degrees} {is_above}: {mean}");
                    assert!(mean < 1.0 + 3.0 * error + 0.002, "{what} +- {error}");
                    let place = ANGLES.iter().position(|&angle| angle == degrees).unwrap();
                    let of_kind = &mut least[usize::from(own)][place];
                    *of_kind = of_kind.min(mean);
                }
            }
        }
        println!("lean {lean}, at {ANGLES:?}: without and with a coat's own normal {least:?}");
    }
}

/// What a smooth surface mirrors stays above its triangle, whatever its map says: less than a
/// hundredth is lost. Its microfacets' slopes have the width 0.001, and those that lean by more
/// than 0.005 would send light below the least height of a mirror image: 1 in 103, by the integral
/// over their distribution.
#[test]
fn white_furnaces_of_smooth_bent_coats_keep_the_light() {
    let normal = |texture: TextureId| Some(NormalMap { texture, scale: 1.0 });
    let coated = Principled { coat: 1.0, coat_roughness: 0.0, ..Principled::paint(Vec3::ONE, 0.3) };
    let polished = Principled::metal(Vec3::ONE, 0.0);
    for lean in [0.02, 0.1, 0.4, 0.9] {
        let texels = [leaning(lean, 0.0), leaning(0.0, -lean), leaning(-lean, 0.0)];
        for texture in 0..texels.len() {
            let above = |textures: &[TextureId]| Maps {
                coat_normal: normal(textures[texture]),
                ..Maps::default()
            };
            let below = |textures: &[TextureId]| Maps {
                normal: normal(textures[texture]),
                ..Maps::default()
            };
            let floors = [
                ("coat", floor(&texels, |it| Principled { maps: above(it), ..coated })),
                ("metal", floor(&texels, |it| Principled { maps: below(it), ..polished })),
            ];
            for (name, floor) in floors {
                for (degrees, is_above) in ANGLES.into_iter().flat_map(|a| [(a, true), (a, false)])
                {
                    let (mean, error) = energy(&floor, arriving(degrees, is_above));
                    let what = format!("{name} {lean} {texture} {degrees} {is_above}: {mean}");
                    assert!(mean > 0.99 - 3.0 * error - 0.002, "{what} +- {error}");
                    assert!(mean < 1.0 + 3.0 * error + 0.002, "{what} +- {error}");
                }
            }
        }
    }
}

/// The coat's highlight is where the coat's own normal reflects, whatever is below.
#[test]
fn a_highlight_is_where_the_coat_faces() {
    let texels = [leaning(0.4, 0.0), leaning(0.0, -0.3)];
    let normal = |texture: TextureId| Some(NormalMap { texture, scale: 1.0 });
    let black = Principled {
        coat: 1.0,
        coat_roughness: 0.2,
        specular: Vec3::ZERO,
        ..Principled::paint(Vec3::ZERO, 1.0)
    };
    for (own, towards) in [(false, Vec3::Z), (true, Vec3::new(0.0, -0.3, 1.0).normalize())] {
        let floor = floor(&texels, |textures| {
            let coat_normal = if own { normal(textures[1]) } else { None };
            let maps = Maps { normal: normal(textures[0]), coat_normal, ..Maps::default() };
            Principled { maps, ..black }
        });
        let incoming = arriving(20.0, true);
        let bsdf = met(&floor, incoming);
        let value = |direction: Vec3| {
            let said = bsdf.eval(incoming, direction);
            said.weight.x * said.pdf
        };
        let mirrored = incoming.reflect(towards);
        let beside = |x: f32, y: f32| (mirrored + Vec3::new(x, y, 0.0)).normalize();
        for (x, y) in [(0.2, 0.0), (-0.2, 0.0), (0.0, 0.2), (0.0, -0.2)] {
            let (here, there) = (value(mirrored), value(beside(x, y)));
            assert!(here > 2.0 * there, "{own} ({x}, {y}): {here} {there}");
        }
    }
}

/// Where the normals and the grain of a surface run follows from where their texture lies, and not
/// from where another one does.
#[test]
fn tangents_are_those_of_the_texture_of_normals() {
    let camera = Camera::new(Vec3::Z, Vec3::ZERO, 40.0);
    for (set, matrix, expected) in [
        (CoordinateSet::First, Mat2::IDENTITY, Vec2::X),
        (CoordinateSet::Second, Mat2::IDENTITY, Vec2::Y),
        // Its u grows where the first v falls.
        (CoordinateSet::First, Mat2::from_cols_array_2d(&[[0.0, 1.0], [-1.0, 0.0]]), -Vec2::Y),
    ] {
        let mut scene = Scene::new(camera, FilmSize { width: 4, height: 3 });
        let placement = Placement { set, matrix, offset: Vec2::splat(0.25) };
        let normals = Texture { placement, ..Texture::new(1, 1, vec![leaning(0.5, 0.0)]) };
        let texture = scene.add_texture(normals);
        let colour = scene.add_texture(Texture::new(1, 1, vec![[255; 4]]));
        let normal = Some(NormalMap { texture, scale: 1.0 });
        let maps = Maps { normal, base_colour: Some(colour), ..Maps::default() };
        let material = scene.add_material(Material::Principled(Principled { maps, ..material() }));
        let corners = [Vec2::new(-9.0, -9.0), Vec2::new(9.0, -9.0), Vec2::new(0.0, 9.0)];
        let positions = corners.map(|corner| corner.extend(0.0)).to_vec();
        let mut mesh = Mesh::new(material, positions, vec![[0, 1, 2]]);
        mesh.texture_coordinates = Some(vec![corners]);
        // A quarter turn.
        mesh.second_coordinates = Some(vec![corners.map(|it| Vec2::new(it.y, -it.x))]);
        scene.add_mesh(mesh);
        let scene = prepare(&scene);
        let found = met(&scene, arriving(5.0, true)).normal;
        let expected = (expected * 0.5).extend(1.0).normalize();
        assert!((found - expected).length() < 0.01, "{set:?} {matrix}: {found} {expected}");
    }
}
