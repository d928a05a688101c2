//! Normals of surfaces with a relief: what a picture says, turned into the world.
//!
//! Heights lean the normal against the way uphill, the surface itself stays as it is (Blinn 1978, Simulation of Wrinkled Surfaces;
//! Mikkelsen 2010, Bump Mapping Unparametrized Surfaces on the GPU).
//!
//! The frame is that of the surface parameters at the point, so that pictures lie as their colours do, mirrored ones too.
//! Surfaces whose parameters are not known to lie in any direction stay as they are. Normals that would mirror the view into
//! the surface are bent back where they are used, as interpolated ones are (`shading.rs`).

use crate::geometry::Interaction;
use crate::material::Material;
use crate::scene::Scene;
use crate::texture::{Relief, Spot};
use glam::Vec3;

/// The shading normal of a point of a surface with a relief, unit; `None` where there is none.
pub(super) fn normal(scene: &Scene, it: &Interaction, material: &Material, spot: Spot<f32>) -> Option<Vec3> {
    let relief = material.relief.as_ref()?;
    let grain = scene.world.grain(it)?;
    match relief {
        Relief::Normals(map) => {
            let [x, y] = grain.frame(it.ns)?;
            let n: Vec3 = map.at(spot).into();
            (x * n.x + y * n.y + it.ns * n.z).try_normalize()
        }
        Relief::Heights(heights) => {
            let uphill = grain.uphill(it.ns, heights.slopes(spot))? * heights.metres(grain.density());
            (it.ns - uphill).try_normalize()
        }
    }
}
