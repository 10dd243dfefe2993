//! `--denoise` and `raystream denoise`.

use crate::program::{names, render, run};
use raystream::image::{
    Channel, LayeredImage, read_color, read_layers, read_settings, write_layers,
};
use raystream::render::FilterKind;

const SMALL: &str = "--size 24x18 --spp 8";

fn folder() -> tempfile::TempDir {
    tempfile::tempdir().unwrap()
}

#[test]
fn a_render_has_its_filtered_picture_beside_everything_else() {
    let folder = folder();
    let path = |name: &str| folder.path().join(name);
    render(folder.path(), &format!("{SMALL} -o plain.exr")).succeeded();
    for filter in FilterKind::built_in() {
        let arguments = format!("{SMALL} --denoise {filter} -o a.exr -o a.png");
        render(folder.path(), &arguments).succeeded().says(&[filter.name()]);
        assert_eq!(read_settings(&path("a.exr")).unwrap()["denoise"], filter.name());
        let [plain, denoised] = ["plain.exr", "a.exr"].map(|n| read_layers(&path(n)).unwrap());
        for channel in &plain.channels {
            let kept = denoised.channel(&channel.name);
            assert_eq!(kept, Some(channel.values.as_slice()), "{filter}: {}", channel.name);
        }
        assert_eq!(denoised.channels.len(), plain.channels.len() + 4);
        let errors = denoised.channel("denoised_error.V").unwrap();
        assert!(errors.iter().all(|&e| e >= 0.0) && errors.iter().any(|&e| e > 0.0));
        // The PNG shows the filtered picture, and not the other.
        let shown = read_color(&path("a.png")).unwrap();
        let off = |layer: &str| {
            let red = denoised.channel(&format!("{layer}R")).unwrap();
            let pairs = shown.pixels.iter().zip(red).filter(|(_, r)| (0.0..0.7).contains(*r));
            pairs.map(|(shown, r)| (shown.x - r).abs()).fold(0.0, f32::max)
        };
        // Half of the widest step of 8 bits below 0.7, and the tone map is true there.
        assert!(off("denoised.") < 0.005 && off("") > 0.005, "{filter}");
    }
    // Without a name it is the default.
    render(folder.path(), &format!("{SMALL} -o b.exr --denoise")).succeeded();
    assert_eq!(read_settings(&path("b.exr")).unwrap()["denoise"], "auto");
    let wrong = render(folder.path(), &format!("{SMALL} --denoise nonsense"));
    assert_eq!(wrong.status, Some(2));
    wrong.says(&["nonsense", "bilateral", "nlm", "nfor"]);
}

#[test]
fn uniform_samples_are_split_for_it() {
    let folder = folder();
    render(folder.path(), &format!("{SMALL} --allocator uniform --denoise nlm -o a.exr"))
        .succeeded();
    let layers = read_layers(&folder.path().join("a.exr")).unwrap();
    assert!(layers.channel("first.R").is_some() && layers.channel("denoised.R").is_some());
}

#[test]
fn a_picture_is_filtered_later_as_it_would_have_been() {
    let folder = folder();
    let path = |name: &str| folder.path().join(name);
    for allocator in ["runs", "uniform --halves"] {
        for filter in FilterKind::built_in() {
            let arguments = format!("{SMALL} --allocator {allocator} --denoise {filter} -o a.exr");
            render(folder.path(), &arguments).succeeded();
            let device = "--device cpu";
            run(
                folder.path(),
                &format!("denoise a.exr --filter {filter} {device} -o b.exr -o b.png"),
            )
            .succeeded()
            .says(&["wrote b.exr", "wrote b.png", "24x18", "halves", "albedo"]);
            let [then, later] = ["a.exr", "b.exr"].map(|n| read_layers(&path(n)).unwrap());
            assert_eq!(then.channels.len(), later.channels.len());
            let [a, b] = [&then, &later].map(|l| l.channel("denoised.G").unwrap());
            let brightest = a.iter().copied().fold(0.0, f32::max);
            let off = a.iter().zip(b).map(|(a, b)| (a - b).powi(2)).sum::<f32>() / a.len() as f32;
            // Distances are seen by another camera; means are rounded once more.
            assert!(off.sqrt() < 0.01 * brightest, "{allocator}, {filter}: {}", off.sqrt());
            assert_eq!(read_settings(&path("b.exr")).unwrap()["seed"], "0", "the header is kept");
        }
    }
}

#[test]
fn pictures_of_other_renderers_lose_noise() {
    let folder = folder();
    let (width, height) = (48, 32);
    let mut seed = 7_u32;
    let mut noise = || {
        seed = seed.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        (seed >> 8) as f32 / (1 << 24) as f32 - 0.5
    };
    let values: Vec<f32> = (0..width * height).map(|_| 1.0 + noise()).collect();
    let layer = |name: &str, values: Vec<f32>| Channel { name: name.to_owned(), values };
    let constant = |value: f32| vec![value; (width * height) as usize];
    let mut channels: Vec<Channel> =
        ["R", "G", "B"].map(|c| layer(&format!("View.Combined.{c}"), values.clone())).into();
    channels.extend(
        ["R", "G", "B"].map(|c| layer(&format!("View.Denoising Albedo.{c}"), constant(0.5))),
    );
    // A wall across the view, as a camera with 45 degrees from top to bottom sees it.
    let depth = |place: u32| {
        let (x, y) = (place % width, place / width);
        let across = |place: u32, len: u32| (place as f32 + 0.5 - 0.5 * len as f32) * 2.0;
        let (across, up) = (across(x, width), across(y, height));
        let half_view = 0.414_f32 / height as f32;
        3.0 * (1.0 + (across * across + up * up) * half_view * half_view).sqrt()
    };
    channels.push(layer("View.Depth.Z", (0..width * height).map(depth).collect()));
    let image = LayeredImage { width, height, channels };
    write_layers(&folder.path().join("cycles.exr"), &image, &[]).unwrap();
    for filter in FilterKind::built_in() {
        run(folder.path(), &format!("denoise cycles.exr --device cpu --filter {filter} -o b.exr"))
            .succeeded()
            .says(&["albedo", "depth", "noise estimated"]);
        let layers = read_layers(&folder.path().join("b.exr")).unwrap();
        assert_eq!(layers.channel("View.Combined.R").unwrap(), values);
        let denoised = layers.channel("denoised.R").unwrap();
        let error = |values: &[f32]| values.iter().map(|v| (v - 1.0).powi(2)).sum::<f32>();
        let (before, after) = (error(&values), error(denoised));
        assert!(after < 0.2 * before, "{filter}: {after} of {before}");
    }
}

#[test]
fn what_cannot_be_denoised_says_why() {
    let folder = folder();
    render(folder.path(), &format!("{SMALL} -o a.exr -o a.png")).succeeded();
    let with = |arguments: &str| run(folder.path(), &format!("denoise {arguments} --device cpu"));
    with("a.exr -o ./a.exr").failed(&["a.exr", "would replace"]);
    with("a.exr -o b.exr -o ./b.exr").failed(&["b.exr", "twice"]);
    with("a.exr -o b.jpg").failed(&["b.jpg", "use .exr or .png"]);
    with("a.png -o b.exr").failed(&["a.png", "not a valid EXR"]);
    with("missing.exr -o b.exr").failed(&["missing.exr", "no such file"]);
    let image = LayeredImage {
        width: 1,
        height: 1,
        channels: vec![Channel { name: "depth.Z".into(), values: vec![1.0] }],
    };
    write_layers(&folder.path().join("depth.exr"), &image, &[]).unwrap();
    with("depth.exr -o b.exr").failed(&["depth.exr", "depth.Z", "R, G, B"]);
    assert_eq!(names(folder.path()), ["a.exr", "a.png", "depth.exr"]);
}

#[test]
fn noise_is_that_of_the_filtered_picture() {
    let folder = folder();
    let path = |name: &str| folder.path().join(name);
    let samples = |arguments: &str| -> f64 {
        let arguments = format!("--size 32x24 --noise 0.3 --round-budget 4 -o a.exr {arguments}");
        render(folder.path(), &arguments).succeeded();
        let settings = read_settings(&path("a.exr")).unwrap();
        assert_eq!(settings["stop"], "noise");
        assert!(settings["estimated_error"].parse::<f64>().unwrap() <= 0.3);
        settings["samples"].parse().unwrap()
    };
    let (plain, denoised) =
        (samples("--allocator uniform"), samples("--allocator uniform --denoise"));
    assert!(denoised < 0.7 * plain, "{denoised} of {plain} samples");
}
