//! Runs in a file, one a line: what a sweep that was stopped goes on from, and what a budget is planned by.
//!
//! The first line is a head in JSON: what scene, settings, reference and machine the runs are of. Each further line is a [`Run`]. A line is written
//! in one go when its run is done, so that no more than that run is lost whatever happens; a last line that was cut off is dropped.

use super::moments::{Own, Product};
use crate::error::{Error, Place, Problem, Problems, Result};
use crate::scene;
use serde_json::{Value, json};
use std::fs::{File, OpenOptions};
use std::io::{Read as _, Seek as _, SeekFrom, Write as _};
use std::path::{Path, PathBuf};

/// One picture, measured.
#[derive(Clone, Debug, PartialEq)]
pub struct Run {
    /// Of which point: what [`super::runs::Point::key`] says.
    pub point: String,
    /// What is set there: keys of the scene file and values.
    pub set: Vec<(String, String)>,
    /// Samples per pixel.
    pub spp: u32,
    /// Which of the runs of the point, from 0.
    pub number: u32,
    /// Its seed.
    pub seed: u64,
    /// Seconds of the processor that tracing took, all threads together.
    pub cpu_s: f64,
    /// The same of building the hierarchy that it was rendered on.
    pub build_cpu_s: f64,
    /// Seconds by the clock that tracing took.
    pub wall_s: f64,
    /// Errors of the picture by itself.
    pub own: Own,
    /// What an eye would notice, from 0 to 1.
    pub flip: f64,
    /// Rays.
    pub rays: f64,
    /// Numbers of other runs of the same point, and the product with their pictures ([`super::moments::Measure::product`]).
    pub products: Vec<(u32, Product)>,
}

impl Run {
    fn to_json(&self) -> Value {
        json!({
            "point": self.point,
            "set": self.set,
            "spp": self.spp,
            "run": self.number,
            "seed": self.seed,
            "cpu_s": self.cpu_s,
            "build_cpu_s": self.build_cpu_s,
            "wall_s": self.wall_s,
            "relmse": self.own.relmse,
            "mse": self.own.mse,
            "brightness": self.own.brightness,
            "flip": self.flip,
            "rays": self.rays,
            "products": self.products.iter().map(|(number, of)| json!([number, of.value, of.cross])).collect::<Vec<_>>(),
        })
    }

    fn of_json(json: &Value) -> Option<Self> {
        let number = |key: &str| json[key].as_f64();
        let whole = |json: &Value| u32::try_from(json.as_u64()?).ok();
        let word = |json: &Value| json.as_str().map(str::to_owned);
        let set = json["set"].as_array()?.iter().map(|it| Some((word(&it[0])?, word(&it[1])?)));
        // Older files have no `cross`.
        let product =
            |it: &Value| Some(Product { value: it[1].as_f64()?, cross: it[2].as_f64().unwrap_or(0.0) });
        let products = json["products"].as_array()?.iter().map(|it| Some((whole(&it[0])?, product(it)?)));
        Some(Self {
            point: word(&json["point"])?,
            set: set.collect::<Option<_>>()?,
            spp: whole(&json["spp"])?,
            number: whole(&json["run"])?,
            seed: json["seed"].as_u64()?,
            cpu_s: number("cpu_s")?,
            build_cpu_s: number("build_cpu_s")?,
            wall_s: number("wall_s")?,
            own: Own { relmse: number("relmse")?, mse: number("mse")?, brightness: number("brightness")? },
            flip: number("flip")?,
            rays: number("rays")?,
            products: products.collect::<Option<_>>()?,
        })
    }
}

/// What the head of a file says that it is.
pub const KIND: &str = "specula tradeoff";

/// A file that runs are added to.
#[derive(Debug)]
pub struct Log {
    path: PathBuf,
    file: File,
}

impl Log {
    /// A new file with that head.
    ///
    /// Fails if there is one already, or it cannot be written.
    pub fn begin(path: &Path, head: &Value) -> Result<Self> {
        if path.exists() {
            let problem =
                Problem::at(Place::file(path), "there is a file already, which runs would be added to");
            return Err(problem.remedy("give --resume with its name to go on from it, or remove it").into());
        }
        let file = OpenOptions::new().write(true).create_new(true).open(path);
        let file = file.map_err(|source| failed(path, "cannot write", source))?;
        let mut log = Self { path: path.to_owned(), file };
        log.line(head)?;
        Ok(log)
    }

    /// Refuses a file of anything else than `head` says, if there is one, before there is a reference: of that only what `head` knows of it counts.
    ///
    /// Fails as [`Log::resume`] does.
    pub fn check(path: &Path, head: &Value) -> Result<()> {
        if !path.exists() {
            return Ok(());
        }
        let mut there = Kept::read(path)?.head;
        there["reference"] = head["reference"].as_object().map_or(Value::Null, |known| {
            known.keys().map(|key| (key.clone(), there["reference"][key].clone())).collect()
        });
        same(path, &there, head)
    }

    /// The file at `path` to go on with, and its runs; a new one if there is none.
    ///
    /// Fails if it is no such file, of anything else than `head` says, or damaged.
    pub fn resume(path: &Path, head: &Value) -> Result<(Self, Vec<Run>)> {
        if !path.exists() {
            return Ok((Self::begin(path, head)?, Vec::new()));
        }
        let Kept { head: there, runs, sound_bytes } = Kept::read(path)?;
        same(path, &there, head)?;
        let file = OpenOptions::new().write(true).open(path);
        let mut file = file.map_err(|source| failed(path, "cannot write", source))?;
        let cut = file.set_len(sound_bytes).and_then(|()| file.seek(SeekFrom::End(0)));
        cut.map_err(|source| failed(path, "cannot write", source))?;
        Ok((Self { path: path.to_owned(), file }, runs))
    }

    /// Adds a run.
    ///
    /// Fails if it cannot be written.
    pub fn add(&mut self, run: &Run) -> Result<()> {
        self.line(&run.to_json())
    }

    fn line(&mut self, json: &Value) -> Result<()> {
        let line = format!("{json}\n");
        let written = self.file.write_all(line.as_bytes()).and_then(|()| self.file.sync_data());
        written.map_err(|source| failed(&self.path, "cannot write", source))
    }
}

/// Refuses heads that differ, and names what does.
fn same(path: &Path, there: &Value, here: &Value) -> Result<()> {
    let differences = scene::differences(there, here).into_iter().map(|what| {
        Problem::at(Place::file(path), format!("runs of something else: {what}"))
            .remedy("run it the same way, or name another file")
    });
    Problems(differences.collect()).into_result(())
}

/// A file of runs, read.
#[derive(Clone, Debug, PartialEq)]
pub struct Kept {
    /// What they are of.
    pub head: Value,
    /// The runs, in the order that they were made in.
    pub runs: Vec<Run>,
    /// How many bytes of the file are whole lines.
    pub sound_bytes: u64,
}

impl Kept {
    /// Reads a file.
    ///
    /// Fails if it cannot be read, or a line of it is none; a last line that was cut off is left out.
    pub fn read(path: &Path) -> Result<Self> {
        let mut bytes = Vec::new();
        let file = File::open(path).and_then(|mut file| file.read_to_end(&mut bytes));
        file.map_err(|source| failed(path, "cannot read", source))?;
        let sound = bytes.iter().rposition(|&byte| byte == b'\n').map_or(0, |last| last + 1);
        let text = String::from_utf8_lossy(&bytes[..sound]);
        let mut lines = (1..).zip(text.lines());
        let refused = |line: u32, what: &str| {
            let place = Place { line: Some(line), ..Place::file(path) };
            Error::from(Problem::at(place, what).remedy("name a file that `specula tradeoff --keep` wrote"))
        };
        let head: Value = lines
            .next()
            .and_then(|(_, line)| serde_json::from_str(line).ok())
            .filter(|head: &Value| head["kind"] == KIND)
            .ok_or_else(|| refused(1, "not the head of a file of runs"))?;
        let run = |(number, line): (u32, &str)| {
            let json = serde_json::from_str(line).ok();
            json.as_ref().and_then(Run::of_json).ok_or_else(|| refused(number, "not a run"))
        };
        let runs: Result<Vec<Run>> = lines.filter(|(_, line)| !line.is_empty()).map(run).collect();
        Ok(Self { head, runs: runs?, sound_bytes: sound as u64 })
    }
}

fn failed(path: &Path, what: &'static str, source: std::io::Error) -> Error {
    Error::Io { path: path.to_owned(), what, source }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tradeoff::Reference;

    fn product(value: f64) -> Product {
        Product { value, cross: value * 1e-3 }
    }

    fn run(number: u32) -> Run {
        Run {
            point: "p".to_owned(),
            set: vec![("render.max_depth".to_owned(), "3".to_owned())],
            spp: 4,
            number,
            seed: u64::MAX - u64::from(number),
            cpu_s: 0.1,
            build_cpu_s: 1e-3,
            wall_s: 0.2,
            own: Own { relmse: 1.5e-7, mse: 3.0, brightness: -0.25 },
            flip: 0.0,
            rays: 1e9,
            products: (0..number).map(|other| (other, product(f64::from(other) * 0.1))).collect(),
        }
    }

    fn head(seed: u32) -> Value {
        json!({ "kind": KIND, "seed": seed })
    }

    #[test]
    fn what_was_added_is_there_and_half_a_line_is_not() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("runs.jsonl");
        let mut log = Log::begin(&path, &head(1)).expect("new");
        log.add(&run(0)).expect("written");
        log.add(&run(1)).expect("written");
        drop(log);
        let whole = std::fs::read(&path).expect("there");
        let mut file = OpenOptions::new().append(true).open(&path).expect("there");
        file.write_all(b"{\"point\":\"p\",\"se").expect("written");
        drop(file);
        let (mut log, runs) = Log::resume(&path, &head(1)).expect("the same");
        assert_eq!(runs, [run(0), run(1)], "without the half one");
        assert_eq!(std::fs::read(&path).expect("there"), whole, "which is gone");
        log.add(&run(2)).expect("written");
        drop(log);
        let kept = Kept::read(&path).expect("sound");
        assert_eq!((kept.head, kept.runs), (head(1), vec![run(0), run(1), run(2)]), "goes on");
    }

    #[test]
    fn files_of_something_else_are_refused() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("runs.jsonl");
        assert!(Log::resume(&path, &head(1)).expect("none yet").1.is_empty(), "begins");
        let message = |result: Result<()>| result.expect_err("refused").to_string();
        let again = message(Log::begin(&path, &head(1)).map(drop));
        assert!(again.contains("already") && again.contains("--resume"), "{again}");
        let other = message(Log::resume(&path, &head(2)).map(drop));
        assert!(other.contains("`seed` is 1 there and 2 here"), "{other}");
        for (text, line) in [("", ":1: "), ("{}\n", ":1: "), ("no\n", ":1: ")] {
            std::fs::write(&path, text).expect("written");
            let told = message(Kept::read(&path).map(drop));
            assert!(told.contains(line) && told.contains("head"), "{told}");
        }
        std::fs::write(&path, format!("{}\n{}\n{{}}\n{}\n", head(1), run(0).to_json(), run(1).to_json()))
            .expect("written");
        let told = message(Kept::read(&path).map(drop));
        assert!(told.contains(":3: not a run"), "{told}");
    }
    #[test]
    fn what_is_known_of_a_reference_is_looked_at_before_there_is_one() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("runs.jsonl");
        let with = |reference: Value| json!({ "kind": KIND, "seed": 1, "reference": reference });
        let settings = |depth: &str| vec![("render.max_depth".to_owned(), depth.to_owned())];
        let mut rendered = Reference::planned(&settings("8"), 255);
        rendered["pixels"] = "0123".into();
        Log::begin(&path, &with(rendered)).expect("new");
        let planned = |depth: &str, spp| Log::check(&path, &with(Reference::planned(&settings(depth), spp)));
        planned("8", 256).expect("the same, rounded as rendering does");
        Log::check(&path, &with(Value::Null)).expect("a file, which is read first");
        for (other, told) in
            [(planned("8", 512), "`reference.spp` is 256"), (planned("9", 256), "\"8\" there")]
        {
            let text = other.expect_err("another reference").to_string();
            assert!(text.contains(told), "{text}");
        }
    }
}
