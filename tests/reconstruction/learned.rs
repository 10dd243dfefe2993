//! The filter `learned` and its network, and the mixture that is `auto`.

use super::films::{mean_squared_error, noisy_wall, picture_of, view};
use super::guard::Blackout;
use crate::estimator::walls::SAMPLES;
use glam::{Vec3, Vec4};
use raystream::exec::Executor;
use raystream::exec::cpu::CpuExecutor;
use raystream::render::film::row_place;
use raystream::render::reconstruction::auto::Auto;
use raystream::render::reconstruction::{Filter, FilterInputs, FilteredPicture, create, learned};
use raystream::render::{FilmBuffers, FilterKind, FilterSettings};
use raystream::scene::FilmSize;
use raystream_shaders::reconstruction::learned::description::Description;
use raystream_shaders::reconstruction::learned::filter::filter;
use raystream_shaders::reconstruction::learned::network::{self, INPUTS};
use raystream_shaders::reconstruction::learned::{LARGEST, PixelFilter};

const SIZE: [u32; 2] = [32, 32];
const FILM: FilmSize = FilmSize { width: SIZE[0], height: SIZE[1] };

#[test]
fn whatever_the_network_says_what_is_clearly_brighter_stays_apart() {
    for output in [-1e30, -5.0, 0.0, 5.0, 1e30, f32::NAN] {
        let filter = PixelFilter::new([Vec4::splat(output); 2], 0.5);
        let (features, colors) = (filter.features, filter.colors);
        assert!(features.is_finite() && features.min_element() > 0.0, "{output}: {features}");
        assert!(colors.is_finite() && colors.min_element() > 0.0, "{output}: {colors}");
        // Three standard errors and no more are noise, and ten of them weigh next to nothing.
        assert!(colors.y < 9.0 && colors.w < 9.0, "{output}: {colors}");
        assert!((-colors.x * (100.0 - colors.y)).exp() < 1e-4, "{output}: {colors}");
    }
    let largest = PixelFilter::new(LARGEST, 0.5);
    assert_eq!(largest.features, PixelFilter::new([Vec4::splat(1e30); 2], 0.5).features);
}

#[test]
fn what_was_learned_depends_on_every_number_of_the_description() {
    let weights = learned::weights();
    assert!(weights.iter().all(|row| row.is_finite()));
    let outputs = |inputs: &[f32; INPUTS]| network::evaluate(&weights, inputs);
    let base = outputs(&[0.0; INPUTS]);
    for input in 0..INPUTS {
        let mut inputs = [0.0; INPUTS];
        inputs[input] = 1.0;
        assert_ne!(outputs(&inputs), base, "input {input}");
    }
}

/// How far a filtered pixel follows its own colour, against what it does when that changes a
/// little.
#[test]
fn the_own_part_is_the_derivative() {
    const STEP: f32 = 1e-3;
    let film = noisy_wall(SIZE, SAMPLES, 11, |x, y| Vec3::splat(1.0 + 0.05 * (x + y) as f32));
    let executor = &CpuExecutor;
    let inputs = FilterInputs::new(executor, FILM).expect("it fits");
    let buffers = FilmBuffers::from_film(executor, &film).expect("it fits");
    executor.run(&inputs.launches(&buffers)).expect("the device works");
    let mut guides = inputs.guides.read(executor).expect("the device works");
    let first = inputs.first.read(executor).expect("the device works");
    let second = inputs.second.read(executor).expect("the device works");
    let parameters = learned::parameters(&view(FILM));
    let describe = |rank| Description::of(&parameters, &guides, &first, &second, rank);
    let described: Vec<Description> = (0..parameters.threads).map(describe).collect();
    let mut smoothed: Vec<Vec4> = described.iter().map(|d| d.smoothed).collect();
    let (mut wrong, mut between) = (0, 0);
    for (rank, described) in described.iter().enumerate() {
        let of_pixel = PixelFilter::new([Vec4::ZERO; 2], described.own);
        let (guide, smooth) = (guides[rank], smoothed[rank]);
        let mut at = |step: f32| {
            guides[rank].color = guide.color + step;
            smoothed[rank] = smooth + Vec3::splat(step * described.own).extend(0.0);
            let filtered = filter(&parameters, &guides, &smoothed, &of_pixel, rank as u32);
            (guides[rank], smoothed[rank]) = (guide, smooth);
            filtered
        };
        let slope = (at(STEP).color.x - at(-STEP).color.x) / (2.0 * STEP);
        let own = at(0.0).own;
        if slope > 0.01 && slope < 1.0 && own < 1.0 {
            between += 1;
            // Roundings of the difference are 1e-4 of the step; weights bend within it by less.
            wrong += usize::from((slope - own).abs() > 0.01);
        }
    }
    // Where a neighbour's difference becomes more than noise within the step, a slope jumps: a step
    // is 1/250 of a deviation, and has 224 neighbours to do so, most of which weigh nothing.
    assert!(between > 500 && wrong * 10 < between, "{wrong} of {between}");
}

/// A filtered picture and what it is worth: its mean squared error.
fn error_of(mixed: Box<dyn Filter<<CpuExecutor as Executor>::Buffer>>, truth: &[Vec3]) -> f64 {
    let executor = &CpuExecutor;
    let film = noisy_wall(SIZE, SAMPLES, 5, |_, _| Vec3::ONE);
    let picture = FilteredPicture::with_filter(executor, FILM, mixed).expect("it fits");
    let buffers = FilmBuffers::from_film(executor, &film).expect("it fits");
    let before = picture.inputs().launches(&buffers);
    picture.run(executor, before, &view(FILM), Vec::new()).expect("the device works");
    let ranks = picture.filtered().read(executor).expect("the device works");
    let mut rows = vec![Vec3::ZERO; ranks.len()];
    for (rank, pixel) in ranks.iter().enumerate() {
        rows[row_place(FILM, rank as u32)] = pixel.color;
    }
    mean_squared_error(&rows, truth)
}

/// The truth is 1 and the variance 1/16. Beside a black picture the part of the other is estimated
/// within a deviation of `sqrt(1/16/200)` over 200 pixels, and what is above 1 does not count: the
/// picture is too dark by that squared, 3e-4, half of the time. The doubt adds less than 1e-6.
#[test]
fn of_two_filters_the_better_one_is_taken() {
    let executor = &CpuExecutor;
    let truth = picture_of(SIZE, |_, _| Vec3::ONE);
    let settings = FilterSettings::default();
    let good = || create(executor, FILM, FilterKind::Bilateral, settings).expect("it fits");
    let alone = error_of(good(), &truth);
    assert_eq!(error_of(Box::new(Blackout), &truth), 1.0);
    let mixture = |first, second| {
        error_of(Box::new(Auto::of(executor, FILM, first, second).expect("it fits")), &truth)
    };
    for (order, error) in [
        ("first", mixture(good(), Box::new(Blackout))),
        ("second", mixture(Box::new(Blackout), good())),
    ] {
        assert!(error < alone + 3e-4, "the good one is the {order}: {error:e}, alone {alone:e}");
    }
}
