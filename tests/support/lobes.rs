//! The lobes that spread light over a continuum, each with a chart in which it is nearly uniform.

use crate::random::from_angles;
use specula::bsdf::microfacet::Ggx;
use specula::bsdf::{BsdfSample, Diffuse, Glossy, RoughConductor};
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
    Rough(RoughConductor<f32>),
    Glossy(Glossy<f32>),
}

impl Lobe {
    pub(crate) fn sample(&self, wo: V, u2: [f32; 2]) -> BsdfSample<f32> {
        match &self.kind {
            Kind::Diffuse(lobe) => lobe.sample(wo, u2),
            Kind::Rough(lobe) => lobe.sample(wo, u2),
            Kind::Glossy(lobe) => lobe.sample(wo, u2),
        }
    }

    pub(crate) fn pdf(&self, wo: V, wi: V) -> f32 {
        match &self.kind {
            Kind::Diffuse(lobe) => lobe.pdf(wo, wi),
            Kind::Rough(lobe) => lobe.pdf(wo, wi),
            Kind::Glossy(lobe) => lobe.pdf(wo, wi),
        }
    }

    pub(crate) fn eval(&self, wo: V, wi: V) -> Rgb<f32> {
        match &self.kind {
            Kind::Diffuse(lobe) => lobe.eval(wo, wi),
            Kind::Rough(lobe) => lobe.eval(wo, wi),
            Kind::Glossy(lobe) => lobe.eval(wo, wi),
        }
    }

    /// Whether light may be lost below the surface, so that the density has less than one to share out.
    pub(crate) fn loses(&self) -> bool {
        matches!(self.kind, Kind::Rough(_))
    }
}

/// All of them. Metals reflect nearly everything, so that the energy of the geometry alone is judged.
pub(crate) fn lobes() -> Vec<Lobe> {
    let reflectance = Rgb::new(1.0, 0.8, 0.0);
    let mut lobes = vec![Lobe {
        name: "diffuse".into(),
        kind: Kind::Diffuse(Diffuse { reflectance }),
        chart: Chart::Power { mirrored: false, exponent: 1.0 },
        width: 1.0,
    }];
    for [ax, ay] in [[1e-3_f32, 1e-3], [0.01, 0.01], [0.1, 0.1], [0.3, 0.3], [1.0, 1.0], [0.1, 0.4]] {
        let ggx = Ggx { alpha_x: ax, alpha_y: ay };
        let metal = RoughConductor { eta: Rgb::new(0.2, 0.1, 1.0), k: Rgb::new(1e4, 1e5, 5.0), ggx };
        lobes.push(Lobe {
            name: format!("rough conductor {ax} {ay}"),
            kind: Kind::Rough(metal),
            chart: Chart::Half { alpha: f64::from(ax * ay).sqrt() },
            width: ax,
        });
    }
    for exponent in [0.0_f32, 1.0, 20.0, 1e3, 1e6, 1e9] {
        lobes.push(Lobe {
            name: format!("glossy {exponent:e}"),
            kind: Kind::Glossy(Glossy { reflectance, exponent }),
            chart: Chart::Power { mirrored: true, exponent: f64::from(exponent) },
            width: (exponent + 1.0).sqrt().recip(),
        });
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
                // 1 - q = (1 - t)^2 takes away the pole of the solid angle at the horizon.
                let (t, q) = (q, q * (2.0 - q));
                let tan2 = alpha * alpha * q / (1.0 - q);
                let cos = 1.0 / (1.0 + tan2).sqrt();
                let sin = (tan2.sqrt() * cos) as f32;
                let h = Vec3::new(sin * cos_phi as f32, sin * sin_phi as f32, cos as f32);
                let cos_d = wo.dot(h);
                let d = alpha * alpha / (PI * cos.powi(4) * (alpha * alpha + tan2).powi(2));
                let per_area = 2.0 * (1.0 - t) * 4.0 * f64::from(cos_d) / (d * cos);
                (cos_d > 0.0).then(|| (h * (cos_d * 2.0) - wo, per_area))
            }
        }
    }

    /// The point of the square that stands for a direction.
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
            Self::Half { alpha } => {
                let h = wo + wi;
                let tan2 = f64::from(h.x).hypot(f64::from(h.y)).powi(2) / f64::from(h.z).powi(2);
                [1.0 - (alpha * alpha / (alpha * alpha + tan2)).sqrt(), turns(h)]
            }
        }
    }
}

fn axis(wo: V, mirrored: bool) -> Frame<f32> {
    Frame::about(if mirrored { Vec3::new(-wo.x, -wo.y, wo.z) } else { Vec3::new(0.0, 0.0, 1.0) })
}
