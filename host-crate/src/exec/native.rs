//! What a kernel's native function is given, and how it shares its lanes out among threads.

use super::scene_buffers::SceneUses;
use bytemuck::{AnyBitPattern, Pod};
use rayon::prelude::*;
use std::sync::atomic::AtomicU32;

/// The bindings of one launch on the CPU.
pub struct NativeArguments<'a, F> {
    /// The parameter block.
    pub parameters: &'a [u8],
    /// The other bindings, in the order of the table.
    pub views: Vec<NativeBinding<'a>>,
    /// The scene, if it works on one.
    pub(super) scene: SceneUses<'a>,
    /// What the scene uses: the word, or what is compiled for it.
    pub abilities: F,
}

impl<'a, F> NativeArguments<'a, F> {
    /// These, for code that is compiled for `abilities`.
    pub fn with_abilities<G>(self, abilities: G) -> NativeArguments<'a, G> {
        let Self { parameters, views, scene, .. } = self;
        NativeArguments { parameters, views, scene, abilities }
    }

    /// The parameter block as the struct that it holds.
    pub fn parameters<T: AnyBitPattern>(&self) -> T {
        bytemuck::pod_read_unaligned(self.parameters)
    }
}

/// A part of a buffer, locked for the time of the launch.
pub enum NativeBinding<'a> {
    /// Shared with others.
    Read(&'a [u8]),
    /// This launch's own.
    Write(&'a mut [u8]),
}

impl<'a> NativeBinding<'a> {
    /// The elements of a binding of access [`Read`](super::Access::Read).
    pub fn into_slice<T: Pod>(self) -> &'a [T] {
        match self {
            Self::Read(bytes) => bytemuck::cast_slice(bytes),
            Self::Write(bytes) => bytemuck::cast_slice(bytes),
        }
    }

    /// The elements of a binding of access [`Write`](super::Access::Write).
    ///
    /// # Panics
    /// If the executor locked it for reading: a bug in the executor.
    pub fn into_slice_mut<T: Pod>(self) -> &'a mut [T] {
        match self {
            Self::Write(bytes) => bytemuck::cast_slice_mut(bytes),
            Self::Read(_) => unreachable!("written binding locked for reading"),
        }
    }

    /// The words of a binding of access [`Write`](super::Access::Write), for lanes that write at
    /// places of their choice.
    ///
    /// # Panics
    /// If the executor locked it for reading: a bug in the executor.
    pub fn into_atomics(self) -> &'a [AtomicU32] {
        let words: &'a mut [u32] = self.into_slice_mut();
        // SAFETY: an AtomicU32 has the size, alignment and bits of a u32, and for the lifetime of
        // the result nobody else has the words, which this exclusive borrow shows.
        unsafe { &*(std::ptr::from_mut(words) as *const [AtomicU32]) }
    }
}

/// Some of a kernel's lanes.
pub type Job<'a> = Box<dyn FnOnce() + Send + 'a>;

/// How many lanes (or workgroups) of `len` make a job: few enough that no thread waits long for the
/// last, at most [`LARGEST_PART`], at least 1.
pub fn part_of(len: u32) -> u32 {
    len.div_ceil(JOBS_PER_THREAD * rayon::current_num_threads() as u32).clamp(1, LARGEST_PART)
}

/// Jobs that each thread gets of a launch, on average.
const JOBS_PER_THREAD: u32 = 64;

/// Lanes of one job at most.
const LARGEST_PART: u32 = 4096;

/// Runs all jobs on rayon's threads. It is no generic function on purpose: rayon's machinery is
/// then compiled once and not for each kernel, which took a quarter of the library's compile time.
pub fn run_all(jobs: Vec<Job<'_>>) {
    jobs.into_par_iter().with_max_len(1).for_each(|job| job());
}
