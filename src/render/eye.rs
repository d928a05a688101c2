//! Which media the camera stands in.

use crate::accel::Accel;
use crate::geometry::Ray;
use crate::integrator::Stage;
use crate::material::{MaterialId, Media};
use crate::scene::Scene;
use glam::Vec3;

/// Surfaces along one line of sight after which the search gives up.
const MOST_SURFACES: usize = 4096;

/// Moments of the shutter at which media are looked for, but for its closing. A camera that dips into glass for less than the
/// time between two of them may go unnoticed.
const MOMENTS: u8 = 32;

/// A scene as the camera sees it, with what is around the camera.
#[derive(Debug)]
pub(super) struct Eye<'a, A> {
    stage: Stage<'a, A>,
    /// Whether the camera goes through a boundary of media, or one goes through it, while the shutter is open.
    changes: bool,
}

impl<'a, A: Accel> Eye<'a, A> {
    pub(super) fn new(scene: &'a Scene, accel: &'a A, spp: u32) -> Self {
        let eye_media = media(scene, accel, 0.0);
        let differ = |i: u8| media(scene, accel, f32::from(i) / f32::from(MOMENTS)) != eye_media;
        let changes = scene.has_media() && scene.is_moving() && (1..=MOMENTS).any(differ);
        Self { stage: Stage::new(scene, accel, spp).within(eye_media), changes }
    }

    /// What an integrator starts from at a moment of the shutter, in [0, 1]. Media are looked for each time only where they
    /// change, for that takes three lines of sight.
    pub(super) fn stage(&self, time: f32) -> Stage<'a, A> {
        let stage = &self.stage;
        stage.within(if self.changes { media(stage.scene, stage.accel, time) } else { stage.eye_media })
    }
}

/// The media around the camera: of three lines of sight, what two agree on, since one may slip through an edge.
fn media<A: Accel>(scene: &Scene, accel: &A, time: f32) -> Media {
    if !scene.has_media() {
        return Media::default();
    }
    // Directions without a pattern, lest they run along edges of a model.
    let directions =
        [Vec3::new(0.31, 0.87, -0.38), Vec3::new(-0.71, 0.23, 0.67), Vec3::new(0.53, -0.61, 0.59)];
    let [a, b, c] = directions.map(|d| bodies(scene, accel, d, time));
    let agreed = if b == c { b } else { a };
    let bodies = agreed.iter().filter_map(|id| Some((*id, scene.materials[id.index()].medium()?)));
    Media::inside(bodies)
}

/// The bodies that a line from the camera leaves without having entered, outermost first.
fn bodies<A: Accel>(scene: &Scene, accel: &A, d: Vec3, time: f32) -> Vec<MaterialId> {
    let mut ray = Ray::new(scene.camera.eye(time), d).at_time(time);
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
