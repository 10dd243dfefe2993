//! `raystream picture`

use super::choices::choice;
use super::effects::{Facts, Given};
use super::ending::{CliError, Ending};
use super::options::{DeviceArguments, DisplayArguments};
use super::output::{self, is_png};
use clap::Args;
use raystream::film::Film;
use raystream::film_file::FilmFile;
use raystream::image;
use raystream::render::FilterKind;
use std::path::PathBuf;

/// The options of `raystream picture`.
#[derive(Args)]
pub struct PictureArguments {
    /// The film file, of `raystream render --checkpoint` or `raystream merge`.
    film: PathBuf,
    /// Where to write the picture; .exr for all layers in full precision, .png for a look. May be
    /// given several times.
    #[arg(short, long, value_name = "FILE", required = true)]
    output: Vec<PathBuf>,
    /// Take noise out of the picture with a filter [default filter: auto]; for films whose samples
    /// are in halves.
    #[arg(
        long,
        value_name = "FILTER",
        num_args = 0..=1,
        default_missing_value = FilterKind::Auto.name(),
        value_parser = choice::<FilterKind>()
    )]
    denoise: Option<FilterKind>,
    #[command(flatten)]
    device: DeviceArguments,
    #[command(flatten)]
    display: DisplayArguments,
    /// Say nothing but warnings and errors.
    #[arg(short, long)]
    quiet: bool,
}

/// Makes a picture of a film.
pub fn run(arguments: &PictureArguments, given: &Given) -> Result<Ending, CliError> {
    let path = &arguments.film;
    output::check_outputs(&arguments.output, Some(path))?;
    let file = FilmFile::read(path)?;
    let has_halves = file.checkpoint.radiance.iter().any(|pixel| pixel.second_samples > 0);
    if arguments.denoise.is_some() && !has_halves {
        return Err(format!(
            "{}: --denoise needs samples in halves, which the film has not; begin the render with \
             --denoise or --halves",
            path.display()
        )
        .into());
    }
    let device = arguments.device.open()?;
    given.warn(&Facts {
        writes_png: arguments.output.iter().any(|path| is_png(path)),
        ..Facts::of_device(&device)
    });
    let film = file.film(&device, arguments.denoise)?;
    let header = header(&file, &film, arguments.denoise);
    let mut written = Ok(());
    for path in &arguments.output {
        let picture = image::write_film_as(path, &film, &header, &arguments.display.display());
        if picture.is_ok() && !arguments.quiet {
            output::say(&format!("wrote {}", path.display()));
        }
        written = written.and(picture);
    }
    written?;
    Ok(Ending::Done)
}

/// What the picture says of the render.
fn header(file: &FilmFile, film: &Film, denoise: Option<FilterKind>) -> Vec<(String, String)> {
    let mut header = vec![
        ("scene".to_owned(), file.header.scene.clone()),
        ("device".to_owned(), file.header.device.clone()),
        ("samples".to_owned(), output::average_samples(film).to_string()),
        ("seconds".to_owned(), format!("{:.3}", file.header.seconds)),
        ("version".to_owned(), file.header.version.clone()),
        ("command".to_owned(), file.header.command.arguments.join(" ")),
    ];
    if let Some(part) = file.header.own_parts().next() {
        let parts = file.header.own_parts().count();
        header.push(("parts".to_owned(), format!("{parts} of {}", part.count)));
    }
    header.extend(denoise.map(|filter| ("denoise".to_owned(), filter.to_string())));
    header
}
