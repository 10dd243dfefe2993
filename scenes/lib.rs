//! The scenes that ship with Raystream, as data: README.md beside this file says what they show.
//!
//! They are a crate, so that a published `raystream` finds them: a package holds no file from
//! outside its folder.

#![no_std]

macro_rules! files {
    ($($file:literal),* $(,)?) => {
        /// Path and bytes of each file; paths are relative to this folder, with `/` between parts.
        pub const FILES: &[(&str, &[u8])] = &[$(($file, include_bytes!($file))),*];
    };
}
files![
    "cornell_ball/cornell_ball.json",
    "cornell_ball/cornell_ball.obj",
    "cornell_ball/cornell_ball.mtl",
    "cornell_glass/cornell_glass.json",
    "opening/opening.json",
    "opening/opening.obj",
    "opening/opening.mtl",
    "caustics/caustics.json",
    "tea/tea.json",
    "metals/metals.json",
    "daylight/daylight.json",
    "shapes/ball.obj",
    "shapes/cloth.obj",
    "shapes/cube.obj",
    "shapes/drink.obj",
    "shapes/ring.obj",
    "shapes/tumbler.obj",
    "sibenik/sibenik.json",
    "conference/conference.json",
];
