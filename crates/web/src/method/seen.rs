//! What was seen of a round: the steps of its kernels as the data that they are.

use crate::recording::{Bound, Keep, Step};
use bytemuck::Pod;
use raystream::exec::Kernel;
use raystream_shaders::allocator::paper::PaperState;
use raystream_shaders::estimator::Estimate;
use raystream_shaders::estimator::guide::Guide;
use raystream_shaders::film::Contribution;
use raystream_shaders::film::accumulate::AccumulateParams;
use raystream_shaders::film::stream::{NO_PIXEL, Slot};
use raystream_shaders::film::sums::PixelSums;
use raystream_shaders::math::random::SECOND_HALF;

/// A round. What there is for each pixel is in rank order.
#[derive(Clone, Debug, Default)]
pub struct Seen {
    /// The unit of the film is 2 to this power.
    pub unit_exponent: i32,
    /// The film before the round.
    pub before: Vec<PixelSums>,
    /// What estimators see of the pixels; empty where nobody estimates.
    pub guides: Vec<Guide>,
    /// What they think; empty likewise.
    pub estimates: Vec<Estimate>,
    /// The errors that the allocator goes by; empty likewise.
    pub errors: Vec<f32>,
    /// How the allocator chose among the pixels.
    pub selection: Selection,
    /// The slots that were added to the film, in the order of the stream; empty ones too.
    pub slots: Vec<Slot>,
    /// What came of each slot.
    pub contributions: Vec<Contribution>,
    /// The film after the round.
    pub after: Vec<PixelSums>,
}

/// How an allocator chose.
#[derive(Clone, Debug, Default)]
pub enum Selection {
    /// Without a look at errors: every pixel alike.
    #[default]
    Alike,
    /// By weights, of which follow runs: where each begins, and where the last one ends.
    Runs {
        /// Weights of the pixels.
        weights: Vec<u32>,
        /// First slots of the pixels, and the end.
        starts: Vec<u32>,
    },
    /// By streams of pixels, each of which takes those whose error exceeds a random threshold.
    Streams {
        /// 1 for a pixel that wanted to be in the longest stream that was kept, 0 for the others.
        longest: Vec<u32>,
        /// How many slots each stream has that was kept.
        lengths: Vec<u32>,
    },
}

/// What is to be kept of a kernel's launches for [`Seen::of`].
pub fn keep(kernel: &Kernel) -> Keep {
    match kernel.name {
        "accumulate" => Keep::All,
        "make_guides" | "filter_errors" | "filtered_errors" | "noise_errors" | "axis_rates"
        | "weigh_errors" | "weigh_deficits" | "run_starts" | "paper_select" | "paper_decide" => {
            Keep::Written
        }
        _ => Keep::Nothing,
    }
}

impl Seen {
    /// What the steps of a round show; None where nothing was added to the film.
    pub fn of(steps: &[Step]) -> Option<Self> {
        let mut seen = Self::default();
        let mut flags: Vec<Vec<u32>> = Vec::new();
        for step in steps {
            let written = |name| elements(&step.written, name);
            match step.kernel.name {
                "make_guides" => seen.guides = elements(&step.written, "guides"),
                "filter_errors" | "filtered_errors" | "noise_errors" | "axis_rates" => {
                    seen.estimates = step.written.first().map_or_else(Vec::new, Bound::elements);
                    seen.errors = step.written.get(1).map_or_else(Vec::new, Bound::elements);
                }
                "weigh_errors" | "weigh_deficits" => {
                    let weights = written("weights");
                    seen.selection = Selection::Runs { weights, starts: Vec::new() };
                }
                "run_starts" => {
                    if let Selection::Runs { starts, .. } = &mut seen.selection {
                        *starts = written("starts");
                    }
                }
                "paper_select" => flags.push(written("keep")),
                "paper_decide" => {
                    let states = elements(&step.written, "states");
                    seen.selection = streams(&states, &flags);
                }
                "accumulate" => seen.accumulate(step),
                _ => {}
            }
        }
        (!seen.slots.is_empty()).then_some(seen)
    }

    /// A part of the stream has been added to the film.
    fn accumulate(&mut self, step: &Step) {
        let params: AccumulateParams = bytemuck::pod_read_unaligned(&step.parameters);
        let range = params.first_slot as usize..params.end_slot as usize;
        if self.before.is_empty() {
            self.before = elements(&step.given, "film");
        }
        self.unit_exponent = params.unit_exponent;
        self.slots.extend(&elements::<Slot>(&step.given, "slots")[range.clone()]);
        let contributions: Vec<Contribution> = elements(&step.given, "contributions");
        self.contributions.extend(&contributions[range]);
        self.after = elements(&step.written, "film");
    }

    /// The slots that are not empty, each with what came of it.
    pub fn paths(&self) -> impl Iterator<Item = (&Slot, &Contribution)> {
        let both = self.slots.iter().zip(&self.contributions);
        both.filter(|(slot, _)| slot.rank != NO_PIXEL)
    }

    /// Slots of each pixel.
    pub fn slots_of_pixels(&self) -> Vec<u32> {
        let mut counts = vec![0; self.after.len()];
        for (slot, _) in self.paths() {
            counts[slot.rank as usize] += 1;
        }
        counts
    }

    /// Whether the film after the round is, bit for bit, the film before it with all contributions
    /// added one by one.
    pub fn adds_up(&self) -> bool {
        let mut film = self.before.clone();
        for (slot, contribution) in self.paths() {
            let is_second = slot.sample >= SECOND_HALF;
            film[slot.rank as usize].add(contribution, is_second, self.unit_exponent);
        }
        film == self.after
    }
}

/// The streams that were kept, and who wanted to be in the longest one.
fn streams(states: &[PaperState], flags: &[Vec<u32>]) -> Selection {
    let kept = || states.iter().zip(flags).filter(|(state, _)| state.taken > 0);
    let longest = kept().max_by_key(|(state, _)| state.taken);
    Selection::Streams {
        longest: longest.map(|(_, flags)| flags.clone()).unwrap_or_default(),
        lengths: kept().map(|(state, _)| state.taken).collect(),
    }
}

/// The elements of a binding; none where it is not there.
fn elements<T: Pod>(bindings: &[Bound], name: &str) -> Vec<T> {
    bindings.iter().find(|bound| bound.name == name).map_or_else(Vec::new, Bound::elements)
}
