//! Plots with two logarithmic axes, side by side, as SVG.

use plotters::coord::Shift;
use plotters::prelude::*;
use std::error::Error;

/// Quantities over the same axis.
#[derive(Debug)]
pub(crate) struct Panel {
    pub(crate) title: String,
    /// Names of the axes.
    pub(crate) axes: [&'static str; 2],
    pub(crate) curves: Vec<Curve>,
}

/// A quantity.
#[derive(Debug)]
pub(crate) struct Curve {
    pub(crate) label: String,
    /// Positive.
    pub(crate) points: Vec<[f64; 2]>,
}

impl Curve {
    /// The slope of the straight line through the logarithms, by least squares.
    pub(crate) fn slope(&self) -> f64 {
        let count = self.points.len() as f64;
        let mean = |axis: usize| self.points.iter().map(|point| point[axis].ln()).sum::<f64>() / count;
        let centre = [mean(0), mean(1)];
        let offsets =
            self.points.iter().map(|point| [0, 1].map(|axis: usize| point[axis].ln() - centre[axis]));
        let (xy, xx) = offsets.fold((0.0, 0.0), |(xy, xx), [x, y]| (xy + x * y, xx + x * x));
        xy / xx
    }
}

/// Told apart by those who see few colours, too (Okabe and Ito 2008, Color Universal Design).
const COLOURS: [RGBColor; 3] = [RGBColor(0, 114, 178), RGBColor(213, 94, 0), RGBColor(0, 158, 115)];

const FONT: (&str, u32) = ("sans-serif", 13);

/// Panels side by side at most.
const COLUMNS: usize = 4;

/// All panels in one picture.
pub(crate) fn svg(panels: &[Panel]) -> Result<String, Box<dyn Error>> {
    let mut svg = String::new();
    {
        let columns = panels.len().clamp(1, COLUMNS);
        let rows = panels.len().div_ceil(columns);
        let size = (400 * u32::try_from(columns)?, 380 * u32::try_from(rows)?);
        let root = SVGBackend::with_string(&mut svg, size).into_drawing_area();
        root.fill(&WHITE)?;
        for (area, panel) in root.split_evenly((rows, columns)).iter().zip(panels) {
            draw(area, panel)?;
        }
        root.present()?;
    }
    Ok(svg)
}

fn draw(area: &DrawingArea<SVGBackend<'_>, Shift>, panel: &Panel) -> Result<(), Box<dyn Error>> {
    let range = |axis: usize, margin: f64| {
        let all = panel.curves.iter().flat_map(|curve| &curve.points).map(|point| point[axis]);
        let (least, most) = all.fold((f64::INFINITY, 0.0_f64), |(a, b), x| (a.min(x), b.max(x)));
        (least / margin..most * margin).log_scale()
    };
    let mut chart = ChartBuilder::on(area)
        .margin(8)
        .margin_right(20)
        .caption(&panel.title, ("sans-serif", 15))
        .x_label_area_size(40)
        .y_label_area_size(56)
        .build_cartesian_2d(range(0, 1.5), range(1, 3.0))?;
    let number = |x: &f64| {
        if (0.01..1e4).contains(x) { format!("{}", (x * 1e4).round() / 1e4) } else { format!("{x:.0e}") }
    };
    chart
        .configure_mesh()
        .label_style(FONT)
        .x_labels(6)
        .x_label_formatter(&number)
        .y_label_formatter(&number)
        .x_desc(panel.axes[0])
        .y_desc(panel.axes[1])
        .draw()?;
    for (curve, colour) in panel.curves.iter().zip(COLOURS) {
        let points = || curve.points.iter().map(|&[x, y]| (x, y));
        chart
            .draw_series([PathElement::new(points().collect::<Vec<_>>(), colour.stroke_width(2))])?
            .label(format!("{} (slope {:.2})", curve.label, curve.slope()))
            .legend(move |(x, y)| PathElement::new(vec![(x, y), (x + 14, y)], colour.stroke_width(2)));
        chart.draw_series(points().map(|at| Circle::new(at, 3, colour.filled())))?;
    }
    // Where curves are not: they all rise, or they all fall.
    let falls = panel.curves.iter().filter(|curve| curve.slope() < 0.0).count() * 2 > panel.curves.len();
    let position = if falls { SeriesLabelPosition::UpperRight } else { SeriesLabelPosition::UpperLeft };
    chart
        .configure_series_labels()
        .position(position)
        .background_style(WHITE.mix(0.8))
        .label_font(FONT)
        .draw()?;
    Ok(())
}
