//! Kept results of the verification are of the cases as they are now; what cases and the page say
//! of them is so.

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

/// The setting that a part of what a known failure got is of: "0.1 at 240 Hz", or the one it names.
fn setting_of(known: &str, part: &str) -> String {
    let Some((_, rate)) = part.split_once(" at ") else {
        return known.trim_end_matches('*').to_owned();
    };
    let engine = known.split(['-', '*']).next().unwrap_or_default();
    let single = if known.ends_with("-single") { "-single" } else { "" };
    match rate.split(' ').next() {
        _ if rate.ends_with("with `coulomb`") => "rapier-coulomb".to_owned(),
        Some("480") if engine != "native" => format!("{engine}{single}"),
        rate => format!("{engine}-{}{single}", rate.unwrap_or_default()),
    }
}

/// Law: what reasons of known failures say that was got is what kept rows have, to within one of
/// its last digit.
#[test]
fn reasons_quote_what_kept_rows_have() {
    let mut kept = BTreeMap::new();
    for row in KEPT.into_iter().flat_map(rows) {
        kept.insert((row["case"].clone(), row["setting"].clone()), row["got"].clone());
    }
    let mut quoted = 0;
    for case in builtin().expect("the built-in cases are sound") {
        for known in &case.known_failures {
            let Some((_, got)) = known.reason.rsplit_once("Got ") else { continue };
            for part in got.trim_end_matches('.').split(", ") {
                let setting = setting_of(&known.setting, part);
                let Some(row) = kept.get(&(case.id.clone(), setting.clone())) else { continue };
                let value = part.split(' ').next().unwrap_or_default();
                let digits = value.split_once('.').map_or(0, |(_, digits)| digits.len());
                let is_right = match (value.parse::<f64>(), row.parse::<f64>()) {
                    (Ok(value), Ok(row)) => {
                        (value - row).abs() < 1.01 * 0.1_f64.powi(digits as i32)
                    }
                    _ => value == "none" && row.is_empty(),
                };
                assert!(is_right, "law: {} on {setting}: expected {row}, got {value}", case.id);
                quoted += 1;
            }
        }
    }
    assert!(quoted > 400, "law: reasons quote kept rows, got {quoted}");
}

/// Law: tilted blocks meet the floor without gravity: no law of theirs speaks of its direction.
#[test]
fn laws_of_tilted_impacts_do_not_speak_of_gravity() {
    for case in builtin().expect("the built-in cases are sound") {
        let speaks = case.id.starts_with("impact-tilted") && case.law.contains("gravity");
        assert!(!speaks, "law: {} is without gravity, got `{}`", case.id, case.law);
    }
}
