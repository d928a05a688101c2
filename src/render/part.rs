//! Parts of a picture as files: sums, of which samples of which pixels, and of what.

use crate::film::{Aov, Film, Layout, Names};
use crate::image::Window;
use crate::integrator::Counters;
use crate::render::archive::{self, Archive};
use crate::render::state::{
    counters_of_json, counters_to_json, non_finite_of_json, non_finite_to_json, things,
};
use serde_json::{Value, json};
use std::io::{self, Read, Write};
use std::ops::Range;

/// Which part of a picture there is.
#[derive(Clone, Debug, PartialEq)]
pub struct Outline {
    /// Width and height of the whole picture.
    pub full: [u32; 2],
    /// The pixels.
    pub window: Window,
    /// What is kept of samples.
    pub layout: Layout,
    /// Which samples of each pixel.
    pub samples: Range<u32>,
    /// How many samples a pixel of the picture has; at most, where something else may end it.
    pub spp: u32,
    /// Whether something else may end it.
    pub has_limit: bool,
}

/// A part of a picture.
#[derive(Clone, Debug, PartialEq)]
pub struct Part {
    /// Which.
    pub outline: Outline,
    /// The sums.
    pub film: Film,
    /// Rays and cuts.
    pub counters: Counters,
    /// Of what it is: the same for all parts of one picture.
    pub about: Value,
    /// How it was made.
    pub told: Value,
}

impl Part {
    /// Writes it as a file of sums.
    pub fn write(&self, into: &mut dyn Write) -> io::Result<()> {
        let Self { outline, film, counters, about, told } = self;
        let Window { x0, y0, x1, y1 } = outline.window;
        let shares = film.shares();
        let names = film.names();
        let head = json!({
            "kind": "part",
            "about": about,
            "told": told,
            "full": outline.full,
            "window": [x0, y0, x1, y1],
            "outputs": outline.layout.aovs().iter().map(|aov| aov.name()).collect::<Vec<_>>(),
            "samples": [outline.samples.start, outline.samples.end],
            "spp": outline.spp,
            "has_limit": outline.has_limit,
            "names": { "objects": names.objects, "materials": names.materials },
            "things": shares,
            "non_finite": non_finite_to_json(film.non_finite()),
            "counters": counters_to_json(counters),
        });
        let length = Film::bytes(film.window(), film.layout(), shares)
            .ok_or_else(|| io::Error::other("a picture of more bytes than there can be"))?;
        archive::write(into, &head, length, |into| film.write(into))
    }
}

/// A file of a part, of which it is known what it is of.
#[derive(Debug)]
pub struct PartFile<R> {
    outline: Outline,
    archive: Archive<R>,
}

impl<R: Read> PartFile<R> {
    /// Reads what a file of `length` bytes is of. Fails with what is wrong with it.
    pub fn open(from: R, length: u64) -> Result<Self, String> {
        let archive = Archive::open(from, length)?;
        if archive.head["kind"] != "part" {
            return Err("not a part of a picture, but a checkpoint".to_owned());
        }
        let outline = outline(&archive.head).ok_or_else(odd)?;
        let things = things(&archive.head["things"]).ok_or_else(odd)?;
        if Film::bytes(outline.window, &outline.layout, things) != Some(archive.length) {
            return Err(odd());
        }
        Ok(Self { outline, archive })
    }

    /// Which part it is.
    pub fn outline(&self) -> &Outline {
        &self.outline
    }

    /// Of what it is.
    pub fn about(&self) -> &Value {
        &self.archive.head["about"]
    }

    /// Looks whether the sums are as they were written, without keeping them. Fails with what is wrong with them.
    pub fn check(self) -> Result<(), String> {
        self.archive.check()
    }

    /// Reads the sums. Fails with what is wrong with them.
    pub fn read(self) -> Result<Part, String> {
        let outline = self.outline;
        self.archive.arrays(|head, from| {
            let names = |kind: &str| -> Option<Vec<String>> {
                let names = head["names"][kind].as_array()?.iter();
                names.map(|name| Some(name.as_str()?.to_owned())).collect()
            };
            let names = Names {
                objects: names("objects").ok_or_else(odd)?,
                materials: names("materials").ok_or_else(odd)?,
            };
            let mut film = Film::new(outline.full, outline.window, outline.layout.clone()).named(names);
            film.read(things(&head["things"]).ok_or_else(odd)?, from).map_err(|error| error.to_string())?;
            let [least, most] = film.samples_of_pixels();
            let all = outline.samples.end - outline.samples.start;
            if most > all || (least < all && !outline.has_limit) {
                return Err(odd());
            }
            Ok(Part {
                film: film.dropped(non_finite_of_json(&head["non_finite"]).ok_or_else(odd)?),
                counters: counters_of_json(&head["counters"]).ok_or_else(odd)?,
                about: head["about"].clone(),
                told: head["told"].clone(),
                outline,
            })
        })
    }
}

fn odd() -> String {
    "not what a part of a picture looks like".to_owned()
}

fn outline(head: &Value) -> Option<Outline> {
    let number = |json: &Value| u32::try_from(json.as_u64()?).ok();
    let at = |key: &str, i: usize| number(&head[key][i]);
    let full = [at("full", 0)?, at("full", 1)?];
    let window =
        Window { x0: at("window", 0)?, y0: at("window", 1)?, x1: at("window", 2)?, y1: at("window", 3)? };
    let samples = at("samples", 0)?..at("samples", 1)?;
    let spp = number(&head["spp"])?;
    let is_sound =
        !window.is_empty() && window.fits(full[0], full[1]) && !samples.is_empty() && samples.end <= spp;
    let aov = |name: &Value| Aov::ALL.into_iter().find(|aov| name == aov.name());
    let aovs: Option<Vec<_>> = head["outputs"].as_array()?.iter().map(aov).collect();
    let has_limit = head["has_limit"].as_bool()?;
    is_sound.then_some(Outline { full, window, layout: Layout::new(aovs?), samples, spp, has_limit })
}
