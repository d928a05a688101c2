//! Pictures that MTL files name.
//!
//! A statement is a keyword, options and the name of a file, which may hold spaces. Of the options `-o`, `-s`, `-clamp` and `-bm`
//! mean something here: where the picture lies, what is beyond its edges, and how strong a relief is. Files are looked for beside
//! the MTL file.

use crate::error::{Place, Problem};
use crate::image::RASTERS;
use crate::math::Rgb;
use crate::scene::description::{
    Bump, ImageTexture, Lie, Located, NormalMap, ScalarTexture, Space, Texture, Wrap,
};
use crate::scene::load::files;
use crate::trust::Trust;
use std::ops::RangeInclusive;
use std::path::{Path, PathBuf};

/// What the pictures of a material are for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Use {
    /// `map_Kd`.
    Diffuse,
    /// `map_Ke`.
    Emission,
    /// `map_d`.
    Opacity,
    /// `norm`.
    Normal,
    /// `map_Bump` or `bump`.
    Bump,
}

impl Use {
    pub(super) fn of(keyword: &str) -> Option<Self> {
        Some(match keyword {
            "map_Kd" => Self::Diffuse,
            "map_Ke" => Self::Emission,
            "map_d" => Self::Opacity,
            "norm" => Self::Normal,
            "map_bump" | "map_Bump" | "bump" => Self::Bump,
            _ => return None,
        })
    }

    fn is_relief(self) -> bool {
        matches!(self, Self::Normal | Self::Bump)
    }

    /// What becomes of the surface where there is no such file.
    fn without(self) -> &'static str {
        match self {
            Self::Diffuse => "the surface is made gray",
            Self::Emission => "the surface shines as `Ke` says",
            Self::Opacity => "the surface is left whole",
            Self::Normal | Self::Bump => "the surface is left even",
        }
    }
}

/// The pictures of a material.
#[derive(Clone, Debug, Default)]
pub(super) struct Maps {
    /// `Some(None)` where it is missing.
    diffuse: Option<Option<Map>>,
    emission: Option<Map>,
    pub(super) opacity: Option<Map>,
    pub(super) normal: Option<Map>,
    pub(super) bump: Option<Map>,
}

/// A picture, and how it lies.
#[derive(Clone, Debug)]
pub(super) struct Map {
    file: Located<PathBuf>,
    lie: Lie,
    strength: f32,
}

impl Maps {
    /// Notes what follows a keyword; warnings where the file or a number cannot be used. Fails where the file lies where it must not.
    pub(super) fn add(
        &mut self,
        what: Use,
        rest: &str,
        (mtl, trust): (&Path, &Trust),
        place: Place,
    ) -> Result<Vec<Problem>, Problem> {
        let mut warnings = Vec::new();
        let map = Map::read(what, rest, mtl, place.clone(), &mut warnings);
        if let Some((fault, remedy)) = trust.outside(&map.file.value) {
            return Err(Problem::at(place, fault).remedy(remedy));
        }
        let map = match files::fault(&map.file.value, RASTERS, trust) {
            None => Some(map),
            Some((fault, remedy)) => {
                let remedy = format!("{remedy}; {}", what.without());
                warnings.push(Problem::at(place, fault).remedy(remedy));
                None
            }
        };
        match what {
            Use::Diffuse => self.diffuse = Some(map),
            Use::Emission => self.emission = map,
            Use::Opacity => self.opacity = map,
            Use::Normal => self.normal = map,
            Use::Bump => self.bump = map,
        }
        Ok(warnings)
    }

    /// Whether the material is coloured by a picture, there or missing.
    pub(super) fn has_diffuse(&self) -> bool {
        self.diffuse.is_some()
    }

    /// What is reflected by a base of the colour `kd`, with its picture; middle gray where that is missing.
    pub(super) fn colored(&self, kd: Option<Rgb<f32>>) -> Texture {
        match &self.diffuse {
            None => Texture::Constant(kd.unwrap_or(Rgb::gray(0.5))),
            Some(None) => Texture::gray(0.5),
            Some(Some(map)) => map.colored(factor(kd.unwrap_or(Rgb::BLACK))),
        }
    }

    /// What is given off where `Ke` says so much.
    pub(super) fn shining(&self, ke: Rgb<f32>) -> Texture {
        self.emission.as_ref().map_or(Texture::Constant(ke), |map| map.colored(factor(ke)))
    }
}

impl Map {
    /// Numbers that scene files could not hold are left out and warned of. The file may not be there.
    fn read(what: Use, rest: &str, mtl: &Path, place: Place, warnings: &mut Vec<Problem>) -> Self {
        let mut lie = Lie { wrap: Wrap::Repeat, repeat: [1.0; 2], offset: [0.0; 2] };
        let mut strength = [1.0];
        let mut rest = rest.trim();
        while let Some(option) = rest.strip_prefix('-') {
            let (name, values) = option.split_once(char::is_whitespace).unwrap_or((option, ""));
            let most = match name {
                "o" | "s" | "t" => 3,
                "mm" => 2,
                "blendu" | "blendv" | "cc" | "clamp" | "boost" | "texres" | "bm" | "imfchan" | "type" => 1,
                _ => break,
            };
            let (words, after) = take(values, most, matches!(name, "o" | "s" | "t" | "mm" | "bm"));
            let mut set = |to: &mut [f32], allowed: RangeInclusive<f32>| {
                for (to, x) in to.iter_mut().zip(words.iter().filter_map(|word| word.parse().ok())) {
                    if allowed.contains(&x) {
                        *to = x;
                    } else {
                        let (low, high) = (allowed.start(), allowed.end());
                        let problem = Problem::at(place.clone(), format!("`-{name}` of {x} is ignored"));
                        warnings.push(problem.remedy(format!("give it numbers from {low} to {high}")));
                    }
                }
            };
            match name {
                "clamp" if words.first() == Some(&"on") => lie.wrap = Wrap::Clamp,
                "o" => set(&mut lie.offset, -1e6..=1e6),
                "s" if what.is_relief() => set(&mut lie.repeat, f32::MIN_POSITIVE..=1e6),
                "s" => set(&mut lie.repeat, -1e6..=1e6),
                "bm" if what == Use::Normal => set(&mut strength, 0.0..=100.0),
                "bm" => set(&mut strength, -1e4..=1e4),
                _ => {}
            }
            rest = after;
        }
        let [strength] = strength;
        let file = mtl.with_file_name(rest.replace('\\', "/"));
        Self { file: Located { value: file, place }, lie, strength }
    }

    fn colored(&self, factor: Rgb<f32>) -> Texture {
        let Self { file, lie, .. } = self.clone();
        Texture::Image(Box::new(ImageTexture { file, space: None, factor, lie }))
    }

    /// How much is there.
    pub(super) fn opacity(self) -> ScalarTexture {
        let Self { file, lie, .. } = self;
        ScalarTexture { file, channel: None, space: Space::Linear, factor: 1.0, lie }
    }

    /// A relief of heights. The unit of `-bm` is not said; texels are what programs of its time counted in.
    pub(super) fn heights(self) -> Bump {
        let Self { file, lie, strength } = self;
        Bump { file, channel: None, strength, height: None, lie }
    }

    /// A relief of normals.
    pub(super) fn normal(self) -> NormalMap {
        let Self { file, lie, strength } = self;
        NormalMap { file, strength, flip_y: false, lie }
    }
}

/// What a picture is multiplied by: exporters often write black beside it.
fn factor(color: Rgb<f32>) -> Rgb<f32> {
    if color.is_black() { Rgb::WHITE } else { color }
}

/// Up to `most` words, only such as are numbers where these are `wanted`, and what follows them.
fn take(text: &str, most: usize, wanted: bool) -> (Vec<&str>, &str) {
    let (mut words, mut rest) = (Vec::new(), text.trim_start());
    while words.len() < most {
        let word = rest.split_whitespace().next().unwrap_or("");
        if word.is_empty() || (wanted && word.parse::<f32>().is_err()) {
            break;
        }
        words.push(word);
        rest = rest[word.len()..].trim_start();
    }
    (words, rest)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::trust::Sandbox;

    #[test]
    fn options_stand_before_names_with_spaces() {
        let dir = tempfile::tempdir().expect("a directory");
        std::fs::create_dir(dir.path().join("sub")).expect("made");
        std::fs::write(dir.path().join("sub/my wood.png"), b"").expect("written");
        let mtl = dir.path().join("x.mtl");
        let read = |rest: &str| Map::read(Use::Bump, rest, &mtl, Place::file(&mtl), &mut vec![]);
        let map = read("-s 2 3 1 -o 0.5 -clamp on -bm 0.25 -blendu off sub\\my wood.png");
        assert_eq!(map.file.value, dir.path().join("sub/my wood.png"), "name");
        assert_eq!(
            (map.lie.repeat, map.lie.offset, map.lie.wrap),
            ([2.0, 3.0], [0.5, 0.0], Wrap::Clamp),
            "options"
        );
        assert!((map.strength - 0.25).abs() < 1e-6, "strength");
        let mut maps = Maps::default();
        let told = maps.add(Use::Bump, "-s 1 1 1 nothing.png", (&mtl, &Trust::default()), Place::file(&mtl));
        let told = told.expect("a warning");
        assert!(told.len() == 1 && told[0].to_string().contains("no such file"), "{told:?}");
        assert!(maps.bump.is_none(), "missing");
    }

    #[test]
    fn pictures_outside_of_a_sandbox_are_refused_be_they_there_or_not() {
        let dir = tempfile::tempdir().expect("a directory");
        let inner = dir.path().join("inner");
        std::fs::create_dir(&inner).expect("made");
        std::fs::write(dir.path().join("a.png"), b"").expect("written");
        std::fs::write(inner.join("b.png"), b"").expect("written");
        let trust = Trust { sandbox: Some(Sandbox::new(&inner)), ..Trust::default() };
        let mtl = inner.join("x.mtl");
        let add = |name: &str| Maps::default().add(Use::Diffuse, name, (&mtl, &trust), Place::file(&mtl));
        for name in ["../a.png", "..\\a.png", "../lost.png", "/lost.png"] {
            let problem = add(name).expect_err(name).to_string();
            assert!(problem.contains("lies outside of the scene's folder"), "{problem}");
        }
        assert_eq!(add("b.png").expect("inside"), [], "there");
        assert_eq!(add("lost.png").expect("inside").len(), 1, "a warning");
    }

    #[test]
    fn numbers_that_no_scene_file_could_hold_are_left_out_and_told() {
        let dir = tempfile::tempdir().expect("a directory");
        std::fs::write(dir.path().join("a.png"), b"").expect("written");
        let mtl = dir.path().join("x.mtl");
        let read = |what: Use, rest: &str| {
            let mut warnings = Vec::new();
            let map = Map::read(what, rest, &mtl, Place::file(&mtl), &mut warnings);
            (map.lie.repeat, map.lie.offset, map.strength, warnings.len())
        };
        let plain = |warnings: usize| ([1.0; 2], [0.0; 2], 1.0, warnings);
        assert_eq!(read(Use::Diffuse, "-s nan nan -o inf 1e30 a.png"), plain(4), "not finite, too large");
        assert_eq!(read(Use::Bump, "-bm 1e30 -s 0 -1 a.png"), plain(3), "a relief");
        assert_eq!(read(Use::Normal, "-bm -1 a.png"), plain(1), "normals");
        let kept = ([-2.0, 0.0], [0.5, 0.0], 1.0, 1);
        assert_eq!(read(Use::Diffuse, "-s -2 0 -o 0.5 nan a.png"), kept, "the others stay");
    }
}
