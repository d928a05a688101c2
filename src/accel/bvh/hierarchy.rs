//! What is asked of a hierarchy, and the two kinds that obvhs builds.

use super::{Preset, Way};
use glam::UVec2;
use obvhs::BvhBuildParams;
use obvhs::aabb::Aabb;
use obvhs::bvh2::Bvh2;
use obvhs::bvh2::leaf_collapser::collapse;
use obvhs::bvh2::node::Bvh2Node;
use obvhs::bvh2::reinsertion::ReinsertionOptimizer;
use obvhs::cwbvh::CwBvh;
use obvhs::cwbvh::bvh2_to_cwbvh::bvh2_to_cwbvh;
use obvhs::cwbvh::node::CwBvhNode;
use obvhs::faststack::{FastStack, HeapStack, StackStack};
use obvhs::ploc::PlocBuilder;
use obvhs::ray::Ray;
use std::fmt::{self, Debug};
use std::ops::ControlFlow;

/// Padded boxes in a frame, and which thing each belongs to.
#[derive(Debug)]
pub struct Boxes {
    /// At least two, none of them empty.
    pub boxes: Vec<Aabb>,
    /// Whose they are, by number.
    pub owners: Vec<u32>,
    /// Whether somebody owns more than one.
    pub split: bool,
}

/// A tree of boxes, each of which is at a place in a row that the tree orders.
pub trait Hierarchy: Debug + Send + Sized + Sync {
    /// The name of the backend that stands on it.
    const NAME: &'static str;

    /// The tree, and the owners of the boxes in its order.
    fn build(boxes: Boxes, preset: Preset) -> (Self, Vec<u32>);

    /// Visits the places whose boxes are on a way, nearer ones first as far as possible; a visit tells where the way ends
    /// from now on, or infinity if that changes nothing.
    fn closest(&self, way: &Way, visit: impl FnMut(usize) -> f32);

    /// Whether a visit to a place whose box is on the way says yes; none follows.
    fn any(&self, way: &Way, visit: impl FnMut(usize) -> bool) -> bool;

    /// Bytes of the nodes.
    fn bytes(&self) -> usize;
}

/// A binary tree with boxes in single precision.
pub struct Binary(Bvh2);

/// A tree of eight children a node, whose boxes are quantised to eight bits a side.
pub struct Wide {
    tree: CwBvh,
    depth: usize,
}

impl Debug for Binary {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Binary")
            .field("nodes", &self.0.nodes.len())
            .field("depth", &self.0.max_depth)
            .finish()
    }
}

impl Debug for Wide {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Wide").field("nodes", &self.tree.nodes.len()).field("depth", &self.depth).finish()
    }
}

impl Hierarchy for Binary {
    const NAME: &'static str = "bvh2";

    fn build(boxes: Boxes, preset: Preset) -> (Self, Vec<u32>) {
        let params = preset.params();
        let mut tree = binary(boxes, &params);
        let mut optimizer = ReinsertionOptimizer::default();
        optimizer.run(&mut tree, params.reinsertion_batch_ratio, None);
        collapse(&mut tree, params.max_prims_per_leaf, params.collapse_traversal_cost);
        let again = params.reinsertion_batch_ratio * params.post_collapse_reinsertion_batch_ratio_multiplier;
        optimizer.run(&mut tree, again, None);
        // What obvhs notes is the depth before nodes moved, and its stacks lose what comes when they are full, or panic.
        tree.max_depth = tree.depth(0);
        tree.parents = Vec::new();
        let order = std::mem::take(&mut tree.primitive_indices);
        (Self(tree), order)
    }

    #[inline(always)]
    fn closest(&self, way: &Way, mut visit: impl FnMut(usize) -> f32) {
        let _ = self.walk(
            way,
            #[inline(always)]
            |place| ControlFlow::Continue(visit(place)),
        );
    }

    #[inline(always)]
    fn any(&self, way: &Way, mut visit: impl FnMut(usize) -> bool) -> bool {
        let walked = self.walk(
            way,
            #[inline(always)]
            |place| if visit(place) { ControlFlow::Break(()) } else { ControlFlow::Continue(f32::INFINITY) },
        );
        walked.is_break()
    }

    fn bytes(&self) -> usize {
        size_of_val(self.0.nodes.as_slice())
    }
}

/// A part of a binary tree that a way meets later.
#[derive(Clone, Copy, Default)]
struct Later {
    first: u32,
    count: u32,
    /// Where the way enters it.
    t: f32,
}

/// Levels of a tree that are kept track of without memory of their own: one for which there is nothing to put off, and as many
/// as such a stack of obvhs holds.
const STACK: usize = 64;

impl Binary {
    /// Visits the places on a way until a visit breaks off; else it tells where the way ends.
    ///
    /// As obvhs' own traversal, but for two things: what was put off is dropped where a hit has come to lie before it, and
    /// there is one place that visits leaves.
    #[inline(always)]
    fn walk(&self, way: &Way, visit: impl FnMut(usize) -> ControlFlow<(), f32>) -> ControlFlow<()> {
        if self.0.max_depth <= STACK {
            self.walk_with(way, &mut StackStack::<Later, STACK>::default(), visit)
        } else {
            self.walk_with(way, &mut HeapStack::<Later>::new_with_capacity(self.0.max_depth), visit)
        }
    }

    #[inline(always)]
    fn walk_with(
        &self,
        way: &Way,
        stack: &mut impl FastStack<Later>,
        mut visit: impl FnMut(usize) -> ControlFlow<(), f32>,
    ) -> ControlFlow<()> {
        let nodes = self.0.nodes.as_slice();
        let mut end = way.end;
        let part = |node: &Bvh2Node, t: f32| Later { first: node.first_index, count: node.prim_count, t };
        // The way was found by entering the root.
        let mut next = part(&nodes[0], 0.0);
        loop {
            let first = next.first as usize;
            if next.count > 0 {
                for place in first..first + next.count as usize {
                    end = end.min(visit(place)?);
                }
            } else if let [left, right, ..] = &nodes[first..] {
                let (to_left, to_right) = (entry(left.aabb(), way, end), entry(right.aabb(), way, end));
                let swap = to_right < to_left;
                let (near, far) = if swap { (right, left) } else { (left, right) };
                let (to_near, to_far) = if swap { (to_right, to_left) } else { (to_left, to_right) };
                if to_far < f32::INFINITY {
                    stack.push(part(far, to_far));
                }
                if to_near < f32::INFINITY {
                    next = part(near, to_near);
                    continue;
                }
            }
            next = loop {
                match stack.pop() {
                    None => return ControlFlow::Continue(()),
                    Some(later) if later.t <= end => break later,
                    Some(_) => {}
                }
            };
        }
    }
}

/// Where a way enters a box, before `end`; infinity if it does not.
#[inline(always)]
fn entry(aabb: &Aabb, way: &Way, end: f32) -> f32 {
    let (a, b) = ((aabb.min - way.o) * way.inv, (aabb.max - way.o) * way.inv);
    let (near, far) = (a.min(b).max_element().max(0.0), a.max(b).min_element().min(end));
    if near <= far { near } else { f32::INFINITY }
}

impl Hierarchy for Wide {
    const NAME: &'static str = "cwbvh";

    fn build(boxes: Boxes, preset: Preset) -> (Self, Vec<u32>) {
        let params = preset.params();
        let mut tree = binary(boxes, &params);
        ReinsertionOptimizer::default().run(&mut tree, params.reinsertion_batch_ratio, None);
        let mut wide = bvh2_to_cwbvh(&tree, params.max_prims_per_leaf.clamp(1, 3), true, false);
        wide.nodes.shrink_to_fit();
        let order = std::mem::take(&mut wide.primitive_indices);
        let depth = depth(&wide);
        (Self { tree: wide, depth }, order)
    }

    #[inline(always)]
    fn closest(&self, way: &Way, visit: impl FnMut(usize) -> f32) {
        if self.depth <= STACK {
            self.closest_with(way, StackStack::<UVec2, STACK>::default(), visit);
        } else {
            self.closest_with(way, HeapStack::new_with_capacity(self.depth), visit);
        }
    }

    #[inline(always)]
    fn any(&self, way: &Way, visit: impl FnMut(usize) -> bool) -> bool {
        if self.depth <= STACK {
            self.any_with(way, StackStack::<UVec2, STACK>::default(), visit)
        } else {
            self.any_with(way, HeapStack::new_with_capacity(self.depth), visit)
        }
    }

    fn bytes(&self) -> usize {
        size_of_val(self.tree.nodes.as_slice())
    }
}

impl Wide {
    #[inline(always)]
    fn closest_with(&self, way: &Way, stack: impl FastStack<UVec2>, mut visit: impl FnMut(usize) -> f32) {
        let mut ray = ray(way);
        let mut state = Traversal::new(&self.tree, &ray, stack);
        let mut node: &CwBvhNode;
        obvhs::traverse!(self.tree, node, state, node.intersect_ray(&ray, state.oct_inv4), {
            ray.tmax = ray.tmax.min(visit(state.primitive_id as usize));
        });
    }

    #[inline(always)]
    fn any_with(
        &self,
        way: &Way,
        stack: impl FastStack<UVec2>,
        mut visit: impl FnMut(usize) -> bool,
    ) -> bool {
        let ray = ray(way);
        let mut state = Traversal::new(&self.tree, &ray, stack);
        let mut node: &CwBvhNode;
        obvhs::traverse!(self.tree, node, state, node.intersect_ray(&ray, state.oct_inv4), {
            if visit(state.primitive_id as usize) {
                return true;
            }
        });
        false
    }
}

/// How many levels of nodes a wide tree has.
fn depth(tree: &CwBvh) -> usize {
    let mut level = if tree.nodes.is_empty() { vec![] } else { vec![&tree.nodes[0]] };
    let mut depth = 0;
    while !level.is_empty() {
        depth += 1;
        // Child nodes lie side by side, in the order of their bits.
        let children = |node: &CwBvhNode| {
            let first = node.child_base_idx as usize;
            first..first + node.imask.count_ones() as usize
        };
        level = level.into_iter().flat_map(children).map(|index| &tree.nodes[index]).collect();
    }
    depth
}

/// The binary tree that both start from.
fn binary(boxes: Boxes, params: &BvhBuildParams) -> Bvh2 {
    let Boxes { boxes, owners, split } = boxes;
    let mut tree = PlocBuilder::with_capacity(boxes.len()).build(
        params.ploc_search_distance,
        &boxes,
        owners,
        params.sort_precision,
        params.search_depth_threshold,
    );
    tree.uses_spatial_splits = split;
    tree
}

#[inline(always)]
fn ray(way: &Way) -> Ray {
    // Of the direction obvhs wants the signs; those of zeros must be those of their inverses.
    Ray { origin: way.o, direction: way.inv, inv_direction: way.inv, tmin: 0.0, tmax: way.end }
}

/// Where a traversal of a wide tree stands. As obvhs' own, with room for deeper trees.
struct Traversal<T> {
    stack: T,
    current_group: UVec2,
    primitive_group: UVec2,
    oct_inv4: u32,
    primitive_id: u32,
    hitmask: u32,
}

impl<T: FastStack<UVec2>> Traversal<T> {
    #[inline(always)]
    fn new(tree: &CwBvh, ray: &Ray, stack: T) -> Self {
        let obvhs::cwbvh::Traversal { current_group, primitive_group, oct_inv4, .. } =
            tree.new_traversal(ray.direction);
        Self { stack, current_group, primitive_group, oct_inv4, primitive_id: 0, hitmask: 0 }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::accel::bvh::frame::Frame;
    use glam::{Vec3, Vec3A};

    /// How far the next of the nested boxes reaches, beside the one around it.
    const SHRINKING: f32 = 0.985;

    /// Boxes in each other, all with a corner at zero, and in the opposite corner of each a bunch of small ones: a ray that comes
    /// from zero goes down to the innermost first and has a bunch to put off at every level.
    fn deep(levels: usize) -> Bvh2 {
        let inner = |aabb: Aabb, first: usize| Bvh2Node::new(aabb, 0, u32::try_from(first).expect("few"));
        let whole = Aabb::new(Vec3A::ZERO, Vec3A::ONE);
        let mut tree = Bvh2 { nodes: vec![inner(whole, 0)], ..Bvh2::default() };
        let (mut spine, mut side) = (0, 1.0_f32);
        for _ in 0..levels {
            let bunch = Aabb::new(Vec3A::splat(0.9 * side), Vec3A::splat(side));
            let first = tree.nodes.len();
            tree.nodes[spine] = inner(*tree.nodes[spine].aabb(), first);
            side *= SHRINKING;
            tree.nodes.extend([inner(Aabb::new(Vec3A::ZERO, Vec3A::splat(side)), 0), inner(bunch, 0)]);
            fill(&mut tree, first + 1, 16);
            spine = first;
        }
        fill(&mut tree, spine, 1);
        tree.max_depth = tree.depth(0);
        tree
    }

    /// Makes a node the root of so many leaves, a power of two, with boxes like its own.
    fn fill(tree: &mut Bvh2, at: usize, leaves: usize) {
        let aabb = *tree.nodes[at].aabb();
        if leaves == 1 {
            let place = u32::try_from(tree.primitive_indices.len()).expect("few");
            tree.primitive_indices.push(place);
            tree.nodes[at] = Bvh2Node::new(aabb, 1, place);
            return;
        }
        let first = tree.nodes.len();
        tree.nodes[at] = Bvh2Node::new(aabb, 0, u32::try_from(first).expect("few"));
        tree.nodes.extend([Bvh2Node::new(aabb, 0, 0); 2]);
        fill(tree, first, leaves / 2);
        fill(tree, first + 1, leaves / 2);
    }

    /// The way along the diagonal that all boxes lie on.
    fn diagonal() -> Way {
        let bounds = crate::math::Aabb { min: Vec3::ZERO, max: Vec3::ONE };
        let ray = crate::geometry::Ray::new(Vec3::splat(-1.0), Vec3::ONE);
        Frame::around(bounds, 1.0).enter(&ray).expect("it enters")
    }

    fn all_are_visited(tree: &impl Hierarchy, count: usize) {
        let mut visited = vec![0; count];
        tree.closest(&diagonal(), |place| {
            visited[place] += 1;
            f32::INFINITY
        });
        assert!(visited.iter().all(|&times| times == 1), "the nearest: {visited:?}");
        let mut asked = 0;
        let found = tree.any(&diagonal(), |_| {
            asked += 1;
            false
        });
        assert!(!found && asked == count, "any: {asked} of {count} asked");
    }

    #[test]
    fn deep_trees_lose_nothing_and_small_stacks_would() {
        let tree = deep(600);
        let count = tree.primitive_indices.len();
        assert!(tree.max_depth > 600, "{}", tree.max_depth);
        let wide = bvh2_to_cwbvh(&tree, 3, true, false);
        let wide = Wide { depth: depth(&wide), tree: wide };
        assert!(wide.depth > STACK, "too shallow to fill a stack: {}", wide.depth);
        all_are_visited(&wide, count);
        let mut reached = 0;
        wide.closest_with(&diagonal(), StackStack::<UVec2, STACK>::default(), |_| {
            reached += 1;
            f32::INFINITY
        });
        assert!(reached < count, "a stack of {STACK} is enough for {} levels", wide.depth);
        all_are_visited(&Binary(tree), count);
    }
}
