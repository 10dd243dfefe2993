//! Trains the network of the filter `learned`.
//!
//! ```text
//! cargo run --release -p train-filter -- train --cache FOLDER -o FILE
//! cargo run --release -p train-filter -- compare SCENE ...
//! ```
//!
//! `train` renders random rooms with few samples and with many on the CPU, and looks for the
//! weights with which the filter brings the former closest to the latter. `compare` measures
//! filters on scenes that nothing was trained on: scenes that ship, files, and rooms of other
//! numbers. Both do the same each time, on machines that compute alike.

mod comparison;
mod films;
mod gradients;
mod rooms;
mod training;

use anyhow::{Context, Result};
use clap::{Parser, Subcommand};
use films::{Example, Noisy, Sampled};
use raystream::scene::FilmSize;
use std::path::{Path, PathBuf};

#[derive(Parser)]
#[command(about = "Trains the network of the filter `learned`")]
struct Arguments {
    #[command(subcommand)]
    command: Command,
}

#[derive(Subcommand)]
enum Command {
    /// Train on random rooms.
    Train {
        /// Rooms.
        #[arg(long, default_value_t = 64)]
        rooms: u64,
        /// Samples per pixel of the pictures to come close to.
        #[arg(long, default_value_t = 256)]
        reference_spp: u32,
        /// Steps of training.
        #[arg(long, default_value_t = 20_000)]
        steps: u32,
        /// Of weights at the beginning, and of the order of pixels.
        #[arg(long, default_value_t = 1)]
        seed: u64,
        /// Where rendered films are kept.
        #[arg(long, value_name = "FOLDER")]
        cache: PathBuf,
        /// Where the weights go.
        #[arg(short, long, value_name = "FILE")]
        output: PathBuf,
    },
    /// Compare the filters on other scenes.
    Compare(comparison::Arguments),
}

/// Size of the pictures to learn from.
const SIZE: FilmSize = FilmSize { width: 120, height: 88 };
/// Samples per pixel of films, by turns.
const SAMPLES: [u32; 5] = [4, 8, 16, 32, 64];

fn main() -> Result<()> {
    match Arguments::parse().command {
        Command::Train { rooms, reference_spp, steps, seed, cache, output } => {
            std::fs::create_dir_all(&cache)
                .with_context(|| format!("cannot create {}", cache.display()))?;
            let mut examples = Vec::new();
            for number in 0..rooms {
                // Where no light falls there is nothing to learn.
                let of_room = learn_from(number, reference_spp, &cache)?;
                examples.extend(of_room.into_iter().filter(|example| example.mean > 0.0));
            }
            let weights = training::train(&examples, steps, seed, |line: &str| eprintln!("{line}"));
            std::fs::write(&output, bytemuck::cast_slice(&weights))
                .with_context(|| format!("cannot write {}", output.display()))
        }
        Command::Compare(arguments) => comparison::run(&arguments),
    }
}

/// The films of a room: one with uniform samples, one with adaptive ones.
fn learn_from(number: u64, reference_spp: u32, cache: &Path) -> Result<Vec<Example>> {
    let scene = rooms::room(number, SIZE);
    scene.check()?;
    let FilmSize { width, height } = SIZE;
    let path = |is_adaptive: bool| cache.join(format!("{number}-{reference_spp}-{is_adaptive}"));
    if ![true, false].iter().all(|&is_adaptive| path(is_adaptive).exists()) {
        eprintln!("rendering {}: {} triangles", scene.name, scene.triangle_count());
        let prepared = films::prepare(&scene)?;
        let reference = films::reference(&scene, &prepared, reference_spp)?;
        for is_adaptive in [true, false] {
            let samples = SAMPLES[(number as usize + 2 * usize::from(is_adaptive)) % SAMPLES.len()];
            let sampled = Sampled { samples, is_adaptive, seed: 1 };
            let film = films::render(&scene, &prepared, sampled)?;
            Noisy { film, reference: reference.clone() }.write(&path(is_adaptive))?;
        }
    }
    let read = |is_adaptive| {
        let noisy = Noisy::read(&path(is_adaptive), width, height)?;
        Example::new(&scene, &noisy)
    };
    [true, false].into_iter().map(read).collect()
}
