//! All surfaces in one list, and their parts that spread light over a continuum, each with a chart in which it is nearly uniform.

use crate::one_of_each;
use crate::random::from_angles;
use specula::bsdf::microfacet::{Beckmann, Distribution, Ggx};
use specula::bsdf::{
    Below, Bsdf, BsdfSample, Coat, Conductor, Dielectric, Diffuse, FresnelModel, Glass, Glossy, Jitter,
    Lobes, Metal, Mirror, OrenNayar, Over, Phong, PhongScale, RoughConductor, RoughDielectric, Schlick,
    ThinDielectric,
};
use specula::math::{Frame, Rgb, Vec3};
use specula::sampling::warp;
use std::f64::consts::{PI, TAU};

type V = Vec3<f32>;

/// A part of a surface behind the three functions of its contract.
pub(crate) struct Lobe {
    pub(crate) name: String,
    pub(crate) bsdf: Bsdf<f32>,
    pub(crate) part: Part,
    pub(crate) chart: Chart,
    /// Width of the lobe in radians: rounding of directions counts relative to it.
    pub(crate) width: f32,
}

/// Which part of a surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Part {
    /// What is matt, drawn from by the cosine.
    Matt,
    /// The glossy reflection.
    Above,
    /// The glossy transmission.
    Below,
}

/// Cells along each side of a chart.
pub(crate) const CELLS: u16 = 16;

impl Lobe {
    pub(crate) fn sample(&self, wo: V, u2: [f32; 2]) -> BsdfSample<f32> {
        let glossy = |k: usize| self.bsdf.sample_glossy(wo, u2)[k].expect("there is such a lobe");
        match self.part {
            Part::Matt => {
                let wi = warp::cosine_hemisphere(u2);
                let weight = self.bsdf.eval_diffuse(wo, wi).scale(std::f32::consts::PI);
                let pdf = warp::cosine_hemisphere_pdf(wi.z);
                BsdfSample { wi, weight, pdf, valid: wi.z > 0.0 }
            }
            Part::Above => glossy(0),
            Part::Below => glossy(1),
        }
    }

    pub(crate) fn pdf(&self, wo: V, wi: V) -> f32 {
        match self.part {
            Part::Matt => warp::cosine_hemisphere_pdf(wi.z),
            Part::Above | Part::Below => self.on_side(wi, self.bsdf.pdf_glossy(wo, wi)),
        }
    }

    pub(crate) fn eval(&self, wo: V, wi: V) -> Rgb<f32> {
        match self.part {
            Part::Matt => self.bsdf.eval_diffuse(wo, wi),
            Part::Above | Part::Below => self.bsdf.eval_glossy(wo, wi).scale(self.on_side(wi, 1.0)),
        }
    }

    /// Nothing on the side of a twin.
    fn on_side(&self, wi: V, value: f32) -> f32 {
        let has_twin = self.bsdf.lobes().intersects(Lobes::THROUGH);
        if !has_twin || (wi.z < 0.0) == (self.part == Part::Below) { value } else { 0.0 }
    }

    /// The integral of `f` over the directions of each cell.
    pub(crate) fn integrals(&self, wo: V, f: impl Fn(V) -> f32) -> Vec<f64> {
        let points = self.points();
        let n = CELLS * points;
        let mut cells = vec![0.0; usize::from(CELLS * CELLS)];
        for (i, j) in (0..n).flat_map(|i| (0..n).map(move |j| (i, j))) {
            let at = [i, j].map(|k| (f64::from(k) + 0.5) / f64::from(n));
            if let Some((wi, solid_angle)) = self.chart.place(wo, at) {
                let cell = usize::from(i / points * CELLS + j / points);
                cells[cell] += f64::from(f(wi)) * solid_angle / f64::from(n).powi(2);
            }
        }
        cells
    }

    /// The part of the light, of its red, that is returned, what radiance grows by on entering left out.
    pub(crate) fn albedo(&self, wo: V) -> f64 {
        let sum: f64 = self.integrals(wo, |wi| self.eval(wo, wi).r * wi.z.abs()).iter().sum();
        sum / f64::from(self.radiance_scale())
    }

    /// What of red light is returned for certain, where that is known.
    pub(crate) fn returns(&self) -> Option<f32> {
        match (&self.bsdf, self.part) {
            (Bsdf::Diffuse(lobe), _) => Some(lobe.reflectance.r),
            (Bsdf::OrenNayar(lobe), _) if lobe.reflectance.r.to_bits() == 1.0_f32.to_bits() => Some(1.0),
            (Bsdf::Glossy(Over { base, .. }), Part::Matt)
            | (Bsdf::Phong(Over { base, .. }), Part::Matt)
            | (Bsdf::Jitter(Over { base, .. }), Part::Matt) => Some(base.reflectance.r),
            (Bsdf::Glossy(over), Part::Above) if !self.loses() => Some(over.lobe.reflectance.r),
            _ => None,
        }
    }

    /// Whether light may be lost below the surface, so that the density has less than one to share out.
    pub(crate) fn loses(&self) -> bool {
        match (&self.bsdf, self.part) {
            (_, Part::Matt) => false,
            (Bsdf::Glossy(over), _) => over.lobe.below == Below::Discard,
            _ => true,
        }
    }

    /// Whether light and view may be exchanged. Between two media they may but for the square of the index: a law of its own.
    pub(crate) fn is_reciprocal(&self) -> bool {
        let is_glossy = matches!(self.bsdf, Bsdf::Glossy(_) | Bsdf::Jitter(_));
        self.part == Part::Matt || self.part == Part::Above && !is_glossy
    }

    /// Whether the density is the area that the warp stretches a square to: not where directions are drawn again.
    pub(crate) fn is_warp(&self) -> bool {
        self.below() != Some(Below::Rejection)
    }

    /// What becomes of directions below the surface, where that is asked.
    fn below(&self) -> Option<Below> {
        match &self.bsdf {
            Bsdf::Glossy(over) if self.part == Part::Above => Some(over.lobe.below),
            _ => None,
        }
    }

    /// How many directions of the raw lobe become `wi`.
    pub(crate) fn folds(&self, wo: V, wi: V) -> f32 {
        let r = Vec3::new(-wo.x, -wo.y, wo.z);
        let folded = self.below() == Some(Below::ThroughR) && 2.0 * r.dot(wi) * wo.z < wi.z;
        if folded { 2.0 } else { 1.0 }
    }

    /// The greatest weight that a sample may have.
    pub(crate) fn greatest_weight(&self) -> f32 {
        match (&self.bsdf, self.part) {
            // Light thrown back at grazing: the value grows as the inverse of the cosine, over a shrinking solid angle.
            (Bsdf::OrenNayar(_), _) => f32::INFINITY,
            // Straight on more than the mean, which is one.
            (Bsdf::Glazed(_), Part::Matt) => 1.05,
            (Bsdf::Phong(over), Part::Above) => (over.lobe.exponent + 2.0) / (over.lobe.exponent + 1.0),
            _ => self.radiance_scale(),
        }
    }

    /// By how much radiance grows.
    pub(crate) fn radiance_scale(&self) -> f32 {
        self.eta().map_or(1.0, |eta| eta.powi(-2))
    }

    /// The index ratio, where light passes.
    pub(crate) fn eta(&self) -> Option<f32> {
        match &self.bsdf {
            Bsdf::RoughDielectric(lobe) if self.part == Part::Below => Some(lobe.glass.eta()),
            _ => None,
        }
    }

    /// Cosines of both directions with the facet between them, where it refracts.
    pub(crate) fn refracting(&self, wo: V, wi: V) -> Option<[f32; 2]> {
        let h = (wo + wi * self.eta()?).normalize();
        Some([wo.dot(h).abs(), wi.dot(h).abs()])
    }

    /// Points along each side of a cell of the chart that integrals need: more where total reflection cuts the density off.
    fn points(&self) -> u16 {
        if self.part == Part::Below { 60 } else { 20 }
    }

    /// What the half vector of a direction is divided by: it is rounded that much more.
    pub(crate) fn reach(&self, wo: V, wi: V) -> f32 {
        let by_facets = !matches!(self.bsdf, Bsdf::Glossy(_) | Bsdf::Phong(_));
        match self.part {
            Part::Below => (wo + wi * self.eta().unwrap_or(1.0)).length(),
            Part::Above if by_facets => (wo + wi).length(),
            Part::Above | Part::Matt => 1.0,
        }
    }
}

/// Roughness along both tangents.
const ROUGHNESS: [[f32; 2]; 6] = [[1e-3, 1e-3], [0.01, 0.01], [0.1, 0.1], [0.3, 0.3], [1.0, 1.0], [0.1, 0.4]];

/// All parts of all surfaces.
pub(crate) fn lobes() -> Vec<Lobe> {
    surfaces().iter().flat_map(|(name, bsdf)| parts(name, *bsdf)).collect()
}

/// The parts of a surface that spread light; what is black is no part.
pub(crate) fn parts(name: &str, bsdf: Bsdf<f32>) -> Vec<Lobe> {
    let up = Vec3::new(0.0, 0.0, 1.0);
    let has = |lobes: Lobes| bsdf.lobes().intersects(lobes);
    let all = [
        (Part::Matt, "base", has(Lobes::DIFFUSE) && !bsdf.eval_diffuse(up, up).is_black()),
        (Part::Above, "reflection", has(Lobes::GLOSSY)),
        (Part::Below, "transmission", has(Lobes::THROUGH)),
    ];
    let of = |(part, what, is_there): (Part, &str, bool)| {
        let (chart, width) = chart(&bsdf, part);
        is_there.then(|| Lobe { name: format!("{name}, {what}"), bsdf, part, chart, width })
    };
    all.into_iter().filter_map(of).collect()
}

/// Where a part is nearly uniform, and how wide it is.
fn chart(bsdf: &Bsdf<f32>, part: Part) -> (Chart, f32) {
    let about_r = |exponent: f32| {
        (Chart::Power { mirrored: true, exponent: exponent.into() }, (exponent + 1.0).sqrt().recip())
    };
    match (bsdf, part) {
        // Fine towards grazing, where light is thrown back most.
        (Bsdf::OrenNayar(_), _) => (Chart::Power { mirrored: false, exponent: 0.0 }, 1.0),
        (_, Part::Matt) => (Chart::Power { mirrored: false, exponent: 1.0 }, 1.0),
        (Bsdf::RoughConductor(lobe), _) => by_facets(&lobe.facets),
        (Bsdf::RoughDielectric(lobe), Part::Above) => by_facets(&lobe.facets),
        (Bsdf::RoughDielectric(lobe), Part::Below) => {
            let (Chart::Half { alpha }, width) = by_facets(&lobe.facets) else {
                unreachable!("facets have half vectors")
            };
            (Chart::Through { alpha, eta: lobe.glass.eta().into() }, width)
        }
        (Bsdf::Glossy(over), _) => about_r(over.lobe.exponent),
        (Bsdf::Phong(over), _) => about_r(over.lobe.exponent),
        (Bsdf::Jitter(over), _) => {
            let exponent = over.lobe.exponent;
            let alpha = (2.0 / (f64::from(exponent) + 2.0)).sqrt();
            // Normals are half as wide as what they mirror.
            (Chart::Half { alpha }, (exponent + 1.0).sqrt().recip() * 0.5)
        }
        _ => {
            // Straight on the density is that of the normals over 4: 1 / (4 pi alpha^2).
            let up = Vec3::new(0.0, 0.0, 1.0);
            let alpha = (4.0 * std::f32::consts::PI * bsdf.pdf_glossy(up, up)).sqrt().recip();
            (Chart::Half { alpha: alpha.into() }, alpha)
        }
    }
}

fn by_facets(facets: &Distribution<f32>) -> (Chart, f32) {
    let (Distribution::Ggx(Ggx { alpha_x, alpha_y }) | Distribution::Beckmann(Beckmann { alpha_x, alpha_y })) =
        *facets;
    (Chart::Half { alpha: f64::from(alpha_x * alpha_y).sqrt() }, alpha_x.min(alpha_y))
}

/// The list: one of each kind, then all kinds with what they may be told. Metals reflect nearly everything, so that the energy of
/// the geometry alone is judged.
pub(crate) fn surfaces() -> Vec<(String, Bsdf<f32>)> {
    let mut all: Vec<_> =
        one_of_each::lobes().into_iter().map(|(name, bsdf)| (format!("one: {name}"), bsdf)).collect();
    for more in [matt(), sharp(), metals(), interfaces(), phong()] {
        all.extend(more);
    }
    all
}

fn matt() -> Vec<(String, Bsdf<f32>)> {
    let reflectance = Rgb::new(1.0, 0.8, 0.0);
    let mut all = vec![("diffuse".into(), Bsdf::Diffuse(Diffuse { reflectance }))];
    for roughness in [0.0_f32, 0.3, 1.0] {
        let clay = OrenNayar { reflectance, roughness };
        all.push((format!("Oren-Nayar {roughness}"), Bsdf::OrenNayar(clay)));
    }
    all
}

/// What has branches, by every model of reflectance.
fn sharp() -> Vec<(String, Bsdf<f32>)> {
    let white = Rgb::WHITE;
    let (eta, k) = (Rgb::new(0.143, 0.375, 1.442), Rgb::new(3.983, 2.386, 1.603));
    let mut all = vec![("mirror".into(), Bsdf::Mirror(Mirror { reflectance: Rgb::new(1.0, 0.8, 0.0) }))];
    let models = [FresnelModel::Exact, FresnelModel::Schlick, FresnelModel::F82, FresnelModel::Constant];
    for model in models {
        all.push((
            format!("gold, {model:?}"),
            Bsdf::Conductor(Conductor { metal: Metal::new(model, eta, k) }),
        ));
        for index in [1.0_f32 / 1.5, 1.02, 1.5, 2.4] {
            let glass = Glass::new(model, index);
            all.push((format!("glass {index}, {model:?}"), Bsdf::Dielectric(Dielectric { glass })));
            if index > 1.0 {
                let pane = ThinDielectric { glass, transmittance: white };
                all.push((format!("pane {index}, {model:?}"), Bsdf::ThinDielectric(pane)));
                let glazed = Coat::new(model, index).over(white);
                all.push((format!("glazed {index}, {model:?}"), Bsdf::Glazed(glazed)));
            }
        }
    }
    all
}

fn distributions([alpha_x, alpha_y]: [f32; 2]) -> [(&'static str, Distribution<f32>); 2] {
    [
        ("GGX", Distribution::Ggx(Ggx { alpha_x, alpha_y })),
        ("Beckmann", Distribution::Beckmann(Beckmann { alpha_x, alpha_y })),
    ]
}

fn metals() -> Vec<(String, Bsdf<f32>)> {
    let (eta, k) = (Rgb::new(0.2, 0.1, 1.0), Rgb::new(1e4, 1e5, 5.0));
    let metal = Metal::new(FresnelModel::Exact, eta, k);
    let mut all = Vec::new();
    for [ax, ay] in ROUGHNESS {
        for (name, facets) in distributions([ax, ay]) {
            let rough = RoughConductor { metal, facets };
            all.push((format!("{name} conductor {ax} {ay}"), Bsdf::RoughConductor(rough)));
        }
    }
    for (roughness, isotropy) in [(0.01_f32, 1.0_f32), (0.5, 1.0), (0.3, 0.5), (0.8, 0.5)] {
        let surface = Schlick::new(Rgb::new(1.0, 0.5, 0.1), roughness, isotropy);
        all.push((format!("Schlick {roughness} {isotropy}"), Bsdf::Schlick(surface)));
    }
    all
}

fn interfaces() -> Vec<(String, Bsdf<f32>)> {
    let mut all = Vec::new();
    for [ax, ay] in [[0.01_f32, 0.01], [0.1, 0.1], [0.5, 0.5], [0.1, 0.4]] {
        for (eta, (name, facets)) in
            [1.5_f32, 1.0 / 1.5, 1.02].into_iter().flat_map(|eta| distributions([ax, ay]).map(|d| (eta, d)))
        {
            let frost = RoughDielectric { glass: Glass::exact(eta), facets };
            all.push((format!("{name} {ax} {ay} into {eta}"), Bsdf::RoughDielectric(frost)));
        }
    }
    all
}

fn phong() -> Vec<(String, Bsdf<f32>)> {
    let reflectance = Rgb::new(1.0, 0.8, 0.0);
    let base = Diffuse { reflectance: Rgb::BLACK };
    let mut all = Vec::new();
    for exponent in [0.0_f32, 1.0, 20.0, 1e3, 1e6, 1e9] {
        let mut push = |name: &str, bsdf| all.push((format!("{name} {exponent:e}"), bsdf));
        for (name, below) in
            [("glossy", Below::ThroughR), ("discarding", Below::Discard), ("rejecting", Below::Rejection)]
        {
            push(name, Bsdf::Glossy(Over { lobe: Glossy { reflectance, exponent, below }, base }));
        }
        for (name, scale) in [("modified Phong", PhongScale::Modified), ("max cosine", PhongScale::MaxCosine)]
        {
            push(name, Bsdf::Phong(Over { lobe: Phong { reflectance, exponent, scale }, base }));
        }
        push("jitter", Bsdf::Jitter(Over { lobe: Jitter { reflectance, exponent }, base }));
    }
    all
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
