//! From a hit to what shading needs to know.

use crate::glam::{UVec4, Vec2, Vec3, Vec4};
use crate::math::packed::NO_TANGENT;
use crate::math::random::{hash, unit_float};
use crate::memory::access::at;
use crate::memory::rows::{four_rows, six_rows, three_rows, two_rows};
use crate::scene::abilities::{
    ANISOTROPY, Abilities, INSTANCES, LAYER_MAPS, MEDIA, PLACED_TEXTURES, TANGENTS, TEXTURES,
    VERTEX_COLOURS,
};
use crate::scene::bsdf::albedo::{self, AlbedoView};
use crate::scene::bsdf::layer_maps::{LayerMaps, LayerMapsView};
use crate::scene::bsdf::layers::Layers;
use crate::scene::bsdf::{Bsdf, Material, MaterialKind};
use crate::scene::bvh::BvhView;
use crate::scene::bvh::instance::{NO_INSTANCE, Place};
use crate::scene::light::tree::Vantage;
use crate::scene::looks::Looks;
use crate::scene::media::{Body, Interface, Media, MediaView, Sides};
use crate::scene::ray::{Clearance, Hit, Ray, SurfacePoint};
use crate::scene::texture::{Coordinates, NO_TEXTURE, TextureView};
use crate::scene::triangle::{
    Attributes, NO_ATTRIBUTES, NO_COLOURS, NO_COORDINATES, NO_TANGENTS, SecondCoordinates,
    Tangents, Triangle, VertexColours,
};

/// The surfaces of a scene, for those who know what has been hit.
#[derive(Clone, Copy)]
pub struct SurfaceView<'a, A> {
    /// The scene's buffer `surfaces`, see [`crate::scene`].
    pub rows: &'a [UVec4],
    /// The geometry, which has the triangles' planes.
    pub bvh: BvhView<'a, A>,
    /// Row of the first attributes.
    pub first_attributes: u32,
    /// See [`SceneParams::first_colours`](crate::scene::SceneParams::first_colours).
    pub first_colours: u32,
    /// See [`SceneParams::first_tangents`](crate::scene::SceneParams::first_tangents).
    pub first_tangents: u32,
    /// See [`SceneParams::first_coordinates`](crate::scene::SceneParams::first_coordinates).
    pub first_coordinates: u32,
    /// See [`SceneParams::first_layer_maps`](crate::scene::SceneParams::first_layer_maps).
    pub first_layer_maps: u32,
    /// Row of the first material.
    pub first_material: u32,
    /// Row of the tables of principled materials; see [`crate::scene`].
    pub first_albedos: u32,
    /// Row of the table of [anisotropic](crate::scene::bsdf::anisotropic) surfaces.
    pub first_anisotropic: u32,
    /// How far rays start from surfaces, see [`crate::scene::ray::OFFSET_ROUNDINGS`].
    pub offset_roundings: f32,
    /// The textures.
    pub textures: TextureView<'a, A>,
    /// The bodies that are bounded by them.
    pub media: MediaView<'a>,
    /// What the scene uses.
    pub abilities: A,
}

impl<'a, A: Abilities> SurfaceView<'a, A> {
    /// The triangle of a leaf entry.
    pub fn triangle(&self, entry: u32) -> Triangle {
        Triangle::from_rows(two_rows(self.rows, entry * Triangle::ROWS))
    }

    /// The point of the `triangle` at `place` where `ray` made `hit`.
    #[inline(always)]
    pub fn point(&self, place: &Place, triangle: &Triangle, ray: &Ray, hit: &Hit) -> SurfacePoint {
        let plane = self.bvh.plane_at(place);
        let clearance = self.clearance(place.instance);
        let position = if self.bvh.is_in_instance(place) {
            self.position_in_instance(place, triangle, ray, hit)
        } else {
            triangle.point(&plane, ray, hit, self.offset_roundings)
        };
        SurfacePoint { position, normal: plane.normal, clearance }
    }

    /// The same in world units of a triangle of an instance, where it is found in the space of the
    /// shape.
    fn position_in_instance(
        &self,
        place: &Place,
        triangle: &Triangle,
        ray: &Ray,
        hit: &Hit,
    ) -> Vec3 {
        let instances = self.bvh.instances();
        let inside = instances.ray(place.instance, ray);
        let outward = instances.outward(place.instance);
        let point = inside.origin + inside.direction * hit.t;
        let clearance = self.clearance(place.instance);
        let here = outward.point(point).abs().max_element() + clearance.spread;
        let offset = clearance.roundings * here * instances.measures(place.instance).scale;
        let reach = inside.origin.abs().max(point.abs()).max_element();
        let plane = self.bvh.plane_of_entry(place.entry);
        outward.point(triangle.inset(&plane, point, hit, [offset, reach]))
    }

    /// How far rays start from surfaces of an instance, or of what is in none.
    #[inline(always)]
    pub fn clearance(&self, instance: u32) -> Clearance {
        let of_world = Clearance::of_world(self.offset_roundings);
        if !self.abilities.has(INSTANCES) || instance == NO_INSTANCE {
            return of_world;
        }
        let measures = self.bvh.instances().measures(instance);
        Clearance { roundings: of_world.roundings * measures.factor, spread: measures.spread }
    }

    /// Attributes of a triangle of an instance, or of none, as they are in the world.
    #[inline(always)]
    pub(super) fn attributes(&self, index: u32, instance: u32) -> Attributes {
        let rows = four_rows(self.rows, self.first_attributes + index * Attributes::ROWS);
        let attributes = Attributes::from_rows(rows);
        if self.abilities.has(INSTANCES) && instance != NO_INSTANCE {
            return self.bvh.instances().attributes(instance, &attributes);
        }
        attributes
    }

    /// The same for `hit`, with the tangent there.
    #[inline(always)]
    pub(super) fn attributes_at(&self, index: u32, instance: u32, hit: &Hit) -> Attributes {
        let mut attributes = self.attributes(index, instance);
        if self.abilities.has(TANGENTS) && self.first_tangents != NO_TANGENTS {
            let row = at(self.rows, self.first_tangents + index * Tangents::ROWS);
            let mut tangents = Tangents::from_rows([row]);
            if self.abilities.has(INSTANCES) && instance != NO_INSTANCE {
                // Not what is between them: an instance may stretch its shape.
                tangents = self.bvh.instances().tangents(instance, &tangents);
            }
            let tangent = tangents.at(hit);
            if tangent != NO_TANGENT {
                attributes.tangent = tangent;
            }
        }
        attributes
    }

    /// The texture coordinates of `hit` on a triangle with these `attributes`, number `index`.
    #[inline(always)]
    pub(super) fn coordinates(
        &self,
        attributes: &Attributes,
        index: u32,
        hit: &Hit,
    ) -> Coordinates {
        let mut coordinates = Coordinates::both(attributes.uv(hit));
        if self.abilities.has(PLACED_TEXTURES) && self.first_coordinates != NO_COORDINATES {
            let first = self.first_coordinates + index * SecondCoordinates::ROWS;
            let second = SecondCoordinates::from_rows(two_rows(self.rows, first));
            coordinates.second = second.at(hit);
        }
        coordinates
    }

    /// The grain of a surface with these layers, turned from the tangent to this `heading`; zero
    /// where there is none.
    #[inline(always)]
    fn grain(&self, layers: &Layers, tangent: u32, heading: Vec2, shading: Vec3) -> Vec3 {
        if !self.abilities.has(ANISOTROPY) {
            return Vec3::ZERO;
        }
        layers.grain(tangent, heading, shading, self.abilities)
    }

    /// Makes a surface the boundary between what is on its sides, where bodies overlap.
    #[inline(always)]
    fn bound(
        &self,
        material: &mut Material,
        layers: &mut Layers,
        index: u32,
        from_front: bool,
        sides: Sides,
    ) {
        if self.has_media() && sides.differ() {
            let interface = self.interface(index, from_front, sides);
            material.ior = interface.ior;
            layers.boundary_albedos = interface.albedos;
        }
    }

    /// What vertices multiply the colour and the opacity of a triangle's material by, where `hit` is
    /// on it: one with attributes of this number.
    #[inline(always)]
    pub(super) fn colour(&self, attributes: u32, hit: &Hit) -> Vec4 {
        if !self.abilities.has(VERTEX_COLOURS) || self.first_colours == NO_COLOURS {
            return Vec4::ONE;
        }
        let first = self.first_colours + attributes * VertexColours::ROWS;
        VertexColours::from_rows(two_rows(self.rows, first)).at(hit)
    }

    /// What the principled material number `index` has beside [`Self::material`].
    pub(super) fn layers(&self, index: u32) -> Layers {
        let first = self.first_albedos + albedo::ROWS + index * Layers::ROWS;
        Layers::from_rows(six_rows(self.rows, first))
    }

    /// Whether textures say more of layers than most do.
    #[inline(always)]
    pub(super) fn has_layer_maps(&self) -> bool {
        self.abilities.has(LAYER_MAPS) && self.first_layer_maps != 0
    }

    /// The textures of these layers of the principled material number `index`.
    pub(super) fn layer_maps(&self, index: u32) -> LayerMapsView<'a> {
        let first = self.first_layer_maps + index * LayerMaps::ROWS;
        LayerMapsView { rows: self.rows, first }
    }

    /// Whether there is a hole where `ray` made `hit`. What is half transparent has holes by
    /// chance, which the ray's own bits decide.
    pub fn is_hole(&self, ray: &Ray, hit: &Hit) -> bool {
        let triangle = self.triangle(self.bvh.place(hit.triangle).entry);
        let material = self.material(triangle.material);
        if material.kind.0 != MaterialKind::PRINCIPLED.0 {
            return false;
        }
        let layers = self.layers(triangle.material);
        if !layers.has_holes() {
            return false;
        }
        let mut alpha = layers.alpha;
        let has_attributes = triangle.attributes != NO_ATTRIBUTES;
        if self.abilities.has(VERTEX_COLOURS) && has_attributes {
            alpha *= self.colour(triangle.attributes, hit).w;
        }
        let is_textured = material.texture != NO_TEXTURE && has_attributes;
        if self.abilities.has(TEXTURES) && is_textured {
            let attributes = self.attributes(triangle.attributes, NO_INSTANCE);
            let place = self.coordinates(&attributes, triangle.attributes, hit);
            alpha *= self.textures.codes(material.texture, place).w;
        }
        let Vec3 { x, y, z } = ray.direction;
        let bits = hash(x.to_bits() ^ hash(y.to_bits() ^ hash(z.to_bits() ^ hit.t.to_bits())));
        layers.is_hole(alpha, unit_float(bits))
    }

    /// Whether paths know which bodies they are in.
    #[inline(always)]
    pub fn has_media(&self) -> bool {
        self.abilities.has(MEDIA) && self.media.is_some()
    }

    /// The body behind the front of what `hit` is on.
    pub fn body(&self, hit: &Hit) -> Body {
        self.media.body(self.triangle(self.bvh.place(hit.triangle).entry).material)
    }

    /// What bounds the body of the material number `index`, seen `from_front`, against what is on
    /// the other side.
    fn interface(&self, index: u32, from_front: bool, sides: Sides) -> Interface {
        let other = if from_front { sides.here } else { sides.beyond };
        self.media.interface(self.media.body(index).number, other.there())
    }

    /// What the camera is in.
    #[inline(always)]
    pub fn media_of_camera(&self) -> Media {
        if self.has_media() { self.media.of_camera() } else { Media::NONE }
    }

    /// What the front of the light number `index` is in.
    #[inline(always)]
    pub fn media_of_light(&self, index: u32) -> Media {
        if self.has_media() { self.media.of_light(index) } else { Media::NONE }
    }

    /// The share of light that is left after this `distance`, in world units, through `media`.
    #[inline(always)]
    pub fn transmittance(&self, media: Media, distance: f32) -> Vec3 {
        if self.has_media() { self.media.transmittance(media, distance) } else { Vec3::ONE }
    }

    fn albedos(&self) -> AlbedoView<'a> {
        let Self { first_albedos: first, first_anisotropic: anisotropic, .. } = *self;
        AlbedoView { rows: self.rows, first, anisotropic }
    }

    pub(super) fn material(&self, index: u32) -> Material {
        Material::from_rows(three_rows(self.rows, self.first_material + index * Material::ROWS))
    }
}

/// A point on a surface, seen along a ray.
#[derive(Clone, Copy)]
pub struct Surface<'a, F> {
    /// Where it is, and how a ray leaves it.
    pub point: SurfacePoint,
    /// The instance that it is on, or [`NO_INSTANCE`].
    pub instance: u32,
    /// Whether the ray came from the front of the triangle, the side that emits.
    pub from_front: bool,
    /// What is on both sides.
    pub sides: Sides,
    /// What the surface does with light.
    pub bsdf: Bsdf<'a, F>,
    /// Radiance of the front, linear Rec.709.
    pub emission: Vec3,
    /// See [`Triangle::light`].
    pub light: u32,
}

impl<'a, F: Abilities> Surface<'a, F> {
    /// The surface at `hit`, which `ray` made and which [is some](Hit::is_some), with what is on
    /// its two sides.
    pub fn at(surfaces: &SurfaceView<'a, F>, ray: &Ray, hit: &Hit, sides: Sides) -> Self {
        let place = surfaces.bvh.place(hit.triangle);
        let triangle = surfaces.triangle(place.entry);
        let point = surfaces.point(&place, &triangle, ray, hit);
        let mut looks = Looks::of(surfaces, hit, &triangle, &point, place.instance);
        let from_front = ray.direction.dot(point.normal) < 0.0;
        let Looks { material, layers, .. } = &mut looks;
        surfaces.bound(material, layers, triangle.material, from_front, sides);
        let Looks { material, layers, normals, tangent, heading } = looks;
        let from_outside = ray.direction.dot(normals.geometric) < 0.0;
        let grain = surfaces.grain(&layers, tangent, heading, normals.shading);
        let mapped = normals.on_side(if from_outside { 1.0 } else { -1.0 });
        let (albedos, abilities) = (surfaces.albedos(), surfaces.abilities);
        let normals = [mapped.mirroring(-ray.direction, abilities), mapped];
        Self {
            point,
            instance: place.instance,
            from_front,
            sides,
            bsdf: material.bsdf(normals, grain, from_outside, layers, albedos, abilities),
            emission: material.emission,
            light: triangle.light,
        }
    }

    /// The surface as the choice of a light for it sees it.
    #[inline(always)]
    pub fn vantage(&self) -> Vantage {
        Vantage::new(self.point.position, self.bsdf.geometric, self.bsdf.passes_light())
    }

    /// What a path is in that leaves in this direction.
    #[inline(always)]
    pub fn media_towards(&self, direction: Vec3) -> Media {
        let goes_behind = direction.dot(self.point.normal) < 0.0;
        if goes_behind == self.from_front { self.sides.beyond } else { self.sides.here }
    }

    /// Whether it emits along the ray, back to where that came from.
    pub fn emits(&self) -> bool {
        self.from_front && self.emission.max_element() > 0.0
    }
}
