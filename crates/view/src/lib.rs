//! Raystream's window: a render to look at while it runs.
//!
//! What it does is in plain structs, which know nothing of windows: a camera in somebody's hands
//! ([`navigator`]), what is chosen ([`choices`]), the thread that renders ([`thread`]) and where it
//! meets the window ([`desk`]), and all that is shown ([`viewer`]). The page in the browser, which
//! has neither threads nor a window, takes the first of them alone: the feature `window` adds the
//! others.

pub mod choices;
pub mod curve;
#[cfg(feature = "window")]
pub mod desk;
pub mod inspect;
pub mod layers;
#[cfg(feature = "window")]
pub mod measure;
pub mod navigator;
pub mod news;
pub mod pace;
pub mod paths;
#[cfg(feature = "window")]
pub mod program;
#[cfg(feature = "window")]
pub mod save;
pub mod side;
pub mod stage;
#[cfg(feature = "window")]
pub mod thread;
#[cfg(feature = "window")]
pub mod view;
#[cfg(feature = "window")]
pub mod viewer;
#[cfg(feature = "window")]
pub mod watch;
#[cfg(feature = "window")]
pub mod window;
