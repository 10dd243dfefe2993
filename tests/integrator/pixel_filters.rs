//! Pictures by every filter of pixels.

use glam::Vec3;
use raystream::exec::cpu::CpuExecutor;
use raystream::render::{IntegratorKind, PixelFilter, PixelFilterShape, Settings};
use raystream::scene::{FilmSize, Projection, Scene};
use raystream_shaders::film::pixel_filter::{
    self as shaders, BLACKMAN_HARRIS, BOX, GAUSSIAN, TENT,
};
use raystream_tests::scenes::{self, add_quad};
use raystream_tests::statistics::assert_same_expectation;
use raystream_tests::{prepare, render, render_on, settings, with_gpu};

fn filters() -> impl Iterator<Item = PixelFilter> {
    PixelFilterShape::ALL.iter().map(|&shape| PixelFilter { shape, width: 2.6 })
}

/// A lamp whose edge goes down the middle of a picture of one row, seen by parallel rays.
fn edge() -> Scene {
    let mut scene = scenes::empty(Vec3::Z, Vec3::ZERO);
    scene.film = FilmSize { width: 8, height: 1 };
    scene.camera.projection = Projection::Orthographic { width: 8.0 };
    let lamp = scene.add_material(scenes::emissive(1.0, 0.0));
    add_quad(&mut scene, Vec3::new(-90.0, -90.0, 0.0), Vec3::X * 90.0, Vec3::Y * 180.0, lamp);
    scene
}

/// The share of the filter to the left of a place, in pixels from its middle.
fn share_below(filter: &shaders::PixelFilter, place: f64) -> f64 {
    const FINE: u32 = 800;
    let step = 2.0 * f64::from(filter.radius) / f64::from(FINE);
    let at = |k: u32| (f64::from(k) + 0.5) * step - f64::from(filter.radius);
    let rows = |x: f64| -> f64 {
        (0..FINE).map(|k| f64::from(filter.density([x as f32, at(k) as f32]))).sum()
    };
    (0..FINE).map(at).filter(|&x| x < place).map(|x| rows(x) * step * step).sum()
}

#[test]
fn a_pixel_beside_an_edge_has_its_filters_share() {
    let scene = edge();
    let prepared = prepare(&scene);
    let kinds = [BOX, TENT, GAUSSIAN, BLACKMAN_HARRIS];
    for (filter, kind) in filters().zip(kinds) {
        let own = shaders::PixelFilter { kind, radius: 0.5 * filter.width };
        let settings = Settings { pixel_filter: filter, ..settings(&scene) };
        let film = render(&prepared, &settings, 1 << 14);
        for (column, (color, variance)) in film.color().iter().zip(film.variance()).enumerate() {
            let expected = share_below(&own, 3.5 - column as f64);
            let error = f64::from(variance.x).sqrt();
            let off = (f64::from(color.x) - expected).abs();
            // The sum is off by a step of the filter's at most.
            let what = filter.shape.name();
            assert!(off <= 4.5 * error + 3e-3, "{what}, {column}: {} {expected}", color.x);
        }
    }
}

/// The four integrators that walk the same paths do so with every filter.
#[test]
fn integrators_agree_bit_for_bit() {
    let scene = scenes::room(scenes::glass(1.5), 1.0);
    let prepared = prepare(&scene);
    for pixel_filter in filters() {
        let film = |integrator| {
            let settings = Settings { integrator, pixel_filter, ..settings(&scene) };
            render(&prepared, &settings, 4).color()
        };
        let expected = film(IntegratorKind::Megakernel);
        for kind in
            [IntegratorKind::Regeneration, IntegratorKind::Compaction, IntegratorKind::Streaming]
        {
            assert!(film(kind) == expected, "{kind}, {}", pixel_filter.shape);
        }
    }
}

/// A box of width 1 is the pixel itself, whatever else the kernels can do.
#[test]
fn a_box_of_one_pixel_is_the_pixel() {
    let scene = scenes::room(scenes::glass(1.5), 1.0);
    let prepared = prepare(&scene);
    let film =
        |pixel_filter| render(&prepared, &Settings { pixel_filter, ..settings(&scene) }, 512);
    let pixel_filter = PixelFilter::of(PixelFilterShape::Box);
    assert!(pixel_filter.is_pixel());
    let nearly = PixelFilter { width: 1.000_001, ..pixel_filter };
    assert_eq!(film(pixel_filter).color(), film(PixelFilter::default()).color());
    let other =
        render(&prepared, &Settings { seed: 5, pixel_filter: nearly, ..settings(&scene) }, 512);
    assert_same_expectation(&film(pixel_filter), &other, "a box of one pixel");
}

#[test]
fn devices_agree_by_every_filter() {
    with_gpu(|gpu| {
        let scene = scenes::room(scenes::diffuse(0.7), 1.0);
        let prepared = prepare(&scene);
        for pixel_filter in filters() {
            let own = Settings { pixel_filter, ..settings(&scene) };
            let cpu = render_on(&CpuExecutor, &prepared, &own, 64);
            let gpu = render_on(gpu, &prepared, &Settings { seed: 2, ..own }, 64);
            assert_same_expectation(&cpu, &gpu, pixel_filter.shape.name());
        }
    });
}
