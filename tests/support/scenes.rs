//! Small scenes, made in place.

use glam::{DAffine3, DQuat, DVec3, Mat2, Vec2, Vec3};
use raystream::scene::{
    Anisotropy, Attenuation, Camera, Channel, CoordinateSet, Environment, FilmSize, Maps, Material,
    MaterialId, Mesh, NormalMap, Placement, Principled, Projection, PunctualLight, Scene, Texture,
    TextureId,
};

/// Lambert's law.
pub fn diffuse(reflectance: f32) -> Material {
    Material::diffuse(Vec3::splat(reflectance))
}

/// Lambert's law on both sides and emission from the front.
pub fn emissive(radiance: f32, reflectance: f32) -> Material {
    let [radiance, reflectance] = [radiance, reflectance].map(Vec3::splat);
    Material::Emissive { radiance, reflectance }
}

/// An ideal mirror.
pub fn mirror(reflectance: f32) -> Material {
    Material::mirror(Vec3::splat(reflectance))
}

/// Clear glass.
pub fn glass(ior: f32) -> Material {
    Material::glass(ior)
}

/// An empty scene of 16x12 pixels with a camera at `origin` that looks at `target`.
pub fn empty(origin: Vec3, target: Vec3) -> Scene {
    Scene::new(Camera::new(origin, target, 40.0), FilmSize { width: 16, height: 12 })
}

/// Adds a triangle whose front is the side from which its corners run counter-clockwise: to the
/// last mesh if that is of the same material, and flat.
pub fn add_triangle(scene: &mut Scene, corners: [Vec3; 3], material: MaterialId) {
    let fits = |mesh: &Mesh| mesh.material == material && mesh.normals.is_none();
    if !scene.meshes.last().is_some_and(fits) {
        scene.add_mesh(Mesh::new(material, Vec::new(), Vec::new()));
    }
    let mesh = scene.meshes.last_mut().expect("one was added");
    let first = mesh.positions.len() as u32;
    mesh.positions.extend(corners);
    mesh.triangles.push([first, first + 1, first + 2]);
}

/// Adds a parallelogram whose front is the side of `cross(u, v)`.
pub fn add_quad(scene: &mut Scene, corner: Vec3, u: Vec3, v: Vec3, material: MaterialId) {
    add_triangle(scene, [corner, corner + u, corner + u + v], material);
    add_triangle(scene, [corner, corner + u + v, corner + v], material);
}

/// Adds the box between two corners, its fronts outwards, or inwards if `inwards`.
pub fn add_box(scene: &mut Scene, low: Vec3, high: Vec3, inwards: bool, material: MaterialId) {
    for axis in 0..3 {
        let along = |axis: usize| Vec3::AXES[axis % 3] * (high - low)[axis % 3];
        let (u, v) = (along(axis + 1), along(axis + 2));
        let (front, back) = if inwards { ((v, u), (u, v)) } else { ((u, v), (v, u)) };
        add_quad(scene, low + along(axis), front.0, front.1, material);
        add_quad(scene, low, back.0, back.1, material);
    }
}

/// Adds a closed, convex ball of flat triangles, subdivided from an octahedron, its fronts
/// outwards.
pub fn add_ball(
    scene: &mut Scene,
    centre: Vec3,
    radius: f32,
    subdivisions: u32,
    material: MaterialId,
) {
    let mut faces: Vec<[Vec3; 3]> = (0..8)
        .map(|octant: u32| {
            let sign = |bit: u32| if octant >> bit & 1 == 0 { 1.0 } else { -1.0 };
            let [x, y, z] = [Vec3::X * sign(0), Vec3::Y * sign(1), Vec3::Z * sign(2)];
            if sign(0) * sign(1) * sign(2) > 0.0 { [x, y, z] } else { [x, z, y] }
        })
        .collect();
    for _ in 0..subdivisions {
        faces = faces
            .into_iter()
            .flat_map(|[a, b, c]| {
                let [ab, bc, ca] = [(a + b).normalize(), (b + c).normalize(), (c + a).normalize()];
                [[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]]
            })
            .collect();
    }
    for face in faces {
        add_triangle(scene, face.map(|corner| centre + corner * radius), material);
    }
}

/// Makes a mesh smooth, with normals away from `centre`.
fn smooth(mesh: &mut Mesh, centre: Vec3) {
    let normals = (0..mesh.triangles.len())
        .map(|triangle| mesh.corners(triangle).map(|corner| (corner - centre).normalize()));
    mesh.normals = Some(normals.collect());
}

/// The [`room`] with a ball of so few triangles, but smooth normals, that shading normals are far
/// from those of the triangles.
pub fn smooth_room(ball: Material) -> Scene {
    let mut scene = room(ball, 1.0);
    // The ball is what the room ends with.
    let ball = scene.meshes.pop().expect("there is a ball").material;
    let centre = Vec3::new(0.68, 0.22, 0.6);
    add_ball(&mut scene, centre, 0.2, 1, ball);
    smooth(scene.meshes.last_mut().expect("a ball was added"), centre);
    scene
}

/// The [`room`] with walls that are shaded as a ball around it would be: up to 55 degrees from what
/// they are.
pub fn smooth_walls(ball: Material) -> Scene {
    let mut scene = room(ball, 1.0);
    // They are what the room begins with.
    smooth(&mut scene.meshes[0], Vec3::splat(0.5));
    scene
}

/// A closed box whose walls emit and reflect, and are shaded as a ball around it would be.
pub fn glowing_smooth_box() -> Scene {
    let high = Vec3::new(1.0, 1.2, 1.5);
    let mut scene = empty(Vec3::new(0.3, 0.4, 0.1), Vec3::new(0.6, 0.5, 1.0));
    let wall = scene.add_material(emissive(0.3, 0.9));
    add_box(&mut scene, Vec3::ZERO, high, true, wall);
    smooth(&mut scene.meshes[0], high * 0.5);
    scene
}

/// A closed room with a lamp, a diffuse block and a ball of `ball`'s material: all of the path
/// tracer's cases at once.
pub fn room(ball: Material, scale: f32) -> Scene {
    let at = |x: f32, y: f32, z: f32| Vec3::new(x, y, z) * scale;
    let mut scene = empty(at(0.5, 0.5, 0.05), at(0.5, 0.45, 1.0));
    scene.camera.projection = Projection::Perspective { fov_y: 70.0, lens: None };
    let walls = scene.add_material(diffuse(0.6));
    let lamp = scene.add_material(emissive(12.0, 0.3));
    let block = scene.add_material(Material::diffuse(Vec3::new(0.7, 0.3, 0.2)));
    let ball = scene.add_material(ball);
    add_box(&mut scene, Vec3::ZERO, at(1.0, 1.0, 1.0), true, walls);
    add_quad(&mut scene, at(0.35, 0.98, 0.4), at(0.3, 0.0, 0.0), at(0.0, 0.0, 0.3), lamp);
    add_box(&mut scene, at(0.15, 0.0, 0.55), at(0.4, 0.35, 0.8), false, block);
    add_ball(&mut scene, at(0.68, 0.22, 0.6), 0.2 * scale, 3, ball);
    scene
}

/// A room with a block of glass, a liquid that overlaps it and has ice, a matt ball and a lamp in
/// it, and touches the floor: bodies that absorb light, smooth and rough, with priorities and
/// without.
pub fn drink() -> Scene {
    let mut scene = room(diffuse(0.7), 1.0);
    let tea = Some(Attenuation { colour: Vec3::new(0.9, 0.6, 0.3), distance: 0.3 });
    let ice = Principled { priority: Some(3), ..Principled::glass(1.31, 0.4) };
    let dyed = Some(Attenuation { colour: Vec3::new(0.3, 0.7, 0.9), distance: 0.2 });
    let smooth = |ior, attenuation, priority| Material::Dielectric {
        ior,
        transmittance: Vec3::ONE,
        reflectance: Vec3::ONE,
        attenuation,
        priority,
    };
    let liquid = scene.add_material(smooth(1.33, tea, Some(1)));
    let glass = scene.add_material(smooth(1.5, None, Some(2)));
    let ice = scene.add_material(Material::Principled(ice));
    let marble = scene.add_material(smooth(1.4, dyed, None));
    let lamp = scene.add_material(emissive(4.0, 0.3));
    let at = Vec3::new;
    // The matt ball of the room, of radius 0.2 around (0.68, 0.22, 0.6), is wholly in the liquid.
    add_box(&mut scene, at(0.44, 0.0, 0.36), at(0.93, 0.45, 0.9), false, liquid);
    add_box(&mut scene, at(0.42, 0.01, 0.3), at(0.95, 0.5, 0.38), false, glass);
    add_box(&mut scene, at(0.5, 0.41, 0.5), at(0.62, 0.52, 0.62), false, ice);
    add_ball(&mut scene, at(0.8, 0.42, 0.8), 0.06, 2, marble);
    add_quad(&mut scene, at(0.46, 0.1, 0.45), at(0.0, 0.1, 0.0), at(0.0, 0.0, 0.1), lamp);
    scene
}

/// The [`room`] whose block and whose ball of `ball`'s material are instances: turned, stretched and
/// mirrored, several of each. The balls are of few triangles, smooth by their normals, and have a
/// map of normals and a grain along tangents of their own if `ball` is principled.
pub fn instanced(ball: Material) -> Scene {
    let mut scene = room(ball, 1.0);
    let mut round = scene.meshes.pop().expect("there is a ball");
    let block = scene.meshes.pop().expect("there is a block");
    let material = round.material;
    if let Material::Principled(principled) = &mut scene.materials[material.0 as usize] {
        let texels = (0..64).map(|k| [100 + k % 8 * 8, 160 - k / 8 * 8, 230, 255]).collect();
        scene.textures.push(Texture::new(8, 8, texels));
        let bumps = TextureId(scene.textures.len() as u32 - 1);
        let normal = Some(NormalMap { texture: bumps, scale: 1.0 });
        principled.maps = Maps { normal, ..principled.maps };
        principled.anisotropy = Anisotropy { strength: 0.6, rotation: 30.0 };
    }
    let middle = Vec3::new(0.68, 0.22, 0.6);
    for position in &mut round.positions {
        *position = (*position - middle) * 5.0;
    }
    smooth(&mut round, Vec3::ZERO);
    let uv = |p: Vec3| Vec2::new(p.x + 0.3 * p.z, p.y);
    let coordinates = (0..round.triangles.len()).map(|index| round.corners(index).map(uv));
    round.texture_coordinates = Some(coordinates.collect());
    let along = |p: Vec3| (Vec3::new(0.3, 1.0, 0.2).cross(p) + 0.4 * p).normalize().extend(1.0);
    let tangents = (0..round.triangles.len()).map(|index| round.corners(index).map(along));
    round.tangents = Some(tangents.collect());
    let [round, block] = [round, block].map(|mesh| scene.add_shape(mesh));
    let at = |scale: [f64; 3], angle: f64, place: [f64; 3]| {
        DAffine3::from_scale_rotation_translation(
            DVec3::from_array(scale),
            DQuat::from_axis_angle(DVec3::new(0.6, 0.0, 0.8), angle),
            DVec3::from_array(place),
        )
    };
    scene.add_instance(round, at([0.2; 3], 0.7, [0.68, 0.22, 0.6]));
    scene.add_instance(round, at([0.1, -0.06, 0.15], 1.9, [0.3, 0.5, 0.65]));
    scene.add_instance(round, at([-0.07; 3], 0.0, [0.62, 0.55, 0.5]));
    scene.add_instance(block, DAffine3::IDENTITY);
    scene.add_instance(block, at([-0.5, 0.4, 0.6], -0.4, [0.95, 0.1, 0.4]));
    scene
}

/// The texture of this number of a [`painted`] ball.
fn paint(number: u32, scene: &mut Scene) -> TextureId {
    let code = |k: u32, channel: u32| (90 + (k * 37 + number * 11 + channel * 53) % 160) as u8;
    let texels = (0..16).map(|k| [0, 1, 2, 3].map(|channel| code(k, channel))).collect();
    let (sin, cos) = (number as f32 * 0.7).sin_cos();
    let is_first = number.is_multiple_of(2);
    let set = if is_first { CoordinateSet::First } else { CoordinateSet::Second };
    let matrix = Mat2::from_cols_array_2d(&[[cos, sin], [-1.5 * sin, 1.5 * cos]]);
    let placement = Placement { set, matrix, offset: Vec2::splat(0.1 * number as f32) };
    scene.add_texture(Texture { placement, ..Texture::new(4, 4, texels) })
}

/// Its map of normals of this number.
fn dents(number: u32, scene: &mut Scene) -> TextureId {
    let code = |k: u32| (108 + (k * 29 + number * 7) % 40) as u8;
    let texels = (0..16).map(|k| [code(k), code(k + 5), 250, 255]).collect();
    let matrix = Mat2::from_diagonal(Vec2::new(2.0, 3.0));
    let placement = Placement { matrix, ..Placement::default() };
    scene.add_texture(Texture { placement, ..Texture::new(4, 4, texels) })
}

/// The [`room`] whose ball has a texture for everything, each at a place of its own in one of two
/// sets of texture coordinates, and a coat that is bent otherwise than what is below.
pub fn painted() -> Scene {
    let ball = Principled {
        coat: 0.9,
        coat_roughness: 0.7,
        sheen: Vec3::new(0.9, 0.6, 0.3),
        sheen_roughness: 0.8,
        transmission: 0.5,
        specular: Vec3::new(1.0, 0.9, 0.8),
        anisotropy: Anisotropy { strength: 0.8, rotation: 20.0 },
        ..Principled::paint(Vec3::splat(0.9), 0.8)
    };
    let mut scene = room(Material::Principled(ball), 1.0);
    let mut share =
        |number: u32, channel: u32| Some(Channel { texture: paint(number, &mut scene), channel });
    let [roughness, metallic, coat, coat_roughness, sheen_roughness, transmission, specular] =
        [(0, 1), (1, 2), (2, 0), (3, 1), (4, 3), (5, 0), (6, 3)].map(|(n, c)| share(n, c));
    let maps = Maps {
        roughness,
        metallic,
        coat,
        coat_roughness,
        sheen_roughness,
        transmission,
        specular,
        base_colour: Some(paint(7, &mut scene)),
        sheen: Some(paint(8, &mut scene)),
        specular_colour: Some(paint(9, &mut scene)),
        anisotropy: Some(paint(10, &mut scene)),
        normal: Some(NormalMap { texture: dents(11, &mut scene), scale: 0.8 }),
        coat_normal: Some(NormalMap { texture: dents(12, &mut scene), scale: 1.2 }),
        ..Maps::default()
    };
    let middle = Vec3::new(0.68, 0.22, 0.6);
    let mesh = scene.meshes.last_mut().expect("there is a ball");
    let material = mesh.material;
    let uv = |p: Vec3| Vec2::new(p.x + 0.3 * p.z, p.y) * 6.0;
    let other = |p: Vec3| Vec2::new(p.y - 0.4 * p.x, p.z) * 5.0;
    let all = |of: &dyn Fn(Vec3) -> Vec2, mesh: &Mesh| {
        Some((0..mesh.triangles.len()).map(|index| mesh.corners(index).map(of)).collect())
    };
    mesh.texture_coordinates = all(&uv, mesh);
    mesh.second_coordinates = all(&other, mesh);
    smooth(mesh, middle);
    scene.materials[material.0 as usize] = Material::Principled(Principled { maps, ..ball });
    scene
}

/// An environment of 24x12 texels: a sun, a sky that is brighter at the horizon, and black below.
pub fn sky() -> Environment {
    let (width, height) = (24, 12);
    let texel = |index: u32| {
        let (x, y) = (index % width, index / width);
        if (x, y) == (5, 2) {
            Vec3::new(60.0, 50.0, 40.0)
        } else if y < height / 2 {
            Vec3::new(0.2, 0.3, 0.5) * (1.0 + y as f32 * 0.25)
        } else {
            Vec3::ZERO
        }
    };
    Environment::new(width, height, (0..width * height).map(texel).collect())
}

/// A room without a roof, with a lamp and a ball, under the [`sky`].
pub fn roofless(ball: Material) -> Scene {
    let mut scene = empty(Vec3::new(0.5, 0.7, 2.4), Vec3::new(0.5, 0.3, 0.0));
    let wall = scene.add_material(Material::diffuse(Vec3::new(0.7, 0.6, 0.5)));
    let lamp = scene.add_material(emissive(4.0, 0.2));
    let ball = scene.add_material(ball);
    add_quad(&mut scene, Vec3::new(-0.5, 0.0, -0.5), Vec3::Z * 2.0, Vec3::X * 2.0, wall);
    add_quad(&mut scene, Vec3::new(-0.5, 0.0, -0.5), Vec3::X * 2.0, Vec3::Y, wall);
    add_quad(&mut scene, Vec3::new(-0.3, 0.6, -0.3), Vec3::X * 0.3, Vec3::Z * 0.3, lamp);
    add_ball(&mut scene, Vec3::new(0.7, 0.3, 0.4), 0.3, 2, ball);
    scene.set_environment(sky());
    scene
}

/// A floor with a wall, a block and a ball of `ball`'s material, and a light of every kind that has
/// no surface: a point, a spot, a sharp direction and a sun.
pub fn punctual(ball: Material) -> Scene {
    let mut scene = empty(Vec3::new(0.5, 0.7, 2.4), Vec3::new(0.5, 0.3, 0.0));
    let wall = scene.add_material(Material::diffuse(Vec3::new(0.7, 0.6, 0.5)));
    let ball = scene.add_material(ball);
    add_quad(&mut scene, Vec3::new(-0.5, 0.0, -0.5), Vec3::Z * 2.0, Vec3::X * 2.0, wall);
    add_quad(&mut scene, Vec3::new(-0.5, 0.0, -0.5), Vec3::X * 2.0, Vec3::Y, wall);
    add_box(&mut scene, Vec3::new(0.0, 0.0, 0.0), Vec3::new(0.25, 0.3, 0.25), false, wall);
    add_ball(&mut scene, Vec3::new(0.7, 0.3, 0.4), 0.3, 2, ball);
    scene.add_punctual_light(PunctualLight::point(
        Vec3::new(-0.2, 0.8, 0.6),
        Vec3::new(0.2, 0.4, 0.6),
    ));
    scene.add_punctual_light(PunctualLight::Spot {
        position: Vec3::new(1.2, 1.1, 0.9),
        direction: Vec3::new(-0.5, -0.9, -0.6),
        intensity: Vec3::new(1.5, 1.2, 0.4),
        inner_angle: 10.0,
        outer_angle: 35.0,
    });
    scene.add_punctual_light(PunctualLight::directional(
        Vec3::new(-0.2, -1.0, -0.5),
        Vec3::new(0.5, 0.1, 0.2),
    ));
    scene.add_punctual_light(PunctualLight::Directional {
        direction: Vec3::new(0.6, -1.0, -0.3),
        irradiance: Vec3::new(0.3, 0.5, 0.4),
        angle: 20.0,
    });
    scene
}

/// A room whose lamp is a picture: bright and coloured texels, and black ones.
pub fn picture_lamp(ball: Material) -> Scene {
    let mut scene = room(ball, 1.0);
    let texels = (0..32_u8).map(|k| match k % 4 {
        0 => [255, 40 + 3 * k, 90, 255],
        1 => [0, 0, 0, 255],
        2 => [20, 200, 255 - 3 * k, 255],
        _ => [60, 60, 60, 255],
    });
    let texture = Texture::new(8, 4, texels.collect());
    let emission = Some(scene.add_texture(texture));
    let maps = Maps { emission, ..Maps::default() };
    let glowing = Principled {
        emission: Vec3::splat(25.0),
        maps,
        ..Principled::paint(Vec3::splat(0.3), 0.9)
    };
    // The lamp is the material of index 1, of one quad.
    scene.materials[1] = Material::Principled(glowing);
    let lamp = scene.meshes.iter_mut().find(|mesh| mesh.material == MaterialId(1));
    let lamp = lamp.expect("the room has a lamp");
    let uv = |position: Vec3| Vec2::new(1.5 * (position.x - 0.35), position.z - 0.4) / 0.3;
    let coordinates = (0..lamp.triangles.len()).map(|index| lamp.corners(index).map(uv));
    lamp.texture_coordinates = Some(coordinates.collect());
    scene
}

/// The [`roofless`] room with `lamps` more, of powers from 1 to 1000, that face any way, and a sun:
/// every fifth is a point or a spot.
pub fn many_lamps(ball: Material, lamps: u32) -> Scene {
    let mut scene = roofless(ball);
    let shade = |power: f32| Vec3::new(1.0, 0.8, 0.6) * power;
    for k in 0..lamps {
        // Points that fill the room evenly, and directions that go around.
        let part = |step: f32| (k as f32 * step).fract();
        let place = Vec3::new(part(0.8192), part(0.6711) * 0.9 + 0.05, part(0.5497));
        let place = place * Vec3::new(2.2, 1.0, 1.8) - Vec3::new(0.45, 0.0, 0.45);
        let (sin, cos) = (k as f32 * 2.4).sin_cos();
        let facing = Vec3::new(cos, part(0.38) * 2.0 - 1.2, sin).normalize();
        let power = 10.0_f32.powf(part(0.2911) * 3.0) * 1e-3;
        match k % 10 {
            4 => scene.add_punctual_light(PunctualLight::point(place, shade(power))),
            9 => scene.add_punctual_light(PunctualLight::Spot {
                position: place,
                direction: facing,
                intensity: shade(power * 3.0),
                inner_angle: 20.0,
                outer_angle: if k % 20 == 9 { 40.0 } else { 120.0 },
            }),
            _ => {
                let size = 0.01 + 0.02 * part(0.7548);
                let [u, v] = facing.any_orthonormal_pair().into();
                let radiance = shade(power / (size * size));
                let lamp =
                    scene.add_material(Material::Emissive { radiance, reflectance: Vec3::ZERO });
                add_triangle(&mut scene, [place, place + u * size, place + v * size], lamp);
            }
        }
    }
    scene.add_punctual_light(PunctualLight::Directional {
        direction: Vec3::new(0.6, -1.0, -0.3),
        irradiance: Vec3::new(0.3, 0.5, 0.4),
        angle: 5.0,
    });
    scene
}
