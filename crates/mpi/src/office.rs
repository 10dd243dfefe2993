//! The one thread of a process that calls MPI.
//!
//! It sends what it is given, takes in what comes, and waits for neither: a process that is gone
//! keeps nobody waiting. MPI itself does not say that one is gone. So all say every second that
//! they are there, the helpers to the first process and that to them, and who has said nothing for
//! a while is lost.

use crate::post::{Address, Inboxes, Mail, Post};
use crate::transfer::Transfer;
use mpi::point_to_point::Source;
use mpi::topology::{Communicator, SimpleCommunicator};
use mpi::traits::AsRaw;
use mpi::{Rank, ffi};
use std::collections::HashMap;
use std::sync::mpsc::{Receiver, RecvTimeoutError, channel};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

/// Between two looks at what has come, where nothing is to be sent. A window of samples takes a
/// tenth of a second.
const PATIENCE: Duration = Duration::from_micros(250);
/// Between two signs of life.
const BEAT: Duration = Duration::from_secs(1);
/// Who has said nothing for so long is lost.
const SILENCE: Duration = Duration::from_secs(20);
/// The last messages have so long to arrive.
const LAST_MESSAGES: Duration = Duration::from_secs(5);
/// What the first process says at the end: all finalize MPI together.
const GOODBYE: &[u8] = b"goodbye";
/// The same, if not all are left: nobody can finalize it.
const LEAVE: &[u8] = b"leave";
/// What the first process says of one that is lost, before its number: helpers may wait for it.
const LOST: &[u8] = b"lost";

/// How the office closed.
pub enum Closed {
    /// All have ended.
    Together(u8),
    /// Somebody is lost, whom MPI would wait for at the end.
    WithoutSome(u8),
    /// The first process is lost.
    Abandoned,
}

/// Sends and receives for all threads of the process.
pub struct Office {
    world: SimpleCommunicator,
    rank: Rank,
    mail: Receiver<Mail>,
    inboxes: Arc<Mutex<Inboxes>>,
    sending: Vec<Transfer>,
    receiving: Vec<Transfer>,
    /// When something was last heard, of each process that this one listens to.
    heard: HashMap<Rank, Instant>,
    beaten: Instant,
    /// The last word of the first process.
    last_word: Option<Vec<u8>>,
}

impl Office {
    /// An office, the way to it, and where greetings arrive.
    pub fn open(world: SimpleCommunicator) -> (Self, Post, Receiver<crate::post::Greeting>) {
        // SAFETY: the communicator is there, and the handler is one of MPI's own. By default what
        // cannot be sent to one process ends all of them.
        unsafe { ffi::MPI_Comm_set_errhandler(world.as_raw(), ffi::RSMPI_ERRORS_RETURN) };
        let (rank, size) = (world.rank(), world.size());
        let (sender, mail) = channel();
        let (greetings, greeted) = channel();
        let inboxes = Arc::new(Mutex::new(Inboxes::new(greetings)));
        let post = Post::new(rank, size, sender, Arc::clone(&inboxes));
        let now = Instant::now();
        let others = if rank == 0 { 1..size } else { 0..1 };
        let office = Self {
            world,
            rank,
            mail,
            inboxes,
            sending: Vec::new(),
            receiving: Vec::new(),
            heard: others.map(|other| (other, now)).collect(),
            beaten: now,
            last_word: None,
        };
        (office, post, greeted)
    }

    /// Works until the program of the first process has ended.
    pub fn work(&mut self) -> Closed {
        loop {
            let patience = if self.is_busy() { Duration::ZERO } else { PATIENCE };
            std::thread::yield_now();
            match self.mail.recv_timeout(patience) {
                Ok(Mail::Message(to, bytes)) => self.send(to, bytes),
                Ok(Mail::Close(status)) if self.rank == 0 => return self.close(status),
                // A helper stays until the first process lets it go.
                Ok(Mail::Close(_)) | Err(RecvTimeoutError::Timeout) => (),
                // The threads that had it are gone, and the office is the last.
                Err(RecvTimeoutError::Disconnected) => std::thread::sleep(PATIENCE),
            }
            self.progress();
            match self.last_word.as_deref() {
                Some(GOODBYE) => return Closed::Together(0),
                Some(_) => return Closed::WithoutSome(0),
                None if self.rank > 0 && self.heard.is_empty() => return Closed::Abandoned,
                None => (),
            }
        }
    }

    /// Whether messages are under way, which MPI moves on only while it is called.
    fn is_busy(&self) -> bool {
        !self.sending.is_empty() || !self.receiving.is_empty()
    }

    fn inboxes(&self) -> MutexGuard<'_, Inboxes> {
        self.inboxes.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn send(&mut self, to: Address, bytes: Vec<u8>) {
        if !self.inboxes().lost.contains(&to.rank) {
            self.sending.push(Transfer::send(&self.world, to, bytes));
        }
    }

    /// Moves everything on as far as it goes.
    fn progress(&mut self) {
        while let Some((message, status)) = self.world.any_process().immediate_matched_probe() {
            self.receiving.push(Transfer::receive(message, &status));
        }
        for transfer in std::mem::take(&mut self.receiving) {
            let from = transfer.with;
            match transfer.completed() {
                Ok(bytes) => self.received(from, bytes),
                Err(transfer) => self.receiving.push(transfer),
            }
        }
        let sending = std::mem::take(&mut self.sending).into_iter();
        self.sending = sending.filter_map(|transfer| transfer.completed().err()).collect();
        if self.beaten.elapsed() >= BEAT {
            self.beaten = Instant::now();
            self.lose_the_silent();
            for rank in self.heard.keys().copied().collect::<Vec<_>>() {
                self.send(Address::process(rank), Vec::new());
            }
        }
    }

    fn received(&mut self, from: Address, bytes: Vec<u8>) {
        if let Some(heard) = self.heard.get_mut(&from.rank) {
            *heard = Instant::now();
        }
        if self.rank > 0 && from.worker == 0 && (bytes == GOODBYE || bytes == LEAVE) {
            self.last_word = Some(bytes);
        } else if self.rank > 0 && from.worker == 0 && bytes.starts_with(LOST) {
            let rank = bytes[LOST.len()..].try_into().map(Rank::from_ne_bytes);
            let _ = rank.map(|rank| self.lose(rank));
        } else if !(from.worker == 0 && bytes.is_empty()) {
            self.inboxes().deliver(from, bytes);
        }
    }

    fn lose_the_silent(&mut self) {
        let is_silent = |heard: &Instant| heard.elapsed() >= SILENCE;
        let silent = self.heard.iter().filter(|(_, heard)| is_silent(heard));
        for rank in silent.map(|(&rank, _)| rank).collect::<Vec<_>>() {
            self.lose(rank);
            for other in self.heard.keys().copied().collect::<Vec<_>>() {
                let word = [LOST, &rank.to_ne_bytes()[..]].concat();
                self.send(Address::process(other), word);
            }
        }
    }

    /// Gives a process up, and what is under way to it and from it.
    fn lose(&mut self, rank: Rank) {
        self.heard.remove(&rank);
        let reason = format!("it has said nothing for {} s", SILENCE.as_secs());
        self.inboxes().lose(rank, &reason);
        for transfers in [&mut self.sending, &mut self.receiving] {
            for transfer in std::mem::take(transfers) {
                match transfer {
                    transfer if transfer.with.rank == rank => transfer.give_up(),
                    transfer => transfers.push(transfer),
                }
            }
        }
    }

    /// Lets all others go.
    fn close(&mut self, status: u8) -> Closed {
        let are_all_here = self.heard.len() + 1 == self.world.size() as usize;
        let word = if are_all_here { GOODBYE } else { LEAVE };
        for rank in self.heard.keys().copied().collect::<Vec<_>>() {
            self.send(Address::process(rank), word.to_owned());
        }
        let start = Instant::now();
        while !self.sending.is_empty() && start.elapsed() < LAST_MESSAGES {
            self.progress();
            std::thread::yield_now();
        }
        if are_all_here && self.sending.is_empty() {
            Closed::Together(status)
        } else {
            Closed::WithoutSome(status)
        }
    }
}

impl Drop for Office {
    fn drop(&mut self) {
        let transfers = self.sending.drain(..).chain(self.receiving.drain(..));
        transfers.for_each(Transfer::give_up);
    }
}
