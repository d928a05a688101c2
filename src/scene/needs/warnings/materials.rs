//! Materials that do nothing that shows, at the price of those that do.

use super::at;
use crate::bsdf::microfacet::Distribution;
use crate::error::{Place, Problem};
use crate::material::Scattering;
use crate::scene::Scene;
use crate::scene::needs::count::materials_in_use;
use std::f32::consts::LN_2;

/// Indices nearer to one, but not one, are told of: their faces mirror less than a part in four million straight on.
const NEAR_ONE: f32 = 1e-3;

/// Lobes are told of whose light is halved within this part of a pixel's angle.
const INVISIBLE: f32 = 0.5;

/// What is odd about materials that something is made of, each named by the first shape made of it.
pub(super) fn of(scene: &Scene, origins: &[Place]) -> Vec<Problem> {
    let pixel = scene.camera.pixel_angle([scene.film.width, scene.film.height]);
    let mut warnings = Vec::new();
    for (id, placement) in materials_in_use(scene) {
        let name = scene.names.materials.get(id.index()).map_or("", String::as_str);
        for part in scene.materials[id.index()].scattering.parts() {
            let told = index(part, name).or_else(|| sharpness(part, name, pixel));
            warnings
                .extend(told.map(|(what, remedy)| at(origins.get(placement.index()), what).remedy(remedy)));
        }
    }
    warnings
}

/// An index of refraction close to one.
fn index(scattering: &Scattering, name: &str) -> Option<(String, String)> {
    let ior = match scattering {
        Scattering::Dielectric { medium, .. } => medium.ior,
        Scattering::ThinDielectric(pane) => pane.glass.eta(),
        Scattering::Glazed { coat, .. } => coat.ior,
        _ => return None,
    };
    let over = ior - 1.0;
    if over <= 0.0 || over >= NEAR_ONE {
        return None;
    }
    let mirrored = (over / (ior + 1.0)).powi(2);
    // At 45 degrees, by which much sin(45) changes.
    let bent = over.to_degrees();
    let what = format!(
        "`{name}` has an index of {ior}: it mirrors {mirrored:.1e} of the light straight on and bends light by {bent:.1e} degrees"
    );
    Some((
        what,
        "give it the index 1, which is not seen and costs less, or the index that is meant".to_owned(),
    ))
}

/// A lobe so narrow that the picture shows a mirror.
fn sharpness(scattering: &Scattering, name: &str, pixel: f32) -> Option<(String, String)> {
    let of_exponent = |exponent: f32| (2.0 * LN_2 / exponent.max(f32::MIN_POSITIVE)).sqrt();
    let (knob, value, angle) = match scattering {
        Scattering::Glossy { lobe, .. } => ("an exponent", lobe.exponent, of_exponent(lobe.exponent)),
        Scattering::Phong { lobe, .. } => ("an exponent", lobe.exponent, of_exponent(lobe.exponent)),
        // Normals tremble; what they mirror moves by twice as much.
        Scattering::Jitter { lobe, .. } => ("an exponent", lobe.exponent, 2.0 * of_exponent(lobe.exponent)),
        Scattering::Conductor { facets: Some(facets), .. }
        | Scattering::Dielectric { facets: Some(facets), .. }
            if facets.width.is_none() =>
        {
            let (alpha, half) = match facets.distribution {
                // Tangents at which the densities are halved.
                Distribution::Ggx(ggx) => (ggx.alpha_x.max(ggx.alpha_y), (f32::sqrt(2.0) - 1.0).sqrt()),
                Distribution::Beckmann(beckmann) => (beckmann.alpha_x.max(beckmann.alpha_y), LN_2.sqrt()),
            };
            ("an alpha", alpha, 2.0 * alpha * half)
        }
        _ => return None,
    };
    if angle >= INVISIBLE * pixel {
        return None;
    }
    let [angle, pixel] = [angle, pixel].map(f32::to_degrees);
    let what = format!(
        "`{name}` has {knob} of {value:e}: its lobe is {angle:.1e} degrees wide, of which a picture with pixels of {pixel:.1e} degrees \
         shows no more than of a mirror"
    );
    Some((what, "make it a mirror (`alpha = 0`, or `type = \"mirror\"`), or less sharp".to_owned()))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bsdf::microfacet::Ggx;
    use crate::bsdf::{FresnelModel, Glossy, Metal};
    use crate::material::{Facets, Medium};
    use crate::math::Rgb;
    use crate::texture::Texture;

    #[test]
    fn indices_next_to_one_are_told() {
        let glass = |ior: f32| Scattering::Dielectric {
            medium: Medium { ior, absorption: Rgb::BLACK, priority: 0 },
            fresnel: FresnelModel::Exact,
            facets: None,
        };
        for sound in [1.0, 1.002, 1.33] {
            assert_eq!(index(&glass(sound), "x"), None, "{sound}");
        }
        let (told, _) = index(&glass(1.0001), "frost").expect("told");
        assert!(told.starts_with("`frost` has an index of 1.0001: it mirrors 2.5e-9 of the light"), "{told}");
    }

    #[test]
    fn lobes_narrower_than_pixels_are_told() {
        let glossy = |exponent: f32| Scattering::Glossy {
            lobe: Glossy::new(Rgb::gray(0.8), exponent),
            base: Texture::Constant(Rgb::BLACK),
        };
        // Half a pixel of 1e-3: an exponent of 2 ln 2 / (5e-4)^2 = 5.5e6.
        assert_eq!(sharpness(&glossy(5.5e6), "x", 1e-3), None, "just to be seen");
        let (told, _) = sharpness(&glossy(5.6e6), "x", 1e-3).expect("told");
        assert!(told.starts_with("`x` has an exponent of 5.6e6: its lobe is 2.9e-2 degrees wide"), "{told}");
        assert_eq!(sharpness(&glossy(5.6e6), "x", 1e-4), None, "a finer picture");
        let rough = |alpha: f32| Scattering::Conductor {
            metal: Metal::new(FresnelModel::Exact, Rgb::gray(0.2), Rgb::gray(3.0)),
            facets: Some(Facets {
                distribution: Distribution::Ggx(Ggx { alpha_x: alpha, alpha_y: alpha }),
                turn: None,
                width: None,
            }),
        };
        assert_eq!(sharpness(&rough(1e-3), "x", 1e-3), None, "rough enough");
        assert!(sharpness(&rough(3e-4), "x", 1e-3).is_some(), "a mirror");
    }
}
