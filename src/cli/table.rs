//! Results as compact tables for people.

use super::*;
use crate::paper::{InterpretationColumn, ResultCounts};
use crate::record::{
    AngleOfRepose, Balance, GrainsSummary, LaboratorySummary, Overlap, Settlement, Site,
    StandingHeight, VibrationSummary,
};
use crate::report::{Calibration, calibration_rows};
use crate::study::CompareRecord;
use crate::verify::{Status, Verdict, tally};

/// A length of time for people.
pub(super) fn duration(seconds: f64) -> String {
    let whole = seconds.round().max(0.0) as u64;
    match (whole / 3600, whole / 60 % 60, whole % 60) {
        (0, 0, s) => format!("{s} s"),
        (0, m, s) => format!("{m} min {s} s"),
        (h, m, _) => format!("{h} h {m} min"),
    }
}

/// Rows of a name and what is to be said of it.
#[derive(Default)]
struct Rows(Vec<(String, String)>);

impl Rows {
    /// Adds a row where there is something to be said.
    fn add(&mut self, name: &str, text: impl Into<Option<String>>) {
        self.0.extend(text.into().map(|text| (name.to_owned(), text)));
    }

    fn aligned(&self) -> String {
        let width = self.0.iter().map(|(name, _)| name.chars().count()).max().unwrap_or(0);
        self.0.iter().map(|(name, text)| format!("  {name:width$}  {text}\n")).collect()
    }
}

/// A height in mm for people: to a tenth, or of low ones to three digits.
fn height(mm: f64) -> String {
    let magnitude = if mm > 0.0 { mm.log10().floor() } else { 1.0 };
    let decimals = (2.0 - magnitude).clamp(1.0, 6.0) as usize;
    format!("{mm:.decimals$} mm")
}

fn standing(of: &StandingHeight) -> String {
    let [surface, p95, highest] = [of.mean_surface, of.p95, of.highest].map(height);
    format!("{surface} mean surface, {p95} 95th percentile, {highest} highest")
}

fn settlement(of: &Settlement) -> String {
    let mm = |settled: f64| format!("{:.2} mm", rounded(settled, 2));
    let mut text = format!("{} at rest", mm(of.final_mm));
    if let Some(moving) = of.end_of_shaking {
        text += &format!(", {} at the end of shaking", mm(moving));
    }
    if let (Some(after), Some(share)) = (of.after_5_s, of.share_after_5_s) {
        text += &format!("; {} after 5 s ({:.0} %)", mm(after), share * 100.0);
    }
    text
}

/// How far grains overlap.
fn overlap(of: &Overlap) -> String {
    match of.known() {
        None => "no grain is left".to_owned(),
        Some(Overlap { pairs: 0, .. }) => "no two grains overlap".to_owned(),
        Some(Overlap { mean_percent, p99_percent, max_percent, .. }) => format!(
            "{mean_percent:.2} % mean, {p99_percent:.2} % 99th percentile, {max_percent:.2} % \
             largest"
        ),
    }
}

/// How many grains touch a grain, and how the contacts are loaded.
fn coordination(of: &Summary) -> String {
    let sliding = of.contacts.as_ref().and_then(|contacts| contacts.sliding_percent);
    let sliding = sliding.map(|share| format!(", {share:.0} % of the loaded contacts slide"));
    let mean = match of.coordination_number.is_nan() {
        true => "no grain is left".to_owned(),
        false => format!("{:.2}", of.coordination_number),
    };
    mean + &sliding.unwrap_or_default()
}

/// How a vibration moved the table and came to rest.
fn vibration(of: &VibrationSummary) -> String {
    let mut text = of.motion.line();
    if let Some(settling) = &of.settling {
        let how = if settling.settled { "settled" } else { "NOT settled" };
        text += &format!("; {how} {:.2} s after it", settling.time_s);
    }
    text
}

fn angle_of_repose(of: &AngleOfRepose) -> String {
    let AngleOfRepose { degrees, by_volume_degrees, .. } = of;
    let (low, high) = (of.confidence_low_degrees, of.confidence_high_degrees);
    let between = of.standard_deviation_degrees;
    format!(
        "{degrees:.1}°, 95 % confidence for this pile {low:.1} to {high:.1}°; {between:.1}° between \
         sectors; {by_volume_degrees:.1}° by volume"
    )
}

/// A value rounded to `decimals`; what rounds to zero has no sign.
fn rounded(value: f64, decimals: i32) -> f64 {
    let scale = 10f64.powi(decimals);
    (value * scale).round() / scale + 0.0
}

/// D_r for people.
fn relative_density(of: f64) -> String {
    format!("{:.2}", rounded(of, 2))
}

/// Loads, flows and void ratios.
fn of_laboratory(of: &LaboratorySummary, rows: &mut Rows) {
    let pieces = of.pieces.iter().filter(|piece| piece.present).map(|p| (&p.name, p.force_n));
    for (name, force) in pieces.chain(of.groups.iter().map(|group| (&group.name, group.force_n))) {
        let [x, y, z] = components(force);
        rows.add(&format!("force on {name}"), format!("({x}, {y}, {z}) N"));
    }
    let Balance { weight_n, carried_n, difference_percent, .. } = of.balance;
    let balance = match difference_percent.map(|off| rounded(off, 2)) {
        Some(off) => {
            let [carried, weight] = components([carried_n, weight_n]);
            format!("{carried} N carried of {weight} N of grains, {off:+.2} %")
        }
        None => "no grain is left".to_owned(),
    };
    rows.add("balance", balance);
    for opening in &of.openings {
        // Rates scatter: of large ones tenths say nothing.
        let number = |rate: f64| if rate < 10.0 { grams(rate) } else { format!("{rate:.0}") };
        let rate = opening.rate_g_per_s.map(|rate| format!(" at {} g/s", number(rate)));
        let text = format!("{} g{}", grams(opening.passed_g), rate.unwrap_or_default());
        rows.add(&format!("flow, {}", opening.name), text);
    }
    for region in &of.regions {
        let ratio = region.void_ratio.map_or("no grains".to_owned(), |e| format!("{e:.3}"));
        rows.add(&format!("void ratio, {}", region.name), ratio);
        let relative = region.relative_density.map(relative_density);
        rows.add(&format!("relative density, {}", region.name), relative);
        if let Some(stress) = &region.stress {
            let [[xx, _, _], [_, yy, _], [_, _, zz]] = stress.tensor_kpa;
            let [xx, yy, zz] = components([xx, yy, zz]);
            rows.add(&format!("stress, {}", region.name), format!("xx {xx}, yy {yy}, zz {zz} kPa"));
        }
    }
}

/// The figures of a run.
pub(super) fn of_summary(summary: &Summary) -> String {
    let grains = &summary.grains;
    let mut rows = Rows::default();
    let BackendInfo { name, version, precision } = &summary.backend;
    let solver = &summary.contact_solver;
    rows.add("engine", format!("{name} {version}, {precision} precision, contacts by {solver}"));
    rows.add("grains", format!("{}, {} g", grains.count, grams(grains.mass_g)));
    let (site, laboratory) = (summary.site(), summary.laboratory.as_ref());
    let GrainsSummary { in_cylinder, spilled, left_in_funnel, escaped, .. } = grains;
    let places = match site {
        Site::Laboratory => format!(
            "{in_cylinder} in the laboratory, {left_in_funnel} left over, {spilled} fallen out of it, \
             {escaped} escaped through walls"
        ),
        Site::Base => {
            let mut text = format!("{in_cylinder} on the base, {spilled} fallen off");
            if left_in_funnel + escaped > 0 {
                text += &format!(", {left_in_funnel} not fed, {escaped} escaped through the base");
            }
            text
        }
        Site::Cylinder => format!(
            "{in_cylinder} in the cylinder, {spilled} spilled, {}, {escaped} escaped through walls",
            grains.taken_with_funnel()
        ),
    };
    rows.add("", places);
    let ratio = |void_ratio: f64| format!("{void_ratio:.3}");
    rows.add("poured height", summary.poured_height_mm.as_ref().map(standing));
    rows.add("poured void ratio", summary.poured_void_ratio.map(ratio));
    let is_withheld = summary.withheld.iter().any(|w| w.field == "standing_height_mm");
    if site == Site::Cylinder && !is_withheld {
        rows.add("standing height", standing(&summary.standing_height_mm));
    }
    if let (Some(void_ratio), Some(porosity)) = (summary.void_ratio, summary.porosity) {
        rows.add("void ratio", format!("{void_ratio:.3} (porosity {porosity:.3})"));
    }
    rows.add("relative density", summary.relative_density.map(relative_density));
    let core = summary.core.as_ref().and_then(|core| core.void_ratio);
    rows.add("void ratio of the core", core.map(ratio));
    if let Some(laboratory) = laboratory {
        of_laboratory(laboratory, &mut rows);
    }
    for (n, of) in summary.stages.iter().enumerate() {
        let until = of.until.as_ref().map(|until| until.line());
        rows.add(&format!("stage {n}, {}", of.stage), until);
    }
    for of in &summary.vibrations {
        rows.add("vibration", vibration(of));
    }
    rows.add("settlement, plate", summary.settlement_mm.as_ref().map(settlement));
    rows.add("settlement, surface", summary.surface_settlement_mm.as_ref().map(settlement));
    let tilt = summary.plate_tilt_deg.map(|of| format!("{:.1}°", of.final_deg));
    rows.add("tilt of the plate", tilt);
    if let Some(of) = &summary.angle_of_repose {
        rows.add("angle of repose", angle_of_repose(of));
        let (high, toe) = (height(of.pile_height_mm), height(of.base_radius_mm));
        let pile = format!("{high} high, {toe} to its toe; fallen off the base: {}", of.fallen_off);
        rows.add("pile", pile);
    }
    rows.add("overlap", overlap(&summary.overlap));
    rows.add("coordination number", coordination(summary));
    let creep = summary.creep_um_per_s.map(|v| format!("{:.1} µm/s", rounded(v, 1)));
    rows.add("numerical creep at rest", creep);
    let standard = match (summary.meets_standard, summary.valid) {
        (true, _) => paint::good("met"),
        (false, true) => {
            paint::notable("met while grains touched; now they have run out (docs/accuracy.md)")
        }
        (false, false) => paint::bad("NOT met (docs/accuracy.md)"),
    };
    rows.add("accuracy standard", standard);
    if let Some(checks) = &summary.checks {
        let line = checks.line();
        rows.add("checks", if checks.passed == Some(false) { paint::bad(line) } else { line });
    }
    let Summary { scenario, configuration, seed, simulated_s, steps, .. } = summary;
    let (took, memory) = (duration(summary.wall_s), summary.peak_memory_mib);
    let steps = counted(*steps as usize, "step");
    let mut cost = format!("{simulated_s:.2} s simulated in {steps} and {took}");
    if memory > 0.0 {
        cost += &format!(", {memory:.0} MiB");
    }
    rows.add("cost", cost);
    let head = format!("{scenario}, configuration {configuration}, seed {seed}\n");
    let mut text = head + &rows.aligned();
    for warning in &summary.warnings {
        text += &format!("  {}: {warning}\n", paint::notable("warning"));
    }
    text
}

/// Rows of cells in columns of their widest cell.
pub(super) fn columns<R: AsRef<[String]>>(rows: &[R]) -> String {
    let count = rows.iter().map(|row| row.as_ref().len()).max().unwrap_or(0);
    let cell = |row: &R, column: usize| row.as_ref().get(column).map_or(0, |c| paint::width(c));
    let widths: Vec<usize> = (0..count)
        .map(|column| rows.iter().map(|row| cell(row, column)).max().unwrap_or(0))
        .collect();
    let mut out = String::new();
    for row in rows {
        let cells: Vec<String> = row
            .as_ref()
            .iter()
            .zip(&widths)
            .map(|(cell, width)| cell.clone() + &" ".repeat(width - paint::width(cell)))
            .collect();
        out += cells.join("  ").trim_end();
        out.push('\n');
    }
    out
}

/// The quantities of a comparison, one a line, and what agrees.
pub(super) fn of_comparison(record: &CompareRecord) -> String {
    let names: Vec<String> = record.runs.iter().map(|r| r.name.clone()).collect();
    let mut rows = vec![[vec!["quantity".to_owned()], names, vec!["unit".to_owned()]].concat()];
    // Of what sand weighs three decimals say little.
    let number = |v: f64| if v.abs() < 0.1 { four_digits(v) } else { three_decimals(v) };
    for q in &record.quantities {
        let values = q.values.iter().map(|v| v.map_or_else(|| "-".to_owned(), number));
        let verdict = match q.within_band {
            Some(true) => paint::good(" (agree)"),
            Some(false) => paint::bad(" (DIFFER)"),
            None => String::new(),
        };
        let mut row = vec![q.quantity.clone()];
        row.extend(values);
        row.push(format!("{}{verdict}", q.unit));
        rows.push(row);
    }
    let mut judged = |name: &str, of: fn(&Summary) -> bool, good: &str, bad: &str| {
        let verdict = |is: bool| if is { paint::good(good) } else { paint::bad(bad) };
        let verdicts = record.runs.iter().map(|run| verdict(of(&run.summary)));
        rows.push([name.to_owned()].into_iter().chain(verdicts).collect());
    };
    judged("accuracy standard", |s| s.meets_standard, "met", "NOT met");
    judged("valid", |s| s.valid, "yes", "NOT valid");
    columns(&rows)
}

/// What a calibration found, and what must be known of it.
pub(super) fn of_calibration(of: &Calibration) -> String {
    let rows = Rows(calibration_rows(of));
    let mut text = format!("{}\n{}", of.statement, rows.aligned());
    for note in &of.notes {
        text += &format!("  note: {note}\n");
    }
    text
}

/// What became of each interpretation, one a line.
pub(super) fn of_interpretations(interpretations: &[InterpretationColumn]) -> String {
    let header = [
        "interpretation",
        "runs",
        "failed",
        "within",
        "outside",
        "accuracy standard",
        "left out of means",
    ];
    let mut rows = vec![header.map(str::to_owned)];
    for interpretation in interpretations {
        let results = ResultCounts::of(&interpretation.claims);
        let met = interpretation.runs.iter().filter(|r| r.summary.meets_standard).count();
        let left_out = interpretation.runs.iter().filter(|r| !r.counts_in_means()).count();
        rows.push([
            interpretation.name.clone(),
            format!("{} of {}", interpretation.runs.len(), interpretation.planned_runs),
            interpretation.failures.len().to_string(),
            results.within.to_string(),
            results.outside.to_string(),
            format!("met by {met} of {}", interpretation.runs.len()),
            left_out.to_string(),
        ]);
    }
    columns(&rows)
}

/// The verdicts of a verification, one a line, and how many there are of each.
pub(super) fn of_verdicts(verdicts: &[Verdict]) -> String {
    let number = |value: f64| {
        if value != 0.0 && !(1e-3..1e6).contains(&value.abs()) {
            format!("{value:.2e}")
        } else {
            three_decimals(value)
        }
    };
    let header = ["verdict", "case", "setting", "expected", "got", "tolerance", "unit"];
    let mut rows = vec![header.map(str::to_owned)];
    for v in verdicts {
        rows.push([
            match v.status {
                Status::Pass => paint::good(v.status.words()),
                Status::Fail => paint::bad(v.status.words()),
                Status::KnownFailure | Status::UnexpectedPass => paint::notable(v.status.words()),
            },
            v.id.clone(),
            v.setting.clone(),
            number(v.expected),
            v.got.map_or_else(|| "-".to_owned(), number),
            number(v.tolerance),
            v.unit.clone(),
        ]);
    }
    let mut out = columns(&rows);
    for v in verdicts.iter().filter(|v| !v.pass) {
        out += &format!("{} on {}: {}\n", v.id, v.setting, v.remarks());
    }
    let count = |status| tally(verdicts, status);
    out += &format!(
        "{} experiments: {} pass, {} known failures, {} fail, {} pass unexpectedly\n",
        verdicts.len(),
        count(Status::Pass),
        count(Status::KnownFailure),
        count(Status::Fail),
        count(Status::UnexpectedPass)
    );
    out
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::*;

    #[test]
    fn durations_are_for_people() {
        for (seconds, expected) in
            [(0.4, "0 s"), (59.6, "1 min 0 s"), (125.0, "2 min 5 s"), (7384.0, "2 h 3 min")]
        {
            assert_eq!(duration(seconds), expected, "law: {seconds} s in words");
        }
    }

    #[test]
    fn an_overlap_of_no_grains_is_no_overlap_of_none() {
        let apart = Overlap::default();
        let touching = Overlap { pairs: 9, mean_percent: 0.2, p99_percent: 1.0, ..apart };
        for (of, expected) in [
            (Overlap::of_none(), "no grain is left"),
            (apart, "no two grains overlap"),
            (touching, "0.20 % mean, 1.00 % 99th percentile, 0.00 % largest"),
        ] {
            assert_eq!(overlap(&of), expected, "law: of {of:?}");
        }
    }

    #[test]
    fn what_rounds_to_zero_has_no_sign() {
        for (value, expected) in
            [(-0.0004, "+0.00"), (0.0, "+0.00"), (-0.006, "-0.01"), (1.236, "+1.24")]
        {
            assert_eq!(format!("{:+.2}", rounded(value, 2)), expected, "law: of {value}");
        }
    }

    /// Law: a specimen of fine sand is a millimetre high, of which a tenth says little.
    #[test]
    fn low_heights_have_three_digits() {
        let shown = [0.0, 0.866, 0.0123, 9.94, 56.78, 731.54].map(height);
        let expected = ["0.0 mm", "0.866 mm", "0.0123 mm", "9.94 mm", "56.8 mm", "731.5 mm"];
        assert_eq!(shown, expected);
    }

    #[test]
    fn summaries_show_what_applies() {
        let value = json!({
            "scenario": "a", "backend": { "name": "bullet", "version": "3.24", "precision": "double" },
            "contact_solver": "stock", "seed": 1, "configuration": 2, "falling_height_mm": 50.0,
            "grains": { "count": 364, "mass_g": 585.7, "solids_volume_cm3": 219.0,
                "in_cylinder": 362, "mass_in_cylinder_g": 582.0, "escaped": 0, "spilled": 1,
                "left_in_funnel": 1 },
            "standing_height_mm": { "mean_surface": 101.2, "p95": 110.0, "highest": 115.0 },
            "poured_height_mm": null, "void_ratio": 0.912, "poured_void_ratio": null,
            "porosity": 0.477, "relative_density": 0.5625,
            "settlement_mm": { "final": 10.0, "after_5_s": 8.0, "share_after_5_s": 0.8,
                "after_each_period": [10.0] },
            "surface_settlement_mm": null, "plate_tilt_deg": { "final": 6.27, "end_of_shaking": 7.0 },
            "overlap": { "pairs": 900, "mean_percent": 0.2, "p99_percent": 1.0,
                "max_percent": 2.0, "max_mm": 0.2 },
            "coordination_number": 5.1, "creep_um_per_s": null, "rest_test": null,
            "meets_standard": false, "kinetic_energy_j": 0.0, "simulated_s": 6.0, "steps": 2880,
            "wall_s": 61.0, "engine_s": 60.0, "peak_memory_mib": 55.0,
            "warnings": ["1 grain hangs"],
        });
        let summary: Summary = serde_json::from_value(value).expect("a summary");
        let text = paint::colourless(&of_summary(&summary));
        for shown in [
            "a, configuration 2",
            "362 in the cylinder",
            "8.00 mm after 5 s (80 %)",
            "6.3°",
            "0.912",
            "relative density     0.56",
            "NOT met",
            "1 min 1 s",
            "warning: 1 grain hangs",
        ] {
            assert!(text.contains(shown), "`{shown}` is missing in:\n{text}");
        }
        for hidden in ["poured", "creep", "settlement, surface"] {
            assert!(!text.contains(hidden), "`{hidden}` does not apply, in:\n{text}");
        }
        let grains = GrainsSummary { heaped_above_rim: Some(1), ..summary.grains };
        let text = paint::colourless(&of_summary(&Summary { grains, ..summary.clone() }));
        let shown = "1 spilled, 0 left in the funnel, 1 heaped above the rim, 0 escaped";
        assert!(text.contains(shown), "law: expected `{shown}`, got\n{text}");
        let laboratory = json!({
            "pieces": [{ "name": "lid", "present": true, "force_n": [0.0, -2e-7, 1.5e-4],
                "moment_n_m": [0.0, 0.0, 0.0], "at_mm": [0.0, 0.0, 0.0] }],
            "groups": [], "openings": [],
            "regions": [{ "name": "core", "void_ratio": 0.8, "relative_density": -0.003 }],
            "balance": { "weight_n": 0.0, "carried_n": 0.0, "sideways_n": 0.0,
                "difference_percent": null }
        });
        let laboratory = serde_json::from_value(laboratory).expect("a laboratory");
        let ran_out = Summary { laboratory: Some(laboratory), valid: true, ..summary.clone() };
        let text = paint::colourless(&of_summary(&ran_out));
        for shown in [
            "362 in the laboratory, 1 left over, 1 fallen out of it, 0 escaped",
            "no grain is left",
            "met while grains touched",
            "relative density, core  0.00",
            "(0, -0.0000002, 0.00015) N",
        ] {
            assert!(text.contains(shown), "law: `{shown}` of a laboratory, in:\n{text}");
        }
        let pile = Summary { void_ratio: None, porosity: None, ..summary };
        let text = paint::colourless(&of_summary(&pile));
        assert!(
            text.contains("362 on the base, 1 fallen off"),
            "law: a pile's places, got\n{text}"
        );
        for hidden in ["cylinder", "standing height", "void ratio"] {
            assert!(!text.contains(hidden), "`{hidden}` is not of a pile, in:\n{text}");
        }
    }
}
