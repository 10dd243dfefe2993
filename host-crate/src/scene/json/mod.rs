//! Scene files of format 1: JSON that names an OBJ, and says what its materials are, what lights it
//! and where it is seen from.

mod clean;
mod format;
mod material;
mod values;

use self::clean::Cleaner;
use self::format::{Normals, SceneFile};
use self::material::FileMaterial;
use self::values::Object;
use super::description::Scene;
use super::error::{SceneError, list};
use super::material::Material;
use super::obj::mtl::{self, Described, Library};
use super::obj::{Obj, Part};
use super::picture::Pictures;
use super::rule::MaterialRule;
use super::source::{Disk, Source, environment, expand, portable};
use serde::de::Error as _;
use std::path::{Path, PathBuf};

/// Loads a scene file of format 1 with its OBJ, MTL and textures.
///
/// # Errors
///
/// When a file is missing or malformed, or a value out of range: the message names the file, the
/// place in it and what to do.
pub fn load(path: &Path) -> Result<Scene, SceneError> {
    load_from(&Disk, path)
}

/// Loads a scene whose files are in `source`.
pub(super) fn load_from(source: &dyn Source, path: &Path) -> Result<Scene, SceneError> {
    let file = SceneFile::parse(path, &source.read(path)?)?;
    let names = Names { source, scene: path };
    let obj_path = names.find("obj", &file.obj, &[parent(path)])?;
    let obj = Obj::parse(&obj_path, &source.read(&obj_path)?)?;
    check_overrides(path, &file, &obj)?;

    let mut scene = Scene::new(file.camera(), file.film());
    scene.name = file.name.clone();
    scene.limits = file.limits();
    let library = read_libraries(source, &obj_path, &obj, &mut scene.warnings)?;
    let mut parts = Parts {
        file: &file,
        names,
        obj_path: &obj_path,
        library,
        pictures: Pictures::default(),
        cleaner: Cleaner::new(file.dedupe),
        undescribed: Vec::new(),
        any_smooth: false,
    };
    for part in &obj.parts {
        parts.add(part, &mut scene)?;
    }
    parts.warn(&mut scene.warnings);
    scene.textures = parts.pictures.textures;
    add_quads(path, &file, &mut scene)?;
    if !scene.emits() {
        let path = path.display();
        scene.warnings.push(format!(
            "{path}: nothing emits light, the picture will be black; add `quads` or an emissive \
             material."
        ));
    }
    Ok(scene)
}

/// What it takes to make meshes of an OBJ's parts, and what is found on the way.
struct Parts<'a> {
    file: &'a SceneFile,
    names: Names<'a>,
    obj_path: &'a Path,
    library: Library,
    pictures: Pictures,
    cleaner: Cleaner,
    /// The materials that no MTL describes.
    undescribed: Vec<String>,
    /// Whether any part is smooth.
    any_smooth: bool,
}

impl Parts<'_> {
    /// Adds a part and its material.
    fn add(&mut self, part: &Part, scene: &mut Scene) -> Result<(), SceneError> {
        let rule = self.rule(part, &mut scene.warnings)?;
        let smooth = self.file.normals == Normals::Smooth && part.has_normals;
        self.any_smooth |= smooth;
        let (material, textured) = match rule {
            MaterialRule::Null => return Ok(()),
            MaterialRule::Plain(material) => (material, false),
            MaterialRule::Textured(texture) if part.has_texture_coordinates => {
                let texture = self.pictures.load(self.names.source, &texture)?;
                (Material::textured(texture), true)
            }
            MaterialRule::Textured(texture) => {
                return Err(SceneError::NoTextureCoordinates {
                    path: self.obj_path.to_owned(),
                    material: part.material.clone(),
                    texture,
                });
            }
        };
        let mut mesh = part.mesh(scene.add_material(material), smooth, textured);
        self.cleaner.clean(&mut mesh);
        scene.add_mesh(mesh);
        Ok(())
    }

    /// What a part's material is: by the scene file, or else by an MTL.
    fn rule(
        &mut self,
        part: &Part,
        warnings: &mut Vec<String>,
    ) -> Result<MaterialRule, SceneError> {
        if let Some(Object(FileMaterial(rule))) = self.file.materials.get(&part.material) {
            return self.names.with_found_texture(&part.material, rule, parent(self.obj_path));
        }
        match self.library.describe(&part.material, self.names.source).transpose()? {
            Some(Described { rule, warning }) => {
                warnings.extend(warning);
                Ok(rule)
            }
            None => {
                self.undescribed.push(part.material.clone());
                Ok(mtl::DEFAULT)
            }
        }
    }

    /// Says what the user should know of the parts as a whole.
    fn warn(&self, warnings: &mut Vec<String>) {
        let obj = self.obj_path.display();
        if !self.undescribed.is_empty() {
            let materials = list(&self.undescribed);
            warnings
                .push(format!("{obj}: no MTL describes {materials}: diffuse grey of 0.5 is used."));
        }
        if self.file.normals == Normals::Smooth && !self.any_smooth {
            warnings.push(format!(
                "{obj}: normals are to be smooth, but no material has a vn at every corner: they \
                 are flat."
            ));
        }
        let Cleaner { degenerate, duplicates, .. } = self.cleaner;
        if degenerate > 0 {
            warnings.push(format!("{obj}: {degenerate} triangles without area were dropped."));
        }
        if duplicates > 0 {
            warnings.push(format!(
                "{obj}: {duplicates} triangles with the corners of another were dropped."
            ));
        }
    }
}

fn add_quads(path: &Path, file: &SceneFile, scene: &mut Scene) -> Result<(), SceneError> {
    for (index, Object(quad)) in file.quads.iter().enumerate() {
        let light = quad.light();
        if !light.has_area() {
            let what = "u and v span no area: a quad needs two edges in different directions";
            return Err(SceneError::Json {
                path: path.to_owned(),
                key: format!("quads[{index}]"),
                source: serde_json::Error::custom(what),
            });
        }
        scene.add_quad_light(light);
    }
    Ok(())
}

fn parent(path: &Path) -> &Path {
    path.parent().unwrap_or(Path::new(""))
}

fn check_overrides(path: &Path, file: &SceneFile, obj: &Obj) -> Result<(), SceneError> {
    let used: Vec<_> = obj.parts.iter().map(|part| part.material.clone()).collect();
    let names: Vec<_> =
        file.materials.keys().filter(|name| !used.contains(name)).cloned().collect();
    if names.is_empty() {
        Ok(())
    } else {
        Err(SceneError::UnknownMaterials { path: path.to_owned(), names, used })
    }
}

fn read_libraries(
    source: &dyn Source,
    obj_path: &Path,
    obj: &Obj,
    warnings: &mut Vec<String>,
) -> Result<Library, SceneError> {
    let mut library = Library::default();
    for name in &obj.libraries {
        match source.find(parent(obj_path), &portable(name)) {
            Some(path) => library.add(&path, &source.read(&path)?),
            None => warnings.push(format!(
                "{}: the MTL file `{name}` that it names is not there.",
                obj_path.display()
            )),
        }
    }
    Ok(library)
}

/// Finds the files that a scene file names.
struct Names<'a> {
    source: &'a dyn Source,
    scene: &'a Path,
}

impl Names<'_> {
    /// The file that `text`, the value of `key`, names in the first of the folders that has it.
    fn find(&self, key: &str, text: &str, folders: &[&Path]) -> Result<PathBuf, SceneError> {
        let expanded = expand(text, environment).map_err(|name| SceneError::Variable {
            path: self.scene.to_owned(),
            key: key.to_owned(),
            name,
            text: text.to_owned(),
        })?;
        let name = portable(&expanded);
        folders.iter().find_map(|folder| self.source.find(folder, &name)).ok_or_else(|| {
            SceneError::Missing {
                path: self.scene.to_owned(),
                key: key.to_owned(),
                wanted: folders.last().map_or(name.clone(), |folder| folder.join(&name)),
            }
        })
    }

    /// The rule of `material`, its texture (if any) found beside the OBJ or the scene file.
    fn with_found_texture(
        &self,
        material: &str,
        rule: &MaterialRule,
        obj_folder: &Path,
    ) -> Result<MaterialRule, SceneError> {
        let MaterialRule::Textured(file) = rule else { return Ok(rule.clone()) };
        let key = format!("materials.{material}.reflectance.texture");
        let found = self.find(&key, &file.to_string_lossy(), &[obj_folder, parent(self.scene)])?;
        Ok(MaterialRule::Textured(found))
    }
}
