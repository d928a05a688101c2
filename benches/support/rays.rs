//! Recorded rays: those of a camera, the shadow rays from what they hit, and a diffuse bounce from there.

#![allow(dead_code, reason = "each bench uses a part")]

use glam::Vec3;
use specula::accel::{Accel, RayPacket, RayStream};
use specula::geometry::{Interaction, Ray, World};
use specula::sampling::pcg::pcg3d;

/// Rays of one kind, in the forms that queries take.
pub(crate) struct Rays {
    pub(crate) single: Vec<Ray>,
    pub(crate) stream: RayStream,
}

impl Rays {
    fn new(mut single: Vec<Ray>) -> Self {
        // Whole packets of every width: no contestant has a remainder to deal with.
        single.truncate(single.len() / 16 * 16);
        let mut stream = RayStream::default();
        stream.extend(&single);
        Self { single, stream }
    }

    /// The rays in packets of `N`.
    pub(crate) fn packets<const N: usize>(&self) -> Vec<RayPacket<N>> {
        let packet = |rays: &[Ray]| {
            let mut packet = RayPacket::EMPTY;
            rays.iter().enumerate().for_each(|(lane, ray)| packet.set(lane, ray));
            packet
        };
        self.single.chunks_exact(N).map(packet).collect()
    }
}

/// The three kinds of a path's rays.
pub(crate) struct Recorded {
    pub(crate) primary: Rays,
    pub(crate) shadow: Rays,
    pub(crate) diffuse: Rays,
}

/// Pixels along the edge of the picture whose pixels are sampled.
const PICTURE: f32 = 512.0;

/// Sixteen rays, four by four, through each of `tiles` x `tiles` pixels spread over a picture: what a renderer asks for that
/// traces the samples of a pixel together.
pub(crate) fn record(world: &World, accel: &impl Accel, eye: Vec3, at: Vec3, tiles: u32) -> Recorded {
    let bounds = world.bounds();
    let light = bounds.center() + Vec3::new(0.5, 2.0, 0.7) * bounds.radius();
    let forward = (at - eye).normalize();
    let right = forward.cross(Vec3::Y).normalize();
    let up = right.cross(forward);
    // The middle of a pixel, and the place within it.
    let ndc = |pixel: u32, within: u32, jitter: f32| {
        let middle = (pixel as f32 + 0.5) / tiles as f32;
        let inside = (within as f32 + jitter) / 4.0 - 0.5;
        (middle + inside / PICTURE) * 2.0 - 1.0
    };
    let (mut primary, mut shadow, mut diffuse) = (Vec::new(), Vec::new(), Vec::new());
    for index in 0..16 * tiles * tiles {
        let (pixel, within) = (index / 16, index % 16);
        let [a, b, c] = random(index, 0);
        let (x, y) = (ndc(pixel % tiles, within % 4, a), ndc(pixel / tiles, within / 4, b));
        let ray = Ray::new(eye, forward + (right * x - up * y) * 0.4);
        primary.push(ray);
        let Some(hit) = accel.intersect(&ray) else { continue };
        let point = world.interaction(&ray, &hit);
        let [d, e, f] = random(index, 1);
        shadow.push(point.spawn_to(light + Vec3::new(c, d, e) * 0.1 * bounds.radius()));
        diffuse.push(bounce(&point, [e, f]));
    }
    Recorded { primary: Rays::new(primary), shadow: Rays::new(shadow), diffuse: Rays::new(diffuse) }
}

/// A ray off the surface, on the side it was seen from, distributed by the cosine (Malley's method).
fn bounce(point: &Interaction, [u, v]: [f32; 2]) -> Ray {
    let n = if point.is_front() { point.ng } else { -point.ng };
    let (x, y) = n.any_orthonormal_pair();
    let (r, phi) = (u.sqrt(), v * std::f32::consts::TAU);
    point.spawn(x * (r * phi.cos()) + y * (r * phi.sin()) + n * (1.0 - u).sqrt())
}

/// Three numbers in [0, 1).
fn random(index: u32, use_: u32) -> [f32; 3] {
    pcg3d([index, use_, 17]).map(|h| (h >> 8) as f32 / 16_777_216.0)
}
