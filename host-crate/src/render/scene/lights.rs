//! The table of lights and their choice by power.

use super::emission_maps::MappedEmission;
use super::environment::Ball;
use super::scene_triangle::SceneTriangle;
use super::triangles::Functions;
use crate::scene::PunctualLight;
use glam::Vec3;
use raystream_shaders::scene::bsdf::Material;
use raystream_shaders::scene::light::{
    DIRECTION, EmissionMap, Light, MAPPED, POINT, TRIANGLE, area_pdf, importance,
};
use std::f64::consts::PI;

/// The lights of a scene.
pub struct Lights {
    /// Emissive triangles, punctual lights and what stands for the environment, with the alias
    /// table that chooses among them.
    pub table: Vec<Light>,
    /// What textures say of triangles in the table, see [`Light::kind`].
    pub maps: Vec<EmissionMap>,
    /// Sum of area times importance, in squared world units.
    pub total_importance: f32,
    /// Probability of the environment, if there is one.
    pub environment_chance: f32,
    /// Largest component of emitted radiance, or of what stands for it; 0 without lights.
    pub brightest: f32,
}

/// Neither what is at infinity nor all other lights together are chosen less often than this: one
/// may be far stronger and all the same be hidden where the other shines.
const LEAST_CHANCE: f64 = 0.1;

/// What may be a light.
#[derive(Clone, Copy)]
pub struct Emitters<'a> {
    /// All triangles.
    pub triangles: &'a [SceneTriangle],
    /// Their materials.
    pub materials: &'a [Material],
    /// What textures say of each triangle; may be empty.
    pub mapped: &'a [Option<MappedEmission>],
    /// The lights without a surface.
    pub punctual: &'a [PunctualLight],
    /// A ball around the scene.
    pub ball: Ball,
    /// What an environment, if there is one, sends through the scene: as much as triangles do whose
    /// area times importance is this.
    pub environment: Option<f64>,
}

/// A light whose chance is not known yet.
struct Candidate {
    light: Light,
    /// Flux over pi.
    power: f64,
    is_distant: bool,
    /// What its radiance is multiplied by at most, linear Rec.709.
    peak: f32,
}

/// Finds the lights and builds the alias table of them, the environment last.
pub fn build(emitters: &Emitters<'_>) -> Lights {
    let mut maps = Vec::new();
    let mut candidates = emissive_triangles(emitters, &mut maps);
    let shining = emitters.punctual.iter().filter(|light| light.colour().max_element() > 0.0);
    candidates.extend(shining.map(|light| punctual(light, emitters.ball)));
    let brightest = candidates
        .iter()
        .map(|it| it.peak * radiance(&it.light, emitters.ball).max_element())
        .fold(0.0, f32::max);
    candidates.extend(emitters.environment.map(|power| Candidate {
        light: Light::default(),
        power,
        is_distant: true,
        peak: 1.0,
    }));

    let sum = |distant: bool| -> f64 {
        candidates.iter().filter(|c| c.is_distant == distant).map(|c| c.power).sum()
    };
    let (near, distant) = (sum(false), sum(true));
    let least = near * LEAST_CHANCE / (1.0 - LEAST_CHANCE);
    let most = near * (1.0 - LEAST_CHANCE) / LEAST_CHANCE;
    let counted = if near > 0.0 { distant.clamp(least, most) } else { distant };
    let weight = |candidate: &Candidate| {
        if candidate.is_distant { counted * (candidate.power / distant) } else { candidate.power }
    };
    let weights: Vec<f64> = candidates.iter().map(weight).collect();
    let total_importance = weights.iter().sum::<f64>();
    let chance = |weight: f64| (weight / total_importance) as f32;
    let environment = emitters.environment.and(weights.last().copied());
    let columns = alias_table(&weights);
    let table = candidates
        .iter()
        .zip(&weights)
        .zip(&columns)
        .map(|((Candidate { light, .. }, &weight), &(threshold, alias))| {
            let pdf = match light.kind {
                POINT | DIRECTION => chance(weight),
                // So far it is the importance.
                _ => area_pdf(light.pdf, total_importance as f32),
            };
            Light { threshold, alias, pdf, ..*light }
        })
        .collect();
    Lights {
        table,
        maps,
        total_importance: total_importance as f32,
        environment_chance: environment.map_or(0.0, chance),
        brightest,
    }
}

/// The triangles that emit, with their importance in place of the density. What textures say of
/// them is added to `maps`.
fn emissive_triangles(emitters: &Emitters<'_>, maps: &mut Vec<EmissionMap>) -> Vec<Candidate> {
    let mut candidates = Vec::new();
    for (index, triangle) in emitters.triangles.iter().enumerate() {
        let material = &emitters.materials[triangle.material as usize];
        let mapped = emitters.mapped.get(index).copied().flatten();
        let chosen_by = mapped.map_or(importance(material.emission), |mapped| mapped.importance);
        if !material.emits() || mapped.is_some() && chosen_by <= 0.0 {
            continue;
        }
        let kind = mapped.map_or(TRIANGLE, |_| MAPPED + maps.len() as u32);
        maps.extend(mapped.map(|mapped| mapped.map));
        let [corner, b, c] = triangle.corners;
        let functions = Functions::of(triangle.corners);
        let light = Light {
            corner,
            edge1: b - corner,
            edge2: c - corner,
            pdf: chosen_by,
            radiance: material.emission,
            kind,
            normal: functions.normal.as_vec3(),
            offset: functions.offset as f32,
            ..Light::default()
        };
        let power = area(triangle) * f64::from(chosen_by);
        let peak = mapped.map_or(1.0, |mapped| mapped.peak);
        candidates.push(Candidate { light, power, is_distant: false, peak });
    }
    candidates
}

/// A light without a surface, as [`raystream_shaders::scene::light::punctual`] lays it out.
fn punctual(light: &PunctualLight, ball: Ball) -> Candidate {
    let colour = light.colour();
    let unit = |direction: Vec3| direction.as_dvec3().normalize().as_vec3();
    let power_of = |extent: f64| f64::from(importance(colour)) * extent / PI;
    match *light {
        PunctualLight::Point { position, .. } => Candidate {
            light: Light {
                corner: position,
                edge1: Vec3::new(0.0, 1.0, 2.0),
                radiance: colour,
                kind: POINT,
                normal: Vec3::Z,
                ..Light::default()
            },
            power: power_of(4.0 * PI),
            is_distant: false,
            peak: 1.0,
        },
        PunctualLight::Spot { position, direction, inner_angle, outer_angle, .. } => {
            // 1 - cosine.
            let versine =
                |degrees: f32| 2.0 * (0.5 * f64::from(degrees).to_radians()).sin().powi(2);
            let [inner, outer] = [inner_angle, outer_angle].map(versine);
            let scale = (outer - inner).max(SHARPEST_EDGE).recip();
            Candidate {
                light: Light {
                    corner: position,
                    edge1: Vec3::new(scale as f32, ((outer - 1.0) * scale) as f32, outer as f32),
                    radiance: colour,
                    kind: POINT,
                    normal: unit(direction),
                    ..Light::default()
                },
                power: power_of(2.0 * PI * (inner + (outer - inner) / 3.0)),
                is_distant: false,
                peak: 1.0,
            }
        }
        PunctualLight::Directional { direction, angle, .. } => Candidate {
            light: Light {
                corner: ball.centre,
                edge1: Vec3::X * (0.5 * f64::from(angle).to_radians()).sin() as f32,
                edge2: Vec3::X * ball.radius,
                radiance: colour,
                kind: DIRECTION,
                normal: unit(direction),
                ..Light::default()
            },
            power: power_of(PI * ball.radius_squared()),
            is_distant: true,
            peak: 1.0,
        },
    }
}

/// The least difference of cosines between the two angles of a spot: below, a direction's roundings
/// show.
const SHARPEST_EDGE: f64 = 1e-6;

/// The radiance of a light, or of white surfaces that a light without a surface shines on, about.
fn radiance(light: &Light, ball: Ball) -> Vec3 {
    match light.kind {
        POINT => light.radiance / (ball.radius * ball.radius),
        _ => light.radiance,
    }
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
    use raystream_shaders::scene::texture::TextureView;

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
            first_map: 0,
            total_importance: 0.0,
            offset_roundings: 0.0,
            environment: EnvironmentView::new(&[], NO_ENVIRONMENT),
            textures: TextureView::new(&[], Fixed),
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
        let lights = build(&Emitters {
            triangles: &[],
            materials: &[],
            mapped: &[],
            punctual: &[PunctualLight::point(Vec3::ZERO, Vec3::ZERO)],
            ball: Ball::around([].into_iter()),
            environment: None,
        });
        assert!(lights.table.is_empty());
        assert_eq!((lights.total_importance, lights.brightest), (0.0, 0.0));
    }
}
