//! Names for every use of randomness.
//!
//! Numbers are asked for by purpose, not taken from a stream: a scene that lacks a lens or a light skips the dimension
//! without moving the others. A purpose recurs at every node of a path or ray tree; [`Vertex`] tells them apart.

use super::hash;

/// What a random number is for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Dim {
    /// Where in the pixel's filter: two numbers.
    Film,
    /// Where on the lens: two numbers.
    Lens,
    /// When while the shutter is open: one number.
    Time,
    /// Which light, where one is chosen among many: one number.
    LightChoice,
    /// Where on the light with this index: two numbers. A light chosen by [`Dim::LightChoice`] uses index 0.
    LightPoint(u32),
    /// Which lobe of a BSDF: one number.
    LobeChoice,
    /// The direction within a lobe: two numbers.
    LobeDirection,
    /// Whether a path goes on: one number.
    Roulette,
}

impl Dim {
    /// A number of its own for each dimension.
    #[inline(always)]
    const fn code(self) -> u32 {
        match self {
            Self::Film => 1,
            Self::Lens => 2,
            Self::Time => 3,
            Self::LightChoice => 4,
            Self::LobeChoice => 5,
            Self::LobeDirection => 6,
            Self::Roulette => 7,
            Self::LightPoint(light) => light.wrapping_add(8),
        }
    }

    /// Random bits for a dimension at a vertex, the same in all pixels. Costs nothing where both are known.
    #[inline(always)]
    pub(super) fn salt(self, vertex: Vertex) -> u32 {
        hash::mix(self.code()) ^ vertex.0
    }
}

/// Which node of a path or ray tree: the camera's is [`Vertex::ROOT`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Vertex(u32);

impl Vertex {
    /// The camera: film, lens and time belong to it.
    pub const ROOT: Self = Self(0);

    /// Branch `k` below this node. A path has one branch, 0; a tree numbers its branches by purpose (say 0 reflection,
    /// 1 transmission), so that a pruned one does not move the others.
    ///
    /// Siblings differ always; other nodes of one tree with n nodes all differ with probability 1 - n^2 / 2^33.
    #[inline(always)]
    #[must_use]
    pub fn child(self, k: u32) -> Self {
        Self(hash::combine(self.0, k))
    }

    /// The number that stands for this node.
    #[inline(always)]
    pub const fn id(self) -> u32 {
        self.0
    }
}

#[cfg(test)]
mod tests {
    use std::collections::HashSet;

    use super::*;

    #[test]
    fn dimensions_have_codes_of_their_own() {
        let mut all =
            vec![Dim::Film, Dim::Lens, Dim::Time, Dim::LightChoice, Dim::LobeChoice, Dim::LobeDirection];
        all.push(Dim::Roulette);
        all.extend((0..1000).map(Dim::LightPoint));
        let codes: HashSet<_> = all.iter().map(|dim| dim.code()).collect();
        assert_eq!(codes.len(), all.len(), "codes");
        let salts: HashSet<_> = all.iter().map(|dim| dim.salt(Vertex::ROOT)).collect();
        assert_eq!(salts.len(), all.len(), "salts");
    }

    #[test]
    fn nodes_of_a_binary_tree_differ() {
        let mut level = vec![Vertex::ROOT];
        let mut seen = HashSet::from([Vertex::ROOT]);
        for depth in 0..12 {
            level = level.iter().flat_map(|v| [v.child(0), v.child(1)]).collect();
            seen.extend(&level);
            assert_eq!(seen.len(), (2 << (depth + 1)) - 1, "all nodes down to level {}", depth + 1);
        }
    }
}
