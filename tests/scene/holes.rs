//! Surfaces with holes: where rays go on, and that all surfaces behind are found in order.

use super::traversal::hits;
use glam::{Vec2, Vec3};
use raystream::exec::Executor;
use raystream::exec::cpu::CpuExecutor;
use raystream::render::PreparedScene;
use raystream::scene::{Material, Mesh, Opacity, Principled, Scene, Texture};
use raystream_shaders::math::random::{hash, unit_float};
use raystream_shaders::scene::bvh::Order;
use raystream_shaders::scene::ray::{Hit, Ray};
use raystream_tests::statistics::assert_chi_square;
use raystream_tests::{prepare, scenes, with_gpu};

fn paint(opacity: Opacity) -> Material {
    Material::Principled(Principled { opacity, ..Principled::paint(Vec3::ONE, 0.5) })
}

/// A texture of four columns, of which the second and the last are holes.
fn add_grating(scene: &mut Scene) -> Material {
    let texels = [255, 0, 255, 0].map(|alpha| [255, 255, 255, alpha]).to_vec();
    let texture = scene.add_texture(Texture::new(4, 1, texels));
    let grating = Principled::paint(Vec3::ONE, 0.5);
    let mut maps = grating.maps;
    maps.base_colour = Some(texture);
    let opacity = Opacity::Mask { alpha: 1.0, cutoff: 0.5 };
    Material::Principled(Principled { opacity, maps, ..grating })
}

/// The square from (0, 0) to (1, 1) at a height of `z`, with texture coordinates, as triangles that
/// begin at other corners for other numbers of `turns`.
fn add_square(scene: &mut Scene, z: f32, turns: usize, material: Material) {
    let material = scene.add_material(material);
    let square = [Vec2::ZERO, Vec2::X, Vec2::ONE, Vec2::Y];
    let corner = |k: usize| square[(k + turns) % 4];
    let halves = [[0, 1, 2], [0, 2, 3]];
    let positions = (0..4).map(|k| corner(k).extend(z)).collect();
    let mut mesh =
        Mesh::new(material, positions, halves.map(|half| half.map(|k| k as u32)).to_vec());
    mesh.texture_coordinates = Some(halves.map(|half| half.map(corner)).to_vec());
    scene.add_mesh(mesh);
}

fn empty() -> Scene {
    scenes::empty(Vec3::new(0.5, 0.5, 9.0), Vec3::new(0.5, 0.5, 0.0))
}

/// A ray down to the square, to this place.
fn down(x: f32, y: f32) -> Ray {
    Ray::new(Vec3::new(x, y, 5.0), Vec3::NEG_Z)
}

/// Random rays down to the square that meet all squares up to one higher.
fn rays(count: u32) -> Vec<Ray> {
    let number = |seed: u32| unit_float(hash(seed));
    (0..count)
        .map(|k| {
            let inside = |seed| 0.2 + 0.6 * number(seed);
            let at = Vec3::new(inside(4 * k), inside(4 * k + 1), 0.0);
            let off = Vec3::new(number(4 * k + 2) - 0.5, number(4 * k + 3) - 0.5, 4.0);
            Ray::new(at + off, -off.normalize())
        })
        .collect()
}

/// The hits of rays on a device, after it has been seen that any hit is found where one is.
fn traced<E: Executor>(executor: &E, scene: &PreparedScene, rays: &[Ray]) -> Vec<Hit> {
    let (found, occluded) = hits(executor, scene, rays).expect("traced");
    for (hit, any) in found.iter().zip(occluded) {
        assert_eq!(hit.is_some(), any == 1);
    }
    found
}

/// The heights that a ray finds, downwards, until it misses.
fn heights_along(scene: &PreparedScene, ray: Ray) -> Vec<f32> {
    let view = scene.view();
    let behind = Order { any: false, behind: true };
    let mut found = Vec::new();
    let mut hit = view.closest_hit(&ray);
    while hit.is_some() {
        found.push(ray.origin.z - hit.t);
        hit = view.bvh.traverse(&ray, &hit, behind);
    }
    found
}

#[test]
fn every_surface_along_a_ray_is_found_once_and_in_order() {
    let mut scene = empty();
    // Two at the same height, with other triangles, so that none is a copy.
    let heights = [0.5, -1.0, 0.5, 3.0, 0.0];
    for (index, height) in heights.into_iter().enumerate() {
        add_square(&mut scene, height, index / 2 % 2, scenes::diffuse(0.5));
    }
    let scene = prepare(&scene);
    for (x, y) in [(0.3, 0.1), (0.7, 0.9), (0.21, 0.83), (0.9, 0.2)] {
        assert_eq!(heights_along(&scene, down(x, y)), [3.0, 0.5, 0.5, 0.0, -1.0], "{x} {y}");
    }
}

#[test]
fn rays_go_through_the_holes_of_a_mask() {
    let mut scene = empty();
    let grating = add_grating(&mut scene);
    add_square(&mut scene, 1.0, 0, grating);
    // In the same plane, and hidden where the grating is not.
    add_square(&mut scene, 1.0, 1, grating);
    add_square(&mut scene, 0.0, 0, scenes::diffuse(0.5));
    let scene = prepare(&scene);
    let rays: Vec<Ray> = (0..400).map(|k| down((k as f32 + 0.5) / 400.0, 0.37)).collect();
    let check = |found: Vec<Hit>| {
        for (ray, hit) in rays.iter().zip(found) {
            // Alpha is interpolated between the columns' middles: it is half where two meet.
            let column = ray.origin.x * 4.0;
            let height = if (column as u32).is_multiple_of(2) { 1.0 } else { 0.0 };
            assert_eq!(ray.origin.z - hit.t, height, "at {}", ray.origin.x);
        }
    };
    check(traced(&CpuExecutor, &scene, &rays));
    with_gpu(|gpu| check(traced(gpu, &scene, &rays)));
}

#[test]
fn the_share_of_rays_that_pass_is_what_alpha_leaves() {
    let count = 20_000;
    for alpha in [0.0, 0.3, 0.75, 1.0] {
        let mut scene = empty();
        for layer in 0..2 {
            add_square(&mut scene, layer as f32, layer, paint(Opacity::Blend { alpha }));
        }
        let scene = prepare(&scene);
        let found = traced(&CpuExecutor, &scene, &rays(count));
        let is_at = |hit: &Hit, height: f32| hit.is_some() && (hit.t < 3.5) == (height > 0.5);
        let of = |height| found.iter().filter(|hit| is_at(hit, height)).count() as u32;
        let (upper, lower) = (of(1.0), of(0.0));
        let expected = [alpha, (1.0 - alpha) * alpha, (1.0 - alpha).powi(2)];
        if alpha == 0.0 || alpha == 1.0 {
            assert_eq!(upper, if alpha == 1.0 { count } else { 0 });
            assert_eq!(lower, 0);
        } else {
            let counts = [upper, lower, count - upper - lower];
            let expected = expected.map(|share| f64::from(share) * f64::from(count));
            assert_chi_square(&counts, &expected, &format!("opacity {alpha}"));
        }
    }
}

#[test]
fn what_is_no_hole_costs_nothing_and_changes_nothing() {
    let mut scene = empty();
    add_square(&mut scene, 1.0, 0, paint(Opacity::Opaque));
    let opaque = prepare(&scene);
    scene.materials[0] = paint(Opacity::Mask { alpha: 0.5, cutoff: 0.5 });
    let masked = prepare(&scene);
    assert_ne!(opaque.abilities, masked.abilities);
    let rays = rays(1000);
    let bits =
        |scene| traced(&CpuExecutor, scene, &rays).iter().map(|hit| hit.t.to_bits()).collect();
    let (one, other): (Vec<u32>, Vec<u32>) = (bits(&opaque), bits(&masked));
    assert_eq!(one, other);
}
