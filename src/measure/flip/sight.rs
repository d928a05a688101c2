//! What is seen of a part of a picture: blurred as by the eye, and searched for edges and points. Over lanes.
//!
//! Every filter is separable: first along rows, for as many rows around the part as columns need; then along columns.

use super::colour::{Opponent, Perceived};
use super::filter::Filters;
use super::tone::Tone;
use crate::math::Rgb;
use crate::math::lanes::{Isa, Lanes};

/// Sides of the part, and how far around it light is known.
#[derive(Clone, Copy, Debug)]
pub(super) struct Extent {
    /// A multiple of the number of lanes.
    pub(super) columns: usize,
    pub(super) rows: usize,
    pub(super) reach: usize,
}

impl Extent {
    /// From a pixel to the one below, where the surroundings are included.
    pub(super) fn stride(self) -> usize {
        self.columns + 2 * self.reach
    }

    /// Rows, those around included.
    pub(super) fn lines(self) -> usize {
        self.rows + 2 * self.reach
    }
}

/// Numbers by row.
pub(super) type Plane = Vec<f32>;

/// Space for what is computed on the way to [`Sight`], to be used again.
#[derive(Debug)]
pub(super) struct Desk {
    /// Opponent channels, surroundings included: [`Opponent::y`], `cx`, `cz`.
    opponent: [Plane; 3],
    /// Filtered along rows, in the order of [`row_filters`].
    rows: [Plane; 7],
}

impl Desk {
    pub(super) fn new(extent: Extent, surroundings: usize) -> Self {
        let row_planes = [(); 7].map(|()| vec![0.0; extent.columns * extent.lines()]);
        Self { opponent: [(); 3].map(|()| vec![0.0; surroundings]), rows: row_planes }
    }
}

/// What is seen at each pixel.
#[derive(Debug)]
pub(super) struct Sight {
    l: Plane,
    a: Plane,
    b: Plane,
    edge: Plane,
    point: Plane,
}

/// What is seen at some pixels.
#[derive(Clone, Copy, Debug)]
pub(super) struct Seen<F> {
    /// The colour.
    pub(super) colour: Perceived<F>,
    /// How steep luminance is, 1 for a step from black to white.
    pub(super) edge: F,
    /// How bent it is.
    pub(super) point: F,
}

impl Sight {
    pub(super) fn new(extent: Extent) -> Self {
        let plane = || vec![0.0; extent.columns * extent.rows];
        Self { l: plane(), a: plane(), b: plane(), edge: plane(), point: plane() }
    }

    /// What was seen from pixel `i` on.
    #[inline(always)]
    pub(super) fn at<S: Isa>(&self, isa: S, i: usize) -> Seen<S::F> {
        let colour =
            Perceived { l: isa.load(&self.l[i..]), a: isa.load(&self.a[i..]), b: isa.load(&self.b[i..]) };
        Seen { colour, edge: isa.load(&self.edge[i..]), point: isa.load(&self.point[i..]) }
    }

    #[inline(always)]
    fn set<F: Lanes>(&mut self, i: usize, seen: Seen<F>) {
        seen.colour.l.store(&mut self.l[i..]);
        seen.colour.a.store(&mut self.a[i..]);
        seen.colour.b.store(&mut self.b[i..]);
        seen.edge.store(&mut self.edge[i..]);
        seen.point.store(&mut self.point[i..]);
    }
}

/// Sets `sight` to what is seen of `light` (red, green, blue, surroundings included) brought to a display by `tone`.
#[inline(always)]
pub(super) fn see<S: Isa>(
    isa: S,
    (light, tone): (&[Plane; 3], Tone),
    filters: &Filters,
    extent: Extent,
    desk: &mut Desk,
    sight: &mut Sight,
) {
    show(isa, light, tone, &mut desk.opponent);
    along_rows(isa, filters, extent, desk);
    along_columns(isa, filters, extent, &desk.rows, sight);
}

/// Light as opponent channels of what a display shows.
#[inline(always)]
fn show<S: Isa>(isa: S, [r, g, b]: &[Plane; 3], tone: Tone, [y, cx, cz]: &mut [Plane; 3]) {
    for i in (0..y.len()).step_by(S::WIDTH) {
        let light = Rgb::new(isa.load(&r[i..]), isa.load(&g[i..]), isa.load(&b[i..]));
        let opponent = Opponent::of(tone.apply(light));
        opponent.y.store(&mut y[i..]);
        opponent.cx.store(&mut cx[i..]);
        opponent.cz.store(&mut cz[i..]);
    }
}

#[inline(always)]
fn along_rows<S: Isa>(isa: S, filters: &Filters, extent: Extent, desk: &mut Desk) {
    let [y, cx, cz] = &desk.opponent;
    let [achromatic, red_green, first, second, smooth, edge, point] = &mut desk.rows;
    for line in 0..extent.lines() {
        for column in (0..extent.columns).step_by(S::WIDTH) {
            let from = line * extent.stride() + column + extent.reach;
            let to = line * extent.columns + column;
            even(isa, y, from, 1, &filters.achromatic).store(&mut achromatic[to..]);
            even(isa, cx, from, 1, &filters.red_green).store(&mut red_green[to..]);
            even(isa, cz, from, 1, &filters.blue_yellow[0]).store(&mut first[to..]);
            even(isa, cz, from, 1, &filters.blue_yellow[1]).store(&mut second[to..]);
            even(isa, y, from, 1, &filters.smooth).store(&mut smooth[to..]);
            odd(isa, y, from, 1, &filters.edge).store(&mut edge[to..]);
            bend(isa, y, from, 1, &filters.point).store(&mut point[to..]);
        }
    }
}

#[inline(always)]
fn along_columns<S: Isa>(
    isa: S,
    filters: &Filters,
    extent: Extent,
    [achromatic, red_green, first, second, smooth, edge, point]: &[Plane; 7],
    sight: &mut Sight,
) {
    let stride = extent.columns;
    for to in (0..extent.columns * extent.rows).step_by(S::WIDTH) {
        let from = to + extent.reach * stride;
        let blurred = Opponent {
            y: even(isa, achromatic, from, stride, &filters.achromatic),
            cx: even(isa, red_green, from, stride, &filters.red_green),
            cz: even(isa, first, from, stride, &filters.blue_yellow[0])
                + even(isa, second, from, stride, &filters.blue_yellow[1]),
        };
        let edge_x = even(isa, edge, from, stride, &filters.smooth);
        let edge_y = odd(isa, smooth, from, stride, &filters.edge);
        let point_x = even(isa, point, from, stride, &filters.smooth);
        let point_y = bend(isa, smooth, from, stride, &filters.point);
        let seen = Seen {
            colour: Perceived::of(blurred),
            edge: length(edge_x, edge_y),
            point: length(point_x, point_y),
        };
        sight.set(to, seen);
    }
}

/// An even kernel about the pixels from `at` on; its steps are `stride` apart.
#[inline(always)]
fn even<S: Isa>(isa: S, plane: &[f32], at: usize, stride: usize, half: &[f32]) -> S::F {
    let mut sum = isa.load(&plane[at..]) * half[0];
    for k in 1..half.len() {
        let pair = isa.load(&plane[at - k * stride..]) + isa.load(&plane[at + k * stride..]);
        sum = pair.mul_add(isa.splat(half[k]), sum);
    }
    sum
}

/// An even kernel of sum 0, whose centre is minus the rest: applied to differences from the centre, so that a constant
/// gives zero and not rounding errors, which the square root of the feature error would magnify.
#[inline(always)]
fn bend<S: Isa>(isa: S, plane: &[f32], at: usize, stride: usize, half: &[f32]) -> S::F {
    let centre = isa.load(&plane[at..]);
    let mut sum = isa.splat(0.0);
    for k in 1..half.len() {
        let before = isa.load(&plane[at - k * stride..]) - centre;
        let after = isa.load(&plane[at + k * stride..]) - centre;
        sum = (before + after).mul_add(isa.splat(half[k]), sum);
    }
    sum
}

/// An odd kernel.
#[inline(always)]
fn odd<S: Isa>(isa: S, plane: &[f32], at: usize, stride: usize, half: &[f32]) -> S::F {
    let mut sum = isa.splat(0.0);
    for k in 1..half.len() {
        let pair = isa.load(&plane[at + k * stride..]) - isa.load(&plane[at - k * stride..]);
        sum = pair.mul_add(isa.splat(half[k]), sum);
    }
    sum
}

#[inline(always)]
fn length<F: Lanes>(x: F, y: F) -> F {
    (x * x + y * y).sqrt()
}
