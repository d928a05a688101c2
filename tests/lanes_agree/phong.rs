//! Fuzzy mirrors.

use crate::{another, ask, viewer};
use specula::bsdf::{Below, Diffuse, Glossy, Jitter, Over, Phong, PhongScale};
use specula::math::Rgb;
use specula::math::lanes::Lanes;

const EXPONENTS: [(&str, f32); 5] =
    [("glossy 0", 0.0), ("glossy 1", 1.0), ("glossy 100", 100.0), ("glossy 1e6", 1e6), ("glossy 1e9", 1e9)];

/// The chord between unit vectors is rounded to 1e-7 and counts by e times itself: up to 8 / sqrt(e) long.
fn bound_of(exponent: f32) -> f32 {
    1e-5 + 2e-6 * exponent.sqrt()
}

/// A lobe over a base as gray as itself.
#[inline(always)]
fn over<L, F>(lobe: L, reflectance: Rgb<F>) -> Over<L, F> {
    Over { lobe, base: Diffuse { reflectance } }
}

parts! {
    /// Directions below the surface are turned, lost, or drawn again.
    Mirrored lobes_about_the_mirror_direction_are_the_same_at_every_width, |table, input| {
        let [_, _, u, v, eta, ..] = input;
        let both = [viewer(input), another(input)];
        for (who, exponent) in EXPONENTS {
            let bound = bound_of(exponent);
            for below in [Below::ThroughR, Below::Discard, Below::Rejection] {
                let reflectance = Rgb::gray(u);
                let lobe = over(Glossy { reflectance, exponent: eta.splat(exponent), below }, reflectance);
                let told = ask(&lobe, both, [u, v]);
                table.put_samples(who, [2e-6, bound, 0.0], told.sampled);
                // Near the horizon of the lobe cosines are differences.
                table.put([who, "density"], [bound, 0.01], told.pdf);
                table.put([who, "value times cosine"], [bound, 0.01], told.glossy.r * both[1].z);
                table.put([who, "base"], [1e-6, 0.0], told.diffuse.r);
            }
        }
    }

    /// Reciprocal lobes.
    Reciprocal reciprocal_lobes_are_the_same_at_every_width, |table, input| {
        let [_, _, u, v, eta, ..] = input;
        let both = [viewer(input), another(input)];
        for (who, exponent) in EXPONENTS {
            let bound = bound_of(exponent);
            for scale in [PhongScale::Modified, PhongScale::MaxCosine] {
                let reflectance = Rgb::gray(u);
                let lobe = over(Phong { reflectance, exponent: eta.splat(exponent), scale }, reflectance);
                let told = ask(&lobe, both, [u, v]);
                table.put_samples(who, [2e-6, bound, 1e-4], told.sampled);
                table.put([who, "density"], [bound, 0.01], told.pdf);
                table.put([who, "value times cosine"], [bound, 0.01], told.glossy.r * both[1].z);
            }
        }
    }

    /// Normals that tremble.
    Trembling jittered_mirrors_are_the_same_at_every_width, |table, input| {
        let [_, _, u, v, eta, ..] = input;
        let both = [viewer(input), another(input)];
        for (who, exponent) in EXPONENTS {
            let bound = 10.0 * bound_of(exponent);
            let reflectance = Rgb::gray(u);
            let lobe = over(Jitter { reflectance, exponent: eta.splat(exponent) }, reflectance);
            let told = ask(&lobe, both, [u, v]);
            table.put_samples(who, [2e-6, bound, 0.0], told.sampled);
            table.put([who, "density"], [bound, 0.01], told.pdf);
            table.put([who, "value times cosine"], [bound, 0.01], told.glossy.r * both[1].z);
        }
    }
}
