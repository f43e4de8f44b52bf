//! Calibration: the value of a field of the scenario at which a result of the run is as wanted.

mod concluded;
mod elements;
mod kept;
mod line;
mod question;
mod root;
mod search;
#[cfg(test)]
mod tests;
mod times;
mod under_way;

pub use question::{CalibrationTarget, GRAIN_FRICTION};

use super::*;
use super::{realisations::REALISATIONS, variations::carry_out_in};
use crate::measure::{Interval, InversePrediction, inference::t_quantile};
use crate::report::{
    Calibration, CalibrationEnding as Ending, CalibrationRun, CalibrationValue, text::compact,
};
use kept::{CONFIDENCE, Kept};
use line::in_result;
use question::{ANGLE_OF_REPOSE, Reading};
use search::search;
use under_way::{Experiment, Going, Halt, Question, Search};

/// What to find, and how.
pub struct CalibrationOptions {
    /// The scenario's file.
    pub scenario: PathBuf,
    /// Changes that every run has.
    pub changes: Vec<Override>,
    /// The result that is wanted.
    pub target: CalibrationTarget,
    /// The field of the scenario that is sought.
    pub unknown: String,
    /// Between which values.
    pub between: Interval,
    /// Realisations per value, at least 2: each a new random arrangement of the same grains.
    pub realisations: u32,
    /// How well the result is to be known, in its unit: half of the 95 %
    /// interval. `None` for the standard deviation of a single run.
    pub tolerance: Option<f64>,
    /// Maximum number of runs; `None` for 16 per realisation.
    pub most_runs: Option<usize>,
}

impl CalibrationOptions {
    /// The friction whose angle is the wanted angle of repose; none where anything else is asked.
    fn friction_of_angle(&self) -> Option<f64> {
        let is_asked = self.target.field == ANGLE_OF_REPOSE && self.unknown == GRAIN_FRICTION;
        is_asked.then(|| self.target.wanted.to_radians().tan())
    }
}

/// Runs by the bits of their value and their configuration.
type Known = HashMap<(u64, u32), CalibrationRun>;

/// Most runs per realisation where no number is typed.
const RUNS_A_REALISATION: usize = 16;
/// Fewer are used up by the first look.
const LEAST_RUNS_A_REALISATION: usize = 6;

/// Checks a calibration as far as that is possible before anything runs: the scenario at both ends
/// of the range, the unknown, the numbers. It leaves `calibrate.json`, `calibrate.md`,
/// `report.html`, `evaluations.csv`, `figures/` and `runs/<name>/`.
///
/// # Errors
/// [`StudyError::Faults`] of the scenario, [`StudyError::Scenario`] else. A result that no value
/// reaches is no error.
pub fn calibrate(options: CalibrationOptions) -> Result<Study<Calibration>, StudyError> {
    let scenario = load_scenario(&options.scenario, &options.changes)?.scenario;
    let measured = question::known(&options.target)
        .and_then(|()| question::measured(&options.target, &scenario))
        .and_then(|()| elements::there(&options.target, &scenario));
    let mut faults: Vec<String> = measured.err().iter().map(ToString::to_string).collect();
    let whole = question::takes_whole(&options.unknown, &scenario);
    faults.extend(whole.as_ref().err().map(ToString::to_string));
    let whole = whole.unwrap_or_default();
    let Interval { low, high } = options.between;
    if whole && (low.fract() != 0.0 || high.fract() != 0.0) {
        faults.push(format!(
            "--between {low}..{high}: `{}` takes whole numbers only",
            options.unknown
        ));
    }
    let realisations = options.realisations as usize;
    let most_runs = options.most_runs.unwrap_or(RUNS_A_REALISATION * realisations);
    if most_runs < LEAST_RUNS_A_REALISATION * realisations {
        faults.push(format!(
            "--most-runs {most_runs}: at least {} runs are needed, {LEAST_RUNS_A_REALISATION} \
             per realisation",
            LEAST_RUNS_A_REALISATION * realisations
        ));
    }
    if scenario.rest_test_s <= 0.0 {
        faults.push(format!(
            "{}: rest_test_s is {}: without a rest test no run is valid, and only valid runs count in \
             a calibration; it must be above 0",
            options.scenario.display(),
            scenario.rest_test_s
        ));
    }
    if !faults.is_empty() {
        return refused(faults.join("\n"));
    }
    let question = Question {
        wanted: options.target.wanted,
        between: (low, high),
        realisations: options.realisations,
        tolerance: options.tolerance,
        most_runs,
        whole,
        also: options.friction_of_angle(),
    };
    let asked = json!({
        "scenario": in_question(&scenario),
        "target": options.target.field,
        "wanted": options.target.wanted,
        "unknown": options.unknown,
        (MEANWHILE): {
            "between": [low, high],
            "realisations": options.realisations,
            "tolerance": options.tolerance,
            "most_runs": most_runs,
        },
    });
    let runs = Runs { options, question };
    // A value that the scenario does not allow is reported before anything runs.
    let ends = runs.varied(&[low, high])?;
    times::reached(&runs.options.target, &ends)?;
    refuse_repeats(&ends, REALISATIONS, runs.options.realisations)?;
    Ok(Study {
        command: "calibrate",
        question: asked,
        scenarios: ends.scenarios().cloned().collect(),
        conclude: Box::new(move |run| runs.find(&scenario, run)),
    })
}

/// The runs of a calibration.
struct Runs {
    options: CalibrationOptions,
    question: Question,
}

impl Runs {
    /// Asks for runs until the question is answered.
    fn find(&self, scenario: &Scenario, run: &RunOptions) -> Result<Calibration, StudyError> {
        let mut known = Known::new();
        let mut carry_out = |values: &[f64], configurations: Range<u32>| {
            let runs = self.at(values, configurations, &mut known, run)?;
            let mut all: Vec<CalibrationRun> = known.values().cloned().collect();
            all.sort_by(|a, b| {
                a.value.total_cmp(&b.value).then(a.configuration.cmp(&b.configuration))
            });
            report::write_calibration_runs(&run.out, &all)?;
            Ok(runs)
        };
        // One run tells whether the result is measured at all.
        carry_out(&[self.question.between.0], 0..1)?;
        let answer = search(&self.question, &mut carry_out)?;
        let found = concluded::conclude(&self.options, scenario, &self.question, answer);
        report::write_calibration(&run.out, &found)?;
        Ok(found)
    }

    /// Values of the unknown as variations of the scenario.
    fn varied(&self, values: &[f64]) -> Result<Varied, StudyError> {
        let variation = |value: &f64| {
            let typed = if self.question.whole { format!("{value:.0}") } else { value.to_string() };
            let change: Result<Override, _> = format!("{}={typed}", self.options.unknown).parse();
            let change = change.map_err(|e| StudyError::Scenario(e.to_string()))?;
            let changes = vec![change.typed_with("--between")];
            Ok(Variation::new(format!("at-{value}"), &self.options.unknown, changes))
        };
        let variations = values.iter().map(variation).collect::<Result<_, StudyError>>()?;
        Ok(Varied::load(&self.options.scenario, &self.options.changes, variations)?)
    }

    /// Runs what is not known yet, and gives the runs value by value.
    fn at(
        &self,
        values: &[f64],
        configurations: Range<u32>,
        known: &mut Known,
        options: &RunOptions,
    ) -> Result<Vec<CalibrationRun>, StudyError> {
        let key = |value: f64, configuration: u32| (value.to_bits(), configuration);
        let missing = |value: &f64| {
            configurations.clone().any(|number| !known.contains_key(&key(*value, number + 1)))
        };
        let wanted: Vec<f64> = values.iter().copied().filter(missing).collect();
        if !wanted.is_empty() {
            let varied = self.varied(&wanted)?;
            let rows = carry_out_in(
                &crate::world::create,
                &varied,
                std::slice::from_ref(&configurations),
                options,
                &mut |_| Ok(()),
            )?;
            for (value, (variation, _)) in wanted.iter().zip(&varied.all) {
                for row in rows.iter().filter(|row| row.variation == variation.name) {
                    let run = self.measured(*value, row, &options.out)?;
                    let told = known.insert(key(*value, run.configuration), run.clone());
                    if told.is_none() {
                        self.tell(&run, options.progress.as_ref());
                    }
                }
            }
        }
        let of = |value: &f64| {
            let at = |number: u32| known.get(&key(*value, number + 1)).cloned();
            configurations.clone().filter_map(at).collect::<Vec<_>>()
        };
        Ok(values.iter().flat_map(of).collect())
    }

    /// Reads the result of a run from its summary.
    fn measured(&self, value: f64, row: &RunRow, out: &Path) -> Result<CalibrationRun, StudyError> {
        let run = CalibrationRun::new(value, row.configuration, &row.run);
        if let Some(why) = &row.failure {
            return Ok(CalibrationRun { failure: Some(why.clone()), ..run });
        }
        let path = folder_of(out, &row.run).join("summary.json");
        let summary: Value = read_json(&path)?;
        let run = CalibrationRun {
            left_in_funnel: summary.pointer("/grains/left_in_funnel").and_then(Value::as_u64),
            escaped: summary.pointer("/grains/escaped").and_then(Value::as_u64),
            meets_standard: row.meets_standard,
            valid: row.valid,
            left_out_of_means: row.why_left_out(),
            wall_s: summary.get("wall_s").and_then(Value::as_f64),
            ..run
        };
        let first = value == self.question.between.0 && row.configuration == 1;
        match self.options.target.read(&summary) {
            Reading::Number(result) => Ok(CalibrationRun { result: Some(result), ..run }),
            Reading::NotMeasured if !first => {
                let failure = format!("`{}` was not measured", self.options.target.field);
                Ok(CalibrationRun { failure: Some(failure), ..run })
            }
            missing => Err(self.options.target.not_there(&summary, missing)),
        }
    }

    fn tell(&self, run: &CalibrationRun, progress: &dyn Progress) {
        let unit = self.options.target.unit();
        let result = match (&run.result, &run.failure) {
            (Some(result), _) => {
                let number = report::with_unit(&compact(*result), unit);
                let left_out = run.left_out_of_means.as_ref();
                left_out.map_or(number.clone(), |why| format!("{number}, left out: {why}"))
            }
            (None, why) => format!("no result: {}", why.as_deref().unwrap_or("unknown")),
        };
        let name = report::unknown_in_words(&self.options.unknown);
        let text = format!("{name} {}, configuration {}: {result}", run.value, run.configuration);
        progress.message(&text);
    }
}
