//! One stream, traced by every integrator.

use super::occupancy::{self, Lanes};
use raystream::exec::{Array, ExecError, Executor, SceneBuffers};
use raystream::render::integrator::regeneration::RESIDENT;
use raystream::render::integrator::{Integrator, IntegratorContext, StreamBuffers, create};
use raystream::render::{IntegratorKind, PreparedScene, Settings, Techniques};
use raystream_shaders::film::Contribution;
use raystream_shaders::film::stream::Slot;
use raystream_shaders::integrator::params::PathParams;

/// A stream of runs of one length, in rank order.
pub struct Stream<B> {
    scene: SceneBuffers<B>,
    settings: Settings,
    parameters: PathParams,
    /// The same without light samples: paths take the same way, and their rays are their segments.
    without_shadow_rays: PathParams,
    slots: Vec<Slot>,
    slots_there: Array<B, Slot>,
    contributions: Array<B, Contribution>,
}

/// What an integrator made of it.
pub struct Traced {
    /// Slot for slot.
    pub contributions: Vec<Contribution>,
    /// Iteration by iteration.
    pub lanes: Vec<Lanes>,
}

impl<B> Stream<B> {
    /// `count` slots of the picture: as many samples of each pixel as it takes.
    pub fn new<E: Executor<Buffer = B>>(
        executor: &E,
        scene: &PreparedScene,
        settings: &Settings,
        count: u32,
    ) -> Result<Self, ExecError> {
        let pixels = settings.size.width * settings.size.height;
        let samples = count.div_ceil(pixels);
        let slots: Vec<Slot> =
            (0..count).map(|k| Slot { rank: k / samples, sample: k % samples }).collect();
        Ok(Self {
            scene: scene.buffers_for(executor, settings.abilities())?,
            settings: *settings,
            parameters: scene.parameters(settings),
            without_shadow_rays: scene
                .parameters(&Settings { techniques: Techniques::BsdfSampling, ..*settings }),
            slots_there: Array::from_slice(executor, "the sample stream", &slots)?,
            contributions: Array::zeroed(executor, "contributions", count as usize)?,
            slots,
        })
    }

    /// Traces it.
    pub fn trace<E: Executor<Buffer = B>>(
        &self,
        executor: &E,
        kind: IntegratorKind,
    ) -> Result<Traced, ExecError> {
        let settings = Settings { integrator: kind, ..self.settings };
        let context = IntegratorContext {
            executor,
            scene: &self.scene,
            parameters: &self.parameters,
            settings: &settings,
        };
        let integrator = create(&context, self.slots.len() as u32)?;
        let (contributions, active) = self.run(executor, integrator.as_ref(), &self.parameters)?;
        let lanes = if active.is_empty() {
            let (segments, _) =
                self.run(executor, integrator.as_ref(), &self.without_shadow_rays)?;
            let lengths = occupancy::lengths(&self.slots, &segments);
            match kind {
                IntegratorKind::Regeneration => {
                    occupancy::regeneration(&lengths, RESIDENT as usize)
                }
                _ => occupancy::megakernel(&lengths),
            }
        } else {
            active
                .into_iter()
                .map(|active| Lanes { active: active.into(), held: active.into() })
                .collect()
        };
        Ok(Traced { contributions, lanes })
    }

    /// Contributions, and the paths under way in each iteration where the integrator counts them.
    fn run<E: Executor<Buffer = B>>(
        &self,
        executor: &E,
        integrator: &dyn Integrator<E>,
        parameters: &PathParams,
    ) -> Result<(Vec<Contribution>, Vec<u32>), ExecError> {
        let stream = StreamBuffers {
            scene: &self.scene,
            parameters,
            slots: &self.slots_there,
            contributions: &self.contributions,
        };
        let all = || 0..self.slots.len() as u32;
        let mut launches = integrator.begin_round(&stream, 0);
        launches.extend(integrator.trace(&stream, all()));
        executor.run(&launches)?;
        Ok((self.contributions.read(executor)?, integrator.active_paths(executor, &stream, all())?))
    }
}

/// Slots whose contributions are the same bits.
pub fn identical(a: &[Contribution], b: &[Contribution]) -> u32 {
    a.iter().zip(b).filter(|(a, b)| bytemuck::bytes_of(*a) == bytemuck::bytes_of(*b)).count() as u32
}
