//! Recorded rays on a world that no scene file describes: those of a camera, the shadow rays from what they hit, and a diffuse
//! bounce from there, as `specula bench` records them.

#![allow(dead_code, reason = "each bench uses a part")]

use glam::Vec3;
use specula::accel::{Accel, RayPacket, RayStream};
use specula::bench::record::{Stand, record as recorded};
use specula::bench::{Class, RaySet};
use specula::camera::{Camera, Pinhole};
use specula::geometry::{Ray, World};
use specula::light::{Light, SphereLight};
use specula::math::Rgb;

/// Rays of one kind, in the forms that queries take.
pub(crate) struct Rays {
    pub(crate) single: Vec<Ray>,
    pub(crate) stream: RayStream,
}

impl Rays {
    fn new(set: RaySet) -> Self {
        let stream = set.stream();
        Self { single: set.rays, stream }
    }

    /// The rays in packets of `N`.
    pub(crate) fn packets<const N: usize>(&self) -> Vec<RayPacket<N>> {
        RaySet { name: String::new(), rays: self.single.clone() }.packets()
    }
}

/// The three kinds of a path's rays.
pub(crate) struct Recorded {
    pub(crate) primary: Rays,
    pub(crate) shadow: Rays,
    pub(crate) diffuse: Rays,
}

/// Sixteen rays through each of `tiles` x `tiles` pixels spread over a picture, towards a lamp beside the world, and away.
pub(crate) fn record(world: &World, accel: &impl Accel, eye: Vec3, at: Vec3, tiles: u32) -> Recorded {
    let bounds = world.bounds();
    let center = bounds.center() + Vec3::new(0.5, 2.0, 0.7) * bounds.radius();
    let lamp = SphereLight {
        center: center.into(),
        radius: 0.1 * bounds.radius(),
        radiance: Rgb::WHITE,
        two_sided: false,
    };
    let size = [512, 512];
    let camera: Camera = Pinhole::new([eye, at, Vec3::Y], 2.0 * 0.4_f32.atan(), size).into();
    let lights = [Light::Sphere(lamp)];
    let stand = Stand { world, camera: &camera, size, lights: &lights, moves: false };
    let classes = [Class::Primary, Class::Shadow, Class::Diffuse(1)];
    let mut sets = recorded(&stand, accel, &classes, 16 * (tiles * tiles) as usize).into_iter();
    let mut next = || Rays::new(sets.next().expect("the camera sees the world, and it the lamp"));
    Recorded { primary: next(), shadow: next(), diffuse: next() }
}
