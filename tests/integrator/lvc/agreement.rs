//! The pictures of `lvc` against those of the path tracer, and its techniques against each other.
//!
//! The samples of a round share their light paths, so the error of a picture is told by the spread
//! of its rounds.

use super::renders::{lvc, rounds};
use glam::{DVec3, Vec3};
use raystream::exec::cpu::CpuExecutor;
use raystream::film::Film;
use raystream::render::BidirectionalTechniques::{
    self, Connections, Emission, LightTracing, WithoutConnections, WithoutLightSampling,
    WithoutLightTracing,
};
use raystream::render::{
    LightCacheSettings, PixelFilter, PixelFilterShape, PreparedScene, Settings,
};
use raystream::scene::{
    Attenuation, FilmSize, Material, Opacity, Principled, Projection, PunctualLight, Scene, load,
    load_named,
};
use raystream_tests::scenes::{self, add_ball, add_box, add_quad};
use raystream_tests::statistics::assert_rounds_have_expectation;
use raystream_tests::{cameras, large_scenes, prepare, render, settings, with_gpu};

/// Rounds of a picture.
const ROUNDS: usize = 256;
/// Samples of each pixel in a round.
const SAMPLES: u32 = 2;
/// Light paths of a round: as many as there are samples, roughly.
const LIGHT_PATHS: u32 = 300;

fn path_traced(scene: &Scene, samples: u32) -> (PreparedScene, Film) {
    let prepared = prepare(scene);
    let film = render(&prepared, &Settings { seed: 1000, ..settings(scene) }, samples);
    (prepared, film)
}

/// `lvc` has the expectation of the path tracer.
fn assert_agreement(scene: &Scene, samples: u32, what: &str) {
    let (prepared, expected) = path_traced(scene, samples);
    let pictures = rounds(&CpuExecutor, &prepared, &lvc(scene, LIGHT_PATHS), ROUNDS, SAMPLES);
    assert_rounds_have_expectation(&expected, &pictures, what);
}

fn shipped(name: &str) -> Scene {
    let mut scene = load_named(name).expect("it ships");
    scene.film = FilmSize { width: 16, height: 12 };
    scene
}

#[test]
fn the_pictures_of_shipped_scenes() {
    for (name, samples) in
        [("cornell_ball", 1024), ("cornell_glass", 4096), ("opening", 16384), ("caustics", 8192)]
    {
        assert_agreement(&shipped(name), samples, name);
    }
}

#[test]
fn the_pictures_of_the_large_scenes() {
    let Some(folder) = large_scenes() else { return };
    for name in ["sibenik", "conference"] {
        let mut scene =
            load(&folder.join(name).join(name).with_extension("json")).expect("it is there");
        scene.film = FilmSize { width: 16, height: 12 };
        assert_agreement(&scene, 2048, name);
    }
}

#[test]
fn rooms_with_every_material() {
    let paint = Principled::paint(Vec3::splat(0.6), 0.2);
    let panes = Principled { thin_walled: true, ..Principled::glass(1.5, 0.4) };
    let velvet = Principled { sheen: Vec3::splat(0.9), coat: 0.7, coat_roughness: 0.3, ..paint };
    let attenuation = Some(Attenuation { colour: Vec3::new(0.9, 0.5, 0.2), distance: 0.5 });
    let coloured = Principled { attenuation, ..Principled::glass(1.5, 0.3) };
    let ghost = Principled { opacity: Opacity::Blend { alpha: 0.6 }, ..paint };
    for (name, ball) in [
        ("mirror", scenes::mirror(0.9)),
        ("glass", scenes::glass(1.5)),
        ("bubble", scenes::glass(0.7)),
        ("metal", Material::Principled(Principled::metal(Vec3::new(0.9, 0.7, 0.4), 0.3))),
        ("paint", Material::Principled(paint)),
        ("panes", Material::Principled(panes)),
        ("coated velvet", Material::Principled(velvet)),
        ("half a ball", Material::Principled(ghost)),
        ("rough glass", Material::Principled(Principled::glass(1.5, 0.4))),
        ("coloured glass", Material::Principled(coloured)),
    ] {
        assert_agreement(&scenes::room(ball, 1.0), 2048, name);
    }
}

/// Glossy surfaces next to each other, to the lamp and to the camera: whichever vertices of a path
/// they are, its techniques have one weight together.
#[test]
fn a_room_of_glossy_walls() {
    let mut scene = scenes::room(scenes::glass(1.5), 1.0);
    let paint = Principled::paint(Vec3::splat(0.7), 0.4);
    let mixture = Principled { metallic: 0.4, coat: 0.5, coat_roughness: 0.4, ..paint };
    let walls = scene.materials.iter_mut().filter(|m| matches!(m, Material::Diffuse { .. }));
    for wall in walls.step_by(2) {
        *wall = Material::Principled(mixture);
    }
    assert_agreement(&scene, 4096, "glossy walls");
}

/// Light paths from infinity, and every technique for light from there.
#[test]
fn light_of_an_environment() {
    for (name, ball) in [("diffuse", scenes::diffuse(0.6)), ("glass", scenes::glass(1.5))] {
        let scene = scenes::roofless(ball);
        let (prepared, expected) = path_traced(&scene, 4096);
        for techniques in [
            BidirectionalTechniques::All,
            Connections,
            LightTracing,
            WithoutConnections,
            WithoutLightSampling,
            WithoutLightTracing,
        ] {
            let settings = lvc(&scene, LIGHT_PATHS);
            let light_cache = LightCacheSettings { techniques, ..settings.light_cache };
            let settings = Settings { light_cache, ..settings };
            let pictures = rounds(&CpuExecutor, &prepared, &settings, ROUNDS, SAMPLES);
            let what = format!("{name} ball under a sky, {techniques:?}");
            assert_rounds_have_expectation(&expected, &pictures, &what);
        }
    }
}

/// Both techniques that find a light path's first vertex, and all that go on from there.
const FOR_LIGHT_PATHS: [BidirectionalTechniques; 5] = [
    BidirectionalTechniques::All,
    Connections,
    LightTracing,
    WithoutConnections,
    WithoutLightTracing,
];

fn assert_techniques_agree(
    scene: &Scene,
    samples: u32,
    pixel_filter: PixelFilter,
    all: &[BidirectionalTechniques],
    what: &str,
) {
    let prepared = prepare(scene);
    let traced = Settings { seed: 1000, pixel_filter, ..settings(scene) };
    let expected = render(&prepared, &traced, samples);
    for &techniques in all {
        let settings = lvc(scene, LIGHT_PATHS);
        let light_cache = LightCacheSettings { techniques, ..settings.light_cache };
        let settings = Settings { light_cache, pixel_filter, ..settings };
        let pictures = rounds(&CpuExecutor, &prepared, &settings, ROUNDS, SAMPLES);
        assert_rounds_have_expectation(&expected, &pictures, &format!("{what}, {techniques:?}"));
    }
}

/// Points, spots and directions: no eye path runs into them. (Glass would tell the two apart:
/// light tracing alone finds its caustics.)
#[test]
fn lights_without_surfaces() {
    let metal = Material::Principled(Principled::metal(Vec3::new(0.9, 0.7, 0.4), 0.3));
    for (name, ball) in [("diffuse", scenes::diffuse(0.6)), ("metal", metal)] {
        let what = format!("{name} ball, lights without surfaces");
        let (scene, filter) = (scenes::punctual(ball), PixelFilter::default());
        assert_techniques_agree(&scene, 4096, filter, &FOR_LIGHT_PATHS, &what);
    }
}

/// A lamp whose picture is bright here and black there.
#[test]
fn a_lamp_that_is_a_picture() {
    let scene = scenes::picture_lamp(scenes::glass(1.5));
    let all = [&FOR_LIGHT_PATHS[..], &[WithoutLightSampling]].concat();
    assert_techniques_agree(&scene, 8192, PixelFilter::default(), &all, "a picture");
}

/// Light tracing finds the pixel by every camera as camera rays do.
#[test]
fn every_camera() {
    for (name, scene) in cameras::seen_by_others(&scenes::room(scenes::glass(1.5), 1.0)) {
        let all = [BidirectionalTechniques::All, LightTracing];
        assert_techniques_agree(&scene, 4096, PixelFilter::default(), &all, name);
    }
}

/// A splat counts for all pixels whose filters reach it.
#[test]
fn every_pixel_filter() {
    let scene = scenes::room(scenes::glass(1.5), 1.0);
    for &shape in PixelFilterShape::ALL {
        let pixel_filter = PixelFilter { width: 2.5, shape };
        let all = [BidirectionalTechniques::All, LightTracing];
        assert_techniques_agree(&scene, 4096, pixel_filter, &all, shape.name());
    }
}

/// The left edge of a panorama is beside the right one, and its upper edge beside itself.
#[test]
fn pixel_filters_go_around_a_panorama() {
    let mut scene = scenes::room(scenes::glass(1.5), 1.0);
    scene.camera.projection = Projection::Panorama;
    let pixel_filter = PixelFilter { width: 4.0, shape: PixelFilterShape::Gaussian };
    assert_techniques_agree(&scene, 8192, pixel_filter, &[LightTracing], "a panorama");
}

/// The comparison can fail: the pictures of two filters differ.
#[test]
#[should_panic(expected = "another filter")]
fn another_pixel_filter_is_noticed() {
    let scene = scenes::room(scenes::glass(1.5), 1.0);
    let (prepared, expected) = path_traced(&scene, 4096);
    let pixel_filter = PixelFilter { width: 5.0, shape: PixelFilterShape::Tent };
    let settings = Settings { pixel_filter, ..lvc(&scene, LIGHT_PATHS) };
    let pictures = rounds(&CpuExecutor, &prepared, &settings, ROUNDS, SAMPLES);
    assert_rounds_have_expectation(&expected, &pictures, "another filter");
}

/// Shading normals far from those of the triangles: light paths need the adjoint BSDF, which shows
/// where connections do most of the work.
#[test]
fn smooth_normals() {
    for (name, scene) in [
        ("diffuse ball", scenes::smooth_room(scenes::diffuse(0.8))),
        ("mirror ball", scenes::smooth_room(scenes::mirror(0.9))),
        ("glass ball", scenes::smooth_room(scenes::glass(1.5))),
        ("walls", scenes::smooth_walls(scenes::mirror(0.9))),
        ("glowing walls", scenes::glowing_smooth_box()),
    ] {
        let (prepared, expected) = path_traced(&scene, 4096);
        for techniques in [BidirectionalTechniques::All, Connections, LightTracing] {
            let settings = lvc(&scene, LIGHT_PATHS);
            let light_cache = LightCacheSettings { techniques, ..settings.light_cache };
            let pictures = rounds(
                &CpuExecutor,
                &prepared,
                &Settings { light_cache, ..settings },
                ROUNDS,
                SAMPLES,
            );
            assert_rounds_have_expectation(
                &expected,
                &pictures,
                &format!("smooth {name}, {techniques:?}"),
            );
        }
    }
}

/// Paths from the lights ask for covers and coats with the directions changed, and look textures up
/// where they lie.
#[test]
fn a_painted_ball() {
    assert_agreement(&scenes::painted(), 8192, "a painted ball");
}

/// Light vertices inside glass: densities change by the square of the index.
#[test]
fn a_ball_in_a_block_of_glass() {
    let mut scene = scenes::room(scenes::diffuse(0.8), 1.0);
    let glass = scene.add_material(scenes::glass(1.5));
    add_box(&mut scene, Vec3::new(0.44, 0.01, 0.36), Vec3::new(0.92, 0.46, 0.84), false, glass);
    assert_agreement(&scene, 8192, "a ball in glass");
}

/// Paths from lights and from the camera are in the same bodies, and lose the same light there.
#[test]
fn a_drink() {
    let scene = scenes::drink();
    let all = [BidirectionalTechniques::All, Connections, LightTracing, WithoutLightTracing];
    assert_techniques_agree(&scene, 16384, PixelFilter::default(), &all, "a drink");
}

/// A lamp and a background, which only eye paths find.
#[test]
fn a_lamp_in_the_open() {
    let mut scene = scenes::empty(Vec3::new(0.0, 1.0, 4.0), Vec3::new(0.0, 0.3, 0.0));
    let ground = scene.add_material(scenes::diffuse(0.7));
    let lamp = scene.add_material(scenes::emissive(9.0, 0.4));
    add_quad(&mut scene, Vec3::new(-3.0, 0.0, 3.0), Vec3::X * 6.0, Vec3::NEG_Z * 6.0, ground);
    add_ball(&mut scene, Vec3::new(-0.4, 0.5, 0.0), 0.5, 2, ground);
    add_quad(&mut scene, Vec3::new(0.6, 0.2, -0.5), Vec3::Z, Vec3::new(0.3, 0.8, 0.0), lamp);
    // Sums of these do not round.
    scene.background = Vec3::new(0.125, 0.25, 0.5);
    let prepared = prepare(&scene);
    let expected = render(&prepared, &Settings { seed: 1000, ..settings(&scene) }, 2048);
    let pictures = rounds(&CpuExecutor, &prepared, &lvc(&scene, LIGHT_PATHS), ROUNDS, SAMPLES);
    assert_rounds_have_expectation(&expected, &pictures, "a lamp in the open");
}

/// A closed box whose walls emit 1 - rho and reflect rho holds radiance 1 - rho^D for paths of D
/// segments: every technique, at every length, and no path too long.
#[test]
fn a_glowing_box_holds_its_radiance() {
    let reflectance = 0.6_f32;
    let mut scene = scenes::empty(Vec3::new(0.3, 0.4, 0.1), Vec3::new(0.6, 0.5, 1.0));
    let wall = scene.add_material(scenes::emissive(1.0 - reflectance, reflectance));
    add_box(&mut scene, Vec3::ZERO, Vec3::new(1.0, 1.2, 1.5), true, wall);
    let prepared = prepare(&scene);
    for techniques in [
        BidirectionalTechniques::All,
        Emission,
        WithoutConnections,
        WithoutLightSampling,
        WithoutLightTracing,
        Connections,
        LightTracing,
    ] {
        for max_depth in [1, 2, 3, 4, 9] {
            let settings = lvc(&scene, LIGHT_PATHS);
            let light_cache = LightCacheSettings { techniques, ..settings.light_cache };
            let pictures = rounds(
                &CpuExecutor,
                &prepared,
                &Settings { max_depth, light_cache, ..settings },
                ROUNDS,
                1,
            );
            let (mean, error) = mean_and_error(&pictures);
            // The second term is for rounding: emission alone has no variance here.
            let expected = f64::from(1.0 - reflectance.powi(max_depth as i32));
            assert!(
                (mean - expected).abs() <= 5.0 * error + 1e-5 * expected,
                "{techniques:?}, {max_depth} segments: {mean} is {:.1} standard errors from \
                 {expected}",
                (mean - expected) / error
            );
        }
    }
}

fn mean_and_error(pictures: &[Vec<DVec3>]) -> (f64, f64) {
    let means: Vec<f64> =
        pictures.iter().map(|p| p.iter().map(|c| c.x).sum::<f64>() / p.len() as f64).collect();
    let count = means.len() as f64;
    let mean = means.iter().sum::<f64>() / count;
    let spread = means.iter().map(|m| (m - mean).powi(2)).sum::<f64>() / (count - 1.0);
    (mean, (spread / count).sqrt())
}

/// Each technique alone, with what it takes to find all light.
#[test]
fn techniques_agree() {
    for (name, scene) in [
        ("glass", scenes::room(scenes::glass(1.5), 1.0)),
        ("smooth", scenes::smooth_room(scenes::diffuse(0.8))),
        ("opening", shipped("opening")),
    ] {
        let (prepared, expected) = path_traced(&scene, 8192);
        for techniques in [
            Emission,
            WithoutConnections,
            WithoutLightSampling,
            WithoutLightTracing,
            Connections,
            LightTracing,
        ] {
            // No eye path runs into the lamp behind the opening often enough to tell anything, and
            // nothing else finds the spot below it. So few light paths come through that their
            // spread does not tell the error of light tracing, whose tests have more of them.
            let is_rare = matches!(techniques, Emission | WithoutLightSampling | LightTracing);
            if name == "opening" && is_rare {
                continue;
            }
            let settings = lvc(&scene, LIGHT_PATHS);
            let light_cache = LightCacheSettings { techniques, ..settings.light_cache };
            let pictures = rounds(
                &CpuExecutor,
                &prepared,
                &Settings { light_cache, ..settings },
                ROUNDS,
                2 * SAMPLES,
            );
            assert_rounds_have_expectation(
                &expected,
                &pictures,
                &format!("{name}, {techniques:?}"),
            );
        }
    }
}

/// Any number of light paths, of connections and of segments before roulette gives the same
/// picture; with roulette from the start it is part of most paths.
#[test]
fn numbers_of_paths_and_connections_and_roulette_change_no_mean() {
    let scene = scenes::room(scenes::glass(1.5), 1.0);
    let (prepared, expected) = path_traced(&scene, 4096);
    for (light_paths, connections, roulette_depth) in
        [(7, 1, 5), (100, 9, 5), (3000, 2, 1), (300, 64, 100)]
    {
        let settings = lvc(&scene, light_paths);
        let light_cache =
            LightCacheSettings { connections: Some(connections), ..settings.light_cache };
        let settings = Settings { light_cache, roulette_depth, ..settings };
        let pictures = rounds(&CpuExecutor, &prepared, &settings, ROUNDS, SAMPLES);
        let what = format!(
            "{light_paths} light paths, {connections} connections, roulette from {roulette_depth}"
        );
        assert_rounds_have_expectation(&expected, &pictures, &what);
    }
}

/// Sobol points: light paths are a sequence for each round, and independent of the eye paths.
#[test]
fn sobol_points_give_the_same_picture() {
    let scene = scenes::room(scenes::mirror(0.9), 1.0);
    let (prepared, expected) = path_traced(&scene, 4096);
    let settings = Settings { independent_sampler: false, ..lvc(&scene, 512) };
    // Rounds continue the sequences of pixels, so renders of different seeds are what is
    // independent.
    let pictures: Vec<Vec<DVec3>> = (0..100)
        .map(|seed| rounds(&CpuExecutor, &prepared, &Settings { seed, ..settings }, 1, 8).remove(0))
        .collect();
    assert_rounds_have_expectation(&expected, &pictures, "Sobol points");
}

/// A scene of any size in world units gives the same picture: densities and their squares are far
/// from overflow.
#[test]
fn scale_does_not_matter() {
    let (_, expected) = path_traced(&scenes::room(scenes::glass(1.5), 1.0), 4096);
    for scale in [1e-4, 1e6] {
        let scene = scenes::room(scenes::glass(1.5), scale);
        let pictures =
            rounds(&CpuExecutor, &prepare(&scene), &lvc(&scene, LIGHT_PATHS), ROUNDS, SAMPLES);
        assert_rounds_have_expectation(&expected, &pictures, &format!("scale {scale}"));
    }
}

/// Everything at once: a lamp that is a picture, lights without surfaces, a lens, a pixel filter.
#[test]
fn the_gpu_agrees_on_lights_cameras_and_filters() {
    with_gpu(|gpu| {
        let mut scene = scenes::picture_lamp(scenes::diffuse(0.8));
        scene.add_punctual_light(PunctualLight::point(Vec3::new(0.2, 0.7, 0.3), Vec3::splat(0.3)));
        scene.camera = cameras::others(scene.camera)[0].1;
        let pixel_filter = PixelFilter::of(PixelFilterShape::Gaussian);
        let prepared = prepare(&scene);
        let traced = Settings { seed: 1000, pixel_filter, ..settings(&scene) };
        let expected = render(&prepared, &traced, 4096);
        let settings = Settings { pixel_filter, ..lvc(&scene, LIGHT_PATHS) };
        let pictures = rounds(gpu, &prepared, &settings, 128, SAMPLES);
        assert_rounds_have_expectation(&expected, &pictures, "everything on the GPU");
    });
}

#[test]
fn the_gpu_agrees() {
    with_gpu(|gpu| {
        for (name, scene) in [
            ("glass", scenes::room(scenes::glass(1.5), 1.0)),
            ("smooth", scenes::smooth_room(scenes::diffuse(0.8))),
            ("opening", shipped("opening")),
        ] {
            let (prepared, expected) = path_traced(&scene, 4096);
            let pictures = rounds(gpu, &prepared, &lvc(&scene, LIGHT_PATHS), 128, SAMPLES);
            assert_rounds_have_expectation(&expected, &pictures, &format!("{name} on the GPU"));
        }
    });
}
