//! Which light a path asks.

use crate::light::{Environment, Light, LightId};
use crate::sampling::Table1d;
use crate::scene::{Direct, Scene};

/// The lights of a scene that are asked, each with the probability of its choice.
///
/// In proportion to power. An environment that is the same all around is not asked: directions of lobes find it as well, and
/// cost no shadow ray. Where light is left to lobes, only those that lobes cannot find are asked.
#[derive(Debug)]
pub(super) struct Lights {
    asked: Vec<LightId>,
    choice: Option<Table1d>,
    /// By light, asked or not.
    probabilities: Vec<f32>,
    direct: Direct,
}

/// What densities of asking count for where lobes are to have no share: beside them, squared, all others vanish.
const ALL_OF_IT: f32 = 1e30;

impl Lights {
    pub(super) fn of(scene: &Scene) -> Self {
        let radius = scene.world.bounds().radius();
        let direct = scene.render.direct;
        let is_asked = |light: &Light| {
            !matches!(light, Light::Environment(Environment::Constant(_)))
                && (direct != Direct::Bsdf || light.is_delta())
        };
        let ids = (0..).map(LightId).zip(&scene.lights).filter(|(_, light)| is_asked(light));
        let (asked, powers): (Vec<_>, Vec<_>) =
            ids.map(|(id, light)| (id, light.power(radius).clamp(f32::MIN_POSITIVE, f32::MAX))).unzip();
        let choice = if asked.len() > 1 { Table1d::new(&powers).ok() } else { None };
        let mut probabilities = vec![0.0; scene.lights.len()];
        for (index, id) in asked.iter().enumerate() {
            probabilities[id.index()] = choice.as_ref().map_or(1.0, |table| table.probability(index));
        }
        Self { asked, choice, probabilities, direct }
    }

    /// Whether there is none to ask.
    pub(super) fn is_empty(&self) -> bool {
        self.asked.is_empty()
    }

    /// The only one, if no choice is needed.
    pub(super) fn only(&self) -> Option<LightId> {
        if let [only] = self.asked[..] { Some(only) } else { None }
    }

    /// The light for a number in [0, 1).
    pub(super) fn chosen(&self, u: f32) -> LightId {
        self.asked[self.choice.as_ref().map_or(0, |table| table.sample(u).index)]
    }

    /// The probability with which a light is asked; 0 if it never is.
    pub(super) fn probability(&self, id: LightId) -> f32 {
        self.probabilities[id.index()]
    }

    /// The factor on densities of asking where they are weighed against those of lobes.
    pub(super) fn favour(&self) -> f32 {
        if self.direct == Direct::Light { ALL_OF_IT } else { 1.0 }
    }

    /// Whether lights that lobes can find are not asked.
    pub(super) fn are_left_to_lobes(&self) -> bool {
        self.direct == Direct::Bsdf
    }
}
