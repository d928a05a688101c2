//! Round bodies that find their own hits, and height fields.

use crate::error::{Place, Problem};
use crate::geometry::{Frustum, HeightField, Mesh, MeshError, Shape, Surface, Torus};
use crate::image;
use crate::scene::build::Builder;
use crate::scene::description::{Form, HeightNormals, Located};
use crate::scene::library::{self, Made};
use crate::trust::Limit;
use glam::{DVec3, Vec2};
use std::path::PathBuf;
use std::sync::Arc;

impl Builder {
    /// A cylinder, a cone or a torus, counted from `origin`.
    pub(super) fn surface_of(&mut self, form: &Form, origin: DVec3, place: &Place) -> Option<Shape> {
        let local = |p: DVec3| (p - origin).as_vec3();
        let surface: Option<Arc<dyn Surface>> = match *form {
            Form::Cylinder { from, to, radius, caps } => {
                Frustum::cylinder(local(from), local(to), radius, caps).map(|made| Arc::new(made) as _)
            }
            Form::Cone { from, to, radius, end_radius, caps } => {
                Frustum::new(local(from), local(to), [radius, end_radius], caps)
                    .map(|made| Arc::new(made) as _)
            }
            Form::Torus { center, axis, major_radius, minor_radius } => {
                Torus::new(local(center), axis, major_radius, minor_radius).map(|made| Arc::new(made) as _)
            }
            _ => None,
        };
        if surface.is_none() {
            // Files are checked when they are loaded; a description made by a program is not.
            self.problems.push(Problem::at(place.clone(), "the shape's measures span no body"));
        }
        surface.map(Shape::Surface)
    }

    /// The mesh of a height field, counted from `origin`.
    pub(super) fn height_field(&mut self, form: &Form, origin: DVec3, place: &Place) -> Option<Shape> {
        let Form::HeightField { file, center, size, height, normals } = form else { return None };
        let field = self.heights_of_file(file, *height)?;
        let [columns, rows] = field.counts().map(|count| count as usize - 1);
        if !self.may_hold(2 * columns * rows, &file.place) {
            return None;
        }
        let smooth = *normals == HeightNormals::Smooth;
        self.mesh_of(field.mesh((*center - origin).as_vec3(), Vec2::from(*size), smooth), place)
    }

    /// A mesh made of numbers, unless they are too large for one.
    pub(super) fn mesh_of(&mut self, made: Result<Mesh, MeshError>, place: &Place) -> Option<Shape> {
        match made {
            Ok(mesh) => Some(Shape::Mesh(mesh)),
            Err(error) => {
                let problem = Problem::at(place.clone(), error.to_string());
                self.problems.push(problem.remedy("scale the scene down"));
                None
            }
        }
    }

    fn heights_of_file(&mut self, file: &Located<PathBuf>, [black, white]: [f32; 2]) -> Option<HeightField> {
        if !self.may_read(1, &file.place) {
            return None;
        }
        let (library, trust) = (self.library.clone(), &self.trust);
        let picture = library.thing(&file.value, library::Form::Heights, trust, || {
            let thing = image::read_gray_within(&file.value, trust)?;
            let takes = (Limit::Texels, thing.values.len() as u64);
            Ok(Made { bytes: size_of_val(&thing.values[..]), takes, thing, more: vec![] })
        });
        let picture = match picture {
            Ok(picture) => picture,
            Err(error) => {
                self.problems.absorb(error, Some(&file.place));
                return None;
            }
        };
        let heights = picture.values.iter().map(|value| black + (white - black) * value).collect();
        match HeightField::new(picture.width, picture.height, heights) {
            Ok(field) => Some(field),
            Err(error) => {
                let problem = Problem::at(Place::file(&file.value), error.to_string());
                self.problems.push(problem.remedy("check the picture and the range `height`"));
                None
            }
        }
    }
}
