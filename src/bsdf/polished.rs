//! Glossy lobes as mirrors that are to be blurred.

use crate::bsdf::{Bsdf, mirrored};
use crate::math::{Rgb, Vec3};

/// A mirror, and the lobe that it stands for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LobeOfMirror {
    /// The part of the light along the mirrored ray that is sent on.
    pub weight: Rgb<f32>,
    /// Exponent of the lobe about the mirrored ray, (e + 1) / (2 pi) cos^e, or of one that is as wide.
    pub exponent: f32,
}

impl Bsdf<f32> {
    /// The glossy reflection as a mirror with a lobe, where [`Self::is_fuzzy_mirror`]; `None` also where nothing is sent on.
    #[must_use]
    pub fn lobe_of_mirror(&self, wo: Vec3<f32>) -> Option<LobeOfMirror> {
        let exponent = match self {
            Self::Glossy(over) => over.lobe.exponent,
            Self::Phong(over) => over.lobe.exponent,
            Self::Jitter(over) => (over.lobe.exponent - 3.0).max(0.0) * 0.25,
            _ => return None,
        };
        let r = mirrored(wo);
        let pdf = self.pdf_glossy(wo, r);
        let weight = self.eval_glossy(wo, r).scale(r.z / pdf);
        (pdf > 0.0 && weight.is_finite()).then_some(LobeOfMirror { weight, exponent })
    }

    /// Whether there is a glossy reflection that is round about the mirrored ray, or nearly: those of `glossy` and `phong`,
    /// and jittered mirrors by the lobe that they have straight on, (m - 3) / 4.
    #[must_use]
    pub fn is_fuzzy_mirror(&self) -> bool {
        matches!(self, Self::Glossy(_) | Self::Phong(_) | Self::Jitter(_))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bsdf::{Diffuse, Glossy, Jitter, Mirror, Over};

    #[test]
    fn the_weight_is_what_the_lobe_sends_on() {
        let reflectance = Rgb::new(0.8, 0.5, 0.2);
        let base = Diffuse { reflectance: Rgb::gray(0.1) };
        for exponent in [0.0, 20.0, 1e4, 1e6] {
            for x in [0.0_f32, 0.5, 0.99] {
                let wo = Vec3::new(x, 0.0, (1.0 - x * x).sqrt());
                let glossy = Bsdf::Glossy(Over { lobe: Glossy::new(reflectance, exponent), base });
                let found = glossy.lobe_of_mirror(wo).expect("a lobe");
                assert!((found.weight.g - 0.5).abs() < 1e-4, "{exponent} {x}: {found:?}");
                assert!((found.exponent - exponent).abs() < 1e-3, "{found:?}");
            }
        }
        let jitter = Bsdf::Jitter(Over { lobe: Jitter { reflectance, exponent: 403.0 }, base });
        let straight = jitter.lobe_of_mirror(Vec3::new(0.0, 0.0, 1.0)).expect("a lobe");
        assert!(
            (straight.exponent - 100.0).abs() < 1e-3 && (straight.weight.r - 0.8).abs() < 1e-4,
            "{straight:?}"
        );
        assert!(
            Bsdf::Mirror(Mirror { reflectance }).lobe_of_mirror(Vec3::new(0.0, 0.0, 1.0)).is_none(),
            "sharp"
        );
    }
}
