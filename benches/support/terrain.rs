//! A procedural landscape: as many triangles as wanted, and few of them hidden.
//!
//! Heights are a sum of octaves of value noise, each of half the size and a little less than half the height of the
//! one before (Musgrave 1994, in Texturing and Modeling, chapter 14), ridged so that slopes vary.

#![allow(dead_code, reason = "each bench uses a part")]

use glam::Vec3;
use specula::geometry::Mesh;
use specula::sampling::pcg::pcg2d;

/// A square landscape of side 2 about the origin, y upwards, of `2 * cells * cells` triangles; the same for the same
/// `cells`.
pub(crate) fn terrain(cells: u32) -> Mesh {
    let step = 2.0 / cells as f32;
    let at = |i: u32| i as f32 * step - 1.0;
    let positions = (0..=cells)
        .flat_map(|j| (0..=cells).map(move |i| (at(i), at(j))))
        .map(|(x, z)| Vec3::new(x, height(x, z), z))
        .collect();
    let row = cells + 1;
    let triangles = (0..cells)
        .flat_map(|j| (0..cells).map(move |i| j * row + i))
        .flat_map(|i| [[i, i + row, i + 1], [i + 1, i + row, i + row + 1]])
        .collect();
    Mesh::new(positions, triangles).expect("indices name vertices of the grid")
}

/// A place a little above a corner of the landscape, and its middle.
pub(crate) fn view() -> (Vec3, Vec3) {
    (Vec3::new(0.9, height(0.9, 0.9) + 0.25, 0.9), Vec3::new(0.0, 0.2, 0.0))
}

/// Height of the landscape, between 0 and about 0.6.
pub(crate) fn height(x: f32, z: f32) -> f32 {
    let mut sum = 0.0;
    let (mut size, mut weight) = (2.0, 0.25);
    for octave in 0..9 {
        let ridge = 1.0 - (2.0 * value_noise(x * size, z * size, octave) - 1.0).abs();
        sum += weight * ridge * ridge;
        size *= 2.0;
        weight *= 0.45;
    }
    sum
}

/// Noise in [0, 1) with features of size one: random values on a grid, joined smoothly.
fn value_noise(x: f32, z: f32, octave: i32) -> f32 {
    let (x0, z0) = (x.floor(), z.floor());
    let fade = |t: f32| t * t * (3.0 - 2.0 * t);
    let (fx, fz) = (fade(x - x0), fade(z - z0));
    #[expect(clippy::cast_possible_truncation, reason = "the landscape has few grid points")]
    let (i, j) = (x0 as i32, z0 as i32 + 4096 * octave);
    let corner = |di: i32, dj: i32| {
        let [h, _] = pcg2d([(i + di).cast_unsigned(), (j + dj).cast_unsigned()]);
        (h >> 8) as f32 / 16_777_216.0
    };
    let mix = |a: f32, b: f32, t: f32| a + (b - a) * t;
    mix(mix(corner(0, 0), corner(1, 0), fx), mix(corner(0, 1), corner(1, 1), fx), fz)
}
