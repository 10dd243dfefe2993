//! `raystream compare`

use super::ending::{CliError, Ending};
use super::output::{is_same_file, print_line};
use clap::Args;
use glam::Vec3;
use raystream::image::{self, ColorImage, ComparisonSettings, Display, ToneMap};
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
    /// must be an independent render. The first picture must be an EXR that Raystream wrote, for
    /// its variance.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..))]
    reference_samples: Option<u32>,
}

/// Blocks for the test of agreement: small enough to find a wrong corner, large enough to average
/// noise away.
const BLOCK: [u32; 2] = [40, 30];

/// Compares two pictures.
pub fn run(arguments: &CompareArguments) -> Result<Ending, CliError> {
    let CompareArguments { test: test_path, reference: reference_path, .. } = arguments;
    let in_context = |error: image::ImageError| {
        format!("{} and {}: {error}", test_path.display(), reference_path.display())
    };
    if let Some(path) = &arguments.output {
        image::check_writable(path)?;
        if [test_path, reference_path].into_iter().any(|input| is_same_file(input, path)) {
            return Err(format!(
                "{}: -o would replace a picture to compare; name another file",
                path.display()
            )
            .into());
        }
    }
    let test = image::read_color(test_path)?;
    let reference = image::read_color(reference_path)?;
    let comparison =
        image::compare(&test, &reference, &ComparisonSettings::default()).map_err(in_context)?;
    if arguments.json {
        print_line(&serde_json::to_string_pretty(&comparison)?)?;
    } else {
        let ratio =
            |ratio: Option<f64>| ratio.map_or_else(|| "-".into(), |ratio| format!("{ratio:.5}"));
        print_line(&format!("RMSE            {:.6}", comparison.rmse))?;
        print_line(&format!("relMSE          {:.6}", comparison.relative_mse))?;
        print_line(&format!(
            "trimmed relMSE  {:.6}  (without the worst 0.1 % of the pixels)",
            comparison.trimmed_relative_mse
        ))?;
        let rgb = comparison.ratio_rgb.map(ratio);
        print_line(&format!(
            "mean            {:.6} / {:.6} = {}  (by component {})",
            comparison.mean_test,
            comparison.mean_reference,
            ratio(comparison.ratio),
            rgb.join(", ")
        ))?;
        if comparison.non_finite_test + comparison.non_finite_reference > 0 {
            print_line(&format!(
                "not finite      {} pixels and {}",
                comparison.non_finite_test, comparison.non_finite_reference
            ))?;
        }
    }
    if let Some(path) = &arguments.output {
        let difference =
            image::difference(&test, &reference, arguments.gain).map_err(in_context)?;
        image::write_color(
            path,
            &difference,
            &[],
            &Display { exposure: 0.0, tone_map: ToneMap::Clip },
        )?;
    }
    if let Some(samples) = arguments.reference_samples {
        print_agreement(test_path, &test, &reference, f64::from(samples))?;
    }
    Ok(Ending::Done)
}

fn print_agreement(
    path: &Path,
    test: &ColorImage,
    reference: &ColorImage,
    samples: f64,
) -> Result<(), CliError> {
    let layers = image::read_layers(path)?;
    let channel = |name: &str| {
        layers.channel(name).ok_or_else(|| {
            format!("{}: has no channel {name}; render it with raystream", path.display())
        })
    };
    let [r, g, b] = [channel("variance.R")?, channel("variance.G")?, channel("variance.B")?];
    let variance: Vec<Vec3> =
        r.iter().zip(g).zip(b).map(|((&r, &g), &b)| Vec3::new(r, g, b)).collect();
    let counts = channel("samples.N")?;
    let own_samples =
        counts.iter().map(|&n| f64::from(n)).sum::<f64>() / counts.len().max(1) as f64;
    let result = image::agreement(test, &variance, own_samples / samples, reference, BLOCK)?;
    print_line(&format!(
        "agreement       mean {:+.3} %, worst of {} blocks of {}x{} pixels {:.2} standard errors \
         at ({}, {}), {} fireflies aside",
        100.0 * (result.mean_ratio - 1.0),
        result.blocks,
        BLOCK[0],
        BLOCK[1],
        result.worst_block,
        result.worst_at[0],
        result.worst_at[1],
        result.fireflies
    ))?;
    Ok(())
}

fn parse_gain(text: &str) -> Result<f32, String> {
    match text.parse::<f32>() {
        Ok(gain) if gain.is_finite() && gain > 0.0 => Ok(gain),
        _ => Err(format!("'{text}' is not a factor above 0, such as 4")),
    }
}
