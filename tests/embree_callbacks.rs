//! User code that misbehaves while Embree calls it: it panics, tells boxes that are none or changes its mind; and who
//! owns what Embree points to.

#[path = "support/queries.rs"]
mod queries;

use glam::{Affine3A, Vec2, Vec3};
use queries::Kind;
use specula::accel::Accel;
use specula::accel::embree::{
    BuildOptions, Config, Device, EmbreeAccel, EmbreeError, Geometry, Scene, SceneOptions, UserShape,
};
use specula::geometry::{HitFilter, Mesh, Pose, Ray, Shape, ShapeHit, Sphere, Surface, SurfacePoint, World};
use specula::math::motion::MOST_KEYS;
use specula::math::{Aabb, Motion, Transform};
use std::any::Any;
use std::panic::{AssertUnwindSafe, catch_unwind, panic_any, resume_unwind};
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};

/// What is panicked with.
#[derive(Debug, PartialEq)]
struct Why(&'static str);

const BALL: Sphere = Sphere { center: Vec3::ZERO, radius: 1.0 };

/// A ball that panics when asked by rays from below.
#[derive(Debug)]
struct Touchy;

impl Surface for Touchy {
    fn primitive_bounds(&self, _prim: u32) -> Aabb {
        BALL.bounds()
    }

    fn intersect(&self, _prim: u32, ray: &Ray) -> Option<ShapeHit> {
        if ray.o.z < 0.0 {
            panic_any(Why("from below"));
        }
        let t = BALL.intersect(ray.o, ray.d, ray.t_min, ray.t_max)?;
        Some(ShapeHit { t, u: 0.0, v: 0.0, ng: ray.at(t) })
    }

    fn point(&self, _prim: u32, ray: &Ray, hit: &ShapeHit) -> SurfacePoint {
        let (p, n) = BALL.project(ray.at(hit.t));
        SurfacePoint::smooth(p, Vec3::splat(1e-6), n, Vec2::ZERO)
    }
}

impl HitFilter for Touchy {
    fn accepts(&self, ray: &Ray, _hit: &ShapeHit, _prim: u32) -> bool {
        if ray.o.z < 0.0 {
            panic_any(Why("from below"));
        }
        true
    }
}

/// Three parallel rays apart and down on a ball; the second from below if asked for.
fn rays(bad: bool) -> Vec<Ray> {
    let down = |x: f32| Ray::new(Vec3::new(x, 0.1, 3.0), -Vec3::Z);
    let mut rays: Vec<Ray> = (0..23_u8).map(|i| down(f32::from(i % 5) * 0.1)).collect();
    if bad {
        rays[19] = Ray::new(Vec3::new(0.2, 0.1, -3.0), Vec3::Z);
    }
    rays
}

fn panic_of<T>(run: impl FnOnce() -> T) -> Option<Box<dyn Any + Send>> {
    catch_unwind(AssertUnwindSafe(run)).err()
}

fn touchy_worlds() -> Vec<(&'static str, World)> {
    let plane = Mesh::new(
        [Vec3::new(-9.0, -9.0, 0.0), Vec3::new(9.0, -9.0, 0.0), Vec3::new(0.0, 9.0, 0.0)].to_vec(),
        vec![[0, 1, 2]],
    );
    let own = Shape::Surface(Arc::new(Touchy));
    let moved = Transform::new(Affine3A::from_translation(Vec3::new(0.05, 0.0, 0.0))).expect("invertible");
    let world = |shape: &Shape, filter: bool, pose: Pose| {
        let mut world = World::default();
        let id = world.add_shape(shape.clone());
        if filter {
            world.filters.insert(id, Arc::new(Touchy));
        }
        world.place(id, pose);
        world
    };
    let plane = Shape::Mesh(plane.expect("good"));
    vec![
        ("surface", world(&own, false, Pose::World)),
        ("instance", world(&own, false, Pose::from(moved))),
        ("filter", world(&plane, true, Pose::World)),
        ("filter in an instance", world(&plane, true, Pose::from(moved))),
        ("filter of a sphere", world(&Shape::Sphere(BALL), true, Pose::World)),
    ]
}

#[test]
fn panics_come_out_of_every_kind_of_query() {
    for (name, world) in touchy_worlds() {
        let accel = EmbreeAccel::build(&world, &BuildOptions::default()).expect("built");
        for kind in Kind::all() {
            let nearest = |bad| kind.hits(&accel, &rays(bad)).iter().flatten().count();
            let any = |bad| kind.occluded(&accel, &rays(bad)).iter().filter(|met| **met).count();
            let asked: [(&str, &dyn Fn(bool) -> usize); 2] = [("nearest", &nearest), ("any", &any)];
            for (what, ask) in asked {
                let payload = panic_of(|| ask(true));
                let payload = payload.unwrap_or_else(|| panic!("{name}, {kind:?}, {what}: no panic"));
                let why = payload.downcast_ref::<Why>();
                assert_eq!(why, Some(&Why("from below")), "{name}, {kind:?}, {what}");
                assert_eq!(ask(false), rays(false).len(), "{name}, {kind:?}, {what}: usable afterwards");
            }
        }
    }
}

#[test]
fn a_panic_stays_in_its_thread() {
    let (_, world) = touchy_worlds().swap_remove(0);
    let accel = EmbreeAccel::build(&world, &BuildOptions::default()).expect("built");
    let [good, bad] = [rays(false)[0], rays(true)[19]];
    std::thread::scope(|scope| {
        let threads: Vec<_> = (0..4)
            .map(|thread| {
                let accel = &accel;
                scope.spawn(move || {
                    for _ in 0..200 {
                        let panicked =
                            panic_of(|| accel.intersect(if thread % 2 == 0 { &good } else { &bad }));
                        assert_eq!(panicked.is_some(), thread % 2 == 1, "thread {thread}");
                    }
                })
            })
            .collect();
        threads.into_iter().for_each(|thread| thread.join().unwrap_or_else(|p| resume_unwind(p)));
    });
}

/// Primitives side by side along x, with boxes as told; each a wall across its cell at z = 0.
#[derive(Debug)]
struct Row {
    boxes: Vec<Aabb>,
    /// Whether it tells something else when asked again.
    fickle: bool,
    asked: Arc<AtomicUsize>,
    dropped: Arc<AtomicUsize>,
}

impl Row {
    fn new(boxes: Vec<Aabb>) -> Self {
        Self { boxes, fickle: false, asked: Arc::default(), dropped: Arc::default() }
    }
}

impl Drop for Row {
    fn drop(&mut self) {
        self.dropped.fetch_add(1, Ordering::Relaxed);
    }
}

impl Surface for Row {
    fn primitive_count(&self) -> u32 {
        self.boxes.len().try_into().expect("few")
    }

    fn primitive_bounds(&self, prim: u32) -> Aabb {
        let asked = self.asked.fetch_add(1, Ordering::Relaxed);
        let changed = self.fickle && asked >= self.boxes.len();
        if changed { Aabb::EMPTY } else { self.boxes[prim as usize] }
    }

    fn intersect(&self, prim: u32, ray: &Ray) -> Option<ShapeHit> {
        let t = -ray.o.z / ray.d.z;
        let inside = (ray.at(t).x - prim as f32 - 0.5).abs() < 0.5;
        (inside && t >= ray.t_min && t <= ray.t_max).then_some(ShapeHit { t, u: 0.0, v: 0.0, ng: Vec3::Z })
    }

    fn point(&self, _prim: u32, ray: &Ray, hit: &ShapeHit) -> SurfacePoint {
        SurfacePoint::smooth(ray.at(hit.t), Vec3::splat(1e-6), Vec3::Z, Vec2::ZERO)
    }
}

/// The box of a cell.
fn cell(prim: u16) -> Aabb {
    let x = f32::from(prim);
    Aabb { min: Vec3::new(x, -1.0, -0.1), max: Vec3::new(x + 1.0, 1.0, 0.1) }
}

#[test]
fn boxes_that_are_none_are_never_hit() {
    let mut boxes: Vec<Aabb> = (0..9).map(cell).collect();
    boxes[1] = Aabb::EMPTY;
    boxes[2].min.y = f32::NAN;
    boxes[3].max.x = f32::INFINITY;
    boxes[4] = Aabb { min: Vec3::NEG_INFINITY, max: Vec3::INFINITY };
    boxes[5] = Aabb { min: Vec3::NAN, max: Vec3::NAN };
    boxes[7].min.z = 1.0;
    let rays: Vec<Ray> =
        (0..9_u8).map(|i| Ray::new(Vec3::new(f32::from(i) + 0.4, 0.0, 2.0), -Vec3::Z)).collect();
    let moved = Transform::new(Affine3A::from_scale(Vec3::new(1.0, 2.0, 1.0))).expect("invertible");
    for pose in [Pose::World, Pose::from(moved)] {
        let mut world = World::default();
        let shape = world.add_shape(Shape::Surface(Arc::new(Row::new(boxes.clone()))));
        world.place(shape, pose.clone());
        let accel = EmbreeAccel::build(&world, &BuildOptions::default()).expect("built");
        for kind in Kind::all() {
            let hit: Vec<usize> = (0..9).filter(|&i| kind.hits(&accel, &rays)[i].is_some()).collect();
            assert_eq!(hit, [0, 6, 8], "{pose:?}, {kind:?}");
        }
        assert!(accel.bounds().max.is_finite(), "{:?}", accel.bounds());
    }
    let mut world = World::default();
    let shape = world.add_shape(Shape::Surface(Arc::new(Row::new(vec![boxes[5]; 40]))));
    world.place(shape, None);
    let accel = EmbreeAccel::build(&world, &BuildOptions::default()).expect("built");
    assert!(accel.bounds().is_empty(), "nothing is left: {:?}", accel.bounds());
    assert!(!accel.occluded(&rays[0]), "nothing is hit");
}

#[test]
fn boxes_are_asked_for_once_and_panics_in_them_come_out_of_the_build() {
    let mut row = Row::new((0..2000).map(cell).collect());
    row.fickle = true;
    let asked = row.asked.clone();
    let mut world = World::default();
    let shape = world.add_shape(Shape::Surface(Arc::new(row)));
    for i in 0..20_u8 {
        let up = Affine3A::from_translation(Vec3::Z * f32::from(i % 5));
        world.place(shape, Transform::new(up).expect("invertible"));
    }
    let accel = EmbreeAccel::build(&world, &BuildOptions::default()).expect("built");
    assert_eq!(asked.load(Ordering::Relaxed), 2000, "once for each primitive");
    let hits = (0..2000_u16).filter(|&i| {
        let hit = accel.intersect(&Ray::new(Vec3::new(f32::from(i) + 0.5, 0.0, 9.0), -Vec3::Z));
        hit.is_some_and(|hit| hit.prim == u32::from(i))
    });
    assert_eq!(hits.count(), 2000, "all are there");

    #[derive(Debug)]
    struct Boxless;
    impl Surface for Boxless {
        fn primitive_bounds(&self, _prim: u32) -> Aabb {
            panic_any(Why("no box"))
        }
        fn intersect(&self, _prim: u32, _ray: &Ray) -> Option<ShapeHit> {
            None
        }
        fn point(&self, prim: u32, ray: &Ray, hit: &ShapeHit) -> SurfacePoint {
            Touchy.point(prim, ray, hit)
        }
    }
    let mut world = World::default();
    let shape = world.add_shape(Shape::Surface(Arc::new(Boxless)));
    world.place(shape, None);
    let payload = panic_of(|| EmbreeAccel::build(&world, &BuildOptions::default())).expect("a panic");
    assert_eq!(payload.downcast_ref::<Why>(), Some(&Why("no box")), "the payload");
}

#[test]
fn surfaces_are_dropped_once_when_the_scene_is_gone() {
    let row = Row::new((0..50).map(cell).collect());
    let dropped = row.dropped.clone();
    let count = || dropped.load(Ordering::Relaxed);
    let mut world = World::default();
    let shape = world.add_shape(Shape::Surface(Arc::new(row)));
    for i in 0..40_u8 {
        let pose = Affine3A::from_translation(Vec3::Z * f32::from(i));
        world.place(shape, Transform::new(pose).expect("invertible"));
    }
    world.place(shape, None);
    let accel = EmbreeAccel::build(&world, &BuildOptions::default()).expect("built");
    let again = EmbreeAccel::build(&world, &BuildOptions::default()).expect("built");
    drop(world);
    assert_eq!(count(), 0, "the scenes keep it");
    let ray = Ray::new(Vec3::new(3.5, 0.0, 99.0), -Vec3::Z);
    for _ in 0..1000 {
        assert_eq!(accel.intersect(&ray).map(|hit| hit.prim), Some(3), "it is there");
    }
    assert_eq!(count(), 0, "and a query drops nothing");
    drop(accel);
    assert!(again.occluded(&ray), "the other scene has it still");
    assert_eq!(count(), 0, "the other scene keeps it");
    drop(again);
    assert_eq!(count(), 1, "dropped once");

    let row = Row::new(vec![cell(0)]);
    let dropped = row.dropped.clone();
    let device = Device::new(Config::default()).expect("device");
    let shape = UserShape::new(Shape::Surface(Arc::new(row)), None);
    let geometry = Geometry::surface(&device, shape.clone()).expect("made");
    drop(geometry.with_filter(Arc::new(Touchy)).expect("filtered"));
    assert_eq!(dropped.load(Ordering::Relaxed), 0, "kept by the handle");
    let other = Geometry::surface(&device, shape).expect("made");
    let mut open = Scene::new(&device, SceneOptions::default()).expect("scene");
    open.attach(0, other).expect("attached");
    drop(open);
    assert_eq!(dropped.load(Ordering::Relaxed), 1, "dropped with a scene that was never committed");
}

#[test]
fn geometries_refuse_what_they_cannot_do() {
    let device = Device::new(Config::default()).expect("device");
    let scene = || {
        let mut open = Scene::new(&device, SceneOptions::default()).expect("scene");
        open.attach(0, Geometry::spheres(&device, &[BALL]).expect("made")).expect("attached");
        Arc::new(open.commit().expect("committed"))
    };
    let most = vec![Affine3A::IDENTITY, Affine3A::from_translation(Vec3::X)];
    let most: Vec<Affine3A> = most.into_iter().cycle().take(MOST_KEYS).collect();
    let most = Pose::from(Motion::new(&most).expect("invertible"));
    let most = Geometry::instance(&device, scene(), &most).expect("as many keys as can be");
    let only = |geometry: Result<Geometry, EmbreeError>| geometry.and_then(|geometry| geometry.with_mask(1));
    let own = || Geometry::surface(&device, UserShape::new(Shape::Surface(Arc::new(Touchy)), None));
    let masked = only(own()).and_then(|geometry| geometry.with_filter(Arc::new(Touchy))).expect("made");
    let mut open = Scene::new(&device, SceneOptions::default()).expect("scene");
    open.attach(0, masked).expect("attached");
    let committed = open.commit().expect("committed");
    let mut ray = rays(false)[0];
    assert!(committed.occluded(&ray), "seen");
    ray.mask = 2;
    assert!(!committed.occluded(&ray), "a filter leaves the mask as it was");
    let refused = most.with_filter(Arc::new(Touchy)).err();
    assert_eq!(refused, Some(EmbreeError::FilteredInstance), "a filter on an instance");
}
