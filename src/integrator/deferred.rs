//! Rays towards lights that are traced together, when many are waiting.

use crate::accel::{Accel, Coherence, RayStream};
use crate::geometry::Ray;
use crate::integrator::Radiance;
use crate::math::Rgb;

/// Rays towards lights, and what each brings to its camera sample if nothing is in the way.
#[derive(Debug, Default)]
pub struct Deferred {
    rays: RayStream,
    light: Vec<Rgb<f32>>,
    slots: Vec<Slot>,
    blocked: Vec<bool>,
    /// What rays are added for.
    slot: Slot,
}

/// Where light arrives.
#[derive(Clone, Copy, Debug, Default)]
struct Slot {
    /// The camera sample.
    sample: usize,
    /// Edges of the path by which it comes.
    edges: u32,
}

impl Deferred {
    /// Says which camera sample the rays that follow are for.
    pub fn begin(&mut self, sample: usize) {
        self.slot.sample = sample;
    }

    /// Says of how many edges the paths are that end with the rays that follow.
    pub(super) fn edges(&mut self, edges: u32) {
        self.slot.edges = edges;
    }

    /// Adds a ray.
    pub(super) fn push(&mut self, ray: &Ray, light: Rgb<f32>) {
        self.rays.push(ray);
        self.light.push(light);
        self.slots.push(self.slot);
    }

    /// Traces all rays and adds the light of those that are free to their camera samples, in the order in which they came.
    ///
    /// # Panics
    /// Where a ray's camera sample is missing.
    pub fn arrive<A: Accel>(&mut self, accel: &A, samples: &mut [Radiance]) {
        let Self { rays, light, slots, blocked, .. } = self;
        accel.occluded_stream(rays, blocked, Coherence::Incoherent);
        for ((&blocked, &light), &slot) in blocked.iter().zip(&*light).zip(&*slots) {
            if !blocked {
                samples[slot.sample].add(light, slot.edges);
            }
        }
        rays.clear();
        light.clear();
        slots.clear();
    }
}
