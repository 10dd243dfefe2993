//! What estimators work on, and their launches.

use crate::exec::{Array, ExecError, Executor, Launch, kernels};
use crate::render::film::{Band, FilmBuffers, in_rows};
use crate::render::reconstruction::{FilterView, FilteredPicture, axis_aligned};
use crate::render::settings::estimation::Estimator;
use crate::render::settings::sampling::{AllocatorKind, Sampling};
use crate::scene::FilmSize;
use bytemuck::Zeroable;
use raystream_shaders::estimator::bilateral::FilterParams;
use raystream_shaders::estimator::filtered::FilteredParams;
use raystream_shaders::estimator::guide::{Guide, GuideParams, HALVES, SUM_OF_SQUARES};
use raystream_shaders::estimator::{ErrorForm, ErrorTotal, Estimate, NoiseParams, TotalParams};
use raystream_shaders::reconstruction::axis_aligned::AxisParams;
use raystream_shaders::scene::camera::Camera;

/// What the largest buffer is called in errors.
const GUIDES: &str = "what estimates the errors of so large a picture";
/// Threads that add up errors.
const ADDERS: u32 = 4096;

/// Estimates of every pixel, in rank order. Filters look across bands, so these buffers are whole:
/// 48 bytes a pixel are the largest.
pub struct EstimateBuffers<B> {
    size: FilmSize,
    sight: Sight<B>,
    estimates: Array<B, Estimate>,
    errors: Array<B, f32>,
    totals: Array<B, ErrorTotal>,
}

/// What an estimator looks at.
enum Sight<B> {
    /// Guides alone.
    Guides(Array<B, Guide>),
    /// What a filter makes of them.
    Filtered(Box<FilteredPicture<B>>),
}

/// What estimators need to know of the round that their errors are for.
#[derive(Clone, Copy, Debug)]
pub struct ComingRound {
    /// Samples that it gives a pixel on average; above 0.
    pub samples: f32,
    /// Mean radiance of the picture so far, over pixels and components; at least 0. Relative errors
    /// have a soft floor at a [part](raystream_shaders::estimator::SOFT_FLOOR) of it.
    pub mean_radiance: f32,
}

/// The noise of a picture, by its estimates.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Noise {
    /// Root of the mean over the pixels of the relative squared error; 1 is as large as the
    /// picture.
    pub relative_error: f64,
    /// Pixels that have not converged.
    pub unconverged: u64,
    /// Mean radiance of the estimates' picture, over pixels and components.
    pub mean_radiance: f64,
}

impl<B: Send + Sync + 'static> EstimateBuffers<B> {
    /// Fails where a picture of `size` is too large for a device, whose kernels must be given all
    /// guides at once.
    pub fn check<E: Executor<Buffer = B>>(executor: &E, size: FilmSize) -> Result<(), ExecError> {
        let bytes = u64::from(size.width) * u64::from(size.height) * size_of::<Guide>() as u64;
        executor.check_size(GUIDES, bytes)
    }

    /// Buffers for a picture of `size` and the estimator of `sampling`.
    ///
    /// # Errors
    /// If the device has no room for them, or cannot give them to a kernel as a whole.
    pub fn new<E: Executor<Buffer = B>>(
        executor: &E,
        size: FilmSize,
        sampling: &Sampling,
    ) -> Result<Self, ExecError> {
        let pixels = (size.width * size.height) as usize;
        let sight = match sampling.estimator.filter() {
            None => Sight::Guides(Array::zeroed(executor, GUIDES, pixels)?),
            Some(kind) => {
                let settings = sampling.estimation.filter;
                Sight::Filtered(Box::new(FilteredPicture::new(executor, size, kind, settings)?))
            }
        };
        Ok(Self {
            size,
            sight,
            estimates: Array::zeroed(executor, "estimates", pixels)?,
            errors: Array::zeroed(executor, "errors", pixels)?,
            totals: Array::zeroed(executor, "sums of errors", ADDERS as usize)?,
        })
    }

    /// The launches after which [`errors`](Self::errors) is what `sampling` asks for, given the
    /// film. The film and `camera` are of the size that these buffers are for, the estimator is
    /// theirs.
    pub fn launches<'a>(
        &'a self,
        film: &'a FilmBuffers<B>,
        camera: &Camera,
        sampling: &Sampling,
        round: ComingRound,
    ) -> Vec<Launch<'a, B>> {
        let form = error_form(sampling, round);
        // All that is seen comes before the first estimate: those at a band's border look across
        // it.
        let mut launches = match &self.sight {
            Sight::Guides(guides) => guide_launches(guides, film, sampling.estimator),
            Sight::Filtered(picture) => {
                let view = FilterView { camera: *camera, mean_radiance: round.mean_radiance };
                picture.launches(film, &view)
            }
        };
        launches.extend(film.bands().iter().map(|band| match &self.sight {
            Sight::Guides(guides) => self.by_guides(guides, band, camera, sampling, form),
            Sight::Filtered(picture) => self.by_filter(picture, band, form),
        }));
        launches
    }

    fn by_filter<'a>(
        &'a self,
        picture: &'a FilteredPicture<B>,
        band: &'a Band<B>,
        form: ErrorForm,
    ) -> Launch<'a, B> {
        let FilmSize { width, height } = self.size;
        let parameters = FilteredParams {
            threads: band.film.len() as u32,
            first_rank: band.first_rank,
            width,
            height,
            form,
        };
        kernels::filtered_errors(
            &parameters,
            picture.inputs().guides.view(),
            picture.filtered().view(),
            band.film.view(),
            self.estimates.slice(band.ranks()),
            self.errors.slice(band.ranks()),
        )
    }

    fn by_guides<'a>(
        &'a self,
        guides: &'a Array<B, Guide>,
        band: &'a Band<B>,
        camera: &Camera,
        sampling: &Sampling,
        form: ErrorForm,
    ) -> Launch<'a, B> {
        let (threads, first_rank) = (band.film.len() as u32, band.first_rank);
        let FilmSize { width, height } = self.size;
        let (guides, film) = (guides.view(), band.film.view());
        let estimates = self.estimates.slice(band.ranks());
        let errors = self.errors.slice(band.ranks());
        if sampling.estimator == Estimator::Bilateral {
            let shared = sampling.estimation.filter.parameters(camera, form);
            let parameters = FilterParams { threads, first_rank, ..shared };
            return kernels::filter_errors(&parameters, guides, film, estimates, errors);
        }
        if sampling.estimator == Estimator::AxisAligned {
            let shared = axis_aligned::parameters(camera);
            let parameters = AxisParams { threads, first_rank, form, ..shared };
            return kernels::axis_rates(&parameters, guides, film, estimates, errors);
        }
        let smooth = u32::from(sampling.estimation.smooth);
        let noise = NoiseParams {
            threads,
            first_rank,
            width,
            height,
            form,
            smooth,
            ..NoiseParams::zeroed()
        };
        kernels::noise_errors(&noise, guides, film, estimates, errors)
    }

    /// The allocators' errors, in rank order: at least 0, or
    /// [`CONVERGED`](raystream_shaders::estimator::CONVERGED).
    pub fn errors(&self) -> &Array<B, f32> {
        &self.errors
    }

    /// Copies the estimates to the host, in rows.
    pub fn read<E: Executor<Buffer = B>>(&self, executor: &E) -> Result<Vec<Estimate>, ExecError> {
        Ok(in_rows(self.size, &self.estimates.read(executor)?))
    }

    /// The noise by the last estimates; `mean_radiance` as in [`ComingRound`].
    pub fn noise<E: Executor<Buffer = B>>(
        &self,
        executor: &E,
        mean_radiance: f32,
    ) -> Result<Noise, ExecError> {
        self.noise_of(executor, &self.estimates, mean_radiance)
    }

    /// The same of `picture`, estimates of another picture of the film in rank order; pixels
    /// converge by the last errors all the same.
    pub fn noise_of<E: Executor<Buffer = B>>(
        &self,
        executor: &E,
        picture: &Array<B, Estimate>,
        mean_radiance: f32,
    ) -> Result<Noise, ExecError> {
        let pixels = self.errors.len() as u32;
        let parameters = TotalParams { threads: ADDERS, pixels, mean_radiance, pad: 0 };
        executor.run(&[kernels::total_errors(
            &parameters,
            picture.view(),
            self.errors.view(),
            self.totals.view(),
        )])?;
        let totals = self.totals.read(executor)?;
        let mean = |of: fn(&ErrorTotal) -> f32| {
            totals.iter().map(|t| f64::from(of(t))).sum::<f64>() / f64::from(pixels)
        };
        Ok(Noise {
            relative_error: mean(|t| t.relative_error).sqrt(),
            unconverged: totals.iter().map(|t| u64::from(t.unconverged)).sum(),
            mean_radiance: mean(|t| t.radiance),
        })
    }
}

/// The launches after which `guides` are those of `film`.
fn guide_launches<'a, B>(
    guides: &'a Array<B, Guide>,
    film: &'a FilmBuffers<B>,
    estimator: Estimator,
) -> Vec<Launch<'a, B>> {
    let spread = if estimator == Estimator::Halves { HALVES } else { SUM_OF_SQUARES };
    let of_band = |band: &'a Band<B>| {
        let threads = band.film.len() as u32;
        let unit_exponent = film.unit_exponent();
        let parameters = GuideParams { threads, spread, unit_exponent, pad: 0 };
        let guides = guides.slice(band.ranks());
        kernels::make_guides(&parameters, band.film.view(), band.features.view(), guides)
    };
    film.bands().iter().map(of_band).collect()
}

/// How errors follow from estimates.
fn error_form(sampling: &Sampling, round: ComingRound) -> ErrorForm {
    // Deficits are those of counts, which go by deviations.
    let fills_up = sampling.allocator == AllocatorKind::Runs;
    ErrorForm {
        samples_of_round: if fills_up { 0.0 } else { round.samples },
        mean_radiance: round.mean_radiance,
        noise: sampling.noise.unwrap_or(0.0),
        relative: u32::from(sampling.relative),
    }
}
