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

use super::{Case, Setting, Status, Verdict, verify};
use crate::protocol::Progress;
use crate::record::{FileError, write_file, write_json};
use crate::report::{LawCase, LawCurve, LawRow, ReportError, write_laws};
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
        let path = out.join("verify.csv");
        let rows = table(&verdicts).map_err(|e| FileError::new("write", &path, e))?;
        write_file(&path, &rows)?;
        write_laws(out, &pages(&options.cases, &verdicts))?;
    }
    Ok(verdicts)
}

/// `verify.csv`: one row a case and setting.
fn table(verdicts: &[Verdict]) -> Result<Vec<u8>, csv::Error> {
    let mut writer = csv::Writer::from_writer(Vec::new());
    let header = "case,setting,engine,expected,tolerance,got,unit,status";
    writer.write_record(header.split(','))?;
    for v in verdicts {
        writer.write_record([
            v.id.as_str(),
            &v.setting,
            &format!("{} {}, {}", v.backend, v.version, v.precision),
            &v.expected.to_string(),
            &v.tolerance.to_string(),
            &v.got.map_or(String::new(), |got| got.to_string()),
            &v.unit,
            v.status.words(),
        ])?;
    }
    writer.into_inner().map_err(|e| e.into_error().into())
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

fn pages(cases: &[Case], verdicts: &[Verdict]) -> Vec<LawCase> {
    cases
        .iter()
        .map(|case| {
            let of_case: Vec<&Verdict> = verdicts.iter().filter(|v| v.id == case.id).collect();
            let axes = of_case.iter().find_map(|v| v.outcome.as_ref());
            LawCase {
                id: case.id.clone(),
                title: case.title.clone(),
                law: case.law.clone(),
                source: case.source.clone(),
                quantity: case.quantity.clone(),
                x: axes.map(|o| o.x.clone()).unwrap_or_default(),
                y: axes.map(|o| o.y.clone()).unwrap_or_default(),
                rows: of_case.iter().map(|v| row(v)).collect(),
                curves: of_case.iter().flat_map(|v| curves(v)).collect(),
            }
        })
        .collect()
}

fn row(verdict: &Verdict) -> LawRow {
    LawRow {
        setting: verdict.setting.clone(),
        engine: format!("{} {}, {}", verdict.backend, verdict.version, verdict.precision),
        expected: verdict.expected,
        got: verdict.got,
        tolerance: verdict.tolerance,
        unit: verdict.unit.clone(),
        verdict: verdict.status.words().to_owned(),
        met: verdict.pass,
        as_expected: verdict.status.as_expected(),
        remarks: verdict.known_reason.iter().chain(&verdict.note).cloned().collect(),
    }
}

fn curves(verdict: &Verdict) -> Vec<LawCurve> {
    let all = verdict.outcome.iter().flat_map(|o| &o.curves);
    all.map(|c| LawCurve {
        setting: (!c.law).then(|| verdict.setting.clone()),
        name: c.name.clone(),
        points: c.points.clone(),
    })
    .collect()
}

/// How many verdicts have each status.
pub fn tally(verdicts: &[Verdict], status: Status) -> usize {
    verdicts.iter().filter(|v| v.status == status).count()
}
