//! Rows of `make bench` in the pages: one world, or two at once.

use std::fs;

use serde_json::{Value, json};

use super::{Results, list, pages, root, tables};

/// A row of 1456 grains that are shaken.
fn row(specimens: u32, threads: u32, ms_per_step: f64, speed_up: Value) -> Value {
    json!({ "grains": 1456, "specimens": specimens, "state": "shaken", "threads": threads,
        "ms_per_step": ms_per_step, "us_per_grain_step": 1e3 * ms_per_step / 1456.0,
        "growth": 1.0, "serial_share": null, "speed_up": speed_up,
        "memory_kib_per_grain": 20.0 })
}

/// Law: worlds that run at once are named as such, and numbers of one world are found wherever its
/// row stands.
#[test]
fn two_worlds_at_once_stand_apart_from_one() {
    let folder = tempfile::tempdir().expect("a folder");
    let results = folder.path().join(list::FOLDER);
    fs::create_dir_all(&results).expect("made");
    let rows =
        [row(2, 1, 60.0, json!(1.5)), row(1, 1, 45.0, Value::Null), row(1, 2, 30.0, json!(1.5))];
    fs::write(results.join("bench.json"), json!(rows).to_string()).expect("written");
    let results = Results::of(folder.path());
    let text = tables::named("steps", &results).expect("a table");
    let lines: Vec<&str> = text.lines().skip(2).collect();
    let expected = [
        "| shaken, two worlds at once | 1456 | 1 | 60.00 | 41.2 | 1.00 | | 1.50 | 20.0 |",
        "| shaken | 1456 | 1 | 45.00 | 30.9 | 1.00 | | | 20.0 |",
        "| shaken | 1456 | 2 | 30.00 | 20.6 | 1.00 | | 1.50 | 20.0 |",
    ];
    assert_eq!(lines, expected, "law: left what the table has, right what its rows give");
    for (specimens, expected) in [(1, "45"), (2, "60")] {
        let key = format!(
            "bench:state=shaken/grains=1456/specimens={specimens}/threads=1/0/ms_per_step:"
        );
        assert_eq!(results.quote(&key).as_deref(), Ok(expected), "law: {key}");
    }
}

/// Law: a page says of how many worlds at once a number of `make bench` is.
#[test]
fn pages_name_the_number_of_worlds() {
    let mut quoted = 0;
    for (page, text) in pages::read(root()).expect("pages can be read") {
        for key in text.split("<!--r bench:").skip(1).filter_map(|after| after.split("-->").next())
        {
            assert!(key.contains("/specimens="), "law: `bench:{key}` in {page} names specimens");
            quoted += 1;
        }
    }
    assert!(quoted > 0, "expected pages that quote bench.json");
}
