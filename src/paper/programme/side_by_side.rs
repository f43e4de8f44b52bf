//! The programme under several interpretations of the paper, side by side.

use std::collections::BTreeSet;

use super::reproduce::{Scenarios, programme, study_view};
use super::*;
use crate::paper;
use crate::protocol::Work;
use crate::record::{SeriesRow, StageStore, create_folder};
use crate::scenario::warnings;
use crate::study::{carry_out_each, write_shared_grains};

/// Folder of the columns in the output folder.
const FOLDER: &str = "interpretations";

/// Which interpretations to run.
pub struct InterpretationsOptions {
    /// A few hundred grains instead of 1456, and shorter vibration.
    pub quick: bool,
    /// Number of configurations.
    pub configurations: u32,
    /// The interpretations, in the order in which they are run.
    pub interpretations: Vec<Interpretation>,
    /// What is changed in every scenario of every interpretation.
    pub changes: Vec<Override>,
}

/// What came out.
#[derive(Debug, Clone, PartialEq)]
pub struct InterpretationsOutcome {
    /// Every interpretation of the table, those of earlier commands among them.
    pub columns: Vec<InterpretationColumn>,
    /// The page.
    pub report: PathBuf,
}

/// Loads the programme under each interpretation, which leaves `interpretations.json`,
/// `interpretations.md`, `interpretations.html` and `figures/`, anew after every interpretation,
/// `grains.json`, `sieve.csv` and `runs/<name>/`; those run there before stay in the table. A run
/// that fails is a line of it.
///
/// # Errors
/// [`StudyError`] where the changes do not fit.
pub fn interpretations(
    options: InterpretationsOptions,
) -> Result<Study<InterpretationsOutcome>, StudyError> {
    let load =
        |interpretation| Scenarios::load(options.quick, Some(interpretation), &options.changes);
    let all = options.interpretations.iter().map(load).collect::<Result<Vec<_>, _>>()?;
    let question = json!({ (MEANWHILE): {
        "quick": options.quick,
        "configurations": options.configurations,
        "interpretations": options.interpretations.iter().map(|i| i.name).collect::<Vec<&str>>(),
        "changes": options.changes.iter().map(Override::text).collect::<Vec<&str>>(),
    } });
    Ok(Study {
        command: "interpretations",
        question,
        scenarios: all.iter().flat_map(Scenarios::all).cloned().collect(),
        conclude: Box::new(move |run| {
            create_folder(&run.out)?;
            let mut outcome = None;
            for (interpretation, scenarios) in options.interpretations.iter().zip(&all) {
                let Interpretation { name, title, .. } = interpretation;
                run.progress.message(&format!("interpretation {name}: {title}"));
                let column = carry_out_interpretation(&options, run, interpretation, scenarios)?;
                let columns = keep_and_read(run, column)?;
                write_interpretations(&run.out, &columns, standard(&Scale::PAPER))?;
                let report = run.out.join("interpretations.html");
                outcome = Some(InterpretationsOutcome { columns, report });
            }
            outcome.ok_or_else(|| StudyError::Scenario("no interpretation is named".to_owned()))
        }),
    })
}

fn carry_out_interpretation(
    options: &InterpretationsOptions,
    run: &RunOptions,
    interpretation: &Interpretation,
    scenarios: &Scenarios,
) -> Result<InterpretationColumn, StudyError> {
    let grains = Arc::new(make_grains(&scenarios.pluviation)?);
    let runs = programme(scenarios, &grains, options.configurations, 1);
    let plan = Plan::new(&runs)?;
    // Beside `runs/`, where whoever reads one of these looks for the grains of all.
    write_shared_grains(&run.out, &scenarios.pluviation, &grains)?;
    let store = StageStore::open(&run.out.join("stages"))?;
    let _work = Work::begin(run.progress.as_ref(), plan.expected());
    let each = carry_out_each(&crate::world::create, &plan, &runs, &store, run)?;
    let mut records: Vec<RunRecord> = Vec::new();
    let mut failures = Vec::new();
    for (run, result) in runs.iter().zip(each) {
        match result {
            Ok(done) => records.push(done),
            Err(reason) => failures.push(InterpretationFailure { run: run.name.clone(), reason }),
        }
    }
    let study = study_view(options.configurations, scenarios, &grains, &records)?;
    let claims = paper::claims(&study);
    let warnings: BTreeSet<String> = scenarios.all().into_iter().flat_map(warnings).collect();
    Ok(InterpretationColumn {
        name: interpretation.name.to_owned(),
        title: interpretation.title.clone(),
        meaning: interpretation.meaning.clone(),
        source: interpretation.source.clone(),
        settings: beside::label(&EngineSettings::default(), &scenarios.pluviation.engine),
        programme: scenarios.programme_of_interpretations_hash(options.configurations)?,
        quick: options.quick,
        configurations: options.configurations,
        planned_runs: runs.len(),
        runs: records.into_iter().map(shown).collect(),
        failures,
        warnings: warnings.into_iter().collect(),
        claims,
    })
}

/// A run with what the table and the figures need of it.
fn shown(mut run: RunRecord) -> RunRecord {
    run.series.retain(SeriesRow::is_shaken);
    run.rest_test.clear();
    run
}

/// Keeps a column, and gives it with the others of the same programme, in the
/// order of the interpretations.
fn keep_and_read(
    run: &RunOptions,
    column: InterpretationColumn,
) -> Result<Vec<InterpretationColumn>, StudyError> {
    let name = format!("{}.json", column.name);
    let folder = run.out.join(FOLDER);
    let progress = run.progress.as_ref();
    let mut columns = beside::keep(&folder, &name, &column, |c| &c.programme, progress)?;
    columns.push(column);
    let place = |c: &InterpretationColumn| Interpretation::names().position(|n| n == c.name);
    columns.sort_by_key(|c| (place(c).unwrap_or(usize::MAX), c.name.clone()));
    Ok(columns)
}
