//! Fuzzing: inputs made of seeds by chance, and what becomes of the program with them.
//!
//! The same number is the same input, so that a failure can be made again. Without a sanitizer and
//! without the compiler's help, it needs no other toolchain; it knows what the formats are made of
//! by its seeds and words.

mod mutate;

use self::mutate::Mutator;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::time::{Duration, Instant};

/// Names how many inputs each target gets; a few thousand without it.
const INPUTS: &str = "RAYSTREAM_FUZZ_INPUTS";
/// Names the number that all inputs follow from.
const SEED: &str = "RAYSTREAM_FUZZ_SEED";
/// Inputs of a target unless told otherwise: a second or two.
const FEW: u64 = 4000;
/// The longest that an input may keep a thread busy.
const MOST_TIME: Duration = Duration::from_secs(2);
/// The longest that it may take before nothing more is waited for.
const HANGS: Duration = Duration::from_secs(60);
/// Memory that one thread may take for an input, in bytes.
const MOST_MEMORY: u64 = 1 << 30;

/// The input that a thread has, and since when.
type Watched = Mutex<Option<(Instant, Vec<u8>)>>;

/// What is fed with inputs.
pub struct Target<'a> {
    /// What it is called.
    pub name: &'static str,
    /// Good inputs, and inputs that have found something.
    pub seeds: Vec<Vec<u8>>,
    /// Words that inputs are made of.
    pub words: &'static [&'static str],
    /// Makes an input good where chance never would: its checksums.
    pub repair: fn(&mut [u8]),
    /// What is done with an input: it may fail, but neither panic nor hang.
    pub run: &'a (dyn Fn(&[u8]) + Sync),
    /// The largest amount of memory that this thread has taken since the last call, if anything
    /// counts it.
    pub peak_memory: &'a (dyn Fn() -> u64 + Sync),
}

impl Target<'_> {
    /// Runs the seeds and then as many inputs as the environment says, on all cores.
    ///
    /// # Panics
    /// If an input panics, hangs or takes too much memory. The message says where it is kept.
    pub fn fuzz(&self) {
        let number = |name, otherwise| {
            std::env::var(name).map_or(otherwise, |text: String| {
                text.parse().unwrap_or_else(|_| panic!("{name}={text}: not a number"))
            })
        };
        let (inputs, seed) = (number(INPUTS, FEW), number(SEED, 0));
        let threads = std::thread::available_parallelism().map_or(1, usize::from);
        let next = AtomicU64::new(0);
        let (started, done) = (Instant::now(), AtomicBool::new(false));
        let watched: Vec<Watched> = (0..threads).map(|_| Mutex::new(None)).collect();
        for seed in &self.seeds {
            self.check(seed, &watched[0]);
        }
        std::thread::scope(|scope| {
            let workers: Vec<_> = watched
                .iter()
                .map(|watched| {
                    scope.spawn(|| {
                        let mut mutator = Mutator::new(&self.seeds, self.words, seed);
                        loop {
                            let number = next.fetch_add(1, Ordering::Relaxed);
                            if number >= inputs {
                                return;
                            }
                            let input = mutator.input(number);
                            // Checksums that are wrong are to be tried too.
                            if !number.is_multiple_of(8) {
                                (self.repair)(input);
                            }
                            self.check(input, watched);
                        }
                    })
                })
                .collect();
            scope.spawn(|| self.watch(&watched, &done));
            let ended: Vec<_> =
                workers.into_iter().map(std::thread::ScopedJoinHandle::join).collect();
            done.store(true, Ordering::Relaxed);
            ended.into_iter().for_each(|ended| ended.expect("no input fails"));
        });
        let seconds = started.elapsed().as_secs_f64();
        println!("{}: {inputs} inputs of seed {seed} in {seconds:.1} s", self.name);
    }

    /// Runs one input.
    fn check(&self, input: &[u8], watched: &Watched) {
        let started = Instant::now();
        *watched.lock().expect("no panic here") = Some((started, input.to_vec()));
        let _ = (self.peak_memory)();
        let busy = busy(started);
        let ended = catch_unwind(AssertUnwindSafe(|| (self.run)(input)));
        let (time, memory) = (self::busy(started).saturating_sub(busy), (self.peak_memory)());
        *watched.lock().expect("no panic here") = None;
        if ended.is_err() {
            self.fail(input, "panics");
        }
        assert!(time <= MOST_TIME, "{}", self.keep(input, &format!("takes {time:?}")));
        assert!(memory <= MOST_MEMORY, "{}", self.keep(input, &format!("takes {memory} bytes")));
    }

    fn fail(&self, input: &[u8], what: &str) -> ! {
        panic!("{}", self.keep(input, what))
    }

    /// Keeps an input, and says where.
    fn keep(&self, input: &[u8], what: &str) -> String {
        let sum = input
            .iter()
            .fold(0_u32, |sum, &byte| sum.wrapping_mul(0x0100_0193).wrapping_add(byte.into()));
        let name = format!("raystream-fuzz-{}-{sum:08x}", self.name);
        let path = std::env::temp_dir().join(name);
        match std::fs::write(&path, input) {
            Ok(()) => format!("an input of {} {what}: it is kept as {}", self.name, path.display()),
            Err(error) => format!("an input of {} {what}; it cannot be kept: {error}", self.name),
        }
    }

    /// Ends the process if an input hangs, until all are done.
    fn watch(&self, watched: &[Watched], done: &AtomicBool) {
        while !done.load(Ordering::Relaxed) {
            std::thread::sleep(Duration::from_millis(20));
            for input in watched {
                let input = input.lock().expect("no panic here");
                if let Some((started, input)) = input.as_ref()
                    && started.elapsed() > HANGS
                {
                    crate::not_tested(&self.keep(input, "hangs"));
                    std::process::abort();
                }
            }
        }
    }
}

/// How long this thread has been busy, by the system: that others are busy too does not count.
#[cfg(target_os = "linux")]
fn busy(_started: Instant) -> Duration {
    let time = rustix::time::clock_gettime(rustix::time::ClockId::ThreadCPUTime);
    Duration::new(time.tv_sec.unsigned_abs(), time.tv_nsec.unsigned_abs() as u32)
}

/// How long ago it was `started`.
#[cfg(not(target_os = "linux"))]
fn busy(started: Instant) -> Duration {
    started.elapsed()
}
