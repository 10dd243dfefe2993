//! What `compare` says of pictures whose numbers do not mean the same.

use crate::program::{Run, render, run};
use raystream::image::{Channel, LayeredImage, write_layers};
use std::path::Path;

fn json(run: &Run) -> serde_json::Value {
    serde_json::from_str(&run.stdout).unwrap()
}

/// A Y of 0.25 and the same as R, G and B.
#[test]
fn grey_equals_its_colour() {
    let folder = tempfile::tempdir().unwrap();
    let write = |name: &str, channels: &[&str]| {
        let channels = channels.iter();
        let channels =
            channels.map(|name| Channel { name: (*name).into(), values: vec![0.25; 6] }).collect();
        let image = LayeredImage { width: 3, height: 2, channels };
        write_layers(&folder.path().join(name), &image, &[]).unwrap();
    };
    write("y.exr", &["A", "Y"]);
    write("rgb.exr", &["R", "G", "B"]);
    let run = run(folder.path(), "compare y.exr rgb.exr --json").succeeded();
    assert_eq!(json(&run)["rmse"], 0.0);
    assert_eq!((run.stderr.as_str(), json(&run)["warnings"].as_array().unwrap().len()), ("", 0));
}

#[test]
fn radiance_and_a_png_are_not_the_same() {
    let folder = tempfile::tempdir().unwrap();
    render(folder.path(), "--size 8x6 --spp 4 -q -o a.exr -o a.png").succeeded();
    let said = ["warning: a.png: a PNG is not radiance"];
    let first = run(folder.path(), "compare a.exr a.png").succeeded().says(&said);
    assert!(first.stdout.starts_with("RMSE "));
    let second = run(folder.path(), "compare a.png a.exr --json").succeeded().says(&said);
    assert_eq!(json(&second)["warnings"].as_array().unwrap().len(), 1);
    for alike in ["a.exr a.exr", "a.png a.png"] {
        assert_eq!(run(folder.path(), &format!("compare {alike}")).succeeded().stderr, "");
    }
}

/// A PNG shows what the comparison makes of the EXR, up to its 8 bits.
#[test]
fn similarity_is_that_of_what_is_shown() {
    let folder = tempfile::tempdir().unwrap();
    render(folder.path(), "--size 32x24 --spp 4 -q -o a.exr -o a.png").succeeded();
    render(folder.path(), "--size 32x24 --spp 4 --seed 1 -q -o b.exr -o b.png").succeeded();
    let ssim = |pictures: &str| {
        let run = run(folder.path(), &format!("compare {pictures} --json")).succeeded();
        json(&run)["ssim"].as_f64().unwrap()
    };
    assert_eq!([ssim("a.exr a.exr"), ssim("b.png b.png")], [1.0; 2]);
    let other = ssim("a.exr b.exr");
    assert!(0.0 < other && other < 0.99, "{other}");
    for shown in [ssim("a.exr b.png"), ssim("a.png b.exr"), ssim("a.png b.png")] {
        assert!((shown - other).abs() < 0.01, "{shown} of PNGs, {other} of EXRs");
    }
    let text = run(folder.path(), "compare a.exr b.exr").succeeded().stdout;
    assert!(text.contains(&format!("\nSSIM            {other:.6}\n")), "{text}");
}

/// Renders of one scene, which `arguments` of the first and of the second tell apart, tested for
/// agreement.
fn agreement(folder: &Path, first: &str, second: &str) -> Run {
    render(folder, &format!("--size 80x60 -q -o a.exr {first}")).succeeded();
    render(folder, &format!("--size 80x60 -q -o b.exr {second}")).succeeded();
    run(folder, "compare a.exr b.exr --reference-samples 16").succeeded()
}

const UNIFORM: &str = "--allocator uniform --sampler independent --spp 16";

#[test]
fn verdicts_in_words() {
    let folder = tempfile::tempdir().unwrap();
    let same = agreement(folder.path(), UNIFORM, &format!("{UNIFORM} --seed 1"));
    assert_eq!(same.stderr, "");
    assert!(same.stdout.contains("verdict         the same scene"), "{}", same.stdout);
    let other = format!("{UNIFORM} --seed 1 --max-depth 2");
    let differs = agreement(folder.path(), UNIFORM, &other);
    assert!(differs.stdout.contains("verdict         not the same scene"), "{}", differs.stdout);
    let as_json = json(&run(folder.path(), "compare a.exr b.exr --reference-samples 16 --json"));
    assert_eq!(as_json["agreement"]["same_scene"], false);
    assert!(as_json["agreement"]["worst_block"].as_f64() > as_json["agreement"]["limit"].as_f64());
}

#[test]
fn what_the_test_of_agreement_cannot_tell() {
    let folder = tempfile::tempdir().unwrap();
    let seeded = format!("{UNIFORM} --seed 1");
    for (first, second, said) in [
        ("--spp 16", &*seeded, "a.exr: was rendered with --allocator runs"),
        (&seeded, "--spp 16 --allocator paper", "b.exr: was rendered with --allocator paper"),
        (UNIFORM, UNIFORM, "both pictures have the seed 0"),
        (
            UNIFORM,
            &format!("{seeded} --integrator lvc"),
            "b.exr: was rendered with --integrator lvc",
        ),
        (UNIFORM, &seeded.replace("16", "4"), "the reference says that it has 4 per pixel"),
    ] {
        let run = agreement(folder.path(), first, second).says(&[said]);
        assert!(run.stdout.contains("verdict         not sure"), "{}", run.stdout);
        let json =
            json(&self::run(folder.path(), "compare a.exr b.exr --reference-samples 16 --json"));
        assert!(json["agreement"]["same_scene"].is_null(), "{json}");
        assert!(json["warnings"][0].as_str().unwrap().contains(said), "{json}");
    }
    let single = UNIFORM.replace("16", "1");
    let run = agreement(folder.path(), &single, &seeded);
    assert!(run.stdout.contains("fewer than two samples"), "{}", run.stdout);
}
