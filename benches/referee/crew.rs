//! Independent work on several threads, each with a referee of its own.

use std::sync::{
    Mutex, PoisonError,
    atomic::{AtomicBool, AtomicUsize, Ordering},
};

use super::program::Program;

/// Does `work` on every item, on up to `jobs` threads, and hands each result to
/// `finish`, one at a time, as it ends. After the first error nothing new begins.
pub fn each<T: Sync, R>(
    jobs: usize,
    items: &[T],
    start: impl Fn() -> Result<Program, String> + Sync,
    work: impl Fn(&mut Program, &T) -> Result<R, String> + Sync,
    finish: impl FnMut(&T, R) -> Result<(), String> + Send,
) -> Result<(), String> {
    let next = AtomicUsize::new(0);
    let failed = AtomicBool::new(false);
    let finish = Mutex::new(finish);
    let worker = || -> Result<(), String> {
        let mut program = start()?;
        while !failed.load(Ordering::Relaxed) {
            let Some(item) = items.get(next.fetch_add(1, Ordering::Relaxed)) else { break };
            let result = work(&mut program, item)?;
            let mut finish = finish.lock().unwrap_or_else(PoisonError::into_inner);
            (*finish)(item, result)?;
        }
        Ok(())
    };
    let watched = || worker().inspect_err(|_| failed.store(true, Ordering::Relaxed));
    std::thread::scope(|scope| {
        let threads: Vec<_> = (0..jobs.min(items.len())).map(|_| scope.spawn(watched)).collect();
        let ended = threads
            .into_iter()
            .map(|t| t.join().unwrap_or_else(|_| Err("a thread of the referee panicked".into())));
        // All are joined before the first error is reported.
        ended.collect::<Vec<_>>().into_iter().collect()
    })
}
