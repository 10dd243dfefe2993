//! How much memory loading a scene may take.

/// How a scene is loaded.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct LoadOptions {
    /// Memory in bytes that a scene may take while it is loaded and made ready, by estimates that
    /// err on the high side; 8 GiB by default.
    ///
    /// It bounds all that is read: a file of geometry (OBJ, glTF with its buffers, PLY) may have a
    /// quarter of it, each picture an eighth, a scene file of format 1 and each MTL 1/128.
    pub max_memory: u64,
}

impl Default for LoadOptions {
    fn default() -> Self {
        Self { max_memory: 8 << 30 }
    }
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
