//! The error over time.

use super::style;
use crate::viewer::Viewer;
use eframe::egui::{Color32, Ui};
use egui_plot::{GridInput, GridMark, Line, LineStyle, Plot, PlotPoints};
use std::ops::RangeInclusive;

/// Draws the curves of all renders, both axes logarithmic.
pub fn show(ui: &mut Ui, viewer: &Viewer) {
    let curves: Vec<(usize, Vec<[f64; 2]>)> = (0..viewer.shown_sides())
        .map(|side| {
            let points = viewer.side(side).curve.points().iter();
            (side, points.map(|p| [p.seconds.log10(), (100.0 * p.error).log10()]).collect())
        })
        .collect();
    let guide = guide(&curves);
    Plot::new("error over time")
        .height(170.0)
        .show_axes(true)
        .allow_drag(false)
        .allow_zoom(false)
        .allow_scroll(false)
        .allow_boxed_zoom(false)
        .allow_axis_zoom_drag(false)
        .x_axis_label("seconds")
        .y_axis_label("relative error, %")
        .x_axis_formatter(decade)
        .y_axis_formatter(decade)
        .x_grid_spacer(marks)
        .y_grid_spacer(marks)
        .label_formatter(|_| None)
        .show(ui, |plot| {
            let color = Color32::from_gray(90);
            let dashed = LineStyle::Dashed { length: 6.0 };
            plot.line(Line::new("guide", PlotPoints::from(guide)).color(color).style(dashed));
            for (side, points) in curves {
                let line = Line::new(format!("side {side}"), PlotPoints::from(points));
                plot.line(line.color(style::SIDES[side]).width(2.0));
            }
        });
    ui.small("dashed: half the error takes four times as long");
    if let Some(speedup) = viewer.speedup() {
        let text = format!("variance at equal time: {speedup:.2} times smaller on the left");
        ui.strong(text);
    }
}

/// A line along which the squared error falls as time grows, from the first point of the first
/// curve.
fn guide(curves: &[(usize, Vec<[f64; 2]>)]) -> Vec<[f64; 2]> {
    let Some((_, points)) = curves.first() else { return Vec::new() };
    let (Some([x, y]), Some([end, _])) = (points.first(), points.last()) else {
        return Vec::new();
    };
    vec![[*x, *y], [*end, y - 0.5 * (end - x)]]
}

/// A number whose logarithm is at a mark.
fn decade(mark: GridMark, _: &RangeInclusive<f64>) -> String {
    let value = 10_f64.powf(mark.value);
    // Not all digits of a float: 1.5 is no power of ten.
    format!("{}", (value * 1e6).round() / 1e6)
}

/// Marks at round numbers: powers of ten, and more between them the fewer there are.
fn marks(input: GridInput) -> Vec<GridMark> {
    let (low, high) = input.bounds;
    if !(low.is_finite() && high.is_finite() && high - low < 60.0) {
        return Vec::new();
    }
    let factors: &[f64] = match high - low {
        span if span < 0.5 => &[1.0, 1.5, 2.0, 3.0, 4.0, 5.0, 6.0, 8.0],
        span if span < 1.5 => &[1.0, 2.0, 5.0],
        _ => &[1.0],
    };
    let decades = low.floor() as i32..=high.ceil() as i32;
    decades
        .flat_map(|decade| factors.iter().map(move |factor| f64::from(decade) + factor.log10()))
        .filter(|value| (low..=high).contains(value))
        .map(|value| GridMark { value, step_size: 1.0 })
        .collect()
}
