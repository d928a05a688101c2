//! The rays that a picture of a scene asks for, class by class.
//!
//! Camera samples are taken as a renderer does that traces the samples of a pixel together: sixteen in turn, four by four,
//! through each of many pixels spread over the picture. What a sample sees sends one shadow ray towards one of the lights,
//! one mirrored ray, and a chain of diffuse bounces, on the side it was seen from. Materials are not asked: a backend does not know them, and so every scene has every
//! class. Rounds of other samples follow until each class has its rays.
//!
//! Numbers come from hashes of sample and purpose. So rays depend on the scene, on what is hit and on how many are wanted,
//! not on threads or on which classes are chosen; a shorter recording is the beginning of a longer one but for primary rays and
//! what follows from them, which are spread over the picture according to their number.

use super::rays::{Class, RaySet};
use crate::accel::Accel;
use crate::camera::Camera;
use crate::geometry::{Interaction, Ray, World};
use crate::light::{Light, Reference};
use crate::math::{Frame, Vec3};
use crate::sampling::pcg::pcg3d;
use crate::sampling::warp;
use crate::scene::Scene;

/// What rays are recorded from.
#[derive(Clone, Copy, Debug)]
pub struct Stand<'a> {
    /// What they meet; rays are counted from where it is.
    pub world: &'a World,
    /// Where they come from.
    pub camera: &'a Camera,
    /// Columns and rows of the picture.
    pub size: [u32; 2],
    /// Where shadow rays go.
    pub lights: &'a [Light],
    /// Whether moments of the shutter differ.
    pub moves: bool,
}

impl<'a> Stand<'a> {
    /// A scene's own camera and lights.
    #[must_use]
    pub fn of(scene: &'a Scene) -> Self {
        Self {
            world: &scene.world,
            camera: &scene.camera,
            size: [scene.film.width, scene.film.height],
            lights: &scene.lights,
            moves: scene.is_moving(),
        }
    }
}

/// Camera samples of one pixel, in turn.
const PER_PIXEL: u32 = 16;

/// Rounds over the picture after which classes that few samples reach stay short.
const MOST_ROUNDS: u32 = 64;

/// At most `count` rays of each class asked for, in the order of the classes; whole packets of sixteen. `accel` finds what is
/// hit on the way. Classes without rays are left out: shadow rays without lights, diffuse ones where nothing is seen.
#[must_use]
pub fn record(stand: &Stand<'_>, accel: &impl Accel, classes: &[Class], count: usize) -> Vec<RaySet> {
    let count = count.next_multiple_of(PER_PIXEL as usize);
    let mut recorder =
        Recorder { stand, accel, count, sets: classes.iter().map(|&c| (c, Vec::new())).collect() };
    let picture = Picture::new(stand.size, count);
    for round in 0..MOST_ROUNDS {
        if recorder.is_full() {
            break;
        }
        for index in 0..picture.samples() {
            recorder.sample(&picture, round, index);
        }
    }
    recorder.finish()
}

/// Pixels spread over a picture, in rows of as many as come out evenly.
struct Picture {
    size: [f32; 2],
    pixels: u32,
    rows: u32,
}

#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    clippy::cast_precision_loss,
    reason = "pixels"
)]
impl Picture {
    fn new([width, height]: [u32; 2], count: usize) -> Self {
        let pixels = (count as u32 / PER_PIXEL).max(1);
        let rows = (pixels as f32 * height as f32 / width as f32).sqrt().round() as u32;
        Self { size: [width as f32, height as f32], pixels, rows: rows.clamp(1, pixels) }
    }

    /// How many samples one round takes.
    fn samples(&self) -> u32 {
        self.pixels * PER_PIXEL
    }

    /// The place of a pixel in its row, the length of that row; the row, the number of rows.
    fn cell(&self, pixel: u32) -> [[u32; 2]; 2] {
        let [pixels, rows] = [self.pixels, self.rows].map(u64::from);
        // The first pixel of a row; 2^24 pixels in as many rows fit.
        let first = |row: u64| (row * pixels).div_ceil(rows);
        let row = u64::from(pixel) * rows / pixels;
        let start = first(row);
        [[pixel - start as u32, (first(row + 1) - start) as u32], [row as u32, self.rows]]
    }

    /// Where a sample falls: four by four strata of a pixel, the middle one of its cell at first, another one in later rounds.
    fn film(&self, round: u32, index: u32) -> [f32; 2] {
        let (pixel, within) = (index / PER_PIXEL, index % PER_PIXEL);
        let shift = if round == 0 { [0.5; 2] } else { uniform(round, pixel, Purpose::Pixel).1 };
        let jitter = uniform(round, index, Purpose::Film).1;
        let strata = [within % 4, within / 4];
        let cells = self.cell(pixel);
        std::array::from_fn(|axis| {
            let [at, of] = cells[axis].map(|n| n as f32);
            let middle = (at + shift[axis]) / of * self.size[axis];
            let inside = (strata[axis] as f32 + jitter[axis]) / 4.0 - 0.5;
            (middle + inside).clamp(0.0, self.size[axis])
        })
    }
}

/// What random numbers are for.
#[derive(Clone, Copy)]
enum Purpose {
    Pixel,
    Film,
    Lens,
    Light,
    Bounce(u8),
    From,
    To,
}

/// Three numbers in [0, 1), one and two.
#[expect(clippy::cast_precision_loss, reason = "24 bits")]
fn uniform(round: u32, index: u32, purpose: Purpose) -> (f32, [f32; 2]) {
    let purpose = match purpose {
        Purpose::Pixel => 0,
        Purpose::Film => 1,
        Purpose::Lens => 2,
        Purpose::Light => 3,
        Purpose::From => 4,
        Purpose::To => 5,
        Purpose::Bounce(depth) => 8 + u32::from(depth),
    };
    let [a, b, c] = pcg3d([index, purpose, round]).map(|h| (h >> 8) as f32 / 16_777_216.0);
    (a, [b, c])
}

struct Recorder<'a, A> {
    stand: &'a Stand<'a>,
    accel: &'a A,
    count: usize,
    sets: Vec<(Class, Vec<Ray>)>,
}

impl<A: Accel> Recorder<'_, A> {
    fn is_full(&self) -> bool {
        let reachable = |class| class != Class::Shadow || !self.stand.lights.is_empty();
        // Primary rays are those of the first round, however many that are.
        let open = |class| !matches!(class, Class::Primary | Class::Random) && reachable(class);
        let has_begun = self.sets.iter().any(|(_, rays)| !rays.is_empty());
        has_begun && self.sets.iter().all(|(class, rays)| !open(*class) || rays.len() >= self.count)
    }

    fn keep(&mut self, class: Class, ray: Ray) {
        let set = self.sets.iter_mut().find(|(kept, _)| *kept == class);
        if let Some((_, rays)) = set.filter(|(_, rays)| rays.len() < self.count && ray.is_traceable()) {
            rays.push(ray);
        }
    }

    fn sample(&mut self, picture: &Picture, round: u32, index: u32) {
        let (time, lens) = uniform(round, index, Purpose::Lens);
        let time = if self.stand.moves { time } else { 0.0 };
        let ray = self.stand.camera.ray(picture.film(round, index), lens, time);
        if round == 0 {
            self.keep(Class::Primary, ray);
        }
        self.random(round, index, time);
        let Some(it) = self.met(&ray) else { return };
        if let Some(shadow) = self.shadow(&it, round, index) {
            self.keep(Class::Shadow, shadow);
        }
        self.keep(Class::Specular, mirrored(&it));
        let mut it = it;
        for depth in 1..=4 {
            let ray = bounced(&it, uniform(round, index, Purpose::Bounce(depth)).1);
            self.keep(Class::Diffuse(depth), ray);
            let Some(next) = self.met(&ray) else { return };
            it = next;
        }
    }

    fn met(&self, ray: &Ray) -> Option<Interaction> {
        self.accel.intersect(ray).map(|hit| self.stand.world.interaction(ray, &hit))
    }

    /// Between two points of the box.
    fn random(&mut self, round: u32, index: u32, time: f32) {
        let bounds = self.accel.bounds();
        if bounds.is_empty() {
            return;
        }
        let point = |purpose| {
            let (x, [y, z]) = uniform(round, index, purpose);
            bounds.min + bounds.size() * glam::Vec3::new(x, y, z)
        };
        let (o, to) = (point(Purpose::From), point(Purpose::To));
        self.keep(Class::Random, Ray::new(o, to - o).until(1.0).at_time(time));
    }

    /// Towards a light that shines on the side that is seen.
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        clippy::cast_precision_loss,
        reason = "a choice among fewer than 2^24 lights"
    )]
    fn shadow(&self, it: &Interaction, round: u32, index: u32) -> Option<Ray> {
        let lights = self.stand.lights;
        let (choice, u2) = uniform(round, index, Purpose::Light);
        let light = lights.get((choice * lights.len() as f32) as usize)?;
        let n = seen(it, it.ns);
        let sample = light.sample(Reference { p: it.p.into(), n: n.into() }, u2);
        let wi: glam::Vec3 = sample.wi.into();
        if !sample.valid || wi.dot(n) <= 0.0 {
            return None;
        }
        Some(if light.is_infinite() { it.spawn(wi) } else { it.spawn_to(sample.p.into()) })
    }

    fn finish(self) -> Vec<RaySet> {
        let whole = |mut rays: Vec<Ray>| {
            // Whole packets of every width: no contestant has a remainder to deal with.
            rays.truncate(rays.len() / PER_PIXEL as usize * PER_PIXEL as usize);
            rays
        };
        let sets = self
            .sets
            .into_iter()
            .map(|(class, rays)| RaySet { name: class.word().to_owned(), rays: whole(rays) });
        sets.filter(|set| !set.rays.is_empty()).collect()
    }
}

/// A normal on the side that is seen.
fn seen(it: &Interaction, n: glam::Vec3) -> glam::Vec3 {
    if it.is_front() { n } else { -n }
}

/// Mirrored at the shading normal, or at the geometric one where that would lead into the surface.
fn mirrored(it: &Interaction) -> Ray {
    let wo: Vec3<f32> = it.wo.into();
    let d: glam::Vec3 = wo.reflect(it.ns.into()).into();
    let is_out = d.dot(it.ng) * it.wo.dot(it.ng) > 0.0;
    it.spawn(if is_out { d } else { wo.reflect(it.ng.into()).into() })
}

/// Distributed by the cosine about the geometric normal.
fn bounced(it: &Interaction, u2: [f32; 2]) -> Ray {
    let frame = Frame::about(seen(it, it.ng).into());
    it.spawn(frame.to_world(warp::cosine_hemisphere(u2)).into())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::accel::Brute;
    use crate::camera::Pinhole;
    use crate::geometry::{Shape, Sphere};
    use crate::light::SphereLight;
    use crate::math::Rgb;
    use std::sync::Arc;

    fn sets(classes: &[Class], count: usize) -> Vec<RaySet> {
        let mut world = World::default();
        for (center, radius) in [(glam::Vec3::ZERO, 1.0), (glam::Vec3::X * 2.0, 1.0), (glam::Vec3::ZERO, 9.0)]
        {
            let ball = world.add_shape(Shape::Sphere(Sphere { center, radius }));
            world.place(ball, None);
        }
        let brute = Brute::new(Arc::new(world.clone()));
        let camera =
            Pinhole::new([glam::Vec3::Z * 4.0, glam::Vec3::ZERO, glam::Vec3::Y], 0.8, [30, 20]).into();
        let center = Vec3::new(0.0, 5.0, 2.0);
        let lights =
            [Light::Sphere(SphereLight { center, radius: 0.5, radiance: Rgb::WHITE, two_sided: false })];
        let stand = Stand { world: &world, camera: &camera, size: [30, 20], lights: &lights, moves: false };
        record(&stand, &brute, classes, count)
    }

    #[test]
    fn every_class_has_whole_packets_of_its_own_kind() {
        let sets = sets(&Class::ALL, 64);
        let names: Vec<&str> = sets.iter().map(|set| set.name.as_str()).collect();
        assert_eq!(names, Class::ALL.map(Class::word), "names");
        for RaySet { name, rays } in &sets {
            assert!(
                rays.len().is_multiple_of(16) && !rays.is_empty() && rays.len() <= 64,
                "{name}: {}",
                rays.len()
            );
            assert!(rays.iter().all(Ray::is_traceable), "{name}");
        }
        let is_on_ball = |p: glam::Vec3| {
            let off = [p.length() - 1.0, p.distance(glam::Vec3::X * 2.0) - 1.0, p.length() - 9.0];
            off.iter().any(|off| off.abs() < 1e-4)
        };
        for set in &sets[1..7] {
            assert!(set.rays.iter().all(|ray| is_on_ball(ray.o)), "{} rays leave a ball", set.name);
        }
        assert!(sets[0].rays.iter().all(|ray| ray.o == glam::Vec3::Z * 4.0), "from the camera");
        let light = glam::Vec3::new(0.0, 5.0, 2.0);
        assert!(sets[1].rays.iter().all(|ray| (ray.at(1.0) - light).length() < 0.51), "to the light");
    }

    #[test]
    fn pixels_are_spread_evenly_whatever_their_number() {
        for (size, count) in [([30, 20], 64), ([1280, 720], 4096), ([3, 700], 1008), ([9, 9], 16)] {
            let picture = Picture::new(size, count);
            assert_eq!(picture.samples() as usize, count, "{size:?}");
            let cells: Vec<_> = (0..picture.pixels).map(|pixel| picture.cell(pixel)).collect();
            let lengths: Vec<u32> = cells.iter().map(|[[_, length], _]| *length).collect();
            assert!(
                lengths.iter().max() <= lengths.iter().min().map(|n| n + 1).as_ref(),
                "{size:?}: {lengths:?}"
            );
            for pair in cells.windows(2) {
                let [[[a, of], [row, _]], [[b, _], [next, _]]] = [pair[0], pair[1]];
                let follows = if a + 1 < of { (b, next) == (a + 1, row) } else { (b, next) == (0, row + 1) };
                assert!(follows, "{size:?}: {pair:?}");
            }
        }
    }

    #[test]
    fn a_choice_of_classes_does_not_change_their_rays() {
        let all = sets(&Class::ALL, 64);
        let chosen = sets(&[Class::Diffuse(2), Class::Shadow], 64);
        assert_eq!(chosen[0], all[4], "diffuse2");
        assert_eq!(chosen[1], all[1], "shadow");
    }
}
