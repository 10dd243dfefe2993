//! A triangle of a scene, before it is brought into the layout of a device.

use glam::Vec3;

/// A triangle of a scene.
#[derive(Clone, Copy, Debug)]
pub struct SceneTriangle {
    /// Its corners in world units, counter-clockwise as seen from the front; of a shape's, in units
    /// of the shape.
    pub corners: [Vec3; 3],
    /// Index into the materials.
    pub material: u32,
    /// Index into the attributes, or
    /// [`NO_ATTRIBUTES`](raystream_shaders::scene::triangle::NO_ATTRIBUTES).
    pub attributes: u32,
    /// Its number in the scene, or in its shape.
    pub number: u32,
}
