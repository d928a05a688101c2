//! What the filter reads, number by number: pixels, or the texels of a smaller picture.

use super::gbuffer::{End, GBuffer};
use super::reach::area;
use crate::image::Window;
use rayon::prelude::*;

/// Numbers beyond the last texel, so that lanes may be loaded anywhere.
const SLACK: usize = 16;

/// Columns begin at multiples of this, so that a lane holds the same columns wherever a picture begins: sums do not depend on that.
const ALIGNED: u32 = 16;

/// Texels by row.
#[derive(Debug)]
pub(super) struct Field {
    /// Column and row of the first texel, in the grid of texels over the whole picture.
    pub(super) origin: [u32; 2],
    /// Columns and rows.
    pub(super) size: [usize; 2],
    /// Where mirrored rays end, or their directions.
    pub(super) b: [Vec<f32>; 3],
    /// 1 for places, 0 for directions.
    pub(super) h: Vec<f32>,
    /// Light along mirrored rays.
    pub(super) l: [Vec<f32>; 3],
    /// Normals of the reflector.
    pub(super) n: [Vec<f32>; 3],
    /// How many pixels count.
    pub(super) m: Vec<f32>,
    /// Area about the end of rays, as a vector along its normal; of directions, solid angle. Empty if nobody asks.
    pub(super) area: [Vec<f32>; 3],
    /// Numbers of reflectors; 0 for none.
    pub(super) id: Vec<u32>,
}

/// A texel.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Values {
    pub(super) b: [f32; 3],
    pub(super) h: f32,
    pub(super) l: [f32; 3],
    pub(super) n: [f32; 3],
    pub(super) m: f32,
    pub(super) area: [f32; 3],
    pub(super) id: u32,
}

impl Field {
    /// Of the texels from `low` up to, but without, `high`, with or without areas; there may be empty columns before them.
    pub(super) fn of_texels(
        [low, high]: [[u32; 2]; 2],
        areas: bool,
        texel: impl Fn([u32; 2]) -> Values + Sync,
    ) -> Self {
        let start = low[0] / ALIGNED * ALIGNED;
        let size = [(high[0] - start) as usize, (high[1] - low[1]) as usize];
        let texel = &texel;
        let row =
            |y| (start..high[0]).map(move |x| if x < low[0] { Values::default() } else { texel([x, y]) });
        let texels: Vec<Values> = (low[1]..high[1]).into_par_iter().flat_map_iter(row).collect();
        Self::new([start, low[1]], size, &texels, areas)
    }

    fn new(origin: [u32; 2], size: [usize; 2], texels: &[Values], areas: bool) -> Self {
        let column = |value: &(dyn Fn(&Values) -> f32 + Sync)| -> Vec<f32> {
            texels.iter().map(value).chain(std::iter::repeat_n(0.0, SLACK)).collect()
        };
        let columns = |value: fn(&Values) -> [f32; 3]| [0, 1, 2].map(|i| column(&|texel| value(texel)[i]));
        Self {
            origin,
            size,
            b: columns(|texel| texel.b),
            h: column(&|texel| texel.h),
            l: columns(|texel| texel.l),
            n: columns(|texel| texel.n),
            m: column(&|texel| texel.m),
            area: if areas { columns(|texel| texel.area) } else { Default::default() },
            id: texels.iter().map(|texel| texel.id).chain(std::iter::repeat_n(0, SLACK)).collect(),
        }
    }

    /// The pixels of a picture, with or without areas.
    pub(super) fn of(g: &GBuffer, areas: bool) -> Self {
        let Window { x0, y0, x1, y1 } = g.window;
        Self::of_texels([[x0, y0], [x1, y1]], areas, |at| values(g, at, areas))
    }

    /// The texel in a column and row of the grid; an empty one where there is none.
    pub(super) fn values(&self, [x, y]: [u32; 2]) -> Values {
        let (Some(column), Some(row)) = (x.checked_sub(self.origin[0]), y.checked_sub(self.origin[1])) else {
            return Values::default();
        };
        let (column, row) = (column as usize, row as usize);
        if column >= self.size[0] || row >= self.size[1] {
            return Values::default();
        }
        let at = row * self.size[0] + column;
        let of = |columns: &[Vec<f32>; 3]| [0, 1, 2].map(|i| columns[i].get(at).copied().unwrap_or(0.0));
        Values {
            b: of(&self.b),
            h: self.h[at],
            l: of(&self.l),
            n: of(&self.n),
            m: self.m[at],
            area: of(&self.area),
            id: self.id[at],
        }
    }
}

fn values(g: &GBuffer, [x, y]: [u32; 2], areas: bool) -> Values {
    let Some(mirror) = g.texel(x, y).and_then(|texel| texel.mirror) else { return Values::default() };
    let (b, h) = match mirror.end {
        End::At(b) => (b, 1.0),
        End::Away(d) => (d, 0.0),
    };
    // A ray that ends where it begins has no direction, and light that is not finite would spread.
    if mirror.direction().is_none() || !mirror.radiance.iter().all(|l| l.is_finite()) {
        return Values::default();
    }
    Values {
        b: b.to_array(),
        h,
        l: mirror.radiance,
        n: mirror.normal.to_array(),
        m: 1.0,
        area: if areas { area(g, [x, y], &mirror).to_array() } else { [0.0; 3] },
        id: mirror.reflector,
    }
}
