//! A scene on the device: three buffers, the parameters that say what lies where, and views.
//!
//! ```text
//! geometry: nodes of the BVH | triangles, for the test | their numbers in the scene
//! surfaces: triangles, for shading | attributes | materials | lights | albedos of surfaces
//!           | layers | albedos of boundaries and of sheen | maps of emission
//! texels:   textures, see `texture` | environment, see `environment`
//! ```
//!
//! Albedos and layers are there where the scene has principled materials, maps where textures say
//! what triangles emit.
//!
//! What traversal reads lies in `geometry`, what shading reads in `surfaces`. They are few because
//! a kernel may bind few buffers (WebGPU promises eight), and two because each can then hold the
//! triangles of twice as large a scene. A row of the [table of kernels](crate::kernels) that says
//! `with scene` binds all three and hands its function a [`SceneView`]: another table of the scene
//! is added here and nowhere else.

pub mod abilities;
pub mod bsdf;
pub mod bvh;
pub mod camera;
pub mod environment;
pub mod light;
pub mod ray;
pub mod surface;
pub mod texture;
pub mod triangle;

use crate::glam::{UVec4, Vec3};
use crate::memory::device_struct;
use abilities::{Abilities, HOLES};
use bvh::{BvhView, Order};
use environment::EnvironmentView;
use light::{Light, LightView};
use ray::{Hit, Ray};
use surface::SurfaceView;
use texture::TextureView;

device_struct! {
    /// What is the same for all of a scene. 64 bytes.
    pub struct SceneParams {
        /// Radiance of the light that comes from all around where there is no surface, linear
        /// Rec.709.
        pub background: Vec3,
        /// Number of lights, the environment included, which is the last.
        pub lights: u32,
        /// Sum over the lights of area times importance (of the environment: what stands for that),
        /// in squared world units; see [`light::area_pdf`].
        pub total_importance: f32,
        /// How far rays start from surfaces, see [`ray::OFFSET_ROUNDINGS`].
        pub offset_roundings: f32,
        /// Row of `geometry` with the first triangle.
        pub first_planes: u32,
        /// Row of `surfaces` with the first attributes.
        pub first_attributes: u32,
        /// Row of `surfaces` with the first material.
        pub first_material: u32,
        /// Row of `surfaces` with the first light.
        pub first_light: u32,
        /// Largest component of the radiance that lights emit; 0 without lights.
        pub brightest: f32,
        /// Row of `geometry` with the numbers of triangles in the scene.
        pub first_order: u32,
        /// Word of `texels` where the environment's header begins, or
        /// [`environment::NO_ENVIRONMENT`].
        pub environment: u32,
        /// Row of `surfaces` with the first map of emission.
        pub first_emission_map: u32,
        /// Unused; zero.
        pub pad0: u32,
        /// Unused; zero.
        pub pad1: u32,
    }
}

/// The parameters of a kernel that traces: they hold those of its scene.
pub trait TracingParams {
    /// The scene's.
    fn scene(&self) -> SceneParams;
}

/// Everything that a ray may hit, and what lights it.
#[derive(Clone, Copy)]
pub struct SceneView<'a, A> {
    /// The geometry, to trace rays through.
    pub bvh: BvhView<'a>,
    /// What rays hit.
    pub surfaces: SurfaceView<'a, A>,
    /// What emits.
    pub lights: LightView<'a, A>,
    /// Radiance where no ray hits anything, linear Rec.709.
    pub background: Vec3,
}

impl<'a, A: Abilities> SceneView<'a, A> {
    /// Wraps the buffers, which the [module](self) describes. The host answers for what they hold,
    /// and for `abilities`: the scene uses no others.
    #[inline(always)]
    pub fn new(
        abilities: A,
        params: &SceneParams,
        geometry: &'a [UVec4],
        surfaces: &'a [UVec4],
        texels: &'a [u32],
    ) -> Self {
        let bvh = BvhView::new(geometry, params.first_planes, params.first_order);
        let textures = TextureView::new(texels);
        Self {
            bvh,
            surfaces: SurfaceView {
                rows: surfaces,
                bvh,
                first_attributes: params.first_attributes,
                first_material: params.first_material,
                first_albedos: params.first_light + params.lights * Light::ROWS,
                offset_roundings: params.offset_roundings,
                textures,
                abilities,
            },
            lights: LightView {
                rows: surfaces,
                first: params.first_light,
                count: params.lights,
                total_importance: params.total_importance,
                offset_roundings: params.offset_roundings,
                first_map: params.first_emission_map,
                environment: EnvironmentView::new(texels, params.environment),
                textures,
                abilities,
            },
            background: params.background,
        }
    }

    /// The nearest surface that `ray` hits in `0 < t < ray.t_max`, holes left out; of several the
    /// first in the scene.
    #[inline(always)]
    pub fn closest_hit(&self, ray: &Ray) -> Hit {
        self.hit(ray, false)
    }

    /// Whether `ray` hits any surface in `0 < t < ray.t_max`, holes left out.
    #[inline(always)]
    pub fn is_occluded(&self, ray: &Ray) -> bool {
        self.hit(ray, true).is_some()
    }

    /// The nearest surface that is no hole; if `any` will do, another one perhaps.
    #[inline(always)]
    fn hit(&self, ray: &Ray, any: bool) -> Hit {
        // Where there are holes, surfaces are looked for in order, so that none is met twice.
        let has_holes = self.surfaces.abilities.has(HOLES);
        let order = Order { any: any && !has_holes, behind: has_holes };
        let mut passed = Hit::miss(0.0);
        loop {
            let hit = self.bvh.traverse(ray, &passed, order);
            if !has_holes || !hit.is_some() || !self.surfaces.is_hole(ray, &hit) {
                return hit;
            }
            passed = hit;
        }
    }

    /// What the scene uses.
    #[inline(always)]
    pub fn abilities(&self) -> A {
        self.surfaces.abilities
    }
}
