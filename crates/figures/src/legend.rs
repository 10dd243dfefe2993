//! What the colours of a picture of numbers mean, as a strip to lie below it.

use super::canvas::{Canvas, font_for, text_width};
use super::scale::{Scale, labels};
use embedded_graphics::mono_font::MonoFont;

/// A legend, laid out for a picture of some width: a title, a bar of the colours with ticks and
/// numbers, and notes.
pub(super) struct Legend<'a> {
    width: u32,
    font: &'static MonoFont<'static>,
    title: Vec<String>,
    scale: Option<Scale>,
    notes: &'a [Note],
}

/// A colour that is not along the bar, or not one value there.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Note {
    /// The colour, sRGB.
    pub color: [u8; 3],
    /// What it stands for.
    pub text: String,
}

/// Columns of a legend at least.
pub(super) const MIN_WIDTH: u32 = 240;

const BLACK: [u8; 3] = [0; 3];

impl<'a> Legend<'a> {
    /// A legend as wide as the picture, or wider where its text would not fit.
    pub fn new(picture_width: u32, title: &str, scale: Option<Scale>, notes: &'a [Note]) -> Self {
        let font = font_for(picture_width);
        let longest_word =
            title.split_whitespace().map(|word| text_width(word, font)).max().unwrap_or(0);
        let width = picture_width.max(MIN_WIDTH).max(longest_word + 2 * margin(font));
        let columns = width - 2 * margin(font);
        let mut lines: Vec<String> = Vec::new();
        for word in title.split_whitespace() {
            match lines.last_mut() {
                Some(line)
                    if text_width(line, font) + text_width(" ", font) + text_width(word, font)
                        <= columns =>
                {
                    line.push(' ');
                    line.push_str(word);
                }
                _ => lines.push(word.to_owned()),
            }
        }
        Self { width, font, title: lines, scale, notes }
    }

    /// Width in pixels, at least that of the picture.
    pub fn width(&self) -> u32 {
        self.width
    }

    /// Height in pixels.
    pub fn height(&self) -> u32 {
        let line = line_height(self.font);
        let bar = if self.scale.is_some() {
            2 * line + tick_length(self.font) + margin(self.font)
        } else {
            0
        };
        2 * margin(self.font) + (self.title.len() + self.notes.len()) as u32 * line + bar
    }

    /// Draws it, from the row `top` of a canvas of [`Self::width`]. `color` gives that of a
    /// position along the bar, 0 to 1.
    pub fn draw(&self, canvas: &mut Canvas, top: u32, color: impl Fn(f64) -> [u8; 3]) {
        let font = self.font;
        let (margin, line) = (margin(font), line_height(font));
        let mut y = top + margin;
        for text in &self.title {
            canvas.write(margin, y, text, font);
            y += line;
        }
        if let Some(scale) = &self.scale {
            self.draw_bar(canvas, y, scale, color);
            y += 2 * line + tick_length(font) + margin;
        }
        for note in self.notes {
            let swatch = font.character_size.height;
            canvas.fill(margin..margin + swatch, y..y + swatch, BLACK);
            canvas.fill(margin + 1..margin + swatch - 1, y + 1..y + swatch - 1, note.color);
            canvas.write(2 * margin + swatch, y, &note.text, font);
            y += line;
        }
    }

    fn draw_bar(
        &self,
        canvas: &mut Canvas,
        top: u32,
        scale: &Scale,
        color: impl Fn(f64) -> [u8; 3],
    ) {
        let font = self.font;
        let (first, last) = (margin(font), self.width - margin(font) - 1);
        let bottom = top + line_height(font);
        for x in first..=last {
            let along = f64::from(x - first) / f64::from(last - first);
            let of_all = if scale.low == scale.high { scale.position(scale.low) } else { along };
            canvas.fill(x..x + 1, top..bottom, color(of_all));
        }
        for tick in self.ticks(scale, first, last) {
            canvas.fill(tick.x..tick.x + 1, bottom..bottom + tick_length(font), BLACK);
            if let Some((x, text)) = tick.label {
                canvas.write(x, bottom + tick_length(font) + 1, &text, font);
            }
        }
    }

    /// The ends and as many round numbers between them as there is room for.
    fn ticks(&self, scale: &Scale, first: u32, last: u32) -> Vec<Tick> {
        let font = self.font;
        let gap = text_width("  ", font);
        let at =
            |value: f64| first + (scale.position(value) * f64::from(last - first)).round() as u32;
        if scale.low == scale.high {
            let text = labels(&[scale.low]).concat();
            let x = at(scale.low);
            return vec![Tick { x, label: Some((x - text_width(&text, font) / 2, text)) }];
        }
        for set in scale.tick_sets() {
            let numbers: Vec<f64> =
                [scale.low].into_iter().chain(set).chain([scale.high]).collect();
            let mut texts = labels(&numbers);
            let (Some(high), low) = (texts.pop(), texts.remove(0)) else { continue };
            let high_start = last + 1 - text_width(&high, font);
            // Between the numbers of the ends.
            let mut free = first + text_width(&low, font) + gap;
            let (from_low, to_high) = (free, high_start.saturating_sub(gap));
            let mut ticks = vec![Tick { x: first, label: Some((first, low)) }];
            let mut fits = true;
            for (&value, text) in numbers[1..].iter().zip(texts) {
                let (x, width) = (at(value), text_width(&text, font));
                let start = x.saturating_sub(width / 2);
                let clear_of_ends = start >= from_low && start + width <= to_high;
                if clear_of_ends {
                    fits &= start >= free;
                    free = start + width + gap;
                }
                ticks.push(Tick { x, label: clear_of_ends.then_some((start, text)) });
            }
            ticks.push(Tick { x: last, label: Some((high_start, high)) });
            if fits {
                return ticks;
            }
        }
        Vec::new()
    }
}

/// A mark below the bar.
struct Tick {
    x: u32,
    /// Its number and the column where that begins.
    label: Option<(u32, String)>,
}

fn margin(font: &MonoFont<'_>) -> u32 {
    font.character_size.height / 2
}

fn line_height(font: &MonoFont<'_>) -> u32 {
    font.character_size.height * 5 / 4
}

fn tick_length(font: &MonoFont<'_>) -> u32 {
    font.character_size.height / 3
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The texts of all numbers, in order; fails where two overlap or one leaves the strip.
    fn numbers(width: u32, low: f64, high: f64) -> Vec<String> {
        let scale = Scale::new(low, high);
        let legend = Legend::new(width, "t", Some(scale), &[]);
        let mut end = 0;
        let ticks = legend.ticks(&scale, 5, legend.width() - 6);
        let label = |tick: Tick| {
            let (start, text) = tick.label?;
            assert!(start >= end, "{low} to {high}: {text} overlaps");
            end = start + text_width(&text, legend.font);
            assert!(end <= legend.width());
            Some(text)
        };
        ticks.into_iter().filter_map(label).collect()
    }

    #[test]
    fn numbers_never_overlap_and_the_ends_are_there() {
        for width in [1, 240, 500, 1300, 4000] {
            assert_eq!(numbers(width, 64.0, 64.0), ["64"]);
            for (low, high) in [
                (0.0, 5.0),
                (3.0, 2000.0),
                (1.234e-30, 5.678e30),
                (-1e9, 1e-9),
                (1000.125, 1000.25),
            ] {
                let numbers = numbers(width, low, high);
                assert!(numbers.len() >= 3, "{width} columns, {low} to {high}: {numbers:?}");
                for (end, text) in [(low, numbers.first()), (high, numbers.last())] {
                    let number: f64 = text.unwrap().parse().unwrap();
                    assert!((number - end).abs() <= 0.005 * end.abs(), "{end} is written {number}");
                }
            }
        }
        assert_eq!(numbers(240, 0.0, 5.0), ["0", "1", "2", "3", "4", "5"]);
        assert_eq!(
            numbers(240, 1e-6_f32.into(), 0.1_f32.into()),
            ["1e-6", "1e-4", "0.001", "0.01", "0.1"]
        );
        assert_eq!(numbers(240, 1.0, 16384.0), ["1", "10", "100", "1000", "16384"]);
    }

    #[test]
    fn a_long_title_is_wrapped_and_a_long_word_widens() {
        let height = |title: &str| Legend::new(16, title, None, &[]).height();
        let line = height("a") - height("");
        assert_eq!(height(&"word ".repeat(20)) - height(""), 3 * line);
        let wide = Legend::new(16, &"x".repeat(100), None, &[]);
        assert_eq!((wide.width(), wide.height()), (610, height("a")));
    }
}
