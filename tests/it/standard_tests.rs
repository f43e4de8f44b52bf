//! The laws by which `make laboratory` reads its tests keep to what they say, and its rows are
//! judged by what was seen in a source.

use std::path::Path;

#[allow(dead_code, unused_imports)] // the laboratory reads more than the tests ask
#[path = "../../benches/laboratory/standard_tests/mod.rs"]
mod laws;
#[path = "../../benches/laboratory/legend.rs"]
mod legend;
#[path = "../../benches/laboratory/references.rs"]
mod references;
#[path = "../../benches/laboratory/relative.rs"]
mod relative;
#[allow(dead_code)] // no table is printed here
#[path = "../../benches/laboratory/row.rs"]
mod row;
#[path = "../../benches/laboratory/rows.rs"]
mod rows;

use laws::{self as standard_tests, Verdict};
use references::{Published, Stated};
use row::Row;

/// Rows of points that a kept file may not have yet, and of the full design.
const OTHERS: [&str; 12] = [
    "column-run-out-0.5",
    "density-basalt-long-flat-e-max",
    "density-basalt-long-flat-e-min",
    "density-basalt-rough-e-max",
    "density-basalt-rough-e-min",
    "density-fraction-e-max",
    "density-fraction-e-min",
    "direct-shear-far-dilation-end",
    "direct-shear-far-end",
    "direct-shear-void-ratio",
    "relative-density-oedometer-void-ratio",
    "triaxial-begin-loose",
];

/// What a source says that has no address.
const WITHOUT_ADDRESS: [&str; 7] = [
    "from memory",
    "not checked against a source",
    "No source was seen",
    "no number was seen",
    "none is published",
    "follows from the two published void ratios",
    "as in the row of these grains without the change",
];

/// The rows that the page shows.
fn kept() -> Vec<Row> {
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("docs/results/laboratory.json");
    pluvia::record::read_json(&file).expect("the rows are kept")
}

/// Whether a source names a place in the web: a host with a path.
fn has_address(source: &str) -> bool {
    source.split([' ', '(', ')', ',', ';']).any(|word| {
        let Some((host, path)) = word.split_once('/') else { return false };
        let mut parts = host.rsplit('.');
        let is_top = parts.next().is_some_and(|top| top.chars().all(|c| c.is_ascii_alphabetic()));
        is_top && parts.next().is_some() && !path.is_empty()
    })
}

#[test]
fn every_published_number_has_a_source() {
    let ids = kept().into_iter().map(|row| row.id).chain(OTHERS.map(str::to_owned));
    for id in ids {
        let reference = references::of(&id);
        let source = &reference.source;
        let has_number = reference.stated != Stated::Nothing;
        assert!(!source.is_empty(), "law: {id} says where its number is from, or that none is");
        if reference.is_judged {
            assert!(
                has_number && has_address(source),
                "law: {id} is judged by a number that was seen at an address, got `{source}`"
            );
            let is_one = matches!(reference.stated, Stated::Known(Published::Value { .. }));
            assert!(!is_one, "law: {id} is judged by a range: one value has no ends");
        } else {
            assert!(
                has_address(source) || WITHOUT_ADDRESS.iter().any(|text| source.contains(text)),
                "law: {id} has an address, or says why it has none, got `{source}`"
            );
            assert!(
                !has_number || !source.contains("none is published"),
                "law: {id} states no number of which its source says that there is none"
            );
        }
    }
    for (source, expected) in [
        ("Mankoc et al. 2007, seen at ar5iv.labs.arxiv.org/html/0707.4550: a 5/2 law", true),
        ("(seen at hindawi.com/journals/tswj/2014/290207/tab1)", true),
        ("Lube et al. 2004, J. Fluid Mech. 508: (r∞ − r₀)/r₀ = 1.24 a, ± 3.5/2 %", false),
        ("a handbook", false),
    ] {
        assert_eq!(has_address(source), expected, "law: an address in `{source}`");
    }
}

#[test]
fn verdicts_follow_from_the_interval_and_what_is_published() {
    // Student's t of three values in steps of s reaches 2.48 s to either side of their mean.
    for (id, values, expected) in [
        // 2.4 to 2.6, seen.
        ("hopper-exponent", vec![2.49, 2.50, 2.51], Verdict::Within),
        ("hopper-exponent", vec![2.80, 2.81, 2.82], Verdict::Outside),
        ("hopper-exponent", vec![2.20, 2.21, 2.22], Verdict::Outside),
        ("hopper-exponent", vec![2.57, 2.58, 2.59], Verdict::Undecided),
        ("hopper-exponent", vec![2.3, 2.5, 2.7], Verdict::Undecided),
        ("hopper-exponent", vec![2.5], Verdict::Undecided),
        ("hopper-exponent", Vec::new(), Verdict::NotRun),
        // 1 to 2, not seen.
        ("hopper-k", vec![1.49, 1.50, 1.51], Verdict::NotJudged),
        ("hopper-k", vec![7.0, 7.0, 7.1], Verdict::NotJudged),
        ("hopper-k", Vec::new(), Verdict::NotRun),
        // Nothing is published.
        ("density-e-max", vec![0.95, 0.96, 0.97], Verdict::NotJudged),
        ("density-e-max", Vec::new(), Verdict::NotRun),
        // A change that is only tried, whatever it is called; the same without it is judged.
        ("density-basalt-longer-e-min", vec![0.70, 0.70, 0.71], Verdict::NotJudged),
        ("density-basalt-e-min", vec![0.70, 0.70, 0.71], Verdict::Within),
    ] {
        let row = Row::of("a test", id, "a quantity", &values);
        assert_eq!(row.verdict, expected, "law: {id} with {values:?}: {:?}", row.interval);
    }
    let law = Published::Range { low: 1.0, high: 1.4 };
    for (values, expected) in
        [(vec![1.19, 1.20, 1.21], Verdict::Within), (vec![0.49, 0.50, 0.51], Verdict::Outside)]
    {
        let row = Row::of("column", "column-run-out-1", "run-out", &values).beside(law);
        assert_eq!(row.verdict, expected, "law: {values:?} beside 1.0 to 1.4");
    }
}

#[test]
fn a_kept_row_takes_the_published_number_of_today() {
    let values = [2.49, 2.50, 2.51];
    let stale = Some(Published::Range { low: 3.0, high: 4.0 });
    let again = |id: &str| {
        let mut row = Row::of("a test", id, "a quantity", &values);
        (row.published, row.verdict) = (stale, Verdict::Outside);
        row.judge();
        (row.published, row.verdict)
    };
    let expected = (Some(Published::Range { low: 2.4, high: 2.6 }), Verdict::Within);
    assert_eq!(again("hopper-exponent"), expected, "law: the range of today, and its verdict");
    let expected = (None, Verdict::NotJudged);
    assert_eq!(again("density-e-max"), expected, "law: what is published no longer goes");
    let expected = (stale, Verdict::Outside);
    assert_eq!(again("column-run-out-1"), expected, "law: a law's value is the row's own");
}

#[test]
fn kept_rows_are_judged_by_the_references_of_today() {
    // Relative densities are judged by more than their own values.
    let mut judged = kept();
    judged.iter_mut().for_each(Row::judge);
    relative::derive(&mut judged);
    for row in kept() {
        let today = judged.iter().find(|today| today.id == row.id);
        let today = today.unwrap_or_else(|| panic!("law: {} is derived today", row.id));
        assert_eq!(
            (today.published, &today.source[..], today.verdict),
            (row.published, &row.source[..], row.verdict),
            "law: {} says what benches/laboratory/references.rs says; `make laboratory \
             ARGS=\"--judge --out docs/results/laboratory.json\"` judges kept rows again",
            row.id
        );
        let of = |row: &Row| {
            let ends = row.interval.map(|i| (i.low, i.high)).unzip();
            [("mean", row.ours), ("low end", ends.0), ("high end", ends.1)]
        };
        for ((what, kept), (_, found)) in of(&row).into_iter().zip(of(today)) {
            let is_same = match (kept, found) {
                (Some(kept), Some(found)) => (kept - found).abs() <= 1e-9 * kept.abs().max(1e-3),
                _ => kept.is_none() && found.is_none(),
            };
            assert!(
                is_same,
                "law: the {what} of {} follows from its values to 1e-9, expected {found:?}, got \
                 {kept:?}",
                row.id
            );
        }
    }
}

#[test]
fn relative_densities_follow_from_the_index_densities_beside_them() {
    let row = |id: &str, values: &[f64]| Row::of("density", id, "a void ratio", values);
    let mut rows = vec![
        row("density-e-max", &[0.9, 1.1]),
        row("density-e-min", &[0.5, 0.7]),
        row("density-fraction-e-max", &[0.8]),
        row("density-fraction-e-min", &[0.6]),
        row("oedometer-void-ratio", &[0.75, 0.85]),
        row("density-d4253", &[0.7]),
        // By index densities that were measured anew since.
        row("density-d4253-relative", &[0.1]),
    ];
    let own = "density-d4253-relative";
    for again in [false, true] {
        relative::derive(&mut rows);
        for (id, expected) in
            [(own, vec![0.75]), ("relative-density-oedometer-void-ratio", vec![0.25, -0.25])]
        {
            let found: Vec<&Row> = rows.iter().filter(|row| row.id == id).collect();
            assert_eq!(found.len(), 1, "law: one row {id}, again: {again}");
            let got = &found[0].values;
            let apart = got.iter().zip(&expected).map(|(a, b)| (a - b).abs());
            assert!(
                got.len() == expected.len() && apart.fold(0.0, f64::max) < 1e-12,
                "law: {id} to 1e-12, expected {expected:?}, got {got:?}"
            );
        }
    }
    // One run alone keeps what it found.
    let mut alone = vec![row("density-d4253", &[0.7]), row(own, &[0.1])];
    relative::derive(&mut alone);
    assert_eq!(alone[1].values, [0.1], "law: without index densities the row stays");
}

/// Law: a relative density is as uncertain as the specimen and both index densities make it, is of
/// the oldest build of the three, and says so.
#[test]
fn a_relative_density_has_the_uncertainty_of_all_three() {
    let row = |id: &str, values: &[f64]| Row::of("density", id, "a void ratio", values);
    let of = |loosest: &[f64], densest: &[f64], specimen: &[f64]| {
        let mut rows = vec![
            row("density-fraction-e-max", loosest),
            Row { format: Some(3), ..row("density-fraction-e-min", densest) },
            row("oedometer-void-ratio", specimen),
            row("triaxial-begin-loose", specimen),
        ];
        relative::derive(&mut rows);
        let [lid, inner] = ["oedometer-void-ratio", "triaxial-begin-loose"].map(|id| {
            let id = format!("relative-density-{id}");
            rows.iter().find(|row| row.id == id).cloned().expect("law: the row is there")
        });
        assert_eq!(lid.format, Some(3), "law: the format of the oldest, of {loosest:?}");
        assert!(lid.note.contains("densest of 3"), "law: it is said, got `{}`", lid.note);
        assert!(lid.note.contains("walls make its void ratio larger"), "got `{}`", lid.note);
        let walls = "without the looser grains at its walls";
        assert!(inner.note.contains(walls), "law: read in a region, got `{}`", inner.note);
        lid
    };
    // Student's t of 95 % at 1 and at 2 degrees of freedom.
    let [t_1, t_2] = [12.706_204_736_174_7, 4.302_652_729_749_5];
    let ends = |row: &Row| row.interval.map(|i| [i.low, i.high]);
    let near = |what: &str, got: Option<[f64; 2]>, expected: [f64; 2]| {
        let is_near = got.is_some_and(|got| {
            got.iter().zip(&expected).all(|(got, expected)| (got - expected).abs() < 1e-6)
        });
        assert!(is_near, "law: {what}, expected {expected:?} to 1e-6, got {got:?}");
    };
    // Only the specimen scatters: its own interval over the range.
    let half = t_2 * 0.01 / 3_f64.sqrt() / 0.2;
    let got = of(&[0.8, 0.8], &[0.6, 0.6], &[0.69, 0.70, 0.71]);
    near("of the specimen alone", ends(&got), [0.5 - half, 0.5 + half]);
    // Only the densest scatters, D = 0.1/(0.8 − n): the ends are those of n.
    let n = t_1 * 0.001;
    let got = of(&[0.8, 0.8], &[0.599, 0.601], &[0.7, 0.7]);
    near("of the densest alone", ends(&got), [0.1 / (0.2 + n), 0.1 / (0.2 - n)]);
    // Only the loosest scatters, D = 1 − 0.1/(x − 0.6).
    let got = of(&[0.799, 0.801], &[0.6, 0.6], &[0.7, 0.7]);
    near("of the loosest alone", ends(&got), [1.0 - 0.1 / (0.2 - n), 1.0 - 0.1 / (0.2 + n)]);
    for (why, loosest, densest, specimen) in [
        ("single realisation", &[0.8, 0.8][..], &[0.6, 0.6][..], &[0.7][..]),
        ("single realisation", &[0.8][..], &[0.6, 0.6][..], &[0.69, 0.71][..]),
        ("single realisation", &[0.8, 0.8][..], &[0.6][..], &[0.69, 0.71][..]),
        ("may be the same", &[0.7, 0.9][..], &[0.5, 0.7][..], &[0.69, 0.71][..]),
    ] {
        let got = of(loosest, densest, specimen);
        assert_eq!(ends(&got), None, "law: none where it is not known, {why}");
        assert!(got.note.contains(why), "law: it says `{why}`, got `{}`", got.note);
    }
}

#[test]
fn kept_relative_densities_follow_from_the_kept_index_densities() {
    let mut today = kept();
    relative::derive(&mut today);
    for row in kept().iter().filter(|row| row.id.contains("relative")) {
        let found = today.iter().find(|other| other.id == row.id).and_then(|other| other.ours);
        let is_same = row.ours.zip(found).is_some_and(|(a, b)| (a - b).abs() < 1e-9);
        assert!(
            is_same,
            "law: {} to 1e-9, expected {found:?}, got {:?}; `make laboratory ARGS=\"--judge --out \
             docs/results/laboratory.json\"` derives it anew",
            row.id, row.ours
        );
    }
}

/// Law: the rows of a test are in the file when it ends, in the order of the tests, with what
/// follows from them; those of other tests stay.
#[test]
fn rows_of_a_test_are_written_when_it_ends() {
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("rows.json");
    let tests = ["density", "direct-shear", "oedometer"].map(str::to_owned);
    let row = |test: &str, id: &str, value: f64| Row::of(test, id, "a void ratio", &[value]);
    let of_density = [
        row("density", "density-fraction-e-max", 1.0),
        row("density", "density-fraction-e-min", 0.6),
    ];
    let oedometer = |value| [row("oedometer", "oedometer-void-ratio", value)];
    let mut all = Vec::new();
    let relative = "relative-density-oedometer-void-ratio";
    let both = ["density-fraction-e-max", "density-fraction-e-min"];
    let ends: [(&str, &[Row], Vec<&str>); 3] = [
        ("oedometer", &oedometer(0.9), vec!["oedometer-void-ratio"]),
        ("density", &of_density, vec![both[0], both[1], relative, "oedometer-void-ratio"]),
        ("oedometer", &oedometer(0.8), vec![both[0], both[1], relative, "oedometer-void-ratio"]),
    ];
    for (test, found, expected) in ends {
        rows::renew(&mut all, test, found, &tests, &file).expect("the rows are written");
        let written: Vec<Row> = pluvia::record::read_json(&file).expect("the rows are there");
        let got: Vec<&str> = written.iter().map(|row| row.id.as_str()).collect();
        assert_eq!(got, expected, "law: the file after {test}");
    }
    let found = all.iter().find(|row| row.id == relative).and_then(|row| row.ours);
    let got = found.expect("a relative density");
    assert!((got - 0.5).abs() < 1e-12, "law: (1 - 0.8)/(1 - 0.6) = 0.5, got {got}");
}

/// Law: a figure shows realisations that have a value now, whatever earlier runs have left.
#[test]
fn realisations_without_a_value_have_no_line() {
    let failures = |runs: &[&str]| -> Vec<String> {
        runs.iter().map(|run| format!("{run}: it failed: densest-c1: at 2 s")).collect()
    };
    for (values, failed, expected) in [
        (2, &["densest-c2"][..], vec![1, 3]),
        (3, &[][..], vec![1, 2, 3]),
        (0, &["densest-c1"][..], vec![]),
        (9, &["densest-c10"][..], vec![1, 2, 3, 4, 5, 6, 7, 8, 9]),
    ] {
        let got = legend::realisations("densest", values, &failures(failed));
        assert_eq!(got, expected, "law: {values} with a value, without one {failed:?}");
    }
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("benches/laboratory/density.rs");
    let text = std::fs::read_to_string(path).expect("it can be read");
    let by_folder = text.contains(".exists()");
    assert!(!by_folder, "law: no line is drawn because a folder of a run is there");
}

/// Law: the first line of a kind in a figure has its name, whichever realisation it is of: the first
/// one may be left out.
#[test]
fn the_first_line_of_each_kind_has_its_name() {
    let kinds = ["Loaded", "Unloaded"].map(str::to_owned);
    for (lines, expected) in [
        (vec![0, 1, 0, 1], vec!["Loaded", "Unloaded", "", ""]),
        (vec![1, 1, 0], vec!["Unloaded", "", "Loaded"]),
        (Vec::new(), Vec::new()),
    ] {
        let got = legend::names(&kinds, &lines);
        assert_eq!(got, expected, "law: names of lines of the kinds {lines:?}");
    }
    for file in ["oedometer", "density"] {
        let path = format!("benches/laboratory/{file}.rs");
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join(path);
        let text = std::fs::read_to_string(path).expect("it can be read");
        let by_number = text.contains("configuration == 1");
        assert!(!by_number, "law: {file}.rs names no line by the number of its realisation");
    }
}
