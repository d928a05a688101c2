//! What a surface can be asked, whatever it is made of.

use crate::bsdf::{
    Branch, BsdfSample, Conductor, Dielectric, Diffuse, Glazed, Glossy, Jitter, Lobes, Mirror, OrenNayar,
    Phong, RoughConductor, RoughDielectric, Schlick, ThinDielectric,
};
use crate::math::lanes::Lanes;
use crate::math::{Rgb, Vec3};

/// A kind of surface. What a kind does not have it answers with nothing.
pub trait Lobe<F: Lanes>: Copy {
    /// Which kinds of scattering there are.
    const LOBES: Lobes;

    /// The BSDF of the diffuse lobe, 1/sr.
    #[inline(always)]
    fn eval_diffuse(&self, wo: Vec3<F>, _wi: Vec3<F>) -> Rgb<F> {
        Rgb::gray(wo.z.splat(0.0))
    }

    /// The BSDF of the glossy lobe that `wi` belongs to, reflection above and transmission below, 1/sr.
    #[inline(always)]
    fn eval_glossy(&self, wo: Vec3<F>, _wi: Vec3<F>) -> Rgb<F> {
        Rgb::gray(wo.z.splat(0.0))
    }

    /// Density of the sample of [`Self::sample_glossy`] on the side of `wi`, with respect to solid angle.
    #[inline(always)]
    fn pdf_glossy(&self, wo: Vec3<F>, _wi: Vec3<F>) -> F {
        wo.z.splat(0.0)
    }

    /// A direction of the glossy reflection and one of the glossy transmission, where there are such lobes. Each has the
    /// density of its own lobe: both are to be followed, or one of them chosen.
    #[inline(always)]
    fn sample_glossy(&self, _wo: Vec3<F>, _u2: [F; 2]) -> [Option<BsdfSample<F>>; 2] {
        [None, None]
    }

    /// The ways on at a specular interface, none for other surfaces: reflection first, then transmission.
    #[inline(always)]
    fn branches(&self, _wo: Vec3<F>) -> [Option<Branch<F>>; 2] {
        [None, None]
    }

    /// About how much the glossy reflection and the glossy transmission return of light: a guess from `wo` alone, for
    /// choosing between lobes.
    #[inline(always)]
    fn glossy_albedo(&self, wo: Vec3<F>) -> [F; 2] {
        [wo.z.splat(0.0); 2]
    }
}

/// A lobe over a matt base, which gets its own share of the light.
#[derive(Clone, Copy, Debug)]
pub struct Over<L, F> {
    /// The lobe.
    pub lobe: L,
    /// The base.
    pub base: Diffuse<F>,
}

/// Passes questions about the glossy reflection on to methods of the same meaning: the lobe's own, or those of a field.
macro_rules! one_glossy_lobe {
    ($($field:ident)?) => {
        #[inline(always)]
        fn eval_glossy(&self, wo: Vec3<F>, wi: Vec3<F>) -> Rgb<F> {
            self$(.$field)?.eval(wo, wi)
        }
        #[inline(always)]
        fn pdf_glossy(&self, wo: Vec3<F>, wi: Vec3<F>) -> F {
            self$(.$field)?.pdf(wo, wi)
        }
        #[inline(always)]
        fn sample_glossy(&self, wo: Vec3<F>, u2: [F; 2]) -> [Option<BsdfSample<F>>; 2] {
            [Some(self$(.$field)?.sample(wo, u2)), None]
        }
    };
}

impl<F: Lanes> Lobe<F> for Diffuse<F> {
    const LOBES: Lobes = Lobes::DIFFUSE;
    #[inline(always)]
    fn eval_diffuse(&self, wo: Vec3<F>, wi: Vec3<F>) -> Rgb<F> {
        self.eval(wo, wi)
    }
}

impl<F: Lanes> Lobe<F> for OrenNayar<F> {
    const LOBES: Lobes = Lobes::DIFFUSE;
    #[inline(always)]
    fn eval_diffuse(&self, wo: Vec3<F>, wi: Vec3<F>) -> Rgb<F> {
        self.eval(wo, wi)
    }
}

impl<F: Lanes> Lobe<F> for Mirror<F> {
    const LOBES: Lobes = Lobes::SPECULAR;
    #[inline(always)]
    fn branches(&self, wo: Vec3<F>) -> [Option<Branch<F>>; 2] {
        [Some(self.branch(wo)), None]
    }
}

impl<F: Lanes> Lobe<F> for Conductor<F> {
    const LOBES: Lobes = Lobes::SPECULAR;
    #[inline(always)]
    fn branches(&self, wo: Vec3<F>) -> [Option<Branch<F>>; 2] {
        [Some(self.branch(wo)), None]
    }
}

impl<F: Lanes> Lobe<F> for RoughConductor<F> {
    const LOBES: Lobes = Lobes::GLOSSY;
    one_glossy_lobe!();
    #[inline(always)]
    fn glossy_albedo(&self, wo: Vec3<F>) -> [F; 2] {
        [wo.z.splat(1.0), wo.z.splat(0.0)]
    }
}

impl<F: Lanes> Lobe<F> for Dielectric<F> {
    const LOBES: Lobes = Lobes::SPECULAR;
    #[inline(always)]
    fn branches(&self, wo: Vec3<F>) -> [Option<Branch<F>>; 2] {
        let [reflected, refracted] = Self::branches(self, wo);
        [Some(reflected), Some(refracted)]
    }
}

impl<F: Lanes> Lobe<F> for RoughDielectric<F> {
    const LOBES: Lobes = Lobes::GLOSSY.and(Lobes::THROUGH);
    #[inline(always)]
    fn eval_glossy(&self, wo: Vec3<F>, wi: Vec3<F>) -> Rgb<F> {
        self.eval(wo, wi)
    }
    #[inline(always)]
    fn pdf_glossy(&self, wo: Vec3<F>, wi: Vec3<F>) -> F {
        self.pdf(wo, wi)
    }
    #[inline(always)]
    fn sample_glossy(&self, wo: Vec3<F>, u2: [F; 2]) -> [Option<BsdfSample<F>>; 2] {
        let [mirrored, refracted] = self.sample(wo, u2);
        [Some(mirrored), Some(refracted)]
    }
    #[inline(always)]
    fn glossy_albedo(&self, wo: Vec3<F>) -> [F; 2] {
        // Roughness spreads the angles that facets are met at, which matters most about the critical angle: the mean over level facets
        // and those that lean towards the viewer and away, as large as they are seen.
        let (cos, lean) = (wo.z, self.facets.lean());
        let sin = (-cos.square() + 1.0).max(0.0).sqrt();
        let length = (lean.square() + 1.0).rsqrt();
        let (near, far) = ((cos + sin * lean) * length, ((cos - sin * lean) * length).max(0.0));
        let seen = |cos: F| cos * self.glass.at(cos.min(1.0)).reflectance;
        let reflected = (seen(cos) * 2.0 + seen(near) + seen(far)) / (cos * 2.0 + near + far);
        // Neither way is ever out of the question.
        let reflected = reflected.clamp(0.05, 0.95);
        [reflected, -reflected + 1.0]
    }
}

impl<F: Lanes> Lobe<F> for ThinDielectric<F> {
    const LOBES: Lobes = Lobes::SPECULAR;
    #[inline(always)]
    fn branches(&self, wo: Vec3<F>) -> [Option<Branch<F>>; 2] {
        let [reflected, transmitted] = Self::branches(self, wo);
        [Some(reflected), Some(transmitted)]
    }
}

/// Lobes that may lie over a matt base.
macro_rules! over_matt {
    ($($Lobe:ident),+) => { $(
        impl<F: Lanes> Lobe<F> for Over<$Lobe<F>, F> {
            const LOBES: Lobes = Lobes::GLOSSY.and(Lobes::DIFFUSE);
            one_glossy_lobe!(lobe);
            #[inline(always)]
            fn eval_diffuse(&self, wo: Vec3<F>, wi: Vec3<F>) -> Rgb<F> {
                self.base.eval(wo, wi)
            }
            #[inline(always)]
            fn glossy_albedo(&self, wo: Vec3<F>) -> [F; 2] {
                [self.lobe.reflectance.max_channel(), wo.z.splat(0.0)]
            }
        }
    )+ };
}
over_matt!(Glossy, Phong, Jitter);

impl<F: Lanes> Lobe<F> for Glazed<F> {
    const LOBES: Lobes = Lobes::SPECULAR.and(Lobes::DIFFUSE);
    #[inline(always)]
    fn eval_diffuse(&self, wo: Vec3<F>, wi: Vec3<F>) -> Rgb<F> {
        self.diffuse(wo, wi)
    }
    #[inline(always)]
    fn branches(&self, wo: Vec3<F>) -> [Option<Branch<F>>; 2] {
        [Some(self.branch(wo)), None]
    }
}

impl<F: Lanes> Lobe<F> for Schlick<F> {
    const LOBES: Lobes = Lobes::SPECULAR.and(Lobes::GLOSSY).and(Lobes::DIFFUSE);
    one_glossy_lobe!();
    #[inline(always)]
    fn eval_diffuse(&self, wo: Vec3<F>, wi: Vec3<F>) -> Rgb<F> {
        self.diffuse(wo, wi)
    }
    #[inline(always)]
    fn branches(&self, wo: Vec3<F>) -> [Option<Branch<F>>; 2] {
        [Some(self.branch(wo)), None]
    }
    #[inline(always)]
    fn glossy_albedo(&self, wo: Vec3<F>) -> [F; 2] {
        [self.glossy_share(wo), wo.z.splat(0.0)]
    }
}
