//! Pictures of what kernels of a round have written.

use crate::page::Painted;
use glam::Vec3;
use raystream::image::{Display, ToneMap};
use raystream::scene::FilmSize;
use raystream_figures::ColorScale;
use raystream_shaders::estimator::guide::{Guide, unpack_normal};
use raystream_shaders::film::stream::{NO_PIXEL, Slot};
use raystream_shaders::film::sums::PixelSums;
use raystream_shaders::film::tiles::{pixel_of_rank, rank_of_pixel};

/// Colours as they are, without a tone map.
const TRUE: Display = Display { exposure: 0.0, tone_map: ToneMap::Clip };

/// Paints values that are in rank order, one for each pixel of a picture.
#[derive(Clone, Copy)]
pub struct Painter {
    /// The picture's size.
    pub size: FilmSize,
}

impl Painter {
    /// The values in rows from the top.
    fn in_rows<T: Copy>(self, ranked: &[T]) -> Vec<T> {
        let FilmSize { width, height } = self.size;
        let rows = (0..height).flat_map(|y| (0..width).map(move |x| (x, y)));
        rows.map(|(x, y)| ranked[rank_of_pixel(x, y, width, height) as usize]).collect()
    }

    fn picture(self, title: &'static str, colors: &[[u8; 3]]) -> Painted {
        let size = [self.size.width, self.size.height];
        painted(title, size, &self.in_rows(colors))
    }

    /// Radiance.
    pub fn radiance(self, title: &'static str, radiance: &[Vec3]) -> Painted {
        self.picture(title, &shown(radiance, Display::default()))
    }

    /// Colours from 0 to 1.
    pub fn colors(self, title: &'static str, colors: &[Vec3]) -> Painted {
        self.picture(title, &shown(colors, TRUE))
    }

    /// Numbers by colours, with a legend. Where a zero is no value, it is black.
    pub fn numbers(self, title: &'static str, numbers: &[f32], zero_is_value: bool) -> Painted {
        let scale = ColorScale::of(numbers.iter().copied(), zero_is_value);
        let colors: Vec<_> = numbers.iter().map(|&number| scale.color(number)).collect();
        Painted {
            ticks: scale.ticks(4),
            colors: (0..64).map(|step| scale.color_along(f64::from(step) / 63.0)).collect(),
            ..self.picture(title, &colors)
        }
    }

    /// What estimators see of the surfaces behind pixels: reflectance, normals and places.
    pub fn surfaces(self, guides: &[Guide]) -> [Painted; 3] {
        let of = |value: fn(&Guide) -> Vec3| -> Vec<Vec3> {
            let value = |guide: &Guide| {
                if guide.has_surface() { value(guide) } else { Vec3::ZERO }
            };
            guides.iter().map(value).collect()
        };
        let normals = of(|guide| 0.5 + 0.5 * unpack_normal(guide.normal));
        let mut places = of(|guide| guide.position);
        let seen = || places.iter().zip(guides).filter(|(_, guide)| guide.has_surface());
        let low = seen().fold(Vec3::INFINITY, |low, (place, _)| low.min(*place));
        let high = seen().fold(Vec3::NEG_INFINITY, |high, (place, _)| high.max(*place));
        let across = (high - low).max(Vec3::splat(f32::MIN_POSITIVE));
        for (place, guide) in places.iter_mut().zip(guides) {
            if guide.has_surface() {
                *place = (*place - low) / across;
            }
        }
        [
            self.colors("reflectance", &of(|guide| guide.albedo)),
            self.colors("normal: red +x, green +y, blue +z", &normals),
            self.colors("position, the scene's ends dark and bright", &places),
        ]
    }

    /// A stream in the order of its slots, in rows as wide as the picture: the radiance of each.
    pub fn stream(self, title: &'static str, radiance: &[Vec3]) -> Painted {
        self.list(title, shown(radiance, Display::default()))
    }

    /// A stream in the order of its slots, each in the colour of its pixel's place: the more red
    /// the farther right, the more green the farther down; empty ones black.
    pub fn slots(self, title: &'static str, slots: &[Slot]) -> Painted {
        let FilmSize { width, height } = self.size;
        let color = |slot: &Slot| match slot.rank {
            NO_PIXEL => [0; 3],
            rank => {
                let (x, y) = pixel_of_rank(rank, width, height);
                let part =
                    |at: u32, of: u32| (255 * at / of.max(2).saturating_sub(1)).min(255) as u8;
                [part(x, width), part(y, height), 160]
            }
        };
        self.list(title, slots.iter().map(color).collect())
    }

    fn list(self, title: &'static str, mut colors: Vec<[u8; 3]>) -> Painted {
        let width = self.size.width;
        let height = (colors.len() as u32).div_ceil(width).max(1);
        colors.resize((width * height) as usize, [0; 3]);
        painted(title, [width, height], &colors)
    }
}

/// Mean radiance of each pixel of a film; black where there is no sample.
pub fn means(film: &[PixelSums], unit_exponent: i32) -> Vec<Vec3> {
    let mean = |sums: &PixelSums| {
        let pixel = sums.to_pixel(unit_exponent);
        pixel.sum() / pixel.samples().max(1) as f32
    };
    film.iter().map(mean).collect()
}

fn shown(colors: &[Vec3], display: Display) -> Vec<[u8; 3]> {
    colors.iter().map(|color| display.srgb8(*color)).collect()
}

fn painted(title: &'static str, size: [u32; 2], colors: &[[u8; 3]]) -> Painted {
    let rgba = colors.iter().flat_map(|&[r, g, b]| [r, g, b, 255]).collect();
    Painted { size, rgba, title, ticks: Vec::new(), colors: Vec::new() }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SIZE: FilmSize = FilmSize { width: 19, height: 11 };

    #[test]
    fn every_pixel_is_where_it_belongs() {
        let FilmSize { width, height } = SIZE;
        let mut ranked = vec![Vec3::ZERO; (width * height) as usize];
        ranked[rank_of_pixel(17, 9, width, height) as usize] = Vec3::X;
        let painted = Painter { size: SIZE }.colors("a", &ranked);
        assert_eq!(painted.size, [width, height]);
        let bright: Vec<_> =
            painted.rgba.chunks(4).enumerate().filter(|(_, color)| color[0] > 0).collect();
        assert_eq!(bright, [(9 * 19 + 17, &[255, 0, 0, 255][..])]);
    }

    #[test]
    fn a_stream_is_as_wide_as_the_picture_and_its_last_row_is_filled_up() {
        let painter = Painter { size: SIZE };
        let rank = rank_of_pixel(18, 0, 19, 11);
        let slots = [rank, NO_PIXEL].map(|rank| Slot { rank, sample: 0 });
        let painted = painter.slots("b", &slots);
        assert_eq!((painted.size, painted.rgba.len()), ([19, 1], 4 * 19));
        assert_eq!(painted.rgba[..8], [255, 0, 160, 255, 0, 0, 0, 255]);
        assert_eq!(painter.stream("c", &[Vec3::ONE; 20]).size, [19, 2]);
        assert_eq!(painter.stream("c", &[]).size, [19, 1]);
    }

    #[test]
    fn surfaces_that_are_not_there_are_black() {
        let guides = vec![Guide { normal: u32::MAX, ..Guide::default() }; 19 * 11];
        assert!(!guides[0].has_surface());
        for painted in (Painter { size: SIZE }).surfaces(&guides) {
            assert!(painted.rgba.chunks(4).all(|color| color == [0, 0, 0, 255]));
        }
    }
}
