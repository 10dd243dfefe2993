//! How a scene is loaded.

use crate::names::named;
use std::time::Duration;

/// How a scene is loaded.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct LoadOptions {
    /// Memory in bytes that a scene may take while it is loaded and made ready, by estimates that
    /// err on the high side; 8 GiB by default.
    ///
    /// It bounds all that is read: a file of geometry (OBJ, glTF with its buffers, PLY) may have a
    /// quarter of it, each picture an eighth, a scene file of format 1 and each MTL 1/128.
    pub max_memory: u64,
    /// What becomes of shapes that stand in several places.
    pub instancing: Instancing,
    /// The time at which the first animation of a glTF is shown, from its beginning; `None`: all
    /// stands as it does without animations.
    pub at: Option<Duration>,
    /// The variant of a glTF that is shown, by its name; `None`: the materials that its parts have
    /// without one.
    pub variant: Option<String>,
}

impl Default for LoadOptions {
    fn default() -> Self {
        Self { max_memory: 8 << 30, instancing: Instancing::default(), at: None, variant: None }
    }
}

/// What becomes of shapes that stand in several places. Pictures differ by roundings alone.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Instancing {
    /// They are repeated while all of them together have at most 2^20 triangles, else kept once:
    /// the default.
    #[default]
    Auto,
    /// They are kept once: this takes less memory, and rays more time.
    Always,
    /// They are repeated.
    Never,
}

named! {
    Instancing {
        Auto: "auto",
        Always: "always",
        Never: "never",
    }
}

/// So many triangles, some 200 MB on a device, are repeated for the time that it saves.
const MAX_REPEATED: u64 = 1 << 20;
/// Shapes of fewer triangles are repeated: an instance takes the memory of two or three.
const LEAST_TRIANGLES: usize = 16;

impl Instancing {
    /// Whether shapes are kept once where all that stand in several places make so many triangles.
    pub(super) fn keeps(self, repeated: u64) -> bool {
        match self {
            Self::Auto => repeated > MAX_REPEATED,
            Self::Always => true,
            Self::Never => false,
        }
    }
}

/// Whether a shape of so many triangles that stands in so many places is worth being kept once.
pub(super) fn is_worth_keeping(triangles: usize, places: usize) -> bool {
    places > 1 && triangles >= LEAST_TRIANGLES
}

impl LoadOptions {
    /// The most bytes of a scene file or an MTL.
    pub(super) fn text_bytes(&self) -> u64 {
        self.max_memory / 128
    }

    /// The most bytes of a file of geometry.
    pub(super) fn geometry_bytes(&self) -> u64 {
        self.max_memory / 4
    }

    /// The most bytes of a picture file.
    pub(super) fn picture_bytes(&self) -> u64 {
        self.max_memory / 8
    }
}
