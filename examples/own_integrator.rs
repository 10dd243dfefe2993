//! An integrator of one's own: it has two others trace every slot, and keeps what both made of it.
//! Both walk the same paths, so all must agree to the bit.
//!
//! `cargo run --release --example own_integrator -- [PICTURE] [SAMPLES] [DEVICE]`

use raystream::exec::{Array, ExecError, Launch};
use raystream::prelude::*;
use raystream::render::integrator::{
    Integrator, StreamBuffers, megakernel::Megakernel, regeneration::Regeneration,
};
use raystream_shaders::film::Contribution;
use std::ops::Range;
use std::sync::Arc;

/// What each integrator made of the last stream, on the device.
struct Traced<B> {
    by_megakernel: Array<B, Contribution>,
    by_regeneration: Array<B, Contribution>,
}

struct Twice<B> {
    regeneration: Regeneration<B>,
    traced: Arc<Traced<B>>,
}

impl<E: Executor> Integrator<E> for Twice<E::Buffer> {
    fn trace<'a>(
        &'a self,
        stream: &StreamBuffers<'a, E::Buffer>,
        part: Range<u32>,
    ) -> Vec<Launch<'a, E::Buffer>> {
        let into = |contributions| StreamBuffers { contributions, ..*stream };
        let by_megakernel = |stream: &StreamBuffers<'a, _>| {
            Integrator::<E>::trace(&Megakernel, stream, part.clone())
        };
        // The render goes by those of the first.
        let mut launches = by_megakernel(stream);
        launches.extend(by_megakernel(&into(&self.traced.by_megakernel)));
        let stream = into(&self.traced.by_regeneration);
        launches.extend(Integrator::<E>::trace(&self.regeneration, &stream, part.clone()));
        launches
    }
}

impl<B> Traced<B> {
    fn new<E: Executor<Buffer = B>>(executor: &E, slots: u32) -> Result<Self, ExecError> {
        let array = || Array::zeroed(executor, "contributions", slots as usize);
        Ok(Self { by_megakernel: array()?, by_regeneration: array()? })
    }

    fn agree<E: Executor<Buffer = B>>(&self, executor: &E) -> Result<bool, ExecError> {
        let (a, b) = (self.by_megakernel.read(executor)?, self.by_regeneration.read(executor)?);
        Ok(bytemuck::cast_slice::<_, u32>(&a) == bytemuck::cast_slice::<_, u32>(&b))
    }
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut arguments = std::env::args().skip(1);
    let picture = arguments.next().unwrap_or("own_integrator.png".into());
    let samples = arguments.next().map_or(Ok(16), |text| text.parse())?;
    let device = Device::open(&arguments.next().unwrap_or("auto".into()))?;

    let scene = scene::load_named("cornell_ball")?;
    let settings = Settings { stream_slots: Some(1 << 20), ..Settings::for_scene(&scene) };
    let prepared = PreparedScene::new(&scene, BvhQuality::default())?;
    let mut traced = None;
    let mut renderer =
        Renderer::with_integrator(device.clone(), &prepared, &settings, |context, slots| {
            let kept = Arc::new(Traced::new(context.executor, slots)?);
            traced = Some(Arc::clone(&kept));
            let regeneration = Regeneration::new(context.executor)?;
            Ok(Box::new(Twice { regeneration, traced: kept }))
        })?;
    render::run(&mut renderer, Budget::samples(samples), &|| false, &mut |_| ())?;
    image::write_film(picture, &renderer.film()?)?;
    let agree = traced.is_some_and(|traced| matches!(traced.agree(&device), Ok(true)));
    println!("{}", if agree { "all slots agree" } else { "some slots differ" });
    Ok(())
}
