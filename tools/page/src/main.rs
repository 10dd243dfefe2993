//! `cargo page`: compiles the library to WebAssembly, puts it beside the page's own files, and
//! serves the folder to browsers on this machine.

mod gather;
mod sections;
mod server;
mod wasm;
mod wgsl;

use anyhow::Result;
use clap::Parser;
use std::path::PathBuf;
use std::process::ExitCode;

/// Build the page that renders in a browser, and serve it on this machine.
///
/// The page is a folder of static files, which any web server can serve.
#[derive(Parser)]
#[command(name = "cargo page")]
struct Arguments {
    /// Port to serve at; 0 takes one that is free.
    #[arg(long, default_value_t = 8017)]
    port: u16,
    /// Folder that the page is written to; by default `page` in Cargo's target folder.
    #[arg(long, value_name = "FOLDER")]
    output: Option<PathBuf>,
    /// Write the page and serve nothing.
    #[arg(long)]
    no_serve: bool,
    /// Serve what an earlier run has written.
    #[arg(long, conflicts_with = "no_serve")]
    no_build: bool,
}

fn main() -> ExitCode {
    match run(&Arguments::parse()) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("error: {error:#}");
            ExitCode::from(2)
        }
    }
}

fn run(arguments: &Arguments) -> Result<()> {
    let folder = match &arguments.output {
        Some(folder) => folder.clone(),
        None => wasm::target_folder()?.join("page"),
    };
    if !arguments.no_build {
        let library = wasm::build()?;
        let bytes = gather::write(&library, &folder)?;
        eprintln!("{}: {:.2} MB in all", folder.display(), bytes as f64 * 1e-6);
    }
    if arguments.no_serve {
        return Ok(());
    }
    server::serve(&folder, arguments.port)
}
