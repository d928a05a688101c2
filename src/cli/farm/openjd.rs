//! A template in the terms of Open Job Description (2023-09): a step of renderings, one for each slice, and a step that merges their parts.
//!
//! Whatever a user may have typed is the value of a parameter, of type `PATH` where it names a file, so that engines can map it to
//! what it is called on their machines. Paths are told as seen from the template, since defaults may not begin at the root (section 2.2 has
//! them joined to its directory). Values are not looked at for expressions (`{{...}}`), other strings of a
//! template are. Scripts get them as words, not as text. The document is JSON, which templates may be.

use std::ffi::OsStr;
use std::path::{Component, Path, PathBuf};
use std::process::{Command, Stdio};

use serde_json::{Map, Value, json};

use super::Written;
use super::job::{CHECKPOINT, Job};
use crate::error::{Error, Problem, Result};

const TEMPLATE: &str = "template.json";

/// The most characters of a value, and the most parameters, by sections 2.5 and 1.1 of the specification.
const LONGEST: usize = 1024;
const MOST: usize = 50;

/// The template as a file.
pub(super) fn file(job: &Job<'_>) -> Result<Written> {
    Ok((TEMPLATE, format!("{:#}\n", template(job)?).into_bytes()))
}

/// Runs a template on this machine.
pub(super) fn run(template: &Path) -> Result<()> {
    // Standard output is for results, and what is told there is not.
    let status = Command::new("openjd")
        .args([OsStr::new("run"), template.as_os_str()])
        .stdin(Stdio::null())
        .stdout(std::io::stderr())
        .status();
    let what = match status {
        Ok(status) if status.success() => return Ok(()),
        Ok(status) => format!("the job failed: {status}"),
        Err(error) if error.kind() == std::io::ErrorKind::NotFound => format!(
            "there is no `openjd` here; install it (`pip install openjd-cli`), or hand `{}` to an engine that takes Open Job \
             Descriptions by the engine's own command",
            template.display()
        ),
        Err(error) => format!("cannot run `openjd`: {error}"),
    };
    Err(Error::Backend { backend: "openjd", what })
}

/// Parameters as they are asked for.
#[derive(Debug)]
struct Parameters<'a> {
    /// The directory of the template.
    dir: &'a Path,
    definitions: Vec<Value>,
}

impl Parameters<'_> {
    /// A path of a file or a directory that is read or written.
    fn path(&mut self, name: &str, path: &Path, (object, flow): (&str, &str)) -> Result<String> {
        let path = seen(path, self.dir);
        self.add(name, path.as_os_str(), json!({ "type": "PATH", "objectType": object, "dataFlow": flow }))
    }

    /// A word.
    fn word(&mut self, name: &str, word: &OsStr) -> Result<String> {
        self.add(name, word, json!({ "type": "STRING" }))
    }

    /// Defines a parameter; the expression that stands for its value.
    fn add(&mut self, name: &str, value: &OsStr, kind: Value) -> Result<String> {
        let problem = |what: String, remedy: &str| {
            Err(Problem::new(format!("in an Open Job Description {what}")).remedy(remedy).into())
        };
        let Some(text) = value.to_str() else {
            let what = format!("`{}` cannot be named, which is not UTF-8", value.to_string_lossy());
            return problem(what, "rename it");
        };
        if text.chars().count() > LONGEST {
            let what = format!("values have {LONGEST} characters at most, and `{text}` has more");
            return problem(what, "write long values into the scene file");
        }
        if self.definitions.len() == MOST {
            let what = format!("there are {MOST} parameters at most");
            return problem(what, "write values into the scene file instead of giving many flags");
        }
        let mut definition = Map::new();
        definition.insert("name".to_owned(), name.into());
        if let Value::Object(kind) = kind {
            definition.extend(kind);
        }
        definition.insert("default".to_owned(), text.into());
        self.definitions.push(definition.into());
        Ok(format!("{{{{Param.{name}}}}}"))
    }
}

/// A path as seen from a directory, both from the root and read as they are written.
fn seen(path: &Path, dir: &Path) -> PathBuf {
    let same = path.components().zip(dir.components()).take_while(|(a, b)| a == b).count();
    let up = dir.components().skip(same).map(|_| Component::ParentDir);
    let seen: PathBuf = up.chain(path.components().skip(same)).collect();
    if seen.as_os_str().is_empty() { ".".into() } else { seen }
}

/// The document.
fn template(job: &Job<'_>) -> Result<Value> {
    let farm = job.options;
    let mut parameters = Parameters { dir: &farm.dir, definitions: Vec::new() };
    let scene = parameters.path("Scene", &farm.scene, ("FILE", "IN"))?;
    let dir = parameters.path("Dir", &farm.dir, ("DIRECTORY", "INOUT"))?;
    let folder = parameters.path("Folder", &farm.folder, ("DIRECTORY", "IN"))?;
    let program = parameters.word("Program", farm.program.as_os_str())?;
    let mut merge = vec!["merge".to_owned()];
    merge.extend((0..job.slices).map(|slice| format!("{dir}/{}{slice}.part", job.stem())));
    for (i, path) in farm.outputs.iter().enumerate() {
        let path = parameters.path(&format!("Picture{}", i + 1), path, ("FILE", "OUT"))?;
        merge.push(format!("--output={path}"));
    }
    if let Some(path) = &farm.stats {
        merge.push(format!("--stats={}", parameters.path("Statistics", path, ("FILE", "OUT"))?));
    }
    merge.extend(farm.half.then(|| "--half".to_owned()));
    let mut words = Vec::new();
    for (i, word) in farm.words.iter().enumerate() {
        words.push(parameters.word(&format!("Flag{}", i + 1), word)?);
    }

    let args = [
        vec!["{{Task.File.Run}}".to_owned(), "{{Task.Param.Slice}}".to_owned(), program.clone(), dir, folder],
        words,
        vec![scene],
    ];
    let has_tasks = !job.missing.is_empty();
    let render = json!({
        "name": "Render",
        "parameterSpace": { "taskParameterDefinitions": [{ "name": "Slice", "type": "INT", "range": job.range() }] },
        "script": {
            "actions": { "onRun": {
                "command": "sh",
                "args": args.concat(),
                // Time for a checkpoint.
                "cancelation": { "mode": "NOTIFY_THEN_TERMINATE", "notifyPeriodInSeconds": 60 },
            } },
            "embeddedFiles": [{ "name": "Run", "type": "TEXT", "data": script(job) }],
        },
    });
    let mut merging = json!({
        "name": "Merge",
        "script": { "actions": { "onRun": {
            "command": program,
            "args": merge,
            "cancelation": { "mode": "NOTIFY_THEN_TERMINATE", "notifyPeriodInSeconds": 60 },
        } } },
    });
    if has_tasks {
        merging["dependencies"] = json!([{ "dependsOn": "Render" }]);
    }
    Ok(json!({
        "specificationVersion": "jobtemplate-2023-09",
        "name": job.name(),
        "parameterDefinitions": parameters.definitions,
        "steps": if has_tasks { vec![render, merging] } else { vec![merging] },
    }))
}

/// What a task runs. All that may be odd comes as words.
fn script(job: &Job<'_>) -> String {
    let checkpoint = if job.has_checkpoints {
        format!("{CHECKPOINT}\nset -- --checkpoint=\"$checkpoint\" --resume \"$@\"\n")
    } else {
        String::new()
    };
    format!(
        r#"# Renders a slice of a picture; written by specula {}.
set -eu
slice=$1 program=$2 dir=$3 folder=$4
shift 4
cd -- "$folder"
part=$dir/{}$slice.part
{checkpoint}# In place of this shell, so that it is asked itself to stop and writes a checkpoint.
exec "$program" render --slice="$slice/{}" --output="$part" "$@"
"#,
        env!("CARGO_PKG_VERSION"),
        job.stem(),
        job.slices,
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn paths_are_seen_from_the_template() {
        let seen = |path: &str| seen(Path::new(path), Path::new("/a/b/c.farm"));
        assert_eq!(seen("/a/b/x.toml"), Path::new("../x.toml"), "beside");
        assert_eq!(seen("/a/b/c.farm"), Path::new("."), "itself");
        assert_eq!(seen("/a/b/c.farm/d"), Path::new("d"), "within");
        assert_eq!(seen("/z"), Path::new("../../../z"), "far");
    }
}
