//! Two devices as one, for finding where they part.

use super::{Access, Binding, ExecError, Executor, Kernel, Launch, Limits};
use crate::clock::Instant;
use raystream_shaders::scene::bvh::wide::lanes::Simd;
use std::fmt;
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::Duration;

/// What depends on which lane comes first, by kernel and binding: it differs between two runs of
/// one device, and nothing but the kernel itself reads it. How many slots lanes have taken when all
/// were: some more than there were, each of which showed a lane that it is done.
pub const UNORDERED: [(&str, &str); 1] = [("regenerate_paths", "taken")];

/// Bytes that are compared at once.
const PIECE: u64 = 16 << 20;

/// Two devices as one: each launch runs on both, and what they wrote is compared, byte for byte.
/// Where that differs the second device goes on with what the first one wrote, so that every launch
/// is compared from the same start.
pub struct Paired<A, B> {
    first: A,
    second: B,
    launches: AtomicU64,
    partings: Mutex<Vec<Parting>>,
}

/// A buffer on each of two devices.
pub struct PairedBuffer<A, B> {
    first: A,
    second: B,
}

/// Where two devices part: the first launch of a kernel after which buffers are not the same on
/// both.
#[derive(Clone, Debug)]
pub struct Parting {
    /// What the devices are called.
    pub devices: [String; 2],
    /// The kernel.
    pub kernel: &'static str,
    /// Which of all launches it was, from 1 on.
    pub launch: u64,
    /// After how many of the kernel's launches buffers differ.
    pub launches: u64,
    /// Its lanes.
    pub threads: u32,
    /// Its parameters.
    pub parameters: String,
    /// What differs; the first is what [`Self::read`] is about.
    pub differences: Vec<Difference>,
    /// What the kernel reads: of each binding, by its name, the element of the number that differs.
    pub read: Vec<(&'static str, String)>,
}

/// A buffer that is not the same on two devices.
#[derive(Clone, Debug)]
pub struct Difference {
    /// The name of the binding.
    pub binding: &'static str,
    /// The first element that differs. Where lanes write the elements of their own numbers, it is
    /// the lane as well.
    pub element: u64,
    /// Whether that is so.
    pub is_lane: bool,
    /// How many elements differ.
    pub differing: u64,
    /// Of how many.
    pub of: u64,
    /// The element before the launch, on the first device.
    pub before: String,
    /// The element after it, on each.
    pub after: [String; 2],
}

impl fmt::Display for Parting {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { devices: [first, second], kernel, launch, threads, .. } = self;
        writeln!(f, "{first} and {second} part in kernel {kernel}, launch {launch}")?;
        if self.launches > 1 {
            writeln!(f, "  and in {} more of its launches", self.launches - 1)?;
        }
        for difference in &self.differences {
            let Difference { binding, element, differing, of, before, after, .. } = difference;
            write!(f, "  {binding}: {differing} of {of} elements differ, first ")?;
            if difference.is_lane {
                writeln!(f, "that of lane {element} of {threads}")?;
            } else {
                writeln!(f, "number {element}; {threads} lanes wrote them")?;
            }
            writeln!(f, "    before: {before}")?;
            for (device, after) in self.devices.iter().zip(after) {
                writeln!(f, "    {device}: {after}")?;
            }
        }
        writeln!(f, "  what the kernel reads, at the number of the first difference:")?;
        for (name, element) in &self.read {
            writeln!(f, "    {name}: {element}")?;
        }
        write!(f, "  parameters: {}", self.parameters)
    }
}

impl<A: Executor, B: Executor> Paired<A, B> {
    /// The two.
    pub fn new(first: A, second: B) -> Self {
        Self { first, second, launches: AtomicU64::new(0), partings: Mutex::default() }
    }

    /// How many launches were compared so far.
    pub fn launches(&self) -> u64 {
        self.launches.load(Ordering::Relaxed)
    }

    /// Where they part, of each kernel once, in the order in which that was found.
    pub fn partings(&self) -> Vec<Parting> {
        self.lock().clone()
    }

    fn lock(&self) -> MutexGuard<'_, Vec<Parting>> {
        self.partings.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Runs a launch on both, and compares what they wrote.
    fn run_one(
        &self,
        launch: &Launch<'_, PairedBuffer<A::Buffer, B::Buffer>>,
    ) -> Result<(), ExecError> {
        let number = self.launches.fetch_add(1, Ordering::Relaxed) + 1;
        let written = || {
            let bindings = launch.kernel.bindings[1..].iter().zip(0..);
            bindings.filter(|(binding, _)| {
                binding.access.writes() && !UNORDERED.contains(&(launch.kernel.name, binding.name))
            })
        };
        let before = written().map(|(_, place)| self.read_first(launch, place));
        let before = before.collect::<Result<Vec<_>, _>>()?;
        self.first.run(&[launch.with_buffers(|buffer| &buffer.first)])?;
        self.second.run(&[launch.with_buffers(|buffer| &buffer.second)])?;
        let mut differences = Vec::new();
        for ((binding, place), before) in written().zip(before) {
            let after = [self.read_first(launch, place)?, self.read_second(launch, place)?];
            let Some(difference) = difference(*binding, &before, &after) else { continue };
            differences.push(difference);
            let view = &launch.views[place];
            self.second.write(&view.buffer.second, view.first_byte, &after[0])?;
        }
        if differences.is_empty() {
            return Ok(());
        }
        let name = launch.kernel.name;
        if let Some(known) = self.lock().iter_mut().find(|known| known.kernel == name) {
            known.launches += 1;
            return Ok(());
        }
        let parting = self.parting(launch, number, differences)?;
        self.lock().push(parting);
        Ok(())
    }

    /// What the first device has in binding `place` after the parameters.
    fn read_first(
        &self,
        launch: &Launch<'_, PairedBuffer<A::Buffer, B::Buffer>>,
        place: usize,
    ) -> Result<Vec<u8>, ExecError> {
        let view = &launch.views[place];
        read(&self.first, &view.buffer.first, view.first_byte, view.bytes)
    }

    /// The same of the second device.
    fn read_second(
        &self,
        launch: &Launch<'_, PairedBuffer<A::Buffer, B::Buffer>>,
        place: usize,
    ) -> Result<Vec<u8>, ExecError> {
        let view = &launch.views[place];
        read(&self.second, &view.buffer.second, view.first_byte, view.bytes)
    }

    /// What there is to say of a launch after which there are `differences`.
    fn parting(
        &self,
        launch: &Launch<'_, PairedBuffer<A::Buffer, B::Buffer>>,
        number: u64,
        differences: Vec<Difference>,
    ) -> Result<Parting, ExecError> {
        let element = differences.first().map_or(0, |difference| difference.element);
        let Kernel { name, bindings, .. } = launch.kernel;
        let mut read = Vec::new();
        for (binding, place) in bindings[1..].iter().zip(0..) {
            if binding.access == Access::Read {
                let bytes = self.read_first(launch, place)?;
                let element = described(*binding, &bytes, element as usize);
                read.extend(element.map(|element| (binding.name, element)));
            }
        }
        Ok(Parting {
            devices: [self.first.name(), self.second.name()].map(str::to_owned),
            kernel: name,
            launch: number,
            launches: 1,
            threads: launch.threads(),
            parameters: (bindings[0].element.describe)(&launch.parameters),
            differences,
            read,
        })
    }
}

/// What differs in a binding between two devices, if anything does.
fn difference(binding: Binding, before: &[u8], after: &[Vec<u8>; 2]) -> Option<Difference> {
    if after[0] == after[1] {
        return None;
    }
    let size = binding.element.bytes;
    let pairs = || after[0].chunks(size).zip(after[1].chunks(size));
    let element = pairs().position(|(first, second)| first != second)?;
    let describe = |bytes: &[u8]| described(binding, bytes, element).unwrap_or_default();
    Some(Difference {
        binding: binding.name,
        element: element as u64,
        is_lane: binding.access == Access::Write,
        differing: pairs().filter(|(first, second)| first != second).count() as u64,
        of: pairs().count() as u64,
        before: describe(before),
        after: [describe(&after[0]), describe(&after[1])],
    })
}

/// Element `number` of a binding's `bytes`: its fields, and its words; nothing if there are not so
/// many.
fn described(binding: Binding, bytes: &[u8], number: usize) -> Option<String> {
    let size = binding.element.bytes;
    let bytes = bytes.get(number * size..(number + 1) * size)?;
    let words: Vec<String> = bytes
        .chunks(size_of::<u32>())
        .map(|word| format!("{:08x}", bytemuck::pod_read_unaligned::<u32>(word)))
        .collect();
    Some(format!("{} [{}]", (binding.element.describe)(bytes), words.join(" ")))
}

/// A part of a buffer.
fn read<E: Executor>(
    executor: &E,
    buffer: &E::Buffer,
    first_byte: u64,
    bytes: u64,
) -> Result<Vec<u8>, ExecError> {
    let mut read = vec![0; bytes as usize];
    let firsts = (first_byte..).step_by(PIECE as usize);
    for (piece, first_byte) in read.chunks_mut(PIECE as usize).zip(firsts) {
        executor.read(buffer, first_byte, piece)?;
    }
    Ok(read)
}

impl<A: Executor, B: Executor> Executor for Paired<A, B> {
    type Buffer = PairedBuffer<A::Buffer, B::Buffer>;

    fn limits(&self) -> Limits {
        let (first, second) = (self.first.limits(), self.second.limits());
        Limits {
            buffer_bytes: first.buffer_bytes.min(second.buffer_bytes),
            alignment: first.alignment.max(second.alignment),
        }
    }

    fn name(&self) -> &str {
        self.first.name()
    }

    fn prepare(&self, abilities: u32) -> Result<(), ExecError> {
        self.first.prepare(abilities)?;
        self.second.prepare(abilities)
    }

    fn runs_in_step(&self) -> bool {
        self.first.runs_in_step() || self.second.runs_in_step()
    }

    fn simd(&self) -> Option<Simd> {
        self.first.simd().or_else(|| self.second.simd())
    }

    fn allocate(&self, label: &'static str, bytes: u64) -> Result<Self::Buffer, ExecError> {
        Ok(PairedBuffer {
            first: self.first.allocate(label, bytes)?,
            second: self.second.allocate(label, bytes)?,
        })
    }

    fn write(&self, buffer: &Self::Buffer, first_byte: u64, bytes: &[u8]) -> Result<(), ExecError> {
        self.first.write(&buffer.first, first_byte, bytes)?;
        self.second.write(&buffer.second, first_byte, bytes)
    }

    fn read(
        &self,
        buffer: &Self::Buffer,
        first_byte: u64,
        bytes: &mut [u8],
    ) -> Result<(), ExecError> {
        self.first.read(&buffer.first, first_byte, bytes)
    }

    fn run_parts(&self, parts: &[&[Launch<'_, Self::Buffer>]]) -> Result<Vec<Duration>, ExecError> {
        let run_part = |part: &&[Launch<'_, Self::Buffer>]| {
            let start = Instant::now();
            part.iter().try_for_each(|launch| self.run_one(launch))?;
            Ok(start.elapsed())
        };
        parts.iter().map(run_part).collect()
    }
}
