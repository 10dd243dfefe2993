//! An executor that runs kernels on a GPU through the browser.

use raystream::clock::Instant;
use raystream::exec::{Access, ExecError, Executor, Kernel, Launch, Limits};
use serde::Serialize;
use std::time::Duration;

/// What the browser does for the executor. Calls that wait for the GPU return when it is done; what
/// goes wrong is [told](Self::failure) after them.
pub trait Driver: Clone + Send + Sync + 'static {
    /// A new buffer of zeros, by the number that it has from then on; None where there is no room.
    fn allocate(&self, bytes: u64) -> Option<u32>;

    /// Forgets a buffer.
    fn free(&self, buffer: u32);

    /// Copies `bytes` into a buffer.
    fn write(&self, buffer: u32, first_byte: u64, bytes: &[u8]);

    /// Copies a part of a buffer to `bytes`.
    fn read(&self, buffer: u32, first_byte: u64, bytes: &mut [u8]);

    /// Runs what `work` says, the JSON of a list of [`Work`], whose parameters are parts of
    /// `parameters`.
    fn run(&self, work: &str, parameters: &[u8]);

    /// What has gone wrong since this was last called.
    fn failure(&self) -> Option<String>;
}

/// What a GPU can do.
#[derive(Clone, Debug, PartialEq, serde::Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Facts {
    /// What the browser calls it.
    pub name: String,
    /// Bytes of a buffer at most.
    pub buffer_bytes: u64,
    /// What the first byte of a part of a buffer must be a multiple of.
    pub alignment: u64,
    /// Workgroups in a row of a launch at most.
    pub row: u32,
}

/// Runs kernels through a browser's WebGPU.
#[derive(Clone)]
pub struct WebGpu<D> {
    driver: D,
    facts: Facts,
}

/// Memory of the GPU.
pub struct WebGpuBuffer<D: Driver> {
    driver: D,
    number: u32,
}

impl<D: Driver> Drop for WebGpuBuffer<D> {
    fn drop(&mut self) {
        self.driver.free(self.number);
    }
}

/// A launch, as the page's JavaScript reads it.
#[derive(Debug, Serialize)]
pub struct Work {
    /// The kernel.
    pub kernel: &'static str,
    /// What it is compiled for; none where it works on no scene.
    pub abilities: Option<u32>,
    /// Of each binding, in their order: `u` for a uniform, `r` for a buffer that is read, `w` for
    /// one that is written.
    pub access: String,
    /// Workgroups in a row, and rows.
    pub grid: [u32; 2],
    /// The first byte of its parameters, and how many they are.
    pub parameters: [usize; 2],
    /// Buffer, first byte and bytes of each other binding.
    pub views: Vec<(u32, u64, u64)>,
}

/// What parameters of one launch begin at a multiple of, in one buffer with those of others.
const PARAMETER_ALIGNMENT: usize = 256;

impl<D: Driver> WebGpu<D> {
    /// The GPU that `driver` has opened.
    pub fn new(driver: D, facts: Facts) -> Self {
        Self { driver, facts }
    }

    fn check(&self) -> Result<(), ExecError> {
        let device = || self.facts.name.clone();
        let failed = |message| Err(ExecError::Device { device: device(), message });
        self.driver.failure().map_or(Ok(()), failed)
    }

    /// A launch whose parameters begin at a byte of all launches' parameters.
    fn work(&self, launch: &Launch<'_, WebGpuBuffer<D>>, first_byte: usize) -> Work {
        let kernel = launch.kernel();
        let views = launch.views().iter();
        Work {
            kernel: kernel.name,
            abilities: kernel.has_scene().then(|| launch.abilities()),
            access: access(kernel),
            grid: grid(launch.threads().div_ceil(kernel.workgroup_size), self.facts.row),
            parameters: [first_byte, launch.parameters().len()],
            views: views
                .map(|view| (view.buffer().number, view.first_byte(), view.bytes()))
                .collect(),
        }
    }
}

fn access(kernel: &Kernel) -> String {
    let letter = |access| match access {
        Access::Uniform => 'u',
        Access::Read => 'r',
        Access::Write | Access::Scatter | Access::Atomic => 'w',
    };
    kernel.bindings.iter().map(|binding| letter(binding.access)).collect()
}

/// So many workgroups in rows of at most `row`.
fn grid(groups: u32, row: u32) -> [u32; 2] {
    let rows = groups.div_ceil(row).max(1);
    [groups.div_ceil(rows), rows]
}

impl<D: Driver> Executor for WebGpu<D> {
    type Buffer = WebGpuBuffer<D>;

    fn limits(&self) -> Limits {
        let Facts { buffer_bytes, alignment, .. } = self.facts;
        // Bindings are whole multiples of 4 bytes.
        Limits { buffer_bytes: buffer_bytes / 256 * 256, alignment }
    }

    fn name(&self) -> &str {
        &self.facts.name
    }

    /// Pipelines are made when they are first used: a browser takes long for each.
    fn prepare(&self, _: u32) -> Result<(), ExecError> {
        Ok(())
    }

    fn allocate(&self, label: &'static str, bytes: u64) -> Result<Self::Buffer, ExecError> {
        self.check_size(label, bytes)?;
        let number = self.driver.allocate(bytes.next_multiple_of(4));
        self.check()?;
        let device = || self.facts.name.clone();
        let number =
            number.ok_or_else(|| ExecError::OutOfMemory { device: device(), label, bytes })?;
        Ok(WebGpuBuffer { driver: self.driver.clone(), number })
    }

    fn write(&self, buffer: &Self::Buffer, first_byte: u64, bytes: &[u8]) -> Result<(), ExecError> {
        self.driver.write(buffer.number, first_byte, bytes);
        self.check()
    }

    fn read(
        &self,
        buffer: &Self::Buffer,
        first_byte: u64,
        bytes: &mut [u8],
    ) -> Result<(), ExecError> {
        if !bytes.is_empty() {
            self.driver.read(buffer.number, first_byte, bytes);
        }
        self.check()
    }

    fn run_parts(&self, parts: &[&[Launch<'_, Self::Buffer>]]) -> Result<Vec<Duration>, ExecError> {
        let mut parameters: Vec<u8> = Vec::new();
        let mut work = Vec::new();
        for launch in parts.iter().copied().flatten() {
            parameters.resize(parameters.len().next_multiple_of(PARAMETER_ALIGNMENT), 0);
            work.push(self.work(launch, parameters.len()));
            parameters.extend(launch.parameters());
        }
        if work.is_empty() {
            return Ok(vec![Duration::ZERO; parts.len()]);
        }
        let failed = |error: serde_json::Error| ExecError::Device {
            device: self.facts.name.clone(),
            message: error.to_string(),
        };
        let text = serde_json::to_string(&work).map_err(failed)?;
        let start = Instant::now();
        self.driver.run(&text, &parameters);
        self.check()?;
        // Browsers round the GPU's clock: the best guess is an even share.
        Ok(vec![start.elapsed() / parts.len() as u32; parts.len()])
    }
}

/// A driver for where there is no browser.
#[derive(Clone, Copy, Debug)]
pub enum NoGpu {}

impl Driver for NoGpu {
    fn allocate(&self, _: u64) -> Option<u32> {
        match *self {}
    }

    fn free(&self, _: u32) {}

    fn write(&self, _: u32, _: u64, _: &[u8]) {}

    fn read(&self, _: u32, _: u64, _: &mut [u8]) {}

    fn run(&self, _: &str, _: &[u8]) {}

    fn failure(&self) -> Option<String> {
        match *self {}
    }
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;
    use raystream::exec::{Array, kernels};
    use raystream_shaders::film::stream::{RunWindow, Slot};
    use raystream_shaders::parallel::prefix::BlockParams;
    use serde_json::{Value, json};
    use std::sync::{Arc, Mutex};

    /// Keeps what it is told, and has buffers on the host.
    #[derive(Clone, Default)]
    pub struct Told(Arc<Mutex<Memory>>);

    #[derive(Default)]
    pub struct Memory {
        buffers: Vec<Option<Vec<u8>>>,
        work: Vec<(String, Vec<u8>)>,
        failure: Option<String>,
    }

    impl Driver for Told {
        fn allocate(&self, bytes: u64) -> Option<u32> {
            let mut memory = self.0.lock().unwrap();
            if bytes > 1 << 20 {
                return None;
            }
            memory.buffers.push(Some(vec![0; bytes as usize]));
            Some(memory.buffers.len() as u32 - 1)
        }

        fn free(&self, buffer: u32) {
            self.0.lock().unwrap().buffers[buffer as usize] = None;
        }

        fn write(&self, buffer: u32, first_byte: u64, bytes: &[u8]) {
            let mut memory = self.0.lock().unwrap();
            let buffer = memory.buffers[buffer as usize].as_mut().unwrap();
            buffer[first_byte as usize..][..bytes.len()].copy_from_slice(bytes);
        }

        fn read(&self, buffer: u32, first_byte: u64, bytes: &mut [u8]) {
            let memory = self.0.lock().unwrap();
            let buffer = memory.buffers[buffer as usize].as_ref().unwrap();
            bytes.copy_from_slice(&buffer[first_byte as usize..][..bytes.len()]);
        }

        fn run(&self, work: &str, parameters: &[u8]) {
            self.0.lock().unwrap().work.push((work.to_owned(), parameters.to_vec()));
        }

        fn failure(&self) -> Option<String> {
            self.0.lock().unwrap().failure.take()
        }
    }

    /// A GPU that runs nothing.
    pub fn gpu() -> WebGpu<Told> {
        let facts =
            Facts { name: "it".to_owned(), buffer_bytes: 1 << 24, alignment: 256, row: 100 };
        WebGpu::new(Told::default(), facts)
    }

    #[test]
    fn buffers_hold_what_is_written_and_are_freed() {
        let gpu = gpu();
        let array = Array::from_slice(&gpu, "a", &[1_u32, 2, 3]).unwrap();
        array.write_from(&gpu, 1, &[7]).unwrap();
        assert_eq!(array.read(&gpu).unwrap(), [1, 7, 3]);
        drop(array);
        assert_eq!(gpu.driver.0.lock().unwrap().buffers, [None]);
    }

    #[test]
    fn what_does_not_fit_and_what_fails_are_errors() {
        let gpu = gpu();
        assert!(matches!(gpu.allocate("b", 1 << 21), Err(ExecError::OutOfMemory { .. })));
        assert!(matches!(gpu.allocate("b", 1 << 25), Err(ExecError::TooLarge { .. })));
        gpu.driver.0.lock().unwrap().failure = Some("lost".to_owned());
        let message = gpu.allocate("b", 4).err().unwrap().to_string();
        assert!(message.contains("it failed: lost"), "{message}");
    }

    #[test]
    fn launches_say_what_they_bind_and_how_large_they_are() {
        let gpu = gpu();
        let slots: Array<_, Slot> = Array::zeroed(&gpu, "slots", 64).unwrap();
        let sums: Array<_, u32> = Array::zeroed(&gpu, "sums", 512).unwrap();
        let window = RunWindow { threads: 256 * 250, ..RunWindow::default() };
        let blocks = BlockParams { threads: 3, ..BlockParams::default() };
        let launches = [
            kernels::clear_slots(&window, slots.slice(32..64)),
            kernels::scan_blocks(&blocks, sums.view()),
        ];
        assert_eq!(gpu.run(&launches).unwrap().len(), 2);
        let memory = gpu.driver.0.lock().unwrap();
        let [(work, parameters)] = &memory.work[..] else { panic!("one call") };
        let work: Value = serde_json::from_str(work).unwrap();
        let window_bytes = size_of::<RunWindow>();
        let expected = json!([
            {
                "kernel": "clear_slots", "abilities": null, "access": "uw", "grid": [84, 3],
                "parameters": [0, window_bytes], "views": [[0, 256, 256]],
            },
            {
                "kernel": "scan_blocks", "abilities": null, "access": "uw", "grid": [1, 1],
                "parameters": [256, size_of::<BlockParams>()], "views": [[1, 0, 2048]],
            },
        ]);
        assert_eq!(work, expected);
        assert_eq!(parameters[..window_bytes], *bytemuck::bytes_of(&window));
        assert_eq!(parameters[256..], *bytemuck::bytes_of(&blocks));
    }

    #[test]
    fn a_launch_of_nothing_runs_nothing() {
        let gpu = gpu();
        assert_eq!(gpu.run_parts(&[&[], &[]]).unwrap(), [Duration::ZERO; 2]);
        assert!(gpu.driver.0.lock().unwrap().work.is_empty());
        assert_eq!([grid(0, 9), grid(9, 9), grid(10, 9)], [[0, 1], [9, 1], [5, 2]]);
    }
}
