//! The table of many runs of one scenario: one row a run, one a variation.

use super::*;
use crate::grains::table_csv;
use crate::in_order::grouped;
use crate::measure::Estimate;
use crate::scenario::Scenario;

/// One run of one variation. What it did not measure, or did not come to
/// measure because it failed, is `None`.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct RunRow {
    /// Name of the run and of its folder.
    pub run: String,
    /// The variation it belongs to.
    pub variation: String,
    /// What the variation is part of, a ladder for one.
    pub group: String,
    /// Which realisation, counted from 1.
    pub configuration: u32,
    /// What was changed in the scenario, `path=value`, divided by semicolons.
    pub changes: String,
    /// The same for runs of the same scenario, configurations aside, by
    /// whatever changes it came about.
    pub experiment: String,
    /// The engine.
    pub backend: String,
    /// Its precision, `double` or `single`.
    pub precision: String,
    /// Who found and solved the contacts.
    pub contact_solver: String,
    /// Steps per second of simulated time.
    pub rate_hz: f64,
    /// Solver iterations a step, over all its sub-steps; of rapier those that push overlaps apart.
    pub iterations: u32,
    /// Sub-steps of a step, where the contact solver has them.
    pub substeps: Option<u32>,
    /// Stiffness of a contact point in N/m, where the contact solver has one.
    pub contact_stiffness_n_per_m: Option<f64>,
    /// Number of grains made.
    pub grains: Option<usize>,
    /// How many of them are not in the cylinder at the end: left in the
    /// funnel, spilled or escaped. The specimen is lower without them.
    pub grains_outside: Option<usize>,
    /// Height of the mean surface after pouring in mm; none where the run pours nothing.
    pub poured_height_mm: Option<f64>,
    /// Void ratio after pouring, likewise.
    pub void_ratio: Option<f64>,
    /// Settlement of the top plate at the end in mm.
    pub plate_settlement_mm: Option<f64>,
    /// The same after the first 5 s of vibration.
    pub plate_settlement_after_5_s_mm: Option<f64>,
    /// Settlement of the mean surface at the end in mm.
    pub surface_settlement_mm: Option<f64>,
    /// The same after the first 5 s of vibration.
    pub surface_settlement_after_5_s_mm: Option<f64>,
    /// Mean overlap at the end in percent of the equivalent diameter.
    pub overlap_mean_percent: Option<f64>,
    /// Its 99th percentile.
    pub overlap_p99_percent: Option<f64>,
    /// Numerical creep in the rest test in µm/s.
    pub creep_um_per_s: Option<f64>,
    /// Whether overlap and numerical creep meet the accuracy standard.
    pub meets_standard: Option<bool>,
    /// Whether the run is valid, as its summary has it.
    pub valid: Option<bool>,
    /// Whether something is found in it that the accuracy standard does not judge, as by the check
    /// of the energy; none in rows from before this was recorded.
    pub finding_beside_standard: Option<bool>,
    /// Why the result is left out of means; none where it counts (`counts_in_means`).
    pub left_out_of_means: Option<String>,
    /// Wall time over simulated time.
    pub wall_s_per_simulated_s: Option<f64>,
    /// Simulated time in s, rest test included.
    pub simulated_s: Option<f64>,
    /// Engine steps, rest test included.
    pub steps: Option<u64>,
    /// Why the run has no results.
    pub failure: Option<String>,
}

impl RunRow {
    /// The row of a run that has no results yet: what is known from its scenario.
    pub fn of_scenario(run: &str, variation: &str, group: &str, scenario: &Scenario) -> Self {
        let engine = &scenario.engine;
        let native = engine.is_native();
        let (substeps, iterations) = if native {
            (Some(engine.native.substeps(engine.rate_hz)), engine.native.iterations)
        } else if engine.is_stock() {
            (None, engine.iterations)
        } else {
            (Some(engine.rapier.substeps), engine.rapier.iterations)
        };
        let info = crate::world::info(engine.backend);
        Self {
            run: run.to_owned(),
            variation: variation.to_owned(),
            group: group.to_owned(),
            configuration: scenario.configuration,
            experiment: experiment(scenario),
            contact_solver: engine.solver_name().to_owned(),
            backend: info.name,
            precision: info.precision,
            rate_hz: engine.rate_hz,
            iterations: substeps.unwrap_or(1) * iterations,
            substeps,
            contact_stiffness_n_per_m: native.then_some(engine.native.contact_stiffness_n_per_m),
            ..Self::default()
        }
    }

    /// The same row with the results of the run.
    pub fn with_results(self, s: &Summary) -> Self {
        let plate = s.settlement_mm.as_ref();
        let surface = s.surface_settlement_mm.as_ref();
        Self {
            grains: Some(s.grains.count),
            grains_outside: Some(s.grains.count.saturating_sub(s.grains.in_cylinder)),
            poured_height_mm: s.poured_height_mm.and_then(|height| height.mean()),
            void_ratio: s.poured_void_ratio,
            plate_settlement_mm: plate.map(|p| p.final_mm),
            plate_settlement_after_5_s_mm: plate.and_then(|p| p.after_5_s),
            surface_settlement_mm: surface.map(|p| p.final_mm),
            surface_settlement_after_5_s_mm: surface.and_then(|p| p.after_5_s),
            overlap_mean_percent: s.overlap.known().map(|of| of.mean_percent),
            overlap_p99_percent: s.overlap.known().map(|of| of.p99_percent),
            creep_um_per_s: s.creep_um_per_s,
            meets_standard: Some(s.meets_standard),
            valid: Some(s.valid),
            finding_beside_standard: Some(s.has_finding_beside_standard()),
            left_out_of_means: (!s.counts_in_means()).then(|| s.why_left_out().join("; ")),
            wall_s_per_simulated_s: (s.simulated_s > 0.0).then_some(s.wall_s / s.simulated_s),
            simulated_s: Some(s.simulated_s),
            steps: Some(s.steps),
            ..self
        }
    }

    /// Settlement of the plate after 5 s of vibration, or at the end of a shorter one, in mm.
    pub fn early_plate_mm(&self) -> Option<f64> {
        self.plate_settlement_after_5_s_mm.or(self.plate_settlement_mm)
    }

    /// The same of the mean surface.
    pub fn early_surface_mm(&self) -> Option<f64> {
        self.surface_settlement_after_5_s_mm.or(self.surface_settlement_mm)
    }

    /// A value of a run by configuration, of those runs that have it and count in means.
    pub fn paired(rows: &[&Self], of: impl Fn(&Self) -> Option<f64>) -> Vec<(u32, f64)> {
        let counting = rows.iter().filter(|r| r.counts_in_means());
        counting.filter_map(|r| Some((r.configuration, of(r)?))).collect()
    }
}

/// The first digits of a scenario's hash; what it is called and said to be for,
/// and its configuration, are left out.
fn experiment(scenario: &Scenario) -> String {
    let bare = Scenario {
        name: String::new(),
        description: String::new(),
        notes: Vec::new(),
        configuration: 1,
        ..scenario.clone()
    };
    hash_json(&bare).chars().take(16).collect()
}

/// One variation: means over its runs. Lengths and void ratios are over those that count in
/// means; overlap, numerical creep, grains outside and cost, by which runs are judged, over all
/// that have them, or a setting would look good by what it spoils.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct VariationRow {
    /// Its name.
    pub variation: String,
    /// What it is part of.
    pub group: String,
    /// What was changed.
    pub changes: String,
    /// The same for variations that come to the same scenario.
    pub experiment: String,
    /// The engine.
    pub backend: String,
    /// Its precision.
    pub precision: String,
    /// Who found and solved the contacts.
    pub contact_solver: String,
    /// Steps per second of simulated time.
    pub rate_hz: f64,
    /// Solver iterations a step, over all its sub-steps.
    pub iterations: u32,
    /// Sub-steps of a step.
    pub substeps: Option<u32>,
    /// Stiffness of a contact point in N/m.
    pub contact_stiffness_n_per_m: Option<f64>,
    /// Number of runs.
    pub runs: usize,
    /// How many of them failed; they do not count in the means.
    pub failed: usize,
    /// How many of them meet the accuracy standard for overlap and numerical creep.
    pub meeting_standard: usize,
    /// How many of them are valid, as their summaries have it.
    pub valid: usize,
    /// How many of them have a result that is left out of the means.
    pub left_out: usize,
    /// How many of them failed, or have a finding beside what the accuracy standard judges.
    pub spoilt: usize,
    /// Grains that are not in the cylinder at the end.
    pub grains_outside: Option<Estimate>,
    /// Height of the mean surface after pouring in mm.
    pub poured_height_mm: Option<Estimate>,
    /// Void ratio after pouring.
    pub void_ratio: Option<Estimate>,
    /// Settlement of the plate in mm after 5 s, or at the end of a shorter vibration.
    pub plate_settlement_mm: Option<Estimate>,
    /// The same of the mean surface.
    pub surface_settlement_mm: Option<Estimate>,
    /// Mean overlap in percent of the equivalent diameter.
    pub overlap_mean_percent: Option<Estimate>,
    /// Its 99th percentile.
    pub overlap_p99_percent: Option<Estimate>,
    /// Numerical creep in µm/s without its sign: sinking in one run does not make up for rising in
    /// another.
    pub creep_um_per_s: Option<Estimate>,
    /// Wall time over simulated time.
    pub wall_s_per_simulated_s: Option<Estimate>,
    /// Engine steps of a run.
    pub steps: Option<Estimate>,
}

impl VariationRow {
    /// The variations of runs, in the order of their first runs; those of each
    /// precision by themselves.
    pub fn of(runs: &[RunRow]) -> Vec<Self> {
        let keyed = runs.iter().map(|run| ((&run.variation, &run.precision), run));
        grouped(keyed).iter().filter_map(|(_, of)| Self::of_one(of)).collect()
    }

    fn of_one(runs: &[&RunRow]) -> Option<Self> {
        let first = *runs.first()?;
        let of_all = |of: &dyn Fn(&RunRow) -> Option<f64>| {
            Estimate::of(&runs.iter().filter_map(|r| of(r)).collect::<Vec<_>>())
        };
        let mean = |of: &dyn Fn(&RunRow) -> Option<f64>| {
            of_all(&|r| of(r).filter(|_| r.counts_in_means()))
        };
        Some(Self {
            variation: first.variation.clone(),
            group: first.group.clone(),
            changes: first.changes.clone(),
            experiment: first.experiment.clone(),
            backend: first.backend.clone(),
            precision: first.precision.clone(),
            contact_solver: first.contact_solver.clone(),
            rate_hz: first.rate_hz,
            iterations: first.iterations,
            substeps: first.substeps,
            contact_stiffness_n_per_m: first.contact_stiffness_n_per_m,
            runs: runs.len(),
            failed: runs.iter().filter(|r| r.failure.is_some()).count(),
            meeting_standard: runs.iter().filter(|r| r.meets_standard == Some(true)).count(),
            valid: runs.iter().filter(|r| r.valid == Some(true)).count(),
            left_out: runs.iter().filter(|r| r.is_left_out()).count(),
            spoilt: runs.iter().filter(|r| r.is_spoilt()).count(),
            grains_outside: of_all(&|r| r.grains_outside.map(|g| g as f64)),
            poured_height_mm: mean(&|r| r.poured_height_mm),
            void_ratio: mean(&|r| r.void_ratio),
            plate_settlement_mm: mean(&RunRow::early_plate_mm),
            surface_settlement_mm: mean(&RunRow::early_surface_mm),
            overlap_mean_percent: of_all(&|r| r.overlap_mean_percent),
            overlap_p99_percent: of_all(&|r| r.overlap_p99_percent),
            creep_um_per_s: of_all(&|r| r.creep_um_per_s.map(f64::abs)),
            wall_s_per_simulated_s: of_all(&|r| r.wall_s_per_simulated_s),
            steps: of_all(&|r| r.steps.map(|s| s as f64)),
        })
    }

    /// Whether it has results and all of them are left out of the means.
    pub fn has_no_valid_run(&self) -> bool {
        self.left_out > 0 && self.left_out + self.failed == self.runs
    }
}

/// How many fields of [`VariationRow`] say what it is and how many runs it has; means follow.
const SETTINGS: usize = 17;

/// `variations.csv`: one row a variation, each mean beside its standard error.
///
/// # Errors
/// As [`table_csv`].
pub fn variations_csv(rows: &[VariationRow]) -> Result<Vec<u8>, csv::Error> {
    let text = |value: &Value| match value {
        Value::String(text) => text.clone(),
        number => number.as_f64().map_or_else(String::new, |number| number.to_string()),
    };
    table_csv(rows.iter().map(|row| {
        let row = serde_json::to_value(row).expect("a row has a JSON form");
        let fields = row.as_object().into_iter().flatten().enumerate();
        let cells = fields.flat_map(|(n, (name, value))| {
            if n < SETTINGS {
                return vec![(name.clone(), text(value))];
            }
            let error = (format!("{name}_standard_error"), text(&value["standard_error"]));
            vec![(name.clone(), text(&value["mean"])), error]
        });
        cells.collect::<Vec<(String, String)>>()
    }))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn row(variation: &str, configuration: u32, height: Option<f64>) -> RunRow {
        let scenario: Scenario = serde_json::from_value(serde_json::json!({
            "name": "s", "grains": { "file": "grains.json" },
            "stages": [{ "stage": "fill_funnel" }], "configuration": configuration
        }))
        .expect("a scenario");
        let name = format!("{variation}-c{configuration}");
        RunRow {
            poured_height_mm: height,
            creep_um_per_s: height.map(|h| h - 161.0),
            meets_standard: height.map(|_| true),
            valid: height.map(|_| true),
            failure: height.is_none().then(|| "it blew up".to_owned()),
            ..RunRow::of_scenario(&name, variation, "group", &scenario)
        }
    }

    /// Law: iterations and sub-steps are those of the solver that runs, not another's.
    #[test]
    fn iterations_and_sub_steps_are_those_of_the_engine() {
        let rapier = serde_json::json!({ "substeps": 8, "iterations": 3 });
        let native = serde_json::json!({ "substep_rate_hz": 1440, "iterations": 5 });
        for (engine, expected) in [
            (serde_json::json!({ "contact_solver": "stock", "iterations": 50 }), (50, None)),
            (serde_json::json!({ "backend": "rapier", "rapier": rapier }), (24, Some(8))),
            (serde_json::json!({ "rate_hz": 480, "native": native }), (15, Some(3))),
        ] {
            let scenario: Scenario = serde_json::from_value(serde_json::json!({
                "name": "s", "grains": { "file": "grains.json" }, "engine": engine,
                "stages": [{ "stage": "fill_funnel" }]
            }))
            .expect("a scenario");
            let row = RunRow::of_scenario("a-c1", "a", "group", &scenario);
            let got = (row.iterations, row.substeps);
            assert_eq!(got, expected, "law: left what is shown of {engine}, right what is so");
        }
    }

    #[test]
    fn runs_that_failed_are_counted_and_left_out_of_the_means() {
        let runs = [
            row("a", 1, Some(160.0)),
            row("b", 1, Some(1.0)),
            row("a", 2, Some(162.0)),
            row("a", 3, None),
        ];
        let rows = VariationRow::of(&runs);
        assert_eq!(rows.iter().map(|r| &*r.variation).collect::<Vec<_>>(), ["a", "b"]);
        let a = &rows[0];
        assert_eq!((a.runs, a.failed), (3, 1));
        let height = a.poured_height_mm.expect("two heights");
        assert_eq!((height.mean, height.count), (161.0, 2), "law: the mean of those that ran");
        let creep = a.creep_um_per_s.expect("two").mean;
        assert_eq!(creep, 1.0, "law: -1 and 1 µm/s are a numerical creep of 1, not of 0");
        let none = VariationRow::of(&[row("c", 1, None)]);
        assert_eq!(none[0].poured_height_mm, None, "nothing ran, nothing is made up");
    }

    /// Law: a run that pours nothing, as one that begins with a specimen and shakes it, has no height
    /// after pouring: its height at the end is another.
    #[test]
    fn a_run_without_a_pour_has_no_height_after_pouring() {
        let of = |mean_surface: f64| StandingHeight { mean_surface, ..StandingHeight::default() };
        let shaken =
            Summary { standing_height_mm: of(150.0), void_ratio: Some(0.7), ..Summary::default() };
        let got = |summary: &Summary| {
            let row = row("a", 1, None).with_results(summary);
            (row.poured_height_mm, row.void_ratio)
        };
        assert_eq!(got(&shaken), (None, None), "law: nothing was poured");
        let poured = Summary {
            poured_height_mm: Some(of(160.0)),
            poured_void_ratio: Some(0.8),
            ..shaken.clone()
        };
        assert_eq!(got(&poured), (Some(160.0), Some(0.8)), "law: as it was poured");
        let withheld = Summary { poured_height_mm: Some(StandingHeight::withheld()), ..shaken };
        assert_eq!(got(&withheld).0, None, "law: nor where it is withheld");
    }

    #[test]
    fn runs_that_are_not_valid_are_counted_apart_from_those_below_the_standard() {
        let judged = |configuration, meets, valid| RunRow {
            meets_standard: Some(meets),
            valid: Some(valid),
            ..row("a", configuration, Some(160.0))
        };
        let runs = [
            judged(1, true, true),
            judged(2, true, false),
            judged(3, false, false),
            row("a", 4, None),
        ];
        let rows = VariationRow::of(&runs);
        assert_eq!((rows[0].meeting_standard, rows[0].valid), (2, 1), "law: each by itself");
        assert_eq!((rows[0].left_out, rows[0].failed), (2, 1), "law: a failed run is not left out");
        let mut older = serde_json::to_value(&runs[0]).expect("JSON");
        older.as_object_mut().expect("an object").remove("valid");
        let older: RunRow = serde_json::from_value(older).expect("rows without it are read");
        assert_eq!(older.valid, None, "law: nothing is made up of rows from before");
    }

    #[test]
    fn precisions_are_told_apart() {
        let single = RunRow { precision: "single".into(), ..row("a", 1, Some(150.0)) };
        let rows = VariationRow::of(&[row("a", 1, Some(160.0)), single]);
        assert_eq!(rows.len(), 2, "law: one row a variation and precision");
    }

    #[test]
    fn tables_have_one_row_a_run_or_variation_and_as_many_cells_as_names() {
        let not_valid = RunRow { valid: Some(false), ..row("a", 2, Some(160.0)) };
        let runs = [row("a", 1, Some(160.0)), not_valid, row("a", 3, None)];
        for (table, rows) in [
            (to_csv(&runs).expect("written"), 3),
            (variations_csv(&VariationRow::of(&runs)).expect("written"), 1),
        ] {
            let mut reader = csv::Reader::from_reader(&table[..]);
            let names = reader.headers().expect("names").len();
            let cells: Vec<usize> = reader.records().map(|r| r.expect("a row").len()).collect();
            assert_eq!(cells, vec![names; rows]);
        }
        let text = to_csv(&runs).expect("written");
        let mut reader = csv::Reader::from_reader(&text[..]);
        let back: Vec<RunRow> = reader.deserialize().map(|r| r.expect("a row")).collect();
        assert_eq!(back, runs, "law: what is written is read back");
    }
}
