//! What lies over the rest of a principled material: sheen, and a clear coat over that.
//!
//! Each lets pass to what is below what it does not reflect itself, as the path sees it: `1 -
//! E(o)`, with its albedo `E`. This keeps all light, and is not the same in both directions: a path
//! from a light asks for the BSDF with the directions changed (see
//! [`super::Bsdf::weight_of_flux`]).
//!
//! A map of normals bends what is below a coat, as bumps do under varnish. The coat has the normal of
//! the corners, or a map of its own. Kernels know of that by the ability [`COAT_NORMALS`].

use super::albedo::AlbedoView;
use super::ggx::Ggx;
use super::layers::Layers;
use super::reflector::grazing;
use super::sheen;
use crate::glam::Vec3;
use crate::math::tangent_frame;
use crate::scene::abilities::{Abilities, COAT_NORMALS};

/// Reflectance of a coat at normal incidence: that of index of refraction 1.5.
const COAT_F0: f32 = 0.04;

/// Least cosine under which a coat is seen.
const JUST_SEEN: f32 = 1e-4;

/// The cover as a direction `o` sees it.
#[derive(Clone, Copy)]
pub struct Cover {
    coat: f32,
    /// Unit normal of the coat in the frame of what is below; +z where it is not bent.
    normal: Vec3,
    ggx: Ggx,
    sheen: Vec3,
    sheen_roughness: f32,
    /// What brings the sheen's albedo to 1 where it is more.
    sheen_scale: f32,
    /// Share of light that gets below.
    pub passes: f32,
    /// Share of light that gets below the coat.
    below_coat: f32,
    /// Probabilities of the lobes of the coat and of the sheen.
    pub chances: [f32; 2],
}

impl Cover {
    /// Nothing.
    pub const NONE: Self = Self {
        coat: 0.0,
        normal: Vec3::Z,
        ggx: Ggx { alpha: 1.0 },
        sheen: Vec3::ZERO,
        sheen_roughness: 1.0,
        sheen_scale: 1.0,
        passes: 1.0,
        below_coat: 1.0,
        chances: [0.0, 0.0],
    };

    /// That of `layers`, with this `normal` of the coat, over what has the albedo `below`. `albedos`
    /// are those of surfaces.
    pub fn new<F: Abilities>(
        layers: &Layers,
        normal: Vec3,
        o: Vec3,
        albedos: AlbedoView<'_>,
        below: f32,
        abilities: F,
    ) -> Self {
        let mut cosine = o.z;
        if abilities.has(COAT_NORMALS) && normal.z < 1.0 {
            cosine = normal.dot(o).clamp(JUST_SEEN, 1.0);
        }
        let coated = albedos.directional(layers.coat_roughness, cosine);
        let coat = layers.coat * (COAT_F0 * coated.x + coated.y);
        let table = AlbedoView { first: albedos.first + layers.sheen_albedos, ..albedos };
        let tint = layers.sheen.max_element();
        let mut whole = 0.0;
        if tint > 0.0 {
            whole = table.directional(sheen::place(layers.sheen_roughness), o.z).x;
        }
        let sheen_scale = 1.0 / whole.max(1.0);
        let sheen = tint * whole * sheen_scale;
        let passes = (1.0 - coat) * (1.0 - sheen);
        let (of_coat, of_sheen) = (coat, (1.0 - coat) * sheen);
        let all = (of_coat + of_sheen + passes * below).max(f32::MIN_POSITIVE);
        Self {
            coat: layers.coat,
            normal,
            ggx: Ggx::of_roughness(layers.coat_roughness),
            sheen: layers.sheen,
            sheen_roughness: layers.sheen_roughness,
            sheen_scale,
            passes,
            below_coat: 1.0 - coat,
            chances: [of_coat / all, of_sheen / all],
        }
    }

    /// A direction in the frame of the coat.
    #[inline(always)]
    fn coated<F: Abilities>(&self, abilities: F, w: Vec3) -> Vec3 {
        if !abilities.has(COAT_NORMALS) || self.normal.z >= 1.0 {
            return w;
        }
        let (x, y) = tangent_frame(self.normal);
        Vec3::new(x.dot(w), y.dot(w), self.normal.dot(w))
    }

    /// Where a path came from, in the frame of the coat and above its horizon.
    #[inline(always)]
    fn seen<F: Abilities>(&self, abilities: F, o: Vec3) -> Vec3 {
        if !abilities.has(COAT_NORMALS) || self.normal.z >= 1.0 {
            return o;
        }
        let o = self.coated(abilities, o);
        Vec3::new(o.x, o.y, o.z.max(JUST_SEEN)).normalize()
    }

    /// A direction of the frame of the coat in that of what is below.
    #[inline(always)]
    fn uncoated<F: Abilities>(&self, abilities: F, w: Vec3) -> Vec3 {
        if !abilities.has(COAT_NORMALS) || self.normal.z >= 1.0 {
            return w;
        }
        let (x, y) = tangent_frame(self.normal);
        x * w.x + y * w.y + self.normal * w.z
    }

    /// Whether a number of the choice of the lobe, in [0, 1), is one of the cover's.
    pub fn takes(&self, lobe: f32) -> bool {
        lobe < self.chances[0] + self.chances[1]
    }

    /// The number for the choice of a lobe below, where the cover [does not take](Self::takes) it.
    pub fn rest(&self, lobe: f32) -> f32 {
        let taken = self.chances[0] + self.chances[1];
        ((lobe - taken) / (1.0 - taken).max(f32::MIN_POSITIVE)).clamp(0.0, 0.999_999_94)
    }

    /// A direction, where the cover [takes](Self::takes) the lobe.
    pub fn sample<F: Abilities>(&self, abilities: F, o: Vec3, u: [f32; 2], lobe: f32) -> Vec3 {
        if lobe < self.chances[0] {
            let o = self.seen(abilities, o);
            self.uncoated(abilities, (-o).reflect(self.ggx.sample_visible(o, u)))
        } else {
            sheen::sample(u)
        }
    }

    /// BSDF times cosine, and density per solid angle, chances included, of light from `i`, above
    /// the surface, or at least above the triangle.
    pub fn reflects<F: Abilities>(&self, abilities: F, o: Vec3, i: Vec3) -> (Vec3, f32) {
        let (mut coat, mut pdf) = (0.0, 0.0);
        let (seen, coated) = (self.seen(abilities, o), self.coated(abilities, i));
        if !abilities.has(COAT_NORMALS) || coated.z > 0.0 {
            let h = (seen + coated).normalize();
            let lobe = self.ggx.distribution(h) / (4.0 * seen.z);
            let fresnel = COAT_F0 + (1.0 - COAT_F0) * grazing(seen.dot(h).clamp(0.0, 1.0));
            coat = self.coat * fresnel * self.ggx.masking_reflected(seen, coated) * lobe;
            pdf = self.chances[0] * self.ggx.masking(seen) * lobe;
        }
        let mut value = Vec3::splat(coat);
        let sees_fibres = !abilities.has(COAT_NORMALS) || i.z > 0.0;
        if self.chances[1] > 0.0 && sees_fibres {
            let fibres = sheen::value(self.sheen_roughness, o, i) * self.sheen_scale;
            value += self.sheen * (self.below_coat * fibres);
            pdf += self.chances[1] * sheen::PDF;
        }
        (value, pdf)
    }
}
