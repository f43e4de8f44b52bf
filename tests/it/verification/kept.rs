//! Kept results of the verification are of the cases as they are now, and the page names failures
//! that are known.

use std::{collections::BTreeMap, path::Path};

use pluvia::verify::builtin;

use super::case;
use crate::program::page;

/// The kept tables, in double and in single precision.
const KEPT: [&str; 2] = ["verify.csv", "verify-single.csv"];

/// Rows of a kept table, by its columns.
fn rows(name: &str) -> Vec<BTreeMap<String, String>> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("docs/results").join(name);
    let mut table = csv::Reader::from_path(path).expect("the table can be opened");
    table.deserialize().map(|row| row.expect("a row of the table")).collect()
}

/// Law: kept rows are judged by what their cases expect and allow.
#[test]
fn kept_rows_expect_and_allow_what_their_cases_do() {
    let cases = builtin().expect("the built-in cases are sound");
    for name in KEPT {
        for row in rows(name) {
            let (id, setting) = (&row["case"], &row["setting"]);
            let case = cases.iter().find(|c| c.id == *id);
            let case =
                case.unwrap_or_else(|| panic!("law: {name} has no case but the built-in: {id}"));
            let single = case.tolerance_single.filter(|_| setting.ends_with("-single"));
            let got = ["expected", "tolerance"].map(|of| row[of].parse::<f64>().expect("a number"));
            let expected = [case.expected, single.unwrap_or(case.tolerance)];
            assert_eq!(got, expected, "law: {name}, {id} on {setting}: expected and tolerance");
        }
    }
}

/// Law: ranges of heights of packings may be what chance makes once in a thousand, 5.3 standard
/// deviations of four and 5.5 of five, not much more. One is 4 % of a mean height of 13 mm.
#[test]
fn ranges_of_packings_allow_little_more_than_chance() {
    const DEVIATION_MM: f64 = 0.04 * 13.0;
    for id in ["packing-turned", "packing-size"] {
        let got = case(id).tolerance / DEVIATION_MM;
        assert!(got < 6.0, "law: {id} allows less than 6 standard deviations, got {got:.1}");
    }
}

/// Law: a case that the page names among the deviations of native contacts is a known failure of
/// one of their settings.
#[test]
fn the_page_names_known_failures_of_native_contacts() {
    let text = page("docs/verification.md");
    let (_, rest) = text.split_once("- **Native contacts**").expect("the deviations");
    let (native, _) = rest.split_once("\n- **").expect("those of others");
    let cases = builtin().expect("the built-in cases are sound");
    let quoted = native.split('`').skip(1).step_by(2);
    let named: Vec<_> = quoted.filter_map(|word| cases.iter().find(|c| c.id == word)).collect();
    assert!(named.len() >= 5, "law: the page names cases, got {}", named.len());
    for case in named {
        let known = case.known_failures.iter().any(|k| k.setting.starts_with("native"));
        assert!(known, "law: `{}` is a known failure of native contacts", case.id);
    }
}
