//! Mirrors and dielectrics, against Snell's law and Fresnel's formulas in double precision.

use glam::{DVec3, Vec3};
use raystream_shaders::math::random::{CHOICES, INDEPENDENT, RandomNumbers, unit_float};
use raystream_shaders::scene::bsdf::{BsdfSample, Material};
use raystream_tests::histogram::{SAMPLERS, histogram};
use raystream_tests::materials::{bsdf, glass, mirror};
use raystream_tests::statistics::assert_chi_square;

const COUNT: u32 = 1 << 16;

/// What a dozen roundings of numbers up to 1 can make.
const ROUNDING: f64 = 1e-6;

/// Indices of water, glass, diamond, an air bubble in water, and of what surrounds.
const INDICES: [f32; 5] = [1.33, 1.5, 2.42, 1.0 / 1.33, 1.0];

/// What a material does with a ray that comes in.
fn sample(
    material: &Material,
    normal: Vec3,
    from_outside: bool,
    incoming: Vec3,
    lobe: f32,
) -> BsdfSample {
    bsdf(material, normal, from_outside).sample(incoming, [0.5; 2], lobe)
}

/// Normals with rays that come in at `degrees` to them.
fn arrivals(degrees: f64) -> impl Iterator<Item = (Vec3, Vec3)> {
    [DVec3::Z, DVec3::NEG_Y, DVec3::new(1.0, -2.0, 0.5).normalize()].into_iter().map(
        move |normal| {
            let (sin, cos) = degrees.to_radians().sin_cos();
            let incoming = normal.any_orthonormal_vector() * sin - normal * cos;
            (normal.as_vec3(), incoming.as_vec3().normalize())
        },
    )
}

/// Fresnel's reflectance of unpolarised light that arrives at `degrees` and goes over to `eta`
/// times the index, by the angles on both sides.
pub fn reflectance(degrees: f64, eta: f64) -> f64 {
    let incident = degrees.to_radians();
    let sin_refracted = incident.sin() / eta;
    if sin_refracted >= 1.0 {
        return 1.0;
    }
    if incident < 1e-6 {
        return ((eta - 1.0) / (eta + 1.0)).powi(2);
    }
    let refracted = sin_refracted.asin();
    let (difference, sum) = (incident - refracted, incident + refracted);
    0.5 * ((difference.sin() / sum.sin()).powi(2) + (difference.tan() / sum.tan()).powi(2))
}

/// Each index from both sides: the material, whether from outside, and the ratio of the indices,
/// far side over near.
fn sides() -> impl Iterator<Item = (Material, bool, f64)> {
    INDICES.into_iter().flat_map(|ior| {
        let material = Material { transmittance: Vec3::new(0.9, 0.5, 0.1), ..glass(ior) };
        let material = Material { reflectance: Vec3::new(0.3, 1.0, 0.6), ..material };
        [(material, true, f64::from(ior)), (material, false, 1.0 / f64::from(ior))]
    })
}

/// Angles from straight to grazing, and a fifth of a degree on both sides of total reflection's
/// limit.
fn angles(eta: f64) -> Vec<f64> {
    let limit = eta.asin().to_degrees();
    let near_limit = [limit - 0.2, limit + 0.2].into_iter().filter(|a| a.is_finite() && *a < 90.0);
    (0..=17).map(|step| 5.0 * f64::from(step)).chain([88.0, 89.5]).chain(near_limit).collect()
}

fn is_reflected(sample: &BsdfSample, normal: Vec3) -> bool {
    sample.direction.dot(normal) > 0.0
}

/// Asserts that rays at `degrees` are reflected as often as Fresnel's formulas say.
fn assert_lobes(sample: impl Fn(f32) -> bool, reflected: f64, kind: u32, what: &str) {
    let lobes = (0..COUNT).map(|index| {
        let [choice, _] = RandomNumbers::new(kind, 1, 42, index).bits(CHOICES);
        usize::from(sample(unit_float(choice)))
    });
    let counts = histogram(2, lobes);
    let expected = [1.0 - reflected, reflected].map(|p| p * f64::from(COUNT));
    if expected[0].min(expected[1]) < 1e-3 {
        // Total reflection, or two media of one index.
        assert_eq!(counts[usize::from(reflected < 0.5)], 0, "{what}");
    } else {
        assert_chi_square(&counts, &expected, what);
    }
}

#[test]
fn dielectrics_reflect_by_fresnels_formulas() {
    for (material, from_outside, eta) in sides() {
        for degrees in angles(eta) {
            let (normal, incoming) = arrivals(degrees).last().expect("there are normals");
            for (kind, name) in SAMPLERS {
                let what = format!("{name}: ratio {eta}, {degrees} degrees");
                let reflects =
                    |u| is_reflected(&sample(&material, normal, from_outside, incoming, u), normal);
                assert_lobes(reflects, reflectance(degrees, eta), kind, &what);
            }
        }
    }
}

/// The test can fail: Schlick's approximation is too far off.
#[test]
#[should_panic(expected = "chi-square")]
fn schlicks_approximation_is_rejected() {
    let (degrees, eta) = (60.0_f64, 1.5);
    let straight = reflectance(0.0, eta);
    let schlick = straight + (1.0 - straight) * (1.0 - degrees.to_radians().cos()).powi(5);
    assert_lobes(|u| f64::from(u) < schlick, reflectance(degrees, eta), INDEPENDENT, "Schlick");
}

/// The direction and weight of both lobes; energy: what crosses is spread over the squared ratio's
/// share of solid angle, so radiance times that is what the colours leave.
#[test]
fn dielectrics_obey_snells_law_and_lose_only_what_their_colours_take() {
    for (material, from_outside, eta) in sides() {
        for degrees in angles(eta) {
            for (normal, incoming) in arrivals(degrees) {
                for u in [0.0, 0.01, 0.04, 0.1, 0.5, 0.9, 1.0 - f32::EPSILON / 2.0] {
                    let sample = sample(&material, normal, from_outside, incoming, u);
                    let [n, i, out] = [normal, incoming, sample.direction].map(Vec3::as_dvec3);
                    let what = format!("ratio {eta}, {degrees} degrees about {normal}, u {u}");
                    assert!((out.length() - 1.0).abs() < ROUNDING, "{what}");
                    assert_eq!(sample.pdf, 0.0, "{what}: a delta distribution");
                    let tangential = |v: DVec3| v - n * n.dot(v);
                    let (colour, squeeze, refraction) = if is_reflected(&sample, normal) {
                        assert!(
                            (out.dot(n) + i.dot(n)).abs() < ROUNDING,
                            "{what}: the angles differ"
                        );
                        (material.reflectance, 1.0, 1.0)
                    } else {
                        assert!(degrees.to_radians().sin() < eta, "{what}: reflection is total");
                        (material.transmittance, eta * eta, eta)
                    };
                    assert!(
                        (tangential(out) - tangential(i) / refraction).length() < ROUNDING,
                        "{what}: {out}"
                    );
                    let energy = sample.weight.as_dvec3() * squeeze;
                    assert!((energy - colour.as_dvec3()).length() < ROUNDING, "{what}: {energy}");
                }
            }
        }
    }
}

/// Through a slab with parallel sides a ray keeps its direction, and its radiance but for the
/// colour.
#[test]
fn a_slab_keeps_direction_and_radiance() {
    for ior in INDICES {
        for degrees in [0.0, 20.0, 45.0] {
            for (normal, incoming) in arrivals(degrees) {
                let inside = sample(&glass(ior), normal, true, incoming, 0.999);
                let outside = sample(&glass(ior), normal, false, inside.direction, 0.999);
                let weight = (inside.weight * outside.weight).as_dvec3();
                assert!(
                    (outside.direction - incoming).as_dvec3().length() < 2.0 * ROUNDING,
                    "{ior}, {degrees}"
                );
                assert!(
                    (weight - DVec3::ONE).length() < 2.0 * ROUNDING,
                    "{ior}, {degrees}: {weight}"
                );
            }
        }
    }
}

#[test]
fn mirrors_reflect() {
    let colour = Vec3::new(0.2, 0.5, 1.0);
    let mirror = Material { reflectance: colour, ..mirror(1.0) };
    for degrees in angles(1.0) {
        for (normal, incoming) in arrivals(degrees) {
            let sample = sample(&mirror, normal, true, incoming, 0.5);
            let [n, i, out] = [normal, incoming, sample.direction].map(Vec3::as_dvec3);
            assert!(
                (out - (i - n * (2.0 * i.dot(n)))).length() < ROUNDING,
                "{degrees} degrees: {out}"
            );
            assert!((out.length() - 1.0).abs() < ROUNDING, "{degrees} degrees: {out}");
            assert_eq!((sample.weight, sample.pdf), (colour, 0.0));
        }
    }
}
