//! Optical constants of metals, as linear Rec.709 triples; and constants for a wanted reflectance.
//!
//! Room temperature, clean and polished, against vacuum. No oxide, tarnish or alloy: iron here is not steel, and copper is
//! not an old kettle.
//!
//! # From spectra to three channels
//!
//! The truth to be met is the colour of the spectral reflectance at each angle: integrated with the CIE 1931 2-degree
//! curves (fits of Wyman, Sloan and Shirley 2013, *Simple Analytic Approximations to the CIE XYZ Color Matching Functions*)
//! under D65, the white of Rec.709, so that a perfect mirror is (1, 1, 1) and no adaptation is needed.
//! Two reductions were measured against it; absolute errors of reflectance in units of 1e-4, over 0 to 89 degrees:
//!
//! | metal | spectrum | constants averaged: max, mean | reflectance matched: max, mean |
//! |---|---|---|---|
//! | Ag | McPeak et al. 2015 | 2, 1 | 1, 0 |
//! | Al | Rakić 1995 | 20, 8 | 9, 0 |
//! | Au | Olmon et al. 2012, evaporated | 600, 246 | 417, 99 |
//! | Cr | Johnson and Christy 1974 | 14, 6 | 2, 0 |
//! | Cu | Johnson and Christy 1972 | 163, 57 | 39, 5 |
//! | Fe | Johnson and Christy 1974 | 1, 1 | 1, 0 |
//! | Ni | Johnson and Christy 1974 | 17, 8 | 5, 1 |
//! | Pt | Rakić et al. 1998, Lorentz-Drude | 11, 5 | 5, 1 |
//! | Ti | Johnson and Christy 1974 | 11, 4 | 4, 1 |
//! | W | Rakić et al. 1998, Lorentz-Drude | 5, 2 | 2, 0 |
//!
//! "Averaged" integrates eta and k themselves with the weights of the channels. "Matched", which the table holds,
//! integrates the reflectance at 0 and 82 degrees and solves each channel for eta and k. It is never worse.
//!
//! Gold's red is outside the gamut of Rec.709: its reflectance is 1.041 at normal incidence, more than any constants
//! can give. That channel is limited to 0.999, with k as averaged and the eta that follows; what is lost is nearly
//! all of the error stated. No other channel is limited, and no reflectance is negative.
//!
//! # Choice of spectra
//!
//! * Silver: ellipsometry every 10 nm on optically thick films stripped from a template, the smoothest surface of those
//!   published; Johnson and Christy 1972 agree within 0.004.
//! * Gold: every 10 nm, between McPeak's brighter and Johnson and Christy's darker samples; their steps of 25 nm are coarse
//!   for its absorption edge.
//! * Copper: Johnson and Christy rather than McPeak, whose freshly stripped film (0.11 brighter in red, outside the gamut)
//!   is not what copper looks like in air.
//! * Aluminium: a critical analysis of many films by Kramers-Kronig consistency.
//! * Chromium, iron, nickel, titanium: the one series of this quality.
//! * Platinum, tungsten: a model fitted to handbook data. The tabulated measurements by electron energy loss (Werner et
//!   al. 2009) give platinum 0.93 and tungsten 0.82 in green where optical ones give 0.64 and 0.50; they are good in the far
//!   ultraviolet, not here.
//!
//! `tests/conductors.rs` recomputes the table and the errors.

use crate::math::Rgb;
use crate::math::lanes::Lanes;

/// A complex index of refraction per channel, relative to vacuum.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Conductor {
    /// Real part.
    pub eta: Rgb<f32>,
    /// Extinction.
    pub k: Rgb<f32>,
}

/// Names that [`named`] knows: chemical symbols, then common names.
pub const NAMES: [&str; 21] = [
    "Ag",
    "Al",
    "Au",
    "Cr",
    "Cu",
    "Fe",
    "Ni",
    "Pt",
    "Ti",
    "W",
    "silver",
    "aluminium",
    "aluminum",
    "gold",
    "chromium",
    "copper",
    "iron",
    "nickel",
    "platinum",
    "titanium",
    "tungsten",
];

/// A metal of the table.
struct Metal {
    /// The chemical symbol, then common names.
    names: &'static [&'static str],
    eta: [f32; 3],
    k: [f32; 3],
}

const METALS: [Metal; 10] = [
    Metal { names: &["Ag", "silver"], eta: [0.0517, 0.0435, 0.0410], k: [4.4073, 3.5937, 2.6031] },
    Metal {
        names: &["Al", "aluminium", "aluminum"],
        eta: [1.4967, 0.9883, 0.6053],
        k: [7.6475, 6.5567, 5.3483],
    },
    Metal { names: &["Au", "gold"], eta: [0.0036, 0.3826, 1.5288], k: [3.6809, 2.2113, 1.6713] },
    Metal { names: &["Cr", "chromium"], eta: [3.2445, 3.1159, 2.2857], k: [3.2855, 3.3367, 3.1169] },
    Metal { names: &["Cu", "copper"], eta: [0.2144, 1.0398, 1.2943], k: [3.2685, 2.6259, 2.3603] },
    Metal { names: &["Fe", "iron"], eta: [2.9218, 2.9196, 2.5461], k: [3.0750, 2.9383, 2.7498] },
    Metal { names: &["Ni", "nickel"], eta: [2.0305, 1.9032, 1.7274], k: [4.1907, 3.5733, 2.8948] },
    Metal { names: &["Pt", "platinum"], eta: [2.3471, 2.0765, 1.8315], k: [4.2305, 3.6710, 3.0946] },
    Metal { names: &["Ti", "titanium"], eta: [2.7442, 2.5090, 2.2393], k: [3.8385, 3.3995, 3.0143] },
    Metal { names: &["W", "tungsten"], eta: [3.6916, 3.4431, 3.3554], k: [2.9411, 2.7340, 2.5098] },
];

/// The constants of a metal, in any case of letters; none if [`NAMES`] lacks it.
#[must_use]
pub fn named(name: &str) -> Option<Conductor> {
    let metal =
        METALS.iter().find(|metal| metal.names.iter().any(|known| known.eq_ignore_ascii_case(name)))?;
    Some(Conductor { eta: metal.eta.into(), k: metal.k.into() })
}

/// The greatest reflectance at normal incidence that [`from_reflectance`] gives.
pub const MAX_REFLECTANCE: f32 = 0.999;

/// The constants (eta, k) with this reflectance at normal incidence, channel by channel. The edge tint in [0, 1] says
/// what happens towards grazing angles: 1 stays bright, 0 dips before the rise as glass of that reflectance would.
///
/// Values outside are limited: reflectance to [0, [`MAX_REFLECTANCE`]], tint to [0, 1], NaN to 0.
///
/// Gulbrandsen 2014, *Artist Friendly Metallic Fresnel*: all pairs of one reflectance r form a curve on which eta runs from
/// (1 - r) / (1 + r) to (1 + sqrt r) / (1 - sqrt r); the tint goes along it.
#[must_use]
pub fn from_reflectance(reflectance: Rgb<f32>, edge_tint: Rgb<f32>) -> (Rgb<f32>, Rgb<f32>) {
    let (reflectance, edge_tint): ([f32; 3], [f32; 3]) = (reflectance.into(), edge_tint.into());
    let constants = [0, 1, 2].map(|i| channel_from_reflectance(reflectance[i], edge_tint[i]));
    (constants.map(|[eta, _]| eta).into(), constants.map(|[_, k]| k).into())
}

/// eta and k of one channel.
#[expect(clippy::cast_possible_truncation, reason = "rounding; eta is below 4000 and k below 2000")]
fn channel_from_reflectance(reflectance: f32, edge_tint: f32) -> [f32; 2] {
    // Unlike the inherent function, this one makes NaN the lower end.
    let r = f64::from(Lanes::clamp(reflectance, 0.0, MAX_REFLECTANCE));
    let tint = f64::from(Lanes::clamp(edge_tint, 0.0, 1.0));
    let low = (1.0 - r) / (1.0 + r);
    let high = (1.0 + r.sqrt()) / (1.0 - r.sqrt());
    let eta = tint * low + (1.0 - tint) * high;
    let k2 = (r * (eta + 1.0).powi(2) - (eta - 1.0).powi(2)) / (1.0 - r);
    [eta as f32, k2.max(0.0).sqrt() as f32]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_list_of_names_is_the_table_s() {
        let of_table: usize = METALS.iter().map(|metal| metal.names.len()).sum();
        assert_eq!(NAMES.len(), of_table, "as many");
        assert!(NAMES.iter().all(|name| named(name).is_some()), "all known");
    }
}
