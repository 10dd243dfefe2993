//! The tables of albedos of rough surfaces, in the layout of
//! [`raystream_shaders::scene::bsdf::albedo`].

use glam::{UVec4, Vec2, Vec3};
use rayon::prelude::*;
use raystream_shaders::scene::bsdf::albedo::{AlbedoView, ROWS_PER_ROUGHNESS, SIDE};
use raystream_shaders::scene::bsdf::boundary::{dielectric_fresnel, refract};
use raystream_shaders::scene::bsdf::conductor::fresnel;
use raystream_shaders::scene::bsdf::ggx::Ggx;
use raystream_shaders::scene::bsdf::reflector::grazing;
use raystream_shaders::scene::bsdf::sheen;
use std::collections::BTreeMap;
use std::sync::{Arc, Mutex, OnceLock, PoisonError};

/// The lattice over which directions are integrated.
const LATTICE: Lattice = Lattice { points: 4181, generator: 2584 };
/// Intervals of the integral over angles, for each of the table's.
const STEPS: u32 = 16;

/// The rows of the table of surfaces, which is made once: how much by Schlick's two terms.
pub fn of_surface() -> &'static [UVec4] {
    static TABLE: OnceLock<Vec<UVec4>> = OnceLock::new();
    TABLE.get_or_init(|| tabulate(surface))
}

/// The rows of the table of a boundary of this index of refraction, which is made once: how much
/// light one microfacet sends on that is seen from outside, and from inside.
pub fn of_boundary(ior: f32) -> Arc<[UVec4]> {
    static TABLES: Mutex<BTreeMap<u32, Arc<[UVec4]>>> = Mutex::new(BTreeMap::new());
    let tables = || TABLES.lock().unwrap_or_else(PoisonError::into_inner);
    // Nobody else waits while it is made: two may make the same one.
    if let Some(table) = tables().get(&ior.to_bits()) {
        return table.clone();
    }
    let table = tabulate(|roughness, cosine| {
        let side = |from_outside| boundary(roughness, cosine, ior, from_outside);
        Vec2::new(side(true), side(false))
    });
    tables().entry(ior.to_bits()).or_insert(table.into()).clone()
}

/// The rows of the table of sheen, which is made once: how much it reflects, and nothing.
pub fn of_sheen() -> &'static [UVec4] {
    static TABLE: OnceLock<Vec<UVec4>> = OnceLock::new();
    let pair = |place, cosine| Vec2::new(fibres(sheen::roughness_at(place), cosine), 0.0);
    TABLE.get_or_init(|| tabulate(pair))
}

/// The mean of what a smooth metal of this index of refraction and coefficient of extinction
/// reflects, over the cosine-weighted hemisphere.
pub fn of_conductor(eta: Vec3, k: Vec3) -> Vec3 {
    let mean = |eta: f32, k: f32| {
        let steps = LATTICE.points;
        let middle = |step: u32| (f64::from(step) + 0.5) / f64::from(steps);
        let at = |step| middle(step) * f64::from(fresnel(middle(step) as f32, eta, k));
        (2.0 / f64::from(steps) * (0..steps).map(at).sum::<f64>()) as f32
    };
    Vec3::new(mean(eta.x, k.x), mean(eta.y, k.y), mean(eta.z, k.z))
}

/// The table of a pair that is a function of the roughness and of the cosine.
fn tabulate(directional: impl Fn(f32, f32) -> Vec2 + Sync) -> Vec<UVec4> {
    let places: Vec<(u32, u32)> =
        (0..SIDE).flat_map(|roughness| (0..SIDE).map(move |angle| (roughness, angle))).collect();
    let albedos: Vec<Vec2> = places
        .into_par_iter()
        .map(|(roughness, angle)| directional(fraction(roughness), fraction(angle).powi(2)))
        .collect();
    let mut rows: Vec<UVec4> = albedos.chunks(SIDE as usize).flat_map(pairs).collect();
    // The mean of what kernels look up, which is linear between the table's angles.
    let view = AlbedoView { rows: &rows, first: 0, anisotropic: 0 };
    let means: Vec<Vec2> = (0..SIDE).map(|roughness| mean(&view, fraction(roughness))).collect();
    rows.extend(pairs(&means));
    rows
}

/// The number `index` of [`SIDE`] from 0 to 1.
fn fraction(index: u32) -> f32 {
    index as f32 / (SIDE - 1) as f32
}

/// Each value with the next.
pub(super) fn pairs(values: &[Vec2]) -> Vec<UVec4> {
    let rows = values.windows(2).map(|pair| {
        let [low, high] = [pair[0], pair[1]];
        UVec4::new(low.x.to_bits(), low.y.to_bits(), high.x.to_bits(), high.y.to_bits())
    });
    rows.collect()
}

/// The direction of a cosine.
fn towards(cosine: f32) -> Vec3 {
    let cosine = cosine.max(1e-4);
    Vec3::new((1.0 - cosine * cosine).sqrt(), 0.0, cosine)
}

/// Points of the unit square that lie evenly: their number and their generator, two Fibonacci
/// numbers, one after the other (Niederreiter, "Random Number Generation and Quasi-Monte Carlo
/// Methods", 1992, section 5.1). Where light is lost is a step in the square, along which the
/// points of a grid would line up.
pub(super) struct Lattice {
    pub points: u32,
    pub generator: u32,
}

impl Lattice {
    /// The mean of a function over the points.
    pub(super) fn mean(&self, value: impl Fn([f32; 2]) -> Vec2) -> Vec2 {
        let middle = |k: u32| (k as f32 + 0.5) / self.points as f32;
        let points =
            (0..self.points).map(|k| [middle(k), middle(k * self.generator % self.points)]);
        let sum: glam::DVec2 = points.map(|point| value(point).as_dvec2()).sum();
        (sum / f64::from(self.points)).as_vec2()
    }
}

/// The albedo under a `cosine`, by the microfacets that are seen from there: for each, the weight
/// of its reflection, by Schlick's two terms.
fn surface(roughness: f32, cosine: f32) -> Vec2 {
    let ggx = Ggx::of_roughness(roughness);
    let o = towards(cosine);
    LATTICE.mean(|point| {
        let h = ggx.sample_visible(o, point);
        let i = (-o).reflect(h);
        if i.z <= 0.0 {
            return Vec2::ZERO;
        }
        let weight = ggx.masking_reflected(o, i) / ggx.masking(o);
        let fifth = grazing(o.dot(h).clamp(0.0, 1.0));
        Vec2::new(weight * (1.0 - fifth), weight * fifth)
    })
}

/// The same of a boundary: for each microfacet the weights of reflection and of passage.
fn boundary(roughness: f32, cosine: f32, ior: f32, from_outside: bool) -> f32 {
    let ggx = Ggx::of_roughness(roughness);
    let o = towards(cosine);
    let eta = if from_outside { ior } else { 1.0 / ior };
    let whole = LATTICE.mean(|point| {
        let h = ggx.sample_visible(o, point);
        let here = o.dot(h).clamp(0.0, 1.0);
        let reflected = dielectric_fresnel(here, eta);
        let up = (-o).reflect(h);
        let mut weight = 0.0;
        if up.z > 0.0 {
            weight += reflected * ggx.masking_reflected(o, up) / ggx.masking(o);
        }
        if reflected < 1.0 {
            let down = refract(o, h, here, eta);
            if down.z < 0.0 {
                weight += (1.0 - reflected) * ggx.masking_transmitted(o, down) / ggx.masking(o);
            }
        }
        Vec2::new(weight, 0.0)
    });
    whole.x
}

/// The albedo of sheen under a `cosine`, by directions spread evenly over the hemisphere.
fn fibres(roughness: f32, cosine: f32) -> f32 {
    let o = towards(cosine);
    LATTICE.mean(|point| Vec2::new(sheen::value(roughness, o, sheen::sample(point)), 0.0)).x
        / sheen::PDF
}

/// The mean of a roughness's albedos, weighted by the cosine, by Simpson's rule over the cosine's
/// root, in which they are linear piece by piece.
fn mean(view: &AlbedoView<'_>, roughness: f32) -> Vec2 {
    let steps = STEPS * ROWS_PER_ROUGHNESS;
    let at = |k: u32| {
        let root = f64::from(k) / f64::from(steps);
        let albedo = view.directional(roughness, (root * root) as f32).as_dvec2();
        albedo * (4.0 * root.powi(3))
    };
    let inner: glam::DVec2 = (1..steps).map(|k| at(k) * if k % 2 == 1 { 4.0 } else { 2.0 }).sum();
    ((at(0) + inner + at(steps)) / (3.0 * f64::from(steps))).as_vec2()
}

#[cfg(test)]
mod tests {
    use super::*;
    use raystream_shaders::scene::bsdf::albedo::ROWS;

    #[test]
    fn the_table_has_its_rows_and_mirrors_reflect_all() {
        assert_eq!(of_surface().len(), ROWS as usize);
        let view = AlbedoView { rows: of_surface(), first: 0, anisotropic: 0 };
        for cosine in [0.05, 0.3, 1.0] {
            let albedo = view.directional(0.0, cosine);
            assert!((albedo.x + albedo.y - 1.0).abs() < 1e-3, "{cosine}: {albedo}");
        }
        // Light from grazing angles counts little: the mean of (1 - c)^5 is 1/21.
        let mean = view.mean(0.0);
        assert!((mean.y - 1.0 / 21.0).abs() < 1e-3, "{mean}");
    }

    #[test]
    fn rougher_surfaces_lose_more_to_several_reflections() {
        let view = AlbedoView { rows: of_surface(), first: 0, anisotropic: 0 };
        let means: Vec<f32> = (0..SIDE).map(|k| view.mean(fraction(k)).element_sum()).collect();
        assert!(means.windows(2).all(|pair| pair[1] <= pair[0] + 1e-4), "{means:?}");
        // Slope 1: Kulla and Conty 2017 have some 0.55 for a mean albedo of one reflection.
        assert!((0.4..0.7).contains(&means[SIDE as usize - 1]), "{means:?}");
    }
}
