//! Finds the files that a scene file names.

use super::material::key_of;
use crate::scene::error::SceneError;
use crate::scene::rule::{MaterialRule, TextureFile, TexturedRule};
use crate::scene::source::{Source, environment, expand, portable};
use std::path::{Path, PathBuf};

/// Finds the files that a scene file names.
#[derive(Clone, Copy)]
pub(super) struct Names<'a> {
    pub source: &'a dyn Source,
    /// The scene file, for messages.
    pub scene: &'a Path,
    /// The folder that its paths start from.
    pub folder: &'a Path,
}

impl Names<'_> {
    /// The file that `text`, the value of `key`, names in the first of the folders that has it.
    pub(super) fn find(
        &self,
        key: &str,
        text: &str,
        folders: &[&Path],
    ) -> Result<PathBuf, SceneError> {
        let expanded = expand(text, environment).map_err(|name| SceneError::Variable {
            path: self.scene.to_owned(),
            key: key.to_owned(),
            name,
            text: text.to_owned(),
        })?;
        let name = portable(&expanded);
        folders.iter().find_map(|folder| self.source.find(folder, &name)).ok_or_else(|| {
            let wanted = folders.last().map_or(name.clone(), |folder| folder.join(&name));
            let (path, key) = (self.scene.to_owned(), key.to_owned());
            match folders.iter().map(|folder| folder.join(&name)).find(|path| path.is_dir()) {
                Some(folder) if !text.is_empty() => SceneError::Folder { path, key, folder },
                _ => SceneError::Missing { path, key, wanted },
            }
        })
    }

    /// The rule of the material that stands behind `key`, its textures (if any) found beside the
    /// OBJ or the scene file.
    pub(super) fn with_found_textures(
        &self,
        key: &str,
        rule: &MaterialRule,
        obj_folder: &Path,
    ) -> Result<MaterialRule, SceneError> {
        let MaterialRule::Textured(textured) = rule else { return Ok(rule.clone()) };
        let find = |file: &TextureFile| {
            let key = format!("{key}.{}", key_of(file.slot));
            let path = self.find(&key, &file.path.to_string_lossy(), &[obj_folder, self.folder])?;
            Ok(TextureFile { path, ..*file })
        };
        let textures = textured.textures.iter().map(find).collect::<Result<_, SceneError>>()?;
        Ok(MaterialRule::Textured(TexturedRule { textures, ..textured.clone() }))
    }
}
