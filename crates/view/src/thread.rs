//! The thread that renders: it follows the latest order, and stops at once when there is another.

use crate::choices::Stops;
use crate::desk::{Desk, Order, Placed};
use crate::news::{Activity, Frame};
use crate::pace::MovingSize;
use crate::side::{Shot, Side};
use crate::stage::{SceneChoice, Stage, StageError};
use raystream::exec::Device;
use raystream::render::{PreparedScene, Settings};
use raystream::scene::FilmSize;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::Arc;
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

/// The thread that renders. It ends when this is dropped.
pub struct RenderThread {
    desk: Arc<Desk>,
    thread: Option<JoinHandle<()>>,
}

/// What ends a picture of a moving camera: it will go on moving.
const MOVING: Stops = Stops { samples: Some(32), time: None, noise: None };

/// So long the thread is waited for: a batch takes a tenth of a second, but loading takes longer,
/// and a process need not wait for that.
const PATIENCE: Duration = Duration::from_secs(2);

impl RenderThread {
    /// Starts a thread that renders this scene as orders at the desk say.
    ///
    /// # Errors
    /// If the system has no thread for it.
    pub fn start(desk: Arc<Desk>, scene: SceneChoice) -> std::io::Result<Self> {
        let at_desk = Arc::clone(&desk);
        let thread = std::thread::Builder::new().name("render".to_owned()).spawn(move || {
            Studio {
                desk: &at_desk,
                scene,
                loaded: None,
                device: None,
                size: MovingSize::default(),
            }
            .run();
        })?;
        Ok(Self { desk, thread: Some(thread) })
    }
}

impl Drop for RenderThread {
    fn drop(&mut self) {
        self.desk.close();
        let Some(thread) = self.thread.take() else { return };
        let start = Instant::now();
        while !thread.is_finished() {
            if start.elapsed() > PATIENCE {
                return;
            }
            std::thread::sleep(Duration::from_millis(1));
        }
        // It catches its panics.
        let _ = thread.join();
    }
}

/// A render, and whether its last picture has all that can be computed of it.
struct Running {
    side: Side,
    has_all: bool,
}

/// What the thread has.
struct Studio<'d> {
    desk: &'d Desk,
    scene: SceneChoice,
    /// The number of the order's `reload` that the scene on the stage is of.
    loaded: Option<u64>,
    device: Option<(String, Device)>,
    size: MovingSize,
}

impl Studio<'_> {
    fn run(&mut self) {
        let mut known = None;
        while let Some(placed) = self.desk.wait(known) {
            let done = catch_unwind(AssertUnwindSafe(|| self.follow(&placed)));
            match done {
                Ok(Ok(())) => {}
                Ok(Err(error)) => self.desk.is_at(Activity::Failed(error.to_string())),
                Err(_) => {
                    // What it has on the device may be half of something.
                    (self.loaded, self.device) = (None, None);
                    let what = "a part of the program has failed; the terminal says which. Change \
                                a setting to go on";
                    self.desk.is_at(Activity::Failed(what.to_owned()));
                }
            }
            // What was wrong with an order stays wrong until there is another.
            known = Some(placed.number);
        }
    }

    /// Renders until there is another order that does not continue this one.
    fn follow(&mut self, placed: &Placed) -> Result<(), StageError> {
        let Placed { order, version, .. } = placed;
        self.load(order)?;
        let device = self.open(order)?;
        let start = Instant::now();
        let mut sides = self.sides(order, &device)?;
        let mut is_first = true;
        loop {
            let Some(latest) = self.desk.latest().filter(|latest| latest.version == *version)
            else {
                return Ok(());
            };
            let goes_on = is_first || !latest.order.paused;
            if goes_on && self.turn(&mut sides, &latest)? {
                self.desk.is_at(Activity::Rendering);
                if std::mem::take(&mut is_first) && order.moving {
                    self.size.record(start.elapsed());
                }
            } else {
                self.complete(&mut sides, &latest)?;
                self.desk.is_at(if goes_on { Activity::Ended } else { Activity::Paused });
                self.desk.wait(Some(latest.number));
            }
        }
    }

    /// Has the render that is behind in time go on. Returns whether there is one.
    fn turn(&self, sides: &mut [Running], placed: &Placed) -> Result<bool, StageError> {
        let Placed { order, version, .. } = placed;
        let stops = if order.moving { MOVING } else { order.stops };
        for (number, running) in sides.iter_mut().enumerate() {
            let before = running.side.stop();
            if running.side.check(&stops)?.is_some() && before.is_none() {
                self.show(number, running, placed)?;
            }
        }
        let running = sides.iter_mut().enumerate().filter(|(_, it)| it.side.stop().is_none());
        let Some((number, running)) = running.min_by_key(|(_, it)| it.side.time()) else {
            return Ok(false);
        };
        running.side.turn(&stops, &|| self.desk.is_outdated(*version))?;
        running.has_all = false;
        if running.side.is_due() && !self.desk.is_outdated(*version) {
            self.show(number, running, placed)?;
        }
        Ok(true)
    }

    /// Hands out pictures of renders that rest, with all that can be computed of them, once.
    fn complete(&self, sides: &mut [Running], placed: &Placed) -> Result<(), StageError> {
        let all = Placed { order: Order { all: true, ..placed.order.clone() }, ..*placed };
        for (number, running) in sides.iter_mut().enumerate() {
            if !running.has_all && !placed.order.moving {
                self.show(number, running, &all)?;
            }
        }
        Ok(())
    }

    /// Hands out a picture.
    fn show(&self, number: usize, running: &mut Running, to: &Placed) -> Result<(), StageError> {
        let Shot { film, all, status } = running.side.show(to.order.all && !to.order.moving)?;
        running.has_all = all;
        let (version, moving) = (to.version, to.order.moving);
        let frame = Frame { version, side: number, film, moving, all, status };
        self.desk.tell(|news| news.add(frame));
        Ok(())
    }

    /// Loads the scene, unless that has been done.
    fn load(&mut self, order: &Order) -> Result<(), StageError> {
        if self.loaded != Some(order.reload) {
            self.desk.is_at(Activity::Loading);
            let (scene, files) = self.scene.load();
            self.desk.tell(|news| news.files.extend(files));
            let stage = Stage::new(&scene?)?;
            let facts = Arc::new(stage.facts().clone());
            *self.desk.stage() = Some(stage);
            self.loaded = Some(order.reload);
            self.desk.tell(|news| news.scene = Some(facts));
        }
        Ok(())
    }

    /// Opens the device, unless that has been done.
    fn open(&mut self, order: &Order) -> Result<Device, StageError> {
        match &self.device {
            Some((name, device)) if *name == order.device => Ok(device.clone()),
            _ => {
                self.desk.is_at(Activity::Opening);
                // The one before goes first: both may not have room.
                self.device = None;
                let device = Device::open(&order.device)?;
                let description = device.description();
                self.device = Some((order.device.clone(), device.clone()));
                self.desk.tell(|news| news.device = Some(description));
                Ok(device)
            }
        }
    }

    /// The renders of an order, none of which has begun.
    fn sides(&self, order: &Order, device: &Device) -> Result<Vec<Running>, StageError> {
        let mut stage = self.desk.stage();
        // It is loaded before.
        let Some(stage) = stage.as_mut() else { return Ok(Vec::new()) };
        let facts = stage.facts().clone();
        stage.set_camera(order.camera.unwrap_or(facts.camera))?;
        let side = |settings: &Settings, scene: &PreparedScene| -> Result<Running, StageError> {
            let side = Side::new(device.clone(), scene, settings)?;
            Ok(Running { side, has_all: false })
        };
        if order.moving {
            let (width, height) = self.size.of(facts.size.width, facts.size.height);
            let base = stage.base(FilmSize { width, height });
            let choices = order.sides.first().copied().unwrap_or_default();
            return Ok(vec![side(&choices.moving_settings(&base), stage.prepared())?]);
        }
        let base = stage.base(facts.size);
        let all = order.sides.iter();
        let settings = all.map(|choices| choices.settings(&base, order.stops.noise));
        settings.map(|settings| side(&settings, stage.prepared())).collect()
    }
}

#[cfg(test)]
mod tests;
