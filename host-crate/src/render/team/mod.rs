//! Several devices that make one render.
//!
//! One device, the render's own, has the film, estimates errors and makes streams. **Workers**
//! trace for it. Sums do not depend on who adds what first (see
//! [`raystream_shaders::math::fixed`]), so the film is that of one device alone, bit for bit, where
//! all are of one kind.
//!
//! - **Windows** of pixels, where no errors decide, need nothing but the numbers of their samples. A
//!   worker fills them, traces them and adds them to a film of its own, one after the other, and
//!   waits for nobody. Its sums are added to the render's film when somebody wants to look at that.
//!   Before, workers that can reach each other add up their films two and two, so that the render's
//!   device has one to add and not one for each.
//! - **Adaptive streams** are made on the render's device. Each worker is sent a part of the slots,
//!   in proportion to its speed, and sends the contributions back, for the next round's errors are
//!   those of them all. That is 24 bytes a slot to and fro, which may take longer than to trace it:
//!   so both ways are measured, and the faster one is taken.
//!
//! A worker that fails is left out from then on. What it was doing, and what it had not handed over,
//! the render's own device does again.

mod hand_over;
mod local;
mod member;
mod message;
mod remote;

pub use local::LocalWorker;
pub use remote::{Link, RemoteWorker, Way, serve};

use super::allocator::Stream;
use super::film::WINDOW_ALIGNMENT;
use crate::exec::ExecError;
use member::{Member, Task};
use raystream_shaders::film::Contribution;
use raystream_shaders::film::stream::Slot;
use raystream_shaders::film::sums::PixelSums;
use std::ops::Range;

/// Somebody who traces for a render, on another device or in another process.
pub trait Worker: Send {
    /// What to call it.
    fn name(&self) -> String;

    /// Slots of the longest stream that it can be given.
    fn capacity(&self) -> u32;

    /// Gets ready for the paths of a round: all until the next round's are of this one.
    ///
    /// # Errors
    /// If it fails; it is not called again after that, in this and in the others.
    fn begin_round(&mut self, number: u32) -> Result<(), ExecError>;

    /// Traces a window's samples and adds them to its own film.
    ///
    /// # Errors
    /// If it fails.
    fn sample(&mut self, window: &Stream) -> Result<(), ExecError>;

    /// The contributions of `slots`, one for each.
    ///
    /// # Errors
    /// If it fails.
    fn trace(&mut self, slots: &[Slot]) -> Result<Vec<Contribution>, ExecError>;

    /// The sums of its own film for a range of ranks, which are zero there from then on.
    ///
    /// # Errors
    /// If it fails.
    fn take_sums(&mut self, ranks: Range<u32>) -> Result<Vec<PixelSums>, ExecError>;

    /// Adds sums to its own film, from a rank on.
    ///
    /// # Errors
    /// If it fails.
    fn add_sums(&mut self, first: u32, sums: &[PixelSums]) -> Result<(), ExecError>;

    /// Where other workers of the render find it, if workers can send each other their films.
    fn peer(&self) -> Option<Peer> {
        None
    }

    /// Sends its film to another worker, which [takes](Self::take_film) it. Its own is zero from then
    /// on.
    ///
    /// # Errors
    /// If it fails, or has no way there.
    fn give_film(&mut self, _to: Peer, _transfer: FilmTransfer) -> Result<(), ExecError> {
        let reason = "it has no way to other workers".to_owned();
        Err(ExecError::Worker { name: self.name(), reason })
    }

    /// Adds another worker's film to its own.
    ///
    /// # Errors
    /// If it or the other one fails, or there is no way.
    fn take_film(&mut self, from: Peer, transfer: FilmTransfer) -> Result<(), ExecError> {
        self.give_film(from, transfer)
    }
}

/// Where a worker is found.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Peer {
    /// Number of its process.
    pub process: u32,
    /// Which of that process's workers it is.
    pub worker: u32,
}

/// A film that one worker gives and another one takes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct FilmTransfer {
    /// Pixels of the film.
    pub pixels: u32,
    /// The number of the transfer, which no other one has: what is left of one that failed is taken
    /// for no other.
    pub number: u32,
}

/// The workers of a render.
#[derive(Default)]
pub struct Team {
    members: Vec<Member>,
    /// Windows of workers that were lost before they handed them over.
    lost: Vec<Stream>,
    /// Parts of the stream likewise.
    lost_parts: Vec<Range<u32>>,
    /// Slots per second of the last adaptive stream that was not shared; 0 before one.
    alone: f64,
    /// Slots per second of the fastest one that was shared.
    shared: f64,
    /// Adaptive streams that were shared.
    shared_streams: u32,
}

/// Windows that a worker has at once: the next ones while it is at one, so that it waits for nobody.
const WINDOWS_AT_ONCE: usize = 4;
/// Windows that a worker may have in its film and not handed over: what is to be done again if it
/// is lost.
const KEPT_WINDOWS: usize = 1 << 12;
/// Adaptive streams that are shared to find out how fast that is: workers' speeds are those of the
/// streams before.
const TRIES: u32 = 4;
/// Speed of a worker's first part, as a share of that of the render's own device: much slower ones
/// do not hold it up for long, and the part is long enough to say how fast they are.
const FIRST_RATE: f64 = 1.0 / 16.0;

impl Team {
    /// Adds a worker.
    pub fn add(&mut self, worker: Box<dyn Worker>) {
        self.members.push(Member::new(worker));
    }

    /// Whether there is nobody.
    pub fn is_empty(&self) -> bool {
        self.members.is_empty()
    }

    /// Slots that all workers together work off in the time of a batch.
    pub fn batch_slots(&self) -> u32 {
        self.members.iter().map(|member| member.batch.slots()).fold(0, u32::saturating_add)
    }

    /// Slots of windows that are not handed over.
    pub fn slots_given(&self) -> u64 {
        let windows = self.members.iter().flat_map(|member| &member.windows).chain(&self.lost);
        windows.map(|window| u64::from(window.slots)).sum()
    }

    /// Whether some worker has so much in its film that it should be handed over.
    pub fn is_full(&self) -> bool {
        self.members.iter().any(|member| member.windows.len() >= KEPT_WINDOWS)
    }

    /// Has all workers get ready for a round.
    pub fn begin_round(&mut self, number: u32) {
        self.for_each(|member| member.send(Task::BeginRound(number)));
    }

    /// Gives windows to workers that have time; `next` makes one of at most so many slots. Returns
    /// how many slots were given.
    pub fn give(&mut self, mut next: impl FnMut(u32) -> Option<Stream>) -> u32 {
        let mut slots = 0;
        self.for_each(|member| {
            member.receive_what_is_there()?;
            while member.pending < WINDOWS_AT_ONCE {
                let Some(window) = next(member.batch.slots().min(member.capacity)) else { break };
                slots += window.slots;
                member.windows.push(window.clone());
                member.send(Task::Sample(window))?;
            }
            Ok(())
        });
        slots
    }

    /// Whether the next adaptive stream is to be shared.
    pub fn shares(&self) -> bool {
        let is_faster = self.shared_streams < TRIES || self.shared > self.alone;
        !self.is_empty() && self.alone > 0.0 && is_faster
    }

    /// Learns how many slots per second an adaptive stream went at.
    pub fn record_stream(&mut self, was_shared: bool, rate: f64) {
        if was_shared {
            self.shared = self.shared.max(rate);
            self.shared_streams += 1;
        } else {
            self.alone = rate;
        }
    }

    /// Cuts a stream of `slots` into parts in proportion to speeds, in slots per second: that of the
    /// render's own device, which has the speed `own`, and one for each worker. Where a worker's is
    /// not known, its part is one that says it.
    pub fn cut(&self, slots: u32, own: f64) -> Vec<Range<u32>> {
        let rate = |member: &Member| member.rate.unwrap_or(own * FIRST_RATE);
        let mut left: f64 = self.members.iter().map(rate).sum();
        let all = own + left;
        let place = |left: f64| (f64::from(slots) * (1.0 - left / all)) as u32;
        let aligned = |place: u32| place / WINDOW_ALIGNMENT * WINDOW_ALIGNMENT;
        // The render's own part is never empty.
        let first = aligned(place(left)).max(WINDOW_ALIGNMENT).min(slots);
        let mut parts = Vec::with_capacity(1 + self.members.len());
        parts.push(0..first);
        for (index, member) in self.members.iter().enumerate() {
            left -= rate(member);
            let is_last = index + 1 == self.members.len();
            let start = parts[index].end;
            let end = if is_last { slots } else { aligned(place(left)).max(start) };
            parts.push(start..end);
        }
        parts
    }

    /// Has worker number `index` trace a `part` of the stream, which has these `slots`.
    pub fn trace(&mut self, index: usize, part: Range<u32>, slots: Vec<Slot>) {
        if part.is_empty() {
            return;
        }
        let member = &mut self.members[index];
        member.part = Some(part);
        member.have_done(Task::Trace(slots));
    }

    /// Waits for what workers make of the parts that they were given to [trace](Self::trace); there
    /// is nothing of those that are lost.
    pub fn traced(&mut self) -> Vec<(Range<u32>, Option<Vec<Contribution>>)> {
        let mut traced = Vec::new();
        self.for_each(|member| {
            let Some(part) = member.part.clone() else { return Ok(()) };
            let contributions = member.traced()?;
            member.part = None;
            traced.push((part, Some(contributions)));
            Ok(())
        });
        let slots: usize = traced.iter().map(|(part, _)| part.len()).sum();
        tracing::debug!("workers traced {slots} slots of an adaptive stream");
        traced.extend(self.lost_parts.drain(..).map(|part| (part, None)));
        traced
    }

    /// Windows that are to be done again.
    pub fn take_lost(&mut self) -> Vec<Stream> {
        std::mem::take(&mut self.lost)
    }

    /// Calls `run` for every worker, and leaves out those that fail or have failed.
    fn for_each(&mut self, mut run: impl FnMut(&mut Member) -> Result<(), ExecError>) {
        let Self { members, lost, lost_parts, .. } = self;
        members.retain_mut(|member| {
            let result = match member.failed.take() {
                Some(error) => Err(error),
                None => run(member),
            };
            let Err(error) = result else { return true };
            tracing::warn!(
                "{} is lost: {error}. What it had not handed over is done again.",
                member.name
            );
            lost.append(&mut member.windows);
            lost_parts.extend(member.part.take());
            false
        });
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A worker that does nothing.
    struct Idle;

    impl Worker for Idle {
        fn name(&self) -> String {
            "idle".to_owned()
        }

        fn capacity(&self) -> u32 {
            1 << 22
        }

        fn begin_round(&mut self, _: u32) -> Result<(), ExecError> {
            Ok(())
        }

        fn sample(&mut self, _: &Stream) -> Result<(), ExecError> {
            Ok(())
        }

        fn trace(&mut self, slots: &[Slot]) -> Result<Vec<Contribution>, ExecError> {
            Ok(vec![Contribution::NOTHING; slots.len()])
        }

        fn take_sums(&mut self, ranks: Range<u32>) -> Result<Vec<PixelSums>, ExecError> {
            Ok(vec![PixelSums::default(); ranks.len()])
        }

        fn add_sums(&mut self, _: u32, _: &[PixelSums]) -> Result<(), ExecError> {
            Ok(())
        }
    }

    #[test]
    fn streams_are_cut_in_proportion_to_speed() {
        let mut team = Team::default();
        for rate in [1e6, 3e6, 2e6] {
            team.add(Box::new(Idle));
            team.members.last_mut().expect("it was added").rate = Some(rate);
        }
        for (slots, own) in [(8_000_000, 2e6), (1 << 22, 1e3), (1000, 2e6), (1, 1.0), (65, 1e9)] {
            let parts = team.cut(slots, own);
            assert_eq!(parts.len(), 4);
            assert!(parts[0].start == 0 && !parts[0].is_empty() && parts[3].end == slots);
            for pair in parts.windows(2) {
                assert_eq!(pair[0].end, pair[1].start, "no gaps: {parts:?}");
                assert!(pair[1].is_empty() || pair[1].start % WINDOW_ALIGNMENT == 0, "{parts:?}");
            }
        }
        let parts = team.cut(8_000_000, 2e6);
        let lengths = parts.iter().map(|part| part.len() as i64);
        for (length, expected) in lengths.zip([2_000_000, 1_000_000, 3_000_000, 2_000_000]) {
            assert!((length - expected).abs() <= 64, "{parts:?}");
        }
    }
}
