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
    /// The parts of the scene do not fit together.
    #[error("the scene cannot be rendered: {0}")]
    Scene(#[from] InvalidScene),
}
