//! What the render thread tells the window.

use crate::stage::SceneFacts;
use raystream::film::Film;
use raystream::render::Stop;
use std::path::PathBuf;
use std::sync::Arc;
use std::time::Duration;

/// A picture of a render under way.
#[derive(Clone)]
pub struct Frame {
    /// Which order it follows.
    pub version: u64,
    /// The render's place among those beside each other.
    pub side: usize,
    /// What there is of it.
    pub film: Arc<Film>,
    /// Whether the camera is moving: the film is then smaller than the picture.
    pub moving: bool,
    /// Whether the film has all that can be computed of it: corrections, features, estimates and the
    /// filtered picture.
    pub all: bool,
    /// How far it is.
    pub status: Status,
}

/// How far a render is.
#[derive(Clone, Copy, Debug, Default)]
pub struct Status {
    /// Samples, on average over the pixels.
    pub samples: f64,
    /// Rays traced.
    pub rays: u64,
    /// Time of rendering, without that of showing.
    pub time: Duration,
    /// Time that pictures of it took: to copy them, and what estimators and filters made of them.
    pub showing: Duration,
    /// The relative error of the picture, by the variance of its samples; None before there are two
    /// of each pixel.
    pub error: Option<f64>,
    /// What ended it.
    pub stop: Option<Stop>,
}

/// What the render thread is at.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub enum Activity {
    /// It waits for an order.
    #[default]
    Waiting,
    /// It loads the scene and builds what rays are traced through.
    Loading,
    /// It opens a device, and has its driver compile the kernels.
    Opening,
    /// It renders.
    Rendering,
    /// It was told to pause.
    Paused,
    /// All renders have ended by themselves.
    Ended,
    /// It cannot go on, for this reason, until there is another order.
    Failed(String),
}

/// What there is to know since it was last asked for.
#[derive(Clone, Default)]
pub struct News {
    /// A scene that has been loaded.
    pub scene: Option<Arc<SceneFacts>>,
    /// Files that a scene was read from, also where that has failed.
    pub files: Vec<PathBuf>,
    /// The device that has been opened.
    pub device: Option<String>,
    /// The latest picture of each render.
    pub frames: Vec<Frame>,
    /// Each picture's number of order, render and status, for the curves.
    pub points: Vec<(u64, usize, Status)>,
    /// What the thread is at now.
    pub activity: Activity,
}

impl News {
    /// Adds a picture. An older one of the same render, which nobody has fetched, goes.
    pub fn add(&mut self, frame: Frame) {
        if !frame.moving {
            self.points.push((frame.version, frame.side, frame.status));
        }
        self.frames.retain(|old| old.version == frame.version && old.side != frame.side);
        self.frames.push(frame);
    }

    /// Takes all of it; the activity is a lasting one.
    pub fn take(&mut self) -> Self {
        let activity = self.activity.clone();
        std::mem::replace(self, Self { activity, ..Self::default() })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn frame(version: u64, side: usize, samples: f64) -> Frame {
        let film = Arc::new(Film::new(0, 0, Vec::new(), Vec::new()));
        let status = Status { samples, ..Status::default() };
        Frame { version, side, film, moving: false, all: true, status }
    }

    #[test]
    fn only_the_latest_pictures_are_kept_but_all_points() {
        let mut news = News::default();
        for samples in [1.0, 2.0, 3.0] {
            news.add(frame(1, 0, samples));
            news.add(frame(1, 1, samples));
        }
        let kept: Vec<_> = news.frames.iter().map(|f| (f.side, f.status.samples)).collect();
        assert_eq!(kept, [(0, 3.0), (1, 3.0)]);
        assert_eq!(news.points.len(), 6);
        news.add(frame(2, 0, 1.0));
        assert_eq!(news.frames.len(), 1, "those of an older order go");
    }

    #[test]
    fn news_are_taken_once_and_the_activity_stays() {
        let mut news = News { activity: Activity::Rendering, ..News::default() };
        news.add(frame(1, 0, 1.0));
        assert_eq!(news.take().frames.len(), 1);
        let again = news.take();
        assert!(again.frames.is_empty() && again.points.is_empty());
        assert_eq!(again.activity, Activity::Rendering);
    }
}
