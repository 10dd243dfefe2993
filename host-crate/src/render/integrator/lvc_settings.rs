//! Settings of the integrator `lvc`.

/// How the light vertex cache is filled and used.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct LightCacheSettings {
    /// Light paths of each round, at least 1; by default as many as give the cache about one vertex
    /// for each pixel.
    pub light_paths: Option<u32>,
    /// Connections of each diffuse vertex of an eye path, 1 to
    /// [`MAX_CONNECTIONS`](raystream_shaders::integrator::lvc::MAX_CONNECTIONS); by default 1 or 2,
    /// by how many vertices a light path has.
    pub connections: Option<u32>,
    /// What finds light.
    pub techniques: BidirectionalTechniques,
}

/// What finds light in `lvc`. All are unbiased, since the weights know of it; they differ in noise.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum BidirectionalTechniques {
    /// All techniques.
    #[default]
    All,
    /// Eye paths that run into lights alone.
    Emission,
    /// What the path tracer does: running into lights and next-event estimation.
    WithoutConnections,
    /// Connections, and running into lights.
    WithoutLightSampling,
    /// Connections wherever they can, the others for what they cannot find.
    Connections,
}

/// What counts as next to nothing beside one sample in [`BidirectionalTechniques::Connections`];
/// weights go by its square.
const NEGLIGIBLE: f32 = 1e-3;

impl BidirectionalTechniques {
    /// Samples of emission, of next-event estimation and, as a share of those that there are, of
    /// connections, by which the techniques are weighed.
    pub fn samples(self) -> [f32; 3] {
        match self {
            Self::All => [1.0, 1.0, 1.0],
            Self::Emission => [1.0, 0.0, 0.0],
            Self::WithoutConnections => [1.0, 1.0, 0.0],
            Self::WithoutLightSampling => [1.0, 0.0, 1.0],
            Self::Connections => [NEGLIGIBLE, NEGLIGIBLE, 1.0],
        }
    }
}
