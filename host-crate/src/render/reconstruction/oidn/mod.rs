//! The filter `oidn`: Open Image Denoise, where it is installed.

#[cfg(any(unix, windows))]
mod library;
#[cfg(not(any(unix, windows)))]
#[path = "no_library.rs"]
mod library;

use self::library::Oidn2;
use super::{Filter, FilterInputs, FilterView, HostFilter};
use crate::exec::{Array, ExecError, Launch};
use crate::scene::FilmSize;
use glam::Vec3;
use raystream_shaders::estimator::filtered::FilteredPixel;
use raystream_shaders::estimator::guide::{Guide, unpack_normal};
use raystream_shaders::math::random::hash;

/// What pixels are moved by to see how far the filter follows them, by their standard deviations.
const PROBE: f32 = 0.1;
/// Pixels to each side over which that is averaged: a single one says little.
const PROBE_RADIUS: u32 = 3;

/// The environment variable that names the library, where the system does not find it.
pub const VARIABLE: &str = "RAYSTREAM_OIDN";

/// A picture's images, each of as many pixels of three components.
#[cfg_attr(
    not(any(unix, windows)),
    expect(dead_code, reason = "nobody can have a library that reads them")
)]
struct Images<'a> {
    width: u32,
    height: u32,
    color: &'a [[f32; 3]],
    /// Albedo and normal.
    features: Option<[&'a [[f32; 3]]; 2]>,
}

/// Open Image Denoise.
pub struct Oidn {
    library: Oidn2,
}

impl Oidn {
    /// Loads the library.
    ///
    /// # Errors
    /// [`ExecError::Library`] if it is not there, or too old.
    pub fn load() -> Result<Self, ExecError> {
        Ok(Self { library: Oidn2::load().map_err(error)? })
    }
}

fn error(reason: String) -> ExecError {
    ExecError::Library { name: "Open Image Denoise", variable: VARIABLE, reason }
}

impl<B> Filter<B> for Oidn {
    fn launches<'a>(
        &'a self,
        _: &'a FilterInputs<B>,
        _: &FilterView,
        _: &'a Array<B, FilteredPixel>,
    ) -> Vec<Launch<'a, B>> {
        Vec::new()
    }

    fn on_host(&self) -> Option<&dyn HostFilter> {
        Some(self)
    }
}

impl HostFilter for Oidn {
    /// The library does not say how far its picture follows each pixel. So it filters twice, the
    /// second time with all pixels moved a little, up or down by chance: what the picture moves by
    /// along with them is the part that they have in it (Ramani et al., "Monte-Carlo SURE", 2008).
    fn filter(&self, size: FilmSize, guides: &[Guide]) -> Result<Vec<FilteredPixel>, ExecError> {
        let color: Vec<[f32; 3]> = guides.iter().map(|guide| guide.color.to_array()).collect();
        let steps = probe(guides);
        let moved: Vec<[f32; 3]> = guides
            .iter()
            .zip(&steps)
            .map(|(guide, &step)| (guide.color + Vec3::splat(step)).to_array())
            .collect();
        let features = features(guides);
        let filter = |color: &[[f32; 3]]| {
            let features = features.as_ref().map(|[a, n]| [a.as_slice(), n.as_slice()]);
            let FilmSize { width, height } = size;
            self.library.filter(&Images { width, height, color, features }).map_err(error)
        };
        let (picture, moved) = (filter(&color)?, filter(&moved)?);
        let follows: Vec<[f32; 2]> = steps
            .iter()
            .zip(picture.iter().zip(&moved))
            .map(|(&step, (a, b))| {
                let difference = (Vec3::from(*b) - Vec3::from(*a)).element_sum() / 3.0;
                [step * difference, step * step]
            })
            .collect();
        let filtered = guides.iter().zip(picture).enumerate().map(|(place, (guide, color))| {
            if guide.is_measured() {
                let own = follows_about(size, &follows, place as u32);
                FilteredPixel { color: Vec3::from(color), own }
            } else {
                FilteredPixel { color: Vec3::ZERO, own: 1.0 }
            }
        });
        Ok(filtered.collect())
    }
}

/// What each pixel is moved by, up or down by chance.
fn probe(guides: &[Guide]) -> Vec<f32> {
    let step = |(place, guide): (u32, &Guide)| {
        let size = PROBE * guide.variance.sqrt();
        if hash(place) & 1 == 0 { size } else { -size }
    };
    (0..).zip(guides).map(step).collect()
}

/// Albedos and normals, where any pixel has such.
fn features(guides: &[Guide]) -> Option<[Vec<[f32; 3]>; 2]> {
    guides.iter().any(Guide::has_surface).then(|| {
        let normal = |guide: &Guide| {
            if guide.has_surface() { unpack_normal(guide.normal) } else { Vec3::ZERO }
        };
        [
            guides.iter().map(|guide| guide.albedo.to_array()).collect(),
            guides.iter().map(|guide| normal(guide).to_array()).collect(),
        ]
    })
}

/// How far the picture follows the pixels about a place, from 0 to 1.
fn follows_about(size: FilmSize, follows: &[[f32; 2]], place: u32) -> f32 {
    let (x, y) = (place % size.width, place / size.width);
    let about = |at: u32, len: u32| at.saturating_sub(PROBE_RADIUS)..len.min(at + PROBE_RADIUS + 1);
    let (mut along, mut all) = (0.0, 0.0);
    for row in about(y, size.height) {
        for column in about(x, size.width) {
            let [moved, step] = follows[(row * size.width + column) as usize];
            along += moved;
            all += step;
        }
    }
    if all > 0.0 { (along / all).clamp(0.0, 1.0) } else { 0.0 }
}
