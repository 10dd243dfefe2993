//! What can go wrong in a render.

use crate::exec::ExecError;
use crate::scene::InvalidScene;

/// What can go wrong in a render.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum RenderError {
    /// The device failed.
    #[error(transparent)]
    Exec(#[from] ExecError),
    /// A checkpoint is of another render.
    #[error(
        "the checkpoint is of a picture of another size or by another integrator; go on from it \
         with the settings that it was made with"
    )]
    CheckpointDiffers,
    /// The parts of the scene do not fit together.
    #[error("the scene cannot be rendered: {0}")]
    Scene(#[from] InvalidScene),
}
