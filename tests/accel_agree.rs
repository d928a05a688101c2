//! Every backend and every kind of query against the oracle that tests each primitive in double precision.
//!
//! Rays are aimed at edges, along surfaces and from far away on purpose, where single precision cannot but answer
//! otherwise than the oracle now and then. An answer is therefore wrong only if the oracle gives it for no ray within
//! rounding of the one asked for; one in 10^5 may be. The tables printed (`--nocapture`) also count plain
//! differences.

#![expect(clippy::print_stdout, reason = "tables of what was found")]

#[path = "support/rays.rs"]
mod rays;
#[path = "support/verdict.rs"]
mod verdict;

use glam::Vec3;
use rays::{Aim, Rng, worlds};
use specula::accel::embree::{BuildOptions, Config, EmbreeAccel, Isa, Quality, SceneOptions};
use specula::accel::{Accel, Active, Brute, Coherence, HitStream, Packet, RayPacket, RayStream};
use specula::geometry::{Hit, Mesh, Ray, Shape, World};
use std::sync::Arc;
use verdict::{Verdict, judge};

const RAYS_PER_AIM: usize = 5_000;

/// One way of asking, and what it found.
struct Answers {
    kind: String,
    hits: Vec<Option<Hit>>,
    occluded: Vec<bool>,
}

/// What one way of asking made of one set of rays.
#[derive(Clone, Copy, Default)]
struct Tally {
    rays: usize,
    /// Another primitive than the oracle's: most are ties on edges.
    differ: usize,
    /// Rays that slipped past a boundary.
    leaks: usize,
    /// Answers that rounding does not excuse.
    wrong: usize,
    /// Occlusion other than the own hit says.
    occlusion: usize,
}

impl Tally {
    fn add(&mut self, other: &Self) {
        self.rays += other.rays;
        self.differ += other.differ;
        self.leaks += other.leaks;
        self.wrong += other.wrong;
        self.occlusion += other.occlusion;
    }
}

fn backends(world: &Arc<World>) -> Vec<(&'static str, EmbreeAccel)> {
    let build = |max_isa, scene| {
        let device = Config { max_isa, ..Config::default() };
        EmbreeAccel::build(world, &BuildOptions { device, scene }).expect("built")
    };
    let fast = SceneOptions::default();
    let robust = SceneOptions { robust: true, ..fast };
    vec![
        ("embree", build(None, fast)),
        ("embree robust", build(None, robust)),
        ("embree compact", build(None, SceneOptions { compact: true, ..fast })),
        ("embree high", build(None, SceneOptions { quality: Quality::High, ..fast })),
        ("embree sse2", build(Some(Isa::Sse2), fast)),
        ("embree sse2 robust", build(Some(Isa::Sse2), robust)),
        ("embree avx robust", build(Some(Isa::Avx), robust)),
    ]
}

fn all_kinds<A: Accel>(accel: &A, rays: &[Ray]) -> Vec<Answers> {
    let hits = rays.iter().map(|ray| accel.intersect(ray)).collect();
    let occluded = rays.iter().map(|ray| accel.occluded(ray)).collect();
    let mut all = vec![Answers { kind: "single".to_owned(), hits, occluded }];
    for coherence in [Coherence::Coherent, Coherence::Incoherent] {
        all.push(packets::<A, 4>(accel, rays, coherence));
        all.push(packets::<A, 8>(accel, rays, coherence));
        all.push(packets::<A, 16>(accel, rays, coherence));
        all.push(stream(accel, rays, coherence));
    }
    // A width that no backend has kernels for.
    all.push(packets::<A, 3>(accel, rays, Coherence::Incoherent));
    all
}

/// Packets with some lanes switched off in turn, so that each ray is traced in the end.
fn packets<A: Accel, const N: usize>(accel: &A, rays: &[Ray], coherence: Coherence) -> Answers {
    let mut rng = Rng::new(7);
    let mut hits = Vec::with_capacity(rays.len());
    let mut occluded = Vec::with_capacity(rays.len());
    for chunk in rays.chunks(N) {
        let mut packet = Packet::<N>::EMPTY;
        chunk.iter().enumerate().for_each(|(lane, ray)| packet.ray.set(lane, ray));
        let mut shadow: RayPacket<N> = packet.ray;
        let filled = (1_u32 << chunk.len()) - 1;
        let some = rng.bits() & filled;
        for active in [Active::from_bits(some), Active::from_bits(filled & !some)] {
            let before = packet;
            accel.intersect_packet(&active, &mut packet, coherence);
            for lane in (0..N).filter(|&lane| !active.contains(lane)) {
                let [now, then] =
                    [&packet, &before].map(|p| (p.ray.t_max[lane].to_bits(), p.hit.geometry[lane]));
                assert_eq!(now, then, "an inactive lane has changed");
            }
            accel.occluded_packet(&active, &mut shadow, coherence);
        }
        hits.extend((0..chunk.len()).map(|lane| packet.get_hit(lane)));
        occluded.extend((0..chunk.len()).map(|lane| shadow.t_max[lane] < chunk[lane].t_max));
    }
    Answers { kind: format!("packet {N} {coherence:?}"), hits, occluded }
}

fn stream<A: Accel>(accel: &A, rays: &[Ray], coherence: Coherence) -> Answers {
    let mut input = RayStream::default();
    input.extend(rays);
    // Answers of an earlier, longer stream must not shine through.
    let mut output = HitStream::default();
    output.resize(rays.len() + 5);
    accel.intersect_stream(&input, &mut output, coherence);
    assert_eq!(output.len(), rays.len(), "one answer a ray");
    let mut occluded = vec![true; 3];
    accel.occluded_stream(&input, &mut occluded, coherence);
    let hits = (0..rays.len()).map(|i| output.get(i)).collect();
    Answers { kind: format!("stream {coherence:?}"), hits, occluded }
}

/// Rays, the oracle's answers, and verdicts on other answers: most kinds of query give the same ones.
struct Judge<'a> {
    world: &'a World,
    brute: &'a Brute,
    rays: &'a [Ray],
    oracle: Vec<Option<Hit>>,
    verdicts: Vec<Vec<(Option<Hit>, Verdict)>>,
}

impl<'a> Judge<'a> {
    fn new(world: &'a World, brute: &'a Brute, rays: &'a [Ray]) -> Self {
        let oracle = rays.iter().map(|ray| brute.intersect(ray)).collect();
        Self { world, brute, rays, oracle, verdicts: vec![Vec::new(); rays.len()] }
    }

    fn verdict(&mut self, i: usize, found: Option<&Hit>) -> Verdict {
        if let Some((_, verdict)) = self.verdicts[i].iter().find(|(hit, _)| hit.as_ref() == found) {
            return *verdict;
        }
        let verdict = judge(self.world, self.brute, &self.rays[i], self.oracle[i].as_ref(), found);
        self.verdicts[i].push((found.copied(), verdict));
        verdict
    }

    fn tally(&mut self, answers: &Answers) -> Tally {
        let mut tally = Tally { rays: self.rays.len(), ..Tally::default() };
        for (i, found) in answers.hits.iter().enumerate() {
            let identity = |hit: &Hit| (hit.placement, hit.prim);
            tally.differ +=
                usize::from(self.oracle[i].as_ref().map(identity) != found.as_ref().map(identity));
            tally.occlusion += usize::from(answers.occluded[i] != found.is_some());
            match self.verdict(i, found.as_ref()) {
                Verdict::Right => {}
                Verdict::Leak => tally.leaks += 1,
                Verdict::Wrong => {
                    tally.wrong += 1;
                    println!(
                        "wrong: {}: {:?}: {found:?}, not {:?}",
                        answers.kind, self.rays[i], self.oracle[i]
                    );
                }
            }
        }
        tally
    }
}

#[test]
fn all_kinds_of_query_agree_with_the_oracle() {
    let mut totals: Vec<(String, Aim, Tally)> = Vec::new();
    for (name, world) in worlds() {
        let world = Arc::new(world);
        let backends = backends(&world);
        let brute = Brute::new(world.clone());
        for aim in Aim::ALL {
            let rays = aim.rays(&world, RAYS_PER_AIM);
            let mut judge = Judge::new(&world, &brute, &rays);
            println!(
                "{name:9} {aim:?}: {} of {} rays hit",
                judge.oracle.iter().flatten().count(),
                rays.len()
            );
            for (backend, accel) in &backends {
                for answers in all_kinds(accel, &rays) {
                    let tally = judge.tally(&answers);
                    let key = format!("{backend}, {}", answers.kind);
                    match totals.iter_mut().find(|(k, a, _)| *k == key && *a == aim) {
                        Some((_, _, total)) => total.add(&tally),
                        None => totals.push((key, aim, tally)),
                    }
                }
            }
        }
    }
    report(&totals);
    for (key, aim, tally) in &totals {
        let at_most = |count: usize, share: f64, what: &str| {
            let allowed = (tally.rays as f64 * share).ceil();
            assert!(count as f64 <= allowed, "{key}, {aim:?}: {count} of {} {what}", tally.rays);
        };
        at_most(tally.wrong, 0.0, "are wrong");
        match aim {
            Aim::Anywhere | Aim::Axis => {
                at_most(tally.differ, 2e-4, "name another primitive");
                at_most(tally.leaks, 1e-5, "leak");
                at_most(tally.occlusion, 1e-5, "are occluded otherwise than they hit");
            }
            // Mostly misses of single edges and rims, which half of the rays should miss.
            Aim::Edge => at_most(tally.leaks, 8e-2, "leak"),
            Aim::Grazing => at_most(tally.leaks, 2e-2, "leak"),
            Aim::Far => at_most(tally.leaks, 1e-3, "leak"),
        }
        at_most(tally.occlusion, 1e-3, "are occluded otherwise than they hit");
    }
}

#[test]
fn kinds_without_kernels_agree_with_single_rays() {
    let world = Arc::new(rays::instanced());
    let rays = Aim::Anywhere.rays(&world, 500);
    let all = all_kinds(&Brute::new(world), &rays);
    for answers in &all {
        assert_eq!(answers.hits, all[0].hits, "{}", answers.kind);
        assert_eq!(answers.occluded, all[0].occluded, "{}", answers.kind);
    }
}

fn report(totals: &[(String, Aim, Tally)]) {
    println!(
        "{:36} {:9} {:>6} {:>6} {:>6} {:>6} {:>9}",
        "query", "aim", "rays", "differ", "leaks", "wrong", "occlusion"
    );
    for (key, aim, t) in totals {
        let aim = format!("{aim:?}");
        println!(
            "{key:36} {aim:9} {:6} {:6} {:6} {:6} {:9}",
            t.rays, t.differ, t.leaks, t.wrong, t.occlusion
        );
    }
}

#[test]
fn rays_that_cannot_be_traced_hit_nothing() {
    let bad = [f32::NAN, f32::INFINITY, f32::NEG_INFINITY];
    let mut bad_rays = Vec::new();
    for good in Aim::ALL.iter().flat_map(|aim| aim.rays(&rays::instanced(), 40)) {
        for (axis, value) in (0..3).flat_map(|axis| bad.map(|value| (axis, value))) {
            let mut ray = good;
            ray.o[axis] = value;
            bad_rays.push(ray);
            let mut ray = good;
            ray.d[axis] = value;
            bad_rays.push(ray);
            ray.o[(axis + 1) % 3] = value;
            bad_rays.push(ray);
        }
        bad_rays.push(rays::changed(good, |ray| ray.d = Vec3::ZERO));
        bad_rays.push(rays::changed(good, |ray| ray.d = -Vec3::ZERO));
        bad_rays.push(rays::changed(good, |ray| (ray.t_min, ray.t_max) = (2.0, 1.0)));
        bad_rays.push(rays::changed(good, |ray| ray.t_max = -1.0));
        bad_rays.push(rays::changed(good, |ray| ray.t_max = f32::NEG_INFINITY));
        bad_rays.push(rays::changed(good, |ray| ray.t_max = f32::NAN));
        bad_rays.push(rays::changed(good, |ray| ray.t_min = f32::NAN));
        bad_rays.push(rays::changed(good, |ray| ray.mask = 0));
    }
    let mut checked = 0;
    for (name, world) in worlds() {
        let world = Arc::new(world);
        let mut all = all_kinds(&Brute::new(world.clone()), &bad_rays);
        all.extend(backends(&world).iter().flat_map(|(_, accel)| all_kinds(accel, &bad_rays)));
        for answers in &all {
            for (i, ray) in bad_rays.iter().enumerate() {
                assert_eq!(answers.hits[i], None, "{name}, {}: {ray:?}", answers.kind);
                assert!(!answers.occluded[i], "{name}, {}: {ray:?}", answers.kind);
                checked += 1;
            }
        }
    }
    println!("{checked} rays that cannot be traced hit nothing");
}

/// A ray of random bits, or of coordinates of any magnitude that is not a fault in itself.
fn wild(rng: &mut Rng) -> Ray {
    let mut number = |signed: bool| match rng.bits() % 4 {
        0 => f32::from_bits(rng.bits()),
        1 => 0.0,
        _ => {
            let size = 10_f32.powf(rng.unit() * 63.0 - 45.0);
            if signed && rng.bits() & 1 == 0 { -size } else { size }
        }
    };
    let (o, d) = ([number(true), number(true), number(true)], [number(true), number(true), number(true)]);
    let (t_min, t_max) = (number(false), number(false));
    let ray = Ray::new(Vec3::from(o), Vec3::from(d)).until(t_max);
    rays::changed(ray, |ray| ray.t_min = t_min)
}

#[test]
fn rays_of_any_numbers_are_survived() {
    let mut rng = Rng::new(5);
    let rays: Vec<Ray> = (0..20_000).map(|_| wild(&mut rng)).collect();
    let traceable = rays.iter().filter(|ray| ray.is_traceable()).count();
    for (name, world) in worlds() {
        let world = Arc::new(world);
        for (backend, accel) in backends(&world) {
            for answers in all_kinds(&accel, &rays) {
                let hits = rays.iter().zip(&answers.hits).filter(|(_, hit)| hit.is_some());
                for (ray, hit) in hits {
                    assert!(ray.is_traceable(), "{name}, {backend}, {}: {ray:?} hits {hit:?}", answers.kind);
                }
            }
        }
    }
    println!("{traceable} of {} wild rays can be traced", rays.len());
}

#[test]
fn a_closed_robust_mesh_lets_next_to_nothing_out() {
    let world = Arc::new(rays::closed());
    let mut rng = Rng::new(3);
    let rays: Vec<Ray> = (0..50_000)
        .map(|_| {
            let o = rng.direction() * 0.3;
            Ray::new(o, rays::edge_point(&world, &mut rng) - o)
        })
        .collect();
    for (name, accel) in backends(&world) {
        for answers in all_kinds(&accel, &rays) {
            let lost = answers.hits.iter().filter(|hit| hit.is_none()).count();
            println!("{name}, {}: {lost} of {} rays at edges and corners lost", answers.kind, rays.len());
            // Without the flag one in ten of these goes lost; with it one in 10^4, for it is not quite watertight.
            assert!(!name.ends_with("robust") || lost <= 10, "{}: {lost} lost", answers.kind);
        }
    }
}

#[test]
fn empty_and_degenerate_worlds_are_never_hit() {
    let line = Mesh::new(vec![Vec3::ZERO, Vec3::X, Vec3::X * 2.0], vec![[0, 1, 2], [0, 0, 0], [1, 1, 2]]);
    let none = Mesh::new(vec![Vec3::ZERO], vec![]);
    let mut flat = World::default();
    for mesh in [line.expect("good"), none.expect("good")] {
        let shape = flat.add_shape(Shape::Mesh(mesh));
        flat.place(shape, None);
        flat.place(shape, Some(rays::skewed()));
    }
    let mut rays = Aim::Anywhere.rays(&rays::closed(), 2000);
    rays.extend((0..2000_u16).map(|i| {
        let target = Vec3::X * (f32::from(i) / 1000.0);
        Ray::new(
            Vec3::new(1.0, f32::from(i % 7) - 3.0, 2.0),
            target - Vec3::new(1.0, f32::from(i % 7) - 3.0, 2.0),
        )
    }));
    rays.push(Ray::new(-Vec3::X, Vec3::X));
    for world in [World::default(), flat] {
        let world = Arc::new(world);
        for (name, accel) in backends(&world) {
            for answers in all_kinds(&accel, &rays) {
                assert!(answers.hits.iter().all(Option::is_none), "{name}, {}: hit", answers.kind);
                assert!(!answers.occluded.contains(&true), "{name}, {}: occluded", answers.kind);
            }
        }
    }
}

#[test]
fn bounds_hold_the_world() {
    for (name, world) in worlds() {
        let world = Arc::new(world);
        let own = world.bounds();
        for (backend, accel) in backends(&world) {
            let found = accel.bounds();
            let slack =
                own.size().max_element() * 1e-5 + own.max.abs().max(own.min.abs()).max_element() * 1e-6;
            // Embree's box of a sphere or of an instance may be larger than ours, never smaller.
            assert!(found.min.cmple(own.min + slack).all(), "{name}, {backend}: {found:?} in {own:?}");
            assert!(found.max.cmpge(own.max - slack).all(), "{name}, {backend}: {found:?} in {own:?}");
        }
    }
}
