//! What rounds work on.

use crate::exec::{Array, ExecError, Executor, Launch, SceneBuffers, halve_until_it_fits};
use crate::render::allocator::{Allocation, RoundBuffers, Stream};
use crate::render::film::{FilmBuffers, WINDOW_ALIGNMENT};
use crate::render::integrator::first_hits::first_hits;
use crate::render::integrator::{Integrator, IntegratorContext, StreamBuffers};
use crate::render::scene::PreparedScene;
use crate::render::settings::Settings;
use raystream_shaders::film::Contribution;
use raystream_shaders::film::stream::Slot;
use raystream_shaders::integrator::params::PathParams;
use raystream_shaders::math::fixed::unit_exponent;

/// Slots of the largest stream: 2^22 contributions are 134 MB, and four million paths fill any GPU.
pub const MAX_STREAM: u32 = 1 << 22;

/// A device and what a render has there.
pub struct DeviceState<E: Executor> {
    /// The device.
    pub executor: E,
    /// The scene.
    pub scene: SceneBuffers<E::Buffer>,
    /// The film.
    pub film: FilmBuffers<E::Buffer>,
    /// What is the same for all paths; `threads` is 0.
    pub parameters: PathParams,
    /// How the stream is traced.
    pub integrator: Box<dyn Integrator<E>>,
    /// The sample stream.
    pub slots: Array<E::Buffer, Slot>,
    /// What comes of it.
    pub contributions: Array<E::Buffer, Contribution>,
}

impl<E: Executor> DeviceState<E> {
    /// Copies the scene to the device, and makes a black film and an integrator: `create` is given
    /// what that may look at and how many slots its streams have at most.
    pub fn new<C>(
        executor: E,
        scene: &PreparedScene,
        settings: &Settings,
        create: C,
    ) -> Result<Self, ExecError>
    where
        C: FnOnce(&IntegratorContext<'_, E>, u32) -> Result<Box<dyn Integrator<E>>, ExecError>,
    {
        let scene_buffers = scene.buffers_for(&executor, settings.abilities())?;
        let parameters = scene.parameters(settings);
        let unit_exponent = unit_exponent(parameters.scene.brightest);
        let film = FilmBuffers::new(&executor, settings.size, unit_exponent)?;
        let (slots, contributions) = allocate_stream(&executor, settings.stream_slots)?;
        let context = IntegratorContext {
            executor: &executor,
            scene: &scene_buffers,
            parameters: &parameters,
            settings,
        };
        let integrator = create(&context, slots.len() as u32)?;
        let scene = scene_buffers;
        Ok(Self { executor, scene, film, parameters, integrator, slots, contributions })
    }

    /// Traces the samples of a window, all at once, and adds them to the film.
    pub fn sample(
        &self,
        allocation: &Allocation<E>,
        buffers: &RoundBuffers<'_, E::Buffer>,
        window: &Stream,
    ) -> Result<(), ExecError> {
        let mut launches = allocation.fill(buffers, window);
        launches.extend(self.integrator.trace(&self.stream_buffers(), 0..window.slots));
        launches.extend(allocation.accumulate(buffers, window));
        self.executor.run_parts(&[&launches])?;
        Ok(())
    }

    /// What the integrator works on.
    pub fn stream_buffers(&self) -> StreamBuffers<'_, E::Buffer> {
        StreamBuffers {
            scene: &self.scene,
            parameters: &self.parameters,
            slots: &self.slots,
            contributions: &self.contributions,
        }
    }

    /// Launches that trace the features of all pixels, until each has `samples` camera rays.
    pub fn first_hits(&self, samples: u32) -> Vec<Launch<'_, E::Buffer>> {
        let bands = self.film.bands().iter();
        bands
            .map(|band| {
                let pixels = 0..band.film.len() as u32;
                first_hits(&self.scene, &self.parameters, band, &pixels, samples)
            })
            .collect()
    }
}

/// The sample stream and its contributions: of `wanted` slots or else as large as useful, and as
/// the device has room for.
#[expect(clippy::type_complexity, reason = "a pair, taken apart at once")]
fn allocate_stream<E: Executor>(
    executor: &E,
    wanted: Option<u32>,
) -> Result<(Array<E::Buffer, Slot>, Array<E::Buffer, Contribution>), ExecError> {
    let fitting = executor.limits().buffer_bytes / size_of::<Contribution>() as u64;
    // The smallest window of the film must fit.
    let wanted = wanted.unwrap_or(MAX_STREAM).clamp(WINDOW_ALIGNMENT, MAX_STREAM);
    let capacity = u64::from(wanted).min(fitting) as u32;
    halve_until_it_fits(capacity, 4 * WINDOW_ALIGNMENT, |capacity| {
        let slots = Array::zeroed(executor, "the sample stream", capacity as usize)?;
        Ok((slots, Array::zeroed(executor, "contributions", capacity as usize)?))
    })
}
