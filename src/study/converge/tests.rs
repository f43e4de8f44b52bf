//! Deviations, verdicts and the choice of the cheapest setting, on canned rows.

use super::{
    BUILT_IN, StudyOptions, converge,
    design::{ConvergenceLimits, Designed, Ladder},
    judge::{cheapest, judge},
};
use crate::record::RunRow;
use crate::report::{ConvergenceRow, Standard};
use crate::scale::Scale;
use crate::study::{presets::with_design, tests::bare_scenario};

const LIMITS: ConvergenceLimits =
    ConvergenceLimits { height_percent: 1.0, settlement_percent: 5.0 };

fn standard() -> Standard {
    crate::study::standard(&Scale::PAPER)
}

/// A good run: overlap and numerical creep within the standard.
fn run(variation: &str, configuration: u32, height: f64, cost: f64) -> RunRow {
    RunRow {
        configuration,
        precision: "double".into(),
        poured_height_mm: Some(height),
        plate_settlement_mm: Some(10.0),
        surface_settlement_mm: Some(8.0),
        overlap_mean_percent: Some(0.2),
        overlap_p99_percent: Some(1.0),
        creep_um_per_s: Some(-1.0),
        meets_standard: Some(true),
        valid: Some(true),
        wall_s_per_simulated_s: Some(cost),
        // Variations are different scenarios.
        experiment: variation.to_owned(),
        ..RunRow::of_scenario("run", variation, "group", &bare_scenario())
    }
}

/// Three configurations that differ from each other by 2 mm.
fn three(variation: &str, height: f64, cost: f64) -> Vec<RunRow> {
    (1..=3).map(|c| run(variation, c, height + 2.0 * f64::from(c), cost)).collect()
}

fn ladder(title: &str, names: &[&str]) -> Ladder {
    let rungs = names.iter().map(|n| ((*n).to_owned(), (*n).to_owned())).collect();
    Ladder { title: title.to_owned(), rungs }
}

fn judged(runs: &[RunRow], ladders: &[Ladder]) -> Vec<ConvergenceRow> {
    judge(runs, ladders, &ladders[0].title, LIMITS, &standard())
}

fn height_percent(row: &ConvergenceRow) -> f64 {
    row.from_ladder.height.percent.expect("a deviation").mean
}

#[test]
fn deviations_are_from_the_finest_rung_and_have_its_sign() {
    // The finest: 162, 164, 166 mm, in the mean 164.
    let runs =
        [three("low", 156.72, 1.0), three("high", 163.28, 2.0), three("fine", 160.0, 4.0)].concat();
    let rows = judged(&runs, &[ladder("rate", &["low", "high", "fine"])]);
    let [low, high, fine] = &rows[..] else { panic!("three rungs: {rows:?}") };
    for (row, expected, within) in [(low, -2.0, false), (high, 2.0, false), (fine, 0.0, true)] {
        let got = height_percent(row);
        assert!(
            (got - expected).abs() < 1e-9,
            "law: (mean - reference)/reference in %, expected {expected}, got {got} for {}",
            row.rung
        );
        let d = row.from_ladder.height;
        assert_eq!(d.within, Some(within), "law: within 1 %: {d:?}");
        // All three differ alike: pairs have no scatter.
        assert_eq!(d.open, Some(false), "law: nothing is open without scatter: {d:?}");
        assert_eq!(row.meets, Some(within), "law: the height decides here");
    }
    assert!(fine.finest_of_ladder && fine.finest_of_study && !low.finest_of_ladder);
    let error = low.error_over_limit.expect("all is known");
    assert!((error - 2.0).abs() < 1e-9, "law: 2 % over a limit of 1 %, got {error}");
}

#[test]
fn a_deviation_inside_the_scatter_is_said_to_be_so() {
    let mut noisy = three("noisy", 160.0, 1.0);
    for (row, off) in noisy.iter_mut().zip([3.0, -3.0, 6.0]) {
        row.poured_height_mm = row.poured_height_mm.map(|h| h + off);
    }
    let runs = [noisy, three("fine", 160.0, 4.0)].concat();
    let rows = judged(&runs, &[ladder("rate", &["noisy", "fine"])]);
    let d = rows[0].from_ladder.height;
    assert_eq!(
        (d.within, d.inside_scatter, d.open),
        (Some(false), Some(true), Some(true)),
        "law: 2 ± 2.6 mm of 164 is beyond 1 %, cannot be told from zero, and is open: {d:?}"
    );
    assert_eq!(d.may_pass(), Some(true), "law: it may pass for all that is known");
    let found = cheapest(&rows, &standard());
    assert_eq!(found.not_shown_to_miss, Some(0), "law: what is open is not shown to miss");
    assert_eq!(found.meeting, Some(1), "law: by its mean it misses");
}

#[test]
fn the_cheapest_that_passes_is_chosen() {
    let of = |coarse: f64, costs: [f64; 3]| {
        let runs = [
            three("coarse", coarse, costs[0]),
            three("middle", 160.5, costs[1]),
            three("fine", 160.0, costs[2]),
        ]
        .concat();
        let rows = judged(&runs, &[ladder("rate", &["coarse", "middle", "fine"])]);
        let found = cheapest(&rows, &standard());
        assert_eq!(found.meeting, found.surely_meeting, "law: no scatter, no doubt");
        found.meeting.map(|i| rows[i].rung.clone())
    };
    assert_eq!(of(160.2, [1.0, 2.0, 4.0]).as_deref(), Some("coarse"), "all pass");
    assert_eq!(of(150.0, [1.0, 2.0, 4.0]).as_deref(), Some("middle"), "the coarse one misses");
    assert_eq!(of(150.0, [1.0, 5.0, 4.0]).as_deref(), Some("fine"), "cost decides, not order");
}

#[test]
fn overlap_creep_and_failure_each_spoil_a_setting() {
    type Spoilt = (&'static str, fn(&mut RunRow), bool);
    let spoil: [Spoilt; 7] = [
        ("nothing", |_| {}, true),
        ("overlap", |r| r.overlap_mean_percent = Some(0.6), false),
        ("p99", |r| r.overlap_p99_percent = Some(3.1), false),
        ("sinking", |r| r.creep_um_per_s = Some(6.0), false),
        ("rising", |r| r.creep_um_per_s = Some(-6.0), false),
        ("plate", |r| r.plate_settlement_mm = Some(10.6), false),
        ("surface", |r| r.surface_settlement_mm = Some(7.5), false),
    ];
    for (what, change, expected) in spoil {
        let mut coarse = three("coarse", 160.0, 1.0);
        coarse.iter_mut().for_each(change);
        let runs = [coarse, three("fine", 160.0, 4.0)].concat();
        let rows = judged(&runs, &[ladder("rate", &["coarse", "fine"])]);
        assert_eq!(rows[0].meets, Some(expected), "law: {what} spoils it: {:?}", rows[0]);
        let beyond = rows[0].error_over_limit.expect("known") > 1.0;
        assert_eq!(beyond, !expected, "law: the error is over its limit for {what}");
    }
    let mut coarse = three("coarse", 160.0, 1.0);
    coarse[2] =
        RunRow { failure: Some("it blew up".into()), poured_height_mm: None, ..coarse[2].clone() };
    let runs = [coarse, three("fine", 160.0, 4.0)].concat();
    let rows = judged(&runs, &[ladder("rate", &["coarse", "fine"])]);
    assert_eq!(rows[0].meets, Some(false), "law: a setting that fails once does not pass");
    assert_eq!(rows[0].from_ladder.height.percent.map(|p| p.count), Some(2), "pairs that ran");
    assert_eq!(cheapest(&rows, &standard()).meeting, Some(1));
}

#[test]
fn what_is_not_known_is_no_pass() {
    let mut coarse = three("coarse", 160.0, 1.0);
    for row in &mut coarse {
        (row.creep_um_per_s, row.meets_standard, row.valid) = (None, Some(false), Some(false));
    }
    let runs = [coarse, three("fine", 160.0, 4.0)].concat();
    let rows = judged(&runs, &[ladder("rate", &["coarse", "fine"])]);
    assert_eq!((rows[0].meets, rows[0].error_over_limit), (None, None));
    let one = [run("coarse", 1, 160.0, 1.0), run("fine", 1, 160.0, 4.0)];
    let rows = judged(&one, &[ladder("rate", &["coarse", "fine"])]);
    let d = rows[0].from_ladder.height;
    assert_eq!((d.within, d.inside_scatter, d.open), (Some(true), None, None), "{d:?}");
    let found = cheapest(&rows, &standard());
    assert_eq!((found.meeting, found.surely_meeting), (Some(0), None), "law: one run proves none");
}

/// Law: a setting is open where the interval of its overlap or numerical creep contains the limit,
/// whichever side the mean is on.
#[test]
fn the_scatter_of_overlap_and_creep_leaves_settings_open() {
    type Spread = (&'static str, fn(&mut RunRow, f64), [f64; 3], bool, bool);
    fn p99(row: &mut RunRow, value: f64) {
        row.overlap_p99_percent = Some(value);
    }
    fn mean(row: &mut RunRow, value: f64) {
        row.overlap_mean_percent = Some(value);
    }
    fn creep(row: &mut RunRow, value: f64) {
        row.creep_um_per_s = Some(value);
    }
    let cases: [Spread; 6] = [
        ("2.97 ± 8.5 % of 3", p99, [1.0, 1.0, 6.9], true, true),
        ("1 ± 0.2 % of 3", p99, [0.9, 1.0, 1.1], true, false),
        ("3.05 ± 0.5 % of 3", p99, [2.85, 3.05, 3.25], false, true),
        ("4 ± 0.2 % of 3", p99, [3.9, 4.0, 4.1], false, false),
        ("0.48 ± 0.05 % of 0.5", mean, [0.46, 0.48, 0.5], true, true),
        ("5.1 ± 1.2 µm/s of 5", creep, [4.6, -5.1, 5.6], false, true),
    ];
    for (what, change, values, meets, open) in cases {
        let mut coarse = three("coarse", 160.0, 1.0);
        coarse.iter_mut().zip(values).for_each(|(row, value)| change(row, value));
        let runs = [coarse, three("fine", 160.0, 4.0)].concat();
        let rows = judged(&runs, &[ladder("rate", &["coarse", "fine"])]);
        assert_eq!((rows[0].meets, rows[0].open), (Some(meets), Some(open)), "law: {what}");
        let found = cheapest(&rows, &standard());
        let first_if = |is: bool| Some(usize::from(!is));
        assert_eq!(found.meeting, first_if(meets), "law: by its means, {what}");
        assert_eq!(found.surely_meeting, first_if(meets && !open), "law: no doubt, {what}");
        assert_eq!(found.not_shown_to_miss, first_if(meets || open), "law: may meet, {what}");
    }
}

/// Law: what is not valid is left out of heights and deviations, and a setting does not pass by it.
#[test]
fn a_setting_does_not_pass_by_leaving_its_bad_runs_out() {
    let of = |change: &dyn Fn(&mut RunRow)| {
        let mut coarse = three("coarse", 160.0, 1.0);
        change(&mut coarse[2]);
        let runs = [coarse, three("fine", 160.0, 4.0)].concat();
        judged(&runs, &[ladder("rate", &["coarse", "fine"])]).remove(0)
    };
    let told = |row: &ConvergenceRow| {
        (row.meets, row.result.left_out, row.from_ladder.height.percent.map(|p| (p.mean, p.count)))
    };
    let good = of(&|_| {});
    assert_eq!(told(&good), (Some(true), 0, Some((0.0, 3))), "law: nothing is left out");
    // Its height is far off, which nobody sees any more.
    let not_valid = |r: &mut RunRow| {
        (r.valid, r.poured_height_mm) = (Some(false), Some(100.0));
    };
    let check = of(&|r| not_valid(r));
    assert_eq!(told(&check), (Some(false), 1, Some((0.0, 2))), "law: a run-time check spoils it");
    let overlap = of(&|r| {
        not_valid(r);
        (r.meets_standard, r.overlap_mean_percent) = (Some(false), Some(9.0));
    });
    assert_eq!(told(&overlap), (Some(false), 1, Some((0.0, 2))), "law: overlap is of all runs");
    assert!(overlap.error_over_limit.is_some_and(|e| e > 6.0), "law: 3.1 % of 0.5: {overlap:?}");
    let jammed = of(&|r| {
        (r.left_out_of_means, r.poured_height_mm) = (Some("a jam".into()), Some(100.0));
    });
    assert_eq!(told(&jammed), (Some(true), 1, Some((0.0, 2))), "law: a jam is chance");
    // All of a rung's runs left out: no deviation, and a miss where one is known.
    let mut coarse = three("coarse", 160.0, 1.0);
    for row in &mut coarse {
        not_valid(row);
        (row.meets_standard, row.overlap_mean_percent) = (Some(false), Some(1.0));
    }
    let runs = [coarse, three("fine", 160.0, 4.0)].concat();
    let rows = judged(&runs, &[ladder("rate", &["coarse", "fine"])]);
    assert_eq!(told(&rows[0]), (Some(false), 3, None), "law: nothing is made of nothing");
    assert_eq!(rows[0].error_over_limit, Some(2.0), "law: by its overlap it misses twice");
    assert!(rows[0].result.has_no_valid_run());
    let found = cheapest(&rows, &standard());
    assert_eq!(
        (found.meeting, found.not_shown_to_miss),
        (Some(1), Some(1)),
        "law: the finest alone"
    );
}

/// Law: what a run-time check found in one run spoils its setting, whether that run meets the
/// accuracy standard or not, and whatever other runs there are.
#[test]
fn a_failed_check_spoils_a_setting_beside_any_other_run() {
    let passes = |change: &dyn Fn(&mut [RunRow])| {
        let mut coarse = three("coarse", 160.0, 1.0);
        change(&mut coarse);
        let runs = [coarse, three("fine", 160.0, 4.0)].concat();
        let rows = judged(&runs, &[ladder("rate", &["coarse", "fine"])]);
        (rows[0].meets, cheapest(&rows, &standard()).not_shown_to_miss == Some(0))
    };
    // Grains that ran out are valid without an overlap at the end.
    let ran_out = |row: &mut RunRow| (row.meets_standard, row.valid) = (Some(false), Some(true));
    let above = |row: &mut RunRow, finding: bool| {
        (row.meets_standard, row.overlap_mean_percent) = (Some(false), Some(0.6));
        (row.valid, row.finding_beside_standard) = (Some(false), Some(finding));
    };
    let alone = passes(&|rows| ran_out(&mut rows[1]));
    assert_eq!(alone, (Some(true), true), "law: what is valid spoils nothing");
    let hidden = passes(&|rows| {
        ran_out(&mut rows[1]);
        rows[2].valid = Some(false);
    });
    assert_eq!(hidden, (Some(false), false), "law: a valid run does not make up for another");
    let by_chance = passes(&|rows| above(&mut rows[2], false));
    assert_eq!(by_chance, (Some(true), true), "law: overlap is judged by its mean");
    let found = passes(&|rows| above(&mut rows[2], true));
    assert_eq!(found, (Some(false), false), "law: a finding spoils it, above the standard, too");
}

#[test]
fn settings_are_held_against_the_study_too() {
    // A ladder of its own that is converged, at another height.
    let runs =
        [three("fine", 160.0, 4.0), three("own-coarse", 170.0, 1.0), three("own-fine", 170.0, 2.0)]
            .concat();
    let ladders = [ladder("rate", &["fine"]), ladder("bullet", &["own-coarse", "own-fine"])];
    let rows = judged(&runs, &ladders);
    let own = rows.iter().find(|r| r.rung == "own-coarse").expect("a row");
    assert_eq!(own.from_ladder.height.within, Some(true), "law: its own ladder is converged");
    assert_eq!(own.from_study.height.within, Some(false), "law: the study says otherwise");
    assert_eq!(own.meets, Some(false));
}

#[test]
fn a_setting_must_pass_in_every_ladder_that_has_it() {
    let same = |rows: Vec<RunRow>, experiment: &str| -> Vec<RunRow> {
        rows.into_iter().map(|r| RunRow { experiment: experiment.into(), ..r }).collect()
    };
    let of = |stiff: f64| {
        let runs = [
            same(three("rate-480", 160.5, 1.0), "default"),
            three("rate-1920", 160.0, 4.0),
            same(three("stiffness-5", 160.5, 1.0), "default"),
            three("stiffness-20", stiff, 2.0),
        ]
        .concat();
        let ladders = [
            ladder("rate", &["rate-480", "rate-1920"]),
            ladder("stiffness", &["stiffness-5", "stiffness-20"]),
        ];
        let rows = judged(&runs, &ladders);
        assert_eq!(rows[0].meets, rows[2].meets, "law: one setting, one verdict");
        (rows[0].meets, cheapest(&rows, &standard()))
    };
    let (meets, found) = of(160.0);
    assert_eq!((meets, found.meeting), (Some(true), Some(0)), "it passes in both");
    let (meets, found) = of(170.0);
    assert_eq!(meets, Some(false), "law: what misses in one ladder misses");
    assert_eq!((found.meeting, found.not_shown_to_miss), (Some(1), Some(1)));
}

#[test]
fn single_precision_is_held_against_double() {
    let single = |rows: Vec<RunRow>| -> Vec<RunRow> {
        rows.into_iter().map(|r| RunRow { precision: "single".into(), ..r }).collect()
    };
    let ladders = [ladder("rate", &["coarse", "fine"])];
    let both = [
        three("coarse", 160.0, 1.0),
        three("fine", 160.0, 4.0),
        single(three("coarse", 150.0, 0.5)),
        single(three("fine", 150.0, 2.0)),
    ]
    .concat();
    let rows = judged(&both, &ladders);
    assert_eq!(rows.len(), 4, "law: one row a rung and precision");
    let single_fine =
        rows.iter().find(|r| r.rung == "fine" && r.result.precision == "single").expect("a row");
    assert!(!single_fine.finest_of_ladder, "law: the reference is in double precision");
    assert!((height_percent(single_fine) + 100.0 * 10.0 / 164.0).abs() < 1e-9);
    // Alone it is compared with itself.
    let alone = judged(&both[6..], &ladders);
    assert_eq!(height_percent(&alone[0]), 0.0);
    assert!(alone[1].finest_of_ladder);
}

/// Law: of specimens that no run pours, as those that a study begins with, no height after pouring is
/// asked for: settings are judged by what they have. Without a run that counts nothing is shown.
#[test]
fn heights_are_not_asked_of_runs_that_pour_nothing() {
    let ladders = [ladder("rate", &["coarse", "fine"])];
    let mut runs = [three("coarse", 160.0, 1.0), three("fine", 160.0, 4.0)].concat();
    for run in &mut runs {
        run.poured_height_mm = None;
    }
    let meets = |runs: &[RunRow]| {
        judged(runs, &ladders).iter().map(|row| row.meets).collect::<Vec<Option<bool>>>()
    };
    assert_eq!(meets(&runs), [Some(true); 2], "law: by settlements, overlap and numerical creep");
    for run in &mut runs {
        (run.plate_settlement_mm, run.surface_settlement_mm) = (None, None);
    }
    assert_eq!(meets(&runs), [Some(true); 2], "law: by overlap and numerical creep");
    for run in &mut runs[..3] {
        run.left_out_of_means = Some("a jam".into());
    }
    assert_eq!(meets(&runs), [None, Some(true)], "law: nothing is shown by what is left out");
}

/// Law: ladders differ by their titles on the page, their runs by both names together.
#[test]
fn ladders_and_runs_are_told_apart() {
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("design.json");
    let faults = |ladders: serde_json::Value| -> Vec<(String, String)> {
        let design = serde_json::json!({
            "full": { "scenario": "none.json", "configurations": 2 },
            "limits": { "height_percent": 1, "settlement_percent": 5 },
            "reference": "a", "ladders": ladders
        });
        std::fs::write(&file, design.to_string()).expect("a design");
        let errors = Designed::of_file(&file, false).expect_err("law: no scenario is there");
        let found = errors.faults().iter();
        found.map(|fault| (fault.path.clone(), fault.message.clone())).collect()
    };
    let ladder = |name: &str, title: &str, rungs: [&str; 2]| {
        let rungs = rungs.map(|name| serde_json::json!({ "name": name, "title": name }));
        serde_json::json!({ "name": name, "title": title, "rungs": rungs })
    };
    let one = ladder("a", "One", ["b-c", "d"]);
    let told = |path: &str, said: &str| (path.to_owned(), said.to_owned());
    let found = faults(serde_json::json!([one, ladder("a-b", "Two", ["c", "d"])]));
    assert_eq!(found, [told("ladders[1].rungs[0].name", "two runs have one name")], "law: a-b-c");
    let found = faults(serde_json::json!([one, ladder("b", "One", ["b-c", "d"])]));
    assert_eq!(found, [told("ladders[1].title", "the title is given twice")]);
    let found = faults(serde_json::json!([one, ladder("a", "Two", ["b-c", "d"])]));
    assert_eq!(found, [told("ladders[1].name", "the name is given twice")], "law: no more");
}

/// Law: rungs that differ in their configuration alone share no realisation, as parameters of
/// `pluvia sensitivity` do not.
#[test]
fn rungs_share_no_realisation() {
    let folder = tempfile::tempdir().expect("a folder");
    let write = |name: &str, value: serde_json::Value| {
        let file = folder.path().join(name);
        std::fs::write(&file, value.to_string()).expect("a file");
        file
    };
    let scenario = serde_json::json!({
        "name": "small",
        "grains": { "total_mass_g": 20, "density_kg_per_m3": 2650, "sieve_table":
            [{ "passing_mm": 10, "retained_mm": 8, "mass_percent": 100 }] },
        "stages": [{ "stage": "fill_funnel" }, { "stage": "pour", "falling_height_mm": 0 }]
    });
    write("small.json", scenario);
    let said = |configuration: u32| {
        let changes = [format!("configuration={configuration}")];
        let design = serde_json::json!({
            "full": { "scenario": "small.json", "configurations": 3 },
            "limits": { "height_percent": 1, "settlement_percent": 5 },
            "reference": "a",
            "ladders": [{ "name": "a", "title": "One", "rungs": [
                { "name": "b", "title": "first" },
                { "name": "c", "title": "second", "changes": changes }
            ] }]
        });
        let design = Some(write("design.json", design));
        let study = converge(&StudyOptions { design, quick: false, configurations: None });
        study.err().map_or(String::new(), |error| error.to_string())
    };
    for words in ["--configurations 3 cannot be taken", "`a-c`", "`a-b`", "at least 3 apart"] {
        assert!(said(3).contains(words), "law: `{words}` is said, got `{}`", said(3));
    }
    assert_eq!(said(4), "", "law: 1 to 3 and 4 to 6 share none");
}

#[test]
fn the_built_in_design_is_sound() {
    for quick in [false, true] {
        let design = with_design(None, BUILT_IN, |file| Designed::of_file(file, quick));
        let design = design.unwrap_or_else(|e| panic!("quick {quick}: {e}"));
        assert!(design.configurations >= 2, "one configuration tells nothing of scatter");
        let names = || design.varied.all.iter().map(|(v, _)| v.name.as_str());
        assert!(
            names().any(|n| n == "rate-1920"),
            "the ladder of rates: {:?}",
            names().collect::<Vec<_>>()
        );
        assert!(names().any(|n| n == "stock-960x20"), "Bullet's contacts");
        assert_eq!(names().any(|n| n == "stock-960x50"), !quick, "the costliest only in full");
    }
}
