//! A scene in the layout that the kernels read.

mod albedos;
mod alias_table;
mod anisotropic_albedos;
mod bump_maps;
pub mod bvh;
pub mod camera;
mod emission_maps;
mod environment;
mod geometry;
mod hierarchies;
mod light_tree;
mod lights;
mod materials;
mod media;
mod scene_triangle;
mod textures;
mod triangles;
mod wide_forms;

use self::bump_maps::NormalMaps;
use self::bvh::BvhQuality;
use self::environment::{Ball, PackedEnvironment};
use self::geometry::Corners;
use self::hierarchies::Hierarchies;
pub use self::lights::LightChoice;
use self::lights::{Emitters, Lights};
use self::materials::Tables;
use self::media::PackedMedia;
use self::textures::Textures;
use self::wide_forms::WideForms;
use super::error::RenderError;
use crate::exec::{ExecError, Executor, SceneBuffers};
use crate::scene::{Camera, Material, PathLimits, Principled, Projection, Scene, Texture};
use bytemuck::{Pod, Zeroable};
use glam::UVec4;
use raystream_shaders::scene::abilities::{
    ALL, ANISOTROPY, CAMERAS, COAT_NORMALS, CONDUCTORS, COVER, EMISSION_MAPS, ENVIRONMENT, F90,
    Fixed, HOLES, INSTANCES, LAYER_MAPS, LIGHT_TREE, MEDIA, NORMAL_MAPS, PLACED_TEXTURES,
    PRINCIPLED, PUNCTUAL, TANGENTS, TEXTURES, VERTEX_COLOURS, WIDE_TEXTURES,
};
use raystream_shaders::scene::bsdf::layer_maps::LayerMaps;
use raystream_shaders::scene::bsdf::{self, layers::Layers};
use raystream_shaders::scene::environment::NO_ENVIRONMENT;
use raystream_shaders::scene::light::tree::NO_TREE;
use raystream_shaders::scene::light::{DIRECTION, Light, POINT};
use raystream_shaders::scene::media::NO_MEDIA;
use raystream_shaders::scene::ray::Hit;
use raystream_shaders::scene::triangle::{NO_COLOURS, NO_COORDINATES, NO_TANGENTS};
use raystream_shaders::scene::{SceneParams, SceneView};

/// A scene, ready to be copied to a device. [`raystream_shaders::scene`] says how it is laid out.
pub struct PreparedScene {
    /// Nodes of the BVH, and triangles in the order of its leaves.
    pub geometry: Vec<UVec4>,
    /// The same triangles for shading, attributes, materials and lights.
    pub surfaces: Vec<UVec4>,
    /// The textures.
    pub texels: Vec<u32>,
    /// What lies where, the lights' total and the background. What is up to a render's settings
    /// is zero.
    pub params: SceneParams,
    /// What the scene uses, see [`raystream_shaders::scene::abilities`].
    pub abilities: u32,
    /// How many numbers [hits](raystream_shaders::scene::ray::Hit::triangle) have: one for each
    /// triangle, those of all instances counted; more for those that were split.
    pub numbers: u32,
    /// How many instances are not repeated in memory.
    pub instances: u32,
    /// How many triangles had no area or were thinner than the roundings of their own corners, and
    /// were left out.
    pub degenerate: usize,
    /// How many had the corners of an earlier one, which hides them, and were left out.
    pub copies: usize,
    /// How many bump maps lie on surfaces in sizes that differ, so that their heights do.
    pub uneven_bumps: usize,
    /// The camera.
    pub camera: Camera,
    /// How long paths may be, by the scene.
    pub limits: PathLimits,
    /// The hierarchies in the forms that CPUs traverse.
    wide: WideForms,
}

impl PreparedScene {
    /// Checks a scene, builds its BVH and the tables that the kernels read.
    ///
    /// # Errors
    ///
    /// When [`Scene::check`] finds something.
    pub fn new(scene: &Scene, quality: BvhQuality) -> Result<Self, RenderError> {
        Self::choosing_lights(scene, quality, LightChoice::default())
    }

    /// The same, with lights that paths from the camera choose in this way; `lvc` chooses them by
    /// power.
    ///
    /// # Errors
    ///
    /// When [`Scene::check`] finds something.
    pub fn choosing_lights(
        scene: &Scene,
        quality: BvhQuality,
        choice: LightChoice,
    ) -> Result<Self, RenderError> {
        scene.check()?;
        let from = geometry::gather(scene);
        let triangles = &from.world.triangles;
        let normals = NormalMaps::new(scene, &from);
        let textures = textures::pack(scene.textures.iter().chain(&normals.textures));
        let mapped = emission_maps::of_triangles(scene, triangles, &from.corners, &textures);
        let Textures { words: mut texels, places } = textures;
        let materials = materials::table(scene, &places);
        let punctual = &scene.punctual_lights;
        let emitters = Emitters { triangles, materials: &materials, mapped: &mapped, punctual };
        let has_tree = emitters.has_tree(choice);
        let mut params = SceneParams { background: scene.background, ..SceneParams::zeroed() };
        let Hierarchies { geometry, shading: mut surfaces, numbers, instances, bounds, source } =
            Hierarchies::build(&from, &emitters.marks(has_tree), quality, &mut params)?;
        let environment = scene.environment.as_ref().and_then(PackedEnvironment::new);
        let corners = triangles.iter().flat_map(|triangle| triangle.corners);
        let ball = Ball::around(corners.chain(from.corners_of_instances(bounds)));
        let power = environment.as_ref().map(|it| it.power * ball.radius_squared());
        let lights = lights::build(&emitters, ball, power, has_tree);
        let mut tables = Tables::new(scene.materials.len() as u32);
        let layer_maps = materials::layer_maps(scene, &places);
        let layers = materials::layered(scene, &normals, &places, &mut tables);
        let media = PackedMedia::new(scene, lights.table.len(), &mut tables);
        params.lights = lights.table.len() as u32;
        params.total_importance = lights.total_importance;
        let around = environment.as_ref().map_or(0.0, |e| e.brightest);
        params.brightest = around.max(lights.brightest).max(scene.background.max_element());
        params.environment = environment.as_ref().map_or(NO_ENVIRONMENT, |packed| {
            packed.append(&mut texels, lights.environment_chance, ball)
        });
        let (corners, materials, lights) = (&from.corners, &materials[..], &lights);
        let (layers, layer_maps, tables) = (&layers[..], &layer_maps[..], &tables);
        Parts { corners, materials, lights, layers, layer_maps, tables }
            .append_to(&mut surfaces, &mut params);
        let mut prepared = Self {
            geometry,
            surfaces,
            texels,
            params,
            abilities: abilities(scene, &params, lights),
            numbers,
            instances,
            degenerate: from.degenerate(),
            copies: from.copies(),
            uneven_bumps: normals.uneven,
            camera: scene.camera,
            limits: scene.limits,
            wide: WideForms::of(source),
        };
        if instances > 0 {
            prepared.abilities |= INSTANCES;
        }
        if let Some(media) = &media {
            prepared.add_media(media, lights);
        }
        Ok(prepared)
    }

    /// Has the scene seen through another camera, without building it anew. Renders that have begun
    /// do not know of it.
    ///
    /// # Errors
    ///
    /// When the camera has no direction, or a number out of range. Then nothing changes.
    pub fn set_camera(&mut self, camera: Camera) -> Result<(), RenderError> {
        camera.check_as_field()?;
        self.camera = camera;
        self.abilities &= !CAMERAS;
        if !is_pinhole(&camera) {
            self.abilities |= CAMERAS;
        }
        if self.abilities & MEDIA != 0 {
            let within = media::of_camera(&self.view(), camera.origin);
            media::write_camera(&mut self.surfaces[self.params.first_media as usize..], within);
        }
        Ok(())
    }

    /// Adds what camera and lights are in, which is asked of the rest of the scene.
    fn add_media(&mut self, media: &PackedMedia, lights: &Lights) {
        self.abilities |= MEDIA;
        self.params.first_media = append(&mut self.surfaces, &media.rows);
        let Self { geometry, surfaces, texels, params, camera, .. } = self;
        let view = SceneView::new(Fixed, params, geometry, surfaces, texels);
        let places = media.places(&view, camera.origin, &lights.table);
        media.complete(&mut surfaces[params.first_media as usize..], &places);
    }

    /// What the picture lacks of the scene, for its user to know: a sentence for each kind.
    pub fn warnings(&self) -> Vec<String> {
        let dropped = |count: usize, which: &str| {
            (count > 0).then(|| format!("{count} triangles {which} were dropped."))
        };
        let copies = dropped(self.copies, "with the corners of an earlier one, which hides them,");
        let thin = dropped(self.degenerate, "thinner than the roundings of their corners");
        let bumps = (self.uneven_bumps > 0).then(|| {
            format!(
                "{} bump maps lie on surfaces in sizes that differ: where they are larger than in \
                 the mean, so are their heights.",
                self.uneven_bumps
            )
        });
        copies.into_iter().chain(thin).chain(bumps).collect()
    }

    /// The number in the scene of the triangle of a hit, if that is one: those of the meshes count,
    /// in order, then those of the instances, then two for each quad light.
    pub fn scene_triangle(&self, hit: &Hit) -> Option<u32> {
        hit.is_some().then(|| self.view().bvh.scene_triangle(hit.triangle))
    }

    /// The scene as kernels see it, for the host. What is up to a render's settings is zero.
    pub fn view(&self) -> SceneView<'_, Fixed<ALL>> {
        SceneView::new(Fixed, &self.params, &self.geometry, &self.surfaces, &self.texels)
    }

    /// Copies it to a device, for kernels that have these abilities beside the scene's: those that
    /// [settings use](super::Settings::abilities).
    pub fn buffers_for<E: Executor>(
        &self,
        executor: &E,
        abilities: u32,
    ) -> Result<SceneBuffers<E::Buffer>, ExecError> {
        let abilities = self.abilities | abilities;
        let wide = executor.simd().and_then(|simd| {
            let planes = self.params.first_planes as usize..self.params.first_order as usize;
            self.wide.form(simd, &self.geometry[planes])
        });
        SceneBuffers::new(executor, abilities, &self.geometry, &self.surfaces, &self.texels)
            .map(|buffers| buffers.with_wide(wide))
    }

    /// Copies it to a device, for kernels that know of no settings.
    pub fn buffers<E: Executor>(&self, executor: &E) -> Result<SceneBuffers<E::Buffer>, ExecError> {
        self.buffers_for(executor, 0)
    }
}

fn is_pinhole(camera: &Camera) -> bool {
    let is_perspective = matches!(camera.projection, Projection::Perspective { .. });
    is_perspective && !camera.projection.has_lens()
}

/// What a scene uses, but for [`MEDIA`] and [`INSTANCES`].
fn abilities(scene: &Scene, params: &SceneParams, lights: &Lights) -> u32 {
    let any = |uses: fn(&Material) -> bool| scene.materials.iter().any(uses);
    let has_textures = any(|material| material.textures().next().is_some());
    let has_wide =
        has_textures && (scene.textures.iter().any(Texture::is_wide) || any(Material::has_bumps));
    let has_placed =
        params.first_coordinates != NO_COORDINATES || scene.textures.iter().any(Texture::is_placed);
    let is_principled = any(|material| material.principled().is_some());
    let has_cover = any(|m| m.principled().is_some_and(Principled::has_cover));
    let has_conductors = any(|m| m.principled().is_some_and(|p| p.conductor.is_some()));
    let has_holes = any(Material::has_holes);
    let has_environment = params.environment != NO_ENVIRONMENT;
    let is_punctual = |light: &Light| matches!(light.kind, POINT | DIRECTION);
    [
        (has_textures, TEXTURES),
        (has_wide, WIDE_TEXTURES),
        (has_environment, ENVIRONMENT),
        (is_principled, PRINCIPLED),
        (has_cover, COVER),
        (has_conductors, CONDUCTORS),
        (has_holes, HOLES),
        (!is_pinhole(&scene.camera), CAMERAS),
        (lights.table.iter().any(is_punctual), PUNCTUAL),
        (!lights.maps.is_empty(), EMISSION_MAPS),
        (params.first_colours != NO_COLOURS, VERTEX_COLOURS),
        (params.first_tangents != NO_TANGENTS, TANGENTS),
        (params.first_light_tree != NO_TREE, LIGHT_TREE),
        (any(Material::has_grain), ANISOTROPY),
        (has_placed, PLACED_TEXTURES),
        (params.first_layer_maps != 0, LAYER_MAPS),
        (any(|m| m.principled().is_some_and(Principled::has_coat_normal)), COAT_NORMALS),
        (any(|m| m.principled().is_some_and(Principled::has_normal_map)), NORMAL_MAPS),
        (any(|m| m.principled().is_some_and(Principled::has_f90)), F90),
    ]
    .into_iter()
    .filter(|(uses, _)| *uses)
    .fold(0, |word, (_, ability)| word | ability)
}

/// What surfaces are shaded by, besides triangles and bodies.
struct Parts<'a> {
    corners: &'a Corners,
    materials: &'a [bsdf::Material],
    lights: &'a Lights,
    layers: &'a [Layers],
    layer_maps: &'a [LayerMaps],
    tables: &'a Tables,
}

impl Parts<'_> {
    /// Adds them to the rows of triangles.
    fn append_to(&self, surfaces: &mut Vec<UVec4>, params: &mut SceneParams) {
        params.first_attributes = append(surfaces, &self.corners.attributes);
        params.first_material = append(surfaces, self.materials);
        params.first_light = append(surfaces, &self.lights.table);
        params.first_media = NO_MEDIA;
        // The kernels look for these right behind the lights.
        if !self.layers.is_empty() {
            append(surfaces, albedos::of_surface());
            append(surfaces, self.layers);
            append(surfaces, &self.tables.rows);
        }
        params.first_emission_map = append(surfaces, &self.lights.maps);
        if self.layers.iter().any(|layers| layers.strength() > 0.0) {
            params.first_anisotropic = append(surfaces, anisotropic_albedos::of_anisotropic());
        }
        let colours = &self.corners.colours;
        params.first_colours =
            if colours.is_empty() { NO_COLOURS } else { append(surfaces, colours) };
        let tangents = &self.corners.tangents;
        params.first_tangents =
            if tangents.is_empty() { NO_TANGENTS } else { append(surfaces, tangents) };
        let second = &self.corners.second;
        params.first_coordinates =
            if second.is_empty() { NO_COORDINATES } else { append(surfaces, second) };
        if !self.layer_maps.is_empty() {
            params.first_layer_maps = append(surfaces, self.layer_maps);
        }
        let tree = self.lights.tree.as_ref();
        params.first_light_tree = tree.map_or(NO_TREE, |tree| append(surfaces, &tree.rows()));
    }
}

/// Four words to a row, the last filled up by zeros.
fn rows_of(words: &[u32]) -> Vec<UVec4> {
    let word = |row: &[u32], column: usize| row.get(column).copied().unwrap_or(0);
    let row = |row: &[u32]| UVec4::new(row[0], word(row, 1), word(row, 2), word(row, 3));
    words.chunks(4).map(row).collect()
}

/// Adds the rows of `elements`, whose sizes are multiples of a row's; the number of the first one.
fn append<T: Pod>(rows: &mut Vec<UVec4>, elements: &[T]) -> u32 {
    let first = rows.len() as u32;
    rows.extend(bytemuck::pod_collect_to_vec::<T, UVec4>(elements));
    first
}

#[cfg(test)]
mod tests {
    use super::*;

    use raystream_shaders::scene::light::EmissionMap;
    use raystream_shaders::scene::triangle::{
        Attributes, SecondCoordinates, Tangents, VertexColours,
    };

    /// The rows of an element whose every word differs, and the element.
    fn numbered<T: Pod, const ROWS: usize>() -> ([UVec4; ROWS], T) {
        let word = |row: usize, column: u32| 0x3f80_0000 + 4 * row as u32 + column;
        let rows = std::array::from_fn(|row| {
            UVec4::new(word(row, 0), word(row, 1), word(row, 2), word(row, 3))
        });
        (rows, bytemuck::pod_read_unaligned(bytemuck::cast_slice(&rows)))
    }

    #[test]
    fn kernels_unpack_the_memory_that_the_host_writes() {
        let (rows, material) = numbered::<bsdf::Material, { bsdf::Material::ROWS as usize }>();
        assert_eq!(bsdf::Material::from_rows(rows), material);
        let (rows, layers) = numbered::<Layers, { Layers::ROWS as usize }>();
        assert_eq!(Layers::from_rows(rows), layers);
        let (rows, light) = numbered::<Light, { Light::ROWS as usize }>();
        assert_eq!(Light::from_rows(rows), light);
        let (rows, map) = numbered::<EmissionMap, { EmissionMap::ROWS as usize }>();
        assert_eq!(EmissionMap::from_rows(rows), map);
        let (rows, attributes) = numbered::<Attributes, { Attributes::ROWS as usize }>();
        assert_eq!(Attributes::from_rows(rows), attributes);
        let (rows, colours) = numbered::<VertexColours, { VertexColours::ROWS as usize }>();
        assert_eq!(VertexColours::from_rows(rows), colours);
        let (rows, tangents) = numbered::<Tangents, { Tangents::ROWS as usize }>();
        assert_eq!(Tangents::from_rows(rows), tangents);
        let (rows, second) = numbered::<SecondCoordinates, { SecondCoordinates::ROWS as usize }>();
        assert_eq!(SecondCoordinates::from_rows(rows), second);
    }
}
