//! The executor that runs kernels on a GPU, through wgpu.

mod adapters;
mod clock;
mod exact;
mod float_controls;
mod pipelines;
mod spirv;

pub(super) use adapters::Adapters;
pub use pipelines::ShaderPath;

use super::arithmetic::Arithmetic;
use super::devices::OpenOptions;
use super::{ExecError, Executor, Kernel, Launch, Limits, Table};
use crate::clock::Instant;
use clock::Clock;
use exact::Exact;
use float_controls::keeps_subnormals;
use pipelines::{Pipeline, Pipelines};
use rayon::prelude::*;
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Duration;

/// Bytes that are copied between host and device at once.
const TRANSFER_BYTES: u64 = 64 << 20;
/// Bytes that a thread copies at once.
const COPIED_BYTES: usize = 1 << 20;

/// Why there are no exact kernels where naga translates them.
const NOT_EXACT: &str = "exact kernels must reach the driver as SPIR-V: naga knows no way to say \
    that a product and a sum must not be fused";

/// Runs kernels on one GPU.
pub struct GpuExecutor {
    name: String,
    device: wgpu::Device,
    queue: wgpu::Queue,
    pipelines: Pipelines,
    table: Table,
    limits: wgpu::Limits,
    /// What times parts of runs, where the device has a clock, and is kept from run to run.
    clock: Option<Mutex<Clock>>,
    /// What reads go through, kept from read to read.
    staging: Mutex<Option<wgpu::Buffer>>,
    /// What the driver reported outside of any call that could return it.
    failure: Arc<Mutex<Option<String>>>,
}

impl GpuExecutor {
    /// Opens `adapter` and compiles for it the kernels of the `options`' table that need no scene:
    /// those that compute what the CPU does, bit for bit, if they are to be exact.
    ///
    /// # Errors
    /// If it cannot be opened, or cannot run the kernels; if they are to be exact, also if it
    /// rounds otherwise than the CPU.
    pub fn new(
        adapter: &wgpu::Adapter,
        path: ShaderPath,
        options: OpenOptions,
    ) -> Result<Self, ExecError> {
        let OpenOptions { exact, table, .. } = options;
        let name = adapter.get_info().name;
        if exact && path == ShaderPath::Naga {
            return Err(ExecError::Unsuitable { device: name, reason: NOT_EXACT.to_owned() });
        }
        let limits = adapter.limits();
        let wanted = wgpu::Features::TIMESTAMP_QUERY
            | match path {
                ShaderPath::Passthrough => wgpu::Features::PASSTHROUGH_SHADERS,
                ShaderPath::Naga => wgpu::Features::empty(),
            };
        let features = adapter.features() & wanted;
        let (device, queue) = pollster::block_on(adapter.request_device(&wgpu::DeviceDescriptor {
            label: Some("raystream"),
            required_features: features,
            required_limits: limits.clone(),
            memory_hints: wgpu::MemoryHints::Performance,
            ..Default::default()
        }))
        .map_err(|error| ExecError::Unsuitable {
            device: name.clone(),
            reason: error.to_string(),
        })?;

        let failure = failure_of(&device);
        let unsuitable = |reason| ExecError::Unsuitable { device: name.clone(), reason };
        let exact =
            exact.then(|| Exact { by_fma: true, keeps_subnormals: keeps_subnormals(adapter) });
        // What is exact is found by this project's own kernels.
        let first = if exact.is_some() { Table::default() } else { table };
        let pipelines = Pipelines::new(device.clone(), path, &first, exact).map_err(unsuitable)?;
        let mut executor = Self {
            name,
            pipelines,
            table,
            limits,
            clock: features
                .contains(wgpu::Features::TIMESTAMP_QUERY)
                .then(|| Mutex::new(Clock::new(&device, 32))),
            staging: Mutex::default(),
            failure,
            device,
            queue,
        };
        if let Some(exact) = exact {
            let exact = executor.find_exact(path, exact)?;
            if !table.is_own() {
                let pipelines = Pipelines::new(executor.device.clone(), path, &table, Some(exact));
                executor.pipelines = pipelines.map_err(|reason| executor.unsuitable(reason))?;
            }
        }
        executor.compile(0, |kernel| !kernel.has_scene())?;
        Ok(executor)
    }

    /// Keeps this project's kernels by `fma` if they compute what the CPU does, or else takes those
    /// by integers; returns which.
    fn find_exact(&mut self, path: ShaderPath, mut exact: Exact) -> Result<Exact, ExecError> {
        let fast = self.name.clone();
        let unsuitable = |reason| ExecError::Unsuitable { device: fast.clone(), reason };
        self.name = format!("{fast}, exact");
        let (mut found, mut way) = (Arithmetic::of(self)?, "fma");
        if found.check().is_err() {
            exact.by_fma = false;
            let table = Table::default();
            let pipelines = Pipelines::new(self.device.clone(), path, &table, Some(exact));
            self.pipelines = pipelines.map_err(unsuitable)?;
            (found, way) = (Arithmetic::of(self)?, "integers");
        }
        tracing::info!("{} divides by {way}; {}", self.name, found.subnormals);
        found.check().map_err(unsuitable)?;
        Ok(exact)
    }

    /// Compiles those of the kernels that are `wanted`, for scenes that use `abilities`.
    fn compile(&self, abilities: u32, wanted: impl Fn(&Kernel) -> bool) -> Result<(), ExecError> {
        for &kernel in self.table.kernels.iter().filter(|kernel| wanted(kernel)) {
            self.pipeline(kernel, abilities)?;
        }
        self.check()
    }

    fn pipeline(
        &self,
        kernel: &'static Kernel,
        abilities: u32,
    ) -> Result<Arc<Pipeline>, ExecError> {
        self.pipelines.get(kernel, abilities).map_err(|reason| self.unsuitable(reason))
    }

    fn unsuitable(&self, reason: String) -> ExecError {
        ExecError::Unsuitable { device: self.name.clone(), reason }
    }

    /// The pipeline of each launch.
    fn pipelines_of(
        &self,
        parts: &[&[Launch<'_, wgpu::Buffer>]],
    ) -> Result<Vec<Arc<Pipeline>>, ExecError> {
        let launches = parts.iter().copied().flatten();
        launches.map(|launch| self.pipeline(launch.kernel, launch.scene.abilities)).collect()
    }

    /// The size of the launch's grid in workgroups: rows of at most as many as the device allows.
    fn grid(&self, kernel: &Kernel, threads: u32) -> (u32, u32) {
        let groups = threads.div_ceil(kernel.workgroup_size);
        let rows = groups.div_ceil(self.limits.max_compute_workgroups_per_dimension).max(1);
        (groups.div_ceil(rows), rows)
    }

    fn bind_group(
        &self,
        launch: &Launch<'_, wgpu::Buffer>,
        layout: &wgpu::BindGroupLayout,
        parameters: &wgpu::Buffer,
        first_byte: u64,
    ) -> wgpu::BindGroup {
        let part = |buffer, offset, bytes| {
            wgpu::BindingResource::Buffer(wgpu::BufferBinding {
                buffer,
                offset,
                size: std::num::NonZero::new(bytes),
            })
        };
        let uniform = part(parameters, first_byte, launch.parameters.len() as u64);
        let storage =
            launch.views.iter().map(|view| part(view.buffer, view.first_byte, view.bytes));
        let entries: Vec<_> = std::iter::once(uniform)
            .chain(storage)
            .zip(0..)
            .map(|(resource, binding)| wgpu::BindGroupEntry { binding, resource })
            .collect();
        self.device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some(launch.kernel.name),
            layout,
            entries: &entries,
        })
    }

    /// All launches' parameter blocks in one buffer, and where each starts.
    fn parameter_buffer<'a, 'b: 'a>(
        &self,
        launches: impl Iterator<Item = &'a Launch<'b, wgpu::Buffer>>,
    ) -> (wgpu::Buffer, Vec<u64>) {
        let alignment = self.limits.min_uniform_buffer_offset_alignment as usize;
        let mut bytes = Vec::new();
        let mut starts = Vec::new();
        for launch in launches {
            bytes.resize(bytes.len().next_multiple_of(alignment), 0);
            starts.push(bytes.len() as u64);
            bytes.extend(&launch.parameters);
        }
        let buffer = self.device.create_buffer(&wgpu::BufferDescriptor {
            label: Some("parameters"),
            size: bytes.len() as u64,
            usage: wgpu::BufferUsages::UNIFORM | wgpu::BufferUsages::COPY_DST,
            mapped_at_creation: false,
        });
        self.queue.write_buffer(&buffer, 0, &bytes);
        (buffer, starts)
    }

    /// Waits for all submitted work.
    fn wait(&self) -> Result<(), ExecError> {
        self.device
            .poll(wgpu::PollType::wait_indefinitely())
            .map_err(|error| self.failed(error.to_string()))?;
        self.check()
    }

    /// What the driver reported since the last check.
    fn check(&self) -> Result<(), ExecError> {
        match self.failure.lock().unwrap_or_else(PoisonError::into_inner).take() {
            Some(message) => Err(self.failed(message)),
            None => Ok(()),
        }
    }

    fn failed(&self, message: String) -> ExecError {
        ExecError::Device { device: self.name.clone(), message }
    }

    /// Copies at most [`TRANSFER_BYTES`] to the host, through `staging`.
    fn read_part(
        &self,
        buffer: &wgpu::Buffer,
        first_byte: u64,
        staging: &wgpu::Buffer,
        into: &mut [u8],
    ) -> Result<(), ExecError> {
        let bytes = into.len() as u64;
        let mut encoder = self.device.create_command_encoder(&Default::default());
        encoder.copy_buffer_to_buffer(buffer, first_byte, staging, 0, bytes);
        self.queue.submit([encoder.finish()]);
        self.map(staging, into)
    }

    /// Waits for all submitted work, and copies the first bytes of a staging buffer.
    fn map(&self, staging: &wgpu::Buffer, into: &mut [u8]) -> Result<(), ExecError> {
        let bytes = into.len() as u64;
        staging.map_async(wgpu::MapMode::Read, ..bytes, |_| {});
        self.wait()?;
        let mapped =
            staging.get_mapped_range(..bytes).map_err(|error| self.failed(error.to_string()))?;
        // Most of this is the host's own work, to give memory to `into`: threads share it.
        let (parts, of_mapped) =
            (into.par_chunks_mut(COPIED_BYTES), mapped.par_chunks(COPIED_BYTES));
        parts.zip(of_mapped).for_each(|(into, from)| into.copy_from_slice(from));
        drop(mapped);
        staging.unmap();
        Ok(())
    }

    /// A buffer of at least `bytes` that the host can read.
    fn staging(&self, bytes: u64) -> wgpu::Buffer {
        self.device.create_buffer(&wgpu::BufferDescriptor {
            label: Some("staging"),
            size: bytes,
            usage: wgpu::BufferUsages::MAP_READ | wgpu::BufferUsages::COPY_DST,
            mapped_at_creation: false,
        })
    }
}

/// Bytes of the largest buffer that can be bound whole.
pub(super) fn largest_buffer(limits: &wgpu::Limits) -> u64 {
    // Bindings are whole multiples of 4 bytes, which 2 GiB - 1, a common limit, is not.
    limits.max_storage_buffer_binding_size.min(limits.max_buffer_size) / 256 * 256
}

/// What the driver reports outside of any call that could return it, from now on.
fn failure_of(device: &wgpu::Device) -> Arc<Mutex<Option<String>>> {
    let failure = Arc::new(Mutex::new(None));
    let on_error = Arc::clone(&failure);
    device.on_uncaptured_error(Arc::new(move |error| record(&on_error, error.to_string())));
    let on_loss = Arc::clone(&failure);
    device.set_device_lost_callback(move |reason, message| {
        if reason != wgpu::DeviceLostReason::Destroyed {
            record(&on_loss, format!("the device was lost: {message}"));
        }
    });
    failure
}

fn record(failure: &Mutex<Option<String>>, message: String) {
    // The first report is the cause; what follows are its consequences.
    failure.lock().unwrap_or_else(PoisonError::into_inner).get_or_insert(message);
}

impl Executor for GpuExecutor {
    type Buffer = wgpu::Buffer;

    fn name(&self) -> &str {
        &self.name
    }

    fn limits(&self) -> Limits {
        Limits {
            buffer_bytes: largest_buffer(&self.limits),
            alignment: u64::from(self.limits.min_storage_buffer_offset_alignment),
        }
    }

    fn prepare(&self, abilities: u32) -> Result<(), ExecError> {
        self.compile(abilities, Kernel::has_scene)
    }

    fn allocate(&self, label: &'static str, bytes: u64) -> Result<wgpu::Buffer, ExecError> {
        self.check_size(label, bytes)?;
        let scope = self.device.push_error_scope(wgpu::ErrorFilter::OutOfMemory);
        let buffer = self.device.create_buffer(&wgpu::BufferDescriptor {
            label: Some(label),
            size: bytes.next_multiple_of(4),
            usage: wgpu::BufferUsages::STORAGE
                | wgpu::BufferUsages::COPY_DST
                | wgpu::BufferUsages::COPY_SRC,
            mapped_at_creation: false,
        });
        if pollster::block_on(scope.pop()).is_some() {
            return Err(ExecError::OutOfMemory { device: self.name.clone(), label, bytes });
        }
        self.check()?;
        Ok(buffer)
    }

    fn write(&self, buffer: &wgpu::Buffer, first_byte: u64, bytes: &[u8]) -> Result<(), ExecError> {
        let mut at = first_byte;
        for part in bytes.chunks(TRANSFER_BYTES as usize) {
            self.queue.write_buffer(buffer, at, part);
            self.queue.submit([]);
            self.wait()?;
            at += part.len() as u64;
        }
        Ok(())
    }

    fn read(
        &self,
        buffer: &wgpu::Buffer,
        first_byte: u64,
        bytes: &mut [u8],
    ) -> Result<(), ExecError> {
        if bytes.is_empty() {
            return Ok(());
        }
        let most = TRANSFER_BYTES.min(bytes.len() as u64);
        let mut kept = self.staging.lock().unwrap_or_else(PoisonError::into_inner);
        // Memory that the host can read takes long to get.
        let staging = match kept.take().filter(|staging| staging.size() >= most) {
            Some(staging) => staging,
            None => self.staging(most),
        };
        let mut at = first_byte;
        for part in bytes.chunks_mut(TRANSFER_BYTES as usize) {
            self.read_part(buffer, at, &staging, part)?;
            at += part.len() as u64;
        }
        *kept = Some(staging);
        Ok(())
    }

    fn run_parts(&self, parts: &[&[Launch<'_, wgpu::Buffer>]]) -> Result<Vec<Duration>, ExecError> {
        if parts.is_empty() {
            return Ok(Vec::new());
        }
        // Before time is taken: some may have to be compiled.
        let pipelines = self.pipelines_of(parts)?;
        let start = Instant::now();
        let count = parts.len() as u32;
        let mut clock =
            self.clock.as_ref().map(|clock| clock.lock().unwrap_or_else(PoisonError::into_inner));
        let clock = clock.as_mut().and_then(|clock| clock.with_room_for(&self.device, count));
        let (parameters, starts) = self.parameter_buffer(parts.iter().copied().flatten());
        let mut launched = pipelines.iter().zip(starts);
        let mut encoder = self.device.create_command_encoder(&Default::default());
        for (part, number) in parts.iter().zip(0..) {
            let mut pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor {
                label: part.first().map(|launch| launch.kernel.name),
                timestamp_writes: clock.map(|clock| clock.stamps(number)),
            });
            for (launch, (pipeline, first_byte)) in part.iter().zip(&mut launched) {
                let Pipeline { pipeline, layout } = pipeline.as_ref();
                let bind_group = self.bind_group(launch, layout, &parameters, first_byte);
                pass.set_pipeline(pipeline);
                pass.set_bind_group(0, &bind_group, &[]);
                let (columns, rows) = self.grid(launch.kernel, launch.threads());
                pass.dispatch_workgroups(columns, rows, 1);
            }
        }
        let Some(clock) = clock else {
            self.queue.submit([encoder.finish()]);
            self.wait()?;
            // Without a device clock the best guess is an even share.
            return Ok(vec![start.elapsed() / count; parts.len()]);
        };
        // Read back with the same submission: a second one would be a second round trip.
        let (stamps, bytes) = clock.resolve(&mut encoder, count);
        self.queue.submit([encoder.finish()]);
        let mut read = vec![0; bytes as usize];
        self.map(stamps, &mut read)?;
        Ok(clock::durations(&read, self.queue.get_timestamp_period()))
    }
}
