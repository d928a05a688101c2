//! The same scene seen otherwise: from elsewhere, at another time, on another film. What the difference does not touch stays.

use crate::scene::Scene;
use crate::scene::build::{Origin, camera};
use crate::scene::description::Description;

/// Makes of the scene of `before` that of `after`, where they differ in the camera and the film alone, and nothing but the camera moves from one
/// to the other; else leaves it as it is and says so. That no file has changed is for the caller to know.
///
/// The world stays the same to the address, so that a hierarchy made of it serves on.
pub fn retake(scene: &mut Scene, before: &Description, after: &Description) -> bool {
    let origin = Origin::of(&after.camera);
    let [was, is] = [before, after].map(|it| camera::shutter(&it.camera));
    let moves = after.shapes.iter().any(|shape| !shape.keys.is_empty());
    let is_same = origin == Origin::of(&before.camera)
        && (was == is || !moves)
        && before.render == after.render
        && before.materials == after.materials
        && before.shapes == after.shapes
        && before.lights == after.lights;
    if !is_same || !scene.forced.is_empty() {
        return false;
    }
    let film = after.film.clone();
    let camera = camera::camera(&after.camera, origin, [film.width, film.height]);
    // What the scene requires stays the same, too.
    let asks_alike =
        camera.is_moving() == scene.camera.is_moving() && camera.has_lens() == scene.camera.has_lens();
    if asks_alike {
        (scene.camera, scene.film) = (camera, film);
    }
    asks_alike
}
