//! What can go wrong in a render.

use crate::exec::ExecError;
use crate::scene::InvalidScene;
use raystream_shaders::scene::bvh::MAX_DEPTH;

/// What can go wrong in a render.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum RenderError {
    /// The device failed.
    #[error(transparent)]
    Exec(#[from] ExecError),
    /// The parts of the scene do not fit together.
    #[error("the scene cannot be rendered: {0}")]
    Scene(#[from] InvalidScene),
    /// The BVH does not fit the traversal's stack.
    #[error(
        "the geometry nests {depth} levels deep and the traversal handles {MAX_DEPTH}: it has \
         many triangles of sizes that differ by orders of magnitude in one place; scale or split \
         them"
    )]
    TooDeep {
        /// Nodes on the longest path.
        depth: u32,
    },
}
