//! Holes in surfaces, from pictures.

use crate::geometry::{HitFilter, Ray, Shape, ShapeHit};
use crate::texture::Scalar;
use glam::Vec2;

/// From this opacity on there is a surface. Pictures are interpolated between texels, so edges are smooth lines.
const THERE: f32 = 0.5;

/// Lets rays through where the materials of a shape are not there.
#[derive(Clone, Debug)]
pub struct CutOut {
    shape: Shape,
    /// How much of each group is there; all of it without.
    opacities: Vec<Option<Scalar>>,
}

impl CutOut {
    /// For a shape and the opacity of each of its groups.
    #[must_use]
    pub fn new(shape: Shape, opacities: Vec<Option<Scalar>>) -> Self {
        Self { shape, opacities }
    }
}

impl HitFilter for CutOut {
    fn accepts(&self, ray: &Ray, hit: &ShapeHit, prim: u32) -> bool {
        let group = usize::from(self.shape.group(prim));
        let Some(opacity) = self.opacities.get(group).and_then(Option::as_ref) else { return true };
        let uv = match &self.shape {
            Shape::Mesh(mesh) => mesh.corner_uvs(prim).map_or(Vec2::new(hit.u, hit.v), |[a, b, c]| {
                a * (1.0 - hit.u - hit.v) + b * hit.u + c * hit.v
            }),
            shape => shape.point(prim, ray, hit).uv,
        };
        opacity.at::<f32>(uv.to_array()) >= THERE
    }
}
