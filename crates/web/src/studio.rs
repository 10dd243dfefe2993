//! Who answers the page's questions.

use crate::ask::{Chosen, DeviceName, MethodChosen, Motion, Question};
use crate::computer::Computer;
use crate::digests::digests;
use crate::files::Files;
use crate::method::Method;
use crate::method::beside::Beside;
use crate::page::Page;
use crate::webgpu::{Driver, WebGpu};
use raystream::exec::Executor;
use raystream::exec::cpu::CpuExecutor;
use raystream::image::Display;
use raystream::render::{AllocatorKind, Estimator, FilterKind, IntegratorKind};
use raystream::scene::{self, LoadOptions, Scene, SceneError, SceneGeometry};
use raystream_view::inspect::progress;
use raystream_view::layers::Layer;
use serde_json::{Value, json};
use std::error::Error;
use std::path::Path;
use std::time::Duration;

/// The devices, the files that were given, and the page.
pub struct Studio<D: Driver> {
    driver: Option<D>,
    gpu: Option<WebGpu<D>>,
    computer: Computer<D>,
    files: Files,
    page: Option<Page<Computer<D>>>,
    method: Option<Method<Computer<D>>>,
    pixels: Vec<u8>,
}

type Answer = Result<Value, Box<dyn Error>>;

impl<D: Driver> Studio<D> {
    /// An empty page that computes on the CPU. A browser's GPU is made known later, which `driver`
    /// then drives.
    pub fn new(driver: Option<D>) -> Self {
        Self {
            driver,
            gpu: None,
            computer: Computer::Cpu(CpuExecutor),
            files: Files::default(),
            page: None,
            method: None,
            pixels: Vec::new(),
        }
    }

    /// Keeps a file, for a scene that is opened later.
    pub fn add_file(&mut self, name: &str, bytes: Vec<u8>) {
        self.files.add(name, bytes);
    }

    /// Forgets all files.
    pub fn clear_files(&mut self) {
        self.files.clear();
    }

    /// The pixels that were painted last, of one picture after the other: red, green, blue and 255
    /// of each.
    pub fn pixels(&self) -> &[u8] {
        &self.pixels
    }

    /// The answer to a question.
    pub fn answer(&mut self, question: &str) -> String {
        let answer = serde_json::from_str(question)
            .map_err(Into::into)
            .and_then(|question| self.answer_to(question));
        answer.unwrap_or_else(|error| json!({ "error": error.to_string() })).to_string()
    }

    fn answer_to(&mut self, question: Question) -> Answer {
        match question {
            Question::Known => Ok(known(self.computer.name())),
            Question::Open { scene, choices } => self.open(&scene, &choices),
            Question::Found => Ok(json!({ "scene": self.files.scene()? })),
            Question::Choose { choices } => {
                let page = self.page()?;
                let size = choices.size(page.facts().size)?;
                page.choose(size, choices.choices()?, choices.stops())?;
                Ok(json!({}))
            }
            Question::Move(motion) => self.move_camera(&motion),
            Question::Rest => {
                self.page()?.rest()?;
                Ok(json!({}))
            }
            Question::Render { milliseconds } => {
                let page = self.page()?;
                let more = page.render(Duration::from_millis(milliseconds.into()))?;
                Ok(json!({ "more": more, "moving": page.is_moving() }))
            }
            Question::Paint { layer, exposure } => self.paint(&layer, exposure),
            Question::Inspect { x, y } => Ok(json!(self.page()?.inspect([x, y]))),
            Question::Method { scene, choices } => self.open_method(&scene, &choices),
            Question::Round => self.round(),
            Question::Gpu(facts) => {
                let driver = self.driver.clone().ok_or("there is no browser")?;
                self.gpu = Some(WebGpu::new(driver, facts));
                Ok(json!({}))
            }
            Question::Device { name } => self.compute_on(name),
            Question::Digests { scene } => {
                let scene = LoadOptions::default().load_named(&scene)?;
                Ok(json!(digests(&self.computer, &scene)?))
            }
        }
    }

    fn page(&mut self) -> Result<&mut Page<Computer<D>>, &'static str> {
        self.page.as_mut().ok_or("no scene is open")
    }

    fn compute_on(&mut self, name: DeviceName) -> Answer {
        let computer = match name {
            DeviceName::Cpu => Computer::Cpu(CpuExecutor),
            DeviceName::WebGpu => Computer::Gpu(self.gpu.clone().ok_or("no GPU is open")?),
        };
        (self.page, self.method, self.computer) = (None, None, computer);
        Ok(json!({ "device": self.computer.name() }))
    }

    fn load(&mut self, name: &str) -> Result<Scene, SceneError> {
        let path = Path::new(name);
        if self.files.has(path) {
            return self.files.load(path);
        }
        LoadOptions::default().load_named(name)
    }

    fn open(&mut self, name: &str, chosen: &Chosen) -> Answer {
        let scene = self.load(name)?;
        let (size, choices) = (chosen.size(scene.film)?, chosen.choices()?);
        let page = Page::new(self.computer.clone(), &scene, size, choices, chosen.stops())?;
        let facts = page.facts();
        let answer = json!({
            "name": facts.name,
            "triangles": facts.triangles,
            "size": [facts.size.width, facts.size.height],
            "warnings": facts.warnings,
        });
        self.page = Some(page);
        Ok(answer)
    }

    fn open_method(&mut self, name: &str, chosen: &MethodChosen) -> Answer {
        self.method = None;
        let scene = self.load(name)?;
        let choice = chosen.choice(scene.film)?;
        let computer = match &self.computer {
            Computer::Gpu(gpu) if chosen.beside => Computer::with_cpu(gpu.clone()),
            computer => computer.clone(),
        };
        self.method = Some(Method::new(computer, &scene, choice)?);
        Ok(json!({ "size": [choice.size.width, choice.size.height] }))
    }

    /// The stages of the next round; their pictures are one after the other in the pixels.
    fn round(&mut self) -> Answer {
        let method = self.method.as_mut().ok_or("no method is shown")?;
        let mut told = method.round()?;
        if let Computer::Both(both) = method.executor() {
            let partings = both.partings();
            for stage in &mut told.stages {
                stage.beside = Some(Beside::of(stage.kernels, &partings));
            }
        }
        let pictures = told.stages.iter().flat_map(|stage| &stage.pictures);
        self.pixels = pictures.flat_map(|painted| painted.rgba.iter().copied()).collect();
        Ok(serde_json::to_value(told)?)
    }

    fn move_camera(&mut self, motion: &Motion) -> Answer {
        let page = self.page()?;
        if motion.reset {
            page.reset_camera()?;
        }
        page.navigate(|navigator| {
            navigator.orbit(motion.orbit[0], motion.orbit[1]);
            navigator.pan(motion.pan[0], motion.pan[1]);
            if let Some(factor) = motion.zoom {
                navigator.zoom(factor);
            }
        })?;
        Ok(json!({}))
    }

    fn paint(&mut self, layer: &str, exposure: f32) -> Answer {
        let layer = Layer::named(layer).ok_or_else(|| format!("there is no layer '{layer}'"))?;
        let page = self.page.as_mut().ok_or("no scene is open")?;
        let status = page.look(layer.wants_all())?;
        let display = Display { exposure, ..Display::default() };
        let painted = page.paint(layer, &display).or_else(|| page.paint(Layer::Beauty, &display));
        let painted = painted.ok_or("there is no picture yet")?;
        self.pixels = painted.rgba;
        Ok(json!({
            "size": painted.size,
            "title": painted.title,
            "ticks": painted.ticks,
            "colors": painted.colors,
            "progress": progress(&status),
            "samples": status.samples,
            "rays": status.rays,
            "seconds": status.time.as_secs_f64(),
            "relative_error": status.error,
            "done": status.stop.is_some(),
            "moving": page.is_moving(),
        }))
    }
}

/// What can be chosen.
fn known(device: &str) -> Value {
    fn names<T: Copy>(all: &[T], name: impl Fn(T) -> &'static str) -> Vec<&'static str> {
        all.iter().map(|&value| name(value)).collect()
    }
    let scenes = scene::shipped().iter().filter(|s| s.geometry == SceneGeometry::BuiltIn);
    // A browser has no libraries to load.
    let filters = FilterKind::ALL.iter().filter(|&&filter| filter != FilterKind::Oidn);
    json!({
        "device": device,
        "scenes": scenes.map(|s| json!({ "name": s.name, "description": s.description }))
            .collect::<Vec<_>>(),
        "allocators": names(AllocatorKind::ALL, AllocatorKind::name),
        "estimators": names(Estimator::ALL, Estimator::name),
        "integrators": names(IntegratorKind::ALL, IntegratorKind::name),
        "filters": filters.map(|filter| filter.name()).collect::<Vec<_>>(),
        "layers": names(&Layer::ALL, Layer::name),
    })
}
