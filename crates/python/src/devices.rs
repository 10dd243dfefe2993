//! Devices, each opened once: what they compile, they keep.

use pyo3::prelude::*;
use pyo3::types::PyDict;
use raystream::exec::Device;
use raystream::exec::devices::{Devices, OpenOptions};
use raystream_cli::{Call, CliError};
use std::collections::HashMap;
use std::sync::{LazyLock, Mutex, PoisonError};

/// The device that has the film, and the others.
type Opened = (Device, Vec<Device>);

/// What has been opened, by what asked for it.
static OPENED: LazyLock<Mutex<HashMap<String, Opened>>> = LazyLock::new(Mutex::default);

/// Opens what a call asks for, unless it is open.
pub fn open(call: &Call) -> Result<Opened, CliError> {
    let key = call.devices();
    let mut opened = OPENED.lock().unwrap_or_else(PoisonError::into_inner);
    if let Some(devices) = opened.get(&key) {
        return Ok(devices.clone());
    }
    let devices = call.open()?;
    opened.insert(key, devices.clone());
    Ok(devices)
}

/// Has devices opened anew next time: one may be lost.
pub fn forget() {
    OPENED.lock().unwrap_or_else(PoisonError::into_inner).clear();
}

/// The devices that can render, and why others cannot.
///
/// Returns a list of dictionaries: `name`, by which the option `device` finds it; `kind`; `driver`;
/// `bytes`, its largest buffer; and `unsuitable`, why it cannot be used, or None.
#[pyfunction]
pub fn devices(py: Python<'_>) -> PyResult<Vec<Bound<'_, PyDict>>> {
    let found = py.detach(|| Devices::enumerate(OpenOptions::default()).list());
    let described = found.into_iter().map(|device| {
        let described = PyDict::new(py);
        described.set_item("name", device.name)?;
        described.set_item("kind", device.kind)?;
        described.set_item("driver", device.driver)?;
        described.set_item("bytes", device.buffer_bytes)?;
        described.set_item("unsuitable", device.unsuitable)?;
        Ok(described)
    });
    described.collect()
}
