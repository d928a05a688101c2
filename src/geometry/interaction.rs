//! The resolved point on a surface.

use crate::geometry::{Disc, Hit, Mesh, PlacementId, Ray, Shape, Sphere, World, spawn};
use crate::math::float::{UNIT_ROUNDOFF, gamma};
use glam::{Vec2, Vec3};

/// A point on a surface, ready to be shaded.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Interaction {
    /// The point, recomputed from surface parameters: its error does not grow with the length of the ray.
    pub p: Vec3,
    /// Bound on the error of `p` per axis, including what an intersection test near it may get wrong.
    pub p_error: Vec3,
    /// Unit direction towards where the ray came from.
    pub wo: Vec3,
    /// Unit geometric normal, outward.
    pub ng: Vec3,
    /// Unit shading normal, on the side of `ng`.
    pub ns: Vec3,
    /// Surface parameters: those of the mesh's file, else barycentric; longitude and latitude on a sphere.
    pub uv: Vec2,
    /// Ray parameter of the hit.
    pub t: f32,
    /// Moment within the shutter, in [0, 1].
    pub time: f32,
    /// What was hit.
    pub placement: PlacementId,
    /// Which of its primitives.
    pub prim: u32,
    /// The group of that primitive.
    pub group: u16,
}

impl Interaction {
    /// Whether the ray came from outside.
    #[must_use]
    pub fn is_front(&self) -> bool {
        self.wo.dot(self.ng) > 0.0
    }

    /// The ray that leaves along `d`, at the same moment.
    #[must_use]
    pub fn spawn(&self, d: Vec3) -> Ray {
        spawn::ray(self.p, self.p_error, self.ng, d).at_time(self.time)
    }

    /// The ray towards a point that ends just before it; parameters count from 0 at the start to 1 at the point.
    #[must_use]
    pub fn spawn_to(&self, target: Vec3) -> Ray {
        let o = spawn::origin(self.p, self.p_error, self.ng, target - self.p);
        Ray::new(o, target - o).until(spawn::SHADOW_REACH).at_time(self.time)
    }
}

/// A surface point in the space of its shape.
struct Local {
    p: Vec3,
    p_error: Vec3,
    ng: Vec3,
    ns: Vec3,
    uv: Vec2,
    group: u16,
}

impl World {
    /// The point that `hit` of `ray` names, in world space.
    #[must_use]
    pub fn interaction(&self, ray: &Ray, hit: &Hit) -> Interaction {
        let placement = &self.placements[hit.placement.index()];
        let p_ray = ray.at(hit.t);
        let p_ray = placement.transform.map_or(p_ray, |t| t.inverse_point(p_ray));
        let local = match &self.shapes[placement.shape.index()] {
            Shape::Mesh(mesh) => on_mesh(mesh, hit),
            Shape::Sphere(sphere) => on_sphere(sphere, p_ray),
            Shape::Disc(disc) => on_disc(disc, p_ray),
        };
        let local = match &placement.transform {
            None => local,
            Some(t) => {
                let p = t.point(local.p);
                Local {
                    p,
                    p_error: t.point_error(local.p, local.p_error) + t.inverse_point_error(p),
                    ng: t.normal(local.ng).normalize_or(local.ng),
                    ns: t.normal(local.ns).normalize_or(local.ns),
                    ..local
                }
            }
        };
        Interaction {
            p: local.p,
            p_error: local.p_error,
            wo: -ray.d.normalize(),
            ng: local.ng,
            ns: if local.ns.dot(local.ng) < 0.0 { -local.ns } else { local.ns },
            uv: local.uv,
            t: hit.t,
            time: ray.time,
            placement: hit.placement,
            prim: hit.prim,
            group: local.group,
        }
    }
}

/// Roundings that an intersection test spends on a point near its own triangle; `tests/spawn.rs` counts the rays that a
/// smaller number lets hit what they leave.
const TRIANGLE_ROUNDINGS: f32 = 4.0;

/// The same for spheres and discs.
const ROUND_ROUNDINGS: f32 = 8.0;

fn on_mesh(mesh: &Mesh, hit: &Hit) -> Local {
    let [a, b, c] = mesh.corners(hit.prim);
    let (u, v) = (hit.u, hit.v);
    let w = 1.0 - u - v;
    let p = a * w + b * u + c * v;
    let (e1, e2) = (b - a, c - a);
    let cross = e1.cross(e2);
    let ng = cross.normalize_or(hit.ng.normalize_or(Vec3::Z));
    // The plane of a needle is known less well than that of a fat triangle: by the ratio of edges to area.
    let reach = e1.length().max(e2.length());
    let slenderness = e1.length() * e2.length() / cross.length().max(f32::MIN_POSITIVE);
    let traversal = TRIANGLE_ROUNDINGS * UNIT_ROUNDOFF * reach * (1.0 + slenderness.min(1e3));
    let p_error = (a.abs() * w.abs() + b.abs() * u + c.abs() * v) * gamma(7) + Vec3::splat(traversal);
    let smooth = mesh.corner_normals(hit.prim).map(|[na, nb, nc]| na * w + nb * u + nc * v);
    let ns = smooth.map_or(ng, |n| n.normalize_or(ng));
    // Vertex normals are more often right than the winding.
    let ng = if ns.dot(ng) < 0.0 { -ng } else { ng };
    let uv = mesh.corner_uvs(hit.prim).map_or(Vec2::new(u, v), |[ta, tb, tc]| ta * w + tb * u + tc * v);
    Local { p, p_error, ng, ns, uv, group: mesh.group(hit.prim) }
}

fn on_sphere(sphere: &Sphere, p_ray: Vec3) -> Local {
    let (p, n) = sphere.project(p_ray);
    let p_error = (sphere.center.abs() + sphere.radius) * (ROUND_ROUNDINGS * UNIT_ROUNDOFF);
    let longitude = n.y.atan2(n.x) / std::f32::consts::TAU;
    let latitude = n.z.clamp(-1.0, 1.0).acos() / std::f32::consts::PI;
    let uv = Vec2::new(longitude.rem_euclid(1.0), latitude);
    Local { p, p_error, ng: n, ns: n, uv, group: 0 }
}

fn on_disc(disc: &Disc, p_ray: Vec3) -> Local {
    let p = disc.project(p_ray);
    let p_error = (disc.center.abs() + disc.radius) * (ROUND_ROUNDINGS * UNIT_ROUNDOFF);
    let (x, y) = disc.normal.any_orthonormal_pair();
    let out = (p - disc.center) / disc.radius;
    let angle = out.dot(y).atan2(out.dot(x)) / std::f32::consts::TAU;
    let uv = Vec2::new(angle.rem_euclid(1.0), out.length());
    Local { p, p_error, ng: disc.normal, ns: disc.normal, uv, group: 0 }
}
