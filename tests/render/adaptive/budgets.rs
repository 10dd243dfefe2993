//! Budgets are met exactly, whatever decides about samples and whatever there is to see.

use super::renders::{render, render_on, room, sampling, small};
use glam::Vec3;
use raystream::exec::Executor;
use raystream::exec::cpu::CpuExecutor;
use raystream::film::Film;
use raystream::render::AllocatorKind::{self, Atomic, Paper, Runs, Uniform};
use raystream::render::{Estimator, PreparedScene, Sampling, Settings};
use raystream::scene::FilmSize;
use raystream_tests::{prepare, scenes, settings, with_gpu};

const ALLOCATORS: [AllocatorKind; 4] = [Uniform, Paper, Atomic, Runs];
const ESTIMATORS: &[Estimator] = Estimator::ALL;

/// The picture and what is said of it are numbers.
fn assert_finite(film: &Film, what: &str) {
    assert!(
        film.color().iter().chain(film.filtered().iter().flatten()).all(|color| color.is_finite()),
        "{what}"
    );
    assert!(
        film.squared_error().iter().flatten().all(|error| error.is_finite() && *error >= 0.0),
        "{what}"
    );
    assert!(film.features.iter().all(|f| f.albedo.is_finite() && f.normal.is_finite()), "{what}");
}

/// Renders with all allocators, estimators and forms of error; film and budget are as they should
/// be.
fn assert_budgets<E: Executor>(
    executor: &E,
    (scene, settings): &(PreparedScene, Settings),
    samples: u32,
    look: impl Fn(&Film, &str),
) {
    for allocator in ALLOCATORS {
        for &estimator in ESTIMATORS {
            for relative in [false, true] {
                let sampling = Sampling {
                    relative,
                    initial_samples: 2,
                    round_budget: Some(1.3),
                    ..sampling(allocator, estimator)
                };
                let what = format!(
                    "{allocator:?} by {estimator:?}, relative {relative}, of {:?}",
                    settings.size
                );
                let (film, outcome) =
                    render_on(executor, scene, &Settings { sampling, ..*settings }, Some(samples));
                let budget = u64::from(samples) * film.radiance.len() as u64;
                if allocator == Paper {
                    // A round that has fewer pixels to sample than slots is not filled.
                    assert!(
                        outcome.paths <= budget && outcome.paths * 100 >= budget * 95,
                        "{what}: {outcome:?}"
                    );
                } else {
                    assert_eq!(outcome.paths, budget, "{what}");
                }
                assert!(
                    film.samples().iter().all(|&n| n >= 2.min(samples)),
                    "{what}: the first round is uniform"
                );
                assert_eq!(film.estimates.is_some(), allocator != Uniform, "{what}");
                assert_finite(&film, &what);
                look(&film, &what);
            }
        }
    }
}

#[test]
fn every_combination_meets_its_budget_on_the_cpu() {
    assert_budgets(&small(&CpuExecutor), &room(scenes::glass(1.5), 19, 13), 7, |_, _| ());
}

#[test]
fn every_combination_meets_its_budget_on_the_gpu() {
    with_gpu(|gpu| assert_budgets(&small(gpu), &room(scenes::glass(1.5), 19, 13), 7, |_, _| ()));
}

/// One sample is less than the first round wants.
#[test]
fn budgets_smaller_than_the_first_round() {
    let room = room(scenes::mirror(0.9), 8, 8);
    assert_budgets(&small(&CpuExecutor), &room, 1, |film, what| {
        assert!(film.samples().iter().all(|&n| n == 1), "{what}");
    });
}

#[test]
fn pictures_smaller_than_a_tile() {
    for (width, height) in [(1, 1), (7, 5), (1, 9)] {
        assert_budgets(
            &small(&CpuExecutor),
            &room(scenes::mirror(0.9), width, height),
            9,
            |_, _| (),
        );
    }
}

/// Where nothing is to be seen no pixel is worse than any other.
#[test]
fn nothing_to_see() {
    let mut empty = scenes::empty(Vec3::ZERO, Vec3::Z);
    empty.film = FilmSize { width: 7, height: 5 };
    // Surfaces without a light.
    let mut dark = empty.clone();
    let wall = dark.add_material(scenes::diffuse(0.5));
    scenes::add_box(&mut dark, Vec3::splat(-1.0), Vec3::ONE, true, wall);
    for (scene, has_surfaces) in [(empty, false), (dark, true)] {
        let scene = (prepare(&scene), settings(&scene));
        let look = |film: &Film, what: &str| {
            assert!(film.color().iter().all(|color| *color == Vec3::ZERO), "{what}");
            assert!(film.squared_error().iter().flatten().all(|error| *error == 0.0), "{what}");
        };
        assert_budgets(&small(&CpuExecutor), &scene, 9, look);
        with_gpu(|gpu| assert_budgets(&small(gpu), &scene, 9, look));
        if has_surfaces {
            // There might be light to find.
            continue;
        }
        // No error is below any threshold.
        let sampling = Sampling { noise: Some(0.01), ..sampling(Runs, Estimator::Bilateral) };
        let (film, _) = render(&scene.0, &Settings { sampling, ..scene.1 }, None);
        assert!(film.samples().iter().all(|&n| n == sampling.initial_samples));
    }
}

/// Features are of each pixel's first camera rays, and not of how many paths it got.
#[test]
fn features_are_those_of_a_uniform_render() {
    let (scene, settings) = room(scenes::glass(1.5), 19, 13);
    let features =
        |sampling, samples| render(&scene, &Settings { sampling, ..settings }, Some(samples)).0;
    let uniform = features(Sampling::UNIFORM, 32);
    for allocator in [Paper, Atomic, Runs] {
        let adaptive = features(sampling(allocator, Estimator::Bilateral), 36);
        assert!(
            adaptive.samples().iter().any(|&n| n < 32),
            "{allocator:?}: some pixels have fewer paths than camera rays"
        );
        assert_eq!(adaptive.albedo(), uniform.albedo(), "{allocator:?}");
        assert_eq!(adaptive.normal(), uniform.normal(), "{allocator:?}");
        assert_eq!(adaptive.position(), uniform.position(), "{allocator:?}");
        assert_eq!(adaptive.depth(), uniform.depth(), "{allocator:?}");
    }
}
