//! Random rooms to learn from: boxes and balls of all materials, lamps of all kinds, textures and
//! skies.

use fastrand::Rng;
use glam::{Vec2, Vec3};
use raystream::scene::{
    Camera, Environment, FilmSize, Material, MaterialId, Mesh, Principled, PunctualLight,
    QuadLight, Scene, Texture,
};

/// Side of textures in texels.
const TEXELS: u32 = 64;

/// The room of a number; the same number makes the same room.
pub fn room(number: u64, size: FilmSize) -> Scene {
    let mut rng = Rng::with_seed(number);
    let (width, height, depth) =
        (between(&mut rng, 3.0, 9.0), between(&mut rng, 2.2, 4.5), between(&mut rng, 4.0, 10.0));
    let extent = Vec3::new(width, height, depth);
    let eye = Vec3::new(
        width * between(&mut rng, 0.15, 0.85),
        height * between(&mut rng, 0.3, 0.8),
        depth * between(&mut rng, 0.02, 0.15),
    );
    let target = Vec3::new(
        width * between(&mut rng, 0.2, 0.8),
        height * between(&mut rng, 0.15, 0.6),
        depth * between(&mut rng, 0.5, 0.9),
    );
    let camera = Camera::new(eye, target, between(&mut rng, 30.0, 75.0));
    let mut scene = Scene::new(camera, size);
    scene.name = format!("room {number}");
    let is_open = rng.u32(0..4) == 0;
    add_walls(&mut rng, &mut scene, extent, is_open);
    for _ in 0..rng.u32(4..14) {
        add_thing(&mut rng, &mut scene, extent);
    }
    if is_open {
        add_sky(&mut rng, &mut scene);
    }
    add_lamps(&mut rng, &mut scene, extent, is_open);
    scene
}

fn between(rng: &mut Rng, low: f32, high: f32) -> f32 {
    low + (high - low) * rng.f32()
}

/// Between two numbers above 0, as likely in each octave.
fn scale(rng: &mut Rng, low: f32, high: f32) -> f32 {
    between(rng, low.ln(), high.ln()).exp()
}

fn colour(rng: &mut Rng) -> Vec3 {
    let grey = between(rng, 0.1, 0.85);
    let tint = Vec3::new(rng.f32(), rng.f32(), rng.f32());
    let saturation = if rng.bool() { 0.15 } else { 0.8 };
    (tint * saturation + Vec3::splat(grey) * (1.0 - saturation)).clamp(Vec3::ZERO, Vec3::ONE)
}

/// Tiles, stripes or stains of two colours.
fn texture(rng: &mut Rng) -> Texture {
    let code = |c: Vec3| [c.x, c.y, c.z].map(|c| (255.0 * c.sqrt()) as u8);
    let colours = [code(colour(rng)), code(colour(rng))];
    let (kind, cell) = (rng.u32(0..3), 1 << rng.u32(1..5));
    let seed = rng.u32(..);
    let texels = (0..TEXELS * TEXELS).map(|t| {
        let (x, y) = (t % TEXELS / cell, t / TEXELS / cell);
        let which = match kind {
            0 => (x + y) % 2,
            1 => x % 2,
            _ => Rng::with_seed(u64::from(seed ^ (x << 8) ^ y)).u32(0..2),
        };
        let [r, g, b] = colours[which as usize];
        [r, g, b, 255]
    });
    Texture::new(TEXELS, TEXELS, texels.collect())
}

fn material(rng: &mut Rng, scene: &mut Scene) -> MaterialId {
    let roughness = rng.f32();
    let material = match rng.u32(0..16) {
        0..6 => Material::diffuse(colour(rng)),
        6..10 => {
            let texture = texture(rng);
            Material::textured(scene.add_texture(texture))
        }
        10 => Material::mirror(Vec3::splat(0.9)),
        11 => Material::glass(between(rng, 1.3, 1.7)),
        12 => Material::Principled(Principled::glass(1.5, 0.5 * roughness)),
        13 => Material::Principled(Principled::metal(colour(rng), roughness)),
        _ => Material::Principled(Principled::paint(colour(rng), roughness)),
    };
    scene.add_material(material)
}

/// A parallelogram with a texture that repeats `repeats` times along each side; its front is the
/// side of `cross(u, v)`.
fn add_quad(scene: &mut Scene, [corner, u, v]: [Vec3; 3], repeats: f32, material: MaterialId) {
    let corners = vec![corner, corner + u, corner + u + v, corner + v];
    let uv = [Vec2::ZERO, Vec2::X, Vec2::ONE, Vec2::Y].map(|uv| uv * repeats);
    let triangles = vec![[0, 1, 2], [0, 2, 3]];
    let coordinates = triangles.iter().map(|t: &[u32; 3]| t.map(|k| uv[k as usize])).collect();
    let mut mesh = Mesh::new(material, corners, triangles);
    mesh.texture_coordinates = Some(coordinates);
    scene.add_mesh(mesh);
}

fn add_walls(rng: &mut Rng, scene: &mut Scene, extent: Vec3, is_open: bool) {
    let (x, y, z) = (Vec3::X * extent, Vec3::Y * extent, Vec3::Z * extent);
    let walls = [[Vec3::ZERO, z, x], [Vec3::ZERO, x, y], [z, y, x], [Vec3::ZERO, y, z], [x, z, y]];
    let plain = scene.add_material(Material::diffuse(Vec3::splat(between(rng, 0.4, 0.85))));
    for wall in walls {
        let material = if rng.bool() {
            plain
        } else if rng.bool() {
            let texture = texture(rng);
            let texture = scene.add_texture(texture);
            scene.add_material(Material::textured(texture))
        } else {
            scene.add_material(Material::diffuse(colour(rng)))
        };
        add_quad(scene, wall, between(rng, 1.0, 4.0), material);
    }
    if !is_open {
        add_quad(scene, [y, x, z], 1.0, plain);
    }
}

/// A box or a ball, on the floor or in the air.
fn add_thing(rng: &mut Rng, scene: &mut Scene, extent: Vec3) {
    let material = material(rng, scene);
    let size = scale(rng, 0.04, 0.3) * extent.min_element();
    let place = Vec3::new(rng.f32(), 0.0, between(rng, 0.3, 1.0)) * extent;
    let on_floor = rng.u32(0..3) > 0;
    let height = if on_floor { 0.0 } else { rng.f32() * extent.y };
    if rng.bool() {
        let shape = Vec3::new(size, size * scale(rng, 0.2, 4.0), size * scale(rng, 0.3, 3.0));
        add_box(scene, place + Vec3::Y * height, shape, rng.f32() * 3.0, material);
    } else {
        add_ball(scene, place + Vec3::Y * (height + size), size, material);
    }
}

/// A box that stands at `place`, turned about y.
fn add_box(scene: &mut Scene, place: Vec3, shape: Vec3, angle: f32, material: MaterialId) {
    let (sine, cosine) = angle.sin_cos();
    let x = Vec3::new(cosine, 0.0, sine) * shape.x;
    let y = Vec3::Y * shape.y;
    let z = Vec3::new(-sine, 0.0, cosine) * shape.z;
    let corner = place - 0.5 * (x + z);
    for (axis, u, v) in [(x, y, z), (y, z, x), (z, x, y)] {
        add_quad(scene, [corner + axis, u, v], 1.0, material);
        add_quad(scene, [corner, v, u], 1.0, material);
    }
}

/// A smooth ball of 32 by 16 quadrilaterals.
fn add_ball(scene: &mut Scene, centre: Vec3, radius: f32, material: MaterialId) {
    const ROUND: u32 = 32;
    const DOWN: u32 = 16;
    let corners: Vec<(Vec3, Vec2)> = (0..=DOWN)
        .flat_map(|row| (0..=ROUND).map(move |column| (row, column)))
        .map(|(row, column)| {
            let uv = Vec2::new(column as f32 / ROUND as f32, row as f32 / DOWN as f32);
            let (height, round) = (uv.y * std::f32::consts::PI, uv.x * std::f32::consts::TAU);
            let (y, flat) = (height.cos(), height.sin());
            (Vec3::new(flat * round.cos(), y, flat * round.sin()), uv)
        })
        .collect();
    let mut triangles = Vec::new();
    for row in 0..DOWN {
        for column in 0..ROUND {
            let a = row * (ROUND + 1) + column;
            let [b, c, d] = [a + 1, a + ROUND + 2, a + ROUND + 1];
            if row > 0 {
                triangles.push([a, b, c]);
            }
            if row + 1 < DOWN {
                triangles.push([a, c, d]);
            }
        }
    }
    let of = |triangle: &[u32; 3]| triangle.map(|k| corners[k as usize]);
    let mut mesh = Mesh::new(
        material,
        corners.iter().map(|(n, _)| centre + *n * radius).collect(),
        Vec::new(),
    );
    mesh.normals = Some(triangles.iter().map(|t| of(t).map(|(normal, _)| normal)).collect());
    mesh.texture_coordinates = Some(triangles.iter().map(|t| of(t).map(|(_, uv)| uv)).collect());
    mesh.triangles = triangles;
    scene.add_mesh(mesh);
}

/// A gradient, now and then with a sun.
fn add_sky(rng: &mut Rng, scene: &mut Scene) {
    const SIZE: [u32; 2] = [64, 32];
    let (top, horizon) = (colour(rng) * 2.0, colour(rng) * 3.0);
    let sun = rng.bool().then(|| rng.u32(2..SIZE[1] / 2) * SIZE[0] + rng.u32(0..SIZE[0]));
    let bright = scale(rng, 100.0, 3000.0);
    let texels = (0..SIZE[0] * SIZE[1]).map(|t| {
        let down = 2.0 * (t / SIZE[0]) as f32 / SIZE[1] as f32;
        let sky = if down < 1.0 { top * (1.0 - down) + horizon * down } else { Vec3::splat(0.1) };
        if Some(t) == sun { Vec3::splat(bright) } else { sky }
    });
    scene.set_environment(Environment::new(SIZE[0], SIZE[1], texels.collect()));
}

/// One to three lamps, unless the sky is enough.
fn add_lamps(rng: &mut Rng, scene: &mut Scene, extent: Vec3, is_open: bool) {
    for _ in 0..rng.u32(u32::from(!is_open)..4) {
        let side = scale(rng, 0.03, 0.4) * extent.min_element();
        let place = Vec3::new(rng.f32(), between(rng, 0.75, 0.98), rng.f32()) * (extent - side);
        // As much power whatever its size.
        let power = colour(rng) * scale(rng, 2.0, 20.0) * extent.length_squared() / 30.0;
        match rng.u32(0..8) {
            0 => scene.add_punctual_light(PunctualLight::point(place, power * 0.3)),
            1 => {
                let lamp = scene.add_material(Material::emissive(power / (12.0 * side * side)));
                add_ball(scene, place, 0.5 * side, lamp);
            }
            _ => scene.add_quad_light(QuadLight::new(
                place,
                Vec3::X * side,
                Vec3::Z * side,
                power / (3.0 * side * side),
            )),
        }
    }
}
