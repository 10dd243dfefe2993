//! Renders that go on from checkpoints.

use raystream::exec::Executor;
use raystream::exec::cpu::CpuExecutor;
use raystream::film::Film;
use raystream::render::{
    AllocatorKind, Budget, Checkpoint, Estimator, FilterKind, IntegratorKind, PreparedScene,
    RenderError, Renderer, Sampling, Settings, Stop, Watch, run, run_watched,
};
use raystream::scene::FilmSize;
use raystream_tests::executors::Hindered;
use raystream_tests::{prepare, scenes, with_gpu};
use std::cell::Cell;

const SAMPLES: u32 = 41;

/// Ends a run after some of the places where a checkpoint may be taken.
struct StopAt {
    left: Cell<u32>,
}

impl<E: Executor> Watch<E> for StopAt {
    fn is_interrupted(&self) -> bool {
        self.left.get() == 0
    }

    fn keeps_checkpoints(&self) -> bool {
        true
    }

    fn may_checkpoint(&mut self, _: &Renderer<E>) -> Result<(), RenderError> {
        self.left.set(self.left.get().saturating_sub(1));
        Ok(())
    }
}

fn finish<E: Executor>(mut renderer: Renderer<E>) -> Film {
    run(&mut renderer, Budget::samples(SAMPLES), &|| false, &mut |_| ()).unwrap();
    renderer.finish_features().unwrap();
    renderer.film().unwrap()
}

/// Renders with a new renderer for every few checkpoints; the film, and how many breaks there were.
fn with_breaks<E: Executor>(
    executor: &E,
    scene: &PreparedScene,
    settings: &Settings,
    every: u32,
) -> (Film, u32) {
    let mut kept: Option<Checkpoint> = None;
    for breaks in 0.. {
        let mut renderer = Renderer::new(executor, scene, settings).unwrap();
        if let Some(kept) = &kept {
            renderer.restore(kept).unwrap();
            assert_eq!(renderer.checkpoint().unwrap(), *kept, "nothing is lost on the way");
        }
        let mut watch = StopAt { left: Cell::new(every) };
        let outcome = run_watched(&mut renderer, Budget::samples(SAMPLES), &mut watch).unwrap();
        if outcome.stop == Stop::Samples {
            return (finish(renderer), breaks);
        }
        assert_eq!(outcome.stop, Stop::Interrupted);
        // What is asked of a film on the way must not change what comes.
        kept = Some(renderer.checkpoint().unwrap());
        renderer.finish_features().unwrap();
        renderer.film().unwrap();
    }
    unreachable!()
}

fn cases() -> Vec<(&'static str, Settings, PreparedScene)> {
    let mut scene = scenes::room(scenes::glass(1.5), 1.0);
    scene.film = FilmSize { width: 37, height: 23 };
    let prepared = || prepare(&scene);
    let settings = Settings::for_scene(&scene);
    let adaptive = |allocator, estimator| Sampling { allocator, estimator, ..settings.sampling };
    let with = |sampling| Settings { sampling, ..settings };
    let uniform = with(Sampling::UNIFORM);
    let lvc = Settings { integrator: IntegratorKind::Lvc, ..uniform };
    let short = Sampling { round_budget: Some(0.3), ..settings.sampling };
    vec![
        ("the default", settings, prepared()),
        ("uniform", uniform, prepared()),
        ("uniform in halves", Settings { denoise: Some(FilterKind::Auto), ..uniform }, prepared()),
        ("short rounds", with(short), prepared()),
        ("paper", with(adaptive(AllocatorKind::Paper, Estimator::Halves)), prepared()),
        ("lvc", lvc, prepared()),
        ("lvc, adaptive", Settings { integrator: IntegratorKind::Lvc, ..settings }, prepared()),
        (
            "relative errors",
            with(Sampling { relative: true, noise: Some(1e-4), ..settings.sampling }),
            prepared(),
        ),
        ("atomic", with(adaptive(AllocatorKind::Atomic, Estimator::Halves)), prepared()),
    ]
}

#[test]
fn breaks_do_not_change_the_film() {
    for (name, settings, scene) in cases() {
        let at_once = finish(Renderer::new(&CpuExecutor, &scene, &settings).unwrap());
        for every in [1, 2] {
            let (film, breaks) = with_breaks(&CpuExecutor, &scene, &settings, every);
            assert!(breaks > 1, "{name}: {breaks} breaks show nothing");
            assert!(film == at_once, "{name}, every {every}");
        }
    }
}

#[test]
fn breaks_do_not_change_the_film_of_a_gpu() {
    with_gpu(|gpu| {
        for (name, settings, scene) in cases().into_iter().take(2) {
            let at_once = finish(Renderer::new(gpu, &scene, &settings).unwrap());
            let (film, _) = with_breaks(gpu, &scene, &settings, 2);
            assert_eq!(film, at_once, "{name}");
        }
    });
}

/// Streams too short for a sample of every pixel: breaks come within rounds.
#[test]
fn breaks_within_a_round() {
    let (_, settings, scene) = cases().swap_remove(1);
    let at_once = finish(Renderer::new(&CpuExecutor, &scene, &settings).unwrap());
    let small = Hindered::by_buffers(&CpuExecutor, 32 << 9);
    let within = Cell::new(false);
    let mut renderer = Renderer::new(&small, &scene, &settings).unwrap();
    for _ in 0..5 {
        let mut watch = StopAt { left: Cell::new(1) };
        run_watched(&mut renderer, Budget::samples(SAMPLES), &mut watch).unwrap();
        let kept = renderer.checkpoint().unwrap();
        within.set(within.get() || kept.progress.rest != Default::default());
        renderer = Renderer::new(&small, &scene, &settings).unwrap();
        renderer.restore(&kept).unwrap();
    }
    assert!(within.get(), "no break came within a round");
    assert_eq!(finish(renderer), at_once);
}

#[test]
fn a_checkpoint_of_another_render_is_refused() {
    let mut cases = cases();
    let (_, lvc, scene) = cases.swap_remove(5);
    let (_, uniform, _) = cases.swap_remove(1);
    let kept = Renderer::new(&CpuExecutor, &scene, &lvc).unwrap().checkpoint().unwrap();
    let refused = |settings: Settings| {
        let mut renderer = Renderer::new(&CpuExecutor, &scene, &settings).unwrap();
        matches!(renderer.restore(&kept), Err(RenderError::CheckpointDiffers))
    };
    assert!(!refused(lvc));
    assert!(refused(uniform), "the splats have no place");
    assert!(refused(Settings { size: FilmSize { width: 23, height: 37 }, ..lvc }));
}

/// The first samples of one film and the others of another are all samples.
#[test]
fn skipped_samples_are_those_of_another_film() {
    let settings_of_halves = |s: Settings| Settings { denoise: Some(FilterKind::Bilateral), ..s };
    let (_, uniform, scene) = cases().swap_remove(1);
    for settings in [uniform, settings_of_halves(uniform)] {
        let film = |from: u32, to: u32| {
            let mut renderer = Renderer::new(&CpuExecutor, &scene, &settings).unwrap();
            renderer.skip_samples(from).unwrap();
            let budget = Budget::samples(to - from);
            run(&mut renderer, budget, &|| false, &mut |_| ()).unwrap();
            let sums = renderer.checkpoint().unwrap();
            let film = renderer.film().unwrap();
            assert_eq!(renderer.checkpoint().unwrap(), sums, "to look at it changes nothing");
            assert_eq!(film.denoised.is_some(), settings.denoise.is_some());
            sums
        };
        let (all, first, second) = (film(0, 16), film(0, 7), film(7, 16));
        assert!(second.radiance.iter().all(|pixel| pixel.samples() == 9));
        let ((all, first), second) = ((&all.radiance, &first.radiance), &second.radiance);
        for ((all, first), second) in all.iter().zip(first).zip(second) {
            let mut sum = *first;
            sum.add_sums(second);
            assert_eq!(sum, *all, "the same samples");
        }
    }
}
