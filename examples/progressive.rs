//! Steps a renderer, as a window would, and writes a picture whenever the samples have doubled.
//!
//! `cargo run --release --example progressive -- [PICTURE] [SAMPLES] [DEVICE]`

use raystream::prelude::*;

/// What a window would hold: the renderer owns its device.
struct Viewer {
    renderer: Renderer,
    picture: String,
}

impl Viewer {
    fn samples(&self) -> u64 {
        self.renderer.paths() / u64::from(self.renderer.pixels())
    }

    /// Renders until there are `samples` per pixel, and writes the picture.
    fn refine(&mut self, samples: u64) -> Result<(), Box<dyn std::error::Error>> {
        let goal = samples * u64::from(self.renderer.pixels());
        while self.renderer.paths() < goal {
            let mut round = self.renderer.next_round(goal - self.renderer.paths())?;
            // Between batches, a tenth of a second each, a window would look for events.
            while let Some(batch) = round.next_batch()? {
                eprint!("\r{:>10} paths in this batch", batch.paths);
            }
        }
        image::write_film(&self.picture, &self.renderer.film()?)?;
        eprintln!("\r{:>10} samples per pixel    ", self.samples());
        Ok(())
    }
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut arguments = std::env::args().skip(1);
    let picture = arguments.next().unwrap_or("progressive.png".into());
    let last: u64 = arguments.next().map_or(Ok(64), |text| text.parse())?;
    let device = Device::open(&arguments.next().unwrap_or("auto".into()))?;

    let scene = scene::load_named("cornell_ball")?;
    // Not adaptive: the initial samples of adaptive sampling would be one round.
    let settings = Settings { sampling: Sampling::UNIFORM, ..Settings::for_scene(&scene) };
    let prepared = PreparedScene::new(&scene, BvhQuality::default())?;
    let renderer = Renderer::new(device, &prepared, &settings)?;
    let mut viewer = Viewer { renderer, picture };
    let mut samples = 1;
    while samples < last {
        viewer.refine(samples)?;
        samples *= 2;
    }
    viewer.refine(last)
}
