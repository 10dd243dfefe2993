//! The table of lights and their choice, by power or by a tree.

use super::alias_table::alias_table;
use super::emission_maps::MappedEmission;
use super::environment::Ball;
use super::light_tree::{LightTree, Source, boxed};
use super::scene_triangle::SceneTriangle;
use super::triangles::Functions;
use crate::scene::PunctualLight;
use glam::Vec3;
use raystream_shaders::scene::bsdf::Material;
use raystream_shaders::scene::light::{
    DIRECTION, EmissionMap, Light, MAPPED, POINT, TRIANGLE, area_pdf, importance,
};
use std::f64::consts::{FRAC_PI_2, PI};

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
    /// What chooses among them in place of the alias table, if that is asked for.
    pub tree: Option<LightTree>,
}

/// How paths from the camera choose a light at each vertex.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum LightChoice {
    /// By a tree where there are many lights, else by power.
    #[default]
    ByNumber,
    /// By the power of each.
    Power,
    /// By what each sends to the vertex at most, which a tree finds.
    Tree,
}

impl LightChoice {
    /// Whether a tree chooses among this many lights, those at infinity left out.
    pub fn is_tree(self, lights: usize) -> bool {
        match self {
            Self::ByNumber => lights >= MANY_LIGHTS,
            Self::Power => false,
            Self::Tree => lights > 1,
        }
    }
}

/// So many lights are chosen by a tree.
const MANY_LIGHTS: usize = 64;

/// Neither what is at infinity nor all other lights together are chosen less often than this: one
/// may be far stronger and all the same be hidden where the other shines.
const LEAST_CHANCE: f64 = 0.1;

impl Candidate {
    fn is_distant(&self) -> bool {
        self.source.is_none()
    }
}

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
}

/// A light whose chance is not known yet.
struct Candidate {
    light: Light,
    /// Flux over pi.
    power: f64,
    /// What its radiance is multiplied by at most, linear Rec.709.
    peak: f32,
    /// What a tree knows of it; nothing at infinity.
    source: Option<Source>,
}

impl Emitters<'_> {
    /// What the triangle of this number is chosen by, if it is a light: its importance.
    fn chosen_by(&self, triangle: usize) -> Option<f32> {
        let material = &self.materials[self.triangles[triangle].material as usize];
        let mapped = self.mapped(triangle);
        let chosen_by = mapped.map_or(importance(material.emission), |mapped| mapped.importance);
        (material.emits() && (mapped.is_none() || chosen_by > 0.0)).then_some(chosen_by)
    }

    /// What a texture says of it.
    fn mapped(&self, triangle: usize) -> Option<MappedEmission> {
        self.mapped.get(triangle).copied().flatten()
    }

    /// The triangles that are lights, in order.
    fn triangles_that_shine(&self) -> impl Iterator<Item = (usize, f32)> {
        let shining = |triangle| Some((triangle, self.chosen_by(triangle)?));
        (0..self.triangles.len()).filter_map(shining)
    }

    fn punctual_that_shine(&self) -> impl Iterator<Item = &PunctualLight> {
        self.punctual.iter().filter(|light| light.colour().max_element() > 0.0)
    }

    /// Whether a tree chooses among them by this `choice`.
    pub fn has_tree(&self, choice: LightChoice) -> bool {
        let is_near = |light: &&PunctualLight| !matches!(light, PunctualLight::Directional { .. });
        let punctual = self.punctual_that_shine().filter(is_near).count();
        choice.is_tree(self.triangles_that_shine().count() + punctual)
    }

    /// The [light](raystream_shaders::scene::triangle::Triangle::light) of each triangle; none if
    /// all are 0.
    pub fn marks(&self, has_tree: bool) -> Vec<u32> {
        if !has_tree {
            let mark = |it: &Option<MappedEmission>| it.map_or(0, |it| it.importance.to_bits());
            return self.mapped.iter().map(mark).collect();
        }
        let mut marks = vec![0; self.triangles.len()];
        for (number, (triangle, _)) in (0..).zip(self.triangles_that_shine()) {
            marks[triangle] = number;
        }
        marks
    }
}

/// Finds the lights and builds what chooses among them: the alias table, and the tree if that is
/// wanted. There is a `ball` around the scene. What an `environment`, if there is one, sends through
/// it is as much as triangles do whose area times importance is this; it is the last light.
pub fn build(
    emitters: &Emitters<'_>,
    ball: Ball,
    environment: Option<f64>,
    has_tree: bool,
) -> Lights {
    let mut maps = Vec::new();
    let mut candidates = emissive_triangles(emitters, &mut maps);
    candidates.extend(emitters.punctual_that_shine().map(|light| punctual(light, ball)));
    let brightest = candidates
        .iter()
        .map(|it| it.peak * radiance(&it.light, ball).max_element())
        .fold(0.0, f32::max);
    candidates.extend(environment.map(|power| Candidate {
        light: Light::default(),
        power,
        peak: 1.0,
        source: None,
    }));

    let sum = |distant: bool| -> f64 {
        candidates.iter().filter(|c| c.is_distant() == distant).map(|c| c.power).sum()
    };
    let (near, distant) = (sum(false), sum(true));
    let least = near * LEAST_CHANCE / (1.0 - LEAST_CHANCE);
    let most = near * (1.0 - LEAST_CHANCE) / LEAST_CHANCE;
    let counted = if near > 0.0 { distant.clamp(least, most) } else { distant };
    let weight = |candidate: &Candidate| {
        if candidate.is_distant() { counted * (candidate.power / distant) } else { candidate.power }
    };
    let weights: Vec<f64> = candidates.iter().map(weight).collect();
    let total_importance = weights.iter().sum::<f64>();
    let chance = |weight: f64| (weight / total_importance) as f32;
    let environment = environment.and(weights.last().copied());
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
        tree: if has_tree { tree(&candidates, &weights) } else { None },
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
    for (index, chosen_by) in emitters.triangles_that_shine() {
        let triangle = &emitters.triangles[index];
        let material = &emitters.materials[triangle.material as usize];
        let mapped = emitters.mapped(index);
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
        let (low, high) = boxed(&triangle.corners);
        let (axis, spread) = (functions.normal, 0.0);
        let source = Some(Source { low, high, axis, spread, intensity: power });
        candidates.push(Candidate { light, power, peak, source });
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
            peak: 1.0,
            source: Some(source_at(position, Vec3::Z, PI, colour)),
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
                peak: 1.0,
                source: Some(source_at(
                    position,
                    unit(direction),
                    (f64::from(outer_angle).to_radians() - FRAC_PI_2).max(0.0),
                    colour,
                )),
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
            peak: 1.0,
            source: None,
        },
    }
}

/// What a tree knows of a light at a point that shines up to a right angle from what it faces: as
/// far as `spread`, in radians, from `axis`.
fn source_at(position: Vec3, axis: Vec3, spread: f64, colour: Vec3) -> Source {
    let (low, high) = boxed(&[position]);
    Source { low, high, axis: axis.as_dvec3(), spread, intensity: importance(colour).into() }
}

/// The tree of lights with these weights, if there are two or more.
fn tree(candidates: &[Candidate], weights: &[f64]) -> Option<LightTree> {
    let (mut near, mut distant, mut near_weight) = (Vec::new(), Vec::new(), 0.0);
    for ((number, candidate), &weight) in (0..).zip(candidates).zip(weights) {
        match candidate.source {
            Some(source) => {
                near.push((number, source));
                near_weight += weight;
            }
            None => distant.push((number, weight)),
        }
    }
    LightTree::new(&near, near_weight, &distant)
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_lights_make_an_empty_table() {
        let emitters = Emitters {
            triangles: &[],
            materials: &[],
            mapped: &[],
            punctual: &[PunctualLight::point(Vec3::ZERO, Vec3::ZERO)],
        };
        let lights = build(&emitters, Ball::around([].into_iter()), None, false);
        assert!(lights.table.is_empty());
        assert_eq!((lights.total_importance, lights.brightest), (0.0, 0.0));
    }
}
