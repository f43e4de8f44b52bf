//! The suite: cases times settings, in parallel, into a file and a page.

use std::{
    path::PathBuf,
    sync::{
        Arc, Mutex, PoisonError,
        atomic::{AtomicBool, Ordering},
    },
    time::Instant,
};

use rayon::prelude::*;

use super::{Case, Setting, Status, Verdict, page, verify};
use crate::protocol::Progress;
use crate::record::{FileError, write_json};
use crate::report::ReportError;
use crate::world::WorldMaker;

/// The suite's name to whoever shows progress.
const SUITE: u64 = 0;

/// What to run and where to.
pub struct SuiteOptions {
    /// The cases.
    pub cases: Vec<Case>,
    /// The engines and settings.
    pub settings: Vec<Setting>,
    /// Folder for `verify.json`, `verify.csv`, `report.html` and `figures/`; `None` writes nothing.
    pub out: Option<PathBuf>,
    /// Experiments at the same time.
    pub jobs: usize,
    /// Becomes true to stop: what is running ends, nothing more begins.
    pub cancel: Arc<AtomicBool>,
    /// Told of what goes on.
    pub progress: Arc<dyn Progress>,
}

/// Why the suite did not finish.
#[derive(Debug, thiserror::Error)]
pub enum SuiteError {
    /// A file could not be written.
    #[error(transparent)]
    File(#[from] FileError),
    /// The page could not be written.
    #[error(transparent)]
    Report(#[from] ReportError),
    /// No threads.
    #[error("no threads could be started: {0}")]
    Threads(String),
    /// Asked to stop.
    #[error("stopped; nothing of the suite is kept")]
    Cancelled,
}

/// Runs every case on every setting; the verdicts, case by case.
///
/// # Errors
/// [`SuiteError`]. A case that fails is no error.
pub fn run_suite(options: &SuiteOptions, make: WorldMaker) -> Result<Vec<Verdict>, SuiteError> {
    let todo: Vec<(&Case, &Setting)> =
        options.cases.iter().flat_map(|c| options.settings.iter().map(move |s| (c, s))).collect();
    // Finished experiments; a lock, so that they are reported in the order of their numbers.
    let done = Mutex::new(0_usize);
    let pool = pool(options.jobs.max(1))?;
    options.progress.begin_pieces(SUITE, "experiments", todo.len());
    let verdicts: Option<Vec<Verdict>> = pool.install(|| {
        // One at a time from the front: the order of the table is that of the work.
        let each = todo.par_iter().with_max_len(1).map(|(case, setting)| {
            if options.cancel.load(Ordering::Relaxed) {
                return None;
            }
            let began = Instant::now();
            let mut verdict = verify(case, setting, make);
            verdict.wall_s = began.elapsed().as_secs_f64();
            let words = in_words(&verdict);
            let mut done = done.lock().unwrap_or_else(PoisonError::into_inner);
            *done += 1;
            let count = format!("{done}/{}", todo.len());
            options.progress.message(&format!("{count}  {} on {}: {words}", case.id, setting.name));
            options.progress.update(SUITE, *done as f64, &case.id);
            Some(verdict)
        });
        each.collect()
    });
    options.progress.end_stage(SUITE);
    let verdicts = verdicts.ok_or(SuiteError::Cancelled)?;
    if let Some(out) = &options.out {
        write_json(&out.join("verify.json"), &verdicts)?;
        page::rows(&verdicts).write(&out.join("verify.csv"))?;
        page::write(out, &options.cases, &verdicts)?;
    }
    Ok(verdicts)
}

/// A pool of a number of threads, or of as many as the system gives.
fn pool(threads: usize) -> Result<rayon::ThreadPool, SuiteError> {
    let made = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
    match made {
        Err(_) if threads > 1 => pool(threads - 1),
        made => made.map_err(|e| SuiteError::Threads(e.to_string())),
    }
}

fn in_words(verdict: &Verdict) -> String {
    let got = verdict.got.map_or_else(|| "nothing".to_owned(), |g| format!("{g:.4}"));
    format!("{}, got {got} {}", verdict.status.words(), verdict.unit)
}

/// How many verdicts have each status.
pub fn tally(verdicts: &[Verdict], status: Status) -> usize {
    verdicts.iter().filter(|v| v.status == status).count()
}
