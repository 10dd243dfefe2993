use super::*;
use raystream::exec::cpu::CpuExecutor;
use raystream::scene::load_named;
use stages::Stage;

const ADAPTIVE: [&str; 9] = [
    "Film",
    "Guides",
    "Filtered",
    "Error",
    "Weights",
    "Runs",
    "Slots",
    "Contributions",
    "Film after",
];
const UNIFORM: [&str; 4] = ["Film", "Slots", "Contributions", "Film after"];
const PIXELS: u64 = 40 * 30;

fn choice(allocator: AllocatorKind) -> Choice {
    Choice {
        size: FilmSize { width: 40, height: 30 },
        allocator,
        estimator: Estimator::Bilateral,
        relative: false,
        budget: 1.0,
        seed: 0,
    }
}

fn method(choice: Choice) -> Method<CpuExecutor> {
    Method::new(CpuExecutor, &load_named("cornell_ball").unwrap(), choice).unwrap()
}

fn names(told: &Told) -> Vec<&'static str> {
    told.stages.iter().map(|stage| stage.name).collect()
}

fn value(stages: &[Stage], key: &str) -> String {
    let facts = stages.iter().flat_map(|stage| &stage.facts);
    facts.filter(|fact| fact.key == key).map(|fact| fact.value.clone()).next().unwrap()
}

fn number(stages: &[Stage], key: &str) -> u64 {
    value(stages, key).parse().unwrap()
}

/// That a round goes on from the one before and its numbers fit together.
fn check(told: &Told, before: u64) -> u64 {
    let stages = &told.stages;
    let slots = number(stages, "slots");
    assert_eq!(number(stages, "samples-before"), before);
    assert_eq!(number(stages, "samples-after"), before + slots);
    assert_eq!(value(stages, "adds-up"), "yes, bit for bit");
    assert!(slots > 0 && slots <= number(stages, "budget"));
    for stage in stages {
        assert!(stage.text.len() > 60 && !stage.text.contains("  "), "{}", stage.text);
        for painted in &stage.pictures {
            let [width, height] = painted.size;
            assert_eq!(painted.rgba.len() as u32, 4 * width * height, "{}", painted.title);
        }
    }
    before + slots
}

#[test]
fn rounds_are_shown_from_film_to_film() {
    let mut method = method(choice(AllocatorKind::Runs));
    let first = method.round().unwrap();
    assert_eq!((first.round, names(&first)), (1, UNIFORM.to_vec()));
    let mut samples = check(&first, 0);
    assert_eq!(samples, 5 * PIXELS, "the initial samples");
    for round in 2..5 {
        let told = method.round().unwrap();
        assert_eq!((told.round, names(&told)), (round, ADAPTIVE.to_vec()));
        samples = check(&told, samples);
        assert_eq!(number(&told.stages, "slots"), PIXELS, "the budget, exactly");
        assert_eq!(number(&told.stages, "budget"), PIXELS);
        assert!(number(&told.stages, "runs") <= PIXELS);
        for stage in &told.stages {
            for painted in &stage.pictures {
                let first = &painted.rgba[..4];
                assert!(
                    painted.rgba.chunks(4).any(|color| color != first),
                    "{}, {}",
                    stage.name,
                    painted.title
                );
            }
        }
    }
}

#[test]
fn every_allocator_and_estimator_has_its_stages() {
    let mut seen = Vec::new();
    for (allocator, estimator) in [
        (AllocatorKind::Uniform, Estimator::Bilateral),
        (AllocatorKind::Paper, Estimator::Halves),
        (AllocatorKind::Atomic, Estimator::Variance),
        (AllocatorKind::Runs, Estimator::AxisAligned),
    ] {
        let mut method = method(Choice { estimator, relative: true, ..choice(allocator) });
        let mut samples = 0;
        let mut told = method.round().unwrap();
        samples = check(&told, samples);
        told = method.round().unwrap();
        check(&told, samples);
        seen.push(names(&told));
    }
    let streams = ["Film", "Guides", "Filtered", "Error", "Streams", "Slots", "Contributions"];
    assert_eq!(seen[0], UNIFORM);
    assert_eq!(seen[1][..7], streams);
    assert_eq!((&seen[2][..], &seen[3][..]), (&ADAPTIVE[..], &ADAPTIVE[..]));
}

#[test]
fn short_rounds_leave_the_share_of_all_pixels_to_rounds_of_its_own() {
    let mut method = method(Choice { budget: 0.5, ..choice(AllocatorKind::Runs) });
    let (mut samples, mut kinds) = (0, Vec::new());
    for _ in 0..16 {
        let told = method.round().unwrap();
        samples = check(&told, samples);
        kinds.push((told.stages.len(), number(&told.stages, "slots")));
    }
    assert!(
        kinds[1..].contains(&(9, PIXELS / 2)) && kinds[1..].contains(&(4, PIXELS)),
        "{kinds:?}"
    );
}

/// The check can fail.
#[test]
fn a_film_that_lacks_a_contribution_does_not_add_up() {
    let recording = Recording::new(CpuExecutor, seen::keep);
    let scene = load_named("cornell_ball").unwrap();
    let prepared = PreparedScene::new(&scene, BvhQuality::Fast).unwrap();
    let settings = settings(&scene, &choice(AllocatorKind::Runs));
    let mut renderer = Renderer::new(recording.clone(), &prepared, &settings).unwrap();
    renderer.step(u64::MAX).unwrap();
    let mut seen = Seen::of(&recording.take()).unwrap();
    assert!(seen.adds_up());
    let brightest = seen.contributions.iter().position(|c| c.radiance.x > 0.0).unwrap();
    seen.contributions[brightest].radiance.x *= 1.0 + f32::EPSILON;
    assert!(!seen.adds_up());
}
