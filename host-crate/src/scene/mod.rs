//! Scenes as plain data, and the loaders that end there.
//!
//! A [`Scene`] is loaded from a [file](load) (a scene file with its OBJs, a glTF, an OBJ or a PLY),
//! from one of those that [ship](load_named), or built in code:
//!
//! ```
//! use glam::Vec3;
//! use raystream::scene::{Camera, FilmSize, Material, Mesh, QuadLight, Scene};
//!
//! let camera = Camera::new(Vec3::new(0.0, 1.0, 4.0), Vec3::ZERO, 40.0);
//! let mut scene = Scene::new(camera, FilmSize { width: 320, height: 240 });
//! let grey = scene.add_material(Material::diffuse(Vec3::splat(0.5)));
//! let floor = [(-2.0, 2.0), (2.0, 2.0), (2.0, -2.0), (-2.0, -2.0)];
//! let floor = floor.map(|(x, z)| Vec3::new(x, 0.0, z)).to_vec();
//! scene.add_mesh(Mesh::new(grey, floor, vec![[0, 1, 2], [0, 2, 3]]));
//! let corner = Vec3::new(-0.5, 3.0, -0.5);
//! scene.add_quad_light(QuadLight::new(corner, Vec3::X, Vec3::Z, Vec3::splat(10.0)));
//! scene.check()?;
//! # Ok::<(), raystream::scene::InvalidScene>(())
//! ```

mod bounds;
mod camera;
mod check;
mod clean;
mod description;
mod environment;
mod error;
mod film;
mod formats;
mod framing;
mod gltf;
pub(crate) mod instance;
mod json;
mod light;
mod limits;
mod load;
mod material;
mod memory;
pub(crate) mod mesh;
mod metal;
mod obj;
mod options;
mod picture;
mod ply;
mod radiances;
mod recentre;
mod rule;
mod shipped;
mod sky;
mod source;
mod studio;
mod summary;
mod text;
mod texture;

pub use camera::{Camera, Lens, NamedCamera, Projection};
pub use check::InvalidScene;
pub use description::Scene;
pub use environment::Environment;
pub use error::SceneError;
pub use film::FilmSize;
pub use instance::{Instance, ShapeId};
pub use light::{PunctualLight, QuadLight};
pub use limits::PathLimits;
pub use load::{embedded, load, load_named};
pub(crate) use material::distinct_ior;
pub use material::{
    Anisotropy, Attenuation, Body, BumpMap, Channel, Maps, Material, MaterialId, NormalMap,
    Opacity, Principled, Reflectance,
};
pub use mesh::Mesh;
pub use metal::{Conductor, Metal};
pub use options::{Instancing, LoadOptions};
pub use shipped::{DEFAULT_SCENE, SceneGeometry, ShippedScene, shipped};
pub use sky::Sky;
pub use texture::{CoordinateSet, Placement, Texels, Texture, TextureFilter, TextureId, Wrap};
