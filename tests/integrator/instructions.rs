//! Contributions on the CPU are the same, bit for bit, by all its instructions; and which integrator
//! a device chooses.

use super::tracing::{Case, cases};
use glam::{Vec2, Vec3};
use raystream::exec::{Array, Executor};
use raystream::render::integrator::{IntegratorContext, StreamBuffers, create};
use raystream::render::{PreparedScene, Settings};
use raystream::scene::{Material, Mesh, Scene, Texture, Wrap, load};
use raystream_shaders::film::Contribution;
use raystream_tests::{cpus, large_scenes, render_on, scenes, settings, with_gpu};

fn assert_contributions_are_the_same(case: &Case) {
    let bytes = |found: &[Contribution]| bytemuck::cast_slice::<_, u8>(found).to_vec();
    let devices = cpus();
    let expected = case.megakernel(&devices[0], case.all());
    assert!(expected.iter().any(|contribution| contribution.radiance.max_element() > 0.0));
    for device in &devices[1..] {
        let found = case.megakernel(device, case.all());
        let others = found.iter().zip(&expected).filter(|(a, b)| a != b).count();
        assert_eq!(others, 0, "{}: {} of {}", case.name, device.description(), found.len());
        assert!(bytes(&found) == bytes(&expected), "{}: {}", case.name, device.description());
    }
}

#[test]
fn contributions_are_the_same_by_all_instructions() {
    for case in cases(6000) {
        assert_contributions_are_the_same(&case);
    }
}

/// Triangles with textures that go on beyond their edges in different ways.
fn papered() -> Scene {
    let mut scene = scenes::empty(Vec3::new(0.0, 1.0, 4.0), Vec3::ZERO);
    scene.background = Vec3::new(0.4, 0.7, 1.0);
    let ways = [
        [Wrap::Repeat, Wrap::Repeat],
        [Wrap::Clamp, Wrap::Repeat],
        [Wrap::Repeat, Wrap::Mirror],
        [Wrap::Mirror, Wrap::Clamp],
    ];
    for (x, wrap) in (-2..).map(|x| x as f32).zip(ways) {
        let texels = (0..15).map(|k| [255 - 16 * k, 17 * k, 90 + 9 * k, 255]).collect();
        let texture = scene.add_texture(Texture { wrap, ..Texture::new(5, 3, texels) });
        let material = scene.add_material(Material::textured(texture));
        let positions = [[x, -1.0, 0.0], [x + 1.0, -1.0, 0.5], [x + 0.5, 1.0, -0.5]];
        let positions = positions.map(Vec3::from_array).to_vec();
        let mut mesh = Mesh::new(material, positions, vec![[0, 1, 2]]);
        let uv = [[-3.7, 2.2], [5.3, -1.4], [0.1, 9.9]].map(Vec2::from_array);
        mesh.texture_coordinates = Some(vec![uv]);
        scene.add_mesh(mesh);
    }
    scene
}

#[test]
fn contributions_of_textures_are_the_same_by_all_instructions() {
    assert_contributions_are_the_same(&Case::new("textures", papered(), 3000));
}

/// Lanes of vector instructions have paths of slots that follow each other: any number of these is
/// traced, and none beside them.
#[test]
fn streams_of_any_length_are_traced_by_all_instructions() {
    let scene = || scenes::room(scenes::mirror(0.9), 1.0);
    for case in [Case::new("a few slots", scene(), 50), Case::new("", scene(), 50).scrambled()] {
        let devices = cpus();
        let expected = case.megakernel(&devices[0], case.all());
        for device in &devices[1..] {
            for (first, end) in [(0, 1), (0, 7), (3, 20), (16, 33), (0, 50)] {
                let found = case.megakernel(device, first..end);
                let expected = &expected[first as usize..end as usize];
                let message = format!("{}: {first} to {end}", device.description());
                assert!(found == expected, "{message}");
            }
        }
    }
}

#[test]
fn contributions_of_large_scenes_are_the_same_by_all_instructions() {
    let Some(folder) = large_scenes() else { return };
    for name in ["sibenik", "conference"] {
        let mut scene = load(&folder.join(name).join(name).with_extension("json")).unwrap();
        (scene.film.width, scene.film.height) = (80, 60);
        assert_contributions_are_the_same(&Case::new(name, scene, 4 * 80 * 60));
    }
}

/// Rays of light's own paths, and of those that end at all vertices of a cache.
#[test]
fn light_vertex_caches_are_the_same_by_all_instructions() {
    let scene = scenes::room(scenes::mirror(0.9), 1.0);
    let settings = Settings { integrator: "lvc".parse().unwrap(), ..settings(&scene) };
    let prepared = raystream_tests::prepare(&scene);
    let film = |device| render_on(device, &prepared, &settings, 4).radiance;
    let devices = cpus();
    let expected = film(&devices[0]);
    for device in &devices[1..] {
        assert!(film(device) == expected, "{}", device.description());
    }
}

/// By itself the CPU takes the integrator whose threads share nothing, and a GPU the one that is
/// made for lanes in step.
#[test]
fn devices_choose_their_integrators() {
    let scene = scenes::room(scenes::mirror(0.9), 1.0);
    let prepared = raystream_tests::prepare(&scene);
    let settings = Settings::for_scene(&scene);
    for cpu in cpus() {
        assert_eq!(kernel_of(&cpu, &prepared, &settings), "trace_paths");
    }
    with_gpu(|gpu| assert_eq!(kernel_of(gpu, &prepared, &settings), "regenerate_paths"));
}

/// The name of the kernel that traces a stream by the integrator of these settings.
fn kernel_of<E: Executor>(executor: &E, prepared: &PreparedScene, settings: &Settings) -> String {
    let scene = prepared.buffers(executor).unwrap();
    let parameters = prepared.parameters(settings);
    let context = IntegratorContext { executor, scene: &scene, parameters: &parameters, settings };
    let integrator = create(&context, 64).unwrap();
    let slots = Array::zeroed(executor, "slots", 64).unwrap();
    let contributions = Array::zeroed(executor, "contributions", 64).unwrap();
    let (slots, contributions) = (&slots, &contributions);
    let stream = StreamBuffers { scene: &scene, parameters: &parameters, slots, contributions };
    let launches = integrator.trace(&stream, 0..64);
    launches.last().expect("it traces").kernel().name.to_owned()
}
