//! The film on the host: what was measured of every pixel, in rows from the top left.

use glam::{DVec3, Vec3};
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
    /// What is to be added to the mean radiance of each pixel, likewise, so that the picture is
    /// without bias; none where there is no control film (see
    /// [`raystream_shaders::film::control`]).
    pub corrections: Option<Vec<Vec3>>,
    /// What light tracing found of each pixel, likewise: mean radiance over all light paths, linear
    /// Rec.709, to be added to that of the samples; none without light tracing (see
    /// [`raystream_shaders::film::splats`]). All pictures below have it.
    pub splats: Option<Vec<Vec3>>,
    /// The filtered picture of the samples and the squared error that is left in it, likewise; none
    /// where no filter was [asked for](crate::render::Settings::denoise).
    pub denoised: Option<Vec<Estimate>>,
}

impl Film {
    /// A film of samples and features alone, as the fields of these names have them.
    pub fn new(
        width: u32,
        height: u32,
        radiance: Vec<FilmPixel>,
        features: Vec<FeaturePixel>,
    ) -> Self {
        Self {
            width,
            height,
            radiance,
            features,
            estimates: None,
            corrections: None,
            splats: None,
            denoised: None,
        }
    }

    /// The picture: radiance of each pixel, linear Rec.709; what light tracing found, if anything,
    /// where there is no sample. It is [`Self::plain`] with the corrections added, where there are
    /// any; then a component that is noisy and dark may be a little below 0.
    pub fn color(&self) -> Vec<Vec3> {
        let plain = self.plain();
        match &self.corrections {
            Some(corrections) => plain.iter().zip(corrections).map(|(p, c)| p + c).collect(),
            None => plain,
        }
    }

    /// Mean radiance over all samples of each pixel, with what light tracing found, linear Rec.709;
    /// black where there is neither. Where values decide about the numbers of samples it is biased,
    /// by some percent too dark.
    pub fn plain(&self) -> Vec<Vec3> {
        self.with_splats(self.radiance.iter().map(|p| mean(p.sum(), p.samples())))
    }

    /// Variance of each pixel's **mean** over its samples, by component: the squared standard error
    /// of [`Self::plain`], but for that of light tracing, of which nothing is known. Infinite for
    /// fewer than two samples.
    pub fn variance(&self) -> Vec<Vec3> {
        self.radiance
            .iter()
            .map(|p| {
                if p.samples() < 2 {
                    return Vec3::INFINITY;
                }
                let n = f64::from(p.samples());
                let m = (p.first_sum.as_dvec3() + p.second_sum.as_dvec3()) / n;
                let squares = p.sum_of_squares.as_dvec3() / n;
                // Rounding can take a constant pixel below zero.
                ((squares - m * m) / (n - 1.0)).max(DVec3::ZERO).as_vec3()
            })
            .collect()
    }

    /// Means over the first and over the second half of the samples, two independent pictures; none
    /// where no pixel has a second half. With a control film the first half is that. What light
    /// tracing found is the same in both.
    pub fn halves(&self) -> Option<[Vec<Vec3>; 2]> {
        self.radiance.iter().any(|p| p.second_samples > 0).then(|| {
            let first = self.radiance.iter().map(|p| mean(p.first_sum, p.first_samples));
            let second = self.radiance.iter().map(|p| mean(p.second_sum, p.second_samples));
            [self.with_splats(first), self.with_splats(second)]
        })
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
        self.radiance.iter().map(FilmPixel::samples).collect()
    }

    /// The filtered picture, linear Rec.709; none without estimates. What light tracing found is
    /// added to it and not filtered.
    pub fn filtered(&self) -> Option<Vec<Vec3>> {
        let filtered = self.of_estimates(|e| e.filtered)?;
        Some(self.with_splats(filtered.into_iter()))
    }

    /// Estimated squared error of each pixel of [`Self::color`], the mean over the components, in
    /// squared radiance; none without estimates. That of light tracing is not in it: samples do not
    /// make it smaller.
    pub fn squared_error(&self) -> Option<Vec<f32>> {
        self.of_estimates(|e| e.squared_error)
    }

    /// The picture that the filter of [`Settings::denoise`](crate::render::Settings::denoise) has
    /// made, linear Rec.709; none without one. What light tracing found is added to it and not
    /// filtered. A component that is noisy and dark may be a little below 0.
    pub fn denoised(&self) -> Option<Vec<Vec3>> {
        let denoised = self.denoised.as_ref()?;
        Some(self.with_splats(denoised.iter().map(|estimate| estimate.filtered)))
    }

    /// Estimated squared error of each pixel of [`Self::denoised`], as [`Self::squared_error`].
    pub fn denoised_error(&self) -> Option<Vec<f32>> {
        let denoised = self.denoised.as_ref()?;
        Some(denoised.iter().map(|estimate| estimate.squared_error).collect())
    }

    /// The picture to look at: [`Self::denoised`], or else [`Self::color`].
    pub fn best(&self) -> Vec<Vec3> {
        self.denoised().unwrap_or_else(|| self.color())
    }

    fn with_splats(&self, samples: impl Iterator<Item = Vec3>) -> Vec<Vec3> {
        match &self.splats {
            Some(splats) => samples.zip(splats).map(|(color, splat)| color + splat).collect(),
            None => samples.collect(),
        }
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
