//! What happens where the paths of a chunk meet surfaces: one pass over all lanes.

use super::asking::{absorb_shadows, ask_lights, ask_sky, asked};
use super::lights::Lights;
use super::met::Met;
use super::roulette::roulette;
use super::scattering::scatter;
use super::surfaces::Surfaces;
use super::wave::{Guarded, Guards, Paths, Slots, Wave};
use crate::accel::{Coherence, Packet};
use crate::bsdf::choice::{Question, Step};
use crate::geometry::{Interaction, PlacementId, spawn};
use crate::integrator::cone::{Beam, Cone};
use crate::integrator::shading::{Lifted, Shading, lifted};
use crate::integrator::{Counters, relief};
use crate::light::{Arriving, Emitter, Environment, Reference};
use crate::material::{Material, Media};
use crate::math::lanes::{Bits, Compare, IntLanes, Isa, Kernel, Lanes, MaskLanes, Select, WIDEST};
use crate::math::{Rgb, Vec3};
use crate::sampling::{AnySampler, Dim, Sampler, SamplerKind, Vertex, heuristic};
use crate::scene::Scene;
use crate::texture::Spot;

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
    /// Paths that go on from what a camera ray meets first.
    pub(super) ways: u32,
    /// Whether direct light is told apart.
    pub(super) splits: bool,
    /// Where surfaces show pictures: what the widths of rays follow from.
    pub(super) beam: Option<Beam>,
}

impl Surroundings<'_> {
    /// The numbers of paths.
    #[inline(always)]
    fn numbers<S: Isa>(&self, isa: S, slots: &Slots, names: S::I) -> AnySampler<S::I> {
        let pixel = [slots.pixel_of(isa, 0, names), slots.pixel_of(isa, 1, names)];
        self.sampler.start(self.seed, pixel, isa.gather_u32(slots.index.all(), names))
    }

    /// How many paths of a sample part where their edges of this number end.
    fn ways_from(&self, depth: u32) -> u32 {
        if depth == 1 { self.ways } else { 1 }
    }

    /// Whether asking lights has all that the ways on from here would find: they are the last ones, and nothing keeps rays towards
    /// lights from where paths get to, as surfaces hidden by media do.
    fn asks_for_all(&self, depth: u32) -> bool {
        depth + 1 == self.max_depth && !self.surfaces.hides && !self.lights.are_left_to_lobes()
    }
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
        let Wave { paths, shadows, guards, slots, .. } = wave;
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
        let tangent = tangents(isa, around, packet, &met);
        let shading = Shading::seen(wo, normals, tangent);
        let (sampler, ways) = (around.numbers(isa, slots, lanes.slot), around.ways_from(depth));
        let light = asked(isa, around, (&met, &shading), (&sampler, vertex));
        let light = light.for_all(isa, lanes.slot, ways);
        let choice =
            if around.surfaces.choices { sampler.get_1d(Dim::LobeChoice, vertex) } else { isa.splat(0.0) };
        let question = Question {
            wo: shading.wo,
            light: shading.frame.to_local(light.wi),
            light_pdf: light.shared_pdf,
            choice,
            direction: sampler.get_2d(Dim::LobeDirection, vertex),
            last: around.asks_for_all(depth),
        };
        let mut found = scatter(isa, (around.scene, around.surfaces), &met, beyond, &question);
        let own = (&lanes, &mut found.step);
        counters.cut_by_roulette += roulette(isa, (around, slots, depth), own, beyond, (&sampler, vertex));
        let at = Here { scene: around.scene, packet, lanes: &lanes, met: &met, shading: &shading };
        ask_lights(isa, (shadows, guards), &at, (&light, &question), found.lit);
        if around.surfaces.absorbs {
            absorb_shadows(around.scene, shadows, slots);
        }
        if question.last {
            let unshared = found.step.valid & found.step.pdf.lt(0.0);
            found.step.valid = found.step.valid & !unshared;
            ask_sky(isa, (shadows, guards), &at, (&found.step, unshared));
        }
        let next = go_on(isa, (guards, to), &at, found.step);
        counters.bounced += next.goes.count() as u64;
        if around.surfaces.media {
            cross(slots, lanes.slot, next.goes & found.step.crosses, beyond);
        }
        if let (Some(beam), Some((cone, length))) = (around.beam, cone) {
            paths.widen(to, next.goes, beam.scattered(cone, length, next.pdf));
        }
        let normals = if around.lights.uses_normals() { Some(shading.frame.z) } else { None };
        next.store(paths, to, (&lanes, normals), ways)
    }
}

/// The lanes' paths.
pub(super) struct State<S: Isa> {
    o: Vec3<S::F>,
    d: Vec3<S::F>,
    pub(super) time: S::F,
    pub(super) beta: Rgb<S::F>,
    pdf: S::F,
    pub(super) slot: S::I,
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
    let mut rows = [[0.0; WIDEST]; 3];
    for lane in Bits(shining.bits()) {
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

/// First tangents of surfaces that are not the same in all directions, zero for the others; `None` where the scene has none.
#[inline(always)]
fn tangents<S: Isa, const N: usize>(
    isa: S,
    around: &Surroundings<'_>,
    packet: &Packet<N>,
    met: &Met<S>,
) -> Option<Vec3<S::F>> {
    if !around.surfaces.turns {
        return None;
    }
    let scene = around.scene;
    let mut rows = [[0.0; WIDEST]; 3];
    for lane in Bits(met.hit.bits()) {
        let material = &scene.materials[met.materials.extract(lane) as usize];
        let ns = around.surfaces.reliefs.then(|| met.points.ns.extract(lane).into());
        if let Some(tangent) = tangent_of(scene, (packet, lane), material, ns) {
            [rows[0][lane], rows[1][lane], rows[2][lane]] = tangent.to_array();
        }
    }
    Some(Vec3::load(isa, &rows))
}

/// Shading normals, those of surfaces with a relief turned as it says: one by one, as tangents.
#[inline(always)]
fn relieved<S: Isa, const N: usize>(isa: S, scene: &Scene, packet: &Packet<N>, met: &Met<S>) -> Vec3<S::F> {
    let ns = met.points.ns;
    let mut rows = [[0.0; WIDEST]; 3];
    ns.store(&mut rows);
    for lane in Bits(met.hit.bits()) {
        let material = &scene.materials[met.materials.extract(lane) as usize];
        if material.relief.is_none() {
            continue;
        }
        if let Some(ns) = relief_of(scene, (packet, lane), material, met.footprint.extract(lane)) {
            [rows[0][lane], rows[1][lane], rows[2][lane]] = ns.to_array();
        }
    }
    Vec3::load(isa, &rows)
}

#[inline(never)]
fn relief_of<const N: usize>(
    scene: &Scene,
    (packet, lane): (&Packet<N>, usize),
    material: &Material,
    footprint: f32,
) -> Option<glam::Vec3> {
    let it = scene.world.interaction(&packet.ray.get(lane), &packet.get_hit(lane)?);
    relief::normal(scene, &it, material, Spot { uv: it.uv.into(), footprint })
}

#[inline(never)]
fn tangent_of<const N: usize>(
    scene: &Scene,
    (packet, lane): (&Packet<N>, usize),
    material: &Material,
    relieved: Option<glam::Vec3>,
) -> Option<glam::Vec3> {
    material.scattering.turn()?;
    let it = scene.world.interaction(&packet.ray.get(lane), &packet.get_hit(lane)?);
    let ns = relieved.unwrap_or(it.ns);
    crate::integrator::tangent(scene, &Interaction { ns, ..it }, material)
}

/// Where the lanes are.
pub(super) struct Here<'a, S: Isa, const N: usize> {
    pub(super) scene: &'a Scene,
    packet: &'a Packet<N>,
    pub(super) lanes: &'a State<S>,
    pub(super) met: &'a Met<S>,
    pub(super) shading: &'a Shading<S::F>,
}

impl<S: Isa, const N: usize> Here<'_, S, N> {
    /// The ray of a lane that starts from the smooth surface, above the horizon of the shading normal or `below` it.
    #[inline(always)]
    pub(super) fn lifted(&self, lane: usize, d: Vec3<S::F>, below: bool) -> Option<Lifted> {
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
    let it = scene.world.interaction(&packet.ray.get(lane), &packet.get_hit(lane)?);
    lifted(&it, n, way)
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
    let wanted = step.valid & !beta.is_black();
    let o = spawn::origin(points.p, points.p_error, points.ng, d);
    let wrong = wanted & (below ^ step.crosses);
    if wrong.none() {
        return Next { o, d, beta, pdf: step.pdf, goes: wanted };
    }
    // Where the shading normal leads to the wrong side, the way starts from the smooth surface, or there is none.
    let mut rows = [[0.0; WIDEST]; 3];
    o.store(&mut rows);
    let mut lost = 0_u32;
    let first = guards.0.len();
    for lane in Bits(wrong.bits()) {
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
    let o = Vec3::load(isa, &rows);
    let lanes = isa.per_lane(|lane| if going >> lane & 1 == 1 { 1.0 } else { 0.0 });
    Next { o, d, beta, pdf: step.pdf, goes: lanes.gt(0.0) }
}

impl<S: Isa> Next<S> {
    /// Packs them to `to` and on; how many there are.
    #[inline(always)]
    fn store(
        self,
        paths: &mut Paths,
        to: usize,
        (lanes, normals): (&State<S>, Option<Vec3<S::F>>),
        ways: u32,
    ) -> usize {
        if let Some(n) = normals {
            paths.normal.pack(to, self.goes, n);
        }
        paths.rays.pack(to, self.goes, (self.o, self.d, lanes.time, lanes.slot));
        paths.beta.pack(to, self.goes, Vec3::new(self.beta.r, self.beta.g, self.beta.b));
        // Light that is asked for once is found by any of these ways.
        paths.pdf.store(to, (self.pdf * ways as f32).compress(self.goes));
        self.goes.count()
    }
}

/// The media of those that cross a surface.
#[inline(always)]
fn cross<I: IntLanes, const N: usize>(slots: &mut Slots, names: I, crossing: I::Mask, beyond: &Beyond<N>) {
    for lane in Bits(crossing.bits() & beyond.changed) {
        slots.media[names.extract(lane) as usize] = beyond.media[lane];
    }
}
