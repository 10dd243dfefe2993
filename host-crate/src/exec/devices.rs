//! Which devices there are, and the choice of one.

use super::cpu::CpuExecutor;
use super::device::Device;
#[cfg(feature = "gpu")]
use super::gpu::Adapters;
use super::{ExecError, Executor, Table};
use raystream_shaders::scene::bvh::wide::lanes::Simd;
#[cfg(feature = "gpu")]
use std::sync::Arc;

/// The name of instructions that are none of [`Simd`]'s.
pub(super) const SCALAR: &str = "scalar";

impl Device {
    /// Opens the device that `selection` names, whatever the case: `cpu`; `cpu:` and instructions
    /// by which rays are traced (`scalar` for those of one number, or a [`Simd::name`]); `gpu`, the
    /// best GPU, a software one if there is no other; `auto`, the best real GPU, else the CPU; or a
    /// part of a device's name. Of several that fit, `gpu:2` or `NAME:2` is the second.
    ///
    /// # Errors
    /// If there is no such device, or it cannot run the kernels.
    pub fn open(selection: &str) -> Result<Self, ExecError> {
        Self::open_with(selection, OpenOptions::default())
    }

    /// [`Self::open`] with options.
    ///
    /// # Errors
    /// Likewise.
    pub fn open_with(selection: &str, options: OpenOptions) -> Result<Self, ExecError> {
        let selection = selection.to_lowercase();
        // Looking for GPUs takes time, and a broken driver may not survive it.
        if let Some(instructions) = of_cpu(&selection) {
            return Self::open_cpu(&selection, instructions);
        }
        Devices::enumerate(options).open(&selection)
    }

    /// Opens the devices that `selection` names, with commas between them: each as
    /// [`Self::open_with`] has it, the same one twice if it is named twice; or with `all` every GPU
    /// that is no software, or else the CPU. Returns the first one and the others.
    ///
    /// # Errors
    /// If one of them does not exist, or cannot run the kernels.
    pub fn open_all(selection: &str, options: OpenOptions) -> Result<(Self, Vec<Self>), ExecError> {
        let names: Vec<String> = if selection.eq_ignore_ascii_case("all") {
            let gpus = Devices::enumerate(options).list();
            let gpus = gpus.iter().filter(|device| device.is_gpu()).count();
            (1..=gpus).map(|number| format!("gpu:{number}")).collect()
        } else {
            selection.split(',').map(|one| one.trim().to_owned()).collect()
        };
        let open = |name: &String| Self::open_with(name, options);
        let Some((first, others)) = names.split_first() else {
            return Ok((Self::cpu(), Vec::new()));
        };
        Ok((open(first)?, others.iter().map(open).collect::<Result<_, _>>()?))
    }

    /// The CPU, with these instructions; the best ones if none are named.
    fn open_cpu(selection: &str, instructions: Option<&str>) -> Result<Self, ExecError> {
        let Some(name) = instructions else { return Ok(Self::cpu()) };
        let found = Simd::all().find(|simd| simd.name() == name);
        if found.is_none() && name != SCALAR {
            let known = Simd::all().map(Simd::name).chain([SCALAR]);
            let known: Vec<_> = known.map(|name| format!("cpu:{name}")).collect();
            let name = selection.to_owned();
            return Err(ExecError::NoSuchDevice { name, known: known.join(", ") });
        }
        Ok(Self::Cpu(CpuExecutor, found))
    }

    /// The CPU, with its best instructions.
    fn cpu() -> Self {
        Self::Cpu(CpuExecutor, CpuExecutor.simd())
    }
}

/// How devices are opened.
#[derive(Clone, Copy, Debug, Default)]
#[non_exhaustive]
pub struct OpenOptions {
    /// Have naga translate the kernels, also where the driver takes SPIR-V.
    pub naga: bool,
    /// Run under the driver's validation layers (Vulkan) or debug layer (DirectX); their messages
    /// are logged.
    pub validation: bool,
    /// Have GPUs compute what the CPU does, bit for bit, which takes them longer.
    pub exact: bool,
    /// The kernels of GPUs: this project's, or your own. Renderers need this project's.
    pub table: Table,
}

impl OpenOptions {
    /// These, with [`Self::naga`] as given.
    pub fn with_naga(self, naga: bool) -> Self {
        Self { naga, ..self }
    }

    /// These, with [`Self::exact`] as given.
    pub fn with_exact(self, exact: bool) -> Self {
        Self { exact, ..self }
    }

    /// These, with [`Self::table`] as given.
    pub fn with_table(self, table: Table) -> Self {
        Self { table, ..self }
    }

    /// These, with [`Self::validation`] as given.
    pub fn with_validation(self, validation: bool) -> Self {
        Self { validation, ..self }
    }
}

/// Looks for devices.
pub struct Devices {
    #[cfg(feature = "gpu")]
    gpus: Adapters,
}

/// What there is to know of a device before it is opened.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct DeviceInfo {
    /// The name by which [`Device::open`] finds it.
    pub name: String,
    /// What kind of device it is.
    pub kind: &'static str,
    /// Driver and its version; for the CPU, its threads.
    pub driver: String,
    /// How the kernels reach it.
    pub kernels: &'static str,
    /// Largest buffer that a kernel can be given, in bytes.
    pub buffer_bytes: u64,
    /// Why it cannot be used, if so.
    pub unsuitable: Option<String>,
}

impl DeviceInfo {
    /// Whether it is a GPU that works, and no software.
    fn is_gpu(&self) -> bool {
        self.kind.ends_with(" GPU") && self.kind != "software GPU" && self.unsuitable.is_none()
    }
}

impl Devices {
    /// The CPU and all GPUs that the system's drivers offer.
    #[cfg(feature = "gpu")]
    pub fn enumerate(options: OpenOptions) -> Self {
        Self { gpus: Adapters::enumerate(options) }
    }

    /// The CPU: this library was built without the feature `gpu`.
    #[cfg(not(feature = "gpu"))]
    pub fn enumerate(_: OpenOptions) -> Self {
        Self {}
    }

    /// Every device, real GPUs first, the CPU last.
    pub fn list(&self) -> Vec<DeviceInfo> {
        #[cfg(feature = "gpu")]
        let gpus = self.gpus.list();
        #[cfg(not(feature = "gpu"))]
        let gpus = [];
        let cpu = DeviceInfo {
            name: "cpu".into(),
            kind: "CPU",
            driver: format!("{}, {}", threads(), Simd::widest().name()),
            kernels: "native",
            buffer_bytes: isize::MAX as u64,
            unsuitable: None,
        };
        gpus.into_iter().chain([cpu]).collect()
    }

    /// [`Device::open`] of anything but the CPU; `selection` is in lower case.
    fn open(&self, selection: &str) -> Result<Device, ExecError> {
        let (name, number) = numbered(selection);
        if name == "auto" && number == 1 {
            return Ok(self.open_best());
        }
        // Every name has nothing in it.
        let found = if name.is_empty() { None } else { self.open_gpu(name, number)? };
        match found {
            Some(device) => Ok(device),
            None => {
                let known: Vec<_> = self.list().into_iter().map(|info| info.name).collect();
                Err(ExecError::NoSuchDevice { name: selection.into(), known: known.join(", ") })
            }
        }
    }

    #[cfg(feature = "gpu")]
    fn open_best(&self) -> Device {
        match self.gpus.open_best() {
            Some(gpu) => Device::Gpu(Arc::new(gpu)),
            None => Device::cpu(),
        }
    }

    #[cfg(not(feature = "gpu"))]
    fn open_best(&self) -> Device {
        Device::cpu()
    }

    #[cfg(feature = "gpu")]
    fn open_gpu(&self, name: &str, number: usize) -> Result<Option<Device>, ExecError> {
        Ok(self.gpus.open(name, number)?.map(|gpu| Device::Gpu(Arc::new(gpu))))
    }

    #[cfg(not(feature = "gpu"))]
    fn open_gpu(&self, name: &str, _: usize) -> Result<Option<Device>, ExecError> {
        if name == "gpu" { Err(ExecError::NoGpu) } else { Ok(None) }
    }
}

/// A selection, and which of the devices that fit it: from 1 on, the number after a colon at its
/// end.
fn numbered(selection: &str) -> (&str, usize) {
    let numbered =
        selection.rsplit_once(':').and_then(|(name, number)| Some((name, number.parse().ok()?)));
    numbered.filter(|&(_, number)| number > 0).unwrap_or((selection, 1))
}

/// The instructions that a selection of the CPU names, if it is one.
fn of_cpu(selection: &str) -> Option<Option<&str>> {
    match selection.strip_prefix("cpu")? {
        "" => Some(None),
        rest => rest.strip_prefix(':').map(Some),
    }
}

/// How many threads the CPU has for kernels.
pub(super) fn threads() -> String {
    format!("{} threads", rayon::current_num_threads())
}

#[cfg(test)]
mod tests {
    use super::numbered;

    #[test]
    fn a_number_after_a_colon_chooses_among_devices() {
        assert_eq!(numbered("gpu"), ("gpu", 1));
        assert_eq!(numbered("gpu:3"), ("gpu", 3));
        assert_eq!(numbered("radeon:0"), ("radeon:0", 1));
        assert_eq!(numbered("some: thing"), ("some: thing", 1));
    }
}
