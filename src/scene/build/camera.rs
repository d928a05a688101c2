//! The camera while the shutter is open.

use crate::camera::{Camera, Lens, MovingPinhole, Pinhole, Viewpoint};
use crate::scene::build::{Origin, Shutter, unit};
use crate::scene::description::{self, CameraKey, Located};
use glam::Vec3;

/// When the shutter is open.
pub(super) fn shutter(camera: &description::Camera) -> Shutter {
    let &description::Camera::Perspective { shutter_open_s, shutter_close_s, .. } = camera;
    Shutter { open_s: shutter_open_s, close_s: shutter_close_s }
}

/// The camera for a film of `size` pixels, still where it does not move while the shutter is open.
pub(super) fn camera(camera: &description::Camera, origin: Origin, size: [u32; 2]) -> Camera {
    let &description::Camera::Perspective { lens_radius, blades, blade_rotation_deg, .. } = camera;
    let lens = Lens::new(lens_radius, blades, blade_rotation_deg.to_radians());
    stand(camera, lens.is_some(), origin, size).with_lens(lens)
}

/// The camera at its viewpoint as the shutter opens, as one that moves but stays there.
pub(super) fn held(camera: &description::Camera, origin: Origin, size: [u32; 2]) -> Option<Camera> {
    let &description::Camera::Perspective {
        from,
        at,
        up,
        vfov_deg,
        focus_distance,
        lens_radius,
        blades,
        blade_rotation_deg,
        ref keys,
        ..
    } = camera;
    if !keys.is_empty() {
        // What stands still though it has keys would be cut from them once more.
        return None;
    }
    let lens = Lens::new(lens_radius, blades, blade_rotation_deg.to_radians());
    let view = [Vec3::ZERO, (at - from).as_vec3(), unit(up.as_dvec3())];
    let own = Viewpoint::new(view, vfov_deg.to_radians());
    let focus = focus_distance.unwrap_or(own.focus);
    let viewpoint = Viewpoint { eye: origin.place(from), focus, ..own };
    let moving = MovingPinhole::new(vec![(0.0, viewpoint), (1.0, viewpoint)], size)?;
    Some(Camera::from(moving).with_lens(lens))
}

/// The camera without its lens.
fn stand(camera: &description::Camera, has_lens: bool, origin: Origin, size: [u32; 2]) -> Camera {
    let description::Camera::Perspective { from, at, up, vfov_deg, focus_distance, keys, .. } = camera;
    if keys.is_empty() {
        let place = [origin.place(*from), origin.place(*at), unit(up.as_dvec3())];
        let pinhole = Pinhole::new(place, vfov_deg.to_radians(), size);
        return focus_distance.map_or(pinhole, |distance| pinhole.focused(distance)).into();
    }
    let viewpoint = |key: &Located<CameraKey>| {
        // The difference before it is rounded: only the first key is sure to be near where the scene is counted from.
        let [from, at] = [key.from.unwrap_or(*from), key.at.unwrap_or(*at)];
        let view = [Vec3::ZERO, (at - from).as_vec3(), unit(key.up.unwrap_or(*up).as_dvec3())];
        let own = Viewpoint::new(view, key.vfov_deg.unwrap_or(*vfov_deg).to_radians());
        let focus = key.focus_distance.or(*focus_distance).unwrap_or(own.focus);
        // A focus that nothing depends on must not pass for a movement.
        let focus = if has_lens { focus } else { 1.0 };
        (key.time_s, Viewpoint { eye: origin.place(from), focus, ..own })
    };
    let keys: Vec<_> = keys.iter().map(viewpoint).collect();
    let cut = during(&keys, shutter(camera));
    let (_, first) = cut[0];
    let moves = cut.iter().any(|(_, viewpoint)| *viewpoint != first);
    let moving = if moves { MovingPinhole::new(cut, size) } else { None };
    moving.map_or_else(|| Pinhole::at(&first, size).into(), Camera::from)
}

/// The viewpoints at the opening and the closing of the shutter and at the keys in between, each at its moment in [0, 1].
fn during(keys: &[(f64, Viewpoint)], shutter: Shutter) -> Vec<(f32, Viewpoint)> {
    let mut cut = vec![(0.0, at(keys, shutter.open_s))];
    if !shutter.is_open() {
        return cut;
    }
    let times: Vec<f64> = keys.iter().map(|(time, _)| *time).collect();
    for moment in shutter.moments(&times) {
        #[expect(clippy::cast_possible_truncation, reason = "a moment in [0, 1]")]
        let rounded = moment as f32;
        // Keys too close for single precision are one.
        if cut.last().is_some_and(|(last, _)| *last < rounded) && rounded < 1.0 {
            cut.push((rounded, at(keys, shutter.at(moment))));
        }
    }
    cut.push((1.0, at(keys, shutter.close_s)));
    cut
}

/// The viewpoint at a time in seconds: before the first key and after the last the nearer one.
fn at(keys: &[(f64, Viewpoint)], time_s: f64) -> Viewpoint {
    let next = keys.partition_point(|(key, _)| *key <= time_s).clamp(1, keys.len().max(2) - 1);
    let Some((&(from, a), &(to, b))) = keys.get(next - 1).zip(keys.get(next)) else { return keys[0].1 };
    #[expect(clippy::cast_possible_truncation, reason = "a part in [0, 1]")]
    let part = ((time_s - from) / (to - from)).clamp(0.0, 1.0) as f32;
    a.between(&b, part)
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Quat;

    #[test]
    fn the_shutter_cuts_out_its_part_of_the_way() {
        let viewpoint =
            |x: f32| Viewpoint { eye: Vec3::X * x, rotation: Quat::IDENTITY, vfov: 1.0, focus: 1.0 };
        let keys = [(1.0, viewpoint(0.0)), (2.0, viewpoint(1.0)), (4.0, viewpoint(5.0))];
        let cut = |open_s, close_s| {
            let cut = during(&keys, Shutter { open_s, close_s });
            cut.into_iter().map(|(moment, viewpoint)| [moment, viewpoint.eye.x]).collect::<Vec<_>>()
        };
        assert_eq!(cut(1.5, 3.5), [[0.0, 0.5], [0.25, 1.0], [1.0, 4.0]], "across a key");
        assert_eq!(cut(0.0, 1.0), [[0.0, 0.0], [1.0, 0.0]], "before the first key");
        assert_eq!(cut(0.0, 8.0)[1..], [[0.125, 0.0], [0.25, 1.0], [0.5, 5.0], [1.0, 5.0]], "all of it");
        assert_eq!(cut(3.0, 3.0), [[0.0, 3.0]], "a closed shutter is one moment");
    }
}
