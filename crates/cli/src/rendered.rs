//! What came of a render, in words.

use super::ending::CliError;
use super::output::{average_samples, rate};
use glam::Vec3;
use raystream::film::Film;
use raystream::render::estimator::Noise;
use raystream::render::{Outcome, Stop};

/// What to say of a picture without any light.
const BLACK: &str = "the picture is black: no path met light that shines towards it. A quad shines \
    on the side of cross(u, v), an emissive material on the front of its triangles; a lamp may be \
    turned away, or behind a wall, or the camera may be enclosed.";

/// What came of a render.
pub struct Rendered {
    /// The film.
    pub film: Film,
    /// How the render went.
    pub outcome: Outcome,
    /// What is left in the picture; none where errors are not estimated.
    pub noise: Option<Noise>,
    /// Whether the film file could be written at the end.
    pub kept: Result<(), CliError>,
}

impl Rendered {
    /// How it went, in a line.
    pub fn summary(&self) -> String {
        let Self { film, outcome, noise, .. } = self;
        let seconds = outcome.elapsed.as_secs_f64().max(1e-9);
        let error = noise.map_or_else(String::new, |noise| {
            format!(", estimated error {:.2} %", 100.0 * noise.relative_error)
        });
        format!(
            "{}{} samples per pixel in {seconds:.2} s: {}samples/s, {}rays/s{error}",
            if outcome.interrupted() { "interrupted after " } else { "" },
            average_samples(film),
            rate(outcome.paths as f64 / seconds),
            rate(outcome.rays as f64 / seconds)
        )
    }

    /// What the picture lacks, of the error `wanted` too, a sentence each.
    pub fn shortcomings(&self, wanted: Option<f32>) -> Vec<String> {
        let Self { film, outcome, noise, .. } = self;
        let mut lines = Vec::new();
        let unseen = film.radiance.iter().filter(|pixel| pixel.samples() == 0).count();
        if unseen > 0 {
            lines.push(format!(
                "{unseen} of {} pixels have no sample and are black: the render ended before \
                 its first look at them; give it more --time or a smaller --size",
                film.radiance.len()
            ));
        }
        if let (Some(wanted), Some(noise)) = (wanted, noise)
            && outcome.stop != Stop::Noise
        {
            let first = match outcome.stop {
                Stop::Samples => "--spp came first",
                Stop::Time => "--time came first",
                Stop::Noise | Stop::Interrupted => "it was interrupted",
            };
            lines.push(format!(
                "the error that --noise asks for, {:.2} %, was not reached: {first}; {} of {} \
                 pixels are above it",
                100.0 * wanted,
                noise.unconverged,
                film.radiance.len()
            ));
        }
        if outcome.paths > 0 && film.radiance.iter().all(|pixel| pixel.sum() == Vec3::ZERO) {
            lines.push(BLACK.to_owned());
        }
        lines
    }
}

/// What a picture's header calls the end of its render.
pub fn stop_name(stop: Stop) -> &'static str {
    match stop {
        Stop::Samples => "samples",
        Stop::Time => "time",
        Stop::Noise => "noise",
        Stop::Interrupted => "interrupted",
    }
}
