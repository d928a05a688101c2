//! Specula: an offline ray tracer for shiny things, on Embree 4.
//!
//! ```text
//! files --load--> Description --build--> Scene --dispatch--> backend x integrator x sampler
//! for every tile:  Film point -> Camera -> Ray -> Accel -> Hit -> Interaction -> Material -> Bsdf
//!                  Light + Bsdf + Sampler -> Integrator::li -> Tile -> Film -> EXR / PNG
//! ```
//!
//! The modules are floors: each uses itself and lower ones only, in the order given in `ARCHITECTURE.md`. Whoever wants
//! hits and nothing else needs [`geometry`] and [`accel`]:
//!
//! ```
//! use glam::Vec3;
//! use specula::accel::Accel;
//! use specula::accel::embree::{BuildOptions, EmbreeAccel};
//! use specula::geometry::{Ray, Shape, Sphere, World};
//!
//! let mut world = World::default();
//! let ball = world.add_shape(Shape::Sphere(Sphere { center: Vec3::ZERO, radius: 1.0 }));
//! world.place(ball, None);
//! let accel = EmbreeAccel::build(&world, &BuildOptions::default())?;
//!
//! let ray = Ray::new(Vec3::new(0.0, 0.0, 3.0), -Vec3::Z);
//! let hit = accel.intersect(&ray).expect("the ball is in the way");
//! assert!((hit.t - 2.0).abs() < 1e-6);
//! assert!(!accel.occluded(&ray.until(1.9)));
//! # Ok::<(), specula::accel::embree::EmbreeError>(())
//! ```
//!
//! Whoever wants pictures goes on to [`scene::load()`], [`scene::build()`] and [`render::render`]; whoever wants to know
//! how good they are, to [`measure::Comparison`]; whoever chooses a backend, to [`bench::Track`]; whoever chooses settings, to
//! [`tradeoff::runs::Sweep`].

// The document of statistics is one macro call with more keys than the usual depth allows.
#![recursion_limit = "256"]

pub mod accel;
pub mod bench;
pub mod bsdf;
pub mod camera;
pub mod cli;
pub mod display;
pub mod error;
pub mod film;
pub mod geometry;
pub mod image;
pub mod integrator;
pub mod light;
pub mod material;
pub mod math;
pub mod measure;
pub mod post;
pub mod render;
pub mod sampling;
pub mod scene;
pub mod texture;
pub mod tradeoff;
pub mod trust;
