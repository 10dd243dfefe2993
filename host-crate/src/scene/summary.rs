//! What files say and the picture does not show, gathered so that it is said once.

use super::description::Scene;
use super::error::list;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// What becomes of something that a file says.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Fate {
    MissingTexture,
    UnreadableTexture,
    MissingEmission,
    UnreadableEmission,
    FoundByEnd,
    MeanOfTexture,
    WithoutGrain,
    Opaque,
    Unlit,
    Unfiltered,
    WithoutEffect,
    DefinedAgain,
    /// What these words say becomes of it.
    Becomes(&'static str),
    /// Said among the details only: it changes no picture that follows the laws of light, or is a
    /// judgement that most files need.
    Judged(&'static str),
}

impl Fate {
    /// What to say before the list of things.
    fn in_words(self) -> &'static str {
        match self {
            Self::MissingTexture => {
                "these textures are not there, plain colours are used instead: "
            }
            Self::UnreadableTexture => {
                "these textures cannot be read, plain colours are used instead: "
            }
            Self::MissingEmission => {
                "these textures of emission are not there, the radiance Ke is used instead: "
            }
            Self::UnreadableEmission => {
                "these textures of emission cannot be read, the radiance Ke is used instead: "
            }
            Self::FoundByEnd => {
                "these paths lead nowhere, files of these names beside it are used: "
            }
            Self::MeanOfTexture => {
                "faces without usable texture coordinates show the mean of their texture: "
            }
            Self::WithoutGrain => {
                "without texture coordinates nothing says along what these are rougher, they are \
                 alike in all directions: "
            }
            Self::Opaque => "opacity is left out, these surfaces are opaque: ",
            Self::Unlit => "emission by a texture is left out: ",
            Self::Unfiltered => "the filter of glass is left out, it is clear: ",
            Self::WithoutEffect => "these have no effect here: ",
            Self::DefinedAgain => "materials are defined again, the first definition counts: ",
            Self::Becomes(what) | Self::Judged(what) => what,
        }
    }
}

/// Names of materials, the first few of many.
type Names = Vec<String>;

/// At most this many names and details are kept.
const MAX_NAMES: usize = 64;
const MAX_DETAILS: usize = 10_000;
/// At most this many things are told apart in a sentence.
const MAX_THINGS: usize = 16;

/// Gathers what is left out.
#[derive(Default)]
pub(super) struct Summary {
    things: BTreeMap<(PathBuf, Fate), BTreeMap<String, Names>>,
    details: Vec<String>,
}

impl Summary {
    /// Notes that something has this fate, for a material: in a line (from 1; 0 if unknown) of a
    /// file.
    pub(super) fn note(
        &mut self,
        file: &Path,
        line: usize,
        fate: Fate,
        thing: &str,
        material: &str,
    ) {
        let before = fate.in_words();
        if self.details.len() < MAX_DETAILS {
            let line = if line > 0 { format!(", line {line}") } else { String::new() };
            let file = file.display();
            self.details.push(format!("{file}{line}: material `{material}`: {before}`{thing}`"));
        }
        if matches!(fate, Fate::Judged(_)) {
            return;
        }
        let things = self.things.entry((file.to_owned(), fate)).or_default();
        let names = things.entry(thing.to_owned()).or_default();
        if names.len() < MAX_NAMES && !names.iter().any(|name| name == material) {
            names.push(material.to_owned());
        }
    }

    /// A sentence for each file and fate, and every detail.
    pub(super) fn finish(self, scene: &mut Scene) {
        for ((file, fate), things) in &self.things {
            let (file, before) = (file.display(), fate.in_words());
            scene.warnings.push(format!("{file}: {before}{}.", in_words(things)));
        }
        scene.details.extend(self.details);
    }
}

fn in_words(things: &BTreeMap<String, Names>) -> String {
    let shown: Vec<_> = things
        .iter()
        .take(MAX_THINGS)
        .map(|(thing, names)| format!("`{thing}` of {}", list(names)))
        .collect();
    match things.len().saturating_sub(MAX_THINGS) {
        0 => shown.join("; "),
        more => format!("{}; and {more} more", shown.join("; ")),
    }
}
