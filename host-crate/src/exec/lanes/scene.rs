//! What paths in lanes go through.

use glam::UVec4;
use raystream_shaders::integrator::params::PathParams;
use raystream_shaders::scene::SceneView;
use raystream_shaders::scene::abilities::{BASIC, Fixed};

/// A scene that uses no more than the basic abilities.
#[derive(Clone, Copy)]
pub struct Scene<'a> {
    /// The scene.
    pub view: SceneView<'a, Fixed<BASIC>>,
    /// Its buffer of that name.
    pub geometry: &'a [UVec4],
    /// Its buffer of that name.
    pub texels: &'a [u32],
    /// What is the same for all paths.
    pub params: &'a PathParams,
}
