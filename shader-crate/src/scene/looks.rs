//! What a surface looks like at a point, by its corners and its textures.

use crate::glam::{Vec2, Vec3};
use crate::math::packed::{NO_TANGENT, Tangent};
use crate::scene::abilities::{
    Abilities, COAT_NORMALS, EMISSION_MAPS, NORMAL_MAPS, PRINCIPLED, TEXTURES, VERTEX_COLOURS,
};
use crate::scene::bsdf::layers::Layers;
use crate::scene::bsdf::{Material, MaterialKind};
use crate::scene::normals::Normals;
use crate::scene::ray::{Hit, SurfacePoint};
use crate::scene::surface::SurfaceView;
use crate::scene::texture::{Coordinates, NO_TEXTURE};
use crate::scene::triangle::{NO_ATTRIBUTES, Triangle};
#[cfg(target_arch = "spirv")]
use spirv_std::num_traits::Float as _;

/// What a point of a surface is made of, by the numbers of its corners and by its textures.
pub struct Looks {
    /// With the colours of vertices and textures.
    pub material: Material,
    /// With the numbers of textures.
    pub layers: Layers,
    /// Those of the front.
    pub normals: Normals,
    /// Packed, or [`NO_TANGENT`].
    pub tangent: u32,
    /// See [`Layers::grain`].
    pub heading: Vec2,
}

impl Looks {
    /// Those of the `triangle` of an `instance`, or of none, where a ray made `hit`.
    #[inline(always)]
    pub fn of<A: Abilities>(
        surfaces: &SurfaceView<'_, A>,
        hit: &Hit,
        triangle: &Triangle,
        point: &SurfacePoint,
        instance: u32,
    ) -> Self {
        let material = surfaces.material(triangle.material);
        let mut layers = Layers::NONE;
        let is_principled =
            surfaces.abilities.has(PRINCIPLED) && material.kind.0 == MaterialKind::PRINCIPLED.0;
        if is_principled {
            layers = surfaces.layers(triangle.material);
        }
        let mut looks = Self {
            material,
            layers,
            normals: Normals::all(point.normal),
            tangent: NO_TANGENT,
            heading: Vec2::X,
        };
        if triangle.attributes != NO_ATTRIBUTES {
            let a = surfaces.attributes_at(triangle.attributes, instance, hit);
            looks.normals = Normals::all(a.normal(hit, point.normal));
            looks.tangent = a.tangent;
            if surfaces.abilities.has(VERTEX_COLOURS) {
                let colour = surfaces.colour(triangle.attributes, hit);
                looks.material.reflectance *= colour.truncate();
            }
            if surfaces.abilities.has(TEXTURES) {
                let place = surfaces.coordinates(&a, triangle.attributes, hit);
                looks.look_up(surfaces, place, is_principled);
                let maps = surfaces.layer_maps(triangle.material);
                let has_maps = is_principled && surfaces.has_layer_maps();
                if has_maps {
                    let (layers, heading) = maps.applied(looks.layers, &surfaces.textures, place);
                    (looks.layers, looks.heading) = (layers, heading);
                }
                let has_normal_map = surfaces.abilities.has(NORMAL_MAPS)
                    && is_principled
                    && looks.layers.normal_map != NO_TEXTURE;
                let (tangent, corners) = (a.tangent, looks.normals.shading);
                if has_normal_map && tangent != NO_TANGENT {
                    let slopes = looks.layers.slopes(&surfaces.textures, place);
                    looks.normals.shading = mapped(corners, slopes, tangent);
                    looks.normals.geometric = point.normal;
                }
                let knows_coats = has_maps && surfaces.abilities.has(COAT_NORMALS);
                if knows_coats && maps.coat_normal() != NO_TEXTURE && tangent != NO_TANGENT {
                    let slopes = maps.coat_slopes(&surfaces.textures, place);
                    looks.normals.coat = mapped(corners, slopes, tangent);
                    looks.normals.geometric = point.normal;
                }
            }
        }
        looks
    }

    /// Multiplies the numbers of the material by what its textures say at a `place`.
    #[inline(always)]
    fn look_up<A: Abilities>(
        &mut self,
        surfaces: &SurfaceView<'_, A>,
        place: Coordinates,
        is_principled: bool,
    ) {
        let textures = &surfaces.textures;
        if self.material.texture != NO_TEXTURE {
            self.material.reflectance *= textures.reflectance(self.material.texture, place);
        }
        if is_principled {
            let map = self.layers.emission_map;
            if surfaces.abilities.has(EMISSION_MAPS) && map != NO_TEXTURE {
                self.material.emission *= textures.sample(map, place);
            }
            self.layers = self.layers.textured(textures, place);
        }
    }
}

/// The shading `normal` with a map's `slopes`: towards the tangent, towards the bitangent, and
/// along the normal.
fn mapped(normal: Vec3, slopes: Vec3, tangent: u32) -> Vec3 {
    let Tangent { direction: along, is_mirrored } = Tangent::unpack(tangent);
    let along = along - normal * normal.dot(along);
    let length = along.length_squared();
    if length <= 0.0 {
        return normal;
    }
    let along = along / length.sqrt();
    let across = normal.cross(along);
    let across = if is_mirrored { -across } else { across };
    (along * slopes.x + across * slopes.y + normal * slopes.z).normalize()
}
