//! Materials.

use crate::bsdf::Coat;
use crate::error::Problem;
use crate::material::{Material, Medium, conductors};
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
        use description::Material as Described;
        match material {
            Described::Diffuse { reflectance } => Material::Diffuse { reflectance: texture(reflectance) },
            &Described::Mirror { reflectance } => Material::Mirror { reflectance },
            Described::Conductor { alpha, optics } => {
                let (eta, k) = self.optics(optics);
                Material::Conductor { eta, k, alpha: *alpha }
            }
            &Described::Dielectric { ior, absorption, priority } => {
                Material::Dielectric(Medium { ior, absorption, priority })
            }
            Described::Glossy { exponent, reflectance, diffuse } => {
                Material::Glossy { exponent: *exponent, reflectance: *reflectance, base: texture(diffuse) }
            }
            Described::Glazed { ior, reflectance } => {
                Material::Glazed { coat: Coat::new(*ior), base: texture(reflectance) }
            }
            &Described::Emission { radiance, two_sided } => Material::Emission { radiance, two_sided },
        }
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
