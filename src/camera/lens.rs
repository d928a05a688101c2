//! A thin lens in place of the pinhole: what is off the plane in focus is blurred.
//!
//! All rays have the same weight, wherever they leave the lens and under whichever angle: a lens changes what is sharp,
//! not how bright the picture is. The fall-off with cos^4 of a real lens is left out.

use crate::camera::Pinhole;
use crate::math::Vec3;
use crate::math::lanes::Lanes;
use crate::sampling::warp;
use std::f32::consts::TAU;

/// An ideal lens, thin and free of errors, behind an iris.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lens {
    /// Radius of the iris in metres; the corners of a polygon lie on this circle.
    radius: f32,
    /// Corners of the iris; `None` where it is round.
    blades: Option<u32>,
    /// Turn of the iris in radians, counter-clockwise seen from behind the camera; at 0 a corner is on top.
    turn: f32,
}

impl Lens {
    /// A lens of `radius` metres with an iris of `blades` straight edges, round for fewer than three, turned by `turn` radians;
    /// `None` if the radius is not above zero, for then it is a pinhole.
    #[must_use]
    pub fn new(radius: f32, blades: u32, turn: f32) -> Option<Self> {
        (radius > 0.0).then(|| Self { radius, blades: (blades >= 3).then_some(blades), turn })
    }

    /// The rays, origins and directions, that leave the lens at the points drawn by `u2`, uniform over the iris, for film points
    /// in pixels: all of one film point meet where the ray through the middle of the lens meets the plane in focus. Directions
    /// are unit vectors.
    #[inline(always)]
    pub(super) fn rays<F: Lanes>(
        &self,
        pinhole: &Pinhole<F>,
        film: [F; 2],
        u2: [F; 2],
    ) -> (Vec3<F>, Vec3<F>) {
        let [x, y] = self.iris(u2);
        let offset = pinhole.across([x * self.radius, y * self.radius]);
        // Divided by the distance instead of multiplied: a focus far away must not swallow the direction.
        let d = pinhole.towards(film) - offset / pinhole.focus;
        (pinhole.eye + offset, d.normalize())
    }

    /// A point of the iris of radius 1, uniform by area; x to the right, y upwards.
    #[inline(always)]
    fn iris<F: Lanes>(&self, u2: [F; 2]) -> [F; 2] {
        match self.blades {
            None => warp::disc(u2),
            Some(blades) => polygon(u2, blades, self.turn),
        }
    }
}

/// A point of a regular polygon with its corners on the unit circle, one of them at `turn` from the top; uniform by area.
/// The first number chooses among the triangles about the centre, and what is left of it serves within.
#[expect(clippy::cast_precision_loss, reason = "polygons have fewer than 2^24 corners")]
#[inline(always)]
fn polygon<F: Lanes>([u, v]: [F; 2], corners: u32, turn: f32) -> [F; 2] {
    let scaled = u * corners as f32;
    let sector = scaled.floor().min((corners - 1) as f32);
    let rest = (scaled - sector).clamp(0.0, 1.0 - f32::EPSILON);
    let [_, b, c] = warp::triangle([rest, v]);
    let ([x0, y0], [x1, y1]) = (corner(sector, corners, turn), corner(sector + 1.0, corners, turn));
    [x0 * b + x1 * c, y0 * b + y1 * c]
}

/// Corner `k` of such a polygon.
#[expect(clippy::cast_precision_loss, reason = "polygons have fewer than 2^24 corners")]
#[inline(always)]
fn corner<F: Lanes>(k: F, corners: u32, turn: f32) -> [F; 2] {
    let (sin, cos) = (k * (1.0 / corners as f32) + (0.25 + turn / TAU)).sin_cos_turns();
    [cos, sin]
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::{Vec2, Vec3 as Point};
    use std::f32::consts::FRAC_PI_2;

    fn pinhole() -> Pinhole {
        Pinhole::new([Point::ZERO, -Point::Z * 2.0, Point::Y], 0.8, [200, 100])
    }

    fn ray(lens: Lens, pinhole: &Pinhole, film: [f32; 2], u2: [f32; 2]) -> (Point, Point) {
        let (o, d) = lens.rays(pinhole, film, u2);
        (o.into(), d.into())
    }

    #[test]
    fn rays_meet_on_the_plane_in_focus() {
        for blades in [0, 3, 6] {
            let lens = Lens::new(0.1, blades, 0.3).expect("a lens");
            for film in [[100.0, 50.0], [0.0, 0.0], [171.0, 92.5]] {
                let sharp = Point::from(pinhole().towards(film)) * 2.0;
                for i in 0..100_u16 {
                    let u2 = [f32::from(i) / 100.0, f32::from(i * 7 % 100) / 100.0];
                    let (o, d) = ray(lens, &pinhole(), film, u2);
                    let at = o + d * (-2.0 / d.z);
                    assert!(at.abs_diff_eq(sharp, 1e-6), "{blades} blades, {film:?}: {at} for {sharp}");
                    assert!(d.is_normalized(), "a unit direction");
                    assert!(o.z == 0.0 && o.length() <= 0.100_001, "on the lens: {o}");
                }
            }
        }
    }

    #[test]
    fn a_focus_at_infinity_sends_rays_in_parallel() {
        let far = pinhole().focused(f32::MAX);
        let lens = Lens::new(0.5, 0, 0.0).expect("a lens");
        let straight = Point::from(far.towards([30.0, 40.0])).normalize();
        let (_, found) = ray(lens, &far, [30.0, 40.0], [0.9, 0.2]);
        assert!(found.abs_diff_eq(straight, 1e-7), "{found} for {straight}");
    }

    #[test]
    fn a_polygon_stands_on_its_corner_and_fills_its_edges() {
        for corners in [3, 4, 5, 7] {
            let inner = (TAU / 2.0 / corners as f32).cos();
            let (mut top, mut widest) = (f32::MIN, 0.0_f32);
            for i in 0..200_u8 {
                for j in 0..200_u8 {
                    let p = Vec2::from(polygon([f32::from(i) / 200.0, f32::from(j) / 200.0], corners, 0.0));
                    for k in 0..corners {
                        let middle = FRAC_PI_2 + TAU * (k as f32 + 0.5) / corners as f32;
                        let reach = Vec2::from_angle(middle).dot(p);
                        assert!(reach <= inner + 1e-6, "{corners} corners: {p} is beyond edge {k}");
                        widest = widest.max(reach / inner);
                    }
                    top = top.max(p.y);
                }
            }
            assert!(top > 0.98, "{corners} corners: the corner on top is at {top}");
            assert!(widest > 0.99, "{corners} corners: edges are reached, {widest}");
        }
        let p = Vec2::from(polygon([1.0 - f32::EPSILON / 2.0, 0.5], 5, 0.0));
        assert!(p.is_finite() && p.length() <= 1.0, "the last number: {p}");
    }

    #[test]
    fn no_radius_is_no_lens() {
        for radius in [0.0, -1.0, f32::NAN] {
            assert_eq!(Lens::new(radius, 5, 0.0), None, "radius {radius}");
        }
    }
}
