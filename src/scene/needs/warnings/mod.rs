//! What single precision, the unit of length or the picture's resolution do not suit: sizes and positions, triangles, materials.

mod materials;
mod triangles;

use crate::error::{Place, Problem};
use crate::math::Aabb;
use crate::scene::Scene;
use glam::Vec3;

/// Extents of a scene, in metres, that all kernels are tested at.
const TESTED: [f32; 2] = [1e-6, 1e6];

/// Extents that a scene in metres usually has.
const USUAL: [f32; 2] = [1e-2, 1e4];

/// Distance from the origin in extents from which on positions are coarse: a part in 10^5 of the extent.
const FAR: f32 = 100.0;

/// How much smaller than the whole a shape may be before its own details are coarse.
const MIXED: f32 = 1e5;

/// Distance of the camera in radii from which on the scene is a dot.
const DISTANT: f32 = 300.0;

/// All that is odd.
pub(super) fn of(scene: &Scene, origins: &[Place]) -> Vec<Problem> {
    let bounds = scene.world.bounds();
    if bounds.is_empty() {
        return Vec::new();
    }
    let mut warnings = Vec::new();
    warnings.extend(scale(bounds));
    warnings.extend(position(bounds));
    warnings.extend(mixed(scene, bounds, origins));
    warnings.extend(camera(scene.camera.eye(0.0), bounds));
    warnings.extend(materials::of(scene, origins));
    warnings
}

/// All that is odd about triangles.
pub(super) fn of_triangles(scene: &Scene, origins: &[Place]) -> Vec<Problem> {
    triangles::of(scene, origins)
}

/// A warning where it is known.
fn at(place: Option<&Place>, what: String) -> Problem {
    place.map_or_else(|| Problem::new(what.clone()), |place| Problem::at(place.clone(), what.clone()))
}

/// A scene far smaller or larger than things are.
fn scale(bounds: Aabb) -> Option<Problem> {
    let extent = bounds.size().max_element();
    if extent <= 0.0 || (USUAL[0]..=USUAL[1]).contains(&extent) {
        return None;
    }
    let what = if (TESTED[0]..=TESTED[1]).contains(&extent) {
        format!("the scene is {} wide: absorption and radiance are per metre", length(extent))
    } else {
        format!(
            "the scene is {} wide: kernels are tested from {} to {}",
            length(extent),
            length(TESTED[0]),
            length(TESTED[1])
        )
    };
    let remedy = "if the file counts in another unit, scale its shapes, or bring them to a size with `fit`";
    Some(Problem::new(what).remedy(remedy))
}

/// A scene far from the origin.
fn position(bounds: Aabb) -> Option<Problem> {
    let (extent, reach) = (bounds.size().max_element(), reach(bounds));
    (extent > 0.0 && reach > FAR * extent).then(|| {
        let what = format!(
            "the scene is {} wide but lies {} from the origin, where single precision knows positions to {} only",
            length(extent),
            length(reach),
            length(reach * f32::EPSILON),
        );
        Problem::new(what).remedy("move everything, camera and lights too, towards the origin")
    })
}

/// Shapes so small beside their own distance from the origin that their form is coarse.
fn mixed(scene: &Scene, bounds: Aabb, origins: &[Place]) -> Option<Problem> {
    let extent = bounds.size().max_element();
    let sizes = scene.world.placements.iter().enumerate().filter_map(|(index, placement)| {
        let own = placement.pose.aabb(scene.world.shapes[placement.shape.index()].bounds());
        let size = own.size().max_element();
        (size > 0.0 && extent > MIXED * size && reach(own) > MIXED * size).then_some((index, size))
    });
    let small: Vec<(usize, f32)> = sizes.collect();
    let &(index, size) = small.iter().min_by(|a, b| a.1.total_cmp(&b.1))?;
    let what = format!(
        "{} {} less than a part in {MIXED:.0} of the scene, the smallest {} of {}: positions there are coarse",
        small.len(),
        if small.len() == 1 { "shape is" } else { "shapes are" },
        length(size),
        length(extent),
    );
    let problem = at(origins.get(index), what);
    Some(problem.remedy("bring small things near the origin, or leave out what is far away"))
}

/// A camera from which nothing can be made out.
fn camera(eye: Vec3, bounds: Aabb) -> Option<Problem> {
    let distance = (eye - bounds.center()).length();
    (bounds.radius() > 0.0 && distance > DISTANT * bounds.radius()).then(|| {
        let what = format!(
            "the camera is {} away from a scene of {}: it will be a dot",
            length(distance),
            length(bounds.size().max_element())
        );
        Problem::new(what).remedy("move the camera nearer, or scale the shapes")
    })
}

/// The greatest coordinate.
fn reach(bounds: Aabb) -> f32 {
    bounds.min.abs().max(bounds.max.abs()).max_element()
}

/// A length in metres for people, in a unit that suits it.
#[must_use]
pub fn length(metres: f32) -> String {
    let (value, unit) = match metres {
        m if m >= 1e3 => (m * 1e-3, "km"),
        m if m >= 1.0 => (m, "m"),
        m if m >= 1e-2 => (m * 1e2, "cm"),
        m if m >= 1e-3 => (m * 1e3, "mm"),
        m => (m * 1e6, "um"),
    };
    let text = if value >= 1e6 || (value > 0.0 && value < 1e-3) {
        format!("{value:.1e}")
    } else if value >= 99.95 {
        format!("{value:.0}")
    } else {
        format!("{value:.2}").trim_end_matches('0').trim_end_matches('.').to_owned()
    };
    format!("{text} {unit}")
}

#[cfg(test)]
mod tests {
    use super::*;

    fn cube(at: f32, size: f32) -> Aabb {
        Aabb { min: Vec3::splat(at), max: Vec3::splat(at + size) }
    }

    #[test]
    fn lengths_read_well() {
        let lengths = [1234.0, 2.5, 0.125, 4e-3, 2e-6, 3e9, 0.0, 250.0].map(length);
        assert_eq!(
            lengths,
            ["1.23 km", "2.5 m", "12.5 cm", "4 mm", "2 um", "3.0e6 km", "0 um", "250 m"],
            "texts"
        );
    }

    #[test]
    fn usual_scenes_are_passed_and_odd_ones_told() {
        assert_eq!(scale(cube(0.0, 3.0)), None, "a room");
        let told = scale(cube(0.0, 3000.0 * 1e2)).map(|p| p.to_string()).unwrap_or_default();
        assert!(told.starts_with("the scene is 300 km wide: absorption"), "{told}");
        let told = scale(cube(0.0, 1e-8)).map(|p| p.to_string()).unwrap_or_default();
        assert!(told.contains("tested from 1 um to 1000 km"), "{told}");
        assert_eq!(position(cube(50.0, 3.0)), None, "not far");
        let told = position(cube(1e6, 3.0)).map(|p| p.to_string()).unwrap_or_default();
        assert!(
            told.contains("3 m wide but lies 1000 km from the origin") && told.contains("to 11.92 cm"),
            "{told}"
        );
        assert_eq!(camera(Vec3::Z * 10.0, cube(0.0, 1.0)), None, "near");
        assert!(camera(Vec3::Z * 1e4, cube(0.0, 1.0)).is_some(), "far");
    }
}
