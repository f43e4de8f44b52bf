//! What pages quote of tables of many runs, on made-up tables of known answer.

use std::fs;

use serde_json::json;

use super::{Results, list, tables};

/// The results of a tree with one file, made of these lines.
fn with(file: &str, text: &str) -> (tempfile::TempDir, Results) {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join(list::FOLDER).join(file);
    fs::create_dir_all(path.parent().expect("a folder")).expect("made");
    fs::write(path, text).expect("written");
    let results = Results::of(folder.path());
    (folder, results)
}

/// Law: two settings with the same settlements in another order do not differ, whichever is the
/// default, and one that settles by a tenth more does so by 10 %, however much settlements scatter.
#[test]
fn deviations_are_of_the_mean_settlement() {
    let settled = [5.0, 7.0, 12.0];
    let of = |default: [f64; 3], other: [f64; 3]| {
        let mut text = String::from(
            "point,configuration,engine.rate_hz,settlement_mm.final,surface_settlement_mm.final,\
             poured_height_mm.mean_surface\n",
        );
        for (point, rate, settled) in [("a", 480, default), ("b", 240, other)] {
            for (n, mm) in (1..).zip(settled) {
                text += &format!("{point},{n},{rate},{mm},{mm},100\n");
            }
        }
        let (_folder, results) = with("engines/native-settlement.csv", &text);
        let found = results.source("settlement").expect("a table");
        ["plate_percent", "surface_percent", "height_percent"].map(|field| {
            let of = |of: &str| found[1][field][of].as_f64().expect("an interval");
            (of("mean"), of("half"))
        })
    };
    let turned = [7.0, 12.0, 5.0];
    let tenth = settled.map(|mm| 1.1 * mm);
    // Student's t of three pairs, 4.303, times the standard error of 2, 5 and -7 mm, or of 0.5, 0.7
    // and 1.2 mm, over 8 mm.
    let (of_turned, of_tenth) = (193.92, 11.2);
    for (default, other, mean, half) in [
        (settled, turned, 0.0, of_turned),
        (turned, settled, 0.0, of_turned),
        (settled, tenth, 10.0, of_tenth),
    ] {
        let [plate, surface, height] = of(default, other);
        for got in [plate, surface] {
            let law = format!("{other:?} beside {default:?}: {mean} ± {half}, got {got:?}");
            assert!((got.0 - mean).abs() < 1e-9, "law: {law}, tolerance 1e-9");
            assert!((got.1 - half).abs() < 0.05, "law: {law}, tolerance 0.05");
        }
        assert_eq!(height, (0.0, 0.0), "law: the same height");
    }
}

/// Law: of no run a page quotes no number, but how many they are.
#[test]
fn nothing_is_quoted_of_no_run() {
    let text = "configuration,void_ratio,left_out_of_means\n1,0.9,jammed\n2,1.0,\n";
    let (_folder, results) = with("quick/vibration.csv", text);
    let quote = |runs: &str, format: &str| {
        results.quote(&format!("quick:left_out_of_means={runs}/*void_ratio:{format}"))
    };
    for format in ["mean.1", "list.1", "slashes.1", "max.1", "range.1"] {
        assert_eq!(quote("", format), Ok("1.0".to_owned()), "law: {format} of a run");
        let got = quote("unknown", format);
        assert!(got.is_err(), "law: {format} of no run is a fault, got {got:?}");
    }
    assert_eq!(quote("unknown", "count"), Ok("0".to_owned()), "law: there are none");
}

/// Law: a run that failed is no realisation.
#[test]
fn runs_that_failed_are_not_counted() {
    let text = "point,configuration,engine.rate_hz,void_ratio,settlement_mm.final,failure\n\
                a,1,480,1.0,5,\na,2,480,1.1,6,\na,3,480,,,grains flew away\n\
                b,1,240,1.0,5,\nb,2,240,,,grains flew away\nb,3,240,,,grains flew away\n";
    let (_folder, results) = with("engines/native-settlement.csv", text);
    let found = results.source("settlement").expect("a table");
    for (point, expected) in [(0_usize, 2), (1, 1)] {
        let got = &found[point]["count"];
        assert_eq!(got, &json!(expected), "law: {expected} of 3 runs have a result, got {got}");
    }
}

/// Law: runs that are left out of means are left out of how settlements scatter.
#[test]
fn scatter_between_placements_is_of_runs_that_count() {
    let text = "configuration,settlement_mm.final,surface_settlement_mm.final,left_out_of_means\n\
                1,10,5,\n1,12,6,\n1,90,70,checks NOT passed\n2,14,7,\n2,16,8,\n";
    let (_folder, results) = with("placements.csv", text);
    let found = results.source("placements-scatter").expect("a table");
    for (n, expected) in [(0_usize, 13.0), (1, 6.5)] {
        let of = &found[n];
        assert_eq!(of["values"], json!(4), "law: four runs count, got {}", of["values"]);
        let mean = of["mean"].as_f64().expect("a mean");
        let off = (mean - expected).abs();
        assert!(off < 1e-9, "law: {expected} mm on average, got {mean} mm, tolerance 1e-9");
    }
}

/// Law: the interval of a coefficient's angle is of the piles that have one and count.
#[test]
fn a_calibration_counts_the_piles_of_its_means() {
    let value = |value: f64, left_out: u32| {
        json!({ "value": value, "runs": 5, "failed": 1, "left_out": left_out, "mean": 41.7,
            "half_width_95": 1.5 })
    };
    let found = json!({ "values": [value(1.0, 0), value(1.5, 2)] });
    let (_folder, results) = with("calibration/calibrate.json", &found.to_string());
    let text = tables::named("calibration", &results).expect("a table");
    let ends: Vec<&str> = text.lines().skip(2).filter_map(|row| row.rsplit('°').next()).collect();
    assert_eq!(ends, [" | 4 |", " | 2 |"], "law: runs less failed less left out, got {text}");
}

/// Law: sizes are compared realisation by realisation: a difference that every pair has is beyond
/// scatter, however wide the intervals of either size are; heights are over the size. A realisation
/// that jams in one of the sizes is in neither.
#[test]
fn twins_are_compared_in_pairs() {
    let mut text = String::from(
        "larger,configuration,void_ratio,standing_height_mm.mean_surface,coordination_number,\
         grains.left_in_funnel\n",
    );
    for (n, height) in (1..).zip([90.0, 100.0, 110.0, 500.0]) {
        // Pairs differ in void ratio by chance, in height over the size by 1 mm.
        let chance = [0.02, -0.03, 0.01, 0.0][n - 1];
        for (larger, more, apart) in [(0.1, 1.0, chance), (1.0, 0.0, 0.0), (5.0, 0.0, 0.0)] {
            let stuck = if n == 4 && larger == 5.0 { 100 } else { 0 };
            let height = larger * (height + more);
            text += &format!("{larger},{n},{},{height},4.5,{stuck}\n", 1.0 + apart);
        }
    }
    // The fourth is far off, and jams at the largest size alone.
    let (_folder, results) = with("scale/twins.csv", &text);
    let found = results.source("twins-differences").expect("differences");
    let found = found.as_array().expect("rows");
    let expected =
        [("0.1 less 1", 4, 0.5), ("5 less 1", 3, 0.0), ("5 less 0.1", 3, -100.0 / 101.0)];
    assert_eq!(found.len(), expected.len(), "law: every two sizes");
    for ((name, pairs, height), row) in expected.into_iter().zip(found) {
        assert_eq!((&row["name"], &row["count"]), (&json!(name), &json!(pairs)), "law: {row}");
        let [mean, half] = ["mean", "half"].map(|of| {
            let number = row["height_percent"][of].as_f64();
            number.unwrap_or_else(|| panic!("no {of} in {row}"))
        });
        let law = format!("{name}: {height} ± 0 % of the height, got {mean} ± {half}");
        assert!((mean - height).abs() < 1e-9 && half < 1e-9, "law: {law}, tolerance 1e-9");
        let reach = row["height_reach_percent"].as_f64().expect("how far");
        assert!((reach - height.abs()).abs() < 1e-9, "law: {law}, reaches to {reach}");
    }
    let beyond = results.source("twins-beyond").expect("how many");
    let expected = json!({ "differences": 9, "beyond": 2 });
    assert_eq!(*beyond, expected, "law: heights at 0.1 alone are beyond scatter");
    let table = tables::named("twins-differences", &results).expect("a table");
    let rows: Vec<&str> = table.lines().skip(2).collect();
    assert!(rows[0].starts_with("| 0.1 less 1 | 4 | +0.50 ± 0.00 | 0.00 ± "), "law: {table}");
    assert!(rows[0].ends_with(" ~ | 0.00 ± 0.00 ~ |"), "law: scatter is marked, got {table}");
    assert!(rows[1].starts_with("| 5 less 1 | 3 | 0.00 ± 0.00 ~ | "), "law: {table}");
}

/// Law: of twins the page says how many runs it leaves out: those that jammed, without a result,
/// with a row or without one, and those that are not valid.
#[test]
fn twins_that_are_left_out_are_counted() {
    let mut text = String::from(
        "larger,configuration,void_ratio,standing_height_mm.mean_surface,coordination_number,\
         overlap.mean_percent,overlap.p99_percent,creep_um_per_s,grains.left_in_funnel,\
         meets_standard,valid\n",
    );
    for n in 1..=5 {
        for (larger, height) in [("0.1", 10), ("1", 100), ("5", 500)] {
            text += &match (larger, n) {
                ("0.1", 2) => format!("{larger},{n},,,,,,,,,\n"),
                ("0.1", 3) => format!("{larger},{n},9,9,4.5,0.06,0.3,0.1,0,true,false\n"),
                ("0.1", 4) => format!("{larger},{n},9,9,4.5,0.06,0.3,0.1,100,true,true\n"),
                ("1", 5) => continue,
                _ => format!("{larger},{n},1,{height},4.5,0.06,0.3,0.1,0,true,true\n"),
            };
        }
    }
    let (_folder, results) = with("scale/twins.csv", &text);
    let table = tables::named("twins", &results).expect("a table");
    let rows: Vec<&str> = table.lines().skip(2).collect();
    for (row, expected) in rows.iter().zip([
        "| 0.1 | 2 | 3 | 1.000 ± ",
        "| 1 | 4 | 1 | 1.000 ± ",
        "| 5 | 5 | 0 | 1.000 ± ",
    ]) {
        assert!(row.starts_with(expected), "law: expected `{expected}`, got `{row}`");
    }
}
