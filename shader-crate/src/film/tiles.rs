//! The order of pixels in memory.
//!
//! The picture is cut into tiles of 8x8 pixels, row by row; inside a whole tile pixels follow the
//! Morton curve, inside a cut one (at the right and bottom edges) they go row by row. A pixel's
//! place in this order is its **rank**. Film and sample stream are both in rank order, so that
//! neighbours in memory are neighbours in the picture, and any range of ranks is one piece of film
//! and one piece of stream.

/// Side of a tile in pixels.
pub const TILE: u32 = 8;

/// The pixel `(x, y)` of a rank; `rank < width * height`.
pub fn pixel_of_rank(rank: u32, width: u32, height: u32) -> (u32, u32) {
    let band = rank / (width * TILE);
    let top = band * TILE;
    let rows = TILE.min(height - top);
    let in_band = rank - top * width;
    let tile = in_band / (TILE * rows);
    let left = tile * TILE;
    let columns = TILE.min(width - left);
    let in_tile = in_band - left * rows;
    if rows == TILE && columns == TILE {
        (left + every_second_bit(in_tile), top + every_second_bit(in_tile >> 1))
    } else {
        (left + in_tile % columns, top + in_tile / columns)
    }
}

/// The rank of the pixel `(x, y)`, the inverse of [`pixel_of_rank`].
pub fn rank_of_pixel(x: u32, y: u32, width: u32, height: u32) -> u32 {
    let (left, top) = (x / TILE * TILE, y / TILE * TILE);
    let rows = TILE.min(height - top);
    let columns = TILE.min(width - left);
    let (dx, dy) = (x - left, y - top);
    let in_tile = if rows == TILE && columns == TILE {
        spread_bits(dx) | spread_bits(dy) << 1
    } else {
        dy * columns + dx
    };
    top * width + left * rows + in_tile
}

/// Bits 0, 2 and 4 of `x`, side by side.
fn every_second_bit(x: u32) -> u32 {
    (x & 1) | (x >> 1 & 2) | (x >> 2 & 4)
}

/// The three lowest bits of `x`, moved to bits 0, 2 and 4.
fn spread_bits(x: u32) -> u32 {
    (x & 1) | (x & 2) << 1 | (x & 4) << 2
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ranks_are_a_bijection_for_any_size() {
        for (width, height) in [(1, 1), (8, 8), (7, 5), (9, 17), (16, 8), (33, 20), (64, 3)] {
            let mut seen = [false; 33 * 20];
            for rank in 0..width * height {
                let (x, y) = pixel_of_rank(rank, width, height);
                assert!(x < width && y < height, "{rank} of {width}x{height} -> ({x}, {y})");
                assert_eq!(rank_of_pixel(x, y, width, height), rank);
                let seen = &mut seen[(y * width + x) as usize];
                assert!(!*seen, "pixel ({x}, {y}) of {width}x{height} twice");
                *seen = true;
            }
        }
    }

    #[test]
    fn sixty_four_ranks_are_one_tile() {
        let tile_of = |rank| {
            let (x, y) = pixel_of_rank(rank, 32, 24);
            (x / TILE, y / TILE)
        };
        for rank in 0..32 * 24 {
            assert_eq!(tile_of(rank), tile_of(rank / 64 * 64));
        }
    }
}
