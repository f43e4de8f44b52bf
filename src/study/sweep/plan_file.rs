//! `plan.json`: every run of a sweep before any is run.

use std::{fmt::Display, iter::repeat_n};

use super::*;
use crate::record::refuse_without;

/// Name of the file in the output folder.
pub const PLAN_FILE: &str = "plan.json";

/// Name of the scenario's copy in the output folder.
pub const SCENARIO_FILE: &str = "scenario.json";

const FORMAT: &str = "pluvia-sweep-plan";

/// Raised whenever a program made for the version before would misread a plan.
const VERSION: u32 = 2;

/// A plan.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct SweepPlan {
    /// `pluvia-sweep-plan`.
    pub format: String,
    /// 2.
    pub version: u32,
    /// Program and version that made it.
    pub program: String,
    /// Engines of its runs with version and precision.
    pub engines: Vec<String>,
    /// The scenario's file, as it was given.
    pub scenario: String,
    /// The folder from which relative names of files in changes lead; none in plans of earlier builds,
    /// where they lead from the folder of whoever runs a stage.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub folder: Option<String>,
    /// Its name.
    pub name: String,
    /// SHA-256 of the scenario's copy in the folder, as JSON in one line.
    pub scenario_sha256: String,
    /// `grid`, `one_at_a_time` or `latin_hypercube`.
    pub design: String,
    /// Number of samples of a latin hypercube; none else.
    pub samples: Option<usize>,
    /// Fields with listed values, `path=v1,v2`.
    pub over: Vec<String>,
    /// Parameters of a sensitivity design, with what makes their ends.
    pub parameters: Vec<Parameter>,
    /// Whether they are those of the design's smaller specimen.
    pub quick: bool,
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

impl SweepStudy {
    /// The plan: every run with its changes, and the name under which its last stage is stored.
    ///
    /// # Errors
    /// When grains or apparatus of a point cannot be made.
    pub fn plan(&self) -> Result<SweepPlan, StudyError> {
        let Self { options, gathered, scenario, points, varied, specimens: _ } = self;
        let factors: Vec<String> = options.names().into_iter().map(str::to_owned).collect();
        let engines = varied.scenarios().map(|scenario| {
            let info = crate::world::info(scenario.engine.backend);
            format!("{} {} in {} precision", info.name, info.version, info.precision)
        });
        let planned = varied.runs(options.configurations)?;
        let plan = Plan::new(&planned)?;
        let of_runs = points.iter().flat_map(|p| repeat_n(p, options.configurations as usize));
        let runs = of_runs.zip(planned.iter().zip(&plan.runs)).map(|(point, (run, nodes))| {
            let last = nodes.rest_test.or(nodes.stages.last().copied());
            PlannedPoint {
                run: run.name.clone(),
                point: point.name.clone(),
                values: factors.iter().cloned().zip(point.values.iter().cloned()).collect(),
                changes: point.changes.iter().map(|c| c.text().to_owned()).collect(),
                seed: run.scenario.seed,
                configuration: run.scenario.configuration,
                key: last.map(|n| plan.nodes[n].key().to_owned()).unwrap_or_default(),
            }
        });
        let is_here = options.folder.as_os_str().is_empty();
        let folder = if is_here { Path::new(".") } else { &options.folder };
        let folder = std::path::absolute(folder).ok();
        Ok(SweepPlan {
            format: FORMAT.to_owned(),
            version: VERSION,
            program: format!("pluvia {}", env!("CARGO_PKG_VERSION")),
            engines: each_once(engines),
            scenario: options.scenario.display().to_string(),
            folder: folder.and_then(|folder| folder.to_str().map(str::to_owned)),
            name: scenario.name.clone(),
            scenario_sha256: hash_json(gathered),
            design: name(options.design).to_owned(),
            samples: match options.design {
                Design::LatinHypercube(count) => Some(count),
                Design::Grid | Design::OneAtATime => None,
            },
            over: options.over.iter().map(|f| f.text.clone()).collect(),
            parameters: options.parameters.clone(),
            quick: options.quick,
            ranges: options.ranges.iter().map(|r| r.text.clone()).collect(),
            changes: options.changes.iter().map(|c| c.text().to_owned()).collect(),
            configurations: options.configurations,
            runs: runs.collect(),
        })
    }
}

impl SweepPlan {
    /// Writes it and the scenario that it was made of into a folder.
    pub(super) fn write(&self, out: &Path, gathered: &Value) -> Result<(), StudyError> {
        write_json(&out.join(SCENARIO_FILE), gathered)?;
        Ok(write_json(&out.join(PLAN_FILE), self)?)
    }

    /// Reads it from a folder.
    ///
    /// # Errors
    /// [`StudyError::File`], [`StudyError::Scenario`] for a plan of another version.
    pub fn read(out: &Path) -> Result<Self, StudyError> {
        refuse_without(out, PLAN_FILE, "it is no folder of a sweep: it has no plan.json")?;
        let path = out.join(PLAN_FILE);
        let json: Value = read_json(&path)?;
        let format = json.get("format").and_then(Value::as_str).unwrap_or_default();
        let version = json.get("version").and_then(Value::as_u64).unwrap_or_default();
        if format != FORMAT || version != u64::from(VERSION) {
            return refused(format!(
                "{} is of format `{format}`, version {version}; this program reads `{FORMAT}`, \
                 version {VERSION}",
                path.display(),
            ));
        }
        let plan = serde_json::from_value(json).map_err(|e| FileError::malformed(&path, e))?;
        Ok(plan)
    }

    /// What was asked for, of the scenario that is kept in the folder of the plan.
    ///
    /// # Errors
    /// [`StudyError::Scenario`] for what cannot be read.
    pub fn options(&self, out: &Path) -> Result<SweepOptions, StudyError> {
        fn parsed<T: FromStr<Err: Display>>(texts: &[String]) -> Result<Vec<T>, StudyError> {
            let each = texts.iter().map(|t| t.parse().map_err(|e: T::Err| e.to_string()));
            each.collect::<Result<_, _>>().map_err(StudyError::Scenario)
        }
        // As the command allows: without a limit a plan asks for work without end.
        let count = self.configurations;
        if !(1..=1000).contains(&count) {
            return refused(format!(
                "the plan's configurations are {count}; allowed are 1 to 1000"
            ));
        }
        if let Some(count) = self.samples.filter(|count| !(2..=10_000).contains(count)) {
            return refused(format!("the plan's samples are {count}; allowed are 2 to 10000"));
        }
        let design = match (self.design.as_str(), self.samples) {
            ("grid", None) => Design::Grid,
            ("one_at_a_time", None) => Design::OneAtATime,
            ("latin_hypercube", Some(count)) => Design::LatinHypercube(count),
            (other, _) => {
                return refused(format!(
                    "the plan's design is `{other}`; allowed are grid, one_at_a_time, and \
                     latin_hypercube with samples"
                ));
            }
        };
        Ok(SweepOptions {
            scenario: out.join(SCENARIO_FILE),
            changes: parsed(&self.changes)?,
            over: parsed(&self.over)?,
            parameters: self.parameters.clone(),
            quick: self.quick,
            ranges: parsed(&self.ranges)?,
            design,
            configurations: self.configurations,
            folder: self.folder.as_ref().map(PathBuf::from).unwrap_or_default(),
        })
    }
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::*;

    fn options(change: &dyn Fn(&mut Value)) -> Result<SweepOptions, StudyError> {
        let mut plan = json!({
            "format": FORMAT, "version": VERSION, "program": "", "engines": [], "scenario": "a.json",
            "name": "a", "scenario_sha256": "", "design": "latin_hypercube", "samples": 3, "over": [],
            "parameters": [], "quick": false, "ranges": ["contact.restitution=0.1..0.6"],
            "changes": [], "configurations": 2, "runs": []
        });
        change(&mut plan);
        let plan: SweepPlan = serde_json::from_value(plan).expect("a plan");
        plan.options(Path::new("out"))
    }

    #[test]
    fn a_plan_that_asks_for_work_without_end_is_refused() {
        assert!(options(&|_| ()).is_ok(), "law: what the command allows is");
        for (field, value) in [
            ("configurations", u64::from(u32::MAX)),
            ("configurations", 0),
            ("samples", u64::MAX),
            ("samples", 1),
        ] {
            let refused = options(&|plan| plan[field] = value.into());
            let said = refused.err().map(|error| error.to_string()).unwrap_or_default();
            let told = said.contains(field) && said.contains(&value.to_string());
            assert!(told, "law: {field} = {value} is refused with what it is, got `{said}`");
        }
    }
}
