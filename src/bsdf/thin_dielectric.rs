//! A pane of glass, a soap film, a sheet of plastic: two parallel faces so close that light goes on where it came in.
//!
//! The light that bounces between the faces is summed; interference is left out.

use crate::bsdf::mirror::reflection;
use crate::bsdf::{Branch, Glass};
use crate::math::lanes::Lanes;
use crate::math::{Rgb, Vec3};

/// A thin sheet, the same on both sides.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ThinDielectric<F> {
    /// How each face reflects; its `eta` is the index of the sheet, relative to outside.
    pub glass: Glass<F>,
    /// What is left of light that crosses the sheet once, straight on, per channel, in [0, 1].
    pub transmittance: Rgb<F>,
}

impl<F: Lanes> ThinDielectric<F> {
    /// Reflection, and transmission straight on.
    #[inline(always)]
    pub fn branches(&self, wo: Vec3<F>) -> [Branch<F>; 2] {
        let [reflected, transmitted] = self.fractions(wo.z);
        let through = Branch { wi: -wo, transmission: true, ..reflection(wo, transmitted) };
        [reflection(wo, reflected), through]
    }

    /// What is reflected and what goes through, at this cosine outside.
    ///
    /// With R at each face and A per crossing: R + (1 - R)^2 A^2 R / (1 - R^2 A^2) and (1 - R)^2 A / (1 - R^2 A^2), the
    /// geometric series (Stokes 1860, On the Intensity of the Light Reflected from or Transmitted through a Pile of Plates).
    #[inline(always)]
    pub fn fractions(&self, cos: F) -> [Rgb<F>; 2] {
        let at = self.glass.at(cos);
        let slant = at.cos_t.max(1e-30).recip();
        let a = Rgb::new(
            self.transmittance.r.powf(slant),
            self.transmittance.g.powf(slant),
            self.transmittance.b.powf(slant),
        );
        let [rr, tr] = series(at.reflectance, a.r);
        let [rg, tg] = series(at.reflectance, a.g);
        let [rb, tb] = series(at.reflectance, a.b);
        [Rgb::new(rr, rg, rb), Rgb::new(tr, tg, tb)]
    }
}

/// The fraction reflected and the fraction transmitted by two faces.
#[inline(always)]
fn series<F: Lanes>(r: F, a: F) -> [F; 2] {
    let passed = -r + 1.0;
    let ra = r * a;
    // 1 - (R A)^2 in factors. Where both are 1 nothing comes in, and the quotient is 0 by the floor.
    let left = ((-ra + 1.0) * (ra + 1.0)).max(1e-30);
    let through = passed * passed * a / left;
    // R T A is what of the transmitted light turns back once more.
    [(through * ra + r).min(1.0), through]
}
