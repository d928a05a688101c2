//! Which media a ray is inside of.
//!
//! Bodies may overlap: water poured into a glass is modelled a little larger than the hollow it fills. Where they do, the
//! medium of the highest priority is there, and surfaces of the others are not seen (Schmidt and Budge 2002, Simple
//! Nested Dielectrics in Ray Traced Images). Among equals the one entered last counts.

use crate::material::{MaterialId, Medium};

/// Surfaces that are not seen which a ray may pass in a row; more are a broken scene, and the ray ends.
pub const MOST_HIDDEN: u32 = 256;

/// Most bodies that a point can be inside of at once; deeper ones are forgotten.
const DEEPEST: usize = 8;

/// The bodies around a point, in the order they were entered.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Media {
    /// The rest are `NONE`.
    entered: [Entry; DEEPEST],
    count: u8,
    /// Which of them counts: the last one of the highest priority.
    top: u8,
}

#[derive(Clone, Copy, Debug, PartialEq)]
struct Entry {
    id: MaterialId,
    ior: f32,
    priority: i32,
}

const NONE: Entry = Entry { id: MaterialId(0), ior: 1.0, priority: i32::MIN };

impl Default for Media {
    fn default() -> Self {
        Self { entered: [NONE; DEEPEST], count: 0, top: 0 }
    }
}

/// What a surface of a medium means to a ray that meets it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Crossing {
    /// The surface is not seen: something of higher priority is there on both sides, or media of one index, and it is nothing but an
    /// interface.
    Hidden {
        /// What lies behind.
        beyond: Media,
    },
    /// An interface.
    Interface {
        /// Index of refraction behind over that before.
        eta: f32,
        /// What lies behind.
        beyond: Media,
    },
}

impl Media {
    /// Inside of `bodies`, outermost first.
    pub fn inside<'a>(bodies: impl IntoIterator<Item = (MaterialId, &'a Medium)>) -> Self {
        bodies.into_iter().fold(Self::default(), |media, (id, medium)| {
            media.with(Entry { id, ior: medium.ior, priority: medium.priority })
        })
    }

    /// The medium that counts; `None` in the open.
    #[must_use]
    pub fn current(&self) -> Option<MaterialId> {
        self.top().map(|entry| entry.id)
    }

    /// A surface of `medium` is met from outside (`entering`) or from within; whether it is nothing but an interface.
    #[must_use]
    #[expect(clippy::float_cmp, reason = "between equal media nothing is seen and no direction may change")]
    pub fn cross(&self, (id, medium): (MaterialId, &Medium), entering: bool, is_interface: bool) -> Crossing {
        let own = Entry { id, ior: medium.ior, priority: medium.priority };
        let met = |eta: f32, beyond| {
            if is_interface && eta == 1.0 {
                Crossing::Hidden { beyond }
            } else {
                Crossing::Interface { eta, beyond }
            }
        };
        if entering {
            let beyond = self.with(own);
            if beyond.top() != Some(own) {
                return Crossing::Hidden { beyond };
            }
            return met(own.ior / self.ior(), beyond);
        }
        let beyond = self.without(id);
        // Met from within without having been entered: an open or badly wound surface. Believe the surface.
        let counts =
            if self.contains(id) { self.top() == Some(own) } else { beyond.priority() <= own.priority };
        if !counts {
            return Crossing::Hidden { beyond };
        }
        met(beyond.ior() / own.ior, beyond)
    }

    fn priority(&self) -> i32 {
        self.top().map_or(i32::MIN, |entry| entry.priority)
    }

    /// The index of refraction there; 1 in the open.
    #[must_use]
    pub fn ior(&self) -> f32 {
        self.top().map_or(1.0, |entry| entry.ior)
    }

    fn contains(&self, id: MaterialId) -> bool {
        self.entries().any(|entry| entry.id == id)
    }

    fn entries(&self) -> impl DoubleEndedIterator<Item = Entry> + ExactSizeIterator + '_ {
        self.entered[..usize::from(self.count)].iter().copied()
    }

    fn top(&self) -> Option<Entry> {
        (self.count > 0).then(|| self.entered[usize::from(self.top)])
    }

    fn with(mut self, entry: Entry) -> Self {
        if let Some(free) = self.entered.get_mut(usize::from(self.count)) {
            *free = entry;
            if entry.priority >= self.priority() {
                self.top = self.count;
            }
            self.count += 1;
        }
        self
    }

    /// Without the last entry of `id`.
    fn without(self, id: MaterialId) -> Self {
        let Some(last) = self.entries().rposition(|entry| entry.id == id) else { return self };
        let others = self.entries().enumerate().filter(|&(i, _)| i != last);
        others.fold(Self::default(), |left, (_, entry)| left.with(entry))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::Rgb;

    const GLASS: MaterialId = MaterialId(0);
    const WATER: MaterialId = MaterialId(1);

    fn medium(ior: f32, priority: i32) -> Medium {
        Medium { ior, absorption: Rgb::BLACK, priority }
    }

    fn through(media: Media, id: MaterialId, of: &Medium, entering: bool) -> (Option<f32>, Media) {
        match media.cross((id, of), entering, false) {
            Crossing::Hidden { beyond } => (None, beyond),
            Crossing::Interface { eta, beyond } => (Some(eta), beyond),
        }
    }

    #[test]
    fn water_that_overlaps_its_glass_gives_two_interfaces() {
        let (glass, water) = (medium(1.5, 2), medium(1.33, 1));
        let (eta, media) = through(Media::default(), GLASS, &glass, true);
        assert_eq!(eta, Some(1.5), "air to glass");
        let (eta, media) = through(media, WATER, &water, true);
        assert_eq!(eta, None, "the water's surface lies within the glass");
        let (eta, media) = through(media, GLASS, &glass, false);
        assert_eq!(eta, Some(1.33 / 1.5), "glass to water");
        let (eta, media) = through(media, WATER, &water, false);
        assert_eq!(eta, Some(1.0 / 1.33), "water to air");
        assert_eq!(media, Media::default(), "out of everything");
    }

    #[test]
    fn equal_priorities_nest() {
        let (glass, bubble) = (medium(1.5, 0), medium(1.0, 0));
        let (_, media) = through(Media::default(), GLASS, &glass, true);
        let (eta, media) = through(media, WATER, &bubble, true);
        assert_eq!(eta, Some(1.0 / 1.5), "into the bubble");
        let (eta, media) = through(media, WATER, &bubble, false);
        assert_eq!(eta, Some(1.5), "back into the glass");
        assert_eq!(media.current(), Some(GLASS), "glass again");
    }

    #[test]
    fn leaving_what_was_never_entered_is_an_interface() {
        let (eta, media) = through(Media::default(), GLASS, &medium(1.5, 0), false);
        assert_eq!(eta, Some(1.0 / 1.5), "glass to air");
        assert_eq!(media, Media::default(), "still in the open");
    }

    #[test]
    fn more_bodies_than_fit_are_forgotten() {
        let mut media = Media::default();
        for i in 0..20 {
            (_, media) = through(media, MaterialId(i), &medium(1.1, 0), true);
        }
        assert_eq!(media.entries().count(), DEEPEST, "full");
    }
}
