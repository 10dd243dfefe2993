//! What every command begins with.

use super::ending::{CliError, FAILED};
use super::output;
use clap::Args;

/// The options of every command.
#[derive(Args)]
pub struct ProgramArguments {
    /// Say more: -v what happens, -vv what the libraries say.
    #[arg(short, long, global = true, action = clap::ArgAction::Count)]
    verbose: u8,
    /// Threads of the CPU to use [default: one for each core].
    #[arg(
        long,
        global = true,
        value_name = "N",
        value_parser = clap::value_parser!(u32).range(1..=4096)
    )]
    threads: Option<u32>,
}

impl ProgramArguments {
    /// Sends the program's and the libraries' messages to stderr; warnings and errors always, more
    /// by `-v`. The variable `RUST_LOG` overrides. Panics are said in one line.
    pub fn start_logging(&self) {
        use tracing_subscriber::filter::EnvFilter;
        let default = match self.verbose {
            0 => "warn",
            1 => "raystream=debug,warn",
            _ => "debug",
        };
        let filter = EnvFilter::try_from_default_env().unwrap_or_else(|_| EnvFilter::new(default));
        // Fails only where a test harness has set a subscriber of its own, which then stays.
        let _ = tracing_subscriber::fmt()
            .with_env_filter(filter)
            .with_writer(std::io::stderr)
            .with_ansi(std::io::IsTerminal::is_terminal(&std::io::stderr()))
            .without_time()
            .with_target(false)
            // By default it reports a closed stderr on stderr, and panics.
            .log_internal_errors(false)
            .try_init();
        report_panics();
    }

    /// Starts the threads that `--threads` asks for.
    ///
    /// # Errors
    /// If the system has no room for so many.
    pub fn start_threads(&self) -> Result<(), CliError> {
        let Some(threads) = self.threads else { return Ok(()) };
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads as usize);
        pool.build_global().map_err(|error| {
            format!("--threads {threads}: cannot be started: {error}; give a smaller number").into()
        })
    }
}

/// Without a desktop, the layer of Mesa that picks the desktop's GPU complains on stderr at every
/// start of Vulkan: leaves it out.
///
/// # Safety
/// No other thread of the process may read the environment meanwhile.
pub unsafe fn quiet_drivers() {
    let has_desktop = ["DISPLAY", "WAYLAND_DISPLAY", "XDG_RUNTIME_DIR"]
        .iter()
        .any(|name| std::env::var_os(name).is_some());
    if !has_desktop {
        // SAFETY: the caller says so.
        unsafe { std::env::set_var("NODEVICE_SELECT", "1") };
    }
}

/// A panic is a bug: say so in one line, and where, and end with the status of an error.
fn report_panics() {
    std::panic::set_hook(Box::new(|panic| {
        let message = panic.payload_as_str().unwrap_or("unknown");
        let place = panic.location().map_or_else(String::new, |location| format!(" at {location}"));
        output::complain(&format!(
            "error: a bug in raystream: {message}{place}; please report it with the command that \
             you ran"
        ));
        std::process::exit(i32::from(FAILED));
    }));
}
