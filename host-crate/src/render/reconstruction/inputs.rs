//! What filters look at, on a device.

use crate::exec::{Array, ExecError, Executor, Launch, kernels};
use crate::render::film::FilmBuffers;
use crate::render::film::control::{blur, gaussian};
use crate::scene::FilmSize;
use bytemuck::Zeroable;
use glam::Vec4;
use raystream_shaders::estimator::guide::{Guide, GuideParams, SUM_OF_SQUARES};
use raystream_shaders::reconstruction::PictureParams;
use raystream_shaders::reconstruction::halves::HalvesParams;
use raystream_shaders::scene::camera::Camera;

/// Standard deviation, in pixels, of the Gaussian over which variances are compared.
const NOISE_SIGMA: f32 = 4.0;
/// Standard deviations at which Gaussians are cut off.
const CUT: f32 = 2.5;

/// Every pixel as filters see it, in rank order, and memory for passes over rows.
pub struct FilterInputs<B> {
    /// Size of the picture.
    pub size: FilmSize,
    /// Means, variances and features.
    pub guides: Array<B, Guide>,
    /// Mean of the first half and its variance, see
    /// [`make_halves`](raystream_shaders::reconstruction::halves::make_halves).
    pub first: Array<B, Vec4>,
    /// The same of the second half.
    pub second: Array<B, Vec4>,
    /// In rows, for what is to be blurred.
    pub rows: Array<B, Vec4>,
    /// In rows, for the time between two passes of a blur.
    pub scratch: Array<B, Vec4>,
}

/// From where a picture was taken, and how bright it is.
#[derive(Clone, Copy, Debug)]
pub struct FilterView {
    /// The camera, of the picture's size.
    pub camera: Camera,
    /// Mean radiance of the picture, at least 0, about: what is a thousandth of it is dark.
    pub mean_radiance: f32,
}

impl<B> FilterInputs<B> {
    /// For a picture of `size`.
    ///
    /// # Errors
    /// If the device has no room for them, or cannot give them to a kernel as a whole.
    pub fn new<E: Executor<Buffer = B>>(executor: &E, size: FilmSize) -> Result<Self, ExecError> {
        const LABEL: &str = "what a filter looks at in so large a picture";
        let pixels = (size.width * size.height) as usize;
        let vectors = || Array::zeroed(executor, LABEL, pixels);
        Ok(Self {
            size,
            guides: Array::zeroed(executor, LABEL, pixels)?,
            first: vectors()?,
            second: vectors()?,
            rows: vectors()?,
            scratch: vectors()?,
        })
    }

    /// The parameters of a pass over all pixels.
    pub fn parameters(&self) -> PictureParams {
        let FilmSize { width, height } = self.size;
        PictureParams { threads: width * height, first_rank: 0, width, height }
    }

    /// The launches after which the inputs are those of `film`, which is of their size.
    pub fn launches<'a>(&'a self, film: &'a FilmBuffers<B>) -> Vec<Launch<'a, B>> {
        let FilmSize { width, height } = self.size;
        let unit_exponent = film.unit_exponent();
        let mut launches = Vec::new();
        for band in film.bands() {
            let threads = band.film.len() as u32;
            let parameters = GuideParams { threads, spread: SUM_OF_SQUARES, unit_exponent, pad: 0 };
            launches.push(kernels::make_guides(
                &parameters,
                band.film.view(),
                band.features.view(),
                self.guides.slice(band.ranks()),
            ));
            let parameters = HalvesParams {
                threads,
                first_rank: band.first_rank,
                width,
                height,
                unit_exponent,
                ..HalvesParams::zeroed()
            };
            launches.push(kernels::make_halves(
                &parameters,
                band.film.view(),
                self.first.slice(band.ranks()),
                self.second.slice(band.ranks()),
                self.rows.view(),
            ));
        }
        launches.extend(self.calibration());
        launches
    }

    /// The launches that scale the variances of guides and halves to what [`Self::rows`] says of
    /// noise, see [`calibrate`](raystream_shaders::reconstruction::halves::calibrate): the last
    /// step of [`Self::launches`].
    pub fn calibration(&self) -> Vec<Launch<'_, B>> {
        let calibrate = kernels::calibrate(
            &self.parameters(),
            self.rows.view(),
            self.guides.view(),
            self.first.view(),
            self.second.view(),
        );
        self.blur(NOISE_SIGMA).into_iter().chain([calibrate]).collect()
    }

    /// Sums over [`Self::rows`] by the weights of a Gaussian that are 1 at the pixel itself.
    pub fn blur(&self, sigma: f32) -> [Launch<'_, B>; 2] {
        blur(&gaussian(self.size, sigma, CUT), &self.rows, &self.scratch, &self.rows)
    }
}
