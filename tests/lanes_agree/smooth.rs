//! Reflectances, mirrors, glass: what has one way on, or two.

use crate::{another, ask, viewer};
use specula::bsdf::{
    Conductor, Dielectric, FresnelModel, Glass, Glazed, Metal, Mirror, ThinDielectric, fresnel,
};
use specula::math::Rgb;
use specula::math::lanes::Lanes;

/// The knob.
const MODELS: [(&str, FresnelModel); 4] = [
    ("exact", FresnelModel::Exact),
    ("Schlick", FresnelModel::Schlick),
    ("edge term", FresnelModel::F82),
    ("constant", FresnelModel::Constant),
];

parts! {
    /// The formulas.
    Reflectances reflectances_are_the_same_at_every_width, |table, input| {
        let [c, _, _, _, eta, ..] = input;
        // c^2 + d cancels to 1e-7 near the critical angle, of which the root is 3e-4; towards a denser medium it does not.
        let at = fresnel::dielectric(c, eta);
        table.put(["Fresnel", "dielectric"], [1e-3, 1.0], at.reflectance);
        table.put(["Fresnel", "cosine within"], [1e-3, 1.0], at.cos_t);
        table.put(["Fresnel", "denser"], [2e-6, 1.0], fresnel::dielectric(c, eta.max(1.4)).reflectance);
        table.put(["Fresnel", "Schlick"], [1e-6, 1.0], fresnel::schlick(c, fresnel::normal_incidence(eta)));
    }

    /// The same by the knob.
    Models models_of_reflectance_are_the_same_at_every_width, |table, input| {
        let [c, _, _, _, eta, k, ..] = input;
        for (who, model) in MODELS {
            table.put([who, "glass"], [1e-3, 1.0], Glass::new(model, eta).at(c).reflectance);
            let metal = Metal::new(model, Rgb::gray(eta), Rgb::gray(k));
            table.put([who, "metal"], [1e-5, 1.0], metal.at(c).g);
        }
    }

    /// Interfaces that light goes through.
    Transparent glass_is_the_same_at_every_width, |table, input| {
        let [_, _, _, v, eta, ..] = input;
        let wo = viewer(input);
        let glass = ask(&Dielectric { glass: Glass::exact(eta) }, [wo, wo], [v, v]);
        for branch in glass.branches.into_iter().flatten() {
            table.put_branch("dielectric", 1e-3, branch);
        }
        let pane = ThinDielectric { glass: Glass::exact(eta.max(1.1)), transmittance: Rgb::gray(v) };
        for branch in ask(&pane, [wo, wo], [v, v]).branches.into_iter().flatten() {
            table.put_branch("pane", 2e-6, branch);
        }
    }

    /// Surfaces that it does not go through.
    Polished polished_surfaces_are_the_same_at_every_width, |table, input| {
        let [_, _, u, v, eta, k, ..] = input;
        let wo = viewer(input);
        let wi = another(input);
        let mirror = ask(&Mirror { reflectance: Rgb::gray(u) }, [wo, wi], [u, v]);
        for branch in mirror.branches.into_iter().flatten() {
            table.put_branch("mirror", 1e-6, branch);
        }
        // (eta - k)(eta + k) - s^2 cancels where both are near one.
        let metal = Metal::new(FresnelModel::Exact, Rgb::gray(eta), Rgb::gray(k));
        for branch in ask(&Conductor { metal }, [wo, wi], [u, v]).branches.into_iter().flatten() {
            table.put_branch("conductor", 1e-5, branch);
        }
        let glazed = Glazed { glass: Glass::exact(eta.max(1.4)), inside: Rgb::gray(v) };
        let told = ask(&glazed, [wo, wi], [u, v]);
        for branch in told.branches.into_iter().flatten() {
            table.put_branch("glazed", 2e-6, branch);
        }
        table.put(["glazed", "value"], [2e-6, 1.0], told.diffuse.r);
    }
}
