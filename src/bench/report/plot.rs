//! Plots as SVG: bars with their spread, and points with names.

use crate::bench::race::Spread;
use plotters::prelude::*;

/// One bar.
#[derive(Debug)]
pub(super) struct Bar {
    pub(super) label: String,
    pub(super) value: Spread,
    /// Which backend: it chooses the colour.
    pub(super) family: usize,
}

/// One point.
#[derive(Debug)]
pub(super) struct Point {
    pub(super) label: String,
    pub(super) at: [f64; 2],
    /// Which backend.
    pub(super) family: usize,
}

/// Told apart by those who see few colours, too (Okabe and Ito 2008, Color Universal Design).
const COLOURS: [RGBColor; 7] = [
    RGBColor(0, 114, 178),
    RGBColor(230, 159, 0),
    RGBColor(0, 158, 115),
    RGBColor(204, 121, 167),
    RGBColor(213, 94, 0),
    RGBColor(86, 180, 233),
    RGBColor(60, 60, 60),
];

const WIDTH: u32 = 800;
/// Of axes.
pub(crate) const FONT: (&str, u32) = ("sans-serif", 13);

/// The colour of that number; they begin again where there are more.
pub(crate) fn colour(number: usize) -> RGBColor {
    COLOURS[number % COLOURS.len()]
}

/// A plot drawn by `fill`; a plot that cannot be drawn is a sentence that says so.
pub(crate) fn drawn(
    height: u32,
    fill: impl FnOnce(&DrawingArea<SVGBackend<'_>, plotters::coord::Shift>) -> Drawn,
) -> String {
    let mut svg = String::new();
    let done = {
        let root = SVGBackend::with_string(&mut svg, (WIDTH, height)).into_drawing_area();
        root.fill(&WHITE)
            .map_err(|e| e.to_string())
            .and_then(|()| fill(&root))
            .and_then(|()| root.present().map_err(|e| e.to_string()))
    };
    match done {
        Ok(()) => svg,
        Err(what) => format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\"><text y=\"16\">no plot: {}</text></svg>",
            what.replace(['<', '&'], "?")
        ),
    }
}

/// Whether it worked, or why not, in words: the backend's errors borrow what it writes to.
pub(crate) type Drawn = Result<(), String>;

/// Horizontal bars from the top down, from zero, with a line from the lower to the upper end of their spread.
pub(super) fn bars(axis: &str, bars: &[Bar]) -> String {
    let count = bars.len();
    let Ok(rows) = u32::try_from(count) else { return String::new() };
    let most = bars.iter().map(|bar| bar.value.median + bar.value.half_iqr).fold(0.0, f64::max);
    let most = if most > 0.0 { most * 1.05 } else { 1.0 };
    drawn(56 + 17 * rows, |root| {
        let mut chart = ChartBuilder::on(root)
            .margin(4)
            .margin_right(16)
            .x_label_area_size(40)
            .y_label_area_size(300)
            .build_cartesian_2d(0.0..most, (0..count).into_segmented())
            .map_err(|e| e.to_string())?;
        // The axis goes up.
        let label = |at: &SegmentValue<usize>| match at {
            SegmentValue::CenterOf(i) | SegmentValue::Exact(i) => count
                .checked_sub(i + 1)
                .and_then(|i| bars.get(i))
                .map_or_else(String::new, |bar| bar.label.clone()),
            SegmentValue::Last => String::new(),
        };
        chart
            .configure_mesh()
            .disable_y_mesh()
            .light_line_style(TRANSPARENT)
            .y_labels(count)
            .y_label_formatter(&label)
            .label_style(FONT)
            .x_desc(axis)
            .draw()
            .map_err(|e| e.to_string())?;
        let body = bars.iter().rev().enumerate().map(|(i, bar)| {
            let corners = [(0.0, SegmentValue::Exact(i)), (bar.value.median, SegmentValue::Exact(i + 1))];
            let mut body = Rectangle::new(corners, colour(bar.family).filled());
            body.set_margin(2, 2, 0, 0);
            body
        });
        chart.draw_series(body).map_err(|e| e.to_string())?;
        let spread = bars.iter().rev().enumerate().map(|(i, bar)| {
            let Spread { median, half_iqr } = bar.value;
            let ends =
                [median - half_iqr, median + half_iqr].map(|x| (x.max(0.0), SegmentValue::CenterOf(i)));
            PathElement::new(ends.to_vec(), BLACK.stroke_width(2))
        });
        chart.draw_series(spread).map_err(|e| e.to_string())?;
        Ok(())
    })
}

/// Points with names, the first axis logarithmic; points that are not positive are left out.
pub(super) fn scatter([x_axis, y_axis]: [&str; 2], points: &[Point]) -> String {
    let points: Vec<&Point> = points.iter().filter(|point| point.at.iter().all(|x| *x > 0.0)).collect();
    let ends = points.iter().map(|point| point.at[0]);
    let (least, most) = ends.fold((f64::INFINITY, 0.0_f64), |(a, b), x| (a.min(x), b.max(x)));
    let across = least / 1.4..most * 1.4;
    let highest = points.iter().map(|point| point.at[1]).fold(0.0, f64::max);
    if points.is_empty() {
        return String::new();
    }
    drawn(420, |root| {
        let mut chart = ChartBuilder::on(root)
            .margin(8)
            .margin_right(120)
            .x_label_area_size(40)
            .y_label_area_size(60)
            .build_cartesian_2d(across.log_scale(), 0.0..highest * 1.1)
            .map_err(|e| e.to_string())?;
        chart
            .configure_mesh()
            .label_style(FONT)
            // Multiples of powers of ten come with the rounding of their products.
            .x_label_formatter(&|x| format!("{:.3}", x).trim_end_matches('0').to_owned())
            .x_desc(x_axis)
            .y_desc(y_axis)
            .draw()
            .map_err(|e| e.to_string())?;
        let dots = points.iter().map(|point| {
            let [x, y] = point.at;
            EmptyElement::at((x, y))
                + Circle::new((0, 0), 4, colour(point.family).filled())
                + Text::new(point.label.clone(), (7, -6), ("sans-serif", 11).into_font())
        });
        chart.draw_series(dots).map_err(|e| e.to_string())?;
        Ok(())
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_bar_and_point_is_there_with_its_name() {
        let bar = |label: &str, median| Bar {
            label: label.to_owned(),
            value: Spread { median, half_iqr: 0.5 },
            family: 1,
        };
        let svg = bars("Mrays/s", &[bar("first", 2.0), bar("second & last", 0.0)]);
        assert!(svg.starts_with("<svg") && svg.contains("Mrays/s"), "{svg}");
        for label in ["first", "second &amp; last"] {
            assert_eq!(svg.matches(label).count(), 1, "{label} in {svg}");
        }
        assert!(svg.matches("#E69F00").count() >= 2, "coloured: {svg}");
        let point = |label: &str, at| Point { label: label.to_owned(), at, family: 0 };
        let svg = scatter(["s", "rays"], &[point("here", [1.0, 2.0]), point("nowhere", [0.0, 2.0])]);
        assert!(svg.contains("here") && !svg.contains("nowhere"), "{svg}");
    }
}
