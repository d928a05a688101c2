//! Filters over pictures of geometry.
//!
//! The one there is makes fuzzy reflections of sharp ones (Kulikova and Dmitriev, fuzzy reflections by two-pass rendering): pass one, which
//! is rendering, traces ideal mirrors and keeps where their rays go, pixel by pixel ([`GBuffer`]); pass two, here, averages what
//! neighbouring pixels mirror with the weights of a glossy lobe. It knows pictures and numbers only, so that a saved first pass can be
//! filtered again.
//!
//! ```text
//! for every pixel that shows a reflector at a, whose mirror ray ends at b:
//!     how many pixels its lobe covers follows from the lobe's width, the camera and a, b
//!     for every pixel of the same reflector in that window, whose mirror ray ends at b':
//!         f = weight of the angle at a between b and b'
//!     the reflection is the mean of what those pixels mirror, by f
//! ```
//!
//! What it is right about and what not stands in `benches/record/fuzzy.md`.

mod field;
mod filter;
mod gather;
mod gbuffer;
mod half;
mod layers;
mod lobe;
mod pyramid;
mod reach;
mod settings;

pub use filter::{Filtered, filter, margin};
pub use gbuffer::{End, GBuffer, Mirror, Rgb3, Texel};
pub use layers::{Saved, layers, saved};
pub use lobe::{Lobe, exponent_of_roughness};
pub use settings::{Correction, Fuzzy, Radius, Rejection, Shape, Speed, Weighting};
