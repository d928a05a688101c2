//! A lobe of every kind, and mixes of them.

#![allow(dead_code, unused_imports, unused_macros, reason = "each program uses a part")]

use specula::bsdf::microfacet::{Beckmann, Distribution, Ggx};
use specula::bsdf::{
    Below, Bsdf, Coat, Conductor, Dielectric, Diffuse, FresnelModel, Glass, Glossy, Jitter, MOST_PARTS,
    Metal, Mirror, Mix, OrenNayar, Over, Part, Phong, PhongScale, RoughConductor, RoughDielectric, Schlick,
    ThinDielectric,
};
use specula::math::Rgb;

/// Runs an expression for the lobe within.
macro_rules! each_lobe {
    ($bsdf:expr, $lobe:ident => $body:expr) => {
        match $bsdf {
            Bsdf::Diffuse($lobe) => $body,
            Bsdf::OrenNayar($lobe) => $body,
            Bsdf::Mirror($lobe) => $body,
            Bsdf::Conductor($lobe) => $body,
            Bsdf::RoughConductor($lobe) => $body,
            Bsdf::Dielectric($lobe) => $body,
            Bsdf::RoughDielectric($lobe) => $body,
            Bsdf::ThinDielectric($lobe) => $body,
            Bsdf::Glossy($lobe) => $body,
            Bsdf::Phong($lobe) => $body,
            Bsdf::Jitter($lobe) => $body,
            Bsdf::Glazed($lobe) => $body,
            Bsdf::Schlick($lobe) => $body,
        }
    };
}
pub(crate) use each_lobe;

/// The names of all kinds, and that of a surface. The match wants every kind: a new one does not compile before it is named here,
/// and is then missed in the list below until it is there.
macro_rules! kinds {
    ($($Kind:ident)*) => {
        pub(crate) const KINDS: &[&str] = &[$(stringify!($Kind)),*];

        pub(crate) fn kind(bsdf: &Bsdf<f32>) -> &'static str {
            match bsdf {
                $(Bsdf::$Kind(_) => stringify!($Kind),)*
            }
        }
    };
}
kinds! {
    Diffuse OrenNayar Mirror Conductor RoughConductor Dielectric RoughDielectric ThinDielectric Glossy Phong Jitter Glazed
    Schlick
}

/// The kinds that a list lacks.
pub(crate) fn missing(list: &[(impl AsRef<str>, Bsdf<f32>)]) -> Vec<&'static str> {
    KINDS.iter().filter(|name| !list.iter().any(|(_, bsdf)| kind(bsdf) == **name)).copied().collect()
}

/// One of each kind with its name; those with a choice within, twice.
pub(crate) fn lobes() -> Vec<(&'static str, Bsdf<f32>)> {
    let gray = Rgb::gray(0.5_f32);
    let base = Diffuse { reflectance: gray };
    let (metal, glass) = (Metal::new(FresnelModel::Exact, gray, gray), Glass::exact(1.5_f32));
    let [long, short]: [Distribution<f32>; 2] =
        [Ggx { alpha_x: 0.1, alpha_y: 0.2 }.into(), Beckmann { alpha_x: 0.1, alpha_y: 0.2 }.into()];
    let glossy = Glossy { reflectance: gray, exponent: 20.0, below: Below::Rejection };
    let phong = Phong { reflectance: gray, exponent: 20.0, scale: PhongScale::MaxCosine };
    vec![
        ("diffuse", Bsdf::Diffuse(base)),
        ("oren_nayar", Bsdf::OrenNayar(OrenNayar { reflectance: gray, roughness: 0.5 })),
        ("mirror", Bsdf::Mirror(Mirror { reflectance: gray })),
        ("conductor", Bsdf::Conductor(Conductor { metal })),
        ("rough conductor; ggx", Bsdf::RoughConductor(RoughConductor { metal, facets: long })),
        ("rough conductor; beckmann", Bsdf::RoughConductor(RoughConductor { metal, facets: short })),
        ("dielectric", Bsdf::Dielectric(Dielectric { glass })),
        ("rough dielectric; ggx", Bsdf::RoughDielectric(RoughDielectric { glass, facets: long })),
        ("rough dielectric; beckmann", Bsdf::RoughDielectric(RoughDielectric { glass, facets: short })),
        ("thin dielectric", Bsdf::ThinDielectric(ThinDielectric { glass, transmittance: gray })),
        ("glossy; through_r", Bsdf::Glossy(Over { lobe: Glossy { below: Below::ThroughR, ..glossy }, base })),
        ("glossy; rejection", Bsdf::Glossy(Over { lobe: glossy, base })),
        ("phong", Bsdf::Phong(Over { lobe: phong, base })),
        ("jitter", Bsdf::Jitter(Over { lobe: Jitter { reflectance: gray, exponent: 20.0 }, base })),
        ("glazed", Bsdf::Glazed(Coat::new(FresnelModel::Exact, 1.5).over(gray))),
        ("schlick", Bsdf::Schlick(Schlick::new(gray, 0.3, 0.5))),
    ]
}

/// As many parts as there is room for, in turn of all kinds; their shares add up to one.
pub(crate) fn mixes() -> Vec<(String, Mix<f32>)> {
    const SHARES: [[f32; 3]; MOST_PARTS] =
        [[0.4, 0.1, 0.25], [0.3, 0.2, 0.25], [0.2, 0.3, 0.25], [0.1, 0.4, 0.25]];
    let lobes = lobes();
    let mix = |some: &[(&str, Bsdf<f32>)]| {
        let mut mix = Mix::nothing();
        for ((_, bsdf), [r, g, b]) in some.iter().zip(SHARES) {
            mix.push(Part { weight: Rgb::new(r, g, b), bsdf: *bsdf });
        }
        let names: Vec<_> = some.iter().map(|(name, _)| *name).collect();
        (format!("mix of {}", names.join(", ")), mix)
    };
    lobes.chunks(MOST_PARTS).map(mix).collect()
}
