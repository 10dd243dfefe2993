//! What is known of a pixel, and of a render, in words.

use crate::news::{Activity, Status};
use raystream::film::Film;
use raystream::render::Stop;

/// What is known of a pixel: what it is called and what it is. Empty outside of the film.
pub fn inspect(film: &Film, [x, y]: [u32; 2]) -> Vec<(&'static str, String)> {
    if x >= film.width || y >= film.height {
        return Vec::new();
    }
    let index = (y * film.width + x) as usize;
    // A film of one pixel knows all that the whole one knows of it.
    let pixel = Film {
        width: 1,
        height: 1,
        radiance: vec![film.radiance[index]],
        features: vec![film.features[index]],
        estimates: film.estimates.as_ref().map(|all| vec![all[index]]),
        corrections: film.corrections.as_ref().map(|all| vec![all[index]]),
        splats: film.splats.as_ref().map(|all| vec![all[index]]),
        denoised: film.denoised.as_ref().map(|all| vec![all[index]]),
    };
    let mut rows = vec![("pixel", format!("{x}, {y}"))];
    rows.push(("radiance", vector(pixel.color()[0])));
    if let Some(denoised) = pixel.denoised() {
        rows.push(("denoised", vector(denoised[0])));
    }
    rows.push(("samples", pixel.samples()[0].to_string()));
    let variance = pixel.variance()[0];
    if variance.is_finite() {
        rows.push(("std. error", vector(variance.map(f32::sqrt))));
    }
    if let Some(squared) = pixel.squared_error() {
        rows.push(("est. error", short(squared[0].sqrt())));
    }
    // Those of a moving camera, and of the first pictures, are not there yet.
    if pixel.features[0].samples == 0 {
        return rows;
    }
    rows.push(("albedo", vector(pixel.albedo()[0])));
    if pixel.features[0].hits == 0 {
        rows.push(("surface", "none".to_owned()));
        return rows;
    }
    rows.push(("normal", vector(pixel.normal()[0])));
    rows.push(("position", vector(pixel.position()[0])));
    rows.push(("depth", short(pixel.depth()[0])));
    rows
}

/// Three numbers.
pub fn vector(v: glam::Vec3) -> String {
    v.to_array().map(short).join("  ")
}

/// A number of four digits.
pub fn short(number: f32) -> String {
    let size = number.abs();
    if number == 0.0 || !number.is_finite() {
        // The sum makes 0 of -0.
        return format!("{}", number + 0.0);
    }
    if !(1e-3..1e5).contains(&size) {
        return format!("{number:.2e}");
    }
    let decimals = (3 - size.log10().floor() as i32).clamp(0, 5) as usize;
    format!("{number:.decimals$}")
}

/// How far a render is, in a line.
pub fn progress(status: &Status) -> String {
    let seconds = status.time.as_secs_f64();
    let rate = if seconds > 0.0 { status.rays as f64 / seconds / 1e6 } else { 0.0 };
    let error = status.error.map_or("-".to_owned(), |error| format!("{:.2} %", 100.0 * error));
    let samples = if status.samples < 10.0 {
        format!("{:.1}", status.samples)
    } else {
        format!("{:.0}", status.samples)
    };
    format!("{samples} spp   {rate:.1} Mrays/s   {seconds:.1} s   error {error}")
}

/// What part of the time went into showing, in a sentence.
pub fn showing(status: &Status) -> String {
    let (time, showing) = (status.time.as_secs_f64(), status.showing.as_secs_f64());
    let share = if showing > 0.0 { 100.0 * showing / (time + showing) } else { 0.0 };
    format!("{share:.1} % of the time went into showing it")
}

/// What the thread is at, in some words; `stop` is what ended the render in front.
pub fn activity(activity: &Activity, stop: Option<Stop>) -> String {
    match (activity, stop) {
        (Activity::Waiting, _) => "waiting".to_owned(),
        (Activity::Loading, _) => "loading the scene".to_owned(),
        (Activity::Opening, _) => "opening the device".to_owned(),
        (Activity::Paused, _) => "paused".to_owned(),
        (Activity::Failed(reason), _) => format!("error: {reason}"),
        (Activity::Rendering | Activity::Ended, Some(stop)) => match stop {
            Stop::Samples => "done: all samples".to_owned(),
            Stop::Time => "done: the time is up".to_owned(),
            Stop::Noise => "done: the error is reached".to_owned(),
            Stop::Interrupted => "stopped".to_owned(),
        },
        (Activity::Rendering, None) => "rendering".to_owned(),
        (Activity::Ended, None) => "done".to_owned(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec3;
    use raystream_shaders::estimator::Estimate;
    use raystream_shaders::film::FilmPixel;
    use raystream_shaders::integrator::first_hits::FeaturePixel;
    use std::time::Duration;

    fn film() -> Film {
        let radiance = FilmPixel {
            first_sum: Vec3::new(1.0, 2.0, 4.0),
            first_samples: 4,
            sum_of_squares: Vec3::new(1.0, 2.0, 8.0),
            ..FilmPixel::default()
        };
        let feature = FeaturePixel {
            albedo: Vec3::splat(0.5),
            normal: Vec3::Y,
            position: Vec3::new(2.0, 4.0, 6.0),
            depth: 6.0,
            samples: 1,
            hits: 2,
        };
        Film::new(
            2,
            1,
            vec![FilmPixel::default(), radiance],
            vec![FeaturePixel { samples: 1, ..FeaturePixel::default() }, feature],
        )
    }

    fn value(rows: &[(&str, String)], name: &str) -> Option<String> {
        rows.iter().find(|(of, _)| *of == name).map(|(_, value)| value.clone())
    }

    #[test]
    fn a_pixel_says_what_it_is() {
        let mut film = film();
        let estimate = Estimate { filtered: Vec3::ONE, squared_error: 0.04 };
        film.estimates = Some(vec![estimate; 2]);
        film.denoised = Some(vec![estimate; 2]);
        let rows = inspect(&film, [1, 0]);
        let expected = [
            ("pixel", "1, 0"),
            ("radiance", "0.2500  0.5000  1.000"),
            ("denoised", "1.000  1.000  1.000"),
            ("samples", "4"),
            // (1/4 - 1/16) / 3, (2/4 - 1/4) / 3, (8/4 - 1) / 3, and their roots.
            ("std. error", "0.2500  0.2887  0.5774"),
            ("est. error", "0.2000"),
            ("albedo", "0.5000  0.5000  0.5000"),
            ("normal", "0  1.000  0"),
            ("position", "1.000  2.000  3.000"),
            ("depth", "3.000"),
        ];
        assert_eq!(rows, expected.map(|(name, value)| (name, value.to_owned())));
    }

    #[test]
    fn a_pixel_without_samples_or_surface_says_so() {
        let rows = inspect(&film(), [0, 0]);
        assert_eq!(value(&rows, "samples").as_deref(), Some("0"));
        assert_eq!(value(&rows, "surface").as_deref(), Some("none"));
        assert_eq!((value(&rows, "std. error"), value(&rows, "depth")), (None, None));
        let mut without = film();
        without.features = vec![FeaturePixel::default(); 2];
        assert_eq!(value(&inspect(&without, [1, 0]), "albedo"), None);
        assert_eq!(inspect(&film(), [2, 0]), []);
        assert_eq!(inspect(&film(), [0, 1]), []);
    }

    #[test]
    fn numbers_are_short() {
        let numbers = [0.0, -0.0, 0.012_345_6, 1234.56, 99_999.4, 1e-7, 1e9, f32::INFINITY, -2.0];
        let texts = numbers.map(short);
        assert_eq!(
            texts,
            ["0", "0", "0.01235", "1235", "99999", "1.00e-7", "1.00e9", "inf", "-2.000"]
        );
        assert_eq!(short(f32::NAN), "NaN");
    }

    #[test]
    fn progress_is_a_line() {
        let status = Status {
            samples: 12.4,
            rays: 3_000_000,
            time: Duration::from_secs(2),
            error: Some(0.0123),
            ..Status::default()
        };
        assert_eq!(progress(&status), "12 spp   1.5 Mrays/s   2.0 s   error 1.23 %");
        assert_eq!(progress(&Status::default()), "0.0 spp   0.0 Mrays/s   0.0 s   error -");
    }

    #[test]
    fn every_end_has_its_words() {
        let stops = [Stop::Samples, Stop::Time, Stop::Noise, Stop::Interrupted];
        let texts = stops.map(|stop| activity(&Activity::Ended, Some(stop)));
        assert!(texts.iter().enumerate().all(|(i, text)| !texts[..i].contains(text)), "{texts:?}");
        let failed = activity(&Activity::Failed("no device".into()), Some(Stop::Time));
        assert!(failed.contains("no device"));
    }
}
