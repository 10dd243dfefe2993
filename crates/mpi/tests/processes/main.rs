//! The program as a user runs it: several processes on this machine, with tiny pictures.
#![cfg(target_os = "linux")]
#![allow(clippy::unwrap_used, reason = "what fails is a test")]

mod failures;
mod films;
mod losses;
mod program;
