//! Renders in rounds.

use raystream::exec::cpu::CpuExecutor;
use raystream::render::{Renderer, Settings};
use raystream::scene::FilmSize;
use raystream_tests::{prepare, render, scenes, settings};

/// The way a render is cut into rounds and batches is nobody's business: the film is the same, bit
/// for bit.
#[test]
fn rounds_do_not_change_the_film() {
    let mut scene = scenes::room(scenes::glass(1.5), 1.0);
    scene.film = FilmSize { width: 19, height: 13 };
    let prepared = prepare(&scene);
    let settings = Settings { independent_sampler: false, ..settings(&scene) };
    let at_once = render(&prepared, &settings, 21);
    let mut renderer = Renderer::new(&CpuExecutor, &prepared, &settings).unwrap();
    for samples in [1, 7, 3, 10] {
        renderer.uniform_round(samples).finish().unwrap();
    }
    renderer.finish_features().unwrap();
    assert_eq!(renderer.film().unwrap(), at_once);
    let rays: u64 = at_once.radiance.iter().map(|p| u64::from(p.rays)).sum();
    assert_eq!(renderer.rays().unwrap(), rays);
}
