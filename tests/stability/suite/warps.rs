//! Warps of the unit square.

use super::axes::{above, cone, exponent, number};
use super::big::{Big, big, dot, pi};
use super::reference::power;
use super::row::Row;
use specula::math::Vec3;
use specula::sampling::warp;

/// The point of the concentric disc (Shirley and Chiu 1997), and its radius. Numbers stand for centres of cells.
fn disc(u: &Big, v: &Big) -> [Big; 3] {
    let centred = |x: &Big| x * 2.0 - 1.0 + 1.0 / 16_777_216.0;
    let (a, b) = (centred(u), centred(v));
    let along_x = a.abs() > b.abs();
    let (r, side) = if along_x { (a, b) } else { (b, a) };
    let [sin, cos] = (&side / &r / 8.0).sin_cos_turns();
    let (x, y) = if along_x { (&r * cos, &r * sin) } else { (&r * sin, &r * cos) };
    [x, y, r.abs()]
}

#[expect(clippy::too_many_lines, reason = "a list")]
pub(crate) fn rows() -> Vec<Row> {
    vec![
        kernel!(
            "disc",
            [number(), number()],
            |u, v| warp::disc([u, v]),
            |t| Some(disc(&t[0], &t[1])[..2].to_vec()),
            "3e-7",
            |_, r| 3e-7 * r
        ),
        kernel!(
            "cosine hemisphere",
            [number(), number()],
            |u, v| {
                let w = warp::cosine_hemisphere([u, v]);
                [w.x, w.y, w.z]
            },
            |t| {
                let [x, y, r] = disc(&t[0], &t[1]);
                Some(vec![x, y, (big(1.0) - r.square()).sqrt()])
            },
            "3e-7",
            |_, _| 3e-7
        ),
        kernel!(
            "cosine hemisphere: the cosine alone",
            [number(), number()],
            |u, v| [warp::cosine_hemisphere([u, v]).z],
            |t| Some(vec![(big(1.0) - disc(&t[0], &t[1])[2].square()).sqrt()]),
            "5e-7",
            |_, z| 5e-7 * z
        ),
        kernel!(
            "cone",
            [number(), number(), cone()],
            |u, v, h| {
                let w = warp::cone([u, v], h);
                [w.x, w.y]
            },
            |t| {
                let [x, y, r] = disc(&t[0], &t[1]);
                let h = r.square() * &t[2];
                let scale = (&t[2] * (big(2.0) - h)).sqrt();
                Some(vec![x * &scale, y * &scale])
            },
            "5e-7",
            |_, r| 5e-7 * r
        ),
        kernel!(
            "1 - cos from sin^2",
            [cone()],
            |s| [warp::one_minus_cos_of_sin2(s)],
            |t| Some(vec![big(1.0) - (big(1.0) - &t[0]).sqrt()]),
            "3e-7",
            |_, x| 3e-7 * x
        ),
        kernel!(
            "1 - cos of a direction",
            [above()],
            |x, y, z| [warp::one_minus_cos(Vec3::new(x, y, z))],
            |t| {
                // Of the direction that has these x and y exactly: z says nothing near the pole.
                let sin2 = dot(&t[..2], &t[..2]);
                Some(vec![if t[2] > big(0.7) {
                    big(1.0) - (big(1.0) - sin2).sqrt()
                } else {
                    big(1.0) - &t[2]
                }])
            },
            "5e-7",
            |_, x| 5e-7 * x
        ),
        kernel!(
            "triangle",
            [number(), number()],
            |u, v| warp::triangle([u, v]),
            |t| {
                let above = t[1] > t[0];
                let (small, large) = if above { (&t[0], &t[1]) } else { (&t[1], &t[0]) };
                let (half, rest) = (small / 2.0, large - small / 2.0);
                let last = big(1.0) - large;
                Some(if above { vec![half, rest, last] } else { vec![rest, half, last] })
            },
            "1e-7",
            |_, _| 1e-7
        ),
        kernel!(
            "power cosine: sine",
            [number(), number(), exponent()],
            |u, v, e| {
                let w = warp::power_cosine([u, v], e);
                [w.x, w.y]
            },
            |t| {
                let q = (big(1.0) - &t[1]).ln() / (&t[2] + 1.0) * 2.0;
                let sin = (big(1.0) - q.exp()).sqrt();
                let [s, c] = t[0].sin_cos_turns();
                Some(vec![&sin * c, sin * s])
            },
            "5e-7",
            |_, r| 5e-7 * r
        ),
        kernel!(
            "power cosine: cosine",
            [number(), number(), exponent()],
            |u, v, e| [warp::power_cosine([u, v], e).z],
            |t| Some(vec![((big(1.0) - &t[1]).ln() / (&t[2] + 1.0)).exp()]),
            "3e-6: at e = 0 the logarithm reaches -17",
            |_, z| 3e-6 * z
        ),
        kernel!(
            "power of a cosine",
            [above(), exponent()],
            |x, y, z, e| [warp::power_of_cosine(Vec3::new(x, y, z), e)],
            |t| {
                let near = big(1.0) - dot(&t[..2], &t[..2]) / (&t[2] + 1.0);
                let cos = if t[2] > big(0.5) { near } else { t[2].clone() };
                // Functions of lanes take denormals for zero.
                if !cos.is_positive() || cos < big(1.2e-38) {
                    return None;
                }
                Some(vec![power(&cos, &t[3])])
            },
            "2e-6, growing with the logarithm of the result",
            |_, p| p * (2e-6 + 3e-7 * p.max(1e-300).ln().abs())
        ),
        kernel!(
            "power cosine: density",
            [above(), exponent()],
            |x, y, z, e| { [warp::power_cosine_pdf(Vec3::new(x, y, z), e)] },
            |t| {
                let near = big(1.0) - dot(&t[..2], &t[..2]) / (&t[2] + 1.0);
                let cos = if t[2] > big(0.5) { near } else { t[2].clone() };
                let least = big(1.2e-38);
                (cos > least).then(|| vec![(&t[3] + 1.0) / (pi() * 2.0) * power(&cos, &t[3])])
            },
            "2e-6, growing with the logarithm of the power; powers below 1.2e-38 are lost",
            |a, p| p * (3e-6 + 3e-7 * (p / (a[3] + 1.0)).max(1e-300).ln().abs()) + 1.2e-38 * (a[3] + 1.0)
        ),
        kernel!(
            "uniform hemisphere",
            [number(), number()],
            |u, v| {
                let w = warp::uniform_hemisphere([u, v]);
                [w.x, w.y, w.z]
            },
            |t| {
                let [x, y, r] = disc(&t[0], &t[1]);
                let scale = (big(2.0) - r.square()).sqrt();
                Some(vec![x * &scale, y * &scale, big(1.0) - r.square()])
            },
            "3e-7",
            |_, _| 3e-7
        ),
        kernel!(
            "inverses of disc and cosine hemisphere",
            [above()],
            |x, y, z| {
                let ([a, b], [c, d]) =
                    (warp::disc_inverse([x, y]), warp::cosine_hemisphere_inverse(Vec3::new(x, y, z)));
                [a, b, c, d]
            },
            |t| {
                let along_x = t[0].abs() > t[1].abs();
                let (main, other) = if along_x { (&t[0], &t[1]) } else { (&t[1], &t[0]) };
                let length = dot(&t[..2], &t[..2]).sqrt();
                let [r, side] = if length.is_positive() {
                    let r = if main.is_positive() { length } else { -length };
                    let side = &r * (other / main).atan() * 4.0 / pi();
                    [r, side]
                } else {
                    [big(0.0), big(0.0)]
                };
                // The greatest number below 1 is the last.
                let pair = if along_x { [r, side] } else { [side, r] };
                let [u, v] = pair.map(|a| (a / 2.0 + 0.5).min(&big(1.0 - 0.5_f64.powi(24))).max(&big(0.0)));
                Some(vec![u.clone(), v.clone(), u, v])
            },
            "2e-7",
            |_, _| 2e-7
        ),
        kernel!(
            "cone: there and back",
            [number(), number(), cone()],
            |u, v, h| warp::cone_inverse(warp::cone([u, v], h), h),
            // Numbers stand for centres of cells.
            |t| Some(t[..2].iter().map(|u| u + 0.5_f64.powi(25)).collect()),
            "5e-7",
            |_, _| 5e-7
        ),
        kernel!(
            "triangle: there and back",
            [number(), number()],
            |u, v| warp::triangle_inverse(warp::triangle([u, v])),
            |t| Some(t.to_vec()),
            "1.2e-7",
            |_, _| 1.2e-7
        ),
        kernel!(
            "uniform sphere",
            [number(), number()],
            |u, v| {
                let w = warp::uniform_sphere([u, v]);
                [w.x, w.y, w.z]
            },
            |t| {
                let [x, y, r] = disc(&t[0], &t[1]);
                let scale = (big(1.0) - r.square()).sqrt() * 2.0;
                Some(vec![x * &scale, y * &scale, big(1.0) - r.square() * 2.0])
            },
            "3e-7",
            |_, _| 3e-7
        ),
        kernel!(
            "density of a cone",
            [cone()],
            |h| [warp::cone_pdf(h)],
            |t| Some(vec![big(0.5) / (&t[0] * pi())]),
            "3e-7",
            |_, p| 3e-7 * p
        ),
    ]
}
