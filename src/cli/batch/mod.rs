//! The command `batch`: many pictures, one after the other or side by side.
//!
//! A batch file or scene files become tasks, one for each picture (`tasks`). Workers take them in their order (`work`), leave out what is
//! done by what its files say (`done`), wait for memory (`memory`), and make pictures on a stage of their own, whose library is shared.
//! What became of each is told at the end (`summary`).

mod done;
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
    let available = options.threads.or_else(|| thread::available_parallelism().ok());
    let available = available.unwrap_or(NonZeroUsize::MIN);
    threads::limit(Some(available));

    let library = Arc::new(Library::default());
    let gate = Gate::new(options.memory, library.clone());
    let meter =
        Meter::in_steps(args.log.quiet || options.dry_run, ("pictures", work::STEPS), interrupt.clone());
    let whole = Whole::new(&tasks, &options, (&library, &gate), &meter);
    let workers = options.jobs.get().min(tasks.len()).max(1);
    let each = NonZeroUsize::new(available.get() / workers).unwrap_or(NonZeroUsize::MIN);
    let worked: Result<()> = thread::scope(|scope| {
        let others: Vec<_> = (1..workers).map(|_| scope.spawn(|| whole.work(each))).collect();
        let own = whole.work(each);
        let joined = others.into_iter().map(|other| {
            let stopped = || Err(Error::Backend { backend: "batch", what: "a worker stopped".to_owned() });
            other.join().unwrap_or_else(|_| stopped())
        });
        joined.fold(own, Result::and)
    });
    meter.finish();
    let fates: Vec<Fate> = whole.into_fates();
    worked?;
    let summary = Summary { tasks: &tasks, fates: &fates, reads: library.reads() };
    output::print(if options.json { summary.json() } else { summary.table() }.as_bytes())?;
    summary.tell_failures();
    interrupt.check()?;
    match summary.failed() {
        0 => Ok(()),
        failed => Err(Error::Failed { failed, of: tasks.len() }),
    }
}
