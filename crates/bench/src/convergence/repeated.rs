//! What is measured of a configuration, repetition by repetition.

use super::check::{self, Deviation, Spread, mean_difference};
use super::curve::{self, Point};
use super::render::Recorded;
use super::{Configuration, Measured, Reference, Round};
use crate::BenchError;

/// A configuration and what its repetitions have shown so far.
pub struct Repeated {
    /// Which.
    pub configuration: Configuration,
    /// What it is called; with the integrator, if there are several.
    name: String,
    /// What was measured, one of each repetition.
    curves: Vec<Vec<Point>>,
    /// The rounds of the first repetition.
    pub rounds: Vec<Round>,
    /// How far the mean of a repetition is off at most, if they are uniform.
    off: Option<Deviation>,
}

impl Repeated {
    /// All of `configurations`, of which nothing is measured yet.
    pub fn none_yet(configurations: &[Configuration]) -> Vec<Self> {
        configurations
            .iter()
            .map(|&configuration| Self {
                configuration,
                name: configuration.name_among(configurations),
                curves: Vec::new(),
                rounds: Vec::new(),
                off: None,
            })
            .collect()
    }

    /// A line on the next of `repetitions`.
    pub fn progress(&self, recorded: &Recorded, repetitions: u32) -> String {
        let end = &recorded.end;
        format!(
            "{}, {} of {repetitions}: {:.2} samples per pixel in {:.2} s, RMSE {:.3e}",
            self.name,
            self.curves.len() + 1,
            end.samples,
            end.wall.as_secs_f64(),
            end.errors.rmse
        )
    }

    /// Fails if the mean of a uniform repetition is further off that of the reference than chance
    /// explains. Adaptive ones have a bias.
    pub fn check_mean(
        &mut self,
        recorded: &Recorded,
        seed: u32,
        reference: &Reference,
        spread: Option<Spread>,
    ) -> Result<(), BenchError> {
        if !self.configuration.is_uniform() {
            return Ok(());
        }
        let (end, integrator) = (&recorded.end, self.configuration.integrator);
        let off = mean_difference(&recorded.film, end.samples, integrator, reference, spread);
        if off.is_wrong() {
            return Err(BenchError::Wrong(format!(
                "the mean of the uniform render ({}) with seed {seed} is {:.5} times the \
                 reference's, {:.1} standard errors off, of which {} are allowed",
                self.name, end.errors.mean_ratio, off.errors, off.limit
            )));
        }
        if self.off.is_none_or(|largest| off.errors > largest.errors) {
            self.off = Some(off);
        }
        Ok(())
    }

    /// Adds a repetition.
    pub fn add(&mut self, recorded: Recorded) {
        if self.curves.is_empty() {
            self.rounds = recorded.rounds;
        }
        self.curves.push(recorded.points);
    }

    /// A sentence on the means of uniform repetitions.
    pub fn mean_sentence(&self) -> Option<String> {
        let Deviation { errors, limit } = self.off?;
        let how = if limit == check::LIMIT {
            String::new()
        } else {
            format!(
                " (the standard error of lvc, whose samples of a round share light paths, is by \
                 the spread of {} rounds)",
                check::ROUNDS
            )
        };
        Some(format!(
            "mean of {}: at most {errors:.1} standard errors off the reference's, of which {limit} \
             are allowed{how}",
            self.name
        ))
    }

    /// All repetitions as one curve.
    pub fn measured(self) -> Measured {
        let Self { configuration, name, curves, rounds, .. } = self;
        Measured { configuration, name, curve: curve::aggregate(&curves), rounds }
    }
}
