//! Streams: any number of rays, one array per component.

use crate::accel::packet::NONE;
use crate::geometry::{Hit, PlacementId, Ray};
use glam::Vec3;

/// Rays, one array per component; see [`Ray`] for the fields. All arrays have the same length.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct RayStream {
    pub(crate) o: [Vec<f32>; 3],
    pub(crate) d: [Vec<f32>; 3],
    pub(crate) t_min: Vec<f32>,
    pub(crate) t_max: Vec<f32>,
    pub(crate) time: Vec<f32>,
    pub(crate) mask: Vec<u32>,
}

impl RayStream {
    /// How many rays there are.
    #[must_use]
    pub fn len(&self) -> usize {
        self.t_max.len()
    }

    /// Whether there are none.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.t_max.is_empty()
    }

    /// Drops all rays and keeps the memory.
    pub fn clear(&mut self) {
        self.o.iter_mut().chain(&mut self.d).for_each(Vec::clear);
        self.t_min.clear();
        self.t_max.clear();
        self.time.clear();
        self.mask.clear();
    }

    /// Appends a ray.
    pub fn push(&mut self, ray: &Ray) {
        for axis in 0..3 {
            self.o[axis].push(ray.o[axis]);
            self.d[axis].push(ray.d[axis]);
        }
        self.t_min.push(ray.t_min);
        self.t_max.push(ray.t_max);
        self.time.push(ray.time);
        self.mask.push(ray.mask);
    }

    /// The ray at `i`.
    #[must_use]
    pub fn get(&self, i: usize) -> Ray {
        let component = |v: &[Vec<f32>; 3]| Vec3::new(v[0][i], v[1][i], v[2][i]);
        let ray = Ray::new(component(&self.o), component(&self.d));
        ray.starting(self.t_min[i]).until(self.t_max[i]).at_time(self.time[i]).seeing(self.mask[i])
    }
}

impl<'a> Extend<&'a Ray> for RayStream {
    fn extend<T: IntoIterator<Item = &'a Ray>>(&mut self, rays: T) {
        rays.into_iter().for_each(|ray| self.push(ray));
    }
}

/// Hits, one array per component; see [`Hit`] for the fields. All arrays have the same length.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct HitStream {
    pub(crate) t: Vec<f32>,
    pub(crate) u: Vec<f32>,
    pub(crate) v: Vec<f32>,
    pub(crate) ng: [Vec<f32>; 3],
    pub(crate) prim: Vec<u32>,
    pub(crate) placement: Vec<u32>,
}

impl HitStream {
    /// How many answers there are, hits and misses.
    #[must_use]
    pub fn len(&self) -> usize {
        self.t.len()
    }

    /// Whether there are none.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.t.is_empty()
    }

    /// Makes room for `len` answers; new ones are misses.
    pub fn resize(&mut self, len: usize) {
        for values in [&mut self.t, &mut self.u, &mut self.v].into_iter().chain(&mut self.ng) {
            values.resize(len, 0.0);
        }
        self.prim.resize(len, NONE);
        self.placement.resize(len, NONE);
    }

    /// Whether the answer at `i` is a hit.
    #[must_use]
    pub fn is_hit(&self, i: usize) -> bool {
        self.placement[i] != NONE
    }

    /// The answer at `i`.
    #[must_use]
    pub fn get(&self, i: usize) -> Option<Hit> {
        if !self.is_hit(i) {
            return None;
        }
        Some(Hit {
            t: self.t[i],
            u: self.u[i],
            v: self.v[i],
            ng: Vec3::new(self.ng[0][i], self.ng[1][i], self.ng[2][i]),
            prim: self.prim[i],
            placement: PlacementId(self.placement[i]),
        })
    }

    /// Writes the answer at `i`.
    pub fn set(&mut self, i: usize, hit: Option<&Hit>) {
        let Some(hit) = hit else {
            self.placement[i] = NONE;
            return;
        };
        self.t[i] = hit.t;
        self.u[i] = hit.u;
        self.v[i] = hit.v;
        for axis in 0..3 {
            self.ng[axis][i] = hit.ng[axis];
        }
        self.prim[i] = hit.prim;
        self.placement[i] = hit.placement.0;
    }
}
