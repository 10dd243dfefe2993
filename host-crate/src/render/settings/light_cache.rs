//! Settings of the integrator `lvc`.

/// How the light vertex cache is filled and used.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct LightCacheSettings {
    /// Light paths of each round, at least 1; by default as many as give the cache about four
    /// vertices for each pixel, or one without light tracing.
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
    /// All but light tracing: all that is found is in the samples of pixels.
    WithoutLightTracing,
    /// Eye paths that run into lights alone.
    Emission,
    /// What the path tracer does: running into lights and next-event estimation.
    WithoutConnections,
    /// Connections, and running into lights.
    WithoutLightSampling,
    /// Connections wherever they can, running into lights and next-event estimation for what they
    /// cannot find.
    Connections,
    /// Light tracing wherever it can, running into lights and next-event estimation for what it
    /// cannot find: lamps seen directly, and what mirrors and glass show.
    LightTracing,
}

/// How many samples the techniques have in their weights.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TechniqueShares {
    /// Of running into lights.
    pub emission: f32,
    /// Of next-event estimation.
    pub light: f32,
    /// Of connections, as a share of those that there are.
    pub connection: f32,
    /// Of light tracing, likewise.
    pub camera: f32,
}

/// What counts as next to nothing beside one sample where a technique is to be used wherever it
/// can; weights go by its square.
const NEGLIGIBLE: f32 = 1e-3;

impl BidirectionalTechniques {
    /// The samples by which techniques are weighed.
    pub fn shares(self) -> TechniqueShares {
        let [emission, light, connection, camera] = match self {
            Self::All => [1.0, 1.0, 1.0, 1.0],
            Self::WithoutLightTracing => [1.0, 1.0, 1.0, 0.0],
            Self::Emission => [1.0, 0.0, 0.0, 0.0],
            Self::WithoutConnections => [1.0, 1.0, 0.0, 0.0],
            Self::WithoutLightSampling => [1.0, 0.0, 1.0, 0.0],
            Self::Connections => [NEGLIGIBLE, NEGLIGIBLE, 1.0, 0.0],
            Self::LightTracing => [NEGLIGIBLE, NEGLIGIBLE, 0.0, 1.0],
        };
        TechniqueShares { emission, light, connection, camera }
    }
}
