//! Lights, and the surfaces of those that have one.

use crate::error::{Place, Problem};
use crate::geometry::{Disc, Mesh, Shape, Sphere};
use crate::image;
use crate::light::{
    Area, Directional, DiscArea, Environment, EnvironmentMap, Light, MeshArea, Point, RectangleArea,
    SphereLight, Spot, spot_versines,
};
use crate::material::{Emission, Material, Scattering};
use crate::math::Rgb;
use crate::sampling::{Table1d, TableError};
use crate::scene::build::{Builder, forms, number, steps, unit, way};
use crate::scene::description::{self, Located, Normals, Sky, Step};
use crate::scene::library::{self, Made};
use crate::texture::Texture;
use crate::trust::Limit;
use glam::{DAffine3, Vec3};
use std::path::PathBuf;
use std::sync::Arc;

impl Builder {
    pub(super) fn add_lights(&mut self, lights: &[Located<description::Light>]) {
        use description::Light as Described;
        for (number, light) in lights.iter().enumerate() {
            match &light.value {
                &Described::Point { position, intensity } => {
                    let position = self.origin.place(position);
                    self.add_light(
                        Light::Point(Point { position: position.into(), intensity }),
                        &light.place,
                    );
                }
                &Described::Spot { position, at, intensity, angle_deg, softness } => {
                    let [versine_outer, versine_inner] = spot_versines(angle_deg.to_radians(), softness);
                    let axis = unit(at - position).into();
                    let position = self.origin.place(position).into();
                    self.add_light(
                        Light::Spot(Spot { position, axis, intensity, versine_outer, versine_inner }),
                        &light.place,
                    );
                }
                &Described::Directional { direction, irradiance } => {
                    let direction = unit(direction.as_dvec3()).into();
                    self.add_light(Light::Directional(Directional { direction, irradiance }), &light.place);
                }
                &Described::Rectangle { center, edge_u, edge_v, radiance } => {
                    let center = self.origin.place(center);
                    let surface = RectangleArea::new(center, edge_u, edge_v);
                    let shining = Light::Rectangle(Area { surface, radiance, two_sided: false });
                    if let Some(shape) = self.mesh_of(forms::rectangle(center, edge_u, edge_v), &light.place)
                    {
                        self.add_shining(shape, shining, radiance, &light.place);
                    }
                }
                &Described::Disc { center, normal, radius, radiance } => {
                    let center = self.origin.place(center);
                    let normal = unit(normal.as_dvec3());
                    let surface = DiscArea::new(center, normal, radius);
                    let shining = Light::Disc(Area { surface, radiance, two_sided: false });
                    let shape = Shape::Disc(Disc { center, normal, radius });
                    self.add_shining(shape, shining, radiance, &light.place);
                }
                &Described::Sphere { center, radius, radiance } => {
                    let center = self.origin.place(center);
                    let shining = Light::Sphere(SphereLight {
                        center: center.into(),
                        radius,
                        radiance,
                        two_sided: false,
                    });
                    let shape = Shape::Sphere(Sphere { center, radius });
                    self.add_shining(shape, shining, radiance, &light.place);
                }
                Described::Mesh { file, radiance, transform } => {
                    self.add_mesh_light(file, *radiance, transform, &light.place);
                }
                Described::Environment { scale, rotate_deg, sky } => {
                    self.add_environment(sky, *scale, rotate_deg.to_radians(), &light.place);
                }
            }
            self.name(format!("light_{number}"));
        }
    }

    /// Adds a light with its surface; without power it is a black surface.
    fn add_shining(&mut self, shape: Shape, light: Light, radiance: Rgb<f32>, origin: &Place) {
        let emission = Some(Emission { radiance: Texture::Constant(radiance), two_sided: false });
        let name = format!("emission_{}", self.materials.len());
        let material = Material { scattering: Scattering::Black, emission, relief: None, opacity: None };
        let material = self.add_material(name, material);
        let shape = self.world.add_shape(shape);
        let placement = self.place(shape, None, vec![material], origin);
        self.surfaces[placement.index()].light = self.add_light(light, origin);
    }

    fn add_mesh_light(
        &mut self,
        file: &Located<PathBuf>,
        radiance: Rgb<f32>,
        transform: &[Located<Step>],
        place: &Place,
    ) {
        let Some(loaded) = self.mesh_of_file(file, Normals::File) else { return };
        let shape = Shape::Mesh(loaded.mesh.clone());
        let own = DAffine3::from_translation(loaded.origin);
        let map = match steps::transform(transform, |map| steps::extent_of(&shape, &(*map * own))) {
            Ok(map) => DAffine3::from_translation(-self.origin.0) * map * own,
            Err(problem) => return self.problems.push(problem),
        };
        let Some(Shape::Mesh(mesh)) = forms::moved(&shape, &way::single(&map)) else {
            let problem =
                Problem::at(place.clone(), "a mesh light is carried infinitely far from the camera");
            return self.problems.push(problem.remedy("move it nearer"));
        };
        match of_triangles(shining(&mesh), radiance, false) {
            Ok(light) => {
                let groups = mesh.group_count();
                self.add_shining(Shape::Mesh(mesh), light, radiance, place);
                // A file's own materials do not matter to a light.
                if let Some(surface) = self.surfaces.last_mut() {
                    surface.materials = vec![surface.materials[0]; groups];
                }
            }
            Err(error) => self.problems.push(no_light("a mesh light", error, place)),
        }
    }

    /// Reports lights of which none could be chosen, since there are too many.
    pub(super) fn count_lights(&mut self) {
        self.problems.0.extend(too_many(&self.light_places, Table1d::MAX_LEN));
    }

    fn add_environment(&mut self, sky: &Sky, scale: f32, rotation: f32, place: &Place) {
        if self.environment.is_some() {
            let problem = Problem::at(place.clone(), "a second environment");
            return self.problems.push(problem.remedy("keep one: there is only one infinity"));
        }
        let environment = match sky {
            Sky::Constant { radiance } => Environment::Constant(radiance.scale(scale)),
            Sky::File { file } => {
                if !self.may_read(1, &file.place) {
                    return;
                }
                let form = library::Form::Sky(scale.to_bits(), rotation.to_bits());
                let (library, trust) = (self.library.clone(), &self.trust);
                let sky = library.thing(&file.value, form, trust, || {
                    let decoded = image::read_shown_within(&file.value, trust)?;
                    let texels = decoded.image.pixels().len() as u64;
                    let map = EnvironmentMap::new(decoded.image, scale, rotation).map_err(|error| {
                        let what = format!("{}: cannot light a scene: {error}", file.value.display());
                        Problem::at(file.place.clone(), what)
                    })?;
                    let takes = (Limit::Texels, texels);
                    let bytes = map.bytes();
                    Ok(Made { bytes, thing: (Arc::new(map), decoded.warnings), takes, more: vec![] })
                });
                match sky {
                    Ok(sky) => {
                        let (map, warnings) = &*sky;
                        self.warnings.extend(warnings.iter().cloned());
                        Environment::Map(map.clone())
                    }
                    Err(error) => return self.problems.absorb(error, Some(&file.place)),
                }
            }
        };
        self.environment = self.add_light(Light::Environment(environment), place);
    }
}

/// The corners of the triangles of a mesh, counter-clockwise seen from the side that shines.
pub(super) fn shining(mesh: &Mesh) -> Vec<[Vec3; 3]> {
    let triangles = 0..number(mesh.triangles().len());
    triangles.map(|i| sorted(mesh, i, mesh.corners(i))).collect()
}

/// What belongs to the corners of a triangle, in the order of [`shining`]. Normals of corners are more often right than the winding, as
/// hits have it.
pub(super) fn sorted<T: Copy>(mesh: &Mesh, triangle: u32, [x, y, z]: [T; 3]) -> [T; 3] {
    let [a, b, c] = mesh.corners(triangle);
    let own = (b - a).cross(c - a);
    let is_turned = |normals: [Vec3; 3]| normals.iter().sum::<Vec3>().dot(own) < 0.0;
    if mesh.corner_normals(triangle).is_some_and(is_turned) { [x, z, y] } else { [x, y, z] }
}

/// Lights described at `places` that are more than `most`, told at the first that is too many.
fn too_many(places: &[Place], most: usize) -> Option<Problem> {
    let place = places.get(most)?;
    let what = format!("{} lights, and one is chosen of at most {most}", places.len());
    let remedy = "leave some out, or make a mesh of them: all of its triangles are one light";
    Some(Problem::at(place.clone(), what).remedy(remedy))
}

/// That the triangles of `what` make no light.
pub(super) fn no_light(what: &str, error: TableError, place: &Place) -> Problem {
    let most = Table1d::MAX_LEN;
    let (why, remedy) = match error {
        TableError::TooMany => (
            format!("more than {most} triangles, of which one cannot be chosen"),
            format!("split the file into meshes of at most {most} triangles"),
        ),
        TableError::Zero => {
            ("no triangle has an area".to_owned(), "leave it out, or scale it up if it is tiny".to_owned())
        }
        TableError::Weight(_) | TableError::Shape => {
            (format!("its triangles cannot be weighed: {error}"), "scale it down".to_owned())
        }
    };
    Problem::at(place.clone(), format!("{what}: {why}")).remedy(remedy)
}

/// A light made of triangles that shine alike: a rectangle where two of them make up one.
pub(super) fn of_triangles(
    triangles: Vec<[Vec3; 3]>,
    radiance: Rgb<f32>,
    two_sided: bool,
) -> Result<Light, TableError> {
    if let Some(surface) = RectangleArea::of_triangles(&triangles) {
        return Ok(Light::Rectangle(Area { surface, radiance, two_sided }));
    }
    Ok(Light::Mesh(Area { surface: MeshArea::new(triangles)?, radiance, two_sided }))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn triangles_that_make_no_light_are_told_with_a_remedy() {
        let place = Place::file("a.toml");
        let told = |error| no_light("a mesh light", error, &place).to_string();
        let many = told(TableError::TooMany);
        assert!(many.starts_with("a.toml: a mesh light: more than 4194304 triangles"), "{many}");
        assert!(many.ends_with("; split the file into meshes of at most 4194304 triangles"), "{many}");
        let flat = of_triangles(vec![[Vec3::ZERO; 3]; 3], Rgb::WHITE, false).map(drop);
        let flat = flat.map_err(told).expect_err("no area");
        assert_eq!(
            flat,
            "a.toml: a mesh light: no triangle has an area; leave it out, or scale it up if it is tiny"
        );
        let huge = [Vec3::ZERO, Vec3::X * 1e30, Vec3::Y * 1e30];
        let huge =
            of_triangles(vec![huge; 3], Rgb::WHITE, false).map(drop).map_err(told).expect_err("infinite");
        assert!(huge.contains("weight 0 is negative or not finite; scale it down"), "{huge}");
    }

    #[test]
    fn lights_that_are_too_many_are_told_at_the_first() {
        let places = ["a", "b", "c", "d"].map(Place::file);
        assert_eq!(too_many(&places, 4), None, "as many as there may be");
        let told = too_many(&places, 2).expect("more").to_string();
        assert!(told.starts_with("c: 4 lights, and one is chosen of at most 2; leave some out"), "{told}");
    }
}
