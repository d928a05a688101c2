//! How far a picture is from what it should be.
//!
//! A [`Pair`] is a picture and its reference, checked to belong together; a [`Comparison`] all there is to say about it:
//! [`Errors`], which are means over its pixels, and [`flip`], what an eye would notice at each. Sums are in double
//! precision and in one order, whatever the threads.

mod comparison;
pub mod difference;
mod error;
pub mod flip;
pub mod magma;
mod pair;

pub use crate::film::RELATIVE_FLOOR;
pub use comparison::Comparison;
pub use error::{Errors, Largest, Metric};
pub use pair::Pair;
