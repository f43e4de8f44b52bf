//! The suite: cases times settings, in parallel, into a file and a page.

use std::{
    collections::BTreeMap,
    path::{Path, PathBuf},
    sync::{
        Arc, Mutex, PoisonError,
        atomic::{AtomicBool, Ordering},
    },
    time::{Duration, Instant},
};

use rayon::prelude::*;

use super::{Case, Setting, Status, Verdict, page, verify};
use crate::plain::plain_path;
use crate::protocol::Progress;
use crate::record::{FileError, write_json};
use crate::report::ReportError;
use crate::world::WorldMaker;

/// The suite's name to whoever shows progress.
const SUITE: u64 = 0;

/// Rows of `verify.csv` of the experiments that are finished, while others are not.
const UNFINISHED: &str = "unfinished.csv";

/// Least time between two writings of that file, before the suite is asked to stop.
const KEPT_EVERY: Duration = Duration::from_secs(1);

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
    /// Asked to stop; with what is kept.
    #[error("stopped; {0}")]
    Cancelled(String),
}

/// What is finished of a suite.
#[derive(Default)]
struct Done {
    /// By the numbers of their experiments.
    verdicts: BTreeMap<usize, Verdict>,
    /// When they were kept last.
    kept: Option<Instant>,
}

impl Done {
    /// Writes what is finished.
    fn keep(&mut self, out: &Path) -> Result<(), FileError> {
        self.kept = Some(Instant::now());
        page::rows(self.verdicts.values()).write(&out.join(UNFINISHED))
    }

    /// Why a suite of `all` experiments ends before they are finished.
    fn stopped(&mut self, out: Option<&Path>, all: usize) -> SuiteError {
        let finished = self.verdicts.len();
        let kept = match out {
            Some(out) if finished > 0 => match self.keep(out) {
                Ok(()) => format!(", in {}", plain_path(&out.join(UNFINISHED))),
                Err(error) => return error.into(),
            },
            _ => String::new(),
        };
        SuiteError::Cancelled(format!(
            "{finished} of {all} experiments are finished{kept}; the same command begins anew"
        ))
    }
}

/// Runs every case on every setting; the verdicts, case by case.
///
/// # Errors
/// [`SuiteError`]. A case that fails is no error.
pub fn run_suite(options: &SuiteOptions, make: WorldMaker) -> Result<Vec<Verdict>, SuiteError> {
    let todo: Vec<(&Case, &Setting)> =
        options.cases.iter().flat_map(|c| options.settings.iter().map(move |s| (c, s))).collect();
    // A lock, so that experiments are reported in the order in which they are counted.
    let done = Mutex::<Done>::default();
    let pool = pool(options.jobs.max(1))?;
    if let Some(out) = &options.out {
        // The suite begins anew: rows of an earlier one are none of it.
        let _ = std::fs::remove_file(out.join(UNFINISHED));
    }
    options.progress.begin_pieces(SUITE, "experiments", todo.len());
    pool.install(|| {
        // One at a time from the front: the order of the table is that of the work.
        todo.par_iter().enumerate().with_max_len(1).for_each(|(number, (case, setting))| {
            if options.cancel.load(Ordering::Relaxed) {
                return;
            }
            let began = Instant::now();
            let mut verdict = verify(case, setting, make);
            verdict.wall_s = began.elapsed().as_secs_f64();
            let words = in_words(&verdict);
            let mut done = done.lock().unwrap_or_else(PoisonError::into_inner);
            done.verdicts.insert(number, verdict);
            let finished = done.verdicts.len();
            let count = format!("{finished}/{}", todo.len());
            options.progress.message(&format!("{count}  {} on {}: {words}", case.id, setting.name));
            options.progress.update(SUITE, finished as f64, &case.id);
            let is_due = done.kept.is_none_or(|at| at.elapsed() >= KEPT_EVERY)
                || options.cancel.load(Ordering::Relaxed);
            if let Some(out) = options.out.as_ref().filter(|_| is_due) {
                // Where it cannot be written, the files at the end cannot either, which is an error.
                let _ = done.keep(out);
            }
        });
    });
    options.progress.end_stage(SUITE);
    let mut done = done.into_inner().unwrap_or_else(PoisonError::into_inner);
    if done.verdicts.len() < todo.len() {
        return Err(done.stopped(options.out.as_deref(), todo.len()));
    }
    let verdicts: Vec<Verdict> = done.verdicts.into_values().collect();
    if let Some(out) = &options.out {
        write_json(&out.join("verify.json"), &verdicts)?;
        page::rows(&verdicts).write(&out.join("verify.csv"))?;
        page::write(out, &options.cases, &verdicts)?;
        // All of it is in the others now.
        let _ = std::fs::remove_file(out.join(UNFINISHED));
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::verify::{builtin, settings};

    /// Asks to stop once two experiments are reported.
    struct StopsAfterTwo(Arc<AtomicBool>, Mutex<usize>);

    impl Progress for StopsAfterTwo {
        fn message(&self, _: &str) {
            let mut heard = self.1.lock().expect("no other failed");
            *heard += 1;
            self.0.store(*heard == 2, Ordering::Relaxed);
        }
    }

    /// Law: a suite that is stopped keeps the rows of what is finished and says where; one that is
    /// finished leaves no such file.
    #[test]
    fn what_is_finished_is_kept() {
        let folder = tempfile::tempdir().expect("a folder");
        let fast = ["free-fall", "projectile", "mass-properties"];
        let cases = || {
            let all = builtin().expect("sound").into_iter();
            all.filter(|case| fast.contains(&case.id.as_str())).collect::<Vec<_>>()
        };
        let setting = settings().into_iter().next().expect("one");
        let run = |cancel: Arc<AtomicBool>, progress: Arc<dyn Progress>| {
            let options = SuiteOptions {
                cases: cases(),
                settings: vec![setting.clone()],
                out: Some(folder.path().to_owned()),
                jobs: 1,
                cancel,
                progress,
            };
            run_suite(&options, &crate::world::create)
        };
        let rows = |file: &str| {
            let text = std::fs::read_to_string(folder.path().join(file)).ok()?;
            Some(text.lines().skip(1).map(str::to_owned).collect::<Vec<_>>())
        };
        let cancel = Arc::new(AtomicBool::new(false));
        let stops = Arc::new(StopsAfterTwo(cancel.clone(), Mutex::new(0)));
        let said = run(cancel, stops).expect_err("law: it is stopped").to_string();
        let expected = "stopped; 2 of 3 experiments are finished, in ";
        assert!(said.starts_with(expected), "law: expected `{expected}…`, got `{said}`");
        let kept = rows(UNFINISHED).expect("law: what is finished is kept");
        assert_eq!(kept.len(), 2, "law: each finished one, got {kept:?}");
        assert_eq!(rows("verify.csv"), None, "law: no table looks like that of the whole suite");
        let silent = Arc::new(crate::protocol::Silent);
        let stopped = run(Arc::new(AtomicBool::new(true)), silent.clone());
        let said = stopped.expect_err("law: nothing begins").to_string();
        assert!(said.contains("0 of 3 experiments"), "law: nothing is finished, got `{said}`");
        assert_eq!(rows(UNFINISHED), None, "law: no rows of the suite before are left");
        run(Arc::default(), silent).expect("law: the same begins anew");
        let all = rows("verify.csv").expect("law: the whole table");
        assert_eq!(all[..2], kept[..], "law: the same rows, first");
        assert_eq!((all.len(), rows(UNFINISHED)), (3, None), "law: nothing is unfinished");
    }
}
