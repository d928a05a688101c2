//! Specula: an offline ray tracer for shiny things, on Embree 4.

// Floors, lowest first: a module may use itself and those above it in this list, never one below.
pub mod math;
pub mod error;
pub mod image;
pub mod sampling;
pub mod geometry;
pub mod accel;
pub mod texture;
pub mod bsdf;
pub mod material;
pub mod light;
pub mod camera;
pub mod film;
pub mod scene;
pub mod integrator;
pub mod render;
pub mod cli;
