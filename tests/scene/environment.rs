//! Directions that are drawn from an environment.

use glam::{DVec3, Vec3};
use raystream::exec::cpu::CpuExecutor;
use raystream::render::{PreparedScene, Settings, Techniques};
use raystream::scene::Environment;
use raystream_shaders::math::random::{INDEPENDENT, LIGHT_POINT, RandomNumbers};
use raystream_shaders::scene::environment::EnvironmentView;
use raystream_tests::histogram::{SAMPLERS, cell, histogram};
use raystream_tests::scenes::{self, sky};
use raystream_tests::statistics::assert_chi_square;
use raystream_tests::{prepare, render_on, settings};
use std::f64::consts::{PI, TAU};

const COUNT: u32 = 1 << 18;
/// Cells of a histogram over all directions: rows of one height, so that all are alike.
const ROWS: usize = 20;
const COLUMNS: usize = 30;

fn prepared(environment: Environment) -> PreparedScene {
    let mut scene = scenes::empty(Vec3::Z, Vec3::ZERO);
    scene.set_environment(environment);
    prepare(&scene)
}

/// The environment as a render sees it that goes by these techniques.
fn view(scene: &PreparedScene, techniques: Techniques) -> EnvironmentView<'_> {
    let of_scene = raystream::scene::Scene::new(
        scene.camera,
        raystream::scene::FilmSize { width: 4, height: 3 },
    );
    let parameters = scene.parameters(&Settings { techniques, ..settings(&of_scene) });
    EnvironmentView::new(&scene.texels, parameters.scene.environment)
}

/// The cell of a direction.
fn place(direction: Vec3) -> usize {
    let direction = direction.as_dvec3();
    let turns = direction.x.atan2(direction.z) / TAU + 0.5;
    cell(0.5 * (1.0 + direction.y), ROWS) * COLUMNS + cell(turns, COLUMNS)
}

/// The integral of a function over each of these cells.
fn integrals(of: impl Fn(Vec3) -> f64) -> Vec<f64> {
    const FINE: usize = 24;
    let mut sums = vec![0.0; ROWS * COLUMNS];
    for row in 0..ROWS * FINE {
        let y = 2.0 * (row as f64 + 0.5) / (ROWS * FINE) as f64 - 1.0;
        for column in 0..COLUMNS * FINE {
            let angle = ((column as f64 + 0.5) / (COLUMNS * FINE) as f64 - 0.5) * TAU;
            let across = (1.0 - y * y).sqrt();
            let direction = DVec3::new(across * angle.sin(), y, across * angle.cos()).as_vec3();
            let solid_angle = 2.0 * TAU / (ROWS * FINE * COLUMNS * FINE) as f64;
            sums[row / FINE * COLUMNS + column / FINE] += of(direction) * solid_angle;
        }
    }
    sums
}

#[test]
fn directions_have_the_density_that_they_say() {
    for rotation in [0.0, 77.0] {
        let scene = prepared(Environment { rotation, ..sky() });
        for techniques in [Techniques::Both, Techniques::LightSampling] {
            let view = view(&scene, techniques);
            let shares = integrals(|direction| view.pdf(direction).into());
            let whole: f64 = shares.iter().sum();
            assert!((whole - 1.0).abs() < 2e-3, "{techniques:?}: integrates to {whole}");
            let expected: Vec<f64> =
                shares.iter().map(|share| share / whole * f64::from(COUNT)).collect();
            for (kind, name) in SAMPLERS {
                let directions = (0..COUNT).map(|pixel| {
                    let numbers = RandomNumbers::new(kind, 1, pixel, 3);
                    let sample = view.sample(numbers.bits(LIGHT_POINT));
                    assert!((sample.direction.length() - 1.0).abs() < 1e-5);
                    place(sample.direction)
                });
                let counts = histogram(ROWS * COLUMNS, directions);
                assert_chi_square(&counts, &expected, &format!("{name}, {techniques:?}"));
            }
        }
    }
}

/// The test can fail: the compensated density is another one.
#[test]
#[should_panic(expected = "where 0 were expected")]
fn another_density_is_rejected() {
    let scene = prepared(sky());
    let [both, light] = [Techniques::Both, Techniques::LightSampling].map(|t| view(&scene, t));
    let shares = integrals(|direction| both.pdf(direction).into());
    let expected: Vec<f64> = shares.iter().map(|share| share * f64::from(COUNT)).collect();
    let directions = (0..COUNT).map(|pixel| {
        let numbers = RandomNumbers::new(INDEPENDENT, 1, pixel, 3);
        place(light.sample(numbers.bits(LIGHT_POINT)).direction)
    });
    assert_chi_square(&histogram(ROWS * COLUMNS, directions), &expected, "another");
}

/// What is drawn has the density that a path finds that came across it, all but at edges of cells.
#[test]
fn both_sides_know_the_same_density() {
    let scene = prepared(Environment { rotation: -31.0, ..sky() });
    for techniques in [Techniques::Both, Techniques::LightSampling] {
        let view = view(&scene, techniques);
        let others = (0..10_000).filter(|&pixel| {
            let numbers = RandomNumbers::new(INDEPENDENT, 1, pixel, 3);
            let sample = view.sample(numbers.bits(LIGHT_POINT));
            (view.pdf(sample.direction) / sample.pdf - 1.0).abs() > 1e-5
        });
        assert!(others.count() <= 10, "{techniques:?}");
    }
}

/// Light samples alone reach whatever is bright, the compensated ones leave out what is dim.
#[test]
fn no_radiance_is_out_of_reach() {
    let scene = prepared(sky());
    let [both, light] = [Techniques::Both, Techniques::LightSampling].map(|t| view(&scene, t));
    let (mut bright, mut left_out) = (0, 0);
    integrals(|direction| {
        if light.radiance(direction).max_element() > 0.0 {
            assert!(light.pdf(direction) > 0.0, "{direction}");
        }
        0.0
    });
    for row in 0..64 {
        let y = (row as f32 + 0.5) / 32.0 - 1.0;
        let direction = Vec3::new(0.0, y, (1.0 - y * y).sqrt());
        if both.radiance(direction).max_element() > 0.0 {
            bright += 1;
            left_out += usize::from(both.pdf(direction) == 0.0);
        }
    }
    assert!(bright > 16 && left_out > 2, "{bright} {left_out}");
}

/// The middle of the picture lies towards -z, its right side towards +x, its top is +y; turning
/// goes counter-clockwise as seen from above, from -z to -x.
#[test]
fn the_picture_hangs_as_it_says() {
    let (width, height) = (64, 32);
    let texel = |index: u32| {
        let (x, y) = (index % width, index / width);
        Vec3::new(x as f32, y as f32, 1.0)
    };
    let picture = Environment::new(width, height, (0..width * height).map(texel).collect());
    let at = |rotation: f32, direction: Vec3| {
        let scene = prepared(Environment { rotation, strength: 2.0, ..picture.clone() });
        view(&scene, Techniques::Both).radiance(direction) / 2.0
    };
    let close = |found: Vec3, x: f32, y: f32| {
        assert!((found - Vec3::new(x, y, 1.0)).abs().max_element() < 0.05, "{found} {x} {y}");
    };
    // Texel centres are at half-integers.
    close(at(0.0, Vec3::NEG_Z), 31.5, 15.5);
    close(at(0.0, Vec3::X), 47.5, 15.5);
    close(at(0.0, Vec3::NEG_X), 15.5, 15.5);
    close(at(90.0, Vec3::NEG_X), 31.5, 15.5);
    close(at(90.0, Vec3::NEG_Z), 47.5, 15.5);
    close(at(-270.0, Vec3::NEG_Z), 47.5, 15.5);
    let up = at(0.0, Vec3::new(0.0, 1.0, -1e-6).normalize());
    assert!(up.y < 0.05, "{up}");
    let down = at(0.0, Vec3::NEG_Y);
    assert!(down.y > 30.95, "{down}");
    let slope = at(0.0, Vec3::new(0.0, (PI / 4.0).sin() as f32, -(PI / 4.0).cos() as f32));
    close(slope, 31.5, 7.5);
}

/// A camera that sees nothing else shows the picture, upright and not mirrored.
#[test]
fn the_camera_sees_the_picture() {
    let mut scene = scenes::empty(Vec3::ZERO, Vec3::NEG_Z);
    let texel = |index: u32| {
        let (right, top) = (index % 8 >= 4, index / 8 < 2);
        Vec3::new(f32::from(u8::from(right)), f32::from(u8::from(top)), 1.0)
    };
    scene.set_environment(Environment::new(8, 4, (0..32).map(texel).collect()));
    let film = render_on(&CpuExecutor, &prepare(&scene), &settings(&scene), 16);
    let colors = film.color();
    let (width, height) = (film.width as usize, film.height as usize);
    let [first, last] = [colors[0], colors[width * height - 1]];
    assert!(first.y > first.x && last.x > last.y, "{first} {last}");
}
