//! The lobes that spread light over a continuum, each with a chart in which it is nearly uniform.

use crate::random::from_angles;
use specula::bsdf::microfacet::{Beckmann, Distribution, Ggx};
use specula::bsdf::{
    Below, BsdfSample, Diffuse, FresnelModel, Glass, Glossy, Jitter, Metal, OrenNayar, Phong, PhongScale,
    RoughConductor, RoughDielectric, Schlick,
};
use specula::math::{Frame, Rgb, Vec3};
use std::f64::consts::{PI, TAU};

type V = Vec3<f32>;

/// One lobe behind the three functions of its contract.
pub(crate) struct Lobe {
    pub(crate) name: String,
    pub(crate) kind: Kind,
    pub(crate) chart: Chart,
    /// Width of the lobe in radians: rounding of directions counts relative to it.
    pub(crate) width: f32,
}

/// Which lobe.
#[derive(Clone, Copy)]
pub(crate) enum Kind {
    Diffuse(Diffuse<f32>),
    OrenNayar(OrenNayar<f32>),
    Rough(RoughConductor<f32>),
    /// The reflection of a rough interface, or its transmission.
    Interface(RoughDielectric<f32>, Side),
    Glossy(Glossy<f32>),
    Phong(Phong<f32>),
    Jitter(Jitter<f32>),
    Schlick(Schlick<f32>),
}

/// Where light comes from, seen from the viewer's side.
#[derive(Clone, Copy, PartialEq)]
pub(crate) enum Side {
    Above,
    Below,
}

impl Lobe {
    pub(crate) fn sample(&self, wo: V, u2: [f32; 2]) -> BsdfSample<f32> {
        match &self.kind {
            Kind::Diffuse(lobe) => lobe.sample(wo, u2),
            Kind::OrenNayar(lobe) => lobe.sample(wo, u2),
            Kind::Rough(lobe) => lobe.sample(wo, u2),
            Kind::Interface(lobe, side) => lobe.sample(wo, u2)[usize::from(*side == Side::Below)],
            Kind::Glossy(lobe) => lobe.sample(wo, u2),
            Kind::Phong(lobe) => lobe.sample(wo, u2),
            Kind::Jitter(lobe) => lobe.sample(wo, u2),
            Kind::Schlick(lobe) => lobe.sample(wo, u2),
        }
    }

    pub(crate) fn pdf(&self, wo: V, wi: V) -> f32 {
        match &self.kind {
            Kind::Diffuse(lobe) => lobe.pdf(wo, wi),
            Kind::OrenNayar(lobe) => lobe.pdf(wo, wi),
            Kind::Rough(lobe) => lobe.pdf(wo, wi),
            Kind::Interface(lobe, side) => self.on_side(*side, wi, lobe.pdf(wo, wi)),
            Kind::Glossy(lobe) => lobe.pdf(wo, wi),
            Kind::Phong(lobe) => lobe.pdf(wo, wi),
            Kind::Jitter(lobe) => lobe.pdf(wo, wi),
            Kind::Schlick(lobe) => lobe.pdf(wo, wi),
        }
    }

    pub(crate) fn eval(&self, wo: V, wi: V) -> Rgb<f32> {
        match &self.kind {
            Kind::Diffuse(lobe) => lobe.eval(wo, wi),
            Kind::OrenNayar(lobe) => lobe.eval(wo, wi),
            Kind::Rough(lobe) => lobe.eval(wo, wi),
            Kind::Interface(lobe, side) => Rgb::gray(self.on_side(*side, wi, lobe.eval(wo, wi).r)),
            Kind::Glossy(lobe) => lobe.eval(wo, wi),
            Kind::Phong(lobe) => lobe.eval(wo, wi),
            Kind::Jitter(lobe) => lobe.eval(wo, wi),
            Kind::Schlick(lobe) => lobe.eval(wo, wi),
        }
    }

    #[expect(clippy::unused_self, reason = "reads as a method")]
    fn on_side(&self, side: Side, wi: V, value: f32) -> f32 {
        if (wi.z < 0.0) == (side == Side::Below) { value } else { 0.0 }
    }

    /// Whether light may be lost below the surface, so that the density has less than one to share out.
    pub(crate) fn loses(&self) -> bool {
        match &self.kind {
            Kind::Diffuse(_) | Kind::OrenNayar(_) => false,
            Kind::Glossy(lobe) => lobe.below == Below::Discard,
            _ => true,
        }
    }

    /// Whether light and view may be exchanged.
    pub(crate) fn is_reciprocal(&self) -> bool {
        !matches!(self.kind, Kind::Glossy(_) | Kind::Jitter(_) | Kind::Interface(_, Side::Below))
    }

    /// Whether the density is the area that the warp stretches a square to: not where directions are drawn again.
    pub(crate) fn is_warp(&self) -> bool {
        !matches!(&self.kind, Kind::Glossy(lobe) if lobe.below == Below::Rejection)
    }

    /// How many directions of the raw lobe become `wi`.
    pub(crate) fn folds(&self, wo: V, wi: V) -> f32 {
        match &self.kind {
            Kind::Glossy(lobe) if lobe.below == Below::ThroughR => {
                let r = Vec3::new(-wo.x, -wo.y, wo.z);
                if 2.0 * r.dot(wi) * wo.z < wi.z { 2.0 } else { 1.0 }
            }
            _ => 1.0,
        }
    }

    /// The greatest weight that a sample may have.
    pub(crate) fn greatest_weight(&self) -> f32 {
        match &self.kind {
            // Light thrown back at grazing: the value grows as the inverse of the cosine, over a shrinking solid angle.
            Kind::OrenNayar(_) => f32::INFINITY,
            Kind::Phong(lobe) => (lobe.exponent + 2.0) / (lobe.exponent + 1.0),
            Kind::Interface(..) => self.radiance_scale(),
            _ => 1.0,
        }
    }

    /// By how much radiance grows.
    pub(crate) fn radiance_scale(&self) -> f32 {
        match &self.kind {
            Kind::Interface(lobe, Side::Below) => lobe.glass.eta().powi(-2),
            _ => 1.0,
        }
    }

    /// Cosines of both directions with the facet between them, where it refracts.
    pub(crate) fn refracting(&self, wo: V, wi: V) -> Option<[f32; 2]> {
        let Kind::Interface(lobe, Side::Below) = &self.kind else { return None };
        let h = (wo + wi * lobe.glass.eta()).normalize();
        Some([wo.dot(h).abs(), wi.dot(h).abs()])
    }

    /// Points along each side of a cell of the chart that integrals need: more where total reflection cuts the density off.
    pub(crate) fn points(&self) -> u16 {
        if matches!(self.kind, Kind::Interface(_, Side::Below)) { 60 } else { 20 }
    }

    /// What the half vector of a direction is divided by: it is rounded that much more.
    pub(crate) fn reach(&self, wo: V, wi: V) -> f32 {
        match &self.kind {
            Kind::Interface(lobe, Side::Below) => (wo + wi * lobe.glass.eta()).length(),
            Kind::Rough(_) | Kind::Interface(..) | Kind::Jitter(_) | Kind::Schlick(_) => (wo + wi).length(),
            _ => 1.0,
        }
    }
}

/// Roughness along both tangents.
const ROUGHNESS: [[f32; 2]; 6] = [[1e-3, 1e-3], [0.01, 0.01], [0.1, 0.1], [0.3, 0.3], [1.0, 1.0], [0.1, 0.4]];

/// All of them. Metals reflect nearly everything, so that the energy of the geometry alone is judged.
pub(crate) fn lobes() -> Vec<Lobe> {
    let mut lobes = matt();
    lobes.extend(metals());
    lobes.extend(interfaces());
    lobes.extend(phong());
    lobes
}

fn matt() -> Vec<Lobe> {
    let reflectance = Rgb::new(1.0, 0.8, 0.0);
    let chart = Chart::Power { mirrored: false, exponent: 1.0 };
    let mut lobes = vec![Lobe {
        name: "diffuse".into(),
        kind: Kind::Diffuse(Diffuse { reflectance }),
        chart,
        width: 1.0,
    }];
    // Fine towards grazing, where light is thrown back most.
    let chart = Chart::Power { mirrored: false, exponent: 0.0 };
    for roughness in [0.0_f32, 0.3, 1.0] {
        let kind = Kind::OrenNayar(OrenNayar { reflectance, roughness });
        lobes.push(Lobe { name: format!("Oren-Nayar {roughness}"), kind, chart, width: 1.0 });
    }
    lobes
}

fn distributions([alpha_x, alpha_y]: [f32; 2]) -> [(&'static str, Distribution<f32>); 2] {
    [
        ("GGX", Distribution::Ggx(Ggx { alpha_x, alpha_y })),
        ("Beckmann", Distribution::Beckmann(Beckmann { alpha_x, alpha_y })),
    ]
}

fn metals() -> Vec<Lobe> {
    let (eta, k) = (Rgb::new(0.2, 0.1, 1.0), Rgb::new(1e4, 1e5, 5.0));
    let metal = Metal::new(FresnelModel::Exact, eta, k);
    let mut lobes = Vec::new();
    for [ax, ay] in ROUGHNESS {
        let chart = Chart::Half { alpha: f64::from(ax * ay).sqrt() };
        for (name, facets) in distributions([ax, ay]) {
            let kind = Kind::Rough(RoughConductor { metal, facets });
            lobes.push(Lobe { name: format!("{name} conductor {ax} {ay}"), kind, chart, width: ax });
        }
    }
    for (roughness, isotropy) in [(0.01_f32, 1.0_f32), (0.5, 1.0), (0.3, 0.5)] {
        let surface = Schlick::new(Rgb::new(1.0, 0.5, 0.1), roughness, isotropy);
        let chart = Chart::Half { alpha: f64::from(roughness).sqrt() };
        let name = format!("Schlick {roughness} {isotropy}");
        lobes.push(Lobe { name, kind: Kind::Schlick(surface), chart, width: roughness.sqrt() });
    }
    lobes
}

fn interfaces() -> Vec<Lobe> {
    let mut lobes = Vec::new();
    for [ax, ay] in [[0.01_f32, 0.01], [0.1, 0.1], [0.5, 0.5], [0.1, 0.4]] {
        let alpha = f64::from(ax * ay).sqrt();
        for (eta, (name, facets)) in
            [1.5_f32, 1.0 / 1.5, 1.02].into_iter().flat_map(|eta| distributions([ax, ay]).map(|d| (eta, d)))
        {
            let lobe = RoughDielectric { glass: Glass::exact(eta), facets };
            let sides = [
                ("reflection", Side::Above, Chart::Half { alpha }),
                ("transmission", Side::Below, Chart::Through { alpha, eta: f64::from(eta) }),
            ];
            for (what, side, chart) in sides {
                let name = format!("{name} {what} {ax} {ay} into {eta}");
                lobes.push(Lobe { name, kind: Kind::Interface(lobe, side), chart, width: ax });
            }
        }
    }
    lobes
}

fn phong() -> Vec<Lobe> {
    let reflectance = Rgb::new(1.0, 0.8, 0.0);
    let mut lobes = Vec::new();
    for exponent in [0.0_f32, 1.0, 20.0, 1e3, 1e6, 1e9] {
        let chart = Chart::Power { mirrored: true, exponent: f64::from(exponent) };
        let width = (exponent + 1.0).sqrt().recip();
        let mut push = |name: &str, kind| {
            lobes.push(Lobe { name: format!("{name} {exponent:e}"), kind, chart, width });
        };
        push("glossy", Kind::Glossy(Glossy::new(reflectance, exponent)));
        for (name, below) in [("discarding", Below::Discard), ("rejecting", Below::Rejection)] {
            push(name, Kind::Glossy(Glossy { reflectance, exponent, below }));
        }
        for (name, scale) in [("modified Phong", PhongScale::Modified), ("max cosine", PhongScale::MaxCosine)]
        {
            push(name, Kind::Phong(Phong { reflectance, exponent, scale }));
        }
        let chart = Chart::Half { alpha: (2.0 / (f64::from(exponent) + 2.0)).sqrt() };
        let kind = Kind::Jitter(Jitter { reflectance, exponent });
        // Normals are half as wide as what they mirror.
        lobes.push(Lobe { name: format!("jitter {exponent:e}"), kind, chart, width: width * 0.5 });
    }
    lobes
}

/// The angles from the normal at which lobes are judged, in degrees.
pub(crate) const ANGLES: [f32; 5] = [0.0, 30.0, 60.0, 80.0, 89.0];

/// Directions towards the viewer at those angles.
pub(crate) fn viewers() -> [V; 5] {
    ANGLES.map(|angle| from_angles(angle.to_radians(), 0.7))
}

/// A map from the unit square to the directions that a lobe favours.
#[derive(Clone, Copy)]
pub(crate) enum Chart {
    /// Uniform in the integral of cos^e about the normal or the mirror direction.
    Power { mirrored: bool, exponent: f64 },
    /// Of half vectors, uniform but for the root in the integral of D cos for isotropic GGX.
    Half { alpha: f64 },
    /// The same, of the facets that refract.
    Through { alpha: f64, eta: f64 },
}

impl Chart {
    /// A direction and the solid angle about it per area of the square.
    #[expect(clippy::cast_possible_truncation, reason = "directions are in single precision")]
    pub(crate) fn place(self, wo: V, [q, turn]: [f64; 2]) -> Option<(V, f64)> {
        let (sin_phi, cos_phi) = (turn * TAU).sin_cos();
        match self {
            Self::Power { mirrored, exponent } => {
                let ln_cos = (-q).ln_1p() / (exponent + 1.0);
                let sin = (-(2.0 * ln_cos).exp_m1()).sqrt();
                let local = [sin * cos_phi, sin * sin_phi, ln_cos.exp()].map(|x| x as f32);
                let w = axis(wo, mirrored).to_world(Vec3::new(local[0], local[1], local[2]));
                Some((w, TAU / ((exponent + 1.0) * (exponent * ln_cos).exp())))
            }
            Self::Half { alpha } => {
                let (h, per_area) = facet(alpha, q, [sin_phi, cos_phi]);
                let cos = wo.dot(h);
                (cos > 0.0).then(|| (h * (cos * 2.0) - wo, per_area * 4.0 * f64::from(cos)))
            }
            Self::Through { alpha, eta } => {
                let (h, per_area) = facet(alpha, q, [sin_phi, cos_phi]);
                let c = f64::from(wo.dot(h));
                let g2 = (eta - 1.0) * (eta + 1.0) + c * c;
                if c <= 0.0 || g2 <= 0.0 {
                    return None;
                }
                let (g, inverse) = (g2.sqrt(), 1.0 / eta);
                let wi = (h * ((c - g) * inverse) as f32 - wo * inverse as f32).normalize();
                let denominator = (eta - 1.0) * (eta + 1.0) / (c + g);
                Some((wi, per_area * denominator * denominator / (eta * g)))
            }
        }
    }

    /// The point of the square that stands for a direction.
    #[expect(clippy::cast_possible_truncation, reason = "directions are in single precision")]
    pub(crate) fn find(self, wo: V, wi: V) -> [f64; 2] {
        let turns = |v: V| (f64::from(v.y).atan2(f64::from(v.x)) / TAU).rem_euclid(1.0);
        match self {
            Self::Power { mirrored, exponent } => {
                let local = axis(wo, mirrored).to_local(wi);
                let sin2 = (f64::from(local.x).powi(2) + f64::from(local.y).powi(2)).min(1.0);
                let q =
                    if local.z > 0.0 { -(0.5 * (-sin2).ln_1p() * (exponent + 1.0)).exp_m1() } else { 1.0 };
                [q, turns(local)]
            }
            Self::Half { .. } | Self::Through { .. } => {
                let (alpha, h) = match self {
                    Self::Through { alpha, eta } => (alpha, wo + wi * eta as f32),
                    Self::Half { alpha } => (alpha, wo + wi),
                    Self::Power { .. } => unreachable!("matched above"),
                };
                let h = if h.z < 0.0 { -h } else { h };
                let tan2 = f64::from(h.x).hypot(f64::from(h.y)).powi(2) / f64::from(h.z).powi(2);
                [1.0 - (alpha * alpha / (alpha * alpha + tan2)).sqrt(), turns(h)]
            }
        }
    }
}

/// A normal, and the solid angle of normals about it per area of the square.
#[expect(clippy::cast_possible_truncation, reason = "directions are in single precision")]
fn facet(alpha: f64, q: f64, [sin_phi, cos_phi]: [f64; 2]) -> (V, f64) {
    // 1 - q = (1 - t)^2 takes away the pole of the solid angle at the horizon.
    let (t, q) = (q, q * (2.0 - q));
    let tan2 = alpha * alpha * q / (1.0 - q);
    let cos = 1.0 / (1.0 + tan2).sqrt();
    let sin = (tan2.sqrt() * cos) as f32;
    let h = Vec3::new(sin * cos_phi as f32, sin * sin_phi as f32, cos as f32);
    let d = alpha * alpha / (PI * cos.powi(4) * (alpha * alpha + tan2).powi(2));
    (h, 2.0 * (1.0 - t) / (d * cos))
}

fn axis(wo: V, mirrored: bool) -> Frame<f32> {
    Frame::about(if mirrored { Vec3::new(-wo.x, -wo.y, wo.z) } else { Vec3::new(0.0, 0.0, 1.0) })
}
