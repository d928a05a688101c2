//! Meshes: a hierarchy over triangles whose corners lie in its order.

use super::Options;
use super::hierarchy::Hierarchy;
use super::tree::Tree;
use super::triangle::{Corners, Met, Shear};
use crate::geometry::{Hit, Mesh, PlacementId, Ray, ShapeHit, World};
use crate::math::motion;

/// Triangles of one mesh, or of all meshes of the world that are placed once and stand still.
#[derive(Debug)]
pub(super) struct Triangles<H> {
    tree: Tree<H>,
    /// As many as there are keys for each place.
    corners: Vec<Corners>,
    keys: usize,
    /// Which triangle of its mesh is at each place.
    prims: Vec<u32>,
    owners: Owners,
    /// Whether hits may be of no account.
    is_guarded: bool,
}

/// Whose triangles these are.
#[derive(Debug)]
enum Owners {
    /// Whoever places the mesh.
    Any,
    /// Of the placement at each place.
    These(Vec<PlacementId>),
}

/// Where a ray met a triangle.
#[derive(Clone, Copy)]
struct Found {
    place: usize,
    t: f32,
    met: Met,
}

impl<H: Hierarchy> Triangles<H> {
    /// The triangles of a mesh; `None` if there are fewer than two.
    pub(super) fn of_mesh(mesh: &Mesh, is_filtered: bool, options: &Options) -> Option<Self> {
        let count = mesh.triangles().len();
        let boxes: Vec<_> = (0..).take(count).map(|prim| mesh.triangle_bounds(prim)).collect();
        let keys = mesh.key_count();
        let still = |prim| mesh.corners(prim);
        let (tree, prims) = Tree::build(&boxes, (keys == 1).then_some(&still), options)?;
        let corners = prims.iter().flat_map(|&prim| (0..keys).map(move |key| (prim, key)));
        let at = |(prim, key): (u32, usize)| {
            let positions = mesh.key_positions(key);
            mesh.triangles()[prim as usize].map(|i| positions[i as usize])
        };
        let corners = corners.map(|key| Corners::new(at(key).map(|p| tree.frame().point(p)))).collect();
        Some(Self { tree, corners, keys, prims, owners: Owners::Any, is_guarded: is_filtered })
    }

    /// The triangles of several still meshes in world coordinates.
    pub(super) fn of_placements(
        world: &World,
        placed: &[(PlacementId, &Mesh)],
        options: &Options,
    ) -> Option<Self> {
        let all: Vec<(PlacementId, &Mesh, u32)> = placed
            .iter()
            .flat_map(|&(id, mesh)| (0..).take(mesh.triangles().len()).map(move |prim| (id, mesh, prim)))
            .collect();
        let boxes: Vec<_> = all.iter().map(|(_, mesh, prim)| mesh.triangle_bounds(*prim)).collect();
        let corners = |i: u32| {
            let (_, mesh, prim) = all[i as usize];
            mesh.corners(prim)
        };
        let (tree, order) = Tree::build(&boxes, Some(&corners), options)?;
        let at = |&i: &u32| Corners::new(corners(i).map(|p| tree.frame().point(p)));
        let is_guarded = placed.iter().any(|(id, _)| {
            let placement = &world.placements[id.index()];
            placement.mask != u32::MAX || world.filters.contains_key(&placement.shape)
        });
        Some(Self {
            corners: order.iter().map(at).collect(),
            keys: 1,
            prims: order.iter().map(|&i| all[i as usize].2).collect(),
            owners: Owners::These(order.iter().map(|&i| all[i as usize].0).collect()),
            is_guarded,
            tree,
        })
    }

    /// The nearest hit of a traceable ray, or any, as `placement`'s where the triangles have no owners.
    #[inline(always)]
    pub(super) fn search<const ANY: bool>(
        &self,
        world: &World,
        ray: &Ray,
        placement: PlacementId,
    ) -> Option<Hit> {
        let way = self.tree.enter(ray)?;
        let shear = Shear::new(&way);
        let (key, part) = motion::step(if self.keys > 1 { ray.time } else { 0.0 }, self.keys);
        let mut nearest: Option<Found> = None;
        let mut t_max = ray.t_max;
        self.tree.search::<ANY>(
            &way,
            #[inline(always)]
            |place| {
                let met = self.at(place, key, part, &shear)?;
                let t = way.t(met.t);
                if !(t >= ray.t_min && t <= t_max) {
                    return None;
                }
                let found = Found { place, t, met };
                if self.is_guarded && !self.counts(world, ray, placement, &found) {
                    return None;
                }
                t_max = t;
                nearest = Some(found);
                Some(t)
            },
        );
        let found = nearest?;
        let ShapeHit { t, u, v, ng } = self.shape_hit(&found, key, part);
        Some(Hit {
            t,
            u,
            v,
            ng,
            prim: self.prims[found.place],
            placement: self.owner(found.place, placement),
        })
    }

    #[inline(always)]
    fn at(&self, place: usize, key: usize, part: f32, shear: &Shear) -> Option<Met> {
        if self.keys == 1 {
            self.corners[place].meet(shear)
        } else {
            self.moved(place, key, part).meet(shear)
        }
    }

    fn moved(&self, place: usize, key: usize, part: f32) -> Corners {
        let first = place * self.keys + key;
        self.corners[first].towards(&self.corners[first + 1], part)
    }

    fn owner(&self, place: usize, placement: PlacementId) -> PlacementId {
        match &self.owners {
            Owners::Any => placement,
            Owners::These(owners) => owners[place],
        }
    }

    fn shape_hit(&self, found: &Found, key: usize, part: f32) -> ShapeHit {
        let place = found.place;
        let corners = if self.keys == 1 { self.corners[place] } else { self.moved(place, key, part) };
        let ng = corners.normal() * self.tree.frame().normal_scale();
        ShapeHit { t: found.t, u: found.met.u, v: found.met.v, ng }
    }

    /// Whether the ray sees what it met, and the filter accepts it.
    #[cold]
    fn counts(&self, world: &World, ray: &Ray, placement: PlacementId, found: &Found) -> bool {
        let placement = &world.placements[self.owner(found.place, placement).index()];
        if placement.mask & ray.mask == 0 {
            return false;
        }
        let (key, part) = motion::step(ray.time, self.keys);
        let filter = world.filters.get(&placement.shape);
        filter.is_none_or(|filter| {
            filter.accepts(ray, &self.shape_hit(found, key, part), self.prims[found.place])
        })
    }

    pub(super) fn bytes(&self) -> usize {
        let owners = match &self.owners {
            Owners::Any => 0,
            Owners::These(owners) => size_of_val(owners.as_slice()),
        };
        self.tree.bytes() + size_of_val(self.corners.as_slice()) + size_of_val(self.prims.as_slice()) + owners
    }
}
