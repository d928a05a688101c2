//! Vectors and frames.

use super::axes::{above, around, nearby, place, scale};
use super::big::{big, dot, unit};
use super::row::Row;
use specula::math::{Frame, Vec3};

#[expect(clippy::too_many_lines, reason = "a list")]
pub(crate) fn rows() -> Vec<Row> {
    vec![
        kernel!(
            "normalize",
            [around(), scale()],
            |x, y, z, s| {
                let v = (Vec3::new(x, y, z) * s).normalize();
                [v.x, v.y, v.z]
            },
            |t| Some(unit(&t[..3])),
            "2e-7",
            |_, _| 2e-7
        ),
        kernel!(
            "reflect",
            [above(), around()],
            |x, y, z, a, b, c| {
                let v = Vec3::new(x, y, z).reflect(Vec3::new(a, b, c));
                [v.x, v.y, v.z]
            },
            |t| {
                let twice = dot(&t[..3], &t[3..]) * 2.0;
                Some((0..3).map(|i| &t[3 + i] * &twice - &t[i]).collect())
            },
            "4e-7",
            |_, _| 4e-7
        ),
        kernel!(
            "dot, by the size of its terms",
            [around(), nearby()],
            |x, y, z, a, b, c| [Vec3::new(x, y, z).dot(Vec3::new(a, b, c))],
            |t| Some(vec![dot(&t[..3], &t[3..])]),
            "2e-7 of the lengths",
            |a, _| 2e-7
                * (a[..3].iter().map(|x| x * x).sum::<f64>() * a[3..].iter().map(|x| x * x).sum::<f64>())
                    .sqrt()
        ),
        kernel!(
            "frame: products of its axes less those of unit vectors",
            [around()],
            |x, y, z| {
                let f = Frame::about(Vec3::new(x, y, z));
                let n = f.z;
                [
                    f.x.dot(f.x) - 1.0,
                    f.y.dot(f.y) - 1.0,
                    f.x.dot(f.y),
                    f.x.dot(n),
                    f.y.dot(n),
                    f.x.cross(f.y).dot(n) - 1.0,
                ]
            },
            |_| Some(vec![big(0.0); 6]),
            "5e-7",
            |_, _| 5e-7
        ),
        kernel!(
            "frame: to local and back",
            [around(), around()],
            |x, y, z, a, b, c| {
                let f = Frame::about(Vec3::new(x, y, z));
                let v = f.to_world(f.to_local(Vec3::new(a, b, c)));
                [v.x, v.y, v.z]
            },
            |t| Some(t[3..].to_vec()),
            "8e-7",
            |_, _| 8e-7
        ),
        kernel!(
            "point along a ray",
            [place(), around(), scale()],
            |x, y, z, a, b, c, t| {
                let v = Vec3::new(x, y, z).mul_add(t, Vec3::new(a, b, c));
                [v.x, v.y, v.z]
            },
            |t| Some((0..3).map(|i| &t[i] + &t[6] * &t[3 + i]).collect()),
            "2e-7 of the larger term",
            |a, _| 2e-7 * a[..3].iter().fold(a[6], |m, x| m.max(x.abs()))
        ),
    ]
}
