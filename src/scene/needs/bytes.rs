//! Memory that a capability takes in a scene, and that leaving it out saves.

use crate::film::{Aov, Film, Layout};
use crate::geometry::{Mesh, Pose};
use crate::image::Window;
use crate::light::{Environment, Light};
use crate::material::Media;
use crate::math::Transform;
use crate::scene::needs::capability::Capability;
use crate::scene::needs::meshes;
use crate::scene::{Scene, Wanted};
use glam::{Affine3A, Vec2, Vec3};
use std::collections::BTreeSet;

/// Bytes of memory, beside what the backend makes of it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Bytes {
    /// What is taken.
    pub taken: usize,
    /// What would be taken besides, if everything that lacks it had it.
    pub saved: usize,
    /// What each path takes, or would take, of those that a thread follows side by side.
    pub per_path: usize,
}

/// Those of a capability, by what there is of the scene.
pub(super) fn of(scene: &Scene, wanted: &Wanted, capability: Capability) -> Bytes {
    let none = Bytes::default();
    match capability {
        Capability::Triangles => {
            let bytes = |mesh: &Mesh| size_of_val(&**mesh.positions()) + size_of_val(&**mesh.triangles());
            Bytes { taken: meshes(scene).map(bytes).sum(), ..none }
        }
        Capability::ShadingNormals => attribute(scene, |mesh| {
            (mesh.has_normals(), size_of::<Vec3>() * mesh.positions().len() * mesh.key_count())
        }),
        Capability::SurfaceParameters => {
            attribute(scene, |mesh| (mesh.has_uvs(), size_of::<Vec2>() * mesh.positions().len()))
        }
        Capability::MovingVertices => attribute(scene, |mesh| {
            let keys = mesh.key_count().max(2) - 1;
            let normals = usize::from(mesh.has_normals());
            (mesh.key_count() > 1, keys * (1 + normals) * size_of::<Vec3>() * mesh.positions().len())
        }),
        Capability::Instances => placements(scene, |pose| match pose {
            Pose::World => (false, size_of::<Transform>()),
            Pose::Still(_) => (true, size_of::<Transform>()),
            Pose::Moving(_) => (false, 0),
        }),
        Capability::MovingPoses => placements(scene, |pose| match pose {
            Pose::World | Pose::Still(_) => (false, 2 * size_of::<Affine3A>()),
            Pose::Moving(motion) => (true, size_of_val(motion.keys())),
        }),
        Capability::Media => Bytes { per_path: size_of::<Media>(), ..none },
        Capability::ImageTextures => {
            Bytes { taken: scene.texture_bytes(), per_path: 2 * size_of::<f32>(), ..none }
        }
        Capability::LightChoice => Bytes { per_path: size_of::<Vec3>(), ..none },
        Capability::Environment => {
            let maps = scene.lights.iter().filter_map(|light| match light {
                Light::Environment(Environment::Map(map)) => Some(map.bytes()),
                _ => None,
            });
            Bytes { taken: maps.sum(), ..none }
        }
        Capability::Aovs => aovs(scene, &wanted.layout),
        Capability::AdaptiveSampling => {
            // What a pixel was after its first half of samples.
            let bytes = size_of::<[f32; 3]>() * pixels(scene).area();
            if wanted.adaptive { Bytes { taken: bytes, ..none } } else { Bytes { saved: bytes, ..none } }
        }
        _ => none,
    }
}

/// Bytes of vertices and indices; arrays that several meshes share count once.
pub(super) fn of_meshes(scene: &Scene) -> usize {
    let mut seen = BTreeSet::new();
    meshes(scene).map(|mesh| mesh.bytes_beside(&mut seen)).sum()
}

/// An attribute of meshes: whether a mesh has it, and what it takes or would take.
fn attribute(scene: &Scene, of: impl Fn(&Mesh) -> (bool, usize)) -> Bytes {
    sum(meshes(scene).map(of))
}

/// The same for placements.
fn placements(scene: &Scene, of: impl Fn(&Pose) -> (bool, usize)) -> Bytes {
    sum(scene.world.placements.iter().map(|placement| of(&placement.pose)))
}

fn sum(parts: impl Iterator<Item = (bool, usize)>) -> Bytes {
    parts.fold(Bytes::default(), |sum, (is_taken, bytes)| match is_taken {
        true => Bytes { taken: sum.taken + bytes, ..sum },
        false => Bytes { saved: sum.saved + bytes, ..sum },
    })
}

/// Sums of the film beside those of the picture.
fn aovs(scene: &Scene, layout: &Layout) -> Bytes {
    let window = pixels(scene);
    let bytes = |layout: &Layout| {
        let bytes = Film::bytes(window, layout, [0; 2]).and_then(|bytes| usize::try_from(bytes).ok());
        bytes.unwrap_or(usize::MAX)
    };
    let (plain, own) = (bytes(&Layout::default()), bytes(layout));
    let all = bytes(&Layout::with(Aov::ALL));
    Bytes { taken: own.saturating_sub(plain), saved: all.saturating_sub(own), per_path: 0 }
}

fn pixels(scene: &Scene) -> Window {
    Window { x0: 0, y0: 0, x1: scene.film.width, y1: scene.film.height }
}
