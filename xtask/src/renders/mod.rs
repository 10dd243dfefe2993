//! `cargo xtask renders`: what a program renders, as digests of pixels. Two lists of them tell
//! whether a change to the code changed any picture.

mod list;
mod pixels;

use crate::Outcome;
use anyhow::{Context, Result, bail};
use clap::Args;
use list::{Digest, Line};
use std::env;
use std::fs;
use std::io::{Write, stdout};
use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::Instant;
use tempfile::TempDir;

const SCENES: [&str; 7] =
    ["caustics", "cornell_ball", "cornell_glass", "daylight", "metals", "opening", "tea"];
/// Scenes whose geometry lies in the folder that [`FOLDER`] names.
const LARGE_SCENES: [&str; 2] = ["conference", "sibenik"];
const FOLDER: &str = "SCENES_DIR";
const INTEGRATORS: [&str; 5] = ["megakernel", "compaction", "regeneration", "streaming", "lvc"];
const ALLOCATORS: [&str; 4] = ["uniform", "paper", "atomic", "runs"];
/// The allocator that adds in the order in which threads come.
const UNORDERED: &str = "atomic";

/// Small, and three rounds, so that two of them go by errors. Nothing follows from time.
const SETTINGS: &str = "--size 24x16 --spp 8 --initial-spp 4 --round-budget 2 --seed 7 \
                        --light-paths 256 --connections 2 --bvh fast --quiet";
/// Have a CPU, and a GPU that Mesa makes of one, run one thread: then threads come in order.
const ONE_THREAD: [(&str, &str); 2] = [("RAYON_NUM_THREADS", "1"), ("LP_NUM_THREADS", "1")];

/// What to render, and what to compare with.
#[derive(Args)]
pub struct Arguments {
    /// The program whose renders these are.
    #[arg(long, value_name = "PATH")]
    binary: PathBuf,
    /// Where to render, as `raystream render` takes it; may be given several times.
    #[arg(long = "device", value_name = "DEVICE", default_values = ["cpu", "gpu"])]
    devices: Vec<String>,
    /// A list that this wrote earlier. What differs is named, and the exit status is then 1. Lines
    /// of other devices do not count.
    #[arg(long, value_name = "FILE")]
    against: Option<PathBuf>,
}

/// Renders everything, prints the list, and compares it if asked to.
pub fn run(arguments: &Arguments) -> Result<Outcome> {
    let start = Instant::now();
    let earlier =
        arguments.against.as_deref().map(|path| read(path, &arguments.devices)).transpose()?;
    let folder = TempDir::new().context("cannot create a temporary folder")?;
    let binary = copy(&arguments.binary, folder.path())?;
    let mut scenes = SCENES.to_vec();
    let mut note = String::new();
    if env::var_os(FOLDER).is_some_and(|value| !value.is_empty()) {
        scenes.extend(LARGE_SCENES);
    } else {
        note = format!("\nNOT RENDERED: {}, since {FOLDER} is not set", LARGE_SCENES.join(", "));
        eprintln!("warning:{note}");
    }
    let mut now = Vec::new();
    for scene in scenes {
        for integrator in INTEGRATORS {
            for allocator in ALLOCATORS {
                for device in &arguments.devices {
                    let options = [scene, integrator, allocator, device];
                    let line = Line {
                        digest: digest(&binary, folder.path(), options)?,
                        render: options.join(" "),
                    };
                    writeln!(stdout(), "{line}").context("cannot print the list")?;
                    now.push(line);
                }
            }
        }
    }
    let rendered = format!("{} renders in {:.0} s", now.len(), start.elapsed().as_secs_f32());
    let Some(earlier) = earlier else {
        return Ok(Outcome::Good(format!("{rendered}{note}")));
    };
    let comparison = list::compare(&earlier, &now);
    let lines = [comparison.undecided, comparison.differences.clone()].concat();
    let message = format!(
        "{}\n{rendered}: {} as before, {} not{note}",
        lines.join("\n"),
        comparison.same,
        comparison.differences.len()
    );
    let same = comparison.differences.is_empty();
    Ok(if same { Outcome::Good(message) } else { Outcome::Bad(message) })
}

/// The lines of the list in the file `path` that are of `devices`.
fn read(path: &Path, devices: &[String]) -> Result<Vec<Line>> {
    let text =
        fs::read_to_string(path).with_context(|| format!("cannot read {}", path.display()))?;
    let mut lines = list::parse(&text).with_context(|| path.display().to_string())?;
    lines.retain(|line| devices.iter().any(|device| device == line.device()));
    Ok(lines)
}

/// A copy of the program, so that all renders are of one, whatever a build puts into its place.
fn copy(binary: &Path, folder: &Path) -> Result<PathBuf> {
    let name = binary.file_name().with_context(|| format!("{} is no file", binary.display()))?;
    let copy = folder.join(name);
    fs::copy(binary, &copy).with_context(|| format!("cannot copy {}", binary.display()))?;
    Ok(copy)
}

/// Renders `[scene, integrator, allocator, device]`, twice where the pixels may vary.
fn digest(binary: &Path, folder: &Path, options: [&str; 4]) -> Result<Digest> {
    let digest = render(binary, folder, options)?;
    let [_, _, allocator, _] = options;
    let varies = allocator == UNORDERED && render(binary, folder, options)? != digest;
    Ok(if varies { Digest::Varies } else { Digest::Pixels(digest) })
}

/// The digest of one render.
fn render(binary: &Path, folder: &Path, options: [&str; 4]) -> Result<String> {
    let picture = folder.join("picture.exr");
    let [scene, integrator, allocator, device] = options;
    let mut command = Command::new(binary);
    command
        .args(["render", scene, "--integrator", integrator, "--allocator", allocator])
        .args(["--device", device])
        .args(SETTINGS.split_whitespace())
        .arg("--output")
        .arg(&picture);
    if allocator == UNORDERED {
        command.envs(ONE_THREAD);
    }
    let output = command.output().with_context(|| format!("cannot run {}", binary.display()))?;
    if !output.status.success() {
        bail!(
            "{} failed ({}) at {}:\n{}",
            binary.display(),
            output.status,
            options.join(" "),
            String::from_utf8_lossy(&output.stderr).trim()
        );
    }
    let digest = pixels::sha256(&picture)?;
    // So that a program that writes nothing is not taken for one that writes the same.
    fs::remove_file(&picture).with_context(|| format!("cannot remove {}", picture.display()))?;
    Ok(digest)
}
