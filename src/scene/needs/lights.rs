//! How the light that is asked is chosen in a scene.

use crate::light::{Environment, Light, LightTree};
use crate::scene::description::LightChoice;
use crate::scene::{Direct, Scene};

/// From how many emitters on a tree chooses among those that are somewhere: see `benches/record/lights.md`.
const SEVERAL: usize = 2;

/// How the light that is asked is chosen in a scene.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ChosenLights {
    /// The way.
    pub choice: LightChoice,
    /// How many lights are asked; triangles of large meshes count each.
    pub emitters: usize,
}

impl ChosenLights {
    /// As the scene says, or as is best for as many emitters as it has.
    #[must_use]
    pub fn of(scene: &Scene) -> Self {
        let direct = scene.render.direct;
        let lights = || scene.lights.iter().filter(|light| is_asked(light, direct));
        let somewhere = LightTree::count(lights());
        let emitters = somewhere + lights().filter(|light| light.is_infinite()).count();
        let best = if somewhere >= SEVERAL { LightChoice::Tree } else { LightChoice::Power };
        Self { choice: scene.render.light_choice.unwrap_or(best), emitters }
    }
}

/// An environment that is the same all around is not asked: directions of lobes find it as well, and cost no shadow ray.
/// Where light is left to lobes, only those that lobes cannot find are asked.
#[must_use]
pub fn is_asked(light: &Light, direct: Direct) -> bool {
    !matches!(light, Light::Environment(Environment::Constant(_)))
        && (direct != Direct::Bsdf || light.is_delta())
}
