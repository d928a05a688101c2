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
    // At a right angle there is no radius.
    alpha(mirror, lobe).min(1.55).tan() * scale
}

/// Half the angle that the lobe covers as seen from the eye, in radians; 0 for a mirrored ray without a length.
fn alpha(mirror: &Mirror, lobe: &Lobe) -> f32 {
    let r = mirror.length();
    // At r infinite the ratio is zero.
    if r > 0.0 { lobe.angle() / (1.0 + mirror.s / r) } else { 0.0 }
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

/// The area about the end of a pixel's ray that is the pixel's, as a vector along its normal, on the side that the ray goes to, so that areas of
/// pixels add up; of rays without an end, the solid angle of their directions.
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
    let w = mirror.direction().unwrap_or(Vec3::Z);
    if found.is_finite() && found != Vec3::ZERO {
        // Where rays cross on their way, right and left change places.
        return if found.dot(w) < 0.0 { -found } else { found };
    }
    // As if all were flat and straight on.
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

#[cfg(test)]
mod tests {
    use super::super::gbuffer::Texel;
    use super::*;
    use crate::image::Window;

    fn mirror((a, normal): (Vec3, Vec3), (end, s): (End, f32)) -> Mirror {
        let (radiance, factor) = ([1.0; 3], [1.0; 3]);
        Mirror { radiance, factor, a, normal, end, s, reflector: 1, exponent: 1.0, strength: 1.0, hit: 1 }
    }

    #[test]
    fn the_cone_is_the_published_one() {
        // Ten degrees seen from a metre: by r the angle in degrees, and pixels of a picture of 1024 columns over 60 degrees, by hand.
        let table: [(f32, f32, f32); 5] = [
            (0.01, 0.099, 1.7),
            (0.1, 0.909, 15.5),
            (1.0, 5.0, 85.0),
            (10.0, 9.09, 155.0),
            (100.0, 9.90, 169.0),
        ];
        let lobe = Lobe::new(50.0, 0.01, 10_f32.to_radians());
        let scale = 512.0 / 30_f32.to_radians().tan();
        for (r, angle, pixels) in table {
            let mirror = mirror((Vec3::ZERO, Vec3::Z), (End::At(Vec3::Z * r), 1.0));
            let found = alpha(&mirror, &lobe).to_degrees();
            assert!((found / angle - 1.0).abs() < 3e-3, "r {r}: {found} degrees, not {angle}");
            // Published are pixels as equal angles, which they are not in a perspective picture: in its middle they are larger than on the mean.
            assert!((found * 1024.0 / 60.0 / pixels - 1.0).abs() < 7e-3, "r {r}: {pixels} equal pixels");
            let found = cone(scale, &mirror, &lobe);
            let wanted = f32::tan(angle.to_radians()) * scale;
            assert!((found / wanted - 1.0).abs() < 3e-3, "r {r}: {found} pixels, not {wanted}");
            let plain = Fuzzy { radius: Radius::Cone, ..Fuzzy::default() };
            let g =
                GBuffer { full: [1, 1], window: Window::whole(1, 1), scale, weight: 1.0, texels: Vec::new() };
            let radius = |fuzzy: &Fuzzy| reach(&g, [0, 0], &mirror, (&lobe, fuzzy));
            assert_eq!(radius(&plain).map(f32::to_bits), [found.to_bits(); 2], "the knob takes it");
            let capped = Fuzzy { max_radius: 20.0, ..plain };
            assert_eq!(radius(&capped).map(f32::to_bits), [found.min(20.0).to_bits(); 2], "and the cap");
        }
        let away = mirror((Vec3::ZERO, Vec3::Z), (End::Away(Vec3::Z), 1.0));
        assert!((alpha(&away, &lobe) - lobe.angle()).abs() < 1e-6, "all of it at infinity");
        let nowhere = mirror((Vec3::ZERO, Vec3::Z), (End::At(Vec3::ZERO), 1.0));
        assert!(cone(scale, &nowhere, &lobe) <= 0.0, "none without a ray");
    }

    /// Columns and rows of the pictures of balls.
    const SIZE: u32 = 241;

    /// A ball of radius `radius` about the origin, mirroring on its outside or on its inside, seen from `eye` along -z; what is mirrored is a far
    /// larger ball about it for the outside, and a plane before the bowl, at z = `wall`, for the inside. Off the axis by `shift` pixels.
    fn ball(radius: f32, eye: f32, (scale, shift): (f32, [f32; 2]), wall: Option<f32>) -> GBuffer {
        let at = |x: u32, y: u32| {
            let half = 0.5 * SIZE as f32 - 0.5;
            let d = Vec3::new(x as f32 - half + shift[0], half - y as f32 + shift[1], -scale).normalize();
            let o = Vec3::Z * eye;
            // |o + t d| = radius: the nearer of both for the outside, the farther for the inside.
            let b = o.dot(d);
            let root = (b * b - eye * eye + radius * radius).sqrt();
            let t = if wall.is_some() { -b + root } else { -b - root };
            let a = o + d * t;
            let normal = if wall.is_some() { -a / radius } else { a / radius };
            let w = d - normal * (2.0 * d.dot(normal));
            let length = if let Some(z) = wall {
                (z - a.z) / w.z
            } else {
                let b = a.dot(w);
                -b + (b * b - radius * radius + 25.0).sqrt()
            };
            let mirror = mirror((a, normal), (End::At(a + w * length), t));
            let is_there = root > 0.0 && length > 0.0;
            Texel { mirror: is_there.then_some(mirror), alpha: 1.0, ..Texel::default() }
        };
        let texels = (0..SIZE).flat_map(|y| (0..SIZE).map(move |x| at(x, y))).collect();
        GBuffer { full: [SIZE; 2], window: Window::whole(SIZE, SIZE), scale, weight: 1.0, texels }
    }

    /// Half the width and half the height of the pixels whose rays end within the lobe of the middle one, looked at one by one.
    fn looked_at(g: &GBuffer, lobe: &Lobe) -> [f32; 2] {
        let middle = SIZE / 2;
        let of = |x, y| g.texel(x, y).and_then(|texel| texel.mirror);
        let own = of(middle, middle).expect("a mirror");
        let w = own.direction().expect("a way");
        let mut far = [[SIZE, 0]; 2];
        for y in 0..SIZE {
            for x in 0..SIZE {
                let Some(End::At(b)) = of(x, y).map(|mirror| mirror.end) else { continue };
                if 1.0 - (b - own.a).normalize().dot(w) <= lobe.t_max {
                    for (far, x) in far.iter_mut().zip([x, y]) {
                        *far = [far[0].min(x), far[1].max(x)];
                    }
                }
            }
        }
        assert!(
            far.iter().all(|[low, high]| *low > 0 && *high < SIZE - 1),
            "all of it in the picture: {far:?}"
        );
        far.map(|[low, high]| 0.5 * (high - low) as f32)
    }

    #[test]
    fn windows_follow_rays_on_balls_and_in_bowls() {
        // Light of a bowl of radius 2 meets at z = -0.8 if it comes from the eye.
        let cases = [
            ("ball", ball(0.7, 3.0, (3000.0, [0.0, 0.0]), None)),
            ("ball from the side", ball(0.7, 3.0, (3000.0, [350.0, 0.0]), None)),
            ("ball askew", ball(0.7, 3.0, (3000.0, [250.0, -300.0]), None)),
            ("bowl, beyond its focus", ball(2.0, 1.0, (600.0, [0.0, 0.0]), Some(0.5))),
            ("bowl, short of its focus", ball(2.0, 1.0, (900.0, [0.0, 0.0]), Some(-1.5))),
            ("bowl askew", ball(2.0, 1.0, (900.0, [150.0, 100.0]), Some(-1.5))),
        ];
        let lobe = Lobe::new(1000.0, 0.01, 1.5);
        for (name, g) in &cases {
            let middle = SIZE / 2;
            let own = g.texel(middle, middle).and_then(|texel| texel.mirror).expect("a mirror");
            let wanted = looked_at(g, &lobe);
            let found = ellipse(g, [middle; 2], &own, &lobe).expect("a window");
            let published = cone(g.scale, &own, &lobe);
            println!("{name}: {found:.1?} of {wanted:.1?} pixels, by distances {published:.1}");
            for (found, wanted) in found.into_iter().zip(wanted) {
                // Pixels are whole, and rays turn a little more or less over a window than in its middle.
                assert!((found - wanted).abs() < 1.0 + 0.06 * wanted, "{name}: {found}, not {wanted}");
            }
            let off = wanted.iter().map(|wanted| (published / wanted).ln().abs()).fold(0.0, f32::max);
            assert!(off > 1.3_f32.ln(), "{name}: distances tell {published}, which is as good");
        }
    }
}
