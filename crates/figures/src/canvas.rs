//! A picture of bytes to draw on.

use embedded_graphics::Drawable;
use embedded_graphics::Pixel;
use embedded_graphics::draw_target::DrawTarget;
use embedded_graphics::geometry::{OriginDimensions, Point, Size};
use embedded_graphics::mono_font::iso_8859_1::{FONT_6X10, FONT_8X13, FONT_10X20};
use embedded_graphics::mono_font::{MonoFont, MonoTextStyle};
use embedded_graphics::pixelcolor::{Rgb888, RgbColor};
use embedded_graphics::text::{Baseline, Text};
use std::convert::Infallible;
use std::ops::Range;

/// A picture of 3 bytes a pixel (red, green, blue, sRGB), row by row from the top.
pub(super) struct Canvas {
    width: u32,
    height: u32,
    bytes: Vec<u8>,
}

impl Canvas {
    /// A white picture.
    pub fn new(width: u32, height: u32) -> Self {
        Self { width, height, bytes: vec![255; width as usize * height as usize * 3] }
    }

    /// The pixels, `3 * width * height` bytes.
    pub fn bytes(&self) -> &[u8] {
        &self.bytes
    }

    /// Colours a pixel; one outside the picture is left out.
    pub fn set(&mut self, x: u32, y: u32, color: [u8; 3]) {
        if x < self.width && y < self.height {
            let start = (y as usize * self.width as usize + x as usize) * 3;
            self.bytes[start..start + 3].copy_from_slice(&color);
        }
    }

    /// Colours a rectangle.
    pub fn fill(&mut self, columns: Range<u32>, rows: Range<u32>, color: [u8; 3]) {
        for y in rows {
            for x in columns.clone() {
                self.set(x, y, color);
            }
        }
    }

    /// Writes black text, its upper left corner at (`x`, `y`). A letter that is not in Latin-1
    /// becomes a question mark.
    pub fn write(&mut self, x: u32, y: u32, text: &str, font: &MonoFont<'_>) {
        // Beyond that there is no picture.
        if let (Ok(x), Ok(y)) = (x.try_into(), y.try_into()) {
            let style = MonoTextStyle::new(font, Rgb888::BLACK);
            let Ok(_) =
                Text::with_baseline(text, Point::new(x, y), style, Baseline::Top).draw(self);
        }
    }
}

impl OriginDimensions for Canvas {
    fn size(&self) -> Size {
        Size::new(self.width, self.height)
    }
}

impl DrawTarget for Canvas {
    type Color = Rgb888;
    type Error = Infallible;

    fn draw_iter<I: IntoIterator<Item = Pixel<Rgb888>>>(
        &mut self,
        pixels: I,
    ) -> Result<(), Infallible> {
        for Pixel(point, color) in pixels {
            if let (Ok(x), Ok(y)) = (point.x.try_into(), point.y.try_into()) {
                self.set(x, y, [color.r(), color.g(), color.b()]);
            }
        }
        Ok(())
    }
}

/// A font that can be read in a picture of so many columns seen as a whole.
pub(super) fn font_for(width: u32) -> &'static MonoFont<'static> {
    match width {
        0..480 => &FONT_6X10,
        480..1200 => &FONT_8X13,
        1200.. => &FONT_10X20,
    }
}

/// Columns that a text takes.
pub(super) fn text_width(text: &str, font: &MonoFont<'_>) -> u32 {
    text.chars().count() as u32 * (font.character_size.width + font.character_spacing)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn text_is_black_on_white_and_where_it_should_be() {
        for font in [&FONT_6X10, &FONT_8X13, &FONT_10X20] {
            let (width, height) = (60, 40);
            let mut canvas = Canvas::new(width, height);
            canvas.write(10, 5, "8ü☀", font);
            let (w, h) = (text_width("8ü☀", font), font.character_size.height);
            let mut black = 0;
            for (i, color) in canvas.bytes().chunks(3).enumerate() {
                let (x, y) = (i as u32 % width, i as u32 / width);
                let inside = (10..10 + w).contains(&x) && (5..5 + h).contains(&y);
                assert!(color == [255; 3] || inside && color == [0; 3], "{color:?} at ({x}, {y})");
                black += u32::from(color == [0; 3]);
            }
            assert!(black > w * h / 20, "{black} black pixels");
        }
    }

    #[test]
    fn what_lies_outside_is_left_out() {
        let mut canvas = Canvas::new(3, 2);
        canvas.set(3, 0, [0; 3]);
        canvas.set(0, 2, [0; 3]);
        canvas.write(u32::MAX, u32::MAX, "8", &FONT_6X10);
        assert_eq!(canvas.bytes(), [255; 18]);
        canvas.fill(1..9, 1..9, [1, 2, 3]);
        assert_eq!(canvas.bytes()[9..], [255, 255, 255, 1, 2, 3, 1, 2, 3]);
    }
}
