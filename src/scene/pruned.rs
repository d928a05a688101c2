//! What a scene describes to no effect, and what is left out or shared therefore.

use crate::error::Place;
use std::fmt;

/// A kind of thing without effect.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Ineffective {
    /// Objects that nobody can see.
    Object,
    /// Lights without power.
    Light,
    /// Lobes and parts of mixes of weight zero.
    Lobe,
    /// Pictures and patterns that are of one colour, or of no relief.
    Texture,
    /// Meshes that are there already.
    Mesh,
    /// Materials that nothing is made of.
    Material,
}

impl Ineffective {
    /// All of them.
    pub const ALL: [Self; 6] =
        [Self::Object, Self::Light, Self::Lobe, Self::Texture, Self::Mesh, Self::Material];

    /// The words for one and for several.
    #[must_use]
    pub fn words(self) -> [&'static str; 2] {
        match self {
            Self::Object => ["invisible object", "invisible objects"],
            Self::Light => ["light without power", "lights without power"],
            Self::Lobe => ["lobe of weight zero", "lobes of weight zero"],
            Self::Texture => ["constant texture", "constant textures"],
            Self::Mesh => ["duplicate mesh", "duplicate meshes"],
            Self::Material => ["unreferenced material", "unreferenced materials"],
        }
    }
}

/// Something that was left out, or shared.
#[derive(Clone, Debug, PartialEq)]
pub struct Pruned {
    /// What it is.
    pub kind: Ineffective,
    /// Which one, and what became of it.
    pub what: String,
    /// Where it was described.
    pub place: Option<Place>,
    /// Bytes that this saved.
    pub bytes: usize,
}

impl fmt::Display for Pruned {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if let Some(place) = &self.place {
            write!(f, "{place}: ")?;
        }
        write!(f, "{}: {}", self.kind.words()[0], self.what)
    }
}

/// How many there are of each kind, in words; `None` where there is none.
#[must_use]
pub fn summary(pruned: &[Pruned]) -> Option<String> {
    let counted = Ineffective::ALL.into_iter().filter_map(|kind| {
        let count = pruned.iter().filter(|it| it.kind == kind).count();
        let [one, several] = kind.words();
        (count > 0).then(|| format!("{count} {}", if count == 1 { one } else { several }))
    });
    let counted: Vec<String> = counted.collect();
    (!counted.is_empty()).then(|| counted.join(", "))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_summary_counts_by_kind() {
        let of = |kind| Pruned { kind, what: "x".to_owned(), place: None, bytes: 0 };
        assert_eq!(summary(&[]), None, "nothing");
        let told = summary(&[of(Ineffective::Lobe), of(Ineffective::Object), of(Ineffective::Lobe)]);
        assert_eq!(told.as_deref(), Some("1 invisible object, 2 lobes of weight zero"), "in their order");
    }
}
