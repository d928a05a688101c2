//! Threads that share a pass, and the time they take.

use super::query::Scratch;
use crate::error::{Error, Result};
use crate::render::Phase;
use cpu_time::ThreadTime;
use std::hint::black_box;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::{Duration, Instant};

/// A fixed number of threads.
#[derive(Debug)]
pub(super) struct Workers(rayon::ThreadPool);

impl Workers {
    pub(super) fn new(threads: usize) -> Result<Self> {
        rayon::ThreadPoolBuilder::new()
            .num_threads(threads)
            .thread_name(|i| format!("bench {i}"))
            .build()
            .map(Self)
            .map_err(|error| Error::Backend { backend: "threads", what: error.to_string() })
    }

    pub(super) fn threads(&self) -> usize {
        self.0.current_num_threads()
    }

    pub(super) fn pool(&self) -> &rayon::ThreadPool {
        &self.0
    }

    /// Does pieces of work `0..chunks`, each thread taking the next one, when all threads are awake and the first `warm` pieces
    /// have been done once. By the clock: from the first start to the last end; of CPU: what each thread used for its pieces,
    /// and nothing of what it waited.
    pub(super) fn time(
        &self,
        warm: usize,
        chunks: usize,
        work: &(dyn Fn(usize, &mut Scratch) -> u64 + Sync),
    ) -> Phase {
        let [ready, warmed] = [AtomicUsize::new(0), AtomicUsize::new(0)];
        let [first, next] = [AtomicUsize::new(0), AtomicUsize::new(0)];
        let spans = self.0.broadcast(|_| {
            let mut scratch = Scratch::default();
            let mut sum = 0_u64;
            let mut all = |next: &AtomicUsize, chunks| {
                while let Some(chunk) = Some(next.fetch_add(1, Ordering::Relaxed)).filter(|&i| i < chunks) {
                    sum = sum.wrapping_add(work(chunk, &mut scratch));
                }
            };
            self.wait(&ready);
            all(&first, warm);
            self.wait(&warmed);
            let (start, cpu) = (Instant::now(), ThreadTime::now());
            all(&next, chunks);
            let span = (start, Instant::now(), cpu.elapsed());
            black_box(sum);
            span
        });
        let first = spans.iter().map(|(start, ..)| *start).min();
        let last = spans.iter().map(|(_, end, _)| *end).max();
        let wall = first.zip(last).map_or(Duration::ZERO, |(first, last)| last - first);
        Phase { wall, cpu: spans.iter().map(|(.., cpu)| *cpu).sum() }
    }

    /// Waits until all threads are here. Without sleeping: a thread that must be woken begins when the others are done.
    fn wait(&self, here: &AtomicUsize) {
        here.fetch_add(1, Ordering::AcqRel);
        while here.load(Ordering::Acquire) < self.threads() {
            std::thread::yield_now();
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::Mutex;

    #[test]
    fn every_piece_is_done_once_on_any_number_of_threads() {
        for threads in [1, 3] {
            let workers = Workers::new(threads).expect("threads");
            let done = Mutex::new(Vec::new());
            let phase = workers.time(4, 50, &|chunk, _| {
                done.lock().expect("not poisoned").push(chunk);
                0
            });
            let mut done = done.into_inner().expect("not poisoned");
            let mut timed = done.split_off(4);
            done.sort_unstable();
            timed.sort_unstable();
            assert_eq!(done, [0, 1, 2, 3], "warmed first, {threads} threads");
            assert!(timed.into_iter().eq(0..50), "{threads} threads");
            assert!(phase.wall > Duration::ZERO, "{phase:?}");
        }
    }
}
