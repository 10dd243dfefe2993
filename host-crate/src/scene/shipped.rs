//! The scenes that ship with the program.

use super::description::Scene;
use super::error::SceneError;
use super::formats::load_from;
use super::options::LoadOptions;
use super::source::{Disk, Source};
use raystream_scenes::FILES;
use std::path::{Component, Path, PathBuf};

/// A scene that ships, called by its name.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ShippedScene {
    /// What the scene is called on the command line.
    pub name: &'static str,
    /// What there is to see, in one line.
    pub description: &'static str,
    /// Where its geometry comes from.
    pub geometry: SceneGeometry,
}

/// Where the geometry of a scene that ships comes from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SceneGeometry {
    /// It is part of the program.
    BuiltIn,
    /// It is fetched by the user, once, to the folder that the variable `SCENES_DIR` names.
    Download {
        /// The page to fetch it from.
        url: &'static str,
        /// Who made it, and on which terms it may be used.
        credits: &'static str,
    },
}

const ARCHIVE: &str = "https://casual-effects.com/data/";

/// The scene that is rendered when none is named.
pub const DEFAULT_SCENE: &str = "cornell_ball";

const SHIPPED: [ShippedScene; 9] = [
    ShippedScene {
        name: DEFAULT_SCENE,
        description: "Cornell box with a block and a mirror ball",
        geometry: SceneGeometry::BuiltIn,
    },
    ShippedScene {
        name: "cornell_glass",
        description: "Cornell box with a block and a glass ball, which throws a caustic",
        geometry: SceneGeometry::BuiltIn,
    },
    ShippedScene {
        name: "opening",
        description: "Box lit through a small opening in its ceiling: what is seen is lit by a spot on the floor behind the camera",
        geometry: SceneGeometry::BuiltIn,
    },
    ShippedScene {
        name: "caustics",
        description: "Cornell box lit only by a lamp inside a glass ball: all light is a caustic, or comes from one",
        geometry: SceneGeometry::BuiltIn,
    },
    ShippedScene {
        name: "tea",
        description: "Iced tea in a glass, on linen, with copper and gold: bodies that overlap, by priority",
        geometry: SceneGeometry::BuiltIn,
    },
    ShippedScene {
        name: "metals",
        description: "Metals as they have been measured, and lacquer, under an afternoon's sky",
        geometry: SceneGeometry::BuiltIn,
    },
    ShippedScene {
        name: "daylight",
        description: "Velvet, glass, frosted glass and amber under a low sun, through a lens",
        geometry: SceneGeometry::BuiltIn,
    },
    ShippedScene {
        name: "sibenik",
        description: "Nave of the cathedral of Sibenik under four lamps, textured",
        geometry: SceneGeometry::Download {
            url: ARCHIVE,
            credits: "(c) 2002 Marko Dabrovic, CC BY-NC",
        },
    },
    ShippedScene {
        name: "conference",
        description: "Conference room under eight ceiling lamps",
        geometry: SceneGeometry::Download {
            url: ARCHIVE,
            credits: "Anat Grynberg and Greg Ward, public domain",
        },
    },
];

/// The scenes that ship, in the order in which to list them.
pub fn shipped() -> &'static [ShippedScene] {
    &SHIPPED
}

/// Loads the scene that ships under the name `name`.
pub(super) fn load(name: &str, options: &LoadOptions) -> Result<Scene, SceneError> {
    if SHIPPED.iter().any(|scene| scene.name == name) {
        let path = Path::new(ROOT).join(name).join(name).with_extension("json");
        load_from(&BuiltIn, &path, options)
    } else {
        let known = SHIPPED.iter().map(|scene| scene.name.to_owned()).collect();
        Err(SceneError::UnknownName { name: name.to_owned(), known })
    }
}

/// Stands for the folder of the built-in files in messages.
const ROOT: &str = "<built-in scenes>";

/// The files that are part of the program; then those of the disk, relative to the working
/// directory.
struct BuiltIn;

impl Source for BuiltIn {
    fn find(&self, folder: &Path, name: &Path) -> Option<PathBuf> {
        let path = without_dots(&folder.join(name));
        match bytes_of(&path) {
            Some(_) => Some(path),
            None if folder.starts_with(ROOT) => Disk.find(Path::new(""), name),
            None => Disk.find(folder, name),
        }
    }

    fn read(&self, path: &Path, limit: u64) -> Result<Vec<u8>, SceneError> {
        bytes_of(path).map_or_else(|| Disk.read(path, limit), |bytes| Ok(bytes.to_vec()))
    }
}

fn bytes_of(path: &Path) -> Option<&'static [u8]> {
    let below_root = path.strip_prefix(ROOT).ok()?;
    FILES.iter().find(|(file, _)| Path::new(file) == below_root).map(|(_, bytes)| *bytes)
}

/// The path with each `..` and the component before it left out.
fn without_dots(path: &Path) -> PathBuf {
    path.components().fold(PathBuf::new(), |mut folded, component| {
        match component {
            Component::ParentDir if folded.file_name().is_some() => {
                folded.pop();
            }
            other => folded.push(other),
        }
        folded
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_scene_has_its_file() {
        for scene in shipped() {
            let file = format!("{0}/{0}.json", scene.name);
            assert!(FILES.iter().any(|(name, _)| *name == file), "{file} is not built in");
        }
    }

    #[test]
    fn paths_are_folded() {
        assert_eq!(without_dots(Path::new("r/a/../b/./c")), Path::new("r/b/c"));
        assert_eq!(without_dots(Path::new("../a")), Path::new("../a"));
    }
}
