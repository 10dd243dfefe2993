//! Colours of vertices: what they multiply, between corners and on each device.

use super::tracing::Case;
use glam::{Vec2, Vec3, Vec4};
use raystream::exec::Executor;
use raystream::exec::cpu::CpuExecutor;
use raystream::render::PreparedScene;
use raystream::scene::{Material, Mesh, Opacity, Principled, Scene};
use raystream_shaders::math::random::{hash, unit_float};
use raystream_shaders::scene::ray::Ray;
use raystream_tests::{prepare, scenes, with_gpu};

const SKY: Vec3 = Vec3::new(1.0, 1.0, 2.0);
/// Of 16 bits, and of the sums of three corners.
const ROUNDING: f32 = 3e-5;

/// A floor of one triangle with these colours at its corners, and one without any below it.
fn floor(material: Material, colours: [Vec4; 3]) -> Scene {
    let mut scene = scenes::empty(Vec3::new(0.0, 1.0, 3.0), Vec3::ZERO);
    let material = scene.add_material(material);
    let positions =
        vec![Vec3::new(-9.0, 0.0, 9.0), Vec3::new(9.0, 0.0, 9.0), Vec3::new(0.0, 0.0, -9.0)];
    // The lower one comes first, so that a wrong number of a colour is seen.
    let lower = positions.iter().map(|p| *p - Vec3::Y).collect();
    let mut below = Mesh::new(material, lower, vec![[0, 1, 2]]);
    below.normals = Some(vec![[Vec3::Y; 3]]);
    scene.add_mesh(below);
    let mut floor = Mesh::new(material, positions, vec![[0, 1, 2]]);
    floor.colours = Some(vec![colours]);
    scene.add_mesh(floor);
    scene.background = SKY;
    scene
}

fn assert_multiplies<E: Executor>(executor: &E) {
    let colour = Vec4::new(0.25, 0.5, 0.125, 0.0);
    for (material, own) in [
        (Material::diffuse(Vec3::new(0.5, 1.0, 0.75)), Vec3::new(0.5, 1.0, 0.75)),
        // What is opaque knows no alpha.
        (Material::diffuse(Vec3::ONE), Vec3::ONE),
    ] {
        let scene = floor(material, [colour; 3]);
        let case = Case::new("a coloured floor", scene, 100).with(|s| s.max_depth = 2);
        let made = case.megakernel(executor, case.all());
        let seen: Vec<Vec3> =
            made.iter().map(|made| made.radiance).filter(|radiance| *radiance != SKY).collect();
        let expected = SKY * own * colour.truncate();
        assert!(seen.len() > 20, "{} of {}", seen.len(), made.len());
        let is_off = |found: &&Vec3| (**found - expected).abs().max_element() > ROUNDING;
        assert_eq!(seen.iter().find(is_off), None, "not {expected}");
    }
}

#[test]
fn colours_multiply_the_reflectance_on_the_cpu() {
    assert_multiplies(&CpuExecutor);
}

#[test]
fn colours_multiply_the_reflectance_on_the_gpu() {
    with_gpu(assert_multiplies);
}

/// Rays down to random points of the floor from all around, and the barycentric coordinates there.
fn rays(count: u32) -> impl Iterator<Item = (Ray, [f32; 3])> {
    let number = |seed: u32| unit_float(hash(seed));
    (0..count).map(move |k| {
        let (a, b) = (number(2 * k), number(2 * k + 1));
        let [u, v] = if a + b > 1.0 { [1.0 - a, 1.0 - b] } else { [a, b] };
        let at = Vec2::new(-9.0, 9.0) + Vec2::new(18.0, 0.0) * u + Vec2::new(9.0, -18.0) * v;
        let off = Vec3::new(hash(3 * k) as f32, 8e9, hash(3 * k + 1) as f32) / 2e9;
        let ray = Ray::new(Vec3::new(at.x, 0.0, at.y) + off, -off.normalize());
        (ray, [1.0 - u - v, u, v])
    })
}

fn reflectance(scene: &PreparedScene, ray: &Ray) -> Vec3 {
    let view = scene.view();
    let encounter = view.meet(ray, raystream_shaders::scene::media::Media::NONE);
    let surface = raystream_shaders::scene::surface::Surface::at(
        &view.surfaces,
        ray,
        &encounter.hit,
        encounter.sides,
    );
    surface.bsdf.reflectance
}

#[test]
fn colours_are_mixed_between_corners() {
    let colours = [
        Vec4::new(1.0, 0.0, 0.2, 1.0),
        Vec4::new(0.0, 1.0, 0.4, 1.0),
        Vec4::new(0.0, 0.0, 0.9, 1.0),
    ];
    for material in [
        Material::diffuse(Vec3::splat(0.5)),
        Material::Principled(Principled::metal(Vec3::splat(0.5), 0.2)),
    ] {
        let scene = prepare(&floor(material, colours));
        for (ray, weights) in rays(500) {
            let mixed: Vec4 = colours.iter().zip(weights).map(|(&colour, w)| colour * w).sum();
            let found = reflectance(&scene, &ray);
            let expected = 0.5 * mixed.truncate();
            assert!((found - expected).abs().max_element() < ROUNDING, "{found} {expected}");
        }
    }
}

#[test]
fn alpha_between_corners_makes_holes() {
    // At the first corner there is a hole, at the others there is none.
    let alphas = [0.0, 1.0, 1.0].map(|alpha| Vec4::new(1.0, 1.0, 1.0, alpha));
    let paint =
        |opacity| Material::Principled(Principled { opacity, ..Principled::paint(Vec3::ONE, 0.5) });
    let is_hole = |scene: &PreparedScene, ray: &Ray| {
        let hit = scene.view().closest_hit(ray);
        !hit.is_some() || ray.origin.y + hit.t * ray.direction.y < -0.5
    };
    let masked = prepare(&floor(paint(Opacity::Mask { alpha: 1.0, cutoff: 0.5 }), alphas));
    for (ray, [first, ..]) in rays(500).filter(|(_, [first, ..])| (first - 0.5).abs() > 1e-3) {
        assert_eq!(is_hole(&masked, &ray), first > 0.5, "{first}");
    }
    // By chance: in the mean a third is open, and within five standard errors so are these.
    let blended = prepare(&floor(paint(Opacity::Blend { alpha: 1.0 }), alphas));
    let (mut open, mut chance, mut variance) = (0.0, 0.0, 0.0);
    for (ray, [first, ..]) in rays(4000) {
        open += f64::from(u8::from(is_hole(&blended, &ray)));
        chance += f64::from(first);
        variance += f64::from(first * (1.0 - first));
    }
    assert!((open - chance).abs() < 5.0 * variance.sqrt(), "{open} {chance} {variance}");
    let opaque = prepare(&floor(paint(Opacity::Opaque), alphas));
    assert!(rays(100).all(|(ray, _)| !is_hole(&opaque, &ray)));
}
