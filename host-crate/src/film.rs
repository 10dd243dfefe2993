//! The film on the host: what was measured of every pixel, in rows from the top left.

use glam::Vec3;
use raystream_shaders::estimator::Estimate;
use raystream_shaders::film::FilmPixel;
use raystream_shaders::integrator::first_hits::FeaturePixel;

/// Sums over the samples of each pixel, and what follows from them.
#[derive(Clone, Debug, PartialEq)]
pub struct Film {
    /// Width in pixels.
    pub width: u32,
    /// Height in pixels.
    pub height: u32,
    /// Radiance and sample counts, `width * height`, row by row from the top.
    pub radiance: Vec<FilmPixel>,
    /// First-hit features, likewise.
    pub features: Vec<FeaturePixel>,
    /// What an estimator thinks of each pixel, likewise; none where no estimator ran.
    pub estimates: Option<Vec<Estimate>>,
}

impl Film {
    /// Mean radiance of each pixel, linear Rec.709; black where there is no sample.
    pub fn color(&self) -> Vec<Vec3> {
        self.radiance.iter().map(|p| mean(p.sum, p.samples)).collect()
    }

    /// Variance of each pixel's **mean**, by component: the squared standard error of
    /// [`Self::color`]. Infinite for fewer than two samples.
    pub fn variance(&self) -> Vec<Vec3> {
        self.radiance
            .iter()
            .map(|p| {
                if p.samples < 2 {
                    return Vec3::INFINITY;
                }
                let n = p.samples as f32;
                let m = p.sum / n;
                // Rounding can take a constant pixel below zero.
                ((p.sum_of_squares / n - m * m) / (n - 1.0)).max(Vec3::ZERO)
            })
            .collect()
    }

    /// Means over the even and over the odd samples: two independent pictures.
    pub fn halves(&self) -> [Vec<Vec3>; 2] {
        let half = |odd: bool| {
            self.radiance
                .iter()
                .map(|p| {
                    if odd {
                        mean(p.odd_sum, p.samples / 2)
                    } else {
                        mean(p.sum - p.odd_sum, p.samples.div_ceil(2))
                    }
                })
                .collect()
        };
        [half(false), half(true)]
    }

    /// Mean reflectance of the first surface; black where the camera sees none.
    pub fn albedo(&self) -> Vec<Vec3> {
        self.of_features(|f| mean(f.albedo, f.samples))
    }

    /// Mean shading normal of the first surface, towards the camera.
    pub fn normal(&self) -> Vec<Vec3> {
        self.of_features(|f| mean(f.normal, f.samples))
    }

    /// Mean position of the first surface over the samples that hit one, in world units.
    pub fn position(&self) -> Vec<Vec3> {
        self.of_features(|f| mean(f.position, f.hits))
    }

    /// Mean distance to the first surface over the samples that hit one, in world units.
    pub fn depth(&self) -> Vec<f32> {
        self.features
            .iter()
            .map(|f| if f.hits == 0 { 0.0 } else { f.depth / f.hits as f32 })
            .collect()
    }

    /// Samples of each pixel.
    pub fn samples(&self) -> Vec<u32> {
        self.radiance.iter().map(|p| p.samples).collect()
    }

    /// The filtered picture, linear Rec.709; none without estimates.
    pub fn filtered(&self) -> Option<Vec<Vec3>> {
        self.of_estimates(|e| e.filtered)
    }

    /// Estimated squared error of each pixel of [`Self::color`], the mean over the components, in
    /// squared radiance; none without estimates.
    pub fn squared_error(&self) -> Option<Vec<f32>> {
        self.of_estimates(|e| e.squared_error)
    }

    fn of_estimates<T>(&self, value: impl Fn(&Estimate) -> T) -> Option<Vec<T>> {
        self.estimates.as_ref().map(|estimates| estimates.iter().map(value).collect())
    }

    fn of_features(&self, value: impl Fn(&FeaturePixel) -> Vec3) -> Vec<Vec3> {
        self.features.iter().map(value).collect()
    }
}

fn mean(sum: Vec3, count: u32) -> Vec3 {
    if count == 0 { Vec3::ZERO } else { sum / count as f32 }
}
