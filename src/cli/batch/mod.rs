//! The command `batch`: many pictures, one after the other or side by side.
//!
//! A batch file or scene files become tasks, one for each picture (`tasks`). Workers take them in their order (`work`), leave out what is
//! done by what its files say (`cli::done`), wait for memory (`memory`), and make pictures on a stage of their own, whose library is shared.
//! What became of each is told at the end (`summary`).

pub(super) mod memory;
mod summary;
mod tasks;
mod work;

use std::num::NonZeroUsize;
use std::sync::Arc;
use std::thread;

use super::args::BatchArgs;
use super::interrupt::Interrupt;
use super::options::BatchOptions;
use super::progress::Meter;
use super::{log, output, threads};
use crate::error::{Error, Result};
use crate::scene::Library;
use memory::Gate;
use summary::{Fate, Summary};
use work::Whole;

/// Renders all pictures that are not there yet, and prints what became of each.
pub(super) fn run(args: &BatchArgs) -> Result<()> {
    log::start(&args.log);
    let interrupt = Interrupt::listen();
    let options = BatchOptions::new(args)?;
    let tasks = tasks::all(&options)?;
    let available = threads::all(options.threads);
    threads::limit(Some(available));

    let library = Arc::new(Library::default());
    let gate = Gate::new(options.memory, library.clone());
    let meter =
        Meter::in_steps(args.log.quiet || options.dry_run, ("pictures", work::STEPS), interrupt.clone());
    let whole = Whole::new(&tasks, &options, (&library, &gate), &meter);
    let worked = work(&whole, &shares(available, options.jobs.get().min(tasks.len())));
    meter.finish();
    let fates: Vec<Fate> = whole.into_fates();
    let summary = Summary { tasks: &tasks, fates: &fates, reads: library.reads() };
    output::print(if options.json { summary.json() } else { summary.table() }.as_bytes())?;
    summary.tell_failures();
    interrupt.check()?;
    worked?;
    match summary.failed() {
        0 => Ok(()),
        failed => Err(Error::Failed { failed, of: tasks.len() }),
    }
}

/// The threads of each worker, where there are to be so many of them; together as many as are available.
fn shares(available: NonZeroUsize, workers: usize) -> Vec<NonZeroUsize> {
    let workers = workers.clamp(1, available.get());
    let (each, more) = (available.get() / workers, available.get() % workers);
    (0..workers).filter_map(|i| NonZeroUsize::new(each + usize::from(i < more))).collect()
}

/// Has everything done by workers with so many threads each. Fails if one of them could not do its part; others go on.
fn work(whole: &Whole<'_>, shares: &[NonZeroUsize]) -> Result<()> {
    let Some((&own, others)) = shares.split_first() else { return Ok(()) };
    thread::scope(|scope| {
        let begun = others.iter().map(|&share| {
            thread::Builder::new()
                .spawn_scoped(scope, move || whole.work(share))
                .map_err(|error| stopped(&error.to_string()))
        });
        let begun: Vec<_> = begun.collect();
        let own = whole.work(own);
        let join = |other: Result<thread::ScopedJoinHandle<'_, Result<()>>>| {
            other?.join().unwrap_or_else(|_| Err(stopped("it has an error")))
        };
        begun.into_iter().map(join).fold(own, Result::and)
    })
}

fn stopped(why: &str) -> Error {
    Error::Backend { backend: "batch", what: format!("a worker stopped: {why}") }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn workers_share_all_threads() {
        let of = |available: usize, workers| {
            let available = NonZeroUsize::new(available).expect("some");
            shares(available, workers).into_iter().map(NonZeroUsize::get).collect::<Vec<_>>()
        };
        assert_eq!(of(8, 3), [3, 3, 2], "the rest goes to the first ones");
        assert_eq!(of(8, 1), [8], "alone");
        assert_eq!(of(2, 9), [1, 1], "no more workers than threads");
        assert_eq!(of(4, 0), [4], "nothing to do");
    }
}
