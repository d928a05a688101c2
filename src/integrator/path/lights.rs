//! Which light a path asks.

use crate::light::tree::{Drawn, Leaf};
use crate::light::{Emitter, Light, LightId, LightTree, Reference};
use crate::math::Vec3;
use crate::math::lanes::{Compare, IntLanes, Isa, Kernel, Lanes, WIDEST};
use crate::sampling::Table1d;
use crate::scene::description::LightChoice;
use crate::scene::needs::capability::Capability;
use crate::scene::needs::{ChosenLights, is_asked};
use crate::scene::{Direct, Scene};

/// The lights of a scene that are asked, and how one is chosen.
#[derive(Debug)]
pub(super) struct Lights {
    /// Those that a table chooses from: all, or where there is a tree those that it lacks.
    asked: Vec<LightId>,
    choice: Option<Table1d>,
    /// Of those: their numbers, and with which probability the table chooses them.
    names: Vec<u32>,
    chances: Vec<f32>,
    /// By light, with which probability the table chooses it.
    probabilities: Vec<f32>,
    direct: Direct,
    tree: Option<LightTree>,
    /// Whether one is chosen; else there is one at most.
    chooses: bool,
    /// Whether normals of surfaces count in the choice.
    normals: bool,
}

/// The lights of some lanes.
pub(super) struct Picked<S: Isa> {
    pub(super) ids: [u32; WIDEST],
    /// Triangles of those that are chosen by their triangles.
    pub(super) parts: S::I,
    /// Zero where no light matters.
    pub(super) probability: S::F,
}

/// What densities of asking count for where lobes are to have no share: beside them, squared, all others vanish.
const ALL_OF_IT: f32 = 1e30;

impl Lights {
    pub(super) fn of(scene: &Scene) -> Self {
        let all = || {
            (0..).map(LightId).zip(&scene.lights).filter(|(_, light)| is_asked(light, scene.render.direct))
        };
        let choice = ChosenLights::of(scene).choice;
        let chooses = scene.uses(Capability::LightChoice);
        let tree = if chooses && choice == LightChoice::Tree { LightTree::new(all()) } else { None };
        let radius = scene.world.bounds().radius();
        // Where there is a tree, each light at infinity is as likely as all of it.
        let weight = |light: &Light| match choice {
            LightChoice::Power => light.power(radius).clamp(f32::MIN_POSITIVE, f32::MAX),
            LightChoice::Uniform | LightChoice::Tree => 1.0,
        };
        let in_table = all().filter(|(_, light)| tree.is_none() || light.is_infinite());
        let (asked, weights): (Vec<_>, Vec<_>) = in_table.map(|(id, light)| (id, weight(light))).unzip();
        let choice = if asked.len() > 1 { table(&weights) } else { None };
        let mut probabilities = vec![0.0; scene.lights.len()];
        let chance = |index| choice.as_ref().map_or(1.0, |table: &Table1d| table.probability(index));
        let chances: Vec<f32> = (0..asked.len()).map(chance).collect();
        for (id, chance) in asked.iter().zip(&chances) {
            probabilities[id.index()] = *chance;
        }
        let names = asked.iter().map(|id: &LightId| id.0).collect();
        Self {
            asked,
            choice,
            names,
            chances,
            probabilities,
            direct: scene.render.direct,
            // Who measures what a choice takes means all of it.
            normals: tree.is_some() || scene.forces(Capability::LightChoice),
            tree,
            chooses,
        }
    }

    /// Whether there is none to ask.
    pub(super) fn is_empty(&self) -> bool {
        self.asked.is_empty() && self.tree.is_none()
    }

    /// The factor on densities of asking where they are weighed against those of lobes.
    pub(super) fn favour(&self) -> f32 {
        if self.direct == Direct::Light { ALL_OF_IT } else { 1.0 }
    }

    /// Whether lights that lobes can find are not asked.
    pub(super) fn are_left_to_lobes(&self) -> bool {
        self.direct == Direct::Bsdf
    }

    /// The only one, if no choice is needed.
    pub(super) fn only(&self) -> Option<LightId> {
        match self.asked[..] {
            [only] if !self.chooses => Some(only),
            _ => None,
        }
    }

    /// Whether normals of surfaces count in the choice.
    pub(super) fn uses_normals(&self) -> bool {
        self.normals
    }

    /// Whether a light is asked by its triangles.
    pub(super) fn is_split(&self, id: LightId) -> bool {
        self.tree.as_ref().is_some_and(|tree| tree.is_split(id))
    }

    /// The probability of the tree beside the lights at infinity.
    #[expect(clippy::cast_precision_loss, reason = "few")]
    fn tree_share(&self) -> f32 {
        1.0 / (self.asked.len() as f32 + 1.0)
    }

    /// The lights for numbers in [0, 1).
    #[inline(always)]
    pub(super) fn pick<S: Isa>(&self, isa: S, at: Reference<S::F>, u: S::F) -> Picked<S> {
        let Some(tree) = &self.tree else { return self.by_table(isa, u) };
        let (share, zero) = (self.tree_share(), isa.splat_u32(0));
        // The first numbers lead to the tree.
        let rest = (u * (1.0 / share)).min(1.0 - f32::EPSILON);
        let Drawn { leaf, probability } = draw(isa, tree, at, rest);
        let (mut leaves, mut chances) = ([0; WIDEST], [0.0; WIDEST]);
        leaf.store(&mut leaves);
        (probability * share).store(&mut chances);
        let (mut ids, mut parts) = ([u32::MAX; WIDEST], [0; WIDEST]);
        for lane in 0..S::WIDTH {
            let Leaf { light, part } = tree.leaves()[leaves[lane] as usize];
            (ids[lane], parts[lane]) = (light.0, part.unwrap_or(0));
        }
        if !self.asked.is_empty() {
            let mut numbers = [0.0; WIDEST];
            u.store(&mut numbers);
            self.at_infinity(&numbers[..S::WIDTH], share, &mut ids, &mut chances);
        }
        let parts = if parts == [0; WIDEST] { zero } else { isa.load_u32(&parts) };
        Picked { ids, parts, probability: isa.load(&chances) }
    }

    #[inline(always)]
    fn by_table<S: Isa>(&self, isa: S, u: S::F) -> Picked<S> {
        let zero = isa.splat_u32(0);
        let index = match &self.choice {
            Some(table) => table.sample_lanes(u).index,
            None => zero,
        };
        let mut ids = [u32::MAX; WIDEST];
        isa.gather_u32(&self.names, index).store(&mut ids);
        Picked { ids, parts: zero, probability: isa.gather(&self.chances, index) }
    }

    /// Lights at infinity for the numbers that do not lead to the tree.
    #[inline(never)]
    fn at_infinity(&self, numbers: &[f32], share: f32, ids: &mut [u32; WIDEST], chances: &mut [f32; WIDEST]) {
        for (lane, &number) in numbers.iter().enumerate().filter(|(_, number)| **number >= share) {
            let rest = ((number - share) / (1.0 - share)).clamp(0.0, 1.0 - f32::EPSILON);
            let id = self.asked[self.choice.as_ref().map_or(0, |table| table.sample(rest).index)];
            ids[lane] = id.0;
            chances[lane] = self.probabilities[id.index()] * (1.0 - share);
        }
    }

    /// The probability with which a light at infinity is asked, from wherever, times [`Self::favour`]; 0 if it is never asked.
    pub(super) fn chance_at_infinity(&self, id: LightId) -> f32 {
        let others = if self.tree.is_some() { self.tree_share() } else { 0.0 };
        self.favour() * self.probabilities[id.index()] * (1.0 - others)
    }

    /// The density per solid angle, the choice included, with which asking from `at` draws the direction `wi`, along which a ray met the
    /// light at `emitter`, times [`Self::favour`]; 0 if it is never asked.
    pub(super) fn pdf(
        &self,
        scene: &Scene,
        id: LightId,
        (at, wi): (Reference<f32>, Vec3<f32>),
        emitter: Option<&Emitter>,
    ) -> f32 {
        let light = &scene.lights[id.index()];
        let Some(tree) = &self.tree else {
            return self.favour() * self.probabilities[id.index()] * light.pdf(at, wi, emitter);
        };
        if light.is_infinite() {
            return self.chance_at_infinity(id) * light.pdf(at, wi, emitter);
        }
        let part = if tree.is_split(id) { emitter.map(|emitter| emitter.prim) } else { None };
        let chance = tree.probability(at, Leaf { light: id, part }) * self.tree_share();
        let density = if part.is_some() { Light::pdf_part } else { Light::pdf };
        if chance > 0.0 { self.favour() * chance * density(light, at, wi, emitter) } else { 0.0 }
    }
}

/// The table of several weights. Weights that are no numbers say nothing: then all are alike. No scene has more lights than a table holds.
fn table(weights: &[f32]) -> Option<Table1d> {
    Table1d::new(weights).or_else(|_| Table1d::new(&vec![1.0; weights.len()])).ok()
}

/// A function of its own per instruction set, as for lights.
#[inline(never)]
fn draw<S: Isa>(isa: S, tree: &LightTree, at: Reference<S::F>, u: S::F) -> Drawn<S::F> {
    isa.run(Draw { tree, at, u })
}

struct Draw<'a, F> {
    tree: &'a LightTree,
    at: Reference<F>,
    u: F,
}

impl<S: Isa> Kernel<S> for Draw<'_, S::F> {
    type Output = Drawn<S::F>;
    #[inline(always)]
    fn run(self, _isa: S) -> Drawn<S::F> {
        self.tree.sample(self.at, self.u)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_light_can_be_chosen_whatever_its_weight() {
        for weights in [[1.0, 3.0], [f32::NAN, 1.0]] {
            let table = table(&weights).expect("a table");
            assert!((0..2).all(|light| table.probability(light) > 0.2), "{weights:?}");
        }
    }
}
