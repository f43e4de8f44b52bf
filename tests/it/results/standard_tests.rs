//! What the page of the standard tests says of its rows as a whole.

use serde_json::{Value, json};

use super::{Build, laboratory, said};

/// What stands above the rows, of a build with a format.
fn above(format: &str, rows: &[Value]) -> String {
    let [name, day] = ["laboratory", "2000-01-01"].map(str::to_owned);
    let build = Build { name, day, format: format.to_owned() };
    laboratory::build(&[build], &json!(rows))
}

/// Law: each test with rows is named with the format of its rows: their own, or else that of the
/// build of all, which may name tests; where there is but one, no test is named.
#[test]
fn tests_are_named_by_the_format_of_their_rows() {
    let row = |test: &str, format: Value| json!({ "test": test, "format": format });
    let unsaid = |test: &str| row(test, Value::Null);
    for (format, rows, expected) in [
        ("19", vec![unsaid("column"), unsaid("hopper")], ", [format](README.md#the-files) 19.\n"),
        (
            "14 and 15",
            vec![unsaid("column"), unsaid("hopper")],
            ", [format](README.md#the-files) 14 and 15: rows of different tests may be of",
        ),
        (
            "14 and 15, hopper-spheres 21",
            vec![unsaid("hopper"), unsaid("hopper-spheres"), unsaid("beads")],
            ": 14 and 15 (hopper, steel beads), 21 (hopper with spheres). The [changelog]",
        ),
        (
            "14, column 19",
            vec![row("column", json!(21)), unsaid("column"), unsaid("beads")],
            ": 14 (steel beads), 21 and 19 (column). The",
        ),
    ] {
        let text = above(format, &rows);
        assert!(text.contains(expected), "law: `{format}`, expected `{expected}`, got {text}");
    }
}

/// Law: how many rows there are of each verdict is counted; without any, nothing is said of it.
#[test]
fn verdicts_of_the_standard_tests_are_counted() {
    let of = |verdict: &str| json!({ "test": "column", "verdict": verdict });
    let rows = ["within", "outside", "outside", "undecided", "not_judged", "not_run"].map(of);
    let text = above("19", &rows);
    let expected = "- Judged rows: 1 within, 2 missed, 1 undecided. Not judged: 1.\n";
    assert!(text.contains(expected), "law: `{expected}`, got {text}");
    let text = above("19", &rows[4..]);
    assert!(!text.contains("Judged rows"), "law: none is judged, got {text}");
}

/// Law: what was left out is found by the name of its run, not by that of its study.
#[test]
fn what_was_left_out_is_found_by_its_run() {
    let read = "To where a tenth of a ring is covered: 0.7";
    let missing = "friction 0.2 in place of 0.5, a column twice as wide";
    for (left_out, expected) in [
        (
            "column, spheres-1.2-c1 (checks NOT passed, creep); column, aspect-2.4-c2 (no deposit)",
            format!("left out by a check: spheres; no result yet: {missing}"),
        ),
        (
            "hopper-spheres, aspect-2.4-c2 (no deposit)",
            "no result yet: friction 0.2 in place of 0.5, spheres, a column twice as wide"
                .to_owned(),
        ),
    ] {
        let row = json!({ "id": "column-run-out-1.2", "quantity": "e", "verdict": "outside",
            "decimals": 1, "published": { "low": 1.0, "high": 2.0 }, "ours": 0.5, "values": [0.5],
            "note": format!("{read}; left out of this test: {left_out}") });
        let text = said("laboratory-missed", &[row]);
        let expected = format!("| {read}; {expected} |");
        assert!(text.contains(&expected), "law: `{expected}` of `{left_out}`, got {text}");
    }
}

/// Law: specimens whose difference has an interval without 0 did not come to one void ratio.
#[test]
fn triaxial_specimens_meet_where_the_interval_holds_none() {
    let row = |id: &str, interval: Value| json!({ "id": id, "ours": -0.05, "interval": interval, "values": [-0.05], "decimals": 2 });
    let region = |interval: Value| vec![row("triaxial-end-difference", interval)];
    let ends = |low: f64, high: f64| json!({ "low": low, "high": high });
    for (interval, expected) in [
        (ends(-0.09, -0.01), "loose less dense: −0.05 (−0.09 to −0.01); **they do not end at one"),
        (ends(-0.09, -0.01), "dense ones are looser at the end.\n"),
        (ends(0.01, 0.09), "dense ones are still denser at the end.\n"),
        (
            ends(-0.09, 0.01),
            "; no difference is shown, and none within the interval is excluded.\n",
        ),
        (Value::Null, "loose less dense: −0.05; too few specimens to tell"),
    ] {
        let text = said("laboratory-triaxial", &region(interval));
        assert!(text.contains(expected), "law: `{expected}`, got {text}");
    }
    let plates = said("laboratory-triaxial", &[row("triaxial-end-plates", Value::Null)]);
    assert!(plates.starts_with("- Void ratio between the plates"), "law: both, got {plates}");
    assert_eq!(said("laboratory-triaxial", &[]), "", "law: no row, no sentence");
}
