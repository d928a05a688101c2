//! A tree over many emitters, from which one is drawn by how much it may matter at a point.
//!
//! Conty Estevez and Kulla 2018, *Importance Sampling of Many Lights with Adaptive Tree Splitting*, without the splitting: one number leads
//! from the root to a leaf, at every node to one of its two children in proportion to bounds on what they may bring, and what
//! is left of the number goes on. The triangles of large meshes are emitters of their own. Lights at infinity are not in the tree.
//!
//! A group is a ball with a cone of normals. Its importance is zero only where none of its emitters shines, or all are behind the surface.
//! All lanes go down together, each its own way, until the last has arrived.

mod bounds;
mod build;

use crate::light::{Light, LightId, Reference};
use crate::math::Vec3;
use crate::math::lanes::{Compare, Isa, Lanes, MaskLanes, Select, Wrapping};
use bounds::Bounds;

/// What a leaf of the tree is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Leaf {
    /// The light.
    pub light: LightId,
    /// The triangle, of a mesh of many.
    pub part: Option<u32>,
}

/// What was drawn, over lanes.
#[derive(Clone, Copy, Debug)]
pub struct Drawn<F: Lanes> {
    /// The number of the leaf.
    pub leaf: F::Int,
    /// Its probability: discrete. Zero where no leaf can matter.
    pub probability: F,
}

/// A tree over the emitters of a scene.
#[derive(Clone, Debug)]
pub struct LightTree {
    /// Four vectors to a node: centre; axis; intensity, squared radius, cosine of the spread; its sine, cosine of the reach.
    rows: Vec<[f32; 3]>,
    /// The first of the two children of a node, or [`LEAF`] with the number of a leaf.
    links: Vec<u32>,
    leaves: Vec<Leaf>,
    /// By leaf: the turns from the root, the first one in the lowest bit; a bit beyond the last ends them.
    turns: Vec<u64>,
    /// Where each light is, by its number.
    places: Vec<Place>,
}

/// Where a light is in a tree.
#[derive(Clone, Debug)]
enum Place {
    /// It shines from infinity, or not at all.
    Nowhere,
    /// One leaf.
    Leaf(u32),
    /// A leaf for each triangle, none for those that are dark.
    Leaves(Vec<Option<u32>>),
}

/// Vectors kept of a node.
const ROWS: u32 = 4;

/// Marks what is no inner node.
const LEAF: u32 = 1 << 31;

/// The most edges from the root to a leaf.
const DEEPEST: u32 = 48;

impl LightTree {
    /// Over all emitters of the lights that are somewhere; `None` if there are none.
    #[must_use]
    pub fn new<'a>(lights: impl IntoIterator<Item = (LightId, &'a Light)>) -> Option<Self> {
        let mut emitters = Vec::new();
        for (light, described) in lights {
            let parts = Bounds::of(described).into_iter();
            emitters.extend(parts.map(|(part, bounds)| (Leaf { light, part }, bounds)));
        }
        build::build(emitters)
    }

    /// How many emitters these lights have that would be leaves.
    #[must_use]
    pub fn count<'a>(lights: impl IntoIterator<Item = &'a Light>) -> usize {
        lights.into_iter().map(|light| Bounds::of(light).len()).sum()
    }

    /// The emitters.
    #[must_use]
    pub fn leaves(&self) -> &[Leaf] {
        &self.leaves
    }

    /// Whether the triangles of a light are leaves of their own.
    #[must_use]
    pub fn is_split(&self, light: LightId) -> bool {
        matches!(self.places.get(light.index()), Some(Place::Leaves(_)))
    }

    /// A leaf for a number in [0, 1).
    #[inline(always)]
    pub fn sample<F: Lanes>(&self, at: Reference<F>, u: F) -> Drawn<F> {
        let isa = u.isa();
        let mut node = isa.splat_u32(0);
        let (mut u, mut probability) = (u, isa.splat(1.0));
        for _ in 0..=DEEPEST {
            let link = isa.gather_u32(&self.links, node);
            let goes_on = Compare::<u32>::lt(link, LEAF) & probability.gt(0.0);
            if goes_on.none() {
                break;
            }
            // Lanes that have arrived look at the root again.
            let first = F::Int::select(goes_on, link, isa.splat_u32(0));
            let second = Wrapping::<u32>::wrapping_add(first, 1);
            let [own, other] = [self.importance(at, first), self.importance(at, second)];
            let sum = own + other;
            let exists = sum.gt(0.0);
            let inverse = F::select(exists, sum, isa.splat(1.0)).recip();
            let [p, q] = [own * inverse, other * inverse];
            let is_first = u.lt(p);
            let taken = F::select(is_first, p, q);
            let rest = F::select(is_first, u, u - p) / taken.max(1e-30);
            u = F::select(goes_on, rest.clamp(0.0, 1.0 - f32::EPSILON), u);
            probability = F::select(goes_on, probability * taken, probability);
            node = F::Int::select(goes_on & exists, F::Int::select(is_first, first, second), node);
        }
        let leaf = isa.gather_u32(&self.links, node) & (LEAF - 1);
        // Where nothing can matter the walk stops at an inner node.
        Drawn { leaf: F::Int::select(probability.gt(0.0), leaf, isa.splat_u32(0)), probability }
    }

    /// The probability with which [`Self::sample`] draws a leaf; 0 of what is not in the tree.
    #[must_use]
    pub fn probability(&self, at: Reference<f32>, leaf: Leaf) -> f32 {
        let Some(number) = self.number(leaf) else { return 0.0 };
        let (mut turns, mut node, mut probability) = (self.turns[number as usize], 0, 1.0);
        while turns > 1 && probability > 0.0 {
            let first = self.links[node as usize];
            let [own, other] = [self.importance(at, first), self.importance(at, first + 1)];
            let sum = own + other;
            let taken = if turns & 1 == 0 { own } else { other };
            // By the same operations as when drawing.
            probability *= if sum > 0.0 { taken * sum.recip() } else { 0.0 };
            node = first + u32::from(turns & 1 == 1);
            turns >>= 1;
        }
        probability
    }

    fn number(&self, leaf: Leaf) -> Option<u32> {
        match (self.places.get(leaf.light.index())?, leaf.part) {
            (Place::Leaf(number), None) => Some(*number),
            (Place::Leaves(numbers), Some(part)) => *numbers.get(part as usize)?,
            _ => None,
        }
    }

    /// Notes that a leaf has this number.
    fn note(&mut self, leaf: Leaf, number: u32) {
        let index = leaf.light.index();
        if self.places.len() <= index {
            self.places.resize(index + 1, Place::Nowhere);
        }
        let Some(part) = leaf.part else { return self.places[index] = Place::Leaf(number) };
        if !matches!(self.places[index], Place::Leaves(_)) {
            self.places[index] = Place::Leaves(Vec::new());
        }
        if let Place::Leaves(numbers) = &mut self.places[index] {
            let part = part as usize;
            numbers.resize(numbers.len().max(part + 1), None);
            numbers[part] = Some(number);
        }
    }

    /// A bound on what a node may bring, up to a common factor.
    #[inline(always)]
    fn importance<F: Lanes>(&self, at: Reference<F>, node: F::Int) -> F {
        let isa = at.p.x.isa();
        let first = Wrapping::<u32>::wrapping_mul(node, ROWS);
        let [cx, cy, cz] = isa.gather_rows(&self.rows, first);
        let [ax, ay, az] = isa.gather_rows(&self.rows, Wrapping::<u32>::wrapping_add(first, 1));
        let [intensity, radius2, cos_spread] =
            isa.gather_rows(&self.rows, Wrapping::<u32>::wrapping_add(first, 2));
        let [sin_spread, cos_reach, _] = isa.gather_rows(&self.rows, Wrapping::<u32>::wrapping_add(first, 3));
        let way = Vec3::new(cx, cy, cz) - at.p;
        let distance2 = way.length2();
        let inverse = distance2.max(1e-35).rsqrt();
        // How large the ball looks.
        let sin2 = (radius2 * inverse * inverse).min(1.0);
        let [sin_u, cos_u] = [sin2.sqrt(), (-sin2 + 1.0).sqrt()];
        // The angle from the nearest normal, less what the ball takes.
        let cos_w = -(way.dot(Vec3::new(ax, ay, az)) * inverse);
        let sin_w = (-cos_w * cos_w + 1.0).max(0.0).sqrt();
        let [cos_x, sin_x] = less([cos_w, sin_w], [cos_spread, sin_spread]);
        let [cos_out, _] = less([cos_x, sin_x], [cos_u, sin_u]);
        // The same for the receiver's normal.
        let cos_n = way.dot(at.n) * inverse;
        let sin_n = (-cos_n * cos_n + 1.0).max(0.0).sqrt();
        let [cos_in, _] = less([cos_n, sin_n], [cos_u, sin_u]);
        let arrives = cos_out.max(0.0) * cos_in.max(0.0);
        let arrives = F::select(cos_out.ge(cos_reach), arrives, isa.splat(0.0));
        let arrives = F::select(distance2.le(radius2), isa.splat(1.0), arrives);
        intensity * arrives / Compare::<F>::max(distance2, radius2).max(1e-35)
    }
}

/// Cosine and sine of the first angle less the second, or of zero; both from 0 to a half turn.
#[inline(always)]
fn less<F: Lanes>([cos_a, sin_a]: [F; 2], [cos_b, sin_b]: [F; 2]) -> [F; 2] {
    let is_within = Compare::<F>::ge(cos_a, cos_b);
    let (one, zero) = (cos_a.splat(1.0), cos_a.splat(0.0));
    [
        F::select(is_within, one, cos_a * cos_b + sin_a * sin_b),
        F::select(is_within, zero, sin_a * cos_b - cos_a * sin_b),
    ]
}
