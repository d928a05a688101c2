//! Which formula gives the reflectance of an interface: a knob between exactness and speed.
//!
//! Errors against the exact formulas, greatest over all angles (measured; `tests/fresnel.rs`):
//!
//! | index | Schlick | Schlick with edge term | | metal | Schlick | with edge term |
//! |---|---|---|---|---|---|---|
//! | 1.01 | 0.55 | 0.25 | | aluminium (1.1 + 6.79 i) | 0.10 | 0.009 |
//! | 1.1 | 0.21 | 0.022 | | 2.95 + 2.93 i | 0.18 | 0.019 |
//! | 1.33 | 0.060 | 0.020 | | 3.2 + 3.3 i | 0.20 | 0.024 |
//! | 1.5 | 0.036 | 0.028 | | gold, red (0.143 + 3.983 i) | 0.016 | 0.004 |
//! | 2.4 | 0.074 | 0.030 | | gold, blue (1.442 + 1.603 i) | 0.029 | 0.029 |
//!
//! Plain Schlick is for indices from 1.3 to 2.2; near 1 it shows a bright rim where there is no interface at all.
//! Constant reflectance is the metal of introductory lectures: right at normal incidence, wrong by up to 1 at grazing.

use crate::bsdf::Spread;
use crate::bsdf::fresnel::{self, Interface};
use crate::math::Rgb;
use crate::math::lanes::Lanes;

/// How reflectance depends on the angle.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum FresnelModel {
    /// Fresnel's equations.
    #[default]
    Exact,
    /// Schlick 1994, An Inexpensive BRDF Model for Physically-Based Rendering.
    Schlick,
    /// Schlick with a term that makes it exact at a cosine of 1/7 too, near 82 degrees (Lazányi and Szirmay-Kalos 2005,
    /// Fresnel Term Approximations for Metals).
    F82,
    /// That of normal incidence at all angles; total internal reflection stays, since nothing else could be done.
    Constant,
}

impl FresnelModel {
    /// Mean reflectance over the hemisphere, weighted by the cosine, of a dielectric of index `n` >= 1 seen from outside.
    #[must_use]
    pub fn average_outside(self, n: f64) -> f64 {
        let r0 = ((n - 1.0) / (n + 1.0)).powi(2);
        if r0 == 0.0 {
            return 0.0;
        }
        match self {
            Self::Exact => fresnel::average_outside(n),
            Self::Schlick => r0 + (1.0 - r0) / 21.0,
            Self::Constant => r0,
            #[expect(clippy::cast_possible_truncation, reason = "a model in single precision")]
            Self::F82 => {
                let glass = Glass::new(self, n as f32);
                fresnel::cosine_average(|c| f64::from(glass.at(c as f32).reflectance))
            }
        }
    }

    /// The same seen from within: of light that is alike in all directions there, n^2 times as much is within the cone that gets
    /// out as comes in.
    #[must_use]
    pub fn average_inside(self, n: f64) -> f64 {
        1.0 - (1.0 - self.average_outside(n)) / (n * n)
    }
}

/// The reflectance of a metal.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Metal<F> {
    /// By [`fresnel::conductor`].
    Exact {
        /// Real part of the index of refraction.
        eta: Rgb<F>,
        /// Imaginary part: extinction.
        k: Rgb<F>,
    },
    /// By [`fresnel::schlick`].
    Schlick {
        /// At normal incidence.
        r0: Rgb<F>,
    },
    /// By [`fresnel::schlick_edge`].
    F82 {
        /// At normal incidence.
        r0: Rgb<F>,
        /// What is taken off towards the edge.
        edge: Rgb<F>,
    },
    /// At all angles alike.
    Constant {
        /// At normal incidence.
        r0: Rgb<F>,
    },
}

impl<F: Lanes> Metal<F> {
    /// What `model` makes of the index `eta` + i `k`.
    #[inline(always)]
    pub fn new(model: FresnelModel, eta: Rgb<F>, k: Rgb<F>) -> Self {
        let r0 = fresnel::conductor_rgb(eta.r.splat(1.0), eta, k);
        match model {
            FresnelModel::Exact => Self::Exact { eta, k },
            FresnelModel::Schlick => Self::Schlick { r0 },
            FresnelModel::Constant => Self::Constant { r0 },
            FresnelModel::F82 => {
                let known = fresnel::conductor_rgb(eta.r.splat(fresnel::EDGE_COSINE), eta, k);
                let edge = Rgb::new(
                    fresnel::edge_term(r0.r, known.r),
                    fresnel::edge_term(r0.g, known.g),
                    fresnel::edge_term(r0.b, known.b),
                );
                Self::F82 { r0, edge }
            }
        }
    }

    /// Reflectance at the cosine `cos_i` in [0, 1], in [0, 1].
    #[inline(always)]
    pub fn at(&self, cos_i: F) -> Rgb<F> {
        match *self {
            Self::Exact { eta, k } => fresnel::conductor_rgb(cos_i, eta, k),
            Self::Schlick { r0 } => fresnel::schlick_rgb(cos_i, r0),
            Self::F82 { r0, edge } => Rgb::new(
                fresnel::schlick_edge(cos_i, r0.r, edge.r),
                fresnel::schlick_edge(cos_i, r0.g, edge.g),
                fresnel::schlick_edge(cos_i, r0.b, edge.b),
            ),
            Self::Constant { r0 } => r0,
        }
    }
}

/// The reflectance of an interface between transparent media.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Glass<F> {
    eta: F,
    curve: Curve<F>,
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Curve<F> {
    Exact,
    Schlick { r0: F },
    F82 { r0: F, edge: F },
    Constant { r0: F },
}

impl Spread for Glass<f32> {
    type Over<F: Lanes> = Glass<F>;
    #[inline(always)]
    fn spread<F: Lanes>(&self, like: F) -> Glass<F> {
        let curve = match self.curve {
            Curve::Exact => Curve::Exact,
            Curve::Schlick { r0 } => Curve::Schlick { r0: like.splat(r0) },
            Curve::F82 { r0, edge } => Curve::F82 { r0: like.splat(r0), edge: like.splat(edge) },
            Curve::Constant { r0 } => Curve::Constant { r0: like.splat(r0) },
        };
        Glass { eta: like.splat(self.eta), curve }
    }
}

impl<F: Lanes> Glass<F> {
    /// What `model` makes of the index `eta` = n_t / n_i > 0.
    #[inline(always)]
    pub fn new(model: FresnelModel, eta: F) -> Self {
        let curve = match model {
            FresnelModel::Exact => Curve::Exact,
            FresnelModel::Schlick => Curve::Schlick { r0: fresnel::normal_incidence(eta) },
            FresnelModel::Constant => Curve::Constant { r0: fresnel::normal_incidence(eta) },
            FresnelModel::F82 => {
                let r0 = fresnel::normal_incidence(eta);
                let known = fresnel::dielectric(eta.splat(fresnel::EDGE_COSINE), eta.max(eta.recip()));
                Curve::F82 { r0, edge: fresnel::edge_term(r0, known.reflectance) }
            }
        };
        Self { eta, curve }
    }

    /// Fresnel's equations for `eta` = n_t / n_i > 0.
    #[inline(always)]
    pub fn exact(eta: F) -> Self {
        Self { eta, curve: Curve::Exact }
    }

    /// n_t / n_i: the far side's index over the near side's.
    #[inline(always)]
    pub fn eta(&self) -> F {
        self.eta
    }

    /// Reflectance and refraction at the cosine `cos_i` in [0, 1] on the near side. Which directions exist is exact in
    /// every model; approximations take the cosine on the side of the lower index.
    #[inline(always)]
    pub fn at(&self, cos_i: F) -> Interface<F> {
        let bend = fresnel::bend(cos_i, self.eta);
        let outer = F::select(self.eta.lt(1.0), bend.cos_t, cos_i);
        let reflectance = match self.curve {
            Curve::Exact => return fresnel::dielectric(cos_i, self.eta),
            Curve::Schlick { r0 } => fresnel::schlick(outer, r0),
            Curve::F82 { r0, edge } => fresnel::schlick_edge(outer, r0, edge),
            Curve::Constant { r0 } => r0,
        };
        let (zero, one) = (cos_i.splat(0.0), cos_i.splat(1.0));
        let reflectance = F::select(self.eta.eq(1.0), zero, F::select(bend.total, one, reflectance));
        Interface { reflectance, cos_t: bend.cos_t, total: bend.total }
    }
}
