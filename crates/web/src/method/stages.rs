//! The stages of a round as a reader is shown them.

use super::Choice;
use super::beside::Beside;
use super::pictures::{Painter, means};
use super::seen::{Seen, Selection};
use super::texts;
use crate::page::Painted;
use glam::Vec3;
use raystream_shaders::film::sums::PixelSums;
use raystream_view::inspect::short;
use serde::Serialize;

/// A stage of a round.
#[derive(Serialize)]
pub struct Stage {
    /// What it is called.
    pub name: &'static str,
    /// What happens there and why, for a reader who has not seen it before.
    pub text: String,
    /// Numbers of it.
    pub facts: Vec<Fact>,
    /// What there is to see.
    pub pictures: Vec<Painted>,
    /// The kernels that have computed it.
    pub kernels: &'static [&'static str],
    /// What another device has made of it, where one was asked.
    pub beside: Option<Beside>,
}

/// A number of a stage.
#[derive(Serialize)]
pub struct Fact {
    /// A name by which programs find it.
    pub key: &'static str,
    /// What it is, in words.
    pub label: &'static str,
    /// The number.
    pub value: String,
}

fn fact(key: &'static str, label: &'static str, value: impl ToString) -> Fact {
    Fact { key, label, value: value.to_string() }
}

/// A round that has been rendered.
pub struct Round<'a> {
    /// What the reader chose.
    pub choice: &'a Choice,
    /// Number of the round, from 1 on.
    pub number: u32,
    /// What was seen of it.
    pub seen: &'a Seen,
}

impl Round<'_> {
    /// Its stages. One that looks at no errors has fewer.
    pub fn stages(&self) -> Vec<Stage> {
        let mut stages = vec![self.film_before()];
        if !self.seen.errors.is_empty() {
            stages.extend([self.guides(), self.filtered(), self.errors()]);
            match &self.seen.selection {
                Selection::Alike => {}
                Selection::Runs { weights, starts } => {
                    stages.extend([self.weights(weights), self.runs(starts)]);
                }
                Selection::Streams { longest, lengths } => {
                    stages.push(self.streams(longest, lengths));
                }
            }
        }
        stages.extend([self.slots(), self.contributions(), self.film_after()]);
        stages
    }

    fn painter(&self) -> Painter {
        Painter { size: self.choice.size }
    }

    fn means(&self, film: &[PixelSums]) -> Vec<Vec3> {
        means(film, self.seen.unit_exponent)
    }

    fn film_before(&self) -> Stage {
        let film = &self.seen.before;
        let counts: Vec<f32> = film.iter().map(|pixel| pixel.samples() as f32).collect();
        let painter = self.painter();
        let mut pictures = vec![painter.radiance("mean radiance so far", &self.means(film))];
        if counts.iter().any(|&count| count != counts[0]) {
            pictures.push(painter.numbers("samples of each pixel so far", &counts, true));
        }
        Stage {
            name: "Film",
            kernels: &[],
            beside: None,
            text: texts::film_before(self.number),
            facts: vec![fact("samples-before", "samples in the film", samples(film))],
            pictures,
        }
    }

    fn guides(&self) -> Stage {
        let guides = &self.seen.guides;
        let deviations: Vec<f32> = guides.iter().map(|guide| guide.variance.sqrt()).collect();
        let surfaces = guides.iter().filter(|guide| guide.has_surface()).count();
        let mut pictures = self.painter().surfaces(guides).into_iter().collect::<Vec<_>>();
        pictures.push(self.painter().numbers("deviation of the mean", &deviations, false));
        Stage {
            name: "Guides",
            kernels: &["first_hits", "make_guides"],
            beside: None,
            text: texts::guides(self.choice.estimator),
            facts: vec![fact("surfaces", "pixels that show a surface", surfaces)],
            pictures,
        }
    }

    fn filtered(&self) -> Stage {
        let radiance: Vec<Vec3> = self.seen.estimates.iter().map(|e| e.filtered).collect();
        let measured = self.means(&self.seen.before);
        let apart: Vec<Vec3> = radiance.iter().zip(&measured).map(|(f, m)| (f - m).abs()).collect();
        let painter = self.painter();
        Stage {
            name: "Filtered",
            kernels: &["filter_errors", "filtered_errors", "noise_errors", "axis_rates"],
            beside: None,
            text: texts::filtered(self.choice.estimator),
            facts: vec![fact("apart", "mean distance from the film", short(mean(&apart)))],
            pictures: vec![
                painter.radiance("what the estimator takes the picture to be", &radiance),
                painter.radiance("how far that is from the film", &apart),
            ],
        }
    }

    fn errors(&self) -> Stage {
        // Converged pixels have an error below 0.
        let errors: Vec<f32> = self.seen.errors.iter().map(|error| error.max(0.0)).collect();
        let largest = errors.iter().copied().fold(0.0, f32::max);
        let none = errors.iter().filter(|&&error| error == 0.0).count();
        Stage {
            name: "Error",
            kernels: &["filter_errors", "filtered_errors", "noise_errors", "axis_rates"],
            beside: None,
            text: texts::errors(self.choice),
            facts: vec![
                fact("largest-error", "largest error", short(largest)),
                fact("without-error", "pixels without an error", none),
            ],
            pictures: vec![self.painter().numbers(
                "error, by the allocator's form",
                &errors,
                false,
            )],
        }
    }

    fn weights(&self, weights: &[u32]) -> Stage {
        let sum: u64 = weights.iter().map(|&weight| u64::from(weight)).sum();
        let none = weights.iter().filter(|&&weight| weight == 0).count();
        let numbers: Vec<f32> = weights.iter().map(|&weight| weight as f32).collect();
        Stage {
            name: "Weights",
            kernels: &[
                "block_errors",
                "add_block_errors",
                "copy_counts",
                "clear_counter",
                "raise_level",
                "weigh_deficits",
                "weigh_errors",
            ],
            beside: None,
            text: texts::weights(self.choice.allocator),
            facts: vec![
                fact("weights", "sum of the weights", sum),
                fact("without-weight", "pixels without a weight", none),
            ],
            pictures: vec![self.painter().numbers("weight", &numbers, false)],
        }
    }

    fn runs(&self, starts: &[u32]) -> Stage {
        let lengths: Vec<u32> = starts.windows(2).map(|ends| ends[1] - ends[0]).collect();
        let numbers: Vec<f32> = lengths.iter().map(|&length| length as f32).collect();
        let last = starts.last().copied().unwrap_or(0);
        Stage {
            name: "Runs",
            kernels: &["scan_blocks", "run_starts"],
            beside: None,
            text: texts::RUNS.to_owned(),
            facts: vec![
                fact("runs", "slots of all runs", last),
                fact("longest-run", "longest run", lengths.iter().max().unwrap_or(&0)),
            ],
            pictures: vec![self.painter().numbers("length of the run", &numbers, false)],
        }
    }

    fn streams(&self, longest: &[u32], lengths: &[u32]) -> Stage {
        let flags: Vec<Vec3> = longest.iter().map(|&flag| Vec3::splat(flag as f32)).collect();
        let whole = vec![Vec3::ZERO; self.seen.errors.len()];
        let flags = if flags.is_empty() { &whole } else { &flags };
        Stage {
            name: "Streams",
            kernels: &[
                "block_errors",
                "add_block_errors",
                "paper_begin",
                "paper_select",
                "sum_blocks",
                "scan_blocks",
                "paper_decide",
                "scatter_kept",
            ],
            beside: None,
            text: texts::STREAMS.to_owned(),
            facts: vec![
                fact("streams", "streams that were kept", lengths.len()),
                fact("stream-slots", "slots of all of them", lengths.iter().sum::<u32>()),
            ],
            pictures: vec![self.painter().colors("pixels of the longest stream", flags)],
        }
    }

    fn slots(&self) -> Stage {
        let seen = self.seen;
        let counts = seen.slots_of_pixels();
        let numbers: Vec<f32> = counts.iter().map(|&count| count as f32).collect();
        let sampled = counts.iter().filter(|&&count| count > 0).count();
        let painter = self.painter();
        Stage {
            name: "Slots",
            kernels: &[
                "fill_runs",
                "clear_slots",
                "paper_append",
                "reserve_slots",
                "fill_reserved",
            ],
            beside: None,
            text: texts::slots(self.choice.allocator, !seen.errors.is_empty()),
            facts: vec![
                fact("budget", "budget of the round", self.budget()),
                fact("slots", "slots that were filled", seen.paths().count()),
                fact("sampled", "pixels that have slots", sampled),
            ],
            pictures: vec![
                painter.numbers("slots of each pixel", &numbers, false),
                painter.slots(STREAM, &seen.slots),
            ],
        }
    }

    /// What the round was to trace. One that looks at no errors takes what all pixels get alike.
    fn budget(&self) -> u64 {
        let Choice { size, budget, .. } = *self.choice;
        if self.seen.errors.is_empty() {
            return self.seen.slots.len() as u64;
        }
        let pixels = f64::from(size.width) * f64::from(size.height);
        ((f64::from(budget) * pixels) as u64).max(1)
    }

    fn contributions(&self) -> Stage {
        let seen = self.seen;
        let mut sums = vec![(Vec3::ZERO, 0_u32); seen.after.len()];
        let (mut rays, mut black) = (0_u64, 0_u64);
        for (slot, contribution) in seen.paths() {
            let (sum, count) = &mut sums[slot.rank as usize];
            *sum += contribution.radiance;
            *count += 1;
            rays += u64::from(contribution.rays);
            black += u64::from(contribution.radiance == Vec3::ZERO);
        }
        let means: Vec<_> = sums.iter().map(|(sum, n)| sum / (*n).max(1) as f32).collect();
        let each: Vec<_> = seen.contributions.iter().map(|each| each.radiance).collect();
        let painter = self.painter();
        Stage {
            name: "Contributions",
            kernels: &["trace_paths"],
            beside: None,
            text: texts::CONTRIBUTIONS.to_owned(),
            facts: vec![
                fact("rays", "rays traced", rays),
                fact("black", "paths that found no light", black),
            ],
            pictures: vec![
                painter.radiance("means of the round; black where there was no slot", &means),
                painter.stream("the stream, each slot as bright as its path", &each),
            ],
        }
    }

    fn film_after(&self) -> Stage {
        let film = &self.seen.after;
        let counts: Vec<f32> = film.iter().map(|pixel| pixel.samples() as f32).collect();
        let adds_up = if self.seen.adds_up() { "yes, bit for bit" } else { "no" };
        let painter = self.painter();
        Stage {
            name: "Film after",
            kernels: &["accumulate"],
            beside: None,
            text: texts::FILM_AFTER.to_owned(),
            facts: vec![
                fact("samples-after", "samples in the film", samples(film)),
                fact("adds-up", "film before + contributions = film after", adds_up),
            ],
            pictures: vec![
                painter.radiance("mean radiance", &self.means(film)),
                painter.numbers("samples of each pixel", &counts, true),
            ],
        }
    }
}

const STREAM: &str = "the stream: the more red a slot, the farther right is its pixel; the more \
                      green, the farther down";

/// Samples of all pixels.
fn samples(film: &[PixelSums]) -> u64 {
    film.iter().map(|pixel| u64::from(pixel.samples())).sum()
}

/// The mean over pixels and components.
fn mean(colors: &[Vec3]) -> f32 {
    let sum: f64 = colors.iter().map(|color| f64::from(color.element_sum())).sum();
    (sum / (3.0 * colors.len().max(1) as f64)) as f32
}
