//! Scenes: open to geometries first, committed and frozen after.
//!
//! Specula builds each once. Opening them again, taking geometries out and `SceneOptions::dynamic` are for programs that use the
//! library and change what they trace.

use super::after::After;
use super::device::Device;
use super::error::EmbreeError;
use super::geometry::Geometry;
use super::options::SceneOptions;
use crate::math::Aabb;
use embree4_sys as sys;
use glam::Vec3;
use std::any::Any;
use std::collections::BTreeMap;
use std::ffi::c_void;
use std::fmt;
use std::ops::ControlFlow;
use std::panic::{self, AssertUnwindSafe};
use std::ptr::NonNull;
use std::sync::{Mutex, PoisonError};

/// State of a [`Scene`] that takes geometries and answers nothing.
#[derive(Debug)]
pub struct Open(());

/// State of a [`Scene`] that answers queries and cannot change.
#[derive(Debug)]
pub struct Committed {
    bounds: Aabb,
    after: Option<Box<After>>,
}

/// A set of geometries with a hierarchy over them; the state is [`Open`] or [`Committed`].
#[derive(Debug)]
pub struct Scene<State> {
    handle: Handle,
    state: State,
}

/// The library's scene and what it refers to.
struct Handle {
    raw: NonNull<sys::RTCSceneTy>,
    device: Device,
    /// By geometry number; dropped after `raw` is released.
    geometries: BTreeMap<u32, Geometry>,
}

// SAFETY: nothing ties a scene to the thread that made it ("API calls that access the same object are not thread-safe"
// speaks of calls at the same time), and what it keeps is `Send`.
unsafe impl Send for Handle {}
// SAFETY: the only calls made through `&Handle` are ray queries on a committed scene: "performing ray queries in a scene
// is thread-safe" (manual, introduction). All others take the scene by value or `&mut`.
unsafe impl Sync for Handle {}

impl Drop for Handle {
    fn drop(&mut self) {
        // SAFETY: gives up the one reference of this handle; instances of this scene keep the handle alive.
        unsafe { sys::rtcReleaseScene(self.raw.as_ptr()) };
    }
}

impl fmt::Debug for Handle {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Handle").field("geometries", &self.geometries.len()).finish_non_exhaustive()
    }
}

/// Bounds to be overwritten; aligned by their type.
const NO_BOUNDS: sys::RTCBounds = sys::RTCBounds {
    lower_x: 0.0,
    lower_y: 0.0,
    lower_z: 0.0,
    align0: 0.0,
    upper_x: 0.0,
    upper_y: 0.0,
    upper_z: 0.0,
    align1: 0.0,
};

impl<State> Scene<State> {
    /// The device that it was made by.
    #[must_use]
    pub fn device(&self) -> &Device {
        &self.handle.device
    }

    /// The handle, valid for as long as `self`.
    pub(super) fn raw(&self) -> sys::RTCScene {
        self.handle.raw.as_ptr()
    }
}

impl Scene<Open> {
    /// A scene without geometries.
    pub fn new(device: &Device, options: SceneOptions) -> Result<Self, EmbreeError> {
        // SAFETY: the device is alive.
        let raw = unsafe { sys::rtcNewScene(device.raw()) };
        device.check()?;
        let raw = NonNull::new(raw).ok_or_else(|| EmbreeError::Library("no scene was made".to_owned()))?;
        let handle = Handle { raw, device: device.clone(), geometries: BTreeMap::new() };
        let scene = Self { handle, state: Open(()) };
        // SAFETY: the scene is alive and no other thread has seen it.
        unsafe { sys::rtcSetSceneFlags(scene.raw(), options.flags()) };
        // SAFETY: as above.
        unsafe { sys::rtcSetSceneBuildQuality(scene.raw(), options.quality()) };
        device.check()?;
        Ok(scene)
    }

    /// Adds a geometry under a number of the caller's choice, by which hits name it. Numbers should be compact: Embree
    /// keeps a table up to the largest.
    pub fn attach(&mut self, number: u32, geometry: Geometry) -> Result<(), EmbreeError> {
        if !geometry.device().is(self.device()) {
            return Err(EmbreeError::OtherDevice);
        }
        if number == sys::RTC_INVALID_GEOMETRY_ID || self.handle.geometries.contains_key(&number) {
            return Err(EmbreeError::GeometryNumber(number));
        }
        // SAFETY: both objects are alive and of one device; the geometry is kept as long as the scene.
        unsafe { sys::rtcAttachGeometryByID(self.raw(), geometry.raw(), number) };
        self.device().check()?;
        self.handle.geometries.insert(number, geometry);
        Ok(())
    }

    /// Removes a geometry and gives it back.
    pub fn detach(&mut self, number: u32) -> Result<Option<Geometry>, EmbreeError> {
        let Some(geometry) = self.handle.geometries.remove(&number) else { return Ok(None) };
        // SAFETY: the geometry was attached under this number.
        unsafe { sys::rtcDetachGeometry(self.raw(), number) };
        self.device().check()?;
        Ok(Some(geometry))
    }

    /// Builds the hierarchy, on the device's threads.
    pub fn commit(self) -> Result<Scene<Committed>, EmbreeError> {
        // SAFETY: the scene is alive and no other thread has it.
        unsafe { sys::rtcCommitScene(self.raw()) };
        self.device().check()?;
        let mut bounds = NO_BOUNDS;
        // SAFETY: the scene is committed, and the structure is aligned by its type.
        unsafe { sys::rtcGetSceneBounds(self.raw(), &raw mut bounds) };
        self.device().check()?;
        let min = Vec3::new(bounds.lower_x, bounds.lower_y, bounds.lower_z);
        let max = Vec3::new(bounds.upper_x, bounds.upper_y, bounds.upper_z);
        let bounds = if min.cmple(max).all() { Aabb { min, max } } else { Aabb::EMPTY };
        let after = After::of(&self.handle.geometries);
        Ok(Scene { handle: self.handle, state: Committed { bounds, after } })
    }

    /// As [`Scene::commit`], telling `progress` the part done, from 0 to 1, now and then and from several threads at a
    /// time; it stops the build by answering `Break`.
    ///
    /// # Panics
    /// If `progress` does: the build is cancelled first.
    pub fn commit_with(
        self,
        progress: &(dyn Fn(f64) -> ControlFlow<()> + Sync),
    ) -> Result<Scene<Committed>, EmbreeError> {
        let monitor = Monitor { progress, panicked: Mutex::new(None) };
        let user = (&raw const monitor).cast_mut().cast::<c_void>();
        // SAFETY: `monitor` outlives the commit, after which the callback is taken away or the scene is gone.
        unsafe { sys::rtcSetSceneProgressMonitorFunction(self.raw(), Some(Monitor::call), user) };
        let committed = self.commit();
        if let Ok(scene) = &committed {
            // SAFETY: the scene is alive and not yet shared.
            unsafe { sys::rtcSetSceneProgressMonitorFunction(scene.raw(), None, std::ptr::null_mut()) };
        }
        let panicked = monitor.panicked.into_inner().unwrap_or_else(PoisonError::into_inner);
        if let Some(payload) = panicked {
            panic::resume_unwind(payload);
        }
        committed
    }
}

impl Scene<Committed> {
    /// A box around everything; empty if there is nothing.
    #[must_use]
    pub fn bounds(&self) -> Aabb {
        self.state.bounds
    }

    /// The library's own handle, as a number: for measuring what these types cost. It is good for as long as the scene.
    #[must_use]
    pub fn address(&self) -> usize {
        self.raw().expose_provenance()
    }

    /// Opens the scene again, to exchange geometries and commit anew.
    #[must_use]
    pub fn reopen(self) -> Scene<Open> {
        Scene { handle: self.handle, state: Open(()) }
    }

    /// What is left to do after each query, if anything.
    #[inline]
    pub(super) fn after(&self) -> Option<&After> {
        self.state.after.as_deref()
    }

    /// Whether it places other scenes.
    pub(super) fn has_instances(&self) -> bool {
        self.handle.geometries.values().any(Geometry::is_instance)
    }
}

/// A caller's progress function, and what it panicked with: a panic must not unwind into the library.
struct Monitor<'a> {
    progress: &'a (dyn Fn(f64) -> ControlFlow<()> + Sync),
    panicked: Mutex<Option<Box<dyn Any + Send>>>,
}

impl Monitor<'_> {
    /// The callback to register together with a pointer to the monitor.
    ///
    /// # Safety
    /// `monitor` points to a `Monitor` that lives.
    unsafe extern "C" fn call(monitor: *mut c_void, done: f64) -> bool {
        // SAFETY: the caller's promise.
        let monitor = unsafe { &*monitor.cast::<Self>() };
        match panic::catch_unwind(AssertUnwindSafe(|| (monitor.progress)(done))) {
            Ok(answer) => answer.is_continue(),
            Err(payload) => {
                *monitor.panicked.lock().unwrap_or_else(PoisonError::into_inner) = Some(payload);
                false
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::accel::embree::{Config, Vertices};
    use crate::geometry::{Pose, Ray, Sphere};
    use std::sync::Arc;

    fn device() -> Device {
        Device::new(Config::default()).expect("device")
    }

    fn sphere(device: &Device, x: f32) -> Geometry {
        Geometry::spheres(device, &[Sphere { center: Vec3::X * x, radius: 1.0 }]).expect("sphere")
    }

    /// A grid of `n * n` little squares, big enough for the builder to report progress.
    fn grid(device: &Device, n: u16) -> Geometry {
        let at = |i: u16| f32::from(i);
        let positions: Vec<Vec3> =
            (0..n).flat_map(|y| (0..n).map(move |x| Vec3::new(at(x), at(y), 0.0))).collect();
        let n = u32::from(n);
        let triangles: Arc<[[u32; 3]]> = (0..n - 1)
            .flat_map(|y| (0..n - 1).map(move |x| y * n + x))
            .flat_map(|i| [[i, i + 1, i + n], [i + 1, i + n + 1, i + n]])
            .collect();
        Geometry::triangles(device, Vertices::from(positions), triangles).expect("grid")
    }

    fn open(device: &Device) -> Scene<Open> {
        Scene::new(device, SceneOptions::default()).expect("scene")
    }

    #[test]
    fn an_empty_scene_is_never_hit() {
        let scene = open(&device()).commit().expect("commit");
        assert!(scene.bounds().is_empty(), "bounds {:?}", scene.bounds());
        assert!(scene.intersect(&Ray::new(Vec3::ZERO, Vec3::X)).is_none(), "hit");
        assert!(!scene.occluded(&Ray::new(Vec3::ZERO, Vec3::X)), "occluded");
    }

    #[test]
    fn geometries_are_exchanged_between_commits() {
        let device = device();
        let options = SceneOptions { dynamic: true, ..SceneOptions::default() };
        let mut scene = Scene::new(&device, options).expect("scene");
        scene.attach(3, sphere(&device, 5.0)).expect("attach");
        let ray = Ray::new(Vec3::ZERO, Vec3::X);
        let scene = scene.commit().expect("commit");
        let hit = scene.intersect(&ray).expect("hit");
        assert_eq!((hit.placement.0, hit.prim), (3, 0), "identity");
        assert!((hit.t - 4.0).abs() < 1e-5, "distance {}", hit.t);

        let mut scene = scene.reopen();
        assert!(scene.detach(3).expect("detach").is_some(), "it was there");
        assert!(scene.detach(3).expect("detach").is_none(), "it is gone");
        scene.attach(0, sphere(&device, 9.0)).expect("attach");
        let hit = scene.commit().expect("commit").intersect(&ray).expect("hit");
        assert_eq!(hit.placement.0, 0, "identity");
        assert!((hit.t - 8.0).abs() < 1e-5, "distance {}", hit.t);
    }

    #[test]
    fn a_number_names_one_geometry() {
        let device = device();
        let mut scene = open(&device);
        scene.attach(0, sphere(&device, 0.0)).expect("attach");
        assert_eq!(scene.attach(0, sphere(&device, 0.0)), Err(EmbreeError::GeometryNumber(0)), "taken");
        let last = sys::RTC_INVALID_GEOMETRY_ID;
        assert_eq!(
            scene.attach(last, sphere(&device, 0.0)),
            Err(EmbreeError::GeometryNumber(last)),
            "no number"
        );
    }

    #[test]
    fn devices_do_not_mix() {
        let (one, other) = (device(), device());
        assert_eq!(open(&one).attach(0, sphere(&other, 0.0)), Err(EmbreeError::OtherDevice), "attached");
        let inner = Arc::new(open(&one).commit().expect("commit"));
        let instance = Geometry::instance(&other, inner, &Pose::World);
        assert_eq!(instance.err(), Some(EmbreeError::OtherDevice), "instanced");
    }

    #[test]
    fn instances_do_not_nest() {
        let device = device();
        let mut inner = open(&device);
        inner.attach(0, sphere(&device, 0.0)).expect("attach");
        let inner = Arc::new(inner.commit().expect("commit"));
        let mut outer = open(&device);
        outer.attach(7, Geometry::instance(&device, inner, &Pose::World).expect("instance")).expect("attach");
        let outer = outer.commit().expect("commit");
        let hit = outer.intersect(&Ray::new(-Vec3::X * 3.0, Vec3::X)).expect("hit");
        assert_eq!(hit.placement.0, 7, "named by the instance");
        let twice = Geometry::instance(&device, Arc::new(outer), &Pose::World);
        assert_eq!(twice.err(), Some(EmbreeError::NestedInstance), "nested");
    }

    #[test]
    fn memory_is_counted_and_given_back() {
        let device = device();
        let mut scene = open(&device);
        scene.attach(0, grid(&device, 100)).expect("attach");
        let scene = scene.commit().expect("commit");
        let bytes = device.bytes();
        assert!(bytes > 9801 * 2 * 20, "a hierarchy over 19602 triangles in {bytes} bytes");
        drop(scene);
        assert!(device.bytes() < bytes / 10, "{} of {bytes} bytes kept", device.bytes());
    }

    #[test]
    fn builds_report_progress_and_can_be_cancelled() {
        let device = device();
        let calls = Mutex::new(Vec::new());
        let mut scene = open(&device);
        scene.attach(0, grid(&device, 400)).expect("attach");
        let count = |done| {
            calls.lock().expect("lock").push(done);
            ControlFlow::Continue(())
        };
        let scene = scene.commit_with(&count).expect("commit");
        let calls = calls.into_inner().expect("lock");
        assert!(!calls.is_empty(), "no progress");
        assert!(calls.iter().all(|done| (0.0..=1.0).contains(done)), "out of range: {calls:?}");
        assert!(scene.occluded(&Ray::new(Vec3::new(7.3, 8.2, 1.0), -Vec3::Z)), "built");

        let mut scene = open(&device);
        scene.attach(0, grid(&device, 400)).expect("attach");
        let cancelled = scene.commit_with(&|_| ControlFlow::Break(()));
        assert_eq!(cancelled.err(), Some(EmbreeError::Cancelled), "cancelled");
    }

    #[test]
    fn a_panic_in_the_progress_function_comes_out_of_the_commit() {
        let device = device();
        let mut scene = open(&device);
        scene.attach(0, grid(&device, 400)).expect("attach");
        let outcome = panic::catch_unwind(AssertUnwindSafe(|| scene.commit_with(&|_| panic!("enough"))));
        let payload = outcome.expect_err("it panicked");
        assert_eq!(payload.downcast_ref::<&str>(), Some(&"enough"), "the payload");
        assert_eq!(device.check(), Ok(()), "no error is left behind");
    }

    #[test]
    fn errors_stay_with_their_thread() {
        let device = device();
        let mut scene = open(&device);
        scene.attach(0, grid(&device, 400)).expect("attach");
        let failed = std::thread::scope(|s| {
            s.spawn(|| scene.commit_with(&|_| ControlFlow::Break(())).is_err()).join().expect("joined")
        });
        assert!(failed, "cancelled over there");
        assert!(open(&device).commit().is_ok(), "but not here");
    }
}
