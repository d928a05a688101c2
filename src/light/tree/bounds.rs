//! What is known of emitters without looking at each: where they are, where they shine to, how brightly.

use crate::light::Light;
use crate::math::Aabb;
use glam::Vec3;
use std::f32::consts::{FRAC_PI_2, PI};

/// Emitters within a box, whose normals lie within a cone, and whose light goes so far from its normal (Conty Estevez and Kulla
/// 2018, Importance Sampling of Many Lights with Adaptive Tree Splitting, section 4).
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Bounds {
    pub(super) aabb: Aabb,
    /// Axis of the cone of normals, unit.
    pub(super) axis: Vec3,
    /// Half angle of that cone, radians.
    pub(super) spread: f32,
    /// How far from a normal light goes, radians.
    pub(super) reach: f32,
    /// Luminous intensity in the brightest direction, all emitters together.
    pub(super) intensity: f32,
}

impl Bounds {
    fn new(aabb: Aabb, axis: Vec3, [spread, reach]: [f32; 2], intensity: f32) -> Self {
        Self { aabb, axis, spread, reach, intensity }
    }

    /// Those of a light, each part by itself where it is a mesh of many triangles; none of lights at infinity, and none of what is
    /// dark.
    pub(super) fn of(light: &Light) -> Vec<(Option<u32>, Self)> {
        let around = |p: Vec3, r: f32| Aabb { min: p - r, max: p + r };
        let flat = |two_sided: bool| if two_sided { [PI, FRAC_PI_2] } else { [0.0, FRAC_PI_2] };
        let one = match light {
            Light::Point(light) => {
                let aabb = around(light.position.into(), 0.0);
                Self::new(aabb, Vec3::Z, [PI, FRAC_PI_2], light.intensity.luminance())
            }
            Light::Spot(light) => {
                let angle = |versine: f32| 2.0 * (0.5 * versine).sqrt().min(1.0).asin();
                let [inner, outer] = [light.versine_inner, light.versine_outer].map(angle);
                let angles = [inner, (outer - inner).min(FRAC_PI_2)];
                // What fades beyond a right angle is not missed: the whole cone counts as full.
                let angles = if outer - inner > FRAC_PI_2 { [outer, 0.0] } else { angles };
                let aabb = around(light.position.into(), 0.0);
                Self::new(aabb, light.axis.into(), angles, light.intensity.luminance())
            }
            Light::Rectangle(light) => {
                let [u, v] = light.surface.edges().map(Vec3::from);
                let (half, center) = (u.abs() + v.abs(), Vec3::from(light.surface.center()));
                let aabb = Aabb { min: center - half, max: center + half };
                let intensity = light.intensity();
                Self::new(aabb, light.surface.normal().into(), flat(light.two_sided), intensity)
            }
            Light::Disc(light) => {
                let aabb = around(light.surface.center().into(), light.surface.radius());
                let intensity = light.intensity();
                Self::new(aabb, light.surface.normal().into(), flat(light.two_sided), intensity)
            }
            Light::Sphere(light) => {
                let intensity = light.radiance.luminance() * PI * light.radius * light.radius;
                Self::new(around(light.center.into(), light.radius), Vec3::Z, [PI, FRAC_PI_2], intensity)
            }
            Light::Mesh(light) => {
                let all = light.intensity();
                let parts = light.surface.triangles().map(|(part, corners, normal, share)| {
                    let [a, b, c] = corners;
                    let aabb = Aabb { min: a.min(b).min(c), max: a.max(b).max(c) };
                    (Some(part), Self::new(aabb, normal, flat(light.two_sided), all * share))
                });
                let parts = parts.filter(|(_, bounds)| bounds.intensity > 0.0);
                if light.surface.is_split() {
                    return parts.collect();
                }
                let whole = parts.map(|(_, bounds)| bounds).reduce(Self::join);
                return whole.map(|bounds| (None, bounds)).into_iter().collect();
            }
            Light::Directional(_) | Light::Environment(_) => return Vec::new(),
        };
        if one.intensity > 0.0 { vec![(None, one)] } else { Vec::new() }
    }

    /// Those of both.
    pub(super) fn join(self, other: Self) -> Self {
        let (axis, spread) = join_cones((self.axis, self.spread), (other.axis, other.spread));
        Self {
            aabb: self.aabb.union(other.aabb),
            axis,
            spread,
            reach: self.reach.max(other.reach),
            intensity: self.intensity + other.intensity,
        }
    }

    /// How likely a group is to be looked at in vain, up to a factor: intensity times solid angle it shines into times area of its box
    /// (the same, equations 2 and 3).
    pub(super) fn cost(&self, ratio: f32) -> f32 {
        let (spread, end) = (self.spread, (self.spread + self.reach).min(PI));
        let fading = 2.0 * end * spread.sin() - (spread - 2.0 * end).cos() - 2.0 * spread * spread.sin();
        let directions = 2.0 * PI * (1.0 - spread.cos()) + FRAC_PI_2 * (fading + spread.cos());
        // Flat groups have a little of the third extent, so that their other ones count.
        let size = self.aabb.size();
        let size = size.max(Vec3::splat(size.max_element() * 0.01));
        let area = size.x * size.y + size.y * size.z + size.z * size.x;
        self.intensity * directions * area * ratio
    }
}

/// The least cone about two, as axis and half angle (the same, algorithm 1).
fn join_cones(a: (Vec3, f32), b: (Vec3, f32)) -> (Vec3, f32) {
    let (wide, narrow) = if a.1 >= b.1 { (a, b) } else { (b, a) };
    let between = wide.0.dot(narrow.0).clamp(-1.0, 1.0).acos();
    if (between + narrow.1).min(PI) <= wide.1 {
        return wide;
    }
    let spread = 0.5 * (wide.1 + between + narrow.1);
    if spread >= PI {
        return (wide.0, PI);
    }
    // From the wide axis towards the narrow one.
    let across = narrow.0 - wide.0 * wide.0.dot(narrow.0);
    let side = across.try_normalize().unwrap_or_else(|| wide.0.any_orthonormal_vector());
    let (sin, cos) = (spread - wide.1).sin_cos();
    ((wide.0 * cos + side * sin).normalize(), spread)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn joined_cones_hold_both() {
        let directions: Vec<Vec3> = (0..200_u16)
            .map(|i| {
                let t = f32::from(i) * 2.399_963;
                let z = 1.0 - (f32::from(i) + 0.5) / 100.0;
                Vec3::new((1.0 - z * z).sqrt() * t.cos(), (1.0 - z * z).sqrt() * t.sin(), z)
            })
            .collect();
        let angles = [0.0, 0.3, 1.2, 2.5, PI];
        for (i, &a) in directions.iter().enumerate().step_by(7) {
            for (j, &b) in directions.iter().enumerate().step_by(11) {
                let (a, b) = ((a, angles[i % 5]), (b, angles[j % 5]));
                let (axis, spread) = join_cones(a, b);
                assert!((axis.length() - 1.0).abs() < 1e-5 && spread <= PI, "{axis} {spread}");
                assert!(spread + 1e-6 >= a.1.max(b.1), "no less than either");
                for &d in &directions {
                    let is_in = |(axis, spread): (Vec3, f32), slack: f32| {
                        axis.dot(d).clamp(-1.0, 1.0).acos() <= spread + slack
                    };
                    let held = !(is_in(a, -1e-3) || is_in(b, -1e-3)) || is_in((axis, spread), 1e-3);
                    assert!(held, "{d} of {a:?} and {b:?} is outside of {axis} {spread}");
                }
            }
        }
    }
}
