//! Tiles, threads and dispatch.
//!
//! A picture depends on scene, pixel and sample index only, not on threads, tiles or crops: each pixel has one owner and
//! its samples one order.

mod adaptive;
mod allocation;
mod archive;
mod course;
mod dispatch;
mod eye;
mod halves;
mod hierarchies;
mod job;
mod keeping;
mod limits;
mod merge;
mod noise;
mod part;
mod query;
mod samples;
mod schedule;
mod slice;
mod state;
mod studio;
mod tiles;
mod two_pass;

pub use dispatch::{MOST, outline};
pub use hierarchies::{backend, backends};
pub use job::{Phase, Progress, Rendered, Settings, Silent, Statistics};
pub use limits::{Ended, Estimate, Limits};
pub use merge::{Gap, gaps, order, wanted};
pub use part::{Outline, Part, PartFile};
pub use query::{Chosen, lanes, level, query, shading};
pub use slice::Slice;
pub use state::{Checkpoint, Keeper, State};
pub use studio::{Begin, Kept, Studio, render, render_kept, render_on};
pub use two_pass::filter_of;
