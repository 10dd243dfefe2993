//! How the threads of a process send messages to other processes and get theirs.

use mpi::{Rank, Tag};
use raystream::render::Link;
use std::collections::{HashMap, HashSet};
use std::sync::mpsc::{Receiver, RecvError, SendError, Sender};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

/// Workers of a process, at most: MPI promises tags up to 2^15.
pub const MOST_WORKERS: usize = 100;

/// Who is at the other end: a process, and which of its workers.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Address {
    /// Number of the process.
    pub rank: Rank,
    /// 0 for the process itself; else which worker it is, or which two are connected.
    pub worker: Tag,
}

impl Address {
    /// The process itself.
    pub fn process(rank: Rank) -> Self {
        Self { rank, worker: 0 }
    }

    /// A worker, as the first process and its own see it.
    pub fn worker(rank: Rank, index: usize) -> Self {
        Self { rank, worker: 1 + index as Tag }
    }

    /// The way between two processes' workers of these numbers, seen from one of them: `process` is
    /// the other one.
    pub fn between(process: u32, giver: usize, taker: usize) -> Self {
        let pair = (1 + giver) * (MOST_WORKERS + 1) + taker;
        Self { rank: process as Rank, worker: pair as Tag }
    }
}

/// What the office is asked for.
pub enum Mail {
    /// To send a message.
    Message(Address, Vec<u8>),
    /// To close: the program has ended with this status.
    Close(u8),
}

/// What a process has to say of itself, or why nothing comes of it.
pub type Greeting = (Rank, Result<Vec<u8>, String>);

/// Where the messages of a link go, and who reads them there if nobody has opened it yet.
type Inbox = (Sender<Vec<u8>>, Option<Receiver<Vec<u8>>>);

/// Where messages that come in go.
pub struct Inboxes {
    /// Of links, with what nobody has opened yet.
    pub links: HashMap<Address, Inbox>,
    /// Of greetings.
    pub greetings: Sender<Greeting>,
    /// Processes that are lost, and from which nothing more is taken.
    pub lost: HashSet<Rank>,
}

impl Inboxes {
    /// None yet but the one of greetings.
    pub fn new(greetings: Sender<Greeting>) -> Self {
        Self { links: HashMap::new(), greetings, lost: HashSet::new() }
    }

    /// Puts a message where it belongs, and keeps it if nobody has opened that yet.
    pub fn deliver(&mut self, from: Address, bytes: Vec<u8>) {
        if self.lost.contains(&from.rank) {
            return;
        }
        // A receiver that is gone needs it no more.
        if from.worker == 0 {
            let _ = self.greetings.send((from.rank, Ok(bytes)));
        } else {
            let (sender, _) = self.links.entry(from).or_insert_with(new_inbox);
            if let Err(SendError(bytes)) = sender.send(bytes) {
                // That one is over, and this is the next one's.
                let inbox = new_inbox();
                let _ = inbox.0.send(bytes);
                self.links.insert(from, inbox);
            }
        }
    }

    /// The receiver of what comes from there from now on.
    fn open(&mut self, from: Address) -> Receiver<Vec<u8>> {
        if self.lost.contains(&from.rank) {
            return silent();
        }
        let (_, kept) = self.links.entry(from).or_insert_with(new_inbox);
        kept.take().unwrap_or_else(|| {
            let (sender, receiver) = std::sync::mpsc::channel();
            self.links.insert(from, (sender, None));
            receiver
        })
    }

    /// Gives a process up, and tells all who wait for it.
    pub fn lose(&mut self, rank: Rank, reason: &str) {
        self.lost.insert(rank);
        self.links.retain(|address, _| address.rank != rank);
        let _ = self.greetings.send((rank, Err(reason.to_owned())));
    }
}

/// A process's way to the office. Clones lead to the same one.
#[derive(Clone)]
pub struct Post {
    /// Number of this process.
    pub rank: Rank,
    /// Number of processes.
    pub size: Rank,
    mail: Sender<Mail>,
    inboxes: Arc<Mutex<Inboxes>>,
}

impl Post {
    /// The way to who receives `mail` and fills `inboxes`.
    pub fn new(rank: Rank, size: Rank, mail: Sender<Mail>, inboxes: Arc<Mutex<Inboxes>>) -> Self {
        Self { rank, size, mail, inboxes }
    }

    fn inboxes(&self) -> MutexGuard<'_, Inboxes> {
        self.inboxes.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// The processes that trace for the first one and are not lost.
    pub fn helpers(&self) -> HashSet<Rank> {
        let inboxes = self.inboxes();
        (1..self.size).filter(|rank| !inboxes.lost.contains(rank)).collect()
    }

    /// Asks the office for something, if it is still there.
    pub fn ask(&self, mail: Mail) {
        let _ = self.mail.send(mail);
    }

    /// A way to a worker. One that was opened before to the same address is over.
    pub fn open(&self, address: Address) -> MpiLink {
        let inbox = self.inboxes().open(address);
        MpiLink { post: self.clone(), address, inbox }
    }

    /// A way to a worker from which nothing comes back. It leaves alone what comes from the same
    /// address: between two workers of one process that is the other end of the way.
    pub fn open_to(&self, address: Address) -> MpiLink {
        MpiLink { post: self.clone(), address, inbox: silent() }
    }
}

fn new_inbox() -> Inbox {
    let (sender, receiver) = std::sync::mpsc::channel();
    (sender, Some(receiver))
}

/// What nobody will ever send anything to.
fn silent() -> Receiver<Vec<u8>> {
    std::sync::mpsc::channel().1
}

/// A way to a worker of another process, or from one to the first process.
pub struct MpiLink {
    post: Post,
    address: Address,
    inbox: Receiver<Vec<u8>>,
}

/// What is known of a process that nothing is heard of.
const SILENT: &str = "nothing is heard of it any more";

impl Link for MpiLink {
    fn send(&mut self, message: Vec<u8>) -> Result<(), String> {
        if self.post.inboxes().lost.contains(&self.address.rank) {
            return Err(SILENT.to_owned());
        }
        self.post.ask(Mail::Message(self.address, message));
        Ok(())
    }

    fn receive(&mut self) -> Result<Vec<u8>, String> {
        self.inbox.recv().map_err(|RecvError| SILENT.to_owned())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Whichever end is opened first.
    #[test]
    fn two_workers_of_one_process_have_a_way() {
        for giver_is_first in [true, false] {
            let (greetings, _) = std::sync::mpsc::channel();
            let inboxes = Arc::new(Mutex::new(Inboxes::new(greetings)));
            let (sender, mail) = std::sync::mpsc::channel();
            let post = Post::new(1, 2, sender, Arc::clone(&inboxes));
            let address = Address::between(1, 1, 0);
            let give = || {
                let mut giver = post.open_to(address);
                giver.send(b"film".to_vec()).unwrap();
                let Ok(Mail::Message(to, bytes)) = mail.recv() else { panic!("no message") };
                inboxes.lock().unwrap().deliver(to, bytes);
                giver
            };
            let (_giver, mut taker);
            if giver_is_first {
                _giver = give();
                taker = post.open(address);
            } else {
                taker = post.open(address);
                _giver = give();
            }
            assert_eq!(taker.receive().unwrap(), b"film");
        }
    }
}
