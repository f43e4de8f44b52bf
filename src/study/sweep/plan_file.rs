//! `plan.json`: every run of a sweep before any is carried out.

use std::path::Path;

use serde::{Deserialize, Serialize};
use serde_json::{Map, Value};

use super::{
    super::{
        StudyError,
        plan::Plan,
        variations::{GrainSets, Varied, planned_run},
    },
    Design, Point, SweepOptions,
};
use crate::record::{read_json, write_json};

/// Name of the file in the output folder.
pub const PLAN_FILE: &str = "plan.json";

/// What `format` says.
const FORMAT: &str = "pluvia-sweep-plan";

/// Raised whenever a program made for the version before would misread a plan.
const VERSION: u32 = 1;

/// A plan.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct SweepPlan {
    /// `pluvia-sweep-plan`.
    pub format: String,
    /// 1.
    pub version: u32,
    /// Program and version that made it.
    pub program: String,
    /// The scenario's file, as it was given.
    pub scenario: String,
    /// Its name.
    pub name: String,
    /// `grid`, `one_at_a_time` or `latin_hypercube`.
    pub design: String,
    /// Fields that are varied.
    pub factors: Vec<String>,
    /// Changes that every run has, `path=value`.
    pub changes: Vec<String>,
    /// Every run, point by point, configurations in a row.
    pub runs: Vec<PlannedPoint>,
}

/// One run of a plan.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct PlannedPoint {
    /// Its name and that of its folder.
    pub run: String,
    /// The point that it belongs to.
    pub point: String,
    /// The value of each factor.
    pub values: Map<String, Value>,
    /// What it changes in the scenario beside what every run has.
    pub changes: Vec<String>,
    /// Seed of its random streams.
    pub seed: u64,
    /// Which mixing of the grains.
    pub configuration: u32,
    /// Name of its last stage in the store: a hash of everything that
    /// determines the result, the versions of program and engine included.
    pub key: String,
}

/// The name of a design in files.
pub(super) fn name(design: Design) -> &'static str {
    match design {
        Design::Grid => "grid",
        Design::OneAtATime => "one_at_a_time",
        Design::LatinHypercube(_) => "latin_hypercube",
    }
}

/// Makes the plan.
pub(super) fn plan(
    options: &SweepOptions,
    scenario_name: &str,
    points: &[Point],
    varied: &Varied,
) -> Result<SweepPlan, StudyError> {
    let factors: Vec<String> = options
        .over
        .iter()
        .map(|f| f.path.clone())
        .chain(options.ranges.iter().map(|r| r.path.clone()))
        .collect();
    let mut grains = GrainSets::default();
    let mut runs = Vec::new();
    for (point, (variation, scenario)) in points.iter().zip(&varied.all) {
        let set = grains.of(scenario)?;
        let planned: Vec<_> = (0..options.configurations)
            .map(|number| planned_run(variation, scenario, number, set.clone()))
            .collect();
        let nodes = Plan::new(&planned)?;
        for (run, of_run) in planned.iter().zip(&nodes.runs) {
            let last = of_run.control.or(of_run.stages.last().copied());
            runs.push(PlannedPoint {
                run: run.name.clone(),
                point: point.name.clone(),
                values: factors.iter().cloned().zip(point.values.iter().cloned()).collect(),
                changes: point.changes.iter().map(|c| c.text().to_owned()).collect(),
                seed: run.scenario.seed,
                configuration: run.scenario.configuration,
                key: last.map(|n| nodes.nodes[n].key.clone()).unwrap_or_default(),
            });
        }
    }
    Ok(SweepPlan {
        format: FORMAT.to_owned(),
        version: VERSION,
        program: format!("pluvia {}", env!("CARGO_PKG_VERSION")),
        scenario: options.scenario.display().to_string(),
        name: scenario_name.to_owned(),
        design: name(options.design).to_owned(),
        factors,
        changes: options.changes.iter().map(|c| c.text().to_owned()).collect(),
        runs,
    })
}

impl SweepPlan {
    /// Writes it into a folder. A folder that holds the plan of another sweep is
    /// left as it is; more configurations of the same sweep are none.
    ///
    /// # Errors
    /// [`StudyError::Scenario`] for such a folder, [`StudyError::File`].
    pub fn write(&self, out: &Path) -> Result<(), StudyError> {
        let path = out.join(PLAN_FILE);
        if path.exists() {
            let there: Self = read_json(&path)?;
            if there.points() != self.points() {
                return Err(StudyError::Scenario(format!(
                    "{} is the plan of another sweep; choose another folder with --out",
                    path.display()
                )));
            }
        }
        Ok(write_json(&path, self)?)
    }

    /// What makes it this sweep: configurations may be added to it.
    fn points(&self) -> (&str, &[String], &[String], Vec<(&str, &[String])>) {
        let mut points: Vec<(&str, &[String])> = Vec::new();
        for run in &self.runs {
            if points.last().is_none_or(|(name, _)| *name != run.point) {
                points.push((&run.point, &run.changes));
            }
        }
        (&self.name, &self.factors, &self.changes, points)
    }
}
