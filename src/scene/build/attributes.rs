//! Attributes of vertices that somebody reads; the others are dropped.

use crate::film::Aov;
use crate::geometry::{Mesh, PlacementId, Shape};
use crate::material::{Material, Scattering};
use crate::scene::Wanted;
use crate::scene::build::{Builder, number};
use crate::scene::description::{Integrator, Render, View};
use crate::scene::needs::capability::Capability;

impl Builder {
    /// Drops surface parameters and shading normals that neither materials nor what is wanted reads.
    pub(super) fn drop_attributes(&mut self, wanted: &Wanted, render: &Render) {
        let has = |aov| wanted.layout.has(aov);
        let keeps_uvs =
            are_parameters_shown(wanted, render) || wanted.forced.has(Capability::SurfaceParameters);
        let keeps_normals = has(Aov::Normal)
            || has(Aov::GeometricNormal)
            || render.integrator == Integrator::View
            || wanted.forced.has(Capability::ShadingNormals);
        let (mut uvs, mut normals) =
            (vec![keeps_uvs; self.world.shapes.len()], vec![keeps_normals; self.world.shapes.len()]);
        for id in (0..number(self.surfaces.len())).map(PlacementId) {
            let shape = self.world.placements[id.index()].shape.index();
            let materials = &self.surfaces[id.index()].materials;
            let any = |reads: fn(&Material) -> bool| {
                materials.iter().any(|material| reads(&self.materials[material.index()]))
            };
            uvs[shape] |= any(Material::reads_parameters);
            normals[shape] |= any(|material| !matches!(material.scattering, Scattering::Black));
        }
        for ((shape, uvs), normals) in self.world.shapes.iter_mut().zip(uvs).zip(normals) {
            let Shape::Mesh(mesh) = shape else { continue };
            if !uvs && mesh.has_uvs() {
                *mesh = mesh.clone().without_uvs();
            }
            if !normals && mesh.has_normals() && faces_agree(mesh) {
                *mesh = mesh.clone().without_normals();
            }
        }
    }
}

/// Whether a picture shows surface parameters themselves.
pub(super) fn are_parameters_shown(wanted: &Wanted, render: &Render) -> bool {
    wanted.layout.has(Aov::Uv) || (render.integrator == Integrator::View && render.view == View::Uv)
}

/// Whether the normals of all corners are on the outside of their triangles, so that without them outside is where it was.
fn faces_agree(mesh: &Mesh) -> bool {
    mesh.key_count() == 1
        && (0..number(mesh.triangles().len())).all(|triangle| {
            let [a, b, c] = mesh.corners(triangle);
            let own = (b - a).cross(c - a);
            mesh.corner_normals(triangle)
                .is_none_or(|normals| normals.into_iter().all(|normal| normal.dot(own) > 0.0))
        })
}
