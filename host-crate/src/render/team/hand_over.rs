//! How workers' films come into the render's.

use super::member::Task;
use super::{FilmTransfer, Team};
use crate::clock::Instant;
use crate::exec::ExecError;
use raystream_shaders::film::sums::PixelSums;
use std::ops::Range;
use std::sync::atomic::{AtomicU32, Ordering};

/// Pixels that are handed over at once.
const PIXELS_AT_ONCE: u32 = 1 << 18;

/// Films that workers have given each other, in all renders of the process.
static TRANSFERS: AtomicU32 = AtomicU32::new(0);

impl Team {
    /// Waits for all workers and takes over what is in their films: `add` is given a range of ranks
    /// and its sums. Of those that are lost, [`Self::take_lost`] has what is to be done again.
    ///
    /// # Errors
    /// Those of `add`.
    pub fn hand_over(
        &mut self,
        pixels: u32,
        mut add: impl FnMut(Range<u32>, &[PixelSums]) -> Result<(), ExecError>,
    ) -> Result<(), ExecError> {
        self.add_up(pixels);
        let mut result = Ok(());
        self.for_each(|member| {
            if member.windows.is_empty() {
                return Ok(());
            }
            let start = Instant::now();
            member.wait()?;
            let waited = start.elapsed();
            // All of it is here before any of it is added: a worker is lost as a whole or not.
            let sums: Vec<_> = pieces(pixels)
                .map(|ranks| Ok((ranks.clone(), member.take_sums(ranks)?)))
                .collect::<Result<_, ExecError>>()?;
            let read = start.elapsed();
            for (ranks, sums) in sums {
                if result.is_ok() {
                    result = add(ranks, &sums);
                }
            }
            let (windows, name, all) = (member.windows.len(), &member.name, start.elapsed());
            tracing::debug!(
                "{name} handed over {windows} windows: waited {waited:.1?}, read {:.1?}, added {:.1?}",
                read - waited,
                all - read
            );
            member.windows.clear();
            Ok(())
        });
        result
    }

    /// Has workers that can reach each other add up their films, two and two at the same time, until
    /// one of them has all. If one of two fails, what both had is to be done again.
    fn add_up(&mut self, pixels: u32) {
        let start = Instant::now();
        for step in 1.. {
            let members = self.members.iter().enumerate();
            let ready = members.filter(|(_, member)| !member.windows.is_empty());
            let ready: Vec<_> =
                ready.filter_map(|(index, member)| Some((index, member.peer?))).collect();
            let pairs = ready.as_chunks::<2>().0;
            if pairs.is_empty() {
                return;
            }
            for &[(taker, to), (giver, from)] in pairs {
                let number = TRANSFERS.fetch_add(1, Ordering::Relaxed);
                let transfer = FilmTransfer { pixels, number };
                self.members[giver].have_done(Task::GiveFilm(to, transfer));
                self.members[taker].have_done(Task::TakeFilm(from, transfer));
            }
            for &[(taker, _), (giver, _)] in pairs {
                let gave = self.members[giver].finish();
                let windows = std::mem::take(&mut self.members[giver].windows);
                self.members[taker].windows.extend(windows);
                if !self.members[taker].finish() || !gave {
                    self.members[taker].give_up("it has not all of another worker's film");
                }
            }
            self.for_each(|_| Ok(()));
            let (count, elapsed) = (pairs.len(), start.elapsed());
            tracing::debug!("step {step}: {count} workers gave others their films, {elapsed:.1?}");
        }
    }
}

/// The ranges of ranks that are handed over at once.
pub(super) fn pieces(pixels: u32) -> impl Iterator<Item = Range<u32>> {
    let starts = (0..pixels).step_by(PIXELS_AT_ONCE as usize);
    starts.map(move |start| start..pixels.min(start + PIXELS_AT_ONCE))
}
