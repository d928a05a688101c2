//! Transforms from the steps that a scene file lists, in double precision: what is far from the origin may be carried near it.

use crate::error::Problem;
use crate::geometry::Shape;
use crate::math::{Aabb, Transform};
use crate::scene::build::way::single;
use crate::scene::description::{Located, Step};
use crate::scene::track;
use glam::{DAffine3, DVec3};

/// A box of points, in double precision: lowest and highest corner.
pub(super) type Extent = [DVec3; 2];

/// The map that carries a shape through `steps`, first to last; `extent` is the box of the shape under a map.
pub(super) fn transform(
    steps: &[Located<Step>],
    extent: impl Fn(&DAffine3) -> Extent,
) -> Result<DAffine3, Problem> {
    let mut so_far = DAffine3::IDENTITY;
    for step in steps {
        let next = match &step.value {
            Step::Fit { fit: size } => fit(extent(&so_far), *size)
                .ok_or_else(|| Problem::at(step.place.clone(), "a shape without extent cannot be fitted"))?,
            other => affine(other).map_err(|what| Problem::at(step.place.clone(), what))?,
        };
        so_far = next * so_far;
    }
    let Some(last) = steps.last() else { return Ok(so_far) };
    if Transform::new(single(&so_far)).is_none() {
        let problem = Problem::at(last.place.clone(), "the transform flattens the shape or is not finite");
        return Err(problem.remedy("use factors other than zero"));
    }
    Ok(so_far)
}

/// The map of a step that does not depend on the shape.
fn affine(step: &Step) -> Result<DAffine3, &'static str> {
    if let Step::Matrix { matrix } = step
        && matrix[12..] != [0.0, 0.0, 0.0, 1.0]
    {
        return Err("the last row of the matrix must be 0, 0, 0, 1");
    }
    track::map_of(step).ok_or("a shape without extent cannot be fitted")
}

/// Scales a box to the longest edge `size` and stands it on the middle of the plane y = 0.
fn fit([min, max]: Extent, size: f64) -> Option<DAffine3> {
    let longest = (max - min).max_element();
    if longest <= 0.0 || !longest.is_finite() {
        return None;
    }
    let middle = (min + max) * 0.5;
    let foot = DVec3::new(middle.x, min.y, middle.z);
    Some(DAffine3::from_scale(DVec3::splat(size / longest)) * DAffine3::from_translation(-foot))
}

/// The box of a shape under a map; exact for meshes.
pub(super) fn extent_of(shape: &Shape, map: &DAffine3) -> Extent {
    let Shape::Mesh(mesh) = shape else { return around(corners(shape.bounds(), map)) };
    let used = mesh.triangles().iter().flatten();
    around(used.map(|&i| map.transform_point3(mesh.positions()[i as usize].as_dvec3())))
}

fn corners(aabb: Aabb, map: &DAffine3) -> impl Iterator<Item = DVec3> {
    aabb.corners().into_iter().map(|p| map.transform_point3(p.as_dvec3()))
}

fn around(points: impl Iterator<Item = DVec3>) -> Extent {
    let far = DVec3::splat(f64::INFINITY);
    points.fold([far, -far], |[min, max], p| [min.min(p), max.max(p)])
}
