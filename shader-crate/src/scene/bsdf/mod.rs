//! Materials, and what they do with light: BSDFs.
//!
//! A [`Bsdf`] is a material at one point of a surface. Integrators know it by [`Bsdf::eval`],
//! [`Bsdf::pdf`], [`Bsdf::sample`] and [`Bsdf::is_delta`] alone, and never ask which kind it is. A
//! new kind is a file beside this one, a [`MaterialKind`], and a case in each of those functions.
//!
//! Directions: `incoming` points along the path towards the surface, as the ray that hit it does;
//! `direction` points away from the surface, where the path goes on. Both have unit length.

pub mod albedo;
pub mod anisotropic;
pub mod boundary;
pub mod conductor;
pub mod cover;
mod dielectric;
pub mod diffuse;
pub mod ggx;
pub mod layer_maps;
pub mod layers;
mod mirror;
pub mod principled;
pub mod reflector;
pub mod sheen;

use crate::glam::{UVec4, Vec3};
use crate::memory::device_struct;
use crate::memory::rows::{float, vector};
use crate::scene::abilities::{Abilities, COAT_NORMALS, PRINCIPLED};
use crate::scene::normals::Normals;
use albedo::AlbedoView;
use dielectric::Dielectric;
use layers::Layers;
use principled::{Facing, Principled};

/// Which BSDF a material has.
#[cfg_attr(
    not(target_arch = "spirv"),
    derive(Debug, Default, PartialEq, Eq, bytemuck::Pod, bytemuck::Zeroable)
)]
#[derive(Clone, Copy)]
#[repr(transparent)]
pub struct MaterialKind(pub u32);

impl MaterialKind {
    /// Lambert's law, both sides; may emit on the front.
    pub const DIFFUSE: Self = Self(0);
    /// Ideal mirror, both sides, without a Fresnel term.
    pub const MIRROR: Self = Self(1);
    /// Smooth boundary between vacuum (front) and a medium of index `ior` (back).
    pub const DIELECTRIC: Self = Self(2);
    /// What [`principled`] says; may emit on the front.
    pub const PRINCIPLED: Self = Self(3);
}

device_struct! {
    /// One material. 48 bytes.
    pub struct Material {
        /// Reflectance, linear Rec.709 in [0, 1]; a texture replaces it.
        pub reflectance: Vec3,
        /// Which BSDF it has.
        pub kind: MaterialKind,
        /// Radiance that the front emits, linear Rec.709; zero for most.
        pub emission: Vec3,
        /// Index of the reflectance's texture, or [`crate::scene::texture::NO_TEXTURE`].
        pub texture: u32,
        /// What a dielectric lets pass, linear Rec.709 in [0, 1], beside Fresnel's share.
        pub transmittance: Vec3,
        /// A dielectric's index of refraction, relative to the outside.
        pub ior: f32,
    }
}

impl Material {
    /// Rows of one.
    pub const ROWS: u32 = 3;

    /// Unpacks the three rows, which are the struct's memory.
    pub fn from_rows(rows: [UVec4; 3]) -> Self {
        Self {
            reflectance: vector(rows[0]),
            kind: MaterialKind(rows[0].w),
            emission: vector(rows[1]),
            texture: rows[1].w,
            transmittance: vector(rows[2]),
            ior: float(rows[2]),
        }
    }

    /// The material at a point with these normals on the side that the path came from, as lobes that
    /// [mirror](Normals::mirroring) have them and as maps do: `from_outside` says whether that is the
    /// front. Principled materials have `layers` beside, a grain (see [`Layers::grain`]), and look up
    /// `albedos`. The scene uses no more than `abilities`.
    pub fn bsdf<'a, F: Abilities>(
        &self,
        [normals, mapped]: [Normals; 2],
        grain: Vec3,
        from_outside: bool,
        layers: Layers,
        albedos: AlbedoView<'a>,
        abilities: F,
    ) -> Bsdf<'a, F> {
        Bsdf {
            kind: self.kind,
            normal: normals.shading,
            geometric: normals.geometric,
            coat: normals.coat,
            mapped,
            grain,
            from_outside,
            reflectance: self.reflectance,
            transmittance: self.transmittance,
            ior: self.ior,
            layers,
            albedos,
            abilities,
        }
    }

    /// Whether the front emits.
    pub fn emits(&self) -> bool {
        self.emission.max_element() > 0.0
    }
}

/// A direction, and what a BSDF says of it.
#[derive(Clone, Copy)]
pub struct BsdfSample {
    /// Where the path goes on; unit length.
    pub direction: Vec3,
    /// BSDF times cosine over density, by component: what a sampled path's throughput is multiplied
    /// by. A narrow lobe's BSDF and density may both overflow; their ratio does not.
    pub weight: Vec3,
    /// Density of the direction per solid angle; 0 stands for a delta distribution.
    pub pdf: f32,
    /// Index of refraction on the side of the light's arrival over that on the path's side: 1 where
    /// the path does not cross the surface. Radiance that crosses is scaled by `1 / eta^2` (Veach
    /// 1997, section 5.2.2), which `weight` contains.
    pub eta: f32,
}

impl BsdfSample {
    /// Whether it is of a delta distribution and crosses the surface, of which this is the shading
    /// normal.
    pub fn is_transmitted(&self, normal: Vec3) -> bool {
        self.pdf == 0.0 && self.direction.dot(normal) < 0.0
    }
}

/// A material at a point of a surface.
#[derive(Clone, Copy)]
pub struct Bsdf<'a, F> {
    /// Which one.
    pub kind: MaterialKind,
    /// Shading normal, unit length, on the side of the shading frame that the path came from, for
    /// lobes that mirror.
    pub normal: Vec3,
    /// See [`Normals::geometric`].
    pub geometric: Vec3,
    /// Unit normal of the coat on the same side: that of the corners, or as a map of its own has it;
    /// for lobes that mirror.
    pub coat: Vec3,
    /// The normals on the same side, whoever looks.
    pub mapped: Normals,
    /// See [`Layers::grain`].
    pub grain: Vec3,
    /// Whether the path came from the front of the shading frame (outside, for a dielectric).
    pub from_outside: bool,
    /// Reflectance, looked up in its texture, linear Rec.709 in [0, 1].
    pub reflectance: Vec3,
    /// See [`Material::transmittance`].
    pub transmittance: Vec3,
    /// See [`Material::ior`].
    pub ior: f32,
    /// What a principled material has beside these.
    pub layers: Layers,
    /// The tables of a principled material.
    pub albedos: AlbedoView<'a>,
    /// What the scene uses.
    pub abilities: F,
}

impl<F: Abilities> Bsdf<'_, F> {
    /// Whether all of it is delta distributions: no direction but a sampled one carries any light,
    /// so that looking for lights from here is in vain.
    pub fn is_delta(&self) -> bool {
        self.kind.0 != MaterialKind::DIFFUSE.0 && !self.is_principled()
    }

    /// Whether all of it is Lambert's law: what it sends on depends on where light came from
    /// through its flux alone.
    pub fn is_diffuse(&self) -> bool {
        self.kind.0 == MaterialKind::DIFFUSE.0
    }

    /// Whether light from behind the surface goes on to where the path came from, not by delta
    /// distributions alone.
    pub fn passes_light(&self) -> bool {
        self.is_principled() && self.layers.transmission > 0.0
    }

    fn is_principled(&self) -> bool {
        self.abilities.has(PRINCIPLED) && self.kind.0 == MaterialKind::PRINCIPLED.0
    }

    fn eval_principled(&self, incoming: Vec3, direction: Vec3) -> BsdfSample {
        if !self.keeps_side(direction) {
            return BsdfSample { direction, weight: Vec3::ZERO, pdf: 0.0, eta: 1.0 };
        }
        self.principled(self.facing()).eval(self.from_outside, incoming, direction)
    }

    /// Whether `direction` is on the same side of the triangle as of the normal that a map has
    /// bent. Light must not pass a wall because it is above the bumps that a map feigns. A coat that
    /// faces elsewhere says by itself what of the triangle's side it reflects.
    fn keeps_side(&self, direction: Vec3) -> bool {
        let above = direction.dot(self.geometric);
        let is_coats = self.abilities.has(COAT_NORMALS) && above > 0.0;
        is_coats || direction.dot(self.normal) * above > 0.0
    }

    /// What faces the side that the path came from.
    fn facing(&self) -> Facing {
        let Self { normal, geometric, coat, mapped, .. } = *self;
        Facing { normal, geometric, coat, base: mapped.shading }
    }

    /// The material whose lobes face this way.
    fn principled(&self, facing: Facing) -> Principled<'_, F> {
        let Self { reflectance, layers, grain, ior, albedos, abilities, .. } = *self;
        Principled { colour: reflectance, layers, facing, grain, ior, albedos, abilities }
    }

    /// What it says of a given `direction`. Density 0: no light comes from there. Delta
    /// distributions are left out.
    #[inline(always)]
    pub fn eval(&self, incoming: Vec3, direction: Vec3) -> BsdfSample {
        if self.is_principled() {
            return self.eval_principled(incoming, direction);
        }
        BsdfSample {
            direction,
            weight: self.reflectance,
            pdf: self.pdf(incoming, direction),
            eta: 1.0,
        }
    }

    /// The density, per solid angle, with which [`Self::sample`] picks `direction`; delta
    /// distributions are left out.
    #[inline(always)]
    pub fn pdf(&self, incoming: Vec3, direction: Vec3) -> f32 {
        if self.is_principled() {
            self.eval_principled(incoming, direction).pdf
        } else if self.is_delta() {
            0.0
        } else {
            diffuse::pdf(self.normal, direction)
        }
    }

    /// The density with which a path that arrives from `direction` goes on back along `incoming`;
    /// delta distributions are left out.
    #[inline(always)]
    pub fn pdf_back(&self, incoming: Vec3, direction: Vec3) -> f32 {
        if self.is_principled() {
            self.eval_back(incoming, direction).pdf
        } else if self.is_delta() {
            0.0
        } else {
            let crosses = direction.dot(self.normal) < 0.0;
            diffuse::pdf(if crosses { -self.normal } else { self.normal }, -incoming)
        }
    }

    /// What a principled material says of light from where the path arrived along `incoming`, as
    /// `direction` sees it.
    fn eval_back(&self, incoming: Vec3, direction: Vec3) -> BsdfSample {
        let crosses = direction.dot(self.geometric) < 0.0;
        let mapped = self.mapped.on_side(if crosses { -1.0 } else { 1.0 });
        let Normals { shading: normal, geometric, coat } =
            mapped.mirroring(direction, self.abilities);
        let facing = Facing { normal, geometric, coat, base: mapped.shading };
        self.principled(facing).eval(self.from_outside != crosses, -direction, -incoming)
    }

    /// What flux that arrived along `incoming` is multiplied by where `sample` was picked: the BSDF
    /// with the directions changed, times the cosine of `sample`, over its density (Veach 1997,
    /// section 3.7.6). Flux that crosses a boundary is not squeezed. A sample that is lost is lost to
    /// flux, too: the density is none of its lobe, or of none.
    pub fn weight_of_flux(&self, incoming: Vec3, sample: &BsdfSample) -> Vec3 {
        if self.is_principled() && sample.weight.max_element() > 0.0 {
            let back = self.eval_back(incoming, sample.direction);
            let here = self.normal.dot(incoming).abs().max(f32::MIN_POSITIVE);
            let there = self.normal.dot(sample.direction).abs();
            back.weight * (back.pdf / sample.pdf * (there / here))
        } else {
            sample.weight * (sample.eta * sample.eta)
        }
    }

    /// The direction in which a path goes on, from uniform numbers in [0, 1) for the direction
    /// (`u`) and for the choice of the lobe.
    pub fn sample(&self, incoming: Vec3, u: [f32; 2], lobe: f32) -> BsdfSample {
        if self.is_principled() {
            let material = self.principled(self.facing());
            let mut sample = material.sample(self.from_outside, incoming, u, lobe);
            if !self.keeps_side(sample.direction) {
                sample.weight = Vec3::ZERO;
            }
            return sample;
        }
        match self.kind {
            MaterialKind(0) => diffuse::sample(self.reflectance, self.normal, u),
            MaterialKind(2) => Dielectric {
                ior: self.ior,
                reflectance: self.reflectance,
                transmittance: self.transmittance,
            }
            .sample(self.normal, self.from_outside, incoming, lobe),
            _ => mirror::sample(self.reflectance, self.normal, incoming),
        }
    }
}
