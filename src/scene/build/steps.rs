//! Transforms from the steps that a scene file lists.

use crate::error::Problem;
use crate::math::{Aabb, Transform};
use crate::scene::description::{Located, Step};
use glam::{Affine3A, Mat4, Vec3};

/// The map that carries a shape through `steps`, first to last; `bounds` is the box of the shape under a map.
pub(super) fn transform(
    steps: &[Located<Step>],
    bounds: impl Fn(&Affine3A) -> Aabb,
) -> Result<Affine3A, Problem> {
    let mut so_far = Affine3A::IDENTITY;
    for step in steps {
        let next = match &step.value {
            Step::Scale { scale } => Affine3A::from_scale(scale.0),
            Step::Rotate { rotate_deg, axis } => {
                Affine3A::from_axis_angle(axis.normalize(), rotate_deg.to_radians())
            }
            Step::Translate { translate } => Affine3A::from_translation(*translate),
            Step::Matrix { matrix: rows } => {
                matrix(rows).map_err(|what| Problem::at(step.place.clone(), what))?
            }
            Step::Fit { fit: size } => fit(bounds(&so_far), *size)
                .ok_or_else(|| Problem::at(step.place.clone(), "a shape without extent cannot be fitted"))?,
        };
        so_far = next * so_far;
    }
    let Some(last) = steps.last() else { return Ok(so_far) };
    if Transform::new(so_far).is_none() {
        let problem = Problem::at(last.place.clone(), "the transform flattens the shape or is not finite");
        return Err(problem.remedy("use factors other than zero"));
    }
    Ok(so_far)
}

fn matrix(rows: &[f32; 16]) -> Result<Affine3A, &'static str> {
    let matrix = Mat4::from_cols_array(rows).transpose();
    #[expect(clippy::float_cmp, reason = "the last row of an affine map is exact")]
    if matrix.row(3).to_array() != [0.0, 0.0, 0.0, 1.0] {
        return Err("the last row of the matrix must be 0, 0, 0, 1");
    }
    Ok(Affine3A::from_mat4(matrix))
}

/// Scales a box to the longest edge `size` and stands it on the middle of the plane y = 0.
fn fit(bounds: Aabb, size: f32) -> Option<Affine3A> {
    let longest = bounds.size().max_element();
    if longest <= 0.0 || !longest.is_finite() {
        return None;
    }
    let foot = Vec3::new(bounds.center().x, bounds.min.y, bounds.center().z);
    let scale = size / longest;
    Some(Affine3A::from_scale(Vec3::splat(scale)) * Affine3A::from_translation(-foot))
}
