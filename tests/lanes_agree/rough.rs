//! Matt surfaces, rough metals, frosted glass.

use crate::{Table, another, viewer};
use specula::bsdf::microfacet::{Beckmann, Distribution, Ggx};
use specula::bsdf::{
    Bsdf, Diffuse, FresnelModel, Glass, Metal, Mix, OrenNayar, Part, RoughConductor, RoughDielectric, Schlick,
};
use specula::math::Rgb;
use specula::math::lanes::Lanes;

parts! {
    /// Matt surfaces.
    Matt matt_surfaces_are_the_same_at_every_width, |table, input| {
        let [_, _, u, v, _, k, x, y] = input;
        let (wo, wi) = (viewer(input), another(input));
        let diffuse = Diffuse { reflectance: Rgb::gray(k.min(1.0)) };
        table.put_sample("diffuse", [1e-6, 1e-6, 0.0], diffuse.sample(wo, [u, v]));
        table.put(["diffuse", "density"], [1e-6, 0.0], diffuse.pdf(wo, wi));
        table.put(["diffuse", "value"], [1e-6, 0.0], diffuse.eval(wo, wi).r);
        let clay = OrenNayar { reflectance: Rgb::gray(k.min(1.0)), roughness: x.abs() };
        // Beside grazing the quotient of the cosines is known to 1e-7 of 1e-3.
        table.put_sample("Oren-Nayar", [1e-6, 1e-6, 3e-4], clay.sample(wo, [u, v]));
        table.put(["Oren-Nayar", "value"], [3e-4, 1e-3], clay.eval(wo, wi).r);
        let weight = Rgb::gray(y.abs());
        let parts = [Bsdf::Diffuse(diffuse), Bsdf::OrenNayar(clay)].map(|bsdf| Part { weight, bsdf });
        let mut mix = Mix::nothing();
        for part in parts {
            mix.push(part);
        }
        table.put(["mix", "value"], [3e-4, 1e-3], mix.eval_diffuse(wo, wi).r);
    }

    /// From matt to mirror by one number.
    Blend schlicks_surface_is_the_same_at_every_width, |table, input| {
        let [_, _, u, v, eta, _, x, y] = input;
        let (wo, wi) = (viewer(input), another(input));
        let surface = Schlick::new(Rgb::gray(y.abs()), x.abs() * 0.9 + 0.05, eta.splat(0.7));
        table.put_sample("Schlick", [2e-5, 1e-4, 3e-4], surface.sample(wo, [u, v]));
        table.put(["Schlick", "value"], [1e-4, 1e-3], surface.eval(wo, wi).r + surface.diffuse(wo, wi).r);
        table.put(["Schlick", "mirror"], [1e-5, 1.0], surface.branch(wo).weight.r);
    }

    /// Metals with long tails.
    GgxMetal rough_metals_are_the_same_at_every_width, |table, input| {
        metals::<F, false>(table, input);
    }

    /// Metals without.
    BeckmannMetal gaussian_metals_are_the_same_at_every_width, |table, input| {
        metals::<F, true>(table, input);
    }

    /// Frosted glass with long tails.
    GgxGlass frosted_glass_is_the_same_at_every_width, |table, input| {
        frosted::<F, false>(table, input);
    }

    /// Frosted glass without.
    BeckmannGlass gaussian_glass_is_the_same_at_every_width, |table, input| {
        frosted::<F, true>(table, input);
    }
}

#[inline(always)]
fn distribution<F: Lanes, const GAUSSIAN: bool>(like: F, [x, y]: [f32; 2]) -> Distribution<F> {
    let (alpha_x, alpha_y) = (like.splat(x), like.splat(y));
    if GAUSSIAN {
        Distribution::Beckmann(Beckmann { alpha_x, alpha_y })
    } else {
        Distribution::Ggx(Ggx { alpha_x, alpha_y })
    }
}

#[inline(always)]
fn metals<F: Lanes, const GAUSSIAN: bool>(table: &mut Table, input: [F; 8]) {
    let [_, _, u, v, eta, k, ..] = input;
    let (wo, wi) = (viewer(input), another(input));
    for (who, ax, ay) in [("metal 0.01", 0.01, 0.01), ("metal 0.1 0.4", 0.1, 0.4), ("metal 1", 1.0, 1.0)] {
        let metal = Metal::new(FresnelModel::Exact, Rgb::gray(eta), Rgb::gray(k + 0.5));
        let metal = RoughConductor { metal, facets: distribution::<F, GAUSSIAN>(eta, [ax, ay]) };
        // Half vectors are rounded to 1e-7, which counts relative to the roughness.
        let bound = 2e-5 + 3e-6 / ax;
        // Where both directions graze the weight is a quotient of their cosines, of 1e-3 and known to 1e-7.
        table.put_sample(who, [2e-5, bound, 3e-4], metal.sample(wo, [u, v]));
        table.put([who, "density"], [bound, 1e-3], metal.pdf(wo, wi));
        table.put([who, "value"], [bound, 1e-3], metal.eval(wo, wi).r);
    }
}

#[inline(always)]
fn frosted<F: Lanes, const GAUSSIAN: bool>(table: &mut Table, input: [F; 8]) {
    let [_, _, u, v, eta, ..] = input;
    let (wo, wi) = (viewer(input), another(input));
    for (who, ax, ay) in [("glass 0.05", 0.05, 0.05), ("glass 0.1 0.4", 0.1, 0.4), ("glass 0.7", 0.7, 0.7)] {
        // Nearer to 1 the refracting facet is a difference of nearly equal directions.
        let glass = Glass::exact(eta.max(1.3));
        let lobe = RoughDielectric { glass, facets: distribution::<F, GAUSSIAN>(eta, [ax, ay]) };
        let bound = 1e-4 + 1e-5 / ax;
        // Gaussian slopes are found within 2e-7 of their distribution: in its tails that is much of a slope, and at its
        // lower end, where it begins like a square, the root of it.
        let [reach, density] = if GAUSSIAN { [3e-4, 10.0 * bound] } else { [2e-5, bound] };
        let numbers = if GAUSSIAN { [u.clamp(1e-3, 0.999), v] } else { [u, v] };
        for sample in lobe.sample(wo, numbers) {
            table.put_sample(who, [reach, density, 3e-4], sample);
        }
        for wi in [wi, -wi] {
            table.put([who, "density"], [bound, 1e-3], lobe.pdf(wo, wi));
            table.put([who, "value"], [bound, 1e-3], lobe.eval(wo, wi).r);
        }
    }
}
