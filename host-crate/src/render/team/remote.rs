//! A worker in another process.
//!
//! Both sides speak over a [`Link`]: here is a [`RemoteWorker`], there [`serve`] has a worker do
//! what it is told. Each order has one answer, so that at most one message is under way.

use super::hand_over::pieces;
use super::member::{Answer, Task, work};
use super::message::{Order, Report, read_order, read_report, write_order, write_report};
use super::{FilmTransfer, Peer, Stream, Worker};
use crate::clock::Instant;
use crate::exec::ExecError;
use raystream_shaders::film::Contribution;
use raystream_shaders::film::stream::Slot;
use raystream_shaders::film::sums::PixelSums;
use std::ops::Range;

/// A way to another process, on which messages arrive whole and in order. Both processes are of one
/// build: bytes are as they lie in memory.
pub trait Link: Send {
    /// Sends a message; that it has arrived is not said.
    ///
    /// # Errors
    /// Why the other side cannot be reached any more, as far as that is known.
    fn send(&mut self, message: Vec<u8>) -> Result<(), String>;

    /// Waits for a message.
    ///
    /// # Errors
    /// Why none will come any more, as far as that is known.
    fn receive(&mut self) -> Result<Vec<u8>, String>;
}

/// A worker at the other end of a link.
pub struct RemoteWorker<L: Link> {
    link: L,
    name: String,
    capacity: u32,
    peer: Option<Peer>,
}

impl<L: Link> RemoteWorker<L> {
    /// The worker that [`serve`] has at the other end, of this [name](Worker::name) and
    /// [capacity](Worker::capacity).
    pub fn new(link: L, name: String, capacity: u32) -> Self {
        Self { link, name, capacity, peer: None }
    }

    /// The same, where other workers find it.
    pub fn with_peer(mut self, peer: Peer) -> Self {
        self.peer = Some(peer);
        self
    }

    fn ask(&mut self, task: Task) -> Result<Answer, ExecError> {
        let start = Instant::now();
        let order = write_order(&Order::Do(task));
        let there = order.len();
        let sent = self.link.send(order);
        let answer = sent.and_then(|()| self.link.receive()).and_then(|bytes| {
            let (name, back, time) = (&self.name, bytes.len(), start.elapsed());
            tracing::trace!("{name}: {there} bytes there, {back} back, {time:.1?}");
            read_report(&bytes).unwrap_or_else(|| Err("it sent what is no answer".to_owned()))
        });
        answer.map_err(|reason| self.error(reason))
    }

    fn error(&self, reason: String) -> ExecError {
        ExecError::Worker { name: self.name.clone(), reason }
    }

    fn other_answer(&self) -> ExecError {
        self.error("it answered something else".to_owned())
    }

    fn have_done(&mut self, task: Task) -> Result<(), ExecError> {
        match self.ask(task)? {
            Answer::Done => Ok(()),
            _ => Err(self.other_answer()),
        }
    }
}

impl<L: Link> Worker for RemoteWorker<L> {
    fn name(&self) -> String {
        self.name.clone()
    }

    fn capacity(&self) -> u32 {
        self.capacity
    }

    fn begin_round(&mut self, number: u32) -> Result<(), ExecError> {
        self.have_done(Task::BeginRound(number))
    }

    fn sample(&mut self, window: &Stream) -> Result<(), ExecError> {
        self.have_done(Task::Sample(window.clone()))
    }

    fn trace(&mut self, slots: &[Slot]) -> Result<Vec<Contribution>, ExecError> {
        match self.ask(Task::Trace(slots.to_vec()))? {
            Answer::Traced(all) if all.len() == slots.len() => Ok(all),
            _ => Err(self.other_answer()),
        }
    }

    fn take_sums(&mut self, ranks: Range<u32>) -> Result<Vec<PixelSums>, ExecError> {
        match self.ask(Task::TakeSums(ranks.clone()))? {
            Answer::Sums(sums) if sums.len() == ranks.len() => Ok(sums),
            _ => Err(self.other_answer()),
        }
    }

    fn add_sums(&mut self, first: u32, sums: &[PixelSums]) -> Result<(), ExecError> {
        self.have_done(Task::AddSums(first, sums.to_vec()))
    }

    fn peer(&self) -> Option<Peer> {
        self.peer
    }

    fn give_film(&mut self, to: Peer, transfer: FilmTransfer) -> Result<(), ExecError> {
        self.have_done(Task::GiveFilm(to, transfer))
    }

    fn take_film(&mut self, from: Peer, transfer: FilmTransfer) -> Result<(), ExecError> {
        self.have_done(Task::TakeFilm(from, transfer))
    }
}

impl<L: Link> Drop for RemoteWorker<L> {
    /// Lets the other side go.
    fn drop(&mut self) {
        // Nobody may be there any more.
        let _ = self.link.send(write_order(&Order::End));
    }
}

/// A way between two workers, seen from one of them.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Way {
    /// The other one is given a film.
    To(Peer),
    /// The other one gives a film.
    From(Peer),
}

/// Has `worker` do what the [`RemoteWorker`] at the other end of the link asks for, until that is
/// dropped. If the worker fails, the other side is told, and does without it. `connect` opens links
/// to other workers, for those that have a [peer](RemoteWorker::with_peer).
///
/// # Errors
/// If the link fails, or brings what is no order.
pub fn serve(
    worker: &mut dyn Worker,
    link: &mut dyn Link,
    connect: &dyn Fn(Way) -> Box<dyn Link>,
) -> Result<(), String> {
    loop {
        let order = read_order(&link.receive()?).ok_or("an order that cannot be read")?;
        let report = match order {
            Order::End => return Ok(()),
            Order::Do(Task::GiveFilm(to, transfer)) => {
                give_film(worker, connect(Way::To(to)).as_mut(), transfer).map(|()| Answer::Done)
            }
            Order::Do(Task::TakeFilm(from, transfer)) => {
                take_film(worker, connect(Way::From(from)).as_mut(), transfer)
                    .map(|()| Answer::Done)
            }
            Order::Do(task) => {
                let done = work(worker, task).map(|(answer, ..)| answer);
                done.map_err(|error| error.to_string())
            }
        };
        link.send(write_report(&report))?;
    }
}

/// Sends a worker's film over `link`, or that it cannot be had.
fn give_film(
    worker: &mut dyn Worker,
    link: &mut dyn Link,
    FilmTransfer { pixels, number }: FilmTransfer,
) -> Result<(), String> {
    for ranks in pieces(pixels) {
        let report = worker.take_sums(ranks).map(Answer::Sums).map_err(|error| error.to_string());
        link.send([&number.to_ne_bytes()[..], &write_report(&report)].concat())?;
        report?;
    }
    Ok(())
}

/// Adds the film that comes over `link` to that of a worker.
fn take_film(
    worker: &mut dyn Worker,
    link: &mut dyn Link,
    FilmTransfer { pixels, number }: FilmTransfer,
) -> Result<(), String> {
    for ranks in pieces(pixels) {
        match receive_of(link, number)? {
            Some(Ok(Answer::Sums(sums))) if sums.len() == ranks.len() => {
                worker.add_sums(ranks.start, &sums).map_err(|error| error.to_string())?;
            }
            Some(Err(reason)) => return Err(reason),
            _ => return Err("another worker sent what is no film".to_owned()),
        }
    }
    Ok(())
}

/// The next report of a transfer. What is there of others, which have failed, is left out.
fn receive_of(link: &mut dyn Link, number: u32) -> Result<Option<Report>, String> {
    loop {
        let message = link.receive()?;
        let Some((own, report)) = message.split_first_chunk() else { return Ok(None) };
        if u32::from_ne_bytes(*own) == number {
            return Ok(read_report(report));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::VecDeque;

    /// A link that brings what it is sent.
    #[derive(Default)]
    struct Loop(VecDeque<Vec<u8>>);

    impl Link for Loop {
        fn send(&mut self, message: Vec<u8>) -> Result<(), String> {
            self.0.push_back(message);
            Ok(())
        }

        fn receive(&mut self) -> Result<Vec<u8>, String> {
            self.0.pop_front().ok_or_else(|| "nothing is left".to_owned())
        }
    }

    /// A film of two pixels.
    struct Two([u32; 2]);

    impl Worker for Two {
        fn name(&self) -> String {
            "two pixels".to_owned()
        }

        fn capacity(&self) -> u32 {
            64
        }

        fn begin_round(&mut self, _: u32) -> Result<(), ExecError> {
            Ok(())
        }

        fn sample(&mut self, _: &Stream) -> Result<(), ExecError> {
            Ok(())
        }

        fn trace(&mut self, _: &[Slot]) -> Result<Vec<Contribution>, ExecError> {
            Ok(Vec::new())
        }

        fn take_sums(&mut self, _: Range<u32>) -> Result<Vec<PixelSums>, ExecError> {
            let counts = std::mem::take(&mut self.0);
            let sums = |rays| PixelSums { rays, ..PixelSums::default() };
            Ok(counts.map(sums).to_vec())
        }

        fn add_sums(&mut self, _: u32, sums: &[PixelSums]) -> Result<(), ExecError> {
            self.0.iter_mut().zip(sums).for_each(|(own, sums)| *own += sums.rays);
            Ok(())
        }
    }

    #[test]
    fn what_a_failed_transfer_left_is_taken_for_no_other() {
        let mut link = Loop::default();
        let transfer = |number| FilmTransfer { pixels: 2, number };
        give_film(&mut Two([100, 100]), &mut link, transfer(7)).unwrap();
        let mut giver = Two([1, 2]);
        give_film(&mut giver, &mut link, transfer(8)).unwrap();
        let mut taker = Two([10, 20]);
        take_film(&mut taker, &mut link, transfer(8)).unwrap();
        assert_eq!((giver.0, taker.0), ([0, 0], [11, 22]));
        assert!(take_film(&mut taker, &mut link, transfer(9)).is_err());
    }
}
