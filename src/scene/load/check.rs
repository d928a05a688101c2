//! What the keys of one table must satisfy together.

use crate::scene::description::{Camera, Form, Light, Step};
use crate::scene::load::decode::Fields;
use glam::{Mat3, Vec3, Vec4};

/// Sine of the least angle between directions that count as different. Smaller accepts frames whose axes are mostly
/// rounding error; larger refuses views that are meant.
const PARALLEL: f32 = 1e-5;

fn parallel(a: Vec3, b: Vec3) -> bool {
    // Scaled first: squares of lengths beyond 1e19 are infinite, below 1e-19 zero.
    let (a, b) = (a / a.abs().max_element(), b / b.abs().max_element());
    a.cross(b).length() <= PARALLEL * a.length() * b.length()
}

/// A camera looks somewhere, and knows what is up there.
pub(crate) fn camera(camera: &Camera, fields: &mut Fields<'_>) {
    let Camera::Perspective { from, at, up, .. } = *camera;
    if from == at {
        fields.problem("at", "`at` is where the camera stands", "give another point to look at");
    } else if parallel(at - from, up) {
        fields.problem("up", "`up` points along the view", "give another direction");
    }
}

/// Edges span an area, boxes have corners in order.
pub(crate) fn form(form: &Form, fields: &mut Fields<'_>) {
    match *form {
        Form::Rectangle { edge_u, edge_v, .. } => edges(edge_u, edge_v, fields),
        Form::Box { min, max } if !min.cmplt(max).all() => {
            fields.problem("max", "`max` is not above `min` on every axis", "give the lower corner as `min`");
        }
        _ => {}
    }
}

/// Edges span an area, spots aim somewhere.
pub(crate) fn light(light: &Light, fields: &mut Fields<'_>) {
    match *light {
        Light::Rectangle { edge_u, edge_v, .. } => edges(edge_u, edge_v, fields),
        Light::Spot { position, at, .. } if position == at => {
            fields.problem("at", "`at` is where the light stands", "give another point to aim at");
        }
        _ => {}
    }
}

fn edges(edge_u: Vec3, edge_v: Vec3, fields: &mut Fields<'_>) {
    if parallel(edge_u, edge_v) {
        fields.problem("edge_v", "`edge_v` is parallel to `edge_u`", "give edges that span an area");
    }
}

/// Steps can be undone.
pub(crate) fn step(step: &Step, fields: &mut Fields<'_>) {
    match *step {
        Step::Scale { scale } if scale.0.cmpeq(Vec3::ZERO).any() => {
            fields.problem("scale", "`scale` is zero", "give factors other than zero");
        }
        Step::Matrix { matrix: [a, b, c, _, d, e, f, _, g, h, i, _, last @ ..] } => {
            let linear = Mat3::from_cols_array(&[a, d, g, b, e, h, c, f, i]);
            if Vec4::from(last) != Vec4::W {
                let remedy = "give the matrix row by row; the last row must be 0, 0, 0, 1";
                fields.problem("matrix", "`matrix` is not affine", remedy);
            } else if linear.determinant() == 0.0 {
                fields.problem("matrix", "`matrix` has no inverse", "give one whose determinant is not zero");
            }
        }
        _ => {}
    }
}
