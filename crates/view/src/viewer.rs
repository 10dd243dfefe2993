//! What a window shows and what it was told, without the window.

mod paths;

use crate::choices::Choices;
use crate::curve::{Curve, speedup};
use crate::desk::{Desk, Order};
use crate::layers::Layer;
use crate::navigator::Navigator;
use crate::news::{Activity, Frame, News, Status};
use crate::save;
use crate::stage::{SceneChoice, SceneFacts};
use crate::view::View;
use crate::watch::Watch;
pub use paths::ShownPath;
use raystream::film::Film;
use raystream::image::Display;
use raystream::render::{AllocatorKind, FilterKind, Stop};
use raystream_figures::ColorScale;
use raystream_figures::tev::Tev;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::{Duration, Instant};

/// The camera is at rest so long after it was moved last.
const REST: Duration = Duration::from_millis(250);

/// Pixels for a screen.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Painted {
    /// Width and height.
    pub size: [u32; 2],
    /// sRGB, row by row from the top.
    pub pixels: Vec<[u8; 3]>,
}

/// One of the renders beside each other, as it is shown.
#[derive(Default)]
pub struct ShownSide {
    /// The latest picture.
    pub frame: Option<Frame>,
    /// Its error over time.
    pub curve: Curve,
    /// What is to be shown from now on; taken by the window.
    pub painted: Option<Painted>,
}

/// What happened to a file that was to be written.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Saved {
    /// It is there.
    Done(String),
    /// It is not, for this reason.
    Failed(String),
}

/// What a window shows and what it was told.
pub struct Viewer {
    desk: Arc<Desk>,
    scene: SceneChoice,
    /// What is to be rendered. Changes count from the next [`Self::update`] on.
    pub order: Order,
    version: u64,
    facts: Option<Arc<SceneFacts>>,
    navigator: Option<Navigator>,
    moved: Option<Instant>,
    device: Option<String>,
    activity: Activity,
    sides: [ShownSide; 2],
    /// Which of the renders the controls are for.
    pub chosen_side: usize,
    layer: Layer,
    display: Display,
    scale: Option<ColorScale>,
    is_stale: bool,
    /// Where the picture is on the screen.
    pub view: View,
    /// Where the line between two pictures is, as a part of the width.
    pub divider: f32,
    /// The pixel under the pointer.
    pub pointed: Option<[u32; 2]>,
    /// The pixel that was clicked.
    pub pinned: Option<[u32; 2]>,
    /// The path of a sample of that pixel.
    pub path: ShownPath,
    /// Where the picture is saved.
    pub picture_path: String,
    /// Where the copy of the scene's file is saved.
    pub camera_path: String,
    /// What happened to the last file.
    pub saved: Option<Saved>,
    /// Watches the scene's files, if that was asked for.
    pub watch: Option<Watch>,
    /// Shows pictures elsewhere, if that was asked for.
    pub tev: Option<Tev>,
    /// Whether a picture is to be written once there is one that has all.
    is_saving: bool,
}

impl Viewer {
    /// A viewer of a scene that follows what it is told at `desk`.
    pub fn new(desk: Arc<Desk>, scene: SceneChoice, order: Order) -> Self {
        let is_file = scene.shipped().is_none();
        let camera_path = if is_file { save::copy_of(&scene.name) } else { PathBuf::new() };
        let stem = scene.name.file_stem().unwrap_or_default().to_string_lossy().into_owned();
        Self {
            desk,
            scene,
            order,
            version: 0,
            facts: None,
            navigator: None,
            moved: None,
            device: None,
            activity: Activity::Waiting,
            sides: Default::default(),
            chosen_side: 0,
            layer: Layer::Beauty,
            display: Display::default(),
            scale: None,
            is_stale: false,
            view: View::default(),
            divider: 0.5,
            pointed: None,
            pinned: None,
            path: ShownPath::default(),
            picture_path: format!("{stem}.png"),
            camera_path: camera_path.to_string_lossy().into_owned(),
            saved: None,
            watch: None,
            tev: None,
            is_saving: false,
        }
    }

    /// Reads the news and places the order. Returns when to be called again at the latest, if that
    /// is not to wait for news.
    pub fn update(&mut self, now: Instant) -> Option<Duration> {
        let rests_in = self.moved.map(|moved| REST.saturating_sub(now - moved));
        if rests_in.is_some_and(|time| time.is_zero()) {
            self.moved = None;
        }
        self.order.moving = self.moved.is_some();
        self.order.camera = self.navigator.as_ref().map(Navigator::camera);
        let is_own = self.facts.as_ref().map(|facts| facts.camera) == self.order.camera;
        if is_own {
            self.order.camera = None;
        }
        self.order.all = self.layer.wants_all() || self.is_saving;
        let version = self.desk.order(&self.order);
        if version != self.version {
            self.version = version;
            self.sides.iter_mut().for_each(|side| side.curve = Curve::default());
        }
        let news = self.desk.take_news();
        self.read(news);
        if std::mem::take(&mut self.is_stale) {
            self.paint();
        }
        self.check_pinned();
        self.follow_path();
        self.write_picture();
        let rests_in = rests_in.filter(|time| !time.is_zero());
        [rests_in, self.follow_files(now)].into_iter().flatten().min()
    }

    /// Loads the scene again where one of its files has changed. Returns when one will be at rest.
    fn follow_files(&mut self, now: Instant) -> Option<Duration> {
        match self.watch.as_mut()?.take_change(now) {
            Ok(true) => {
                self.order.reload += 1;
                Some(Duration::ZERO)
            }
            Ok(false) => None,
            Err(rests_in) => Some(rests_in),
        }
    }

    fn read(&mut self, news: News) {
        self.activity = news.activity;
        if let Some(facts) = news.scene {
            let is_first = self.facts.is_none();
            let has_moved = self.navigator.is_some_and(|navigator| {
                self.facts.as_ref().is_some_and(|facts| facts.camera != navigator.camera())
            });
            // One that somebody has moved stays where a file is read again.
            if is_first || !has_moved {
                self.navigator = Some(Navigator::new(facts.camera, facts.bounds));
            }
            self.facts = Some(facts);
        }
        self.device = news.device.or(self.device.take());
        if let Some(watch) = &mut self.watch
            && let Err(error) = watch.add(news.files.iter().map(PathBuf::as_path))
        {
            self.saved = Some(Saved::Failed(format!("cannot watch the scene's files: {error}")));
        }
        for (version, side, status) in news.points {
            if version == self.version && side < 2 {
                self.sides[side].curve.add(&status);
            }
        }
        if let Some(failure) = self.tev.as_ref().and_then(Tev::take_failure) {
            (self.tev, self.saved) = (None, Some(Saved::Failed(failure)));
        }
        for frame in news.frames {
            if frame.version == self.version && frame.side < 2 {
                let side = frame.side;
                if let (Some(tev), false, 0) = (&self.tev, frame.moving, side) {
                    tev.show(Arc::clone(&frame.film));
                }
                self.sides[side].frame = Some(frame);
                self.is_stale = true;
            }
        }
    }

    /// Paints the layer of all pictures that there are, in the same colours.
    fn paint(&mut self) {
        let films: Vec<Arc<Film>> = (0..self.shown_sides())
            .filter_map(|side| Some(Arc::clone(&self.sides[side].frame.as_ref()?.film)))
            .collect();
        let films: Vec<&Film> = films.iter().map(AsRef::as_ref).collect();
        self.scale = self.layer.scale(&films);
        for side in 0..self.shown_sides() {
            let Some(frame) = &self.sides[side].frame else { continue };
            let film = Arc::clone(&frame.film);
            let painted = self.layer.paint(&film, &self.display, self.scale.as_ref());
            // Without a filter, as while the camera moves, the picture is all there is.
            let pixels = painted.or_else(|| Layer::Beauty.paint(&film, &self.display, None));
            let size = [film.width, film.height];
            self.sides[side].painted = pixels.map(|pixels| Painted { size, pixels });
        }
    }

    /// What there is to know of the scene, once it is loaded.
    pub fn facts(&self) -> Option<&SceneFacts> {
        self.facts.as_deref()
    }

    /// The camera, once there is a scene.
    pub fn navigator(&self) -> Option<&Navigator> {
        self.navigator.as_ref()
    }

    /// Moves the camera. Pictures are small until it is at rest.
    pub fn navigate(&mut self, now: Instant, change: impl FnOnce(&mut Navigator)) {
        let Some(navigator) = &mut self.navigator else { return };
        let before = navigator.camera();
        change(navigator);
        if navigator.camera() != before {
            self.moved = Some(now);
        }
    }

    /// Puts the camera where the scene's file has it.
    pub fn reset_camera(&mut self) {
        if let Some(facts) = &self.facts {
            self.navigator = Some(Navigator::new(facts.camera, facts.bounds));
        }
    }

    /// Turns around what is at a place of the picture, and has a lens in focus there.
    pub fn focus(&mut self, place: [f32; 2]) {
        let (Some(facts), Some(navigator)) = (&self.facts, &mut self.navigator) else { return };
        let stage = self.desk.stage();
        let Some(stage) = stage.as_ref() else { return };
        if let Some(point) = stage.pick(&navigator.camera(), facts.size, place) {
            navigator.focus(point);
        }
    }

    /// The device that renders, once it is open.
    pub fn device(&self) -> Option<&str> {
        self.device.as_deref()
    }

    /// What the render thread is at.
    pub fn activity(&self) -> &Activity {
        &self.activity
    }

    /// How many renders are beside each other.
    pub fn shown_sides(&self) -> usize {
        self.order.sides.len().min(2)
    }

    /// One of the renders.
    pub fn side(&self, side: usize) -> &ShownSide {
        &self.sides[side.min(1)]
    }

    /// What is to be shown of a render from now on, if that has changed.
    pub fn take_painted(&mut self, side: usize) -> Option<Painted> {
        self.sides[side.min(1)].painted.take()
    }

    /// How far the renders are that are shown.
    pub fn status(&self, side: usize) -> Option<&Status> {
        self.side(side).frame.as_ref().map(|frame| &frame.status)
    }

    /// What ended all renders, if they have ended.
    pub fn stop(&self) -> Option<Stop> {
        let stops = (0..self.shown_sides()).map(|side| self.status(side)?.stop);
        stops.collect::<Option<Vec<_>>>()?.first().copied()
    }

    /// How much faster the first render is than the second, by their variances at equal time.
    pub fn speedup(&self) -> Option<f64> {
        let [first, second] = &self.sides;
        (self.shown_sides() == 2).then(|| speedup(&first.curve, &second.curve)).flatten()
    }

    /// The layer that is shown.
    pub fn layer(&self) -> Layer {
        self.layer
    }

    /// Shows another layer; for one without noise a filter is chosen, if none was.
    pub fn show(&mut self, layer: Layer) {
        if layer == Layer::Denoised && self.order.sides.iter().all(|side| side.filter.is_none()) {
            self.order.sides.iter_mut().for_each(|side| side.filter = Some(FilterKind::Auto));
        }
        self.is_stale |= self.layer != layer;
        self.layer = layer;
    }

    /// How radiance is shown.
    pub fn display(&self) -> Display {
        self.display
    }

    /// Shows radiance in another way.
    pub fn set_display(&mut self, display: Display) {
        self.is_stale |= self.display != display;
        self.display = display;
    }

    /// The colours of the layer's numbers, if it is one of numbers.
    pub fn scale(&self) -> Option<&ColorScale> {
        self.scale.as_ref()
    }

    /// Whether two renders are beside each other.
    pub fn compares(&self) -> bool {
        self.order.sides.len() > 1
    }

    /// Has a second render beside the first: the same, but every pixel sampled alike; or has it
    /// alone again.
    pub fn compare(&mut self, compares: bool) {
        self.order.sides.truncate(1);
        self.chosen_side = 0;
        if compares {
            let first = self.order.sides.first().copied().unwrap_or_default();
            self.order.sides.push(Choices { allocator: AllocatorKind::Uniform, ..first });
        } else {
            self.sides[1] = ShownSide::default();
        }
        self.is_stale = true;
    }

    /// The choices that the controls are for.
    pub fn choices(&mut self) -> Option<&mut Choices> {
        self.order.sides.get_mut(self.chosen_side)
    }

    /// Which render is at a place of the picture, in pixels.
    pub fn side_at(&self, x: f32) -> usize {
        let width = self.facts.as_ref().map_or(0, |facts| facts.size.width) as f32;
        usize::from(self.compares() && x >= self.divider * width)
    }

    /// What is known of the pixel that was clicked or, without one, that is under the pointer.
    pub fn inspected(&self) -> Vec<(&'static str, String)> {
        let Some(pixel) = self.pinned.or(self.pointed) else { return Vec::new() };
        let (Some(frame), Some(facts)) =
            (&self.side(self.side_at(pixel[0] as f32)).frame, &self.facts)
        else {
            return Vec::new();
        };
        // The film is smaller while the camera moves.
        let sizes = [(frame.film.width, facts.size.width), (frame.film.height, facts.size.height)];
        let scaled = |axis: usize| {
            let (film, whole) = sizes[axis];
            (u64::from(pixel[axis]) * u64::from(film) / u64::from(whole.max(1))) as u32
        };
        crate::inspect::inspect(&frame.film, [scaled(0), scaled(1)])
    }

    /// Loads the scene again.
    pub fn reload(&mut self) {
        self.order.reload += 1;
    }

    /// Writes the first render's picture, once there is one that has all layers: the next one that
    /// comes, or the one that is there.
    pub fn save_picture(&mut self) {
        (self.is_saving, self.saved) = (true, None);
    }

    /// Whether a picture is waited for that is to be written.
    pub fn is_saving(&self) -> bool {
        self.is_saving
    }

    fn write_picture(&mut self) {
        let frame = self.sides[0].frame.as_ref().filter(|_| self.is_saving);
        let Some(frame) = frame.filter(|f| f.all && !f.moving && f.version == self.version) else {
            return;
        };
        let path = PathBuf::from(self.picture_path.trim());
        let choices = self.order.sides.first().copied().unwrap_or_default();
        let scene = self.scene.name.display().to_string();
        let device = self.device.as_deref().unwrap_or_default();
        let settings = save::settings_of(&scene, device, &choices, &frame.status);
        let saved = save::save_picture(&path, &frame.film, &self.display, &settings);
        self.saved = Some(told(saved.map_err(|error| error.to_string()), &path));
        self.is_saving = false;
    }

    /// Writes a copy of the scene's file that has the camera as it is.
    pub fn save_camera(&mut self) {
        let path = PathBuf::from(self.camera_path.trim());
        let saved = match (self.scene.shipped(), &self.facts, &self.navigator) {
            (Some(name), ..) => Err(format!(
                "{name} is a part of the program and has no file. To keep a camera, write a scene \
                 file of your own"
            )),
            (None, Some(facts), Some(navigator)) => {
                save::save_camera(&self.scene.name, &path, &navigator.camera(), &facts.camera)
                    .map_err(|error| error.to_string())
            }
            _ => Err("there is no scene yet".to_owned()),
        };
        self.saved = Some(told(saved, &path));
    }
}

fn told(saved: Result<(), String>, path: &Path) -> Saved {
    match saved {
        Ok(()) => Saved::Done(format!("wrote {}", path.display())),
        Err(reason) => Saved::Failed(reason),
    }
}

#[cfg(test)]
mod tests;
