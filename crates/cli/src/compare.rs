//! `raystream compare`

use super::agreement::{self, Verdict};
use super::effects::{Facts, Given};
use super::ending::{CliError, Ending};
use super::output::{is_same_file, print_line, say};
use clap::Args;
use raystream::image::{self, Comparison, ComparisonSettings, Display, Picture, ToneMap, Values};
use std::path::{Path, PathBuf};

/// The options of `raystream compare`.
#[derive(Args)]
pub struct CompareArguments {
    /// The picture to judge, EXR or PNG.
    test: PathBuf,
    /// The picture to judge it by.
    reference: PathBuf,
    /// Write the signed difference: red where the first picture is brighter, blue where it is
    /// darker.
    #[arg(short, long, value_name = "FILE")]
    output: Option<PathBuf>,
    /// How strongly the difference picture shows small differences.
    #[arg(long, default_value_t = 4.0, value_name = "G", value_parser = parse_gain)]
    gain: f32,
    /// Print JSON.
    #[arg(long)]
    json: bool,
    /// Also test whether both show the same scene: the samples per pixel of the reference, which
    /// must be an independent render. The first picture must be an EXR that Raystream wrote with
    /// `--allocator uniform`, for its variance.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..))]
    reference_samples: Option<u32>,
}

/// Compares two pictures.
pub fn run(arguments: &CompareArguments, given: &Given) -> Result<Ending, CliError> {
    let CompareArguments { test: test_path, reference: reference_path, .. } = arguments;
    let in_context = |error: image::ImageError| {
        format!("{} and {}: {error}", test_path.display(), reference_path.display())
    };
    check_output(arguments)?;
    given.warn(&Facts { has_output: arguments.output.is_some(), ..Facts::default() });
    let (test, reference) =
        rayon::join(|| image::read_picture(test_path), || image::read_picture(reference_path));
    let (test, reference) = (test?, reference?);
    let mut warnings = remarks(test_path, &test);
    warnings.extend(remarks(reference_path, &reference));
    warnings.extend(display_values(arguments, &test, &reference));
    let displays = [&test, &reference].map(display);
    let settings = ComparisonSettings { displays, ..Default::default() };
    let comparison =
        image::compare(&test.colors, &reference.colors, &settings).map_err(in_context)?;
    let agreement = arguments.reference_samples.map(|samples| {
        agreement::test([test_path, reference_path], &test.colors, &reference.colors, samples)
    });
    let agreement = agreement.transpose()?;
    warnings.extend(agreement.iter().flat_map(|agreement| agreement.caveats.iter().cloned()));
    for warning in &warnings {
        say(&format!("warning: {warning}"));
    }
    if arguments.json {
        print_line(&json(&comparison, agreement.as_ref(), &warnings)?)?;
    } else {
        for line in lines(&comparison) {
            print_line(&line)?;
        }
        if let Some(agreement) = &agreement {
            print_line(&agreement.to_string())?;
        }
    }
    if let Some(path) = &arguments.output {
        let difference = image::difference(&test.colors, &reference.colors, arguments.gain)
            .map_err(in_context)?;
        let display = Display { exposure: 0.0, tone_map: ToneMap::Clip };
        image::write_color(path, &difference, &[], &display)?;
    }
    Ok(Ending::Done)
}

/// Fails where the difference picture could not be written, or would replace one to compare.
fn check_output(arguments: &CompareArguments) -> Result<(), CliError> {
    let Some(path) = &arguments.output else { return Ok(()) };
    image::check_writable(path)?;
    if [&arguments.test, &arguments.reference].into_iter().any(|input| is_same_file(input, path)) {
        return Err(format!(
            "{}: -o would replace a picture to compare; name another file",
            path.display()
        )
        .into());
    }
    Ok(())
}

/// What is to be known of a picture.
fn remarks(path: &Path, picture: &Picture) -> Vec<String> {
    picture.remarks.iter().map(|remark| format!("{}: {remark}", path.display())).collect()
}

/// That one picture has radiances and the other has not.
fn display_values(
    arguments: &CompareArguments,
    test: &Picture,
    reference: &Picture,
) -> Option<String> {
    if test.values == reference.values {
        return None;
    }
    let is_test = test.values == Values::Display;
    let path = if is_test { &arguments.test } else { &arguments.reference };
    Some(format!(
        "{}: a PNG is not radiance: exposure and tone map are in it, and it ends at white; \
         compare EXR with EXR, or PNG with PNG",
        path.display()
    ))
}

/// How a picture is shown where its looks are compared: a PNG has its tone map in it.
fn display(picture: &Picture) -> Display {
    match picture.values {
        Values::Display => Display { exposure: 0.0, tone_map: ToneMap::Clip },
        Values::Radiance => Display::default(),
    }
}

/// Everything as JSON: the numbers of the comparison, those of the test of agreement, warnings.
fn json(
    comparison: &Comparison,
    agreement: Option<&Verdict>,
    warnings: &[String],
) -> Result<String, CliError> {
    let mut all = serde_json::to_value(comparison)?;
    if let Some(agreement) = agreement {
        all["agreement"] = agreement.json()?;
    }
    all["warnings"] = warnings.into();
    Ok(serde_json::to_string_pretty(&all)?)
}

/// A comparison in lines for people.
fn lines(comparison: &Comparison) -> Vec<String> {
    let ratio =
        |ratio: Option<f64>| ratio.map_or_else(|| "-".into(), |ratio| format!("{ratio:.5}"));
    let mut lines = vec![
        format!("RMSE            {:.6}", comparison.rmse),
        format!("relMSE          {:.6}", comparison.relative_mse),
        format!(
            "trimmed relMSE  {:.6}  (without the worst 0.1 % of the pixels)",
            comparison.trimmed_relative_mse
        ),
        format!(
            "SSIM            {}",
            comparison.ssim.map_or_else(
                || "-  (no window of 11x11 pixels fits)".into(),
                |ssim| format!("{ssim:.6}")
            )
        ),
        format!(
            "mean            {:.6} / {:.6} = {}  (by component {})",
            comparison.mean_test,
            comparison.mean_reference,
            ratio(comparison.ratio),
            comparison.ratio_rgb.map(ratio).join(", ")
        ),
    ];
    if comparison.non_finite_test + comparison.non_finite_reference > 0 {
        lines.push(format!(
            "not finite      {} pixels and {}",
            comparison.non_finite_test, comparison.non_finite_reference
        ));
    }
    lines
}

fn parse_gain(text: &str) -> Result<f32, String> {
    match text.parse::<f32>() {
        Ok(gain) if gain.is_finite() && gain > 0.0 => Ok(gain),
        _ => Err(format!("'{text}' is not a factor above 0, such as 4")),
    }
}
