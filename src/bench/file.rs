//! Rays in files, so that others can trace the same ones.
//!
//! All numbers are little endian.
//!
//! ```text
//! bytes  what
//! 8      the letters "SPECRAYS"
//! 4      version of the format, an unsigned number: 2
//! 8      primitives of the scene, an unsigned number, each instance counted: tells whether rays and scene belong together
//! 24     origin of the scene, three 64-bit floats x, y, z: what was taken from all places of its files. Rays and hits are counted
//!        from there, so a library of your own takes it from its meshes, or adds it to the origins of rays where it holds
//!        double precision. Zero unless the camera is far from the origin
//! 4      classes, an unsigned number, from 1 to 64
//! then of each class
//! 4      bytes of its name, from 1 to 64
//! n      its name, in UTF-8, without control characters
//! 8      rays, an unsigned number
//! then of each class, in the same order, nine arrays of 32-bit floats, a number for each ray
//!        origin x, y, z; direction x, y, z (of any length but zero); nearest parameter; farthest parameter (may be
//!        infinite), both in lengths of the direction; moment of the shutter, from 0 to 1
//! ```
//!
//! Nothing follows. Files that are not so are refused, with the first byte that is wrong, counted from 0. Version 1 has no origin, and is read
//! as with one of zero.

use super::rays::RaySet;
use crate::error::{Error, Place, Problem, Result};
use crate::geometry::Ray;
use crate::image::atomic;
use glam::{DVec3, Vec3};
use std::fs;
use std::io::{self, Write};
use std::path::Path;

const MAGIC: &[u8; 8] = b"SPECRAYS";
const VERSION: u32 = 2;
/// The last version without an origin.
const WITHOUT_ORIGIN: u32 = 1;
const MOST_CLASSES: u32 = 64;
const LONGEST_NAME: u32 = 64;
/// Numbers of a ray.
const ARRAYS: usize = 9;

/// Rays that belong to one scene.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Recording {
    /// Primitives of that scene, each instance counted.
    pub primitives: u64,
    /// What was taken from all places of that scene, in metres: rays are counted from there.
    pub origin: DVec3,
    /// The rays by class.
    pub sets: Vec<RaySet>,
}

/// The numbers of a ray, in the order of the arrays.
fn numbers(ray: &Ray) -> [f32; ARRAYS] {
    let ([ox, oy, oz], [dx, dy, dz]) = (ray.o.to_array(), ray.d.to_array());
    [ox, oy, oz, dx, dy, dz, ray.t_min, ray.t_max, ray.time]
}

/// Writes a recording, atomically.
pub fn write(path: &Path, recording: &Recording) -> Result<()> {
    atomic::write(path, |file| put(file, recording))
}

fn put(file: &mut impl Write, recording: &Recording) -> io::Result<()> {
    let count = |n: usize| u32::try_from(n).map_err(io::Error::other);
    file.write_all(MAGIC)?;
    file.write_all(&VERSION.to_le_bytes())?;
    file.write_all(&recording.primitives.to_le_bytes())?;
    for place in recording.origin.to_array() {
        file.write_all(&place.to_le_bytes())?;
    }
    file.write_all(&count(recording.sets.len())?.to_le_bytes())?;
    for RaySet { name, rays } in &recording.sets {
        file.write_all(&count(name.len())?.to_le_bytes())?;
        file.write_all(name.as_bytes())?;
        file.write_all(&(rays.len() as u64).to_le_bytes())?;
    }
    for set in &recording.sets {
        for array in 0..ARRAYS {
            for ray in &set.rays {
                file.write_all(&numbers(ray)[array].to_le_bytes())?;
            }
        }
    }
    Ok(())
}

/// Reads a recording. Fails with the place of the first byte that is not as it should be.
pub fn read(path: &Path) -> Result<Recording> {
    let bytes = fs::read(path).map_err(|source| match source.kind() {
        io::ErrorKind::NotFound | io::ErrorKind::IsADirectory => Error::from(
            Problem::at(Place::file(path), "there is no such file of rays").remedy("check the name"),
        ),
        _ => Error::Io { path: path.to_owned(), what: "cannot read", source },
    })?;
    let mut reader = Reader { bytes: &bytes, at: 0 };
    reader.recording().map_err(|Fault { at, what }| {
        let problem = Problem::at(Place::file(path), format!("byte {at}: {what}"));
        problem.remedy("give a file that `specula bench --record` wrote, whole").into()
    })
}

/// What is wrong, and where.
struct Fault {
    at: usize,
    what: String,
}

struct Reader<'a> {
    bytes: &'a [u8],
    at: usize,
}

impl<'a> Reader<'a> {
    fn take(&mut self, len: usize, what: &str) -> std::result::Result<&'a [u8], Fault> {
        let rest = &self.bytes[self.at..];
        let Some(taken) = rest.get(..len) else {
            let what = format!("the file ends within {what}: {} bytes of {len}", rest.len());
            return Err(Fault { at: self.bytes.len(), what });
        };
        self.at += len;
        Ok(taken)
    }

    fn array<const N: usize>(&mut self, what: &str) -> std::result::Result<[u8; N], Fault> {
        let mut array = [0; N];
        array.copy_from_slice(self.take(N, what)?);
        Ok(array)
    }

    /// An unsigned number within bounds.
    fn count(&mut self, least: u32, most: u32, what: &str) -> std::result::Result<u32, Fault> {
        let at = self.at;
        let number = u32::from_le_bytes(self.array(what)?);
        if (least..=most).contains(&number) {
            return Ok(number);
        }
        Err(Fault { at, what: format!("{what} is {number}, not from {least} to {most}") })
    }

    fn recording(&mut self) -> std::result::Result<Recording, Fault> {
        if self.take(MAGIC.len(), "the letters `SPECRAYS`")? != MAGIC {
            return Err(Fault {
                at: 0,
                what: "not a file of rays: it does not begin with `SPECRAYS`".to_owned(),
            });
        }
        let version = u32::from_le_bytes(self.array("the version")?);
        if !(WITHOUT_ORIGIN..=VERSION).contains(&version) {
            let what = format!("version {version}, not from {WITHOUT_ORIGIN} to {VERSION}");
            return Err(Fault { at: 8, what });
        }
        let primitives = u64::from_le_bytes(self.array("the number of primitives")?);
        let origin = if version > WITHOUT_ORIGIN { self.origin()? } else { DVec3::ZERO };
        let classes = self.count(1, MOST_CLASSES, "the number of classes")?;
        let heads = (0..classes).map(|_| self.head()).collect::<std::result::Result<Vec<_>, Fault>>()?;
        // Before anything of the size that a file claims is asked for.
        let claimed = heads.iter().fold(0_u64, |sum, (_, rays)| sum.saturating_add(*rays));
        let wanted = claimed.saturating_mul(4 * ARRAYS as u64);
        let there = (self.bytes.len() - self.at) as u64;
        if wanted > there {
            let what = format!("the file ends within the rays: {there} bytes of {wanted}");
            return Err(Fault { at: self.bytes.len(), what });
        }
        let sets = heads
            .into_iter()
            .map(|(name, count)| self.set(name, count))
            .collect::<std::result::Result<_, _>>()?;
        if self.at < self.bytes.len() {
            let what = format!("{} bytes follow the last ray", self.bytes.len() - self.at);
            return Err(Fault { at: self.at, what });
        }
        Ok(Recording { primitives, origin, sets })
    }

    /// What rays are counted from.
    fn origin(&mut self) -> std::result::Result<DVec3, Fault> {
        let mut origin = [0.0; 3];
        for place in &mut origin {
            let at = self.at;
            *place = f64::from_le_bytes(self.array("the origin")?);
            if !place.is_finite() {
                return Err(Fault { at, what: "the origin is not finite".to_owned() });
            }
        }
        Ok(origin.into())
    }

    /// Name and number of rays of a class.
    fn head(&mut self) -> std::result::Result<(String, u64), Fault> {
        let len = self.count(1, LONGEST_NAME, "the length of a name")?;
        let at = self.at;
        let name = str::from_utf8(self.take(len as usize, "the name of a class")?);
        let Some(name) = name.ok().filter(|name| !name.chars().any(char::is_control)) else {
            return Err(Fault { at, what: "the name of a class is not text".to_owned() });
        };
        Ok((name.to_owned(), u64::from_le_bytes(self.array("the number of rays")?)))
    }

    /// The rays of a class, whose size has been checked.
    fn set(&mut self, name: String, count: u64) -> std::result::Result<RaySet, Fault> {
        let start = self.at;
        let count =
            usize::try_from(count).map_err(|_| Fault { at: start, what: "too many rays".to_owned() })?;
        let arrays = (0..ARRAYS)
            .map(|_| Ok(self.take(4 * count, "the rays")?.chunks_exact(4)))
            .collect::<std::result::Result<Vec<_>, Fault>>()?;
        let at = |array: usize, i: usize| {
            let mut bytes = [0; 4];
            arrays[array].clone().nth(i).into_iter().for_each(|number| bytes.copy_from_slice(number));
            f32::from_le_bytes(bytes)
        };
        let ray = |i: usize| {
            let [o, d] = [0, 3].map(|first| Vec3::new(at(first, i), at(first + 1, i), at(first + 2, i)));
            let ray = Ray::new(o, d).starting(at(6, i)).until(at(7, i)).at_time(at(8, i));
            fault_of(&ray).map_or(Ok(ray), |(array, what)| {
                Err(Fault {
                    at: start + 4 * (array * count + i),
                    what: format!("ray {i} of `{name}`: {what}"),
                })
            })
        };
        let rays = (0..count).map(ray).collect::<std::result::Result<_, _>>()?;
        Ok(RaySet { name, rays })
    }
}

/// What keeps a ray from being traced, and in which array it is.
fn fault_of(ray: &Ray) -> Option<(usize, &'static str)> {
    let numbers = numbers(ray);
    if let Some(array) = (0..6).find(|&i| !numbers[i].is_finite()) {
        return Some((
            array,
            if array < 3 { "its origin is not finite" } else { "its direction is not finite" },
        ));
    }
    if ray.d == Vec3::ZERO {
        return Some((3, "its direction has no length"));
    }
    if !(ray.t_min.is_finite() && ray.t_min >= 0.0) {
        return Some((6, "its nearest parameter is not a number from 0 on"));
    }
    if ray.t_max.is_nan() || ray.t_max < ray.t_min {
        return Some((7, "its farthest parameter is before the nearest"));
    }
    (!(0.0..=1.0).contains(&ray.time)).then_some((8, "its moment is not from 0 to 1"))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn recording() -> Recording {
        let ray = |x: f32| Ray::new(Vec3::X * x, Vec3::new(0.5, -1.0, x)).at_time(0.25);
        let set = |name: &str, rays: Vec<Ray>| RaySet { name: name.to_owned(), rays };
        let sets = vec![set("primary", vec![ray(1.0), ray(2.0).until(7.5)]), set("mine", vec![ray(3.0)])];
        Recording { primitives: 12, origin: DVec3::new(1e7, -0.1, 0.0), sets }
    }

    fn bytes() -> Vec<u8> {
        let mut bytes = Vec::new();
        put(&mut bytes, &recording()).expect("memory");
        bytes
    }

    fn fault(bytes: &[u8]) -> String {
        match (Reader { bytes, at: 0 }).recording() {
            Ok(_) => "none".to_owned(),
            Err(Fault { at, what }) => format!("{at}: {what}"),
        }
    }

    #[test]
    fn what_is_written_is_read_again() {
        let dir = tempfile::tempdir().expect("a directory");
        let path = dir.path().join("a.rays");
        write(&path, &recording()).expect("written");
        assert_eq!(read(&path).expect("read"), recording(), "the same rays");
        // 48 bytes of head, two classes with names of 7 and 4 letters, three rays.
        assert_eq!(fs::read(&path).expect("there").len(), 48 + (12 + 7) + (12 + 4) + 3 * 36, "as documented");
    }

    #[test]
    fn files_of_the_first_version_count_from_zero() {
        let mut old = bytes();
        old[8] = 1;
        old.drain(20..44);
        let read = (Reader { bytes: &old, at: 0 }).recording().map_err(|Fault { at, what }| (at, what));
        assert_eq!(read, Ok(Recording { origin: DVec3::ZERO, ..recording() }), "all but the origin");
    }

    #[test]
    fn every_truncation_is_told() {
        let whole = bytes();
        assert_eq!(fault(&whole), "none", "whole");
        for len in 0..whole.len() {
            let told = fault(&whole[..len]);
            assert!(told.starts_with(&format!("{len}: the file ends within")), "{len} bytes: {told}");
        }
    }

    #[test]
    fn damage_is_told_with_its_byte() {
        let first_ray = 48 + 19 + 16;
        let nan = f32::NAN.to_le_bytes();
        let cases: [(usize, &[u8], &str); 11] = [
            (0, b"X", "0: not a file of rays"),
            (8, &[9], "8: version 9, not from 1 to 2"),
            (8, &[0], "8: version 0, not from 1 to 2"),
            (28, &f64::INFINITY.to_le_bytes(), "28: the origin is not finite"),
            (44, &[0], "44: the number of classes is 0"),
            (44, &[0xff; 4], "44: the number of classes is 4294967295"),
            (48, &[200], "48: the length of a name is 200"),
            (52, &[0xff], "52: the name of a class is not text"),
            (59, &[0xff; 8], &format!("{}: the file ends within the rays", first_ray + 3 * 36)),
            // The second array of the first class, its second ray.
            (first_ray + 12, &nan, &format!("{}: ray 1 of `primary`: its origin", first_ray + 12)),
            (
                first_ray + 2 * 36 + 32,
                &nan,
                &format!("{}: ray 0 of `mine`: its moment", first_ray + 2 * 36 + 32),
            ),
        ];
        for (at, damage, wanted) in cases {
            let mut bytes = bytes();
            bytes[at..at + damage.len()].copy_from_slice(damage);
            let told = fault(&bytes);
            assert!(told.starts_with(wanted), "{told}, not {wanted}");
        }
        let more = [bytes(), vec![0; 3]].concat();
        assert_eq!(fault(&more), format!("{}: 3 bytes follow the last ray", more.len() - 3), "more");
    }
}
