//! From a description to a frozen scene: files are read here, and everything a description cannot know about them is
//! checked, all problems at once.
//!
//! What the scene does not need is left out: shapes that stand still in one place, if only while the shutter is open, are
//! moved there once instead of being instanced, lights without power are dropped, shadow rays look for glass only where there is some.
//! [`build_for`] leaves out more, by what is wanted: attributes of vertices that nobody reads, and what has no effect
//! (`pruning`); or switches on what nobody needs (`forced`).

mod again;
mod attributes;
mod camera;
mod cut_outs;
mod forced;
mod forms;
mod lights;
mod materials;
mod origin;
mod pruning;
mod shapes;
mod shutter;
mod steps;
mod surfaces;
mod textures;
mod way;

pub use again::{retake, retune};

use crate::bsdf::FresnelModel;
use crate::error::{Place, Problem, Problems, Result};
use crate::film::Names;
use crate::geometry::{PlacementId, Pose, ShapeId, World};
use crate::light::{Light, LightId};
use crate::material::{Material, MaterialId};
use crate::scene::description::{Description, FuzzyBy};
use crate::scene::frozen::Surface;
use crate::scene::library::Library;
use crate::scene::needs::capability::Capabilities;
use crate::scene::needs::count::{self, Places};
use crate::scene::pruned::{Ineffective, Pruned};
use crate::scene::{Scene, Wanted};
use crate::trust::{Excess, Limit, Trust};
use glam::{DVec3, Vec3};
use origin::Origin;
use pruning::Meshes;
use shutter::Shutter;
use std::collections::HashMap;
use std::path::PathBuf;
use std::sync::Arc;
use textures::Textures;

/// A scene, and what was odd about its files.
#[derive(Debug)]
pub struct Built {
    /// The scene.
    pub scene: Scene,
    /// Where each placement was described.
    pub origins: Vec<Place>,
    /// Files that the description does not name itself, but files that it names: of materials, and of pictures of those.
    pub files: Vec<PathBuf>,
    /// What was odd, but not wrong.
    pub warnings: Vec<Problem>,
    /// What had no effect, and was left out.
    pub pruned: Vec<Pruned>,
    /// Those of the warnings that are about pictures that the description names itself and that could not be read.
    pub unread: Vec<Problem>,
}

/// Reads the files that `description` names, trusted within the usual limits, and freezes the scene, for whatever may be asked of it.
/// Fails with all problems of all files.
pub fn build(description: &Description) -> Result<Built> {
    build_for(description, &Wanted::anything())
}

/// The same of files that are trusted so far.
pub fn build_within(description: &Description, trust: &Trust) -> Result<Built> {
    build_from(description, &Wanted::anything(), (trust, &Arc::default()))
}

/// As [`build`], for what is wanted: what that does not need is left out. Files of materials that nothing is made of are then not
/// read, so faults in these are not found.
pub fn build_for(description: &Description, wanted: &Wanted) -> Result<Built> {
    build_from(description, wanted, (&Trust::default(), &Arc::default()))
}

/// The same of files that are trusted so far, with what a library has of them.
pub fn build_from(
    description: &Description,
    wanted: &Wanted,
    (trust, library): (&Trust, &Arc<Library>),
) -> Result<Built> {
    let shutter = camera::shutter(&description.camera);
    let fresnel = description.render.fresnel;
    let origin = Origin::of(&description.camera);
    let jitters = description.render.glossy == FuzzyBy::Jitter;
    let (prunes, library, trust) = (wanted.prunes, library.clone(), trust.clone());
    let shows_parameters = attributes::are_parameters_shown(wanted, &description.render);
    let mut builder = Builder {
        library,
        trust,
        shutter,
        origin,
        fresnel,
        jitters,
        prunes,
        shows_parameters,
        ..Builder::default()
    };
    let referenced = prunes.then(|| pruning::referenced(description));
    builder.add_materials(&description.materials, referenced.as_ref());
    builder.add_shapes(&description.shapes);
    builder.add_lights(&description.lights);
    builder.count_lights();
    builder.cut_holes();
    builder.drop_attributes(wanted, &description.render);
    let film = description.film.clone();
    let size = [film.width, film.height];
    let camera = camera::camera(&description.camera, origin, size);
    let files = builder.textures.files().map(Into::into).chain(builder.files).collect();
    let mut scene = Scene {
        world: Arc::new(builder.world),
        textures: builder.textures.into_bitmaps(prunes.then_some(&builder.materials[..])),
        materials: builder.materials,
        lights: builder.lights,
        camera,
        origin: origin.0,
        film,
        render: description.render.clone(),
        surfaces: builder.surfaces,
        names: builder.names,
        environment: builder.environment,
        asked: Vec::new(),
        required: Capabilities::NONE,
        forced: count::forceable(wanted.forced, &description.render),
    };
    let places = Places {
        placements: &builder.origins,
        lights: &builder.light_places,
        camera: &description.camera.place,
    };
    scene.asked = count::asked(&scene, wanted, places);
    scene.required = count::set(&scene.asked);
    let scene = forced::force(scene, (&description.camera, origin));
    let Builder { origins, warnings, unread, pruned, problems, .. } = builder;
    problems.into_result(Built { scene, origins, files, warnings, unread, pruned })
}

/// A scene under way.
#[derive(Debug, Default)]
struct Builder {
    library: Arc<Library>,
    shutter: Shutter,
    origin: Origin,
    world: World,
    surfaces: Vec<Surface>,
    /// Of placements and of materials.
    names: Names,
    origins: Vec<Place>,
    materials: Vec<Material>,
    /// How reflectance depends on the angle where a material does not say.
    fresnel: FresnelModel,
    /// Whether fuzzy mirrors become mirrors with a trembling normal.
    jitters: bool,
    /// The scene's own materials; those of mesh files cannot be named.
    named: HashMap<String, MaterialId>,
    lights: Vec<Light>,
    /// Where each was described.
    light_places: Vec<Place>,
    environment: Option<LightId>,
    meshes: Meshes,
    textures: Textures,
    /// Files of materials.
    files: Vec<PathBuf>,
    /// How far files are trusted.
    trust: Trust,
    /// What they have asked for so far.
    taken: Taken,
    /// Of what it was told that it is too much.
    told: [bool; Limit::ALL.len()],
    problems: Problems,
    warnings: Vec<Problem>,
    /// Whether what has no effect is left out.
    prunes: bool,
    /// Whether surface parameters are shown themselves.
    shows_parameters: bool,
    pruned: Vec<Pruned>,
    /// Warnings of pictures that were not read.
    unread: Vec<Problem>,
}

/// What the files of a scene ask for together.
#[derive(Debug, Default)]
struct Taken {
    files: u64,
    triangles: u64,
    texels: u64,
}

impl Builder {
    /// Counts files that are read; reports those that are too many, which are not to be read.
    fn may_read(&mut self, files: usize, place: &Place) -> bool {
        self.taken.files += files as u64;
        self.may_take(Limit::Files, self.taken.files, place)
    }

    /// Counts the triangles of a mesh; reports those that are too many, whose mesh is to be dropped.
    fn may_hold(&mut self, triangles: usize, place: &Place) -> bool {
        self.taken.triangles += triangles as u64;
        self.may_take(Limit::Triangles, self.taken.triangles, place)
    }

    /// Whether the scene may have so much of something; reported at a place, once, where not.
    fn may_take(&mut self, limit: Limit, taken: u64, place: &Place) -> bool {
        let Err(excess) = self.trust.limits.check(limit, taken) else { return true };
        if !std::mem::replace(&mut self.told[limit as usize], true) {
            self.problems.push(too_much(&excess, place));
        }
        false
    }

    fn add_material(&mut self, name: String, material: Material) -> MaterialId {
        let id = MaterialId(number(self.materials.len()));
        self.names.materials.push(name);
        self.materials.push(material);
        id
    }

    /// Adds a light, unless it is without power.
    fn add_light(&mut self, light: Light, place: &Place) -> Option<LightId> {
        if light.power(1.0) <= 0.0 {
            self.prune(Ineffective::Light, "never asked", Some(place));
            return None;
        }
        let id = LightId(number(self.lights.len()));
        self.lights.push(light);
        self.light_places.push(place.clone());
        Some(id)
    }

    /// Gives the placements that have none yet a name.
    fn name(&mut self, name: String) {
        self.names.objects.resize(self.surfaces.len(), name);
    }

    /// Places a shape made of `materials`, one per group, as described at `origin`.
    fn place(
        &mut self,
        shape: ShapeId,
        pose: impl Into<Pose>,
        materials: Vec<MaterialId>,
        origin: &Place,
    ) -> PlacementId {
        self.surfaces.push(Surface { materials, light: None });
        self.origins.push(origin.clone());
        self.world.place(shape, pose)
    }
}

/// That the files of a scene ask for too much, known at the place of one of them.
fn too_much(excess: &Excess, place: &Place) -> Problem {
    let what = format!("with this the scene has {excess}");
    Problem::at(place.clone(), what).remedy(excess.remedy())
}

/// The direction of a vector of any length but zero. Single precision does not hold the squares of long and short ones, and
/// loses the direction between places that are far out.
fn unit(v: DVec3) -> Vec3 {
    (v / v.abs().max_element()).normalize().as_vec3()
}

/// # Panics
/// Beyond 2^32 of anything.
fn number(len: usize) -> u32 {
    u32::try_from(len).expect("fewer than 2^32 of a kind")
}
