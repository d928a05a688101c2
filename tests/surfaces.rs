//! Cylinders, cones and rings against distance functions in double precision: every crossing of every ray, normals, boxes,
//! volumes and areas.

#![expect(clippy::cast_possible_truncation, reason = "sizes of bodies were single precision once")]

#[path = "support/bodies.rs"]
mod bodies;
#[path = "support/random.rs"]
mod random;

use bodies::{Body, KINDS, body};
use glam::{Affine3A, DVec3, Quat, Vec3};
use random::Random;
use specula::accel::embree::{BuildOptions, EmbreeAccel};
use specula::accel::{Accel, Brute};
use specula::geometry::{Ray, Shape, World, spawn};
use specula::math::Transform;
use std::sync::Arc;

/// Distance, in sizes of the body, up to which a ray that dips in and out again may be answered either way.
const GRAZING: f64 = 1e-12;

/// Ways to meet a body.
const WAYS: [&str; 6] = ["random", "far", "grazing", "along the axis", "across the axis", "from inside"];

fn ray_to(rng: &mut Random, body: &Body, way: usize) -> Ray {
    let size = body.size();
    let within = |rng: &mut Random| {
        body.center + Vec3::from(rng.direction()).as_dvec3() * size * f64::from(rng.unit())
    };
    let direction = |rng: &mut Random| Vec3::from(rng.direction()).as_dvec3();
    let (from, to) = match way {
        0 => (body.center + direction(rng) * size * 3.0, within(rng)),
        1 => (body.center + direction(rng) * size * f64::from(rng.logarithmic(1e4, 1e6)), within(rng)),
        2 => grazing(rng, body),
        3 => {
            let foot = within(rng);
            let foot = if rng.unit() < 0.1 { body.center } else { foot };
            (foot - body.axis * size * 3.0, foot + body.axis * size * 3.0)
        }
        4 => {
            let across = body.axis.cross(direction(rng)).normalize();
            let height = body.axis * size * f64::from(rng.unit() - 0.5);
            (body.center + height - across * size * 2.0, body.center + height + across * size)
        }
        _ => (within(rng), within(rng)),
    };
    let d = (to - from).normalize() * f64::from(rng.logarithmic(1e-3, 1e3));
    Ray::new(from.as_vec3(), d.as_vec3())
}

/// Past a point of the surface along a tangent, a little inside or outside.
fn grazing(rng: &mut Random, body: &Body) -> (DVec3, DVec3) {
    let target = Vec3::from(rng.direction()).as_dvec3() * body.size() * f64::from(rng.unit());
    let o = body.center + Vec3::from(rng.direction()).as_dvec3() * body.size() * 3.0;
    let ray = Ray::new(o.as_vec3(), (body.center + target - o).as_vec3());
    let Some(hit) = body.surface.intersect(0, &ray) else { return (o, body.center) };
    let point = body.surface.point(0, &ray, &hit);
    let n = point.ng.as_dvec3();
    let depth = f64::from(rng.logarithmic(1e-9, 1e-2)) * if rng.unit() < 0.5 { 1.0 } else { -1.0 };
    let p = point.p.as_dvec3() + n * body.size() * depth;
    let along = n.cross(Vec3::from(rng.direction()).as_dvec3()).normalize();
    (p - along * body.size() * 2.0, p)
}

fn ulp(t: f64) -> f64 {
    let t = t.abs() as f32;
    f64::from(t.next_up() - t)
}

/// The ray and the body as the oracle sees them.
struct Line<'a> {
    body: &'a Body,
    o: DVec3,
    d: DVec3,
}

impl Line<'_> {
    fn at(&self, t: f64) -> DVec3 {
        self.o + self.d * t
    }

    fn value(&self, t: f64) -> f64 {
        self.body.value(self.at(t))
    }

    /// Crossings by sampling and halving, from the start of the ray on.
    fn crossings(&self) -> Vec<f64> {
        const SAMPLES: u32 = 3000;
        let length = self.d.length();
        let middle = (self.body.center - self.o).dot(self.d) / (length * length);
        let half = 1.01 * self.body.size() / length;
        let start = (middle - half).max(0.0);
        let step = (middle + half - start) / f64::from(SAMPLES);
        let mut all = vec![];
        for i in 0..SAMPLES {
            let [mut low, mut high] = [i, i + 1].map(|i| start + step * f64::from(i));
            let inside = self.value(low) < 0.0;
            if step <= 0.0 || inside == (self.value(high) < 0.0) {
                continue;
            }
            for _ in 0..80 {
                let t = 0.5 * (low + high);
                if (self.value(t) < 0.0) == inside { low = t } else { high = t }
            }
            if self.body.is_on(self.at(high)) {
                all.push(high);
            }
        }
        all
    }

    /// How deep the ray dips below the surface between a crossing and its neighbour.
    fn depth(&self, t: f64, others: &[f64]) -> f64 {
        let near = others.iter().filter(|&&other| (other - t).abs() > 0.0);
        let Some(other) = near.min_by(|a, b| (*a - t).abs().total_cmp(&(*b - t).abs())) else {
            return f64::INFINITY;
        };
        let between = (0..=20).map(|i| self.value(t + (other - t) * f64::from(i) / 20.0).abs());
        between.fold(0.0, f64::max)
    }
}

/// What came of comparing.
#[derive(Debug, Default)]
struct Tally {
    rays: u32,
    crossings: u32,
    merged: u32,
    grazing: u32,
    /// Off the oracle's parameter, in units in the last place.
    worst_t: f64,
    /// Off the gradient.
    worst_normal: f64,
    /// Off the surface, in bounds of the error.
    worst_point: f64,
}

impl Tally {
    fn compare(&mut self, body: &Body, ray: &Ray) {
        let line = Line { body, o: ray.o.as_dvec3(), d: ray.d.as_dvec3() };
        let (expected, found) = (line.crossings(), body.hits(ray));
        // What doubles make of a point so far from the origin.
        let blur = 4.0 * f64::EPSILON * (line.o.length() + body.center.length() + body.size());
        let blunt = blur + GRAZING * body.size();
        let slack = |t: f64| 0.51 * ulp(t) * line.d.length() + blunt;
        self.rays += 1;
        for &t in &expected {
            self.crossings += 1;
            let off = found.iter().map(|&s| (f64::from(s) - t).abs()).fold(f64::INFINITY, f64::min);
            // How fast the value changes: at grazing angles blur moves the crossing far.
            let lead = 1e-3 * ulp(t);
            let rate = ((line.value(t + lead) - line.value(t - lead)) / (2.0 * lead)).abs();
            if off <= 0.51 * ulp(t) + 2.0 * blunt / rate {
                self.worst_t = self.worst_t.max((off - 2.0 * blunt / rate).max(0.0) / ulp(t));
            } else if expected
                .iter()
                .any(|&other| (other - t).abs() > 0.0 && (other - t).abs() <= 2.0 * ulp(t))
            {
                self.merged += 1;
            } else {
                let depth = line.depth(t, &expected);
                assert!(
                    depth <= blunt,
                    "{body:?}\n{ray:?}\nlost {t}, {depth:e} deep, of {expected:?}: {found:?}"
                );
                self.grazing += 1;
            }
        }
        for &t in &found {
            let off = line.value(f64::from(t)).abs();
            let on_edge = body.distance_to_edge(line.at(t.into())) <= slack(t.into());
            assert!(
                off <= slack(t.into()) || on_edge,
                "{body:?}\n{ray:?}\nfalse {t}, off by {off:e}: {expected:?}"
            );
            self.look_at(body, ray, t);
        }
        let occluded = body.surface.occludes(0, ray);
        assert_eq!(occluded, !found.is_empty(), "{body:?}\n{ray:?}: hits and occlusion differ");
    }

    fn look_at(&mut self, body: &Body, ray: &Ray, t: f32) {
        let mut rest = *ray;
        rest.t_min = t.next_down();
        let hit = body.surface.intersect(0, &rest).expect("met before");
        let point = body.surface.point(0, ray, &hit);
        assert!(
            point.ng.is_normalized() && point.uv.is_finite() && point.p.is_finite(),
            "{body:?} {point:?}"
        );
        let p = point.p.as_dvec3();
        let error = point.p_error.as_dvec3();
        let n = point.ng.as_dvec3();
        self.worst_point = self.worst_point.max(body.value(p).abs() / n.abs().dot(error));
        if body.distance_to_edge(p) > 1e-3 * body.size() && body.bend(p) > 1e3 * error.length() {
            let off = (body.gradient(p) - n).length();
            self.worst_normal =
                self.worst_normal.max(off * body.bend(p) / (body.bend(p) + 1e6 * error.length()));
            let reported = hit.ng.normalize().as_dvec3();
            assert!(
                reported.dot(n) > 0.99 || ulp(t.into()) * f64::from(ray.d.length()) > 0.01 * body.bend(p),
                "{body:?} {ray:?}: hit and point disagree: {reported} {n}"
            );
        }
    }
}

#[test]
fn no_crossing_is_lost_and_none_invented() {
    for (kind, name) in KINDS.iter().enumerate() {
        for (way, way_name) in WAYS.iter().enumerate() {
            let mut rng = Random::new(100 + u32::try_from(kind * 10 + way).expect("small"));
            let mut tally = Tally::default();
            for _ in 0..150 {
                let body = body(&mut rng, kind);
                for _ in 0..10 {
                    tally.compare(&body, &ray_to(&mut rng, &body, way));
                }
            }
            println!("{name}, {way_name}: {tally:?}");
            assert!(
                tally.crossings > 300,
                "{name}, {way_name}: too few crossings to show anything: {tally:?}"
            );
            assert!(tally.worst_t <= 0.51, "{name}, {way_name}: {tally:?}");
            assert!(tally.worst_point <= 1.0, "{name}, {way_name}: points off the surface: {tally:?}");
            assert!(tally.worst_normal <= 2e-6, "{name}, {way_name}: {tally:?}");
        }
    }
}

/// Lines that fill space evenly cross a body on 4 V / S on average (Cauchy), and a surface S / (2 A) times where A is the
/// cross-section of the bundle (Crofton).
#[test]
fn chords_measure_volume_and_area() {
    const LINES: u32 = 100_000;
    for (kind, name) in KINDS.iter().enumerate() {
        let mut rng = Random::new(11 + u32::try_from(kind).expect("small"));
        let body = loop {
            let body = body(&mut rng, kind);
            let (_, area) = body.volume_and_area();
            // A body that few lines meet shows little.
            if area > body.size() * body.size() {
                break body;
            }
        };
        let (radius, bundle) = (body.size() * 1.01, std::f64::consts::PI * (body.size() * 1.01).powi(2));
        let (mut chords, mut crossings) = (Moments::default(), Moments::default());
        for _ in 0..LINES {
            let d = Vec3::from(rng.direction()).as_dvec3();
            let (x, y) = d.any_orthonormal_pair();
            let [r, angle] = rng.pair().map(f64::from);
            let (sin, cos) = (angle * std::f64::consts::TAU).sin_cos();
            let from = body.center + (x * cos + y * sin) * (r.sqrt() * radius) - d * 2.0 * radius;
            let ray = Ray::new(from.as_vec3(), (d * radius).as_vec3());
            let hits = body.hits(&ray);
            let chord: f64 = hits.chunks_exact(2).map(|pair| f64::from(pair[1] - pair[0])).sum();
            chords.add(chord * f64::from(ray.d.length()));
            crossings.add(hits.len() as f64);
        }
        let (volume, area) = body.volume_and_area();
        println!("{name}: {chords:?} {crossings:?} {volume:?} {area}");
        let misses = crossings.off(area / (2.0 * bundle));
        assert!(misses < 5.0, "{name}: area off by {misses} standard errors");
        if let Some(volume) = volume {
            let misses = chords.off(volume / bundle);
            assert!(misses < 5.0, "{name}: volume off by {misses} standard errors");
        }
    }
}

#[derive(Debug, Default)]
struct Moments {
    n: f64,
    sum: f64,
    squares: f64,
}

impl Moments {
    fn add(&mut self, x: f64) {
        self.n += 1.0;
        self.sum += x;
        self.squares += x * x;
    }

    /// Distance of the mean from what it should be, in standard errors.
    fn off(&self, expected: f64) -> f64 {
        let mean = self.sum / self.n;
        (mean - expected).abs() / ((self.squares / self.n - mean * mean) / self.n).sqrt()
    }
}

#[test]
fn boxes_hold_all_points_and_fit() {
    for (kind, name) in KINDS.iter().enumerate() {
        let mut rng = Random::new(50 + u32::try_from(kind).expect("small"));
        for _ in 0..20 {
            let body = body(&mut rng, kind);
            let bounds = body.surface.primitive_bounds(0);
            for _ in 0..2000 {
                let ray = ray_to(&mut rng, &body, 0);
                if let Some(hit) = body.surface.intersect(0, &ray) {
                    let p = body.surface.point(0, &ray, &hit).p;
                    assert_eq!(bounds.with(p), bounds, "{name}: {body:?} sticks out of its box");
                }
            }
            for axis in 0..3 {
                let farthest =
                    [DVec3::NEG_ONE, DVec3::ONE].map(|sign| body.farthest(DVec3::AXES[axis] * sign));
                let (low, high) = (f64::from(bounds.min[axis]), f64::from(bounds.max[axis]));
                let loose = (-farthest[0] - low).max(high - farthest[1]);
                let limit = 1e-7 * body.size() + 2.0 * ulp(low.abs().max(high.abs()));
                assert!(loose <= limit, "{name}: {body:?} has a box too large by {loose:e} along {axis}");
            }
        }
    }
}

fn skewed(rng: &mut Random, size: f32) -> Transform {
    let scale = Vec3::new(0.5 + rng.unit(), -0.5 - rng.unit(), 0.5 + rng.unit());
    let turn = Quat::from_axis_angle(Vec3::from(rng.direction()), rng.unit() * 6.0);
    let shift = Vec3::from(rng.triple()) * size;
    Transform::new(Affine3A::from_scale_rotation_translation(scale, turn, shift)).expect("invertible")
}

fn placed(body: &Body, transform: Option<Transform>) -> (Arc<World>, Brute) {
    let mut world = World::default();
    let id = world.add_shape(Shape::Surface(body.surface.clone()));
    world.place(id, transform);
    let world = Arc::new(world);
    (world.clone(), Brute::new(world))
}

/// Rays that leave a body and hit it at once in one of both backends, and rays in all, with error bounds scaled by `factor`.
fn self_hits(rng: &mut Random, body: &Body, transform: Option<Transform>, factor: f32) -> (u32, u32) {
    let (world, brute) = placed(body, transform);
    let embree = EmbreeAccel::build(&world, &BuildOptions::default()).expect("a hierarchy");
    let convex = !matches!(body.measures, bodies::Measures::Torus(..));
    let (mut hits, mut rays) = (0, 0);
    for _ in 0..40 {
        let ray = ray_to(rng, body, 0);
        let ray = transform.map_or(ray, |t| Ray::new(t.point(ray.o), t.vector(ray.d)));
        let Some(hit) = brute.intersect(&ray) else { continue };
        let it = world.interaction(&ray, &hit);
        let p = transform.map_or(it.p, |t| t.inverse_point(it.p)).as_dvec3();
        for _ in 0..4 {
            let d = Vec3::from(rng.direction());
            let cos = d.dot(it.ng);
            // A ray into a body, or over the inner side of a ring, hits it again farther away than rounding explains; near an
            // edge that may be anywhere. Skewing halves lengths at most.
            let reach = 0.25 * body.bend(p) as f32 * cos.abs();
            let reach = if convex && cos > 0.0 { f32::INFINITY } else { reach };
            let away = spawn::ray(it.p, it.p_error * factor, it.ng, d);
            rays += 1;
            hits += u32::from(brute.occluded(&away.until(reach)) || embree.occluded(&away.until(reach)));
        }
    }
    (hits, rays)
}

#[test]
fn no_ray_hits_what_it_leaves() {
    for (kind, name) in KINDS.iter().enumerate() {
        for is_placed in [false, true] {
            for factor in [1.0, 0.5, 0.25, 0.1, 0.0] {
                let mut rng = Random::new(7);
                let (mut hits, mut rays) = (0, 0);
                for _ in 0..400 {
                    let body = body(&mut rng, kind);
                    let transform = is_placed.then(|| skewed(&mut rng, body.size() as f32));
                    let (more_hits, more_rays) = self_hits(&mut rng, &body, transform, factor);
                    hits += more_hits;
                    rays += more_rays;
                }
                println!("{name}, instance {is_placed}: bounds times {factor}: {hits} of {rays} rays");
                assert!(factor < 1.0 || hits == 0, "{name}, instance {is_placed}: {hits} of {rays} rays");
            }
        }
    }
}

#[test]
fn normals_follow_skewed_and_mirrored_maps() {
    for (kind, name) in KINDS.iter().enumerate() {
        let mut rng = Random::new(70 + u32::try_from(kind).expect("small"));
        let mut looked = 0;
        for _ in 0..100 {
            let body = body(&mut rng, kind);
            let map = skewed(&mut rng, body.size() as f32);
            let (world, accel) = placed(&body, Some(map));
            let back = |p: DVec3| {
                let m = map.object_from_world();
                m.matrix3.as_dmat3() * p + Vec3::from(m.translation).as_dvec3()
            };
            for _ in 0..10 {
                let ray = ray_to(&mut rng, &body, 0);
                let ray = Ray::new(map.point(ray.o), map.vector(ray.d));
                let Some(hit) = accel.intersect(&ray) else { continue };
                let it = world.interaction(&ray, &hit);
                let p = it.p.as_dvec3();
                let bend = body.bend(back(p));
                if bend < 1e3 * f64::from(it.p_error.length()) {
                    continue;
                }
                let slope = |way: DVec3| {
                    let h = way * bend * 1e-4;
                    body.value(back(p + h)) - body.value(back(p - h))
                };
                let n = DVec3::new(slope(DVec3::X), slope(DVec3::Y), slope(DVec3::Z)).normalize();
                let off = (n - it.ng.as_dvec3()).length();
                assert!(off < 2e-3, "{name}: {body:?} {map:?}: {} for {n}", it.ng);
                assert!(back(p).is_finite() && body.value(back(p)).abs() < 1e-4 * body.size(), "{name}: off");
                looked += 1;
            }
        }
        assert!(looked > 100, "{name}: only {looked} points were looked at");
    }
}

#[test]
fn bodies_moved_to_their_place_are_those_of_instances() {
    for (kind, name) in KINDS.iter().enumerate() {
        let mut rng = Random::new(90 + u32::try_from(kind).expect("small"));
        let (mut both, mut one) = (0, 0);
        for _ in 0..100 {
            let body = body(&mut rng, kind);
            let size = body.size() as f32;
            let turn = Quat::from_axis_angle(Vec3::from(rng.direction()), rng.unit() * 6.0);
            let (scale, shift) = (0.5 + rng.unit(), Vec3::from(rng.triple()) * size);
            // Mirrored, every other time.
            let sizes = Vec3::splat(scale).with_x(if rng.unit() < 0.5 { -scale } else { scale });
            let affine = Affine3A::from_scale_rotation_translation(sizes, turn, shift);
            let map = Transform::new(affine).expect("invertible");
            let moved = body.surface.scaled(&map, scale).expect("a similar body");
            let (world, accel) = placed(&body, Some(map));
            for _ in 0..20 {
                let ray = ray_to(&mut rng, &body, 0);
                let ray = Ray::new(map.point(ray.o), map.vector(ray.d));
                match (accel.intersect(&ray), moved.intersect(0, &ray)) {
                    (None, None) => {}
                    (Some(a), Some(b)) if (a.t - b.t).abs() < 1e-3 * a.t => {
                        let (p, q) = (world.interaction(&ray, &a), moved.point(0, &ray, &b));
                        let turned = ((p.uv - q.uv).abs() - 0.5).abs().min_element() < 0.45;
                        assert!(!turned || p.uv.abs_diff_eq(q.uv, 0.05), "{name}: {} {}", p.uv, q.uv);
                        both += 1;
                    }
                    _ => one += 1,
                }
            }
        }
        assert!(both > 300 && one * 50 < both, "{name}: {both} alike, {one} not");
    }
}
