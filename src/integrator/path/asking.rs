//! Lights that paths ask: which, with what density, and the rays towards them.

use super::lights::Picked;
use super::met::Met;
use super::vertex::{Here, Surroundings};
use super::wave::{Guarded, Guards, Shadows, Slots};
use crate::bsdf::choice::{Question, Step};
use crate::geometry::spawn;
use crate::integrator::shading::{Lifted, Shading};
use crate::light::{Light, LightId, LightSample, Reference};
use crate::math::lanes::{Bits, Compare, IntLanes, Isa, Kernel, Lanes, MaskLanes, Select};
use crate::math::{Rgb, Vec3};
use crate::sampling::{Dim, Sampler, Vertex};
use crate::scene::Scene;

/// The light that each lane asks.
pub(super) struct Asked<S: Isa> {
    pub(super) wi: Vec3<S::F>,
    p: Vec3<S::F>,
    li: Rgb<S::F>,
    /// Density with which it was asked, the choice included.
    pdf: S::F,
    /// The same for sharing with the ways on: infinite where these cannot find the light.
    pub(super) shared_pdf: S::F,
    infinite: S::M,
    valid: S::M,
}

#[inline(always)]
pub(super) fn asked<S: Isa>(
    isa: S,
    around: &Surroundings<'_>,
    (met, shading): (&Met<S>, &Shading<S::F>),
    (sampler, vertex): (&impl Sampler<I = S::I>, Vertex),
) -> Asked<S> {
    let lights = around.lights;
    let zero = isa.splat(0.0);
    let n = shading.frame.z;
    let never = isa.splat_mask(false);
    let nothing = Asked {
        wi: n,
        p: met.points.p,
        li: Rgb::gray(zero),
        pdf: isa.splat(1.0),
        shared_pdf: isa.splat(1.0),
        infinite: never,
        valid: never,
    };
    if lights.is_empty() {
        return nothing;
    }
    let reference = Reference { p: met.points.p, n };
    let u2 = sampler.get_2d(Dim::LightPoint(0), vertex);
    if let Some(only) = lights.only() {
        let light = (&around.scene.lights[only.index()], None);
        return from_light(isa, light, (isa.splat(1.0), lights.favour()), (reference, only_of(met.hit, u2)));
    }
    let u = sampler.get_1d(Dim::LightChoice, vertex);
    let Picked { ids: chosen, parts, probability } = lights.pick(isa, reference, u);
    let ids = isa.load_u32(&chosen);
    let exists = probability.gt(0.0);
    let probability = S::F::select(exists, probability, isa.splat(1.0));
    let mut all = nothing;
    let mut bits = (met.hit & exists).bits();
    while bits != 0 {
        let id = chosen[bits.trailing_zeros() as usize];
        let same = Compare::<u32>::eq(ids, id) & exists;
        let light = &around.scene.lights[id as usize];
        let part = if lights.is_split(LightId(id)) { Some(parts) } else { None };
        all = Asked::select(
            same,
            from_light(
                isa,
                (light, part),
                (probability, lights.favour()),
                (reference, only_of(same & met.hit, u2)),
            ),
            all,
        );
        bits &= !same.bits();
    }
    all
}

/// Numbers of the lanes that ask, zeros in the others: what these would look up is of no use, and not in the cache.
#[inline(always)]
fn only_of<F: Lanes>(mask: F::Mask, [u, v]: [F; 2]) -> [F; 2] {
    let zero = u.splat(0.0);
    [F::select(mask, u, zero), F::select(mask, v, zero)]
}

impl<S: Isa> Asked<S> {
    /// The same for so many paths with the same vertex, of which only the first asks.
    #[inline(always)]
    pub(super) fn for_all(self, isa: S, slots: S::I, ways: u32) -> Self {
        if ways == 1 {
            return self;
        }
        let part = 1.0 / ways as f32;
        let leads = isa.per_lane(|lane| if slots.extract(lane) % ways == 0 { 1.0 } else { 0.0 }).gt(0.0);
        Self { pdf: self.pdf * part, shared_pdf: self.shared_pdf * part, valid: self.valid & leads, ..self }
    }

    #[inline(always)]
    fn select(mask: S::M, yes: Self, no: Self) -> Self {
        Self {
            wi: Vec3::select(mask, yes.wi, no.wi),
            p: Vec3::select(mask, yes.p, no.p),
            li: Rgb::select(mask, yes.li, no.li),
            pdf: S::F::select(mask, yes.pdf, no.pdf),
            shared_pdf: S::F::select(mask, yes.shared_pdf, no.shared_pdf),
            infinite: (yes.infinite & mask) | (no.infinite & !mask),
            valid: (yes.valid & mask) | (no.valid & !mask),
        }
    }
}

#[inline(always)]
fn from_light<S: Isa>(
    isa: S,
    (light, part): (&Light, Option<S::I>),
    (probability, favour): (S::F, f32),
    (reference, u2): (Reference<S::F>, [S::F; 2]),
) -> Asked<S> {
    let LightSample { wi, p, li, pdf, valid } = ask_light(isa, (light, part), reference, u2);
    let pdf = pdf * probability;
    let shared_pdf = if light.is_delta() { isa.splat(f32::INFINITY) } else { pdf * favour };
    Asked { wi, p, li, pdf, shared_pdf, infinite: isa.splat_mask(light.is_infinite()), valid }
}

/// A function of its own per instruction set, as for lobes.
#[inline(never)]
fn ask_light<S: Isa>(
    isa: S,
    (light, part): (&Light, Option<S::I>),
    reference: Reference<S::F>,
    u2: [S::F; 2],
) -> LightSample<S::F> {
    isa.run(AskLight { light, part, reference, u2 })
}

struct AskLight<'a, F: Lanes> {
    light: &'a Light,
    part: Option<F::Int>,
    reference: Reference<F>,
    u2: [F; 2],
}

impl<S: Isa> Kernel<S> for AskLight<'_, S::F> {
    type Output = LightSample<S::F>;
    #[inline(always)]
    fn run(self, _isa: S) -> LightSample<S::F> {
        self.light.sample_part(self.reference, self.part, self.u2)
    }
}

/// Queues the rays towards lights that would matter.
#[inline(always)]
pub(super) fn ask_lights<S: Isa, const N: usize>(
    isa: S,
    queues: (&mut Shadows, &mut Guards),
    at: &Here<'_, S, N>,
    (light, question): (&Asked<S>, &Question<S::F>),
    lit: Rgb<S::F>,
) {
    let cos = question.light.z;
    let carried = at.lanes.beta * lit * light.li * (cos / light.pdf);
    let wanted = light.valid & cos.gt(0.0) & at.met.hit;
    queue(
        isa,
        queues,
        at,
        (&Towards { wi: light.wi, p: light.p, infinite: light.infinite, carried }, wanted),
    );
}

/// Queues rays of the last ways on towards an environment that is the same all around, which is not asked.
#[inline(always)]
pub(super) fn ask_sky<S: Isa, const N: usize>(
    isa: S,
    queues: (&mut Shadows, &mut Guards),
    at: &Here<'_, S, N>,
    (step, wanted): (&Step<S::F>, S::M),
) {
    let Some((_, environment)) = at.scene.environment_light() else { return };
    let Some(radiance) = environment.constant() else { return };
    let wi = at.shading.to_world(step.wi);
    let carried = at.lanes.beta * step.weight * Rgb::splat(isa.splat(0.0), radiance);
    queue(isa, queues, at, (&Towards { wi, p: wi, infinite: isa.splat_mask(true), carried }, wanted));
}

/// Rays towards lights above their surfaces.
struct Towards<F: Lanes> {
    /// Unit direction from the point of the surface.
    wi: Vec3<F>,
    /// Where they end, unless at infinity.
    p: Vec3<F>,
    infinite: F::Mask,
    carried: Rgb<F>,
}

#[inline(always)]
fn queue<S: Isa, const N: usize>(
    isa: S,
    (shadows, guards): (&mut Shadows, &mut Guards),
    at: &Here<'_, S, N>,
    (way, wanted): (&Towards<S::F>, S::M),
) {
    let (points, lanes) = (&at.met.points, at.lanes);
    let Towards { wi, p, infinite, carried } = *way;
    let wanted = wanted & !carried.is_black();
    if wanted.none() {
        return;
    }
    let straight = wi.dot(at.shading.ng).gt(0.0);
    let o = spawn::origin(points.p, points.p_error, points.ng, wi);
    // From where the ray starts: as long as from the surface, it would end behind a light that is near.
    let d = Vec3::select(infinite, wi, p - o);
    let end = S::F::select(infinite, isa.splat(f32::INFINITY), isa.splat(spawn::SHADOW_REACH));
    let (to, sent) = (shadows.rays.len, wanted & straight);
    shadows.rays.pack(to, sent, (o, d, lanes.time, lanes.slot));
    shadows.end.store(to, end.compress(sent));
    shadows.light.pack(to, sent, Vec3::new(carried.r, carried.g, carried.b));
    shadows.rays.len += sent.count();
    // The others are below the true surface: they start from the smooth one, or not at all.
    for lane in Bits((wanted & !straight).bits()) {
        let Some(Lifted { ray, guard }) = at.lifted(lane, wi, false) else { continue };
        let ray = if infinite.extract(lane) { ray } else { ray.towards(p.extract(lane).into()) };
        guards.0.push((guard, Guarded::Shadow(shadows.rays.len)));
        shadows.push(&ray, lanes.slot.extract(lane), carried.extract(lane));
    }
}

/// What media leave of light on its way to the surfaces that asked for it, for rays that have not been looked at yet.
#[inline(never)]
pub(super) fn absorb_shadows(scene: &Scene, shadows: &mut Shadows, slots: &Slots) {
    for i in shadows.absorbed..shadows.rays.len {
        let medium = slots.media[shadows.rays.slot.all()[i] as usize].current();
        if medium.is_none() {
            continue;
        }
        let d = glam::Vec3::from(shadows.rays.d.get(i));
        let length = if shadows.end.all()[i].is_finite() { d.length() } else { f32::INFINITY };
        let left = scene.absorbed(medium, length);
        shadows.light.scale(i, [left.r, left.g, left.b]);
    }
    shadows.absorbed = shadows.rays.len;
}
