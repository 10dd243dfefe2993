//! Plots as SVG.

use super::error::FigureError;
use plotters::chart::SeriesLabelPosition;
use plotters::coord::ranged1d::ValueFormatter;
use plotters::prelude::*;

const SIZE: (u32, u32) = (960, 640);
const FONT: &str = "sans-serif";

/// A curve: its name and its points (x, y).
pub type Curve = (String, Vec<(f64, f64)>);

type Root<'a> = DrawingArea<SVGBackend<'a>, plotters::coord::Shift>;
type Drawn = Result<(), Box<dyn std::error::Error>>;

/// What `draw` draws on white.
fn svg(
    title: &str,
    size: (u32, u32),
    draw: impl FnOnce(&Root<'_>) -> Drawn,
) -> Result<Vec<u8>, FigureError> {
    let mut svg = String::new();
    let drawn = || -> Drawn {
        let root = SVGBackend::with_string(&mut svg, size).into_drawing_area();
        root.fill(&WHITE)?;
        draw(&root)?;
        Ok(root.present()?)
    };
    drawn().map_err(|error| FigureError::Plot {
        title: title.to_owned(),
        reason: error.to_string(),
    })?;
    Ok(svg.into_bytes())
}

/// Curves in log-log scale; points with a coordinate that is not above 0 are left out.
pub fn curves(
    title: &str,
    x_title: &str,
    y_title: &str,
    curves: &[Curve],
) -> Result<Vec<u8>, FigureError> {
    let positive = |points: &[(f64, f64)]| -> Vec<(f64, f64)> {
        points
            .iter()
            .copied()
            .filter(|&(x, y)| x > 0.0 && y > 0.0 && x.is_finite() && y.is_finite())
            .collect()
    };
    let curves: Vec<Curve> =
        curves.iter().map(|(name, points)| (name.clone(), positive(points))).collect();
    let all = || curves.iter().flat_map(|(_, points)| points);
    let x_range = padded(all().map(|p| p.0));
    let y_range = padded(all().map(|p| p.1));
    svg(title, SIZE, |root| {
        let mut chart = chart_builder(root, title).build_cartesian_2d(
            x_range.clone().log_scale().with_key_points(ticks(&x_range)),
            y_range.clone().log_scale().with_key_points(ticks(&y_range)),
        )?;
        draw_series(&mut chart, x_title, y_title, MAX_TICKS, &curves, true)
    })
}

/// Lines in linear scale, from 0 on.
pub fn lines(
    title: &str,
    x_title: &str,
    y_title: &str,
    lines: &[Curve],
) -> Result<Vec<u8>, FigureError> {
    let largest = |coordinate: fn(&(f64, f64)) -> f64| {
        lines
            .iter()
            .flat_map(|(_, points)| points)
            .map(coordinate)
            .filter(|c| c.is_finite())
            .fold(0.0, f64::max)
    };
    let end = |largest: f64| if largest > 0.0 { 1.05 * largest } else { 1.0 };
    svg(title, SIZE, |root| {
        let mut chart = chart_builder(root, title)
            .build_cartesian_2d(0.0..end(largest(|p| p.0)), 0.0..end(largest(|p| p.1)))?;
        draw_series(&mut chart, x_title, y_title, LINEAR_TICKS, lines, false)
    })
}

/// Ticks of an axis in linear scale.
const LINEAR_TICKS: usize = 10;

fn chart_builder<'a, 'b>(root: &'a Root<'b>, title: &str) -> ChartBuilder<'a, 'b, SVGBackend<'b>> {
    let mut builder = ChartBuilder::on(root);
    builder.caption(title, (FONT, 22)).margin(14).x_label_area_size(48).y_label_area_size(76);
    builder
}

/// Draws the axes, the curves, with a mark for each point if `marks`, and their names.
fn draw_series<'a, X, Y>(
    chart: &mut ChartContext<'a, SVGBackend<'a>, Cartesian2d<X, Y>>,
    x_title: &str,
    y_title: &str,
    ticks: usize,
    curves: &[Curve],
    marks: bool,
) -> Drawn
where
    X: Ranged<ValueType = f64> + ValueFormatter<f64> + 'a,
    Y: Ranged<ValueType = f64> + ValueFormatter<f64> + 'a,
{
    chart
        .configure_mesh()
        .x_desc(x_title)
        .y_desc(y_title)
        .x_labels(ticks)
        .y_labels(ticks)
        .x_label_formatter(&|x| tick_or_zero(*x))
        .y_label_formatter(&|y| tick_or_zero(*y))
        .label_style((FONT, 14))
        .axis_desc_style((FONT, 16))
        .light_line_style(RGBColor(235, 235, 235))
        .bold_line_style(RGBColor(205, 205, 205))
        .draw()?;
    for (index, (name, points)) in curves.iter().enumerate() {
        let color = color(index);
        let style = color.stroke_width(2);
        chart
            .draw_series(LineSeries::new(points.iter().copied(), style))?
            .label(name)
            .legend(move |(x, y)| PathElement::new([(x, y), (x + 18, y)], style));
        if marks {
            // Where colours come again, marks are hollow.
            let style = if index < COLORS.len() { color.filled() } else { color.stroke_width(1) };
            chart.draw_series(points.iter().map(|&point| Circle::new(point, 3, style)))?;
        }
    }
    draw_legend(chart)
}

/// Draws the names of what has been drawn.
fn draw_legend<'a, X, Y>(chart: &mut ChartContext<'a, SVGBackend<'a>, Cartesian2d<X, Y>>) -> Drawn
where
    X: Ranged<ValueType = f64> + 'a,
    Y: Ranged<ValueType = f64> + 'a,
{
    chart
        .configure_series_labels()
        .position(SeriesLabelPosition::UpperRight)
        .background_style(WHITE.mix(0.85))
        .border_style(RGBColor(160, 160, 160))
        .label_font((FONT, 14))
        .draw()?;
    Ok(())
}

/// From the smallest to the largest of `values`, with some room; 0.1 to 10 if there are none.
fn padded(values: impl Iterator<Item = f64>) -> std::ops::Range<f64> {
    let (low, high) =
        values.fold((f64::INFINITY, 0.0_f64), |(low, high), v| (low.min(v), high.max(v)));
    if low > high { 0.1..10.0 } else { low / 1.3..high * 1.3 }
}

/// Ticks of an axis, at most.
const MAX_TICKS: usize = 24;

/// Ticks in a range: powers of ten, with twice and five times those where there is room.
fn ticks(range: &std::ops::Range<f64>) -> Vec<f64> {
    let (first, last) = (range.start.log10().floor() as i32, range.end.log10().ceil() as i32);
    let decades = (last - first) as usize;
    let factors: &[f64] = if decades * 3 <= MAX_TICKS { &[1.0, 2.0, 5.0] } else { &[1.0] };
    let step = decades.div_ceil(MAX_TICKS).max(1);
    (first..=last)
        .step_by(step)
        // Parsed, a power of ten is the nearest number there is.
        .flat_map(|exponent| {
            factors.iter().filter_map(move |factor| format!("{factor}e{exponent}").parse().ok())
        })
        .filter(|tick| range.contains(tick))
        .collect()
}

/// A number at an axis: as short as it is exact to three digits.
fn tick(value: f64) -> String {
    if !(1e-3..1e6).contains(&value) {
        return format!("{value:.0e}");
    }
    let decimals = (2 - value.log10().floor() as i32).max(0) as usize;
    let text = format!("{value:.decimals$}");
    if text.contains('.') {
        text.trim_end_matches('0').trim_end_matches('.').to_owned()
    } else {
        text
    }
}

/// A bar: its name and the parts that it is made of, from the left.
pub type Bar = (String, Vec<(&'static str, f64)>);

/// Horizontal bars of stacked parts. All bars have the same parts.
pub fn bars(title: &str, x_title: &str, bars: &[Bar]) -> Result<Vec<u8>, FigureError> {
    let longest =
        bars.iter().map(|(_, parts)| parts.iter().map(|p| p.1).sum::<f64>()).fold(0.0, f64::max);
    let count = bars.len().max(1);
    let name = |row: f64| {
        // Bars go from the top.
        let index = (count as f64 - row).floor();
        bars.get(index as usize)
            .filter(|_| index >= 0.0)
            .map(|(name, _)| name.clone())
            .unwrap_or_default()
    };
    svg(title, (SIZE.0, 150 + 36 * count as u32), |root| {
        let mut chart = ChartBuilder::on(root)
            .caption(title, (FONT, 22))
            .margin(14)
            .x_label_area_size(48)
            .y_label_area_size(190)
            // The legend's place is on the right.
            .build_cartesian_2d(0.0..(longest * 1.25).max(1e-9), 0.0..count as f64)?;
        chart
            .configure_mesh()
            .disable_y_mesh()
            .disable_y_axis()
            .y_labels(0)
            .x_desc(x_title)
            .x_label_formatter(&|x| tick_or_zero(*x))
            .label_style((FONT, 14))
            .axis_desc_style((FONT, 16))
            .light_line_style(WHITE)
            .draw()?;
        let parts = bars.first().map_or(0, |(_, parts)| parts.len());
        for part in 0..parts {
            let color = color(part);
            let rectangles = bars.iter().enumerate().map(|(index, (_, parts))| {
                let from: f64 = parts[..part].iter().map(|p| p.1).sum();
                let bottom = (count - 1 - index) as f64;
                Rectangle::new(
                    [(from, bottom + 0.15), (from + parts[part].1, bottom + 0.85)],
                    color.filled(),
                )
            });
            chart.draw_series(rectangles)?.label(bars[0].1[part].0).legend(move |(x, y)| {
                Rectangle::new([(x, y - 5), (x + 14, y + 5)], color.filled())
            });
        }
        draw_legend(&mut chart)?;
        for row in 0..count {
            let middle = (count - 1 - row) as f64 + 0.5;
            let (_, y) = chart.backend_coord(&(0.0, middle));
            let style = (FONT, 14).into_text_style(root);
            root.draw(&Text::new(name(middle), (20, y - 7), style))?;
        }
        Ok(())
    })
}

fn tick_or_zero(value: f64) -> String {
    if value == 0.0 { "0".into() } else { tick(value) }
}

/// Colours that are told apart on white, also by most who see few colours.
const COLORS: [RGBColor; 10] = [
    RGBColor(0, 0, 0),
    RGBColor(0, 114, 178),
    RGBColor(213, 94, 0),
    RGBColor(0, 158, 115),
    RGBColor(204, 121, 167),
    RGBColor(230, 159, 0),
    RGBColor(86, 180, 233),
    RGBColor(127, 60, 141),
    RGBColor(140, 86, 75),
    RGBColor(120, 120, 120),
];

/// A colour for the curve or part number `index`; the first is that of uniform sampling.
fn color(index: usize) -> RGBColor {
    COLORS[index % COLORS.len()]
}

#[cfg(test)]
mod tests {
    use super::*;

    fn text(svg: Result<Vec<u8>, FigureError>) -> String {
        String::from_utf8(svg.unwrap()).unwrap()
    }

    #[test]
    fn curves_have_names_and_titles() {
        let falling =
            |factor: f64| (1..9).map(|k| (f64::from(k) * 1e-3, factor / f64::from(k))).collect();
        let all = [("uniform".to_owned(), falling(1.0)), ("runs-<x>".to_owned(), falling(0.1))];
        let svg = text(curves("Cornell", "seconds", "RMSE", &all));
        for part in ["<svg", "</svg>", "Cornell", "seconds", "RMSE", "uniform", "runs-&lt;x&gt;"] {
            assert!(svg.contains(part), "{part} is missing");
        }
        assert_eq!(svg.matches("<circle").count(), 2 * 8, "a mark for each point");
    }

    #[test]
    fn any_points_can_be_drawn() {
        for points in [
            vec![],
            vec![(1.0, 1.0)],
            vec![(0.0, 0.0), (f64::NAN, 1.0)],
            vec![(1e-9, 1e-30), (1e9, 1e30)],
        ] {
            text(curves("t", "x", "y", &[("a".into(), points)]));
        }
        text(curves("t", "x", "y", &[]));
        text(lines("t", "x", "y", &[]));
        text(lines(
            "t",
            "x",
            "y",
            &[("a".into(), vec![(0.0, 0.0)]), ("b".into(), vec![(1.0, 1e9), (2.0, f64::NAN)])],
        ));
        text(bars("t", "x", &[]));
        text(bars("t", "x", &[("a".into(), vec![("p", 0.0)])]));
    }

    #[test]
    fn every_bar_has_all_parts() {
        let bar =
            |name: &str, a: f64, b: f64| (name.to_owned(), vec![("generation", a), ("tracing", b)]);
        let svg = text(bars("Time", "ns", &[bar("uniform", 0.1, 2.0), bar("runs", 0.3, 2.5)]));
        for part in ["uniform", "runs", "generation", "tracing", "ns"] {
            assert!(svg.contains(part), "{part} is missing");
        }
    }

    #[test]
    fn ticks_are_round_and_few() {
        assert_eq!(ticks(&(0.015..0.6)), [0.02, 0.05, 0.1, 0.2, 0.5]);
        assert_eq!(ticks(&(1e-6..2e6)).len(), 13);
        assert!(ticks(&(1e-300..1e300)).len() <= MAX_TICKS + 1);
    }

    #[test]
    fn ticks_are_short() {
        let texts = [0.001, 0.25, 1.0, 30.0, 1234.0, 1e-5, 2e7].map(tick);
        assert_eq!(texts, ["0.001", "0.25", "1", "30", "1234", "1e-5", "2e7"]);
    }
}
