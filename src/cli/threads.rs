//! How many threads work on pictures.

use std::num::NonZeroUsize;
use std::thread;

/// As many as were asked for; all processors if absent.
pub(super) fn all(asked: Option<NonZeroUsize>) -> NonZeroUsize {
    asked.or_else(|| thread::available_parallelism().ok()).unwrap_or(NonZeroUsize::MIN)
}

/// Limits the threads that compress, read and compare pictures; all processors if absent.
pub(super) fn limit(threads: Option<NonZeroUsize>) {
    if let Some(threads) = threads {
        let limited = rayon::ThreadPoolBuilder::new().num_threads(threads.get()).build_global();
        if let Err(error) = limited {
            tracing::debug!("files are written on all processors: {error}");
        }
    }
}
