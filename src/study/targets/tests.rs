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
    let points = found.all.points.expect("law: they are of one table");
    assert_eq!((points.met, points.of), (1, 25), "law: the run at (2, 3) alone");
    let expected = "By the linear models a run meets all targets with";
    assert!(found.answer().contains(expected), "law: {expected} in {}", found.answer());
}

/// Law: runs that are left out, that failed, or that lack the result, are counted and reported.
#[test]
fn runs_left_out_of_a_target_are_counted() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = table(folder.path(), "sweep.csv", 0.5);
    let csv = std::fs::read_to_string(&path).expect("a table");
    std::fs::write(&path, csv + "null,p,1,1,1,3,,,30,,\n").expect("a table");
    let wanted =
        [target("t:settlement_mm.final=28..32"), target("t:angle_of_repose.degrees=32..33")];
    let found = meet_targets(&[runs("t", path)], &wanted, &[]).expect("an answer");
    let counts: Vec<(usize, usize)> =
        found.targets.iter().map(|t| (t.runs_counted, t.runs_left_out)).collect();
    assert_eq!(counts, [(25, 3), (26, 2)], "law: of 28 runs");
    let page = found.page().markdown();
    let row = page.lines().find(|line| line.starts_with("| t:settlement_mm.final | 28 to 32 |"));
    let row = row.expect("a row of the target");
    assert!(
        row.contains(" %) | 25 | 3, 1 of them without the result |"),
        "law: the page says so, too: {row}"
    );
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
    let points = found.all.points.expect("law: their runs have the same factors");
    assert_eq!((points.met, points.of), (0, 25), "law: a run has one settlement");
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

/// Law: numbers that only name realisations are chance, asked for or not.
#[test]
fn a_seed_is_scatter() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = table(folder.path(), "sweep.csv", 0.5);
    let csv = std::fs::read_to_string(&path).expect("a table");
    std::fs::write(&path, csv.replacen(",a,b,", ",a,seed,", 1)).expect("a table");
    let of = [runs("t", path)];
    let angle = [target("t:angle_of_repose.degrees=32.6..33.4")];
    for chance in [&[][..], &["seed".to_owned()]] {
        let found = meet_targets(&of, &angle, chance).expect("an answer");
        assert_eq!(found.factors.keys().collect::<Vec<_>>(), ["a"], "law: with {chance:?}");
    }
}

#[test]
fn shares_are_in_percent_and_tables_of_a_name_go_together() {
    let folder = tempfile::tempdir().expect("a folder");
    let paths = ["a.csv", "b.csv"].map(|name| table(folder.path(), name, 0.5));
    // The second of another configuration.
    let mut csv = std::fs::read_to_string(&paths[1]).expect("a table");
    for n in 0..25 {
        csv = csv.replace(&format!(",p{n},1,"), &format!(",p{n},2,"));
    }
    std::fs::write(&paths[1], csv).expect("a table");
    let tables = paths.map(|path| runs("t", path));
    let share = [target("t:settlement_mm.after_5_s/settlement_mm.final=75..85")];
    let found = meet_targets(&tables, &share, &[]).expect("an answer");
    assert_eq!(found.targets[0].runs_counted, 50, "law: two tables of 25 runs");
    assert!((found.targets[0].values[0] - 80.0).abs() < 1e-9, "law: 80 % in all runs");
    assert_eq!(found.targets[0].runs_meeting, 50, "law: all meet it");
}

/// Law: a run that stands in two sweeps of a name counts once, however its factors are written; one
/// with another result is another run.
#[test]
fn a_run_of_two_sweeps_counts_once() {
    let folder = tempfile::tempdir().expect("a folder");
    let sweep = |name: &str, decimals: usize, last: f64| {
        let path = folder.path().join(name);
        of_numbers(&path, "a,b,settlement_mm.final", |a, b| {
            let settled = if (a, b) == (4.0, 4.0) { last } else { 10.0 * a + b };
            format!("{a:.decimals$},{b},{settled}")
        });
        runs("t", path)
    };
    let wanted = [target("t:settlement_mm.final=20..22")];
    let of = |sweeps: &[TargetRuns]| {
        let found = meet_targets(sweeps, &wanted, &[]).expect("an answer").targets.remove(0);
        (found.runs_counted, found.runs_left_out, found.runs_meeting, found.share_meeting)
    };
    let (first, again) = (sweep("first.csv", 0, 44.0), sweep("again.csv", 1, 44.0));
    let once = of(std::slice::from_ref(&first));
    assert_eq!(
        (once.0, once.1, once.2),
        (25, 0, 3),
        "law: 25 runs, of which 20, 21 and 22 meet it"
    );
    assert_eq!(of(&[first.clone(), again]), once, "law: the same runs again say no more");
    let (counted, left_out, ..) = of(&[first, sweep("other.csv", 1, 44.5)]);
    assert_eq!((counted, left_out), (26, 0), "law: one run of the second is another");
}

/// Law: what a sweep of a laboratory has beside the fixed results can be a target, by the path of its
/// column or with brackets around the numbers of lists.
#[test]
fn results_of_a_laboratory_are_targets() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("sweep.csv");
    of_numbers(&path, "a,b,void_ratio,laboratory.openings.0.rate_g_per_s", |a, b| {
        format!("{a},{b},,{}", 100.0 + 10.0 * a + b)
    });
    for result in ["laboratory.openings.0.rate_g_per_s", "laboratory.openings[0].rate_g_per_s"] {
        let wanted = [target(&format!("h:{result}=99.5..114.5"))];
        let found = meet_targets(&[runs("h", path.clone())], &wanted, &[]).expect("an answer");
        let got = &found.targets[0];
        assert_eq!((got.runs_counted, got.runs_meeting), (25, 10), "law: those with a of 0 and 1");
        let (by, _) = got.effects["a"];
        assert!((by - 40.0).abs() < 1e-6, "law: 10 a over 0 to 4 is 40, got {by}");
    }
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
    let speeds = folder.path().join("speeds.csv");
    of_numbers(&speeds, "a,b,void_ratio,checks.speed.worst", |a, b| format!("{a},{b},,{}", a + b));
    for text in ["t:guards.speed.worst=1..2", "t:checks.speed.worst/guards.speed.worst=1..2"] {
        let old = meet_targets(&[runs("t", speeds.clone())], &[target(text)], &[]);
        let old = old.expect_err("law: refused").to_string();
        let words = "`guards.speed.worst` is now called `checks.speed.worst`";
        assert!(old.contains(words), "law: `{words}` is said of `{text}`, got `{old}`");
    }
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
    let few = folder.path().join("few.csv");
    let head = "run,point,configuration,a,void_ratio,left_out_of_means,failure\n";
    std::fs::write(&few, head.to_owned() + "r0,p0,1,1,5,,\nr1,p1,1,2,6,,\n").expect("a table");
    let refused = meet_targets(&[runs("t", few)], &[target("t:void_ratio=0..9")], &[]);
    let refused = refused.expect_err("law: refused").to_string();
    let words = "too few for a linear model of 1 factor, a (at least 4 are needed, at several";
    assert!(refused.contains(words), "law: `{words}` is said, got `{refused}`");
    let other = folder.path().join("other.csv");
    std::fs::write(&other, "x,y\n1,2\n").expect("a table");
    let refused =
        meet_targets(&[runs("t", other)], &[target("t:y=0..1")], &[]).expect_err("law: refused");
    assert!(refused.to_string().contains("no table of a sweep"), "{refused}");
}

/// Law: a sweep of the configuration alone has no column of a factor, and is one still.
#[test]
fn a_sweep_of_the_configuration_alone_is_read() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("sweep.csv");
    let mut csv = "run,point,configuration,void_ratio,left_out_of_means,failure\n".to_owned();
    for n in 1..=5_u32 {
        let _ = writeln!(csv, "p{n}-c1,p{n},{n},{},,", 0.7 + 0.01 * f64::from(n));
    }
    std::fs::write(&path, csv).expect("a table");
    let wanted = [target("t:void_ratio=0.725..0.745")];
    let chance = ["configuration".to_owned()];
    let found =
        meet_targets(&[runs("t", path)], &wanted, &chance).expect("law: a table of a sweep");
    let met = &found.targets[0];
    assert_eq!((met.runs_meeting, met.runs_counted), (2, 5), "law: 0.73 and 0.74 of five");
}

/// A table of 25 runs with one column a factor and a result, from the numbers 0 to 24.
fn of_numbers(path: &Path, head: &str, row: impl Fn(f64, f64) -> String) {
    let mut csv = format!("run,point,configuration,{head},left_out_of_means,failure\n");
    for n in 0..25_u32 {
        let _ = writeln!(csv, "r{n},p{n},1,{},,", row(f64::from(n % 5), f64::from(n / 5)));
    }
    std::fs::write(path, csv).expect("a table");
}

/// Law: with x = a + r and y = a − r of one specimen's r, both lie 0.5 to 1.5 beyond and below
/// a = 2 where r is 0.5 to 1.5, as probable as that of one; residuals that were independent would
/// give its square.
#[test]
fn residuals_of_one_point_go_together() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("sweep.csv");
    of_numbers(&path, "a,settlement_mm.final,void_ratio", |a, r| {
        format!("{a},{},{}", a + r - 2.0, a - r + 2.0)
    });
    let wanted = [target("t:settlement_mm.final=2.5..3.5"), target("t:void_ratio=0.5..1.5")];
    let found = meet_targets(&[runs("t", path)], &wanted, &[]).expect("an answer");
    let correlations = found.correlations.as_ref().expect("law: 25 points are enough");
    let got = correlations[0][1];
    assert!((got + 1.0).abs() < 1e-9, "law: one residual is the other's opposite, got {got}");
    let rows: Vec<(Vec<f64>, f64)> =
        (0..25_u32).map(|n| (vec![f64::from(n % 5)], f64::from(n / 5) - 2.0)).collect();
    let model = LinearModel::fit(&rows, &(0..25).collect::<Vec<_>>()).expect("a fit");
    let expected = model.between(&[2.0], [0.5, 1.5]);
    let got = found.all.best;
    assert!((got - expected).abs() < 0.02, "law: expected {expected}, got {got}, tolerance 0.02");
    assert!((found.all.at["a"] - 2.0).abs() < 0.1, "law: at a = 2, got {:?}", found.all.at);
    let alone = expected.powi(2);
    assert!(alone + 0.1 < expected, "law: the test tells it from {alone}, that of independence");
}

/// Law: every shaken run belongs to the pile of its a, whatever its b; a run of another
/// configuration, or of an a without a pile, to none.
#[test]
fn runs_of_two_sweeps_are_joined_by_the_factors_that_they_share() {
    let folder = tempfile::tempdir().expect("a folder");
    let shaken = folder.path().join("shaken.csv");
    of_numbers(&shaken, "a,b,settlement_mm.final", |a, b| format!("{a},{b},{}", 10.0 * a + b));
    let mut csv =
        "run,point,configuration,a,angle_of_repose.degrees,left_out_of_means,failure\n".to_owned();
    for a in 0..4_u32 {
        let _ = writeln!(csv, "r,p,1,{a}.0,{},,", 30 + a);
    }
    csv += "r,p,2,4.0,34,,\n";
    let piles = folder.path().join("piles.csv");
    std::fs::write(&piles, csv).expect("a table");
    let wanted =
        [target("pile:angle_of_repose.degrees=31.5..32.5"), target("t:settlement_mm.final=20..22")];
    let found = meet_targets(&[runs("pile", piles), runs("t", shaken)], &wanted, &[]);
    let found = found.expect("an answer");
    let points = found.all.points.expect("law: they are joined");
    assert_eq!((points.met, points.of), (3, 20), "law: a = 2 and b of 0, 1 and 2, of 4 × 5");
    let at: Vec<(f64, f64)> = found.met_at.iter().map(|m| (m.at["a"], m.at["b"])).collect();
    assert_eq!(at, [(2.0, 0.0), (2.0, 1.0), (2.0, 2.0)]);
    assert_eq!(found.met_at[2].values, [32.0, 22.0], "law: angle and settlement, in their order");
    let page = found.page().markdown();
    assert_eq!(points.independent, 4, "law: five shaken runs share a pile");
    assert!(page.contains("Points that meet all targets: 3 of 20 (1.8 % to 62 %)"), "{page}");
    assert!(page.contains("Where all are met"), "{page}");
}

/// Law: a field is one factor, however its path is spelt: in two sweeps, by `--chance`, not twice in
/// a table.
#[test]
fn a_field_of_two_spellings_is_one_factor() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = |name: &str| folder.path().join(name);
    let head = |field: &str, result: &str| format!("{field},b,{result}");
    let (shaken, piles) = (path("shaken.csv"), path("piles.csv"));
    of_numbers(&shaken, &head("stages[1].x", "settlement_mm.final"), |a, b| {
        format!("{a},{b},{}", 10.0 * a + b)
    });
    of_numbers(&piles, &head("stages.1.x", "angle_of_repose.degrees"), |a, b| {
        format!("{a},{b},{}", 30.0 + a + b)
    });
    let wanted =
        [target("t:settlement_mm.final=20..22"), target("pile:angle_of_repose.degrees=31..33")];
    let both = [runs("t", shaken.clone()), runs("pile", piles)];
    let found = meet_targets(&both, &wanted, &[]).expect("an answer");
    let factors: Vec<&String> = found.factors.keys().collect();
    assert_eq!(factors, ["b", "stages[1].x"], "law: the first spelling, once");
    let points = found.all.points.expect("law: they are joined");
    assert_eq!(points.of, 25, "law: each point of one is a point of the other");
    let by_chance = meet_targets(&both, &wanted, &["stages.01.x".to_owned()]);
    let by_chance = by_chance.expect("law: a factor of the tables");
    assert_eq!(by_chance.factors.keys().collect::<Vec<_>>(), ["b"], "law: x is chance");
    let twice = path("twice.csv");
    of_numbers(&twice, "stages[1].x,stages.1.x,settlement_mm.final", |a, b| format!("{a},{b},1"));
    let refused = meet_targets(&[runs("t", twice)], &wanted[..1], &[]).expect_err("law: refused");
    let said = refused.to_string();
    assert!(said.contains("`stages[1].x` twice, as `stages.1.x`"), "law: got `{said}`");
}

/// Law: a field that has one value in one sweep and another in a second of the same name is a factor;
/// where a third does not say what its runs had, it is refused.
#[test]
fn a_field_that_differs_between_sweeps_of_a_name_is_a_factor() {
    let folder = tempfile::tempdir().expect("a folder");
    let sweep = |x: f64| {
        let path = folder.path().join(format!("x-{x}.csv"));
        of_numbers(&path, "x,b,settlement_mm.final", |a, b| {
            format!("{x},{b},{}", 10.0 * x + b + 0.1 * a)
        });
        runs("t", path)
    };
    let wanted = [target("t:settlement_mm.final=12..14")];
    let found = meet_targets(&[sweep(1.0), sweep(3.0)], &wanted, &[]).expect("an answer");
    assert_eq!(found.factors.keys().collect::<Vec<_>>(), ["b", "x"], "law: x varies, too");
    let (by, _) = found.targets[0].effects["x"];
    assert!((by - 20.0).abs() < 1e-6, "law: 10 x over 1 to 3 is 20, got {by}");
    let silent = folder.path().join("silent.csv");
    of_numbers(&silent, "b,settlement_mm.final", |a, b| format!("{b},{}", b + 0.1 * a));
    let all = [sweep(1.0), sweep(3.0), runs("t", silent)];
    let refused = meet_targets(&all, &wanted, &[]).expect_err("law: refused").to_string();
    assert!(refused.contains("--runs t: `x` varies, but is no column"), "law: got `{refused}`");
}

/// Law: a result has one target: two of it would have equal residuals, and exclude each other.
#[test]
fn a_target_is_given_once() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("sweep.csv");
    of_numbers(&path, "a,b,settlement_mm.final", |a, b| format!("{a},{b},{}", 10.0 * a + b));
    for second in ["t:settlement_mm.final=20..22", "t:settlement_mm.final=21..30"] {
        let wanted = [target("t:settlement_mm.final=20..22"), target(second)];
        let said = meet_targets(&[runs("t", path.clone())], &wanted, &[]);
        let said = said.expect_err("law: refused").to_string();
        let expected = "--target t:settlement_mm.final: it is given twice";
        assert!(said.contains(expected), "law: expected `{expected}`, got `{said}`");
    }
}

/// Law: a result that is no number, as with a decimal comma, is refused where a target asks for it:
/// its run would be missing in the count.
#[test]
fn a_result_that_is_no_number_is_refused() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("sweep.csv");
    of_numbers(&path, "a,b,settlement_mm.final,void_ratio", |a, b| {
        let settled = 10.0 * a + b;
        let cell = if settled == 31.0 { "\"31,5\"".to_owned() } else { settled.to_string() };
        format!("{a},{b},{cell},{}", 0.6 + 0.01 * a)
    });
    let of = |text: &str| meet_targets(&[runs("t", path.clone())], &[target(text)], &[]);
    let refused = of("t:settlement_mm.final=20..22").expect_err("law: refused").to_string();
    for words in
        ["sweep.csv: `settlement_mm.final` is no number in 1 of the runs", "`31,5` in run 9"]
    {
        assert!(refused.contains(words), "law: {words}, got `{refused}`");
    }
    let found = of("t:void_ratio=0.6..0.8").expect("law: no target asks for the settlement");
    assert_eq!(found.targets[0].runs_counted, 25);
}
