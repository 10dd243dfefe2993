//! Metals by their complex index of refraction, against Fresnel's equations in complex numbers.

use super::principled::{arriving, floor, met, samples};
use glam::{DVec2, DVec3, Vec3};
use raystream::scene::{Conductor, Metal, Principled};
use raystream_shaders::math::random::SOBOL;
use raystream_shaders::scene::bsdf::boundary::dielectric_fresnel;
use raystream_shaders::scene::bsdf::conductor::fresnel;

fn product(a: DVec2, b: DVec2) -> DVec2 {
    DVec2::new(a.x * b.x - a.y * b.y, a.x * b.y + a.y * b.x)
}

/// The squared magnitude of `(a - b) / (a + b)`.
fn reflected(a: DVec2, b: DVec2) -> f64 {
    (a - b).length_squared() / (a + b).length_squared()
}

/// What a surface of the index of refraction `eta - i k` reflects of unpolarised light, by its two
/// amplitudes.
fn by_amplitudes(cosine: f64, eta: f64, k: f64) -> f64 {
    let index = DVec2::new(eta, -k);
    let squared = product(index, index);
    let inside = squared - DVec2::X * (1.0 - cosine * cosine);
    // The principal root.
    let root = DVec2::from_angle(0.5 * inside.y.atan2(inside.x)) * inside.length().sqrt();
    let perpendicular = reflected(DVec2::X * cosine, root);
    let parallel = reflected(squared * cosine, root);
    0.5 * (perpendicular + parallel)
}

#[test]
fn reflectance_is_fresnels() {
    for &metal in Metal::ALL {
        let Conductor { eta, k } = metal.conductor();
        let both = (0..3).flat_map(|channel| (0..=50).map(move |step| (channel, step)));
        for (channel, step) in both {
            let cosine = step as f32 / 50.0;
            let found = f64::from(fresnel(cosine, eta[channel], k[channel]));
            let expected = by_amplitudes(cosine.into(), eta[channel].into(), k[channel].into());
            assert!((found - expected).abs() < 1e-5, "{metal}, {cosine}: {found} {expected}");
        }
    }
    for cosine in [0.1, 0.5, 1.0] {
        let (found, expected) = (fresnel(cosine, 1.5, 0.0), dielectric_fresnel(cosine, 1.5));
        assert!((found - expected).abs() < 1e-6, "{cosine}: {found} {expected}");
    }
}

#[test]
fn smooth_metals_reflect_by_fresnels_equations() {
    for metal in [Metal::Gold, Metal::Titanium] {
        let conductor = metal.conductor();
        let floor = floor(Principled::conductor(conductor, 0.0));
        for degrees in [2.0, 45.0, 70.0, 85.0] {
            let incoming = arriving(degrees, true);
            let bsdf = met(&floor, incoming);
            let all: Vec<Vec3> = samples(bsdf, incoming, SOBOL).map(|s| s.weight).collect();
            let mean = all.iter().map(|weight| weight.as_dvec3()).sum::<DVec3>() / all.len() as f64;
            let cosine = f64::from(degrees).to_radians().cos();
            let of =
                |c: usize| by_amplitudes(cosine, conductor.eta[c].into(), conductor.k[c].into());
            let expected = DVec3::new(of(0), of(1), of(2));
            // Microfacets of a thousandth's slope tell the angle less well.
            let off = (mean - expected).abs().max_element();
            assert!(off < 2e-3, "{metal} at {degrees} degrees: {mean} instead of {expected}");
        }
    }
}

/// What microfacets send to each other comes back: rough metal is hardly darker than smooth, and
/// what absorbs nothing keeps all.
#[test]
fn rough_metals_keep_their_light() {
    let perfect = Conductor { eta: Vec3::splat(1e-3), k: Vec3::splat(100.0) };
    for roughness in [0.2, 0.5, 1.0] {
        let floor = floor(Principled::conductor(perfect, roughness));
        for degrees in [2.0, 60.0, 85.0] {
            let incoming = arriving(degrees, true);
            let all: Vec<f64> = samples(met(&floor, incoming), incoming, SOBOL)
                .map(|sample| sample.weight.y.into())
                .collect();
            let mean = all.iter().sum::<f64>() / all.len() as f64;
            assert!((mean - 1.0).abs() < 0.005, "{roughness}, {degrees} degrees: {mean}");
        }
    }
}

#[test]
fn names_stand_for_colours() {
    let colour = |metal: Metal| metal.conductor().normal_reflectance();
    let gold = colour(Metal::Gold);
    assert!(gold.x > gold.y && gold.y > 1.5 * gold.z, "gold is yellow: {gold}");
    assert!(colour(Metal::Silver).min_element() > 0.97, "silver is white");
    let all: Vec<_> = Metal::ALL.iter().map(|&metal| colour(metal)).collect();
    assert!(all.iter().all(|colour| colour.min_element() > 0.3 && colour.max_element() < 1.0));
}
