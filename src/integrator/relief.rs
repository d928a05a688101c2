//! Normals of surfaces with a relief: what a picture says, turned into the world.
//!
//! The frame is that of the surface parameters at the point, so that pictures lie as their colours do, mirrored ones too.
//! Surfaces whose parameters are not known to lie in any direction stay as they are. Normals that would mirror the view into
//! the surface are bent back where they are used, as interpolated ones are (`shading.rs`).

use crate::geometry::Interaction;
use crate::material::Material;
use crate::scene::Scene;
use crate::texture::Spot;
use glam::Vec3;

/// The shading normal of a point of a surface with a relief, unit; `None` where there is none.
pub(super) fn normal(scene: &Scene, it: &Interaction, material: &Material, spot: Spot<f32>) -> Option<Vec3> {
    let map = material.normal_map.as_ref()?;
    let [x, y] = scene.world.grain(it)?.frame(it.ns)?;
    let n: Vec3 = map.at(spot).into();
    (x * n.x + y * n.y + it.ns * n.z).try_normalize()
}
