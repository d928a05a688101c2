//! What a scene requires: each capability with how often it is asked for and by whom first, what that takes or what leaving
//! it out saves, what had no effect and was left out, and what is odd about sizes, positions and materials.
//!
//! The list is made once, when a scene is frozen (`count`), and everything else goes by it: building, integrators
//! and backends ask [`Scene::uses`], which answers from this list and from what was forced.

mod bytes;
pub mod capability;
pub(in crate::scene) mod count;
mod lights;
pub mod measured;
mod warnings;

pub use bytes::Bytes;
pub use count::Asked;
pub use lights::{ChosenLights, is_asked};
pub use warnings::length;

use crate::error::{Place, Problem};
use crate::geometry::Shape;
use crate::math::Aabb;
use crate::scene::needs::capability::Capability;
use crate::scene::{Scene, Wanted};
use measured::Measured;

/// One capability, and who asks for it.
#[derive(Clone, Debug, PartialEq)]
pub struct Need {
    /// What.
    pub capability: Capability,
    /// How often it is asked for; 0 where it is left out.
    pub count: usize,
    /// Who asks first; absent where nobody does or nobody can be named.
    pub first: Option<Place>,
    /// Whether it is switched on although nobody asks.
    pub forced: bool,
    /// Memory that it takes, and that leaving it out saves.
    pub bytes: Bytes,
    /// How much time leaving it out saves, where that was measured.
    pub time: Option<Measured>,
}

impl Need {
    /// Whether it is there.
    #[must_use]
    pub fn is_used(&self) -> bool {
        self.count > 0 || self.forced
    }
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
    /// Bytes of vertices and indices; arrays that several meshes share count once.
    pub mesh_bytes: usize,
    /// Pictures on surfaces, each counted once.
    pub textures: usize,
    /// Bytes of them, all sizes counted.
    pub texture_bytes: usize,
}

impl Needs {
    /// Those of a scene that was frozen for what is wanted.
    #[must_use]
    pub fn of(scene: &Scene, wanted: &Wanted) -> Self {
        let times = measured::all();
        let need = |it: Capability| need(scene, wanted, (it, times.get(it.word()).copied()));
        Self {
            capabilities: Capability::ALL.into_iter().map(need).collect(),
            placements: scene.world.placements.len(),
            shapes: scene.world.shapes.len(),
            primitives: scene.world.primitive_count(),
            materials: count::materials_in_use(scene).count(),
            lights: scene.lights.len(),
            bounds: scene.world.bounds(),
            mesh_bytes: bytes::of_meshes(scene),
            textures: scene.textures.len(),
            texture_bytes: scene.texture_bytes(),
        }
    }

    /// How often a capability is asked for.
    #[must_use]
    pub fn count(&self, capability: Capability) -> usize {
        self.capabilities.iter().find(|need| need.capability == capability).map_or(0, |need| need.count)
    }

    /// Whether a capability is there: asked for, or forced.
    #[must_use]
    pub fn uses(&self, capability: Capability) -> bool {
        self.capabilities.iter().any(|need| need.capability == capability && need.is_used())
    }
}

/// What is odd about a scene, as far as that is seen at a glance; `origins` says for each placement where it was described.
#[must_use]
pub fn warnings(scene: &Scene, origins: &[Place]) -> Vec<Problem> {
    warnings::of(scene, origins)
}

/// What is odd about its triangles, for which all are looked at: n log n for n triangles.
#[must_use]
pub fn warnings_of_triangles(scene: &Scene, origins: &[Place]) -> Vec<Problem> {
    warnings::of_triangles(scene, origins)
}

fn need(scene: &Scene, wanted: &Wanted, (capability, time): (Capability, Option<Measured>)) -> Need {
    let asked = scene.asked().iter().find(|asked| asked.capability == capability);
    let count = asked.map_or(usize::from(scene.requires(capability)), |asked| asked.count);
    Need {
        capability,
        count,
        first: asked.and_then(|asked| asked.first.clone()),
        forced: count == 0 && scene.forces(capability),
        bytes: bytes::of(scene, wanted, capability),
        time,
    }
}

/// The meshes of a scene.
fn meshes(scene: &Scene) -> impl Iterator<Item = &crate::geometry::Mesh> {
    scene
        .world
        .shapes
        .iter()
        .filter_map(|shape| if let Shape::Mesh(mesh) = shape { Some(mesh) } else { None })
}
