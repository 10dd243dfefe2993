//! Allocators: budgets, proportions, strange errors, and films that are sequential sums, bit for
//! bit, on both processors.

use glam::Vec3;
use raystream::exec::cpu::CpuExecutor;
use raystream::exec::{Array, Executor};
use raystream::render::AllocatorKind::{self, Atomic, Paper, Runs, Uniform};
use raystream::render::Split;
use raystream::render::allocator::{Allocation, Allocator, RoundBuffers, Stream, Streams, paper};
use raystream::render::film::FilmBuffers;
use raystream::scene::FilmSize;
use raystream_shaders::film::stream::{NO_PIXEL, Slot};
use raystream_shaders::film::sums::PixelSums;
use raystream_shaders::film::{Contribution, FilmPixel};
use raystream_shaders::math::random::SECOND_HALF;
use raystream_shaders::math::random::{hash, unit_float};
use raystream_tests::executors::Hindered;
use raystream_tests::statistics::assert_chi_square;
use raystream_tests::with_gpu;

const ADAPTIVE: [AllocatorKind; 3] = [Paper, Atomic, Runs];
const ALL: [AllocatorKind; 4] = [Uniform, Paper, Atomic, Runs];
/// Samples that pixels have alike before a round.
const FIRST_SAMPLE: u32 = 5;
/// The unit of films is 2 to this power.
const UNIT: i32 = -64;
/// Bytes of a buffer that 320 pixels of the film fit.
const BAND: u64 = 320 * size_of::<PixelSums>() as u64;

/// A round to be made: its errors in rank order, its length, its random number.
#[derive(Clone)]
struct Round {
    size: FilmSize,
    errors: Vec<f32>,
    /// Samples of every pixel.
    uniform: u32,
    slots: u32,
    split: Split,
    salt: u32,
}

/// What became of it.
#[derive(Debug, PartialEq)]
struct Made {
    slots: Vec<Slot>,
    filled: u32,
    /// In rank order.
    film: Vec<PixelSums>,
}

impl Round {
    fn new(errors: Vec<f32>, slots: u32) -> Self {
        let width = 40;
        let height = errors.len() as u32 / width;
        assert_eq!(errors.len() as u32, width * height);
        let size = FilmSize { width, height };
        Self { size, errors, uniform: 0, slots, split: Split::Whole, salt: 1 }
    }

    fn pixels(&self) -> u32 {
        self.size.width * self.size.height
    }

    /// Samples that each pixel has before the round.
    fn counts_before(&self) -> Vec<u32> {
        self.film_before().iter().map(PixelSums::samples).collect()
    }

    fn contributions(&self) -> Vec<Contribution> {
        (0..self.slots)
            .map(|slot| {
                let word = |k: u32| hash(slot * 8 + k);
                // Of any size, some too large for a sum, some negative.
                let number = |k: u32| {
                    let scale = f32::exp2((word(k) % 128) as f32 - 80.0);
                    (unit_float(word(k)) - 0.01) * scale
                };
                let radiance = Vec3::new(number(0), number(1), number(2));
                Contribution { radiance, rays: word(6) >> 20 }
            })
            .collect()
    }

    fn film_before(&self) -> Vec<PixelSums> {
        let pixel = |p: u32| {
            // What pixels get alike are samples of a half of which all have as many.
            let is_uniform = self.slots == self.uniform * self.pixels();
            let samples = FIRST_SAMPLE + if is_uniform { 0 } else { hash(p) % 3 };
            let second_samples = match self.split {
                Split::Whole => 0,
                Split::ByTurns => samples / 2,
                Split::Control => samples - FIRST_SAMPLE,
            };
            let pixel = FilmPixel {
                first_samples: samples - second_samples,
                second_samples,
                first_sum: Vec3::splat((samples - second_samples) as f32),
                second_sum: Vec3::splat(second_samples as f32),
                ..FilmPixel::NOTHING
            };
            PixelSums::of_pixel(&pixel, UNIT)
        };
        (0..self.pixels()).map(pixel).collect()
    }

    fn make<E: Executor>(&self, executor: &E, kind: AllocatorKind) -> Made {
        let allocation = Allocation::new(kind, executor, self.pixels()).unwrap();
        self.with_buffers(executor, |buffers, stream| {
            executor.run(&allocation.fill(buffers, stream)).unwrap();
            let slots = buffers.slots.read(executor).unwrap();
            executor.run(&allocation.accumulate(buffers, stream)).unwrap();
            let bands = buffers.film.bands().iter();
            let film = bands.flat_map(|band| band.film.read(executor).unwrap()).collect();
            Made { slots, filled: allocation.filled(executor, stream).unwrap(), film }
        })
    }

    /// Calls `run` with what the launches of the round work on and with its stream.
    fn with_buffers<E: Executor, T>(
        &self,
        executor: &E,
        run: impl FnOnce(&RoundBuffers<'_, E::Buffer>, &Stream) -> T,
    ) -> T {
        let film = FilmBuffers::new(executor, self.size, UNIT).unwrap();
        let before = self.film_before();
        for band in film.bands() {
            band.film
                .write(executor, &before[band.first_rank as usize..][..band.film.len()])
                .unwrap();
        }
        let errors = Array::from_slice(executor, "errors", &self.errors).unwrap();
        // Old slots are lying about.
        let slots = Array::from_slice(
            executor,
            "slots",
            &vec![Slot { rank: 3, sample: 9 }; self.slots as usize],
        )
        .unwrap();
        let contributions =
            Array::from_slice(executor, "contributions", &self.contributions()).unwrap();
        let buffers = RoundBuffers {
            film: &film,
            paths: self.counts_before().iter().map(|&count| u64::from(count)).sum(),
            split: self.split,
            errors: &errors,
            slots: &slots,
            contributions: &contributions,
            salt: self.salt,
        };
        // Uniform windows are of whole tiles.
        let largest = self.slots.next_multiple_of(64 * self.slots.div_ceil(self.pixels()));
        let adaptive = u64::from(self.slots - self.uniform * self.pixels());
        let mut streams = Streams::new(&film, self.uniform, FIRST_SAMPLE, adaptive, largest);
        let stream = streams.next(&film, largest).expect("a stream");
        assert!(streams.next(&film, largest).is_none(), "one stream");
        run(&buffers, &stream)
    }

    /// Samples that each pixel got in a round.
    fn counts(&self, made: &Made) -> Vec<u32> {
        let mut counts = vec![0; self.pixels() as usize];
        for slot in made.slots.iter().filter(|slot| slot.rank != NO_PIXEL) {
            counts[slot.rank as usize] += 1;
        }
        counts
    }

    /// What must hold for every allocator.
    fn assert_sound(&self, made: &Made, what: &str) {
        let counts = self.counts(made);
        assert_eq!(counts.iter().sum::<u32>(), made.filled, "{what}: slots that have a pixel");
        // Sample numbers continue each half's count without gaps.
        let before = self.film_before();
        let mut numbers = vec![[Vec::new(), Vec::new()]; counts.len()];
        for slot in made.slots.iter().filter(|slot| slot.rank != NO_PIXEL) {
            let half = usize::from(slot.sample >= SECOND_HALF);
            numbers[slot.rank as usize][half].push(slot.sample & !SECOND_HALF);
        }
        for (pixel, numbers) in numbers.into_iter().enumerate() {
            let had = [before[pixel].first_samples, before[pixel].second_samples];
            let got = numbers.each_ref().map(|half| half.len() as u32);
            for ((mut numbers, had), got) in numbers.into_iter().zip(had).zip(got) {
                numbers.sort_unstable();
                let expected: Vec<u32> = (had..had + got).collect();
                assert_eq!(numbers, expected, "{what}: samples of pixel {pixel}");
            }
            let [first, second] = got;
            let is_split_well = match self.split {
                Split::Whole => second == 0,
                Split::ByTurns => (had[0] + first).wrapping_sub(had[1] + second) <= 1,
                Split::Control => first == self.uniform,
            };
            assert!(is_split_well, "{what}: halves of {first} and {second}, pixel {pixel}");
        }
    }

    /// The film as one thread would add it up, in the order of the slots.
    fn sequential_film(&self, made: &Made) -> Vec<PixelSums> {
        let mut film = self.film_before();
        for (slot, contribution) in made.slots.iter().zip(self.contributions()) {
            if slot.rank != NO_PIXEL {
                film[slot.rank as usize].add(&contribution, slot.sample >= SECOND_HALF, UNIT);
            }
        }
        film
    }
}

/// Errors over many orders of magnitude, some of them 0.
fn wild_errors(pixels: u32) -> Vec<f32> {
    (0..pixels)
        .map(|p| {
            if hash(p ^ 77).is_multiple_of(9) {
                0.0
            } else {
                f32::exp2((hash(p) % 40) as f32 - 30.0)
            }
        })
        .collect()
}

fn assert_same_bytes<T: bytemuck::NoUninit>(a: &[T], b: &[T], what: &str) {
    assert_eq!(a.len(), b.len());
    let first = a.iter().zip(b).position(|(a, b)| bytemuck::bytes_of(a) != bytemuck::bytes_of(b));
    assert_eq!(first, None, "{what}: the first element that differs");
}

#[test]
fn budgets_are_met_and_films_are_sequential_sums() {
    for (rows, budget) in [(30, 1200), (30, 1), (30, 777), (30, 9600), (64, 5000), (700, 28_000)] {
        let pixels = 40 * rows;
        let round = Round::new(wild_errors(pixels), budget);
        for kind in ALL {
            // What uniform sampling gives is a multiple of the pixels.
            let round = match kind {
                Uniform => {
                    let uniform = (budget / pixels).max(1);
                    Round { uniform, slots: pixels * uniform, ..round.clone() }
                }
                // With a uniform part where there is room for one.
                Runs => {
                    let uniform = budget.saturating_sub(1) / pixels / 2;
                    Round { uniform, split: Split::Control, ..round.clone() }
                }
                _ => round.clone(),
            };
            let what = format!("{kind:?}, {pixels} pixels, {} slots", round.slots);
            let cpu = round.make(&CpuExecutor, kind);
            round.assert_sound(&cpu, &what);
            assert_same_bytes(&cpu.film, &round.sequential_film(&cpu), &what);
            // These errors leave the paper's method enough pixels for every one of its streams.
            assert_eq!(cpu.filled, round.slots, "{what}: the budget");
            with_gpu(|gpu| {
                let gpu = round.make(gpu, kind);
                round.assert_sound(&gpu, &what);
                assert_same_bytes(&gpu.film, &round.sequential_film(&gpu), &what);
                assert_eq!(gpu.filled, cpu.filled);
                if kind == Atomic {
                    // In whatever order, every pixel gets as many.
                    assert_eq!(round.counts(&gpu), round.counts(&cpu), "{what}");
                } else {
                    assert_same_bytes(&gpu.slots, &cpu.slots, &what);
                    assert_same_bytes(&gpu.film, &cpu.film, &what);
                }
            });
        }
    }
}

#[test]
fn films_are_sequential_sums_however_far_apart_runs_are() {
    // Pixels that have not converged: runs of a thousand slots, and two of a few with all the
    // picture between them.
    for (live, budget) in [(3000, 9600), (27_999, 9600), (27_999, 100), (1100, 300)] {
        let errors = (0..28_000)
            .map(|pixel| if pixel % live == 0 { 1.0 + (pixel % 7) as f32 } else { -1.0 })
            .collect();
        let round = Round::new(errors, budget);
        let cpu = round.make(&CpuExecutor, Runs);
        round.assert_sound(&cpu, "far apart");
        assert_same_bytes(&cpu.film, &round.sequential_film(&cpu), "far apart");
        with_gpu(|gpu| {
            assert_same_bytes(&round.make(gpu, Runs).film, &cpu.film, "far apart");
        });
    }
}

#[test]
fn neighbours_in_a_stream_of_runs_are_neighbours_in_the_picture() {
    let round = Round::new(wild_errors(1200), 3000);
    let made = round.make(&CpuExecutor, Runs);
    assert!(
        made.slots.is_sorted_by_key(|slot| (slot.rank, slot.sample)),
        "runs follow each other in rank order"
    );
}

#[test]
fn no_pixel_is_twice_in_a_stream_of_the_paper() {
    let round = Round::new(wild_errors(1200), 3000);
    let paper = paper::Paper::new(&CpuExecutor, round.pixels()).unwrap();
    let allocator: &dyn Allocator<CpuExecutor> = &paper;
    let (slots, filled) = round.with_buffers(&CpuExecutor, |buffers, stream| {
        CpuExecutor.run(&allocator.fill(buffers, stream)).unwrap();
        (buffers.slots.read(&CpuExecutor).unwrap(), allocator.filled(&CpuExecutor, stream).unwrap())
    });
    let streams = paper.states(&CpuExecutor).unwrap();
    let taken: u32 = streams.iter().map(|stream| stream.taken).sum();
    assert_eq!(taken, filled);
    assert!(
        streams.iter().filter(|stream| stream.taken > 0).count() > 3,
        "several streams were kept"
    );
    assert!(
        streams.iter().any(|stream| stream.wanted > 0 && stream.taken == 0),
        "one that was too long was dropped"
    );
    for stream in streams.iter().filter(|stream| stream.taken > 0) {
        let slots = &slots[stream.filled as usize..][..stream.taken as usize];
        assert!(
            slots.is_sorted_by(|a, b| a.rank < b.rank),
            "strictly ascending ranks: no pixel twice"
        );
    }
}

/// What pixels lack in exact arithmetic, of `budget` samples: the water level by bisection.
fn deficits(errors: &[f32], counts: &[u32], budget: u32) -> Vec<f64> {
    let mean = errors.iter().map(|&e| f64::from(e)).sum::<f64>() / errors.len() as f64;
    let targets: Vec<f64> = errors.iter().map(|&e| f64::from(e).min(16.0 * mean)).collect();
    let at_level = |level: f64| -> Vec<f64> {
        let pixels = targets.iter().zip(counts);
        pixels.map(|(target, &count)| (level * target - f64::from(count)).max(0.0)).collect()
    };
    let (mut low, mut high) = (0.0, 1e9 / mean);
    for _ in 0..200 {
        let middle = (low + high) / 2.0;
        let is_too_much = at_level(middle).iter().sum::<f64>() > f64::from(budget);
        *if is_too_much { &mut high } else { &mut low } = middle;
    }
    at_level(low)
}

/// Over all 256 phases a pixel gets exactly its weight, which is what it lacks, rounded to 1/256 of
/// a sample.
#[test]
fn runs_fill_pixels_up() {
    let pixels = 800;
    let errors: Vec<f32> =
        (0..pixels).map(|p| unit_float(hash(p)) * unit_float(hash(p ^ 99)) * 1e-4).collect();
    for (budget, uniform) in [(500, 0), (4000, 0), (4000, 1)] {
        let split = Split::Control;
        let round = Round { uniform, split, ..Round::new(errors.clone(), budget) };
        let mut totals = vec![0_u32; pixels as usize];
        for phase in 0..256 {
            let made = Round { salt: phase, ..round.clone() }.make(&CpuExecutor, Runs);
            totals.iter_mut().zip(round.counts(&made)).for_each(|(total, count)| *total += count);
        }
        let counts: Vec<u32> = round.counts_before().iter().map(|count| count + uniform).collect();
        let deficits = deficits(&errors, &counts, budget - uniform * pixels);
        assert!(
            deficits.iter().filter(|&&deficit| deficit == 0.0).count() > 100,
            "some had enough"
        );
        for (pixel, (&total, &deficit)) in totals.iter().zip(&deficits).enumerate() {
            let expected = 256.0 * (deficit + f64::from(uniform));
            // The level is reached by a fixed point, all but exactly.
            assert!(
                (f64::from(total) - expected).abs() <= 2.0 + 1e-3 * expected,
                "pixel {pixel}: {total}/256 samples, not {expected:.2}"
            );
        }
    }
}

/// By chance alone: random rounds, counted over many seeds.
#[test]
fn the_papers_samples_are_in_proportion_to_errors() {
    let pixels = 200;
    // Within a factor of 4, so that no pixel is sure to be in a stream of the paper's.
    let errors: Vec<f32> = (0..pixels).map(|p| 0.25 + 0.75 * unit_float(hash(p))).collect();
    let sum: f64 = errors.iter().map(|&e| f64::from(e)).sum();
    let budget = 20;
    let mut totals = vec![0_u32; pixels as usize];
    let rounds = 1500;
    for seed in 0..rounds {
        let round = Round { salt: hash(seed), ..Round::new(errors.clone(), budget) };
        let made = round.make(&CpuExecutor, Paper);
        assert_eq!(made.filled, budget);
        totals.iter_mut().zip(round.counts(&made)).for_each(|(total, count)| *total += count);
    }
    let expected: Vec<f64> = errors
        .iter()
        .map(|&error| f64::from(error) / sum * f64::from(budget) * f64::from(rounds))
        .collect();
    assert_chi_square(&totals, &expected, "the paper's streams");
    // The rounding of `atomic` is not random: each pixel gets its share to less than one sample.
    let round = Round::new(errors.clone(), 5000);
    let counts = round.counts(&round.make(&CpuExecutor, Atomic));
    for (&count, &error) in counts.iter().zip(&errors) {
        let expected = f64::from(error) / sum * 5000.0;
        assert!(
            (f64::from(count) - expected).abs() < 1.0 + 1e-3,
            "{count} samples, not {expected}"
        );
    }
}

/// Pixels of the rounds of strange errors.
const STRANGE: usize = 1200;

/// Makes a round of `errors` on both processors with each adaptive allocator, and hands the CPU's
/// to `check`, with the samples of each pixel; the GPU's must be the same.
fn with_adaptive(
    errors: &[f32],
    slots: u32,
    what: &str,
    check: impl Fn(AllocatorKind, &Made, &[u32]),
) {
    let round = Round::new(errors.to_vec(), slots);
    for kind in ADAPTIVE {
        let what = format!("{kind:?}, {what}");
        let cpu = round.make(&CpuExecutor, kind);
        round.assert_sound(&cpu, &what);
        check(kind, &cpu, &round.counts(&cpu));
        with_gpu(|gpu| {
            let gpu = round.make(gpu, kind);
            round.assert_sound(&gpu, &what);
            assert_eq!(round.counts(&gpu), round.counts(&cpu), "{what}");
        });
    }
}

#[test]
fn errors_that_tell_nothing_make_all_pixels_alike() {
    with_adaptive(&[0.0; STRANGE], 3000, "nothing known", |kind, made, counts| {
        assert_eq!(made.filled, 3000, "{kind:?}");
        assert!(counts.iter().all(|&c| c == 2 || c == 3), "{kind:?}: {counts:?}");
    });
    with_adaptive(&[-1.0; STRANGE], 1200, "all converged", |kind, made, counts| {
        assert_eq!(made.filled, 1200, "{kind:?}");
        assert!(counts.iter().all(|&c| c == 1), "{kind:?}: {counts:?}");
    });
}

#[test]
fn one_error_alone_gets_what_its_allocator_gives_a_pixel_at_most() {
    let mut errors = [0.0; STRANGE];
    errors[321] = 1e-20;
    with_adaptive(&errors, 3000, "one error", |kind, made, counts| match kind {
        // A pixel is in every stream at most once, all others are in the last one alone; the rest
        // stays empty.
        Paper => {
            assert!((2..=34).contains(&counts[321]), "{}", counts[321]);
            assert_eq!(made.filled, 1199 + counts[321]);
        }
        Atomic => assert_eq!(counts[321], 3000),
        // Whatever else the pixels get, they get by the uniform part.
        _ => assert_eq!(counts[321], 3000),
    });
}

#[test]
fn errors_that_are_not_finite_count_as_0_and_converged_pixels_get_nothing() {
    let mut errors = wild_errors(STRANGE as u32);
    for (pixel, error) in
        [(5, f32::NAN), (600, f32::INFINITY), (700, -f32::NAN), (1199, f32::NEG_INFINITY)]
    {
        errors[pixel] = error;
    }
    errors[100..200].fill(-1.0);
    // What is below zero has converged, also where it is not finite.
    let tamed = |&error: &f32| match error {
        f32::NEG_INFINITY => -1.0,
        _ if error.is_sign_negative() && error.is_nan() => -1.0,
        _ if error.is_finite() => error,
        _ => 0.0,
    };
    let tame = Round::new(errors.iter().map(tamed).collect(), 4000);
    with_adaptive(&errors, 4000, "strange errors", |kind, made, counts| {
        assert_eq!(made.filled, 4000, "{kind:?}");
        assert_eq!(counts[100..200].iter().sum::<u32>(), 0, "{kind:?}: converged pixels");
        assert!(counts[5] <= 1 && counts[600] <= 1, "{kind:?}: {} {}", counts[5], counts[600]);
        let counts_of_tame = tame.counts(&tame.make(&CpuExecutor, kind));
        assert_eq!(counts, counts_of_tame, "{kind:?}: the other pixels do not notice");
    });
}

#[test]
fn the_largest_errors_there_are_get_nearly_all() {
    let extreme = std::array::from_fn::<_, STRANGE, _>(|pixel| {
        [f32::MAX, f32::MIN_POSITIVE, 1e-45, 1.0][pixel % 4]
    });
    with_adaptive(&extreme, 2400, "extreme errors", |kind, made, counts| {
        assert_eq!(made.filled, 2400, "{kind:?}");
        assert!(counts.iter().step_by(4).sum::<u32>() >= 2100, "{kind:?}: {counts:?}");
    });
}

#[test]
fn bands_change_nothing() {
    let round = Round::new(wild_errors(1200), 2500);
    let small = Hindered::by_buffers(&CpuExecutor, BAND);
    assert_eq!(FilmBuffers::new(&small, round.size, UNIT).unwrap().bands().len(), 4);
    for kind in ADAPTIVE {
        let whole = round.make(&CpuExecutor, kind);
        let bands = round.make(&small, kind);
        assert_eq!(round.counts(&bands), round.counts(&whole), "{kind:?}");
        if kind != Atomic {
            assert_same_bytes(&bands.slots, &whole.slots, &format!("{kind:?}"));
        }
        assert_same_bytes(&bands.film, &round.sequential_film(&bands), &format!("{kind:?}"));
    }
}

/// Whatever lengths windows are asked for on the way, every pixel gets what it is due, once.
#[test]
fn windows_of_any_length_cover_every_pixel() {
    let size = FilmSize { width: 40, height: 30 };
    let small = Hindered::by_buffers(&CpuExecutor, BAND);
    let film = FilmBuffers::new(&small, size, UNIT).unwrap();
    for uniform in [1, 5, 300] {
        let mut streams = Streams::new(&film, uniform, 3, 7, 100);
        let mut got = vec![0; film.pixels() as usize];
        let mut last = None;
        for step in 0.. {
            let largest = 64 << (hash(step) % 6);
            let Some(stream) = streams.next(&film, largest) else { break };
            if stream.adaptive_slots() > 0 {
                last = Some(stream);
                continue;
            }
            // The smallest windows of a pass that began with longer ones may be longer.
            let fits = stream.slots <= largest || stream.pixels.len() <= 64;
            assert!(last.is_none() && fits, "{stream:?}");
            stream.pixels.clone().for_each(|pixel| {
                assert_eq!(stream.first_sample, 3 + got[pixel as usize], "its next sample");
                got[pixel as usize] += stream.uniform;
            });
        }
        assert!(got.iter().all(|&samples| samples == uniform), "{got:?}");
        assert_eq!(last.expect("an adaptive part").slots, 7);
    }
}
