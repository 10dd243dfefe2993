//! `--denoise oidn`, with a library in the place of Open Image Denoise.

use crate::program::{Run, program};
use raystream::image::{Channel, LayeredImage, read_layers, read_settings, write_layers};
use std::path::{Path, PathBuf};
use std::process::Command;

/// Compiles C to a library in a folder; none where there is no compiler.
fn library(folder: &Path, name: &str, source: &str) -> Option<PathBuf> {
    let (source_file, library) = (folder.join(format!("{name}.c")), folder.join(name));
    std::fs::write(&source_file, source).unwrap();
    let compiled =
        Command::new("cc").args(["-shared", "-fPIC", "-o"]).args([&library, &source_file]).status();
    match compiled {
        Ok(status) => {
            assert!(status.success(), "{name} compiles");
            Some(library)
        }
        Err(error) => {
            eprintln!("NOT TESTED: the filter oidn; there is no C compiler `cc`: {error}");
            None
        }
    }
}

/// Runs the program where the library is what a path names.
fn run_with(folder: &Path, library: &Path, arguments: &str) -> Run {
    let arguments: Vec<_> = arguments.split_whitespace().collect();
    let mut program = program(folder, &arguments);
    Run::new(program.env("RAYSTREAM_OIDN", library).output().expect("the program starts"))
}

fn write_noise(path: &Path, width: u32, height: u32) -> Vec<f32> {
    let mut seed = 7_u32;
    let mut noise = || {
        seed = seed.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        (seed >> 8) as f32 / (1 << 24) as f32 - 0.5
    };
    let values: Vec<f32> = (0..width * height).map(|_| 1.0 + noise()).collect();
    let channels =
        ["R", "G", "B"].map(|name| Channel { name: name.into(), values: values.clone() });
    let image = LayeredImage { width, height, channels: channels.into() };
    write_layers(path, &image, &[]).unwrap();
    values
}

#[test]
fn the_library_filters_and_is_guarded() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let Some(library) = library(folder, "liboidn.so", include_str!("oidn.c")) else { return };
    let values = write_noise(&folder.join("noisy.exr"), 48, 32);
    run_with(folder, &library, "denoise noisy.exr --filter oidn --device cpu -o clean.exr")
        .succeeded()
        .says(&["oidn"]);
    let layers = read_layers(&folder.join("clean.exr")).unwrap();
    let error = |values: &[f32]| values.iter().map(|v| (v - 1.0).powi(2)).sum::<f32>();
    let denoised = layers.channel("denoised.R").unwrap();
    let (before, after) = (error(&values), error(denoised));
    assert!(after < 0.1 * before, "{after} of {before}");
    let left: f32 = layers.channel("denoised_error.V").unwrap().iter().sum();
    assert!(left > 0.3 * after && left < after + 0.16 * before, "{left} for {after}");
    assert_eq!(read_settings(&folder.join("clean.exr")).unwrap()["denoise"], "oidn");
}

#[test]
fn renders_go_by_the_filtered_picture() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let Some(library) = library(folder, "liboidn.so", include_str!("oidn.c")) else { return };
    let arguments = "render --device cpu --size 24x18 --spp 8 --denoise oidn -o a.exr";
    run_with(folder, &library, arguments).succeeded();
    let layers = read_layers(&folder.join("a.exr")).unwrap();
    let errors = layers.channel("denoised_error.V").unwrap();
    assert!(errors.iter().all(|&e| e >= 0.0) && errors.iter().any(|&e| e > 0.0));
    // A blur of a picture with edges must come back to it.
    let off = |layer: &str| {
        let denoised = layers.channel("denoised.G").unwrap();
        let pairs = denoised.iter().zip(layers.channel(layer).unwrap());
        pairs.map(|(a, b)| (a - b).abs()).fold(0.0, f32::max)
    };
    assert!(off("G") > 0.0);
}

#[test]
fn what_is_wrong_with_the_library_is_said() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    write_noise(&folder.join("noisy.exr"), 13, 4);
    let arguments = "denoise noisy.exr --filter oidn --device cpu -o clean.exr";
    let missing = folder.join("missing.so");
    run_with(folder, &missing, arguments).failed(&["Open Image Denoise", "RAYSTREAM_OIDN"]);
    let render = "render --device cpu --size 8x8 --spp 2 --denoise oidn -o a.exr";
    run_with(folder, &missing, render).failed(&["Open Image Denoise", "missing.so"]);
    let Some(old) = library(folder, "libold.so", "void *oidnNewDevice(int t) { return 0; }") else {
        return;
    };
    run_with(folder, &old, arguments).failed(&["libold.so", "version 2 is needed"]);
    let library = library(folder, "liboidn.so", include_str!("oidn.c")).unwrap();
    run_with(folder, &library, arguments).failed(&["Open Image Denoise", "unlucky width"]);
    assert!(!folder.join("clean.exr").exists() && !folder.join("a.exr").exists());
}
