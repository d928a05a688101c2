//! Pictures and numbers by other renderers.
//!
//! ```text
//! cargo test --test agreement                          # minutes of CPU, all that is asserted
//! SPECULA_RECORD=1 cargo test --test agreement  # four times the samples, and the tables of
//!                                               # benches/record/peers_agreement.md
//! ```
//!
//! Numbers are the same in every run: a test that passes once passes always. Significance is stated where a limit is chosen.

#[path = "../support/data.rs"]
mod data;
#[path = "../support/mitsuba.rs"]
mod mitsuba;
#[path = "../support/peers.rs"]
mod peers;
#[path = "../support/scene.rs"]
mod scene;
#[path = "../support/shots.rs"]
mod shots;
#[path = "../support/statistics.rs"]
mod statistics;

mod nori;
mod peer_scenes;
mod plates;
mod rooms;
mod table;
mod z_tests;
