//! Fuzzy mirrors.

use crate::{another, viewer};
use specula::bsdf::{Below, Glossy, Jitter, Phong, PhongScale};
use specula::math::Rgb;
use specula::math::lanes::Lanes;

const EXPONENTS: [(&str, f32); 5] =
    [("glossy 0", 0.0), ("glossy 1", 1.0), ("glossy 100", 100.0), ("glossy 1e6", 1e6), ("glossy 1e9", 1e9)];

/// The chord between unit vectors is rounded to 1e-7 and counts by e times itself: up to 8 / sqrt(e) long.
fn bound_of(exponent: f32) -> f32 {
    1e-5 + 2e-6 * exponent.sqrt()
}

parts! {
    /// Directions below the surface are turned.
    Turned turned_lobes_are_the_same_at_every_width, |table, input| {
        let [_, _, u, v, eta, ..] = input;
        let (wo, wi) = (viewer(input), another(input));
        for (who, exponent) in EXPONENTS {
            let lobe = Glossy::new(Rgb::gray(u), eta.splat(exponent));
            let bound = bound_of(exponent);
            table.put_sample(who, [2e-6, bound, 0.0], lobe.sample(wo, [u, v]));
            // Near the horizon of the lobe cosines are differences.
            table.put([who, "density"], [bound, 0.01], lobe.pdf(wo, wi));
            table.put([who, "value times cosine"], [bound, 0.01], lobe.eval(wo, wi).r * wi.z);
        }
    }

    /// They are lost, or drawn again.
    CutOff cut_lobes_are_the_same_at_every_width, |table, input| {
        let [_, _, u, v, eta, ..] = input;
        let (wo, wi) = (viewer(input), another(input));
        for (who, exponent) in EXPONENTS {
            let bound = bound_of(exponent);
            for below in [Below::Discard, Below::Rejection] {
                let lobe = Glossy { reflectance: Rgb::gray(u), exponent: eta.splat(exponent), below };
                table.put_sample(who, [2e-6, bound, 0.0], lobe.sample(wo, [u, v]));
                table.put([who, "density"], [bound, 0.01], lobe.pdf(wo, wi));
            }
        }
    }

    /// Reciprocal lobes.
    Reciprocal reciprocal_lobes_are_the_same_at_every_width, |table, input| {
        let [_, _, u, v, eta, ..] = input;
        let (wo, wi) = (viewer(input), another(input));
        for (who, exponent) in EXPONENTS {
            let bound = bound_of(exponent);
            for scale in [PhongScale::Modified, PhongScale::MaxCosine] {
                let lobe = Phong { reflectance: Rgb::gray(u), exponent: eta.splat(exponent), scale };
                table.put_sample(who, [2e-6, bound, 1e-4], lobe.sample(wo, [u, v]));
                table.put([who, "value times cosine"], [bound, 0.01], lobe.eval(wo, wi).r * wi.z);
            }
        }
    }

    /// Normals that tremble.
    Trembling jittered_mirrors_are_the_same_at_every_width, |table, input| {
        let [_, _, u, v, eta, ..] = input;
        let (wo, wi) = (viewer(input), another(input));
        for (who, exponent) in EXPONENTS {
            let bound = 10.0 * bound_of(exponent);
            let lobe = Jitter { reflectance: Rgb::gray(u), exponent: eta.splat(exponent) };
            table.put_sample(who, [2e-6, bound, 0.0], lobe.sample(wo, [u, v]));
            table.put([who, "density"], [bound, 0.01], lobe.pdf(wo, wi));
        }
    }
}
