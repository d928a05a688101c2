//! Materials.

use crate::bsdf::microfacet::{Beckmann, Distribution, Ggx, SMOOTHEST};
use crate::bsdf::{Coat, FresnelModel, Glass, Glossy, Jitter, Metal, Phong, Schlick, ThinDielectric};
use crate::error::Problem;
use crate::material::{Emission, Facets, Layer, Material, Medium, Scattering, conductors};
use crate::math::Rgb;
use crate::scene::build::Builder;
use crate::scene::build::pruning::UNUSED;
use crate::scene::description::{self, MixPart, Named, Optics, PerTangent, Roughness};
use crate::scene::pruned::Ineffective;
use crate::texture::Texture;
use std::collections::{HashMap, HashSet};

/// Indices of refraction for which Schlick's polynomial is within 0.06.
const SCHLICK_IS_CLOSE: std::ops::RangeInclusive<f32> = 1.3..=2.2;

impl Builder {
    /// Adds materials; of those that are not among the `referenced`, where these are known, only the names.
    pub(super) fn add_materials(
        &mut self,
        materials: &[Named<description::Material>],
        referenced: Option<&HashSet<&str>>,
    ) {
        let is_used =
            |named: &Named<_>| referenced.is_none_or(|referenced| referenced.contains(named.name.as_str()));
        let plain: Vec<Option<Material>> =
            materials.iter().map(|named| if is_used(named) { self.plain(named) } else { None }).collect();
        let by_name: HashMap<&str, &Material> = materials
            .iter()
            .zip(&plain)
            .filter_map(|(named, own)| Some((named.name.as_str(), own.as_ref()?)))
            .collect();
        for (named, own) in materials.iter().zip(&plain) {
            let material = if is_used(named) {
                own.clone().unwrap_or_else(|| self.placed_at(named, |own| own.mix(named, &by_name)))
            } else {
                self.prune(Ineffective::Material, format!("`{}`", named.name), Some(&named.place));
                UNUSED
            };
            let id = self.add_material(named.name.clone(), material);
            self.named.insert(named.name.clone(), id);
        }
    }

    /// What comes of a material, of which warnings and what was left out are placed at its name.
    fn placed_at<T>(&mut self, named: &Named<description::Material>, make: impl FnOnce(&mut Self) -> T) -> T {
        let (warnings, pruned) = (self.warnings.len(), self.pruned.len());
        let made = make(self);
        for warning in &mut self.warnings[warnings..] {
            warning.place.get_or_insert_with(|| named.place.clone());
        }
        for pruned in &mut self.pruned[pruned..] {
            pruned.what = format!("`{}`: {}", named.name, pruned.what);
            pruned.place.get_or_insert_with(|| named.place.clone());
        }
        made
    }

    /// A material that is no mix.
    fn plain(&mut self, named: &Named<description::Material>) -> Option<Material> {
        if let description::Scattering::Mix { .. } = named.value.scattering {
            return None;
        }
        Some(self.placed_at(named, |own| own.material(&named.value)))
    }

    fn mix(&mut self, named: &Named<description::Material>, plain: &HashMap<&str, &Material>) -> Material {
        let description::Scattering::Mix { parts } = &named.value.scattering else {
            return self.material(&named.value);
        };
        let mut layers = Vec::new();
        for MixPart { material, weight } in parts {
            match plain.get(material.value.as_str()) {
                Some(part) if part.emission.is_none() && weight.is_black() && self.prunes => {
                    let what = format!("`{}` has a weight of zero", material.value);
                    self.prune(Ineffective::Lobe, what, Some(&material.place));
                }
                Some(part) if part.emission.is_none() => {
                    if part.relief.is_some() || part.opacity.is_some() {
                        let what = format!(
                            "the relief and the holes of `{}` are not those of the mix",
                            material.value
                        );
                        let remedy = "give `normal_map`, `bump` or `opacity` to the mix";
                        self.warnings.push(Problem::at(material.place.clone(), what).remedy(remedy));
                    }
                    layers.push(Layer { weight: *weight, scattering: part.scattering.clone() });
                }
                Some(_) => {
                    let what = format!("`{}` shines, which a part of a mix cannot", material.value);
                    let remedy = "give the mix a key `emission` instead";
                    self.problems.push(Problem::at(material.place.clone(), what).remedy(remedy));
                }
                None => {
                    let what = format!("no material `{}` that is not a mix", material.value);
                    let remedy = "name materials that are not mixes themselves";
                    self.problems.push(Problem::at(material.place.clone(), what).remedy(remedy));
                }
            }
        }
        let counting = layers.iter().filter(|layer| !layer.weight.is_black());
        if counting.filter(|layer| matches!(layer.scattering, Scattering::Dielectric { .. })).count() > 1 {
            let what = format!("`{}` would be the surface of two bodies", named.name);
            let remedy = "let one part at most be a `dielectric`";
            self.problems.push(Problem::at(named.place.clone(), what).remedy(remedy));
        }
        let is_empty = layers.is_empty() && self.prunes;
        let scattering = if is_empty { Scattering::Black } else { Scattering::Mix(layers) };
        let mut turns = scattering.turns();
        if turns.next().is_some_and(|first| turns.any(|turn| (turn - first).abs() > 1e-6)) {
            let what = format!("parts of `{}` are brushed in different directions", named.name);
            let remedy = "give all of them the same `rotate_deg` (anisotropic `schlick` has 0)";
            self.problems.push(Problem::at(named.place.clone(), what).remedy(remedy));
        }
        drop(turns);
        self.finished(scattering, &named.value)
    }

    pub(super) fn material(&mut self, material: &description::Material) -> Material {
        if let description::Scattering::Emission { radiance, two_sided } = &material.scattering {
            use description::Texture::Constant;
            let (radiance, two_sided) = match (radiance, &material.emission) {
                (Constant(radiance), Constant(besides)) => {
                    (Texture::Constant(*radiance + *besides), *two_sided && besides.is_black())
                }
                (radiance, Constant(besides)) if besides.is_black() => {
                    (self.colored(radiance, f32::INFINITY), *two_sided)
                }
                (radiance, _) => {
                    let what = "`emission` beside a `radiance`, one of them a texture, is ignored";
                    self.warnings.push(Problem::new(what).remedy("give one of them"));
                    (self.colored(radiance, f32::INFINITY), *two_sided)
                }
            };
            let emission = shining(radiance, two_sided);
            return Material { emission, ..self.finished(Scattering::Black, material) };
        }
        let scattering = self.matt(&material.scattering).unwrap_or_else(|| self.shiny(&material.scattering));
        let scattering = self.without_empty_lobes(scattering);
        self.finished(scattering, material)
    }

    /// A surface that scatters like this, with all else that is said of it; it may shine on the side of its normals.
    fn finished(&mut self, scattering: Scattering, described: &description::Material) -> Material {
        let emission = match described.scattering {
            description::Scattering::Emission { .. } => None,
            _ => shining(self.colored(&described.emission, f32::INFINITY), false),
        };
        let relief = self.relief(described).and_then(|relief| self.unless_even(relief));
        let opacity = described.opacity.as_ref().and_then(|image| self.opacity(image));
        let opacity = opacity.and_then(|opacity| self.unless_whole(opacity));
        Material { scattering, emission, relief, opacity }
    }

    /// Surfaces without an interface.
    fn matt(&mut self, scattering: &description::Scattering) -> Option<Scattering> {
        use description::Scattering as Described;
        Some(match scattering {
            Described::Diffuse { reflectance } => {
                Scattering::Diffuse { reflectance: self.texture(reflectance) }
            }
            Described::OrenNayar { reflectance, roughness } => {
                Scattering::OrenNayar { reflectance: self.texture(reflectance), roughness: *roughness }
            }
            Described::Mirror { reflectance } => {
                Scattering::Mirror { reflectance: self.texture(reflectance) }
            }
            Described::Glossy { exponent, reflectance, diffuse, .. } if self.jitters => {
                // As sharp as the lobe straight on: angles double at a mirror.
                let lobe = Jitter { reflectance: *reflectance, exponent: (4.0 * exponent + 3.0).min(1e9) };
                Scattering::Jitter { lobe, base: self.texture(diffuse) }
            }
            Described::Glossy { exponent, reflectance, diffuse, below } => {
                let lobe = Glossy { reflectance: *reflectance, exponent: *exponent, below: *below };
                Scattering::Glossy { lobe, base: self.texture(diffuse) }
            }
            Described::Phong { exponent, reflectance, diffuse, scale } => {
                let lobe = Phong { reflectance: *reflectance, exponent: *exponent, scale: *scale };
                Scattering::Phong { lobe, base: self.texture(diffuse) }
            }
            Described::Jitter { exponent, reflectance, diffuse } => {
                let lobe = Jitter { reflectance: *reflectance, exponent: *exponent };
                Scattering::Jitter { lobe, base: self.texture(diffuse) }
            }
            &Described::Schlick { color, roughness, isotropy } => {
                Scattering::Schlick(Schlick::new(color, roughness, isotropy))
            }
            _ => return None,
        })
    }

    /// Surfaces that reflect by Fresnel.
    fn shiny(&mut self, scattering: &description::Scattering) -> Scattering {
        use description::Scattering as Described;
        match scattering {
            Described::Conductor { alpha, distribution, rotate_deg, fresnel, optics } => {
                let (eta, k) = self.optics(optics);
                let metal = Metal::new(self.model(*fresnel), eta, k);
                Scattering::Conductor { metal, facets: self.facets(alpha, *distribution, *rotate_deg) }
            }
            &Described::Dielectric {
                ior,
                absorption,
                priority,
                ref alpha,
                distribution,
                rotate_deg,
                fresnel,
            } => Scattering::Dielectric {
                medium: Medium { ior, absorption, priority },
                fresnel: self.model_for(fresnel, ior),
                facets: self.facets(alpha, distribution, rotate_deg),
            },
            &Described::ThinDielectric { ior, transmittance, fresnel } => {
                let glass = Glass::new(self.model_for(fresnel, ior), ior);
                Scattering::ThinDielectric(ThinDielectric { glass, transmittance })
            }
            Described::Glazed { ior, reflectance, fresnel } => {
                let coat = Coat::new(self.model_for(*fresnel, *ior), *ior);
                Scattering::Glazed { coat, base: self.texture(reflectance) }
            }
            _ => Scattering::Black,
        }
    }

    /// What a material says of its reflectance, else what the rendering says: who writes it beside a material means that
    /// one, as in a comparison.
    fn model(&self, own: Option<FresnelModel>) -> FresnelModel {
        own.unwrap_or(self.fresnel)
    }

    /// The same for a dielectric, of which it is told where the approximation is bad.
    fn model_for(&mut self, own: Option<FresnelModel>, ior: f32) -> FresnelModel {
        let model = self.model(own);
        #[expect(clippy::float_cmp, reason = "no interface reflects nothing in every model")]
        if model == FresnelModel::Schlick && ior != 1.0 && !SCHLICK_IS_CLOSE.contains(&ior) {
            let (low, high) = (SCHLICK_IS_CLOSE.start(), SCHLICK_IS_CLOSE.end());
            let what = format!("Schlick's reflectance is far off for an index of {ior}");
            let remedy = format!("keep it for {low} to {high}, use `fresnel = \"exact\"` elsewhere");
            self.warnings.push(Problem::new(what).remedy(remedy));
        }
        model
    }

    /// Facets of this width; none where it is too small to tell from a mirror everywhere.
    fn facets(
        &mut self,
        alpha: &Roughness,
        distribution: description::Distribution,
        rotate_deg: f32,
    ) -> Option<Facets> {
        match alpha {
            Roughness::Constant(widths) => facets(*widths, distribution, rotate_deg),
            Roughness::Image(image) => {
                let width = self.scalar(image, "the surface is left polished")?;
                if let Some(width) = self.constant(&width) {
                    self.prune(Ineffective::Texture, "a roughness that is the same everywhere", None);
                    let distribution = spread(distribution, [width; 2]);
                    return Some(Facets { distribution, turn: None, width: None });
                }
                let distribution = spread(distribution, [SMOOTHEST; 2]);
                Some(Facets { distribution, turn: None, width: Some(width) })
            }
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

/// Light of this radiance; none where it is black everywhere.
fn shining(radiance: Texture, two_sided: bool) -> Option<Emission> {
    (radiance != Texture::Constant(Rgb::BLACK)).then_some(Emission { radiance, two_sided })
}

/// Facets of these widths; none where both are too smooth to tell from a mirror.
fn facets(
    PerTangent([x, y]): PerTangent,
    distribution: description::Distribution,
    rotate_deg: f32,
) -> Option<Facets> {
    if x.max(y) < SMOOTHEST {
        return None;
    }
    let distribution = spread(distribution, [x, y]);
    #[expect(clippy::float_cmp, reason = "only equal widths look the same from all sides")]
    let turn = (x.max(SMOOTHEST) != y.max(SMOOTHEST)).then_some(rotate_deg.to_radians());
    Some(Facets { distribution, turn, width: None })
}

/// How normals are spread by facets of these widths.
fn spread(distribution: description::Distribution, widths: [f32; 2]) -> Distribution<f32> {
    let [alpha_x, alpha_y] = widths.map(|width| width.max(SMOOTHEST));
    match distribution {
        description::Distribution::Ggx => Distribution::Ggx(Ggx { alpha_x, alpha_y }),
        description::Distribution::Beckmann => Distribution::Beckmann(Beckmann { alpha_x, alpha_y }),
    }
}
