//! Scripts for Slurm: a job array of renderings, the job that merges their parts, and how both are queued.
//!
//! Options of ours stand in the scripts and those of the user on the command line of `sbatch`, which has the last word. The scripts
//! are queued from the directory of the farm, so that logs have names without directories: Slurm has its own rules for quotes in
//! names, and none for newlines.

use std::ffi::OsString;

use super::job::{CHECKPOINT, Job};
use super::{Written, flag};
use crate::cli::options::SlurmOptions;
use crate::cli::shell::Script;

pub(super) const TASKS: &str = "tasks.sbatch";
pub(super) const MERGE: &str = "merge.sbatch";
/// Queues both.
pub(super) const SUBMIT: &str = "submit.sh";

/// All files.
pub(super) fn files(job: &Job<'_>, options: &SlurmOptions) -> Vec<Written> {
    let has_tasks = !job.missing.is_empty();
    let tasks = has_tasks.then(|| (TASKS, tasks(job, options).bytes().to_owned()));
    let others = [(MERGE, merge(job)), (SUBMIT, submit(job, options))];
    let others = others.into_iter().map(|(name, script)| (name, script.bytes().to_owned()));
    tasks.into_iter().chain(others).collect()
}

/// The name of the file in which the merge tells its status, when it has ended.
pub(super) fn status(id: &str) -> String {
    format!("merge-{id}.status")
}

/// Where a job logs to: the option for its head, and what its body does about it. Slurm expands percent signs in the name of the directory,
/// too, and leaves all as it is where there is a backslash; then the shell opens the log, and it lacks what Slurm itself has to say.
fn log(job: &Job<'_>, pattern: &str, name: &str) -> (String, String) {
    let dir = job.options.dir.as_os_str().as_encoded_bytes();
    if dir.iter().any(|byte| b"%\\".contains(byte)) {
        ("/dev/null".to_owned(), format!("exec >>\"$dir/{name}\" 2>&1"))
    } else {
        (pattern.to_owned(), "# Slurm has opened the log.".to_owned())
    }
}

/// One rendering for each slice.
fn tasks(job: &Job<'_>, options: &SlurmOptions) -> Script {
    let (log, open_log) = log(job, "task-%A_%a.log", "task-${SLURM_ARRAY_JOB_ID}_$SLURM_ARRAY_TASK_ID.log");
    let at_once = options.at_once.map_or(String::new(), |number| format!("%{number}"));
    let head = format!(
        "#!/bin/sh
#SBATCH --job-name={}
#SBATCH --array={}{at_once}
#SBATCH --requeue
#SBATCH --open-mode=append
#SBATCH --output={log}
# Renders a slice of a picture; written by specula {}, queued by {SUBMIT}.
set -eu",
        job.name(),
        job.range(),
        env!("CARGO_PKG_VERSION"),
    );
    let farm = &options.farm;
    let mut script = Script::default()
        .lines(head)
        .command("cd --", [farm.folder.as_os_str()])
        .set("program", &farm.program)
        .set("dir", &farm.dir)
        .lines(open_log)
        .lines(format!(
            r#"slices={}
slice=$SLURM_ARRAY_TASK_ID
part=$dir/{}$slice.part
restarts=${{SLURM_RESTART_COUNT:-0}}
echo "slice $slice of $slices on ${{SLURMD_NODENAME:-a machine}}, restart $restarts"
# A run that its node's daemon lost may have gone on by itself. Files take their names when they are whole, so this one is.
if [ "$restarts" -gt 0 ] && [ -e "$part" ]; then
    echo "an earlier run has written it"
    exit 0
fi
set -- render --slice="$slice/$slices" --output="$part""#,
            job.slices,
            job.stem(),
        ))
        .lines(CHECKPOINT)
        .lines(r#"set -- "$@" --checkpoint="$checkpoint" --resume"#);
    if !farm.has_threads {
        script = script.lines(r#"set -- "$@" --threads="${SLURM_CPUS_PER_TASK:-${SLURM_CPUS_ON_NODE:-1}}""#);
    }
    let words = farm.words.iter().map(|word| word.as_os_str());
    script
        .lines("# In place of this shell, so that it is asked itself to stop (requeued, pre-empted, out of time) and writes a checkpoint.")
        .command(r#"exec "$program" "$@""#, words.chain([farm.scene.as_os_str()]))
}

/// The picture of all parts. Its status goes to a file, since Slurm soon forgets.
fn merge(job: &Job<'_>) -> Script {
    let farm = job.options;
    let (log, open_log) = log(job, "merge-%j.log", "merge-$SLURM_JOB_ID.log");
    let head = format!(
        "#!/bin/sh
#SBATCH --job-name={}-merge
#SBATCH --requeue
#SBATCH --open-mode=append
#SBATCH --output={log}
# Merges the slices of a picture; written by specula {}, queued by {SUBMIT}.
set -eu",
        job.name(),
        env!("CARGO_PKG_VERSION"),
    );
    let mut words = Vec::new();
    words.extend((0..job.slices).map(|slice| job.part(slice).into_os_string()));
    words.extend(farm.outputs.iter().map(|path| flag("output", path)));
    words.extend(farm.stats.iter().map(|path| flag("stats", path)));
    words.extend(farm.half.then(|| "--half".into()));
    words.extend(job.limits().map(OsString::from));
    Script::default()
        .lines(head)
        .command("cd --", [farm.folder.as_os_str()])
        .set("program", &farm.program)
        .set("dir", &farm.dir)
        .lines(open_log)
        .command("set -- merge", words.iter().map(|word| word.as_os_str()))
        .lines(format!(
            r#"status=0
"$program" "$@" || status=$?
# Interrupted, it runs again.
if [ "$status" -ne 130 ]; then
    told=$dir/{}
    echo "$status" >"$told.tmp"
    mv -f -- "$told.tmp" "$told"
fi
exit "$status""#,
            status("$SLURM_JOB_ID"),
        ))
}

/// Queues the merge behind the tasks; without it, tasks do not stay either.
fn submit(job: &Job<'_>, options: &SlurmOptions) -> Script {
    let sbatch = || options.sbatch.iter().map(|word| word.as_os_str());
    let script = Script::default()
        .lines("#!/bin/sh\n# Queues the slices of a picture, and their merge for when all are there. Prints the numbers of both jobs.\nset -eu")
        .command("cd --", [options.farm.dir.as_os_str()])
        .lines("rm -f -- merge-*.status");
    if job.missing.is_empty() {
        return script
            .lines("# All slices are there.")
            .command("set --", sbatch())
            .lines(format!("merge=$(sbatch --parsable \"$@\" {MERGE})\nprintf 'merge %s\\n' \"$merge\""));
    }
    script.command("set --", sbatch()).lines(format!(
        r#"tasks=$(sbatch --parsable "$@" {TASKS})
merge=$(sbatch --parsable "$@" --dependency="afterok:${{tasks%%;*}}" --kill-on-invalid-dep=yes {MERGE}) || {{
    cluster=${{tasks#"${{tasks%%;*}}"}}
    scancel ${{cluster:+"--clusters=${{cluster#;}}"}} "${{tasks%%;*}}"
    exit 1
}}
printf 'tasks %s\nmerge %s\n' "$tasks" "$merge""#
    ))
}
