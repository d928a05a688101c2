//! From samples to pixels.
//!
//! Every sample belongs to one pixel: the filter decides where about the pixel it is taken, not which pixels it is spread
//! over. So a pixel has one owner, its sums one order, and a picture does not depend on tiles or threads.
//! Ernst, Stamminger, Greiner, 2006, "Filter importance sampling".

mod adding;
mod aov;
mod arrays;
pub mod cryptomatte;
mod filter;
mod shares;
mod statistics;
mod sums;
mod tile;

pub use aov::{Aov, Layout};
pub use arrays::{Number, read_numbers, write_numbers};
pub use filter::{Filter, FilterSample, FilterShape};
pub use shares::Seen;
pub use statistics::{NonFinite, SampleId};
pub use sums::{Film, Names, Precision};
pub use tile::Tile;

/// What keeps relMSE finite on black: added to the square of the reference. Rousselle, Knaus, Zwicker, 2011, "Adaptive
/// sampling and reconstruction using greedy error minimization", and most since.
pub const RELATIVE_FLOOR: f64 = 1e-2;
