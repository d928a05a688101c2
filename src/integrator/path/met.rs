//! What the rays of a chunk have met, over lanes.

use super::surfaces::Surfaces;
use crate::accel::Packet;
use crate::accel::packet::NONE;
use crate::geometry::{Points, Pose, Shape};
use crate::math::Vec3;
use crate::math::lanes::{Bits, Compare, IntLanes, Isa, MaskLanes, Select, WIDEST};
use crate::scene::Scene;
use crate::texture::Spot;

/// Surfaces that were met.
pub(super) struct Met<S: Isa> {
    /// The lanes that met one.
    pub(super) hit: S::M,
    pub(super) points: Points<S::F>,
    /// The material of each lane; unspecified where nothing was met.
    pub(super) materials: S::I,
    pub(super) placements: S::I,
    /// How wide the rays are there, in surface parameters.
    pub(super) footprint: S::F,
}

impl<S: Isa> Met<S> {
    /// What the lanes of `packet` that are set in `active` have met.
    #[inline(always)]
    pub(super) fn of<const N: usize>(
        isa: S,
        (scene, surfaces): (&Scene, &Surfaces),
        packet: &Packet<N>,
        active: S::M,
    ) -> Self {
        let hit = &packet.hit;
        let (u, v) = (isa.load(&hit.u), isa.load(&hit.v));
        let prims = isa.load_u32(&hit.prim);
        let ng = Vec3::new(isa.load(&hit.ng_x), isa.load(&hit.ng_y), isa.load(&hit.ng_z));
        let [geometries, instances] = [isa.load_u32(&hit.geometry), isa.load_u32(&hit.instance)];
        let placements = S::I::select(Compare::<u32>::ne(instances, NONE), instances, geometries);
        let met = Compare::<u32>::ne(placements, NONE) & active;
        let materials = surfaces.materials(isa, scene, (placements, prims), met);
        let zero = Vec3::new(isa.splat(0.0), isa.splat(0.0), isa.splat(0.0));
        let up = Vec3::new(isa.splat(0.0), isa.splat(0.0), isa.splat(1.0));
        let mut points =
            Points { p: zero, p_error: zero, ng: up, ns: up, uv: [u, v], density: isa.splat(0.0) };
        let mut bits = met.bits();
        while bits != 0 {
            let first = placements.extract(bits.trailing_zeros() as usize);
            let same = Compare::<u32>::eq(placements, first) & met;
            let placement = &scene.world.placements[first as usize];
            let shape = &scene.world.shapes[placement.shape.index()];
            let found = match (shape, &placement.pose) {
                (Shape::Mesh(mesh), Pose::World) if mesh.has_points() => {
                    // Numbers of triangles of other meshes may be beyond this one's.
                    let own = S::I::select(same, prims, isa.splat_u32(0));
                    mesh.points(own, [u, v], ng, surfaces.textured)
                }
                (Shape::Sphere(sphere), Pose::World) if !surfaces.textured => {
                    let row = |row: &[f32; N]| isa.load(row);
                    let ray = &packet.ray;
                    let o = Vec3::new(row(&ray.o_x), row(&ray.o_y), row(&ray.o_z));
                    let d = Vec3::new(row(&ray.d_x), row(&ray.d_y), row(&ray.d_z));
                    sphere.points(o + d * row(&ray.t_max))
                }
                _ => one_by_one(isa, scene, packet, same.bits()),
            };
            if same.bits() == met.bits() {
                points = found;
                break;
            }
            points = Points::select(same, found, points);
            bits &= !same.bits();
        }
        Self { hit: met, points, materials, placements, footprint: isa.splat(0.0) }
    }

    /// Where textures are asked.
    #[inline(always)]
    pub(super) fn spot(&self) -> Spot<S::F> {
        Spot { uv: self.points.uv, footprint: self.footprint }
    }
}

/// The points of the lanes in `bits`, each by itself.
#[inline(always)]
fn one_by_one<S: Isa, const N: usize>(isa: S, scene: &Scene, packet: &Packet<N>, bits: u32) -> Points<S::F> {
    let rows = rows_of(scene, packet, Bits(bits));
    let vector = Vec3::new;
    Points {
        p: vector(isa.load(&rows[0]), isa.load(&rows[1]), isa.load(&rows[2])),
        p_error: vector(isa.load(&rows[3]), isa.load(&rows[4]), isa.load(&rows[5])),
        ng: vector(isa.load(&rows[6]), isa.load(&rows[7]), isa.load(&rows[8])),
        ns: vector(isa.load(&rows[9]), isa.load(&rows[10]), isa.load(&rows[11])),
        uv: [isa.load(&rows[12]), isa.load(&rows[13])],
        density: isa.load(&rows[14]),
    }
}

/// Out of line: scalar work, the same for all instruction sets.
#[inline(never)]
fn rows_of<const N: usize>(scene: &Scene, packet: &Packet<N>, lanes: Bits) -> [[f32; WIDEST]; 15] {
    let mut rows = [[0.0; WIDEST]; 15];
    for lane in lanes {
        let Some(hit) = packet.get_hit(lane) else { continue };
        let it = scene.world.interaction(&packet.ray.get(lane), &hit);
        let values = [it.p, it.p_error, it.ng, it.ns].map(|v| v.to_array());
        let grain = if scene.has_images() { scene.world.grain(&it) } else { None };
        let density = grain.map_or(0.0, |grain| grain.density());
        let values = values.into_iter().flatten().chain(it.uv.to_array()).chain([density]);
        rows.iter_mut().zip(values).for_each(|(row, value)| row[lane] = value);
    }
    rows
}
