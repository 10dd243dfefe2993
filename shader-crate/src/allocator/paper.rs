//! The allocator `paper`: streams of pixels whose error exceeds random thresholds, as Podee et al.
//! make them ("Efficient Adaptive GPU Path Tracing", section 3.3).
//!
//! A pixel enters a stream if its error exceeds a random number in `[0, r)`; stream compaction puts
//! those that do close together. Streams are appended until the round is full, and `r` is found by
//! bisection on the way. Where the paper's text is open: a stream that would overshoot is dropped
//! and `r` raised, one that fits is kept and `r` lowered; after [`BISECTIONS`] streams one more, at
//! the lower end of the bisection, is thinned evenly to what is left, and should too few pixels
//! want to be in that, then one of all pixels. What these cannot fill either (a stream has no more
//! slots than there are pixels) stays empty.
//!
//! All in integers (see [`crate::allocator::error_scale`]), all decided on the device.

use crate::allocator::error_scale::{BlockErrors, is_live, magnitude, quantised};
use crate::film::stream::{Slot, sample_number};
use crate::math::random::hash;
use crate::math::wide::{Wide, divide, multiply};
use crate::memory::access::{Scatter, at};
use crate::memory::device_struct;

/// Streams of a round before the thinned ones.
pub const BISECTIONS: u32 = 32;
/// Streams of a round.
pub const STREAMS: u32 = BISECTIONS + 2;

device_struct! {
    /// The parameters of one step: of one stream. 32 bytes.
    pub struct PaperParams {
        /// Lanes of the launch.
        pub threads: u32,
        /// Pixels of the picture.
        pub pixels: u32,
        /// Blocks of pixels.
        pub blocks: u32,
        /// Slots of the round.
        pub slots: u32,
        /// Number of the stream, below [`STREAMS`].
        pub stream: u32,
        /// A random number, other for every stream.
        pub salt: u32,
        /// Which half samples are of: [`FIRST`](crate::film::stream::FIRST), or
        /// [`BY_TURNS`](crate::film::stream::BY_TURNS).
        pub half: u32,
        /// Unused; zero.
        pub pad: u32,
    }
}

device_struct! {
    /// The bisection before each stream, and after the last. 32 bytes.
    pub struct PaperState {
        /// Random numbers lie below this, in units of [`quantised`].
        pub range: u32,
        /// At this range streams were too long.
        pub low: u32,
        /// At this one they fitted.
        pub high: u32,
        /// Slots filled by the streams before.
        pub filled: u32,
        /// Slots of this stream, decided when its length is known.
        pub taken: u32,
        /// Pixels that wanted to be in it.
        pub wanted: u32,
        /// Unused; zero.
        pub pad0: u32,
        /// Unused; zero.
        pub pad1: u32,
    }
}

/// Kernel, one lane: the bisection at its beginning: in the middle of twice the largest error.
pub fn paper_begin(lane: u32, _: &PaperParams, states: &mut Scatter<'_, PaperState>) {
    let high = u32::MAX;
    let state = PaperState {
        range: high / 2 + 1,
        low: 0,
        high,
        filled: 0,
        taken: 0,
        wanted: 0,
        pad0: 0,
        pad1: 0,
    };
    states.set(lane, state);
}

/// Kernel: whether pixel `lane` wants to be in the stream; 1 or 0.
pub fn paper_select(
    lane: u32,
    params: &PaperParams,
    errors: &[f32],
    totals: &[BlockErrors],
    states: &[PaperState],
    keep: &mut u32,
) {
    let all = at(totals, params.blocks);
    let error = at(errors, lane);
    let state = at(states, params.stream);
    if state.filled == params.slots {
        *keep = 0;
    } else if all.exponent == 0 || params.stream == STREAMS - 1 {
        // Nothing is known of any pixel, or too few want samples: all alike.
        *keep = (is_live(error) || all.live == 0) as u32;
    } else {
        let random = multiply(hash(lane ^ hash(params.salt)), state.range).high;
        *keep = (quantised(magnitude(error), all.exponent) > random) as u32;
    }
}

/// Kernel, one lane: decides about the stream, whose length is the last of `offsets`, and about the
/// range of the next.
pub fn paper_decide(
    _: u32,
    params: &PaperParams,
    offsets: &[u32],
    states: &mut Scatter<'_, PaperState>,
) {
    let mut state = states.get(params.stream);
    let room = params.slots - state.filled;
    state.wanted = at(offsets, params.blocks);
    let is_thinned = params.stream >= BISECTIONS;
    state.taken = if is_thinned || state.wanted <= room { state.wanted.min(room) } else { 0 };
    states.set(params.stream, state);
    if state.wanted <= room {
        state.high = state.range;
    } else {
        state.low = state.range;
    }
    state.filled += state.taken;
    state.range = state.low + (state.high - state.low) / 2;
    if params.stream + 1 == BISECTIONS {
        state.range = state.low;
    }
    state.taken = 0;
    states.set(params.stream + 1, state);
}

/// Kernel: appends the pixel number `lane` of those that wanted to be in the stream. `counts` are
/// the samples of each pixel, those of earlier streams included.
pub fn paper_append(
    lane: u32,
    params: &PaperParams,
    states: &[PaperState],
    kept: &[u32],
    counts: &mut Scatter<'_, u32>,
    slots: &mut Scatter<'_, Slot>,
) {
    let state = at(states, params.stream);
    if lane >= state.wanted || state.taken == 0 {
        return;
    }
    // Of all that wanted to be in, every so-manieth from a random one on: all of them, unless the
    // stream is thinned.
    let offset = multiply(hash(!params.salt), state.wanted).high;
    let before = |count| {
        divide(multiply(count, state.taken).plus(Wide { high: 0, low: offset }), state.wanted)
    };
    let place = before(lane);
    if before(lane + 1) > place {
        let rank = at(kept, lane);
        let count = counts.get(rank);
        counts.set(rank, count + 1);
        let sample = sample_number(params.half, count);
        slots.set(state.filled + place, Slot { rank, sample });
    }
}
