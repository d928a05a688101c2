//! What a mesh is made of.

use super::normals::{self, Creased};
use super::{LoadedMesh, Shading};
use crate::error::{Place, Problem};
use crate::geometry::{Mesh, MeshError};
use crate::scene::description::Normals;
use glam::{DVec3, Vec2, Vec3};
use std::path::Path;

/// Vertices and triangles as a file gives them.
#[derive(Debug, Default)]
pub(in crate::scene::load) struct Parts {
    /// Where positions count from in the file.
    pub(in crate::scene::load) origin: DVec3,
    /// Where vertices are.
    pub(in crate::scene::load) positions: Vec<Vec3>,
    /// Their shading normals by the file, zero where it gives none.
    pub(in crate::scene::load) normals: Option<Vec<Vec3>>,
    /// Their surface parameters.
    pub(in crate::scene::load) uvs: Option<Vec<Vec2>>,
    /// Indices of vertices.
    pub(in crate::scene::load) triangles: Vec<[u32; 3]>,
    /// The group of each triangle, where there is more than one.
    pub(in crate::scene::load) groups: Option<Vec<u16>>,
}

impl Parts {
    /// The mesh, without materials; what was wrong is said of the file.
    pub(in crate::scene::load) fn load(
        self,
        shading: Shading,
        path: &Path,
        warnings: Vec<Problem>,
    ) -> Result<LoadedMesh, Problem> {
        let origin = self.origin;
        let mesh = self.mesh(shading).map_err(|error| Problem::at(Place::file(path), error.to_string()))?;
        Ok(LoadedMesh { mesh, origin, materials: vec![], libraries: vec![], warnings })
    }

    fn mesh(mut self, shading: Shading) -> Result<Mesh, MeshError> {
        match shading.normals {
            Normals::File => {}
            Normals::Flat => self.normals = None,
            Normals::Smooth if shading.crease_deg >= 180.0 => {
                self.normals = Some(normals::smooth(&self.positions, &self.triangles));
            }
            Normals::Smooth => self.crease(shading.crease_deg),
        }
        let mut mesh = Mesh::new(self.positions, self.triangles)?;
        if let Some(normals) = self.normals {
            mesh = mesh.with_normals(normals)?;
        }
        if let Some(uvs) = self.uvs {
            mesh = mesh.with_uvs(uvs)?;
        }
        match self.groups {
            Some(groups) => mesh.with_groups(groups),
            None => Ok(mesh),
        }
    }

    /// Takes vertices apart where edges are sharp.
    fn crease(&mut self, crease_deg: f32) {
        let Creased { vertices, normals, triangles } =
            normals::creased(&self.positions, &self.triangles, crease_deg);
        let positions = vertices.iter().map(|&i| self.positions[i as usize]).collect();
        let uvs = self.uvs.as_ref().map(|uvs| vertices.iter().map(|&i| uvs[i as usize]).collect());
        (self.positions, self.uvs, self.normals, self.triangles) = (positions, uvs, Some(normals), triangles);
    }
}
