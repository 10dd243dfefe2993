//! The path of a sample, over the picture.

use super::style;
use crate::paths::{Drawing, Part};
use eframe::egui::{Color32, Painter, Pos2, Shape, Stroke};

/// Points that a dash is long, and the room after it.
const DASH: f32 = 5.0;

/// Draws it; `to_screen` says where a place of the picture is.
pub fn draw(painter: &Painter, drawing: &Drawing, to_screen: impl Fn([f32; 2]) -> Pos2) {
    let under = Stroke::new(3.5, Color32::from_black_alpha(130));
    for line in &drawing.lines {
        let ends = line.ends.map(&to_screen);
        let (is_whole, color) = match line.part {
            Part::Segment => (true, Color32::WHITE),
            Part::Escape => (false, Color32::WHITE),
            Part::Light => (true, style::LIGHT),
            Part::Shadow => (false, style::SHADOW),
        };
        let stroke = Stroke::new(1.5, color);
        if is_whole {
            painter.line_segment(ends, under);
            painter.line_segment(ends, stroke);
        } else {
            painter.extend(Shape::dashed_line(&ends, under, DASH, DASH));
            painter.extend(Shape::dashed_line(&ends, stroke, DASH, DASH));
        }
    }
    for place in drawing.vertices.iter().flatten() {
        let at = to_screen(*place);
        painter.circle(at, 3.5, Color32::WHITE, Stroke::new(1.5, Color32::from_black_alpha(180)));
    }
}
