//! What happens where the paths of a chunk meet surfaces: one pass over all lanes.

use super::lights::{Lights, Picked};
use super::met::{Met, WIDEST, hit_of};
use super::surfaces::Surfaces;
use super::wave::{Guarded, Guards, Paths, Shadows, Slots, Wave};
use crate::accel::{Coherence, Packet};
use crate::bsdf::choice::{Answer, Question, Step, ask};
use crate::bsdf::{Diffuse, with_lobe};
use crate::geometry::{PlacementId, spawn};
use crate::integrator::cone::{Beam, Cone};
use crate::integrator::shading::{Lifted, Shading, lifted};
use crate::integrator::{Counters, Stage, relief};
use crate::light::{Arriving, Emitter, Environment, Light, LightId, LightSample, Reference};
use crate::material::{Layer, Material, Media, Scattering};
use crate::math::lanes::{Compare, IntLanes, Isa, Kernel, Lanes, MaskLanes, Select};
use crate::math::{Rgb, Vec3};
use crate::sampling::{Dim, Sampler, SamplerKind, Vertex, heuristic};
use crate::scene::Scene;
use crate::texture::{Spot, Texture};

/// What is the same for all vertices of a rendering.
#[derive(Debug)]
pub(super) struct Surroundings<'a> {
    pub(super) scene: &'a Scene,
    pub(super) lights: &'a Lights,
    pub(super) surfaces: &'a Surfaces,
    pub(super) sampler: SamplerKind,
    pub(super) seed: u32,
    pub(super) max_depth: u32,
    /// The length from which paths may end at random.
    pub(super) roulette: Option<u32>,
    /// The most luminance of a piece of indirect light.
    pub(super) limit: Option<f32>,
    /// Of the camera's rays.
    pub(super) coherence: Coherence,
    pub(super) bounces_in_packets: bool,
    /// Whether direct light is told apart.
    pub(super) splits: bool,
    /// Whether any surface bounds a medium.
    pub(super) media: bool,
    /// Whether any medium absorbs light.
    pub(super) absorbs: bool,
    /// Whether any surface is not the same in all directions.
    pub(super) turns: bool,
    /// Where surfaces show pictures: what the widths of rays follow from.
    pub(super) beam: Option<Beam>,
}

/// One chunk of paths at the ends of their rays.
pub(super) struct Chunk<'a, const N: usize> {
    pub(super) around: &'a Surroundings<'a>,
    pub(super) wave: &'a mut Wave,
    pub(super) counters: &'a mut Counters,
    /// The rays with their hits.
    pub(super) packet: &'a Packet<N>,
    /// Where the chunk begins, and how many paths it has.
    pub(super) at: usize,
    pub(super) count: usize,
    /// Where those that go on are packed to.
    pub(super) to: usize,
    pub(super) depth: u32,
    pub(super) vertex: Vertex,
    pub(super) beyond: &'a Beyond<N>,
}

/// What lies behind the surfaces of a chunk.
#[derive(Clone, Copy)]
pub(super) struct Beyond<const N: usize> {
    /// The index of each over that before it.
    pub(super) eta: [f32; N],
    /// The media; unspecified where the same are in front.
    pub(super) media: [Media; N],
    /// The lanes where others are in front.
    pub(super) changed: u32,
}

impl<const N: usize> Beyond<N> {
    /// Notes the surface of a medium.
    pub(super) fn set(&mut self, lane: usize, eta: f32, media: Media) {
        (self.eta[lane], self.media[lane]) = (eta, media);
        self.changed |= 1 << lane;
    }
}

impl<S: Isa, const N: usize> Kernel<S> for Chunk<'_, N> {
    /// How many go on.
    type Output = usize;

    #[inline(always)]
    fn run(self, isa: S) -> usize {
        let Chunk { around, wave, counters, packet, at, count, to, depth, vertex, beyond } = self;
        let Wave { paths, shadows, guards, slots } = wave;
        let lanes = State::load(isa, (paths, at), around.lights.uses_normals());
        let mut met = Met::of(isa, (around.scene, around.surfaces), packet, isa.first(count));
        escape(isa, around, slots, &lanes, isa.first(count) & !met.hit);
        if met.hit.none() {
            return 0;
        }
        if depth == 1 {
            slots.meet(met.hit, lanes.slot);
        }
        let cone = around.beam.map(|beam| lanes.cone(isa, (paths, at), (beam, depth), &mut met));
        shine(isa, around, slots, (&lanes, &met), packet);
        if depth >= around.max_depth {
            return 0;
        }
        if around.surfaces.reliefs {
            met.points.ns = relieved(isa, around.scene, packet, &met);
        }
        let wo = -lanes.d;
        let normals = [met.points.ng, met.points.ns];
        let tangent = if around.turns { Some(tangents(isa, around.scene, packet, &met)) } else { None };
        let shading = Shading::seen(wo, normals, tangent);
        let pixel = [slots.pixel_of(isa, 0, lanes.slot), slots.pixel_of(isa, 1, lanes.slot)];
        let index = isa.gather_u32(slots.index.all(), lanes.slot);
        let sampler = around.sampler.start(around.seed, pixel, index);
        let light = asked(isa, around, (&met, &shading), (&sampler, vertex));
        let choice =
            if around.surfaces.choices { sampler.get_1d(Dim::LobeChoice, vertex) } else { isa.splat(0.0) };
        let question = Question {
            wo: shading.wo,
            light: shading.frame.to_local(light.wi),
            light_pdf: light.shared_pdf,
            choice,
            direction: sampler.get_2d(Dim::LobeDirection, vertex),
            // Where media hide surfaces, paths get to lights that rays towards them do not reach.
            last: depth + 1 == around.max_depth && !around.media && !around.lights.are_left_to_lobes(),
        };
        let mut found = scatter(isa, (around.scene, around.surfaces), &met, beyond, &question);
        let own = (&lanes, met.hit, &mut found.step);
        counters.cut_by_roulette += roulette(isa, (around, slots, depth), own, beyond, (&sampler, vertex));
        let at = Here { scene: around.scene, packet, lanes: &lanes, met: &met, shading: &shading };
        ask_lights(isa, (shadows, guards), &at, (&light, &question), found.lit);
        if around.absorbs {
            absorb_shadows(around.scene, shadows, slots);
        }
        if question.last {
            let unshared = found.step.valid & found.step.pdf.lt(0.0) & met.hit;
            found.step.valid = found.step.valid & !unshared;
            ask_sky(isa, (shadows, guards), &at, (&found.step, unshared));
        }
        let next = go_on(isa, (guards, to), &at, found.step);
        counters.bounced += next.goes.count() as u64;
        if around.media {
            cross(slots, lanes.slot, next.goes & found.step.crosses, beyond);
        }
        if let (Some(beam), Some((cone, length))) = (around.beam, cone) {
            paths.widen(to, next.goes, beam.scattered(cone, length, next.pdf));
        }
        let normals = if around.lights.uses_normals() { Some(shading.frame.z) } else { None };
        next.store(paths, to, (&lanes, normals))
    }
}

/// The lanes' paths.
struct State<S: Isa> {
    o: Vec3<S::F>,
    d: Vec3<S::F>,
    time: S::F,
    beta: Rgb<S::F>,
    pdf: S::F,
    slot: S::I,
    /// The normal where the ray left, if normals count in the choice of lights; else unspecified.
    n: Vec3<S::F>,
}

impl<S: Isa> State<S> {
    #[inline(always)]
    fn load(isa: S, (paths, at): (&Paths, usize), normals: bool) -> Self {
        let rays = &paths.rays;
        let d = rays.d.vector(isa, at);
        Self {
            o: rays.o.vector(isa, at),
            d,
            n: if normals { paths.normal.vector(isa, at) } else { d },
            time: rays.time.load(isa, at),
            beta: paths.beta.color(isa, at),
            pdf: paths.pdf.load(isa, at),
            slot: rays.slot.load(isa, at),
        }
    }

    /// The cones about the rays and their lengths; how wide they are on the surfaces is noted.
    #[inline(always)]
    fn cone(
        &self,
        isa: S,
        (paths, at): (&Paths, usize),
        (beam, depth): (Beam, u32),
        met: &mut Met<S>,
    ) -> (Cone<S::F>, S::F) {
        let cone = if depth == 1 { beam.start(isa.splat(0.0)) } else { paths.cone(isa, at) };
        let length = (met.points.p - self.o).length();
        met.footprint = cone.footprint(length, self.d.dot(met.points.ng), met.points.density);
        (cone, length)
    }
}

/// The environment, for the lanes that met nothing.
#[inline(always)]
fn escape<S: Isa>(isa: S, around: &Surroundings<'_>, slots: &mut Slots, lanes: &State<S>, missed: S::M) {
    let Some((id, environment)) = around.scene.environment_light() else { return };
    if missed.none() {
        return;
    }
    let light = match environment {
        Environment::Constant(radiance) => Rgb::splat(isa.splat(0.0), *radiance),
        Environment::Map(map) => {
            // The others look where it costs least.
            let up = Vec3::new(isa.splat(0.0), isa.splat(1.0), isa.splat(0.0));
            let Arriving { radiance, pdf } = map.arriving(Vec3::select(missed, lanes.d, up));
            let asked = pdf * around.lights.chance_at_infinity(id);
            let shared = heuristic::power(lanes.pdf, asked);
            radiance * S::F::select(lanes.pdf.gt(0.0), shared, isa.splat(1.0))
        }
    };
    slots.add(missed, lanes.slot, lanes.beta * light);
}

/// The part that is a ray's of light that asking finds with density `asked`.
fn share(pdf: f32, asked: f32) -> f32 {
    if pdf > 0.0 { heuristic::power(pdf, asked) } else { 1.0 }
}

/// What surfaces give off by themselves: few lanes meet a light, and these are done one by one.
#[inline(always)]
fn shine<S: Isa, const N: usize>(
    isa: S,
    around: &Surroundings<'_>,
    slots: &mut Slots,
    (lanes, met): (&State<S>, &Met<S>),
    packet: &Packet<N>,
) {
    let shining = around.surfaces.shine(isa, met.materials) & met.hit;
    if shining.none() {
        return;
    }
    let scene = around.scene;
    let mut bits = shining.bits();
    let mut rows = [[0.0; WIDEST]; 3];
    while bits != 0 {
        let lane = bits.trailing_zeros() as usize;
        bits &= bits - 1;
        let (ng, d) = (met.points.ng.extract(lane), lanes.d.extract(lane));
        let uv = met.points.uv.map(|x| x.extract(lane));
        let spot = Spot { uv, footprint: met.footprint.extract(lane) };
        let emitted = scene.materials[met.materials.extract(lane) as usize].emitted(d.dot(ng) < 0.0, spot);
        let placement = PlacementId(met.placements.extract(lane));
        let emitter =
            Emitter { p: met.points.p.extract(lane).into(), ng: ng.into(), prim: packet.hit.prim[lane] };
        let shared = scene.light_id_of(placement).filter(|_| lanes.pdf.extract(lane) > 0.0);
        let asked = shared.map_or(0.0, |id| {
            let at = Reference { p: lanes.o.extract(lane), n: lanes.n.extract(lane) };
            around.lights.pdf(scene, id, (at, d), Some(&emitter))
        });
        let Rgb { r, g, b } = emitted.scale(share(lanes.pdf.extract(lane), asked));
        [rows[0][lane], rows[1][lane], rows[2][lane]] = [r, g, b];
    }
    let light = Rgb::new(isa.load(&rows[0]), isa.load(&rows[1]), isa.load(&rows[2]));
    slots.add(shining, lanes.slot, lanes.beta * light);
}

/// First tangents of surfaces that are not the same in all directions, zero for the others.
#[inline(always)]
fn tangents<S: Isa, const N: usize>(isa: S, scene: &Scene, packet: &Packet<N>, met: &Met<S>) -> Vec3<S::F> {
    let mut rows = [[0.0; WIDEST]; 3];
    let mut bits = met.hit.bits();
    while bits != 0 {
        let lane = bits.trailing_zeros() as usize;
        bits &= bits - 1;
        let material = &scene.materials[met.materials.extract(lane) as usize];
        if let Some(tangent) = tangent_of(scene, packet, lane, material) {
            [rows[0][lane], rows[1][lane], rows[2][lane]] = tangent.to_array();
        }
    }
    Vec3::new(isa.load(&rows[0]), isa.load(&rows[1]), isa.load(&rows[2]))
}

/// Shading normals, those of surfaces with a relief turned as it says: one by one, as tangents.
#[inline(always)]
fn relieved<S: Isa, const N: usize>(isa: S, scene: &Scene, packet: &Packet<N>, met: &Met<S>) -> Vec3<S::F> {
    let ns = met.points.ns;
    let mut rows = [[0.0; WIDEST]; 3];
    ns.x.store(&mut rows[0]);
    ns.y.store(&mut rows[1]);
    ns.z.store(&mut rows[2]);
    let mut bits = met.hit.bits();
    while bits != 0 {
        let lane = bits.trailing_zeros() as usize;
        bits &= bits - 1;
        let material = &scene.materials[met.materials.extract(lane) as usize];
        if material.relief.is_none() {
            continue;
        }
        if let Some(ns) = relief_of(scene, (packet, lane), material, met.footprint.extract(lane)) {
            [rows[0][lane], rows[1][lane], rows[2][lane]] = ns.to_array();
        }
    }
    Vec3::new(isa.load(&rows[0]), isa.load(&rows[1]), isa.load(&rows[2]))
}

#[inline(never)]
fn relief_of<const N: usize>(
    scene: &Scene,
    (packet, lane): (&Packet<N>, usize),
    material: &Material,
    footprint: f32,
) -> Option<glam::Vec3> {
    let it = scene.world.interaction(&packet.ray.get(lane), &hit_of(packet, lane)?);
    relief::normal(scene, &it, material, Spot { uv: it.uv.into(), footprint })
}

#[inline(never)]
fn tangent_of<const N: usize>(
    scene: &Scene,
    packet: &Packet<N>,
    lane: usize,
    material: &Material,
) -> Option<glam::Vec3> {
    material.scattering.turn()?;
    let it = scene.world.interaction(&packet.ray.get(lane), &hit_of(packet, lane)?);
    crate::integrator::tangent(scene, &it, material)
}

/// The light that each lane asks.
struct Asked<S: Isa> {
    wi: Vec3<S::F>,
    p: Vec3<S::F>,
    li: Rgb<S::F>,
    /// Density with which it was asked, the choice included.
    pdf: S::F,
    /// The same for sharing with the ways on: infinite where these cannot find the light.
    shared_pdf: S::F,
    infinite: S::M,
    valid: S::M,
}

#[inline(always)]
fn asked<S: Isa>(
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

/// What surfaces answer, material by material.
#[inline(always)]
fn scatter<S: Isa, const N: usize>(
    isa: S,
    (scene, surfaces): (&Scene, &Surfaces),
    met: &Met<S>,
    beyond: &Beyond<N>,
    question: &Question<S::F>,
) -> Answer<S::F> {
    let eta = isa.load(&beyond.eta);
    let mut all = Answer::black(question.wo);
    let mut bits = met.hit.bits();
    let kinds = surfaces.alike(isa, met.materials);
    while bits != 0 {
        let id = kinds.extract(bits.trailing_zeros() as usize);
        let same = Compare::<u32>::eq(kinds, id) & met.hit;
        bits &= !same.bits();
        let found = match &scene.materials[id as usize].scattering {
            Scattering::Diffuse { reflectance: Texture::Constant(_) } => {
                let reflectance = surfaces.colors(isa, S::I::select(same, met.materials, isa.splat_u32(id)));
                ask(isa, &Diffuse { reflectance }, question)
            }
            scattering => of_material(isa, scattering, (met, eta), question),
        };
        if same.bits() == met.hit.bits() {
            return found;
        }
        all = Answer::select(same, found, all);
    }
    all
}

#[inline(always)]
fn of_material<S: Isa>(
    isa: S,
    scattering: &Scattering,
    (met, eta): (&Met<S>, S::F),
    question: &Question<S::F>,
) -> Answer<S::F> {
    match scattering {
        Scattering::Mix(layers) => of_layers(isa, layers, (met, eta), question),
        single => match single.single(met.spot(), eta) {
            Some(bsdf) => with_lobe!(&bsdf, lobe => ask(isa, lobe, question)),
            None => Answer::black(question.wo),
        },
    }
}

/// The part of what reaches the pixel from which on a path goes on for sure: at 1, as others have it, noise grows more than time
/// shrinks where paths are short; see `benches/record/lights.md`.
const FULL: f32 = 0.25;

/// The least probability with which a path goes on: what survives counts twenty times at most.
const LEAST_SURVIVAL: f32 = 0.05;

/// Ends ways on at random, the less they carry the likelier, and lets the others count for them. How many ended.
///
/// What radiance has grown by on its way through glass is no gain of light: it does not count.
#[inline(always)]
fn roulette<S: Isa, const N: usize>(
    isa: S,
    (around, slots, depth): (&Surroundings<'_>, &Slots, u32),
    (lanes, hit, step): (&State<S>, S::M, &mut Step<S::F>),
    beyond: &Beyond<N>,
    (sampler, vertex): (&impl Sampler<I = S::I>, Vertex),
) -> u64 {
    if around.roulette.is_none_or(|first| depth < first) {
        return 0;
    }
    let mut carried = (lanes.beta * step.weight).max_channel();
    if around.media {
        carried *= radiance_scale(isa, slots, (lanes, step), beyond);
    }
    let survival = (carried * (1.0 / FULL)).clamp(LEAST_SURVIVAL, 1.0);
    let ends = sampler.get_1d(Dim::Roulette, vertex).ge(survival);
    let cut = (step.valid & hit & ends).count() as u64;
    step.valid = step.valid & !ends;
    step.weight *= survival.recip();
    cut
}

/// The squared index of refraction of what each way on goes through: radiance in glass is greater by it, and light that comes out
/// loses it again.
#[inline(always)]
fn radiance_scale<S: Isa, const N: usize>(
    isa: S,
    slots: &Slots,
    (lanes, step): (&State<S>, &Step<S::F>),
    beyond: &Beyond<N>,
) -> S::F {
    let mut names = [0; WIDEST];
    lanes.slot.store(&mut names);
    isa.load(&squared_indices(slots, (&names, step.crosses.bits(), step.valid.bits()), beyond))
}

/// Out of line: scalar work, the same for all instruction sets.
#[inline(never)]
fn squared_indices<const N: usize>(
    slots: &Slots,
    (names, crossing, valid): (&[u32; WIDEST], u32, u32),
    beyond: &Beyond<N>,
) -> [f32; WIDEST] {
    let mut squares = [1.0; WIDEST];
    for (lane, square) in squares.iter_mut().enumerate().take(N) {
        if valid >> lane & 1 == 0 {
            continue;
        }
        let crosses = crossing & beyond.changed;
        let media =
            if crosses >> lane & 1 == 1 { &beyond.media[lane] } else { &slots.media[names[lane] as usize] };
        *square = media.ior() * media.ior();
    }
    squares
}

/// One of the layers is chosen for the way on, each with the probability of its greatest weight.
#[inline(always)]
fn of_layers<S: Isa>(
    isa: S,
    layers: &[Layer],
    (met, eta): (&Met<S>, S::F),
    question: &Question<S::F>,
) -> Answer<S::F> {
    let mut total = 0.0;
    for layer in layers {
        total += share_of(layer);
    }
    let mut all = Answer::black(question.wo);
    let mut at = 0.0;
    for layer in layers {
        let probability = share_of(layer) / total;
        if share_of(layer) <= 0.0 {
            continue;
        }
        let Some(bsdf) = layer.scattering.single(met.spot(), eta) else { continue };
        let chosen = question.choice.ge(at);
        let inverse = 1.0 / probability;
        // What is left of the number is as good as new within the layer.
        let choice = ((question.choice - at) * inverse).clamp(0.0, 1.0 - f32::EPSILON);
        let own = Question { choice, light_pdf: question.light_pdf * inverse, ..*question };
        let Answer { lit, step } = with_lobe!(&bsdf, lobe => ask(isa, lobe, &own));
        let weight = Rgb::splat(eta, layer.weight);
        let step = Step { weight: step.weight * weight.scale(inverse), pdf: step.pdf * probability, ..step };
        all = Answer { lit: all.lit + lit * weight, step: Step::select(chosen, step, all.step) };
        at += probability;
    }
    all
}

/// What of a choice falls to a layer; a black one has no way on.
fn share_of(layer: &Layer) -> f32 {
    if matches!(layer.scattering, Scattering::Black) { 0.0 } else { layer.weight.max_channel() }
}

/// Where the lanes are.
struct Here<'a, S: Isa, const N: usize> {
    scene: &'a Scene,
    packet: &'a Packet<N>,
    lanes: &'a State<S>,
    met: &'a Met<S>,
    shading: &'a Shading<S::F>,
}

impl<S: Isa, const N: usize> Here<'_, S, N> {
    /// The ray of a lane that starts from the smooth surface, above the horizon of the shading normal or `below` it.
    #[inline(always)]
    fn lifted(&self, lane: usize, d: Vec3<S::F>, below: bool) -> Option<Lifted> {
        let (n, d) = (self.shading.frame.z.extract(lane), d.extract(lane));
        lifted_of(self.scene, (self.packet, lane), n.into(), (d.into(), below))
    }
}

#[inline(never)]
fn lifted_of<const N: usize>(
    scene: &Scene,
    (packet, lane): (&Packet<N>, usize),
    n: glam::Vec3,
    way: (glam::Vec3, bool),
) -> Option<Lifted> {
    let it = scene.world.interaction(&packet.ray.get(lane), &hit_of(packet, lane)?);
    lifted(&it, n, way)
}

/// Queues the rays towards lights that would matter.
#[inline(always)]
fn ask_lights<S: Isa, const N: usize>(
    isa: S,
    queues: (&mut Shadows, &mut Guards),
    at: &Here<'_, S, N>,
    (light, question): (&Asked<S>, &Question<S::F>),
    lit: Rgb<S::F>,
) {
    let cos = question.light.z;
    let carried = at.lanes.beta * lit * light.li * (cos / light.pdf);
    let wanted = light.valid & cos.gt(0.0) & at.met.hit;
    let d = Vec3::select(light.infinite, light.wi, light.p - at.met.points.p);
    let end = S::F::select(light.infinite, isa.splat(f32::INFINITY), isa.splat(spawn::SHADOW_REACH));
    queue(queues, at, (&Towards { d, wi: light.wi, end, carried }, wanted));
}

/// Queues rays of the last ways on towards an environment that is the same all around, which is not asked.
#[inline(always)]
fn ask_sky<S: Isa, const N: usize>(
    isa: S,
    queues: (&mut Shadows, &mut Guards),
    at: &Here<'_, S, N>,
    (step, wanted): (&Step<S::F>, S::M),
) {
    let Some((_, environment)) = at.scene.environment_light() else { return };
    let Some(radiance) = environment.constant() else { return };
    let wi = at.shading.to_world(step.wi);
    let carried = at.lanes.beta * step.weight * Rgb::splat(isa.splat(0.0), radiance);
    let end = isa.splat(f32::INFINITY);
    queue(queues, at, (&Towards { d: wi, wi, end, carried }, wanted));
}

/// Rays towards lights above their surfaces.
struct Towards<F> {
    d: Vec3<F>,
    /// The same as a unit vector.
    wi: Vec3<F>,
    end: F,
    carried: Rgb<F>,
}

#[inline(always)]
fn queue<S: Isa, const N: usize>(
    (shadows, guards): (&mut Shadows, &mut Guards),
    at: &Here<'_, S, N>,
    (way, wanted): (&Towards<S::F>, S::M),
) {
    let (points, lanes) = (&at.met.points, at.lanes);
    let Towards { d, wi, end, carried } = *way;
    let wanted = wanted & !carried.is_black();
    if wanted.none() {
        return;
    }
    let straight = wi.dot(at.shading.ng).gt(0.0);
    let o = spawn::origin(points.p, points.p_error, points.ng, d);
    let (to, sent) = (shadows.rays.len, wanted & straight);
    shadows.rays.pack(to, sent, (o, d, lanes.time, lanes.slot));
    shadows.end.store(to, end.compress(sent));
    shadows.light.pack(to, sent, Vec3::new(carried.r, carried.g, carried.b));
    shadows.rays.len += sent.count();
    // The others are below the true surface: they start from the smooth one, or not at all.
    let mut bits = (wanted & !straight).bits();
    while bits != 0 {
        let lane = bits.trailing_zeros() as usize;
        bits &= bits - 1;
        let Some(Lifted { ray, guard }) = at.lifted(lane, wi, false) else { continue };
        let end = end.extract(lane);
        let ray = if end.is_finite() { ray.towards((points.p + d).extract(lane).into()) } else { ray };
        guards.0.push((guard, Guarded::Shadow(shadows.rays.len)));
        shadows.push(&ray, lanes.slot.extract(lane), carried.extract(lane));
    }
}

/// Those that go on.
struct Next<S: Isa> {
    o: Vec3<S::F>,
    d: Vec3<S::F>,
    beta: Rgb<S::F>,
    pdf: S::F,
    goes: S::M,
}

#[inline(always)]
fn go_on<S: Isa, const N: usize>(
    isa: S,
    (guards, to): (&mut Guards, usize),
    at: &Here<'_, S, N>,
    step: Step<S::F>,
) -> Next<S> {
    let points = &at.met.points;
    let d = at.shading.to_world(step.wi);
    let below = d.dot(at.shading.ng).lt(0.0);
    let beta = at.lanes.beta * step.weight;
    let wanted = at.met.hit & step.valid & !beta.is_black();
    let o = spawn::origin(points.p, points.p_error, points.ng, d);
    let wrong = wanted & (below ^ step.crosses);
    if wrong.none() {
        return Next { o, d, beta, pdf: step.pdf, goes: wanted };
    }
    // Where the shading normal leads to the wrong side, the way starts from the smooth surface, or there is none.
    let mut rows = [[0.0; WIDEST]; 3];
    o.x.store(&mut rows[0]);
    o.y.store(&mut rows[1]);
    o.z.store(&mut rows[2]);
    let (mut bits, mut lost) = (wrong.bits(), 0_u32);
    let first = guards.0.len();
    while bits != 0 {
        let lane = bits.trailing_zeros() as usize;
        bits &= bits - 1;
        match at.lifted(lane, d, step.crosses.extract(lane)) {
            None => lost |= 1 << lane,
            Some(Lifted { ray, guard }) => {
                [rows[0][lane], rows[1][lane], rows[2][lane]] = ray.o.to_array();
                guards.0.push((guard, Guarded::Path(lane)));
            }
        }
    }
    // Places are known when it is known who goes.
    let going = wanted.bits() & !lost;
    for (_, guarded) in &mut guards.0[first..] {
        if let Guarded::Path(lane) = guarded {
            *lane = to + (going & ((1 << *lane) - 1)).count_ones() as usize;
        }
    }
    let o = Vec3::new(isa.load(&rows[0]), isa.load(&rows[1]), isa.load(&rows[2]));
    let lanes = isa.per_lane(|lane| if going >> lane & 1 == 1 { 1.0 } else { 0.0 });
    Next { o, d, beta, pdf: step.pdf, goes: lanes.gt(0.0) }
}

impl<S: Isa> Next<S> {
    /// Packs them to `to` and on; how many there are.
    #[inline(always)]
    fn store(self, paths: &mut Paths, to: usize, (lanes, normals): (&State<S>, Option<Vec3<S::F>>)) -> usize {
        if let Some(n) = normals {
            paths.normal.pack(to, self.goes, n);
        }
        paths.rays.pack(to, self.goes, (self.o, self.d, lanes.time, lanes.slot));
        paths.beta.pack(to, self.goes, Vec3::new(self.beta.r, self.beta.g, self.beta.b));
        paths.pdf.store(to, self.pdf.compress(self.goes));
        self.goes.count()
    }
}

/// The media of those that cross a surface.
#[inline(always)]
fn cross<I: IntLanes, const N: usize>(slots: &mut Slots, names: I, crossing: I::Mask, beyond: &Beyond<N>) {
    let mut bits = crossing.bits() & beyond.changed;
    while bits != 0 {
        let lane = bits.trailing_zeros() as usize;
        bits &= bits - 1;
        slots.media[names.extract(lane) as usize] = beyond.media[lane];
    }
}

/// What media leave of light on its way to the surfaces that asked for it, for rays that have not been looked at yet.
#[inline(never)]
fn absorb_shadows(scene: &Scene, shadows: &mut Shadows, slots: &Slots) {
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

impl<A> Stage<'_, A> {
    /// Whether any material is not the same in all directions.
    pub(super) fn turns(&self) -> bool {
        self.scene.materials.iter().any(|material| material.scattering.turn().is_some())
    }
}
