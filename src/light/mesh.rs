//! Triangles that shine.
//!
//! A mesh of few triangles is drawn from by solid angle where it looks large: each triangle that faces the reference point in proportion to
//! its own. Of others one triangle is chosen in proportion to its area (and brightness, where that changes); where somebody else
//! has chosen (a tree of lights), the triangle looks large by itself or does not.

use crate::light::area::{Asked, Density, NEAR, SampleArea, SurfacePoint, TINY, length2_alike};
use crate::math::lanes::{IntLanes, Isa, Lanes, MaskLanes, Select, Wrapping};
use crate::math::{Rgb, Vec3};
use crate::sampling::{Picks, SphericalTriangle, Table1d, TableError, warp};
use crate::texture::Texture;

/// Vectors kept of a triangle.
const ROWS: u32 = 4;

/// The most triangles that are all looked at from every reference point.
const FEW: usize = 12;

/// Nearer to the plane of a triangle, in sizes of its mesh, it is not asked: lobes find it. Seen from a point of the triangle itself, and from where a
/// ray leaves that point, it would be half of all directions or nothing, as rounding has it.
const LOWEST: f32 = 1e-5;

/// Triangles.
#[derive(Clone, Debug)]
pub struct MeshArea {
    /// For each triangle its corners and its unit normal.
    rows: Vec<[f32; 3]>,
    areas: Vec<f32>,
    choice: Table1d,
    area: f32,
    paint: Option<Paint>,
    seat: Option<Seat>,
}

/// A ball around few triangles.
#[derive(Clone, Copy, Debug)]
struct Seat {
    center: Vec3<f32>,
    /// One over the radius.
    inverse: f32,
    /// Squared distance up to which the mesh is near.
    reach2: f32,
}

/// Radiance over triangles.
#[derive(Clone, Debug)]
struct Paint {
    /// Six surface parameters for each triangle.
    uvs: Vec<f32>,
    radiance: Texture,
}

impl Paint {
    /// The radiance of a point of the triangles by its barycentric weights.
    #[inline(always)]
    fn at<F: Lanes>(&self, index: F::Int, [b0, b1, b2]: [F; 3]) -> Rgb<F> {
        let isa = index.isa();
        let first = Wrapping::<u32>::wrapping_mul(index, 6);
        let [a, b, c, d, e, f] = [
            isa.gather(&self.uvs, first),
            isa.gather(&self.uvs, Wrapping::<u32>::wrapping_add(first, 1)),
            isa.gather(&self.uvs, Wrapping::<u32>::wrapping_add(first, 2)),
            isa.gather(&self.uvs, Wrapping::<u32>::wrapping_add(first, 3)),
            isa.gather(&self.uvs, Wrapping::<u32>::wrapping_add(first, 4)),
            isa.gather(&self.uvs, Wrapping::<u32>::wrapping_add(first, 5)),
        ];
        self.radiance.at([a * b0 + c * b1 + e * b2, b * b0 + d * b1 + f * b2])
    }
}

impl MeshArea {
    /// From triangles in world space, counter-clockwise seen from the side that shines. Fails if all are degenerate or
    /// there are more than [`Table1d::MAX_LEN`].
    pub fn new(triangles: Vec<[glam::Vec3; 3]>) -> Result<Self, TableError> {
        let areas: Vec<f32> = triangles.iter().map(area_of).collect();
        let choice = Table1d::new(&areas)?;
        #[expect(clippy::cast_possible_truncation, reason = "summed in double precision, used in single")]
        let area = choice.total() as f32;
        let row = |corners: &[glam::Vec3; 3]| {
            let [a, b, c] = *corners;
            let n = (b - a).cross(c - a).normalize_or_zero();
            [a, b, c, n].map(|v| v.to_array())
        };
        let seat = if triangles.len() <= FEW { Seat::of(&triangles) } else { None };
        Ok(Self { rows: triangles.iter().flat_map(row).collect(), areas, choice, area, paint: None, seat })
    }

    /// The same triangles with a radiance that changes over these surface parameters of their corners. Each is chosen in proportion to
    /// what it gives off; within a triangle points are drawn however bright they are.
    #[must_use]
    pub fn painted(self, uvs: &[[glam::Vec2; 3]], radiance: Texture) -> Self {
        let brightness: Vec<f32> = uvs.iter().map(|corners| brightness(corners, &radiance)).collect();
        let powers = || self.areas.iter().zip(&brightness).map(|(area, bright)| area * bright);
        // What has been looked at in a few places only is not dark for sure.
        let least = 0.05 * powers().sum::<f32>() / self.area;
        let weights: Vec<f32> = powers().zip(&self.areas).map(|(power, area)| power + least * area).collect();
        let choice = Table1d::new(&weights).unwrap_or_else(|_| self.choice.clone());
        let uvs = uvs.iter().flatten().flat_map(|uv| uv.to_array()).collect();
        Self { paint: Some(Paint { uvs, radiance }), choice, ..self }
    }

    /// Whether its triangles are better chosen one by one.
    pub(super) fn is_split(&self) -> bool {
        self.areas.len() > FEW
    }

    /// Each triangle: its number, corners and normal, and its share of the light.
    pub(super) fn triangles(&self) -> impl Iterator<Item = (u32, [glam::Vec3; 3], glam::Vec3, f32)> {
        let rows = self.rows.chunks_exact(ROWS as usize).zip(0..);
        rows.map(|(rows, number)| {
            let corners = [rows[0], rows[1], rows[2]].map(glam::Vec3::from);
            (number, corners, rows[3].into(), self.choice.probability(number as usize))
        })
    }

    #[inline(always)]
    fn vector<I: IntLanes>(&self, first: I, k: u32) -> Vec3<I::F> {
        let [x, y, z] = first.isa().gather_rows(&self.rows, Wrapping::<u32>::wrapping_add(first, k));
        Vec3::new(x, y, z)
    }

    /// Vector `k` of a triangle that is the same in all lanes.
    #[inline(always)]
    fn same<F: Lanes>(&self, like: F, triangle: usize, k: usize) -> Vec3<F> {
        let [x, y, z] = self.rows[triangle * ROWS as usize + k];
        Vec3::splat(like, Vec3::new(x, y, z))
    }

    /// How large each of few triangles looks from where it shines on, and all together; and where the mesh is near. `None` where it is
    /// not.
    #[inline(always)]
    fn seen<F: Lanes>(&self, asked: Asked<F>) -> Option<([F; FEW], F, F::Mask)> {
        let seat = match &self.seat {
            Some(seat) => seat,
            None => return None,
        };
        let like = asked.from.x;
        let is_near = length2_alike(Vec3::splat(like, seat.center) - asked.from).lt(seat.reach2);
        if is_near.none() {
            return None;
        }
        let zero = like.splat(0.0);
        let (mut each, mut all) = ([zero; FEW], zero);
        for (i, (own, area)) in each.iter_mut().zip(&self.areas).enumerate() {
            let way = |corner: Vec3<F>| (corner - asked.from).scale(seat.inverse);
            let ways = [way(self.same(like, i, 0)), way(self.same(like, i, 1)), way(self.same(like, i, 2))];
            let twice = 2.0 * area * seat.inverse * seat.inverse;
            let height = ways[0].dot(self.same(like, i, 3));
            let angle = SphericalTriangle::new(ways, height * twice).solid_angle();
            let shines = if asked.two_sided { height.abs().gt(LOWEST) } else { height.lt(-LOWEST) };
            *own = F::select(shines, angle, zero);
            all += *own;
        }
        Some((each, all, is_near & all.gt(TINY)))
    }

    /// A triangle of each lane as it looks from the reference point, in units of its own size; and where it is near.
    #[inline(always)]
    fn triangle_seen<F: Lanes>(&self, from: Vec3<F>, index: F::Int) -> (SphericalTriangle<F>, F::Mask) {
        let first = Wrapping::<u32>::wrapping_mul(index, ROWS);
        let [a, b, c, n] =
            [self.vector(first, 0), self.vector(first, 1), self.vector(first, 2), self.vector(first, 3)];
        let center = (a + b + c).scale(1.0 / 3.0);
        let [ra, rb, rc] = [length2_alike(a - center), length2_alike(b - center), length2_alike(c - center)];
        let radius2 = ra.max(rb).max(rc);
        let is_near = length2_alike(center - from).lt(radius2 * NEAR);
        let inverse = radius2.max(1e-35).rsqrt();
        let ways = [(a - from) * inverse, (b - from) * inverse, (c - from) * inverse];
        let area = index.isa().gather(&self.areas, index);
        let volume = ways[0].dot(n) * area * inverse * inverse * 2.0;
        let seen = SphericalTriangle::new(ways, volume);
        (seen, is_near & seen.solid_angle().gt(TINY) & inverse.is_finite())
    }

    /// A triangle for the first number by what is known without a reference point, and what is left of the number.
    #[inline(always)]
    fn by_table<F: Lanes>(&self, u: F) -> Picks<F> {
        let picks = self.choice.sample_lanes(u);
        // What is left of the number within its cell is as good as new.
        Picks { within: picks.within.min(1.0 - f32::EPSILON), ..picks }
    }
}

impl Seat {
    fn of(triangles: &[[glam::Vec3; 3]]) -> Option<Self> {
        let corners = || triangles.iter().flatten();
        let least = corners().copied().reduce(glam::Vec3::min)?;
        let most = corners().copied().reduce(glam::Vec3::max)?;
        let center = least.midpoint(most);
        let radius = corners().map(|corner| corner.distance(center)).fold(0.0, f32::max);
        let (inverse, reach2) = (radius.recip(), NEAR * radius * radius);
        let exists = reach2.is_normal() && (inverse * inverse).is_normal();
        exists.then_some(Self { center: center.into(), inverse, reach2 })
    }
}

/// Mean luminance over a triangle by the surface parameters of its corners, from places that spread evenly over it.
fn brightness([a, b, c]: &[glam::Vec2; 3], radiance: &Texture) -> f32 {
    const EDGE: u16 = 8;
    let cell = |i: u16| (f32::from(i) + 0.5) / f32::from(EDGE);
    let places = (0..EDGE).flat_map(|i| (0..EDGE).map(move |j| [cell(i), cell(j)]));
    let at = |u2: [f32; 2]| {
        let [x, y, z] = warp::triangle(u2);
        radiance.at::<f32>((*a * x + *b * y + *c * z).to_array()).luminance()
    };
    places.map(at).sum::<f32>() / f32::from(EDGE * EDGE)
}

fn area_of([a, b, c]: &[glam::Vec3; 3]) -> f32 {
    (b - a).cross(c - a).length() * 0.5
}

impl SampleArea for MeshArea {
    #[expect(clippy::manual_map, reason = "a closure may be left out of line, without the instruction set")]
    #[inline(always)]
    fn sample<F: Lanes>(&self, asked: Asked<F>, [u, v]: [F; 2]) -> SurfacePoint<F> {
        let like = asked.from.x;
        let isa = like.isa();
        let (mut index, mut within, probability) = match asked.part {
            Some(part) => (part, u, like.splat(1.0)),
            None => {
                let picks = self.by_table(u);
                (picks.index, picks.within, picks.probability)
            }
        };
        let (mut by_angle, mut angle) = (isa.splat_mask(false), like.splat(1.0));
        if asked.part.is_none()
            && let Some((each, all, is_near)) = self.seen(asked)
        {
            let (chosen, rest) = choose(each, all, u);
            index = F::Int::select(is_near, chosen, index);
            within = F::select(is_near, rest, within);
            (by_angle, angle) = (is_near, all);
        }
        let mut weights = warp::triangle([within, v]);
        if asked.part.is_some() || by_angle.any() {
            let (seen, is_near) = self.triangle_seen(asked.from, index);
            if asked.part.is_some() {
                (by_angle, angle) = (is_near, seen.solid_angle());
            }
            let [a, b, c] = seen.sample([within, v]);
            let [x, y, z] = weights;
            weights = [F::select(by_angle, a, x), F::select(by_angle, b, y), F::select(by_angle, c, z)];
        }
        let first = Wrapping::<u32>::wrapping_mul(index, ROWS);
        let [b0, b1, b2] = weights;
        let p = self.vector(first, 0) * b0 + self.vector(first, 1) * b1 + self.vector(first, 2) * b2;
        let area = isa.gather(&self.areas, index);
        let radiance = match &self.paint {
            Some(paint) => Some(paint.at(index, weights)),
            None => None,
        };
        let pdf = F::select(by_angle, angle.recip(), probability / area);
        SurfacePoint { p, n: self.vector(first, 3), pdf, by_angle, radiance }
    }

    fn pdf(&self, asked: Asked<f32>, prim: u32) -> Density {
        let index = prim as usize;
        let Some(area) = self.areas.get(index) else { return Density::Area(0.0) };
        if asked.part.is_some() {
            return match self.triangle_seen(asked.from, prim) {
                (seen, true) => Density::Angle(seen.solid_angle().recip()),
                _ => Density::Area(1.0 / area),
            };
        }
        match self.seen(asked) {
            Some((each, all, true)) => Density::Angle(if each[index] > 0.0 { all.recip() } else { 0.0 }),
            _ => Density::Area(self.choice.probability(index) / area),
        }
    }

    fn area(&self) -> f32 {
        self.area
    }
}

/// One of few triangles in proportion to its solid angle, and what is left of the number.
#[inline(always)]
fn choose<F: Lanes>(each: [F; FEW], all: F, u: F) -> (F::Int, F) {
    let target = u * all;
    let (mut at, mut start, mut own) = (u.splat(0.0), u.splat(0.0), u.splat(1.0));
    let mut index = u.to_bits().splat(0);
    for (i, angle) in (0..).zip(each) {
        let chosen = target.ge(at) & angle.gt(0.0);
        index = F::Int::select(chosen, index.splat(i), index);
        start = F::select(chosen, at, start);
        own = F::select(chosen, angle, own);
        at += angle;
    }
    (index, ((target - start) / own).clamp(0.0, 1.0 - f32::EPSILON))
}
