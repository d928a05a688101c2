//! Points of surfaces over lanes: the resolved point of [`crate::geometry::Interaction`] for several rays at once.

use crate::geometry::{Mesh, Sphere};
use crate::math::Vec3;
use crate::math::float::{UNIT_ROUNDOFF, gamma};
use crate::math::lanes::{IntLanes, Isa, Lanes, MaskLanes, Select, Wrapping};

/// Roundings that an intersection test spends on a point near its own triangle; `tests/spawn.rs` counts the rays that a
/// smaller number lets hit what they leave.
const TRIANGLE_ROUNDINGS: f32 = 4.0;

/// Points of surfaces; see [`crate::geometry::SurfacePoint`] for the fields.
#[derive(Clone, Copy, Debug)]
#[expect(missing_docs, reason = "the fields are those of `SurfacePoint`")]
pub struct Points<F> {
    pub p: Vec3<F>,
    pub p_error: Vec3<F>,
    pub ng: Vec3<F>,
    pub ns: Vec3<F>,
    pub uv: [F; 2],
    /// How many units of the surface parameters there are to a metre, as a mean over directions; 0 where that is not known.
    pub density: F,
}

impl<F: Lanes> Select for Points<F> {
    type Mask = F::Mask;
    #[inline(always)]
    fn select(mask: F::Mask, yes: Self, no: Self) -> Self {
        Self {
            p: Vec3::select(mask, yes.p, no.p),
            p_error: Vec3::select(mask, yes.p_error, no.p_error),
            ng: Vec3::select(mask, yes.ng, no.ng),
            ns: Vec3::select(mask, yes.ns, no.ns),
            uv: [F::select(mask, yes.uv[0], no.uv[0]), F::select(mask, yes.uv[1], no.uv[1])],
            density: F::select(mask, yes.density, no.density),
        }
    }
}

/// What is known of the triangles that were hit.
pub(super) struct Corners<F> {
    pub(super) positions: [Vec3<F>; 3],
    pub(super) normals: Option<[Vec3<F>; 3]>,
    pub(super) uvs: Option<[[F; 2]; 3]>,
    /// Whether corners are interpolated between keys.
    pub(super) moving: bool,
}

impl<F: Lanes> Corners<F> {
    /// The points with these barycentric parameters; `ng` is the hit's normal, for triangles without area.
    #[inline(always)]
    pub(super) fn at(&self, [u, v]: [F; 2], ng: Vec3<F>) -> Points<F> {
        let [a, b, c] = self.positions;
        let w = -u - v + 1.0;
        let p = a * w + b * u + c * v;
        let (e1, e2) = (b - a, c - a);
        let cross = e1.cross(e2);
        let twice_area = cross.length();
        let up = Vec3::new(u.splat(0.0), u.splat(0.0), u.splat(1.0));
        let per_area = twice_area.max(f32::MIN_POSITIVE).recip();
        let whole = twice_area.ge(f32::MIN_POSITIVE) & twice_area.is_finite();
        let plane = cross * per_area;
        let ng = if whole.all() { plane } else { Vec3::select(whole, plane, ng.normalize_or(up)) };
        // The plane of a needle is known less well than that of a fat triangle: by the ratio of edges to area.
        let (l1, l2) = (e1.length2(), e2.length2());
        let (longer, shorter) = (l1.max(l2).sqrt(), l1.min(l2).sqrt());
        let slenderness = (shorter * per_area * longer).min(1e3);
        let traversal = (slenderness + 1.0) * longer * (TRIANGLE_ROUNDINGS * UNIT_ROUNDOFF);
        // Corners on their way are off by the rounding of their interpolation.
        let roundings = if self.moving { gamma(11) } else { gamma(7) };
        let p_error = (a.abs() * w.abs() + b.abs() * u + c.abs() * v).scale(roundings);
        let p_error = p_error + Vec3::new(traversal, traversal, traversal);
        let ns = match self.normals {
            Some([na, nb, nc]) => (na * w + nb * u + nc * v).normalize_or(ng),
            None => ng,
        };
        // Vertex normals are more often right than the winding.
        let ng = Vec3::select(ns.dot(ng).lt(0.0), -ng, ng);
        let (uv, density) = match self.uvs {
            Some([ta, tb, tc]) => {
                let ([s1, t1], [s2, t2]) = ([tb[0] - ta[0], tb[1] - ta[1]], [tc[0] - ta[0], tc[1] - ta[1]]);
                let density = ((s1 * t2 - t1 * s2).abs() * per_area).sqrt();
                ([ta[0] * w + tb[0] * u + tc[0] * v, ta[1] * w + tb[1] * u + tc[1] * v], density)
            }
            None => ([u, v], u.splat(0.0)),
        };
        Points { p, p_error, ng, ns, uv, density }
    }
}

impl Mesh {
    /// Whether [`Mesh::points`] can be asked: vertices stay, and their numbers are not too many for gathers.
    #[must_use]
    pub fn has_points(&self) -> bool {
        let most = i32::MAX.unsigned_abs() as usize / 3;
        self.key_count() == 1 && self.positions().len() < most && self.triangles().len() < most
    }

    /// The points on `triangles` with these barycentric parameters; `ng` are the hits' normals. Their surface parameters are found
    /// only where they are `textured`.
    #[expect(clippy::manual_map, reason = "a closure may be left out of line, without the instruction set")]
    #[inline(always)]
    pub fn points<F: Lanes>(&self, triangles: F::Int, uv: [F; 2], ng: Vec3<F>, textured: bool) -> Points<F> {
        let corners = triangles.isa().gather_rows_u32(self.triangles(), triangles);
        let normals = match self.normals() {
            Some(normals) => Some(vectors(bytemuck::cast_slice(normals), corners)),
            None => None,
        };
        let uvs = match self.uvs() {
            Some(uvs) if textured => Some(pairs(bytemuck::cast_slice(uvs), corners)),
            _ => None,
        };
        let positions = vectors(bytemuck::cast_slice(self.positions()), corners);
        Corners { positions, normals, uvs, moving: false }.at(uv, ng)
    }
}

impl Sphere {
    /// The points nearest to those that rays have met; surface parameters are left out.
    #[inline(always)]
    pub fn points<F: Lanes>(&self, near: Vec3<F>) -> Points<F> {
        let like = near.x;
        let spread = |v: glam::Vec3| Vec3::new(like.splat(v.x), like.splat(v.y), like.splat(v.z));
        let center = spread(self.center);
        let n = (near - center).normalize_or(spread(glam::Vec3::Z));
        let (p, p_error) = (center + n.scale(self.radius), spread(self.error()));
        Points { p, p_error, ng: n, ns: n, uv: [like.splat(0.0); 2], density: like.splat(0.0) }
    }
}

#[inline(always)]
fn number<I: IntLanes>(table: &[f32], first: I, k: u32) -> I::F {
    first.isa().gather(table, Wrapping::<u32>::wrapping_add(first, k))
}

#[inline(always)]
fn vectors<I: IntLanes>(table: &[[f32; 3]], [a, b, c]: [I; 3]) -> [Vec3<I::F>; 3] {
    [vector(table, a), vector(table, b), vector(table, c)]
}

#[inline(always)]
fn vector<I: IntLanes>(table: &[[f32; 3]], i: I) -> Vec3<I::F> {
    let [x, y, z] = i.isa().gather_rows(table, i);
    Vec3::new(x, y, z)
}

#[inline(always)]
fn pairs<I: IntLanes>(table: &[f32], [a, b, c]: [I; 3]) -> [[I::F; 2]; 3] {
    let [a, b, c] = [a << 1, b << 1, c << 1];
    [
        [number(table, a, 0), number(table, a, 1)],
        [number(table, b, 0), number(table, b, 1)],
        [number(table, c, 0), number(table, c, 1)],
    ]
}
