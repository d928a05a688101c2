//! Packets of rays, in the memory layout that Embree reads: one array per component, aligned to a cache line.

use crate::geometry::{Hit, PlacementId, Ray};
use glam::Vec3;

/// What an identifier holds where there is none.
pub(crate) const NONE: u32 = u32::MAX;

/// Which lanes of a packet take part.
#[repr(C, align(64))]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Active<const N: usize>([i32; N]);

impl<const N: usize> Active<N> {
    /// All lanes.
    pub const ALL: Self = Self([-1; N]);

    /// The lanes whose bit is set, lane 0 the lowest.
    #[must_use]
    pub fn from_bits(bits: u32) -> Self {
        let mut lanes = [0; N];
        for (lane, flag) in lanes.iter_mut().enumerate() {
            *flag = -i32::from(bits >> lane & 1 == 1);
        }
        Self(lanes)
    }

    /// The first `count` lanes.
    #[must_use]
    pub fn first(count: usize) -> Self {
        let mut lanes = [0; N];
        lanes.iter_mut().take(count).for_each(|flag| *flag = -1);
        Self(lanes)
    }

    /// Whether a lane takes part.
    #[must_use]
    pub fn contains(&self, lane: usize) -> bool {
        self.0[lane] != 0
    }

    /// The lanes that take part, in order.
    pub fn lanes(&self) -> impl Iterator<Item = usize> + '_ {
        (0..N).filter(|&lane| self.contains(lane))
    }

    /// The flags as a backend reads them: -1 active, 0 not.
    #[must_use]
    pub fn as_array(&self) -> &[i32; N] {
        &self.0
    }
}

/// `N` rays; see [`Ray`] for the fields.
#[repr(C, align(64))]
#[derive(Clone, Copy, Debug, PartialEq)]
#[expect(missing_docs, reason = "the fields are those of `Ray`, one array per component")]
pub struct RayPacket<const N: usize> {
    pub o_x: [f32; N],
    pub o_y: [f32; N],
    pub o_z: [f32; N],
    pub t_min: [f32; N],
    pub d_x: [f32; N],
    pub d_y: [f32; N],
    pub d_z: [f32; N],
    pub time: [f32; N],
    pub t_max: [f32; N],
    pub mask: [u32; N],
    id: [u32; N],
    flags: [u32; N],
}

/// `N` hits; see [`Hit`] for the fields. Identifiers are all ones where there is none; a placement is named by
/// `instance` where that is set, else by `geometry`: [`HitPacket::placement`].
#[repr(C, align(64))]
#[derive(Clone, Copy, Debug, PartialEq)]
#[expect(missing_docs, reason = "the fields are those of `Hit`, one array per component")]
pub struct HitPacket<const N: usize> {
    pub ng_x: [f32; N],
    pub ng_y: [f32; N],
    pub ng_z: [f32; N],
    pub u: [f32; N],
    pub v: [f32; N],
    pub prim: [u32; N],
    pub geometry: [u32; N],
    pub instance: [u32; N],
    instance_prim: [u32; N],
}

/// `N` rays and room for their hits.
#[repr(C, align(64))]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Packet<const N: usize> {
    /// The rays; `t_max` is the hit's parameter after a query.
    pub ray: RayPacket<N>,
    /// The hits.
    pub hit: HitPacket<N>,
}

impl<const N: usize> RayPacket<N> {
    /// Rays that hit nothing: for filling in.
    pub const EMPTY: Self = Self {
        o_x: [0.0; N],
        o_y: [0.0; N],
        o_z: [0.0; N],
        t_min: [0.0; N],
        d_x: [0.0; N],
        d_y: [0.0; N],
        d_z: [1.0; N],
        time: [0.0; N],
        t_max: [-1.0; N],
        mask: [u32::MAX; N],
        id: [0; N],
        flags: [0; N],
    };

    /// Writes a ray to a lane.
    pub fn set(&mut self, lane: usize, ray: &Ray) {
        [self.o_x[lane], self.o_y[lane], self.o_z[lane]] = ray.o.to_array();
        [self.d_x[lane], self.d_y[lane], self.d_z[lane]] = ray.d.to_array();
        self.t_min[lane] = ray.t_min;
        self.t_max[lane] = ray.t_max;
        self.time[lane] = ray.time;
        self.mask[lane] = ray.mask;
    }

    /// The ray of a lane.
    #[must_use]
    pub fn get(&self, lane: usize) -> Ray {
        let o = Vec3::new(self.o_x[lane], self.o_y[lane], self.o_z[lane]);
        let d = Vec3::new(self.d_x[lane], self.d_y[lane], self.d_z[lane]);
        let ray = Ray::new(o, d).starting(self.t_min[lane]).until(self.t_max[lane]);
        ray.at_time(self.time[lane]).seeing(self.mask[lane])
    }
}

impl<const N: usize> HitPacket<N> {
    /// No hit in any lane.
    pub const NONE: Self = Self {
        ng_x: [0.0; N],
        ng_y: [0.0; N],
        ng_z: [0.0; N],
        u: [0.0; N],
        v: [0.0; N],
        prim: [NONE; N],
        geometry: [NONE; N],
        instance: [NONE; N],
        instance_prim: [NONE; N],
    };

    /// What was hit in a lane.
    #[must_use]
    pub fn placement(&self, lane: usize) -> Option<PlacementId> {
        placement(self.geometry[lane], self.instance[lane])
    }
}

/// The placement that a pair of identifiers names: an instance, else a geometry of the outer scene.
pub(crate) fn placement(geometry: u32, instance: u32) -> Option<PlacementId> {
    if geometry == NONE {
        return None;
    }
    Some(PlacementId(if instance == NONE { geometry } else { instance }))
}

impl<const N: usize> Packet<N> {
    /// Rays that hit nothing, and no hits.
    pub const EMPTY: Self = Self { ray: RayPacket::EMPTY, hit: HitPacket::NONE };

    /// The hit of a lane.
    #[must_use]
    pub fn get_hit(&self, lane: usize) -> Option<Hit> {
        let hit = &self.hit;
        Some(Hit {
            t: self.ray.t_max[lane],
            u: hit.u[lane],
            v: hit.v[lane],
            ng: Vec3::new(hit.ng_x[lane], hit.ng_y[lane], hit.ng_z[lane]),
            prim: hit.prim[lane],
            placement: hit.placement(lane)?,
        })
    }

    /// Writes the hit of a lane.
    pub fn set_hit(&mut self, lane: usize, hit: Option<&Hit>) {
        let Some(hit) = hit else {
            self.hit.geometry[lane] = NONE;
            self.hit.instance[lane] = NONE;
            return;
        };
        self.ray.t_max[lane] = hit.t;
        [self.hit.ng_x[lane], self.hit.ng_y[lane], self.hit.ng_z[lane]] = hit.ng.to_array();
        self.hit.u[lane] = hit.u;
        self.hit.v[lane] = hit.v;
        self.hit.prim[lane] = hit.prim;
        self.hit.geometry[lane] = hit.placement.0;
        self.hit.instance[lane] = NONE;
    }
}

/// The nearest hit of each active lane, by a query for one ray.
#[inline]
pub(super) fn intersect_one_by_one<const N: usize>(
    active: &Active<N>,
    packet: &mut Packet<N>,
    intersect: impl Fn(&Ray) -> Option<Hit>,
) {
    for lane in active.lanes() {
        let hit = intersect(&packet.ray.get(lane));
        packet.set_hit(lane, hit.as_ref());
    }
}

/// Whether anything lies within the range of each active lane, by a query for one ray.
#[inline]
pub(super) fn occluded_one_by_one<const N: usize>(
    active: &Active<N>,
    rays: &mut RayPacket<N>,
    occluded: impl Fn(&Ray) -> bool,
) {
    for lane in active.lanes() {
        if occluded(&rays.get(lane)) {
            rays.t_max[lane] = f32::NEG_INFINITY;
        }
    }
}
