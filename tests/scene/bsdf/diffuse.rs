//! Cosine-distributed directions, and the density of the diffuse BSDF.

use glam::{DVec3, Vec3};
use raystream_shaders::math::random::{BSDF, INDEPENDENT};
use raystream_shaders::math::{sample_cosine_hemisphere, tangent_frame};
use raystream_shaders::scene::bsdf::diffuse;
use raystream_tests::histogram::{SAMPLERS, cell, histogram, points};
use raystream_tests::statistics::assert_chi_square;
use std::f64::consts::{PI, TAU};

const COUNT: u32 = 1 << 17;
/// Cells along the cosine of the angle to the normal, and around it.
const COSINES: usize = 16;
const AZIMUTHS: usize = 32;

/// What a dozen roundings of numbers up to 1 can make.
const ROUNDING: f64 = 1e-6;

fn normals() -> Vec<Vec3> {
    let tilted =
        [Vec3::new(1.0, -2.0, 0.5), Vec3::new(-0.3, 0.2, -0.9), Vec3::new(1e-4, -2e-4, -1.0)];
    Vec3::AXES
        .into_iter()
        .chain(Vec3::AXES.map(|axis| -axis))
        .chain(tilted.map(Vec3::normalize))
        .collect()
}

/// The cell of `direction` in the hemisphere about `normal`, in a frame of the test's own.
fn hemisphere_cell(normal: Vec3, direction: Vec3) -> usize {
    let (normal, direction) = (normal.as_dvec3().normalize(), direction.as_dvec3());
    let (cosine, tangent) = (normal.dot(direction), normal.any_orthonormal_vector());
    assert!((direction.length() - 1.0).abs() < ROUNDING, "{direction} has not unit length");
    assert!(cosine > -ROUNDING, "{direction} is below the surface of normal {normal}");
    let azimuth =
        direction.dot(normal.cross(tangent)).atan2(direction.dot(tangent)).rem_euclid(TAU);
    cell(cosine, COSINES) * AZIMUTHS + cell(azimuth / TAU, AZIMUTHS)
}

/// Asserts that `sample` makes cosine-distributed directions about all [`normals`].
fn assert_cosine_distributed(sample: impl Fn(Vec3, [f32; 2]) -> Vec3, kind: u32, name: &str) {
    // The integral of cos / pi over a cell: differences of squared cosines.
    let expected: Vec<f64> = (0..COSINES * AZIMUTHS)
        .map(|c| {
            let (low, high) = ((c / AZIMUTHS) as f64, (c / AZIMUTHS + 1) as f64);
            f64::from(COUNT) * (high * high - low * low) / (COSINES * COSINES * AZIMUTHS) as f64
        })
        .collect();
    for normal in normals() {
        let cells = points(kind, BSDF, COUNT).map(|u| hemisphere_cell(normal, sample(normal, u)));
        assert_chi_square(
            &histogram(COSINES * AZIMUTHS, cells),
            &expected,
            &format!("{name} about {normal}"),
        );
    }
}

#[test]
fn directions_follow_the_cosine() {
    for (kind, name) in SAMPLERS {
        assert_cosine_distributed(sample_cosine_hemisphere, kind, name);
    }
}

/// The test can fail.
#[test]
#[should_panic(expected = "chi-square")]
fn uniform_directions_are_rejected() {
    let uniform = |normal: Vec3, [z, turn]: [f32; 2]| {
        let (tangent, bitangent) = tangent_frame(normal);
        let (sin, cos) = (turn * std::f32::consts::TAU).sin_cos();
        ((tangent * cos + bitangent * sin) * (1.0 - z * z).sqrt() + normal * z).normalize()
    };
    assert_cosine_distributed(uniform, INDEPENDENT, "uniform");
}

/// Corners, edges and the middle of the square.
#[test]
fn extreme_numbers_give_directions() {
    let ends = [
        0.0,
        f32::MIN_POSITIVE,
        0.5 - f32::EPSILON,
        0.5,
        0.5 + f32::EPSILON,
        1.0 - f32::EPSILON / 2.0,
    ];
    for normal in normals() {
        for x in ends {
            for y in ends {
                hemisphere_cell(normal, sample_cosine_hemisphere(normal, [x, y]));
            }
        }
    }
}

#[test]
fn tangent_frames_are_right_handed_and_orthonormal() {
    let random = points(INDEPENDENT, BSDF, 10_000).zip(points(INDEPENDENT, 2, 10_000)).map(
        |([x, y], [z, scale])| {
            // Every second one is close to the pole.
            let height = if scale < 0.5 { scale - 0.25 } else { (scale - 0.75) * 1e3 };
            (Vec3::new(x, y, z) - 0.5).with_z(height).normalize()
        },
    );
    for n in normals()
        .into_iter()
        .chain([Vec3::new(0.0, -0.0, -1.0), Vec3::new(1.0, 0.0, -0.0)])
        .chain(random)
    {
        let (x, y) = tangent_frame(n);
        let [x, y, z] = [x, y, n].map(Vec3::as_dvec3);
        let errors = [x.dot(y), x.dot(z), y.dot(z), x.length() - 1.0, y.length() - 1.0];
        assert!(errors.iter().all(|e| e.abs() < ROUNDING), "{n}: {errors:?}");
        assert!((x.cross(y) - z).length() < ROUNDING, "{n}");
    }
}

#[test]
fn the_diffuse_bsdf_has_the_density_that_it_says() {
    let reflectance = Vec3::new(0.2, 0.5, 1.0);
    for normal in normals() {
        let frame = normal.as_dvec3().normalize();
        let tangent = frame.any_orthonormal_vector();
        // The density is linear in the cosine, so the rule of midpoints is exact.
        let solid_angle = TAU / (COSINES * AZIMUTHS) as f64;
        let probabilities: Vec<f64> = (0..COSINES * AZIMUTHS)
            .map(|c| {
                let cosine = ((c / AZIMUTHS) as f64 + 0.5) / COSINES as f64;
                let (sin, cos) = (((c % AZIMUTHS) as f64 + 0.5) / AZIMUTHS as f64 * TAU).sin_cos();
                let across: DVec3 = tangent * cos + frame.cross(tangent) * sin;
                let direction = across * (1.0 - cosine * cosine).sqrt() + frame * cosine;
                f64::from(diffuse::pdf(normal, direction.as_vec3())) * solid_angle
            })
            .collect();
        assert!((probabilities.iter().sum::<f64>() - 1.0).abs() < ROUNDING, "about {normal}");
        assert_eq!(diffuse::pdf(normal, -normal), 0.0);

        let expected: Vec<f64> = probabilities.iter().map(|p| p * f64::from(COUNT)).collect();
        for (kind, name) in SAMPLERS {
            let cells = points(kind, BSDF, COUNT).map(|u| {
                let sample = diffuse::sample(reflectance, normal, u);
                assert_eq!(sample.pdf, diffuse::pdf(normal, sample.direction));
                let brdf_cosine = reflectance / PI as f32 * normal.dot(sample.direction);
                assert!(
                    (sample.weight * sample.pdf - brdf_cosine).abs().max_element()
                        < ROUNDING as f32
                );
                hemisphere_cell(normal, sample.direction)
            });
            assert_chi_square(
                &histogram(COSINES * AZIMUTHS, cells),
                &expected,
                &format!("{name} about {normal}"),
            );
        }
    }
}
