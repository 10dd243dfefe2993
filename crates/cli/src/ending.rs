//! How commands end.

/// How a command ended that did not fail.
pub enum Ending {
    Done,
    Interrupted,
}

/// Any error, as the user will see it.
pub type CliError = Box<dyn std::error::Error>;

/// Exit status of a run that Ctrl-C ended.
pub const INTERRUPTED: u8 = 130;
/// Exit status of a run that failed.
pub const FAILED: u8 = 2;
