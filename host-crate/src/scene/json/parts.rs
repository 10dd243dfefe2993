//! Meshes of an OBJ's parts.

use super::defects;
use super::format::Normals;
use super::surfaces::{Sources, Surfaces};
use crate::scene::bounds::MAX_COORDINATE;
use crate::scene::clean::Cleaner;
use crate::scene::description::Scene;
use crate::scene::error::SceneError;
use crate::scene::material::MaterialId;
use crate::scene::obj::texture_map::Laid;
use crate::scene::obj::{Obj, Part, Placement};
use crate::scene::options::{LoadOptions, is_worth_keeping};
use crate::scene::picture::Pictures;
use crate::scene::summary::Fate;
use glam::{DAffine3, DVec3};

/// What is the same for all places of a scene.
#[derive(Clone, Copy)]
pub(super) struct Places {
    /// What is taken off all positions.
    pub origin: DVec3,
    /// Whether what stands in several places is kept once.
    pub keeps_instances: bool,
}

/// What it takes to make meshes of an OBJ's parts, and what is found on the way.
pub(super) struct Parts<'a> {
    sources: Sources<'a>,
    obj_text: &'a [u8],
    places: Places,
    cleaner: Cleaner,
    surfaces: Surfaces<'a>,
}

impl<'a> Parts<'a> {
    pub(super) fn new(
        sources: Sources<'a>,
        obj_text: &'a [u8],
        places: Places,
        options: &LoadOptions,
        pictures: Pictures,
    ) -> Self {
        Self {
            sources,
            obj_text,
            places,
            cleaner: Cleaner::new(sources.rules.dedupe),
            surfaces: Surfaces::new(sources, options, pictures),
        }
    }

    /// Reads the MTL files.
    pub(super) fn read_libraries(
        &mut self,
        obj: &Obj,
        scene: &mut Scene,
    ) -> Result<(), SceneError> {
        self.surfaces.read_libraries(obj, scene)
    }

    /// Adds a part and its material.
    pub(super) fn add(&mut self, part: &Part, scene: &mut Scene) -> Result<(), SceneError> {
        let Some((material, laid)) = self.surfaces.of(part, scene)? else { return Ok(()) };
        let [v, vt, vn] = part.unusable;
        if let Some(line) = v.or(vt.filter(|_| laid.is_some())).or(vn) {
            return Err(Obj::unusable(self.sources.obj_path, self.obj_text, line));
        }
        if laid.is_some_and(|laid| laid.takes_second) && part.second_coordinates.is_none() {
            return Err(self.without_second());
        }
        self.place(part, material, laid.as_ref(), scene)
    }

    /// Adds a part of this material in all of its places.
    fn place(
        &mut self,
        part: &Part,
        material: MaterialId,
        laid: Option<&Laid>,
        scene: &mut Scene,
    ) -> Result<(), SceneError> {
        let is_near = |place: DVec3| place.abs().max_element() <= MAX_COORDINATE;
        let Places { origin, keeps_instances } = self.places;
        let placements = self.sources.rules.placements(origin);
        if placements.iter().any(|placement| !placement.positions(part).all(is_near)) {
            return Err(self.too_far());
        }
        let instances = self.sources.rules.instances.as_deref().unwrap_or_default();
        let takes_colours = scene.materials[material.0 as usize].takes_colours();
        if part.has_colours() && !takes_colours {
            self.surfaces.note(part, Fate::WithoutEffect, "colours of vertices");
        }
        let mesh = |placement: &Placement| {
            let mut mesh = part.mesh(material, placement, laid);
            mesh.colours = mesh.colours.filter(|_| takes_colours);
            mesh
        };
        if !keeps_instances || !is_worth_keeping(part.triangle_count(), instances.len()) {
            for placement in &placements {
                let mut mesh = mesh(placement);
                self.cleaner.clean(&mut mesh);
                scene.add_mesh(mesh);
            }
            return Ok(());
        }
        let first = Placement { transform: self.sources.rules.transform, origin: DVec3::ZERO };
        let mut shape = mesh(&first);
        self.cleaner.clean(&mut shape);
        let taken_off = DAffine3::from_translation(-origin);
        let transforms: Vec<DAffine3> = instances.iter().map(|t| taken_off * *t).collect();
        scene.add_repeated(shape, &transforms);
        Ok(())
    }

    /// The error of a part without the second texture coordinates that a texture takes.
    fn without_second(&self) -> SceneError {
        let key = format!("{}file", self.sources.rules.place);
        let what = "has no second texture coordinates, which a texture of its material takes by \
                    `\"set\": \"second\"`: name a PLY whose vertices have s1 and t1 besides s and t";
        super::wrong_key(self.sources.names.scene, &key, what)
    }

    /// The error of a part that is too far away.
    fn too_far(&self) -> SceneError {
        let key = match (&self.sources.rules.instances, self.sources.rules.transform) {
            (Some(_), _) => "instances",
            (None, Some(_)) => "transform",
            (None, None) => {
                return Obj::too_far(self.sources.obj_path, self.obj_text, self.places.origin);
            }
        };
        let key = format!("{}{key}", self.sources.rules.place);
        let what = "moves the mesh too far from the rest of the scene";
        super::wrong_key(self.sources.names.scene, &key, what)
    }

    /// What the picture will show of the geometry that is not so.
    fn defects(&self, scene: &Scene) -> Vec<String> {
        let path = self.sources.obj_path.display();
        let glass = self.surfaces.names_of(&defects::glass_in_one_place(scene)).map(|names| {
            format!(
                "{path}: glass of {names} has faces in one place, where a ray cannot tell which \
                 body it is in: these make and lose light; move them apart a little."
            )
        });
        let coarse = self.surfaces.names_of(&defects::coarse_and_smooth(scene)).map(|names| {
            format!(
                "{path}: {names} is smooth by its normals, but of large triangles: the edge of its \
                 shadow side will follow them; use a finer mesh."
            )
        });
        glass.into_iter().chain(coarse).collect()
    }

    /// Says what the user should know of the parts as a whole, and hands back the pictures.
    pub(super) fn finish(self, obj: &Obj, scene: &mut Scene) -> Pictures {
        let path = self.sources.obj_path.display();
        let warnings = &mut scene.warnings;
        if let Some(materials) = self.surfaces.undescribed() {
            warnings.push(format!(
                "{path}: no MTL describes {materials}: diffuse grey of 0.5 is used."
            ));
        }
        let is_smooth = self.sources.rules.normals == Normals::Smooth;
        warnings.extend(super::remarks::of(obj, is_smooth).map(|what| format!("{path}: {what}.")));
        let Cleaner { degenerate, duplicates, .. } = self.cleaner;
        if degenerate > 0 {
            warnings.push(format!("{path}: {degenerate} triangles without area were dropped."));
        }
        if duplicates > 0 {
            warnings.push(format!(
                "{path}: {duplicates} triangles with the corners of another were dropped."
            ));
        }
        scene.warnings.extend(self.defects(scene));
        self.surfaces.finish(scene)
    }
}
