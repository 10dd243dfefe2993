//! Shapes at their places in the world.

use super::document::Document;
use super::geometry::Geometry;
use crate::scene::bounds::MAX_COORDINATE;
use crate::scene::clean::Cleaner;
use crate::scene::description::Scene;
use crate::scene::error::SceneError;
use crate::scene::instance::{is_well_conditioned, may_have_instances};
use crate::scene::material::MaterialId;
use crate::scene::mesh::{Mesh, has_area};
use crate::scene::options::is_worth_keeping;
use glam::{DAffine3, DMat3, DMat4, DVec3, Vec3};
use std::collections::HashMap;
use std::rc::Rc;

/// Positions of a shape that are looked at in each of many places.
const SAMPLED: usize = 64;
/// Memory of an instance on the way to a device, in bytes.
const PER_INSTANCE: u64 = 1024;

/// A shape at its places in the world.
pub(super) struct Placed {
    pub shape: Rc<Geometry>,
    pub transforms: Vec<DMat4>,
    pub material: MaterialId,
    /// The part of the file that it is from.
    pub part: String,
}

impl Placed {
    /// Some of its positions in the world, in each place: all if there is one.
    pub(super) fn sampled(
        &self,
    ) -> impl Iterator<Item = impl ExactSizeIterator<Item = DVec3>> + Clone {
        let all = self.shape.positions.len();
        let count = if self.transforms.len() > 1 { all.min(SAMPLED) } else { all };
        self.transforms.iter().map(move |transform| {
            let sampled = &self.shape.positions[..count];
            sampled.iter().map(|position| transform.transform_point3(position.as_dvec3()))
        })
    }

    /// Whether it is worth being kept once.
    fn is_repeated(&self) -> bool {
        is_worth_keeping(self.shape.triangles.len(), self.transforms.len())
    }

    /// Whether it may be kept once in this place.
    fn may_stay(&self, transform: &DMat4, scene: &Scene) -> bool {
        may_have_instances(&scene.materials[self.material.0 as usize])
            && is_well_conditioned(&DAffine3::from_mat4(*transform))
    }
}

/// What is `placed`, each shape in all of its places if it is to be kept once, or else several
/// times. The memory that it takes is counted.
pub(super) fn gathered(
    placed: Vec<Placed>,
    document: &Document<'_>,
    scene: &Scene,
) -> Result<Vec<Placed>, SceneError> {
    let mut found: Vec<Placed> = Vec::with_capacity(placed.len());
    let mut places: HashMap<(*const Geometry, u32), usize> = HashMap::new();
    for one in &placed {
        let key = (Rc::as_ptr(&one.shape), one.material.0);
        *places.entry(key).or_default() += one.transforms.len();
    }
    let is_kept = |one: &Placed| {
        let count = places[&(Rc::as_ptr(&one.shape), one.material.0)];
        is_worth_keeping(one.shape.triangles.len(), count)
    };
    let repeated = placed.iter().filter(|one| is_kept(one));
    let repeated = repeated.map(|one| (one.shape.triangles.len() * one.transforms.len()) as u64);
    let keeps = document.instancing.keeps(repeated.sum());
    let mut first: HashMap<(*const Geometry, u32), usize> = HashMap::new();
    for one in placed {
        let key = (Rc::as_ptr(&one.shape), one.material.0);
        let is_kept = keeps && is_kept(&one);
        for transform in &one.transforms {
            if is_kept && one.may_stay(transform, scene) {
                document.charge(PER_INSTANCE, &one.part)?;
                continue;
            }
            document.charge_triangles(one.shape.triangles.len(), &one.part)?;
            document.charge_vertices(one.shape.positions.len(), &one.part)?;
        }
        if is_kept {
            if let Some(&at) = first.get(&key) {
                found[at].transforms.extend(one.transforms);
                continue;
            }
            document.charge_triangles(one.shape.triangles.len(), &one.part)?;
            document.charge_vertices(one.shape.positions.len(), &one.part)?;
            first.insert(key, found.len());
            found.push(one);
        } else {
            let Placed { shape, transforms, material, part } = one;
            let alone = |transform| Placed {
                shape: shape.clone(),
                transforms: vec![transform],
                material,
                part: part.clone(),
            };
            found.extend(transforms.into_iter().map(alone));
        }
    }
    Ok(found)
}

/// Adds what is placed to a scene, with `origin` taken off its positions.
pub(super) fn add(
    document: &Document<'_>,
    placed: &[Placed],
    origin: DVec3,
    cleaner: &mut Cleaner,
    scene: &mut Scene,
) -> Result<(), SceneError> {
    for one in placed {
        let taken_off = DMat4::from_translation(-origin);
        let to_world: Vec<DMat4> = one.transforms.iter().map(|t| taken_off * *t).collect();
        if !one.is_repeated() {
            for transform in &to_world {
                let mesh = mesh(document, one, transform, cleaner)?;
                scene.add_mesh(mesh);
            }
            continue;
        }
        let shape = mesh(document, one, &DMat4::IDENTITY, cleaner)?;
        let transforms: Vec<DAffine3> = to_world.iter().map(|&t| DAffine3::from_mat4(t)).collect();
        let [low, high] = shape.bounds();
        let (middle, reach) = (0.5 * (low + high), 0.5 * (high - low));
        for transform in &transforms {
            let columns = transform.matrix3.to_cols_array().map(f64::abs);
            let extent = DMat3::from_cols_array(&columns) * reach;
            let farthest = transform.transform_point3(middle).abs() + extent;
            if !is_near(farthest) {
                return Err(too_far(document, one, "an instance"));
            }
        }
        scene.add_repeated(shape, &transforms);
    }
    Ok(())
}

fn is_near(place: DVec3) -> bool {
    place.abs().max_element() <= MAX_COORDINATE
}

fn too_far(document: &Document<'_>, placed: &Placed, what: &str) -> SceneError {
    let what = format!(
        "{what} is more than {MAX_COORDINATE:e} from the middle of the scene, or is no number"
    );
    document.wrong(&placed.part, what)
}

/// The mesh of a shape where a transform has it.
fn mesh(
    document: &Document<'_>,
    placed: &Placed,
    transform: &DMat4,
    cleaner: &mut Cleaner,
) -> Result<Mesh, SceneError> {
    let place = |position: &Vec3| transform.transform_point3(position.as_dvec3());
    let positions = &placed.shape.positions;
    if let Some(index) = positions.iter().position(|position| !is_near(place(position))) {
        return Err(too_far(document, placed, &format!("vertex {index}")));
    }
    let positions = positions.iter().map(|position| place(position).as_vec3()).collect();
    let mut mesh = placed.shape.mesh(placed.material, positions, transform);
    if placed.shape.is_joined {
        // Strips have triangles without area where they are joined.
        mesh.retain(has_area);
    } else {
        cleaner.clean(&mut mesh);
    }
    Ok(mesh)
}
