//! Renders whose own device is lost.

use raystream::exec::cpu::CpuExecutor;
use raystream::exec::{ExecError, Executor};
use raystream::render::{
    Budget, Checkpoint, IntegratorKind, Kept, LocalWorker, PreparedScene, Progress, Relay,
    RenderError, Renderer, Sampling, Settings, Watch, run_watched,
};
use raystream::scene::FilmSize;
use raystream_tests::executors::Hindered;
use raystream_tests::{prepare, scenes};
use std::time::Duration;

const SAMPLES: u32 = 24;

/// Keeps states for the next device.
struct Keeping<'a> {
    kept: &'a mut Kept,
    batches: u32,
}

impl<E: Executor> Watch<E> for Keeping<'_> {
    fn batch_ended(&mut self, _: &Progress) {
        self.batches += 1;
    }

    fn may_checkpoint(&mut self, renderer: &Renderer<E>) -> Result<(), RenderError> {
        Ok(self.kept.may_keep(renderer)?)
    }
}

/// A device that is lost after so many runs, or never.
type Lossy = &'static Hindered<'static, CpuExecutor>;

fn lossy(runs: u32) -> Lossy {
    Box::leak(Box::new(Hindered::lost_after(&CpuExecutor, runs)))
}

/// What a render on these devices comes to, how many it took, and paths that one of them at most
/// did not trace again.
fn rendered(
    (scene, settings): (&PreparedScene, &Settings),
    devices: Vec<Lossy>,
    has_workers: bool,
) -> Result<(Checkpoint, usize, u64), RenderError> {
    let (mut legs, mut kept) = (0, 0);
    let mut relay = Relay::new(devices, None).with_interval(Duration::ZERO);
    let state = relay.run(|leg| {
        legs += 1;
        let mut renderer = Renderer::new(*leg.device, scene, settings)?;
        for other in leg.others.iter().filter(|_| has_workers) {
            renderer.add_worker(Box::new(LocalWorker::new(*other, scene, settings)?));
        }
        if let Some(from) = leg.from {
            renderer.restore(from)?;
            kept = kept.max(renderer.paths());
        }
        let mut watch = Keeping { kept: leg.kept, batches: 0 };
        run_watched(&mut renderer, Budget::samples(SAMPLES), &mut watch)?;
        assert!(watch.batches > 0 || leg.from.is_some());
        Ok(renderer.checkpoint()?)
    })?;
    Ok((state, legs, kept))
}

fn cases() -> Vec<(&'static str, Settings, PreparedScene)> {
    let mut scene = scenes::room(scenes::glass(1.5), 1.0);
    scene.film = FilmSize { width: 31, height: 17 };
    let settings = Settings::for_scene(&scene);
    let uniform = Settings { sampling: Sampling::UNIFORM, ..settings };
    [
        ("the default", settings),
        ("uniform", uniform),
        ("lvc", Settings { integrator: IntegratorKind::Lvc, ..uniform }),
    ]
    .into_iter()
    .map(|(name, settings)| (name, settings, prepare(&scene)))
    .collect()
}

/// Whenever the device that has the film is lost, the next one makes the film that it would have
/// made.
#[test]
fn the_next_device_goes_on() {
    for (name, settings, scene) in cases() {
        let job = (&scene, &settings);
        let (alone, legs, _) = rendered(job, vec![lossy(u32::MAX)], false).unwrap();
        assert_eq!(legs, 1);
        let mut most = (0, 0);
        for runs in [0, 1, 2, 3, 5, 8, 13, 21, 34] {
            for has_workers in [false, true] {
                // The second one is lost, too, and as a worker it may be lost before.
                let devices = vec![lossy(runs), lossy(2 * runs), lossy(u32::MAX)];
                let (state, legs, kept) = rendered(job, devices, has_workers).unwrap();
                let what = format!("{name}, lost after {runs} runs, workers: {has_workers}");
                assert!(state.radiance == alone.radiance, "{what}: other sums");
                assert!(state.splats == alone.splats, "{what}: other splats");
                assert_eq!(state.progress.paths, alone.progress.paths, "{what}");
                most = (most.0.max(legs), most.1.max(kept));
            }
        }
        assert_eq!(most.0, 3, "{name}: no device was lost");
        assert!(most.1 > 0, "{name}: nothing was kept of what was traced");
    }
}

#[test]
fn the_last_device_that_is_lost_ends_the_render() {
    let (_, settings, scene) = cases().swap_remove(0);
    let error = rendered((&scene, &settings), vec![lossy(2), lossy(3)], false).unwrap_err();
    assert!(matches!(error, RenderError::Exec(ExecError::Device { .. })), "{error}");
    assert!(error.to_string().contains("it was to be lost"), "{error}");
}

/// What another device would fail at as well is no reason to try one.
#[test]
fn other_errors_end_the_render_at_once() {
    let mut legs = 0;
    let mut relay = Relay::new(vec![CpuExecutor; 3], None);
    let ended: Result<(), _> = relay.run(|_| {
        legs += 1;
        Err(RenderError::CheckpointDiffers)
    });
    assert!(matches!(ended, Err(RenderError::CheckpointDiffers)) && legs == 1);
}
