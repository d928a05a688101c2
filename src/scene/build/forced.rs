//! What a scene does not need, switched on all the same: for measuring what leaving it out brings.
//!
//! Pictures stay what they are, to rounding. What only hangs on a flag is looked up where it is used
//! ([`Scene::uses`]); here is what must be built.

use crate::camera::{Camera, Lens};
use crate::geometry::{Mesh, Pose, Shape, ShapeId};
use crate::light::{Environment, Light, LightId};
use crate::material::{CutOut, Layer, Material, Scattering};
use crate::math::{Motion, Rgb, Transform};
use crate::scene::Scene;
use crate::scene::build::{Origin, camera, number};
use crate::scene::description;
use crate::scene::needs::capability::Capability;
use glam::{Affine3A, Vec2, Vec3};
use std::sync::Arc;

/// The scene with what it forces; the camera is that of the description, counted from the origin.
pub(super) fn force(mut scene: Scene, (camera, origin): (&description::Camera, Origin)) -> Scene {
    if scene.forced.is_empty() {
        return scene;
    }
    let mut world = (*scene.world).clone();
    let readers = readers(&scene);
    for (shape, is_read) in world.shapes.iter_mut().zip(readers) {
        if let Shape::Mesh(mesh) = shape {
            *mesh = with_attributes(&scene, mesh.clone(), is_read);
        }
    }
    if scene.forces(Capability::CutOuts) {
        for id in (0..number(world.shapes.len())).map(ShapeId) {
            let own = || Arc::new(CutOut::new(world.shapes[id.index()].clone(), Vec::new())) as _;
            world.filters.entry(id).or_insert_with(own);
        }
    }
    for placement in &mut world.placements {
        placement.pose = posed(&scene, &placement.pose);
    }
    scene.world = Arc::new(world);
    if scene.forces(Capability::Mixes) {
        scene.materials = scene.materials.into_iter().map(mixed).collect();
    }
    if scene.forces(Capability::Environment) && scene.environment.is_none() {
        scene.environment = Some(LightId(number(scene.lights.len())));
        scene.lights.push(Light::Environment(Environment::Constant(Rgb::BLACK)));
    }
    scene.camera = with_camera(&scene, (camera, origin));
    scene
}

/// Of each shape, whether its surface parameters are read.
fn readers(scene: &Scene) -> Vec<bool> {
    let mut read = vec![false; scene.world.shapes.len()];
    for (placement, surface) in scene.world.placements.iter().zip(&scene.surfaces) {
        let reads = surface.materials.iter().any(|id| scene.materials[id.index()].reads_parameters());
        read[placement.shape.index()] |= reads;
    }
    read
}

/// Normals of zero stand for the triangle's own; parameters of zero are read by nobody; a second key is the first one.
fn with_attributes(scene: &Scene, mesh: Mesh, is_read: bool) -> Mesh {
    let vertices = mesh.positions().len();
    let still = mesh.key_count() == 1;
    let mut made = mesh;
    let replace = |own: &Mesh, other: Result<Mesh, _>| {
        other.unwrap_or_else(|_: crate::geometry::MeshError| own.clone())
    };
    if scene.forces(Capability::ShadingNormals) && !made.has_normals() && still {
        made = replace(&made, made.clone().with_normals(vec![Vec3::ZERO; vertices]));
    }
    if scene.forces(Capability::SurfaceParameters) && !made.has_uvs() && !is_read {
        made = replace(&made, made.clone().with_uvs(vec![Vec2::ZERO; vertices]));
    }
    if scene.forces(Capability::MovingVertices) && still {
        made = made.clone().held();
    }
    made
}

fn posed(scene: &Scene, pose: &Pose) -> Pose {
    let map = match pose {
        Pose::World => Affine3A::IDENTITY,
        Pose::Still(transform) => *transform.world_from_object(),
        Pose::Moving(_) => return pose.clone(),
    };
    if scene.forces(Capability::MovingPoses) {
        return Motion::new(&[map; 2]).map_or_else(|| pose.clone(), Pose::Moving);
    }
    match pose {
        Pose::World if scene.forces(Capability::Instances) => {
            Transform::new(map).map_or(Pose::World, Pose::Still)
        }
        _ => pose.clone(),
    }
}

/// A surface as the only part of a mix. The boundary of a medium stays alone: within a mix it would be seen between equal media.
fn mixed(material: Material) -> Material {
    let scattering = match material.scattering {
        own @ (Scattering::Black | Scattering::Mix(_) | Scattering::Dielectric { .. }) => own,
        single => Scattering::Mix(vec![Layer { weight: Rgb::WHITE, scattering: single }]),
    };
    Material { scattering, ..material }
}

/// A camera that stands still at two keys; a lens too small to blur.
fn with_camera(scene: &Scene, (described, origin): (&description::Camera, Origin)) -> Camera {
    let size = [scene.film.width, scene.film.height];
    let held = scene.forces(Capability::MovingCamera) && !scene.camera.is_moving();
    let camera = if held { camera::held(described, origin, size) } else { None };
    let camera = camera.unwrap_or_else(|| scene.camera.clone());
    if scene.forces(Capability::Lens) && !camera.has_lens() {
        return camera.with_lens(Lens::new(f32::MIN_POSITIVE, 0, 0.0));
    }
    camera
}
