//! What a sweep found, and its files.

use std::{collections::BTreeMap, path::Path};

use serde::Serialize;
use serde_json::Value;

use super::{
    ReportError, figures,
    sweep_outcomes::all_outcomes,
    sweep_page::page,
    table::{Cell, Table, row, table},
};
use crate::measure::{bootstrap_interval, inference::MeanTest};
use crate::record::{LaboratoryNames, write_json};

/// The one result that is another each time, and has a table of its own.
const WALL_TIME: &str = "wall_s";

/// What is varied.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct SweepFactor {
    /// The field of the scenario.
    pub path: String,
    /// Its values in the order in which they were given; of a sampled range
    /// its two ends.
    pub values: Vec<Value>,
    /// Whether values were drawn from between the two.
    pub sampled: bool,
    /// Whether all values are numbers.
    pub numeric: bool,
}

impl SweepFactor {
    /// A value as a number: the number of its place, from 1, where values are
    /// no numbers.
    pub fn number(&self, value: &Value) -> f64 {
        let place = || self.values.iter().position(|v| v == value).map_or(0, |n| n + 1);
        if self.numeric { value.as_f64().unwrap_or(f64::NAN) } else { place() as f64 }
    }
}

/// One run.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct SweepRun {
    /// Its name and that of its folder.
    pub run: String,
    /// The point that it belongs to.
    pub point: String,
    /// Which realisation, counted from 1.
    pub configuration: u32,
    /// The value of each factor.
    pub values: Vec<Value>,
    /// Results by their path in `summary.json`; what was not measured is absent.
    pub outcomes: BTreeMap<String, f64>,
    /// Whether overlap and numerical creep meet the accuracy standard; none without result.
    pub meets_standard: Option<bool>,
    /// Whether the standard is met and no run-time check found anything; none
    /// without result.
    pub valid: Option<bool>,
    /// Why its result is left out of means and effects; none where it counts, or has none.
    pub left_out_of_means: Option<String>,
    /// Why it has no result.
    pub failure: Option<String>,
}

impl SweepRun {
    /// Whether it counts in means and effects.
    pub fn counts_in_means(&self) -> bool {
        self.failure.is_none() && self.left_out_of_means.is_none()
    }
}

/// A mean over the configurations of a point.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct SweepEstimate {
    /// Number of values.
    pub count: usize,
    /// Their mean.
    pub mean: f64,
    /// Standard deviation; none of a single value.
    pub standard_deviation: Option<f64>,
    /// 95 % confidence interval of the mean by Student's t; none of a single value.
    pub t_low: Option<f64>,
    /// Its upper end.
    pub t_high: Option<f64>,
    /// 95 % percentile bootstrap interval; none of fewer than three values.
    pub bootstrap_low: Option<f64>,
    /// Its upper end.
    pub bootstrap_high: Option<f64>,
}

impl SweepEstimate {
    /// Of values; none of no values.
    pub fn of(values: &[f64]) -> Option<Self> {
        let mean = crate::measure::statistics::mean(values)?;
        let test = MeanTest::of(values, 0.95);
        let bootstrap = bootstrap_interval(values, 0.95);
        Some(Self {
            count: values.len(),
            mean,
            standard_deviation: test.map(|t| t.standard_deviation),
            t_low: test.map(|t| t.estimate.mean - t.half_width),
            t_high: test.map(|t| t.estimate.mean + t.half_width),
            bootstrap_low: bootstrap.map(|b| b.0),
            bootstrap_high: bootstrap.map(|b| b.1),
        })
    }
}

/// One point: means over its configurations, of the runs that count in means.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct SweepPoint {
    /// Its name.
    pub point: String,
    /// The value of each factor.
    pub values: Vec<Value>,
    /// Runs with a result.
    pub runs: usize,
    /// How many of them are valid.
    pub valid: usize,
    /// How many of them are left out of the means.
    pub left_out: usize,
    /// Runs without.
    pub failed: usize,
    /// Results by their path in `summary.json`.
    pub outcomes: BTreeMap<String, SweepEstimate>,
}

/// How one factor moves one result, all others averaged over.
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
pub struct SweepEffect {
    /// The field of the scenario.
    pub factor: String,
    /// The result, by its path in `summary.json`.
    pub outcome: String,
    /// Runs that have the result and count.
    pub runs: usize,
    /// Runs that have the result and are left out.
    pub left_out: usize,
    /// The mean at each value; empty where values were drawn.
    pub means: Vec<(Value, SweepEstimate)>,
    /// Change of the result for one unit of the factor: the mean over
    /// configurations of each one's own slope. None where values are no numbers.
    pub slope: Option<f64>,
    /// Half of its 95 % confidence interval by Student's t; none of one configuration.
    pub slope_half_width: Option<f64>,
    /// Two-sided p-value of no slope.
    pub slope_p: Option<f64>,
    /// One-sided p-value of Page's trend test by ranks, in the direction of the
    /// slope; none of fewer than three values or two configurations.
    pub page_p: Option<f64>,
    /// Configurations that would show a slope of this size among this scatter, at
    /// 95 % confidence with a probability of 80 %; none where it is not known, or
    /// more than 100 000.
    pub configurations_needed: Option<usize>,
}

/// Everything that a sweep found.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Sweep {
    /// Name of the scenario.
    pub scenario: String,
    /// `grid`, `one_at_a_time` or `latin_hypercube`.
    pub design: &'static str,
    /// What is varied.
    pub factors: Vec<SweepFactor>,
    /// Configurations of each point.
    pub configurations: u32,
    /// How many runs the plan has; fewer have been run so far, or failed.
    pub planned: usize,
    /// The runs.
    pub runs: Vec<SweepRun>,
    /// The points.
    pub points: Vec<SweepPoint>,
    /// The effects, factor by factor.
    pub effects: Vec<SweepEffect>,
    /// Names of a laboratory, by which its results are called on the page.
    #[serde(skip)]
    pub names: LaboratoryNames,
}

impl Sweep {
    /// Runs whose results are left out of means and effects.
    pub fn left_out(&self) -> impl Iterator<Item = &SweepRun> {
        self.runs.iter().filter(|r| r.failure.is_none() && !r.counts_in_means())
    }

    /// Runs that have no result.
    pub fn failed(&self) -> impl Iterator<Item = &SweepRun> {
        self.runs.iter().filter(|r| r.failure.is_some())
    }
}

/// `sweep.csv`: one row a run, one column a factor and result. The same sweep
/// gives the same bytes, wherever and in whatever order it was run.
fn table(of: &Sweep) -> Table {
    let all = all_outcomes(&of.runs);
    let results = || all.iter().copied().filter(|path| *path != WALL_TIME);
    let factors = of.factors.iter().map(|f| f.path.as_str());
    let header = ["run", "point", "configuration"].into_iter().chain(factors).chain(results());
    let mut table =
        Table::new(header.chain(["meets_standard", "valid", "left_out_of_means", "failure"]));
    for run in &of.runs {
        let mut cells = row![&run.run, &run.point, run.configuration];
        cells.extend(run.values.iter().map(|value| Cell::from(shown(value))));
        cells.extend(results().map(|path| run.outcomes.get(path).copied().into()));
        let why = [&run.left_out_of_means, &run.failure].map(Clone::clone);
        cells.extend(row![run.meets_standard, run.valid]);
        cells.extend(why.map(Cell::from));
        table.row(cells);
    }
    table
}

/// Wall times, which no two machines have alike, by themselves.
fn times(of: &Sweep) -> Table {
    table!(&of.runs, |run| {
        "run" => &run.run,
        WALL_TIME => run.outcomes.get(WALL_TIME).copied(),
    })
}

/// A value without the quotes of a text.
pub(super) fn shown(value: &Value) -> String {
    value.as_str().map_or_else(|| value.to_string(), str::to_owned)
}

/// Writes `sweep.csv`, `sweep-times.csv`, `sweep.json`, `sweep.md`, `report.html` and `figures/`.
///
/// # Errors
/// [`ReportError`] naming the file or the figure.
pub fn write_sweep(out: &Path, of: &Sweep) -> Result<(), ReportError> {
    table(of).write(&out.join("sweep.csv"))?;
    times(of).write(&out.join("sweep-times.csv"))?;
    write_json(&out.join("sweep.json"), of)?;
    page(of, figures::of_sweep(of)?).write(out, &["sweep.md", "report.html"])
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A sweep of one point in four configurations: valid, below the standard,
    /// with a check that found something, and failed.
    fn sweep() -> Sweep {
        let states = [Some((true, true)), Some((false, false)), Some((true, false)), None];
        let run = |(n, state): (u32, Option<(bool, bool)>)| SweepRun {
            run: format!("point-0001-c{n}"),
            point: "point-0001".into(),
            configuration: n,
            values: vec![1.into()],
            outcomes: BTreeMap::new(),
            meets_standard: state.map(|s| s.0),
            valid: state.map(|s| s.1),
            left_out_of_means: state.filter(|s| !s.1).map(|_| "not valid".to_owned()),
            failure: state.is_none().then(|| "it blew up".to_owned()),
        };
        Sweep {
            scenario: "s".into(),
            design: "grid",
            factors: vec![SweepFactor {
                path: "seed".into(),
                values: vec![1.into()],
                sampled: false,
                numeric: true,
            }],
            configurations: 4,
            planned: 4,
            runs: (1..).zip(states).map(run).collect(),
            points: vec![SweepPoint {
                point: "point-0001".into(),
                values: vec![1.into()],
                runs: 3,
                valid: 1,
                left_out: 2,
                failed: 1,
                outcomes: BTreeMap::new(),
            }],
            effects: Vec::new(),
            names: LaboratoryNames::default(),
        }
    }

    #[test]
    fn the_table_says_of_every_run_whether_it_is_valid() {
        let written = table(&sweep()).csv().expect("written");
        let mut reader = csv::Reader::from_reader(&written[..]);
        let names = reader.headers().expect("names").clone();
        let place = |name: &str| names.iter().position(|n| n == name).expect(name);
        assert_eq!(place("valid"), place("meets_standard") + 1, "law: one beside the other");
        let got: Vec<(String, String)> = reader
            .records()
            .map(|r| r.expect("a row"))
            .map(|r| (r[place("meets_standard")].to_owned(), r[place("valid")].to_owned()))
            .collect();
        let expected = [("true", "true"), ("false", "false"), ("true", "false"), ("", "")];
        let expected = expected.map(|(met, valid)| (met.to_owned(), valid.to_owned()));
        assert_eq!(got, expected, "law: as each run has it; nothing of one without result");
        let json = serde_json::to_value(sweep()).expect("JSON");
        assert_eq!(json["runs"][2]["valid"], Value::Bool(false), "law: sweep.json says so, too");
    }

    #[test]
    fn the_page_counts_runs_below_the_standard_and_those_whose_checks_found_something() {
        let of = sweep();
        let page = page(&of, vec![]);
        let text = page.markdown();
        for said in [
            "; 1 does not meet the accuracy standard for overlap and numerical creep; in 1 that does a \
             run-time check found something; not valid: 2 of 3; 2 of 3 runs with a result are left out of means.",
            "| point | seed | runs | valid | left out |",
            "| point-0001 | 1 | 3, 1 failed | 1 | 2 |",
            "| point-0001-c2 | seed=1 | not valid |",
        ] {
            assert!(text.contains(said), "law: `{said}`, got:\n{text}");
        }
        let valid = Sweep {
            runs: vec![of.runs[0].clone()],
            points: vec![SweepPoint { runs: 1, left_out: 0, failed: 0, ..of.points[0].clone() }],
            planned: 1,
            ..of
        };
        let page = super::page(&valid, vec![]);
        let lead = page.markdown().lines().nth(2).unwrap_or_default().to_owned();
        assert!(lead.ends_with("1 of 1 runs have results."), "law: nothing to warn of, got {lead}");
        assert!(page.html().contains("p class=\"lead\""), "law: no banner");
    }

    /// Law: a mean or slope of which every run is left out is no dash, and no number.
    #[test]
    fn where_no_run_is_valid_the_page_says_so() {
        let mut of = sweep();
        for run in &mut of.runs {
            run.outcomes.insert("void_ratio".into(), 0.9);
        }
        let effect = |slope: Option<f64>, runs, left_out| SweepEffect {
            factor: "seed".into(),
            outcome: "void_ratio".into(),
            runs,
            left_out,
            slope,
            ..SweepEffect::default()
        };
        let line = |of: &Sweep, start: &str| {
            let page = page(of, vec![]).markdown();
            page.lines().find(|l| l.starts_with(start)).unwrap_or_default().to_owned()
        };
        of.points[0].valid = 0;
        of.points[0].left_out = 3;
        for (slope, runs, left_out, said) in [
            (Some(2.0), 3, 0, "| 2 |"),
            (Some(2.0), 2, 1, "| 2 (left out: 1) |"),
            (None, 0, 3, "| no valid run |"),
            (None, 1, 2, "| too few valid runs |"),
            (None, 1, 0, "| – |"),
        ] {
            of.effects = vec![effect(slope, runs, left_out)];
            let got = line(&of, "| seed |");
            assert!(got.contains(said), "law: `{said}`, got `{got}`");
        }
        let got = line(&of, "| point-0001 |");
        assert!(
            got.ends_with("| 3, 1 failed | 0 | 3 | no valid run |"),
            "law: no dash, got `{got}`"
        );
    }
}
