//! A hierarchy over things that have boxes, in its frame.

use super::Options;
use super::frame::{Frame, Way};
use super::hierarchy::{Boxes, Hierarchy};
use crate::geometry::Ray;
use crate::math::Aabb;
use glam::{Vec3, Vec3A};
use obvhs::splits::split_aabbs_preset;
use obvhs::triangle::Triangle;

/// A hierarchy over at least two finite boxes.
#[derive(Debug)]
pub(super) struct Tree<H> {
    frame: Frame,
    hierarchy: H,
}

/// The corners of a triangle by its number, for splitting large ones.
pub(super) type CornersOf<'a> = &'a dyn Fn(u32) -> [Vec3; 3];

impl<H: Hierarchy> Tree<H> {
    /// A tree, and which thing is at each of its places. Things with empty boxes are at none, split ones at several. `None` if
    /// fewer than two boxes are left.
    pub(super) fn build(
        boxes: &[Aabb],
        corners: Option<CornersOf<'_>>,
        options: &Options,
    ) -> Option<(Self, Vec<u32>)> {
        let owners: Vec<u32> =
            (0..).zip(boxes).filter(|(_, aabb)| !aabb.is_empty()).map(|(i, _)| i).collect();
        if owners.len() < 2 {
            return None;
        }
        let all = owners.iter().fold(Aabb::EMPTY, |all, &i| all.union(boxes[i as usize]));
        let frame = Frame::around(all, options.padding);
        let boxes = match corners.filter(|_| options.preset.params().pre_split) {
            Some(corners) => split(&frame, owners, corners),
            None => {
                let boxes = owners.iter().map(|&i| frame.aabb(boxes[i as usize])).collect();
                Boxes { boxes, owners, split: false }
            }
        };
        let (hierarchy, order) = H::build(boxes, options.preset);
        Some((Self { frame, hierarchy }, order))
    }

    pub(super) fn frame(&self) -> &Frame {
        &self.frame
    }

    /// The way of a traceable ray through the tree; none where it passes by.
    #[inline(always)]
    pub(super) fn enter(&self, ray: &Ray) -> Option<Way> {
        self.frame.enter(ray)
    }

    /// Visits places on a way. A visit answers with the ray's parameter at a hit: nothing beyond it is visited any more, and
    /// nothing at all where `ANY` hit will do.
    #[inline(always)]
    pub(super) fn search<const ANY: bool>(&self, way: &Way, mut visit: impl FnMut(usize) -> Option<f32>) {
        if ANY {
            self.hierarchy.any(
                way,
                #[inline(always)]
                |place| visit(place).is_some(),
            );
        } else {
            self.hierarchy.closest(
                way,
                #[inline(always)]
                |place| visit(place).map_or(f32::INFINITY, |t| way.local(t)),
            );
        }
    }

    pub(super) fn bytes(&self) -> usize {
        self.hierarchy.bytes()
    }
}

/// Padded boxes around triangles, several around large ones.
fn split(frame: &Frame, mut owners: Vec<u32>, corners: CornersOf<'_>) -> Boxes {
    let triangle = |&owner: &u32| {
        let [v0, v1, v2] = corners(owner).map(|p| frame.point(p));
        Triangle { v0, v1, v2 }
    };
    let triangles: Vec<Triangle> = owners.iter().map(triangle).collect();
    let mut boxes: Vec<_> = triangles.iter().map(Triangle::aabb).collect();
    let areas = || boxes.iter().map(obvhs::aabb::Aabb::half_area);
    let largest = areas().fold(0.0, f32::max);
    #[expect(clippy::cast_precision_loss, reason = "a rule of thumb")]
    let average = areas().sum::<f32>() / boxes.len() as f32;
    // obvhs counts triangles from 0 in the order of this list, which need not be their own numbers.
    let mut places: Vec<u32> = (0..).take(owners.len()).collect();
    split_aabbs_preset(&mut boxes, &mut places, &triangles, average, largest);
    let padding = Vec3A::splat(frame.padding());
    for aabb in &mut boxes {
        (aabb.min, aabb.max) = (aabb.min - padding, aabb.max + padding);
    }
    owners = places.iter().map(|&place| owners[place as usize]).collect();
    Boxes { boxes, owners, split: true }
}
