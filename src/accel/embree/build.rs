//! The backend: a committed scene made from a world.
//!
//! A placement without transform is a geometry of the outer scene; one with a transform is an instance of a scene
//! of its shape's own, made once however often the shape is placed. Both bear the placement's number and mask; filters
//! belong to shapes.

use super::device::{Config, Device};
use super::error::EmbreeError;
use super::geometry::Geometry;
use super::mesh::MeshArrays;
use super::options::SceneOptions;
use super::scene::{Committed, Scene};
use super::surface::UserShape;
use crate::accel::{Accel, Active, Coherence, HitStream, Packet, RayPacket, RayStream};
use crate::geometry::{Hit, Mesh, Pose, Ray, Shape, ShapeId, World};
use crate::math::Aabb;
use std::collections::HashMap;
use std::ops::ControlFlow;
use std::sync::Arc;

/// How a world is built.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct BuildOptions {
    /// What Embree may use.
    pub device: Config,
    /// What the scenes are built for.
    pub scene: SceneOptions,
}

/// A world in Embree.
#[derive(Debug)]
pub struct EmbreeAccel {
    scene: Scene<Committed>,
    /// Bytes of padded copies of vertex positions, of quads and of boxes.
    copied: usize,
}

/// Geometries under way, made once per shape.
struct Builder<'a> {
    device: Device,
    options: SceneOptions,
    world: &'a World,
    meshes: HashMap<ShapeId, MeshArrays>,
    surfaces: HashMap<ShapeId, UserShape>,
    inner: HashMap<ShapeId, Arc<Scene<Committed>>>,
}

impl EmbreeAccel {
    /// Builds the hierarchy of `world` on all threads that `options` allow.
    ///
    /// # Panics
    /// If a surface of the world does when asked for its boxes.
    pub fn build(world: &World, options: &BuildOptions) -> Result<Self, EmbreeError> {
        Self::build_with(world, options, &|_| ControlFlow::Continue(()))
    }

    /// As [`EmbreeAccel::build`], telling `progress` the part done of the outer scene, from 0 to 1, now and then and
    /// from several threads at a time; it stops the build by answering `Break`.
    ///
    /// # Panics
    /// If `progress` does, or a surface of the world when asked for its boxes.
    pub fn build_with(
        world: &World,
        options: &BuildOptions,
        progress: &(dyn Fn(f64) -> ControlFlow<()> + Sync),
    ) -> Result<Self, EmbreeError> {
        let device = Device::new(options.device)?;
        let mut builder = Builder::new(device, options.scene, world);
        let mut outer = Scene::new(&builder.device, builder.options)?;
        for (number, placement) in (0..).zip(&world.placements) {
            if world.shapes[placement.shape.index()].primitive_count() == 0 {
                continue;
            }
            if progress(0.0).is_break() {
                return Err(EmbreeError::Cancelled);
            }
            let geometry = match &placement.pose {
                Pose::World => builder.geometry(placement.shape)?,
                pose => {
                    let inner = builder.inner_scene(placement.shape)?;
                    Geometry::instance(&builder.device, inner, pose)?
                }
            };
            outer.attach(number, geometry.with_mask(placement.mask)?)?;
        }
        Ok(Self { scene: outer.commit_with(progress)?, copied: builder.bytes() })
    }

    /// The device, which knows version, instruction set and memory in use.
    #[must_use]
    pub fn device(&self) -> &Device {
        self.scene.device()
    }

    /// The scene itself.
    #[must_use]
    pub fn scene(&self) -> &Scene<Committed> {
        &self.scene
    }
}

impl<'a> Builder<'a> {
    fn new(device: Device, options: SceneOptions, world: &'a World) -> Self {
        let (meshes, surfaces, inner) = (HashMap::new(), HashMap::new(), HashMap::new());
        Self { device, options, world, meshes, surfaces, inner }
    }

    /// Bytes of what was copied.
    fn bytes(&self) -> usize {
        self.meshes.values().map(MeshArrays::bytes).sum::<usize>()
            + self.surfaces.values().map(UserShape::bytes).sum::<usize>()
    }

    fn geometry(&mut self, id: ShapeId) -> Result<Geometry, EmbreeError> {
        let filter = self.world.filters.get(&id);
        let geometry = match &self.world.shapes[id.index()] {
            Shape::Mesh(mesh) => self.mesh(id, mesh)?,
            Shape::Sphere(sphere) => Geometry::spheres(&self.device, &[*sphere])?,
            Shape::Disc(disc) => Geometry::discs(&self.device, &[*disc])?,
            shape @ Shape::Surface(_) => {
                let ask = || UserShape::new(shape.clone(), filter.cloned());
                let asked = self.surfaces.entry(id).or_insert_with(ask).clone();
                return Geometry::surface(&self.device, asked);
            }
        };
        match filter {
            Some(filter) => geometry.with_filter(filter.clone()),
            None => Ok(geometry),
        }
    }

    fn mesh(&mut self, id: ShapeId, mesh: &Mesh) -> Result<Geometry, EmbreeError> {
        let quads = self.options.quads;
        let arrays = self.meshes.entry(id).or_insert_with(|| MeshArrays::new(mesh, quads)).clone();
        Geometry::mesh(&self.device, arrays)
    }

    fn inner_scene(&mut self, id: ShapeId) -> Result<Arc<Scene<Committed>>, EmbreeError> {
        if let Some(scene) = self.inner.get(&id) {
            return Ok(scene.clone());
        }
        let mut scene = Scene::new(&self.device, self.options)?;
        scene.attach(0, self.geometry(id)?)?;
        let scene = Arc::new(scene.commit()?);
        self.inner.insert(id, scene.clone());
        Ok(scene)
    }
}

impl Accel for EmbreeAccel {
    #[inline]
    fn intersect(&self, ray: &Ray) -> Option<Hit> {
        self.scene.intersect(ray)
    }

    #[inline]
    fn occluded(&self, ray: &Ray) -> bool {
        self.scene.occluded(ray)
    }

    #[inline]
    fn intersect_packet<const N: usize>(
        &self,
        active: &Active<N>,
        packet: &mut Packet<N>,
        coherence: Coherence,
    ) {
        self.scene.intersect_packet(active, packet, coherence);
    }

    #[inline]
    fn occluded_packet<const N: usize>(
        &self,
        active: &Active<N>,
        rays: &mut RayPacket<N>,
        coherence: Coherence,
    ) {
        self.scene.occluded_packet(active, rays, coherence);
    }

    fn intersect_stream(&self, rays: &RayStream, hits: &mut HitStream, coherence: Coherence) {
        self.scene.intersect_stream(rays, hits, coherence);
    }

    fn occluded_stream(&self, rays: &RayStream, occluded: &mut Vec<bool>, coherence: Coherence) {
        self.scene.occluded_stream(rays, occluded, coherence);
    }

    fn bounds(&self) -> Aabb {
        self.scene.bounds()
    }

    fn bytes(&self) -> usize {
        self.device().bytes() + self.copied
    }
}
