//! A scene on the device: three buffers, the parameters that say what lies where, and views.
//!
//! ```text
//! geometry: nodes of the BVH | triangles, for the test | their numbers in the scene | instances
//! surfaces: triangles, for shading | attributes | materials | lights | albedos of surfaces
//!           | layers | albedos of boundaries and of sheen, conductors | maps of emission
//!           | albedos of anisotropic surfaces | colours of vertices | tangents of corners
//!           | tree of lights | bodies
//! texels:   textures, see `texture` | environment, see `environment`
//! ```
//!
//! Albedos and layers are there where the scene has principled materials, maps where textures say
//! what triangles emit, colours where vertices have some, bodies, see [`media`], where paths must
//! know what they are in.
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
pub mod looks;
pub mod media;
pub mod normals;
pub mod ray;
pub mod surface;
pub mod texture;
pub mod triangle;

use crate::glam::{UVec4, Vec3};
use crate::memory::device_struct;
use abilities::{Abilities, HOLES, MEDIA};
use bvh::{BvhView, Order};
use environment::EnvironmentView;
use light::tree::LightTree;
use light::{Light, LightView};
use media::{Body, Media, MediaView, Sides};
use ray::{Hit, NO_END, Ray};
use surface::SurfaceView;
use texture::TextureView;

device_struct! {
    /// What is the same for all of a scene. 96 bytes.
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
        /// Largest component of the radiance that lights and the background emit; 0 without any.
        pub brightest: f32,
        /// Row of `geometry` with the numbers of triangles in the scene.
        pub first_order: u32,
        /// Word of `texels` where the environment's header begins, or
        /// [`environment::NO_ENVIRONMENT`].
        pub environment: u32,
        /// Row of `surfaces` with the first map of emission.
        pub first_emission_map: u32,
        /// Row of `surfaces` with the header of the [bodies](media), or [`media::NO_MEDIA`].
        pub first_media: u32,
        /// Row of `geometry` with the header of the [instances](bvh::instance).
        pub first_instance: u32,
        /// Row of `surfaces` with the first colours of vertices, or [`triangle::NO_COLOURS`].
        pub first_colours: u32,
        /// Row of `surfaces` with the table of [anisotropic](bsdf::anisotropic) surfaces; 0 if there
        /// are none.
        pub first_anisotropic: u32,
        /// Row of `surfaces` with the [tree of lights](light::tree), or [`light::tree::NO_TREE`].
        pub first_light_tree: u32,
        /// Row of `surfaces` with the first tangents of corners, or [`triangle::NO_TANGENTS`].
        pub first_tangents: u32,
        /// Row of `surfaces` with the first second texture coordinates of corners, or
        /// [`triangle::NO_COORDINATES`].
        pub first_coordinates: u32,
        /// Row of `surfaces` with the first [maps of layers](bsdf::layer_maps); 0 if there are none.
        pub first_layer_maps: u32,
        /// Unused; zero.
        pub pad: u32,
        /// Unused; zero.
        pub pad_too: u32,
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
    pub bvh: BvhView<'a, A>,
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
        let places = [params.first_planes, params.first_order, params.first_instance];
        let bvh = BvhView::new(abilities, geometry, places);
        let textures = TextureView::new(texels, abilities);
        Self {
            bvh,
            surfaces: SurfaceView {
                rows: surfaces,
                bvh,
                first_attributes: params.first_attributes,
                first_colours: params.first_colours,
                first_tangents: params.first_tangents,
                first_coordinates: params.first_coordinates,
                first_layer_maps: params.first_layer_maps,
                first_material: params.first_material,
                first_anisotropic: params.first_anisotropic,
                first_albedos: params.first_light + params.lights * Light::ROWS,
                offset_roundings: params.offset_roundings,
                textures,
                media: MediaView { rows: surfaces, first: params.first_media },
                abilities,
            },
            lights: LightView {
                rows: surfaces,
                first: params.first_light,
                count: params.lights,
                tree: LightTree {
                    rows: surfaces,
                    first: params.first_light_tree,
                    lights: params.lights,
                },
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

    /// The same scene, whose rays go through another hierarchy, if there is one.
    #[cfg(not(target_arch = "spirv"))]
    pub fn with_wide(self, wide: Option<&'a bvh::wide::WideBvh>) -> Self {
        let bvh = self.bvh.with_wide(wide);
        Self { bvh, surfaces: SurfaceView { bvh, ..self.surfaces }, ..self }
    }

    /// The nearest surface that `ray` hits in `0 < t < ray.t_max`, holes left out; of several the
    /// first in the scene. Boundaries of bodies are surfaces like any.
    #[inline(always)]
    pub fn closest_hit(&self, ray: &Ray) -> Hit {
        self.encounter(ray, Media::NONE, false, false).hit
    }

    /// Whether `ray` hits any surface in `0 < t < ray.t_max`, holes left out. Boundaries of bodies
    /// are surfaces like any.
    #[inline(always)]
    pub fn is_occluded(&self, ray: &Ray) -> bool {
        self.encounter(ray, Media::NONE, true, false).hit.is_some()
    }

    /// The nearest surface that a path in `media` meets along `ray`, in `0 < t < ray.t_max`, holes
    /// left out, and what is on its two sides. Boundaries of bodies that others hide are passed.
    #[inline(always)]
    pub fn meet(&self, ray: &Ray, media: Media) -> Encounter {
        self.encounter(ray, media, false, self.surfaces.has_media())
    }

    /// Whether a path in `media` would [meet](Self::meet) anything along `ray`.
    #[inline(always)]
    pub fn is_blocked(&self, ray: &Ray, media: Media) -> bool {
        self.encounter(ray, media, true, self.surfaces.has_media()).hit.is_some()
    }

    /// The nearest surface that is no hole and, if `crosses`, no boundary of what is hidden;
    /// perhaps another one if `any` will do.
    #[inline(always)]
    fn encounter(&self, ray: &Ray, media: Media, any: bool, crosses: bool) -> Encounter {
        let abilities = self.surfaces.abilities;
        // Where surfaces may be passed they are looked for in order, so that none is met twice.
        let is_ordered = abilities.has(HOLES) || abilities.has(MEDIA);
        let order = Order { any: any && !is_ordered, behind: is_ordered };
        let mut passed = Hit::miss(0.0);
        let mut t_max = ray.t_max;
        let mut boundary = Boundary::none(media);
        loop {
            let segment = Ray::segment(ray.origin, ray.direction, t_max);
            let hit = self.bvh.traverse(&segment, &passed, order);
            if abilities.has(HOLES) && hit.is_some() && self.surfaces.is_hole(ray, &hit) {
                passed = hit;
                continue;
            }
            if !abilities.has(MEDIA) || !crosses {
                return Encounter { hit, sides: Sides::both(media) };
            }
            let mut body = Body::NONE;
            if hit.is_some() {
                body = self.surfaces.body(&hit);
            }
            if body.is_some() {
                let from_front = self.is_front(ray, &hit);
                if !boundary.is_some() {
                    t_max = ray.t_max.min(hit.t + self.reach_of_touch(ray, &hit));
                }
                boundary = boundary.crossed(&hit, body, from_front);
                passed = hit;
            } else if boundary.is_some() && !hit.is_some() {
                // Nothing else is there where the boundary is.
                if boundary.sides.differ() {
                    return Encounter { hit: boundary.hit, sides: boundary.sides };
                }
                boundary = Boundary::none(boundary.sides.beyond);
                t_max = ray.t_max;
            } else {
                // What is no boundary, or nothing at all.
                return Encounter { hit, sides: Sides::both(boundary.sides.here) };
            }
        }
    }

    /// Whether what `ray` has `hit` is the front of a triangle.
    #[inline(always)]
    pub fn is_front(&self, ray: &Ray, hit: &Hit) -> bool {
        ray.direction.dot(self.bvh.plane(hit.triangle).normal) < 0.0
    }

    /// How far along `ray`, in units of its direction's length, surfaces touch that which it `hit`:
    /// as far as the origin of a ray that goes on behind it would be.
    fn reach_of_touch(&self, ray: &Ray, hit: &Hit) -> f32 {
        let point = ray.origin + ray.direction * hit.t;
        let place = self.bvh.place(hit.triangle);
        let clearance = self.surfaces.clearance(place.instance);
        let distance = clearance.distance(point.abs().max_element());
        let normal = self.bvh.plane_at(&place).normal;
        distance / ray.direction.dot(normal).abs().max(f32::MIN_POSITIVE)
    }

    /// What the scene uses.
    #[inline(always)]
    pub fn abilities(&self) -> A {
        self.surfaces.abilities
    }
}

/// What a path meets at the end of a segment.
#[derive(Clone, Copy)]
pub struct Encounter {
    /// Where, if there [is something](Hit::is_some).
    pub hit: Hit,
    /// What is on its two sides; of nothing, what the path ends in.
    pub sides: Sides,
}

impl Encounter {
    /// How long the segment is, in units of the ray's direction's length: without an end where
    /// nothing is met.
    #[inline(always)]
    pub fn length(&self) -> f32 {
        if self.hit.is_some() { self.hit.t } else { NO_END }
    }
}

/// Boundaries that are crossed at one place.
#[derive(Clone, Copy)]
struct Boundary {
    /// The one that light meets.
    hit: Hit,
    /// Its body's number.
    number: u32,
    /// The first of them: its body's number, twice, and 1 more if it was seen from the front.
    first: u32,
    /// What is on both sides of all of them.
    sides: Sides,
}

impl Boundary {
    /// None so far, of a path in `media`.
    fn none(media: Media) -> Self {
        Self { hit: Hit::miss(0.0), number: 0, first: 0, sides: Sides::both(media) }
    }

    fn is_some(&self) -> bool {
        self.number != 0
    }

    /// With that of `body`, of which a ray has `hit` this side. Light meets the one of the highest
    /// priority. A ray through an edge hits the triangles on both sides of it.
    fn crossed(self, hit: &Hit, body: Body, from_front: bool) -> Self {
        let side = body.number * 2 + from_front as u32;
        if side == self.first {
            return self;
        }
        let is_met = body.number > self.number;
        Self {
            hit: if is_met { *hit } else { self.hit },
            number: if is_met { body.number } else { self.number },
            first: if self.is_some() { self.first } else { side },
            sides: self.sides.crossed(body, from_front),
        }
    }
}
