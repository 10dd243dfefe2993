//! Scene files of format 2, and the schema of them that ships.

mod schema;
mod second_coordinates;
mod wrong;

use glam::{Vec2, Vec3};
use raystream::scene::{
    Channel, Instancing, Lens, LoadOptions, Maps, Material, MaterialId, Mesh, NormalMap, Placement,
    Principled, Projection, PunctualLight, Scene, TextureFilter, TextureId,
};
use raystream_tests::scene_folder::SceneFolder;
use serde_json::{Value, json};

/// A square of one material in the plane z = 0, with normals and texture coordinates.
const SQUARE: &str = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\nvn 0 0 1\n\
    usemtl left\nf 1/1/1 2/2/1 3/3/1\nusemtl right\nf 1/1/1 3/3/1 4/4/1\n";

/// A file that has everything.
fn whole() -> Value {
    json!({
        "$schema": "scene.schema.json",
        "format": 2,
        "name": "all",
        "about": "of everything one",
        "film": {"width": 8, "height": 6},
        "camera": {"origin": [0, 0, 5], "target": [0, 0, 0], "up": [0, 1, 0], "fov_y": 40,
            "aperture": 0.1, "focus": 4, "blades": 5},
        "meshes": [
            {"file": "square.obj", "material": "wall", "normals": "smooth", "dedupe": true,
                "transform": {"scale": 2, "rotate": [0, 90, 0], "translate": [0, 0, -1]}},
            {"file": "square.obj", "materials": {
                "left": {"type": "mirror", "reflectance": [1, 1, 1]}, "right": "glow"}},
            {"file": "a.obj",
                "transform": {"matrix": [[1, 0, 0, 3], [0, 1, 0, 0], [0, 0, -1, 0]]}}
        ],
        "materials": {
            "wall": {"type": "diffuse", "reflectance": [0.5, 0.6, 0.7]},
            "glow": {"type": "principled", "reflectance": {"texture": "t.png"}, "specular": [1, 1, 0], "f90": 0.25,
                "anisotropy": 0.5, "anisotropy_rotation": 30,
                "radiance": [2, 3, 4], "textures": {
                    "roughness": {"file": "t.png", "channel": "green"},
                    "metallic": {"file": "t.png", "channel": "blue"},
                    "normal": {"file": "t.png", "scale": 0.5},
                    "emission": {"file": "t.png"}}}
        },
        "quads": [{"corner": [0, 0, 3], "u": [1, 0, 0], "v": [0, 1, 0], "radiance": [1, 2, 3]}],
        "lights": [
            {"type": "point", "position": [1, 2, 3], "intensity": [4, 5, 6]},
            {"type": "spot", "position": [0, 1, 0], "direction": [0, -1, 0], "intensity": [1, 1, 1],
                "inner_angle": 10, "outer_angle": 30},
            {"type": "directional", "direction": [0, -1, -1], "irradiance": [3, 2, 1], "angle": 0.5}
        ],
        "environment": {"colour": [0.1, 0.2, 0.3], "strength": 2},
        "background": [0, 0, 1],
        "integrator": {"max_depth": 3, "rr_depth": 2}
    })
}

fn folder(scene: &Value) -> SceneFolder {
    let folder = SceneFolder::new().with("square.obj", SQUARE);
    image::RgbImage::from_pixel(2, 2, image::Rgb([255, 128, 0]))
        .save(folder.path("t.png"))
        .unwrap();
    folder.with("scene.json", scene.to_string())
}

fn load(scene: &Value) -> Scene {
    folder(scene).load().unwrap()
}

/// The material of the mesh of this number.
fn material(scene: &Scene, mesh: usize) -> Material {
    let MaterialId(index) = scene.meshes[mesh].material;
    scene.materials[index as usize]
}

#[test]
fn every_key_is_read() {
    let scene = load(&whole());
    assert_eq!(scene.warnings, [""; 0]);
    assert!(scene.check().is_ok());
    assert_eq!((scene.name.as_str(), scene.film.width, scene.limits.max_depth), ("all", 8, 3));
    let lens = Lens { radius: 0.1, focus_distance: 4.0, blades: 5 };
    let projection = Projection::Perspective { fov_y: 40.0, lens: Some(lens) };
    assert_eq!(scene.camera.projection, projection);
    assert_eq!(scene.triangle_count(), 2 + 2 + 2 + 2);

    let grey = Material::diffuse(Vec3::new(0.5, 0.6, 0.7));
    assert_eq!([material(&scene, 0), material(&scene, 1)], [grey; 2]);
    assert_eq!(material(&scene, 2), Material::mirror(Vec3::ONE));
    let Material::Principled(Principled {
        roughness, metallic, emission, specular, f90, maps, ..
    }) = material(&scene, 3)
    else {
        panic!("{:?}", material(&scene, 3));
    };
    assert_eq!((roughness, metallic), (1.0, 1.0), "what textures multiply");
    assert_eq!(f90, 0.25);
    assert_eq!((emission, specular), (Vec3::new(2.0, 3.0, 4.0), Vec3::new(1.0, 1.0, 0.0)));
    assert_eq!((maps.roughness.unwrap().channel, maps.metallic.unwrap().channel), (1, 2));
    assert_eq!(maps.normal.unwrap().scale, 0.5);
    assert!(maps.emission.is_some() && maps.base_colour.is_some());
    assert_eq!(scene.textures.len(), 1, "a picture is read once");

    assert_eq!(
        scene.punctual_lights,
        [
            PunctualLight::point(Vec3::new(1.0, 2.0, 3.0), Vec3::new(4.0, 5.0, 6.0)),
            PunctualLight::Spot {
                position: Vec3::Y,
                direction: Vec3::NEG_Y,
                intensity: Vec3::ONE,
                inner_angle: 10.0,
                outer_angle: 30.0,
            },
            PunctualLight::Directional {
                direction: Vec3::new(0.0, -1.0, -1.0),
                irradiance: Vec3::new(3.0, 2.0, 1.0),
                angle: 0.5,
            },
        ]
    );
    let environment = scene.environment.unwrap();
    assert_eq!((environment.texels[0], environment.strength), (Vec3::new(0.1, 0.2, 0.3), 2.0));
    assert_eq!(scene.background, Vec3::Z);
}

#[test]
fn meshes_are_moved() {
    let scene = load(&whole());
    // Twice as large, turned from x to -z and from z to x, and moved.
    let close = |a: Vec3, b: Vec3| assert!((a - b).length() < 1e-6, "{a} {b}");
    let [a, b, c] = scene.meshes[0].corners(0);
    close(a, Vec3::NEG_Z);
    close(b, Vec3::new(0.0, 0.0, -3.0));
    close(c, Vec3::new(0.0, 2.0, -3.0));
    close(scene.meshes[0].normals.as_ref().unwrap()[0][0], Vec3::X);
    close((b - a).cross(c - a).normalize(), Vec3::X);
    // Mirrored, so its front, which shows towards z, now shows towards -z.
    let mirrored: &Mesh = scene.meshes.last().unwrap();
    let [a, b, c] = mirrored.corners(0);
    close((b - a).cross(c - a).normalize(), Vec3::NEG_Z);
    close(a, Vec3::X * 3.0);
}

#[test]
fn meshes_have_instances() {
    let mut file = whole();
    file["meshes"][0]["instances"] = json!([{}, {"translate": [0, 1, 0], "scale": [-1, 1, 1]}]);
    let (scene, plain) = (load(&file), load(&whole()));
    // Two parts.
    assert_eq!(scene.meshes.len(), plain.meshes.len() + 2);
    assert_eq!(scene.meshes[0], plain.meshes[0]);
    let [a, b, c] = plain.meshes[0].corners(0).map(|corner| corner + Vec3::Y);
    assert!(scene.meshes[1].corners(0).map(|p| p.x.abs()).iter().all(|x| *x < 1e-6));
    for (found, expected) in scene.meshes[1].corners(0).into_iter().zip([a, c, b]) {
        assert!((found - expected).length() < 1e-6, "{found} {expected}");
    }
    file["meshes"][0]["instances"] = json!([]);
    let message = folder(&file).error();
    assert!(message.contains("meshes[0].instances") && message.contains("nowhere"), "{message}");
    file["meshes"][0]["instances"] = json!([{"translate": [1e10, 0, 0]}, {}]);
    let message = folder(&file).error();
    assert!(message.contains("meshes[0].instances") && message.contains("too far"), "{message}");
}

#[test]
fn instances_are_kept_once_where_that_is_wanted() {
    let mut file = whole();
    let square = format!("{SQUARE}{}", "f 1/1/1 2/2/1 4/4/1\n".repeat(20));
    file["meshes"] = json!([{"file": "many.obj", "normals": "smooth", "material": "glow",
        "transform": {"rotate": [0, 30, 0]},
        "instances": [{}, {"translate": [0, 1, 0], "scale": [-1, 1, 2]}, {"rotate": [9, 9, 9]}]}]);
    file["materials"] = json!({"glow": file["materials"]["glow"]});
    file["materials"]["glow"]["radiance"] = json!([0, 0, 0]);
    let folder = folder(&file).with("many.obj", square);
    let load = |instancing| {
        let options = LoadOptions { instancing, ..LoadOptions::default() };
        options.load(&folder.path("scene.json")).unwrap()
    };
    let kept = load(Instancing::Always);
    // The part of one face is repeated.
    let counts = (kept.meshes.len(), kept.shapes.len(), kept.instances.len());
    assert_eq!(counts, (3, 1, 3));
    let (flat, repeated) = (kept.without_instances(), load(Instancing::Auto));
    assert_eq!((flat.meshes.len(), repeated.instances.len()), (6, 0));
    assert_eq!(flat.meshes[..3], repeated.meshes[..3]);
    for (a, b) in flat.meshes[3..].iter().zip(&repeated.meshes[3..]) {
        assert_eq!((&a.triangles, &a.texture_coordinates), (&b.triangles, &b.texture_coordinates));
        for index in 0..a.triangles.len() {
            let near = |a: Vec3, b: Vec3| (a - b).length() < 1e-6;
            let (from, to) = (a.corners(index), b.corners(index));
            assert!(from.into_iter().zip(to).all(|(a, b)| near(a, b)), "{from:?} {to:?}");
            let [from, to] = [a, b].map(|mesh| mesh.normals.as_ref().unwrap()[index]);
            assert!(from.into_iter().zip(to).all(|(a, b)| near(a, b)), "{from:?} {to:?}");
        }
    }
}

/// Scaled unevenly, normals stay perpendicular to the surface.
#[test]
fn normals_follow_the_surface() {
    let mut scene = whole();
    let slope = "v 0 0 0\nv 1 1 0\nv 0 0 1\nvn -0.7071068 0.7071068 0\nf 1//1 3//1 2//1\n";
    scene["meshes"] = json!([{"file": "slope.obj", "normals": "smooth", "material": "wall",
        "transform": {"scale": [3, 1, 1], "rotate": [10, 20, 30]}}]);
    scene["materials"].as_object_mut().unwrap().remove("glow");
    let scene = folder(&scene).with("slope.obj", slope).load().unwrap();
    let mesh = &scene.meshes[0];
    let [a, b, c] = mesh.corners(0);
    let geometric = (b - a).cross(c - a).normalize();
    let shading = mesh.normals.as_ref().unwrap()[0][0];
    assert!((shading - geometric).length() < 1e-6, "{shading} {geometric}");
}

#[test]
fn a_scene_far_away_is_brought_near_with_its_lights() {
    let mut far = whole();
    let place = [5_000_000.0, 0.0, 0.0];
    far["meshes"] = json!([
        {"file": "square.obj", "material": "wall", "transform": {"translate": place}}]);
    far["materials"].as_object_mut().unwrap().remove("glow");
    far["lights"] =
        json!([{"type": "point", "position": [5_000_000.5, 1, 0], "intensity": [1, 1, 1]}]);
    far["camera"]["origin"] = json!([5_000_000.0, 0, 5]);
    far["camera"]["target"] = json!(place);
    far["quads"] = json!([]);
    let scene = load(&far);
    let [a, b, _] = scene.meshes[0].corners(0);
    assert_eq!(b - a, Vec3::X);
    let PunctualLight::Point { position, .. } = scene.punctual_lights[0] else { panic!() };
    assert_eq!(position - a, Vec3::new(0.5, 1.0, 0.0));
    assert!(scene.warnings[0].contains("far from the origin"), "{:?}", scene.warnings);
}

/// Lines without texture coordinates have the mean of each texture.
#[test]
fn without_texture_coordinates_the_means_are_shown() {
    let mut scene = whole();
    scene["meshes"] =
        json!([{"file": "bare.obj", "material": "glow"}, {"file": "a.obj", "material": "wall"}]);
    let bare = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
    let scene = folder(&scene).with("bare.obj", bare).load().unwrap();
    let Material::Principled(material) = material(&scene, 0) else { panic!() };
    assert_eq!(material.maps.textures().count(), 0);
    assert!((material.roughness - 128.0 / 255.0).abs() < 1e-6 && material.metallic == 0.0);
    assert!((material.emission.x - 2.0).abs() < 1e-6 && material.emission.z == 0.0);
    assert!(
        scene.warnings.iter().any(|w| w.contains("mean of their texture")),
        "{:?}",
        scene.warnings
    );
}

#[test]
fn textures_are_shown_in_whole_texels_where_that_is_asked_for() {
    let mut scene = whole();
    let glow = scene.pointer_mut("/materials/glow").unwrap();
    glow["reflectance"]["filter"] = json!("nearest");
    glow["textures"]["emission"]["filter"] = json!("nearest");
    glow["textures"]["roughness"]["filter"] = json!("linear");
    let scene = load(&scene);
    let filters: Vec<_> = scene.textures.iter().map(|texture| texture.filter).collect();
    assert_eq!(filters, [TextureFilter::Nearest, TextureFilter::Linear], "each is read once");
    let Material::Principled(Principled { maps, .. }) = material(&scene, 3) else { panic!() };
    let found = [maps.base_colour, maps.emission, maps.roughness.map(|map| map.texture)];
    assert_eq!(found, [Some(TextureId(0)), Some(TextureId(0)), Some(TextureId(1))]);
}

/// A texture multiplies a number, which is 1 if it is not given, and lies where it says.
#[test]
fn textures_of_layers_lie_each_by_itself() {
    let mut scene = whole();
    let glow = scene.pointer_mut("/materials/glow").unwrap();
    glow["coat"] = json!(0.5);
    glow.as_object_mut().unwrap().remove("anisotropy");
    let channel = |channel: &str| json!({"file": "t.png", "channel": channel});
    let moved = json!({"scale": [2, 1], "rotate": 90, "translate": [0, 3]});
    glow["textures"] = json!({
        "coat": channel("red"), "coat_roughness": channel("green"),
        "coat_normal": {"file": "t.png", "scale": 0.75},
        "sheen": {"file": "t.png", "transform": moved}, "sheen_roughness": channel("alpha"),
        "transmission": channel("blue"), "specular": channel("red"),
        "specular_colour": {"file": "t.png"}, "anisotropy": {"file": "t.png"},
    });
    let scene = load(&scene);
    let Material::Principled(found) = material(&scene, 3) else { panic!() };
    let Principled { coat, coat_roughness, sheen, sheen_roughness, transmission, .. } = found;
    assert_eq!((coat, coat_roughness, sheen), (0.5, 1.0, Vec3::ONE));
    assert_eq!((sheen_roughness, transmission, found.anisotropy.strength), (1.0, 1.0, 1.0));
    let texture = TextureId(0);
    let channel = |channel: u32| Some(Channel { texture, channel });
    let expected = Maps {
        base_colour: Some(texture),
        coat: channel(0),
        coat_roughness: channel(1),
        coat_normal: Some(NormalMap { texture, scale: 0.75 }),
        sheen: Some(TextureId(1)),
        sheen_roughness: channel(3),
        transmission: channel(2),
        specular: channel(0),
        specular_colour: Some(texture),
        anisotropy: Some(texture),
        ..Maps::default()
    };
    assert_eq!(found.maps, expected);
    let [plain, moved] = &scene.textures[..] else { panic!("{}", scene.textures.len()) };
    assert_eq!(plain.placement, Placement::default());
    let there = moved.placement.of(Vec2::new(0.25, 0.5));
    assert!((there - Vec2::new(-0.5, 3.5)).length() < 1e-6, "{there}");
    assert!(std::sync::Arc::ptr_eq(&plain.texels, &moved.texels));
}

#[test]
fn materials_that_nothing_names_are_said() {
    let mut scene = whole();
    scene["materials"]["spare"] = json!({"type": "null"});
    let warnings = load(&scene).warnings;
    assert!(
        warnings.iter().any(|w| w.contains("no mesh names") && w.contains("`spare`")),
        "{warnings:?}"
    );
}

/// A scene of one OBJ is the same in both formats.
#[test]
fn both_formats_say_the_same_of_one_obj() {
    let one = SceneFolder::new().load().unwrap();
    let two = SceneFolder::new().json(|scene| {
        scene["format"] = json!(2);
        let obj = scene.as_object_mut().unwrap().remove("obj").unwrap();
        scene["meshes"] = json!([{ "file": obj }]);
    });
    assert_eq!(one, two.load().unwrap());
    let still = SceneFolder::new().json(|scene| {
        scene["format"] = json!(2);
        scene.as_object_mut().unwrap().remove("obj");
        scene["meshes"] = json!([{"file": "a.obj", "transform": {"translate": [0, 0, 0]}}]);
    });
    assert_eq!(one, still.load().unwrap());
}
