//! How much memory integrators ask for, and what they do where there is not enough: on a device
//! that keeps accounts and computes nothing.

use raystream::exec::{ExecError, Executor};
use raystream::render::integrator::wavefront::Wavefront;
use raystream::render::{AllocatorKind, IntegratorKind, Renderer, Sampling, Settings};
use raystream::scene::{FilmSize, load, load_named};
use raystream_shaders::film::sums::PixelSums;
use raystream_shaders::scene::abilities::BASIC;
use raystream_tests::executors::Accounts;
use raystream_tests::{large_scenes, prepare, settings};

/// 3840x2160 pixels, 1024 samples each, in less than 4 GiB, whatever the integrator and the
/// allocator.
#[test]
fn a_large_picture_fits_4_gib() {
    let mut scenes = vec![load_named("cornell_ball").unwrap()];
    if let Some(folder) = large_scenes() {
        scenes.push(load(&folder.join("conference/conference.json")).unwrap());
    }
    for scene in scenes {
        let (name, prepared) = (scene.name.clone(), prepare(&scene));
        for &integrator in IntegratorKind::ALL {
            for allocator in [
                AllocatorKind::Uniform,
                AllocatorKind::Paper,
                AllocatorKind::Atomic,
                AllocatorKind::Runs,
            ] {
                let size = FilmSize { width: 3840, height: 2160 };
                let sampling = Sampling { allocator, ..Sampling::UNIFORM };
                let settings = Settings { size, integrator, sampling, ..settings(&scene) };
                let device = Accounts::new(u64::MAX);
                let mut renderer = Renderer::new(&device, &prepared, &settings).unwrap();
                // Batches of a device that takes no time grow to the whole stream; so long a round
                // is cut into streams.
                let mut paths = 0_u64;
                let mut round = renderer.uniform_round(1024);
                while let Some(batch) = round.next_batch().unwrap() {
                    paths += u64::from(batch.paths);
                }
                assert_eq!(paths, 1024 * 3840 * 2160);
                let most = device.most();
                let gib = most as f64 / f64::from(1 << 30);
                assert!(most < 4 << 30, "{name}, {integrator:?}, {allocator:?}: {gib:.2} GiB");
                // It is the pictures that are counted: the film alone takes that much.
                assert!(
                    most > 3840 * 2160 * size_of::<PixelSums>() as u64,
                    "{name}, {integrator:?}, {allocator:?}: {gib:.2} GiB"
                );
            }
        }
    }
}

fn pool(
    kind: IntegratorKind,
    device: &Accounts,
    stream: u32,
) -> Result<Wavefront<<Accounts as Executor>::Buffer>, ExecError> {
    match kind {
        IntegratorKind::Compaction => Wavefront::compaction(device, BASIC, stream),
        _ => Wavefront::streaming(device, BASIC, stream),
    }
}

/// Pools shrink until they fit.
#[test]
fn pools_take_what_room_there_is() {
    let stream = 1 << 22;
    let wanted = |kind| {
        let device = Accounts::new(u64::MAX);
        let _pool = pool(kind, &device, stream).unwrap();
        device.used()
    };
    for kind in [IntegratorKind::Compaction, IntegratorKind::Streaming] {
        let whole = wanted(kind);
        assert!(whole > 100 << 20, "{kind:?}: {whole} bytes");
        for room in [whole, whole - 1, whole / 2, whole / 3] {
            let device = Accounts::new(room);
            let _pool = pool(kind, &device, stream).unwrap();
            let used = device.used();
            assert!(used <= room && used > room / 4, "{kind:?}: {used} of {room} bytes");
        }
        // Thousands of launches for a stream would be no help.
        let refused = pool(kind, &Accounts::new(whole / 100), stream)
            .err()
            .expect("there is no room")
            .to_string();
        assert!(
            refused.contains("has no room for") && refused.contains("smaller picture"),
            "{refused}"
        );
    }
}

/// A pool is no larger than its stream, nor than a buffer may be.
#[test]
fn pools_are_as_large_as_is_useful() {
    let bytes = |stream, capacity| {
        let device = Accounts::new(u64::MAX);
        let _pool = Wavefront::of_capacity(&device, BASIC, stream, capacity, true).unwrap();
        device.used()
    };
    let of_path = 12 * 16 + 4 + 4;
    assert!(bytes(1000, 1000) >= 1000 * of_path && bytes(1000, 1000) < 1000 * of_path + 20_000);
    // Ten times as many paths would be a buffer of 19 GB.
    assert!(bytes(100_000_000, 100_000_000) < 3 << 30);
}
