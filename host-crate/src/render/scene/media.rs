//! The table of bodies, in the layout of [`raystream_shaders::scene::media`].

use super::materials::Tables;
use super::rows_of;
use crate::scene::{Body, Scene, distinct_ior};
use glam::{UVec4, Vec3};
use rayon::prelude::*;
use raystream_shaders::memory::rows::row;
use raystream_shaders::scene::SceneView;
use raystream_shaders::scene::abilities::{ALL, Fixed};
use raystream_shaders::scene::bvh::Order;
use raystream_shaders::scene::light::{DIRECTION, Light, POINT};
use raystream_shaders::scene::media::{self, Media, PASSES_ALL};
use raystream_shaders::scene::ray::{Hit, OFFSET_ROUNDINGS, Ray, offset_distance};

/// Directions in which it is looked for what a point is in. Most of them decide: one may run into
/// an edge.
const PROBES: [Vec3; 3] = [
    Vec3::new(0.362, 0.851, 0.381),
    Vec3::new(-0.733, 0.211, 0.647),
    Vec3::new(0.157, -0.542, -0.826),
];

/// The rows, and where those of the lights begin: what these are in is not known yet.
pub struct PackedMedia {
    /// All rows.
    pub rows: Vec<UVec4>,
    first_light: usize,
}

impl PackedMedia {
    /// Those of a scene in which paths must know what they are in, with this many lights; None of
    /// others. What bounds bodies against each other is added to `tables`.
    pub fn new(scene: &Scene, lights: usize, tables: &mut Tables) -> Option<Self> {
        if !scene.has_media() {
            return None;
        }
        let bodies = scene.bodies();
        let count = bodies.len() as u32;
        let materials = words_of_materials(scene, &bodies);
        let before_lights = (count + 1) * (count + 1) + materials.len() as u32;
        let mut rows = vec![UVec4::new(count, 0, before_lights, 0)];
        rows.extend(bodies.iter().map(|body| row(body.absorption, 0)));
        for body in &bodies {
            rows.push(interface(body, None, tables));
            rows.extend(bodies.iter().map(|other| interface(body, Some(other), tables)));
        }
        rows.extend(materials);
        let first_light = rows.len();
        rows.resize(first_light + lights.div_ceil(4), UVec4::ZERO);
        Some(Self { rows, first_light })
    }

    /// What the camera at `origin` and the fronts of `lights` are in; `view` has the rows, as far
    /// as they are known.
    pub fn places(
        &self,
        view: &SceneView<'_, Fixed<ALL>>,
        origin: Vec3,
        lights: &[Light],
    ) -> Places {
        let words: Vec<u32> = lights.par_iter().map(|light| of_light(view, light).0).collect();
        Places { camera: of_camera(view, origin), lights: rows_of(&words) }
    }

    /// Writes what was not known into `rows`, those of this.
    pub fn complete(&self, rows: &mut [UVec4], places: &Places) {
        write_camera(rows, places.camera);
        rows[self.first_light..][..places.lights.len()].copy_from_slice(&places.lights);
    }
}

/// What the camera and the lights are in.
pub struct Places {
    camera: Media,
    lights: Vec<UVec4>,
}

/// What a camera at `origin` is in.
pub fn of_camera(view: &SceneView<'_, Fixed<ALL>>, origin: Vec3) -> Media {
    around(view, origin)
}

/// Writes what the camera is in into the rows of bodies.
pub fn write_camera(rows: &mut [UVec4], media: Media) {
    rows[0].y = media.0;
}

/// The words of a scene's materials, and of its quad lights, which bound none; `bodies` are
/// numbered from 1, in the order of their priorities.
fn words_of_materials(scene: &Scene, bodies: &[Body]) -> Vec<UVec4> {
    let word = |body: Body| {
        let number = bodies.partition_point(|other| other.key() <= body.key()) as u32;
        let up_to = bodies.partition_point(|other| other.priority <= body.priority) as u32;
        let stays_below = body.priority.map_or(PASSES_ALL, |_| up_to);
        media::Body { number, stays_below }.to_word()
    };
    let words = scene.materials.iter().map(|material| material.body().map_or(0, word));
    rows_of(&words.chain(scene.quad_lights.iter().map(|_| 0)).collect::<Vec<u32>>())
}

/// The row of an interface.
fn interface(body: &Body, other: Option<&Body>, tables: &mut Tables) -> UVec4 {
    // Indices of refraction are relative to the outside, unless a priority says that both are
    // there.
    let is_absolute = |other: &&Body| body.priority.is_some() || other.priority.is_some();
    let ratio = body.ior / other.filter(is_absolute).map_or(1.0, |other| other.ior);
    if !body.is_rough {
        return UVec4::new(ratio.to_bits(), 0, 0, 0);
    }
    let ratio = distinct_ior(ratio);
    UVec4::new(ratio.to_bits(), tables.boundary(ratio), 0, 0)
}

/// What the front of a light is in.
fn of_light(view: &SceneView<'_, Fixed<ALL>>, light: &Light) -> Media {
    if light.kind == DIRECTION || light.radiance == Vec3::ZERO {
        return Media::NONE;
    }
    if light.kind == POINT {
        return around(view, light.corner);
    }
    let centre = light.corner + (light.edge1 + light.edge2) / 3.0;
    let distance = offset_distance(OFFSET_ROUNDINGS, centre.abs().max_element());
    around(view, centre + light.normal * distance)
}

/// What a point is in, by what lies between it and infinity, where nothing is.
fn around(view: &SceneView<'_, Fixed<ALL>>, point: Vec3) -> Media {
    let [a, b, c] = PROBES.map(|direction| seen_along(view, &Ray::new(point, direction)));
    if b == c { b } else { a }
}

/// What a ray without an end starts in.
fn seen_along(view: &SceneView<'_, Fixed<ALL>>, ray: &Ray) -> Media {
    let mut crossed = Vec::new();
    let mut passed = Hit::miss(0.0);
    loop {
        passed = view.bvh.traverse(ray, &passed, Order { any: false, behind: true });
        if !passed.is_some() {
            break;
        }
        let body = view.surfaces.body(&passed);
        if body.is_some() {
            crossed.push((body, view.is_front(ray, &passed)));
        }
    }
    crossed.iter().rev().fold(Media::NONE, |media, &(body, from_front)| {
        if from_front { media.left(body) } else { media.entered(body) }
    })
}
