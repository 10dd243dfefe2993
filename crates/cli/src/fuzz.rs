//! Command lines by chance: each is understood or refused.

use crate::Arguments;
use crate::effects::Given;
use clap::{CommandFactory, FromArgMatches};
use raystream_tests::fuzz::Target;
use std::ffi::OsString;

/// Command lines, one argument a line.
const SEEDS: &[&str] = &[
    "render\ncornell_ball\n-o\na.png\n--spp\n16\n--time\n2.5\n--noise\n0.02\n--size\n32x24",
    "render\n-\n--estimator\nhalves\n--allocator=paper\n--relative\n--filter-radius\n3\n-q",
    "render\n--integrator\nlvc\n--light-paths\n100\n--connections\n2\n--exposure\n-1.5\n-vv",
    "render\n--device\ngpu:2\n--naga\n--ray-offset\n1500\n--max-memory\n0.5\n--threads\n3",
    "compare\na.exr\nb.exr\n--gain\n8\n--json\n--reference-samples\n64\n-o\nd.png",
    "devices\n--validation",
    "bench\nconvergence\na@60x50\n--allocators\npaper,runs\n--levels\n4,16\n--cache\nx",
    "bench\nintegrators\n--integrators\nlvc,streaming\n--stream\n100\n--repetitions\n2",
    "bench\nbias\n--spp\n16,64\n--renders\n3\n--truth-spp\n64\n--seed\n4294967295",
    "inspect\na.glb\n--json\n--camera\nCamera.001\n--max-memory\n2",
    "help\nbench\nrays",
];

const WORDS: &[&str] = &[
    "\n",
    "=",
    "-",
    "--",
    ",",
    "@",
    "x",
    "0x0",
    "--help",
    "--version",
    "--seed",
    "--spp",
    "--time",
    "--noise",
    "--size",
    "--output",
    "--bvh",
    "--sampler",
    "--tone-map",
    "--png-layers",
    "--halves",
    "--max-depth",
    "--rr-depth",
    "auto",
    "cpu",
    "inf",
    "NaN",
    "\u{fc}",
    "render",
    "bench",
    "scenes",
];

#[test]
fn command_lines_by_chance() {
    let run = |input: &[u8]| {
        let arguments = input.split(|&byte| byte == b'\n').map(argument);
        let arguments = std::iter::once("raystream".into()).chain(arguments);
        match Arguments::command().try_get_matches_from(arguments) {
            Ok(matches) => {
                let _ = Given::of(&matches);
                Arguments::from_arg_matches(&matches).expect("it was understood");
            }
            Err(error) => assert!(!error.to_string().is_empty()),
        }
    };
    Target {
        name: "arguments",
        seeds: SEEDS.iter().map(|seed| seed.as_bytes().to_vec()).collect(),
        words: WORDS,
        repair: |_| (),
        run: &run,
        peak_memory: &|| 0,
    }
    .fuzz();
}

#[cfg(unix)]
fn argument(bytes: &[u8]) -> OsString {
    use std::os::unix::ffi::OsStrExt;
    std::ffi::OsStr::from_bytes(bytes).to_owned()
}

#[cfg(not(unix))]
fn argument(bytes: &[u8]) -> OsString {
    String::from_utf8_lossy(bytes).into_owned().into()
}
