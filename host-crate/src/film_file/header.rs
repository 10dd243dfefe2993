//! What a film file says of itself.

use crate::render::{Checkpoint, RenderProgress};
use crate::scene::FilmSize;
use raystream_shaders::film::splats::{HEADER_WORDS, PIXEL_WORDS};
use raystream_shaders::scene::camera::Camera;
use serde::{Deserialize, Serialize};
use std::fmt;
use std::ops::Range;
use std::path::PathBuf;
use std::str::FromStr;

/// What a film is of.
#[derive(Clone, Debug, Deserialize, PartialEq, Serialize)]
#[serde(deny_unknown_fields)]
pub struct Header {
    /// Version of Raystream.
    pub version: String,
    /// See [`kernels_digest`](super::kernels_digest).
    pub kernels: String,
    /// Name of the scene.
    pub scene: String,
    /// See [`scene_digest`](super::scene_digest).
    pub scene_digest: String,
    /// All settings, in words: two films with the same ones were rendered alike.
    pub settings: String,
    /// The device.
    pub device: String,
    /// Which part of the samples it is to have.
    pub part: Option<Part>,
    /// The parts that it has, where films were merged.
    pub merged: Vec<Part>,
    /// How the render was called, to go on with it.
    pub command: Command,
    /// Seconds that it took so far.
    pub seconds: f64,
    /// The camera as the kernels know it.
    #[serde(with = "camera_words")]
    pub camera: Camera,
    /// Whether the samples that errors decided about are of the second half, and the first one is
    /// the control film.
    pub has_control: bool,
}

/// In what two films are not of one render.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub enum Difference {
    /// Their kernels.
    Kernels,
    /// Their scenes.
    Scene,
    /// Their settings.
    Settings,
    /// The number of parts that they are parts of.
    Parts,
}

impl Header {
    /// In what two films are not of one render, if they are not; the first that is found.
    pub fn difference(&self, other: &Self) -> Option<Difference> {
        let count = |header: &Self| header.own_parts().map(|part| part.count).max();
        [
            (self.kernels != other.kernels, Difference::Kernels),
            (self.scene_digest != other.scene_digest, Difference::Scene),
            (self.settings != other.settings, Difference::Settings),
            (count(self) != count(other), Difference::Parts),
        ]
        .into_iter()
        .find_map(|(differs, difference)| differs.then_some(difference))
    }

    /// The parts that it has; none where it is of a whole render.
    pub fn own_parts(&self) -> impl Iterator<Item = Part> {
        self.part.iter().chain(&self.merged).copied()
    }
}

/// How a render was called.
#[derive(Clone, Debug, Deserialize, PartialEq, Serialize)]
#[serde(deny_unknown_fields)]
pub struct Command {
    /// The folder that paths start from.
    pub folder: PathBuf,
    /// The arguments, without the program's name.
    pub arguments: Vec<String>,
}

/// One of several equal parts of a render's samples.
#[derive(Clone, Copy, Debug, Deserialize, Eq, Ord, PartialEq, PartialOrd, Serialize)]
#[serde(deny_unknown_fields)]
pub struct Part {
    /// Which one, from 0 on.
    pub index: u32,
    /// How many there are, at least 1.
    pub count: u32,
}

impl Part {
    /// Most parts that a render can have.
    pub const MAX: u32 = 1 << 16;

    /// The numbers of its samples, of `samples` of each pixel in all.
    pub fn of(self, samples: u32) -> Range<u32> {
        let bound = |index| (u64::from(samples) * index / u64::from(self.count)) as u32;
        bound(u64::from(self.index))..bound(u64::from(self.index) + 1)
    }
}

impl fmt::Display for Part {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}/{}", self.index, self.count)
    }
}

impl FromStr for Part {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let numbers = text.split_once('/');
        let numbers = numbers.and_then(|(i, n)| Some((i.parse().ok()?, n.parse().ok()?)));
        match numbers {
            Some((index, count)) if index < count && count <= Self::MAX => {
                Ok(Self { index, count })
            }
            _ => Err(format!(
                "'{text}' is not a part and the number of parts, such as 0/16 to 15/16"
            )),
        }
    }
}

/// The words of a camera.
mod camera_words {
    use raystream_shaders::scene::camera::Camera;
    use serde::{Deserialize, Deserializer, Serialize, Serializer};

    type Words = [u32; size_of::<Camera>() / size_of::<u32>()];

    pub fn serialize<S: Serializer>(camera: &Camera, to: S) -> Result<S::Ok, S::Error> {
        bytemuck::cast::<Camera, Words>(*camera).serialize(to)
    }

    pub fn deserialize<'de, D: Deserializer<'de>>(from: D) -> Result<Camera, D::Error> {
        Ok(bytemuck::cast(Words::deserialize(from)?))
    }
}

/// A header with what the file needs to be read.
#[derive(Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Whole {
    width: u32,
    height: u32,
    pub unit_exponent: i32,
    progress: RenderProgress,
    pub splats: Option<Splats>,
    header: Header,
}

/// How to read what light tracing has found.
#[derive(Clone, Copy, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Splats {
    pub words: usize,
    pub unit_exponent: i32,
    pub light_paths: u32,
}

impl Header {
    pub(super) fn with_progress(&self, checkpoint: &Checkpoint) -> Whole {
        Whole {
            width: checkpoint.size.width,
            height: checkpoint.size.height,
            unit_exponent: checkpoint.unit_exponent,
            progress: checkpoint.progress,
            splats: checkpoint.splats.as_ref().map(|sums| Splats {
                words: sums.words.len(),
                unit_exponent: sums.unit_exponent,
                light_paths: sums.light_paths,
            }),
            header: self.clone(),
        }
    }
}

impl Whole {
    /// Pixels of the film.
    ///
    /// # Errors
    /// If there is no such film.
    pub fn pixels(&self) -> Result<usize, String> {
        let size = FilmSize::new(self.width.into(), self.height.into())?;
        let pixels = size.width as usize * size.height as usize;
        let words = HEADER_WORDS as usize + pixels * PIXEL_WORDS as usize;
        if self.splats.is_some_and(|splats| splats.words != words) {
            return Err("what light tracing has found is of another size".to_owned());
        }
        Ok(pixels)
    }

    pub fn take_apart(self) -> (Header, FilmSize, RenderProgress) {
        let size = FilmSize { width: self.width, height: self.height };
        (self.header, size, self.progress)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parts_are_all_samples_once() {
        for (samples, count) in [(64, 16), (7, 3), (5, 9), (1 << 24, 65_536)] {
            let parts = (0..count).map(|index| Part { index, count }.of(samples));
            let mut next = 0;
            for part in parts {
                assert_eq!(part.start, next);
                assert!(part.len() as u32 >= samples / count);
                next = part.end;
            }
            assert_eq!(next, samples);
        }
    }

    #[test]
    fn parts_are_read() {
        assert_eq!("3/16".parse(), Ok(Part { index: 3, count: 16 }));
        for wrong in ["", "3", "16/16", "-1/4", "0/0", "1/65537", "1/2/3", "a/b"] {
            assert!(wrong.parse::<Part>().unwrap_err().contains("0/16 to 15/16"), "{wrong}");
        }
    }
}
