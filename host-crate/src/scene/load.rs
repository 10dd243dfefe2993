//! From the scene file to the [`Scene`].

use super::error::list;
use super::format::{Normals, SceneFile};
use super::geometry::{Geometry, Wanted};
use super::mtl::{self, Described, Library};
use super::obj::{Obj, Part};
use super::rule::{Albedo, MaterialRule};
use super::source::{Disk, Source, environment, expand, portable};
use super::texture::Textures;
use super::values::{Object, Radiance, Reflectance};
use super::{Scene, SceneError};
use glam::Vec3;
use raystream_shaders::scene::bsdf::{Material, MaterialKind};
use raystream_shaders::scene::texture::NO_TEXTURE;
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

    let mut warnings = Vec::new();
    let library = read_libraries(source, &obj_path, &obj, &mut warnings)?;
    let mut geometry = Geometry::new(file.dedupe);
    let mut textures = Textures::new();
    let mut materials = Vec::new();
    let mut undescribed = Vec::new();
    let mut any_smooth = false;
    for part in &obj.parts {
        let rule = match file.materials.get(&part.material) {
            Some(Object(rule)) => {
                names.with_found_texture(&part.material, rule, parent(&obj_path))?
            }
            None => match library.describe(&part.material, source).transpose()? {
                Some(Described { rule, warning }) => {
                    warnings.extend(warning);
                    rule
                }
                None => {
                    undescribed.push(part.material.clone());
                    mtl::DEFAULT
                }
            },
        };
        let smooth = file.normals == Normals::Smooth && part.has_normals;
        any_smooth |= smooth;
        let textured = textured(&obj_path, part, &rule)?;
        if let Some(material) = device_material(&rule, source, &mut textures)? {
            geometry.add_part(
                part,
                materials.len() as u32,
                Wanted { normals: smooth, texture_coordinates: textured },
            );
            materials.push(material);
        }
    }
    for (index, Object(quad)) in file.quads.iter().enumerate() {
        if !geometry.add_quad(quad, materials.len() as u32) {
            let what = "u and v span no area: a quad needs two edges in different directions";
            let source = serde_json::Error::custom(what);
            return Err(SceneError::Json {
                path: path.to_owned(),
                key: format!("quads[{index}]"),
                source,
            });
        }
        materials.push(emissive(quad.radiance, Reflectance(Vec3::ZERO)));
    }

    if !undescribed.is_empty() {
        let obj = obj_path.display();
        warnings.push(format!(
            "{obj}: no MTL describes {}: diffuse grey of 0.5 is used.",
            list(&undescribed)
        ));
    }
    if file.normals == Normals::Smooth && !any_smooth {
        let obj = obj_path.display();
        warnings
            .push(format!("{obj}: normals are to be smooth, but no material has a vn at every corner: they are flat."));
    }
    if geometry.degenerate > 0 {
        warnings.push(format!(
            "{}: {} triangles without area were dropped.",
            obj_path.display(),
            geometry.degenerate
        ));
    }
    if geometry.duplicates > 0 {
        let obj = obj_path.display();
        warnings.push(format!(
            "{obj}: {} triangles with the corners of another were dropped.",
            geometry.duplicates
        ));
    }
    if !geometry.triangles.iter().any(|triangle| materials[triangle.material as usize].emits()) {
        let scene = path.display();
        warnings.push(format!(
            "{scene}: nothing emits light, the picture will be black; add `quads` or an emissive material."
        ));
    }
    Ok(Scene {
        film: file.film(),
        camera: file.camera(),
        limits: file.limits(),
        name: file.name,
        triangles: geometry.triangles,
        attributes: geometry.attributes,
        materials,
        texels: textures.into_words(),
        warnings,
    })
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

/// Whether a part has a texture, and the coordinates that this takes.
fn textured(obj_path: &Path, part: &Part, rule: &MaterialRule) -> Result<bool, SceneError> {
    match rule {
        MaterialRule::Diffuse(Albedo::Texture(_)) if part.has_texture_coordinates => Ok(true),
        MaterialRule::Diffuse(Albedo::Texture(texture)) => Err(SceneError::NoTextureCoordinates {
            path: obj_path.to_owned(),
            material: part.material.clone(),
            texture: texture.clone(),
        }),
        _ => Ok(false),
    }
}

/// The material as the kernels read it; `None` for one whose triangles are dropped.
fn device_material(
    rule: &MaterialRule,
    source: &dyn Source,
    textures: &mut Textures,
) -> Result<Option<Material>, SceneError> {
    let plain = Material { ior: 1.0, texture: NO_TEXTURE, ..Material::default() };
    let material = match rule {
        MaterialRule::Null => return Ok(None),
        MaterialRule::Diffuse(Albedo::Colour(reflectance)) => {
            Material { kind: MaterialKind::DIFFUSE, reflectance: reflectance.0, ..plain }
        }
        MaterialRule::Diffuse(Albedo::Texture(path)) => Material {
            kind: MaterialKind::DIFFUSE,
            reflectance: Vec3::ONE,
            texture: textures.load(source, path)?,
            ..plain
        },
        MaterialRule::Mirror(reflectance) => {
            Material { kind: MaterialKind::MIRROR, reflectance: reflectance.0, ..plain }
        }
        MaterialRule::Dielectric { ior, transmittance, reflectance } => Material {
            kind: MaterialKind::DIELECTRIC,
            reflectance: reflectance.0,
            transmittance: transmittance.0,
            ior: ior.0,
            ..plain
        },
        MaterialRule::Emissive { radiance, reflectance } => emissive(*radiance, *reflectance),
    };
    Ok(Some(material))
}

fn emissive(radiance: Radiance, reflectance: Reflectance) -> Material {
    Material {
        kind: MaterialKind::DIFFUSE,
        reflectance: reflectance.0,
        emission: radiance.0,
        texture: NO_TEXTURE,
        ior: 1.0,
        ..Material::default()
    }
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
        let MaterialRule::Diffuse(Albedo::Texture(file)) = rule else { return Ok(rule.clone()) };
        let key = format!("materials.{material}.reflectance.texture");
        let found = self.find(&key, &file.to_string_lossy(), &[obj_folder, parent(self.scene)])?;
        Ok(MaterialRule::Diffuse(Albedo::Texture(found)))
    }
}
