//! The frozen scene: what rendering reads.

use crate::camera::Camera;
use crate::film::Names;
use crate::geometry::{Interaction, PlacementId, World};
use crate::light::{Environment, Light, LightId};
use crate::material::{Material, MaterialId};
use crate::math::Rgb;
use crate::scene::description::{Film, FuzzyBy, Render};
use crate::scene::needs::Asked;
use crate::scene::needs::capability::{Capabilities, Capability};
use crate::texture::Bitmap;
use glam::DVec3;
use std::sync::Arc;

/// A scene without file names: immutable, shared by all threads.
#[derive(Debug)]
pub struct Scene {
    /// What can be hit.
    pub world: Arc<World>,
    /// The materials, named by [`MaterialId`].
    pub materials: Vec<Material>,
    /// The pictures that surfaces show, each once.
    pub textures: Vec<Arc<Bitmap>>,
    /// The lights, named by [`LightId`]; every one can shine.
    pub lights: Vec<Light>,
    /// Where pictures are taken from.
    pub camera: Camera,
    /// What was taken from all coordinates of the scene's files, in metres: zero unless the camera is far from the origin.
    pub origin: DVec3,
    /// The picture.
    pub film: Film,
    /// How light is followed.
    pub render: Render,
    /// What placements and materials are called: by their own names, by the names in their files, or by their numbers.
    pub names: Names,
    /// What the scene asks for, of whatever was forced.
    pub(super) asked: Vec<Asked>,
    /// The same as a set.
    pub(super) required: Capabilities,
    /// What is switched on although nobody asks.
    pub(super) forced: Capabilities,
    pub(super) surfaces: Vec<Surface>,
    pub(super) environment: Option<LightId>,
}

/// What a placement is made of.
#[derive(Clone, Debug)]
pub(super) struct Surface {
    /// A material per group of the shape.
    pub(super) materials: Vec<MaterialId>,
    /// The light that it is.
    pub(super) light: Option<LightId>,
}

impl Scene {
    /// What a point is made of.
    #[must_use]
    pub fn material(&self, it: &Interaction) -> (MaterialId, &Material) {
        let id = self.surfaces[it.placement.index()].materials[usize::from(it.group)];
        (id, &self.materials[id.index()])
    }

    /// What a primitive is made of.
    #[must_use]
    pub fn material_of(&self, placement: PlacementId, prim: u32) -> MaterialId {
        self.only_material_of(placement).unwrap_or_else(|| {
            let group = self.world.shape_of(placement).group(prim);
            self.surfaces[placement.index()].materials[usize::from(group)]
        })
    }

    /// What all primitives of a placement are made of, where it is the same.
    #[must_use]
    pub fn only_material_of(&self, placement: PlacementId) -> Option<MaterialId> {
        if let [only] = self.surfaces[placement.index()].materials[..] { Some(only) } else { None }
    }

    /// The light that a placement is.
    #[must_use]
    pub fn light_of(&self, placement: PlacementId) -> Option<&Light> {
        self.light_id_of(placement).map(|id| &self.lights[id.index()])
    }

    /// Which light a placement is.
    #[must_use]
    pub fn light_id_of(&self, placement: PlacementId) -> Option<LightId> {
        self.surfaces[placement.index()].light
    }

    /// Beer's law: what is left of light after `length` metres of a medium.
    #[must_use]
    pub fn absorbed(&self, medium: Option<MaterialId>, length: f32) -> Rgb<f32> {
        let Some(medium) = medium.and_then(|id| self.materials[id.index()].medium()) else {
            return Rgb::WHITE;
        };
        let pass = |sigma: f32| if sigma > 0.0 { (-sigma * length).exp() } else { 1.0 };
        let Rgb { r, g, b } = medium.absorption;
        Rgb::new(pass(r), pass(g), pass(b))
    }

    /// The environment with its number among the lights, if there is one.
    #[must_use]
    pub fn environment_light(&self) -> Option<(LightId, &Environment)> {
        let id = self.environment?;
        if let Light::Environment(environment) = &self.lights[id.index()] {
            Some((id, environment))
        } else {
            None
        }
    }

    /// Whether a capability is there, because something of the scene asks for it or because it was forced. What building left
    /// out is not there whoever asks later.
    #[inline]
    #[must_use]
    pub fn uses(&self, capability: Capability) -> bool {
        self.requires(capability) || self.forces(capability)
    }

    /// Whether something of the scene asks for a capability.
    #[inline]
    #[must_use]
    pub fn requires(&self, capability: Capability) -> bool {
        match capability {
            // A setting that may change when all is built.
            Capability::TwoPass => self.render.glossy == FuzzyBy::TwoPass,
            _ => self.required.has(capability),
        }
    }

    /// Whether a capability was switched on whether the scene asks for it or not.
    #[inline]
    #[must_use]
    pub fn forces(&self, capability: Capability) -> bool {
        self.forced.has(capability)
    }

    /// What the scene asks for, how often, and who first; but for what is a setting, for which see [`Scene::requires`].
    #[must_use]
    pub fn asked(&self) -> &[Asked] {
        &self.asked
    }

    /// Whether anything moves while the shutter is open, the camera included.
    #[must_use]
    pub fn is_moving(&self) -> bool {
        use Capability::{MovingCamera, MovingPoses, MovingVertices};
        [MovingCamera, MovingPoses, MovingVertices].into_iter().any(|it| self.uses(it))
    }

    /// Whether any surface shows a picture.
    #[must_use]
    pub fn has_images(&self) -> bool {
        self.uses(Capability::ImageTextures)
    }

    /// Bytes of memory that pictures on surfaces take.
    #[must_use]
    pub fn texture_bytes(&self) -> usize {
        self.textures.iter().map(|bitmap| bitmap.bytes()).sum()
    }

    /// Whether any surface bounds a transparent medium.
    #[must_use]
    pub fn has_media(&self) -> bool {
        self.uses(Capability::Media) || self.uses(Capability::Absorption)
    }
}
