//! Options of adaptive sampling.

use super::choices::choice;
use clap::Args;
use raystream::render::{AllocatorKind, EstimationSettings, Estimator, FilterSettings, Sampling};

/// The options that say how samples are spent.
#[derive(Args)]
#[command(next_help_heading = "Adaptive sampling")]
pub struct SamplingArguments {
    /// Who decides which pixels a round samples [default: runs, or uniform where a picture is too
    /// large for the device to estimate errors].
    #[arg(long, value_parser = choice::<AllocatorKind>())]
    allocator: Option<AllocatorKind>,
    #[command(flatten)]
    estimation: EstimationArguments,
    /// What the error of a pixel is taken to be.
    #[arg(long, value_parser = choice::<Estimator>(), default_value_t)]
    estimator: Estimator,
    /// Go by errors relative to the brightness of their pixel, not by absolute ones.
    #[arg(long)]
    relative: bool,
    #[command(flatten)]
    rounds: RoundArguments,
    /// Stop when the picture's estimated relative error is at most this (0.02 is 2 %). Pixels that
    /// are better get no more samples.
    #[arg(long, value_name = "ERROR", value_parser = parse_noise)]
    noise: Option<f32>,
    /// Split the samples of each pixel into two independent halves, which an EXR then holds, even
    /// where nothing else needs them; `runs` always does.
    #[arg(long)]
    halves: bool,
}

/// The options that say how long rounds are.
#[derive(Args)]
pub struct RoundArguments {
    /// Samples per pixel of the first round, which is uniform.
    #[arg(
        long,
        default_value_t = 5,
        value_name = "N",
        value_parser = clap::value_parser!(u32).range(2..=65536)
    )]
    initial_spp: u32,
    /// Samples of a later round, on average over the pixels [default: as many as pixels have, half
    /// of that with paper and atomic, at least 1].
    #[arg(long, value_name = "N", value_parser = parse_round_budget)]
    round_budget: Option<f32>,
}

/// The options that say how estimators look at a pixel's neighbours.
#[derive(Args)]
pub struct EstimationArguments {
    /// Pixels that the filter of the estimator `bilateral` sees to each side.
    #[arg(
        long,
        default_value_t = FilterSettings::default().radius,
        value_name = "PIXELS",
        value_parser = clap::value_parser!(u32).range(0..=32)
    )]
    filter_radius: u32,
    /// Its standard deviation of world distance, in units of what the radius covers on the surface.
    #[arg(
        long,
        default_value_t = FilterSettings::default().position_sigma,
        value_name = "SIGMA",
        value_parser = parse_sigma
    )]
    filter_position: f32,
    /// Its standard deviation of the difference of normals, in radians.
    #[arg(
        long,
        default_value_t = FilterSettings::default().normal_sigma,
        value_name = "SIGMA",
        value_parser = parse_sigma
    )]
    filter_normal: f32,
    /// Its standard deviation of the difference of albedos.
    #[arg(
        long,
        default_value_t = FilterSettings::default().albedo_sigma,
        value_name = "SIGMA",
        value_parser = parse_sigma
    )]
    filter_albedo: f32,
    /// Let the filter look at features alone, not at colours: the filter of the paper.
    #[arg(long)]
    filter_features_only: bool,
    /// Let the estimators `halves` and `variance` look at each pixel alone, not at 3x3.
    #[arg(long)]
    no_smoothing: bool,
}

impl SamplingArguments {
    /// How samples are spent.
    pub fn sampling(&self) -> Sampling {
        Sampling {
            allocator: self.allocator.unwrap_or_default(),
            estimator: self.estimator,
            relative: self.relative,
            noise: self.noise,
            halves: self.halves,
            ..self.rounds.sampling(&self.estimation)
        }
    }

    /// What to do instead where the device cannot hold what estimates errors: nothing, if that was
    /// asked for.
    pub fn fallback(&self) -> Option<Sampling> {
        (self.allocator.is_none() && self.noise.is_none()).then_some(Sampling::UNIFORM)
    }
}

/// How samples were spent, as pairs of name and value, for a picture's header.
pub fn describe(sampling: &Sampling) -> Vec<(String, String)> {
    let pair = |name: &str, value: String| (name.to_owned(), value);
    let mut pairs = vec![pair("allocator", sampling.allocator.to_string())];
    if sampling.allocator != AllocatorKind::Uniform {
        pairs.push(pair("estimator", sampling.estimator.to_string()));
        pairs.push(pair("relative", sampling.relative.to_string()));
        pairs.push(pair("initial_spp", sampling.initial_samples.to_string()));
        if let Some(budget) = sampling.round_budget {
            pairs.push(pair("round_budget", budget.to_string()));
        }
    }
    if let Some(noise) = sampling.noise {
        pairs.push(pair("noise", noise.to_string()));
    }
    pairs
}

impl RoundArguments {
    /// Uniform sampling in rounds of this length, with what estimators it needs for others.
    pub fn sampling(&self, estimation: &EstimationArguments) -> Sampling {
        Sampling {
            initial_samples: self.initial_spp,
            round_budget: self.round_budget,
            estimation: estimation.settings(),
            ..Sampling::UNIFORM
        }
    }
}

impl EstimationArguments {
    /// What was asked for.
    pub fn settings(&self) -> EstimationSettings {
        EstimationSettings {
            filter: FilterSettings {
                radius: self.filter_radius,
                position_sigma: self.filter_position,
                normal_sigma: self.filter_normal,
                albedo_sigma: self.filter_albedo,
                color: !self.filter_features_only,
            },
            smooth: !self.no_smoothing,
        }
    }
}

pub fn parse_noise(text: &str) -> Result<f32, String> {
    match text.parse::<f32>() {
        Ok(noise) if (1e-5..=1.0).contains(&noise) => Ok(noise),
        _ => Err(format!("'{text}' is not a relative error between 0.00001 and 1, such as 0.02")),
    }
}

fn parse_round_budget(text: &str) -> Result<f32, String> {
    match text.parse::<f32>() {
        Ok(samples) if (1e-3..=65536.0).contains(&samples) => Ok(samples),
        _ => Err(format!(
            "'{text}' is not a number of samples per pixel between 0.001 and 65536, such as 1"
        )),
    }
}

fn parse_sigma(text: &str) -> Result<f32, String> {
    match text.parse::<f32>() {
        Ok(sigma) if (1e-4..=1e6).contains(&sigma) => Ok(sigma),
        _ => Err(format!("'{text}' is not a standard deviation between 0.0001 and 1000000")),
    }
}
