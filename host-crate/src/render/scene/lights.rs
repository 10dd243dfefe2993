//! The table of emissive triangles and their choice by power.

use super::scene_triangle::SceneTriangle;
use super::triangles::Functions;
use glam::Vec3;
use raystream_shaders::scene::bsdf::Material;
use raystream_shaders::scene::light::{Light, area_pdf, importance};

/// The lights of a scene.
pub struct Lights {
    /// Emissive triangles, with the alias table that chooses among them.
    pub table: Vec<Light>,
    /// Sum of area times importance, in squared world units.
    pub total_importance: f32,
    /// Probability of the environment, if there is one.
    pub environment_chance: f32,
    /// Largest component of emitted radiance; 0 without lights.
    pub brightest: f32,
}

/// Neither the environment nor the triangles together are chosen less often than this: one may be
/// far stronger and all the same be hidden where the other shines.
const LEAST_CHANCE: f64 = 0.1;

/// Finds the emissive triangles and builds the alias table of them and, last, the environment. What
/// it sends through the scene is as much as triangles do whose area times importance is
/// `environment`.
pub fn build(
    triangles: &[SceneTriangle],
    materials: &[Material],
    environment: Option<f64>,
) -> Lights {
    let emissive: Vec<(&SceneTriangle, &Material)> = triangles
        .iter()
        .map(|t| (t, &materials[t.material as usize]))
        .filter(|(_, material)| material.emits())
        .collect();
    let mut weights: Vec<f64> = emissive
        .iter()
        .map(|(t, material)| area(t) * f64::from(importance(material.emission)))
        .collect();
    let of_triangles = weights.iter().sum::<f64>();
    let least = of_triangles * LEAST_CHANCE / (1.0 - LEAST_CHANCE);
    let most = of_triangles * (1.0 - LEAST_CHANCE) / LEAST_CHANCE;
    let environment =
        environment.map(|power| if of_triangles > 0.0 { power.clamp(least, most) } else { power });
    weights.extend(environment);
    let total_importance = weights.iter().sum::<f64>();
    let environment_chance = (environment.unwrap_or(0.0) / total_importance) as f32;
    let columns = alias_table(&weights);
    let chosen = columns
        .last()
        .filter(|_| environment.is_some())
        .map(|&(threshold, alias)| Light { threshold, alias, ..Light::default() });
    let table = emissive
        .iter()
        .zip(&columns)
        .map(|((triangle, material), &(threshold, alias))| {
            let [corner, b, c] = triangle.corners;
            let functions = Functions::of(triangle.corners);
            Light {
                corner,
                threshold,
                edge1: b - corner,
                alias,
                edge2: c - corner,
                pdf: area_pdf(material.emission, total_importance as f32),
                radiance: material.emission,
                pad: 0,
                normal: functions.normal.as_vec3(),
                offset: functions.offset as f32,
            }
        })
        .chain(chosen)
        .collect();
    let brightest =
        emissive.iter().map(|(_, material)| material.emission.max_element()).fold(0.0, f32::max);
    Lights { table, total_importance: total_importance as f32, environment_chance, brightest }
}

fn area(triangle: &SceneTriangle) -> f64 {
    let [a, b, c] = triangle.corners.map(Vec3::as_dvec3);
    0.5 * (b - a).cross(c - a).length()
}

/// Columns (threshold out of 2^24, alias) that choose in proportion to `weights`: Vose, "A Linear
/// Algorithm for Generating Random Numbers with a Given Distribution", IEEE TSE 17(9), 1991.
fn alias_table(weights: &[f64]) -> Vec<(u32, u32)> {
    const ONE: f64 = 16_777_216.0;
    let total: f64 = weights.iter().sum();
    let mut share: Vec<f64> = weights.iter().map(|w| w / total * weights.len() as f64).collect();
    let mut columns: Vec<(u32, u32)> =
        (0..weights.len() as u32).map(|own| (ONE as u32, own)).collect();
    let (mut small, mut large): (Vec<usize>, Vec<usize>) =
        (0..share.len()).partition(|&i| share[i] < 1.0);
    while let (Some(poor), Some(&rich)) = (small.pop(), large.last()) {
        columns[poor] = ((share[poor] * ONE).round() as u32, rich as u32);
        share[rich] -= 1.0 - share[poor];
        if share[rich] < 1.0 {
            large.pop();
            small.push(rich);
        }
    }
    columns
}

#[cfg(test)]
mod tests {
    use super::*;
    use raystream_shaders::scene::abilities::Fixed;
    use raystream_shaders::scene::environment::{EnvironmentView, NO_ENVIRONMENT};
    use raystream_shaders::scene::light::LightView;

    #[test]
    fn lights_are_chosen_in_proportion_to_their_weights() {
        let weights = [1.0, 0.0, 5.0, 0.25, 3.0, 3.0, 1e-3];
        let lights: Vec<Light> = alias_table(&weights)
            .into_iter()
            .map(|(threshold, alias)| Light { threshold, alias, ..Default::default() })
            .collect();
        let rows: Vec<glam::UVec4> = bytemuck::pod_collect_to_vec(&lights);
        let view = LightView {
            rows: &rows,
            first: 0,
            count: lights.len() as u32,
            total_importance: 0.0,
            offset_roundings: 0.0,
            environment: EnvironmentView::new(&[], NO_ENVIRONMENT),
            abilities: Fixed::<0>,
        };
        // A regular grid of 2^20 numbers, so that the counts are within the number of column ends
        // of the exact ones.
        let mut counts = [0_u32; 7];
        for k in 0..1_u32 << 20 {
            counts[view.choose(k << 12 | 0x800) as usize] += 1;
        }
        let total: f64 = weights.iter().sum();
        for (&count, weight) in counts.iter().zip(weights) {
            let expected = weight / total * f64::from(1 << 20);
            assert!((f64::from(count) - expected).abs() <= 14.0, "{counts:?} for {weights:?}");
        }
    }

    #[test]
    fn no_lights_make_an_empty_table() {
        let lights = build(&[], &[], None);
        assert!(lights.table.is_empty());
        assert_eq!((lights.total_importance, lights.brightest), (0.0, 0.0));
    }
}
