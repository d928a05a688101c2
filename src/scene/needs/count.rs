//! Who asks for what: the one list that building, integrators and backends go by.

use crate::error::Place;
use crate::film::Layout;
use crate::geometry::{PlacementId, Pose, Shape};
use crate::light::Light;
use crate::material::{MaterialId, Scattering};
use crate::scene::description::{GlassShadows, Integrator, Render};
use crate::scene::needs::capability::{Capabilities, Capability};
use crate::scene::needs::lights::ChosenLights;
use crate::scene::{Scene, Wanted};
use glam::DVec3;
use std::collections::BTreeSet;

/// A capability that is asked for.
#[derive(Clone, Debug, PartialEq)]
pub struct Asked {
    /// What.
    pub capability: Capability,
    /// How often.
    pub count: usize,
    /// Who asks first; absent where nobody can be named.
    pub first: Option<Place>,
}

/// Where things of a scene were described.
#[derive(Clone, Copy, Debug)]
pub(in crate::scene) struct Places<'a> {
    /// By placement.
    pub(in crate::scene) placements: &'a [Place],
    /// By light.
    pub(in crate::scene) lights: &'a [Place],
    /// The camera.
    pub(in crate::scene) camera: &'a Place,
}

/// What is asked for of a scene of which so much is wanted, in the order met.
pub(in crate::scene) fn asked(scene: &Scene, wanted: &Wanted, places: Places<'_>) -> Vec<Asked> {
    let mut count = Count { asked: Vec::new(), places };
    count.shapes(scene);
    count.materials(scene);
    count.lights(scene);
    count.add(Capability::RobustTraversal, usize::from(scene.render.robust), None);
    let camera = Some(places.camera);
    count.add(Capability::MovingCamera, usize::from(scene.camera.is_moving()), camera);
    count.add(Capability::Lens, usize::from(scene.camera.has_lens()), camera);
    count.add(Capability::MovedOrigin, usize::from(scene.origin != DVec3::ZERO), camera);
    let plain = Layout::default().aovs().len();
    count.add(Capability::Aovs, wanted.layout.aovs().len().saturating_sub(plain), None);
    count.add(Capability::AdaptiveSampling, usize::from(wanted.adaptive), None);
    count.asked
}

/// What of these can be switched on in pictures that are rendered so.
pub(in crate::scene) fn forceable(these: Capabilities, render: &Render) -> Capabilities {
    these.iter().filter(|it| *it != Capability::GlassShadows || looks_for_glass(render)).collect()
}

/// Whether shadow rays go on through glass where there is some.
fn looks_for_glass(render: &Render) -> bool {
    let asks = render.integrator.is_ray_tree() || render.integrator == Integrator::View;
    asks && render.glass_shadows == GlassShadows::Straight
}

/// The capabilities of a list.
pub(in crate::scene) fn set(asked: &[Asked]) -> Capabilities {
    asked.iter().map(|asked| asked.capability).collect()
}

/// Capabilities as they are met.
struct Count<'a> {
    asked: Vec<Asked>,
    places: Places<'a>,
}

impl Count<'_> {
    fn add(&mut self, capability: Capability, by: usize, first: Option<&Place>) {
        if by == 0 {
            return;
        }
        match self.asked.iter_mut().find(|known| known.capability == capability) {
            Some(known) => known.count += by,
            None => self.asked.push(Asked { capability, count: by, first: first.cloned() }),
        }
    }

    fn shapes(&mut self, scene: &Scene) {
        let mut seen = BTreeSet::new();
        for (placement, origin) in scene.world.placements.iter().zip(self.places.placements) {
            let origin = Some(origin);
            if seen.insert(placement.shape) {
                self.shape(&scene.world.shapes[placement.shape.index()], origin);
                let is_filtered = scene.world.filters.contains_key(&placement.shape);
                self.add(Capability::CutOuts, usize::from(is_filtered), origin);
            }
            match &placement.pose {
                Pose::World => {}
                Pose::Still(_) => self.add(Capability::Instances, 1, origin),
                Pose::Moving(_) => self.add(Capability::MovingPoses, 1, origin),
            }
            self.add(Capability::Masks, usize::from(placement.mask != u32::MAX), origin);
        }
    }

    fn shape(&mut self, shape: &Shape, origin: Option<&Place>) {
        match shape {
            Shape::Mesh(mesh) => {
                self.add(Capability::Triangles, mesh.triangles().len(), origin);
                self.add(Capability::ShadingNormals, usize::from(mesh.has_normals()), origin);
                self.add(Capability::SurfaceParameters, usize::from(mesh.has_uvs()), origin);
                self.add(Capability::MovingVertices, usize::from(mesh.key_count() > 1), origin);
            }
            Shape::Sphere(_) => self.add(Capability::Spheres, 1, origin),
            Shape::Disc(_) => self.add(Capability::Discs, 1, origin),
            Shape::Surface(surface) => {
                self.add(Capability::Surfaces, surface.primitive_count() as usize, origin);
                self.add(Capability::MovingVertices, usize::from(surface.is_moving()), origin);
            }
        }
    }

    /// Materials, each counted once and named by the first shape made of it.
    fn materials(&mut self, scene: &Scene) {
        let looks_for_glass = looks_for_glass(&scene.render);
        for (id, placement) in materials_in_use(scene) {
            let (material, origin) =
                (&scene.materials[id.index()], self.places.placements.get(placement.index()));
            let scattering = &material.scattering;
            let medium = material.medium();
            let absorbs = medium.is_some_and(|medium| !medium.absorption.is_black());
            let found = [
                (Capability::Media, medium.is_some()),
                (Capability::Absorption, absorbs),
                (Capability::Anisotropy, scattering.turn().is_some()),
                (Capability::LobeChoice, scattering.has_choice()),
                (Capability::Mixes, matches!(scattering, Scattering::Mix(_))),
                (Capability::Textures, material.is_textured()),
                (Capability::ImageTextures, material.has_images()),
                (Capability::Reliefs, material.relief.is_some()),
                (Capability::GlassShadows, looks_for_glass && scattering.is_clear()),
            ];
            for (capability, is_asked) in found {
                self.add(capability, usize::from(is_asked), origin);
            }
            for part in scattering.parts() {
                for capability in capabilities(part) {
                    self.add(*capability, 1, origin);
                }
            }
        }
    }

    fn lights(&mut self, scene: &Scene) {
        for (light, origin) in scene.lights.iter().zip(self.places.lights) {
            let capability = match light {
                _ if light.is_delta() => Capability::PointLights,
                Light::Environment(_) => Capability::Environment,
                _ => Capability::AreaLights,
            };
            self.add(capability, 1, Some(origin));
        }
        let emitters = ChosenLights::of(scene).emitters;
        if scene.render.integrator == Integrator::Path && emitters > 1 {
            // The first is not chosen, but only beside a second one.
            let first = self.places.lights.get(1).or(self.places.lights.first());
            self.add(Capability::LightChoice, emitters, first);
        }
    }
}

/// What a surface asks for.
const fn capabilities(scattering: &Scattering) -> &'static [Capability] {
    match scattering {
        Scattering::Mirror { .. } | Scattering::Glazed { .. } => &[Capability::Mirrors],
        Scattering::Conductor { facets: None, .. } => &[Capability::Mirrors],
        Scattering::Dielectric { facets: None, .. } | Scattering::ThinDielectric(_) => {
            &[Capability::Refraction]
        }
        Scattering::Dielectric { .. } => &[Capability::Refraction, Capability::GlossyLobes],
        Scattering::Schlick(_) => &[Capability::Mirrors, Capability::GlossyLobes],
        Scattering::Conductor { .. }
        | Scattering::Glossy { .. }
        | Scattering::Phong { .. }
        | Scattering::Jitter { .. } => &[Capability::GlossyLobes],
        Scattering::Diffuse { .. }
        | Scattering::OrenNayar { .. }
        | Scattering::Black
        | Scattering::Mix(_) => &[],
    }
}

/// Materials that something is made of, each with the first placement of it.
pub(in crate::scene) fn materials_in_use(scene: &Scene) -> impl Iterator<Item = (MaterialId, PlacementId)> {
    let mut seen = BTreeSet::new();
    let all = (0..).map(PlacementId).zip(&scene.surfaces);
    let all = all.flat_map(|(placement, surface)| surface.materials.iter().map(move |id| (*id, placement)));
    all.filter(move |(id, _)| seen.insert(*id))
}
