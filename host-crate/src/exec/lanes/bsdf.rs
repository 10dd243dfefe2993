//! Where `N` paths go on: [`raystream_shaders::scene::bsdf`] side by side.

use super::directions::{diffuse_pdf, sample_cosine_hemisphere};
use super::numbers::{Floats, Mask, Words};
use super::scene::Scene;
use super::surface::Surfaces;
use super::vectors::Vectors;
use glam::Vec3;
use raystream_shaders::math::random::unit_float;
use raystream_shaders::memory::rows::three_rows;
use raystream_shaders::scene::bsdf::albedo::AlbedoView;
use raystream_shaders::scene::bsdf::layers::Layers;
use raystream_shaders::scene::bsdf::{BsdfSample, Material, MaterialKind};
use raystream_shaders::scene::normals::Normals;

/// A [`BsdfSample`] for each lane.
pub struct Samples<const N: usize> {
    /// Where paths go on.
    pub directions: Vectors<N>,
    /// What their throughputs are multiplied by.
    pub weights: Vectors<N>,
    /// Densities; 0 for delta distributions.
    pub pdfs: Floats<N>,
}

impl<const N: usize> Surfaces<N> {
    /// Lanes whose surfaces are not all delta distributions.
    #[inline(always)]
    pub fn are_diffuse(&self) -> Mask<N> {
        self.kinds.is(MaterialKind::DIFFUSE.0)
    }
}

impl<const N: usize> Samples<N> {
    /// Those of lanes that go on, by a uniform point of the unit square and bits for the choice of
    /// a lobe.
    #[inline(always)]
    pub fn of(
        scene: &Scene<'_>,
        goes_on: Mask<N>,
        surfaces: &Surfaces<N>,
        incoming: Vectors<N>,
        u: [Floats<N>; 2],
        choice: Words<N>,
    ) -> Self {
        let directions = sample_cosine_hemisphere(surfaces.normals, u);
        let pdfs = diffuse_pdf(surfaces.normals, directions);
        let mut samples = Self {
            directions,
            weights: surfaces.reflectances,
            pdfs: pdfs.max(Floats::splat(f32::MIN_POSITIVE)),
        };
        let others = goes_on & !surfaces.are_diffuse();
        if !others.any() {
            return samples;
        }
        samples.directions =
            others.choose_vectors(reflected(incoming, surfaces.normals), samples.directions);
        samples.pdfs = others.choose(Floats::splat(0.0), samples.pdfs);
        let others = goes_on & surfaces.kinds.is(MaterialKind::DIELECTRIC.0);
        if others.any() {
            for lane in 0..N {
                if others.holds(lane) {
                    let lobe = unit_float(choice.0[lane]);
                    samples.set(lane, &one(scene, lane, surfaces, incoming.get(lane), lobe));
                }
            }
        }
        samples
    }

    #[inline(always)]
    fn set(&mut self, lane: usize, sample: &BsdfSample) {
        self.directions.set(lane, sample.direction);
        self.weights.set(lane, sample.weight);
        self.pdfs.0[lane] = sample.pdf;
    }
}

/// At an ideal mirror.
#[inline(always)]
fn reflected<const N: usize>(incoming: Vectors<N>, normals: Vectors<N>) -> Vectors<N> {
    let twice = Floats::splat(2.0) * incoming.dot(normals);
    (incoming - normals * twice).normalize()
}

/// That of a boundary, which few surfaces are.
fn one<const N: usize>(
    scene: &Scene<'_>,
    lane: usize,
    surfaces: &Surfaces<N>,
    incoming: Vec3,
    lobe: f32,
) -> BsdfSample {
    let view = &scene.view.surfaces;
    let row = view.first_material + surfaces.materials.0[lane] * Material::ROWS;
    let material = Material {
        reflectance: surfaces.reflectances.get(lane),
        ..Material::from_rows(three_rows(view.rows, row))
    };
    let normal = surfaces.normals.get(lane);
    let (normals, from_outside) = ([Normals::all(normal); 2], surfaces.from_outside.holds(lane));
    let albedos = AlbedoView { rows: view.rows, first: view.first_albedos, anisotropic: 0 };
    material
        .bsdf(normals, normal, from_outside, Layers::NONE, albedos, view.abilities)
        .sample(incoming, [0.0; 2], lobe)
}
