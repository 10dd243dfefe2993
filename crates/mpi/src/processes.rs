//! The processes of a render, connected by MPI.

use crate::post::{Address, Greeting, MOST_WORKERS, Mail, MpiLink, Post};
use mpi::Rank;
use raystream::render::{Link, Peer, RemoteWorker, Way, Worker, serve};
use raystream_cli::{CliError, Helper, Identity, Processes};
use serde::{Deserialize, Serialize};
use std::sync::mpsc::Receiver;
use std::thread;

/// What a helper says of itself before a render.
#[derive(Deserialize, Serialize)]
struct Hello {
    /// The machine that it is on.
    host: String,
    /// Why it cannot render, or else what it renders with.
    can: Result<Crew, String>,
}

/// What a helper renders, and with what.
#[derive(Deserialize, Serialize)]
struct Crew {
    render: Identity,
    /// Name and capacity of each worker.
    workers: Vec<(String, u32)>,
}

/// All processes that `mpirun` has started.
pub struct MpiProcesses {
    post: Post,
    greetings: Receiver<Greeting>,
    host: String,
}

impl MpiProcesses {
    /// Those at the other ends of `post`, whose greetings arrive at `greetings`; `host` is the
    /// machine that this one is on.
    pub fn new(post: Post, greetings: Receiver<Greeting>, host: String) -> Self {
        Self { post, greetings, host }
    }

    /// Tells the first process why this one cannot render.
    pub fn refuse(&self, reason: String) {
        self.greet(Err(reason));
    }

    fn greet(&self, can: Result<Crew, String>) {
        let hello = Hello { host: self.host.clone(), can };
        let bytes = serde_json::to_vec(&hello).unwrap_or_default();
        self.post.ask(Mail::Message(Address::process(0), bytes));
    }

    /// What the process `rank` says of itself in `bytes`: its workers.
    fn crew(&self, rank: Rank, bytes: &[u8], own: &Identity) -> Result<Vec<Helper>, CliError> {
        let Ok(hello) = serde_json::from_slice::<Hello>(bytes) else {
            let what = "is another program or version; start the same one everywhere";
            return Err(format!("process {rank} {what}").into());
        };
        let name = format!("process {rank} on {}", hello.host);
        let crew = hello.can.map_err(|reason| format!("{name}: {reason}"))?;
        if let Some(difference) = own.difference(&crew.render) {
            return Err(format!("{name} {difference}").into());
        }
        let worker = |(index, (device, capacity)): (usize, (String, u32))| {
            let peer = Peer { process: rank as u32, worker: index as u32 };
            let link = self.post.open(Address::worker(rank, index));
            let worker = RemoteWorker::new(link, format!("{device} ({name})"), capacity);
            let worker = worker.with_peer(peer);
            Helper { device, worker: Box::new(worker) }
        };
        Ok(crew.workers.into_iter().enumerate().map(worker).collect())
    }
}

impl Processes for MpiProcesses {
    fn is_helper(&self) -> bool {
        self.post.rank > 0
    }

    fn workers(&self, identity: &Identity) -> Result<Vec<Helper>, CliError> {
        let mut missing = self.post.helpers();
        let mut workers = Vec::new();
        while !missing.is_empty() {
            let (rank, greeting) = self.greetings.recv()?;
            // One that was lost in the frame before is not waited for.
            if missing.remove(&rank) {
                let bytes =
                    greeting.map_err(|reason| format!("process {rank} is gone: {reason}"))?;
                workers.extend(self.crew(rank, &bytes, identity)?);
            }
        }
        Ok(workers)
    }

    fn serve(&self, identity: &Identity, workers: Vec<Box<dyn Worker>>) -> Result<(), CliError> {
        let names = workers.iter().map(|worker| (worker.name(), worker.capacity())).collect();
        if workers.len() > MOST_WORKERS {
            return Err(
                format!("more than {MOST_WORKERS} devices; name fewer with --device").into()
            );
        }
        let links: Vec<MpiLink> =
            (0..workers.len()).map(|index| self.post.open(Address::worker(0, index))).collect();
        self.greet(Ok(Crew { render: identity.clone(), workers: names }));
        thread::scope(|scope| {
            let serving: Vec<_> = workers
                .into_iter()
                .zip(links)
                .enumerate()
                .map(|(index, (mut worker, mut link))| {
                    let post = self.post.clone();
                    let connect = move |way: Way| connect(&post, index, way);
                    scope.spawn(move || serve(worker.as_mut(), &mut link, &connect))
                })
                .collect();
            serving.into_iter().try_for_each(|thread| {
                let served = thread.join().map_err(|_| "a worker has panicked".to_owned());
                served.flatten().map_err(CliError::from)
            })
        })
    }
}

/// A way from this process's worker number `index` to another process's worker.
fn connect(post: &Post, index: usize, way: Way) -> Box<dyn Link> {
    Box::new(match way {
        Way::To(other) => {
            post.open_to(Address::between(other.process, index, other.worker as usize))
        }
        Way::From(other) => {
            post.open(Address::between(other.process, other.worker as usize, index))
        }
    })
}
