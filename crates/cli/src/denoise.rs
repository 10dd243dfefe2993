//! `raystream denoise`

use super::choices::choice;
use super::effects::{Facts, Given};
use super::ending::{CliError, Ending};
use super::options::{DeviceArguments, DisplayArguments};
use super::output::{self, is_png};
use clap::Args;
use glam::Vec3;
use raystream::denoise::{Denoising, NoisyPicture, denoise};
use raystream::image::{self, Channel, ColorImage, Format, LayeredImage};
use raystream::render::FilterKind;
use std::path::PathBuf;

/// The options of `raystream denoise`.
#[derive(Args)]
pub struct DenoiseArguments {
    /// The picture: an EXR of Raystream, or one with the passes of another renderer (albedo, normal
    /// and depth, as Cycles, pbrt and Mitsuba call them), or one of colours alone.
    picture: PathBuf,
    /// Where to write the result; .exr for all that the picture has and the layer `denoised`, .png
    /// for a look. May be given several times.
    #[arg(short, long, value_name = "FILE", required = true)]
    output: Vec<PathBuf>,
    /// The filter.
    #[arg(long, value_parser = choice::<FilterKind>(), default_value_t)]
    filter: FilterKind,
    #[command(flatten)]
    device: DeviceArguments,
    #[command(flatten)]
    display: DisplayArguments,
    /// Say nothing but warnings and errors.
    #[arg(short, long)]
    quiet: bool,
}

/// Takes noise out of a picture.
pub fn run(arguments: &DenoiseArguments, given: &Given) -> Result<Ending, CliError> {
    let path = &arguments.picture;
    output::check_outputs(&arguments.output, Some(path))?;
    let mut layers = image::read_layers(path)?;
    let picture = NoisyPicture::from_layers(path, &layers)?;
    let device = arguments.device.open()?;
    given.warn(&Facts {
        writes_png: arguments.output.iter().any(|path| is_png(path)),
        ..Facts::of_device(&device)
    });
    let say = |line: &str| {
        if !arguments.quiet {
            output::say(line);
        }
    };
    let known = picture.known();
    say(&format!(
        "{}: {}x{} pixels, colour{}{}; filter {} on {}",
        path.display(),
        picture.size().width,
        picture.size().height,
        known.iter().map(|name| format!(", {name}")).collect::<String>(),
        if picture.variance.is_none() { "; noise estimated from the picture" } else { "" },
        arguments.filter,
        device.description()
    ));
    let denoising = Denoising { filter: arguments.filter, ..Denoising::default() };
    let denoised = denoise(&device, &picture, &denoising)?;
    let (width, height) = (layers.width, layers.height);
    let image = ColorImage { width, height, pixels: denoised.color };
    add_layers(&mut layers, &image.pixels, denoised.squared_error);
    let mut header: Vec<_> = image::read_settings(path)?.into_iter().collect();
    header.retain(|(key, _)| key != "denoise");
    header.push(("denoise".to_owned(), arguments.filter.to_string()));
    for path in &arguments.output {
        match Format::of(path)? {
            Format::Exr => image::write_layers(path, &layers, &header)?,
            Format::Png => image::write_png(path, &image, &arguments.display.display())?,
        }
        say(&format!("wrote {}", path.display()));
    }
    Ok(Ending::Done)
}

/// Adds the result to the layers, in the place of an earlier one.
fn add_layers(layers: &mut LayeredImage, color: &[Vec3], squared_error: Vec<f32>) {
    let is_earlier = |name: &str| {
        name.rsplit_once('.')
            .is_some_and(|(layer, _)| ["denoised", "denoised_error"].contains(&layer))
    };
    layers.channels.retain(|channel| !is_earlier(&channel.name));
    let component = |(i, name): (usize, &str)| Channel {
        name: format!("denoised.{name}"),
        values: color.iter().map(|c| c[i]).collect(),
    };
    layers.channels.extend(["R", "G", "B"].into_iter().enumerate().map(component));
    layers.channels.push(Channel { name: "denoised_error.V".to_owned(), values: squared_error });
}
