//! Plots of error over time, both axes logarithmic.

use crate::bench::report::plot::{Drawn, FONT, colour, drawn};
use plotters::prelude::*;

/// Points of one kind.
#[derive(Clone, Debug)]
pub(super) struct Series {
    pub(super) name: String,
    /// Time, error, and half of the error's interval where it is known; joined in this order if they are to be.
    pub(super) points: Vec<([f64; 2], Option<f64>)>,
    pub(super) is_joined: bool,
    /// Which colour; `None` of what stands behind.
    pub(super) colour: Option<usize>,
}

/// The colour of what stands behind.
const GRAY: RGBColor = RGBColor(170, 170, 170);

/// The least and the greatest of positive numbers, with some room; `None` of none.
fn room(values: impl Iterator<Item = f64>) -> Option<std::ops::Range<f64>> {
    let (least, most) = values
        .filter(|x| x.is_finite() && *x > 0.0)
        .fold((f64::INFINITY, 0.0_f64), |(a, b), x| (a.min(x), b.max(x)));
    (most > 0.0).then(|| least / 1.5..most * 1.5)
}

/// Series over time; points that are not positive are left out. Empty where none is left.
pub(super) fn over_time(axes: [&str; 2], series: &[Series]) -> String {
    let all = || series.iter().flat_map(|it| &it.points).filter(|(at, _)| at.iter().all(|x| *x > 0.0));
    let (Some(across), Some(up)) = (room(all().map(|(at, _)| at[0])), room(all().map(|(at, _)| at[1])))
    else {
        return String::new();
    };
    drawn(430, |root| {
        let mut chart = ChartBuilder::on(root)
            .margin(8)
            .margin_right(16)
            .x_label_area_size(40)
            .y_label_area_size(76)
            .build_cartesian_2d(across.clone().log_scale(), up.clone().log_scale())
            .map_err(|e| e.to_string())?;
        chart
            .configure_mesh()
            .label_style(FONT)
            .x_label_formatter(&|x| tick(*x))
            .y_label_formatter(&|y| tick(*y))
            .light_line_style(RGBColor(240, 240, 240))
            .x_desc(axes[0])
            .y_desc(axes[1])
            .draw()
            .map_err(|e| e.to_string())?;
        for it in series {
            draw(&mut chart, it, up.start)?;
        }
        chart
            .configure_series_labels()
            .position(SeriesLabelPosition::LowerLeft)
            .background_style(WHITE.mix(0.8))
            .label_font(FONT)
            .draw()
            .map_err(|e| e.to_string())
    })
}

/// The label of a line of the grid: only of one, two and five times powers of ten, lest they overlap.
fn tick(x: f64) -> String {
    let power = (x.log10() + 1e-9).floor();
    let mantissa = (x / 10_f64.powf(power)).round();
    if ![1.0, 2.0, 5.0].iter().any(|shown| (mantissa - shown).abs() < 1e-9) {
        return String::new();
    }
    if (-2.0..4.0).contains(&power) { format!("{}", (x * 1e4).round() / 1e4) } else { format!("{x:.0e}") }
}

type Chart<'a, 'b> = ChartContext<'a, SVGBackend<'b>, Cartesian2d<LogCoord<f64>, LogCoord<f64>>>;

fn draw(chart: &mut Chart<'_, '_>, it: &Series, least: f64) -> Drawn {
    let own = it.colour.map_or(GRAY, colour);
    let points: Vec<_> = it.points.iter().filter(|(at, _)| at.iter().all(|x| *x > 0.0)).collect();
    let bars = points.iter().filter_map(|&&([x, y], half)| {
        let ends = half.map(|half| [(y - half).max(least), y + half])?;
        Some(PathElement::new(ends.map(|end| (x, end)).to_vec(), own.stroke_width(1)))
    });
    chart.draw_series(bars).map_err(|e| e.to_string())?;
    if it.is_joined {
        let line: Vec<_> = points.iter().map(|([x, y], _)| (*x, *y)).collect();
        let line = PathElement::new(line, own.stroke_width(2));
        chart.draw_series(std::iter::once(line)).map_err(|e| e.to_string())?;
    }
    let radius = if it.colour.is_none() { 2 } else { 4 };
    let dots = points.iter().map(|([x, y], _)| Circle::new((*x, *y), radius, own.filled()));
    let labelled = chart.draw_series(dots).map_err(|e| e.to_string())?;
    if !it.name.is_empty() {
        labelled.label(&it.name).legend(move |(x, y)| Circle::new((x + 8, y), 4, own.filled()));
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ticks_are_few_and_short() {
        let ticks = [0.01, 0.2, 0.3, 5.0, 2000.0, 0.9, 1e-4, 0.05 * 10.0].map(tick);
        assert_eq!(ticks, ["0.01", "0.2", "", "5", "2000", "", "1e-4", "0.5"], "labels");
    }

    #[test]
    fn series_are_named_and_what_is_not_positive_is_left_out() {
        let series = |name: &str, points: Vec<([f64; 2], Option<f64>)>| Series {
            name: name.to_owned(),
            points,
            is_joined: true,
            colour: Some(1),
        };
        let points = vec![([1.0, 1e-2], Some(1e-3)), ([4.0, 2e-3], Some(1.0)), ([9.0, -1.0], None)];
        let svg = over_time(["CPU s", "relMSE"], &[series("first & only", points)]);
        assert!(
            svg.starts_with("<svg") && svg.contains("first &amp; only") && svg.contains("relMSE"),
            "{svg}"
        );
        assert_eq!(svg.matches("<circle").count(), 2 + 1, "two points and a sign in the legend: {svg}");
        assert_eq!(over_time(["a", "b"], &[series("none", vec![([0.0, 1.0], None)])]), "", "nothing to draw");
    }

    #[test]
    fn no_series_of_many_looks_as_if_it_stood_behind() {
        let series = |colour| Series {
            name: String::new(),
            points: vec![([1.0, 1e-2], None)],
            is_joined: true,
            colour,
        };
        let is_gray = |colour| over_time(["CPU s", "relMSE"], &[series(colour)]).contains("#AAAAAA");
        assert!((0..20).all(|number| !is_gray(Some(number))), "a value of a knob");
        assert!(is_gray(None), "what stands behind");
    }
}
