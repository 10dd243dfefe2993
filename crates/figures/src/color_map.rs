//! Numbers as colours.

use super::canvas::Canvas;
use super::color_scale::{ColorScale, Place, color_at};
use super::error::FigureError;
use super::legend::{Legend, Note};
use super::scale::Scale;
use raystream::image::{ImageError, write_rgb8};
use std::path::Path;

/// Writes a PNG of one number a pixel as colours (viridis: from dark violet over green to bright
/// yellow, evenly lighter), with a legend below it: a title, the colours with their numbers, and
/// what the other colours stand for.
///
/// `values` holds `width * height` numbers, row by row from the top. `range` gives the numbers at
/// both ends of the colours, the smaller first, so that several pictures can have the same; numbers
/// beyond it get the colour of that end. Without it the colours span the values that there are, at
/// most six decades below the largest where they are logarithmic. A range of more than a decade
/// that begins above zero is logarithmic; then zero is black. What is not finite is magenta.
///
/// The pixels are in the upper left corner. Where the picture is narrower than its legend, white
/// fills the rest of the rows.
///
/// # Errors
/// [`FigureError`] if the values do not fit the picture's size, the range is not of two finite
/// numbers in order, or the file cannot be written. An existing file is then left as it was.
pub fn write_color_map(
    path: &Path,
    width: u32,
    height: u32,
    values: &[f32],
    title: &str,
    range: Option<(f32, f32)>,
) -> Result<(), FigureError> {
    ColorMap { width, height, values, title, range, zero: None }.write(path)
}

/// A picture of one number a pixel.
pub(super) struct ColorMap<'a> {
    pub width: u32,
    pub height: u32,
    /// `width * height` numbers, row by row from the top.
    pub values: &'a [f32],
    pub title: &'a str,
    /// The numbers at both ends of the colours.
    pub range: Option<(f32, f32)>,
    /// What a zero stands for, if that is no value: the legend says so, and the colours leave it
    /// out.
    pub zero: Option<&'a str>,
}

impl ColorMap<'_> {
    /// See [`write_color_map`].
    pub fn write(&self, path: &Path) -> Result<(), FigureError> {
        ImageError::check_buffer(path, "the numbers", self.values.len(), self.width, self.height)?;
        if let Some((low, high)) = self.range
            && !(low.is_finite() && high.is_finite() && low <= high)
        {
            return Err(FigureError::ColorRange { path: path.to_owned(), low, high });
        }
        let colors = self.colors();
        let notes = self.notes(&colors);
        let legend = Legend::new(self.width, self.title, colors.scale, &notes);
        let height =
            self.height.checked_add(legend.height()).ok_or_else(|| ImageError::Encode {
                path: path.to_owned(),
                format: "PNG",
                reason: format!("there is no room for a legend below {} rows", self.height),
            })?;
        let mut canvas = Canvas::new(legend.width(), height);
        for (y, row) in (0..).zip(self.values.chunks_exact(self.width as usize)) {
            for (x, &value) in (0..).zip(row) {
                canvas.set(x, y, colors.color(value));
            }
        }
        legend.draw(&mut canvas, self.height, color_at);
        Ok(write_rgb8(path, legend.width(), height, canvas.bytes())?)
    }

    fn colors(&self) -> ColorScale {
        let zero_is_value = self.zero.is_none();
        match self.range {
            Some((low, high)) => {
                ColorScale { scale: Some(Scale::new(low.into(), high.into())), zero_is_value }
            }
            None => ColorScale::of(self.values.iter().copied(), zero_is_value),
        }
    }

    /// What the legend says of pixels that have no place along the colours.
    fn notes(&self, colors: &ColorScale) -> Vec<Note> {
        let kinds = [
            (Place::Zero, self.zero.unwrap_or("zero")),
            (Place::Below, "below the colours"),
            (Place::Above, "above the colours"),
            (Place::NotFinite, "not finite"),
        ];
        let mut counts = [0_usize; 4];
        for &value in self.values {
            let place = colors.place(value);
            if let Some(kind) = kinds.iter().position(|(kind, _)| *kind == place) {
                counts[kind] += 1;
            }
        }
        let note = |((kind, what), count): ((Place, &str), usize)| {
            let unit = if count == 1 { "pixel" } else { "pixels" };
            Note { color: kind.color(), text: format!("{what}: {count} {unit}") }
        };
        kinds.into_iter().zip(counts).filter(|(_, count)| *count > 0).map(note).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::super::color_scale::{NOT_FINITE, ZERO};
    use super::*;
    use image::RgbImage;
    use raystream::color::srgb_decode;

    const DARK: [u8; 3] = [68, 1, 84];
    const BRIGHT: [u8; 3] = [253, 231, 37];

    fn write(width: u32, height: u32, values: &[f32], range: Option<(f32, f32)>) -> RgbImage {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("map.png");
        write_color_map(&path, width, height, values, "title", range).unwrap();
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 1, "no file but the picture");
        image::open(path).unwrap().into_rgb8()
    }

    fn notes(values: &[f32], range: Option<(f32, f32)>, zero: Option<&str>) -> Vec<String> {
        let map =
            ColorMap { width: values.len() as u32, height: 1, values, title: "", range, zero };
        map.notes(&map.colors()).into_iter().map(|note| note.text).collect()
    }

    /// Pixels of a colour below the first `height` rows.
    fn below(image: &RgbImage, height: u32, color: [u8; 3]) -> usize {
        image.enumerate_pixels().filter(|(_, y, p)| *y >= height && p.0 == color).count()
    }

    #[test]
    fn the_map_has_its_ends_and_gets_ever_lighter() {
        assert_eq!((color_at(0.0), color_at(1.0)), (DARK, BRIGHT));
        let luminance = |t: f64| {
            let [r, g, b] = color_at(t).map(|c| srgb_decode(f64::from(c) / 255.0));
            0.2126 * r + 0.7152 * g + 0.0722 * b
        };
        let lightness: Vec<f64> =
            (0..=100).map(|i| 116.0 * luminance(f64::from(i) / 100.0).cbrt() - 16.0).collect();
        for pair in lightness.windows(2) {
            // 0.76 on average; rounded to bytes.
            assert!((0.3..1.3).contains(&(pair[1] - pair[0])), "{pair:?}");
        }
        for i in 0..=100 {
            let [r, g, b] = color_at(f64::from(i) / 100.0);
            assert!(g > 60 || r < 120, "{r} {g} {b} is far from magenta");
        }
    }

    #[test]
    fn the_legend_lies_below_the_picture() {
        let (width, height) = (300, 20);
        let values: Vec<f32> = (0..width * height).map(|i| (i % width) as f32).collect();
        let image = write(width, height, &values, None);
        assert_eq!(image.width(), width);
        assert!(image.height() > height + 30);
        for (x, y, pixel) in image.enumerate_pixels().filter(|(_, y, _)| *y < height) {
            // Linear would be otherwise: zeros and a range above a decade.
            let expected = if x == 0 { ZERO } else { color_at(f64::from(x).ln() / 299_f64.ln()) };
            assert_eq!(pixel.0, expected, "at ({x}, {y})");
        }
        // A row of the bar, from one end of the colours to the other.
        let bar =
            (height..image.height()).find(|&y| image.get_pixel(5, y).0 == DARK).expect("a bar");
        assert_eq!(image.get_pixel(294, bar).0, BRIGHT);
        assert_eq!(image.get_pixel(150, bar).0, color_at(145.0 / 289.0));
        assert!(below(&image, height, [0; 3]) > 150, "title, ticks and numbers");
        assert_eq!(below(&image, height, NOT_FINITE), 0);
    }

    #[test]
    fn tiny_pictures_have_a_whole_legend() {
        for (width, height) in [(16, 12), (1, 1), (1, 300)] {
            let values: Vec<f32> = (0..width * height).map(|i| 1.0 + i as f32).collect();
            let image = write(width, height, &values, Some((1.0, 5.0)));
            assert_eq!(image.width(), 240);
            assert_eq!(image.get_pixel(0, 0).0, DARK);
            assert_eq!(image.get_pixel(width, 0).0, [255; 3], "white beside the picture");
            assert!(below(&image, height, BRIGHT) > 0 && below(&image, height, [0; 3]) > 50);
        }
    }

    #[test]
    fn what_is_not_finite_is_magenta_and_in_the_legend() {
        let values = [1.0, f32::NAN, f32::INFINITY, 2.0, f32::NEG_INFINITY, 3.0];
        let image = write(3, 2, &values, None);
        let colors: Vec<_> = (0..6).map(|i| image.get_pixel(i % 3, i / 3).0).collect();
        assert_eq!(colors, [DARK, NOT_FINITE, NOT_FINITE, color_at(0.5), NOT_FINITE, BRIGHT]);
        assert!(below(&image, 2, NOT_FINITE) >= 50);
        assert_eq!(notes(&values, None, None), ["not finite: 3 pixels"]);
        let none = write(3, 1, &[f32::NAN; 3], None);
        assert_eq!(none.get_pixel(2, 0).0, NOT_FINITE);
        assert_eq!(below(&none, 1, DARK), 0, "no bar without values");
    }

    #[test]
    fn equal_values_have_one_colour() {
        for value in [64.0, 0.0, -1.0, f32::MAX, 1e-45] {
            let image = write(20, 3, &[value; 60], None);
            assert_eq!(image.get_pixel(7, 2).0, color_at(0.5));
            assert!(below(&image, 3, color_at(0.5)) > 1000, "the bar has the same");
            assert_eq!(notes(&[value; 60], None, None), [""; 0]);
        }
    }

    #[test]
    fn zeros_without_a_place() {
        let logarithmic = [0.0, 1.0, 100.0];
        let image = write(3, 1, &logarithmic, None);
        assert_eq!([0, 1, 2].map(|x| image.get_pixel(x, 0).0), [ZERO, DARK, BRIGHT]);
        assert_eq!(notes(&logarithmic, None, None), ["zero: 1 pixel"]);
        assert_eq!(
            notes(&[0.0, 3.0, 5.0], None, None),
            [""; 0],
            "a linear scale has a place for it"
        );
        assert_eq!(
            notes(&[0.0, 0.0, 3.0, 5.0], None, Some("no surface")),
            ["no surface: 2 pixels"]
        );
        assert_eq!(notes(&[0.0, -0.0], None, Some("no surface")), ["no surface: 2 pixels"]);
    }

    #[test]
    fn a_given_range_holds() {
        let values = [0.5, 1.0, 3.0, 5.0, 9.0, 7.0];
        let image = write(6, 1, &values, Some((1.0, 5.0)));
        let colors: Vec<_> = (0..6).map(|x| image.get_pixel(x, 0).0).collect();
        assert_eq!(colors, [DARK, DARK, color_at(0.5), BRIGHT, BRIGHT, BRIGHT]);
        assert_eq!(
            notes(&values, Some((1.0, 5.0)), None),
            ["below the colours: 1 pixel", "above the colours: 2 pixels"]
        );
    }

    #[test]
    fn unfit_values_and_ranges_are_refused_and_the_old_file_stays() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.png");
        std::fs::write(&path, b"old").unwrap();
        for (width, height) in [(2, 2), (0, 0), (1, u32::MAX)] {
            let error = write_color_map(&path, width, height, &[1.0; 3], "", None).unwrap_err();
            assert!(matches!(error, FigureError::Image(ImageError::BufferSize { .. })), "{error}");
        }
        for range in [(2.0, 1.0), (f32::NAN, 1.0), (0.0, f32::INFINITY)] {
            let error = write_color_map(&path, 3, 1, &[1.0; 3], "", Some(range)).unwrap_err();
            assert!(
                error.to_string().contains("a.png")
                    && matches!(error, FigureError::ColorRange { .. }),
                "{error}"
            );
        }
        assert_eq!(std::fs::read(&path).unwrap(), b"old");
    }
}
