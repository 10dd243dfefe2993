//! Speed of the traversal for primary, diffuse-bounce and shadow rays, one of each per pixel.

use super::{BenchError, WARM_UP, median, warm_up};
use bytemuck::Zeroable;
use rayon::prelude::*;
use raystream::exec::{Array, Executor, Launch, SceneBuffers, kernels};
use raystream::render::{PreparedScene, Settings};
use raystream_shaders::film::stream::Slot;
use raystream_shaders::integrator::params::PathParams;
use raystream_shaders::scene::bvh::Order;
use raystream_shaders::scene::ray::{Hit, NO_TRIANGLE, Ray};
use std::time::Duration;

/// The speed of one kind of rays.
#[derive(Clone, Copy, Debug)]
pub struct RaySpeed {
    /// Which kind.
    pub kind: &'static str,
    /// Rays per second, in millions; the median of the repetitions.
    pub mrays_per_second: f64,
    /// Share of the rays that hit something.
    pub hits: f64,
    /// Rays that were checked against brute force.
    pub checked: usize,
    /// Those of them that found another triangle at the same distance (coincident or touching
    /// surfaces).
    pub ties: usize,
}

/// How to measure.
#[derive(Clone, Copy, Debug)]
pub struct Options {
    /// Timed repetitions of each kind, after one that is not timed.
    pub repetitions: u32,
    /// Rays of each kind to check against brute force.
    pub checks: usize,
}

/// The rays of one kind, what they hit, and how long tracing them took.
struct Traced {
    rays: Vec<Ray>,
    hits: Vec<Hit>,
    time: Duration,
}

/// Traces one ray of each kind per pixel of `settings.size`.
pub fn measure<E: Executor>(
    executor: &E,
    scene: &PreparedScene,
    settings: &Settings,
    options: Options,
) -> Result<Vec<RaySpeed>, BenchError> {
    let tracer = Tracer::new(executor, scene, settings, options)?;
    let Tracer { parameters, scene: buffers, .. } = &tracer;
    let ranks: Vec<Slot> = (0..parameters.threads).map(|rank| Slot { rank, sample: 0 }).collect();
    let slots = Array::from_slice(executor, "the sample stream", &ranks)?;
    let [primary, bounced, shadow] = [tracer.rays()?, tracer.rays()?, tracer.rays()?];

    executor.run(&[kernels::primary_rays(parameters, buffers, slots.view(), primary.view())])?;
    let traced_primary = tracer.closest(&primary)?;
    let (from, at) = (|| primary.view(), || tracer.hits.view());
    executor.run(&[
        kernels::bounce_rays(parameters, buffers, from(), at(), bounced.view()),
        kernels::shadow_rays(parameters, buffers, from(), at(), shadow.view()),
    ])?;
    let traced_bounced = tracer.closest(&bounced)?;
    let traced_shadow = tracer.any(&shadow)?;

    Ok(vec![
        traced_primary.speed("primary", check_closest(scene, &traced_primary, options)?),
        traced_bounced.speed("diffuse bounce", check_closest(scene, &traced_bounced, options)?),
        traced_shadow.speed("shadow", check_any(scene, &traced_shadow, options)?),
    ])
}

/// What traces rays, one of each pixel.
struct Tracer<'a, E: Executor> {
    executor: &'a E,
    scene: SceneBuffers<E::Buffer>,
    parameters: PathParams,
    options: Options,
    /// What the rays that were traced last hit.
    hits: Array<E::Buffer, Hit>,
}

impl<'a, E: Executor> Tracer<'a, E> {
    fn new(
        executor: &'a E,
        scene: &PreparedScene,
        settings: &Settings,
        options: Options,
    ) -> Result<Self, BenchError> {
        let threads = settings.size.width * settings.size.height;
        Ok(Self {
            executor,
            scene: scene.buffers_for(executor, settings.abilities())?,
            parameters: PathParams { threads, ..scene.parameters(settings) },
            options,
            hits: Array::zeroed(executor, "hits", threads as usize)?,
        })
    }

    /// Room for a ray of each pixel.
    fn rays(&self) -> Result<Array<E::Buffer, Ray>, BenchError> {
        Ok(Array::zeroed(self.executor, "rays", self.parameters.threads as usize)?)
    }

    /// Finds the closest hits.
    fn closest(&self, rays: &Array<E::Buffer, Ray>) -> Result<Traced, BenchError> {
        let time = time(self.executor, self.options, || {
            kernels::closest_hits(&self.parameters, &self.scene, rays.view(), self.hits.view())
        })?;
        Ok(Traced { rays: rays.read(self.executor)?, hits: self.hits.read(self.executor)?, time })
    }

    /// Finds whether there are hits: where they are does not count.
    fn any(&self, rays: &Array<E::Buffer, Ray>) -> Result<Traced, BenchError> {
        let threads = self.parameters.threads as usize;
        let occluded: Array<E::Buffer, u32> = Array::zeroed(self.executor, "hits", threads)?;
        let time = time(self.executor, self.options, || {
            kernels::any_hits(&self.parameters, &self.scene, rays.view(), occluded.view())
        })?;
        let hits = occluded
            .read(self.executor)?
            .into_iter()
            .map(|hit| Hit { triangle: if hit == 0 { NO_TRIANGLE } else { 0 }, ..Hit::zeroed() })
            .collect();
        Ok(Traced { rays: rays.read(self.executor)?, hits, time })
    }
}

/// The median time of `options.repetitions` launches, after one that warms up.
fn time<'a, E: Executor>(
    executor: &E,
    options: Options,
    launch: impl Fn() -> Launch<'a, E::Buffer>,
) -> Result<Duration, BenchError>
where
    E::Buffer: 'a,
{
    warm_up(WARM_UP, || executor.run(&[launch()]).map(drop))?;
    let times = (0..options.repetitions.max(1))
        .map(|_| Ok(executor.run(&[launch()])?[0]))
        .collect::<Result<Vec<_>, BenchError>>()?;
    Ok(median(times))
}

impl Traced {
    fn speed(&self, kind: &'static str, check: Check) -> RaySpeed {
        let count = self.rays.len() as f64;
        RaySpeed {
            kind,
            mrays_per_second: count / self.time.as_secs_f64() / 1e6,
            hits: self.hits.iter().filter(|hit| hit.is_some()).count() as f64 / count,
            checked: check.checked,
            ties: check.ties,
        }
    }
}

struct Check {
    checked: usize,
    ties: usize,
}

/// The nearest hit by testing every triangle.
pub fn brute_force(scene: &PreparedScene, ray: &Ray) -> Hit {
    let bvh = scene.view().bvh;
    let mut hit = Hit::miss(ray.t_max);
    let nothing = Hit::miss(0.0);
    for number in 0..scene.numbers {
        let place = bvh.place(number);
        let (planes, ray) = (bvh.planes(place.entry), bvh.ray_at(&place, ray));
        bvh.test(&planes, &ray, number, &nothing, Order::NEAREST, &mut hit);
    }
    hit
}

/// Indices of `checks` rays, spread evenly.
fn sample(count: usize, checks: usize) -> Vec<usize> {
    let checks = checks.min(count);
    (0..checks).map(|k| k * count / checks).collect()
}

/// Whether two distances are one, up to the roundings of two triangles' intersections.
pub fn same_distance(a: f32, b: f32) -> bool {
    (a - b).abs() <= 1e-4 * a.abs().max(b.abs())
}

fn check_closest(
    scene: &PreparedScene,
    traced: &Traced,
    options: Options,
) -> Result<Check, BenchError> {
    let indices = sample(traced.rays.len(), options.checks);
    let wrong = |index: usize, expected: &Hit| {
        BenchError::Wrong(format!(
            "ray {index} {:?} hit {:?}, brute force says {expected:?}",
            traced.rays[index], traced.hits[index]
        ))
    };
    let ties = indices
        .par_iter()
        .map(|&index| {
            let (hit, expected) = (&traced.hits[index], brute_force(scene, &traced.rays[index]));
            // Splits repeat a triangle, so its place in the scene counts, not in the BVH.
            let of_scene = |hit: &Hit| scene.scene_triangle(hit);
            if hit.is_some() == expected.is_some() && of_scene(hit) == of_scene(&expected) {
                Ok(0)
            } else if hit.is_some() && expected.is_some() && same_distance(hit.t, expected.t) {
                Ok(1)
            } else {
                Err(wrong(index, &expected))
            }
        })
        .collect::<Vec<Result<usize, BenchError>>>();
    // A ray through an edge may pass beside a triangle in one arithmetic and not in the other: one
    // in a thousand is let off.
    let failures = ties.iter().filter(|tie| tie.is_err()).count();
    if failures * 1000 > indices.len() {
        return Err(ties
            .into_iter()
            .find_map(Result::err)
            .unwrap_or_else(|| BenchError::Wrong("no hit".into())));
    }
    Ok(Check { checked: indices.len(), ties: ties.into_iter().flatten().sum::<usize>() + failures })
}

fn check_any(
    scene: &PreparedScene,
    traced: &Traced,
    options: Options,
) -> Result<Check, BenchError> {
    let indices = sample(traced.rays.len(), options.checks);
    let differing = indices
        .par_iter()
        .filter(|&&index| {
            traced.hits[index].is_some() != brute_force(scene, &traced.rays[index]).is_some()
        })
        .count();
    if differing * 1000 > indices.len() {
        return Err(BenchError::Wrong(format!(
            "{differing} of {} shadow rays differ from brute force",
            indices.len()
        )));
    }
    Ok(Check { checked: indices.len(), ties: differing })
}
