//! `raystream merge`

use super::command;
use super::ending::{CliError, Ending};
use super::output::{self, is_same_file};
use clap::Args;
use raystream::film_file::{self, FilmFile, FilmFileError};
use std::path::PathBuf;

/// The options of `raystream merge`.
#[derive(Args)]
pub struct MergeArguments {
    /// Film files of parts of one render, in any order; some may be missing.
    #[arg(required = true)]
    films: Vec<PathBuf>,
    /// Where to write the film of all: `raystream picture` makes a picture of it.
    #[arg(short, long, value_name = "FILE")]
    output: PathBuf,
    /// Say nothing but warnings and errors.
    #[arg(short, long)]
    quiet: bool,
}

/// Adds up films of parts.
pub fn run(arguments: &MergeArguments) -> Result<Ending, CliError> {
    let output = &arguments.output;
    FilmFile::check_writable(output)?;
    if arguments.films.iter().any(|film| is_same_file(film, output)) {
        let path = output.display();
        return Err(format!("{path}: -o would replace a part; name another file").into());
    }
    let (film, warning) = merged(&arguments.films)?;
    film.write(output)?;
    if let Some(what) = warning {
        output::say(&format!("warning: {what}"));
    }
    if !arguments.quiet {
        output::say(&format!("wrote {}", output.display()));
    }
    Ok(Ending::Done)
}

/// The film of all films, and what to know of it.
///
/// # Errors
/// If a film cannot be read, or they do not go together.
pub fn merged(films: &[PathBuf]) -> Result<(FilmFile, Option<String>), FilmFileError> {
    let mut film = film_file::merge(films)?;
    // The sum of all parts is none.
    command::remove_option(&mut film.header.command, "--part");
    // All parts are of as many.
    let count = film.header.own_parts().next().map_or(0, |part| part.count as usize);
    let missing = count - film.header.own_parts().count();
    let warning = (missing > 0).then(|| {
        format!("{missing} of {count} parts are missing: the picture is as good as its samples")
    });
    Ok((film, warning))
}
