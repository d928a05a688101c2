//! The frozen scene: what rendering reads.

use crate::camera::Camera;
use crate::geometry::{Interaction, PlacementId, World};
use crate::light::{Environment, Light, LightId};
use crate::material::{Material, MaterialId};
use crate::scene::description::{Film, GlassShadows, Render};
use glam::DVec3;
use std::sync::Arc;

/// A scene without file names: immutable, shared by all threads.
#[derive(Debug)]
pub struct Scene {
    /// What can be hit.
    pub world: Arc<World>,
    /// The materials, named by [`MaterialId`].
    pub materials: Vec<Material>,
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
    /// How light passes through glass towards shadow rays: never straight where the scene has no glass, which makes
    /// those rays cheaper.
    pub glass_shadows: GlassShadows,
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

    /// The light that a placement is.
    #[must_use]
    pub fn light_of(&self, placement: PlacementId) -> Option<&Light> {
        self.surfaces[placement.index()].light.map(|id| &self.lights[id.index()])
    }

    /// The environment, if there is one.
    #[must_use]
    pub fn environment(&self) -> Option<(&Light, &Environment)> {
        let light = &self.lights[self.environment?.index()];
        if let Light::Environment(environment) = light { Some((light, environment)) } else { None }
    }

    /// Whether anything moves while the shutter is open, the camera included.
    #[must_use]
    pub fn is_moving(&self) -> bool {
        self.camera.is_moving() || self.world.is_moving()
    }

    /// Whether any surface bounds a transparent medium.
    #[must_use]
    pub fn has_media(&self) -> bool {
        self.materials.iter().any(|material| material.medium().is_some())
    }
}
