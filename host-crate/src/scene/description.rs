//! A scene as plain data.

use super::camera::{Camera, NamedCamera};
use super::environment::{Environment, LIT_BY_DEFAULT};
use super::error::SceneError;
use super::film::FilmSize;
use super::instance::{Instance, ShapeId, is_well_conditioned, may_have_instances};
use super::light::{PunctualLight, QuadLight};
use super::limits::PathLimits;
use super::material::{Body, Material, MaterialId};
use super::mesh::Mesh;
use super::texture::{Texture, TextureId};
use glam::{DAffine3, DVec3, Vec3};

/// How warnings end of scenes in which nothing emits light.
pub(super) const DARK: &str = "nothing emits light, the picture will be black; add `quads`, an \
    emissive material or an environment.";

/// A scene: plain data that loaders end at, and that
/// [`PreparedScene`](crate::render::PreparedScene) brings into the layout of a device.
///
/// All fields may be changed at will; [`Scene::check`] says whether they fit together.
#[derive(Clone, Debug, PartialEq)]
pub struct Scene {
    /// What the scene is called.
    pub name: String,
    /// Picture size in pixels.
    pub film: FilmSize,
    /// The camera.
    pub camera: Camera,
    /// The cameras that may take its place, see [`Scene::use_camera`].
    pub cameras: Vec<NamedCamera>,
    /// The names of the variants of its materials that the file has; [`LoadOptions::variant`] says
    /// which one is shown.
    ///
    /// [`LoadOptions::variant`]: super::LoadOptions::variant
    pub variants: Vec<String>,
    /// How long paths may be.
    pub limits: PathLimits,
    /// Radiance from where there is no surface, linear Rec.709, each component in [0, 1e12].
    pub background: Vec3,
    /// A picture of light from all around, which comes on top of the background.
    pub environment: Option<Environment>,
    /// The surfaces.
    pub meshes: Vec<Mesh>,
    /// Surfaces in spaces of their own, which are there where [`instances`](Self::instances) place
    /// them. Coordinates are within [-1e9, 1e9].
    pub shapes: Vec<Mesh>,
    /// Where shapes stand. Together they have at most 2^32 - 1 triangles, those of meshes counted.
    ///
    /// A shape is once in memory, whatever the number of its instances, unless it emits light or is
    /// flattened by its transform.
    pub instances: Vec<Instance>,
    /// The lamps that are no meshes.
    pub quad_lights: Vec<QuadLight>,
    /// The lights that have no surface.
    pub punctual_lights: Vec<PunctualLight>,
    /// The materials; [`Mesh::material`] points here.
    pub materials: Vec<Material>,
    /// The textures; [`Reflectance::Texture`](super::Reflectance::Texture) points here.
    pub textures: Vec<Texture>,
    /// What the user should know of (no light, dropped triangles ...), one sentence each.
    pub warnings: Vec<String>,
    /// Each thing that a file says and the picture does not show: what `warnings` sum up.
    pub details: Vec<String>,
}

impl Scene {
    /// A scene of nothing before a black background, seen by `camera` in a picture of `film`'s
    /// size.
    pub fn new(camera: Camera, film: FilmSize) -> Self {
        Self {
            name: "scene".to_owned(),
            film,
            camera,
            cameras: Vec::new(),
            variants: Vec::new(),
            limits: PathLimits::default(),
            background: Vec3::ZERO,
            environment: None,
            meshes: Vec::new(),
            shapes: Vec::new(),
            instances: Vec::new(),
            quad_lights: Vec::new(),
            punctual_lights: Vec::new(),
            materials: Vec::new(),
            textures: Vec::new(),
            warnings: Vec::new(),
            details: Vec::new(),
        }
    }

    /// Adds a material for meshes to be made of.
    pub fn add_material(&mut self, material: Material) -> MaterialId {
        self.materials.push(material);
        MaterialId(self.materials.len() as u32 - 1)
    }

    /// Adds a texture for materials to use.
    pub fn add_texture(&mut self, texture: Texture) -> TextureId {
        self.textures.push(texture);
        TextureId(self.textures.len() as u32 - 1)
    }

    /// Adds surfaces.
    pub fn add_mesh(&mut self, mesh: Mesh) {
        self.meshes.push(mesh);
    }

    /// Adds surfaces for instances to place.
    pub fn add_shape(&mut self, shape: Mesh) -> ShapeId {
        self.shapes.push(shape);
        ShapeId(self.shapes.len() as u32 - 1)
    }

    /// Places a shape.
    pub fn add_instance(&mut self, shape: ShapeId, transform: DAffine3) {
        self.instances.push(Instance { shape, transform });
    }

    /// Places surfaces several times: as instances where that is possible, else as meshes.
    pub(super) fn add_repeated(&mut self, shape: Mesh, transforms: &[DAffine3]) {
        let is_lamp = !may_have_instances(&self.materials[shape.material.0 as usize]);
        let is_kept = |transform: &DAffine3| !is_lamp && is_well_conditioned(transform);
        let flattened = transforms.iter().filter(|transform| !is_kept(transform));
        self.meshes.extend(flattened.map(|transform| shape.moved(transform)));
        if transforms.iter().any(is_kept) {
            let shape = self.add_shape(shape);
            let kept = transforms.iter().filter(|transform| is_kept(transform));
            kept.for_each(|&transform| self.add_instance(shape, transform));
        }
    }

    /// The same scene with a mesh for each instance. Pictures of it differ by roundings alone.
    ///
    /// # Panics
    ///
    /// When an instance's shape is not there.
    pub fn without_instances(&self) -> Self {
        let mut flat = self.clone();
        let mesh = |instance: &Instance| instance.mesh(&self.shapes[instance.shape.0 as usize]);
        flat.meshes.extend(self.instances.iter().map(mesh));
        (flat.shapes, flat.instances) = (Vec::new(), Vec::new());
        flat
    }

    /// Adds a lamp.
    pub fn add_quad_light(&mut self, light: QuadLight) {
        self.quad_lights.push(light);
    }

    /// Has the camera of this name make the picture, in the size that it asks for.
    ///
    /// # Errors
    ///
    /// When [`cameras`](Self::cameras) has none of that name.
    pub fn use_camera(&mut self, name: &str) -> Result<(), SceneError> {
        let Some(found) = self.cameras.iter().find(|camera| camera.name == name) else {
            let known = self.cameras.iter().map(|camera| camera.name.clone()).collect();
            return Err(SceneError::UnknownCamera { name: name.to_owned(), known });
        };
        self.camera = found.camera;
        self.film = found.film;
        Ok(())
    }

    /// Adds a light without a surface.
    pub fn add_punctual_light(&mut self, light: PunctualLight) {
        self.punctual_lights.push(light);
    }

    /// Has an environment light it, in place of the one that there may be. If that emits, warnings
    /// that nothing does are taken back.
    pub fn set_environment(&mut self, environment: Environment) {
        self.warnings.retain(|warning| !warning.ends_with(LIT_BY_DEFAULT));
        if environment.emits() {
            self.warnings.retain(|warning| !warning.ends_with(DARK));
        }
        self.environment = Some(environment);
    }

    /// Whether paths must know what they are in: whether any body absorbs light or has a priority.
    pub fn has_media(&self) -> bool {
        let matters = |body: Body| body.priority.is_some() || body.absorption != Vec3::ZERO;
        self.materials.iter().filter_map(Material::body).any(matters)
    }

    /// Its bodies, those without a priority first. Materials that are alike in all that a body is
    /// bound one.
    pub(crate) fn bodies(&self) -> Vec<Body> {
        let mut bodies: Vec<Body> = self.materials.iter().filter_map(Material::body).collect();
        bodies.sort_by_key(Body::key);
        bodies.dedup_by_key(|body| body.key());
        bodies
    }

    /// How many triangles it has, those of all instances and two for each quad light included.
    pub fn triangle_count(&self) -> usize {
        let of_meshes: usize = self.meshes.iter().map(|mesh| mesh.triangles.len()).sum();
        let of_instances: usize = self.placed_shapes().map(|shape| shape.triangles.len()).sum();
        of_meshes + of_instances + 2 * self.quad_lights.len()
    }

    /// The shape of each instance, as far as it is there.
    fn placed_shapes(&self) -> impl Iterator<Item = &Mesh> {
        self.instances.iter().filter_map(|instance| self.shapes.get(instance.shape.0 as usize))
    }

    /// The lowest and the highest corner of the box around all meshes and instances; none without
    /// any. Instances are taken to be as large as the boxes of their shapes.
    pub fn bounds(&self) -> Option<[Vec3; 2]> {
        let both = self.outermost().map(|corner| (corner, corner));
        let (low, high) = both.reduce(|(low, high), (a, b)| (low.min(a), high.max(b)))?;
        Some([low, high])
    }

    /// Points around all meshes and instances: the corners of triangles, and of the boxes that
    /// shapes stand in.
    pub(super) fn outermost(&self) -> impl Iterator<Item = Vec3> {
        let boxes: Vec<[DVec3; 2]> = self.shapes.iter().map(Mesh::bounds).collect();
        let corners = self.instances.iter().filter_map(move |&Instance { shape, transform }| {
            let sides = *boxes.get(shape.0 as usize)?;
            Some((0..8_usize).map(move |bits| {
                let side = |axis: usize| sides[bits >> axis & 1][axis];
                transform.transform_point3(DVec3::new(side(0), side(1), side(2))).as_vec3()
            }))
        });
        let of_meshes = self
            .meshes
            .iter()
            .flat_map(|mesh| (0..mesh.triangles.len()).flat_map(|at| mesh.corners(at)));
        of_meshes.chain(corners.flatten())
    }

    /// Whether anything emits light, the background and the environment included. Materials that
    /// are not there do not.
    pub fn emits(&self) -> bool {
        let radiance = |id: MaterialId| {
            self.materials.get(id.0 as usize).map_or(Vec3::ZERO, Material::radiance)
        };
        let meshes = self.meshes.iter().chain(self.placed_shapes());
        let meshes = meshes.filter(|mesh| !mesh.triangles.is_empty());
        let surfaces = meshes.map(|mesh| radiance(mesh.material));
        let quads = self.quad_lights.iter().map(|light| light.radiance);
        let points = self.punctual_lights.iter().map(PunctualLight::colour);
        let others = points.chain([self.background]);
        surfaces.chain(quads).chain(others).any(|light| light.max_element() > 0.0)
            || self.environment.as_ref().is_some_and(Environment::emits)
    }
}
