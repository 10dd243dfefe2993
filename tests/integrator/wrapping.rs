//! How textures go on beyond their edges, on each device.

use super::tracing::Case;
use glam::{Vec2, Vec3};
use raystream::exec::Executor;
use raystream::exec::cpu::CpuExecutor;
use raystream::scene::{Material, Mesh, Scene, Texture, Wrap};
use raystream_tests::{scenes, with_gpu};

/// A floor that shows one point of a texture, red on its left and green on its right.
fn floor(wrap: Wrap, u: f32) -> Scene {
    let mut scene = scenes::empty(Vec3::new(0.0, 1.0, 3.0), Vec3::ZERO);
    let texels = vec![[255, 0, 0, 255], [0, 255, 0, 255]];
    let texture = Texture { wrap: [wrap, Wrap::Repeat], ..Texture::new(2, 1, texels) };
    let texture = scene.add_texture(texture);
    let material = scene.add_material(Material::textured(texture));
    let positions =
        [Vec3::new(-9.0, 0.0, 9.0), Vec3::new(9.0, 0.0, 9.0), Vec3::new(0.0, 0.0, -9.0)];
    let mut floor = Mesh::new(material, positions.to_vec(), vec![[0, 1, 2]]);
    floor.texture_coordinates = Some(vec![[Vec2::new(u, 0.5); 3]]);
    scene.add_mesh(floor);
    scene.background = Vec3::Z + Vec3::ONE;
    scene
}

fn assert_wraps<E: Executor>(executor: &E) {
    // Centres of texels before, behind and far behind the texture; whether they are red.
    let places = [-0.25, 1.25, 2.25];
    for (wrap, red) in [
        (Wrap::Repeat, [false, true, true]),
        (Wrap::Clamp, [true, false, false]),
        (Wrap::Mirror, [true, false, true]),
    ] {
        for (u, is_red) in places.into_iter().zip(red) {
            let case = Case::new("a wrapped floor", floor(wrap, u), 100);
            let made = case.megakernel(executor, case.all());
            // What has met the floor has no blue.
            let seen: Vec<Vec3> = made
                .iter()
                .map(|contribution| contribution.radiance)
                .filter(|radiance| radiance.z == 0.0 && radiance.max_element() > 0.0)
                .collect();
            assert!(seen.len() > 20, "{wrap:?} {u}: {} of {}", seen.len(), made.len());
            let shown =
                |radiance: &Vec3| if is_red { radiance.y == 0.0 } else { radiance.x == 0.0 };
            assert!(seen.iter().all(shown), "{wrap:?} {u}: {:?}", seen[0]);
        }
    }
}

#[test]
fn textures_wrap_on_the_cpu() {
    assert_wraps(&CpuExecutor);
}

#[test]
fn textures_wrap_on_the_gpu() {
    with_gpu(assert_wraps);
}
