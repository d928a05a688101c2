//! Shapes and their instances.

use crate::error::{Place, Problem};
use crate::geometry::{Disc, PlacementId, Pose, Shape, ShapeId, Sphere};
use crate::light::{Area, DiscArea, Light, MeshArea, SphereLight};
use crate::material::{Emission, MaterialId};
use crate::scene::build::textures::canonical;
use crate::scene::build::way::{Placed, Way};
use crate::scene::build::{Builder, forms, lights, steps, unit};
use crate::scene::description::{self, Form, Located};
use crate::scene::library::{self, Made};
use crate::scene::load::{About, LoadedMesh, Shading, load_mesh_within};
use crate::scene::pruned::Ineffective;
use crate::scene::track::Track;
use crate::trust::Limit;
use glam::{DAffine3, DVec3, Vec2};
use std::collections::{HashMap, HashSet};
use std::path::PathBuf;
use std::sync::Arc;

/// A described shape, made.
struct Formed {
    shape: Shape,
    /// What its coordinates count from.
    origin: DVec3,
    /// A material per group.
    materials: Vec<MaterialId>,
}

/// A shape that others are instances of: in the world once, placed many times.
#[derive(Clone)]
struct Prototype {
    shape: ShapeId,
    materials: Vec<MaterialId>,
    way: Way,
}

/// What a shape is called in pictures: by its own name, or by its number in the file.
fn name_of(shape: &description::Shape, number: usize) -> String {
    shape.name.as_ref().map_or_else(|| format!("shape_{number}"), |name| name.value.clone())
}

impl Builder {
    pub(super) fn add_shapes(&mut self, shapes: &[Located<description::Shape>]) {
        let by_name: HashMap<&str, &Located<description::Shape>> =
            shapes.iter().filter_map(|shape| Some((shape.name.as_ref()?.value.as_str(), shape))).collect();
        // Instances that are not seen need nothing to be an instance of.
        let prunes = self.prunes;
        let instanced: HashSet<&str> = shapes
            .iter()
            .filter(|shape| !(prunes && shape.hidden))
            .filter_map(|shape| Some(root_of(&by_name, instance_of(shape)?)))
            .collect();
        let mut prototypes = HashMap::new();
        let numbered = || shapes.iter().enumerate();
        for (number, shape) in numbered().filter(|(_, shape)| instance_of(shape).is_none()) {
            let name = shape.name.as_ref().map(|name| name.value.as_str());
            let is_prototype = name.is_some_and(|name| instanced.contains(name));
            if shape.hidden && !is_prototype {
                let what = format!("`{}` is hidden and has no instance that is seen", name_of(shape, number));
                self.prune(Ineffective::Object, what, Some(&shape.place));
                continue;
            }
            if let Some(prototype) = self.add_shape(shape, is_prototype)
                && let Some(name) = name
            {
                prototypes.insert(name, prototype);
            }
            self.name(name_of(shape, number));
        }
        let named: HashSet<&str> =
            shapes.iter().filter_map(|shape| Some(instance_of(shape)?.as_str())).collect();
        for (number, shape) in numbered().filter(|(_, shape)| instance_of(shape).is_some()) {
            if shape.hidden {
                // One that only others are instances of is a step on their way.
                if !shape.name.as_ref().is_some_and(|name| named.contains(name.as_str())) {
                    let what = format!("`{}` is a hidden instance", name_of(shape, number));
                    self.prune(Ineffective::Object, what, Some(&shape.place));
                }
                continue;
            }
            self.add_instance(shape, &by_name, &prototypes);
            self.name(name_of(shape, number));
        }
    }

    fn add_shape(
        &mut self,
        described: &Located<description::Shape>,
        is_prototype: bool,
    ) -> Option<Prototype> {
        let Formed { shape, origin, materials } = self.make(described)?;
        let mut way = Way::default();
        way.carry(DAffine3::from_translation(origin));
        let way = self.carried(described, &shape, way)?;
        if described.hidden {
            let shape = self.world.add_shape(shape);
            return Some(Prototype { shape, materials, way });
        }
        let placed = self.placed(&way, &shape, &described.place)?;
        if self.is_hole(&materials, &described.place) {
            if !is_prototype {
                return None;
            }
            let shape = self.world.add_shape(shape);
            return Some(Prototype { shape, materials, way });
        }
        if !is_prototype
            && let Placed::Still(map) = placed
            && (!self.reads_parameters(&materials) || forms::keeps_parameters(&shape, &map))
            && let Some(moved) = forms::moved(&shape, &map)
        {
            let id = self.world.add_shape(moved);
            let placement = self.place(id, None, materials, &described.place);
            self.light_up(placement, &described.place);
            return None;
        }
        let id = self.world.add_shape(shape);
        let placement = self.place(id, placed, materials.clone(), &described.place);
        self.light_up(placement, &described.place);
        Some(Prototype { shape: id, materials, way })
    }

    /// Whether it matters where surface parameters of a surface of these materials run.
    fn reads_parameters(&self, materials: &[MaterialId]) -> bool {
        self.shows_parameters || materials.iter().any(|id| self.materials[id.index()].reads_parameters())
    }

    fn add_instance(
        &mut self,
        described: &Located<description::Shape>,
        by_name: &HashMap<&str, &Located<description::Shape>>,
        prototypes: &HashMap<&str, Prototype>,
    ) {
        // From the instance down to the prototype; the transform of the prototype comes first.
        let mut chain = vec![described];
        while let Form::Instance { of } = &chain[chain.len() - 1].form {
            let Some(next) = by_name.get(of.value.as_str()) else { return };
            chain.push(next);
        }
        let root = chain.pop().and_then(|root| root.name.as_ref());
        let Some(prototype) = root.and_then(|name| prototypes.get(name.value.as_str())) else { return };
        let shape = self.world.shapes[prototype.shape.index()].clone();
        let mut way = prototype.way.clone();
        for link in chain.iter().rev() {
            let Some(longer) = self.carried(link, &shape, way) else { return };
            way = longer;
        }
        let Some(placed) = self.placed(&way, &shape, &described.place) else { return };
        let own = chain.iter().find_map(|link| link.material.as_ref());
        let materials = match own.and_then(|name| self.material_named(&name.value)) {
            Some(id) => vec![id; prototype.materials.len()],
            None => prototype.materials.clone(),
        };
        if self.is_hole(&materials, &described.place) {
            return;
        }
        let placement = self.place(prototype.shape, placed, materials, &described.place);
        self.light_up(placement, &described.place);
    }

    /// The way of a shape that has come `way` already, with what its own `transform` and `keys` add.
    fn carried(&mut self, described: &description::Shape, shape: &Shape, mut way: Way) -> Option<Way> {
        let before = way.at_rest();
        let map =
            steps::transform(&described.transform, |so_far| steps::extent_of(shape, &(*so_far * before)));
        let track = if described.keys.is_empty() { Ok(None) } else { Track::new(&described.keys).map(Some) };
        match (map, track) {
            (Ok(map), Ok(track)) => {
                way.carry(map);
                track.into_iter().for_each(|track| way.follow(track));
                Some(way)
            }
            (map, track) => {
                [map.err(), track.err()]
                    .into_iter()
                    .flatten()
                    .for_each(|problem| self.problems.push(problem));
                None
            }
        }
    }

    /// Where a shape on its way is while the shutter is open.
    fn placed(&mut self, way: &Way, shape: &Shape, place: &Place) -> Option<Placed> {
        let mut way = way.clone();
        way.carry(DAffine3::from_translation(-self.origin.0));
        match way.during(self.shutter, shape.bounds(), place) {
            Ok((placed, warning)) => {
                self.warnings.extend(warning);
                Some(placed)
            }
            Err(problem) => {
                self.problems.push(problem);
                None
            }
        }
    }

    /// Whether nothing is there of what is made of these materials. Light from holes is left to be refused.
    fn is_hole(&mut self, materials: &[MaterialId], place: &Place) -> bool {
        let shines = materials.iter().any(|id| self.materials[id.index()].emission.is_some());
        let is_hole = !shines && self.is_invisible(materials);
        if is_hole {
            self.prune(Ineffective::Object, "its opacity is below a half everywhere", Some(place));
        }
        is_hole
    }

    fn make(&mut self, described: &Located<description::Shape>) -> Option<Formed> {
        let own = described.material.as_ref().and_then(|name| self.material_named(&name.value));
        if let &Form::Mesh { ref file, normals, crease_deg } = &described.form {
            return self.mesh(file, Shading { normals, crease_deg }, own);
        }
        let origin = self.origin.own(middle(&described.form));
        let local = |p: DVec3| (p - origin).as_vec3();
        let shape = match &described.form {
            &Form::Sphere { center, radius } => Shape::Sphere(Sphere { center: local(center), radius }),
            &Form::Disc { center, normal, radius } => {
                let normal = unit(normal.as_dvec3());
                Shape::Disc(Disc { center: local(center), normal, radius })
            }
            &Form::Rectangle { center, edge_u, edge_v } => {
                self.mesh_of(forms::rectangle(local(center), edge_u, edge_v), &described.place)?
            }
            &Form::Box { min, max } => {
                self.mesh_of(forms::cuboid(local(min), local(max)), &described.place)?
            }
            form @ (Form::Cylinder { .. } | Form::Cone { .. } | Form::Torus { .. }) => {
                self.surface_of(form, origin, &described.place)?
            }
            form @ Form::HeightField { .. } => self.height_field(form, origin, &described.place)?,
            Form::Mesh { .. } | Form::Instance { .. } => return None,
        };
        Some(Formed { shape, origin, materials: vec![own?] })
    }

    /// The mesh of a file, in the material `own` or those that the file brings.
    pub(super) fn mesh_of_file(
        &mut self,
        file: &Located<PathBuf>,
        shading: impl Into<Shading>,
    ) -> Option<Arc<LoadedMesh>> {
        let (shading, is_moved) = (shading.into(), self.origin.is_moved());
        let about = if is_moved { About::Middle } else { About::Needed };
        let form = library::Form::Mesh(shading.normals, shading.crease_deg.to_bits(), is_moved);
        let key = (canonical(&file.value), form);
        if let Some(known) = self.meshes.known(&key).filter(|_| self.prunes) {
            // Where it is carried to its place its arrays are copied.
            if !self.may_hold(known.mesh.triangles().len(), &file.place) {
                return None;
            }
            self.prune_mesh(file, &known.mesh);
            return Some(known);
        }
        if !self.may_read(1, &file.place) {
            return None;
        }
        let (library, trust) = (self.library.clone(), &self.trust);
        let loaded = library.thing(&file.value, form, trust, || {
            let thing = load_mesh_within(&file.value, shading, about, trust)?;
            let takes = (Limit::Triangles, thing.mesh.triangles().len() as u64);
            Ok(Made { bytes: thing.mesh.bytes(), takes, more: thing.libraries.clone(), thing })
        });
        match loaded {
            Ok(mut loaded) => {
                let may = self.may_read(loaded.libraries.len(), &file.place)
                    && self.may_hold(loaded.mesh.triangles().len(), &file.place);
                if !may {
                    return None;
                }
                self.warnings.extend(loaded.warnings.iter().cloned());
                self.files.extend(loaded.libraries.iter().map(|(path, _)| path.clone()));
                if self.prunes && self.meshes.note(key, &mut loaded) {
                    self.prune_mesh(file, &loaded.mesh);
                }
                Some(loaded)
            }
            Err(error) => {
                self.problems.absorb(error, Some(&file.place));
                None
            }
        }
    }

    fn mesh(&mut self, file: &Located<PathBuf>, shading: Shading, own: Option<MaterialId>) -> Option<Formed> {
        let loaded = self.mesh_of_file(file, shading)?;
        let groups = loaded.mesh.group_count();
        if own.is_none() && loaded.materials.len() < groups {
            let problem = Problem::at(file.place.clone(), "the file brings no materials");
            self.problems.push(problem.remedy("give the shape a `material`"));
            return None;
        }
        let materials = match own {
            Some(id) => vec![id; groups],
            None => loaded.materials.iter().map(|named| self.material_of_file(named)).collect(),
        };
        Some(Formed { shape: Shape::Mesh(loaded.mesh.clone()), origin: loaded.origin, materials })
    }

    fn material_of_file(&mut self, named: &description::Named<description::Material>) -> MaterialId {
        self.textures.of_mtl = true;
        let material = self.material(&named.value);
        self.textures.of_mtl = false;
        self.add_material(named.name.clone(), material)
    }

    fn material_named(&self, name: &str) -> Option<MaterialId> {
        self.named.get(name).copied()
    }

    /// Makes a light of a placement whose material emits.
    fn light_up(&mut self, placement: PlacementId, place: &Place) {
        let materials = self.surfaces[placement.index()].materials.clone();
        let emission = |id: &MaterialId| self.materials[id.index()].emission.clone();
        let Some((&first, emission)) = materials.iter().find_map(|id| Some((id, emission(id)?))) else {
            return;
        };
        if let Pose::Moving(_) = self.world.placements[placement.index()].pose {
            let problem =
                Problem::at(place.clone(), "a shape that emits light moves while the shutter is open");
            let remedy =
                "let it stand still, close the shutter, or take its emission away and light it by a light";
            return self.problems.push(problem.remedy(remedy));
        }
        if materials.iter().any(|id| *id != first) {
            let all_emit = materials.iter().all(|id| self.materials[id.index()].emission.is_some());
            let (what, remedy) = if all_emit {
                ("a mesh that emits in more than one material", "split it into a file for each of them")
            } else {
                (
                    "a mesh that emits in some of its groups only",
                    "split the emitting part off into a file of its own",
                )
            };
            let problem = Problem::at(place.clone(), format!("{what} cannot be asked for light"));
            return self.problems.push(problem.remedy(remedy));
        }
        if self.materials[first.index()].opacity.is_some() {
            let what = "a surface that emits light has holes";
            let problem = Problem::at(place.clone(), what);
            return self.problems.push(problem.remedy("take its `opacity` or its emission away"));
        }
        match self.light_at(placement, emission, place) {
            Ok(light) => self.surfaces[placement.index()].light = self.add_light(light, place),
            Err(problem) => self.problems.push(problem),
        }
    }

    fn light_at(&self, placement: PlacementId, emission: Emission, place: &Place) -> Result<Light, Problem> {
        let refused = |what: &str, remedy: &str| Problem::at(place.clone(), what).remedy(remedy);
        let Emission { radiance: texture, two_sided } = emission;
        let radiance = texture.mean();
        let map = self.world.placements[placement.index()].pose.at(0.0).map(|t| *t.world_from_object());
        let shape = self.world.shape_of(placement);
        let moved = match map {
            // Refused below, wherever it stands.
            _ if matches!(shape, Shape::Surface(_)) => shape.clone(),
            None => shape.clone(),
            Some(map) => forms::moved(shape, &map).ok_or_else(|| {
                let what =
                    "an emitting sphere or disc can be moved, turned and scaled alike on all axes only";
                refused(what, "use a mesh")
            })?,
        };
        if !texture.is_constant() && !matches!(moved, Shape::Mesh(_)) {
            let what = "only meshes and rectangles can emit light by a texture";
            return Err(refused(what, "use one of those"));
        }
        Ok(match moved {
            Shape::Sphere(Sphere { center, radius }) => {
                Light::Sphere(SphereLight { center: center.into(), radius, radiance, two_sided })
            }
            Shape::Disc(Disc { center, normal, radius }) => {
                Light::Disc(Area { surface: DiscArea::new(center, normal, radius), radiance, two_sided })
            }
            Shape::Mesh(mesh) => {
                let triangles = lights::shining(&mesh);
                let wrong = |error| lights::no_light("an emitting mesh", error, place);
                if texture.is_constant() {
                    lights::of_triangles(triangles, radiance, two_sided).map_err(wrong)?
                } else {
                    // Without surface parameters of its own a triangle has its barycentric ones.
                    let own = [Vec2::ZERO, Vec2::X, Vec2::Y];
                    let corners = |i| lights::sorted(&mesh, i, mesh.corner_uvs(i).unwrap_or(own));
                    let uvs: Vec<_> = (0..super::number(mesh.triangles().len())).map(corners).collect();
                    let surface = MeshArea::new(triangles).map_err(wrong)?.painted(&uvs, texture);
                    Light::Mesh(Area { surface, radiance, two_sided })
                }
            }
            Shape::Surface(_) => {
                return Err(refused("only meshes, spheres and discs can be lights", "use one of those"));
            }
        })
    }
}

/// The name of what a shape is an instance of.
fn instance_of(shape: &description::Shape) -> Option<&Located<String>> {
    if let Form::Instance { of } = &shape.form { Some(of) } else { None }
}

/// The name of the shape at the end of a chain of instances.
fn root_of<'a>(by_name: &HashMap<&'a str, &'a Located<description::Shape>>, name: &'a str) -> &'a str {
    let mut name = name;
    // References were checked to exist and not to run in circles.
    while let Some(Form::Instance { of }) = by_name.get(name).map(|shape| &shape.form) {
        name = &of.value;
    }
    name
}

/// A point in the middle of a form, or at one of its ends.
fn middle(form: &Form) -> DVec3 {
    match *form {
        Form::Sphere { center, .. }
        | Form::Disc { center, .. }
        | Form::Rectangle { center, .. }
        | Form::Torus { center, .. }
        | Form::HeightField { center, .. } => center,
        Form::Box { min, max } => (min + max) * 0.5,
        Form::Cylinder { from, .. } | Form::Cone { from, .. } => from,
        Form::Mesh { .. } | Form::Instance { .. } => DVec3::ZERO,
    }
}
