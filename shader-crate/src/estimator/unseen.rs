//! What the samples of a pixel at an edge may have missed.

use crate::estimator::guide::{Guide, mean_of_squares};
use crate::film::tiles::{pixel_of_rank, rank_of_pixel};
use crate::memory::access::at;

/// The squared error, on average over pixels beside an edge, of those whose samples have missed
/// what lies beyond it: an upper bound of about the right size.
///
/// Samples are spread so evenly that `n` of them miss no part of the pixel above `1/n` or so. That
/// a smaller part is covered by what a neighbour shows happens to `1/n` of all pixels at an edge.
/// The part `f` is then anything up to `1/n`, the squared error `f^2` of the squared contrast: a
/// third of `1/n^2` of it on average. (Samples find some of these parts: an edge along an axis
/// leaves a quarter of this.) The pixels have no variance by which one could know them, and beside
/// a lamp they are the worst of a picture.
pub fn unseen_part(guides: &[Guide], rank: u32, width: u32, height: u32) -> f32 {
    let n = at(guides, rank).samples as f32;
    largest_contrast(guides, rank, width, height) / (3.0 * n * n * n)
}

/// The largest squared difference of colour between the pixel of rank `rank` and the eight next to
/// it.
fn largest_contrast(guides: &[Guide], rank: u32, width: u32, height: u32) -> f32 {
    let color = at(guides, rank).color;
    let (x, y) = pixel_of_rank(rank, width, height);
    let (right, bottom) = ((x + 1).min(width - 1), (y + 1).min(height - 1));
    let mut largest = 0.0_f32;
    let mut row = y - y.min(1);
    while row <= bottom {
        let mut column = x - x.min(1);
        while column <= right {
            let tap = at(guides, rank_of_pixel(column, row, width, height));
            if tap.is_measured() {
                largest = mean_of_squares(tap.color - color).max(largest);
            }
            column += 1;
        }
        row += 1;
    }
    largest
}
