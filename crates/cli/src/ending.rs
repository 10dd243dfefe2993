//! How commands end.

use super::hints::with_hint;
use super::output::say;

/// How a command ended that did not fail.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Ending {
    /// It has done what it was asked for.
    Done,
    /// What it was to compare is not the same.
    Different,
    /// A signal ended it, with what there was written.
    Interrupted,
}

/// Any error, as the user will see it.
pub type CliError = Box<dyn std::error::Error>;

/// Exit status of a comparison that found a difference.
pub const DIFFERENT: u8 = 1;
/// Exit status of a run that Ctrl-C ended.
pub const INTERRUPTED: u8 = 130;
/// Exit status of a run that failed.
pub const FAILED: u8 = 2;

/// The exit status of a command; says what went wrong, if anything did.
pub fn exit_status(ended: Result<Ending, CliError>) -> u8 {
    match ended {
        Ok(Ending::Done) => 0,
        Ok(Ending::Different) => DIFFERENT,
        Ok(Ending::Interrupted) => INTERRUPTED,
        Err(error) => {
            say(&format!("error: {}", with_hint(error.as_ref())));
            FAILED
        }
    }
}
