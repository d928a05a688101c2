//! What has no effect: found while a scene is built, left out, and told.

use crate::error::Place;
use crate::geometry::Mesh;
use crate::material::{Material, MaterialId, Scattering};
use crate::math::Rgb;
use crate::scene::build::Builder;
use crate::scene::description::{self, Description, Form, Located};
use crate::scene::library;
use crate::scene::load::LoadedMesh;
use crate::scene::pruned::{Ineffective, Pruned};
use crate::texture::{Bitmap, Channel, Height, Relief, Scalar, Texture};
use std::collections::{HashMap, HashSet};
use std::path::PathBuf;
use std::sync::Arc;

/// Opacities closer to a half than this may fall to either side, by the rounding of an interpolation.
const UNDECIDED: f32 = 1e-5;

/// A file, and what its mesh was asked for as.
type Asked = (PathBuf, library::Form);

/// Meshes of files that have been read.
#[derive(Debug, Default)]
pub(super) struct Meshes {
    known: HashMap<Asked, Arc<LoadedMesh>>,
    /// Those unlike each other, by how many vertices and triangles they have.
    alike: HashMap<[usize; 2], Vec<Mesh>>,
}

impl Meshes {
    /// The mesh of a file that has been read in the same way.
    pub(super) fn known(&self, asked: &Asked) -> Option<Arc<LoadedMesh>> {
        self.known.get(asked).cloned()
    }

    /// Notes one; the same mesh from another file stands for it. Whether there was one.
    pub(super) fn note(&mut self, asked: Asked, loaded: &mut Arc<LoadedMesh>) -> bool {
        let size = [loaded.mesh.positions().len(), loaded.mesh.triangles().len()];
        let alike = self.alike.entry(size).or_default();
        let same = alike.iter().find(|known| **known == loaded.mesh).cloned();
        let is_known = same.is_some();
        match same {
            Some(mesh) => *loaded = Arc::new(LoadedMesh { mesh, ..LoadedMesh::clone(loaded) }),
            None => alike.push(loaded.mesh.clone()),
        }
        self.known.insert(asked, loaded.clone());
        is_known
    }
}

impl Builder {
    /// Notes that something was left out.
    pub(super) fn prune(&mut self, kind: Ineffective, what: impl Into<String>, place: Option<&Place>) {
        self.pruned.push(Pruned { kind, what: what.into(), place: place.cloned(), bytes: 0 });
    }

    /// Notes that a mesh was there already.
    pub(super) fn prune_mesh(&mut self, file: &Located<PathBuf>, mesh: &Mesh) {
        let what = format!("{} was read before: its arrays are shared", file.value.display());
        let place = Some(file.place.clone());
        self.pruned.push(Pruned { kind: Ineffective::Mesh, what, place, bytes: mesh.bytes() });
    }

    /// A surface without lobes of weight zero.
    pub(super) fn without_empty_lobes(&mut self, scattering: Scattering) -> Scattering {
        if !self.prunes {
            return scattering;
        }
        let (what, rest) = match scattering {
            Scattering::Glossy { lobe, base } if lobe.reflectance.is_black() => {
                ("its fuzzy mirror reflects nothing", Scattering::Diffuse { reflectance: base })
            }
            Scattering::Phong { lobe, base } if lobe.reflectance.is_black() => {
                ("its lobe reflects nothing", Scattering::Diffuse { reflectance: base })
            }
            Scattering::Jitter { lobe, base } if lobe.reflectance.is_black() => {
                ("its mirror reflects nothing", Scattering::Diffuse { reflectance: base })
            }
            Scattering::Diffuse { reflectance: Texture::Constant(color) }
            | Scattering::OrenNayar { reflectance: Texture::Constant(color), .. }
                if color.is_black() =>
            {
                ("it reflects nothing", Scattering::Black)
            }
            whole => return whole,
        };
        self.prune(Ineffective::Lobe, what, None);
        rest
    }

    /// The texture as one colour, where a picture or a pattern comes to that. Not for light.
    pub(super) fn as_constant(&mut self, texture: Texture) -> Texture {
        let constant = match &texture {
            _ if !self.prunes => None,
            Texture::Image { map, factor, limit } => match map.bitmap.constant() {
                [Some(r), Some(g), Some(b), _] => Some((Rgb::new(r, g, b) * *factor).clamp(0.0, *limit)),
                _ => None,
            },
            Texture::Checker { colors: [a, b], .. } => (a == b).then_some(*a),
            Texture::Constant(_) => None,
        };
        let Some(color) = constant else { return texture };
        self.prune(Ineffective::Texture, "of one colour", None);
        Texture::Constant(color)
    }

    /// The number that a picture comes to, if it is the same everywhere.
    pub(super) fn constant(&mut self, scalar: &Scalar) -> Option<f32> {
        if !self.prunes {
            return None;
        }
        let value = channel(&scalar.map.bitmap, scalar.channel)?;
        Some((value * scalar.factor).clamp(0.0, 1.0))
    }

    /// The opacity, unless the surface is there everywhere.
    pub(super) fn unless_whole(&mut self, opacity: Scalar) -> Option<Scalar> {
        if self.constant(&opacity).is_some_and(|value| value > 0.5 + UNDECIDED) {
            self.prune(Ineffective::Texture, "an opacity without holes", None);
            return None;
        }
        Some(opacity)
    }

    /// The relief, unless it is even.
    pub(super) fn unless_even(&mut self, relief: Relief) -> Option<Relief> {
        let is_even = self.prunes
            && match &relief {
                Relief::Normals(normals) => {
                    let [x, y, z, _] = normals.map.bitmap.constant();
                    let leans = |c: Option<f32>| c.is_none_or(|c| c * 2.0 - 1.0 != 0.0);
                    normals.strength == 0.0 || !leans(x) && !leans(y) && z.is_some_and(|z| z > 0.5)
                }
                Relief::Heights(heights) => {
                    let (Height::Metres(height) | Height::Texels(height)) = heights.height;
                    height == 0.0 || channel(&heights.map.bitmap, heights.channel).is_some()
                }
            };
        if is_even {
            self.prune(Ineffective::Texture, "a relief that is even", None);
            return None;
        }
        Some(relief)
    }

    /// Whether nothing is left of a shape made of these materials, but holes.
    pub(super) fn is_invisible(&mut self, materials: &[MaterialId]) -> bool {
        let opacities: Vec<Option<Scalar>> =
            materials.iter().map(|id| self.materials[id.index()].opacity.clone()).collect();
        !opacities.is_empty()
            && opacities.iter().all(|opacity| {
                let value = opacity.as_ref().and_then(|opacity| self.constant(opacity));
                value.is_some_and(|value| value < 0.5 - UNDECIDED)
            })
    }
}

/// A number of a picture, if it is the same everywhere.
fn channel(bitmap: &Bitmap, channel: Channel) -> Option<f32> {
    let [r, g, b, a] = bitmap.constant();
    match channel {
        Channel::Red => r,
        Channel::Green => g,
        Channel::Blue => b,
        Channel::Alpha => a,
    }
}

/// The names of materials that something visible is made of, or a part of them.
pub(super) fn referenced(description: &Description) -> HashSet<&str> {
    let shapes = &description.shapes;
    let by_name: HashMap<&str, &description::Shape> =
        shapes.iter().filter_map(|shape| Some((shape.name.as_ref()?.value.as_str(), &shape.value))).collect();
    let mut found: HashSet<&str> = HashSet::new();
    for shape in shapes.iter().filter(|shape| !shape.hidden) {
        let mut link: &description::Shape = shape;
        loop {
            found.extend(link.material.as_ref().map(|name| name.value.as_str()));
            let Form::Instance { of } = &link.form else { break };
            // References were checked to exist and not to run in circles.
            let Some(next) = by_name.get(of.value.as_str()) else { break };
            link = next;
        }
    }
    let parts = description.materials.iter().filter(|named| found.contains(named.name.as_str()));
    let parts: Vec<&str> = parts
        .filter_map(|named| match &named.value.scattering {
            description::Scattering::Mix { parts } => Some(parts),
            _ => None,
        })
        .flatten()
        .map(|part| part.material.value.as_str())
        .collect();
    found.extend(parts);
    found
}

/// What stands for a material that nothing is made of, so that the numbers of the others stay.
pub(super) const UNUSED: Material =
    Material { scattering: Scattering::Black, emission: None, relief: None, opacity: None };
