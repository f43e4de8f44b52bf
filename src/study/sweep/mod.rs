//! Sweeps: one scenario at many values of its fields, one table.

mod effects;
mod factor;
mod plan_file;
mod points;
mod tasks;

pub use factor::{Factor, SampledRange};
pub use plan_file::{PLAN_FILE, PlannedPoint, SweepPlan};
pub use points::{Design, Point};
pub use tasks::{SweepStatus, SweepTasks};

use std::path::PathBuf;

use serde_json::Value;

use super::{
    RunOptions, StudyError,
    variations::{Variation, Varied, carry_out_variations, collect_stored},
};
use crate::record::{RunRow, read_json};
use crate::report::{self, OUTCOMES, Sweep, SweepFactor, SweepRun};
use crate::scenario::{Override, Scenario, load};

/// What to vary, and how.
pub struct SweepOptions {
    /// The scenario's file.
    pub scenario: PathBuf,
    /// Changes that every run has.
    pub changes: Vec<Override>,
    /// Fields with listed values.
    pub over: Vec<Factor>,
    /// Fields whose values are drawn.
    pub ranges: Vec<SampledRange>,
    /// How points are made of them.
    pub design: Design,
    /// Configurations a point, each the same grains mixed anew.
    pub configurations: u32,
    /// Where to, how many at a time, whom to tell.
    pub run: RunOptions,
}

/// A sweep that was checked, and not yet carried out.
pub struct SweepStudy {
    options: SweepOptions,
    scenario: Scenario,
    points: Vec<Point>,
    varied: Varied,
}

impl SweepStudy {
    /// Makes the points and checks the scenario at each of them.
    ///
    /// # Errors
    /// [`StudyError::Faults`] with the faults of all points,
    /// [`StudyError::Scenario`] of what is varied.
    pub fn new(options: SweepOptions) -> Result<Self, StudyError> {
        let listed = options.over.iter().map(|f| &f.path);
        let paths: Vec<&String> = listed.chain(options.ranges.iter().map(|r| &r.path)).collect();
        if let Some(twice) = paths.iter().enumerate().find(|(n, p)| paths[..*n].contains(p)) {
            return Err(StudyError::Scenario(format!("`{}` is varied twice", twice.1)));
        }
        let scenario = load(&options.scenario, &options.changes)?.scenario;
        let points = points::points(options.design, &options.over, &options.ranges, &scenario)?;
        let variations = points.iter().map(|point| Variation {
            name: point.name.clone(),
            group: "sweep".to_owned(),
            changes: point.changes.clone(),
            configurations: None,
        });
        let varied = Varied::load(&options.scenario, &options.changes, variations.collect())?;
        Ok(Self { options, scenario, points, varied })
    }

    /// The plan: every run with its changes, and the name under which its last
    /// stage is stored.
    ///
    /// # Errors
    /// When grains or apparatus of a point cannot be made.
    pub fn plan(&self) -> Result<SweepPlan, StudyError> {
        plan_file::plan(&self.options, &self.scenario.name, &self.points, &self.varied)
    }

    /// Carries it out and writes `plan.json`, `sweep.csv`, `sweep.json`,
    /// `sweep.md`, `report.html`, `figures/` and `runs/<name>/`; anew after each
    /// configuration of all points. What is stored in the folder is not done
    /// again.
    ///
    /// # Errors
    /// [`StudyError`]. A run that fails is a row that says why.
    pub fn carry_out(&self) -> Result<Sweep, StudyError> {
        self.plan()?.write(&self.options.run.out)?;
        let mut found = None;
        let mut so_far = |rows: &[RunRow]| {
            let sweep = self.found(rows)?;
            report::write_sweep(&self.options.run.out, &sweep)?;
            found = Some(sweep);
            Ok(())
        };
        let configurations = self.options.configurations;
        carry_out_variations(&self.varied, configurations, &self.options.run, &mut so_far)?;
        found.ok_or_else(|| StudyError::Scenario("the sweep has no point".to_owned()))
    }

    /// Puts what is stored of it into the same files, whoever carried it out;
    /// a run that is not whole is a row that says so.
    ///
    /// # Errors
    /// [`StudyError`].
    pub fn collect(&self) -> Result<Sweep, StudyError> {
        let rows = collect_stored(&self.varied, self.options.configurations, &self.options.run)?;
        let sweep = self.found(&rows)?;
        report::write_sweep(&self.options.run.out, &sweep)?;
        Ok(sweep)
    }

    /// What is varied, as the report has it.
    fn factors(&self) -> Vec<SweepFactor> {
        let listed = self.options.over.iter().enumerate().map(|(n, f)| {
            // One at a time the scenario's own value is one of them.
            let mut values: Vec<Value> = Vec::new();
            for point in &self.points {
                if !values.contains(&point.values[n]) {
                    values.push(point.values[n].clone());
                }
            }
            let numeric = values.iter().all(Value::is_number);
            SweepFactor { path: f.path.clone(), values, sampled: false, numeric }
        });
        let drawn = self.options.ranges.iter().map(|r| SweepFactor {
            path: r.path.clone(),
            values: vec![r.low.into(), r.high.into()],
            sampled: true,
            numeric: true,
        });
        listed.chain(drawn).collect()
    }

    fn found(&self, rows: &[RunRow]) -> Result<Sweep, StudyError> {
        let runs = rows.iter().map(|row| self.run(row)).collect::<Result<Vec<_>, StudyError>>()?;
        let factors = self.factors();
        let effects = effects::effects(self.options.design, &factors, &self.points, &runs);
        Ok(Sweep {
            scenario: self.scenario.name.clone(),
            design: plan_file::name(self.options.design),
            configurations: self.options.configurations,
            planned: self.points.len() * self.options.configurations as usize,
            points: effects::point_rows(&self.points, &runs),
            factors,
            runs,
            effects,
        })
    }

    /// A run with the numbers of its summary.
    fn run(&self, row: &RunRow) -> Result<SweepRun, StudyError> {
        let point = self.points.iter().find(|p| p.name == row.variation);
        let mut run = SweepRun {
            run: row.run.clone(),
            point: row.variation.clone(),
            configuration: row.configuration,
            values: point.map_or_else(Vec::new, |p| p.values.clone()),
            outcomes: std::collections::BTreeMap::new(),
            meets_standard: row.meets_standard,
            failure: row.failure.clone(),
        };
        if run.failure.is_none() {
            let path = self.options.run.out.join("runs").join(&row.run).join("summary.json");
            let summary: Value = read_json(&path)?;
            for (path, _) in OUTCOMES {
                let pointer = format!("/{}", path.replace('.', "/"));
                if let Some(number) = summary.pointer(&pointer).and_then(Value::as_f64) {
                    run.outcomes.insert(path.to_owned(), number);
                }
            }
        }
        Ok(run)
    }
}
