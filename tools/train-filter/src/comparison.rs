//! Filters against each other, on scenes that none was trained on.

use crate::films::{self, Noisy, Sampled, view};
use crate::rooms;
use anyhow::{Context, Result};
use glam::{Vec3, Vec4};
use raystream::exec::cpu::CpuExecutor;
use raystream::film::Film;
use raystream::image::read_color;
use raystream::render::reconstruction::auto::Auto;
use raystream::render::reconstruction::learned::Learned;
use raystream::render::reconstruction::{Filter, FilteredPicture, Reconstruction, create};
use raystream::render::{FilmBuffers, FilterKind, FilterSettings, Settings};
use raystream::scene::{FilmSize, Scene, load, load_named};
use std::path::{Path, PathBuf};

/// What is compared, and on what.
#[derive(clap::Args)]
pub struct Arguments {
    /// Scenes: files, names of scenes that ship, or `room:N` for a random room; those below 1000
    /// were trained on.
    #[arg(required = true)]
    scenes: Vec<String>,
    /// Filters.
    #[arg(long, value_delimiter = ',', default_value = "bilateral,learned")]
    filters: Vec<FilterKind>,
    /// Weights of `learned` in the place of those that ship.
    #[arg(long, value_name = "FILE")]
    weights: Option<PathBuf>,
    /// Samples per pixel.
    #[arg(long, value_delimiter = ',', default_value = "4,8,16,32,64")]
    spp: Vec<u32>,
    /// Renders of each.
    #[arg(long, default_value_t = 2)]
    seeds: u32,
    /// Samples per pixel of the reference.
    #[arg(long, default_value_t = 2048)]
    reference_spp: u32,
    /// Height of the pictures.
    #[arg(long, default_value_t = 120)]
    height: u32,
    /// Compare with `reference.exr` in each scene's folder, averaged over blocks of pixels.
    #[arg(long)]
    references: bool,
    /// How far rays start from surfaces, in roundings; see `raystream render --help`.
    #[arg(long, value_name = "ROUNDINGS")]
    ray_offset: Option<f32>,
    /// Where rendered films are kept.
    #[arg(long, value_name = "FOLDER")]
    cache: PathBuf,
    /// Samples by errors too, beside as many for every pixel.
    #[arg(long)]
    adaptive: bool,
}

/// Prints the squared error without a filter, and by how much that of each filter is below it: all
/// of it, without the worst thousandth of pixels, and relative to brightness.
pub fn run(arguments: &Arguments) -> Result<()> {
    let weights = match &arguments.weights {
        Some(path) => {
            let bytes =
                std::fs::read(path).with_context(|| format!("cannot read {}", path.display()))?;
            bytes.chunks_exact(16).map(bytemuck::pod_read_unaligned).collect()
        }
        None => raystream::render::reconstruction::learned::weights(),
    };
    let mut gains = Gains::default();
    for name in &arguments.scenes {
        let scene = arguments.scene(name)?;
        let films = arguments.films(name, &scene)?;
        for (sampled, noisy) in films.chunks(arguments.seeds as usize).map(|of| (of[0].0, of)) {
            let Sampled { samples, is_adaptive, .. } = sampled;
            let mut errors = vec![[0.0; 3]; arguments.filters.len() + 1];
            for (_, Noisy { film, reference }) in noisy {
                add(&mut errors[0], measure(&film.plain(), reference));
                for (sum, &kind) in errors[1..].iter_mut().zip(&arguments.filters) {
                    let picture = filter(&scene, film, kind, is_adaptive, &weights)?;
                    add(sum, measure(&picture, reference));
                }
            }
            let how = if is_adaptive { "adaptive" } else { "uniform" };
            gains.print(&format!("{} {how} {samples}", scene.name), &arguments.filters, &errors);
        }
    }
    gains.finish(&arguments.filters);
    Ok(())
}

impl Arguments {
    /// The films of a scene, rendered or as they were kept.
    fn films(&self, name: &str, scene: &Scene) -> Result<Vec<(Sampled, Noisy)>> {
        std::fs::create_dir_all(&self.cache)
            .with_context(|| format!("cannot create {}", self.cache.display()))?;
        let scene_file = Path::new(name);
        let name = name.replace(['/', ':'], "_");
        let ways = [false, true].into_iter().filter(|&is_adaptive| !is_adaptive || self.adaptive);
        let sampled = self.spp.iter().flat_map(|&samples| {
            ways.clone().flat_map(move |is_adaptive| {
                (1..=self.seeds).map(move |seed| Sampled { samples, is_adaptive, seed })
            })
        });
        let mut many = None;
        let film = |sampled: Sampled| {
            let Sampled { samples, is_adaptive, seed } = sampled;
            let FilmSize { width, height } = scene.film;
            let path = self.cache.join(format!(
                "{name}-{width}x{height}-{}-{samples}-{is_adaptive}-{seed}",
                if self.references { 0 } else { self.reference_spp }
            ));
            if path.exists() {
                return Ok((sampled, Noisy::read(&path, width, height)?));
            }
            let prepared = films::prepare(scene)?;
            let offset = self.ray_offset.unwrap_or(Settings::for_scene(scene).ray_offset);
            let film = films::render_from(scene, &prepared, sampled, offset)?;
            if many.is_none() {
                many = Some(if self.references {
                    reference_beside(scene_file, scene.film)?
                } else {
                    films::reference(scene, &prepared, self.reference_spp)?
                });
            }
            let noisy = Noisy { film, reference: many.clone().unwrap_or_default() };
            noisy.write(&path)?;
            Ok((sampled, noisy))
        };
        sampled.map(film).collect()
    }

    fn scene(&self, name: &str) -> Result<Scene> {
        let height = self.height;
        if let Some(number) = name.strip_prefix("room:") {
            let size = FilmSize { width: height * 4 / 3, height };
            return Ok(rooms::room(number.parse()?, size));
        }
        let path = Path::new(name);
        let mut scene = if path.exists() { load(path)? } else { load_named(name)? };
        scene.film = FilmSize { width: height * scene.film.width / scene.film.height, height };
        Ok(scene)
    }
}

fn filter(
    scene: &Scene,
    film: &Film,
    kind: FilterKind,
    has_control_film: bool,
    weights: &[Vec4],
) -> Result<Vec<Vec3>> {
    let executor = &CpuExecutor;
    let size = scene.film;
    let create = |kind| create(executor, size, kind, FilterSettings::DEFAULT);
    let filter: Box<dyn Filter<_>> = match kind {
        FilterKind::Learned => Box::new(Learned::new(executor, size, weights)?),
        FilterKind::Auto => {
            let learned = Learned::new(executor, size, weights)?;
            let bilateral = create(FilterKind::Bilateral)?;
            Box::new(Auto::of(executor, size, bilateral, Box::new(learned))?)
        }
        kind => create(kind)?,
    };
    let picture = FilteredPicture::with_filter(executor, size, filter)?;
    let reconstruction = Reconstruction::new(executor, picture)?;
    let buffers = FilmBuffers::from_film(executor, film)?;
    let view = view(scene, film);
    reconstruction.run(executor, &buffers, &view, has_control_film)?;
    Ok(reconstruction.read(executor)?.iter().map(|pixel| pixel.filtered).collect())
}

/// The picture `reference.exr` beside a scene's file, averaged over blocks to a size.
fn reference_beside(scene_file: &Path, size: FilmSize) -> Result<Vec<Vec3>> {
    let path = scene_file.with_file_name("reference.exr");
    let picture = read_color(&path)?;
    let block = picture.width / size.width;
    anyhow::ensure!(
        block > 0 && [picture.width, picture.height] == [block * size.width, block * size.height],
        "{}: {}x{} pixels are no blocks of {}x{}; give another --height",
        path.display(),
        picture.width,
        picture.height,
        size.width,
        size.height
    );
    let mean = |place: u32| {
        let (x, y) = (place % size.width * block, place / size.width * block);
        let pixels = (0..block * block).map(|k| (y + k / block) * picture.width + x + k % block);
        pixels.map(|p| picture.pixels[p as usize]).sum::<Vec3>() / (block * block) as f32
    };
    Ok((0..size.width * size.height).map(mean).collect())
}

/// Mean squared error, the same without the worst thousandth, and relative.
fn measure(picture: &[Vec3], reference: &[Vec3]) -> [f64; 3] {
    let mean = reference.iter().map(|c| f64::from(c.element_sum())).sum::<f64>()
        / (3 * reference.len()) as f64;
    let of_pixel = |(a, b): (&Vec3, &Vec3)| {
        let square = (a.as_dvec3() - b.as_dvec3()).length_squared() / 3.0;
        let radiance = f64::from(b.element_sum()) / 3.0;
        (square, square / (radiance * radiance + 0.01 * mean * mean))
    };
    let (mut squares, relative): (Vec<f64>, Vec<f64>) =
        picture.iter().zip(reference).map(of_pixel).unzip();
    let sum = squares.iter().sum::<f64>();
    squares.sort_by(f64::total_cmp);
    let kept = squares.len() - squares.len() / 1000;
    [sum, squares[..kept].iter().sum(), relative.iter().sum()]
}

fn add(sums: &mut [f64; 3], errors: [f64; 3]) {
    sums.iter_mut().zip(errors).for_each(|(sum, error)| *sum += error);
}

/// Logarithms of gains, over all that was measured.
#[derive(Default)]
struct Gains {
    sums: Vec<[f64; 3]>,
    count: f64,
}

impl Gains {
    fn print(&mut self, label: &str, filters: &[FilterKind], errors: &[[f64; 3]]) {
        self.sums.resize(filters.len(), [0.0; 3]);
        self.count += 1.0;
        let [all, trimmed, relative] = errors[0];
        let mut line = format!("{label:<32}  none {all:.4e} / {trimmed:.4e} / {relative:.4e}");
        for (k, filter) in filters.iter().enumerate() {
            let gains: [f64; 3] = std::array::from_fn(|m| errors[0][m] / errors[k + 1][m]);
            add(&mut self.sums[k], gains.map(f64::ln));
            line += &format!("  {filter} {:.2} / {:.2} / {:.2}", gains[0], gains[1], gains[2]);
        }
        println!("{line}");
    }

    fn finish(&self, filters: &[FilterKind]) {
        for (filter, sums) in filters.iter().zip(&self.sums) {
            let [a, b, c] = sums.map(|sum| (sum / self.count).exp());
            println!("geometric mean, {filter}: {a:.3} / {b:.3} / {c:.3}");
        }
    }
}
