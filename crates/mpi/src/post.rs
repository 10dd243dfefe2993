//! How the threads of a process send messages to other processes and get theirs.

use mpi::{Rank, Tag};
use raystream::render::Link;
use std::collections::{HashMap, HashSet};
use std::sync::mpsc::{Receiver, RecvError, Sender};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

/// Who is at the other end: a process, and which of its workers.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Address {
    /// Number of the process.
    pub rank: Rank,
    /// Number of its worker, from 1 on; 0 for the process itself.
    pub worker: Tag,
}

impl Address {
    /// The process itself.
    pub fn process(rank: Rank) -> Self {
        Self { rank, worker: 0 }
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

/// Where messages that come in go.
pub struct Inboxes {
    /// Of links.
    pub links: HashMap<Address, Sender<Vec<u8>>>,
    /// Of greetings.
    pub greetings: Sender<Greeting>,
    /// Processes that are lost, and from which nothing more is taken.
    pub lost: HashSet<Rank>,
}

impl Inboxes {
    /// Puts a message where it belongs. One that nobody waits for is of what is over.
    pub fn deliver(&mut self, from: Address, bytes: Vec<u8>) {
        if self.lost.contains(&from.rank) {
            return;
        }
        // A receiver that is gone needs it no more.
        if from.worker == 0 {
            let _ = self.greetings.send((from.rank, Ok(bytes)));
        } else if let Some(inbox) = self.links.get(&from) {
            let _ = inbox.send(bytes);
        }
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

    /// A way to a worker. What came before on one to the same address is gone.
    pub fn open(&self, address: Address) -> MpiLink {
        let (sender, inbox) = std::sync::mpsc::channel();
        let mut inboxes = self.inboxes();
        if !inboxes.lost.contains(&address.rank) {
            inboxes.links.insert(address, sender);
        }
        drop(inboxes);
        MpiLink { post: self.clone(), address, inbox }
    }
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
