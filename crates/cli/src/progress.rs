//! How far a render is, and what goes before it: a bar on a terminal, plain lines elsewhere.

use super::output::{rate, say};
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use raystream::render::Progress;
use std::io::IsTerminal;
use std::sync::mpsc::{RecvTimeoutError, Sender};
use std::time::{Duration, Instant};

/// How often a plain line is printed.
const LINE_INTERVAL: Duration = Duration::from_secs(5);
/// How often what waits is drawn on a terminal.
const TICK: Duration = Duration::from_millis(100);
/// Steps of the bar.
const STEPS: u64 = 1000;

/// Shows a render's progress on stderr.
pub struct ProgressDisplay {
    bar: Option<ProgressBar>,
    next_line: Duration,
}

impl ProgressDisplay {
    /// A display; an invisible one if `quiet`.
    pub fn new(quiet: bool) -> Self {
        let bar = (!quiet && std::io::stderr().is_terminal()).then(|| {
            let style = ProgressStyle::with_template("{bar:30} {percent:>3} %  {msg}");
            ProgressBar::with_draw_target(Some(STEPS), ProgressDrawTarget::stderr())
                .with_style(style.unwrap_or_else(|_| ProgressStyle::default_bar()))
        });
        Self { bar, next_line: if quiet { Duration::MAX } else { LINE_INTERVAL } }
    }

    /// Shows where the render is.
    pub fn show(&mut self, progress: &Progress) {
        if let Some(bar) = &self.bar {
            bar.set_position((fraction(progress) * STEPS as f64) as u64);
            bar.set_message(describe(progress));
        } else if progress.elapsed >= self.next_line {
            self.next_line = progress.elapsed + LINE_INTERVAL;
            say(&format!("{:3.0} %  {}", fraction(progress) * 100.0, describe(progress)));
        }
    }

    /// Removes the bar.
    pub fn finish(&self) {
        if let Some(bar) = &self.bar {
            bar.finish_and_clear();
        }
    }
}

/// Says that something takes long whose end cannot be told, until it is dropped.
pub struct Waiting {
    bar: Option<ProgressBar>,
    /// Ends the thread that prints plain lines when it is dropped.
    lines: Option<Sender<()>>,
}

impl Waiting {
    /// Says `what` is under way: at once on a terminal, every few seconds elsewhere, never if
    /// `quiet`.
    pub fn start(quiet: bool, what: String) -> Self {
        if quiet {
            return Self { bar: None, lines: None };
        }
        if std::io::stderr().is_terminal() {
            let style = ProgressStyle::with_template("{spinner} {msg}, {elapsed}");
            let bar = ProgressBar::with_draw_target(None, ProgressDrawTarget::stderr())
                .with_style(style.unwrap_or_else(|_| ProgressStyle::default_spinner()))
                .with_message(what);
            bar.enable_steady_tick(TICK);
            return Self { bar: Some(bar), lines: None };
        }
        let (lines, ended) = std::sync::mpsc::channel();
        let started = Instant::now();
        std::thread::spawn(move || {
            while ended.recv_timeout(LINE_INTERVAL) == Err(RecvTimeoutError::Timeout) {
                say(&format!("{what}, {:.0} s so far", started.elapsed().as_secs_f64()));
            }
        });
        Self { bar: None, lines: Some(lines) }
    }
}

impl Drop for Waiting {
    fn drop(&mut self) {
        if let Some(bar) = &self.bar {
            bar.finish_and_clear();
        }
        drop(self.lines.take());
    }
}

/// How much of the budget is spent: of samples or of time, or of the way to the noise, whichever is
/// nearer its end.
fn fraction(progress: &Progress) -> f64 {
    let samples = progress.total_paths.map_or(0.0, |total| progress.paths as f64 / total as f64);
    let time =
        progress.time.map_or(0.0, |time| progress.elapsed.as_secs_f64() / time.as_secs_f64());
    samples.max(time).max(progress.convergence).min(1.0)
}

fn describe(progress: &Progress) -> String {
    let seconds = progress.elapsed.as_secs_f64().max(1e-9);
    let done = fraction(progress);
    let begun = fraction(&Progress {
        paths: progress.paths_before,
        elapsed: Duration::ZERO,
        convergence: 0.0,
        ..*progress
    });
    let left = if done > begun {
        format!(", {:.0} s left", seconds * (1.0 - done) / (done - begun))
    } else {
        String::new()
    };
    let rays = if progress.rays > 0 {
        format!(", {}rays/s", rate(progress.rays as f64 / seconds))
    } else {
        String::new()
    };
    let paths = progress.paths - progress.paths_before;
    format!("{}samples/s{rays}{left}", rate(paths as f64 / seconds))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_nearer_end_counts() {
        let progress = Progress {
            paths: 25,
            paths_before: 0,
            total_paths: Some(100),
            rays: 100,
            elapsed: Duration::from_secs(5),
            time: Some(Duration::from_secs(10)),
            convergence: 0.25,
        };
        assert_eq!(fraction(&progress), 0.5);
        assert_eq!(describe(&progress), "5 samples/s, 20 rays/s, 5 s left");
        assert_eq!(fraction(&Progress { convergence: 0.75, ..progress }), 0.75);
    }
}
