//! Specula: an offline ray tracer for shiny things, on Embree 4.

// Floors, lowest first: a module may use itself and those above it in this list, never one below.
pub mod accel;
pub mod bsdf;
pub mod camera;
pub mod cli;
pub mod error;
pub mod film;
pub mod geometry;
pub mod image;
pub mod integrator;
pub mod light;
pub mod material;
pub mod math;
pub mod render;
pub mod sampling;
pub mod scene;
pub mod texture;
