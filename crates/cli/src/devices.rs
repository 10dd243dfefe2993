//! `raystream devices`

use super::ending::{CliError, Ending};
use super::options::OpenArguments;
use super::output::{self, print_line};
use clap::Args;
use raystream::exec::devices::Devices;

/// The options of `raystream devices`.
#[derive(Args)]
pub struct DevicesArguments {
    #[command(flatten)]
    open: OpenArguments,
}

/// Lists every device with its limits.
pub fn run(arguments: &DevicesArguments) -> Result<Ending, CliError> {
    for device in Devices::enumerate(arguments.open.options()).list() {
        print_line(&device.name)?;
        print_line(&format!("    {}, {}, kernels {}", device.kind, device.driver, device.kernels))?;
        match device.unsuitable {
            Some(reason) => print_line(&format!("    cannot be used: {reason}"))?,
            None => {
                print_line(&format!("    largest buffer {}", output::bytes(device.buffer_bytes)))?;
            }
        }
    }
    Ok(Ending::Done)
}
