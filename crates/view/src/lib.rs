//! Raystream's window: a render to look at while it runs.
//!
//! What it does is in plain structs, which know nothing of windows: a camera in somebody's hands
//! ([`navigator`]), what is chosen ([`choices`]), the thread that renders ([`thread`]) and where it
//! meets the window ([`desk`]), and all that is shown ([`viewer`]).

pub mod choices;
pub mod curve;
pub mod desk;
pub mod inspect;
pub mod layers;
pub mod measure;
pub mod navigator;
pub mod news;
pub mod pace;
pub mod program;
pub mod save;
mod side;
pub mod stage;
pub mod tev;
pub mod thread;
pub mod view;
pub mod viewer;
pub mod watch;
pub mod window;
