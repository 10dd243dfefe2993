//! Integrators: the contribution of every slot is that of the megakernel, bit for bit on the CPU,
//! whatever the stream and the pool; on the GPU as far as its compiler treats two kernels alike.

mod common;

#[path = "integrators/devices.rs"]
mod devices;
#[path = "integrators/memory.rs"]
mod memory;
#[path = "integrators/renders.rs"]
mod renders;
#[path = "integrators/slots.rs"]
mod slots;
#[path = "adaptive/renders.rs"]
#[allow(dead_code)] // only its small device is wanted here
mod small;
#[path = "integrators/tracing.rs"]
mod tracing;
