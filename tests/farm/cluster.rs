//! A Slurm cluster on this machine, where its packages are.

use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use tempfile::TempDir;

/// Nodes `n1`, `n2`, ... of one processor each, gone with the value.
pub(crate) struct Cluster(TempDir);

impl Cluster {
    /// Starts it. None where Slurm or MUNGE is not installed, which is printed.
    pub(crate) fn up(nodes: usize) -> Option<Self> {
        let missing =
            ["munged", "slurmctld", "slurmd", "sbatch", "scontrol"].into_iter().find(|name| !is_there(name));
        if let Some(name) = missing {
            println!("skipped: there is no `{name}` (Debian: slurmctld, slurmd, slurm-client, munge)");
            return None;
        }
        let cluster = Self(tempfile::tempdir().expect("a directory"));
        cluster.script(&["up".as_ref(), cluster.0.path(), nodes.to_string().as_ref()]);
        Some(cluster)
    }

    /// A command that talks to it.
    pub(crate) fn command(&self, name: impl AsRef<Path>) -> Command {
        let mut command = Command::new(name.as_ref());
        command.env("SLURM_CONF", self.0.path().join("slurm.conf")).stdin(Stdio::null());
        command
    }

    /// What `scontrol` says of a job, by key.
    pub(crate) fn told(&self, job: &str, key: &str) -> String {
        let output = self.command("scontrol").args(["show", "job", "--oneliner", job]).output().expect("run");
        let text = String::from_utf8_lossy(&output.stdout).into_owned();
        let value = text.split(' ').find_map(|word| word.strip_prefix(key)?.strip_prefix('='));
        value.unwrap_or_default().trim().to_owned()
    }

    /// Kills a node with all that it runs.
    pub(crate) fn kill(&self, node: &str) {
        self.script(&["kill".as_ref(), self.0.path(), node.as_ref()]);
    }

    fn script(&self, words: &[&Path]) {
        let script = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("tests/farm/cluster.sh");
        // Daemons keep what they inherit open: pipes would not end before them.
        let status = Command::new(script).args(words).stdin(Stdio::null()).status().expect("run");
        assert!(status.success(), "{words:?}");
    }
}

impl Drop for Cluster {
    fn drop(&mut self) {
        if std::thread::panicking() {
            for name in ["controller", "node-n1", "node-n2"] {
                let text = std::fs::read_to_string(self.0.path().join("log").join(name)).unwrap_or_default();
                let lines: Vec<&str> = text.lines().collect();
                println!("{name}:\n{}", lines[lines.len().saturating_sub(40)..].join("\n"));
            }
        }
        let script = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("tests/farm/cluster.sh");
        let down = Command::new(script).arg("down").arg(self.0.path()).stdin(Stdio::null()).status();
        if !down.is_ok_and(|status| status.success()) {
            println!("the cluster in {} may still run", self.0.path().display());
        }
    }
}

/// Whether a command is on the path, or where daemons are.
fn is_there(name: &str) -> bool {
    let path = std::env::var_os("PATH").unwrap_or_default();
    let others = ["/usr/sbin", "/sbin"].map(PathBuf::from);
    std::env::split_paths(&path).chain(others).any(|folder| folder.join(name).is_file())
}
