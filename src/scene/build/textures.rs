//! Pictures on surfaces, each file read once.
//!
//! A file that is missing or cannot be read is warned of, with the place that names it, and the surface is as if the key were not there: flat,
//! whole, polished, dark. Only its colour is a gray of its own, lest the lack go unseen.

use crate::error::{Error, Place, Problem};
use crate::image::read_raster_within;
use crate::material::Material;
use crate::math::Rgb;
use crate::scene::build::Builder;
use crate::scene::description::{self, ImageTexture, Lie, Located, ScalarTexture};
use crate::scene::library::{self, Made};
use crate::scene::load::files;
use crate::texture::{Bitmap, Channel, Height, Heights, Mapped, NormalMap, Relief, Scalar, Space, Texture};
use crate::trust::Limit;
use std::collections::{HashMap, HashSet};
use std::mem;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// Pictures that have been read.
#[derive(Debug, Default)]
pub(super) struct Textures {
    /// By file and by what its numbers stand for: smaller sizes depend on that. None could not be read, which was told.
    known: HashMap<(PathBuf, Option<Space>), Option<Arc<Bitmap>>>,
    /// In the order met.
    bitmaps: Vec<Arc<Bitmap>>,
    /// What is odd about files where they colour something, until it has been told.
    as_colour: HashMap<PathBuf, Vec<Problem>>,
    /// Whether those that are asked for are named by an MTL file, whose keywords are used loosely.
    pub(super) of_mtl: bool,
}

impl Textures {
    /// The files of all of them.
    pub(super) fn files(&self) -> impl Iterator<Item = &Path> {
        self.known.keys().map(|(path, _)| path.as_path())
    }

    /// All of them, or those alone that materials show. Whoever else holds some does not count, such as a library.
    pub(super) fn into_bitmaps(self, shown_by: Option<&[Material]>) -> Vec<Arc<Bitmap>> {
        let mut bitmaps = self.bitmaps;
        if let Some(materials) = shown_by {
            let shown: HashSet<_> = materials.iter().flat_map(Material::bitmaps).map(Arc::as_ptr).collect();
            bitmaps.retain(|bitmap| shown.contains(&Arc::as_ptr(bitmap)));
        }
        bitmaps
    }
}

/// The channel where none is said: the shade of gray pictures.
const SHADE: Channel = Channel::Red;

/// What becomes of a surface without the picture of a file that cannot be read.
const GRAY: &str = "the surface is made gray";
const DARK: &str = "the surface does not shine by it";
const WHOLE: &str = "the surface is left whole";
const EVEN: &str = "the surface is left even";

impl Builder {
    /// What colours something that reflects.
    pub(super) fn texture(&mut self, texture: &description::Texture) -> Texture {
        self.colored(texture, 1.0)
    }

    /// A texture of which no channel exceeds a limit. Where its file cannot be read, what reflects is middle gray, and what would
    /// shine, which has no limit, is black.
    pub(super) fn colored(&mut self, texture: &description::Texture, limit: f32) -> Texture {
        let texture = match texture {
            description::Texture::Constant(color) => Texture::Constant(*color),
            description::Texture::Checker(checker) => {
                Texture::Checker { colors: checker.checker, repeat: checker.repeat.into() }
            }
            description::Texture::Image(image) => {
                let &ImageTexture { ref file, space, factor, ref lie } = &**image;
                let (fallback, without) =
                    if limit.is_finite() { (Rgb::gray(0.5), GRAY) } else { (Rgb::BLACK, DARK) };
                let map = self.mapped(file, space, lie, without);
                let odd = self.textures.as_colour.get_mut(&canonical(&file.value)).map(mem::take);
                self.warnings.extend(odd.into_iter().flatten());
                map.map_or(Texture::Constant(fallback), |map| Texture::Image { map, factor, limit })
            }
        };
        // Light is drawn from in another way where it comes from a picture or a pattern.
        if limit.is_infinite() { texture } else { self.as_constant(texture) }
    }

    /// A number that varies over a surface; `without` says what becomes of it where the file cannot be read.
    pub(super) fn scalar(&mut self, image: &ScalarTexture, without: &str) -> Option<Scalar> {
        let &ScalarTexture { ref file, channel, space, factor, ref lie } = image;
        let map = self.mapped(file, Some(space), lie, without)?;
        Some(Scalar { map, channel: channel.unwrap_or(SHADE), factor })
    }

    /// Where a surface is; coverage where the file has it.
    pub(super) fn opacity(&mut self, image: &ScalarTexture) -> Option<Scalar> {
        // Coverage has no curve: what has been read as a colour serves as well.
        let path = canonical(&image.file.value);
        let colored = self.textures.known.get(&(path, None)).and_then(Option::as_ref);
        let colored = colored.filter(|bitmap| bitmap.has_alpha()).cloned();
        let is_alpha = matches!(image.channel, None | Some(Channel::Alpha));
        let mut scalar = match colored.filter(|_| is_alpha) {
            Some(bitmap) => {
                let map = lying(bitmap, &image.lie);
                Scalar { map, channel: Channel::Alpha, factor: image.factor }
            }
            None => self.scalar(image, WHOLE)?,
        };
        if image.channel.is_none() && scalar.map.bitmap.has_alpha() {
            scalar.channel = Channel::Alpha;
        }
        Some(scalar)
    }

    /// A relief.
    pub(super) fn relief(&mut self, material: &description::Material) -> Option<Relief> {
        match (&material.normal_map, &material.bump) {
            (Some(normals), None) => Some(Relief::Normals(self.normal_map(normals)?)),
            (None, Some(heights)) => self.bump(heights),
            (None, None) => None,
            (Some(_), Some(heights)) => {
                let problem = Problem::at(heights.file.place.clone(), "`bump` beside `normal_map`");
                self.problems.push(problem.remedy("give one of them"));
                None
            }
        }
    }

    /// Heights. What MTL files call so are often normals.
    fn bump(&mut self, described: &description::Bump) -> Option<Relief> {
        let &description::Bump { ref file, channel, strength, height, ref lie } = described;
        let map = self.mapped(file, Some(Space::Linear), lie, EVEN)?;
        let [r, g, b, _] = map.bitmap.mean();
        let are_normals = b - r.max(g) > 0.2 && (r - 0.5).abs().max((g - 0.5).abs()) < 0.15;
        if are_normals && channel.is_none() {
            if self.textures.of_mtl {
                let strength = self.lean(strength, &file.place);
                return Some(Relief::Normals(NormalMap { map, strength, flip_y: false }));
            }
            let what = format!("`{}` looks like a picture of normals, not of heights", file.value.display());
            let remedy = "name it `normal_map`, or say which `channel` has the heights";
            self.warnings.push(Problem::at(file.place.clone(), what).remedy(remedy));
        }
        let height = height.map_or(Height::Texels(strength), Height::Metres);
        Some(Relief::Heights(Heights { map, channel: channel.unwrap_or(SHADE), height }))
    }

    /// What `-bm` multiplies the lean of normals by, as for `norm`: numbers that no normal map has are ignored.
    fn lean(&mut self, strength: f32, place: &Place) -> f32 {
        if (0.0..=100.0).contains(&strength) {
            return strength;
        }
        let what = format!("`-bm` of {strength} is ignored, since the picture is one of normals");
        self.warnings.push(Problem::at(place.clone(), what).remedy("give it numbers from 0 to 100"));
        1.0
    }

    fn normal_map(&mut self, described: &description::NormalMap) -> Option<NormalMap> {
        let &description::NormalMap { ref file, strength, flip_y, ref lie } = described;
        let map = self.mapped(file, Some(Space::Linear), lie, EVEN)?;
        Some(NormalMap { map, strength, flip_y })
    }

    fn mapped(
        &mut self,
        file: &Located<PathBuf>,
        space: Option<Space>,
        lie: &Lie,
        without: &str,
    ) -> Option<Mapped> {
        Some(lying(self.bitmap(file, space, without)?, lie))
    }

    fn bitmap(
        &mut self,
        file: &Located<PathBuf>,
        space: Option<Space>,
        without: &str,
    ) -> Option<Arc<Bitmap>> {
        let key = (canonical(&file.value), space);
        if let Some(known) = self.textures.known.get(&key) {
            return known.clone();
        }
        let read = self.read(file, space, without).map(|bitmap| {
            // The same may have been met with its space written out, or left to the file.
            let same = self.textures.bitmaps.iter().find(|known| **known == bitmap).cloned();
            same.unwrap_or_else(|| {
                self.textures.bitmaps.push(bitmap.clone());
                bitmap
            })
        });
        self.textures.known.insert(key, read.clone());
        read
    }

    fn read(&mut self, file: &Located<PathBuf>, space: Option<Space>, without: &str) -> Option<Arc<Bitmap>> {
        // Of what lies where it must not nothing is told, not even whether it is there.
        if let Some((what, remedy)) = self.trust.outside(&file.value) {
            self.problems.push(Problem::at(file.place.clone(), what).remedy(remedy));
            return None;
        }
        if let Some((what, remedy)) = files::absence(&file.value) {
            self.warn(file, what, format!("{remedy}; {without}"));
            return None;
        }
        if !self.may_read(1, &file.place) {
            return None;
        }
        let (library, trust) = (self.library.clone(), &self.trust);
        let read = library.thing(&file.value, library::Form::Bitmap(space), trust, || {
            let raster = read_raster_within(&file.value, trust)?;
            let own = if raster.encoded { Space::Srgb } else { Space::Linear };
            let bitmap = Bitmap::new(&raster, space.unwrap_or(own));
            let takes = (Limit::Texels, u64::from(raster.width) * u64::from(raster.height));
            let bytes = bitmap.bytes();
            let told = [raster.warnings, raster.as_colour];
            Ok(Made { bytes, thing: (Arc::new(bitmap), told, takes.1), takes, more: vec![] })
        });
        match read {
            Ok(read) => {
                let (bitmap, [warnings, as_colour], texels) = &*read;
                self.taken.texels += texels;
                if !self.may_take(Limit::Textures, self.taken.texels, &file.place) {
                    return None;
                }
                self.warnings.extend(warnings.iter().cloned());
                let odd = self.textures.as_colour.entry(canonical(&file.value));
                odd.or_insert_with(|| as_colour.clone());
                Some(bitmap.clone())
            }
            // Right or wrong, it is not what the surface can do without.
            Err(error @ Error::Refused(_)) => {
                self.problems.push(Problem::at(file.place.clone(), error.to_string()));
                None
            }
            Err(Error::Input(problems)) => {
                self.warn(file, problems.to_string(), without.to_owned());
                None
            }
            Err(other) => {
                self.warn(file, other.to_string(), without.to_owned());
                None
            }
        }
    }

    fn warn(&mut self, file: &Located<PathBuf>, what: String, remedy: String) {
        let problem = Problem::at(file.place.clone(), what).remedy(remedy);
        if !self.textures.of_mtl {
            self.unread.push(problem.clone());
        }
        self.warnings.push(problem);
    }
}

/// The one name of a file.
pub(super) fn canonical(path: &Path) -> PathBuf {
    path.canonicalize().unwrap_or_else(|_| path.to_owned())
}

fn lying(bitmap: Arc<Bitmap>, &Lie { wrap, repeat, offset }: &Lie) -> Mapped {
    Mapped { bitmap, wrap, repeat: repeat.into(), offset: offset.into() }
}
