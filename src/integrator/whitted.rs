//! The ray tree.
//!
//! Whitted 1980 (An Improved Illumination Model for Shaded Display), with exact Fresnel terms, glossy lobes and area lights. At
//! every surface: emission, direct light, and a branch per specular or glossy way on; at the first ones several shadow rays
//! and glossy branches, which share what is carried (distribution ray tracing). A branch is cut where the path is
//! long enough (`max_depth`) or where it would carry too little (`min_throughput`); both only darken. Diffuse light between
//! surfaces is not followed: that is the path tracer's. A rough interface sends one ray on each of its sides, by the same
//! facet.
//!
//! ```text
//! push the camera ray
//! while there is a branch:
//!     find what it hits, through surfaces that overlapping media hide; absorb along the way
//!     add emission, or the environment on a miss
//!     stop where the path is long enough
//!     add direct light
//!     push reflected, refracted and glossy branches that carry enough
//! ```

use crate::accel::Accel;
use crate::bsdf::{Branch, BsdfSample, Lobes, Mix, Part, mirrored};
use crate::geometry::{Hit, Interaction, Ray};
use crate::integrator::cone::Cone;
use crate::integrator::direct::{self, Receiver};
use crate::integrator::shading::Shading;
use crate::integrator::splitting::Counts;
use crate::integrator::{
    CameraRay, Counters, Integrator, Radiance, Splitting, Stage, Worker, relief, tangent,
};
use crate::light::Reference;
use crate::material::{Crossing, MOST_HIDDEN, Media};
use crate::math::Rgb;
use crate::sampling::{Dim, Sampler, Vertex, heuristic};
use crate::scene::needs::capability::Capability;
use crate::texture::Spot;
use glam::Vec3;

/// Follows the ray tree depth first.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Whitted {
    /// Longest path in edges: 1 sees emission only, 2 adds direct light and one mirror.
    pub max_depth: u32,
    /// Branches that would carry less than this part of what reaches the pixel are not followed.
    pub min_throughput: f32,
    /// Where several rays are sent instead of one.
    pub splitting: Splitting,
    /// Whether glossy lobes that are round about the mirrored ray are followed as if they were mirrors, and lights with a size not asked for
    /// them: the mirrors see these.
    pub polished: bool,
}

/// A branch to be followed.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Node {
    pub(super) ray: Ray,
    /// What the ray hits, where that has been found already.
    pub(super) found: Option<Option<Hit>>,
    /// Where the ray truly starts: its origin is moved off the surface.
    start: Vec3,
    /// What radiance along the ray is multiplied by on its way to the camera.
    pub(super) beta: Rgb<f32>,
    /// The part of `beta` that is a change of medium or a share of a split, not a loss.
    radiance_scale: f32,
    /// Edges of the path, this one included.
    depth: u32,
    vertex: Vertex,
    media: Media,
    drawn: Option<Drawn>,
    /// About the ray, where any surface shows a picture.
    cone: Cone<f32>,
}

impl Node {
    /// The branch that a camera ray is, in what the camera stands in.
    pub(super) fn of_camera<A>(stage: &Stage<'_, A>, camera: &CameraRay) -> Self {
        let CameraRay { ray, found } = *camera;
        Self {
            ray,
            found,
            start: ray.o,
            beta: Rgb::WHITE,
            radiance_scale: 1.0,
            depth: 1,
            vertex: Vertex::ROOT,
            media: stage.eye_media,
            drawn: None,
            cone: stage.beam.map_or(Cone::NONE, |beam| beam.start(0.0)),
        }
    }

    /// Where pictures on the surface are looked up.
    pub(super) fn spot<A>(&self, stage: &Stage<'_, A>, it: &Interaction) -> Spot<f32> {
        match stage.beam {
            Some(_) => self.cone.spot(stage.scene, it, it.p.distance(self.start)),
            None => it.uv.to_array().into(),
        }
    }

    /// Goes on from a polished surface along `d`, on the same side or through it.
    pub(super) fn pass<A>(&mut self, stage: &Stage<'_, A>, at: &Arrival, (d, through): (Vec3, bool)) {
        if let Some(beam) = stage.beam {
            self.cone = beam.scattered(self.cone, at.it.p.distance(self.start), 0.0);
        }
        self.ray = at.it.spawn(d);
        self.found = None;
        self.start = at.it.p;
        if through {
            self.media = at.beyond;
        }
    }
}

/// How a glossy branch was drawn; what it meets by chance is shared with asking lights.
#[derive(Clone, Copy, Debug)]
struct Drawn {
    from: Reference<f32>,
    pdf: f32,
    /// How many such branches and how many questions to each light there were.
    counts: Counts,
}

impl Drawn {
    /// The part that is this branch's of light that asking finds with density `asked`.
    fn share(&self, asked: f32) -> f32 {
        heuristic::power(self.pdf * self.counts.glossy_factor(), asked * self.counts.light_factor())
    }
}

/// What is beyond saving however small `min_throughput` is.
const NOTHING: f32 = 1e-30;

const REFLECTED: u32 = 0;
const REFRACTED: u32 = 1;
const GLOSSY: u32 = 2;
const GLOSSY_THROUGH: u32 = 3;

/// Ways on from each part of a mix.
const WAYS: u32 = 4;

/// Stands in place of a part for the numbers that all parts but the first draw.
const NUMBERS: u32 = 4;

impl Integrator for Whitted {
    fn li<A: Accel, S: Sampler<I = u32>>(
        &self,
        stage: &Stage<'_, A>,
        camera: &CameraRay,
        sampler: &S,
        worker: &mut Worker,
    ) -> Radiance {
        worker.counters.camera += 1;
        let mut result = Radiance::NOTHING;
        worker.pending.push(Node::of_camera(stage, camera));
        self.finish(stage, sampler, worker, &mut result);
        result
    }
}

/// A surface that scatters, as a branch met it.
pub(super) struct Met {
    pub(super) it: Interaction,
    pub(super) shading: Shading<f32>,
    pub(super) mix: Mix<f32>,
    eta: f32,
    beyond: Media,
    counts: Counts,
    /// Of the ray that came.
    length: f32,
}

impl Whitted {
    /// Follows all branches that are pending, and those that go on from them.
    pub(super) fn finish<A: Accel, S: Sampler<I = u32>>(
        &self,
        stage: &Stage<'_, A>,
        sampler: &S,
        worker: &mut Worker,
        sum: &mut Radiance,
    ) {
        while let Some(mut node) = worker.pending.pop() {
            let Some(met) = self.meet(stage, &mut node, sampler, worker, sum) else { continue };
            for (index, part) in (0..).zip(met.mix.parts()) {
                self.push(&met.at(stage, &node), (index, part), sampler, worker);
            }
        }
    }

    /// Adds what one branch brings; the surface that it met, if branches may go on from there.
    pub(super) fn meet<A: Accel, S: Sampler<I = u32>>(
        &self,
        stage: &Stage<'_, A>,
        node: &mut Node,
        sampler: &S,
        worker: &mut Worker,
        sum: &mut Radiance,
    ) -> Option<Met> {
        let scene = stage.scene;
        let Some(arrival) = arrive(stage, node, worker) else {
            sum.add(node.beta * environment(stage, node), node.depth);
            return None;
        };
        if node.vertex == Vertex::ROOT {
            sum.alpha = 1.0;
        }
        let Arrival { mut it, eta, beyond } = arrival;
        let (_, material) = scene.material(&it);
        let length = it.p.distance(node.start);
        let spot = node.spot(stage, &it);
        let emitted = material.emitted(it.is_front(), spot);
        if emitted != Rgb::BLACK {
            sum.add(node.beta * emitted.scale(share_of_emission(stage, node, &it)), node.depth);
        }
        if let Some(ns) = relief::normal(scene, &it, material, spot) {
            it.ns = ns;
        }
        let mix = material.bsdf(spot, eta)?;
        let shading = Shading::at(&it, tangent(scene, &it, material));
        let media = [node.media, beyond];
        let counts = self.splitting.at(node.depth);
        let receiver = Receiver { it: &it, shading, mix: &mix, media, counts, polished: self.polished };
        if node.depth < self.max_depth {
            if let Some(deferred) = &mut worker.deferred {
                deferred.edges(node.depth + 1);
            }
            let light = direct::light(stage, &receiver, (sampler, node.vertex), node.beta, worker);
            sum.add(node.beta * light, node.depth + 1);
        }
        Some(Met { it, shading, mix, eta, beyond, counts, length })
    }

    /// Pushes the branches that go on from a part of a surface.
    pub(super) fn push<A: Accel, S: Sampler<I = u32>>(
        &self,
        at: &At<'_, A>,
        (index, part): (u32, &Part<f32>),
        sampler: &S,
        worker: &mut Worker,
    ) {
        let lobes = part.bsdf.lobes();
        if lobes.intersects(Lobes::SPECULAR) {
            self.push_specular(at, part, index, worker);
        }
        if !lobes.intersects(Lobes::GLOSSY.and(Lobes::THROUGH)) {
            return;
        }
        if !(self.polished && part.bsdf.is_fuzzy_mirror()) {
            self.push_glossy(at, (index, part), sampler, worker);
        } else if let Some(child) = at.mirror_child((index, part), &mut worker.counters)
            && self.pend(child, worker)
        {
            worker.counters.reflected += 1;
        }
    }

    /// The lighter branch is pushed last and followed first, so that few are pending.
    fn push_specular<A: Accel>(&self, at: &At<'_, A>, part: &Part<f32>, index: u32, worker: &mut Worker) {
        let mut branches = part.bsdf.branches(at.shading.wo);
        let heavy = |branch: &Option<Branch<f32>>| branch.map_or(0.0, |b| b.weight.max_channel());
        if heavy(&branches[1]) > heavy(&branches[0]) {
            branches.swap(0, 1);
        }
        for branch in branches.into_iter().flatten().filter(|branch| branch.valid) {
            let d: Vec3 = at.shading.to_world(branch.wi).into();
            let Some(ray) = at.shading.spawn(at.stage, at.it, (d, branch.transmission), &mut worker.counters)
            else {
                continue;
            };
            let radiance_scale = at.node.radiance_scale * branch.radiance_scale;
            let child = Node {
                ray,
                found: None,
                start: at.it.p,
                beta: at.node.beta * part.weight * branch.weight.scale(branch.radiance_scale),
                radiance_scale,
                depth: at.node.depth + 1,
                vertex: at.child(index, if branch.transmission { REFRACTED } else { REFLECTED }),
                media: if branch.transmission { at.beyond } else { at.node.media },
                drawn: None,
                cone: at.cone(0.0),
            };
            if self.pend(child, worker) {
                let kind = if branch.transmission {
                    &mut worker.counters.refracted
                } else {
                    &mut worker.counters.reflected
                };
                *kind += 1;
            }
        }
    }

    fn push_glossy<A: Accel, S: Sampler<I = u32>>(
        &self,
        at: &At<'_, A>,
        (index, part): (u32, &Part<f32>),
        sampler: &S,
        worker: &mut Worker,
    ) {
        // Each part has numbers of its own; those of the first do not depend on there being others.
        let vertex = if index == 0 { at.node.vertex } else { at.child(NUMBERS, index) };
        let count = at.counts.glossy;
        for j in 0..count {
            let u2 = sampler.get_2d_split(Dim::LobeDirection, vertex, j, count);
            let samples = part.bsdf.sample_glossy(at.shading.wo, u2);
            for (way, sample) in [GLOSSY, GLOSSY_THROUGH].into_iter().zip(samples) {
                let Some(child) = at.glossy_child((index, part), (way, j), sample, &mut worker.counters)
                else {
                    continue;
                };
                if self.pend(child, worker) {
                    worker.counters.glossy += 1;
                }
            }
        }
    }

    /// Whether the branch is followed; if not, why is counted.
    pub(super) fn pend(&self, child: Node, worker: &mut Worker) -> bool {
        if child.depth > self.max_depth {
            worker.counters.cut_by_depth += 1;
            return false;
        }
        let carried = child.beta.max_channel() / child.radiance_scale;
        if carried < self.min_throughput.max(NOTHING) {
            worker.counters.cut_by_attenuation += 1;
            return false;
        }
        worker.pending.push(child);
        true
    }
}

/// Node `j` of `count` that a node is split into; itself where it is not split.
fn nth(vertex: Vertex, j: u32, count: u32) -> Vertex {
    if count == 1 { vertex } else { vertex.child(j) }
}

impl Met {
    /// Where branches leave from.
    pub(super) fn at<'a, A: Accel>(&'a self, stage: &'a Stage<'a, A>, node: &'a Node) -> At<'a, A> {
        let &Self { ref it, shading, eta, beyond, counts, length, .. } = self;
        At { stage, node, it, shading, eta, beyond, counts, length }
    }
}

/// Where branches leave from.
pub(super) struct At<'a, A> {
    stage: &'a Stage<'a, A>,
    node: &'a Node,
    it: &'a Interaction,
    shading: Shading<f32>,
    /// Index of refraction behind the surface over that before it.
    eta: f32,
    /// The media behind the surface.
    beyond: Media,
    /// How many rays are sent from here.
    counts: Counts,
    /// Of the ray that came.
    length: f32,
}

impl<A: Accel> At<'_, A> {
    /// The node at the end of a way on from the part `index` of a mix.
    fn child(&self, index: u32, way: u32) -> Vertex {
        self.node.vertex.child(index * WAYS + way)
    }

    /// The cone about a way on that was drawn with this density.
    fn cone(&self, pdf: f32) -> Cone<f32> {
        self.stage.beam.map_or(Cone::NONE, |beam| beam.scattered(self.node.cone, self.length, pdf))
    }

    /// The branch that the glossy reflection of a part would be if it were a mirror; `None` where there is no such lobe.
    pub(super) fn mirror_child(
        &self,
        (index, part): (u32, &Part<f32>),
        counters: &mut Counters,
    ) -> Option<Node> {
        let wo = self.shading.wo;
        let weight = part.bsdf.lobe_of_mirror(wo)?.weight;
        let d: Vec3 = self.shading.to_world(mirrored(wo)).into();
        let ray = self.shading.spawn(self.stage, self.it, (d, false), counters)?;
        Some(Node {
            ray,
            found: None,
            start: self.it.p,
            beta: self.node.beta * part.weight * weight,
            radiance_scale: self.node.radiance_scale,
            depth: self.node.depth + 1,
            vertex: self.child(index, GLOSSY),
            media: self.node.media,
            drawn: None,
            cone: self.cone(0.0),
        })
    }

    /// The branch along sample `j` of a part's glossy lobe, on either side; `None` where there is no way on.
    fn glossy_child(
        &self,
        (index, part): (u32, &Part<f32>),
        (way, j): (u32, u32),
        sample: Option<BsdfSample<f32>>,
        counters: &mut Counters,
    ) -> Option<Node> {
        let BsdfSample { weight, pdf, wi, .. } = sample.filter(|sample| sample.valid)?;
        let through = way == GLOSSY_THROUGH;
        let d: Vec3 = self.shading.to_world(wi).into();
        let ray = self.shading.spawn(self.stage, self.it, (d, through), counters)?;
        // Already in the weight: radiance grows with the square of the index.
        let grown = if through { (self.eta * self.eta).recip() } else { 1.0 };
        let counts = self.counts;
        let share = counts.glossy_factor().max(1.0).recip();
        Some(Node {
            ray,
            found: None,
            start: self.it.p,
            beta: self.node.beta * part.weight * weight.scale(share),
            radiance_scale: self.node.radiance_scale * grown * share,
            depth: self.node.depth + 1,
            vertex: nth(self.child(index, way), j, counts.glossy),
            media: if through { self.beyond } else { self.node.media },
            drawn: Some(Drawn { from: direct::reference((self.it, self.shading), through), pdf, counts }),
            cone: self.cone(pdf),
        })
    }
}

/// The surface that a branch ends at.
pub(super) struct Arrival {
    pub(super) it: Interaction,
    /// Index of refraction behind the surface over that before it.
    pub(super) eta: f32,
    beyond: Media,
}

/// Finds the surface that `node` meets, `None` if it escapes; what the way absorbs goes into `node.beta`, and media whose
/// surfaces were passed unseen into `node.media`.
pub(super) fn arrive<A: Accel>(
    stage: &Stage<'_, A>,
    node: &mut Node,
    worker: &mut Worker,
) -> Option<Arrival> {
    for _ in 0..MOST_HIDDEN {
        let Some(hit) = node.found.take().unwrap_or_else(|| stage.accel.intersect(&node.ray)) else {
            absorb(stage, node, None);
            return None;
        };
        let it = stage.scene.world.interaction(&node.ray, &hit);
        absorb(stage, node, Some(it.p));
        let (id, material) = stage.scene.material(&it);
        let Some(medium) = material.medium() else {
            return Some(Arrival { it, eta: 1.0, beyond: node.media });
        };
        match node.media.cross((id, medium), it.is_front(), material.is_interface()) {
            Crossing::Interface { eta, beyond } => return Some(Arrival { it, eta, beyond }),
            Crossing::Hidden { beyond } => {
                node.media = beyond;
                node.cone.width = node.cone.width_at(it.p.distance(node.start));
                node.ray = it.spawn(node.ray.d);
                node.start = it.p;
                // Shadow rays give such surfaces no pass, so that nothing is left to share.
                node.drawn = None;
                worker.counters.hidden += 1;
            }
        }
    }
    node.beta = Rgb::BLACK;
    None
}

/// What the medium that the branch is in leaves of light on its way to a point, or out of the scene.
fn absorb<A: Accel>(stage: &Stage<'_, A>, node: &mut Node, to: Option<Vec3>) {
    if stage.scene.uses(Capability::Absorption) {
        let length = to.map_or(f32::INFINITY, |p| p.distance(node.start));
        node.beta *= stage.scene.absorbed(node.media.current(), length);
    }
}

fn environment<A: Accel>(stage: &Stage<'_, A>, node: &Node) -> Rgb<f32> {
    let Some((id, environment)) = stage.scene.environment_light() else { return Rgb::BLACK };
    let radiance = environment.radiance(node.ray.d);
    let Some(drawn) = node.drawn.filter(|_| environment.constant().is_none()) else { return radiance };
    let light = &stage.scene.lights[id.index()];
    let asked = direct::light_pdf(light, drawn.from, node.ray.d.into(), None);
    radiance.scale(drawn.share(asked))
}

/// The part of a surface's emission that is this branch's, the rest being found by asking lights.
fn share_of_emission<A: Accel>(stage: &Stage<'_, A>, node: &Node, it: &Interaction) -> f32 {
    let Some(drawn) = node.drawn else { return 1.0 };
    let Some(light) = stage.scene.light_of(it.placement) else { return 1.0 };
    drawn.share(direct::light_pdf(light, drawn.from, node.ray.d.into(), Some(it)))
}
