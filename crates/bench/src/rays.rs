//! Speed of the traversal for primary, diffuse-bounce and shadow rays, one of each per pixel.

use super::{BenchError, WARM_UP, median, warm_up};
use bytemuck::Zeroable;
use rayon::prelude::*;
use raystream::exec::{Array, Executor, Launch, kernels};
use raystream::render::{PreparedScene, Settings};
use raystream_shaders::film::stream::Slot;
use raystream_shaders::integrator::params::PathParams;
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

/// The rays of one kind and what they hit.
struct Traced {
    rays: Vec<Ray>,
    hits: Vec<Hit>,
}

/// Traces one ray of each kind per pixel of `settings.size`.
pub fn measure<E: Executor>(
    executor: &E,
    scene: &PreparedScene,
    settings: &Settings,
    options: Options,
) -> Result<Vec<RaySpeed>, BenchError> {
    let buffers = scene.buffers(executor)?;
    let threads = settings.size.width * settings.size.height;
    let count = threads as usize;
    let parameters = PathParams { threads, ..scene.parameters(settings) };
    let ranks: Vec<Slot> = (0..threads).map(|rank| Slot { rank, sample: 0 }).collect();
    let slots = Array::from_slice(executor, "the sample stream", &ranks)?;
    let [primary, bounced, shadow]: [Array<E::Buffer, Ray>; 3] = [
        Array::zeroed(executor, "rays", count)?,
        Array::zeroed(executor, "rays", count)?,
        Array::zeroed(executor, "rays", count)?,
    ];
    let hits: Array<E::Buffer, Hit> = Array::zeroed(executor, "hits", count)?;
    let occluded: Array<E::Buffer, u32> = Array::zeroed(executor, "hits", count)?;

    let closest = |rays: &Array<E::Buffer, Ray>| {
        time(executor, options, || {
            kernels::closest_hits(&parameters, &buffers, rays.view(), hits.view())
        })
    };
    let traced = |rays: &Array<E::Buffer, Ray>| -> Result<Traced, BenchError> {
        Ok(Traced { rays: rays.read(executor)?, hits: hits.read(executor)? })
    };

    executor.run(&[kernels::primary_rays(&parameters, slots.view(), primary.view())])?;
    let time_of_primary = closest(&primary)?;
    let traced_primary = traced(&primary)?;
    let (from, at) = (|| primary.view(), || hits.view());
    executor.run(&[
        kernels::bounce_rays(&parameters, &buffers, from(), at(), bounced.view()),
        kernels::shadow_rays(&parameters, &buffers, from(), at(), shadow.view()),
    ])?;
    let time_of_bounced = closest(&bounced)?;
    let traced_bounced = traced(&bounced)?;
    let time_of_shadow = time(executor, options, || {
        kernels::any_hits(&parameters, &buffers, shadow.view(), occluded.view())
    })?;
    // Where a shadow ray hits does not count, only whether.
    let traced_shadow = Traced {
        rays: shadow.read(executor)?,
        hits: occluded
            .read(executor)?
            .into_iter()
            .map(|hit| Hit { triangle: if hit == 0 { NO_TRIANGLE } else { 0 }, ..Hit::zeroed() })
            .collect(),
    };

    Ok(vec![
        speed(
            "primary",
            time_of_primary,
            check_closest(scene, &traced_primary, options)?,
            &traced_primary,
        ),
        speed(
            "diffuse bounce",
            time_of_bounced,
            check_closest(scene, &traced_bounced, options)?,
            &traced_bounced,
        ),
        speed("shadow", time_of_shadow, check_any(scene, &traced_shadow, options)?, &traced_shadow),
    ])
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

fn speed(kind: &'static str, time: Duration, check: Check, traced: &Traced) -> RaySpeed {
    let count = traced.rays.len() as f64;
    RaySpeed {
        kind,
        mrays_per_second: count / time.as_secs_f64() / 1e6,
        hits: traced.hits.iter().filter(|hit| hit.is_some()).count() as f64 / count,
        checked: check.checked,
        ties: check.ties,
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
    for triangle in 0..scene.scene_triangles.len() as u32 {
        bvh.planes(triangle).test(ray, triangle, &mut hit);
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
            let of_scene = |hit: &Hit| scene.scene_triangles.get(hit.triangle as usize);
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
