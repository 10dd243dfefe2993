//! What a render computes, and what it measures of itself.

pub mod estimation;
pub mod light_cache;
pub mod pixel_filter;
pub mod reconstruction;
pub mod sampling;

use self::light_cache::LightCacheSettings;
use self::pixel_filter::PixelFilter;
use self::reconstruction::FilterKind;
use self::sampling::Sampling;
use super::scene::PreparedScene;
use super::scene::camera::camera;
use crate::names::named;
use crate::scene::{FilmSize, Scene};
use raystream_shaders::integrator::params::{self, PathParams};
use raystream_shaders::math::random;
use raystream_shaders::scene::SceneParams;
use raystream_shaders::scene::abilities::PIXEL_FILTERS;
use raystream_shaders::scene::environment::{EnvironmentHeader, NO_ENVIRONMENT};
use raystream_shaders::scene::ray::OFFSET_ROUNDINGS;

/// What a render computes; the same on every device.
#[derive(Clone, Copy, Debug)]
pub struct Settings {
    /// Picture size in pixels.
    pub size: FilmSize,
    /// Renders with different seeds are independent.
    pub seed: u32,
    /// Independent random numbers instead of Owen-scrambled Sobol points.
    pub independent_sampler: bool,
    /// Longest path in segments, at least 1.
    pub max_depth: u32,
    /// Segment after which Russian roulette may end any path, and not only dim ones, which have
    /// less than a quarter of their throughput left; above `max_depth` for no roulette.
    pub roulette_depth: u32,
    /// How path tracers look for light; `lvc` goes by [`LightCacheSettings::techniques`].
    pub techniques: Techniques,
    /// How light that falls beside a pixel's centre counts.
    pub pixel_filter: PixelFilter,
    /// How far rays start from surfaces, in roundings of the surface's largest coordinate (2^-24 of
    /// it each): enough that no surface shades itself, and no more, since what is smaller than this
    /// distance casts no shadow.
    pub ray_offset: f32,
    /// Which pixels get how many samples.
    pub sampling: Sampling,
    /// How paths are computed.
    pub integrator: IntegratorKind,
    /// Settings of the integrator `lvc`.
    pub light_cache: LightCacheSettings,
    /// What takes the noise out of the picture at the end, if anything. Samples are then split into
    /// halves, and [`Sampling::noise`] means the error that is left.
    pub denoise: Option<FilterKind>,
    /// Slots of the longest sample stream, at most 2^22 and by default as many: fewer take less
    /// memory, and bound how many paths an adaptive round traces.
    pub stream_slots: Option<u32>,
}

/// How a path's contribution is computed; see [`crate::render::integrator`].
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum IntegratorKind {
    /// The fastest way to walk one path after the other: regeneration where lanes run in step, in
    /// groups, as those of a GPU do, and else the megakernel. Both make the same contributions.
    #[default]
    Auto,
    /// One thread walks one path to its end.
    Megakernel,
    /// All paths advance by a segment at a time; after each, stream compaction removes those that
    /// have ended.
    Compaction,
    /// A fixed number of threads, each of which takes the next sample as soon as its path has
    /// ended.
    Regeneration,
    /// A pool of paths that advance by a segment at a time; stream compaction removes those that
    /// have ended, and the next samples take their places.
    Streaming,
    /// Bidirectional: paths from the lights leave vertices in a cache, to which paths from the
    /// camera connect.
    Lvc,
}

named! {
    IntegratorKind {
        Auto: "auto",
        Megakernel: "megakernel",
        Compaction: "compaction",
        Regeneration: "regeneration",
        Streaming: "streaming",
        Lvc: "lvc",
    }
}

/// How light is looked for. All are unbiased where every technique can find all light; they differ
/// in noise.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Techniques {
    /// Next-event estimation and BSDF sampling, weighed by the power heuristic.
    #[default]
    Both,
    /// Next-event estimation alone, at surfaces where it is possible.
    LightSampling,
    /// BSDF sampling alone.
    BsdfSampling,
}

impl Settings {
    /// The scene's picture size and path lengths, adaptive sampling, and the defaults of everything
    /// else: what to begin with, `Settings { seed: 7, ..Settings::for_scene(&scene) }`.
    pub fn for_scene(scene: &Scene) -> Self {
        Self {
            size: scene.film,
            seed: 0,
            independent_sampler: false,
            max_depth: scene.limits.max_depth,
            roulette_depth: scene.limits.roulette_depth,
            techniques: Techniques::default(),
            pixel_filter: PixelFilter::default(),
            ray_offset: OFFSET_ROUNDINGS,
            sampling: Sampling::default(),
            integrator: IntegratorKind::default(),
            light_cache: LightCacheSettings::default(),
            denoise: None,
            stream_slots: None,
        }
    }
}

impl Settings {
    /// How samples are spent: in halves where a filter needs them, too.
    pub fn whole_sampling(&self) -> Sampling {
        Sampling { halves: self.sampling.halves || self.denoise.is_some(), ..self.sampling }
    }

    /// The abilities that kernels need for them, beside those that a scene asks for.
    pub fn abilities(&self) -> u32 {
        if self.pixel_filter.is_pixel() { 0 } else { PIXEL_FILTERS }
    }
}

impl PreparedScene {
    /// The environment's header that a render reads.
    ///
    /// Where directions from BSDFs find the environment as well, light samples are not to be where
    /// those do well: the compensated distribution leaves out what is no brighter than the mean
    /// (Karlik, Šik, Vévoda, Skřivan, Křivánek, "MIS Compensation: Optimizing Sampling Techniques
    /// in Multiple Importance Sampling", SIGGRAPH Asia 2019). Whoever goes by light samples alone,
    /// as the light paths of `lvc` do, needs the whole.
    fn environment_header(&self, settings: &Settings) -> u32 {
        let plain = self.params.environment;
        let finds_all =
            settings.techniques == Techniques::Both && settings.integrator != IntegratorKind::Lvc;
        let compensated = plain != NO_ENVIRONMENT && finds_all;
        if compensated { plain + EnvironmentHeader::WORDS } else { plain }
    }

    /// What the tracing kernels need to know beside the scene; `threads` is 0.
    pub fn parameters(&self, settings: &Settings) -> PathParams {
        let filter = settings.pixel_filter.kernels();
        PathParams {
            threads: 0,
            seed: settings.seed,
            sampler: if settings.independent_sampler { random::INDEPENDENT } else { random::SOBOL },
            max_depth: settings.max_depth,
            roulette_depth: settings.roulette_depth,
            techniques: match settings.techniques {
                Techniques::Both => params::BOTH_TECHNIQUES,
                Techniques::LightSampling => params::LIGHT_SAMPLING_ALONE,
                Techniques::BsdfSampling => params::BSDF_SAMPLING_ALONE,
            },
            camera: camera(&self.camera, settings.size),
            scene: SceneParams {
                offset_roundings: settings.ray_offset,
                environment: self.environment_header(settings),
                ..self.params
            },
            filter: filter.kind,
            filter_radius: filter.radius,
        }
    }
}
