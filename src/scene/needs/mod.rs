//! What a scene requires: each capability with how often it is asked for and by whom first, and what is odd about sizes and
//! positions.
//!
//! Nothing here changes what is rendered: it tells what building and rendering do by themselves.

use crate::error::{Place, Problem};
use crate::geometry::{PlacementId, Pose, Shape};
use crate::light::Light;
use crate::material::{MaterialId, Scattering};
use crate::math::Aabb;
use crate::scene::Scene;
use crate::scene::needs::capability::Capability;
use std::collections::BTreeSet;

pub mod capability;
mod warnings;

pub use warnings::length;

/// One capability, and who asks for it.
#[derive(Clone, Debug, PartialEq)]
pub struct Need {
    /// What.
    pub capability: Capability,
    /// How often it is asked for; 0 where it is left out.
    pub count: usize,
    /// Who asks first; absent where nobody does or nobody can be named.
    pub first: Option<Place>,
}

/// What a scene contains and requires.
#[derive(Clone, Debug, PartialEq)]
pub struct Needs {
    /// Every capability, in the order of [`Capability::ALL`].
    pub capabilities: Vec<Need>,
    /// Placements, each instance counted.
    pub placements: usize,
    /// Shapes, each counted once however often it is placed.
    pub shapes: usize,
    /// Primitives, each instance counted.
    pub primitives: usize,
    /// Materials that something is made of.
    pub materials: usize,
    /// Lights that can shine.
    pub lights: usize,
    /// A box around everything that can be hit.
    pub bounds: Aabb,
    /// Bytes of vertices and indices.
    pub mesh_bytes: usize,
    /// Pictures on surfaces, each counted once.
    pub textures: usize,
    /// Bytes of them, all sizes counted.
    pub texture_bytes: usize,
    /// What is odd about sizes and positions.
    pub warnings: Vec<Problem>,
}

impl Needs {
    /// Those of a scene; `origins` says for each placement where it was described.
    #[must_use]
    pub fn of(scene: &Scene, origins: &[Place]) -> Self {
        let mut count = Count::default();
        count.shapes(scene, origins);
        count.materials(scene, origins);
        count.lights(scene, origins);
        count.add(Capability::MovingCamera, usize::from(scene.camera.is_moving()), None);
        count.add(Capability::Lens, usize::from(scene.camera.has_lens()), None);
        let meshes = scene.world.shapes.iter().filter_map(|shape| match shape {
            Shape::Mesh(mesh) => Some(mesh.bytes()),
            _ => None,
        });
        Self {
            capabilities: count.into_needs(),
            placements: scene.world.placements.len(),
            shapes: scene.world.shapes.len(),
            primitives: scene.world.primitive_count(),
            materials: materials_in_use(scene).count(),
            lights: scene.lights.len(),
            bounds: scene.world.bounds(),
            mesh_bytes: meshes.sum(),
            textures: scene.textures.len(),
            texture_bytes: scene.texture_bytes(),
            warnings: warnings::of(scene, origins),
        }
    }

    /// How often a capability is asked for.
    #[must_use]
    pub fn count(&self, capability: Capability) -> usize {
        self.capabilities.iter().find(|need| need.capability == capability).map_or(0, |need| need.count)
    }
}

/// Capabilities as they are met.
#[derive(Debug, Default)]
struct Count {
    met: Vec<(Capability, usize, Option<Place>)>,
}

impl Count {
    fn add(&mut self, capability: Capability, by: usize, origin: Option<&Place>) {
        if by == 0 {
            return;
        }
        match self.met.iter_mut().find(|(known, _, _)| *known == capability) {
            Some((_, count, _)) => *count += by,
            None => self.met.push((capability, by, origin.cloned())),
        }
    }

    fn shapes(&mut self, scene: &Scene, origins: &[Place]) {
        let mut seen = BTreeSet::new();
        for (index, placement) in scene.world.placements.iter().enumerate() {
            let origin = origins.get(index);
            if seen.insert(placement.shape) {
                self.shape(&scene.world.shapes[placement.shape.index()], origin);
                let is_filtered = scene.world.filters.contains_key(&placement.shape);
                self.add(Capability::CutOuts, usize::from(is_filtered), origin);
            }
            match &placement.pose {
                Pose::World => {}
                Pose::Still(_) => self.add(Capability::Instances, 1, origin),
                Pose::Moving(_) => self.add(Capability::MovingPoses, 1, origin),
            }
            self.add(Capability::Masks, usize::from(placement.mask != u32::MAX), origin);
        }
    }

    fn shape(&mut self, shape: &Shape, origin: Option<&Place>) {
        match shape {
            Shape::Mesh(mesh) => {
                self.add(Capability::Triangles, mesh.triangles().len(), origin);
                self.add(Capability::ShadingNormals, usize::from(mesh.has_normals()), origin);
                self.add(Capability::SurfaceParameters, usize::from(mesh.has_uvs()), origin);
                self.add(Capability::MovingVertices, usize::from(mesh.key_count() > 1), origin);
            }
            Shape::Sphere(_) => self.add(Capability::Spheres, 1, origin),
            Shape::Disc(_) => self.add(Capability::Discs, 1, origin),
            Shape::Surface(surface) => {
                self.add(Capability::Surfaces, surface.primitive_count() as usize, origin);
                self.add(Capability::MovingVertices, usize::from(surface.is_moving()), origin);
            }
        }
    }

    /// Materials, each counted once and named by the first shape made of it.
    fn materials(&mut self, scene: &Scene, origins: &[Place]) {
        for (id, placement) in materials_in_use(scene) {
            let has_images = scene.materials[id.index()].has_images();
            self.add(Capability::ImageTextures, usize::from(has_images), origins.get(placement.index()));
            for part in scene.materials[id.index()].scattering.parts() {
                for capability in capabilities(part) {
                    self.add(*capability, 1, origins.get(placement.index()));
                }
            }
        }
    }

    fn lights(&mut self, scene: &Scene, origins: &[Place]) {
        for (id, light) in (0..).zip(&scene.lights) {
            let capability = match light {
                _ if light.is_delta() => Capability::PointLights,
                Light::Environment(_) => Capability::Environment,
                _ => Capability::AreaLights,
            };
            let placement = scene.surfaces.iter().position(|s| s.light.is_some_and(|own| own.0 == id));
            self.add(capability, 1, placement.and_then(|index| origins.get(index)));
        }
    }

    fn into_needs(mut self) -> Vec<Need> {
        let mut take = |capability| {
            let found = self.met.iter_mut().find(|(known, _, _)| *known == capability);
            let (count, first) = found.map_or((0, None), |(_, count, first)| (*count, first.take()));
            Need { capability, count, first }
        };
        Capability::ALL.into_iter().map(&mut take).collect()
    }
}

/// What a surface asks for.
const fn capabilities(scattering: &Scattering) -> &'static [Capability] {
    match scattering {
        Scattering::Mirror { .. } | Scattering::Glazed { .. } => &[Capability::Mirrors],
        Scattering::Conductor { facets: None, .. } => &[Capability::Mirrors],
        Scattering::Dielectric { facets: None, .. } | Scattering::ThinDielectric(_) => {
            &[Capability::Refraction]
        }
        Scattering::Dielectric { .. } => &[Capability::Refraction, Capability::GlossyLobes],
        Scattering::Schlick(_) => &[Capability::Mirrors, Capability::GlossyLobes],
        Scattering::Conductor { .. }
        | Scattering::Glossy { .. }
        | Scattering::Phong { .. }
        | Scattering::Jitter { .. } => &[Capability::GlossyLobes],
        Scattering::Diffuse { .. }
        | Scattering::OrenNayar { .. }
        | Scattering::Black
        | Scattering::Mix(_) => &[],
    }
}

/// Materials that something is made of, each with the first placement of it.
fn materials_in_use(scene: &Scene) -> impl Iterator<Item = (MaterialId, PlacementId)> {
    let mut seen = BTreeSet::new();
    let all = (0..).map(PlacementId).zip(&scene.surfaces);
    let all = all.flat_map(|(placement, surface)| surface.materials.iter().map(move |id| (*id, placement)));
    all.filter(move |(id, _)| seen.insert(*id))
}
