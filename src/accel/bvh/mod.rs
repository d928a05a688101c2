//! Hierarchies of obvhs: `bvh2`, binary, and `cwbvh`, eight wide with boxes quantised to eight bits a side (Ylitie, Karras,
//! Laine 2017, Efficient Incoherent Ray Traversal on GPUs Through Compressed Wide BVHs).
//!
//! A second opinion beside Embree, in plain Rust. The same scenes, the same answers: meshes that stand still or move between
//! keys, spheres, discs, surfaces that find their own hits, instances that stand or move, masks and filters; any hit stops at
//! the first that counts. All still meshes that are placed once in world coordinates share one hierarchy, so that a plain
//! scene pays for no outer one; every other shape of several primitives has one of its own, however often it is placed, and
//! an outer one holds the placements. What moves is boxed over the whole shutter: fast things cost time, not hits.
//!
//! **No hit is lost** that the test of its primitive finds. obvhs as it comes loses some: of 1.49 million hits of rays aimed at
//! edges, along faces, with a zero in their direction and from afar, at worlds of all sizes, its `bvh2` lost 44 032 and its
//! `cwbvh` 154 958 (three in five of those along faces: a direction of -0 swaps near and far; a third of all in a world of
//! 10^-6: its smallest parameter is 10^-4). In frames of our own 14 622 and 25 790 are left, by rounding alone, and none
//! where boxes are padded (`frame`); `tests/bvh_lost.rs` counts them. Rays at the edges of a closed mesh: none of a
//! million gets out.
//!
//! Limits: packets and streams are traced ray by ray; a build can be stopped between shapes only.
//!
//! ```
//! use glam::Vec3;
//! use specula::accel::bvh::Options;
//! use specula::accel::{Accel, Bvh2Accel};
//! use specula::geometry::{Ray, Shape, Sphere, World};
//! use std::sync::Arc;
//!
//! let mut world = World::default();
//! let ball = world.add_shape(Shape::Sphere(Sphere { center: Vec3::Z * 5.0, radius: 1.0 }));
//! world.place(ball, None);
//! let accel = Bvh2Accel::build(&Arc::new(world), &Options::default());
//! let hit = accel.intersect(&Ray::new(Vec3::ZERO, Vec3::Z)).expect("straight ahead");
//! assert!((hit.t - 4.0).abs() < 1e-5);
//! ```

mod build;
mod frame;
mod hierarchy;
mod isa;
mod options;
mod things;
mod tree;
mod triangle;
mod triangles;

pub use frame::Way;
pub use hierarchy::{Binary, Boxes, Hierarchy, Wide};
pub use options::{Options, Preset};

use crate::accel::Accel;
use crate::geometry::{Hit, PlacementId, Ray, ShapeHit, ShapeId, World};
use crate::math::Aabb;
use crate::math::lanes::Level;
use std::sync::Arc;
use things::Things;
use triangles::Triangles;

/// The backend `bvh2`.
pub type Bvh2Accel = BvhAccel<Binary>;

/// The backend `cwbvh`.
pub type CwBvhAccel = BvhAccel<Wide>;

/// A world with hierarchies of one kind.
#[derive(Debug)]
pub struct BvhAccel<H> {
    world: Arc<World>,
    /// The still meshes that are placed once, in world coordinates.
    merged: Option<Triangles<H>>,
    /// What rays meet in each shape that is not among these.
    bodies: Vec<Body<H>>,
    items: Vec<Item>,
    /// Over the items.
    outer: Things<H>,
    bounds: Aabb,
    level: Level,
}

/// The version of obvhs; a test compares it with `Cargo.lock`.
pub const VERSION: &str = "0.4.0";

/// What a shape is made of.
#[derive(Debug)]
enum Body<H> {
    /// Primitives so few that each is tested.
    Few,
    Triangles(Triangles<H>),
    Primitives(Things<H>),
}

/// What the outer hierarchy holds.
#[derive(Clone, Copy, Debug)]
enum Item {
    Merged,
    Placed(PlacementId),
}

/// A search under way.
struct Search<'a, H> {
    accel: &'a BvhAccel<H>,
    /// What is left of the ray.
    rest: Ray,
    nearest: Option<Hit>,
}

/// How far off a ray is brought near before it is traced, in diagonals of what there is.
const FAR: f64 = 2.0;

impl<H: Hierarchy> BvhAccel<H> {
    /// The name of the instruction set that searches are compiled for.
    #[must_use]
    pub fn isa(&self) -> &'static str {
        self.level.name()
    }

    /// The nearest hit, or any.
    #[inline(always)]
    fn search<const ANY: bool>(&self, ray: &Ray) -> Option<Hit> {
        if !ray.is_traceable() || ray.mask == 0 {
            return None;
        }
        let mut search = Search { accel: self, rest: *ray, nearest: None };
        for &item in &self.outer.loose {
            if search.visit::<ANY>(item).is_some() && ANY {
                return search.nearest;
            }
        }
        if let Some(tree) = &self.outer.tree
            && let Some(way) = tree.enter(&search.rest)
        {
            let size = f64::from(self.bounds.size().length());
            let longest = f64::from(ray.d.abs().max_element());
            if way.start() * longest > FAR * size {
                return self.search_from_near::<ANY>(ray, search.nearest, way.start());
            }
            tree.search::<ANY>(
                &way,
                #[inline(always)]
                |place| search.visit::<ANY>(self.outer.order[place]),
            );
        }
        search.nearest
    }

    /// The same with the origin brought to where the ray enters: single precision would carry a far one into instances with
    /// the error of its distance.
    #[cold]
    fn search_from_near<const ANY: bool>(&self, ray: &Ray, nearest: Option<Hit>, start: f64) -> Option<Hit> {
        #[expect(clippy::cast_possible_truncation, reason = "ray parameters are in single precision")]
        let shifted = |t: f32, by: f64| (f64::from(t) + by) as f32;
        let o = (ray.o.as_dvec3() + ray.d.as_dvec3() * start).as_vec3();
        let mut near = *ray;
        near.o = o;
        near.t_min = shifted(ray.t_min, -start).max(0.0);
        near.t_max = shifted(nearest.as_ref().map_or(ray.t_max, |hit| hit.t), -start);
        let (Some(tree), true) = (&self.outer.tree, near.is_traceable()) else { return nearest };
        let mut search = Search { accel: self, rest: near, nearest: None };
        let Some(way) = tree.enter(&near) else { return nearest };
        tree.search::<ANY>(&way, |place| search.visit::<ANY>(self.outer.order[place]));
        let restored = |hit: Hit| Hit { t: shifted(hit.t, start).clamp(ray.t_min, ray.t_max), ..hit };
        let found = search.nearest.map(restored);
        found.or(nearest)
    }
}

impl<H: Hierarchy> Search<'_, H> {
    /// Looks for hits in an item; the ray's parameter at one.
    #[inline(always)]
    fn visit<const ANY: bool>(&mut self, item: u32) -> Option<f32> {
        let world = &*self.accel.world;
        let hit = match self.accel.items[item as usize] {
            Item::Merged => self.accel.merged.as_ref()?.search::<ANY>(world, &self.rest, PlacementId(0)),
            Item::Placed(id) => {
                let placement = &world.placements[id.index()];
                if placement.mask & self.rest.mask == 0 {
                    return None;
                }
                let local = placement.pose.object_ray(&self.rest);
                match &self.accel.bodies[placement.shape.index()] {
                    Body::Triangles(triangles) => triangles.search::<ANY>(world, &local, id),
                    Body::Primitives(things) => primitives::<H, ANY>(world, things, &local, id),
                    Body::Few => few(world, &local, id),
                }
            }
        }?;
        self.rest.t_max = hit.t;
        self.nearest = Some(hit);
        Some(hit.t)
    }
}

/// The nearest hit among few primitives.
fn few(world: &World, ray: &Ray, id: PlacementId) -> Option<Hit> {
    let mut rest = *ray;
    let mut nearest = None;
    for prim in (0..).take(world.shape_of(id).primitive_count()) {
        if let Some(hit) = one(world, &rest, id, prim) {
            rest.t_max = hit.t;
            nearest = Some(hit);
        }
    }
    nearest
}

/// The nearest hit among primitives that find their own hits, or any.
fn primitives<H: Hierarchy, const ANY: bool>(
    world: &World,
    things: &Things<H>,
    ray: &Ray,
    id: PlacementId,
) -> Option<Hit> {
    let mut rest = *ray;
    let mut nearest = None;
    let mut visit = |prim: u32, rest: &mut Ray| {
        let hit = one(world, rest, id, prim)?;
        rest.t_max = hit.t;
        nearest = Some(hit);
        Some(hit.t)
    };
    for &prim in &things.loose {
        if visit(prim, &mut rest).is_some() && ANY {
            return nearest;
        }
    }
    if let Some(tree) = &things.tree
        && let Some(way) = tree.enter(&rest)
    {
        tree.search::<ANY>(&way, |place| visit(things.order[place], &mut rest));
    }
    nearest
}

fn one(world: &World, ray: &Ray, id: PlacementId, prim: u32) -> Option<Hit> {
    let shape: ShapeId = world.placements[id.index()].shape;
    let filter = world.filters.get(&shape).map(AsRef::as_ref);
    let ShapeHit { t, u, v, ng } = world.shapes[shape.index()].intersect_filtered(prim, ray, filter)?;
    Some(Hit { t, u, v, ng, prim, placement: id })
}

impl<H: Hierarchy> Accel for BvhAccel<H> {
    fn intersect(&self, ray: &Ray) -> Option<Hit> {
        isa::run(
            self.level,
            #[inline(always)]
            || self.search::<false>(ray),
        )
    }

    fn occluded(&self, ray: &Ray) -> bool {
        isa::run(
            self.level,
            #[inline(always)]
            || self.search::<true>(ray).is_some(),
        )
    }

    fn bounds(&self) -> Aabb {
        self.bounds
    }

    fn bytes(&self) -> usize {
        let bodies = self.bodies.iter().map(|body| match body {
            Body::Few => 0,
            Body::Triangles(triangles) => triangles.bytes(),
            Body::Primitives(things) => things.bytes(),
        });
        self.merged.as_ref().map_or(0, Triangles::bytes)
            + bodies.sum::<usize>()
            + self.outer.bytes()
            + size_of_val(self.items.as_slice())
    }
}
