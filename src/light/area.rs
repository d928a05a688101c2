//! Flat and tessellated area lights, sampled by area.
//!
//! A point of the surface is drawn uniformly; the density per area 1/A becomes d^2 / (A cos) per solid angle. Enough for
//! lights that subtend less than about half a radian; larger and nearer ones are right but noisy.

use crate::light::{Emitter, LightSample, Reference};
use crate::math::lanes::{IntLanes, Isa, Lanes, Wrapping};
use crate::math::{Rgb, Vec3};
use crate::sampling::{Picks, Table1d, TableError, warp};
use crate::texture::Texture;
use std::f32::consts::PI;

/// A point drawn from a surface.
#[derive(Clone, Copy, Debug)]
pub struct SurfacePoint<F> {
    /// Where.
    pub p: Vec3<F>,
    /// Unit normal.
    pub n: Vec3<F>,
    /// Density with respect to area, 1/m^2.
    pub pdf: F,
    /// Radiance there, where it is not the same everywhere.
    pub radiance: Option<Rgb<F>>,
}

/// A surface that can be sampled uniformly.
pub trait SampleArea {
    /// A point of the surface, like `like` in kind.
    fn sample_area<F: Lanes>(&self, like: F, u2: [F; 2]) -> SurfacePoint<F>;

    /// Density of [`Self::sample_area`] on primitive `prim`, with respect to area.
    fn pdf_area(&self, prim: u32) -> f32;

    /// Area, m^2.
    fn area(&self) -> f32;
}

/// A surface that shines.
#[derive(Clone, Debug)]
pub struct Area<S> {
    /// The surface.
    pub surface: S,
    /// Emitted radiance; its mean where the surface says that it is not the same everywhere.
    pub radiance: Rgb<f32>,
    /// Whether the back shines too.
    pub two_sided: bool,
}

impl<S: SampleArea> Area<S> {
    #[inline(always)]
    pub(super) fn sample<F: Lanes>(&self, at: Reference<F>, u2: [F; 2]) -> LightSample<F> {
        let like = at.p.x;
        let SurfacePoint { p, n, pdf, radiance } = self.surface.sample_area(like, u2);
        let way = p - at.p;
        let distance2 = way.length2();
        let wi = way * distance2.max(1e-30).rsqrt();
        let facing = -wi.dot(n);
        let cos = if self.two_sided { facing.abs() } else { facing };
        let pdf = distance2 * pdf / cos.max(1e-30);
        let valid = cos.gt(0.0) & distance2.gt(0.0) & wi.dot(at.n).gt(0.0) & pdf.is_finite();
        let li = match radiance {
            Some(own) => own,
            None => Rgb::splat(like, self.radiance),
        };
        LightSample { wi, p, li, pdf, valid }
    }

    pub(super) fn pdf(&self, at: Reference<f32>, wi: Vec3<f32>, emitter: &Emitter) -> f32 {
        let facing = -wi.dot(emitter.ng.into());
        let cos = if self.two_sided { facing.abs() } else { facing };
        let distance2 = (Vec3::from(emitter.p) - at.p).length2();
        if cos > 0.0 { distance2 * self.surface.pdf_area(emitter.prim) / cos } else { 0.0 }
    }

    pub(super) fn power(&self) -> f32 {
        let sides = if self.two_sided { 2.0 } else { 1.0 };
        self.radiance.luminance() * PI * self.surface.area() * sides
    }
}

/// The points `center + s edge_u + t edge_v` with s and t in [-1, 1].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RectangleArea {
    center: Vec3<f32>,
    edge_u: Vec3<f32>,
    edge_v: Vec3<f32>,
    normal: Vec3<f32>,
    area: f32,
}

impl RectangleArea {
    /// From the centre and half edges; the normal is along `edge_u` x `edge_v`.
    #[must_use]
    pub fn new(center: glam::Vec3, edge_u: glam::Vec3, edge_v: glam::Vec3) -> Self {
        let across = edge_u.cross(edge_v);
        let [center, edge_u, edge_v] = [center, edge_u, edge_v].map(Vec3::from);
        Self { center, edge_u, edge_v, normal: across.normalize().into(), area: 4.0 * across.length() }
    }
}

impl SampleArea for RectangleArea {
    #[inline(always)]
    fn sample_area<F: Lanes>(&self, like: F, [u, v]: [F; 2]) -> SurfacePoint<F> {
        let along_u = Vec3::splat(like, self.edge_u) * (u * 2.0 - 1.0);
        let along_v = Vec3::splat(like, self.edge_v) * (v * 2.0 - 1.0);
        let p = Vec3::splat(like, self.center) + along_u + along_v;
        SurfacePoint {
            p,
            n: Vec3::splat(like, self.normal),
            pdf: like.splat(1.0 / self.area),
            radiance: None,
        }
    }

    fn pdf_area(&self, _prim: u32) -> f32 {
        1.0 / self.area
    }

    fn area(&self) -> f32 {
        self.area
    }
}

/// A flat disc.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DiscArea {
    center: Vec3<f32>,
    normal: Vec3<f32>,
    x: Vec3<f32>,
    y: Vec3<f32>,
    area: f32,
}

impl DiscArea {
    /// From the centre, the unit normal and the radius.
    #[must_use]
    pub fn new(center: glam::Vec3, normal: glam::Vec3, radius: f32) -> Self {
        let (x, y) = normal.any_orthonormal_pair();
        let [center, normal, x, y] = [center, normal, x * radius, y * radius].map(Vec3::from);
        Self { center, normal, x, y, area: PI * radius * radius }
    }
}

impl SampleArea for DiscArea {
    #[inline(always)]
    fn sample_area<F: Lanes>(&self, like: F, u2: [F; 2]) -> SurfacePoint<F> {
        let [x, y] = warp::disc(u2);
        let p =
            Vec3::splat(like, self.center) + Vec3::splat(like, self.x) * x + Vec3::splat(like, self.y) * y;
        SurfacePoint {
            p,
            n: Vec3::splat(like, self.normal),
            pdf: like.splat(1.0 / self.area),
            radiance: None,
        }
    }

    fn pdf_area(&self, _prim: u32) -> f32 {
        1.0 / self.area
    }

    fn area(&self) -> f32 {
        self.area
    }
}

/// Vectors kept of a triangle.
const ROWS: u32 = 4;

/// Triangles, each chosen in proportion to its area.
#[derive(Clone, Debug)]
pub struct MeshArea {
    /// For each triangle its corners and its unit normal.
    rows: Vec<[f32; 3]>,
    areas: Vec<f32>,
    choice: Table1d,
    area: f32,
    paint: Option<Paint>,
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
        Ok(Self { rows: triangles.iter().flat_map(row).collect(), areas, choice, area, paint: None })
    }

    /// The same triangles with a radiance that changes over these surface parameters of their corners. Triangles are chosen by area,
    /// however bright they are.
    #[must_use]
    pub fn painted(self, uvs: &[[glam::Vec2; 3]], radiance: Texture) -> Self {
        let uvs = uvs.iter().flatten().flat_map(|uv| uv.to_array()).collect();
        Self { paint: Some(Paint { uvs, radiance }), ..self }
    }

    /// The same triangles, each shining on the side that the normals of its corners point to, where it has some: vertex normals
    /// are more often right than the winding, as hits have it.
    #[must_use]
    pub fn facing(mut self, normals: impl Fn(u32) -> Option<[glam::Vec3; 3]>) -> Self {
        for (triangle, rows) in (0..).zip(self.rows.chunks_exact_mut(ROWS as usize)) {
            let own = glam::Vec3::from(rows[3]);
            let turned = |corners: [glam::Vec3; 3]| corners.iter().sum::<glam::Vec3>().dot(own) < 0.0;
            if normals(triangle).is_some_and(turned) {
                rows[3] = (-own).to_array();
            }
        }
        self
    }

    #[inline(always)]
    fn vector<I: IntLanes>(&self, first: I, k: u32) -> Vec3<I::F> {
        let [x, y, z] = first.isa().gather_rows(&self.rows, Wrapping::<u32>::wrapping_add(first, k));
        Vec3::new(x, y, z)
    }
}

fn area_of([a, b, c]: &[glam::Vec3; 3]) -> f32 {
    (b - a).cross(c - a).length() * 0.5
}

impl SampleArea for MeshArea {
    #[expect(clippy::manual_map, reason = "a closure may be left out of line, without the instruction set")]
    #[inline(always)]
    fn sample_area<F: Lanes>(&self, like: F, [u, v]: [F; 2]) -> SurfacePoint<F> {
        // What is left of the number within its cell is as good as new.
        let Picks { index, within, probability } = self.choice.sample_lanes(u);
        let first = Wrapping::<u32>::wrapping_mul(index, ROWS);
        let [b0, b1, b2] = warp::triangle([within.min(1.0 - f32::EPSILON), v]);
        let p = self.vector(first, 0) * b0 + self.vector(first, 1) * b1 + self.vector(first, 2) * b2;
        let area = like.isa().gather(&self.areas, index);
        let radiance = match &self.paint {
            Some(paint) => Some(paint.at(index, [b0, b1, b2])),
            None => None,
        };
        SurfacePoint { p, n: self.vector(first, 3), pdf: probability / area, radiance }
    }

    fn pdf_area(&self, prim: u32) -> f32 {
        let index = prim as usize;
        self.areas.get(index).map_or(0.0, |area| self.choice.probability(index) / area)
    }

    fn area(&self) -> f32 {
        self.area
    }
}
