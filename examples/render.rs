//! Renders a scene that ships, in ten lines.
//!
//! `cargo run --release --example render -- [PICTURE] [SAMPLES] [DEVICE]`

use raystream::prelude::*;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut arguments = std::env::args().skip(1);
    let picture = arguments.next().unwrap_or("cornell_ball.png".into());
    let samples = arguments.next().map_or(Ok(16), |text| text.parse())?;
    let device = Device::open(&arguments.next().unwrap_or("auto".into()))?;

    let scene = scene::load_named("cornell_ball")?;
    let settings = Settings::for_scene(&scene);
    let film = render(&scene, &settings, Budget::samples(samples), device)?;
    image::write_film(picture, &film)?;
    Ok(())
}
