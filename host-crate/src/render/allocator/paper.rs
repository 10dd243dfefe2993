//! The allocator `paper`: streams of pixels whose error exceeds random thresholds; see
//! [`raystream_shaders::allocator::paper`].

use super::error_scale::ErrorScale;
use super::{Allocator, RoundBuffers, Stream};
use crate::exec::{Array, ExecError, Executor, Launch, kernels};
use bytemuck::Zeroable;
use raystream_shaders::allocator::paper::{PaperParams, PaperState, STREAMS};
use raystream_shaders::film::accumulate::CountParams;
use raystream_shaders::film::stream::RunWindow;
use raystream_shaders::math::random::hash;
use raystream_shaders::parallel::prefix::BlockParams;

/// Streams by random thresholds.
pub struct Paper<B> {
    pixels: u32,
    scale: ErrorScale<B>,
    keep: Array<B, u32>,
    sums: Array<B, u32>,
    kept: Array<B, u32>,
    counts: Array<B, u32>,
    states: Array<B, PaperState>,
}

impl<B> Paper<B> {
    /// For pictures of `pixels` pixels.
    pub fn new<E: Executor<Buffer = B>>(executor: &E, pixels: u32) -> Result<Self, ExecError> {
        let blocks = BlockParams::per_block(pixels).blocks as usize;
        let words = |label, len| Array::zeroed(executor, label, len);
        Ok(Self {
            pixels,
            scale: ErrorScale::new(executor, pixels)?,
            keep: words("the flags of pixels", pixels as usize)?,
            sums: words("sums of flags", blocks + 1)?,
            kept: words("the pixels of a stream", pixels as usize)?,
            counts: words("the samples of pixels", pixels as usize)?,
            states: Array::zeroed(executor, "the states of the bisection", STREAMS as usize + 1)?,
        })
    }

    /// The streams of the last round: [`PaperState::filled`] is the first slot of each, `taken` its
    /// length.
    pub fn states<E: Executor<Buffer = B>>(
        &self,
        executor: &E,
    ) -> Result<Vec<PaperState>, ExecError> {
        self.states.read_range(executor, 0..STREAMS as usize)
    }

    fn parameters(&self, stream: &Stream, number: u32, threads: u32) -> PaperParams {
        PaperParams {
            threads,
            pixels: self.pixels,
            blocks: BlockParams::per_block(self.pixels).blocks,
            slots: stream.slots,
            stream: number,
            ..PaperParams::zeroed()
        }
    }

    /// Launches that make and append stream `number` of the round.
    fn append<'a>(
        &'a self,
        buffers: &RoundBuffers<'a, B>,
        stream: &Stream,
        number: u32,
    ) -> [Launch<'a, B>; 6] {
        let salt = hash(buffers.salt ^ hash(number));
        let half = buffers.split.of_adaptive();
        let parameters = PaperParams { salt, half, ..self.parameters(stream, number, self.pixels) };
        let per_block = BlockParams::per_block(self.pixels);
        [
            kernels::paper_select(
                &parameters,
                buffers.errors.view(),
                self.scale.totals.view(),
                self.states.view(),
                self.keep.view(),
            ),
            kernels::sum_blocks(&per_block, self.keep.view(), self.sums.view()),
            kernels::scan_blocks(&BlockParams::one_workgroup(self.pixels), self.sums.view()),
            kernels::paper_decide(
                &PaperParams { threads: 1, ..parameters },
                self.sums.view(),
                self.states.view(),
            ),
            kernels::scatter_kept(&per_block, self.keep.view(), self.sums.view(), self.kept.view()),
            kernels::paper_append(
                &parameters,
                self.states.view(),
                self.kept.view(),
                self.counts.view(),
                buffers.slots.view(),
            ),
        ]
    }
}

impl<E: Executor> Allocator<E> for Paper<E::Buffer> {
    fn fill<'a>(
        &'a self,
        buffers: &RoundBuffers<'a, E::Buffer>,
        stream: &Stream,
    ) -> Vec<Launch<'a, E::Buffer>> {
        let mut launches = self.scale.launches(buffers.errors);
        launches.push(kernels::clear_slots(
            &RunWindow { threads: stream.slots, ..RunWindow::zeroed() },
            buffers.slots.slice(0..stream.slots as usize),
        ));
        for band in buffers.film.bands() {
            launches.push(kernels::copy_counts(
                &CountParams { threads: band.film.len() as u32, ..CountParams::zeroed() },
                band.film.view(),
                self.counts.slice(band.ranks()),
            ));
        }
        launches.push(kernels::paper_begin(&self.parameters(stream, 0, 1), self.states.view()));
        launches.extend((0..STREAMS).flat_map(|number| self.append(buffers, stream, number)));
        launches
    }

    fn in_runs(&self) -> bool {
        false
    }

    fn filled(&self, executor: &E, _: &Stream) -> Result<u32, ExecError> {
        let end = STREAMS as usize;
        Ok(self.states.read_range(executor, end..end + 1)?[0].filled)
    }
}
