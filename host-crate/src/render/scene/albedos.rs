//! The table of albedos of rough surfaces, in the layout of
//! [`raystream_shaders::scene::bsdf::albedo`].

use glam::{UVec4, Vec2, Vec3};
use rayon::prelude::*;
use raystream_shaders::scene::bsdf::albedo::{AlbedoView, ROWS_PER_ROUGHNESS, SIDE};
use raystream_shaders::scene::bsdf::ggx::Ggx;
use std::sync::OnceLock;

/// Points along one axis of the square over which microfacets are integrated.
const POINTS: u32 = 64;
/// Intervals of the integral over angles, for each of the table's.
const STEPS: u32 = 16;

/// The rows of the table, which are made once.
pub fn table() -> &'static [UVec4] {
    static TABLE: OnceLock<Vec<UVec4>> = OnceLock::new();
    TABLE.get_or_init(make)
}

fn make() -> Vec<UVec4> {
    let places: Vec<(u32, u32)> =
        (0..SIDE).flat_map(|roughness| (0..SIDE).map(move |angle| (roughness, angle))).collect();
    let albedos: Vec<Vec2> = places
        .into_par_iter()
        .map(|(roughness, angle)| directional(fraction(roughness), fraction(angle).powi(2)))
        .collect();
    let mut rows: Vec<UVec4> = albedos.chunks(SIDE as usize).flat_map(pairs).collect();
    // The mean of what kernels look up, which is linear between the table's angles.
    let view = AlbedoView { rows: &rows, first: 0 };
    let means: Vec<Vec2> = (0..SIDE).map(|roughness| mean(&view, fraction(roughness))).collect();
    rows.extend(pairs(&means));
    rows
}

/// The number `index` of [`SIDE`] from 0 to 1.
fn fraction(index: u32) -> f32 {
    index as f32 / (SIDE - 1) as f32
}

/// Each value with the next.
fn pairs(values: &[Vec2]) -> Vec<UVec4> {
    let rows = values.windows(2).map(|pair| {
        let [low, high] = [pair[0], pair[1]];
        UVec4::new(low.x.to_bits(), low.y.to_bits(), high.x.to_bits(), high.y.to_bits())
    });
    rows.collect()
}

/// The albedo under a `cosine`, by the microfacets that are seen from there: for each, the weight
/// of its reflection, by Schlick's two terms.
fn directional(roughness: f32, cosine: f32) -> Vec2 {
    let ggx = Ggx::of_roughness(roughness);
    let cosine = cosine.max(1e-4);
    let o = Vec3::new((1.0 - cosine * cosine).sqrt(), 0.0, cosine);
    let middle = |k: u32| (k as f32 + 0.5) / POINTS as f32;
    let mut sum = glam::DVec2::ZERO;
    for k in 0..POINTS * POINTS {
        let h = ggx.sample_visible(o, [middle(k % POINTS), middle(k / POINTS)]);
        let i = (-o).reflect(h);
        if i.z > 0.0 {
            let weight = ggx.masking_reflected(o, i) / ggx.masking(o);
            let fifth = (1.0 - o.dot(h).clamp(0.0, 1.0)).powi(5);
            sum += Vec2::new(weight * (1.0 - fifth), weight * fifth).as_dvec2();
        }
    }
    (sum / f64::from(POINTS * POINTS)).as_vec2()
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
        assert_eq!(table().len(), ROWS as usize);
        let view = AlbedoView { rows: table(), first: 0 };
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
        let view = AlbedoView { rows: table(), first: 0 };
        let means: Vec<f32> = (0..SIDE).map(|k| view.mean(fraction(k)).element_sum()).collect();
        assert!(means.windows(2).all(|pair| pair[1] <= pair[0] + 1e-4), "{means:?}");
        // Slope 1: Kulla and Conty 2017 have some 0.55 for a mean albedo of one reflection.
        assert!((0.4..0.7).contains(&means[SIDE as usize - 1]), "{means:?}");
    }
}
