//! The mean of a filtered picture: what the filter has lost is given back.
//!
//! Filters lose light: bright paths that few pixels have found look like noise. What a picture
//! lacks of another, whose mean is right, is added as [the control film](crate::film::control) adds
//! it: each pixel gives its whole difference away, to pixels near it that are as noisy as itself.
//! The mean of the picture is then exactly that of the other: of the control film where there is
//! one, else of the film.

use super::PictureParams;
use crate::estimator::Estimate;
use crate::estimator::guide::Guide;
use crate::glam::Vec4;
use crate::memory::access::{Scatter, at};
use crate::memory::device_struct;
#[cfg(target_arch = "spirv")]
use spirv_std::num_traits::Float as _;

/// Samples of a pixel that is given nothing.
const CERTAIN: f32 = 1e30;
/// Samples of a filtered pixel for each of the other picture's: its noise is far below that one's,
/// so that differences must be spread widely.
const RATIO: f32 = 1e30;

device_struct! {
    /// The parameters of [`filtered_differences`]. 32 bytes.
    pub struct MeanParams {
        /// Pixels of the picture.
        pub threads: u32,
        /// Picture width in pixels.
        pub width: u32,
        /// Picture height in pixels.
        pub height: u32,
        /// 1: the first half is a control film, and its mean is the right one; 0: that of all
        /// samples.
        pub control: u32,
        /// Unused; zero.
        pub pad0: u32,
        /// Unused; zero.
        pub pad1: u32,
        /// Unused; zero.
        pub pad2: u32,
        /// Unused; zero.
        pub pad3: u32,
    }
}

/// Kernel: what pixel `lane` lacks and the deviation of a sample, and its counts, as
/// [`control_differences`](crate::film::control::control_differences) has them. What is not
/// measured lacks nothing, and is as good as certain.
pub fn filtered_differences(
    lane: u32,
    params: &MeanParams,
    guides: &[Guide],
    first: &[Vec4],
    picture: &[Estimate],
    differences: &mut Scatter<'_, Vec4>,
    counts: &mut Scatter<'_, Vec4>,
) {
    let MeanParams { threads, width, height, .. } = *params;
    let place = PictureParams { threads, first_rank: 0, width, height }.row_index(lane);
    let guide = at(guides, lane);
    let (mut difference, mut count) = (Vec4::ZERO, Vec4::new(0.0, 0.0, RATIO, CERTAIN));
    if guide.is_measured() {
        let right = if params.control != 0 { at(first, lane).truncate() } else { guide.color };
        let samples = guide.samples as f32;
        difference = (right - at(picture, lane).filtered).extend((guide.variance * samples).sqrt());
        count = count.with_w(samples);
    }
    differences.set(place, difference);
    counts.set(place, count);
}
