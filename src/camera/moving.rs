//! A camera that moves while the shutter is open, with everything at rest sharp but for that.

use crate::camera::{Pinhole, Viewpoint};
use crate::math::Vec3;
use crate::math::lanes::{Isa, Lanes, WIDEST};

/// A pinhole that goes from viewpoint to viewpoint. What lies between two is found for each moment by itself, so turns of any
/// speed are exact.
#[derive(Clone, Debug, PartialEq)]
pub struct MovingPinhole {
    /// Moments of the shutter, rising from 0 to 1.
    keys: Box<[(f32, Viewpoint)]>,
    /// Columns and rows of the film.
    size: [u32; 2],
}

impl MovingPinhole {
    /// The camera that is at each viewpoint at its moment, for a film of `size` pixels; `None` unless there are two or more, the
    /// moments rise, the first is 0 and the last 1.
    #[must_use]
    pub fn new(keys: Vec<(f32, Viewpoint)>, size: [u32; 2]) -> Option<Self> {
        let rises = keys.len() > 1 && keys.windows(2).all(|pair| pair[0].0 < pair[1].0);
        let spans =
            rises && keys[0].0.to_bits() == 0 && keys[keys.len() - 1].0.to_bits() == 1.0_f32.to_bits();
        spans.then(|| Self { keys: keys.into(), size })
    }

    /// The camera at a moment of the shutter; outside of [0, 1] that of the nearer end.
    #[must_use]
    pub fn at(&self, time: f32) -> Pinhole {
        let next = self.keys.partition_point(|(key, _)| *key <= time).clamp(1, self.keys.len() - 1);
        let ((from, a), (to, b)) = (self.keys[next - 1], self.keys[next]);
        let part = ((time - from) / (to - from)).clamp(0.0, 1.0);
        Pinhole::at(&a.between(&b, part), self.size)
    }

    /// The camera at the moment of each lane, one after the other.
    #[inline(always)]
    pub(super) fn over<F: Lanes>(&self, time: F) -> Pinhole<F> {
        let mut times = [0.0; WIDEST];
        time.store(&mut times);
        let each = self.each(&times[..F::WIDTH]);
        let isa = time.isa();
        macro_rules! lanes {
            ($($field:ident).+) => { isa.per_lane(|i| each[i].$($field).+) };
        }
        macro_rules! vector {
            ($field:ident) => {
                Vec3::new(lanes!($field.x), lanes!($field.y), lanes!($field.z))
            };
        }
        let (eye, forward, right, down) = (vector!(eye), vector!(forward), vector!(right), vector!(down));
        Pinhole { eye, forward, right, down, middle: each[0].middle, focus: lanes!(focus) }
    }

    /// Out of line: scalar work.
    #[inline(never)]
    fn each(&self, times: &[f32]) -> [Pinhole; WIDEST] {
        let mut each = [self.at(times[0]); WIDEST];
        each.iter_mut().zip(times).skip(1).for_each(|(pinhole, &time)| *pinhole = self.at(time));
        each
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::camera::Camera;
    use glam::{Quat, Vec3};

    fn viewpoint(x: f32, angle: f32) -> Viewpoint {
        let rotation = Quat::from_rotation_y(angle);
        Viewpoint { eye: Vec3::X * x, rotation, vfov: 1.0 + 0.1 * x, focus: 2.0 + x }
    }

    #[test]
    fn place_direction_angle_of_view_and_focus_move_together() {
        let keys = vec![(0.0, viewpoint(0.0, 0.0)), (0.25, viewpoint(1.0, 1.0)), (1.0, viewpoint(4.0, -2.0))];
        let camera = Camera::from(MovingPinhole::new(keys, [200, 100]).expect("a camera"));
        for (time, x, angle) in
            [(-1.0, 0.0, 0.0), (0.125, 0.5, 0.5), (0.25, 1.0, 1.0), (0.5, 2.0, 0.0), (2.0, 4.0, -2.0)]
        {
            let middle = camera.ray([100.0, 50.0], [0.5; 2], time);
            let (sin, cos) = f32::sin_cos(angle);
            assert!(
                middle.d.abs_diff_eq(-Vec3::new(sin, 0.0, cos), 1e-5),
                "direction at {time}: {}",
                middle.d
            );
            assert!(middle.o.abs_diff_eq(Vec3::X * x, 1e-5), "place at {time}: {}", middle.o);
            assert!(camera.eye(time).abs_diff_eq(Vec3::X * x, 1e-5), "eye at {time}");
            let [up, down] = [0.0, 100.0].map(|y| camera.ray([100.0, y], [0.5; 2], time).d);
            assert!((camera.pinhole(time).focus() - 2.0 - x).abs() < 1e-5, "focus at {time}");
            assert!((up.angle_between(down) - (1.0 + 0.1 * x)).abs() < 1e-5, "angle of view at {time}");
            assert_eq!(middle.time.to_bits(), time.to_bits(), "rays know their moment");
        }
    }

    #[test]
    fn a_viewpoint_sees_what_its_pinhole_sees() {
        let place = [Vec3::new(1.0, 2.0, 3.0), Vec3::new(-0.4, 0.0, 0.7), Vec3::new(0.1, 1.0, 0.3)];
        let straight = Pinhole::new(place, 0.9, [64, 48]);
        let turned = Pinhole::at(&Viewpoint::new(place, 0.9), [64, 48]);
        for film in [[0.0, 0.0], [64.0, 0.0], [31.0, 7.5], [64.0, 48.0]] {
            let [a, b] = [straight, turned].map(|camera| Camera::from(camera).ray(film, [0.5; 2], 0.0));
            assert!(a.d.abs_diff_eq(b.d, 1e-6) && a.o == b.o, "{film:?}: {a:?} {b:?}");
        }
    }

    #[test]
    fn moments_must_rise_from_opening_to_closing() {
        let camera = |times: &[f32]| {
            MovingPinhole::new(times.iter().map(|&time| (time, viewpoint(0.0, 0.0))).collect(), [1, 1])
        };
        assert!(camera(&[0.0, 1.0]).is_some(), "the whole");
        for times in [&[0.0][..], &[0.0, 0.5], &[0.5, 1.0], &[0.0, 0.7, 0.6, 1.0], &[0.0, 0.0, 1.0], &[]] {
            assert!(camera(times).is_none(), "{times:?}");
        }
    }
}
