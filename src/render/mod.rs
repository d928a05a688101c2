//! Tiles, threads and dispatch.
//!
//! A picture depends on scene, pixel and sample index only, not on threads, tiles or crops: each pixel has one owner and
//! its samples one order.

mod adaptive;
mod allocation;
mod course;
mod dispatch;
mod eye;
mod job;
mod limits;
mod noise;
mod query;
mod samples;
mod schedule;
mod tiles;
mod two_pass;

pub use dispatch::{MOST, render, render_on};
pub use job::{Phase, Progress, Rendered, Settings, Silent, Statistics};
pub use limits::{Ended, Estimate, Limits};
pub use query::{Chosen, query};
pub use two_pass::filter_of;
