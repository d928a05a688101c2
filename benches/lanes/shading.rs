//! A pass over paths as a renderer makes it: hash, sampled GGX facet, dielectric and conductor Fresnel, reflection or
//! refraction, weight, density, a table look-up, and the surviving lanes packed together.

use specula::math::Vec3;
use specula::math::lanes::{Compare, IntLanes, Isa, Kernel, Lanes, MaskLanes, Select, Wrapping};

/// Paths in structure-of-arrays form; every array has the same length, a multiple of sixteen.
#[derive(Clone, Debug, Default)]
pub(crate) struct Paths {
    /// Direction towards the viewer, in the local frame.
    pub(crate) x: Vec<f32>,
    pub(crate) y: Vec<f32>,
    pub(crate) z: Vec<f32>,
    /// Roughness.
    pub(crate) alpha: Vec<f32>,
    /// Relative index of refraction.
    pub(crate) eta: Vec<f32>,
    /// Extinction; zero for dielectrics.
    pub(crate) k: Vec<f32>,
    /// Throughput.
    pub(crate) beta: Vec<f32>,
    /// Density of the last direction.
    pub(crate) pdf: Vec<f32>,
    /// Which path this is, and the seed of its numbers.
    pub(crate) id: Vec<u32>,
    /// How many paths there are; what follows them in the arrays is unspecified.
    pub(crate) live: usize,
}

/// One bounce of all paths of `from`, the survivors written to `to`. Gives their number.
pub(crate) struct Bounce<'a> {
    pub(crate) from: &'a Paths,
    pub(crate) to: &'a mut Paths,
    pub(crate) albedo: &'a [f32],
}

impl<S: Isa> Kernel<S> for Bounce<'_> {
    type Output = usize;
    #[inline(always)]
    fn run(self, isa: S) -> usize {
        let Bounce { from, to, albedo } = self;
        to.live = 0;
        for at in (0..from.live).step_by(S::WIDTH) {
            let state = State::<S>::load(isa, from, at);
            let (state, survives) = bounce(isa, state, albedo);
            state.store(to, survives & isa.first(from.live - at));
        }
        to.live
    }
}

/// The lanes of one chunk.
#[derive(Clone, Copy)]
struct State<S: Isa> {
    wo: Vec3<S::F>,
    alpha: S::F,
    eta: S::F,
    k: S::F,
    beta: S::F,
    pdf: S::F,
    id: S::I,
}

impl<S: Isa> State<S> {
    #[inline(always)]
    fn load(isa: S, p: &Paths, at: usize) -> Self {
        Self {
            wo: Vec3::new(isa.load(&p.x[at..]), isa.load(&p.y[at..]), isa.load(&p.z[at..])),
            alpha: isa.load(&p.alpha[at..]),
            eta: isa.load(&p.eta[at..]),
            k: isa.load(&p.k[at..]),
            beta: isa.load(&p.beta[at..]),
            pdf: isa.load(&p.pdf[at..]),
            id: isa.load_u32(&p.id[at..]),
        }
    }

    /// Packs the lanes of the mask to where the arrays end, and moves the end.
    #[inline(always)]
    fn store(self, p: &mut Paths, mask: S::M) {
        let at = p.live;
        self.wo.x.compress(mask).store(&mut p.x[at..]);
        self.wo.y.compress(mask).store(&mut p.y[at..]);
        self.wo.z.compress(mask).store(&mut p.z[at..]);
        self.alpha.compress(mask).store(&mut p.alpha[at..]);
        self.eta.compress(mask).store(&mut p.eta[at..]);
        self.k.compress(mask).store(&mut p.k[at..]);
        self.beta.compress(mask).store(&mut p.beta[at..]);
        self.pdf.compress(mask).store(&mut p.pdf[at..]);
        self.id.compress(mask).store(&mut p.id[at..]);
        p.live += mask.count();
    }
}

#[inline(always)]
fn bounce<S: Isa>(isa: S, s: State<S>, albedo: &[f32]) -> (State<S>, S::M) {
    let (u0, u1) = (number(s.id, 0), number(s.id, 1));
    let (u2, u3) = (number(s.id, 2), number(s.id, 3));
    let h = visible_normal(s.wo, s.alpha, u0, u1);
    let cos = s.wo.dot(h).clamp(0.0, 1.0);
    let metal = s.k.gt(0.0);
    let (transparent, cos_t) = dielectric(cos, s.eta);
    let mut fresnel = transparent;
    if metal.any() {
        fresnel = S::F::select(metal, conductor(cos, s.eta, s.k), transparent);
    }
    let reflected = metal | u2.lt(fresnel);
    let up = s.wo.reflect(h);
    let through = h * (cos / s.eta - cos_t) - s.wo * s.eta.recip();
    let wi = Vec3::select(reflected, up, through);
    let weight = S::F::select(metal, fresnel, isa.splat(1.0)) * shadowing(wi, s.alpha);
    let tint = isa.gather(albedo, s.id & 255);
    let beta = s.beta * weight * tint;
    let chance = beta.clamp(0.05, 1.0);
    let survives = u3.lt(chance) & beta.gt(0.0);
    let pdf = distribution(h, s.alpha) / (s.wo.z.abs() * 4.0).max(1e-6);
    let id = s.id.wrapping_mul(747_796_405).wrapping_add(1);
    (State { wo: wi, beta: beta / chance, pdf, id, ..s }, survives)
}

/// Number `dimension` of path `id`, in [0, 1) (M. Jarzynski and M. Olano 2020, Hash Functions for GPU Rendering: PCG).
#[inline(always)]
fn number<I: IntLanes>(id: I, dimension: u32) -> I::F {
    let state =
        (id ^ dimension.wrapping_mul(0x9E37_79B9)).wrapping_mul(747_796_405).wrapping_add(2_891_336_453);
    let word = (state ^ (state >> 15)).wrapping_mul(277_803_737);
    (word ^ (word >> 22)).to_unit()
}

/// A normal seen from wo (J. Dupuy and A. Benyoub 2023, Sampling Visible GGX Normals with Spherical Caps).
#[inline(always)]
fn visible_normal<F: Lanes>(wo: Vec3<F>, alpha: F, u0: F, u1: F) -> Vec3<F> {
    let flat = Vec3::new(wo.x * alpha, wo.y * alpha, wo.z.abs()).normalize();
    let (sin_phi, cos_phi) = u0.sin_cos_turns();
    let z = (-u1 + 1.0).mul_add(flat.z + 1.0, -flat.z);
    let sin = (-z * z + 1.0).max(0.0).sqrt();
    let h = Vec3::new(sin * cos_phi + flat.x, sin * sin_phi + flat.y, z + flat.z);
    Vec3::new(h.x * alpha, h.y * alpha, h.z.max(1e-6)).normalize()
}

/// Fresnel reflectance and cosine of refraction at a dielectric; total reflection where the root is not real.
#[inline(always)]
fn dielectric<F: Lanes>(cos_i: F, eta: F) -> (F, F) {
    let sin2_t = (-cos_i.square() + 1.0) / eta.square();
    let cos_t = (-sin2_t + 1.0).max(0.0).sqrt();
    let parallel = (eta * cos_i - cos_t) / (eta * cos_i + cos_t);
    let perpendicular = (cos_i - eta * cos_t) / (cos_i + eta * cos_t);
    let both = (parallel.square() + perpendicular.square()) * 0.5;
    (F::select(sin2_t.ge(1.0), cos_i.splat(1.0), both), cos_t)
}

/// Fresnel reflectance of a conductor, unpolarised.
#[inline(always)]
fn conductor<F: Lanes>(cos_i: F, eta: F, k: F) -> F {
    let (cos2, sin2) = (cos_i.square(), -cos_i.square() + 1.0);
    let (eta2, k2) = (eta.square(), k.square());
    let t0 = eta2 - k2 - sin2;
    let a2_plus_b2 = t0.mul_add(t0, eta2 * k2 * 4.0).max(0.0).sqrt();
    let a = ((a2_plus_b2 + t0) * 0.5).max(0.0).sqrt();
    let t1 = a2_plus_b2 + cos2;
    let t2 = a * cos_i * 2.0;
    let perpendicular = (t1 - t2) / (t1 + t2);
    let t3 = cos2 * a2_plus_b2 + sin2.square();
    let t4 = t2 * sin2;
    let parallel = perpendicular * (t3 - t4) / (t3 + t4);
    (parallel + perpendicular) * 0.5
}

/// Smith's shadowing of one direction.
#[inline(always)]
fn shadowing<F: Lanes>(w: Vec3<F>, alpha: F) -> F {
    let tan2 = (w.x.square() + w.y.square()) / w.z.square().max(1e-12);
    let root = alpha.square().mul_add(tan2, tan2.splat(1.0)).sqrt();
    (root + 1.0).recip() * 2.0
}

/// The GGX distribution of normals.
#[inline(always)]
fn distribution<F: Lanes>(h: Vec3<F>, alpha: F) -> F {
    let a2 = alpha.square();
    let slope = h.z.square().mul_add(a2, h.x.square() + h.y.square());
    a2 / (slope.square() * std::f32::consts::PI)
}

/// Paths of all roughnesses, half of them on metal.
pub(crate) fn paths(n: usize) -> Paths {
    let mut p = Paths { live: n, ..Paths::default() };
    for i in 0..n {
        let id = u32::try_from(i).expect("few paths");
        let (u, v, w) = (number(id, 10), number(id, 11), number(id, 12));
        let (sin, cos) = ((1.0 - u * u).sqrt(), u.max(0.01));
        p.x.push(sin * (std::f32::consts::TAU * v).cos());
        p.y.push(sin * (std::f32::consts::TAU * v).sin());
        p.z.push(cos);
        p.alpha.push(0.01 + w * w);
        p.eta.push(if id & 32 == 0 { 1.5 } else { 0.2 + v });
        p.k.push(if id & 32 == 0 { 0.0 } else { 1.0 + 3.0 * w });
        p.beta.push(1.0);
        p.pdf.push(0.0);
        p.id.push(id);
    }
    p
}
