//! The table of albedos of anisotropic surfaces, in the layout of
//! [`raystream_shaders::scene::bsdf::anisotropic`].

use super::albedos::{Lattice, pairs};
use glam::{DVec2, UVec4, Vec2, Vec3};
use rayon::prelude::*;
use raystream_shaders::scene::bsdf::anisotropic::{
    AZIMUTHS, Anisotropic, AnisotropicAlbedos, COSINES, ROUGHNESSES, STRENGTHS, azimuth_at,
};
use raystream_shaders::scene::bsdf::reflector::grazing;
use std::f32::consts::FRAC_PI_2;
use std::sync::OnceLock;

/// The lattice of microfacets.
const LATTICE: Lattice = Lattice { points: 987, generator: 610 };
/// Middles of intervals over which means are summed up, along the cosine's root and the azimuth.
const STEPS: [u32; 2] = [184, 36];

/// The rows of the table, which is made once: some 5 s of one core.
pub fn of_anisotropic() -> &'static [UVec4] {
    static TABLE: OnceLock<Vec<UVec4>> = OnceLock::new();
    TABLE.get_or_init(table)
}

fn table() -> Vec<UVec4> {
    let fraction = |index: u32, count: u32| index as f32 / (count - 1) as f32;
    let directions = |index: u32| {
        let place = index / AZIMUTHS;
        let azimuth = azimuth_at(fraction(index % AZIMUTHS, AZIMUTHS));
        let (rough, strong) = (place / STRENGTHS, place % STRENGTHS);
        let surface = Anisotropic::new(fraction(rough, ROUGHNESSES), fraction(strong, STRENGTHS));
        let albedos: Vec<Vec2> = (0..COSINES)
            .map(|k| albedo(&surface, towards(azimuth, fraction(k, COSINES).powi(2))))
            .collect();
        pairs(&albedos)
    };
    let all: Vec<u32> = (0..ROUGHNESSES * STRENGTHS * AZIMUTHS).collect();
    let mut rows: Vec<UVec4> = all.into_par_iter().flat_map_iter(directions).collect();
    let view = AnisotropicAlbedos { rows: &rows, first: 0 };
    let means: Vec<Vec2> = (0..STRENGTHS * ROUGHNESSES)
        .into_par_iter()
        .map(|index| {
            let roughness = fraction(index % ROUGHNESSES, ROUGHNESSES);
            mean(&view, roughness, fraction(index / ROUGHNESSES, STRENGTHS))
        })
        .collect();
    rows.extend(means.chunks(ROUGHNESSES as usize).flat_map(pairs));
    rows
}

/// The direction of a cosine to the normal, whose azimuth has this cosine to the grain.
fn towards(azimuth: f32, cosine: f32) -> Vec3 {
    let cosine = cosine.max(1e-4);
    let sine = (1.0 - cosine * cosine).sqrt();
    Vec3::new(azimuth * sine, (1.0 - azimuth * azimuth).sqrt() * sine, cosine)
}

/// The albedo as `o` sees it, by the microfacets that are seen from there.
fn albedo(surface: &Anisotropic, o: Vec3) -> Vec2 {
    LATTICE.mean(|point| {
        let h = surface.sample_visible(o, point);
        let i = (-o).reflect(h);
        if i.z <= 0.0 {
            return Vec2::ZERO;
        }
        let weight = surface.masking_reflected(o, i) / surface.masking(o);
        let fifth = grazing(o.dot(h).clamp(0.0, 1.0));
        Vec2::new(weight * (1.0 - fifth), weight * fifth)
    })
}

/// The mean of what kernels look up, over the cosine-weighted hemisphere.
fn mean(view: &AnisotropicAlbedos<'_>, roughness: f32, strength: f32) -> Vec2 {
    let [roots, turns] = STEPS;
    let middle = |k: u32, steps: u32| (k as f32 + 0.5) / steps as f32;
    let mut sum = DVec2::ZERO;
    for root in (0..roots).map(|k| middle(k, roots)) {
        for turn in (0..turns).map(|k| middle(k, turns) * FRAC_PI_2) {
            let o = towards(turn.cos(), root * root);
            let weight = 4.0 * f64::from(root).powi(3);
            sum += view.directional(roughness, strength, o).as_dvec2() * weight;
        }
    }
    (sum / f64::from(roots * turns)).as_vec2()
}

#[cfg(test)]
mod tests {
    use super::super::albedos;
    use super::*;
    use raystream_shaders::scene::bsdf::albedo::AlbedoView;
    use raystream_shaders::scene::bsdf::anisotropic::DIRECTIONS;

    #[test]
    fn without_strength_it_is_the_table_of_all_surfaces() {
        let rows = of_anisotropic();
        assert_eq!(rows.len() as u32, DIRECTIONS + STRENGTHS * (ROUGHNESSES - 1));
        let view = AnisotropicAlbedos { rows, first: 0 };
        let other = AlbedoView { rows: albedos::of_surface(), first: 0, anisotropic: 0 };
        for roughness in [0.0, 0.3, 0.55, 0.8, 1.0] {
            for cosine in [0.1, 0.4, 0.8, 1.0] {
                for azimuth in [0.0, 0.3, 1.0] {
                    let found = view.directional(roughness, 0.0, towards(azimuth, cosine));
                    let expected = other.directional(roughness, cosine);
                    let what = format!("{roughness} {cosine} {azimuth}: {found} {expected}");
                    assert!((found - expected).abs().max_element() < 0.006, "{what}");
                }
            }
            let (found, expected) = (view.mean(roughness, 0.0), other.mean(roughness));
            assert!((found - expected).abs().max_element() < 0.003, "{found} {expected}");
        }
    }

    #[test]
    fn what_lies_between_is_what_would_be_computed() {
        let view = AnisotropicAlbedos { rows: of_anisotropic(), first: 0 };
        let mut worst = 0.0_f32;
        for k in 0..400 {
            let number = |by: f32| (k as f32 * by).fract();
            let (roughness, strength) = (number(0.618), number(0.414));
            let o = towards(number(0.732), 0.05 + 0.95 * number(0.236));
            let found = view.directional(roughness, strength, o);
            let expected = albedo(&Anisotropic::new(roughness, strength), o);
            worst = worst.max((found - expected).abs().max_element());
        }
        assert!(worst < 0.01, "{worst}");
    }
}
