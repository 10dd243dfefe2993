//! The splat film in a device's memory; see [`raystream_shaders::film::splats`].

use crate::exec::{Array, ExecError, Executor, Launch, View, kernels};
use crate::scene::FilmSize;
use bytemuck::Zeroable;
use glam::{DVec3, UVec4, Vec3};
use raystream_shaders::film::splats::{CUT_OFF, HEADER_WORDS, PIXEL_WORDS, ROUNDS, SplatParams};
use raystream_shaders::math::fixed;

/// What the film is called in errors.
const LABEL: &str = "the film of light tracing";

/// Sums of splats for each pixel, in rows.
pub struct SplatFilm<B> {
    words: Array<B, u32>,
    unit_exponent: i32,
    /// Light paths of each round.
    light_paths: u32,
}

impl<B> SplatFilm<B> {
    /// A black film for a picture of `size`, to which each round adds the splats of `light_paths`,
    /// in units of 2 to the power of `unit_exponent`.
    pub fn new<E: Executor<Buffer = B>>(
        executor: &E,
        size: FilmSize,
        light_paths: u32,
        unit_exponent: i32,
    ) -> Result<Self, ExecError> {
        let words = u64::from(HEADER_WORDS)
            + u64::from(size.width) * u64::from(size.height) * u64::from(PIXEL_WORDS);
        let bytes = words * size_of::<u32>() as u64;
        executor.check_size(LABEL, bytes)?;
        // Kernels count words by 32 bits.
        let Ok(words) = u32::try_from(words) else {
            let (device, limit) = (executor.name().to_owned(), 4 * u64::from(u32::MAX));
            return Err(ExecError::TooLarge { device, label: LABEL, bytes, limit });
        };
        Ok(Self {
            words: Array::zeroed(executor, LABEL, words as usize)?,
            unit_exponent,
            light_paths,
        })
    }

    /// Adds a round's list of splats, by `threads` lanes.
    pub fn add<'a>(&'a self, threads: u32, splats: View<'a, B, UVec4>) -> Launch<'a, B> {
        let unit_exponent = self.unit_exponent;
        let parameters = SplatParams { threads, unit_exponent, ..SplatParams::zeroed() };
        kernels::add_splats(&parameters, splats, self.words.view())
    }

    /// Copies the sums to the host.
    pub fn read<E: Executor<Buffer = B>>(&self, executor: &E) -> Result<SplatSums, ExecError> {
        let (unit_exponent, light_paths) = (self.unit_exponent, self.light_paths);
        Ok(SplatSums { words: self.words.read(executor)?, unit_exponent, light_paths })
    }

    /// Makes it what it was when the host got these sums, which are of as many pixels.
    pub fn write<E: Executor<Buffer = B>>(
        &self,
        executor: &E,
        sums: &SplatSums,
    ) -> Result<(), ExecError> {
        self.words.write(executor, &sums.words)
    }
}

/// What light tracing has found: exact sums, whatever order they were added in.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct SplatSums {
    /// The words, see [`raystream_shaders::film::splats`].
    pub words: Vec<u32>,
    /// The unit is 2 to this power.
    pub unit_exponent: i32,
    /// Light paths of each round.
    pub light_paths: u32,
}

impl SplatSums {
    /// The mean over all light paths so far, in rows: linear Rec.709; black before the first round.
    pub fn mean(&self) -> Vec<Vec3> {
        let (header, pixels) = self.words.split_at(HEADER_WORDS as usize);
        if header[CUT_OFF as usize] > 0 {
            let count = header[CUT_OFF as usize];
            tracing::warn!("light tracing: {count} components were cut off at 2^43 of a lamp's");
        }
        let paths = f64::from(header[ROUNDS as usize].max(1)) * f64::from(self.light_paths);
        let scale = f64::from(self.unit_exponent).exp2() / paths;
        let component = |words: &[u32]| fixed::to_integer(UVec4::from_slice(words)) as f64 * scale;
        let pixel = |words: &[u32]| {
            let [red, green, blue] =
                [0, 1, 2].map(|c| component(&words[c * fixed::WORDS as usize..]));
            DVec3::new(red, green, blue).as_vec3()
        };
        pixels.chunks_exact(PIXEL_WORDS as usize).map(pixel).collect()
    }
}
