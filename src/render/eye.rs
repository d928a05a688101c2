//! Which media the camera stands in.

use crate::accel::Accel;
use crate::geometry::Ray;
use crate::material::{MaterialId, Media};
use crate::scene::Scene;
use glam::Vec3;

/// Surfaces along one line of sight after which the search gives up.
const MOST_SURFACES: usize = 4096;

/// The media around the camera: of three lines of sight, what two agree on, since one may slip through an edge.
pub(super) fn media<A: Accel>(scene: &Scene, accel: &A) -> Media {
    if !scene.has_media() {
        return Media::default();
    }
    // Directions without a pattern, lest they run along edges of a model.
    let directions =
        [Vec3::new(0.31, 0.87, -0.38), Vec3::new(-0.71, 0.23, 0.67), Vec3::new(0.53, -0.61, 0.59)];
    let [a, b, c] = directions.map(|d| bodies(scene, accel, d));
    let agreed = if b == c { b } else { a };
    let bodies = agreed.iter().filter_map(|id| Some((*id, scene.materials[id.index()].medium()?)));
    Media::inside(bodies)
}

/// The bodies that a line from the camera leaves without having entered, outermost first.
fn bodies<A: Accel>(scene: &Scene, accel: &A, d: Vec3) -> Vec<MaterialId> {
    let mut ray = Ray::new(scene.camera.eye(), d);
    let (mut entered, mut around) = (Vec::new(), Vec::new());
    for _ in 0..MOST_SURFACES {
        let Some(hit) = accel.intersect(&ray) else { break };
        let it = scene.world.interaction(&ray, &hit);
        let (id, material) = scene.material(&it);
        if material.medium().is_some() {
            if it.is_front() {
                entered.push(id);
            } else if let Some(position) = entered.iter().rposition(|known| *known == id) {
                entered.remove(position);
            } else {
                around.push(id);
            }
        }
        ray = it.spawn(d);
    }
    around.reverse();
    around
}
