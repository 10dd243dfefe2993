//! When a render filters its picture.

use super::renders::{room, sampling, small};
use raystream::exec::Executor;
use raystream::exec::cpu::CpuExecutor;
use raystream::render::{AllocatorKind, Estimator, FilterKind, Renderer, Sampling, Settings};
use raystream_tests::scenes;
use std::time::Duration;

/// Whether the last step to the picture filters it.
fn filters<E: Executor>(renderer: &Renderer<E>) -> bool {
    renderer.resolve().expect("the device works").reconstruction() > Duration::ZERO
}

/// The noise and the picture are of one filtering; what changes the picture makes another due.
#[test]
fn a_picture_is_filtered_once() {
    let (scene, settings) = room(scenes::mirror(0.9), 16, 12);
    for kind in [FilterKind::Bilateral, FilterKind::Auto] {
        let sampling = Sampling {
            noise: Some(0.01),
            round_budget: Some(12.0),
            ..sampling(AllocatorKind::Runs, Estimator::Bilateral)
        };
        let settings = Settings { sampling, denoise: Some(kind), ..settings };
        let small = small(&CpuExecutor);
        let new = || Renderer::new(&small, &scene, &settings).expect("the scene fits");
        let (mut renderer, mut other) = (new(), new());
        for round in 0..3 {
            renderer.step(u64::MAX).expect("the device works");
            other.step(u64::MAX).expect("the device works");
            assert!(filters(&renderer), "{kind}: round {round} has brought samples");
            assert!(!filters(&renderer), "{kind}: nothing has changed since");
        }
        renderer.noise().expect("the device works");
        assert!(!filters(&renderer), "{kind}: the noise is that of the same picture");
        renderer.finish_features().expect("the device works");
        other.finish_features().expect("the device works");
        renderer.noise().expect("the device works");
        assert!(!filters(&renderer), "{kind}: the noise has wanted the picture");
        // The other has not been asked before.
        let films = [&mut renderer, &mut other].map(|r| r.film().expect("the device works"));
        assert_eq!(films[0], films[1], "{kind}");

        let checkpoint = renderer.checkpoint().expect("the device works");
        renderer.restore(&checkpoint).expect("it is its own");
        assert!(filters(&renderer), "{kind}: it is another film for all it knows");
    }
}

/// Features are traced for the end of a render alone, and filters look at them.
#[test]
fn better_features_make_another_picture() {
    let (scene, settings) = room(scenes::mirror(0.9), 16, 12);
    let settings = Settings { denoise: Some(FilterKind::Bilateral), ..settings };
    let small = small(&CpuExecutor);
    let mut renderer = Renderer::new(&small, &scene, &settings).expect("the scene fits");
    renderer.step(12 * 16 * 12).expect("the device works");
    assert!(filters(&renderer));
    renderer.finish_features().expect("the device works");
    assert!(filters(&renderer), "there are 12 camera rays a pixel");
    renderer.finish_features().expect("the device works");
    assert!(!filters(&renderer), "and no more to come");
}
