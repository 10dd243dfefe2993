//! The scene on the stage: loaded, prepared, and what there is to know of it.

use crate::navigator::Bounds;
use crate::paths::{Drawing, SamplePath, sample_number};
use glam::{DVec3, Vec3};
use raystream::render::scene::camera::camera as on_film;
use raystream::render::{BvhQuality, PreparedScene, RenderError, Settings};
use raystream::scene::{Camera, FilmSize, LoadOptions, Scene, SceneError, Sky, shipped};
use raystream_shaders::film::stream::Slot;
use raystream_shaders::film::tiles::rank_of_pixel;
use raystream_shaders::scene::SceneView;
use raystream_shaders::scene::abilities::{ALL, Fixed};
use std::path::{Path, PathBuf};

/// What can go wrong before there is a picture, or with one.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum StageError {
    /// The scene cannot be loaded.
    #[error(transparent)]
    Scene(#[from] SceneError),
    /// It cannot be rendered.
    #[error(transparent)]
    Render(#[from] RenderError),
    /// A device cannot be opened.
    #[error(transparent)]
    Device(#[from] raystream::exec::ExecError),
}

/// Which scene, and how it is loaded.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SceneChoice {
    /// A file, or the name of a scene that ships.
    pub name: PathBuf,
    /// The camera of a glTF, by its name.
    pub camera: Option<String>,
    /// How high the sun of a clear sky stands that lights it, in degrees.
    pub sky: Option<f32>,
    /// The size of the picture, if it is not the scene's.
    pub size: Option<FilmSize>,
}

impl SceneChoice {
    /// The name of the shipped scene that is meant, unless a file is.
    pub fn shipped(&self) -> Option<&'static str> {
        let name = self.name.to_str()?;
        let found = shipped().iter().find(|scene| scene.name == name)?;
        (!self.name.is_file()).then_some(found.name)
    }

    /// Loads it; with the files that were read, also where one of them is wrong.
    pub fn load(&self) -> (Result<Scene, SceneError>, Vec<PathBuf>) {
        let options = LoadOptions::default();
        let (scene, files) = match (self.shipped(), self.name.to_str()) {
            (Some(name), _) => (options.load_named(name), Vec::new()),
            // The message lists the scenes that ship.
            (None, Some(name)) if is_no_file(name, &self.name) => {
                (options.load_named(name), Vec::new())
            }
            _ => options.load_listing(&self.name),
        };
        (scene.and_then(|scene| self.changed(scene)), files)
    }

    /// The scene as it was asked for.
    fn changed(&self, mut scene: Scene) -> Result<Scene, SceneError> {
        if let Some(camera) = &self.camera {
            scene.use_camera(camera)?;
        }
        if let Some(elevation) = self.sky {
            scene.set_environment(Sky::new(elevation).environment());
        }
        if let Some(size) = self.size {
            scene.film = size;
        }
        Ok(scene)
    }
}

fn is_no_file(name: &str, path: &Path) -> bool {
    !name.contains(['/', '\\', '.']) && !path.exists()
}

/// What there is to know of a scene.
#[derive(Clone, Debug)]
pub struct SceneFacts {
    /// What it is called.
    pub name: String,
    /// Its camera.
    pub camera: Camera,
    /// The size of its picture.
    pub size: FilmSize,
    /// Where its geometry is.
    pub bounds: Bounds,
    /// Its triangles, those of all instances counted.
    pub triangles: u64,
    /// What the picture does not show, a sentence each.
    pub warnings: Vec<String>,
}

/// A scene, ready to be rendered.
pub struct Stage {
    prepared: PreparedScene,
    base: Settings,
    facts: SceneFacts,
}

impl Stage {
    /// Prepares a scene.
    ///
    /// # Errors
    /// If its parts do not fit together.
    pub fn new(scene: &Scene) -> Result<Self, RenderError> {
        let prepared = PreparedScene::new(scene, BvhQuality::High)?;
        let warnings = scene.warnings.iter().cloned().chain(prepared.warnings()).collect();
        let facts = SceneFacts {
            name: scene.name.clone(),
            camera: scene.camera,
            size: scene.film,
            bounds: bounds(scene),
            triangles: triangles(scene),
            warnings,
        };
        Ok(Self { prepared, base: Settings::for_scene(scene), facts })
    }

    /// What there is to know of it.
    pub fn facts(&self) -> &SceneFacts {
        &self.facts
    }

    /// Settings with the scene's lengths of paths, for a picture of this size.
    pub fn base(&self, size: FilmSize) -> Settings {
        Settings { size, ..self.base }
    }

    /// The scene as renderers take it.
    pub fn prepared(&self) -> &PreparedScene {
        &self.prepared
    }

    /// Sees it through another camera.
    ///
    /// # Errors
    /// If the camera has no direction, or numbers out of range.
    pub fn set_camera(&mut self, camera: Camera) -> Result<(), RenderError> {
        self.prepared.set_camera(camera)
    }

    /// The point that is seen at a place of the picture, in pixels of a picture of `size`; None if
    /// there is none.
    pub fn pick(&self, camera: &Camera, size: FilmSize, place: [f32; 2]) -> Option<DVec3> {
        let ray = on_film(camera, size).ray(Fixed::<ALL>, place, [0.5; 2]);
        let hit = self.prepared.view().closest_hit(&ray);
        let point: Vec3 = ray.origin + ray.direction * hit.t;
        hit.is_some().then(|| point.as_dvec3())
    }

    /// The path of one of the samples that a pixel has, counted from 0, of which `first_samples`
    /// are of its first half; and how it lies over the picture of these settings.
    pub fn path(
        &self,
        settings: &Settings,
        [x, y]: [u32; 2],
        sample: u32,
        first_samples: u32,
    ) -> (SamplePath, Drawing) {
        let PreparedScene { geometry, surfaces, texels, .. } = &self.prepared;
        let parameters = self.prepared.parameters(settings);
        let view = SceneView::new(Fixed::<ALL>, &parameters.scene, geometry, surfaces, texels);
        let rank = rank_of_pixel(x, y, settings.size.width, settings.size.height);
        let slot = Slot { rank, sample: sample_number(sample, first_samples) };
        let path = SamplePath::trace(&parameters, &view, slot);
        // What leaves the scene does so within its diameter.
        let reach = 2.0 * self.facts.bounds.radius as f32;
        let drawing = path.drawing(&parameters.camera, reach);
        (path, drawing)
    }
}

fn triangles(scene: &Scene) -> u64 {
    let count = |mesh: &raystream::scene::Mesh| mesh.triangles.len() as u64;
    let of_shape = |shape: u32| scene.shapes.get(shape as usize).map_or(0, count);
    let repeated = scene.instances.iter().map(|instance| of_shape(instance.shape.0));
    scene.meshes.iter().map(count).chain(repeated).sum()
}

fn bounds(scene: &Scene) -> Bounds {
    let corners = scene.bounds().into_iter().flatten().map(Vec3::as_dvec3);
    Bounds::of(corners.filter(|corner| corner.is_finite()))
}
