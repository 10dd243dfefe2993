//! What the page shows: a scene, a camera in somebody's hands, and a render under way.

use raystream::clock::Instant;
use raystream::exec::Executor;
use raystream::image::Display;
use raystream::render::Settings;
use raystream::scene::{FilmSize, Scene};
use raystream_view::choices::{Choices, Stops};
use raystream_view::inspect::inspect;
use raystream_view::layers::Layer;
use raystream_view::navigator::Navigator;
use raystream_view::news::Status;
use raystream_view::pace::MovingSize;
use raystream_view::side::{Shot, Side};
use raystream_view::stage::{SceneFacts, Stage, StageError};
use serde::Serialize;
use std::time::Duration;

/// A scene on the page, and its render.
pub struct Page<E: Executor + Clone> {
    executor: E,
    stage: Stage,
    navigator: Navigator,
    choices: Choices,
    stops: Stops,
    size: FilmSize,
    /// How small the picture is while the camera moves.
    moving_size: MovingSize,
    is_moving: bool,
    /// When the render was begun.
    start: Instant,
    side: Side<E>,
    shot: Option<Shot>,
}

/// What ends a picture of a moving camera: one sample of each pixel, since it will move on.
const MOVING: Stops = Stops { samples: Some(1), time: None, noise: None };

/// A picture as a screen shows it.
#[derive(Serialize)]
pub struct Painted {
    /// Sides of the picture in pixels; while the camera moves, smaller ones.
    pub size: [u32; 2],
    /// Red, green, blue and 255 of each pixel, row by row from the top.
    #[serde(skip)]
    pub rgba: Vec<u8>,
    /// What is shown, in a sentence.
    pub title: &'static str,
    /// Numbers and their places along the legend's colours, from 0 to 1; empty for colours.
    pub ticks: Vec<(f64, String)>,
    /// The legend's colours, evenly along it; empty for colours.
    pub colors: Vec<[u8; 3]>,
}

impl<E: Executor + Clone> Page<E> {
    /// Puts a scene on the page.
    ///
    /// # Errors
    /// If it cannot be prepared, or the device has no room for it.
    pub fn new(
        executor: E,
        scene: &Scene,
        size: FilmSize,
        choices: Choices,
        stops: Stops,
    ) -> Result<Self, StageError> {
        let stage = Stage::new(scene)?;
        let facts = stage.facts();
        let navigator = Navigator::new(facts.camera, facts.bounds);
        let settings = settings(&choices, &stops, &stage.base(size));
        let side = Side::new(executor.clone(), stage.prepared(), &settings)?;
        Ok(Self {
            executor,
            stage,
            navigator,
            choices,
            stops,
            size,
            moving_size: MovingSize::default(),
            is_moving: false,
            start: Instant::now(),
            side,
            shot: None,
        })
    }

    /// What there is to know of the scene.
    pub fn facts(&self) -> &SceneFacts {
        self.stage.facts()
    }

    /// Begins the render anew with other choices.
    ///
    /// # Errors
    /// If the device has no room for it.
    pub fn choose(
        &mut self,
        size: FilmSize,
        choices: Choices,
        stops: Stops,
    ) -> Result<(), StageError> {
        (self.size, self.choices, self.stops) = (size, choices, stops);
        self.begin(false)
    }

    /// Moves the camera, and begins a small picture of what it sees then. Where the camera is the
    /// same, nothing begins.
    ///
    /// # Errors
    /// If the device has no room for it.
    pub fn navigate(&mut self, change: impl FnOnce(&mut Navigator)) -> Result<(), StageError> {
        let before = self.navigator;
        change(&mut self.navigator);
        if self.navigator == before {
            return Ok(());
        }
        self.stage.set_camera(self.navigator.camera())?;
        self.begin(true)
    }

    /// Puts the camera back to where the scene has it.
    ///
    /// # Errors
    /// If the device has no room for the render.
    pub fn reset_camera(&mut self) -> Result<(), StageError> {
        let facts = self.stage.facts();
        let first = Navigator::new(facts.camera, facts.bounds);
        self.navigate(|navigator| *navigator = first)
    }

    /// The camera has come to rest: begins the whole picture.
    ///
    /// # Errors
    /// If the device has no room for it.
    pub fn rest(&mut self) -> Result<(), StageError> {
        if self.is_moving { self.begin(false) } else { Ok(()) }
    }

    fn begin(&mut self, moving: bool) -> Result<(), StageError> {
        (self.is_moving, self.start) = (moving, Instant::now());
        let settings = if moving {
            let (width, height) = self.moving_size.of(self.size.width, self.size.height);
            let size = FilmSize { width, height };
            self.choices.moving_settings(&self.stage.base(size))
        } else {
            settings(&self.choices, &self.stops, &self.stage.base(self.size))
        };
        self.side = Side::new(self.executor.clone(), self.stage.prepared(), &settings)?;
        Ok(())
    }

    /// Renders for about `time`: at least a batch, and not beyond the end of a round that would be
    /// lost. Returns whether there is more to render.
    ///
    /// # Errors
    /// If the device fails.
    pub fn render(&mut self, time: Duration) -> Result<bool, StageError> {
        let stops = if self.is_moving { MOVING } else { self.stops };
        let start = Instant::now();
        while self.side.check(&stops)?.is_none() {
            self.side.turn(&stops, &|| false)?;
            if self.is_moving {
                self.moving_size.record(self.start.elapsed());
            }
            if start.elapsed() >= time {
                return Ok(self.side.check(&stops)?.is_none());
            }
        }
        Ok(false)
    }

    /// Looks at the render: what is painted next is of now. `all` is for layers that take time to
    /// compute.
    ///
    /// # Errors
    /// If the device fails.
    pub fn look(&mut self, all: bool) -> Result<Status, StageError> {
        let shot = self.side.show(all && !self.is_moving)?;
        let status = shot.status;
        self.shot = Some(shot);
        Ok(status)
    }

    /// Whether the picture is one of a moving camera.
    pub fn is_moving(&self) -> bool {
        self.is_moving
    }

    /// A layer of the render when it was looked at last; None without one, or where it does not
    /// have the layer: without a filter nothing is denoised.
    pub fn paint(&self, layer: Layer, display: &Display) -> Option<Painted> {
        let film = &self.shot.as_ref()?.film;
        let scale = layer.scale(&[film]);
        let pixels = layer.paint(film, display, scale.as_ref())?;
        let along =
            |step: u32| scale.as_ref().map(|scale| scale.color_along(f64::from(step) / 63.0));
        Some(Painted {
            size: [film.width, film.height],
            rgba: pixels.iter().flat_map(|&[r, g, b]| [r, g, b, 255]).collect(),
            title: layer.title(film),
            ticks: scale.as_ref().map_or_else(Vec::new, |scale| scale.ticks(6)),
            colors: (0..64).filter_map(along).collect(),
        })
    }

    /// What is known of a pixel: what it is called and what it is.
    pub fn inspect(&self, pixel: [u32; 2]) -> Vec<(&'static str, String)> {
        self.shot.as_ref().map_or_else(Vec::new, |shot| inspect(&shot.film, pixel))
    }
}

/// The settings of a render at rest. Its streams are short, a sample of each pixel: a browser's
/// worker sees nothing of what a person does before the end of one.
fn settings(choices: &Choices, stops: &Stops, base: &Settings) -> Settings {
    let pixels = base.size.width * base.size.height;
    Settings { stream_slots: Some(pixels), ..choices.settings(base, stops.noise) }
}
