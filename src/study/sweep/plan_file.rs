//! `plan.json`: every run of a sweep before any is carried out.

use std::{fmt::Display, path::Path, str::FromStr};

use serde::{Deserialize, Serialize};
use serde_json::{Map, Value};

use super::{
    super::{
        RunOptions, StudyError,
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
    /// Number of samples of a latin hypercube; none else.
    pub samples: Option<usize>,
    /// Fields with listed values, `path=v1,v2`.
    pub over: Vec<String>,
    /// Fields whose values are drawn, `path=low..high`.
    pub ranges: Vec<String>,
    /// Changes that every run has, `path=value`.
    pub changes: Vec<String>,
    /// Configurations of each point.
    pub configurations: u32,
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
        samples: match options.design {
            Design::LatinHypercube(count) => Some(count),
            Design::Grid | Design::OneAtATime => None,
        },
        over: options.over.iter().map(|f| f.text.clone()).collect(),
        ranges: options.ranges.iter().map(|r| r.text.clone()).collect(),
        changes: options.changes.iter().map(|c| c.text().to_owned()).collect(),
        configurations: options.configurations,
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

    /// Reads it from a folder.
    ///
    /// # Errors
    /// [`StudyError::File`], [`StudyError::Scenario`] for a plan of another
    /// version.
    pub fn read(out: &Path) -> Result<Self, StudyError> {
        let path = out.join(PLAN_FILE);
        let plan: Self = read_json(&path)?;
        if plan.format != FORMAT || plan.version != VERSION {
            return Err(StudyError::Scenario(format!(
                "{} is of format `{}`, version {}; this program reads `{FORMAT}`, version {VERSION}",
                path.display(),
                plan.format,
                plan.version
            )));
        }
        Ok(plan)
    }

    /// What was asked for, with results in `run.out`.
    ///
    /// # Errors
    /// [`StudyError::Scenario`] for what cannot be read.
    pub fn options(&self, run: RunOptions) -> Result<SweepOptions, StudyError> {
        fn parsed<T: FromStr<Err: Display>>(texts: &[String]) -> Result<Vec<T>, StudyError> {
            let each = texts.iter().map(|t| t.parse().map_err(|e: T::Err| e.to_string()));
            each.collect::<Result<_, _>>().map_err(StudyError::Scenario)
        }
        let design = match (self.design.as_str(), self.samples) {
            ("grid", None) => Design::Grid,
            ("one_at_a_time", None) => Design::OneAtATime,
            ("latin_hypercube", Some(count)) => Design::LatinHypercube(count),
            (other, _) => {
                return Err(StudyError::Scenario(format!(
                    "the plan's design is `{other}`; allowed are grid, one_at_a_time, and \
                     latin_hypercube with samples"
                )));
            }
        };
        Ok(SweepOptions {
            scenario: self.scenario.clone().into(),
            changes: parsed(&self.changes)?,
            over: parsed(&self.over)?,
            ranges: parsed(&self.ranges)?,
            design,
            configurations: self.configurations,
            run,
        })
    }

    /// What makes it this sweep: configurations may be added to it.
    fn points(&self) -> Vec<Vec<&str>> {
        let mut points: Vec<Vec<&str>> = vec![
            vec![self.name.as_str()],
            self.over.iter().map(String::as_str).collect(),
            self.ranges.iter().map(String::as_str).collect(),
            self.changes.iter().map(String::as_str).collect(),
        ];
        let mut before = "";
        for run in &self.runs {
            if run.point != before {
                points.push(run.changes.iter().map(String::as_str).collect());
            }
            before = &run.point;
        }
        points
    }
}
