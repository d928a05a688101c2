//! Geometries, and the arrays that Embree keeps pointers to.

use super::after::After;
use super::device::Device;
use super::error::EmbreeError;
use super::faces::Faces;
use super::filter::{self, Sieve};
use super::mesh::{MeshArrays, Primitives, Vertices};
use super::scene::{Committed, Scene};
use super::surface::{self, UserShape};
use crate::geometry::{Disc, HitFilter, Pose, Sphere};
use embree4_sys as sys;
use std::ffi::c_void;
use std::ptr::NonNull;
use std::sync::Arc;

/// Something to attach to a scene: a mesh, spheres, discs, a shape that is asked for its own hits, or an instance.
/// Seen by every ray, unless told otherwise before it is attached; frozen then.
#[derive(Debug)]
pub struct Geometry {
    raw: NonNull<sys::RTCGeometryTy>,
    device: Device,
    /// Dropped after `raw` is released, and so alive for as long as Embree may read it.
    kept: Kept,
    /// Likewise.
    sieve: Option<Arc<Sieve>>,
}

/// What Embree keeps pointers to.
#[derive(Debug)]
enum Kept {
    Mesh(MeshArrays),
    Points { _centers: Box<[[f32; 4]]>, _normals: Box<[[f32; 4]]> },
    Surface(UserShape),
    Instance(Arc<Scene<Committed>>),
}

// SAFETY: "In general, API calls that access the same object are not thread-safe" (manual, introduction), but nothing
// ties an object to a thread, and a `Geometry` is only accessed by value or `&mut`, once it is made. What it keeps is
// `Send` by itself, as is asserted below.
unsafe impl Send for Geometry {}
// SAFETY: `&Geometry` gives access to no call of the library at all, and what it keeps is `Sync` by itself. Callbacks read
// what it keeps from whichever threads trace rays, as that allows.
unsafe impl Sync for Geometry {}

const _: () = {
    const fn may_go_anywhere<T: Send + Sync>() {}
    may_go_anywhere::<(Device, Kept, Option<Arc<Sieve>>)>();
};

impl Drop for Geometry {
    fn drop(&mut self) {
        // SAFETY: gives up the one reference of this handle; scenes hold theirs, and hold this handle longer.
        unsafe { sys::rtcReleaseGeometry(self.raw.as_ptr()) };
    }
}

impl Geometry {
    /// Indexed triangles, counter-clockwise seen from outside; both arrays are shared, not copied.
    ///
    /// Triangles without area, or with a vertex that is not finite, are never hit.
    pub fn triangles(
        device: &Device,
        vertices: Vertices,
        triangles: Arc<[[u32; 3]]>,
    ) -> Result<Self, EmbreeError> {
        Self::mesh(device, MeshArrays::of_triangles(vertices, triangles)?)
    }

    /// A mesh, moving or not; the arrays are shared, not copied. As [`Geometry::triangles`] otherwise.
    pub fn mesh(device: &Device, arrays: MeshArrays) -> Result<Self, EmbreeError> {
        let keys: Vec<View> =
            arrays.keys.iter().map(|key| View::of(key.as_slice(), sys::RTC_FORMAT_FLOAT3)).collect();
        let (kind, indices) = match &arrays.primitives {
            Primitives::Triangles(triangles) => {
                (sys::RTC_GEOMETRY_TYPE_TRIANGLE, View::of(triangles, sys::RTC_FORMAT_UINT3))
            }
            Primitives::Quads(quads, _) => {
                (sys::RTC_GEOMETRY_TYPE_QUAD, View::of(quads, sys::RTC_FORMAT_UINT4))
            }
        };
        let geometry = Self::new(device, kind, Kept::Mesh(arrays))?;
        geometry.set_key_count(keys.len());
        for (key, view) in (0..).zip(keys) {
            // SAFETY: the positions are owned by `kept`, stay where they are, and are padded.
            unsafe { geometry.share(sys::RTC_BUFFER_TYPE_VERTEX, key, view) };
        }
        // SAFETY: the indices are owned by `kept`, stay where they are, and all name vertices.
        unsafe { geometry.share(sys::RTC_BUFFER_TYPE_INDEX, 0, indices) };
        geometry.commit()
    }

    /// Spheres, hit from outside and from inside.
    pub fn spheres(device: &Device, spheres: &[Sphere]) -> Result<Self, EmbreeError> {
        let centers = spheres.iter().map(|s| s.center.extend(s.radius).to_array()).collect();
        Self::points(device, sys::RTC_GEOMETRY_TYPE_SPHERE_POINT, centers, Box::default())
    }

    /// Flat round discs, hit from both sides.
    pub fn discs(device: &Device, discs: &[Disc]) -> Result<Self, EmbreeError> {
        let centers = discs.iter().map(|d| d.center.extend(d.radius).to_array()).collect();
        let normals = discs.iter().map(|d| d.normal.extend(0.0).to_array()).collect();
        Self::points(device, sys::RTC_GEOMETRY_TYPE_ORIENTED_DISC_POINT, centers, normals)
    }

    /// A shape that is asked for its own hits, from the threads that trace rays. A panic in it comes out of the query.
    pub fn surface(device: &Device, shape: UserShape) -> Result<Self, EmbreeError> {
        let count = shape.primitive_count();
        let geometry = Self::new(device, sys::RTC_GEOMETRY_TYPE_USER, Kept::Surface(shape.clone()))?;
        let raw = geometry.raw();
        // SAFETY: the geometry is alive, as for all calls below, and no other thread has seen it.
        unsafe { sys::rtcSetGeometryUserPrimitiveCount(raw, count) };
        // SAFETY: the callback gets what it expects, by `ask`.
        unsafe { sys::rtcSetGeometryIntersectFunction(raw, Some(surface::intersect)) };
        // SAFETY: as above.
        unsafe { sys::rtcSetGeometryOccludedFunction(raw, Some(surface::occluded)) };
        geometry.ask(shape)
    }

    /// Has the callbacks of user geometry ask `shape`.
    fn ask(mut self, shape: UserShape) -> Result<Self, EmbreeError> {
        let user = shape.pointer();
        // SAFETY: the geometry is alive and not attached; `user` is what the callbacks expect, and kept.
        unsafe { sys::rtcSetGeometryUserData(self.raw(), user) };
        // SAFETY: as above.
        unsafe { sys::rtcSetGeometryBoundsFunction(self.raw(), Some(surface::bounds), user) };
        self.kept = Kept::Surface(shape);
        self.commit()
    }

    /// A whole scene, placed; its pose may move. The scene may be shared by many instances but have none itself.
    pub fn instance(device: &Device, scene: Arc<Scene<Committed>>, pose: &Pose) -> Result<Self, EmbreeError> {
        if !scene.device().is(device) {
            return Err(EmbreeError::OtherDevice);
        }
        if scene.has_instances() {
            return Err(EmbreeError::NestedInstance);
        }
        let raw_scene = scene.raw();
        let geometry = Self::new(device, sys::RTC_GEOMETRY_TYPE_INSTANCE, Kept::Instance(scene))?;
        let keys = pose.keys();
        geometry.set_key_count(keys.len());
        // SAFETY: both objects are of this device; the scene is committed and kept.
        unsafe { sys::rtcSetGeometryInstancedScene(geometry.raw(), raw_scene) };
        let format = sys::RTC_FORMAT_FLOAT3X4_COLUMN_MAJOR;
        for (step, key) in (0..).zip(&*keys) {
            let matrix = key.to_cols_array();
            // SAFETY: the format is that of the twelve numbers, which are copied during the call.
            unsafe { sys::rtcSetGeometryTransform(geometry.raw(), step, format, matrix.as_ptr().cast()) };
        }
        geometry.commit()
    }

    /// The same geometry, seen only by rays whose mask shares a bit with `mask`. Within an instance both masks count.
    pub fn with_mask(self, mask: u32) -> Result<Self, EmbreeError> {
        // SAFETY: the geometry is alive and not attached.
        unsafe { sys::rtcSetGeometryMask(self.raw(), mask) };
        self.commit()
    }

    /// The same geometry, of whose hits only those count that `filter` accepts. A panic in it comes out of the query.
    /// Instances take none: their members do.
    pub fn with_filter(self, filter: Arc<dyn HitFilter>) -> Result<Self, EmbreeError> {
        match &self.kept {
            // Embree leaves it to user geometry to filter its hits.
            Kept::Surface(shape) => {
                let shape = shape.filtered(filter);
                self.ask(shape)
            }
            Kept::Instance(_) => Err(EmbreeError::FilteredInstance),
            Kept::Mesh(_) | Kept::Points { .. } => self.with_sieve(filter),
        }
    }

    fn with_sieve(mut self, filter: Arc<dyn HitFilter>) -> Result<Self, EmbreeError> {
        let sieve = Sieve::new(filter, self.faces().cloned());
        let (raw, user) = (self.raw(), sieve.pointer());
        self.sieve = Some(sieve);
        // SAFETY: the geometry is alive, as for all calls below, and not attached; `user` is what the callback expects, and
        // kept.
        unsafe { sys::rtcSetGeometryUserData(raw, user) };
        // SAFETY: as above.
        unsafe { sys::rtcSetGeometryIntersectFilterFunction(raw, Some(filter::sift)) };
        // SAFETY: as above.
        unsafe { sys::rtcSetGeometryOccludedFilterFunction(raw, Some(filter::sift)) };
        self.commit()
    }

    /// The device that it was made by.
    pub(super) fn device(&self) -> &Device {
        &self.device
    }

    /// The handle, valid for as long as `self`.
    pub(super) fn raw(&self) -> sys::RTCGeometry {
        self.raw.as_ptr()
    }

    /// Whether it places another scene.
    pub(super) fn is_instance(&self) -> bool {
        self.instanced().is_some()
    }

    /// The scene that it places, if it is an instance.
    pub(super) fn instanced(&self) -> Option<&Arc<Scene<Committed>>> {
        if let Kept::Instance(scene) = &self.kept { Some(scene) } else { None }
    }

    /// What its primitives are, if they are faces of several triangles.
    pub(super) fn faces(&self) -> Option<&Faces> {
        match &self.kept {
            Kept::Mesh(MeshArrays { primitives: Primitives::Quads(_, faces), .. }) => Some(faces),
            _ => None,
        }
    }

    /// Whether queries run user code for it.
    pub(super) fn calls_back(&self) -> bool {
        match &self.kept {
            Kept::Surface(_) => true,
            Kept::Instance(scene) => scene.after().is_some_and(After::calls_back),
            Kept::Mesh(_) | Kept::Points { .. } => self.sieve.is_some(),
        }
    }

    fn points(
        device: &Device,
        kind: sys::RTCGeometryType,
        centers: Box<[[f32; 4]]>,
        normals: Box<[[f32; 4]]>,
    ) -> Result<Self, EmbreeError> {
        let center_view = View::of(&centers, sys::RTC_FORMAT_FLOAT4);
        let normal_view = View::of(&normals, sys::RTC_FORMAT_FLOAT3);
        let has_normals = !normals.is_empty();
        let geometry = Self::new(device, kind, Kept::Points { _centers: centers, _normals: normals })?;
        // SAFETY: the centres are owned by `kept`, stay where they are, and are 16 bytes each.
        unsafe { geometry.share(sys::RTC_BUFFER_TYPE_VERTEX, 0, center_view) };
        if has_normals {
            // SAFETY: the normals are owned by `kept`, stay where they are, and are 16 bytes each.
            unsafe { geometry.share(sys::RTC_BUFFER_TYPE_NORMAL, 0, normal_view) };
        }
        geometry.commit()
    }

    fn new(device: &Device, kind: sys::RTCGeometryType, kept: Kept) -> Result<Self, EmbreeError> {
        // SAFETY: the device is alive; an unsupported kind is an error, not undefined.
        let raw = unsafe { sys::rtcNewGeometry(device.raw(), kind) };
        device.check()?;
        let raw = NonNull::new(raw).ok_or_else(|| EmbreeError::Library("no geometry was made".to_owned()))?;
        // Embree's own default is one bit.
        // SAFETY: the geometry has just been made.
        unsafe { sys::rtcSetGeometryMask(raw.as_ptr(), u32::MAX) };
        Ok(Self { raw, device: device.clone(), kept, sieve: None })
    }

    /// At how many moments of the shutter it is given.
    fn set_key_count(&self, count: usize) {
        let count = u32::try_from(count).expect("meshes and motions have no more keys than Embree takes");
        // SAFETY: the geometry is alive and not yet committed.
        unsafe { sys::rtcSetGeometryTimeStepCount(self.raw(), count) };
    }

    /// Hands an array to Embree, at a moment of the shutter where it is one of several.
    ///
    /// # Safety
    /// The array behind the view outlives the geometry unchanged, and its last element is readable in 16 bytes if it
    /// is a vertex.
    unsafe fn share(&self, kind: sys::RTCBufferType, slot: u32, view: View) {
        let View { start, format, stride, count } = view;
        // SAFETY: the geometry is alive and not yet committed; the array is the caller's promise.
        unsafe { sys::rtcSetSharedGeometryBuffer(self.raw(), kind, slot, format, start, 0, stride, count) };
    }

    fn commit(self) -> Result<Self, EmbreeError> {
        // SAFETY: the geometry is alive and no other thread has seen it.
        unsafe { sys::rtcCommitGeometry(self.raw()) };
        self.device.check()?;
        Ok(self)
    }
}

/// An array as Embree is told of it.
struct View {
    start: *const c_void,
    format: sys::RTCFormat,
    stride: usize,
    count: usize,
}

impl View {
    fn of<T>(array: &[T], format: sys::RTCFormat) -> Self {
        Self { start: array.as_ptr().cast(), format, stride: size_of::<T>(), count: array.len() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::accel::embree::{Config, SceneOptions};
    use crate::geometry::Ray;
    use glam::Vec3;

    fn committed(device: &Device, geometry: Geometry) -> Scene<Committed> {
        let mut scene = Scene::new(device, SceneOptions::default()).expect("scene");
        scene.attach(0, geometry).expect("attach");
        scene.commit().expect("commit")
    }

    #[test]
    fn indices_are_checked() {
        let device = Device::new(Config::default()).expect("device");
        let vertices = Vertices::from(vec![Vec3::ZERO; 3]);
        let bad = Geometry::triangles(&device, vertices, Arc::new([[0, 1, 2], [2, 3, 0]]));
        assert_eq!(bad.err(), Some(EmbreeError::Index { triangle: 1, vertex: 3, count: 3 }), "refused");
    }

    #[test]
    fn arrays_live_as_long_as_the_scene() {
        let device = Device::new(Config::default()).expect("device");
        let vertices = Vertices::from(&[Vec3::ZERO, Vec3::X, Vec3::Y][..]);
        let triangles: Arc<[[u32; 3]]> = Arc::new([[0, 1, 2]]);
        let geometry = Geometry::triangles(&device, vertices.clone(), triangles.clone()).expect("mesh");
        let scene = committed(&device, geometry);
        assert_eq!(Arc::strong_count(&triangles), 2, "shared, not copied");
        drop(device);
        let hit = scene.intersect(&Ray::new(Vec3::new(0.25, 0.5, 1.0), -Vec3::Z)).expect("hit");
        assert!((hit.u - 0.25).abs() < 1e-6 && (hit.v - 0.5).abs() < 1e-6, "parameters {} {}", hit.u, hit.v);
        assert!(hit.ng.z > 0.0, "the normal is on the counter-clockwise side");
        drop(scene);
        assert_eq!(Arc::strong_count(&triangles), 1, "given back");
        assert_eq!(vertices.owners(), 1, "given back");
    }

    #[test]
    fn spheres_are_hit_from_both_sides_and_discs_too() {
        let device = Device::new(Config::default()).expect("device");
        let sphere = Sphere { center: Vec3::new(0.0, 0.0, 5.0), radius: 2.0 };
        let scene = committed(&device, Geometry::spheres(&device, &[sphere]).expect("sphere"));
        let outside = scene.intersect(&Ray::new(Vec3::ZERO, Vec3::Z)).expect("outside");
        assert!((outside.t - 3.0).abs() < 1e-5 && outside.ng.z < 0.0, "{outside:?}");
        let inside = scene.intersect(&Ray::new(sphere.center, Vec3::Z)).expect("inside");
        assert!((inside.t - 2.0).abs() < 1e-5 && inside.ng.z > 0.0, "{inside:?}");

        let disc = Disc { center: Vec3::new(0.0, 0.0, 5.0), normal: Vec3::Z, radius: 2.0 };
        let scene = committed(&device, Geometry::discs(&device, &[disc]).expect("disc"));
        for (from, d) in [(Vec3::X, Vec3::Z), (Vec3::new(1.0, 0.0, 9.0), -Vec3::Z)] {
            let hit = scene.intersect(&Ray::new(from, d)).expect("disc");
            assert!(hit.ng.z > 0.0, "its own normal, from either side: {hit:?}");
        }
        assert!(scene.intersect(&Ray::new(Vec3::X * 2.1, Vec3::Z)).is_none(), "outside the rim");
    }

    #[test]
    fn nothing_is_a_geometry_too() {
        let device = Device::new(Config::default()).expect("device");
        let mesh = Geometry::triangles(&device, Vertices::from(vec![]), Arc::new([])).expect("no triangles");
        assert!(!committed(&device, mesh).occluded(&Ray::new(Vec3::ZERO, Vec3::Z)), "nothing to hit");
        let spheres = Geometry::spheres(&device, &[]).expect("no spheres");
        assert!(!committed(&device, spheres).occluded(&Ray::new(Vec3::ZERO, Vec3::Z)), "nothing to hit");
        let discs = Geometry::discs(&device, &[]).expect("no discs");
        assert!(!committed(&device, discs).occluded(&Ray::new(Vec3::ZERO, Vec3::Z)), "nothing to hit");
    }
}
