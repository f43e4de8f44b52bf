//! The table of small pours by the referee and by engines.

use serde_json::{Value, json};

/// Law: of pours that lost grains no mean is shown; of the others the interval, with its verdict.
#[test]
fn means_of_pours_that_lost_grains_are_left_out() {
    let row = |engine: &str, outside: u64, equivalent: Value| {
        json!({ "engine": engine, "realisations": 9, "outside": outside, "height_mean_mm": 7.5,
            "height_standard_error_mm": 0.25, "difference_percent": -0.125,
            "difference_interval_percent": [-0.5, 0.25], "coordination_mean": 5,
            "equivalent_within_0_5_percent": equivalent, "deepest_overlap_mm": 0.125 })
    };
    let pours =
        [row("one", 0, true.into()), row("two", 0, false.into()), row("three", 1, true.into())];
    let table = super::referee::pours(&json!({ "pours": pours })).expect("a table");
    let rows: Vec<&str> = table.lines().skip(2).collect();
    let numbers = |verdict: &str| {
        format!("7.500 | 0.250 | −0.12 (−0.50 to +0.25) | {verdict} | 5.00 | 0.125 |")
    };
    assert_eq!(
        rows,
        [
            format!("| one | 9 | 0 | {}", numbers("shown")),
            format!("| two | 9 | 0 | {}", numbers("not shown")),
            "| three | 9 | 1 | | | | | | |".to_owned(),
        ],
        "law: left what is shown, right what is known"
    );
    assert!(super::referee::pours(&json!({})).is_err(), "law: a file without pours has no table");
}
