//! What `farm` is to do.

use std::ffi::{OsStr, OsString};
use std::path::{Component, Path, PathBuf};

use super::files::with_extension;
use super::render::{RenderOptions, is_part, rendered_paths};
use super::values::{on_command_line, whole};
use crate::cli::args::{FIRST_PASS, FarmCommonArgs, OpenJdArgs, RenderArgs, SlurmArgs};
use crate::error::{Error, Problems, Result};

/// A picture to be rendered in slices on many machines. All paths are those from the root, since jobs run elsewhere.
#[derive(Clone, Debug, PartialEq)]
pub(in crate::cli) struct FarmOptions {
    /// The picture, as one machine would render it.
    pub(in crate::cli) picture: RenderOptions,
    /// The scene file.
    pub(in crate::cli) scene: PathBuf,
    /// Pictures to write.
    pub(in crate::cli) outputs: Vec<PathBuf>,
    /// Where the merge is to put its statistics.
    pub(in crate::cli) stats: Option<PathBuf>,
    /// Whether colour, coverage and normals are stored as 16-bit floats.
    pub(in crate::cli) half: bool,
    /// Flags for every slice.
    pub(in crate::cli) words: Vec<OsString>,
    /// Whether one of them is the number of threads.
    pub(in crate::cli) has_threads: bool,
    /// How many slices, if that was said.
    pub(in crate::cli) slices: Option<u32>,
    /// Where everything goes.
    pub(in crate::cli) dir: PathBuf,
    /// Where the command was given.
    pub(in crate::cli) folder: PathBuf,
    /// The program.
    pub(in crate::cli) program: PathBuf,
    pub(in crate::cli) submit: bool,
    pub(in crate::cli) wait: bool,
    pub(in crate::cli) json: bool,
}

/// The same for Slurm.
#[derive(Clone, Debug, PartialEq)]
pub(in crate::cli) struct SlurmOptions {
    pub(in crate::cli) farm: FarmOptions,
    /// Words for `sbatch`.
    pub(in crate::cli) sbatch: Vec<OsString>,
    /// How many tasks may run at once.
    pub(in crate::cli) at_once: Option<u32>,
}

impl SlurmOptions {
    /// What those words mean; all that is wrong with them at once.
    pub(in crate::cli) fn new(args: &SlurmArgs) -> Result<Self> {
        let mut problems = Problems::default();
        args.sbatch_option.iter().for_each(|word| check_sbatch(word, &mut problems));
        let at_once = args.at_once.as_deref().and_then(|text| count("at-once", text, &mut problems));
        let farm = FarmOptions::read(&args.common, problems)?;
        Ok(Self { farm, sbatch: args.sbatch_option.clone(), at_once })
    }
}

impl FarmOptions {
    /// What the words for an Open Job Description mean; all that is wrong with them at once.
    pub(in crate::cli) fn of_openjd(args: &OpenJdArgs) -> Result<Self> {
        Self::read(&args.common, Problems::default())
    }

    /// What those words mean; all that is wrong with them at once, and with others.
    fn read(args: &FarmCommonArgs, mut problems: Problems) -> Result<Self> {
        let render = &args.picture.args;
        refuse(render, &mut problems);
        if args.wait && !args.submit {
            let problem = on_command_line("`--wait` without jobs to wait for".to_owned());
            problems.push(problem.remedy("give --submit, too"));
        }
        let slices = args.slices.as_deref().and_then(|text| count("slices", text, &mut problems));
        let folder = folder()?;
        let absolute = |path: &Path| from_root(&folder, path);
        let outputs = rendered_paths(&RenderArgs { slice: None, ..render.clone() });
        let dir = args.dir.clone().unwrap_or_else(|| outputs[0].with_extension("farm"));
        let program = match &args.program {
            // A bare name is looked for on the other machine.
            Some(name) if name.components().count() == 1 => name.clone(),
            Some(path) => absolute(path),
            None => std::env::current_exe().map_err(|source| Error::Io {
                path: "specula".into(),
                what: "cannot find this program",
                source,
            })?,
        };
        match RenderOptions::new(&all_of_it(render, &outputs)) {
            Err(error) => problems.absorb(error, None),
            Ok(picture) if problems.0.is_empty() => {
                return Ok(Self {
                    scene: absolute(&picture.scene),
                    outputs: outputs.iter().map(|path| absolute(path)).collect(),
                    stats: render.stats.as_deref().map(absolute),
                    half: render.half,
                    words: args.picture.words.clone(),
                    has_threads: render.threads.is_some(),
                    slices,
                    dir: absolute(&dir),
                    program,
                    submit: args.submit,
                    wait: args.wait,
                    json: args.json,
                    picture,
                    folder,
                });
            }
            Ok(_) => {}
        }
        Err(Error::Input(problems))
    }
}

/// The words for the whole picture, without what has been refused.
fn all_of_it(args: &RenderArgs, outputs: &[PathBuf]) -> RenderArgs {
    RenderArgs {
        output: outputs.iter().filter(|path| !is_part(path)).cloned().collect(),
        slice: None,
        // So that the time between copies is looked at; every task has a file of its own.
        checkpoint: args.checkpoint_every.as_ref().map(|_| with_extension(&outputs[0], "ckpt")),
        resume: false,
        frames: None,
        time_limit: None,
        target_error: None,
        preset: None,
        budget: None,
        tradeoff: None,
        ..args.clone()
    }
}

/// Refuses what cannot be merged, and what tasks have of their own.
fn refuse(args: &RenderArgs, problems: &mut Problems) {
    let ends = "slices are parts of a number of samples that is known beforehand";
    let found = "it chooses settings on the way, on each machine by itself";
    let own = "every task has its own";
    let by_spp = "say how many samples by --spp";
    let refused = [
        (args.time_limit.is_some(), "--time-limit", ends, by_spp),
        (args.target_error.is_some(), "--target-error", ends, by_spp),
        (args.preset.is_some(), "--preset", found, by_spp),
        (args.budget.is_some() || args.tradeoff.is_some(), "--budget", found, by_spp),
        (
            args.frames.is_some(),
            "--frames",
            "its slices are those of one picture",
            "give the shutter of the frame by -D, or render frames by `specula batch`",
        ),
        (args.slice.is_some(), "--slice", own, "say how many by --slices N"),
        (args.checkpoint.is_some(), "--checkpoint", own, "leave it out; --checkpoint-every says how often"),
        (
            args.display.is_some(),
            "--display",
            "its slices are rendered apart, and none of them is the picture",
            "leave it out",
        ),
        (args.resume, "--resume", "tasks always go on from their checkpoints", "leave it out"),
        (
            args.aov.iter().any(|name| name == FIRST_PASS),
            "--aov gbuffer",
            "the first pass is no sum of samples, and parts do not hold it",
            "leave it out, or render it on one machine",
        ),
    ];
    for (_, flag, why, remedy) in refused.into_iter().filter(|(is_given, ..)| *is_given) {
        problems.push(on_command_line(format!("`{flag}` is not for a farm: {why}")).remedy(remedy));
    }
    for path in args.output.iter().filter(|path| is_part(path)) {
        let what = format!("`{}` is a part, and a farm makes the whole picture", path.display());
        problems.push(on_command_line(what).remedy("name a file with the extension .exr or .png"));
    }
}

/// Options of `sbatch` that the jobs need for themselves, long and short.
const TAKEN: [(&str, char); 9] = [
    ("array", 'a'),
    ("dependency", 'd'),
    ("chdir", 'D'),
    ("parsable", '\0'),
    ("wait", 'W'),
    ("wrap", '\0'),
    ("test-only", '\0'),
    ("help", 'h'),
    ("version", 'V'),
];

/// Refuses a word that is no option, or one that the jobs need for themselves.
fn check_sbatch(word: &OsStr, problems: &mut Problems) {
    let text = word.to_string_lossy();
    let problem = |what: &str, remedy: &str| {
        on_command_line(format!("`--sbatch-option {text}` {what}")).remedy(remedy.to_owned())
    };
    let is_taken = if let Some(long) = text.strip_prefix("--") {
        let name = long.split('=').next().unwrap_or(long);
        // Beginnings of names are names.
        TAKEN.iter().any(|(taken, _)| taken.starts_with(name))
    } else if let Some(short) = text.strip_prefix('-').filter(|short| !short.is_empty()) {
        TAKEN.iter().any(|&(_, taken)| short.starts_with(taken))
    } else {
        let remedy = "give option and value as one word, such as --sbatch-option=--partition=fast";
        return problems.push(problem("is not an option", remedy));
    };
    if is_taken {
        let remedy = "leave it out; --slices, --at-once and --wait are flags of `farm slurm`";
        problems.push(problem("is what the jobs set for themselves", remedy));
    }
}

/// Most slices, and most tasks at once; more is a slip of the hand.
const MOST: usize = 1 << 24;

fn count(flag: &str, text: &str, problems: &mut Problems) -> Option<u32> {
    whole(flag, text, 1..=MOST, problems).and_then(|number| u32::try_from(number).ok())
}

/// The directory in which the command was given, by the name by which the shell knows it: where homes are mounted on demand, other machines
/// do not know the one that the system tells.
fn folder() -> Result<PathBuf> {
    let failed = |source| Error::Io { path: ".".into(), what: "cannot find the current directory", source };
    let told = std::env::current_dir().map_err(failed)?;
    let named = std::env::var_os("PWD").map(PathBuf::from).filter(|path| path.is_absolute());
    let named = named.filter(|path| path.canonicalize().is_ok_and(|path| path == told));
    Ok(named.unwrap_or(told))
}

/// A path from the root, without `..` where what stands before it can be found.
fn from_root(folder: &Path, path: &Path) -> PathBuf {
    let path = folder.join(path);
    let has_up = path.components().any(|part| part == Component::ParentDir);
    match (path.parent().map(Path::canonicalize), path.file_name()) {
        (Some(Ok(parent)), Some(name)) if has_up => parent.join(name),
        _ => path,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_for_sbatch_that_break_the_jobs_are_refused() {
        let told = |word: &str| {
            let mut problems = Problems::default();
            check_sbatch(OsStr::new(word), &mut problems);
            problems.0
        };
        for word in ["--partition=fast", "--hold", "-pfast", "--time=1:00", "--wait-all-nodes=1", "-c4"] {
            assert_eq!(told(word), [], "{word}");
        }
        for word in [
            "--array=0-3",
            "--arr=0-3",
            "--ar=0-3",
            "-a0-3",
            "--dependency=singleton",
            "-d",
            "-W",
            "--wrap=ls",
            "--",
        ] {
            assert!(told(word).iter().any(|problem| problem.remedy.is_some()), "{word}");
        }
        for word in ["fast", "-"] {
            assert!(told(word)[0].to_string().contains("one word"), "{word}: a value alone");
        }
    }
}
