//! kill -9 at any moment.
#![cfg(unix)]

use crate::program::{names, program};
use raystream::image::{read_color, read_layers};
use std::path::Path;
use std::process::Stdio;
use std::time::{Duration, Instant};

/// Half the time of such a render goes into writing.
const ARGUMENTS: &str = "render --device cpu --size 160x120 --spp 1 --max-depth 1 --bvh fast \
    --allocator uniform -q -o a.exr -o b.png -o c.exr -o d.exr -o e.png";
const PICTURES: [&str; 5] = ["a.exr", "b.png", "c.exr", "d.exr", "e.png"];
const KILLS: u32 = 100;

/// Every file is a whole picture: the one that was there or the new one.
fn check(folder: &Path) {
    for name in names(folder) {
        let path = folder.join(&name);
        if PICTURES.contains(&name.as_str()) {
            read_color(&path).unwrap_or_else(|error| panic!("{error}"));
            continue;
        }
        assert!(name.starts_with(".raystream-"), "{name}");
        // Between its name and that of its target a picture is whole, where the system can give
        // names that late.
        let copy = folder.join("copy.exr");
        std::fs::rename(&path, &copy).unwrap();
        let is_exr = read_layers(&copy).is_ok();
        std::fs::rename(&copy, folder.join("copy.png")).unwrap();
        let is_png = read_color(&folder.join("copy.png")).is_ok();
        assert!(!cfg!(target_os = "linux") || is_exr || is_png, "{name} is half-written");
        std::fs::remove_file(folder.join("copy.png")).unwrap();
    }
}

#[test]
fn no_kill_leaves_a_half_written_file() {
    let folder = tempfile::tempdir().unwrap();
    let start = || {
        let arguments: Vec<_> = ARGUMENTS.split_whitespace().collect();
        let command = &mut program(folder.path(), &arguments);
        command.stdout(Stdio::null()).stderr(Stdio::null()).spawn().unwrap()
    };
    let started = Instant::now();
    assert!(start().wait().unwrap().success());
    let whole = started.elapsed();
    let (mut killed, mut between) = (0, 0);
    for number in 0..KILLS {
        let is_new = number % 2 == 0;
        if is_new {
            for name in names(folder.path()) {
                std::fs::remove_file(folder.path().join(name)).unwrap();
            }
        }
        let mut child = start();
        // The golden ratio spreads the moments evenly, in an order that means nothing.
        let moment = (f64::from(number) * 0.618_033_988_75).fract();
        std::thread::sleep(whole.mul_f64(moment).min(Duration::from_secs(2)));
        let _ = child.kill();
        let ended_by_itself = child.wait().unwrap().success();
        killed += u32::from(!ended_by_itself);
        let there = names(folder.path()).len();
        between += u32::from(is_new && !ended_by_itself && (1..PICTURES.len()).contains(&there));
        check(folder.path());
    }
    println!("{killed} of {KILLS} were killed, {between} of them between two pictures");
    assert!(killed > KILLS / 2, "{killed} kills are too few to say anything");
}
