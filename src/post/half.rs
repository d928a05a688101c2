//! Half resolution: windows of every other row and column, and the rest between them.
//!
//! Joint bilateral upsampling (Kopf, Cohen, Lischinski and Uyttendaele 2007): the four filtered pixels around one count by how near
//! they are, and only if they show the same face of the same reflector with a window of about the same size. Where less than half
//! of the weight is left, the pixel has a window of its own.

use super::gbuffer::{GBuffer, Mirror};

/// Windows that are more unlike than this ratio are not mixed.
const UNLIKE: f32 = 1.25;

/// The square of the chord between normals up to which pixels are mixed.
const TURNED: f32 = 0.01;

/// Up to four pixels, by column and row, and their weights.
pub(super) type Corners = [([u32; 2], f32); 4];

/// Whether a pixel is one of those that are filtered.
pub(super) fn is_kept([x, y]: [u32; 2]) -> bool {
    x.is_multiple_of(2) && y.is_multiple_of(2)
}

/// The filtered pixels around one that is not, with weights that sum to 1; `None` if too little fits. `radius` tells the window of a
/// filtered pixel, if it has one.
pub(super) fn corners(
    g: &GBuffer,
    [x, y]: [u32; 2],
    (mirror, own): (&Mirror, [f32; 2]),
    radius: impl Fn([u32; 2]) -> Option<[f32; 2]>,
) -> Option<Corners> {
    let [left, top] = [x & !1, y & !1];
    let [right, below] = [x & 1, y & 1].map(|odd| if odd == 1 { 0.5 } else { 0.0 });
    let mut corners = [
        ([left, top], (1.0 - right) * (1.0 - below)),
        ([left + 2, top], right * (1.0 - below)),
        ([left, top + 2], (1.0 - right) * below),
        ([left + 2, top + 2], right * below),
    ];
    let fits = |at: [u32; 2]| {
        let other = g.texel(at[0], at[1])?.mirror.as_ref()?;
        let theirs = radius(at)?;
        let alike = |i: usize| theirs[i] < UNLIKE * own[i] && own[i] < UNLIKE * theirs[i];
        let is_same =
            other.reflector == mirror.reflector && other.exponent.to_bits() == mirror.exponent.to_bits();
        let is_flat = other.normal.distance_squared(mirror.normal) < TURNED;
        (is_same && is_flat && alike(0) && alike(1)).then_some(())
    };
    for (at, weight) in &mut corners {
        if *weight > 0.0 && fits(*at).is_none() {
            *weight = 0.0;
        }
    }
    let sum: f32 = corners.iter().map(|(_, weight)| weight).sum();
    if sum < 0.5 {
        return None;
    }
    corners.iter_mut().for_each(|(_, weight)| *weight /= sum);
    Some(corners)
}
