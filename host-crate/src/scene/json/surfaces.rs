//! What the triangles of an OBJ's parts are made of.

use super::choice::MaterialChoice;
use super::format::{FileMesh, SceneFile};
use super::libraries;
use super::material::FileMaterial;
use super::names::Names;
use crate::scene::description::Scene;
use crate::scene::error::SceneError;
use crate::scene::material::{Material, MaterialId};
use crate::scene::obj::mtl::{self, Describer, Library};
use crate::scene::obj::texture_map::{Laid, TextureMap};
use crate::scene::obj::{Obj, Part};
use crate::scene::options::LoadOptions;
use crate::scene::picture::Pictures;
use crate::scene::rule::{MaterialRule, Slot, TextureFile, TexturedRule};
use crate::scene::source::parent;
use crate::scene::summary::{Fate, Summary};
use crate::scene::text::Name;
use crate::scene::texture::{CoordinateSet, TextureId};
use glam::Vec3;
use std::collections::{BTreeSet, HashMap};
use std::path::Path;

/// As Blender writes them.
const NORMALS: Fate = Fate::Judged("this bump map is a picture of normals and is read as one: ");
const UNREADABLE_BUMP: Fate = Fate::Becomes("these bump maps cannot be read and are left out: ");

/// Where it stands what a mesh is made of.
#[derive(Clone, Copy)]
pub(super) struct Sources<'a> {
    pub file: &'a SceneFile,
    pub rules: &'a FileMesh,
    pub names: Names<'a>,
    pub obj_path: &'a Path,
}

/// The materials of an OBJ's parts, and what is found while they are made.
pub(super) struct Surfaces<'a> {
    sources: Sources<'a>,
    options: LoadOptions,
    library: Library,
    /// Whether vertices have colours.
    has_colours: bool,
    pictures: Pictures,
    summary: Summary,
    /// The materials so far.
    surfaces: HashMap<Name, Surface>,
    /// The materials that no MTL describes.
    undescribed: Vec<String>,
}

/// What the triangles of a material are made of.
enum Surface {
    /// Nothing: they are left out.
    Null,
    Plain(MaterialId),
    Textured(Box<Textured>),
}

/// A material with textures.
struct Textured {
    /// What it is without them.
    material: Material,
    textures: Vec<(Slot, TextureId)>,
    laid: Laid,
    /// Of triangles with texture coordinates, and of those without.
    materials: [Option<MaterialId>; 2],
}

impl<'a> Surfaces<'a> {
    pub(super) fn new(sources: Sources<'a>, options: &LoadOptions, pictures: Pictures) -> Self {
        Self {
            sources,
            options: options.clone(),
            library: Library::default(),
            has_colours: false,
            pictures,
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
            self.sources.names.source,
            self.sources.obj_path,
            &obj.libraries,
            &self.options,
            &mut scene.warnings,
            &mut self.summary,
        )?;
        Ok(())
    }

    /// The material of a part, and how its texture coordinates lie if they count; none where the
    /// part is left out.
    pub(super) fn of(
        &mut self,
        part: &Part,
        scene: &mut Scene,
    ) -> Result<Option<(MaterialId, Option<Laid>)>, SceneError> {
        let mut surface = match self.surfaces.remove(&part.material) {
            Some(surface) => surface,
            None => self.surface(&part.material, scene)?,
        };
        let found = match &mut surface {
            Surface::Null => None,
            Surface::Plain(id) => Some((*id, self.map_of_grain(*id, part, scene))),
            Surface::Textured(textured) => {
                let laid = part.has_texture_coordinates.then_some(textured.laid);
                Some((self.textured_material(textured, part, scene), laid))
            }
        };
        self.surfaces.insert(part.material.clone(), surface);
        Ok(found)
    }

    /// Notes what becomes of something in a part.
    pub(super) fn note(&mut self, part: &Part, fate: Fate, thing: &str) {
        let name = part.material.to_string();
        self.summary.note(self.sources.obj_path, part.first_line, fate, thing, &name);
    }

    /// Where texture coordinates lie that say along what a material without textures is rougher.
    fn map_of_grain(&mut self, id: MaterialId, part: &Part, scene: &Scene) -> Option<Laid> {
        if !scene.materials[id.0 as usize].has_grain() {
            return None;
        }
        if !part.has_texture_coordinates {
            self.note(part, Fate::WithoutGrain, &faces_of(part));
            return None;
        }
        Some(Laid::default())
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
        self.note(part, Fate::MeanOfTexture, &faces_of(part));
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
        let obj_folder = parent(self.sources.obj_path);
        let shown = name.to_string();
        let place = &self.sources.rules.place;
        let own = self.sources.rules.materials.get(&shown);
        let own = own.map(|choice| (format!("{place}materials.{shown}"), choice));
        let of_mesh = || {
            self.sources.rules.material.as_ref().map(|choice| (format!("{place}material"), choice))
        };
        if let Some((key, choice)) = own.or_else(of_mesh) {
            let (key, FileMaterial(rule)) = match choice {
                MaterialChoice::Own(material) => (key, &**material),
                MaterialChoice::Named(name) => {
                    let Some(material) = self.sources.file.materials.get(name) else {
                        let names: Vec<_> = self.sources.file.materials.keys().cloned().collect();
                        let known = crate::scene::error::list(&names);
                        let what = format!("there is no material `{name}`; there are: {known}");
                        return Err(super::wrong_key(self.sources.names.scene, &key, &what));
                    };
                    (format!("materials.{name}"), material)
                }
            };
            return self.sources.names.with_found_textures(&key, rule, obj_folder);
        }
        let describer =
            Describer { library: &self.library, source: self.sources.names.source, obj_folder };
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
        for TextureFile { slot, line, path, filter, map, set } in &rule.textures {
            let file =
                rule.otherwise.as_ref().map_or(self.sources.names.scene, |o| o.mtl.as_path());
            match (self.pictures.load(self.sources.names.source, path, *filter), &rule.otherwise) {
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
                    textures.push((*slot, texture, (*map, *set)));
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
        let (laid, textures) = self.laid(textures);
        let materials = [None; 2];
        Ok(Surface::Textured(Box::new(Textured { material, textures, laid, materials })))
    }

    /// Where texture coordinates lie: as all textures do, or else where they are, and the textures
    /// lie by themselves.
    fn laid(
        &mut self,
        textures: Vec<(Slot, TextureId, (TextureMap, CoordinateSet))>,
    ) -> (Laid, Vec<(Slot, TextureId)>) {
        let map = textures.first().map_or_else(TextureMap::default, |(_, _, (map, _))| *map);
        if textures.iter().all(|(_, _, place)| *place == (map, CoordinateSet::First)) {
            return (
                Laid { map, takes_second: false },
                textures.into_iter().map(|(slot, texture, _)| (slot, texture)).collect(),
            );
        }
        let takes_second = textures.iter().any(|(_, _, (_, set))| *set == CoordinateSet::Second);
        let placed =
            |(slot, texture, (map, set)): (Slot, TextureId, (TextureMap, CoordinateSet))| {
                (slot, self.pictures.placed(texture, map.placement(set)))
            };
        (Laid { takes_second, ..Laid::default() }, textures.into_iter().map(placed).collect())
    }

    /// The names of the materials of these numbers, if there are any.
    pub(super) fn names_of(&self, materials: &BTreeSet<usize>) -> Option<String> {
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
    }

    /// The names of the materials that nothing describes, if there are any.
    pub(super) fn undescribed(&self) -> Option<String> {
        (!self.undescribed.is_empty()).then(|| crate::scene::error::list(&self.undescribed))
    }

    /// Says what was noted, and hands back the pictures.
    pub(super) fn finish(self, scene: &mut Scene) -> Pictures {
        self.summary.finish(scene);
        self.pictures
    }
}

/// How many faces a part has.
fn faces_of(part: &Part) -> String {
    let faces = if part.faces == 1 { "face" } else { "faces" };
    format!("{} {faces}", part.faces)
}
