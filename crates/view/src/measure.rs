//! How long frames take, without a window: what the window does, but for drawing itself.

use crate::desk::Desk;
use crate::news::Activity;
use crate::program::Arguments;
use crate::thread::RenderThread;
use std::sync::Arc;
use std::time::{Duration, Instant};

/// What was measured.
#[derive(Clone, Debug, Default)]
pub struct Figures {
    /// The device.
    pub device: String,
    /// Times from a move of the camera to the pixels of its picture, in order of size.
    pub moving: Vec<Duration>,
    /// The size of the last of these pictures.
    pub moving_size: [u32; 2],
    /// Time of rendering at rest.
    pub rendering: Duration,
    /// Time that the renderer spent on showing at rest.
    pub showing: Duration,
    /// Pictures shown at rest.
    pub shown: u32,
    /// Time that the window's thread took to make pixels of these.
    pub painting: Duration,
}

impl Figures {
    /// Part of the time at rest that went into showing.
    pub fn share(&self) -> f64 {
        let (rendering, showing) = (self.rendering.as_secs_f64(), self.showing.as_secs_f64());
        if showing > 0.0 { showing / (rendering + showing) } else { 0.0 }
    }

    /// A time that this part of the frames does not exceed while the camera moves.
    pub fn quantile(&self, part: f64) -> Duration {
        let last = self.moving.len().saturating_sub(1);
        self.moving.get((part * last as f64).round() as usize).copied().unwrap_or_default()
    }

    /// All of it, a line each.
    pub fn report(&self) -> String {
        let milliseconds = |time: Duration| 1e3 * time.as_secs_f64();
        let shown = f64::from(self.shown.max(1));
        let [width, height] = self.moving_size;
        format!(
            "device              {}\n\
             moving              {:.1} ms a frame (median), {:.1} ms (95 %), {} frames, at last of \
             {width}x{height}\n\
             at rest             {} pictures in {:.1} s, {:.1} ms each of the renderer's time\n\
             renderer's share    {:.2} % of its time goes into showing\n\
             pixels of a picture {:.1} ms of the window's time",
            self.device,
            milliseconds(self.quantile(0.5)),
            milliseconds(self.quantile(0.95)),
            self.moving.len(),
            self.shown,
            self.rendering.as_secs_f64() + self.showing.as_secs_f64(),
            milliseconds(self.showing) / shown,
            100.0 * self.share(),
            milliseconds(self.painting) / shown,
        )
    }
}

/// The first pictures, for which kernels are compiled, do not count.
const WARM_UP: usize = 3;

/// Moves the camera for `time`, and lets it rest for as long.
///
/// # Errors
/// If the scene cannot be rendered.
pub fn measure(arguments: &Arguments, time: Duration) -> Result<Figures, String> {
    let desk = Arc::new(Desk::new(|| ()));
    let thread = RenderThread::start(Arc::clone(&desk), arguments.scene());
    let _thread = thread.map_err(|error| error.to_string())?;
    let mut viewer = arguments.viewer(desk);
    let mut figures = Figures::default();
    let wait = |viewer: &mut crate::viewer::Viewer| loop {
        viewer.update(Instant::now());
        if let Activity::Failed(reason) = viewer.activity() {
            return Err(reason.clone());
        }
        if let Some(painted) = viewer.take_painted(0) {
            return Ok(painted);
        }
        std::thread::sleep(Duration::from_micros(200));
    };
    wait(&mut viewer)?;
    let (start, mut frames) = (Instant::now(), 0);
    while start.elapsed() < time || frames <= WARM_UP {
        let moved = Instant::now();
        viewer.navigate(moved, |navigator| navigator.orbit(0.02, 0.0));
        figures.moving_size = wait(&mut viewer)?.size;
        frames += 1;
        if frames > WARM_UP {
            figures.moving.push(moved.elapsed());
        }
    }
    figures.moving.sort();
    figures.device = viewer.device().unwrap_or_default().to_owned();
    let (start, mut last) = (Instant::now(), None::<Instant>);
    while start.elapsed() < time || figures.shown == 0 {
        viewer.take_painted(0);
        let updated = Instant::now();
        viewer.update(updated);
        let took = updated.elapsed();
        let frame = viewer.side(0).frame.as_ref().filter(|frame| !frame.moving);
        if let (Some(frame), true) = (frame, viewer.side(0).painted.is_some()) {
            (figures.rendering, figures.showing) = (frame.status.time, frame.status.showing);
            figures.shown += 1;
            figures.painting += took;
            last = Some(updated);
        }
        std::thread::sleep(Duration::from_millis(1));
    }
    // It has gone on since the last picture.
    figures.rendering += last.map(|last| last.elapsed()).unwrap_or_default();
    Ok(figures)
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::Parser;

    #[test]
    fn figures_are_of_frames_and_of_rest() {
        let words = ["raystream-view", "--device", "cpu", "--size", "64x48"];
        let figures = measure(&Arguments::parse_from(words), Duration::from_millis(400)).unwrap();
        assert!(!figures.moving.is_empty() && figures.moving.is_sorted());
        assert!(figures.quantile(0.5) <= figures.quantile(0.95));
        assert!(figures.shown > 0 && figures.rendering > Duration::ZERO);
        assert!((0.0..0.5).contains(&figures.share()), "{}", figures.share());
        assert!(figures.report().contains("CPU"), "{}", figures.report());
    }
}
