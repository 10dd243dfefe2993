//! Kernels that are compiled for what a scene uses make what those make that can do everything.

use super::tracing::{Case, OTHERS, cases, integrator};
use glam::{Vec2, Vec3};
use raystream::exec::Executor;
use raystream::exec::cpu::CpuExecutor;
use raystream::render::IntegratorKind;
use raystream::scene::{Material, Mesh, Scene, Texture};
use raystream_shaders::film::Contribution;
use raystream_shaders::scene::abilities::{ALL, ENVIRONMENT, TEXTURES};
use raystream_tests::{scenes, with_gpu};

/// A floor with a texture, under a sky.
fn textured() -> Scene {
    let mut scene = scenes::empty(Vec3::new(0.0, 1.0, 3.0), Vec3::ZERO);
    let texels = vec![[255, 0, 0, 255], [0, 255, 0, 255]];
    let texture = scene.add_texture(Texture::new(2, 1, texels));
    let material = scene.add_material(Material::textured(texture));
    let corners = [Vec2::new(-1.0, -1.0), Vec2::new(1.0, -1.0), Vec2::new(0.0, 1.0)];
    let positions = corners.map(|c| Vec3::new(c.x, 0.0, -c.y)).to_vec();
    let mut floor = Mesh::new(material, positions, vec![[0, 1, 2]]);
    floor.texture_coordinates = Some(vec![corners]);
    scene.add_mesh(floor);
    scene.background = Vec3::ONE;
    scene
}

fn assert_same<E: Executor>(executor: &E, kinds: &[IntegratorKind], count: u32, bits_differ: bool) {
    for (least, most) in cases(count).into_iter().zip(cases(count)) {
        if least.name.contains("sky") {
            assert_ne!(least.scene.abilities & ENVIRONMENT, 0, "{}", least.name);
            continue;
        }
        assert_eq!(least.scene.abilities & ENVIRONMENT, 0, "{}", least.name);
        let most = most.compiled_for(ALL);
        for &kind in kinds {
            let integrator = integrator(executor, kind, count, 300);
            let trace = |case: &Case| case.trace(executor, integrator.as_ref(), case.all()).0;
            let (least_made, most_made) = (trace(&least), trace(&most));
            let differs = |(a, b): &(&Contribution, &Contribution)| {
                bytemuck::bytes_of(*a) != bytemuck::bytes_of(*b)
            };
            let others = least_made.iter().zip(&most_made).filter(differs).count();
            let allowed = if bits_differ { count as usize / 100 } else { 0 };
            assert!(others <= allowed, "{}, {kind:?}: {others} of {count} differ", least.name);
        }
    }
}

#[test]
fn the_least_and_the_most_able_kernels_agree_on_the_cpu() {
    let kinds: Vec<_> = [IntegratorKind::Megakernel].into_iter().chain(OTHERS).collect();
    assert_same(&CpuExecutor, &kinds, 600, false);
}

/// All integrators call what abilities switch. A driver compiles this one's kernels soonest, and it
/// compiles them for each case.
#[test]
fn the_least_and_the_most_able_kernels_agree_on_the_gpu() {
    let kinds = [IntegratorKind::Compaction];
    // A real driver may fuse a product and a sum in one of two kernels and not in the other.
    with_gpu(|gpu| assert_same(gpu, &kinds, 300, !gpu.name().contains("llvmpipe")));
}

/// The word does switch something: a kernel that knows no textures shows none.
#[test]
fn a_kernel_without_an_ability_does_not_use_it() {
    with_gpu(|gpu| {
        let case = || Case::new("a textured floor", textured(), 600);
        let is_red_or_green = |c: &Contribution| {
            let [red, green, blue] = c.radiance.to_array();
            (red > 0.0 || green > 0.0) && blue == 0.0
        };
        let coloured = |case: Case| {
            let made = case.megakernel(gpu, case.all());
            made.iter().filter(|c| is_red_or_green(c)).count()
        };
        assert_eq!(case().scene.abilities, TEXTURES);
        assert!(coloured(case()) > 20);
        assert!(coloured(case().compiled_for(ALL)) > 20);
        assert_eq!(coloured(case().compiled_for(0)), 0);
    });
}
