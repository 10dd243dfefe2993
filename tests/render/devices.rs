//! Pictures of the GPU and of the CPU, by statistics.

use raystream::render::Settings;
use raystream_tests::statistics::assert_same_expectation;
use raystream_tests::{prepare, render, render_on, scenes, settings, with_gpu};

#[test]
fn pictures_have_the_same_expectation() {
    for (name, ball) in [("mirror", scenes::mirror(0.9)), ("glass", scenes::glass(1.5))] {
        let scene = scenes::room(ball, 1.0);
        let prepared = prepare(&scene);
        let settings = settings(&scene);
        let cpu = render(&prepared, &settings, 256);
        with_gpu(|gpu| {
            let independent = render_on(gpu, &prepared, &Settings { seed: 7, ..settings }, 256);
            assert_same_expectation(&cpu, &independent, name);
            // The same seed gives the same paths, all but those that the arithmetic sends
            // elsewhere.
            let same_seed =
                render_on(gpu, &prepared, &Settings { seed: settings.seed, ..settings }, 8);
            let cpu_same = render(&prepared, &settings, 8);
            let close = same_seed
                .color()
                .iter()
                .zip(cpu_same.color())
                .filter(|(a, b)| (**a - *b).abs().max_element() <= 1e-3 * b.max_element() + 1e-6)
                .count();
            assert!(close * 10 >= same_seed.radiance.len() * 9, "{name}: {close} pixels alike");
        });
    }
}
