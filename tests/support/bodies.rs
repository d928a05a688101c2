//! Round bodies beside what is known about them without asking for hits: distance functions, volumes, areas.

use glam::{DVec2, DVec3, Vec3};
use specula::geometry::{Frustum, Ray, Surface, Torus};
use std::f64::consts::PI;
use std::sync::Arc;

use crate::random::Random;

/// The measures of a body.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Measures {
    /// Half height, both radii, whether it is closed.
    Frustum(f64, [f64; 2], bool),
    /// Major and minor radius.
    Torus(f64, f64),
}

/// A surface and its oracle.
#[derive(Clone, Debug)]
pub(crate) struct Body {
    pub(crate) surface: Arc<dyn Surface>,
    pub(crate) measures: Measures,
    pub(crate) center: DVec3,
    /// Unit.
    pub(crate) axis: DVec3,
}

impl Body {
    pub(crate) fn frustum(from: Vec3, to: Vec3, radii: [f32; 2], capped: bool) -> Self {
        let surface = Frustum::new(from, to, radii, capped).expect("a body");
        let (a, b) = (from.as_dvec3(), to.as_dvec3());
        let half = (b - a).length() * 0.5;
        Self {
            surface: Arc::new(surface),
            measures: Measures::Frustum(half, radii.map(f64::from), capped),
            center: (a + b) * 0.5,
            axis: (b - a).normalize(),
        }
    }

    pub(crate) fn torus(center: Vec3, axis: Vec3, major: f32, minor: f32) -> Self {
        let surface = Torus::new(center, axis, major, minor).expect("a ring");
        Self {
            surface: Arc::new(surface),
            measures: Measures::Torus(major.into(), minor.into()),
            center: center.as_dvec3(),
            axis: axis.as_dvec3().normalize(),
        }
    }

    /// Distance from the axis, and height along it.
    pub(crate) fn polar(&self, p: DVec3) -> DVec2 {
        let off = p - self.center;
        let height = off.dot(self.axis);
        DVec2::new((off - self.axis * height).length(), height)
    }

    /// Distance from the side of a frustum's cone, or from a ring, negative inside.
    pub(crate) fn side(&self, p: DVec3) -> f64 {
        let q = self.polar(p);
        match self.measures {
            Measures::Frustum(half, [a, b], _) => {
                let n = DVec2::new(2.0 * half, a - b).normalize();
                (q - DVec2::new(a, -half)).dot(n)
            }
            Measures::Torus(major, minor) => (q - DVec2::X * major).length() - minor,
        }
    }

    /// Distance beyond the nearer end of a frustum; none has a ring or an open side.
    pub(crate) fn end(&self, p: DVec3) -> f64 {
        match self.measures {
            Measures::Frustum(half, ..) => self.polar(p).y.abs() - half,
            Measures::Torus(..) => f64::NEG_INFINITY,
        }
    }

    /// A function that changes sign where a ray crosses the surface; about the distance from it.
    pub(crate) fn value(&self, p: DVec3) -> f64 {
        match self.measures {
            Measures::Frustum(.., false) | Measures::Torus(..) => self.side(p),
            Measures::Frustum(.., true) => self.side(p).max(self.end(p)),
        }
    }

    /// Whether a change of sign counts.
    pub(crate) fn is_on(&self, p: DVec3) -> bool {
        !matches!(self.measures, Measures::Frustum(.., false)) || self.end(p) <= 0.0
    }

    /// Distance from the nearest edge or tip.
    pub(crate) fn distance_to_edge(&self, p: DVec3) -> f64 {
        match self.measures {
            Measures::Frustum(half, [a, b], _) => {
                let q = self.polar(p);
                (q - DVec2::new(a, -half)).length().min((q - DVec2::new(b, half)).length())
            }
            Measures::Torus(..) => f64::INFINITY,
        }
    }

    /// A length below which the surface looks flat and alone at the point `p` of it.
    pub(crate) fn bend(&self, p: DVec3) -> f64 {
        match self.measures {
            Measures::Frustum(half, ..) => {
                let q = self.polar(p);
                let mut parts = [self.side(p), half - q.y, half + q.y].map(f64::abs);
                parts.sort_by(f64::total_cmp);
                parts[1].min(q.x)
            }
            Measures::Torus(major, minor) => minor.min(major - minor),
        }
    }

    /// Radius of a ball about the centre that holds the body.
    pub(crate) fn size(&self) -> f64 {
        match self.measures {
            Measures::Frustum(half, [a, b], _) => half.hypot(a.max(b)),
            Measures::Torus(major, minor) => major + minor,
        }
    }

    /// The greatest product of a point with a unit vector, by trying many points.
    pub(crate) fn farthest(&self, way: DVec3) -> f64 {
        const POINTS: u32 = 20_000;
        let (x, y) = self.axis.any_orthonormal_pair();
        let on_circle = |i: u32| {
            let (sin, cos) = (f64::from(i) / f64::from(POINTS) * 2.0 * PI).sin_cos();
            x * cos + y * sin
        };
        let reach = |circle: DVec3| match self.measures {
            Measures::Frustum(half, [a, b], _) => {
                (circle * a - self.axis * half).dot(way).max((circle * b + self.axis * half).dot(way))
            }
            Measures::Torus(major, minor) => (circle * major).dot(way) + minor,
        };
        self.center.dot(way) + (0..POINTS).map(on_circle).map(reach).fold(f64::NEG_INFINITY, f64::max)
    }

    /// Outward unit gradient by differences.
    pub(crate) fn gradient(&self, p: DVec3) -> DVec3 {
        let h = 1e-6 * self.bend(p).min(self.size());
        let slope = |way: DVec3| self.value(p + way * h) - self.value(p - way * h);
        DVec3::new(slope(DVec3::X), slope(DVec3::Y), slope(DVec3::Z)).normalize_or_zero()
    }

    /// Volume, if closed, and area.
    pub(crate) fn volume_and_area(&self) -> (Option<f64>, f64) {
        match self.measures {
            Measures::Frustum(half, [a, b], capped) => {
                let side = PI * (a + b) * (2.0 * half).hypot(a - b);
                let volume = PI * 2.0 * half / 3.0 * (a * a + a * b + b * b);
                if capped { (Some(volume), side + PI * (a * a + b * b)) } else { (None, side) }
            }
            Measures::Torus(major, minor) => {
                (Some(2.0 * PI * PI * major * minor * minor), 4.0 * PI * PI * major * minor)
            }
        }
    }

    /// All parameters at which the surface says that the ray crosses it.
    pub(crate) fn hits(&self, ray: &Ray) -> Vec<f32> {
        let mut rest = *ray;
        let mut all = vec![];
        while let Some(hit) = self.surface.intersect(0, &rest) {
            all.push(hit.t);
            rest.t_min = hit.t.next_up();
        }
        all
    }
}

/// Cylinders, cones, stumps, open and closed, and rings, thin and thick, of all sizes and attitudes.
pub(crate) fn body(rng: &mut Random, kind: usize) -> Body {
    let size = rng.logarithmic(1e-6, 1e6);
    let center = (Vec3::from(rng.triple()) - 0.5) * size * rng.logarithmic(1e-2, 1e2);
    let axis = match rng.triple()[0] {
        x if x < 0.2 => Vec3::Y,
        x if x < 0.3 => -Vec3::X,
        _ => Vec3::from(rng.direction()),
    };
    let [a, b] = [rng.logarithmic(1e-2, 1.0), rng.logarithmic(1e-2, 1.0)].map(|r| r * size);
    let height = axis * size * rng.logarithmic(1e-2, 1.0);
    match kind {
        0 => Body::frustum(center - height, center + height, [a, a], true),
        1 => Body::frustum(center - height, center + height, [a, 0.0], true),
        2 => Body::frustum(center - height, center + height, [a, b], true),
        3 => Body::frustum(center - height, center + height, [a, b], false),
        _ => Body::torus(center, axis, size, size * rng.logarithmic(1e-2, 0.99)),
    }
}

/// Names of the kinds of [`body`].
pub(crate) const KINDS: [&str; 5] = ["cylinder", "cone", "stump", "open stump", "torus"];
