//! Geometries, and the arrays that Embree keeps pointers to.

use super::device::Device;
use super::error::EmbreeError;
use super::scene::{Committed, Scene};
use crate::geometry::{Disc, Sphere};
use embree4_sys as sys;
use glam::{Affine3A, Vec3};
use std::fmt;
use std::ptr::NonNull;
use std::sync::Arc;

/// Vertex positions that Embree can read in place: "the last buffer element must be readable using 16-byte SSE load
/// instructions", so one more position lies behind the last. Cheap to clone; made from an array by copying it once.
#[derive(Clone, PartialEq)]
pub struct Vertices {
    padded: Arc<[Vec3]>,
}

impl Vertices {
    /// The positions.
    #[must_use]
    pub fn as_slice(&self) -> &[Vec3] {
        &self.padded[..self.padded.len() - 1]
    }
}

impl From<&[Vec3]> for Vertices {
    fn from(positions: &[Vec3]) -> Self {
        Self { padded: positions.iter().copied().chain([Vec3::ZERO]).collect() }
    }
}

impl From<Vec<Vec3>> for Vertices {
    fn from(mut positions: Vec<Vec3>) -> Self {
        positions.push(Vec3::ZERO);
        Self { padded: positions.into() }
    }
}

impl fmt::Debug for Vertices {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Vertices").field("len", &self.as_slice().len()).finish()
    }
}

/// Something to attach to a scene: triangles, spheres, discs or an instance. Frozen once made.
#[derive(Debug)]
pub struct Geometry {
    raw: NonNull<sys::RTCGeometryTy>,
    device: Device,
    /// Dropped after `raw` is released, and so alive for as long as Embree may read it.
    kept: Kept,
}

/// What Embree keeps pointers to.
#[derive(Debug)]
enum Kept {
    Triangles { _vertices: Vertices, _triangles: Arc<[[u32; 3]]> },
    Points { _centers: Box<[[f32; 4]]>, _normals: Box<[[f32; 4]]> },
    Instance { _scene: Arc<Scene<Committed>> },
}

// SAFETY: "In general, API calls that access the same object are not thread-safe" (manual, introduction), but nothing
// ties an object to a thread, and a `Geometry` is only accessed by value or `&mut`, once it is made.
unsafe impl Send for Geometry {}
// SAFETY: `&Geometry` gives access to no call at all.
unsafe impl Sync for Geometry {}

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
        let count = vertices.as_slice().len();
        for (triangle, corners) in triangles.iter().enumerate() {
            if let Some(&vertex) = corners.iter().find(|&&vertex| vertex as usize >= count) {
                return Err(EmbreeError::Index { triangle, vertex, count });
            }
        }
        let position_view = View::of(vertices.as_slice(), sys::RTC_FORMAT_FLOAT3);
        let triangle_view = View::of(&triangles, sys::RTC_FORMAT_UINT3);
        let kept = Kept::Triangles { _vertices: vertices, _triangles: triangles };
        let geometry = Self::new(device, sys::RTC_GEOMETRY_TYPE_TRIANGLE, kept)?;
        // SAFETY: the positions are owned by `kept`, stay where they are, and are padded.
        unsafe { geometry.share(sys::RTC_BUFFER_TYPE_VERTEX, position_view) };
        // SAFETY: the indices are owned by `kept`, stay where they are, and all name vertices.
        unsafe { geometry.share(sys::RTC_BUFFER_TYPE_INDEX, triangle_view) };
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

    /// A whole scene, moved. The scene may be shared by many instances but have none itself.
    pub fn instance(
        device: &Device,
        scene: Arc<Scene<Committed>>,
        world_from_object: &Affine3A,
    ) -> Result<Self, EmbreeError> {
        if !scene.device().is(device) {
            return Err(EmbreeError::OtherDevice);
        }
        if scene.has_instances() {
            return Err(EmbreeError::NestedInstance);
        }
        let raw_scene = scene.raw();
        let matrix = world_from_object.to_cols_array();
        let geometry = Self::new(device, sys::RTC_GEOMETRY_TYPE_INSTANCE, Kept::Instance { _scene: scene })?;
        // SAFETY: both objects are of this device; the scene is committed and kept.
        unsafe { sys::rtcSetGeometryInstancedScene(geometry.raw(), raw_scene) };
        let format = sys::RTC_FORMAT_FLOAT3X4_COLUMN_MAJOR;
        // SAFETY: the format is that of the twelve numbers, which are copied during the call.
        unsafe { sys::rtcSetGeometryTransform(geometry.raw(), 0, format, matrix.as_ptr().cast()) };
        geometry.commit()
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
        matches!(self.kept, Kept::Instance { .. })
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
        unsafe { geometry.share(sys::RTC_BUFFER_TYPE_VERTEX, center_view) };
        if has_normals {
            // SAFETY: the normals are owned by `kept`, stay where they are, and are 16 bytes each.
            unsafe { geometry.share(sys::RTC_BUFFER_TYPE_NORMAL, normal_view) };
        }
        geometry.commit()
    }

    fn new(device: &Device, kind: sys::RTCGeometryType, kept: Kept) -> Result<Self, EmbreeError> {
        // SAFETY: the device is alive; an unsupported kind is an error, not undefined.
        let raw = unsafe { sys::rtcNewGeometry(device.raw(), kind) };
        device.check()?;
        let raw = NonNull::new(raw).ok_or_else(|| EmbreeError::Library("no geometry was made".to_owned()))?;
        Ok(Self { raw, device: device.clone(), kept })
    }

    /// Hands an array to Embree.
    ///
    /// # Safety
    /// The array behind the view outlives the geometry unchanged, and its last element is readable in 16 bytes if it
    /// is a vertex.
    unsafe fn share(&self, kind: sys::RTCBufferType, view: View) {
        let View { start, format, stride, count } = view;
        // SAFETY: the geometry is alive and not yet committed; the array is the caller's promise.
        unsafe { sys::rtcSetSharedGeometryBuffer(self.raw(), kind, 0, format, start, 0, stride, count) };
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
    start: *const std::ffi::c_void,
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
        assert_eq!(Arc::strong_count(&vertices.padded), 1, "given back");
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
