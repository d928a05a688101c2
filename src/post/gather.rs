//! The sum over a window, over lanes.

use super::field::Field;
use super::lobe::Lobe;
use super::settings::Rejection;
use crate::math::Vec3;
use crate::math::lanes::{Compare, Isa, Lanes, MaskLanes, Select, Wrapping};

/// Rows whose sums are kept in single precision, counted from the top of the grid.
const ROWS: usize = 32;

/// Lobes that end below this t = 1 - cos J, at 20 degrees, have their logarithm from a series: what is left out of it changes a weight by
/// p t^6 / 6, with p t about the logarithm of what is lost, less than a millionth.
const NARROW: f32 = 0.06;

/// The pixel that a window is looked at for.
#[derive(Clone, Copy, Debug)]
pub(super) struct Aim<'a> {
    /// The point of the reflector.
    pub(super) a: [f32; 3],
    /// Unit direction of the mirrored ray.
    pub(super) w: [f32; 3],
    /// Unit normal.
    pub(super) n: [f32; 3],
    /// Number of the reflector.
    pub(super) id: u32,
    /// The lobe.
    pub(super) lobe: &'a Lobe,
    /// How what lies outside of it is told.
    pub(super) rejection: Rejection,
}

/// An ellipse or a rectangle of texels.
#[derive(Clone, Copy, Debug)]
pub(super) struct Patch {
    /// The middle, in texels from the corner of the whole picture.
    pub(super) middle: [f32; 2],
    /// Half of its width and height.
    pub(super) radius: [f32; 2],
    /// Whether it is an ellipse.
    pub(super) round: bool,
}

/// Sums of weights, and of weighted light.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Total {
    pub(super) light: [f64; 3],
    pub(super) weight: f64,
}

impl Total {
    /// The mean; `None` of nothing.
    #[expect(clippy::cast_possible_truncation, reason = "sums are rounded to the precision of pictures")]
    pub(super) fn mean(&self) -> Option<[f32; 3]> {
        // Weights that are all but zero would give the mean no digits.
        (self.weight > 1e-30).then(|| self.light.map(|light| (light / self.weight) as f32))
    }
}

/// The same over lanes.
#[derive(Clone, Copy, Debug)]
struct Sums<F> {
    light: [F; 3],
    weight: F,
}

impl<F: Lanes> Sums<F> {
    #[inline(always)]
    fn new(zero: F) -> Self {
        Self { light: [zero; 3], weight: zero }
    }

    /// Adds all lanes to the total, in their order.
    #[inline(always)]
    fn flush(&mut self, total: &mut Total) {
        let zero = self.weight.splat(0.0);
        let mut numbers = [0.0; 16];
        for i in 0..3 {
            self.light[i].store(&mut numbers);
            total.light[i] += sum(&numbers[..F::WIDTH]);
        }
        self.weight.store(&mut numbers);
        total.weight += sum(&numbers[..F::WIDTH]);
        *self = Self::new(zero);
    }
}

/// The sum in double precision.
#[inline(always)]
fn sum(numbers: &[f32]) -> f64 {
    let mut sum = 0.0;
    for &x in numbers {
        sum += f64::from(x);
    }
    sum
}

/// Some texels.
#[derive(Clone, Copy)]
struct Taps<F: Lanes> {
    b: Vec3<F>,
    h: F,
    l: [F; 3],
    n: Vec3<F>,
    /// Number of pixels; nothing where areas count.
    m: F,
    area: Vec3<F>,
    id: F::Int,
}

/// Adds the texels of a patch.
#[inline(always)]
pub(super) fn patch<S: Isa>(isa: S, field: &Field, aim: &Aim<'_>, patch: &Patch, total: &mut Total) {
    let mut sums = Sums::new(isa.splat(0.0));
    let [columns, _] = field.size;
    let [top, bottom] = range(patch.middle[1], patch.radius[1], field.origin[1], field.size[1]);
    for row in top..bottom {
        let width = if patch.round {
            let y = ((field.origin[1] as usize + row) as f32 + 0.5 - patch.middle[1]) / patch.radius[1];
            patch.radius[0] * (1.0 - y * y).max(0.0).sqrt()
        } else {
            patch.radius[0]
        };
        let [from, to] = range(patch.middle[0], width, field.origin[0], columns);
        for x in (from / S::WIDTH * S::WIDTH..to).step_by(S::WIDTH) {
            let inside = isa.first(to - x) & !isa.first(from.saturating_sub(x));
            let taps = load(isa, field, row * columns + x);
            weigh(isa, aim, (&taps, inside, !field.area[0].is_empty()), &mut sums);
        }
        if (field.origin[1] as usize + row) % ROWS == ROWS - 1 {
            sums.flush(total);
        }
    }
    sums.flush(total);
}

/// Adds those texels of a patch that lie at `unit` places of a unit disc (two lists of as many numbers, padded to whole lanes), turned by
/// an angle of these cosine and sine; the first `count`.
#[inline(always)]
pub(super) fn scattered<S: Isa>(
    isa: S,
    (field, aim, patch): (&Field, &Aim<'_>, &Patch),
    ([unit_x, unit_y], count): ([&[f32]; 2], usize),
    [cos, sin]: [f32; 2],
    total: &mut Total,
) {
    let mut sums = Sums::new(isa.splat(0.0));
    let low = [field.origin[0] as f32, field.origin[1] as f32];
    let high = [low[0] + field.size[0] as f32, low[1] + field.size[1] as f32];
    let stride = u32::try_from(field.size[0]).unwrap_or(0);
    let zero = isa.splat(0.0);
    for k in (0..count).step_by(S::WIDTH) {
        let (u, v) = (isa.load(&unit_x[k..]), isa.load(&unit_y[k..]));
        let x = ((u * cos - v * sin) * patch.radius[0] + patch.middle[0]).floor();
        let y = ((u * sin + v * cos) * patch.radius[1] + patch.middle[1]).floor();
        let there = x.ge(low[0]) & x.lt(high[0]) & y.ge(low[1]) & y.lt(high[1]);
        let inside = there & isa.first(count - k);
        let column = S::F::select(inside, x - low[0], zero).to_int();
        let row = S::F::select(inside, y - low[1], zero).to_int();
        let at = Wrapping::<S::I>::wrapping_add(Wrapping::<u32>::wrapping_mul(row, stride), column);
        let taps = fetch(isa, field, at);
        weigh(isa, aim, (&taps, inside, !field.area[0].is_empty()), &mut sums);
    }
    sums.flush(total);
}

/// The texels whose middles are within `radius` of `middle`, of those that are there: the first, and the one after the last.
#[inline(always)]
#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "limited to what is there")]
fn range(middle: f32, radius: f32, origin: u32, size: usize) -> [usize; 2] {
    let (low, high) = ((middle - radius - 0.5).ceil(), (middle + radius - 0.5).floor() + 1.0);
    let origin = i64::from(origin);
    let from = ((low as i64) - origin).clamp(0, size as i64) as usize;
    let to = ((high as i64) - origin).clamp(0, size as i64) as usize;
    [from, to.max(from)]
}

// No closures here: what is left out of line is compiled without the instruction set.
#[inline(always)]
fn load<S: Isa>(isa: S, field: &Field, at: usize) -> Taps<S::F> {
    let has_areas = !field.area[0].is_empty();
    let zero = isa.splat(0.0);
    let l = load_vector(isa, &field.l, at);
    Taps {
        b: load_vector(isa, &field.b, at),
        h: isa.load(&field.h[at..]),
        l: [l.x, l.y, l.z],
        n: load_vector(isa, &field.n, at),
        m: if has_areas { zero } else { isa.load(&field.m[at..]) },
        area: if has_areas { load_vector(isa, &field.area, at) } else { Vec3::new(zero, zero, zero) },
        id: isa.load_u32(&field.id[at..]),
    }
}

#[inline(always)]
fn load_vector<S: Isa>(isa: S, columns: &[Vec<f32>; 3], at: usize) -> Vec3<S::F> {
    Vec3::new(isa.load(&columns[0][at..]), isa.load(&columns[1][at..]), isa.load(&columns[2][at..]))
}

#[inline(always)]
fn fetch<S: Isa>(isa: S, field: &Field, at: S::I) -> Taps<S::F> {
    let has_areas = !field.area[0].is_empty();
    let zero = isa.splat(0.0);
    let l = fetch_vector(isa, &field.l, at);
    Taps {
        b: fetch_vector(isa, &field.b, at),
        h: isa.gather(&field.h, at),
        l: [l.x, l.y, l.z],
        n: fetch_vector(isa, &field.n, at),
        m: if has_areas { zero } else { isa.gather(&field.m, at) },
        area: if has_areas { fetch_vector(isa, &field.area, at) } else { Vec3::new(zero, zero, zero) },
        id: isa.gather_u32(&field.id, at),
    }
}

#[inline(always)]
fn fetch_vector<S: Isa>(isa: S, columns: &[Vec<f32>; 3], at: S::I) -> Vec3<S::F> {
    Vec3::new(isa.gather(&columns[0], at), isa.gather(&columns[1], at), isa.gather(&columns[2], at))
}

#[inline(always)]
fn splat<S: Isa>(isa: S, v: [f32; 3]) -> Vec3<S::F> {
    Vec3::new(isa.splat(v[0]), isa.splat(v[1]), isa.splat(v[2]))
}

/// Adds the texels that lie `inside`, where they are of the same reflector and of the lobe.
#[inline(always)]
fn weigh<S: Isa>(
    isa: S,
    aim: &Aim<'_>,
    (taps, inside, by_area): (&Taps<S::F>, S::M, bool),
    sums: &mut Sums<S::F>,
) {
    let zero = isa.splat(0.0);
    let lobe = aim.lobe;
    // Towards where the other ray ends: directions have h = 0, and stay what they are.
    let d = taps.b - splat(isa, aim.a) * taps.h;
    let inverse = d.length2().max(1e-30).rsqrt();
    let t = (d * inverse - splat(isa, aim.w)).length2() * 0.5;
    let turned = (taps.n - splat(isa, aim.n)).length2();
    let same = inside & taps.id.eq(aim.id) & turned.le(lobe.normals_apart());
    let hit = match aim.rejection {
        Rejection::Cosine => same & t.le(lobe.t_max),
        Rejection::Angle => same & (-t + 1.0).clamp(-1.0, 1.0).acos().le(lobe.angle()),
    };
    if hit.none() {
        return;
    }
    let f = if lobe.table.is_empty() {
        // The series of ln(1 - t) to its fifth term, or all of it.
        let ln = if lobe.t_max < NARROW {
            let series = t.mul_add(t.splat(0.2), t.splat(0.25)).mul_add(t, t.splat(1.0 / 3.0));
            -series.mul_add(t, t.splat(0.5)).mul_add(t, t.splat(1.0)) * t
        } else {
            (-t).max(-0.999_999_9).ln_1p()
        };
        (ln * lobe.exponent).exp()
    } else {
        let at = S::F::select(hit, t * lobe.steps_per_t(), zero);
        let whole = at.floor();
        let index = whole.to_int();
        let (low, high) = (
            isa.gather(&lobe.table, index),
            isa.gather(&lobe.table, Wrapping::<u32>::wrapping_add(index, 1)),
        );
        low.lerp(high, at - whole)
    };
    let size = if by_area { taps.area.dot(d).abs() * inverse * inverse * inverse } else { taps.m };
    let weight = S::F::select(hit, f * size, zero);
    sums.weight += weight;
    for i in 0..3 {
        sums.light[i] = weight.mul_add(taps.l[i], sums.light[i]);
    }
}
