//! Raystream's page in the browser.
//!
//! The library is compiled to WebAssembly and runs in a worker of the page. [`page`] is what the
//! page shows, as a plain struct; [`ask`] is what the page can ask it and what it answers, as JSON;
//! `exports` is the surface that JavaScript sees, and exists in WebAssembly alone. [`recording`]
//! keeps what each kernel of a round wrote: [`method`] shows it, a round step by step, and by it
//! [`digests`] shows that browser and native program compute the same bytes. A [`computer`] is what
//! all of it is computed on: the CPU, or a GPU by [`webgpu`].
//!
//! The page itself is the folder `page`: static files, without a bundler or libraries. `cargo page`
//! puts both together and serves them.

pub mod ask;
pub mod computer;
pub mod digests;
#[cfg(target_family = "wasm")]
mod exports;
pub mod files;
#[cfg(target_family = "wasm")]
mod imports;
pub mod method;
pub mod page;
pub mod recording;
pub mod studio;
pub mod webgpu;
