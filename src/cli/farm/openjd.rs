//! A template in the terms of Open Job Description (2023-09): a step of renderings, one for each slice, and a step that merges their parts.
//!
//! Whatever a user may have typed is the value of a parameter, of type `PATH` where it names a file, so that engines can map it to
//! what it is called on their machines. Paths are told in a file of their own, since defaults of a template cannot name what lies outside of
//! its directory. Values are not looked at for expressions (`{{...}}`), other strings of a template are. Scripts get them as words,
//! not as text. Both documents are JSON, which templates may be.

use std::ffi::{OsStr, OsString};
use std::io;
use std::path::Path;
use std::process::{Child, Command, ExitStatus, Stdio};
use std::time::Duration;

use serde_json::{Map, Value, json};

use super::Written;
use super::job::{CHECKPOINT, Job};
use crate::cli::interrupt::Interrupt;
use crate::error::{Error, Problem, Result};

const TEMPLATE: &str = "template.json";
const PARAMETERS: &str = "parameters.json";

/// The most characters of a value, and the most parameters, by sections 2.5 and 1.1 of the specification.
const LONGEST: usize = 1024;
const MOST: usize = 50;

/// The template, and where everything is.
pub(super) fn files(job: &Job<'_>) -> Result<Vec<Written>> {
    let (template, parameters) = template(job)?;
    let text = |document: &Value| format!("{document:#}\n").into_bytes();
    Ok(vec![(TEMPLATE, text(&template)), (PARAMETERS, text(&parameters))])
}

/// Runs the template on this machine; who asks this program to stop asks that one, too.
pub(super) fn run(job: &Job<'_>, interrupt: &Interrupt) -> Result<()> {
    let template = job.options.dir.join(TEMPLATE);
    let mut parameters = OsString::from("file://");
    parameters.push(job.options.dir.join(PARAMETERS));
    interrupt.check()?;
    // Standard output is for results, and what is told there is not.
    let child = Command::new("openjd")
        .args([OsStr::new("run"), template.as_os_str(), OsStr::new("-p"), &parameters])
        .stdin(Stdio::null())
        .stdout(io::stderr())
        .spawn();
    let status = child.and_then(|child| wait(child, interrupt));
    // Whatever its status: tasks that were asked to stop are no failures.
    interrupt.check()?;
    let what = match status {
        Ok(status) if status.success() => return Ok(()),
        Ok(status) => format!("the job failed: {status}"),
        Err(error) if error.kind() == io::ErrorKind::NotFound => format!(
            "there is no `openjd` here; install it (`pip install openjd-cli`), or hand `{}` to an engine that takes Open Job \
             Descriptions by the engine's own command",
            template.display()
        ),
        Err(error) => format!("cannot run `openjd`: {error}"),
    };
    Err(Error::Backend { backend: "openjd", what })
}

/// Between looks at whether it has ended, or somebody asked to stop.
const EVERY: Duration = Duration::from_millis(100);

/// Waits until a program has ended, which is asked to stop once if somebody asks this one.
fn wait(mut child: Child, interrupt: &Interrupt) -> io::Result<ExitStatus> {
    let mut is_told = false;
    loop {
        if let Some(status) = child.try_wait()? {
            return Ok(status);
        }
        if interrupt.is_asked() && !is_told {
            is_told = true;
            stop(&mut child)?;
        }
        std::thread::sleep(EVERY);
    }
}

/// Asks a program to stop as Ctrl-C does; it has time for its checkpoints.
#[cfg(unix)]
fn stop(child: &mut Child) -> io::Result<()> {
    let number = child.id().to_string();
    let mut kill = Command::new("sh");
    kill.args(["-c", "kill -INT \"$1\"", "sh", &number]).stdin(Stdio::null()).stdout(io::stderr());
    // One that has ended meanwhile cannot be asked.
    kill.status().map(|_| ())
}

#[cfg(not(unix))]
fn stop(child: &mut Child) -> io::Result<()> {
    child.kill()
}

/// Parameters as they are asked for.
#[derive(Debug, Default)]
struct Parameters {
    definitions: Vec<Value>,
    /// The values of those that have no default.
    values: Map<String, Value>,
}

impl Parameters {
    /// A path of a file or a directory that is read or written.
    fn path(&mut self, name: &str, path: &Path, (object, flow): (&str, &str)) -> Result<String> {
        let text = self.text(path.as_os_str())?;
        self.values.insert(name.to_owned(), text.into());
        let kind = json!({ "name": name, "type": "PATH", "objectType": object, "dataFlow": flow });
        Ok(self.define(name, kind))
    }

    /// A word.
    fn word(&mut self, name: &str, word: &OsStr) -> Result<String> {
        let text = self.text(word)?;
        Ok(self.define(name, json!({ "name": name, "type": "STRING", "default": text })))
    }

    /// A value, if it can be one.
    fn text(&self, value: &OsStr) -> Result<String> {
        let Some(text) = value.to_str() else {
            let what = format!("`{}` cannot be named, which is not UTF-8", value.to_string_lossy());
            return refused(what, "rename it");
        };
        if text.chars().count() > LONGEST {
            let what = format!("values have {LONGEST} characters at most, and `{text}` has more");
            return refused(what, "write long values into the scene file");
        }
        if self.definitions.len() == MOST {
            let what = format!("there are {MOST} parameters at most");
            return refused(what, "write values into the scene file instead of giving many flags");
        }
        Ok(text.to_owned())
    }

    /// The expression that stands for the value of a parameter.
    fn define(&mut self, name: &str, definition: Value) -> String {
        self.definitions.push(definition);
        format!("{{{{Param.{name}}}}}")
    }
}

fn refused<T>(what: String, remedy: &str) -> Result<T> {
    Err(Problem::new(format!("in an Open Job Description {what}")).remedy(remedy).into())
}

/// The document, and the values that it asks for.
fn template(job: &Job<'_>) -> Result<(Value, Value)> {
    let farm = job.options;
    let mut parameters = Parameters::default();
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
    merge.extend(job.limits());
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
    let template = json!({
        "specificationVersion": "jobtemplate-2023-09",
        "name": job.name(),
        "parameterDefinitions": parameters.definitions,
        "steps": if has_tasks { vec![render, merging] } else { vec![merging] },
    });
    Ok((template, parameters.values.into()))
}

/// What a task runs. All that may be odd comes as words.
fn script(job: &Job<'_>) -> String {
    format!(
        r#"# Renders a slice of a picture; written by specula {}.
set -eu
slice=$1 program=$2 dir=$3 folder=$4
shift 4
cd -- "$folder"
part=$dir/{}$slice.part
{CHECKPOINT}
# In place of this shell, so that it is asked itself to stop and writes a checkpoint.
exec "$program" render --slice="$slice/{}" --output="$part" --checkpoint="$checkpoint" --resume "$@"
"#,
        env!("CARGO_PKG_VERSION"),
        job.stem(),
        job.slices,
    )
}
