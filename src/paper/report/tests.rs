//! Reports of made-up studies of the paper's programme.

use std::{collections::BTreeMap, fs, path::Path};

use serde_json::json;

use super::{
    choices::tests::{VIBRATED, scenario},
    *,
};
use crate::{
    paper::{canned, claims, scorecard},
    record::RunRecord,
    report::figures::of_run,
};

pub(super) const STANDARD: Standard =
    Standard { overlap_mean_percent: 0.5, overlap_p99_percent: 3.0, creep_um_per_s: 5.0 };

/// Hands the report's input of a study to a function.
fn with_input<T>(
    study: StudyView,
    choices: &[Choice],
    use_it: impl FnOnce(&ReportInput) -> T,
) -> T {
    let claims = claims(&study);
    let scorecard = scorecard(&study, &claims);
    let provenance: BTreeMap<String, String> =
        [("pluvia", "0.1.0"), ("command", "pluvia reproduce --set a=<b>&c")]
            .map(|(k, v)| (k.to_owned(), v.to_owned()))
            .into();
    let effective = EffectiveSettings::from([("rate_hz".to_owned(), json!(480.0))]);
    use_it(&ReportInput {
        study,
        claims: &claims,
        scorecard: &scorecard,
        beside: &[],
        choices,
        changes: &[],
        standard: STANDARD,
        provenance: &provenance,
        effective: &effective,
        piles: &[],
        pictures: &[],
        warnings: &["<script>alert(1)</script>".to_owned()],
    })
}

fn write_report(out: &Path, study: StudyView, choices: &[Choice]) -> String {
    with_input(study, choices, |input| write(out, input)).expect("a report");
    fs::read_to_string(out.join("report.html")).expect("the page")
}

/// The page with plain spaces, and its figures, without files.
fn make_report(study: StudyView, choices: &[Choice]) -> (String, Vec<Figure>) {
    with_input(study, choices, |input| {
        let headline = figures::headline(&input.study, input.beside).expect("a figure");
        let figures = figures::of_study(&input.study, &input.standard).expect("figures");
        let page = page::page(input, headline.clone(), figures.clone());
        (page.html().replace('\u{a0}', " "), [vec![headline], figures].concat())
    })
}

#[track_caller]
fn assert_says(page: &str, all: &[&str]) {
    for said in all {
        assert!(page.contains(said), "law: the page says `{said}`");
    }
}

fn a_choice() -> Vec<Choice> {
    choices(&scenario(VIBRATED))
}

#[test]
fn a_whole_study_is_shown_whole() {
    let out = tempfile::tempdir().expect("a folder");
    let runs = canned::runs();
    let page = write_report(out.path(), canned::study(&runs), &a_choice());
    for stem in [
        "settlement",
        "figure-01-grain-size-distribution",
        "figure-07-standing-height",
        "figure-09-continuous-vibration",
        "figure-10-intermittent-vibration",
        "quality-creep",
        "quality-overlap",
    ] {
        for extension in ["svg", "png", "csv"] {
            let path = out.path().join(format!("figures/{stem}.{extension}"));
            let size = fs::metadata(&path).map(|m| m.len()).unwrap_or(0);
            assert!(
                size > 100,
                "{}: expected a file with content, got {size} bytes",
                path.display()
            );
        }
        assert!(page.contains(&format!("id=\"{stem}\"")), "{stem} is not on the page");
    }
    for run in &runs {
        assert!(page.contains(&run.name), "{} is not on the page", run.name);
    }
    let page = page.replace('\u{a0}', " ");
    // Configuration 3 creeps numerically by 45 µm/s: 1.035 mm of 20 mm in the 23 s of four periods.
    let all = [
        "6 of 18 runs have numerical creep",
        "45.0 µm/s",
        "at most 1.035 mm of 20.00 mm, 5.1",
        "in vibration-intermittent-c3 (that",
        "What falls short",
        "not_stated",
    ];
    assert_says(&page, &all);
}

/// Law: numerical creep that lifts a specimen is a share of its settlement as one that lowers it;
/// a plate that did not settle has no share.
#[test]
fn creep_upwards_is_no_negative_share_of_a_settlement() {
    let mut runs = canned::runs();
    for run in &mut runs {
        run.summary.creep_um_per_s = run.summary.creep_um_per_s.map(|creep| -creep);
    }
    let plate = runs[4].summary.settlement_mm.as_mut();
    plate.expect("a vibrated run").final_mm = 0.0;
    let (page, _) = make_report(canned::study(&runs), &[]);
    assert_says(
        &page,
        &["at most 1.035 mm of 20.00 mm, 5.1", "in vibration-intermittent-c3 (that"],
    );
}

/// Law: the page says of each run whether it is valid, and its numbers are of those that are.
#[test]
fn the_page_says_which_runs_do_not_count() {
    let runs = canned::runs();
    let (page, _) = make_report(canned::study(&runs), &[]);
    let all = [
        "6 of 18 runs with a result are left out of means",
        "✗ not valid",
        "✓ valid",
        "– not comparable: 3",
        "no valid run",
        "the accuracy standard is not met",
        "settlement of the plate after 20 s of vibration (17.0 mm [4.3 … 29.7]; the paper's 14 to 19.61 mm)",
        "2 of 2 configurations",
        "(left out: 1)",
        "Left out: vibration-continuous-c3.",
    ];
    assert_says(&page, &all);
    let valid = canned::valid_runs();
    let (page, _) = make_report(canned::study(&valid), &[]);
    let all = [
        "All 18 runs are valid and count in means",
        "? not decided",
        "7 rows: 4 within, 1 outside, 1 not decided, 1 not stated.",
        "settlement of the plate after 20 s of vibration (18.0 mm [13.0 … 23.0]; the paper's 14 to 19.61 mm)",
        "3 of 3 configurations",
        "– not comparable: 0",
    ];
    assert_says(&page, &all);
    for unsaid in ["✗ not valid", "left out of means", "no valid run", "Left out"] {
        assert!(!page.contains(unsaid), "law: nothing is left out, but there is `{unsaid}`");
    }
}

/// Law: the page opens with what is reproduced, then the scorecard, then one figure; the other figures
/// and the table of every statement follow.
#[test]
fn the_page_opens_with_what_a_reader_asks_first() {
    let runs = canned::valid_runs();
    let (page, _) = make_report(canned::study(&runs), &[]);
    let place = |what: &str| page.find(what).unwrap_or_else(|| panic!("no `{what}` on the page"));
    let order = [
        "class=\"lead\">Reproduced",
        "class=\"claims cards scorecard\"",
        "<figure id=\"settlement\"",
        "<nav",
        "<figure id=\"figure-01",
        "section id=\"claims\"",
        "section id=\"runs\"",
    ];
    let places = order.map(place);
    assert!(places.is_sorted(), "law: in this order: {order:?}, got {places:?}");
    let before = &page[..places[3]];
    assert_eq!(before.matches("<figure").count(), 1, "law: one figure in the head");
    let results = place("Results</th>");
    assert!(results < place("Inputs, and what follows"), "law: results before inputs");
}

/// Law: the page of a changed programme says so above what it found, each change as it was typed.
#[test]
fn the_page_says_what_is_changed() {
    let runs = canned::valid_runs();
    let html = |changes: &[String]| {
        with_input(canned::study(&runs), &[], |input| {
            let input = ReportInput { changes, ..input.clone() };
            let headline = figures::headline(&input.study, input.beside).expect("a figure");
            page::page(&input, headline, Vec::new()).html()
        })
    };
    let changed = html(&["grains.total_mass_g=60".to_owned(), "seed=<5>".to_owned()]);
    let said = "Changed in all of its scenarios: grains.total_mass_g=60; seed=&lt;5&gt;.";
    let place = changed.find(said).expect("law: it says so");
    assert!(place < changed.find("class=\"lead\"").expect("a lead"), "law: above what it found");
    assert!(!html(&[]).contains("not the default programme"), "law: nothing is changed");
}

/// Law: no page speaks of figures as lost, which were not available to us, nor of results that
/// it does not have from its runs.
#[test]
fn the_page_says_what_was_not_available() {
    let runs = canned::valid_runs();
    let (page, _) = make_report(canned::study(&runs), &a_choice());
    let text = page.replace("grains changed or lost", "").replace("listed as lost", "");
    for gone in [" is lost", "are lost", "Lost with", "11.6 mm"] {
        assert!(!text.contains(gone), "law: the page does not say `{gone}`");
    }
    assert!(text.contains("not available to us (only its text was)"), "law: it says so");
}

/// Law: whatever keeps a run out of means is in the table of runs, among what falls short, with
/// the statements, the settlements and, for the first, above the scorecard.
#[test]
fn the_page_says_why_runs_do_not_count() {
    let mut runs = canned::runs();
    let spoilt = runs.iter_mut().find(|r| r.name == "vibration-continuous-c2").expect("a run");
    spoilt.summary.grains.missing = Some(700);
    let (page, _) = make_report(canned::study(&runs), &[]);
    let first = page.find("; the first, ").expect("above the scorecard");
    assert!(first < page.find("<nav").expect("contents"), "law: it opens the page");
    let lacking = runs.iter().find(|r| r.name == "vibration-continuous-c2").expect("a run");
    let why = lacking.summary.why_left_out().join("; ");
    assert!(!why.is_empty(), "law: it does not count");
    // Paragraph, table of runs, shortfalls, settlements and statements.
    let found = page.matches(&why).count();
    assert!(found >= 5, "law: `{why}` in five places, got {found}");
    for run in runs.iter().filter(|r| !r.counts_in_means()) {
        for why in run.summary.why_left_out() {
            assert!(page.contains(&why), "law: `{why}` of {} is on the page", run.name);
        }
    }
}

/// Law: every result that is outside falls short, the angle of repose, which has no band, among them.
#[test]
fn an_angle_that_is_missed_falls_short() {
    let said = "Slow pluviation on a rough surface gives an angle of repose of 38.40°: expected 38.4, \
                found 33°.";
    for (angles, expected) in [([32.0, 33.0, 34.0], true), ([37.0, 38.0, 39.0], false)] {
        let mut runs = canned::valid_runs();
        runs.extend((1..).zip(angles).map(|(c, degrees)| canned::pile(c, Some(degrees))));
        let found = with_input(canned::study(&runs), &[], shortfalls::list);
        let got = found.iter().any(|one| one == said);
        assert_eq!(got, expected, "law: `{said}` of {angles:?} (got left), in {found:?}");
    }
}

/// Law: a run that lacks grains is marked in the table, named and left out of the mean.
#[test]
fn a_jammed_run_is_marked_and_left_out() {
    let mut runs = canned::valid_runs();
    let jammed = runs.iter_mut().find(|r| r.name == "vibration-continuous-c3").expect("a run");
    jammed.summary.grains.missing = Some(302);
    jammed.summary.grains.left_in_funnel = 302;
    let (page, _) = make_report(canned::study(&runs), &[]);
    let all = [
        "✗ left out of means",
        "302 of 1456 grains are missing in the specimen",
        "1 of 18 runs with a result is left out of means",
        "17.0 mm [4.3 … 29.7]",
        "(left out: 1)",
    ];
    assert_says(&page, &all);
}

#[test]
fn the_page_needs_no_network_and_escapes_what_it_shows() {
    let runs = canned::runs();
    let (page, _) = make_report(canned::study(&runs), &[]);
    for banned in ["<script", "http://", "https://", "<link", "@import", "url("] {
        let elsewhere = page.replace("http://www.w3.org/2000/svg", "");
        assert!(!elsewhere.contains(banned), "the page contains `{banned}`");
    }
    assert!(page.contains("&lt;script&gt;alert(1)"), "warnings are escaped, not dropped");
    assert!(page.contains("a=&lt;b&gt;&amp;c"), "provenance is escaped");
}

#[test]
fn numbers_of_a_figure_are_those_of_the_runs() {
    let runs = canned::runs();
    let (_, figures) = make_report(canned::study(&runs), &[]);
    let figure = figures.iter().find(|f| f.stem.starts_with("figure-07")).expect("Figure 7");
    let mut reader = csv::Reader::from_reader(figure.csv.as_slice());
    let rows: Vec<csv::StringRecord> = reader.records().map(|r| r.expect("a row")).collect();
    assert_eq!(rows.len(), 12, "three configurations from four heights");
    for row in &rows {
        let run = runs.iter().find(|r| r.name == row[0]).expect("a run of that name");
        let got: f64 = row[3].parse().expect("a number");
        let expected = run.summary.standing_height_mm.mean_surface;
        assert_eq!(got, expected, "standing height of {}", run.name);
    }
}

/// Law: no figure of the quick study has the laboratory's settlement beside its own, which is of a
/// smaller specimen and of less time.
#[test]
fn the_quick_study_has_no_range_of_the_laboratory() {
    let runs = canned::valid_runs();
    let study = canned::study(&runs);
    let quick = StudyView { quick: true, grain_count: 364, ..study.clone() };
    for (study, expected) in [(study, true), (quick, false)] {
        let (_, figures) = make_report(study, &[]);
        for stem in ["settlement", "figure-09-continuous-vibration"] {
            let figure = figures.iter().find(|f| f.stem == stem).expect("a figure");
            let got = figure.svg.contains("Laboratory, ");
            assert_eq!(got, expected, "law: {stem} at full size alone (got left)");
            assert_eq!(figure.caption.contains("range is not drawn"), !expected, "law: said");
        }
    }
}

/// Law: what one configuration cannot show, intervals, has no figure.
#[test]
fn one_configuration_has_no_figure_of_intervals() {
    let runs = canned::valid_runs();
    let one: Vec<RunRecord> = runs.iter().filter(|r| r.configuration == 1).cloned().collect();
    for (runs, expected) in [(&runs, true), (&one, false)] {
        let (_, figures) = make_report(canned::study(runs), &[]);
        let got = figures.iter().any(|f| f.stem == "uncertainty-standing-height");
        assert_eq!(got, expected, "law: of {} runs (got left)", runs.len());
    }
}

/// Law: a note that all quantities have is said once, a single value is no range, one of a thing has
/// no plural, and what was not measured has no unit.
#[test]
fn tables_say_nothing_twice_and_no_more_than_there_is() {
    let runs = canned::valid_runs();
    let of = |configurations: u32| {
        let mut runs = runs.clone();
        runs.retain(|run| run.configuration <= configurations);
        runs.push(canned::pile(1, None));
        make_report(StudyView { configurations, ..canned::study(&runs) }, &[]).0
    };
    let (one, two) = (of(1), of(2));
    for (page, note) in
        [(&one, "One configuration: no interval"), (&two, "Two configurations: the")]
    {
        assert_eq!(page.matches(note).count(), 1, "law: `{note}` once");
        assert!(!page.contains("–°"), "law: a dash alone");
    }
    // The first configuration stands 163.9 mm high when it falls from 0.
    assert!(one.contains("163.9") && !one.contains("163.9 to 163.9"), "law: no range of one");
    assert!(one.contains("1 of 1 configuration") && !one.contains("1 of 1 configurations"));
    assert!(two.contains("with 1 degree of freedom"), "law: one degree");
}

#[test]
fn missing_runs_and_broken_numbers_do_not_stop_the_report() {
    let none: Vec<RunRecord> = Vec::new();
    let mut broken = canned::runs();
    for run in &mut broken {
        run.summary.standing_height_mm.mean_surface = f64::NAN;
        run.summary.creep_um_per_s = None;
        run.summary.overlap.mean_percent = 0.0;
        run.summary.overlap.p99_percent = f64::INFINITY;
        if run.configuration == 2 {
            run.series.clear();
        }
        for row in &mut run.series {
            row.settlement_mm = row.settlement_mm.map(|_| f64::NAN);
            row.kinetic_energy_j = 0.0;
        }
    }
    let one: Vec<RunRecord> = canned::runs().into_iter().take(1).collect();
    for (what, runs) in [("none", none), ("broken", broken), ("one", one)] {
        let mut study = canned::study(&runs);
        study.quick = true;
        if what == "none" {
            study.sieve.clear();
            study.sieved_grains.clear();
        }
        let (page, figures) = make_report(study, &[]);
        assert!(!page.contains("NaN") && !page.contains("inf "), "{what}: NaN on the page");
        assert!(page.contains("quick study"), "{what}: says that it is the quick study");
        let of_runs = runs.iter().flat_map(|r| of_run(r).expect("figures of a run"));
        for figure in of_runs.chain(figures) {
            assert!(!figure.svg.contains("NaN"), "{what}: NaN in {}", figure.stem);
        }
    }
}
