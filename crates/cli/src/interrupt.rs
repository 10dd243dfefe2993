//! Ctrl-C, SIGTERM and SIGHUP.
//!
//! Before there is a picture nothing would be lost: the program ends at once, wherever it is. What
//! waits for a slow disk or builds a hierarchy need not ask whether it should stop.

use super::ending::{CliError, INTERRUPTED};
use super::output::say;
use raystream::image;
use std::sync::atomic::{AtomicU8, Ordering};

/// What a signal does now: one of the values below.
static STATE: AtomicU8 = AtomicU8::new(NOT_RENDERING);

/// It ends the program.
const NOT_RENDERING: u8 = 0;
/// It ends the program: there is no picture yet.
const WITHOUT_PICTURE: u8 = 1;
/// It has the picture finished and written.
const WITH_PICTURE: u8 = 2;
/// It is the second, and ends the program.
const INTERRUPTED_ONCE: u8 = 3;

/// From now on signals do nothing: another process says when this one ends.
///
/// # Errors
/// If the system does not allow it.
pub fn ignore() -> Result<(), CliError> {
    ctrlc::set_handler(|| ())?;
    Ok(())
}

/// From now on the first signal has a render finish and write what it has, if it has anything, and
/// the second one ends the program at once.
///
/// # Errors
/// If the system does not allow it.
pub fn catch() -> Result<(), CliError> {
    ctrlc::set_handler(|| {
        let order = Ordering::SeqCst;
        let (was, now) = (STATE.load(order), INTERRUPTED_ONCE);
        if was == WITH_PICTURE && STATE.compare_exchange(was, now, order, order).is_ok() {
            say("interrupted: finishing what is under way and writing the picture; again to stop \
                 at once");
            return;
        }
        image::discard_unfinished();
        say(match was {
            WITHOUT_PICTURE => "interrupted before there was a picture: none is written",
            _ => "interrupted",
        });
        end();
    })?;
    Ok(())
}

/// Ends the process at once. A GPU's driver may take seconds to tidy up what it has just begun to
/// compile, and nobody needs that.
#[cfg(unix)]
fn end() -> ! {
    // SAFETY: it takes any number, never returns, and asks nothing of the other threads.
    unsafe { libc::_exit(i32::from(INTERRUPTED)) }
}

/// Ends the process.
#[cfg(not(unix))]
fn end() -> ! {
    std::process::exit(i32::from(INTERRUPTED))
}

/// A render begins: it has no picture yet.
pub fn begin_render() {
    STATE.store(WITHOUT_PICTURE, Ordering::SeqCst);
}

/// The render has a picture.
pub fn has_picture() {
    let order = Ordering::SeqCst;
    // Later calls change nothing.
    let _ = STATE.compare_exchange(WITHOUT_PICTURE, WITH_PICTURE, order, order);
}

/// Whether the render should end.
pub fn is_interrupted() -> bool {
    STATE.load(Ordering::SeqCst) == INTERRUPTED_ONCE
}
