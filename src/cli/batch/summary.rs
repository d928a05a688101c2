//! What became of all pictures: a table, JSON, and how to try again what failed.

use std::time::Duration;

use serde_json::{Value, json};

use super::tasks::Task;
use crate::cli::statistics::seconds;
use crate::scene::Reads;

/// What became of a picture.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Fate {
    /// It was there.
    Done,
    /// It is not there, or another one.
    Due(String),
    /// It was made, since it was not there or another one.
    Made { why: String, time: Duration, samples: u64 },
    /// It could not be made: all problems.
    Failed(Vec<String>),
    /// Somebody asked to stop.
    Interrupted,
    /// Somebody asked to stop before.
    NotBegun,
}

impl Fate {
    fn word(&self) -> &'static str {
        match self {
            Self::Done => "done before",
            Self::Due(_) => "due",
            Self::Made { .. } => "rendered",
            Self::Failed(_) => "failed",
            Self::Interrupted => "interrupted",
            Self::NotBegun => "not begun",
        }
    }

    const WORDS: [&str; 6] = ["rendered", "done before", "due", "failed", "interrupted", "not begun"];
}

/// All pictures, and what became of them.
#[derive(Clone, Copy, Debug)]
pub(super) struct Summary<'a> {
    pub(super) tasks: &'a [Task],
    pub(super) fates: &'a [Fate],
    pub(super) reads: Reads,
}

impl Summary<'_> {
    /// How many could not be made.
    pub(super) fn failed(&self) -> usize {
        self.count("failed")
    }

    fn count(&self, word: &str) -> usize {
        self.fates.iter().filter(|fate| fate.word() == word).count()
    }

    /// For people: a line for each picture, and the sums.
    pub(super) fn table(&self) -> String {
        let labels: Vec<String> = self.tasks.iter().map(Task::label).collect();
        let width = labels.iter().map(|label| label.chars().count()).max().unwrap_or(0).max("picture".len());
        let mut text = format!("{:<width$}  {:<11}  {:>9}  \n", "picture", "state", "time");
        for (label, fate) in labels.iter().zip(self.fates) {
            let (time, more) = match fate {
                Fate::Made { why, time, .. } => (format!("{:.2} s", time.as_secs_f64()), why.as_str()),
                Fate::Due(why) => (String::new(), why.as_str()),
                Fate::Failed(problems) => (String::new(), problems.first().map_or("", String::as_str)),
                _ => (String::new(), ""),
            };
            let line = format!("{label:<width$}  {:<11}  {time:>9}  {more}", fate.word());
            text += line.trim_end();
            text.push('\n');
        }
        let counts = Fate::WORDS.iter().map(|word| (self.count(word), word)).filter(|(count, _)| *count > 0);
        let counts: Vec<String> = counts.map(|(count, word)| format!("{count} {word}")).collect();
        let Reads { read, shared, .. } = self.reads;
        text + &format!("{}; {read} files read, {shared} times there already\n", counts.join(", "))
    }

    /// For programs.
    pub(super) fn json(&self) -> String {
        let pictures: Vec<Value> =
            self.tasks.iter().zip(self.fates).map(|(task, fate)| one(task, fate)).collect();
        let counts: serde_json::Map<_, _> =
            Fate::WORDS.iter().map(|word| (word.replace(' ', "_"), self.count(word).into())).collect();
        let document = json!({
            "version": env!("CARGO_PKG_VERSION"),
            "pictures": pictures,
            "counts": counts,
            "files": { "read": self.reads.read, "shared": self.reads.shared },
        });
        format!("{document:#}\n")
    }

    /// Logs what failed, and how to try it again.
    pub(super) fn tell_failures(&self) {
        for (task, fate) in self.tasks.iter().zip(self.fates) {
            let Fate::Failed(problems) = fate else { continue };
            for problem in problems {
                tracing::error!("{}: {problem}", task.label());
            }
            tracing::error!("{}: try it again by `{}`", task.label(), task.command());
        }
    }
}

fn one(task: &Task, fate: &Fate) -> Value {
    let outputs: Vec<String> = task.options.outputs.iter().map(|it| it.path.display().to_string()).collect();
    let mut json = json!({
        "job": task.job.name,
        "frame": task.options.frame,
        "scene": task.options.scene.display().to_string(),
        "outputs": outputs,
        "state": fate.word().replace(' ', "_"),
    });
    match fate {
        Fate::Due(why) => json["why"] = why.as_str().into(),
        Fate::Made { why, time, samples } => {
            json["why"] = why.as_str().into();
            json["wall_s"] = seconds(*time).into();
            json["samples"] = (*samples).into();
        }
        Fate::Failed(problems) => {
            json["problems"] = problems.clone().into();
            json["command"] = task.command().into();
        }
        Fate::Done | Fate::Interrupted | Fate::NotBegun => {}
    }
    json
}
