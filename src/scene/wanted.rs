//! What a scene is frozen for.

use crate::film::{Aov, Layout};
use crate::scene::needs::capability::Capabilities;

/// What is wanted of a scene beside what it describes.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Wanted {
    /// What is kept of samples: what nobody reads need not be there.
    pub layout: Layout,
    /// Whether samples are taken where they bring most.
    pub adaptive: bool,
    /// What is switched on although nothing asks for it. Pictures are the same to rounding, slower: for measuring what leaving things
    /// out brings.
    pub forced: Capabilities,
    /// Whether what has no effect is left out.
    pub prunes: bool,
}

impl Wanted {
    /// A picture with these outputs, and nothing that it does not need.
    #[must_use]
    pub fn picture(layout: Layout) -> Self {
        Self { layout, adaptive: false, forced: Capabilities::NONE, prunes: true }
    }

    /// Whatever may be asked of the scene later: all that its files hold is kept.
    #[must_use]
    pub fn anything() -> Self {
        Self { prunes: false, ..Self::picture(Layout::with(Aov::ALL)) }
    }

    /// The same with everything that can be switched on, and with what has no effect.
    #[must_use]
    pub fn unspecialised(self) -> Self {
        Self { forced: Capabilities::forceable(), prunes: false, ..self }
    }
}

impl Default for Wanted {
    fn default() -> Self {
        Self::picture(Layout::default())
    }
}
