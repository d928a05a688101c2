//! What is left to do when a query has returned: nothing in most scenes, which pay one test of a pointer for it.
//!
//! Scenes with user code go on with its panics; scenes with quads name triangles instead.

use super::faces::Faces;
use super::geometry::Geometry;
use super::guard;
use super::scene::{Committed, Scene};
use crate::accel::{Active, HitPacket};
use embree4_sys as sys;
use std::collections::BTreeMap;
use std::sync::Arc;

/// What a committed scene does after each query.
#[derive(Debug)]
pub(super) struct After {
    /// Whether anything in it calls back.
    calls: bool,
    /// By geometry number; empty if there are no quads.
    quads: Vec<Named>,
}

/// What a geometry number means for the names of hits.
#[derive(Clone, Debug)]
enum Named {
    /// Hits are named as they should be.
    Right,
    /// Hits name faces.
    Faces(Faces),
    /// Hits are named within another scene that has quads.
    Within(Arc<Scene<Committed>>),
}

impl After {
    /// What a scene of these geometries needs; `None` if nothing.
    pub(super) fn of(geometries: &BTreeMap<u32, Geometry>) -> Option<Box<Self>> {
        let calls = geometries.values().any(Geometry::calls_back);
        let mut quads = Vec::new();
        for (&number, geometry) in geometries {
            let named = match (geometry.faces(), geometry.instanced()) {
                (Some(faces), _) => Named::Faces(faces.clone()),
                (None, Some(scene)) if scene.after().is_some_and(Self::has_quads) => {
                    Named::Within(scene.clone())
                }
                _ => continue,
            };
            quads.resize(number as usize + 1, Named::Right);
            quads[number as usize] = named;
        }
        (calls || !quads.is_empty()).then(|| Box::new(Self { calls, quads }))
    }

    /// Whether anything in the scene calls back.
    pub(super) fn calls_back(&self) -> bool {
        self.calls
    }

    fn has_quads(&self) -> bool {
        !self.quads.is_empty()
    }

    /// After a query for any hit.
    #[cold]
    pub(super) fn occluded(&self) {
        if self.calls {
            guard::resume();
        }
    }

    /// After a query for one ray.
    #[cold]
    pub(super) fn single(&self, hit: &mut sys::RTCHit) {
        self.occluded();
        if let Some(faces) = self.faces(hit.geomID, hit.instID[0]) {
            (hit.primID, [hit.u, hit.v]) = faces.triangle(hit.primID, [hit.u, hit.v]);
        }
    }

    /// After a query for a packet.
    #[cold]
    pub(super) fn packet<const N: usize>(&self, active: &Active<N>, hit: &mut HitPacket<N>) {
        self.occluded();
        if !self.has_quads() {
            return;
        }
        for lane in active.lanes() {
            if let Some(faces) = self.faces(hit.geometry[lane], hit.instance[lane]) {
                (hit.prim[lane], [hit.u[lane], hit.v[lane]]) =
                    faces.triangle(hit.prim[lane], [hit.u[lane], hit.v[lane]]);
            }
        }
    }

    /// The faces that a hit names, if it names one.
    fn faces(&self, geometry: u32, instance: u32) -> Option<&Faces> {
        let outer = if instance == sys::RTC_INVALID_GEOMETRY_ID { geometry } else { instance };
        match self.quads.get(outer as usize)? {
            Named::Right => None,
            Named::Faces(faces) => Some(faces),
            Named::Within(scene) => scene.after()?.faces(geometry, sys::RTC_INVALID_GEOMETRY_ID),
        }
    }
}
