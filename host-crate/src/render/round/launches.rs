//! Launches of one submission, and the account of their times.

use crate::exec::{ExecError, Executor, Launch};
use crate::render::timings::{Part, Timings};

/// Launches of one submission, each with what its time is spent on.
pub struct TimedLaunches<'a, B> {
    parts: Vec<(Vec<Launch<'a, B>>, Part)>,
}

impl<B> Default for TimedLaunches<'_, B> {
    fn default() -> Self {
        Self { parts: Vec::new() }
    }
}

impl<'a, B> TimedLaunches<'a, B> {
    /// Adds launches whose time is spent on `part`.
    pub fn add(&mut self, launches: Vec<Launch<'a, B>>, part: Part) {
        self.parts.push((launches, part));
    }

    /// Runs them all. Where `RUST_LOG` asks for traces, every launch is timed.
    pub fn run<E: Executor<Buffer = B>>(&self, executor: &E) -> Result<Timings, ExecError> {
        let longest = if tracing::enabled!(tracing::Level::TRACE) { 1 } else { usize::MAX };
        let timed = || {
            self.parts.iter().flat_map(|(launches, part)| {
                launches.chunks(longest).map(move |launches| (launches, *part))
            })
        };
        let submitted: Vec<_> = timed().map(|(launches, _)| launches).collect();
        let times = executor.run_parts(&submitted)?;
        let mut timings = Timings::default();
        for ((launches, part), time) in timed().zip(times) {
            timings[part] += time;
            let (kernel, threads) = (launches[0].kernel().name, launches[0].threads());
            tracing::trace!("{:8.1} us {kernel} of {threads} threads", time.as_secs_f64() * 1e6);
        }
        Ok(timings)
    }
}
