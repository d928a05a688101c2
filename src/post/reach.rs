//! How many pixels a lobe covers, and how much of the world a pixel does.
//!
//! Kulikova and Dmitriev's radius: seen from the mirrored eye, s + r away, the lobe of half angle Q about a ray of length r covers an angle of
//! Q / (1 + s / r); their equations (4) and (5). It takes reflector and receiver for flat and seen straight on. The other one looks at
//! where the rays of neighbouring pixels end: differentials of rays as differences of what was traced anyway. It is the same where
//! theirs is right, an ellipse where the receiver is tilted, and follows curved reflectors, which spread or gather rays.

use super::gbuffer::{End, GBuffer, Mirror};
use super::lobe::Lobe;
use super::settings::{Fuzzy, Radius};
use glam::Vec3;

/// Steps to both sides that are more unlike than this ratio, squared, stand on an edge: the shorter one counts.
const UNLIKE: f32 = 4.0;

/// Beyond this angle, in radians, the radius of a lobe in a plane is not told by its tangent.
const WIDEST: f32 = 1.4;

/// Half the width and half the height of the window of a pixel, in pixels; zero for a mirrored ray without a length.
pub(super) fn reach(
    g: &GBuffer,
    [x, y]: [u32; 2],
    mirror: &Mirror,
    (lobe, fuzzy): (&Lobe, &Fuzzy),
) -> [f32; 2] {
    let cone = cone(g.scale, mirror, lobe);
    let found = match fuzzy.radius {
        Radius::Cone => None,
        Radius::Differential if cone > 0.0 => ellipse(g, [x, y], mirror, lobe),
        Radius::Differential => None,
    };
    found.unwrap_or([cone; 2]).map(|radius| radius.min(fuzzy.max_radius))
}

/// The radius by distances alone.
fn cone(scale: f32, mirror: &Mirror, lobe: &Lobe) -> f32 {
    let r = mirror.length();
    if r.is_nan() || r <= 0.0 {
        return 0.0;
    }
    // At r infinite the ratio is zero.
    let alpha = lobe.angle() / (1.0 + mirror.s / r);
    alpha.min(1.55).tan() * scale
}

/// Half the extents of the ellipse of pixels whose rays end within the lobe; `None` where neighbours do not tell.
fn ellipse(g: &GBuffer, at: [u32; 2], mirror: &Mirror, lobe: &Lobe) -> Option<[f32; 2]> {
    let w = mirror.direction()?;
    let turn = |other: &Mirror| {
        let d = match other.end {
            End::At(b) => (b - mirror.a).try_normalize()?,
            End::Away(d) => d,
        };
        Some(d - w)
    };
    let [u, v] = steps(g, at, mirror, turn);
    let (u, v) = (u?, v?);
    // The pixels (i, j) with |i u + j v| below the radius of the lobe in a plane straight ahead, which is more than its chord.
    let (uu, uv, vv) = (u.dot(u), u.dot(v), v.dot(v));
    let determinant = uu * vv - uv * uv;
    let radius2 = lobe.angle().min(WIDEST).tan().powi(2);
    let extents = [radius2 * vv / determinant, radius2 * uu / determinant].map(f32::sqrt);
    (determinant > 1e-6 * uu * vv && extents.iter().all(|x| x.is_finite())).then_some(extents)
}

/// The area about the end of a pixel's ray that is the pixel's, as a vector along its normal; of rays without an end, the solid angle of
/// their directions.
pub(super) fn area(g: &GBuffer, at: [u32; 2], mirror: &Mirror) -> Vec3 {
    let step = |other: &Mirror| match (mirror.end, other.end) {
        (End::At(b), End::At(other)) => Some(other - b),
        (End::Away(d), End::Away(other)) => Some(other - d),
        _ => None,
    };
    let found = match steps(g, at, mirror, step) {
        [Some(u), Some(v)] => u.cross(v),
        _ => Vec3::ZERO,
    };
    if found.is_finite() && found != Vec3::ZERO {
        return found;
    }
    // As if all were flat and straight on.
    let w = mirror.direction().unwrap_or(Vec3::Z);
    let side = if let End::At(_) = mirror.end { mirror.s + mirror.length() } else { 1.0 };
    w * (side / g.scale).powi(2)
}

/// The change of something per pixel to the right and downwards, from the neighbours of the same reflector; `None` where there
/// are none. `change` tells it for a neighbour to the right or below.
fn steps(
    g: &GBuffer,
    [x, y]: [u32; 2],
    mirror: &Mirror,
    change: impl Fn(&Mirror) -> Option<Vec3>,
) -> [Option<Vec3>; 2] {
    let of = |x: Option<u32>, y: Option<u32>| {
        let other = g.texel(x?, y?)?.mirror.as_ref()?;
        (other.reflector == mirror.reflector && other.normal.dot(mirror.normal) > 0.5).then_some(other)
    };
    let between = |before: Option<&Mirror>, after: Option<&Mirror>| {
        // Among neighbours, those that end on the same thing.
        let same = |other: &&Mirror| other.hit == mirror.hit;
        let alike = before.filter(same).is_some() || after.filter(same).is_some();
        let kept = |other: Option<&Mirror>| change(other.filter(|other| !alike || same(other))?);
        match (kept(before).map(|step| -step), kept(after)) {
            (Some(a), Some(b)) => {
                let (a2, b2) = (a.length_squared(), b.length_squared());
                if a2 > UNLIKE * b2 {
                    Some(b)
                } else if b2 > UNLIKE * a2 {
                    Some(a)
                } else {
                    Some((a + b) * 0.5)
                }
            }
            (one, other) => one.or(other),
        }
    };
    [
        between(of(x.checked_sub(1), Some(y)), of(Some(x + 1), Some(y))),
        between(of(Some(x), y.checked_sub(1)), of(Some(x), Some(y + 1))),
    ]
}
