//! Sweeps: one scenario at many values of its fields, one table.

mod drawn;
mod edited;
mod effects;
mod factor;
mod plan_file;
mod points;
mod single;
mod snakemake;
mod specimens;
mod tasks;
mod twice;

pub use factor::{Factor, SampledRange};
pub use plan_file::{PLAN_FILE, PlannedPoint, SCENARIO_FILE, SweepPlan};
pub use points::{Design, Point};
pub use snakemake::{SNAKEFILE, write as write_snakefile};
pub use tasks::{SweepStage, SweepStatus, SweepTasks};

use super::sensitivity::{Designed, read_design};
use super::*;
use crate::record::RunLock;
use crate::report::{SPECIMEN, Sweep, SweepFactor, SweepRun, outcomes_in};
use crate::scenario::gathered;
use specimens::Specimens;

/// What to vary, and how.
pub struct SweepOptions {
    /// The scenario's file.
    pub scenario: PathBuf,
    /// Changes that every run has.
    pub changes: Vec<Override>,
    /// Fields with listed values.
    pub over: Vec<Factor>,
    /// Parameters of a design, varied one at a time.
    pub parameters: Vec<Parameter>,
    /// Whether they are those of the design's smaller specimen.
    pub quick: bool,
    /// Fields whose values are drawn.
    pub ranges: Vec<SampledRange>,
    /// How points are made of them.
    pub design: Design,
    /// Configurations per point, each a new random arrangement of the same grains.
    pub configurations: u32,
    /// Where relative names of files in all changes lead from; empty: the working directory.
    pub folder: PathBuf,
}

impl SweepOptions {
    /// Changes that every run has. Where specimens are varied, one of these stands in the place of
    /// the scenario's, which is never run and need not be there.
    fn common(&self) -> Vec<Override> {
        let is_its_own = |change: &Override| change.path() == SPECIMEN;
        let is_never_run =
            self.design != Design::OneAtATime && !self.changes.iter().any(is_its_own);
        let varied = self.over.iter().filter(|factor| is_never_run && factor.path == SPECIMEN);
        let first = varied.filter_map(|factor| factor.values.first()).map(|(_, change)| change);
        let placed = |change: &Override| change.clone().naming_files_in(&self.folder);
        self.changes.iter().chain(first).map(placed).collect()
    }

    /// The sweep of a sensitivity design: its scenario, and each of its parameters by itself.
    ///
    /// # Errors
    /// [`StudyError::Faults`] with all faults of the design.
    pub fn of_design(
        design: &Path,
        quick: bool,
        changes: &[Override],
        configurations: Option<u32>,
    ) -> Result<Self, StudyError> {
        let Designed { chosen, parameters, .. } = read_design(design, quick, changes)?;
        Ok(Self {
            scenario: chosen.scenario,
            changes: chosen.common,
            over: Vec::new(),
            parameters,
            quick,
            ranges: Vec::new(),
            design: Design::OneAtATime,
            configurations: configurations.unwrap_or(chosen.configurations),
            folder: PathBuf::new(),
        })
    }

    /// What names each factor, in the order of a point's values.
    fn names(&self) -> Vec<&str> {
        let listed = self.over.iter().map(|f| f.path.as_str());
        let parameters = self.parameters.iter().map(parameter_name);
        listed.chain(parameters).chain(self.ranges.iter().map(|r| r.path.as_str())).collect()
    }
}

/// The field that a parameter changes; its name where it changes several.
fn parameter_name(parameter: &Parameter) -> &str {
    if parameter.path.is_empty() { &parameter.name } else { &parameter.path }
}

/// A sweep that was checked, and not yet run.
pub struct SweepStudy {
    options: SweepOptions,
    /// The scenario's files as one.
    gathered: Value,
    scenario: Scenario,
    points: Vec<Point>,
    varied: Varied,
    /// The specimens that are realisations, or why those that are varied are not.
    specimens: Result<Option<Specimens>, String>,
}

impl SweepStudy {
    /// Makes the points and checks the scenario at each of them.
    ///
    /// # Errors
    /// [`StudyError::Faults`] with the faults of all points,
    /// [`StudyError::Scenario`] of what is varied, or of realisations that are all the same run.
    pub fn new(options: SweepOptions) -> Result<Self, StudyError> {
        twice::refuse(&options)?;
        let common = options.common();
        let scenario = load_scenario(&options.scenario, &common)?.scenario;
        let gathered = gathered(&options.scenario)?;
        let SweepOptions { design, over, parameters, ranges, .. } = &options;
        let mut points = points::points(*design, over, parameters, ranges, &scenario)?;
        for change in points.iter_mut().flat_map(|point| &mut point.changes) {
            *change = change.clone().naming_files_in(&options.folder);
        }
        twice::refuse_shared_realisations(&options.names(), &points, options.configurations)?;
        let variations =
            points.iter().map(|point| Variation::new(&point.name, "sweep", point.changes.clone()));
        let varied = Varied::load(&options.scenario, &common, variations.collect())?;
        refuse_repeats(&varied, CONFIGURATIONS, options.configurations)?;
        twice::refuse_same_runs(&points, &varied)?;
        let specimens = specimens::realisations(&options, &points, &varied);
        Ok(Self { options, gathered, scenario, points, varied, specimens })
    }

    /// Writes the plan, and the scenario as it was planned, into the output
    /// folder, so that the folder holds all that its stages need.
    ///
    /// # Errors
    /// [`StudyError::Scenario`] for a folder that holds another sweep, or this
    /// one of a scenario that was edited since; no plan is written then.
    pub fn write_plan(&self, run: &RunOptions) -> Result<SweepPlan, StudyError> {
        let plan = self.plan()?;
        let out = &run.out;
        create_folder(out)?;
        // Of two that begin there at once, the second finds the plan of the first.
        RunLock::take(out, |_| {
            edited::refuse(out, &plan, &self.options, &self.scenario)?;
            tell_warnings(self.varied.scenarios(), run.progress.as_ref());
            if self.varied.scenarios().any(|scenario| scenario.rest_test_s <= 0.0) {
                run.progress.message(
                    "warning: rest_test_s is 0: runs without a rest test are not valid and count \
                     in no mean (allowed: above 0)",
                );
            }
            if let Err(why) = &self.specimens {
                run.progress.message(&format!(
                    "{SPECIMEN}: its values are compared, not taken for realisations: {why}"
                ));
            }
            plan.write(out, &self.gathered)
        })?;
        Ok(plan)
    }

    /// As a study that leaves `plan.json`, `sweep.csv`, `sweep.json`, `sweep.md`, `report.html`,
    /// `figures/` and `runs/<name>/`; anew after each configuration of all points. A run that fails
    /// is a row that says why.
    pub fn study(self) -> Study<Sweep> {
        Study {
            command: "sweep",
            // The plan says what is asked; whoever writes it reports the warnings.
            question: Value::Null,
            scenarios: Vec::new(),
            conclude: Box::new(move |run| {
                self.write_plan(run)?;
                let configurations = self.options.configurations;
                conclude_so_far(&self.varied, configurations, run, |rows| {
                    self.write(rows, &run.out)
                })
            }),
        }
    }

    fn write(&self, rows: &[RunRow], out: &Path) -> Result<Sweep, StudyError> {
        let sweep = self.found(rows, out)?;
        report::write_sweep(out, &sweep)?;
        if let Some(table) = single::sensitivity(self, &sweep.factors, rows) {
            report::write_sensitivity(out, &table)?;
        }
        Ok(sweep)
    }

    /// What is varied, as the report has it.
    fn factors(&self) -> Vec<SweepFactor> {
        let listed = self.options.over.len() + self.options.parameters.len();
        let listed = self.options.names().into_iter().take(listed).enumerate().map(|(n, name)| {
            // One at a time the scenario's own value is one of them.
            let values = each_once(self.points.iter().map(|point| &point.values[n]));
            let values: Vec<Value> = values.into_iter().cloned().collect();
            let numeric = values.iter().all(Value::is_number);
            SweepFactor { path: name.to_owned(), values, sampled: false, numeric }
        });
        let drawn = self.options.ranges.iter().map(|r| SweepFactor {
            path: r.path.clone(),
            values: vec![r.low.into(), r.high.into()],
            sampled: true,
            numeric: true,
        });
        listed.chain(drawn).collect()
    }

    fn found(&self, rows: &[RunRow], out: &Path) -> Result<Sweep, StudyError> {
        let mut runs =
            rows.iter().map(|row| self.run(row, out)).collect::<Result<Vec<_>, StudyError>>()?;
        let (mut factors, mut points) = (self.factors(), self.points.clone());
        let specimens = self.specimens.as_ref().ok().and_then(Option::as_ref);
        if let Some(specimens) = specimens {
            (factors, points) = (specimens.without(&factors), specimens.points(&points));
            runs = runs.into_iter().map(|run| specimens.realised(run, &points)).collect();
        }
        // Whoever carried them out may have done so in another order.
        let place = |run: &SweepRun| points.iter().position(|p| p.name == run.point);
        runs.sort_by_key(|run| (run.configuration, place(run)));
        let effects = effects::effects(self.options.design, &factors, &points, &runs);
        let configurations = self.options.configurations;
        Ok(Sweep {
            scenario: self.scenario.name.clone(),
            design: plan_file::name(self.options.design),
            configurations: specimens.map_or(configurations, Specimens::count),
            planned: self.points.len() * configurations as usize,
            points: effects::point_rows(&points, &runs),
            factors,
            runs,
            effects,
            specimens: specimens.map_or_else(Vec::new, |of| of.names().to_vec()),
            names: laboratory::names(&self.scenario),
        })
    }

    /// A run with the numbers of its summary.
    fn run(&self, row: &RunRow, out: &Path) -> Result<SweepRun, StudyError> {
        let point = self.points.iter().find(|p| p.name == row.variation);
        let summary: Value = match row.failure {
            Some(_) => Value::Null,
            None => read_json(&folder_of(out, &row.run).join("summary.json"))?,
        };
        Ok(SweepRun {
            run: row.run.clone(),
            point: row.variation.clone(),
            configuration: row.configuration,
            values: point.map_or_else(Vec::new, |p| p.values.clone()),
            outcomes: outcomes_in(&summary),
            meets_standard: row.meets_standard,
            valid: row.valid,
            left_out_of_means: row.why_left_out(),
            failure: row.failure.clone(),
            withheld: Vec::deserialize(&summary["withheld"]).unwrap_or_default(),
            specimen: None,
        })
    }
}
