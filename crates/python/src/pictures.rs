//! Pictures, read from files and written to them.

use crate::errors::{python_error, value_error};
use crate::layers::{COLOR, channels, dictionary};
use glam::Vec3;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use raystream::image::{
    ColorImage, Display, Format, ImageError, LayeredImage, ToneMap, read_color, read_layers,
    write_layers, write_png,
};
use std::path::{Path, PathBuf};

/// Reads a picture: an .exr, all of its layers, or a .png, as linear Rec.709.
///
/// Returns a dictionary of float32 arrays, (height, width) or (height, width, 3): the channels R,
/// G, B are "color", layer.R ... are "layer". Numbers of an EXR are as they are in the file.
#[pyfunction]
pub fn read(py: Python<'_>, path: PathBuf) -> PyResult<Bound<'_, PyDict>> {
    let read = py.detach(|| {
        Ok(match Format::of(&path)? {
            Format::Exr => read_layers(&path)?,
            Format::Png => LayeredImage::from_color(&read_color(&path)?),
        })
    });
    dictionary(py, &read.map_err(|error: ImageError| python_error(&error))?)
}

/// Writes a picture: an array of shape (height, width, 3), linear Rec.709, or a dictionary of
/// layers.
///
/// write(path, layers, *, exposure=0.0, tone_map="soft"): an .exr has all layers, a .png shows
/// "denoised" if that is there, else "color", with exposure in stops and the tone map soft, clip or
/// aces. Files appear whole or not at all.
#[pyfunction]
#[pyo3(signature = (path, layers, *, exposure = 0.0, tone_map = "soft"))]
pub fn write(
    path: PathBuf,
    layers: &Bound<'_, PyAny>,
    exposure: f32,
    tone_map: &str,
) -> PyResult<()> {
    let py = layers.py();
    let display = display(exposure, tone_map)?;
    let format = Format::of(&path).map_err(|error| python_error(&error))?;
    let image = image_of(layers, format)?;
    let written = py.detach(|| match format {
        Format::Exr => write_layers(&path, &image, &[]),
        Format::Png => shown(&path, &image).and_then(|shown| write_png(&path, &shown, &display)),
    });
    written.map_err(|error| python_error(&error))
}

fn display(exposure: f32, tone_map: &str) -> PyResult<Display> {
    let tone_map: ToneMap = tone_map.parse().map_err(|error| python_error(&error))?;
    // As the command line has it.
    if exposure.is_nan() || exposure.abs() > 100.0 {
        let what = "is not a number of stops between -100 and 100";
        return Err(value_error(format!("exposure: {exposure} {what}")));
    }
    Ok(Display { exposure, tone_map })
}

/// The layers, as far as the format has them.
fn image_of(layers: &Bound<'_, PyAny>, format: Format) -> PyResult<LayeredImage> {
    let (mut size, mut all) = (None, Vec::new());
    match layers.cast::<PyDict>() {
        Ok(layers) => {
            let of_png = if layers.contains("denoised")? { "denoised" } else { COLOR };
            for (name, array) in layers {
                let name: String = name.extract()?;
                if format == Format::Exr || name == of_png {
                    let name = if format == Format::Exr { name.as_str() } else { COLOR };
                    all.extend(channels(name, &array, &mut size)?);
                }
            }
        }
        Err(_) => all.extend(channels(COLOR, layers, &mut size)?),
    }
    let (height, width) = size.ok_or_else(|| value_error("there is no layer to write"))?;
    Ok(LayeredImage { width: width as u32, height: height as u32, channels: all })
}

/// The colours of a picture.
fn shown(path: &Path, image: &LayeredImage) -> Result<ColorImage, ImageError> {
    let [red, green, blue] = ["R", "G", "B"].map(|name| image.channel(name));
    let (Some(red), Some(green), Some(blue)) = (red, green, blue) else {
        let channels = image.channels.iter().map(|channel| channel.name.as_str());
        let channels = channels.collect::<Vec<_>>().join(", ");
        return Err(ImageError::NoColor { path: path.to_owned(), channels });
    };
    let pixels = red.iter().zip(green).zip(blue);
    let pixels = pixels.map(|((&r, &g), &b)| Vec3::new(r, g, b)).collect();
    Ok(ColorImage { width: image.width, height: image.height, pixels })
}
