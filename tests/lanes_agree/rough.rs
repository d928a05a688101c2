//! Matt surfaces, rough metals, frosted glass.

use crate::{Table, another, ask, viewer};
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
        let told = ask(&surface, [wo, wi], [u, v]);
        table.put_samples("Schlick", [2e-5, 1e-4, 3e-4], told.sampled);
        table.put(["Schlick", "density"], [1e-4, 1e-3], told.pdf);
        table.put(["Schlick", "value"], [1e-4, 1e-3], told.glossy.r + told.diffuse.r);
        for branch in told.branches.into_iter().flatten() {
            table.put(["Schlick", "mirror"], [1e-5, 1.0], branch.weight.r);
        }
    }

    /// Metals, with and without long tails.
    Metals rough_metals_are_the_same_at_every_width, |table, input| {
        metals(table, input, false);
        metals(table, input, true);
    }

    /// Frosted glass, with and without long tails.
    Frosted frosted_glass_is_the_same_at_every_width, |table, input| {
        frosted(table, input, false);
        frosted(table, input, true);
    }
}

#[inline(always)]
fn distribution<F: Lanes>(like: F, [x, y]: [f32; 2], gaussian: bool) -> Distribution<F> {
    let (alpha_x, alpha_y) = (like.splat(x), like.splat(y));
    if gaussian {
        Distribution::Beckmann(Beckmann { alpha_x, alpha_y })
    } else {
        Distribution::Ggx(Ggx { alpha_x, alpha_y })
    }
}

#[inline(always)]
fn metals<F: Lanes>(table: &mut Table, input: [F; 8], gaussian: bool) {
    let [_, _, u, v, eta, k, ..] = input;
    let (wo, wi) = (viewer(input), another(input));
    for (who, ax, ay) in [("metal 0.01", 0.01, 0.01), ("metal 0.1 0.4", 0.1, 0.4), ("metal 1", 1.0, 1.0)] {
        let metal = Metal::new(FresnelModel::Exact, Rgb::gray(eta), Rgb::gray(k + 0.5));
        let metal = RoughConductor { metal, facets: distribution(eta, [ax, ay], gaussian) };
        // Half vectors are rounded to 1e-7, which counts relative to the roughness.
        let bound = 2e-5 + 3e-6 / ax;
        // Where both directions graze the weight is a quotient of their cosines, of 1e-3 and known to 1e-7.
        let told = ask(&metal, [wo, wi], [u, v]);
        table.put_samples(who, [2e-5, bound, 3e-4], told.sampled);
        table.put([who, "density"], [bound, 1e-3], told.pdf);
        table.put([who, "value"], [bound, 1e-3], told.glossy.r);
    }
}

#[inline(always)]
fn frosted<F: Lanes>(table: &mut Table, input: [F; 8], gaussian: bool) {
    let [_, _, u, v, eta, ..] = input;
    let (wo, wi) = (viewer(input), another(input));
    for (who, ax, ay) in [("glass 0.05", 0.05, 0.05), ("glass 0.1 0.4", 0.1, 0.4), ("glass 0.7", 0.7, 0.7)] {
        // Nearer to 1 the refracting facet is a difference of nearly equal directions.
        let glass = Glass::exact(eta.max(1.3));
        let lobe = RoughDielectric { glass, facets: distribution(eta, [ax, ay], gaussian) };
        let bound = 1e-4 + 1e-5 / ax;
        // Gaussian slopes are found within 2e-7 of their distribution: in its tails that is much of a slope, and at its
        // lower end, where it begins like a square, the root of it.
        let [reach, density] = if gaussian { [3e-4, 10.0 * bound] } else { [2e-5, bound] };
        let numbers = if gaussian { [u.clamp(1e-3, 0.999), v] } else { [u, v] };
        for wi in [wi, -wi] {
            let told = ask(&lobe, [wo, wi], numbers);
            table.put_samples(who, [reach, density, 3e-4], told.sampled);
            table.put([who, "density"], [bound, 1e-3], told.pdf);
            table.put([who, "value"], [bound, 1e-3], told.glossy.r);
        }
    }
}
