//! A worker in a thread of its own.

use super::{FilmTransfer, Peer, Worker};
use crate::clock::Instant;
use crate::exec::ExecError;
use crate::render::allocator::Stream;
use crate::render::round::batch::BatchSize;
use raystream_shaders::film::Contribution;
use raystream_shaders::film::stream::Slot;
use raystream_shaders::film::sums::PixelSums;
use std::ops::Range;
use std::sync::mpsc::{Receiver, Sender, TryRecvError, channel};
use std::thread;
use std::time::Duration;

/// What a worker is told to do. Each task has one answer, in the same order.
pub(super) enum Task {
    BeginRound(u32),
    Sample(Stream),
    Trace(Vec<Slot>),
    TakeSums(Range<u32>),
    AddSums(u32, Vec<PixelSums>),
    GiveFilm(Peer, FilmTransfer),
    TakeFilm(Peer, FilmTransfer),
}

/// What came of it.
pub(super) enum Answer {
    Done,
    Traced(Vec<Contribution>),
    Sums(Vec<PixelSums>),
}

/// What comes back of a task: the answer, and how many slots took how long.
type Result<T> = std::result::Result<T, ExecError>;

/// A worker as the render sees it.
pub(super) struct Member {
    pub name: String,
    pub capacity: u32,
    pub peer: Option<Peer>,
    pub batch: BatchSize,
    /// Windows under way and in its film.
    pub windows: Vec<Stream>,
    /// The part of the stream that it traces.
    pub part: Option<Range<u32>>,
    /// Slots of such parts per second, the way to the worker and back included, once that is known.
    pub rate: Option<f64>,
    /// Tasks without an answer.
    pub pending: usize,
    /// Why it is to be left out.
    pub failed: Option<ExecError>,
    tasks: Sender<Task>,
    answers: Receiver<Result<(Answer, u32, Duration)>>,
}

impl Member {
    /// Starts its thread, which ends with the member or when the worker fails.
    pub fn new(mut worker: Box<dyn Worker>) -> Self {
        let (name, capacity, peer) = (worker.name(), worker.capacity(), worker.peer());
        let (tasks, inbox) = channel();
        let (outbox, answers) = channel();
        thread::spawn(move || {
            for task in inbox {
                let answer = work(worker.as_mut(), task);
                let has_failed = answer.is_err();
                if outbox.send(answer).is_err() || has_failed {
                    break;
                }
            }
        });
        let batch = BatchSize::new(capacity);
        Self {
            name,
            capacity,
            peer,
            batch,
            windows: Vec::new(),
            part: None,
            rate: None,
            pending: 0,
            failed: None,
            tasks,
            answers,
        }
    }

    /// Gives it a task. That it is gone is said by the answer that does not come.
    pub fn send(&mut self, task: Task) -> Result<()> {
        self.pending += 1;
        self.tasks.send(task).map_err(|_| self.is_gone())
    }

    /// Gives it a task; if it is gone, it is to be left out.
    pub fn have_done(&mut self, task: Task) {
        if let Err(error) = self.send(task) {
            self.failed = Some(error);
        }
    }

    /// Waits until it has done all its tasks. Returns whether it has; else it is to be left out.
    pub fn finish(&mut self) -> bool {
        if self.failed.is_none() {
            self.failed = self.wait().err();
        }
        self.failed.is_none()
    }

    /// Has it be left out, if it is not to be already.
    pub fn give_up(&mut self, reason: &str) {
        let (name, reason) = (self.name.clone(), reason.to_owned());
        self.failed.get_or_insert(ExecError::Worker { name, reason });
    }

    /// Receives the answers that are there.
    pub fn receive_what_is_there(&mut self) -> Result<()> {
        loop {
            match self.answers.try_recv() {
                Ok(answer) => {
                    self.record(answer?);
                }
                Err(TryRecvError::Empty) => return Ok(()),
                Err(TryRecvError::Disconnected) => return Err(self.is_gone()),
            }
        }
    }

    /// Waits until it has done all its tasks.
    pub fn wait(&mut self) -> Result<()> {
        if self.pending > 0 {
            self.answer()?;
        }
        Ok(())
    }

    /// Waits for the answer to the last task.
    pub fn answer(&mut self) -> Result<Answer> {
        loop {
            let answer = self.answers.recv().map_err(|_| self.is_gone())??;
            let answer = self.record(answer);
            if self.pending == 0 {
                return Ok(answer);
            }
        }
    }

    /// Waits for it, and takes sums out of its film.
    pub fn take_sums(&mut self, ranks: Range<u32>) -> Result<Vec<PixelSums>> {
        self.send(Task::TakeSums(ranks))?;
        match self.answer()? {
            Answer::Sums(sums) => Ok(sums),
            _ => Err(self.is_gone()),
        }
    }

    /// Waits for what it makes of a part of the stream.
    pub fn traced(&mut self) -> Result<Vec<Contribution>> {
        match self.answer()? {
            Answer::Traced(contributions) => Ok(contributions),
            _ => Err(self.is_gone()),
        }
    }

    fn record(&mut self, (answer, slots, elapsed): (Answer, u32, Duration)) -> Answer {
        self.pending -= 1;
        if let Answer::Traced(_) = answer {
            self.rate = Some(f64::from(slots) / elapsed.as_secs_f64().max(1e-9));
        } else if slots > 0 {
            tracing::trace!("{}: {slots} slots of a window in {elapsed:.1?}", self.name);
            self.batch.record(slots, elapsed);
        }
        answer
    }

    fn is_gone(&self) -> ExecError {
        ExecError::Worker { name: self.name.clone(), reason: "it has ended".to_owned() }
    }
}

/// Does a task. Returns the answer, and how many slots took how long.
pub(super) fn work(worker: &mut dyn Worker, task: Task) -> Result<(Answer, u32, Duration)> {
    let start = Instant::now();
    let (answer, slots) = match task {
        Task::BeginRound(number) => worker.begin_round(number).map(|()| (Answer::Done, 0))?,
        Task::Sample(window) => {
            worker.sample(&window)?;
            (Answer::Done, window.slots)
        }
        Task::Trace(slots) => (Answer::Traced(worker.trace(&slots)?), slots.len() as u32),
        Task::TakeSums(ranks) => (Answer::Sums(worker.take_sums(ranks)?), 0),
        Task::AddSums(first, sums) => {
            worker.add_sums(first, &sums)?;
            (Answer::Done, 0)
        }
        Task::GiveFilm(to, transfer) => {
            worker.give_film(to, transfer)?;
            (Answer::Done, 0)
        }
        Task::TakeFilm(from, transfer) => {
            worker.take_film(from, transfer)?;
            (Answer::Done, 0)
        }
    };
    Ok((answer, slots, start.elapsed()))
}
