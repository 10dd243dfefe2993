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
mod tests {
    use super::*;
    use crate::choices::Choices;
    use crate::news::News;
    use glam::Vec3;
    use raystream::render::{AllocatorKind, Stop};
    use raystream::scene::Camera;

    const SIZE: FilmSize = FilmSize { width: 32, height: 24 };

    /// A thread that renders a small picture of a scene on the CPU, and the first order for it.
    fn start(name: &str) -> (Arc<Desk>, RenderThread, Order) {
        let desk = Arc::new(Desk::new(|| ()));
        let scene = SceneChoice { name: name.into(), size: Some(SIZE), ..SceneChoice::default() };
        let thread = RenderThread::start(Arc::clone(&desk), scene).unwrap();
        (desk, thread, Order::new("cpu"))
    }

    /// The news, all together, until they are as wanted.
    fn until(desk: &Desk, is_wanted: impl Fn(&News) -> bool) -> News {
        let (start, mut all) = (Instant::now(), News::default());
        while !is_wanted(&all) {
            assert!(start.elapsed() < Duration::from_secs(60), "{:?}", all.activity);
            let news = desk.take_news();
            all.activity = news.activity.clone();
            all.scene = news.scene.or(all.scene);
            all.device = news.device.or(all.device);
            all.points.extend(news.points);
            all.frames.extend(news.frames);
            std::thread::sleep(Duration::from_millis(2));
        }
        all
    }

    fn samples(number: u32) -> Stops {
        Stops { samples: Some(number), ..Stops::default() }
    }

    fn last(news: &News) -> &Frame {
        news.frames.last().unwrap()
    }

    #[test]
    fn a_picture_ends_at_its_samples_and_goes_on_with_more() {
        let (desk, _thread, order) = start("cornell_ball");
        let version = desk.order(&Order { stops: samples(9), ..order.clone() });
        let news = until(&desk, |news| news.activity == Activity::Ended);
        let frame = last(&news);
        assert_eq!((frame.version, frame.side, frame.moving), (version, 0, false));
        assert_eq!((frame.film.width, frame.film.height), (32, 24));
        assert_eq!((frame.status.samples, frame.status.stop), (9.0, Some(Stop::Samples)));
        assert!(frame.status.rays > 9 * 32 * 24 && frame.status.error.is_some());
        assert!(frame.film.color().iter().any(|color| color.max_element() > 0.1));
        assert_eq!(news.scene.unwrap().size, SIZE);
        assert!(news.device.unwrap().starts_with("CPU"));
        assert_eq!(desk.order(&Order { stops: samples(12), ..order }), version);
        let news =
            until(&desk, |news| news.frames.last().is_some_and(|f| f.status.samples == 12.0));
        assert_eq!(last(&news).version, version, "it is the same render");
    }

    #[test]
    fn the_picture_is_that_of_the_library() {
        let (desk, _thread, order) = start("cornell_ball");
        let choices = Choices { allocator: AllocatorKind::Uniform, ..Choices::default() };
        desk.order(&Order { sides: vec![choices], stops: samples(8), ..order });
        let shown = until(&desk, |news| news.activity == Activity::Ended);
        let mut scene = raystream::scene::load_named("cornell_ball").unwrap();
        scene.film = SIZE;
        let settings = choices.settings(&Settings::for_scene(&scene), None);
        let budget = raystream::render::Budget::samples(8);
        let film =
            raystream::render(&scene, &settings, budget, Device::open("cpu").unwrap()).unwrap();
        assert_eq!(last(&shown).film.radiance, film.radiance, "rounds are of no importance");
    }

    #[test]
    fn another_camera_is_another_picture_and_a_moving_one_is_small() {
        let (desk, _thread, order) = start("cornell_ball");
        desk.order(&Order { stops: samples(4), ..order.clone() });
        let before = until(&desk, |news| news.activity == Activity::Ended);
        let camera = Camera::new(Vec3::new(0.3, 1.2, 3.0), Vec3::new(0.0, 1.0, 0.0), 40.0);
        let moving = Order { camera: Some(camera), moving: true, ..order.clone() };
        let version = desk.order(&moving);
        let news = until(&desk, |news| news.frames.iter().any(|f| f.version == version));
        let frame = last(&news);
        assert!(frame.moving && frame.film.width == 8 && frame.film.height == 6);
        assert!(news.points.iter().all(|(of, ..)| *of != version), "curves are of whole pictures");
        let still = Order { moving: false, stops: samples(4), ..moving };
        let version = desk.order(&still);
        let news = until(&desk, |n| {
            n.frames.iter().any(|f| f.version == version && f.status.stop.is_some())
        });
        assert_eq!(last(&news).film.width, 32);
        assert_ne!(last(&news).film.position(), last(&before).film.position());
    }

    #[test]
    fn two_renders_beside_each_other_get_equal_times() {
        let (desk, _thread, order) = start("cornell_ball");
        let uniform = Choices { allocator: AllocatorKind::Uniform, ..Choices::default() };
        let stops = Stops { time: Some(Duration::from_millis(1500)), ..Stops::default() };
        desk.order(&Order { sides: vec![Choices::default(), uniform], stops, ..order });
        let news = until(&desk, |news| news.activity == Activity::Ended);
        let end = |side| news.frames.iter().rfind(|f| f.side == side).unwrap().status;
        for status in [end(0), end(1)] {
            assert_eq!(status.stop, Some(Stop::Time));
            let seconds = status.time.as_secs_f64();
            assert!((1.5..3.0).contains(&seconds), "{seconds}");
            assert!(status.error.is_some());
        }
        // Neither is ever ahead by more than a round and a batch of the other.
        let mut times = [0.0; 2];
        for (_, side, status) in &news.points {
            times[*side] = status.time.as_secs_f64();
            assert!((times[0] - times[1]).abs() < 1.0, "{times:?}");
        }
    }

    #[test]
    fn a_pause_holds_the_samples_and_lets_go() {
        let (desk, _thread, order) = start("cornell_ball");
        desk.order(&order);
        until(&desk, |news| !news.frames.is_empty());
        let version = desk.order(&Order { paused: true, ..order.clone() });
        until(&desk, |news| news.activity == Activity::Paused);
        desk.take_news();
        std::thread::sleep(Duration::from_millis(150));
        assert!(desk.take_news().frames.is_empty());
        assert_eq!(desk.order(&order), version);
        until(&desk, |news| news.activity == Activity::Rendering && !news.frames.is_empty());
    }

    #[test]
    fn pictures_have_all_where_that_is_asked_for_and_at_rest() {
        let (desk, _thread, order) = start("cornell_ball");
        desk.order(&order);
        let news = until(&desk, |news| news.frames.len() > 2);
        assert!(news.frames.iter().all(|f| !f.all && f.film.corrections.is_none()));
        let version = desk.order(&Order { all: true, ..order.clone() });
        let news = until(&desk, |news| news.frames.iter().any(|frame| frame.all));
        let frame = news.frames.iter().find(|frame| frame.all).unwrap();
        assert_eq!(frame.version, version);
        assert!(frame.film.corrections.is_some() && frame.film.estimates.is_some());
        desk.order(&order);
        until(&desk, |news| news.frames.iter().any(|frame| !frame.all));
        desk.order(&Order { paused: true, ..order });
        until(&desk, |news| news.activity == Activity::Paused && last(news).all);
    }

    #[test]
    fn what_goes_wrong_is_said_and_mended_by_another_order() {
        let (desk, _thread, order) = start("cornell_ball");
        desk.order(&Order { device: "no such device".to_owned(), ..order.clone() });
        let failed = |news: &News| matches!(news.activity, Activity::Failed(_));
        let news = until(&desk, failed);
        let Activity::Failed(reason) = news.activity else { panic!("it has failed") };
        assert!(reason.contains("no such device"), "{reason}");
        let nowhere = Camera::new(Vec3::ONE, Vec3::ONE, 40.0);
        desk.order(&Order { camera: Some(nowhere), ..order.clone() });
        let news = until(&desk, |news| failed(news) && news.device.is_some());
        let Activity::Failed(reason) = news.activity else { panic!("it has failed") };
        assert!(reason.contains("camera"), "{reason}");
        desk.order(&order);
        until(&desk, |news| !news.frames.is_empty());
    }

    #[test]
    fn a_scene_that_is_not_there_is_named() {
        let (desk, _thread, order) = start("no_such_scene");
        desk.order(&order);
        let news = until(&desk, |news| matches!(news.activity, Activity::Failed(_)));
        let Activity::Failed(reason) = news.activity else { panic!("it has failed") };
        assert!(reason.contains("no_such_scene"), "{reason}");
    }

    #[test]
    fn closing_ends_a_render_at_once() {
        let (desk, thread, order) = start("cornell_ball");
        desk.order(&order);
        until(&desk, |news| !news.frames.is_empty());
        let start = Instant::now();
        drop(thread);
        assert!(start.elapsed() < Duration::from_secs(1), "{:?}", start.elapsed());
    }

    #[test]
    fn a_place_of_the_picture_is_a_point_of_the_scene() {
        let (desk, _thread, order) = start("cornell_ball");
        desk.order(&order);
        until(&desk, |news| !news.frames.is_empty());
        let stage = desk.stage();
        let stage = stage.as_ref().unwrap();
        let facts = stage.facts();
        let point = stage.pick(&facts.camera, SIZE, [16.0, 12.0]).unwrap();
        assert!((point - facts.bounds.centre).length() < 1.5 * facts.bounds.radius, "{point}");
        assert!(facts.triangles > 10);
    }
}
