//! The choice of a light and of a point on it.

use glam::{DVec3, Vec3};
use raystream::render::PreparedScene;
use raystream::scene::Material;
use raystream_shaders::math::random::{CHOICES, INDEPENDENT, LIGHT_POINT, RandomNumbers};
use raystream_shaders::scene::light::{Light, LightPoint, area_pdf, importance};
use raystream_tests::histogram::{SAMPLERS, assert_uniform, cell, histogram, points};
use raystream_tests::scenes::{self, add_quad, add_triangle};
use raystream_tests::{prepare, statistics::assert_chi_square};

const COUNT: u32 = 1 << 18;
/// A triangle is divided into SIDE^2 equal ones.
const SIDE: usize = 12;

/// Triangles of areas from 0.005 to 12 and of several colours, among others that do not emit.
fn lamps() -> PreparedScene {
    let mut scene = scenes::empty(Vec3::ZERO, Vec3::NEG_Z);
    let wall = scene.add_material(scenes::diffuse(0.5));
    add_quad(&mut scene, Vec3::new(-1.0, -1.0, -2.0), Vec3::X, Vec3::Y, wall);
    for (radiance, corners) in [
        (Vec3::new(1.0, 2.0, 3.0), [Vec3::ZERO, Vec3::X, Vec3::Y]),
        (
            Vec3::new(50.0, 0.0, 0.0),
            [Vec3::new(0.1, 0.2, 0.3), Vec3::new(0.2, 0.2, 0.3), Vec3::new(0.1, 0.3, 0.4)],
        ),
        (
            Vec3::splat(0.25),
            [Vec3::new(-2.0, 1.0, 1.0), Vec3::new(3.0, 2.0, 1.0), Vec3::new(0.0, -2.0, 3.0)],
        ),
        (
            Vec3::new(0.0, 0.0, 7.0),
            [Vec3::new(1.0, 1.0, -1.0), Vec3::new(1.0, 3.0, -1.0), Vec3::new(1.0, 1.2, 0.5)],
        ),
        (Vec3::new(1e-3, 2e-3, 0.0), [Vec3::ZERO, Vec3::Z, Vec3::X]),
    ] {
        let material =
            scene.add_material(Material::Emissive { radiance, reflectance: Vec3::splat(0.1) });
        add_triangle(&mut scene, corners, material);
        add_triangle(&mut scene, corners.map(|corner| corner - Vec3::Z * 3.0), wall);
    }
    prepare(&scene)
}

/// All lights of a scene.
fn lights(scene: &PreparedScene) -> Vec<Light> {
    let view = scene.view().lights;
    (0..view.count).map(|index| view.light(index)).collect()
}

fn area(light: &Light) -> f64 {
    0.5 * light.edge1.as_dvec3().cross(light.edge2.as_dvec3()).length()
}

/// The choice's probabilities, from areas and radiances alone.
fn probabilities(lights: &[Light]) -> Vec<f64> {
    let power = |light: &Light| area(light) * light.radiance.as_dvec3().element_sum();
    let total: f64 = lights.iter().map(power).sum();
    lights.iter().map(|light| power(light) / total).collect()
}

/// How far `position` is along the edges of `light`.
fn barycentric(light: &Light, position: Vec3) -> [f64; 2] {
    let [edge1, edge2, offset] =
        [light.edge1, light.edge2, position - light.corner].map(Vec3::as_dvec3);
    let normal = edge1.cross(edge2);
    let over = |v: DVec3| v.dot(normal) / normal.length_squared();
    let place = [over(offset.cross(edge2)), over(edge1.cross(offset))];
    // What rounding of coordinates up to 3 makes in a triangle of side 0.1.
    let slack = 1e-5;
    let inside = place.iter().all(|&p| p >= -slack) && place[0] + place[1] <= 1.0 + slack;
    assert!(inside && over(offset).abs() < slack, "{position} is not on the light: {place:?}");
    place
}

/// The number of the small triangle that holds a point: rows of squares, each of two triangles but
/// for the last.
fn small_triangle([a, b]: [f64; 2]) -> usize {
    let row = cell(a, SIDE);
    let column = cell(b, SIDE).min(SIDE - row - 1);
    let upper = (a + b) * SIDE as f64 >= (row + column + 1) as f64 && row + column + 1 < SIDE;
    // The rows before have 2 SIDE - 1, 2 SIDE - 3 ... triangles.
    row * (2 * SIDE - row) + 2 * column + usize::from(upper)
}

#[test]
fn lights_are_chosen_by_their_power() {
    let scene = lamps();
    let lights = &lights(&scene);
    let view = scene.view().lights;
    assert_eq!(lights.len(), 5);
    let expected: Vec<f64> = probabilities(lights).iter().map(|p| p * f64::from(COUNT)).collect();
    for (kind, name) in SAMPLERS {
        let over_samples = (0..COUNT).map(|index| RandomNumbers::new(kind, 1, 5, index));
        let over_pixels = (0..COUNT).map(|pixel| RandomNumbers::new(kind, 1, pixel, 5));
        let count = |streams: &mut dyn Iterator<Item = RandomNumbers>| {
            histogram(5, streams.map(|stream| view.choose(stream.bits(CHOICES)[0]) as usize))
        };
        assert_chi_square(
            &count(&mut { over_samples }),
            &expected,
            &format!("{name}: over the samples"),
        );
        assert_chi_square(
            &count(&mut { over_pixels }),
            &expected,
            &format!("{name}: over the pixels"),
        );
    }
}

/// The test can fail.
#[test]
#[should_panic(expected = "chi-square")]
fn a_choice_regardless_of_power_is_rejected() {
    let scene = lamps();
    let lights = &lights(&scene);
    let expected: Vec<f64> = probabilities(lights).iter().map(|p| p * f64::from(COUNT)).collect();
    let chosen = points(INDEPENDENT, CHOICES, COUNT).map(|[choice, _]| cell(choice.into(), 5));
    assert_chi_square(&histogram(5, chosen), &expected, "regardless of power");
}

#[test]
fn densities_integrate_to_1_and_are_those_that_a_path_finds() {
    let scene = lamps();
    let lights = &lights(&scene);
    let integral: f64 = lights.iter().map(|light| area(light) * f64::from(light.pdf)).sum();
    assert!((integral - 1.0).abs() < 1e-6, "{integral}");
    let view = scene.view().lights;
    for ((index, light), probability) in lights.iter().enumerate().zip(probabilities(lights)) {
        let point = view.point_on(index as u32, [0.3, 0.6]);
        assert_eq!(
            point.pdf,
            area_pdf(importance(light.radiance), scene.params.total_importance),
            "light {index}"
        );
        assert!(
            (f64::from(point.pdf) * area(light) / probability - 1.0).abs() < 1e-6,
            "light {index}"
        );
    }
    let power: f64 =
        lights.iter().map(|light| area(light) * f64::from(importance(light.radiance))).sum();
    assert!((f64::from(scene.params.total_importance) / power - 1.0).abs() < 1e-6);
}

#[test]
fn points_are_uniform_over_each_light() {
    let scene = lamps();
    let lights = &lights(&scene);
    let view = scene.view().lights;
    for (index, light) in lights.iter().enumerate() {
        let normal = light.edge1.as_dvec3().cross(light.edge2.as_dvec3()).normalize();
        for (kind, name) in SAMPLERS {
            let cells = points(kind, LIGHT_POINT, COUNT).map(|u| {
                let LightPoint { position, normal: found, radiance, .. } =
                    view.point_on(index as u32, u);
                assert!((found.as_dvec3() - normal).length() < 1e-6 && radiance == light.radiance);
                small_triangle(barycentric(light, position))
            });
            assert_uniform(&histogram(SIDE * SIDE, cells), &format!("{name}: light {index}"));
        }
    }
}

/// Choice and point together, as a path draws them: the density over all lights' area is the one
/// that is returned.
#[test]
fn points_have_the_density_that_they_say() {
    let scene = lamps();
    let lights = &lights(&scene);
    let view = scene.view().lights;
    let per_light = SIDE * SIDE;
    let expected: Vec<f64> = (lights.iter())
        .flat_map(|light| {
            vec![
                f64::from(COUNT) * f64::from(light.pdf) * area(light) / per_light as f64;
                per_light
            ]
        })
        .collect();
    for (kind, name) in SAMPLERS {
        for index in [0, 3] {
            let cells = (0..COUNT).map(|pixel| {
                let stream = RandomNumbers::new(kind, 1, pixel, index);
                let light = view.choose(stream.bits(CHOICES)[0]);
                let point = view.point_on(light, stream.pair(LIGHT_POINT));
                light as usize * per_light
                    + small_triangle(barycentric(&lights[light as usize], point.position))
            });
            assert_chi_square(
                &histogram(5 * per_light, cells),
                &expected,
                &format!("{name}: sample {index}"),
            );
        }
    }
}

/// The test can fail: without the square root, points gather at one corner.
#[test]
#[should_panic(expected = "chi-square")]
fn points_gathered_at_a_corner_are_rejected() {
    let cells = points(INDEPENDENT, LIGHT_POINT, COUNT)
        .map(|[x, y]| small_triangle([f64::from(x), f64::from(y) * (1.0 - f64::from(x))]));
    assert_uniform(&histogram(SIDE * SIDE, cells), "gathered");
}
