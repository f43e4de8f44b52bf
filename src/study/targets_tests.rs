//! Tests of targets: tables of which it is known where targets are met.

use std::fmt::Write;

use super::*;

/// A table of 25 runs over a and b from 0 to 4, settlement 10 a + 10 and angle 30 + b, with scatter.
fn table(folder: &Path, name: &str, scatter: f64) -> PathBuf {
    let mut csv = String::from(
        "run,point,configuration,a,b,fixed,settlement_mm.final,settlement_mm.after_5_s,\
         angle_of_repose.degrees,left_out_of_means,failure\n",
    );
    for n in 0..25_u32 {
        let (a, b) = (f64::from(n % 5), f64::from(n / 5));
        // Of no trend in a or b: each value once at every a and every b.
        let noise = scatter * f64::from((n % 5 + 2 * (n / 5)) % 5).mul_add(0.5, -1.0);
        let settled = 10.0 * (a + 1.0) + noise;
        let _ = writeln!(
            csv,
            "r{n},p{n},1,{a},{b},3,{settled},{},{},,",
            0.8 * settled,
            30.0 + b + noise
        );
    }
    csv += "left,p,1,1,1,3,1000,1000,1000,grains are missing,\nfailed,p,1,1,1,3,,,,,it failed\n";
    let path = folder.join(name);
    std::fs::write(&path, csv).expect("a table");
    path
}

fn runs(name: &str, path: PathBuf) -> TargetRuns {
    TargetRuns { name: name.to_owned(), path }
}

fn target(text: &str) -> Target {
    text.parse().expect("a target")
}

#[test]
fn the_point_where_all_targets_are_met_is_found() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = table(folder.path(), "sweep.csv", 0.5);
    let targets =
        [target("t:settlement_mm.final=28..32"), target("t:angle_of_repose.degrees=32.6..33.4")];
    let found = meet_targets(&[runs("t", path)], &targets, &[]).expect("an answer");
    assert_eq!(found.factors.len(), 2, "law: what does not vary is no factor: {:?}", found.factors);
    assert_eq!(found.targets[0].runs_counted, 25, "law: runs left out and failed do not count");
    assert_eq!(found.targets[0].runs_meeting, 5, "law: those with a = 2");
    let (by, half) = found.targets[0].effects["a"];
    assert!((by - 40.0).abs() < half && half < 2.0, "law: 10 a over 0 to 4 is 40: {by} ± {half}");
    let (by, half) = found.targets[0].effects["b"];
    assert!(by.abs() < half, "law: b does not move it: {by} ± {half}");
    let at = &found.all.at;
    assert!((at["a"] - 2.0).abs() < 0.2, "law: settlement 30 at a = 2: {at:?}");
    assert!((at["b"] - 3.0).abs() < 0.5, "law: 33 degrees at b = 3: {at:?}");
    assert!(found.all.best > 0.3, "law: met by a good part of runs there: {}", found.all.best);
    assert_eq!(found.all.runs, Some((1, 25)), "law: the run at (2, 3) alone");
    assert!(found.answer().starts_with("A run meets all targets with"), "{}", found.answer());
}

#[test]
fn targets_that_exclude_each_other_are_named() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = table(folder.path(), "sweep.csv", 0.5);
    // A settlement of 12 mm and one of 48 exclude each other.
    let targets = [target("t:settlement_mm.final=46..50"), target("u:settlement_mm.final=10..14")];
    let both = [runs("t", path.clone()), runs("u", path)];
    let found = meet_targets(&both, &targets, &[]).expect("an answer");
    assert!(found.targets.iter().all(|t| t.best > 0.5), "law: each by itself is met somewhere");
    assert!(found.all.best < 0.01, "law: never together, got {}", found.all.best);
    assert_eq!(found.all.runs, None, "law: they are of different tables");
    let answer = found.answer();
    let expected =
        "Targets that exclude each other: t:settlement_mm.final and u:settlement_mm.final";
    assert!(answer.contains(expected), "law: {expected} in {answer}");
}

#[test]
fn a_factor_that_stands_for_chance_is_scatter() {
    let folder = tempfile::tempdir().expect("a folder");
    let of = [runs("t", table(folder.path(), "sweep.csv", 0.5))];
    let angle = [target("t:angle_of_repose.degrees=32.6..33.4")];
    let found = meet_targets(&of, &angle, &["b".to_owned()]).expect("an answer");
    assert_eq!(found.factors.keys().collect::<Vec<_>>(), ["a"], "law: b is no factor");
    let scatter = found.targets[0].fit.residual_standard_deviation;
    assert!(scatter > 1.3, "law: 0 to 4 of b are scatter of 1.4 degrees, got {scatter}");
}

#[test]
fn shares_are_in_percent_and_tables_of_a_name_go_together() {
    let folder = tempfile::tempdir().expect("a folder");
    let tables = ["a.csv", "b.csv"].map(|name| runs("t", table(folder.path(), name, 0.5)));
    let share = [target("t:settlement_mm.after_5_s/settlement_mm.final=75..85")];
    let found = meet_targets(&tables, &share, &[]).expect("an answer");
    assert_eq!(found.targets[0].runs_counted, 50, "law: two tables of 25 runs");
    assert!((found.targets[0].values[0] - 80.0).abs() < 1e-9, "law: 80 % in all runs");
    assert_eq!(found.targets[0].runs_meeting, 50, "law: all meet it");
}

#[test]
fn what_cannot_be_answered_is_refused_with_the_reason() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = table(folder.path(), "sweep.csv", 0.5);
    let of = |text: &str| {
        meet_targets(&[runs("t", path.clone())], &[target(text)], &[])
            .expect_err("law: refused")
            .to_string()
    };
    assert!(of("x:void_ratio=0..1").contains("no runs have the name `x` (--runs gives t)"));
    let unknown = of("t:void_ratio=0..1");
    assert!(
        unknown.contains("no run that counts has `void_ratio` (there are angle_of_repose"),
        "{unknown}"
    );
    let angle = [target("t:angle_of_repose.degrees=32..33")];
    let misspelt = meet_targets(&[runs("t", path.clone())], &angle, &["c".to_owned()]);
    let misspelt = misspelt.expect_err("law: refused").to_string();
    assert!(
        misspelt.contains("--chance c: no sweep has this factor (there are a, b, fixed)"),
        "{misspelt}"
    );
    for text in
        ["t:a", "a=1..2", "t:a=2..1", "t:a=1", "t:=1..2", "t:a/=1..2", "t t:a=1..2", "t:a=nan..2"]
    {
        assert!(text.parse::<Target>().is_err(), "law: `{text}` is refused");
    }
    for text in ["t", "t=", "=path", "a b=path"] {
        assert!(text.parse::<TargetRuns>().is_err(), "law: `{text}` is refused");
    }
    let other = folder.path().join("other.csv");
    std::fs::write(&other, "x,y\n1,2\n").expect("a table");
    let refused =
        meet_targets(&[runs("t", other)], &[target("t:y=0..1")], &[]).expect_err("law: refused");
    assert!(refused.to_string().contains("no table of a sweep"), "{refused}");
}

/// Law: the first elements of the sequence of base 2 are 1/2, 1/4, 3/4, 1/8.
#[test]
fn haltons_sequence_halves_and_halves_again() {
    let got: Vec<f64> = (1..=4).map(|n| halton(n, 2)).collect();
    assert_eq!(got, [0.5, 0.25, 0.75, 0.125]);
    assert!((halton(5, 3) - (2.0 / 3.0 + 1.0 / 9.0)).abs() < 1e-15, "law: 5 is 12 in base 3");
}
