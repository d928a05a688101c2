//! The table of metals is recomputed from published spectra, and its reduction to three channels is measured.
//!
//! Spectra come from `optics/nk` of the data; metals whose file is absent are skipped.

#![expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "small non-negative numbers")]

#[path = "support/data.rs"]
mod data;

use data::data;
use specula::material::conductors;
use specula::math::Rgb;
use std::f64::consts::FRAC_PI_2;

/// Wavelengths of the integration, in nm.
const WAVELENGTHS: std::ops::RangeInclusive<u32> = 380..=780;

/// Relative power of CIE standard illuminant D65 at 380, 390, ..., 780 nm (CIE 15:2004, table T.1).
const D65: [f64; 41] = [
    49.9755, 54.6482, 82.7549, 91.486, 93.4318, 86.6823, 104.865, 117.008, 117.812, 114.861, 115.923,
    108.811, 109.354, 107.802, 104.79, 107.689, 104.405, 104.046, 100.0, 96.3342, 95.788, 88.6856, 90.0062,
    89.5991, 87.6987, 83.2886, 83.6992, 80.0268, 80.2146, 82.2778, 78.2842, 69.7213, 71.6091, 74.349, 61.604,
    69.8856, 75.087, 63.5927, 46.4182, 66.8054, 63.3828,
];

/// Linear Rec.709 from CIE XYZ: the inverse of the primaries and white of ITU-R BT.709.
const REC709_FROM_XYZ: [[f64; 3]; 3] = [
    [3.240_454_2, -1.537_138_5, -0.498_531_4],
    [-0.969_266_0, 1.876_010_8, 0.041_556_0],
    [0.055_643_4, -0.204_025_9, 1.057_225_2],
];

/// CIE 1931 2-degree curves: Wyman, Sloan and Shirley 2013, Simple Analytic Approximations to the CIE XYZ Color Matching
/// Functions, the fit of several lobes.
fn xyz(nm: f64) -> [f64; 3] {
    let lobe = |height: f64, centre: f64, below: f64, above: f64| {
        let t = (nm - centre) * if nm < centre { below } else { above };
        height * (-0.5 * t * t).exp()
    };
    [
        lobe(0.362, 442.0, 0.0624, 0.0374)
            + lobe(1.056, 599.8, 0.0264, 0.0323)
            + lobe(-0.065, 501.1, 0.0490, 0.0382),
        lobe(0.821, 568.8, 0.0213, 0.0247) + lobe(0.286, 530.9, 0.0613, 0.0322),
        lobe(1.217, 437.0, 0.0845, 0.0278) + lobe(0.681, 459.0, 0.0385, 0.0725),
    ]
}

/// What each wavelength adds to a channel, so that a perfect mirror under D65 is (1, 1, 1).
fn channel_weights() -> [Vec<f64>; 3] {
    REC709_FROM_XYZ.map(|row| {
        let weight = |nm: u32| {
            let step = f64::from(nm - 380) / 10.0;
            let i = (step as usize).min(39);
            let power = D65[i] + (D65[i + 1] - D65[i]) * (step - i as f64);
            power * xyz(f64::from(nm)).iter().zip(row).map(|(curve, m)| curve * m).sum::<f64>()
        };
        let weights: Vec<_> = WAVELENGTHS.map(weight).collect();
        let total: f64 = weights.iter().sum();
        weights.into_iter().map(|w| w / total).collect()
    })
}

/// Where a metal's spectrum comes from.
enum Source {
    /// A table of wavelength in micrometres, n and k.
    Table(&'static str),
    /// Rakic, Djurisic, Elazar and Majewski 1998, Optical Properties of Metallic Films for Vertical-Cavity Optoelectronic
    /// Devices, Lorentz-Drude model: plasma frequency, (f0, damping), then (f, damping, frequency); in eV.
    LorentzDrude(f64, [f64; 2], [[f64; 3]; 4]),
}

#[expect(clippy::approx_constant, reason = "a measured frequency happens to be near pi")]
const METALS: [(&str, Source); 10] = [
    ("Ag", Source::Table("Ag-McPeak")),
    ("Al", Source::Table("Al-Rakic")),
    ("Au", Source::Table("Au-Olmon-ev")),
    ("Cr", Source::Table("Cr-Johnson")),
    ("Cu", Source::Table("Cu-Johnson")),
    ("Fe", Source::Table("Fe-Johnson")),
    ("Ni", Source::Table("Ni-Johnson")),
    (
        "Pt",
        Source::LorentzDrude(
            9.59,
            [0.333, 0.080],
            [[0.191, 0.517, 0.780], [0.659, 1.838, 1.314], [0.547, 3.668, 3.141], [3.576, 8.517, 9.249]],
        ),
    ),
    ("Ti", Source::Table("Ti-Johnson")),
    (
        "W",
        Source::LorentzDrude(
            13.22,
            [0.206, 0.064],
            [[0.054, 0.530, 1.004], [0.166, 1.281, 1.917], [0.706, 3.332, 3.580], [2.590, 5.836, 7.498]],
        ),
    ),
];

/// eta and k at each wavelength; none if the file is absent.
type Spectrum = Vec<[f64; 2]>;

fn spectrum(source: &Source) -> Option<Spectrum> {
    match source {
        Source::Table(name) => tabulated(name),
        Source::LorentzDrude(plasma, drude, lorentz) => Some(
            WAVELENGTHS
                .map(|nm| lorentz_drude(1_239.841_98 / f64::from(nm), *plasma, drude, lorentz))
                .collect(),
        ),
    }
}

/// Linear interpolation of the rows of three numbers in a file of the refractiveindex.info database.
fn tabulated(name: &str) -> Option<Spectrum> {
    let text = std::fs::read_to_string(data(&format!("optics/nk/{name}.yml"))?).expect("readable");
    let rows: Vec<[f64; 3]> = text
        .lines()
        .skip_while(|line| !line.contains("tabulated nk"))
        .filter_map(|line| {
            let numbers: Vec<f64> = line.split_whitespace().map_while(|word| word.parse().ok()).collect();
            numbers.try_into().ok()
        })
        .collect();
    Some(
        WAVELENGTHS
            .map(|nm| {
                let um = f64::from(nm) / 1000.0;
                let after = rows.partition_point(|row| row[0] <= um);
                assert!((1..rows.len()).contains(&after), "{name} covers {nm} nm");
                let (a, b) = (rows[after - 1], rows[after]);
                let t = (um - a[0]) / (b[0] - a[0]);
                [a[1] + (b[1] - a[1]) * t, a[2] + (b[2] - a[2]) * t]
            })
            .collect(),
    )
}

/// The root of the permittivity at a photon energy in eV.
fn lorentz_drude(energy: f64, plasma: f64, [f0, damping]: &[f64; 2], lorentz: &[[f64; 3]; 4]) -> [f64; 2] {
    // strength / (real + i imaginary), with the sign of time that makes absorption positive.
    let term = |strength: f64, real: f64, imaginary: f64| {
        let scale = strength * plasma * plasma / (real * real + imaginary * imaginary);
        [real * scale, -imaginary * scale]
    };
    let mut permittivity = [1.0, 0.0];
    let mut add = |[real, imaginary]: [f64; 2]| {
        permittivity[0] += real;
        permittivity[1] += imaginary;
    };
    add(term(*f0, -energy * energy, -energy * damping));
    for [f, damping, frequency] in lorentz {
        add(term(*f, frequency * frequency - energy * energy, -energy * damping));
    }
    let [real, imaginary] = permittivity;
    let modulus = real.hypot(imaginary);
    [((modulus + real) / 2.0).sqrt(), ((modulus - real) / 2.0).sqrt()]
}

/// Reflectance for unpolarised light, by complex arithmetic written out (Born and Wolf 1999, section 14.2).
fn reflectance([eta, k]: [f64; 2], cos: f64) -> f64 {
    let (c2, s2) = (cos * cos, 1.0 - cos * cos);
    let t0 = eta * eta - k * k - s2;
    let ab = t0.hypot(2.0 * eta * k);
    let a = ((ab + t0) / 2.0).max(0.0).sqrt();
    let rs = (ab + c2 - 2.0 * a * cos) / (ab + c2 + 2.0 * a * cos);
    let rp = rs * (ab * c2 + s2 * s2 - 2.0 * a * cos * s2) / (ab * c2 + s2 * s2 + 2.0 * a * cos * s2);
    (rs + rp) / 2.0
}

fn cos_deg(angle: usize) -> f64 {
    (angle as f64 / 90.0 * FRAC_PI_2).cos()
}

fn weighted(weights: &[f64], values: impl Iterator<Item = f64>) -> f64 {
    weights.iter().zip(values).map(|(w, x)| w * x).sum()
}

/// The reflectance of one channel at 0, 1, ..., 89 degrees.
type Curve = Vec<f64>;

fn truth(weights: &[f64], spectrum: &Spectrum) -> Curve {
    (0..90)
        .map(|angle| weighted(weights, spectrum.iter().map(|&nk| reflectance(nk, cos_deg(angle)))))
        .collect()
}

fn errors(nk: [f64; 2], truth: &Curve) -> [f64; 2] {
    let errors = truth.iter().enumerate().map(|(angle, t)| (reflectance(nk, cos_deg(angle)) - t).abs());
    errors.fold([0.0, 0.0], |[max, mean], e| [e.max(max), mean + e / 90.0])
}

/// Reduction by averaging the constants themselves.
fn by_constants(weights: &[f64], spectrum: &Spectrum) -> [f64; 2] {
    [0, 1].map(|i| weighted(weights, spectrum.iter().map(|nk| nk[i])))
}

/// The greatest reflectance of a channel at normal incidence.
const LIMIT: f64 = 0.999;

/// Reduction by matching the channel's reflectance at 0 and 82 degrees.
///
/// All constants of one reflectance at normal incidence are a family with one parameter, the tint of Gulbrandsen 2014; it
/// is searched for the reflectance at 82 degrees. Of several solutions the one that fits all angles best is taken.
fn by_reflectance(weights: &[f64], spectrum: &Spectrum) -> [f64; 2] {
    let truth = truth(weights, spectrum);
    let normal = truth[0];
    if normal > LIMIT {
        // Out of the gamut: k as it is on average, and the small eta that gives the limit, a root of
        // (eta - 1)^2 + k^2 = limit ((eta + 1)^2 + k^2).
        let k = by_constants(weights, spectrum)[1];
        let half = (1.0 + LIMIT) / (1.0 - LIMIT);
        return [(1.0 + k * k) / (half + (half * half - 1.0 - k * k).sqrt()), k];
    }
    let of_tint = |tint: f64| {
        let root = normal.sqrt();
        let (low, high) = ((1.0 - normal) / (1.0 + normal), (1.0 + root) / (1.0 - root));
        let eta = tint * low + (1.0 - tint) * high;
        let k2 = (normal * (eta + 1.0).powi(2) - (eta - 1.0).powi(2)) / (1.0 - normal);
        [eta, k2.max(0.0).sqrt()]
    };
    let miss = |tint: f64| reflectance(of_tint(tint), cos_deg(82)) - truth[82];
    let step = |i: u32| f64::from(i) / 4096.0;
    let mut solutions: Vec<[f64; 2]> = Vec::new();
    for i in 0..4096 {
        let (mut low, mut high) = (step(i), step(i + 1));
        if miss(low) * miss(high) > 0.0 {
            continue;
        }
        for _ in 0..60 {
            let middle = (low + high) / 2.0;
            if miss(low) * miss(middle) <= 0.0 {
                high = middle;
            } else {
                low = middle;
            }
        }
        solutions.push(of_tint(low));
    }
    solutions
        .into_iter()
        .min_by(|a, b| errors(*a, &truth)[1].total_cmp(&errors(*b, &truth)[1]))
        .expect("the reflectance at 82 degrees can be matched")
}

/// eta and k of the library.
fn stored(symbol: &str) -> ([f64; 3], [f64; 3]) {
    let metal = conductors::named(symbol).expect("in the table");
    (<[f32; 3]>::from(metal.eta).map(f64::from), <[f32; 3]>::from(metal.k).map(f64::from))
}

#[test]
fn the_table_is_what_the_spectra_give() {
    let weights = channel_weights();
    let mut wrong = Vec::new();
    for (symbol, source) in &METALS {
        let Some(spectrum) = spectrum(source) else { continue };
        let found = [0, 1, 2].map(|channel| by_reflectance(&weights[channel], &spectrum));
        let (eta, k) = stored(symbol);
        // Half of the last digit printed, and the rounding to f32.
        let agrees = |a: f64, b: f64| (a - b).abs() < 0.501e-4;
        if !(0..3).all(|i| agrees(eta[i], found[i][0]) && agrees(k[i], found[i][1])) {
            wrong.push(format!(
                "{symbol}: eta {:.4?}, k {:.4?}",
                found.map(|nk| nk[0]),
                found.map(|nk| nk[1])
            ));
        }
    }
    assert!(wrong.is_empty(), "the spectra give\n{}", wrong.join("\n"));
}

/// The errors stated in the documentation of the module: the greatest over angles and channels, and the mean.
#[test]
fn matching_reflectance_beats_averaging_the_constants() {
    let weights = channel_weights();
    for (symbol, source) in &METALS {
        let Some(spectrum) = spectrum(source) else { continue };
        let (stored_eta, stored_k) = stored(symbol);
        let (mut averaged, mut kept) = ([0.0_f64; 2], [0.0_f64; 2]);
        let mut beyond = 0.0_f64;
        for (channel, weights) in weights.iter().enumerate() {
            let truth = truth(weights, &spectrum);
            let add = |sum: &mut [f64; 2], [max, mean]: [f64; 2]| {
                *sum = [sum[0].max(max), sum[1] + mean / 3.0];
            };
            add(&mut averaged, errors(by_constants(weights, &spectrum), &truth));
            add(&mut kept, errors([stored_eta[channel], stored_k[channel]], &truth));
            beyond = truth.iter().fold(beyond, |max, r| max.max(r - LIMIT));
        }
        println!(
            "{symbol}: averaged {:.4} max {:.4} mean, matched {:.4} max {:.4} mean, beyond the gamut {beyond:.4}",
            averaged[0], averaged[1], kept[0], kept[1]
        );
        assert!(kept[1] <= averaged[1], "{symbol}: {kept:?} against {averaged:?}");
        // What the gamut cannot hold is lost; the rest is within half a per cent of reflectance.
        assert!(kept[0] < 0.005 + beyond, "{symbol}: greatest error {}", kept[0]);
    }
}

#[test]
fn a_perfect_mirror_is_white_and_the_white_is_d65() {
    let mut sum = [0.0; 3];
    for nm in WAVELENGTHS {
        let i = (nm - 380) as usize / 10;
        let t = f64::from(nm - 380) / 10.0 - i as f64;
        let power = if i < 40 { D65[i] + (D65[i + 1] - D65[i]) * t } else { D65[40] };
        for (total, curve) in sum.iter_mut().zip(xyz(f64::from(nm))) {
            *total += power * curve;
        }
    }
    let total: f64 = sum.iter().sum();
    // CIE 15:2004: (0.3127, 0.3290). The fits are good to a per cent of each curve.
    assert!((sum[0] / total - 0.3127).abs() < 5e-4, "x {}", sum[0] / total);
    assert!((sum[1] / total - 0.3290).abs() < 5e-4, "y {}", sum[1] / total);
}

#[test]
fn tints_keep_the_reflectance() {
    for r in [0.0_f32, 0.04, 0.3, 0.7, 0.95, 0.999, 1.0, 7.0, -1.0, f32::NAN] {
        for tint in [0.0_f32, 0.3, 0.9, 1.0, 2.0, f32::NAN] {
            let (eta, k) = conductors::from_reflectance(Rgb::gray(r), Rgb::gray(tint));
            let found = reflectance([f64::from(eta.g), f64::from(k.g)], 1.0);
            let wanted = if r.is_nan() { 0.0 } else { f64::from(r.clamp(0.0, 0.999)) };
            assert!((found - wanted).abs() < 1e-5, "reflectance {r}, tint {tint}: {found} by {eta:?}, {k:?}");
            assert!(eta.r > 0.0 && eta.r.is_finite() && k.r >= 0.0 && k.r.is_finite(), "{eta:?}, {k:?}");
        }
    }
    // More tint, darker edges before the rise at grazing.
    let edge = |tint| {
        let (eta, k) = conductors::from_reflectance(Rgb::gray(0.7), Rgb::gray(tint));
        reflectance([f64::from(eta.b), f64::from(k.b)], cos_deg(75))
    };
    assert!(edge(0.0) < edge(0.5) && edge(0.5) < edge(1.0), "{} {} {}", edge(0.0), edge(0.5), edge(1.0));
}

#[test]
fn names_are_found() {
    for name in conductors::NAMES {
        assert!(conductors::named(name).is_some(), "{name}");
        assert_eq!(conductors::named(name), conductors::named(&name.to_uppercase()), "{name} in capitals");
    }
    assert_eq!(conductors::named("gold"), conductors::named("Au"), "common and chemical name");
    assert_eq!(conductors::named("unobtainium"), None, "unknown");
}
