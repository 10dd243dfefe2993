//! The estimators against each other and against what is known exactly. No golden pictures: every
//! test has a truth of its own and a stated confidence.

use glam::Vec3;
use raystream::render::{Settings, Techniques};
use raystream::scene::{FilmSize, Material, Opacity, Principled, Scene};
use raystream_tests::scenes::{self, add_ball, add_box};
use raystream_tests::statistics::assert_same_expectation;
use raystream_tests::{prepare, render, settings};

/// The materials that a furnace must not change: they absorb nothing.
fn white_materials() -> [(&'static str, Material); 4] {
    [
        ("diffuse", scenes::diffuse(1.0)),
        ("mirror", scenes::mirror(1.0)),
        ("glass", scenes::glass(1.5)),
        ("a bubble", scenes::glass(1.0 / 1.33)),
    ]
}

/// Two touching balls, lit from everywhere by radiance 1.
fn furnace(material: Material) -> (Scene, Settings) {
    let mut scene = scenes::empty(Vec3::new(0.0, 0.3, 4.0), Vec3::ZERO);
    let material = scene.add_material(material);
    add_ball(&mut scene, Vec3::new(-0.8, 0.0, 0.0), 0.8, 3, material);
    add_ball(&mut scene, Vec3::new(0.7, 0.1, 0.3), 0.6, 2, material);
    scene.background = Vec3::ONE;
    let settings = Settings { max_depth: 1000, roulette_depth: 2000, ..settings(&scene) };
    (scene, settings)
}

#[test]
fn a_white_furnace_stays_white() {
    for (name, material) in white_materials() {
        let (scene, settings) = furnace(material);
        let film = render(&prepare(&scene), &settings, 64);
        let hits: u32 = film.features.iter().map(|f| f.hits).sum();
        assert!(hits > 1000, "{name}: the camera sees the balls");
        // Every weight is 1 (or crosses the glass both ways), so every path brings exactly 1 but
        // for rounding.
        for (pixel, color) in film.color().iter().enumerate() {
            assert!(
                (*color - Vec3::ONE).abs().max_element() < 1e-3,
                "{name}: pixel {pixel} is {color}"
            );
        }
    }
}

/// With roulette a path brings 1 only on average.
#[test]
fn roulette_keeps_the_furnace_white_on_average() {
    let (scene, settings) = furnace(scenes::diffuse(0.9));
    let prepared = prepare(&scene);
    let without = render(&prepared, &Settings { seed: 1, ..settings }, 256);
    let with = render(&prepared, &Settings { seed: 2, roulette_depth: 1, ..settings }, 256);
    assert_same_expectation(&without, &with, "roulette in the furnace");
}

/// A closed box whose walls emit 1 - rho and reflect rho holds radiance 1 - rho^D for paths of D
/// segments, everywhere and in every direction.
#[test]
fn a_glowing_box_holds_its_radiance() {
    let reflectance = 0.6_f32;
    for techniques in [Techniques::Both, Techniques::LightSampling, Techniques::BsdfSampling] {
        let mut scene = scenes::empty(Vec3::new(0.3, 0.4, 0.1), Vec3::new(0.6, 0.5, 1.0));
        let wall = scene.add_material(scenes::emissive(1.0 - reflectance, reflectance));
        add_box(&mut scene, Vec3::ZERO, Vec3::new(1.0, 1.2, 1.5), true, wall);
        for max_depth in [1, 2, 5] {
            let settings = Settings { techniques, max_depth, ..settings(&scene) };
            let film = render(&prepare(&scene), &settings, 256);
            let (mean, error) = mean_and_error(&film);
            // The second term is for rounding: BSDF sampling alone has no variance here.
            let expected = f64::from(1.0 - reflectance.powi(max_depth as i32));
            assert!(
                (mean - expected).abs() <= 4.5 * error + 1e-5 * expected,
                "{techniques:?}, {max_depth} segments: {mean} is {:.1} standard errors from \
                 {expected}",
                (mean - expected) / error
            );
        }
    }
}

fn mean_and_error(film: &raystream::film::Film) -> (f64, f64) {
    let pixels = film.radiance.len() as f64;
    let mean = film.color().iter().map(|c| f64::from(c.x)).sum::<f64>() / pixels;
    let variance = film.variance().iter().map(|v| f64::from(v.x)).sum::<f64>() / (pixels * pixels);
    (mean, variance.sqrt())
}

#[test]
fn light_sampling_bsdf_sampling_and_both_agree() {
    let scene = scenes::room(scenes::diffuse(0.8), 1.0);
    let prepared = prepare(&scene);
    let settings = settings(&scene);
    let both = render(&prepared, &Settings { seed: 1, ..settings }, 1024);
    let light = render(
        &prepared,
        &Settings { seed: 2, techniques: Techniques::LightSampling, ..settings },
        1024,
    );
    let bsdf = render(
        &prepared,
        &Settings { seed: 3, techniques: Techniques::BsdfSampling, ..settings },
        8192,
    );
    assert_same_expectation(&both, &light, "both and light sampling");
    assert_same_expectation(&both, &bsdf, "both and BSDF sampling");
    let noise = |film| mean_and_error(film).1 * f64::from(film.radiance[0].samples()).sqrt();
    assert!(
        noise(&both) < noise(&bsdf),
        "next-event estimation makes a room with a lamp less noisy"
    );
}

#[test]
fn techniques_agree_around_glossy_materials() {
    let paint = Principled::paint(Vec3::new(0.7, 0.5, 0.3), 0.25);
    for (name, ball) in [
        ("metal", Principled::metal(Vec3::splat(0.9), 0.35)),
        ("paint", paint),
        ("rough glass", Principled::glass(1.5, 0.4)),
        ("panes", Principled { thin_walled: true, ..Principled::glass(1.5, 0.4) }),
        ("a mixture", Principled { metallic: 0.4, transmission: 0.5, ..paint }),
        ("coated paint", Principled { coat: 0.8, coat_roughness: 0.3, ..paint }),
        ("velvet", Principled { sheen: Vec3::new(0.9, 0.5, 0.7), ..paint }),
        ("half a ball", Principled { opacity: Opacity::Blend { alpha: 0.6 }, ..paint }),
    ] {
        let scene = scenes::room(Material::Principled(ball), 1.0);
        let prepared = prepare(&scene);
        let settings = settings(&scene);
        let of = |techniques, seed, samples| {
            render(&prepared, &Settings { seed, techniques, ..settings }, samples)
        };
        let both = of(Techniques::Both, 1, 512);
        let light = of(Techniques::LightSampling, 2, 1024);
        assert_same_expectation(&both, &light, &format!("{name}, light sampling"));
        let bsdf = of(Techniques::BsdfSampling, 3, 4096);
        assert_same_expectation(&both, &bsdf, &format!("{name}, BSDF sampling"));
    }
}

/// Light samples find the lamp in the liquid from what is in it, and lose what the liquid absorbs.
#[test]
fn techniques_agree_in_a_liquid() {
    let scene = scenes::drink();
    let prepared = prepare(&scene);
    let of = |techniques, seed, samples| {
        render(&prepared, &Settings { seed, techniques, ..settings(&scene) }, samples)
    };
    let both = of(Techniques::Both, 1, 2048);
    assert_same_expectation(&both, &of(Techniques::BsdfSampling, 3, 8192), "in a liquid");
}

#[test]
fn techniques_agree_around_mirrors_and_glass() {
    for (name, ball) in [("mirror", scenes::mirror(0.9)), ("glass", scenes::glass(1.5))] {
        let scene = scenes::room(ball, 1.0);
        let prepared = prepare(&scene);
        let settings = settings(&scene);
        let both = render(&prepared, &Settings { seed: 1, ..settings }, 1024);
        let bsdf = render(
            &prepared,
            &Settings { seed: 3, techniques: Techniques::BsdfSampling, ..settings },
            8192,
        );
        assert_same_expectation(&both, &bsdf, name);
    }
}

#[test]
fn roulette_changes_no_mean() {
    let scene = scenes::room(scenes::glass(1.5), 1.0);
    let prepared = prepare(&scene);
    let settings = Settings { max_depth: 12, ..settings(&scene) };
    let with = render(&prepared, &Settings { seed: 1, roulette_depth: 2, ..settings }, 2048);
    let without = render(&prepared, &Settings { seed: 2, roulette_depth: 13, ..settings }, 2048);
    assert_same_expectation(&with, &without, "roulette on and off");
}

#[test]
fn both_samplers_agree_and_sobol_is_less_noisy() {
    let scene = scenes::room(scenes::mirror(0.9), 1.0);
    let prepared = prepare(&scene);
    let settings = settings(&scene);
    let reference = render(&prepared, &Settings { seed: 9, ..settings }, 16384);
    let independent = render(&prepared, &Settings { seed: 1, ..settings }, 1024);
    let sobol =
        render(&prepared, &Settings { seed: 2, independent_sampler: false, ..settings }, 1024);
    assert_same_expectation(&reference, &sobol, "samplers");
    let error = |film: &raystream::film::Film| {
        film.color()
            .iter()
            .zip(reference.color())
            .map(|(a, b)| f64::from((*a - b).length_squared()))
            .sum::<f64>()
    };
    assert!(error(&sobol) < error(&independent), "{} {}", error(&sobol), error(&independent));
}

/// A scene of any size in world units gives the same picture.
#[test]
fn scale_does_not_matter() {
    let picture = |scale: f32, seed| {
        let scene = scenes::room(scenes::glass(1.5), scale);
        render(&prepare(&scene), &Settings { seed, ..settings(&scene) }, 1024)
    };
    let unit = picture(1.0, 1);
    for (scale, seed) in [(1e-3, 2), (37.0, 3), (1e6, 4)] {
        assert_same_expectation(&unit, &picture(scale, seed), &format!("scale {scale}"));
    }
}

/// A scene far from the origin loses digits, but no light leaks in or out.
#[test]
fn a_closed_box_far_from_the_origin_leaks_nothing() {
    for offset in [0.0, 10.0, 1000.0] {
        let low = Vec3::splat(offset);
        let mut scene =
            scenes::empty(low + Vec3::new(0.5, 0.5, 0.05), low + Vec3::new(0.5, 0.45, 1.0));
        scene.film = FilmSize { width: 33, height: 21 };
        let wall = scene.add_material(scenes::diffuse(1.0));
        add_box(&mut scene, low, low + Vec3::ONE, true, wall);
        scene.background = Vec3::ONE;
        let settings = Settings { roulette_depth: 100, max_depth: 50, ..settings(&scene) };
        let film = render(&prepare(&scene), &settings, 64);
        let lit = film.color().iter().filter(|c| c.max_element() > 0.0).count();
        assert_eq!(lit, 0, "pixels that see out of a box at {offset}");
    }
}
