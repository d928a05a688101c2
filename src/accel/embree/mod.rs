//! Embree 4 behind safe types.
//!
//! A [`Device`] makes everything else; a [`Geometry`] owns or shares the arrays that Embree keeps pointers to; a
//! `Scene<Open>` takes geometries and becomes, by [`Scene::commit`], a `Scene<Committed>` that answers queries and
//! cannot change. [`EmbreeAccel`] builds a committed scene from a [`crate::geometry::World`].
//!
//! Meshes and instances move between up to 129 keys; masks choose who sees what. Shapes that find their own hits and
//! filters are called back from the threads that trace rays; what they panic with comes out of the query (`guard`).
//!
//! What is assumed: the layouts asserted in `embree4-sys`, and what Embree's manual promises, quoted where it is
//! relied on. Limits: one level of instancing; boxes of surfaces hold for the whole shutter, and what has no finite box is
//! never hit; widths of packets other than 4, 8 and 16 fall to single rays. Rays that are not sound numbers are kept from
//! Embree: some crash it (`query`).
//!
//! ```
//! use glam::Vec3;
//! use specula::accel::Accel;
//! use specula::accel::embree::{BuildOptions, EmbreeAccel};
//! use specula::geometry::{Ray, Shape, Sphere, World};
//!
//! let mut world = World::default();
//! let ball = world.add_shape(Shape::Sphere(Sphere { center: Vec3::Z * 5.0, radius: 1.0 }));
//! world.place(ball, None);
//! let accel = EmbreeAccel::build(&world, &BuildOptions::default())?;
//! let hit = accel.intersect(&Ray::new(Vec3::ZERO, Vec3::Z)).expect("straight ahead");
//! assert!((hit.t - 4.0).abs() < 1e-5);
//! # Ok::<(), specula::accel::embree::EmbreeError>(())
//! ```

#![expect(unsafe_code, reason = "Embree is a C library")]

mod after;
mod build;
mod device;
mod error;
mod faces;
mod filter;
mod geometry;
mod guard;
mod lanes;
mod mesh;
mod options;
mod query;
mod scene;
mod surface;

pub use build::{BuildOptions, EmbreeAccel};
pub use device::{Config, Device, Isa};
pub use error::EmbreeError;
pub use geometry::Geometry;
pub use mesh::{MeshArrays, Vertices};
pub use options::{Quality, SceneOptions};
pub use scene::{Committed, Open, Scene};
pub use surface::UserShape;
