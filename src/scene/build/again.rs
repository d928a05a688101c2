//! The same scene seen otherwise: from elsewhere, at another time, on another film; or rendered with other settings. What the difference does not
//! touch stays.

use crate::scene::Scene;
use crate::scene::build::{Origin, camera};
use crate::scene::description::{Description, FuzzyBy};

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

/// Makes of the scene of `before` that of `after`, where they differ in `render` and `film` alone, and there in nothing that building looks at; else
/// leaves it as it is and says so. The world stays the same to the address.
pub fn retune(scene: &mut Scene, before: &Description, after: &Description) -> bool {
    let is_same = is_built_alike(before, after);
    if is_same {
        (scene.render, scene.film) = (after.render.clone(), after.film.clone());
    }
    is_same
}

/// Whether a scene built of one description is that of another one but for `render` and `film`: nothing else differs, and none of the
/// few settings that building looks at. Whatever is not known here not to matter counts.
fn is_built_alike(built: &Description, wanted: &Description) -> bool {
    let mut like = built.clone();
    let (to, from) = (&mut like.render, &wanted.render);
    to.spp = from.spp;
    to.max_depth = from.max_depth;
    to.min_throughput = from.min_throughput;
    to.roulette = from.roulette;
    to.clamp_indirect = from.clamp_indirect;
    to.light_choice = from.light_choice;
    to.light_samples = from.light_samples;
    to.glossy_samples = from.glossy_samples;
    to.split_depth = from.split_depth;
    to.path_splits = from.path_splits;
    to.query = from.query;
    to.backend = from.backend;
    to.build_quality = from.build_quality;
    to.sampler = from.sampler;
    to.seed = from.seed;
    if to.glossy != FuzzyBy::Jitter && from.glossy != FuzzyBy::Jitter {
        to.glossy = from.glossy;
    }
    like.film.filter = wanted.film.filter;
    like.film.filter_radius = wanted.film.filter_radius;
    like == *wanted
}
