//! Meshes and materials of an OBJ's parts.

use super::choice::MaterialChoice;
use super::defects;
use super::format::{FileMesh, Normals, SceneFile};
use super::libraries;
use super::material::FileMaterial;
use super::names::Names;
use crate::scene::bounds::MAX_COORDINATE;
use crate::scene::clean::Cleaner;
use crate::scene::description::Scene;
use crate::scene::error::SceneError;
use crate::scene::material::{Material, MaterialId};
use crate::scene::obj::mtl::{self, Describer, Library};
use crate::scene::obj::texture_map::TextureMap;
use crate::scene::obj::{Obj, Part, Placement};
use crate::scene::options::{LoadOptions, is_worth_keeping};
use crate::scene::picture::Pictures;
use crate::scene::rule::{MaterialRule, Slot, TextureFile, TexturedRule};
use crate::scene::source::parent;
use crate::scene::summary::{Fate, Summary};
use crate::scene::text::Name;
use crate::scene::texture::TextureId;
use glam::{DAffine3, DVec3, Vec3};
use std::collections::{BTreeSet, HashMap};
use std::path::Path;

/// As Blender writes them.
const NORMALS: Fate = Fate::Judged("this bump map is a picture of normals and is read as one: ");
const UNREADABLE_BUMP: Fate = Fate::Becomes("these bump maps cannot be read and are left out: ");

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
    file: &'a SceneFile,
    rules: &'a FileMesh,
    names: Names<'a>,
    obj_path: &'a Path,
    obj_text: &'a [u8],
    places: Places,
    options: LoadOptions,
    library: Library,
    /// Whether vertices have colours.
    has_colours: bool,
    pictures: Pictures,
    cleaner: Cleaner,
    summary: Summary,
    /// The materials so far.
    surfaces: HashMap<Name, Surface>,
    /// The materials that no MTL describes.
    undescribed: Vec<String>,
}

/// What the triangles of a material are made of.
#[derive(Clone)]
enum Surface {
    /// Nothing: they are left out.
    Null,
    Plain(MaterialId),
    Textured(Box<Textured>),
}

/// A material with textures.
#[derive(Clone)]
struct Textured {
    /// What it is without them.
    material: Material,
    textures: Vec<(Slot, TextureId)>,
    map: TextureMap,
    /// Of triangles with texture coordinates, and of those without.
    materials: [Option<MaterialId>; 2],
}

impl<'a> Parts<'a> {
    pub(super) fn new(
        file: &'a SceneFile,
        rules: &'a FileMesh,
        names: Names<'a>,
        (obj_path, obj_text): (&'a Path, &'a [u8]),
        places: Places,
        options: &LoadOptions,
        pictures: Pictures,
    ) -> Self {
        Self {
            file,
            rules,
            names,
            obj_path,
            obj_text,
            places,
            options: options.clone(),
            library: Library::default(),
            has_colours: false,
            pictures,
            cleaner: Cleaner::new(rules.dedupe),
            summary: Summary::default(),
            surfaces: HashMap::new(),
            undescribed: Vec::new(),
        }
    }

    /// Reads the MTL files.
    pub(super) fn read_libraries(
        &mut self,
        obj: &Obj,
        scene: &mut Scene,
    ) -> Result<(), SceneError> {
        self.has_colours = obj.coloured > 0;
        self.library = libraries::read(
            self.names.source,
            self.obj_path,
            &obj.libraries,
            &self.options,
            &mut scene.warnings,
            &mut self.summary,
        )?;
        Ok(())
    }

    /// Adds a part and its material.
    pub(super) fn add(&mut self, part: &Part, scene: &mut Scene) -> Result<(), SceneError> {
        let surface = match self.surfaces.get(&part.material) {
            Some(surface) => surface.clone(),
            None => self.surface(&part.material, scene)?,
        };
        let (material, map, surface) = match surface {
            Surface::Null => (None, None, surface),
            Surface::Plain(id) => (Some(id), self.map_of_grain(id, part, scene), surface),
            Surface::Textured(mut textured) => {
                let has_coordinates = part.has_texture_coordinates;
                let id = self.textured_material(&mut textured, part, scene);
                (Some(id), has_coordinates.then_some(textured.map), Surface::Textured(textured))
            }
        };
        self.surfaces.insert(part.material.clone(), surface);
        let Some(material) = material else { return Ok(()) };
        let [v, vt, vn] = part.unusable;
        if let Some(line) = v.or(vt.filter(|_| map.is_some())).or(vn) {
            return Err(Obj::unusable(self.obj_path, self.obj_text, line));
        }
        self.place(part, material, map.as_ref(), scene)
    }

    /// Where texture coordinates lie that say along what a material without textures is rougher.
    fn map_of_grain(&mut self, id: MaterialId, part: &Part, scene: &Scene) -> Option<TextureMap> {
        if !scene.materials[id.0 as usize].has_grain() {
            return None;
        }
        if !part.has_texture_coordinates {
            let faces = if part.faces == 1 { "face" } else { "faces" };
            let thing = format!("{} {faces}", part.faces);
            let (line, name) = (part.first_line, part.material.to_string());
            self.summary.note(self.obj_path, line, Fate::WithoutGrain, &thing, &name);
            return None;
        }
        Some(TextureMap::default())
    }

    /// Adds a part of this material in all of its places.
    fn place(
        &mut self,
        part: &Part,
        material: MaterialId,
        map: Option<&TextureMap>,
        scene: &mut Scene,
    ) -> Result<(), SceneError> {
        let is_near = |place: DVec3| place.abs().max_element() <= MAX_COORDINATE;
        let Places { origin, keeps_instances } = self.places;
        let placements = self.rules.placements(origin);
        if placements.iter().any(|placement| !placement.positions(part).all(is_near)) {
            return Err(self.too_far());
        }
        let instances = self.rules.instances.as_deref().unwrap_or_default();
        let takes_colours = scene.materials[material.0 as usize].takes_colours();
        if part.has_colours() && !takes_colours {
            let (line, name) = (part.first_line, part.material.to_string());
            self.summary.note(
                self.obj_path,
                line,
                Fate::WithoutEffect,
                "colours of vertices",
                &name,
            );
        }
        let mesh = |placement: &Placement| {
            let mut mesh = part.mesh(material, placement, map);
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
        let first = Placement { transform: self.rules.transform, origin: DVec3::ZERO };
        let mut shape = mesh(&first);
        self.cleaner.clean(&mut shape);
        let taken_off = DAffine3::from_translation(-origin);
        let transforms: Vec<DAffine3> = instances.iter().map(|t| taken_off * *t).collect();
        scene.add_repeated(shape, &transforms);
        Ok(())
    }

    /// The error of a part that is too far away.
    fn too_far(&self) -> SceneError {
        let key = match (&self.rules.instances, self.rules.transform) {
            (Some(_), _) => "instances",
            (None, Some(_)) => "transform",
            (None, None) => {
                return Obj::too_far(self.obj_path, self.obj_text, self.places.origin);
            }
        };
        let key = format!("{}{key}", self.rules.place);
        let what = "moves the mesh too far from the rest of the scene";
        super::wrong_key(self.names.scene, &key, what)
    }

    /// The material of the triangles of a part: with the texture, or else of its mean colour.
    fn textured_material(
        &mut self,
        textured: &mut Textured,
        part: &Part,
        scene: &mut Scene,
    ) -> MaterialId {
        let Textured { material, textures, materials: [with, without], .. } = textured;
        if part.has_texture_coordinates {
            let add = |material, &(slot, texture): &(Slot, TextureId)| slot.with(material, texture);
            let material = textures.iter().fold(*material, add);
            return *with.get_or_insert_with(|| scene.add_material(material));
        }
        let faces = if part.faces == 1 { "face" } else { "faces" };
        let (line, thing) = (part.first_line, format!("{} {faces}", part.faces));
        let name = part.material.to_string();
        self.summary.note(self.obj_path, line, Fate::MeanOfTexture, &thing, &name);
        let add = |material, &(slot, texture): &(Slot, TextureId)| {
            slot.with_mean(material, &self.pictures.textures[texture.0 as usize])
        };
        let material = textures.iter().fold(*material, add);
        *without.get_or_insert_with(|| scene.add_material(material))
    }

    /// What a material is, by the scene file, or else by an MTL.
    fn surface(&mut self, name: &Name, scene: &mut Scene) -> Result<Surface, SceneError> {
        Ok(match self.rule(name)? {
            MaterialRule::Null => Surface::Null,
            MaterialRule::Plain(material) => Surface::Plain(scene.add_material(material)),
            MaterialRule::Textured(rule) => self.textured(name, &rule, scene)?,
        })
    }

    fn rule(&mut self, name: &Name) -> Result<MaterialRule, SceneError> {
        let obj_folder = parent(self.obj_path);
        let shown = name.to_string();
        let place = &self.rules.place;
        let own = self.rules.materials.get(&shown);
        let own = own.map(|choice| (format!("{place}materials.{shown}"), choice));
        let of_mesh =
            || self.rules.material.as_ref().map(|choice| (format!("{place}material"), choice));
        if let Some((key, choice)) = own.or_else(of_mesh) {
            let (key, FileMaterial(rule)) = match choice {
                MaterialChoice::Own(material) => (key, &**material),
                MaterialChoice::Named(name) => {
                    let Some(material) = self.file.materials.get(name) else {
                        let names: Vec<_> = self.file.materials.keys().cloned().collect();
                        let known = crate::scene::error::list(&names);
                        let what = format!("there is no material `{name}`; there are: {known}");
                        return Err(super::wrong_key(self.names.scene, &key, &what));
                    };
                    (format!("materials.{name}"), material)
                }
            };
            return self.names.with_found_textures(&key, rule, obj_folder);
        }
        let describer = Describer { library: &self.library, source: self.names.source, obj_folder };
        match describer.describe(name, &mut self.summary) {
            Some(rule) => rule,
            None => {
                self.undescribed.push(shown);
                // Vertices say what colour it has.
                let white = MaterialRule::Plain(Material::diffuse(Vec3::ONE));
                Ok(if self.has_colours { white } else { mtl::DEFAULT })
            }
        }
    }

    /// A material with textures; where an MTL names what cannot be read, what it says besides.
    fn textured(
        &mut self,
        name: &Name,
        rule: &TexturedRule,
        scene: &mut Scene,
    ) -> Result<Surface, SceneError> {
        let name = name.to_string();
        let mut material = rule.material;
        let mut textures = Vec::new();
        for TextureFile { slot, line, path, filter } in &rule.textures {
            let file = rule.otherwise.as_ref().map_or(self.names.scene, |o| o.mtl.as_path());
            match (self.pictures.load(self.names.source, path, *filter), &rule.otherwise) {
                (Ok(texture), otherwise) => {
                    let of_mtl = otherwise.is_some();
                    let slot = &match *slot {
                        Slot::Bump(height) if of_mtl && self.pictures.is_of_normals(texture) => {
                            let thing = path.display().to_string();
                            self.summary.note(file, *line, NORMALS, &thing, &name);
                            Slot::Normal(height)
                        }
                        slot => slot,
                    };
                    let is_colour = *slot == Slot::Colour && !material.has_holes();
                    if is_colour && self.pictures.has_alpha(texture) {
                        let thing = format!("alpha of {}", path.display());
                        self.summary.note(file, *line, Fate::Opaque, &thing, &name);
                    }
                    textures.push((*slot, texture));
                }
                (Err(error), Some(otherwise)) => {
                    let fate = match slot {
                        Slot::Emission => Fate::UnreadableEmission,
                        Slot::Bump(_) => UNREADABLE_BUMP,
                        _ => Fate::UnreadableTexture,
                    };
                    self.summary.note(file, *line, fate, &error.to_string(), &name);
                    material = slot.without(material, otherwise);
                }
                (Err(error), None) => return Err(error),
            }
        }
        if textures.is_empty() {
            return Ok(Surface::Plain(scene.add_material(material)));
        }
        let (map, materials) = (rule.map, [None; 2]);
        Ok(Surface::Textured(Box::new(Textured { material, textures, map, materials })))
    }

    /// What the picture will show of the geometry that is not so.
    fn defects(&self, scene: &Scene) -> Vec<String> {
        let of = |materials: BTreeSet<usize>| {
            let is_of = |id: &MaterialId| materials.contains(&(id.0 as usize));
            let is_named = |surface: &Surface| match surface {
                Surface::Null => false,
                Surface::Plain(id) => is_of(id),
                Surface::Textured(textured) => textured.materials.iter().flatten().any(is_of),
            };
            let named = self.surfaces.iter().filter(|(_, surface)| is_named(surface));
            let mut names: Vec<_> = named.map(|(name, _)| name.to_string()).collect();
            names.sort();
            (!names.is_empty()).then(|| crate::scene::error::list(&names))
        };
        let path = self.obj_path.display();
        let glass = of(defects::glass_in_one_place(scene)).map(|names| {
            format!(
                "{path}: glass of {names} has faces in one place, where a ray cannot tell which \
                 body it is in: these make and lose light; move them apart a little."
            )
        });
        let coarse = of(defects::coarse_and_smooth(scene)).map(|names| {
            format!(
                "{path}: {names} is smooth by its normals, but of large triangles: the edge of its \
                 shadow side will follow them; use a finer mesh."
            )
        });
        glass.into_iter().chain(coarse).collect()
    }

    /// Says what the user should know of the parts as a whole, and hands back the pictures.
    pub(super) fn finish(self, obj: &Obj, scene: &mut Scene) -> Pictures {
        let path = self.obj_path.display();
        let warnings = &mut scene.warnings;
        if !self.undescribed.is_empty() {
            let materials = crate::scene::error::list(&self.undescribed);
            warnings.push(format!(
                "{path}: no MTL describes {materials}: diffuse grey of 0.5 is used."
            ));
        }
        let is_smooth = self.rules.normals == Normals::Smooth;
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
        self.summary.finish(scene);
        self.pictures
    }
}
