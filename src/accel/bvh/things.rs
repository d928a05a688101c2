//! A hierarchy over anything: placements, or the primitives of a surface.

use super::Options;
use super::hierarchy::Hierarchy;
use super::tree::Tree;
use crate::math::Aabb;

/// Things by number.
#[derive(Debug)]
pub(super) struct Things<H> {
    /// Those without end, and a single one: met by every ray.
    pub(super) loose: Vec<u32>,
    pub(super) tree: Option<Tree<H>>,
    /// Which thing is at each place of the tree.
    pub(super) order: Vec<u32>,
}

impl<H: Hierarchy> Things<H> {
    pub(super) fn build(mut boxes: Vec<Aabb>, options: &Options) -> Self {
        let mut loose = Vec::new();
        for (i, aabb) in (0..).zip(&mut boxes) {
            let is_finite = aabb.min.is_finite() && aabb.max.is_finite();
            if !is_finite && !aabb.is_empty() {
                loose.push(i);
                *aabb = Aabb::EMPTY;
            }
        }
        let Some((tree, order)) = Tree::build(&boxes, None, options) else {
            loose.extend((0..).zip(&boxes).filter(|(_, aabb)| !aabb.is_empty()).map(|(i, _)| i));
            return Self { loose, tree: None, order: Vec::new() };
        };
        Self { loose, tree: Some(tree), order }
    }

    pub(super) fn bytes(&self) -> usize {
        self.tree.as_ref().map_or(0, Tree::bytes)
            + size_of_val(self.order.as_slice())
            + size_of_val(self.loose.as_slice())
    }
}
