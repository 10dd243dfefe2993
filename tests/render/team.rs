//! Renders on several devices.

use raystream::exec::cpu::CpuExecutor;
use raystream::exec::{Device, ExecError, Executor};
use raystream::render::allocator::Stream;
use raystream::render::{
    AllocatorKind, Budget, Checkpoint, Estimator, FilterKind, IntegratorKind, Link, LocalWorker,
    Peer, PreparedScene, RemoteWorker, Renderer, Sampling, Settings, Timings, Way, Worker, run,
    serve,
};
use raystream::scene::FilmSize;
use raystream_shaders::film::Contribution;
use raystream_shaders::film::stream::Slot;
use raystream_shaders::film::sums::PixelSums;
use raystream_tests::statistics::assert_same_expectation;
use raystream_tests::{prepare, scenes, with_gpu};
use std::collections::HashMap;
use std::ops::Range;
use std::sync::mpsc::{Receiver, Sender, channel};
use std::sync::{Arc, Mutex};
use std::thread;
use std::time::Duration;

const SAMPLES: u32 = 40;

fn cases() -> Vec<(&'static str, Settings, PreparedScene)> {
    let mut scene = scenes::room(scenes::glass(1.5), 1.0);
    scene.film = FilmSize { width: 37, height: 23 };
    let settings = Settings::for_scene(&scene);
    let adaptive = |allocator, estimator| {
        let sampling = Sampling { allocator, estimator, ..settings.sampling };
        Settings { sampling, ..settings }
    };
    let uniform = Settings { sampling: Sampling::UNIFORM, ..settings };
    // Streams that are shorter than a round.
    let short = Settings { stream_slots: Some(1 << 12), ..settings };
    [
        ("the default", settings),
        ("uniform", uniform),
        ("uniform in halves", Settings { denoise: Some(FilterKind::Bilateral), ..uniform }),
        ("short streams", short),
        ("short uniform streams", Settings { stream_slots: Some(1 << 12), ..uniform }),
        ("paper", adaptive(AllocatorKind::Paper, Estimator::Halves)),
        ("atomic", adaptive(AllocatorKind::Atomic, Estimator::Variance)),
        ("lvc", Settings { integrator: IntegratorKind::Lvc, ..uniform }),
        ("lvc, adaptive", Settings { integrator: IntegratorKind::Lvc, ..settings }),
        ("streaming", Settings { integrator: IntegratorKind::Streaming, ..settings }),
    ]
    .into_iter()
    .map(|(name, settings)| (name, settings, prepare(&scene)))
    .collect()
}

/// What a render with these workers comes to.
fn rendered<E: Executor>(
    executor: E,
    (scene, settings): (&PreparedScene, &Settings),
    workers: Vec<Box<dyn Worker>>,
) -> Checkpoint {
    let mut renderer = Renderer::new(executor, scene, settings).unwrap();
    workers.into_iter().for_each(|worker| renderer.add_worker(worker));
    let outcome = run(&mut renderer, Budget::samples(SAMPLES), &|| false, &mut |_| ()).unwrap();
    assert_eq!(outcome.paths, u64::from(SAMPLES * renderer.pixels()));
    let kept = renderer.checkpoint().unwrap();
    let film = renderer.film().unwrap();
    assert_eq!(film.samples().into_iter().map(u64::from).sum::<u64>(), outcome.paths);
    assert_eq!(film.radiance.iter().map(|p| u64::from(p.rays)).sum::<u64>(), outcome.rays);
    kept
}

fn worker<E: Executor + Send + 'static>(
    executor: E,
    (scene, settings): (&PreparedScene, &Settings),
) -> Box<dyn Worker> {
    Box::new(LocalWorker::new(executor, scene, settings).unwrap())
}

/// How many rounds there were, and how long batches were, may differ where nothing shows.
fn assert_same(one: &Checkpoint, other: &Checkpoint, what: &str) {
    assert!(one.radiance == other.radiance, "{what}: other sums");
    assert!(one.splats == other.splats, "{what}: other splats");
    assert_eq!(one.progress.paths, other.progress.paths, "{what}");
    assert_eq!(one.progress.uniform_samples, other.progress.uniform_samples, "{what}");
}

#[test]
fn the_film_is_that_of_one_device() {
    for (name, settings, scene) in cases() {
        let job = (&scene, &settings);
        let alone = rendered(CpuExecutor, job, Vec::new());
        for count in [1, 3] {
            let workers = (0..count).map(|_| worker(CpuExecutor, job)).collect();
            let together = rendered(CpuExecutor, job, workers);
            assert_same(&together, &alone, &format!("{name}, {count} workers"));
        }
    }
}

/// A device with room for shorter streams is sent its part in pieces.
#[test]
fn streams_may_be_longer_than_a_workers() {
    let (_, settings, scene) = cases().swap_remove(0);
    let short = Settings { stream_slots: Some(128), ..settings };
    let alone = rendered(CpuExecutor, (&scene, &settings), Vec::new());
    let workers = vec![worker(CpuExecutor, (&scene, &short))];
    let together = rendered(CpuExecutor, (&scene, &settings), workers);
    assert_same(&together, &alone, "streams of 128 slots");
}

/// The same GPU, opened twice.
#[test]
fn the_film_of_two_gpus_is_that_of_one() {
    with_gpu(|gpu| {
        for (name, settings, scene) in cases() {
            let job = (&scene, &settings);
            let alone = rendered(gpu, job, Vec::new());
            let other = Device::open("gpu").unwrap();
            let together = rendered(gpu, job, vec![worker(other, job)]);
            assert_same(&together, &alone, name);
        }
    });
}

/// A worker that fails after a number of calls.
struct Failing {
    inner: Box<dyn Worker>,
    left: u32,
}

impl Failing {
    fn count(&mut self) -> Result<(), ExecError> {
        let name = self.inner.name();
        let Some(left) = self.left.checked_sub(1) else {
            return Err(ExecError::Worker { name, reason: "it was to fail".to_owned() });
        };
        self.left = left;
        Ok(())
    }
}

impl Worker for Failing {
    fn name(&self) -> String {
        self.inner.name()
    }

    fn capacity(&self) -> u32 {
        self.inner.capacity()
    }

    fn begin_round(&mut self, number: u32) -> Result<(), ExecError> {
        self.count()?;
        self.inner.begin_round(number)
    }

    fn sample(&mut self, window: &Stream) -> Result<(), ExecError> {
        self.count()?;
        self.inner.sample(window)
    }

    fn trace(&mut self, slots: &[Slot]) -> Result<Vec<Contribution>, ExecError> {
        self.count()?;
        self.inner.trace(slots)
    }

    fn take_sums(&mut self, ranks: Range<u32>) -> Result<Vec<PixelSums>, ExecError> {
        self.count()?;
        self.inner.take_sums(ranks)
    }

    fn add_sums(&mut self, first: u32, sums: &[PixelSums]) -> Result<(), ExecError> {
        self.count()?;
        self.inner.add_sums(first, sums)
    }
}

/// Whenever a worker is lost, nothing is: what it was to do is done again.
#[test]
fn a_lost_worker_loses_nothing() {
    for (name, settings, scene) in cases() {
        let job = (&scene, &settings);
        let alone = rendered(CpuExecutor, job, Vec::new());
        for left in (0..6).chain([9, 14]) {
            let failing = Failing { inner: worker(CpuExecutor, job), left };
            let workers = vec![Box::new(failing) as Box<dyn Worker>, worker(CpuExecutor, job)];
            let together = rendered(CpuExecutor, job, workers);
            assert_same(&together, &alone, &format!("{name}, {left} calls before the loss"));
        }
    }
}

/// Devices of two kinds make a picture of the same expectation.
#[test]
fn a_gpu_and_the_cpu_render_together() {
    with_gpu(|gpu| {
        let (_, settings, scene) = cases().swap_remove(1);
        let film = |settings: &Settings, has_worker: bool| {
            let job = (&scene, settings);
            let mut renderer = Renderer::new(gpu, &scene, settings).unwrap();
            if has_worker {
                renderer.add_worker(worker(CpuExecutor, job));
            }
            run(&mut renderer, Budget::samples(256), &|| false, &mut |_| ()).unwrap();
            renderer.film().unwrap()
        };
        let alone = film(&settings, false);
        let together = film(&Settings { seed: 7, ..settings }, true);
        assert!(together.samples().iter().all(|&samples| samples == 256));
        assert_same_expectation(&together, &alone, "a GPU and the CPU");
    });
}

/// One end of a link within this process, which breaks after a number of messages.
struct Channel {
    outbox: Sender<Vec<u8>>,
    inbox: Receiver<Vec<u8>>,
    left: u32,
}

impl Channel {
    fn pair(left: u32) -> (Self, Self) {
        let (near_outbox, far_inbox) = channel();
        let (far_outbox, near_inbox) = channel();
        let near = Self { outbox: near_outbox, inbox: near_inbox, left };
        (near, Self { outbox: far_outbox, inbox: far_inbox, left: u32::MAX })
    }
}

impl Link for Channel {
    fn send(&mut self, message: Vec<u8>) -> Result<(), String> {
        self.left = self.left.checked_sub(1).ok_or("it was to break")?;
        self.outbox.send(message).map_err(|_| "nobody is there".to_owned())
    }

    fn receive(&mut self) -> Result<Vec<u8>, String> {
        // A worker that is gone keeps another one waiting.
        self.inbox.recv_timeout(PATIENCE).map_err(|_| "nobody is there".to_owned())
    }
}

/// Longer than any worker here takes for anything.
const PATIENCE: Duration = Duration::from_secs(5);

/// The ways between workers, by who gives and who takes, which one of them has opened.
#[derive(Clone, Default)]
struct Ways(Arc<Mutex<HashMap<(Peer, Peer), Channel>>>);

impl Ways {
    fn open(&self, own: Peer, way: Way) -> Box<dyn Link> {
        let ends = match way {
            Way::To(other) => (own, other),
            Way::From(other) => (other, own),
        };
        let mut ways = self.0.lock().unwrap();
        let there = ways.remove(&ends);
        Box::new(there.unwrap_or_else(|| {
            let (near, far) = Channel::pair(u32::MAX);
            ways.insert(ends, far);
            near
        }))
    }
}

/// A worker at the other end of a link, in a thread of its own.
fn remote(worker: Box<dyn Worker>, left: u32) -> Box<dyn Worker> {
    Box::new(remote_one(worker, left, Peer { process: 0, worker: 0 }, Ways::default()))
}

fn remote_one(
    mut worker: Box<dyn Worker>,
    left: u32,
    own: Peer,
    ways: Ways,
) -> RemoteWorker<Channel> {
    let (near, mut far) = Channel::pair(left);
    let (name, capacity) = (worker.name(), worker.capacity());
    thread::spawn(move || serve(worker.as_mut(), &mut far, &|way| ways.open(own, way)));
    RemoteWorker::new(near, name, capacity)
}

/// Workers at the other ends of links, which can reach each other.
fn connected(workers: Vec<Box<dyn Worker>>, left: u32) -> Vec<Box<dyn Worker>> {
    let ways = Ways::default();
    let connect = |(process, worker): (u32, Box<dyn Worker>)| {
        let peer = Peer { process, worker: 0 };
        // The second one is lost after a while.
        let left = if process == 1 { left } else { u32::MAX };
        let worker = remote_one(worker, left, peer, ways.clone()).with_peer(peer);
        Box::new(worker) as Box<dyn Worker>
    };
    (0..).zip(workers).map(connect).collect()
}

/// Workers that give each other their films; at any moment one of them may be lost.
#[test]
fn films_that_workers_add_up_are_that_of_one_device() {
    for number in [1, 7] {
        let (name, settings, scene) = cases().swap_remove(number);
        let job = (&scene, &settings);
        let alone = rendered(CpuExecutor, job, Vec::new());
        for count in 1..=5 {
            let workers = (0..count).map(|_| worker(CpuExecutor, job)).collect();
            let together = rendered(CpuExecutor, job, connected(workers, u32::MAX));
            assert_same(&together, &alone, &format!("{name}, {count} workers"));
        }
        for left in 0..9 {
            let workers = (0..4).map(|_| worker(CpuExecutor, job)).collect();
            let together = rendered(CpuExecutor, job, connected(workers, left));
            assert_same(&together, &alone, &format!("{name}, {left} messages before the loss"));
        }
        for left in 0..9 {
            let mut workers: Vec<_> = (0..4).map(|_| worker(CpuExecutor, job)).collect();
            let index = left as usize % 4;
            let inner = std::mem::replace(&mut workers[index], worker(CpuExecutor, job));
            workers[index] = Box::new(Failing { inner, left });
            let together = rendered(CpuExecutor, job, connected(workers, u32::MAX));
            assert_same(&together, &alone, &format!("{name}, worker {index} fails after {left}"));
        }
    }
}

#[test]
fn the_film_of_workers_behind_links_is_that_of_one_device() {
    for (name, settings, scene) in cases() {
        let job = (&scene, &settings);
        let alone = rendered(CpuExecutor, job, Vec::new());
        let workers = (0..2).map(|_| remote(worker(CpuExecutor, job), u32::MAX)).collect();
        assert_same(&rendered(CpuExecutor, job, workers), &alone, name);
        for left in [0, 1, 3, 8] {
            let workers = vec![
                remote(worker(CpuExecutor, job), left),
                remote(worker(CpuExecutor, job), u32::MAX),
            ];
            let together = rendered(CpuExecutor, job, workers);
            assert_same(&together, &alone, &format!("{name}, a link breaks after {left}"));
        }
    }
}

/// A worker that fails at the other end is left out like one that fails here.
#[test]
fn failures_come_through_links() {
    let (name, settings, scene) = cases().swap_remove(1);
    let job = (&scene, &settings);
    let alone = rendered(CpuExecutor, job, Vec::new());
    for left in [0, 2, 5] {
        let failing = Failing { inner: worker(CpuExecutor, job), left };
        let workers = vec![remote(Box::new(failing), u32::MAX)];
        assert_same(&rendered(CpuExecutor, job, workers), &alone, name);
    }
}

/// A round that workers trace alone changes the film like any other: errors are estimated anew.
#[test]
fn estimates_follow_rounds_that_workers_trace_alone() {
    let (_, settings, scene) = cases().swap_remove(1);
    let sampling = Sampling { noise: Some(1e-6), ..settings.sampling };
    let settings = Settings { sampling, ..settings };
    let mut alone = Renderer::new(CpuExecutor, &scene, &settings).unwrap();
    let mut together = Renderer::new(CpuExecutor, &scene, &settings).unwrap();
    together.add_worker(worker(CpuExecutor, (&scene, &settings)));
    let mut seen = Vec::new();
    for _ in 0..3 {
        alone.uniform_round(6).finish().unwrap();
        let mut round = together.uniform_round(6);
        let batch = round.next_batch().unwrap().unwrap();
        assert_eq!(batch.paths, 6 * 37 * 23);
        assert_eq!(batch.timings, Timings::default(), "the render's own device has traced nothing");
        round.finish().unwrap();
        let [convergence, expected] = [&mut together, &mut alone].map(|renderer| {
            assert!(!renderer.has_converged().unwrap());
            renderer.convergence()
        });
        assert_eq!(convergence, expected);
        seen.push(expected);
    }
    assert!(seen[0] != seen[1] && seen[1] != seen[2], "{seen:?}");
}
