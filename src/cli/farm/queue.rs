//! Jobs in Slurm's queue: put there, and waited for.

use std::io;
use std::path::Path;
use std::process::{Command, Output, Stdio};
use std::time::{Duration, Instant};

use super::job::Job;
use super::slurm::{SUBMIT, status};
use crate::cli::interrupt::Interrupt;
use crate::error::{Error, Problem, Result};

/// The numbers of the jobs.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Ids {
    /// The array, if anything is to be rendered.
    pub(super) tasks: Option<String>,
    /// The merge.
    pub(super) merge: String,
    /// The cluster, where there are several.
    cluster: Option<String>,
}

/// Runs the script that queues the jobs. Fails with what `sbatch` says.
pub(super) fn submit(job: &Job<'_>) -> Result<Ids> {
    let script = job.options.dir.join(SUBMIT);
    if !has("sbatch") {
        let what = format!(
            "there is no `sbatch` here; install Slurm's commands, or run `sh {}` where jobs are submitted",
            script.display()
        );
        return Err(failed(what));
    }
    let output = Command::new("sh").arg(&script).stdin(Stdio::null()).output();
    let output = output.map_err(|source| Error::Io { path: script.clone(), what: "cannot run", source })?;
    let said = String::from_utf8_lossy(&output.stderr);
    if !output.status.success() {
        let said = said.trim();
        let said = if said.is_empty() { "without a word" } else { said };
        return Err(failed(format!("the jobs were not queued: {said}")));
    }
    if !said.trim().is_empty() {
        tracing::warn!("{}", said.trim());
    }
    let text = String::from_utf8_lossy(&output.stdout);
    ids(&text).ok_or_else(|| failed(format!("`sbatch` told no numbers of jobs, but `{}`", text.trim())))
}

/// Whether a command can be found.
fn has(name: &str) -> bool {
    let paths = std::env::var_os("PATH").unwrap_or_default();
    std::env::split_paths(&paths).any(|dir| dir.join(name).is_file())
}

/// What the script prints: lines of a word and a number, maybe with a semicolon and a cluster.
fn ids(text: &str) -> Option<Ids> {
    let of = |name: &str| {
        let told = text.lines().find_map(|line| line.strip_prefix(name)?.strip_prefix(' '))?;
        let (id, cluster) = told.split_once(';').map_or((told, None), |(id, cluster)| (id, Some(cluster)));
        id.parse::<u64>().ok().map(|_| (id.to_owned(), cluster.map(str::to_owned)))
    };
    let (merge, cluster) = of("merge")?;
    Some(Ids { tasks: of("tasks").map(|(id, _)| id), merge, cluster })
}

/// Between looks at the queue, at first and at most: it is no friend of many questions.
const EVERY: [Duration; 2] = [Duration::from_secs(1), Duration::from_secs(10)];

/// How long a job may be unknown, or have failed without its file, before that is believed: files may come late over a network.
const PATIENCE: Duration = Duration::from_secs(15);

/// Waits until the merge has ended. Fails as it did, or if it will never run.
pub(super) fn wait(job: &Job<'_>, ids: &Ids, interrupt: &Interrupt) -> Result<()> {
    let told = job.options.dir.join(status(&ids.merge));
    let (mut every, mut since, mut last) = (EVERY[0], None, String::new());
    loop {
        if let Some(status) = read(&told) {
            return ended(job, ids, status);
        }
        match state(ids) {
            State::Succeeded => return Ok(()),
            State::Never => return Err(lost(job, ids, "not run, since a task has failed")),
            State::Over(what) => {
                let begin = *since.get_or_insert_with(Instant::now);
                if begin.elapsed() >= PATIENCE {
                    return Err(lost(job, ids, &what));
                }
            }
            State::Alive => since = None,
        }
        let tally = ids.tasks.as_ref().and_then(|tasks| tally(ids, tasks)).unwrap_or_default();
        if tally != last && !tally.is_empty() {
            tracing::info!("tasks: {tally}");
            last = tally;
        }
        rest(every, &told, (ids, interrupt))?;
        every = EVERY[1].min(every * 2);
    }
}

/// What has become of the merge.
#[derive(Clone, Debug, PartialEq, Eq)]
enum State {
    /// It waits or runs, or nobody can be asked.
    Alive,
    /// It has ended well.
    Succeeded,
    /// It will never run, since a task has failed.
    Never,
    /// It has ended in some other way, or is unknown.
    Over(String),
}

/// What Slurm says of the merge.
fn state(ids: &Ids) -> State {
    match ask(ids, &["--format=%T|%r", &format!("--jobs={}", ids.merge)]) {
        Ok(output) if output.status.success() => state_of(&String::from_utf8_lossy(&output.stdout)),
        Ok(output) if String::from_utf8_lossy(&output.stderr).contains("Invalid job id") => {
            State::Over("unknown to Slurm".to_owned())
        }
        // The controller may be away for a while; jobs do not mind.
        Ok(output) => {
            tracing::debug!("squeue: {}", String::from_utf8_lossy(&output.stderr).trim());
            State::Alive
        }
        Err(error) => {
            tracing::debug!("squeue: {error}");
            State::Alive
        }
    }
}

/// What a line of state and reason means.
fn state_of(line: &str) -> State {
    let (state, reason) = line.trim().split_once('|').unwrap_or((line.trim(), ""));
    match (state, reason) {
        ("", _) => State::Over("unknown to Slurm".to_owned()),
        ("COMPLETED", _) => State::Succeeded,
        ("PENDING" | "CANCELLED", "DependencyNeverSatisfied") => State::Never,
        (
            "BOOT_FAIL" | "CANCELLED" | "DEADLINE" | "FAILED" | "NODE_FAIL" | "OUT_OF_MEMORY" | "PREEMPTED"
            | "REVOKED" | "TIMEOUT",
            _,
        ) => State::Over(state.to_lowercase()),
        _ => State::Alive,
    }
}

/// How many tasks are in which state, such as `2 completed, 1 running`.
fn tally(ids: &Ids, tasks: &str) -> Option<String> {
    let output = ask(ids, &["--array", "--format=%T", &format!("--jobs={tasks}")]).ok()?;
    let text = String::from_utf8_lossy(&output.stdout).to_lowercase();
    let mut states: Vec<&str> = text.lines().map(str::trim).collect();
    states.sort_unstable();
    let runs = states.chunk_by(|a, b| a == b).map(|run| format!("{} {}", run.len(), run[0]));
    output.status.success().then(|| runs.collect::<Vec<_>>().join(", "))
}

/// Asks for lines of the queue, of jobs that have ended, too.
fn ask(ids: &Ids, words: &[&str]) -> io::Result<Output> {
    let mut command = Command::new("squeue");
    command.args(["--noheader", "--states=all"]).args(words).stdin(Stdio::null());
    if let Some(cluster) = &ids.cluster {
        command.arg(format!("--clusters={cluster}"));
    }
    command.output()
}

/// The status that the merge has written, if it has.
fn read(told: &Path) -> Option<i32> {
    std::fs::read_to_string(told).ok()?.trim().parse().ok()
}

/// Sleeps until the time is over or the status is there. Fails when somebody asks to stop; the jobs stay.
fn rest(time: Duration, told: &Path, (ids, interrupt): (&Ids, &Interrupt)) -> Result<()> {
    let begin = Instant::now();
    while begin.elapsed() < time && read(told).is_none() {
        if let Err(error) = interrupt.check() {
            tracing::warn!("the jobs go on; `{}` ends them", cancel(ids));
            return Err(error);
        }
        std::thread::sleep(Duration::from_millis(250));
    }
    Ok(())
}

/// The command that ends the jobs.
fn cancel(ids: &Ids) -> String {
    let cluster = ids.cluster.iter().map(|cluster| format!("--clusters={cluster}"));
    let ids = ids.tasks.iter().chain([&ids.merge]).cloned();
    ["scancel".to_owned()].into_iter().chain(cluster).chain(ids).collect::<Vec<_>>().join(" ")
}

/// What the status of the merge means for this command.
fn ended(job: &Job<'_>, ids: &Ids, status: i32) -> Result<()> {
    let log = job.options.dir.join(format!("merge-{}.log", ids.merge));
    match status {
        0 => Ok(()),
        2 => {
            let problem =
                Problem::new(format!("the parts could not be merged, as `{}` tells", log.display()));
            Err(problem.remedy("give the command again: it keeps the parts that are sound").into())
        }
        _ => Err(failed(format!("the merge ended with status {status}; `{}` tells why", log.display()))),
    }
}

/// The merge has not run, or not to its end: which parts are not there.
fn lost(job: &Job<'_>, ids: &Ids, what: &str) -> Error {
    let gone: Vec<u32> = job.missing.iter().copied().filter(|&slice| !job.part(slice).is_file()).collect();
    let tasks = ids.tasks.as_deref().unwrap_or_default();
    let why = match gone.first() {
        Some(slice) => {
            let log = job.options.dir.join(format!("task-{tasks}_{slice}.log"));
            format!(
                "{} of {} slices are not there; `{}` tells of the first",
                gone.len(),
                job.slices,
                log.display()
            )
        }
        None => {
            format!("`{}` may tell why", job.options.dir.join(format!("merge-{}.log", ids.merge)).display())
        }
    };
    let remedy = "give the command again: what is there is kept, and the rest goes on from its checkpoints";
    failed(format!("the merge (job {}) was {what}: {why}; {remedy}", ids.merge))
}

fn failed(what: String) -> Error {
    Error::Backend { backend: "slurm", what }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_read_with_and_without_a_cluster() {
        let some = |tasks: Option<&str>, merge: &str, cluster: Option<&str>| {
            let own = |text: &str| text.to_owned();
            Some(Ids { tasks: tasks.map(own), merge: merge.to_owned(), cluster: cluster.map(own) })
        };
        assert_eq!(ids("tasks 12\nmerge 13\n"), some(Some("12"), "13", None), "one cluster");
        assert_eq!(ids("tasks 12;c\nmerge 13;c\n"), some(Some("12"), "13", Some("c")), "several");
        assert_eq!(ids("merge 7\n"), some(None, "7", None), "merge alone");
        assert_eq!(ids("tasks 12\nmerge \n"), None, "no number");
        let end = |told: &str| cancel(&ids(told).expect("numbers"));
        assert_eq!(end("tasks 12\nmerge 13\n"), "scancel 12 13", "one cluster");
        assert_eq!(end("tasks 12;c\nmerge 13;c\n"), "scancel --clusters=c 12 13", "several");
    }

    #[test]
    fn states_are_told_apart() {
        for alive in ["PENDING|Dependency", "RUNNING|None", "REQUEUED|None", "COMPLETING|None"] {
            assert_eq!(state_of(alive), State::Alive, "{alive}");
        }
        assert_eq!(state_of("COMPLETED|None\n"), State::Succeeded, "ended well");
        for never in ["PENDING|DependencyNeverSatisfied", "CANCELLED|DependencyNeverSatisfied"] {
            assert_eq!(state_of(never), State::Never, "{never}");
        }
        for over in ["CANCELLED|None", "FAILED|NonZeroExitCode", ""] {
            assert!(matches!(state_of(over), State::Over(_)), "{over}");
        }
    }
}
