//! Materials.

use crate::bsdf::Coat;
use crate::error::Problem;
use crate::material::{Emission, Material, Medium, Scattering, conductors};
use crate::math::Rgb;
use crate::scene::build::Builder;
use crate::scene::description::{self, Named, Optics};
use crate::texture::Texture;

impl Builder {
    pub(super) fn add_materials(&mut self, materials: &[Named<description::Material>]) {
        for named in materials {
            let material = self.material(&named.value);
            self.add_material(material);
            self.material_names.push(named.name.clone());
        }
    }

    pub(super) fn material(&mut self, material: &description::Material) -> Material {
        let (scattering, mut radiance, mut two_sided) = self.scattering(&material.scattering);
        radiance += material.emission;
        two_sided &= material.emission.is_black();
        let emission = (!radiance.is_black()).then_some(Emission { radiance, two_sided });
        Material { scattering, emission }
    }

    /// What a surface does, the radiance it gives off by its kind, and whether on both sides.
    fn scattering(&mut self, scattering: &description::Scattering) -> (Scattering, Rgb<f32>, bool) {
        use description::Scattering as Described;
        let made = match scattering {
            Described::Diffuse { reflectance } => Scattering::Diffuse { reflectance: texture(reflectance) },
            &Described::Mirror { reflectance } => Scattering::Mirror { reflectance },
            Described::Conductor { alpha, optics } => {
                let (eta, k) = self.optics(optics);
                Scattering::Conductor { eta, k, alpha: *alpha }
            }
            &Described::Dielectric { ior, absorption, priority } => {
                Scattering::Dielectric(Medium { ior, absorption, priority })
            }
            Described::Glossy { exponent, reflectance, diffuse } => {
                Scattering::Glossy { exponent: *exponent, reflectance: *reflectance, base: texture(diffuse) }
            }
            Described::Glazed { ior, reflectance } => {
                Scattering::Glazed { coat: Coat::new(*ior), base: texture(reflectance) }
            }
            &Described::Emission { radiance, two_sided } => return (Scattering::Black, radiance, two_sided),
        };
        (made, Rgb::BLACK, false)
    }

    fn optics(&mut self, optics: &Optics) -> (Rgb<f32>, Rgb<f32>) {
        match optics {
            &Optics::Index { eta, k } => (eta, k),
            &Optics::Artist { reflectance, edge_tint } => {
                conductors::from_reflectance(reflectance, edge_tint)
            }
            Optics::Metal { metal } => {
                if let Some(found) = conductors::named(&metal.value) {
                    return (found.eta, found.k);
                }
                let what = format!("unknown metal `{}`", metal.value);
                let remedy = format!("known are {}", conductors::NAMES.join(", "));
                self.problems.push(Problem::at(metal.place.clone(), what).remedy(remedy));
                (Rgb::WHITE, Rgb::WHITE)
            }
        }
    }
}

fn texture(texture: &description::Texture) -> Texture {
    match texture {
        description::Texture::Constant(color) => Texture::Constant(*color),
        description::Texture::Checker(checker) => {
            Texture::Checker { colors: checker.checker, repeat: checker.repeat.into() }
        }
    }
}
