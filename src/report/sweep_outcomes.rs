//! The results of runs that stand in the tables of a sweep, by their path in `summary.json`: fixed
//! ones of every run, and all numbers of a laboratory.

use std::collections::BTreeSet;

use super::*;

/// Numbers of a run that stand in every table, by their path in `summary.json`,
/// with what they are in words. The first five have figures.
pub const OUTCOMES: [(&str, &str); 19] = [
    ("poured_height_mm.mean_surface", "Poured height (mm)"),
    ("settlement_mm.final", "Plate settlement (mm)"),
    ("surface_settlement_mm.final", "Surface settlement (mm)"),
    ("angle_of_repose.degrees", "Angle of repose (degrees)"),
    ("void_ratio", "Void ratio"),
    ("standing_height_mm.mean_surface", "Height of the mean surface at the end (mm)"),
    ("poured_void_ratio", "Void ratio after pouring"),
    ("settlement_mm.after_5_s", "Settlement of the plate after 5 s (mm)"),
    (
        "settlement_mm.after_each_period.0",
        "Settlement of the plate after the first of several periods (mm)",
    ),
    ("surface_settlement_mm.after_5_s", "Settlement of the mean surface after 5 s (mm)"),
    ("coordination_number", "Coordination number"),
    ("overlap.mean_percent", "Mean overlap (%)"),
    ("overlap.p99_percent", "99th percentile of the overlap (%)"),
    ("creep_um_per_s", "Numerical creep (µm/s)"),
    ("grains.spilled", "Grains spilled"),
    ("grains.left_in_funnel", "Grains left in the funnel"),
    ("grains.escaped", "Grains through walls"),
    ("simulated_s", "Simulated time (s)"),
    ("wall_s", "Wall time (s)"),
];

/// How many of [`OUTCOMES`] have figures and effects.
const MAIN_OUTCOMES: usize = 5;

/// How the main results of a laboratory begin and end, around the number of the opening or region.
const RATE: [&str; 2] = ["laboratory.openings.", ".rate_g_per_s"];
const VOIDS: [&str; 2] = ["laboratory.regions.", ".void_ratio"];

/// The results of a run by their path in its `summary.json`: those of [`OUTCOMES`], and every number
/// of a laboratory and of the conditions that ended its stages. What was not measured is absent.
pub fn outcomes_in(summary: &Value) -> BTreeMap<String, f64> {
    let mut found = BTreeMap::new();
    for (path, _) in OUTCOMES {
        let pointer = format!("/{}", path.replace('.', "/"));
        let number = summary.pointer(&pointer).and_then(Value::as_f64);
        found.extend(number.map(|number| (path.to_owned(), number)));
    }
    found.extend(numbers_in("laboratory", &summary["laboratory"], [".", ""]));
    for (n, stage) in summary["stages"].as_array().into_iter().flatten().enumerate() {
        found.extend(numbers_in(&format!("stages.{n}.until"), &stage["until"], [".", ""]));
    }
    found
}

/// Every number in a value at a path, with its own path; what stands around the number, from 0, of
/// an element of a list.
pub fn numbers_in(at: &str, value: &Value, around: [&str; 2]) -> Vec<(String, f64)> {
    match value {
        Value::Number(number) => {
            number.as_f64().map(|number| (at.to_owned(), number)).into_iter().collect()
        }
        Value::Object(fields) => {
            let dot = if at.is_empty() { "" } else { "." };
            let of =
                |(name, of): (&String, &Value)| numbers_in(&format!("{at}{dot}{name}"), of, around);
            fields.iter().flat_map(of).collect()
        }
        Value::Array(items) => {
            let [before, after] = around;
            let of = |(n, of): (usize, &Value)| {
                numbers_in(&format!("{at}{before}{n}{after}"), of, around)
            };
            items.iter().enumerate().flat_map(of).collect()
        }
        Value::Null | Value::Bool(_) | Value::String(_) => Vec::new(),
    }
}

/// All results that stand in the table of runs: [`OUTCOMES`], then what else any of them has, by name
/// and number.
pub(super) fn all_outcomes(runs: &[SweepRun]) -> Vec<&str> {
    let fixed: Vec<&str> = OUTCOMES.iter().map(|(path, _)| *path).collect();
    let found: BTreeSet<&str> =
        runs.iter().flat_map(|run| run.outcomes.keys().map(String::as_str)).collect();
    let mut more: Vec<&str> = found.into_iter().filter(|path| !fixed.contains(path)).collect();
    more.sort_by(|a, b| by_number(a).cmp(&by_number(b)));
    [fixed, more].concat()
}

/// The parts of a path, of which numbers are compared as such.
fn by_number(path: &str) -> Vec<(Option<usize>, &str)> {
    path.split('.').map(|part| (part.parse().ok(), part)).collect()
}

/// Results of which points have means: [`OUTCOMES`], and of laboratories the main ones.
pub fn averaged_outcomes(runs: &[SweepRun]) -> Vec<&str> {
    let all = all_outcomes(runs).into_iter().enumerate();
    let averaged = all.filter(|(n, path)| *n < OUTCOMES.len() || is_of_a_laboratory(path));
    averaged.map(|(_, path)| path).collect()
}

/// The main results that any run has, which have figures and effects: the first of [`OUTCOMES`], and
/// of laboratories the rates through openings and the void ratios of regions.
pub fn main_outcomes(runs: &[SweepRun]) -> Vec<&str> {
    let is_main = |n: usize, path: &str| n < MAIN_OUTCOMES || is_of_a_laboratory(path);
    let has = |path: &str| runs.iter().any(|run| run.outcomes.contains_key(path));
    let all = all_outcomes(runs).into_iter().enumerate();
    all.filter(|(n, path)| is_main(*n, path) && has(path)).map(|(_, path)| path).collect()
}

fn is_of_a_laboratory(path: &str) -> bool {
    [RATE, VOIDS].iter().any(|ends| number_between(path, *ends).is_some())
}

/// The number between the beginning and the end of a path.
fn number_between(path: &str, [start, end]: [&str; 2]) -> Option<usize> {
    path.strip_prefix(start)?.strip_suffix(end)?.parse().ok()
}

/// What a result is in words, with the names of a laboratory.
pub(super) fn in_words(outcome: &str, names: &LaboratoryNames) -> String {
    if let Some((_, words)) = OUTCOMES.iter().find(|(path, _)| *path == outcome) {
        return (*words).to_owned();
    }
    let name = |ends: [&str; 2], names: &[String]| -> Option<String> {
        names.get(number_between(outcome, ends)?).cloned()
    };
    match (name(RATE, &names.openings), name(VOIDS, &names.regions)) {
        (Some(opening), _) => format!("Rate through {opening} (g/s)"),
        (None, Some(region)) => format!("Void ratio of {region}"),
        (None, None) => outcome.to_owned(),
    }
}

/// In how many of the runs that count some main results are withheld that others give; nothing where
/// none is.
pub(super) fn withheld_in_words(of: &Sweep) -> Option<String> {
    let counting = || of.runs.iter().filter(|run| run.counts_in_means());
    let main = main_outcomes(&of.runs);
    let said = main.into_iter().filter_map(|path| {
        let without = counting().filter(|run| run.why_withheld(path).is_some()).count();
        let words = in_words(path, &of.names);
        (without > 0).then(|| format!("{words} in {without} of {}", counting().count()))
    });
    let said: Vec<String> = said.collect();
    (!said.is_empty()).then(|| format!("withheld, and not at random: {}", said.join(", ")))
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::*;

    fn run(summary: &Value) -> SweepRun {
        SweepRun {
            run: "point-0001-c1".into(),
            point: "point-0001".into(),
            configuration: 1,
            values: Vec::new(),
            outcomes: outcomes_in(summary),
            ..SweepRun::counted()
        }
    }

    /// Law: every number of a laboratory is a result of its run, in the order of the numbers in its
    /// path; the flow and the voids are the main ones.
    #[test]
    fn all_numbers_of_a_laboratory_are_results() {
        let piece = json!({ "name": "box", "present": true, "force_n": [0.0, 0.5, -2.0] });
        let pieces = vec![piece; 11];
        let summary = json!({
            "void_ratio": null, "coordination_number": 4.5, "simulated_s": 2.0,
            "laboratory": {
                "pieces": pieces,
                "openings": [{ "name": "mouth", "passed_g": 30.0, "rate_g_per_s": 187.5 }],
                "regions": [{ "name": "core", "void_ratio": 0.75, "stress": { "mean_kpa": 12.0 } },
                            { "name": "rim", "void_ratio": null, "stress": null }]
            },
            "stages": [{ "stage": "deposit" },
                       { "stage": "press", "until": { "reached": true, "at_s": 0.5, "force_n": 3.0 } }]
        });
        let runs = [run(&summary), run(&json!({ "void_ratio": 0.8, "laboratory": null }))];
        for (path, expected) in [
            ("coordination_number", Some(4.5)),
            ("laboratory.openings.0.rate_g_per_s", Some(187.5)),
            ("laboratory.openings.0.passed_g", Some(30.0)),
            ("laboratory.regions.0.stress.mean_kpa", Some(12.0)),
            ("laboratory.regions.1.void_ratio", None),
            ("laboratory.pieces.10.force_n.2", Some(-2.0)),
            ("stages.1.until.force_n", Some(3.0)),
            ("void_ratio", None),
        ] {
            let got = runs[0].outcomes.get(path).copied();
            assert_eq!(got, expected, "law: {path} as the summary has it");
        }
        let all = all_outcomes(&runs);
        let fixed: Vec<&str> = OUTCOMES.iter().map(|(path, _)| *path).collect();
        assert_eq!(all[..OUTCOMES.len()], fixed, "law: the fixed ones come first, measured or not");
        let place = |path: &str| all.iter().position(|p| *p == path).expect("a column");
        let [two, ten] = ["2", "10"].map(|n| place(&format!("laboratory.pieces.{n}.force_n.0")));
        assert!(two < ten, "law: 2 stands before 10");
        let rate = "laboratory.openings.0.rate_g_per_s";
        let voids = "laboratory.regions.0.void_ratio";
        assert_eq!(main_outcomes(&runs), ["void_ratio", rate, voids]);
        assert_eq!(averaged_outcomes(&runs)[OUTCOMES.len()..], [rate, voids]);
        assert_eq!(all_outcomes(&runs[1..]), fixed, "law: no columns of what no run has");
        let names = LaboratoryNames {
            openings: vec!["mouth".to_owned()],
            regions: vec!["core".to_owned()],
            ..LaboratoryNames::default()
        };
        assert_eq!(in_words(rate, &names), "Rate through mouth (g/s)");
        assert_eq!(in_words(voids, &names), "Void ratio of core");
        assert_eq!(in_words("void_ratio", &names), "Void ratio");
        assert_eq!(in_words("creep", &names), "creep", "law: a path without words is itself");
    }
}
