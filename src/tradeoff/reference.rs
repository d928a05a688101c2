//! The picture that all others are compared with, and how well it is known.

use super::design::Axis;
use super::knobs::Knob;
use super::moments::Measure;
use super::runs::{Bench, Easel};
use super::subject::Subject;
use crate::error::{Place, Problem, Result};
use crate::image::exr::{self, Channel, Picture, Samples};
use crate::image::{self, Decoded, Image, Range, Window};
use crate::math::Rgb;
use crate::scene::digits;
use crate::trust::{Limits, Trust};
use serde_json::{Value, json};
use std::path::{Path, PathBuf};
use xxhash_rust::xxh3::Xxh3;

/// A picture as near to the truth as it is.
#[derive(Clone, Debug, PartialEq)]
pub struct Reference {
    /// The picture.
    pub image: Image,
    /// The variance of each value, where it is known.
    pub variances: Option<Vec<[f32; 3]>>,
    /// From how many pictures that is estimated.
    pub pictures: u32,
    /// Where it is from.
    pub origin: Origin,
}

/// Where a reference is from.
#[derive(Clone, Debug, PartialEq)]
pub enum Origin {
    /// A file.
    File(PathBuf),
    /// It was rendered, with these values of the scene file replaced and so many samples per pixel.
    Rendered {
        /// Keys and values.
        settings: Vec<(String, String)>,
        /// Samples per pixel, all pictures together.
        spp: u32,
    },
}

/// A rendered reference is the mean of so many pictures with different seeds, so that its variance is known.
const PICTURES: u32 = 4;

/// How far seeds of the reference are from those of runs: there are never so many runs.
const SEEDS: u64 = 1 << 24;

impl Reference {
    /// The one in an `.exr` or `.hdr` file, of a picture of `size`. Its variance is that of the channels `variance.R`, `.G` and `.B`, which
    /// `specula render --aov variance` writes.
    ///
    /// Fails if it cannot be read, is beyond limits or of another size.
    pub fn read(path: &Path, size: [u32; 2], limits: Limits) -> Result<Self> {
        let trust = Trust { limits, sandbox: None };
        let is_exr = path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("exr"));
        if is_exr {
            return Self::of_picture(exr::read_within(path, &trust)?, path, size);
        }
        Self::of_file((image::read_as_stored(path, &trust)?, None), path, size)
    }

    /// The one in an EXR file that was read.
    fn of_picture(picture: Picture, path: &Path, size: [u32; 2]) -> Result<Self> {
        let variances = variances(&picture);
        Self::of_file((picture.into_stored(path)?, variances), path, size)
    }

    /// What a file has, checked.
    fn of_file(
        (decoded, variances): (Decoded, Option<Vec<[f32; 3]>>),
        path: &Path,
        size: [u32; 2],
    ) -> Result<Self> {
        let refused =
            |what: String, remedy: &str| Err(Problem::at(Place::file(path), what).remedy(remedy).into());
        if decoded.range != Range::Scene {
            let what = "what a display shows is no reference for light of a scene".to_owned();
            return refused(what, "use an .exr or .hdr file");
        }
        let [width, height] = size;
        if decoded.full != size || decoded.window != Window::whole(width, height) {
            let [has, rows] = decoded.full;
            let what = format!(
                "a picture of {has} by {rows} pixels, or a part of it, for one of {width} by {height}"
            );
            return refused(
                what,
                "render the reference at the size of the sweep, or set film.width and film.height",
            );
        }
        if !decoded.image.pixels().iter().any(|p| p.r.is_finite() && p.g.is_finite() && p.b.is_finite()) {
            return refused("no pixel of it is finite".to_owned(), "render it again");
        }
        let origin = Origin::File(path.to_owned());
        Ok(Self { image: decoded.image, variances, pictures: 0, origin })
    }

    /// Values of knobs that are nearest to the truth, among those of a sweep and what the scene says: keys and values.
    #[must_use]
    pub fn settings(subject: &Subject, axes: &[Axis]) -> Vec<(String, String)> {
        let truest = |axis: &Axis| {
            let said = subject.said(&axis.key);
            let values = axis.values.iter().map(String::as_str).chain(said.as_deref());
            let value = Knob::of(&axis.knob)?.truest(values)?;
            Some((axis.key.clone(), value.to_owned()))
        };
        axes.iter().filter_map(truest).collect()
    }

    /// Samples that rendering one of `spp` takes.
    #[must_use]
    pub fn samples(spp: u32, pixels: u64) -> u64 {
        u64::from(rounded(spp)) * pixels
    }

    /// What [`Reference::about`] will tell of one that is rendered so, as far as that is known before.
    #[must_use]
    pub fn planned(settings: &[(String, String)], spp: u32) -> Value {
        json!({ "settings": settings, "spp": rounded(spp) })
    }

    /// Renders one of at least `spp` samples per pixel.
    ///
    /// Fails as rendering does.
    pub fn render(
        subject: &mut Subject,
        mut settings: Vec<(String, String)>,
        spp: u32,
        bench: &Bench<'_>,
    ) -> Result<Self> {
        let each = rounded(spp) / PICTURES;
        settings.push(("render.spp".to_owned(), each.to_string()));
        let description = subject.described(&settings)?;
        settings.pop();
        let first = subject.base().render.seed.wrapping_add(SEEDS);
        let (mut easel, mut pictures) = (Easel::new(bench)?, Vec::new());
        for number in 0..PICTURES {
            let scene = subject.scene(&description, first.wrapping_add(u64::from(number)))?;
            pictures.push(easel.render(scene)?.film.image());
        }
        let (image, variances) = mean(&pictures);
        let origin = Origin::Rendered { settings, spp: each * PICTURES };
        Ok(Self { image, variances: Some(variances), pictures: PICTURES, origin })
    }

    /// What noise of its own it has in relMSE, and how uncertain that is ([`Measure::floor`]); zero where it is not known.
    #[must_use]
    pub fn floor(&self) -> [f64; 2] {
        self.measure().floor()
    }

    /// What pictures are measured with.
    #[must_use]
    pub fn measure(&self) -> Measure {
        let noise = self.variances.as_ref().map(|variances| (&variances[..], self.pictures));
        Measure::new(&self.image, noise)
    }

    /// What tells it from others: where it is from, and its numbers.
    #[must_use]
    pub fn about(&self) -> Value {
        let mut hasher = Xxh3::new();
        for pixel in self.image.pixels() {
            [pixel.r, pixel.g, pixel.b].iter().for_each(|x| hasher.update(&x.to_bits().to_le_bytes()));
        }
        let mut about = match &self.origin {
            Origin::File(_) => json!({ "settings": null, "spp": null }),
            Origin::Rendered { settings, spp } => Self::planned(settings, *spp),
        };
        about["pixels"] = format!("{:032x}", hasher.digest128()).into();
        about["noise"] = json!(self.floor());
        about
    }

    /// Writes it to an EXR file with its variance, for [`Reference::read_kept`]; `about` tells what it is of.
    ///
    /// Fails if it cannot be written.
    pub fn keep(&self, path: &Path, about: &Value) -> Result<()> {
        let of = |channel: fn(&Rgb<f32>) -> f32| self.image.pixels().iter().map(channel).collect();
        let named =
            |name: &str, values: Vec<f32>| Channel { name: name.to_owned(), samples: Samples::Float(values) };
        let mut channels = vec![named("R", of(|p| p.r)), named("G", of(|p| p.g)), named("B", of(|p| p.b))];
        for (i, name) in VARIANCES.iter().enumerate().filter(|_| self.variances.is_some()) {
            channels.push(named(name, self.variances.iter().flatten().map(|v| v[i]).collect()));
        }
        let full = [self.image.width(), self.image.height()];
        let attributes = vec![(ABOUT.to_owned(), digits(about))];
        let window = Window::whole(full[0], full[1]);
        exr::write(path, Picture { full, window, channels, attributes, warnings: Vec::new() }).map(drop)
    }

    /// The rendered one that was kept of the same thing, if it is there.
    ///
    /// Fails if there is a file that cannot be read.
    pub fn read_kept(path: &Path, about: &Value, (size, limits): ([u32; 2], Limits)) -> Result<Option<Self>> {
        if !path.exists() {
            return Ok(None);
        }
        let picture = exr::read_within(path, &Trust { limits, sandbox: None })?;
        if picture.attribute(ABOUT) != Some(digits(about).as_str()) {
            return Ok(None);
        }
        let settings = about["settings"].as_array().into_iter().flatten();
        let word = |json: &Value| json.as_str().unwrap_or_default().to_owned();
        let settings = settings.map(|it| (word(&it[0]), word(&it[1]))).collect();
        let spp = about["spp"].as_u64().and_then(|spp| u32::try_from(spp).ok()).unwrap_or(0);
        let origin = Origin::Rendered { settings, spp: rounded(spp) };
        Ok(Some(Self { pictures: PICTURES, origin, ..Self::of_picture(picture, path, size)? }))
    }
}

/// What a kept reference is of.
const ABOUT: &str = "specula:reference_of";

/// As many samples in each picture.
const fn rounded(spp: u32) -> u32 {
    spp.div_ceil(PICTURES) * PICTURES
}

const VARIANCES: [&str; 3] = ["variance.R", "variance.G", "variance.B"];

fn variances(picture: &Picture) -> Option<Vec<[f32; 3]>> {
    let [r, g, b] = VARIANCES.map(|name| picture.channel(name).map(Samples::to_f32));
    let (r, g, b) = (r?, g?, b?);
    Some(r.into_iter().zip(g).zip(b).map(|((r, g), b)| [r, g, b]).collect())
}

/// The mean of pictures, and the variance of that.
#[expect(clippy::cast_possible_truncation, reason = "rounded to the precision of pictures")]
fn mean(pictures: &[Image]) -> (Image, Vec<[f32; 3]>) {
    let Some(first) = pictures.first() else { return (Image::new(0, 0), Vec::new()) };
    #[expect(clippy::cast_precision_loss, reason = "few pictures")]
    let count = pictures.len() as f64;
    let mut image = Image::new(first.width(), first.height());
    let mut variances = Vec::with_capacity(first.pixels().len());
    for (i, pixel) in image.pixels_mut().iter_mut().enumerate() {
        let values: Vec<[f64; 3]> =
            pictures.iter().map(|it| it.pixels()[i]).map(|p| [p.r, p.g, p.b].map(f64::from)).collect();
        let means = [0, 1, 2].map(|c| values.iter().map(|v| v[c]).sum::<f64>() / count);
        *pixel = Rgb::new(means[0] as f32, means[1] as f32, means[2] as f32);
        variances.push([0, 1, 2].map(|c| {
            let squares = values.iter().map(|v| (v[c] - means[c]).powi(2)).sum::<f64>();
            (squares / (count - 1.0).max(1.0) / count) as f32
        }));
    }
    (image, variances)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn means_have_the_variance_of_means() {
        let pictures: Vec<Image> = [1.0, 2.0, 3.0, 6.0]
            .map(|x| Image::from_pixels(1, 1, vec![Rgb::gray(x)]).expect("a pixel"))
            .into();
        let (image, variances) = mean(&pictures);
        assert_eq!(image.pixels(), [Rgb::gray(3.0)], "mean");
        // (4 + 1 + 0 + 9) / 3 / 4.
        assert!((variances[0][0] - 14.0 / 12.0).abs() < 1e-6, "{variances:?}");
    }

    #[test]
    fn what_was_kept_comes_back_for_the_same_thing() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("r.exr");
        let about = json!({ "scene": "a", "settings": [["render.max_depth", "9"]], "spp": 6 });
        let kept = Reference {
            image: Image::from_pixels(2, 1, vec![Rgb::gray(0.1), Rgb::gray(3.0)]).expect("two"),
            variances: Some(vec![[1e-3, 2e-3, 3e-3]; 2]),
            pictures: PICTURES,
            origin: Origin::Rendered {
                settings: vec![("render.max_depth".to_owned(), "9".to_owned())],
                spp: 8,
            },
        };
        kept.keep(&path, &about).expect("written");
        let size = ([2, 1], Limits::default());
        assert_eq!(Reference::read_kept(&path, &about, size).expect("readable"), Some(kept), "the same");
        let other = json!({ "scene": "b" });
        assert_eq!(Reference::read_kept(&path, &other, size).expect("readable"), None, "of another scene");
        let error = Reference::read(&path, [2, 2], Limits::default()).expect_err("another size").to_string();
        assert!(error.contains("2 by 1") && error.contains("2 by 2"), "{error}");
    }
}
