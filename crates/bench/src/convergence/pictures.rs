//! What every configuration has to show after the same time, and its errors.

use super::errors::squared_errors;
use super::reference::Reference;
use super::render::render_to;
use super::speedup::samples_at;
use super::{Errors, Measurement, Plan};
use crate::BenchError;
use crate::files::Folder;
use raystream::exec::Executor;
use raystream::image::{ColorImage, Display, write_png};
use raystream::render::{PreparedScene, Settings};
use raystream_figures::write_color_map;

/// A picture at equal time.
pub struct Picture {
    /// Name of the configuration, and of the files.
    pub name: String,
    /// Samples per pixel that the configuration takes in that time.
    pub samples: f64,
    /// How far it is from the reference.
    pub errors: Errors,
}

/// The pictures at the time that uniform sampling needs for the first level.
pub struct Pictures {
    /// That time.
    pub seconds: f64,
    /// Largest squared error of the colour range.
    pub brightest: f32,
    /// One for each configuration whose curve spans the time.
    pub pictures: Vec<Picture>,
}

/// The share of uniform sampling's squared errors that the colour range spans.
const RANGE: f64 = 0.99;

/// Renders the pictures with the seed of the first repetition and writes them to `folder`:
/// `<configuration>.png`, `<configuration>-error.png` (squared error, in one range of colours for
/// all) and `reference.png`. Nothing if uniform sampling was not measured at the first level.
pub fn write<E: Executor>(
    executor: &E,
    scene: &PreparedScene,
    settings: &Settings,
    plan: &Plan,
    reference: &Reference,
    measurement: &Measurement,
    folder: &Folder,
) -> Result<Option<Pictures>, BenchError> {
    let uniform = measurement.configurations.first().map_or(&[][..], |uniform| &uniform.curve);
    let level =
        plan.levels.first().and_then(|&level| uniform.iter().find(|p| p.checkpoint == level));
    let Some(level) = level else { return Ok(None) };
    let seconds = level.wall.as_secs_f64();
    write_png(&folder.file("reference.png"), &reference.image, &Display::default())?;

    let mut pictures = Vec::new();
    let mut brightest = None;
    for measured in &measurement.configurations {
        let Some(samples) = samples_at(&measured.curve, seconds) else { continue };
        let configuration = measured.configuration;
        let film = render_to(executor, scene, &plan.settings(settings, configuration, 0), samples)?;
        let image = ColorImage::from_film(&film);
        let squares: Vec<f32> = squared_errors(&image.pixels, &reference.image.pixels)
            .into_iter()
            .map(|v| v as f32)
            .collect();
        // Uniform sampling comes first.
        let brightest = *brightest.get_or_insert_with(|| quantile(squares.clone(), RANGE));
        let name = measured.name.clone();
        write_png(&folder.file(&format!("{name}.png")), &image, &Display::default())?;
        let title = format!("{name}: squared error after {seconds:.3} s");
        let path = folder.file(&format!("{name}-error.png"));
        write_color_map(
            &path,
            image.width,
            image.height,
            &squares,
            &title,
            Some((0.0, brightest)),
        )?;
        pictures.push(Picture { name, samples, errors: Errors::of(&image, &reference.image)? });
    }
    Ok(brightest.map(|brightest| Pictures { seconds, brightest, pictures }))
}

/// The value below which the share `share` of `values` lies; 0 if there are none.
fn quantile(mut values: Vec<f32>, share: f64) -> f32 {
    values.sort_by(f32::total_cmp);
    values
        .get((values.len().saturating_sub(1) as f64 * share) as usize)
        .copied()
        .unwrap_or_default()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quantiles() {
        assert_eq!(quantile((0..=100).rev().map(|v| v as f32).collect(), 0.99), 99.0);
        assert_eq!(quantile(vec![3.0], 0.99), 3.0);
        assert_eq!(quantile(vec![], 0.99), 0.0);
    }
}
