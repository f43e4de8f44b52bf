//! The table of made-up interpretations.

use super::*;
use crate::paper::{canned, claims, report::tests::STANDARD};

/// An interpretation of canned runs, changed.
pub(super) fn column(name: &str, change: impl Fn(&mut Vec<RunRecord>)) -> InterpretationColumn {
    let mut runs = canned::valid_runs();
    change(&mut runs);
    let claims = claims(&canned::study(&runs));
    InterpretationColumn {
        name: name.into(),
        title: format!("the interpretation {name}"),
        meaning: "What it stands for.".into(),
        source: "Section 3.".into(),
        settings: "native".into(),
        programme: "p".into(),
        quick: false,
        configurations: 3,
        planned_runs: 18,
        runs,
        failures: Vec::new(),
        warnings: Vec::new(),
        claims,
    }
}

fn columns() -> Vec<InterpretationColumn> {
    let mut failed = column("failed", |runs| runs.clear());
    failed.failures = vec![InterpretationFailure {
        run: "pluviation-c1".into(),
        reason: "body 3 | flew <off>".into(),
    }];
    failed.warnings = vec!["let pass by engine.allow_coarse_steps: engine.rate_hz: too low".into()];
    let emptied = column("emptied", |runs| {
        for run in runs {
            run.summary.grains.in_cylinder = 0;
            run.summary.grains.escaped = 1456;
        }
    });
    let higher = column("higher", |runs| {
        for run in runs {
            run.summary.standing_height_mm.mean_surface += 10.0;
            run.summary.overlap.mean_percent = 7.0;
            (run.summary.meets_standard, run.summary.valid) = (false, false);
        }
    });
    let mut plain = column("plain", |_| {});
    plain.warnings = vec!["contact.restitution: it is unusual".into()];
    vec![plain, higher, failed, emptied]
}

fn row<'a>(rows: &'a [InterpretationRow], quantity: &str) -> &'a InterpretationRow {
    rows.iter().find(|r| r.quantity == quantity).unwrap_or_else(|| panic!("{quantity}"))
}

#[test]
fn cells_are_means_and_ranges_of_the_runs() {
    let columns = columns();
    let rows = table::rows(&columns);
    let row = |quantity: &str| row(&rows, quantity);
    let from_ten = row("from 10 cm");
    // Canned: 163 + 0.9 c - 0.4 a cm, c from 1 to 3.
    let expected = 163.0 + 2.0 * canned::CONFIGURATION_STEP_MM + 10.0 * canned::SLOPE_MM_PER_CM;
    for (n, expected) in [(0, expected), (1, expected + 10.0)] {
        let got = from_ten.cells[n].value.expect("a height");
        assert!((got - expected).abs() < 1e-9, "law: the mean is {expected} mm, got {got} mm");
        let spread = from_ten.cells[n].spread.expect("a range");
        assert!(
            (spread.high - spread.low - 1.8).abs() < 1e-9,
            "law: the range is 1.8 mm: {spread:?}"
        );
    }
    for n in [2, 3] {
        assert_eq!(from_ten.cells[n].value, None, "law: no height without grains");
    }
    assert_eq!(row("runs made").cells[2].words, "0 of 18");
    assert_eq!(row("runs that failed").cells[2].words, "1, see failed");
    let coarse = row("steps too coarse for the motion").cells.iter().map(|c| c.words.as_str());
    let expected = ["no", "no", "yes", "no"];
    assert_eq!(coarse.collect::<Vec<_>>(), expected, "law: by warnings of the steps alone");
    assert_eq!(row("runs that lost every grain").cells[3].value, Some(18.0));
    assert_eq!(row("grains through walls or floor").cells[3].value, Some(1456.0));
    assert_eq!(row("overlap of grains, mean").cells[1].value, Some(7.0));
    let share = row("plate, share after 5 s").cells[0].value.expect("a share");
    assert!((share - 80.0).abs() < 1e-9, "law: 80 % in 5 s, got {share}");
    assert_eq!(row("plate, final").paper, "14 to 19.61");
    let ids = columns[0].claims.len();
    assert_eq!(rows.iter().filter(|r| r.cells[0].verdict.is_some()).count(), ids, "every claim");
}

/// Law: shares of the settlement have the digit of a percent that a run tells, the largest overlap
/// those by which it is more than nothing.
#[test]
fn numbers_have_the_digits_that_say_something() {
    let columns = [column("plain", |runs| {
        for run in runs {
            run.summary.overlap.max_mm = 0.034;
        }
    })];
    let rows = table::rows(&columns);
    for (quantity, expected) in
        [("plate, share after 5 s", "80.0"), ("largest overlap", "0.03"), ("plate, final", "18.0")]
    {
        let of = row(&rows, quantity);
        let cell = InterpretationCell { spread: None, ..of.cells[0].clone() };
        assert_eq!(cell.text(table::decimals(of)), expected, "law: of {quantity}");
    }
}

#[test]
fn every_form_shows_every_interpretation_and_escapes() {
    let out = tempfile::tempdir().expect("a folder");
    let columns = columns();
    write_interpretations(out.path(), &columns, STANDARD).expect("written");
    let read = |name: &str| std::fs::read_to_string(out.path().join(name)).expect(name);
    let (page, text) = (read("interpretations.html"), read("interpretations.md"));
    for c in &columns {
        assert!(page.contains(&c.title) && text.contains(&c.title), "{} is missing", c.name);
    }
    assert!(page.contains("flew &lt;off&gt;"), "what failed is reported, escaped");
    assert!(text.contains("body 3 | flew &lt;off>"), "what failed is reported, no tag: {text}");
    let widths: Vec<usize> =
        text.lines().filter(|l| l.starts_with('|')).map(|l| l.matches('|').count()).collect();
    assert!(
        widths.iter().all(|w| *w == widths[0]),
        "law: every line has as many cells: {widths:?}"
    );
    assert!(text.contains("up to 7.00 % of their diameter"), "overlap stands beside: {text}");
    for stem in ["standing-height", "continuous-plate", "continuous-surface", "intermittent-plate"]
    {
        for extension in ["svg", "png", "csv"] {
            let path = out.path().join(format!("figures/interpretations-{stem}.{extension}"));
            assert!(path.exists(), "{} is missing", path.display());
        }
    }
    let json: serde_json::Value =
        serde_json::from_str(&read("interpretations.json")).expect("JSON");
    assert_eq!(json["interpretations"].as_array().map(Vec::len), Some(4));
    assert_eq!(json["rows"][0]["cells"].as_array().map(Vec::len), Some(4));
}

/// Law: the page says by how much the standard is missed, also by little, that numerical creep may go
/// upwards, and where it was not measured.
#[test]
fn the_page_says_by_how_much_the_standard_is_missed() {
    let rising = column("rising", |runs| {
        let s = &mut runs[0].summary;
        (s.creep_um_per_s, s.overlap.p99_percent) = (Some(-5.3), 3.02);
        (s.meets_standard, s.valid) = (false, false);
    });
    let unrested = column("unrested", |runs| {
        for run in runs {
            run.summary.creep_um_per_s = None;
            (run.summary.meets_standard, run.summary.valid) = (false, false);
        }
    });
    let columns = [rising, unrested];
    let out = tempfile::tempdir().expect("a folder");
    write_interpretations(out.path(), &columns, STANDARD).expect("written");
    let page = std::fs::read_to_string(out.path().join("interpretations.md")).expect("a page");
    for said in [
        "3.02 % at the 99th percentile (3 %)",
        "sinks or rises by up to 5.3 µm/s (5)",
        "and numerical creep was not measured. Where",
    ] {
        assert!(page.contains(said), "law: `{said}` in {page}");
    }
}

#[test]
fn a_column_comes_back_from_its_file() {
    for column in columns() {
        let text = serde_json::to_string(&column).expect("JSON");
        let back: InterpretationColumn = serde_json::from_str(&text).expect("it can be read");
        assert_eq!(back, column, "law: a column comes back as it was written");
    }
}

/// Law: valid runs and others never stand in one mean; where no run is valid the number is
/// shown and marked, in the table, on both pages and in the figures.
#[test]
fn what_is_not_valid_is_marked_and_never_mixed() {
    let spoilt = |name: &str, which: &[u32]| {
        column(name, |runs| {
            for run in runs.iter_mut().filter(|r| which.contains(&r.configuration)) {
                let s = &mut run.summary;
                (s.meets_standard, s.valid) = (false, false);
                s.standing_height_mm.mean_surface += 50.0;
                for point in &mut run.series {
                    point.settlement_mm = point.settlement_mm.map(|mm| mm + 50.0);
                }
            }
        })
    };
    let columns = [spoilt("good", &[]), spoilt("mixed", &[3]), spoilt("stock", &[1, 2, 3])];
    let rows = table::rows(&columns);
    let row = |quantity: &str| row(&rows, quantity);
    // 163 + 0.9 c mm from 0 cm, c from 1 to 3; 50 mm more where it is not valid.
    let heights = row("from 0 cm");
    for (cell, expected, left_out, not_valid) in [
        (&heights.cells[0], 164.8, 0, false),
        (&heights.cells[1], 164.35, 1, false),
        (&heights.cells[2], 214.8, 3, true),
    ] {
        let got = cell.value.expect("a height");
        assert!((got - expected).abs() < 1e-9, "law: the mean is {expected} mm, got {got} mm");
        assert_eq!((cell.left_out, cell.not_valid), (left_out, not_valid), "law: {cell:?}");
    }
    let last = "After 20 s of continuous vibration the top plate has settled by 14 to 19.61 mm \
                (configuration 1)";
    let claim = &row(last).cells;
    assert_eq!((claim[1].value, claim[1].not_valid), (Some(16.0), false), "law: it is valid");
    assert_eq!((claim[2].value, claim[2].not_valid), (Some(16.0), true), "law: shown, marked");
    assert_eq!(claim[2].verdict, Some(crate::paper::Verdict::NotComparable));
    let left_out = row("runs left out of means");
    let words: Vec<&str> = left_out.cells.iter().map(|c| c.words.as_str()).collect();
    assert_eq!(words, ["0 of 18", "6 of 18", "18 of 18"]);
    let falls = "As the falling height increases, the standing height decreases: lower at 20 cm than \
                 at 0 in every configuration";
    // Three are expected of the first column, two of the second, and none of the third.
    assert_eq!(row(falls).paper, "all", "law: no column's number stands for the others'");
    let alone = table::rows(&columns[..1]);
    let paper = alone.iter().find(|of| of.quantity == falls).map(|of| of.paper.as_str());
    assert_eq!(paper, Some("3"), "law: the number where columns agree");
    // Overlap and numerical creep, by which runs are judged, are of all.
    assert_eq!(row("numerical creep at rest").cells[1].left_out, 0);

    let out = tempfile::tempdir().expect("a folder");
    write_interpretations(out.path(), &columns, STANDARD).expect("written");
    let read = |name: &str| std::fs::read_to_string(out.path().join(name)).expect(name);
    let line = read("interpretations.md");
    let line = line.lines().find(|l| l.starts_with("| from 0 cm")).expect("a row").to_owned();
    let cells: Vec<&str> = line.split('|').map(str::trim).collect();
    assert!(!cells[3].contains('('), "law: nothing to mind: {line}");
    assert!(cells[4].ends_with("(1 left out)"), "law: counted: {line}");
    assert!(cells[5].ends_with("(not valid)"), "law: marked: {line}");
    let said = "Under “Credibility” all numbers but the void ratio are of all runs";
    assert!(read("interpretations.md").contains(said), "law: the page says `{said}`");
    assert!(read("interpretations.html").contains("not valid"), "law: the page, too");
    let figure = read("figures/interpretations-standing-height.csv");
    let of = |name: &str| {
        let row = figure.lines().find(|l| l.starts_with(name)).expect("a row");
        row.split(',').map(str::to_owned).collect::<Vec<_>>()
    };
    assert_eq!(of("mixed,")[1], "2", "law: two runs make the point: {figure}");
    assert_eq!((of("mixed,")[4].as_str(), of("stock,")[4].as_str()), ("true", "false"), "{figure}");
    assert!(read("figures/interpretations-standing-height.svg").contains("stock (not valid)"));
    // Curves end where the valid runs end: 16 and 18 mm, not 70.
    let curve = read("figures/interpretations-continuous-plate.csv");
    let end = curve.lines().rfind(|l| l.starts_with("mixed,")).expect("rows");
    let depth: f64 = end.split(',').nth(2).and_then(|v| v.parse().ok()).expect("a number");
    assert!((depth - 17.0).abs() < 1.0, "law: the mean of 16 and 18 mm, got {end}");
}

/// Law: a claim without a value says why: runs that do not tell are not called missing, and those
/// that are too short are called so.
#[test]
fn a_claim_without_a_value_says_why() {
    let mut quick = column("quick", |runs| {
        for settled in runs.iter_mut().filter_map(|run| run.summary.settlement_mm.as_mut()) {
            settled.share_after_5_s = None;
        }
    });
    let longer = quick.claims.clone();
    let study = canned::study(&quick.runs);
    quick.claims = claims(&StudyView { quick: true, grain_count: 364, ..study });
    let longer = InterpretationColumn { claims: longer, ..quick.clone() };
    let columns = [quick, longer, column("failed", |runs| runs.clear())];
    let rows = table::rows(&columns);
    let share = "About 80 % of the settlement occurs in the first five seconds of vibration \
                 (configuration 1)";
    let got: Vec<String> = row(&rows, share).cells.iter().map(|cell| cell.text(None)).collect();
    let expected = ["shaken for less time", "not measured", "not run"];
    assert_eq!(got, expected, "law: got left, expected right");
}

/// Law: an interpretation whose heights are of different realisations is named.
#[test]
fn heights_of_different_realisations_are_said() {
    let uneven = column("uneven", |runs| runs.retain(|run| run.name != "pluviation-fh10-c2"));
    let columns = [column("plain", |_| {}), uneven];
    let figures = figures::of_interpretations(&columns).expect("figures");
    let stem = "interpretations-standing-height";
    let figure = figures.iter().find(|figure| figure.stem == stem).expect("a figure");
    let said = "some runs do not count or are missing: uneven.";
    assert!(figure.caption.contains(said), "law: `{said}`, got `{}`", figure.caption);
}

/// Law: no figure of the quick study has the laboratory's settlement beside its own, which is of a
/// smaller specimen and of less time.
#[test]
fn the_quick_study_has_no_range_of_the_laboratory() {
    for (quick, expected) in [(false, true), (true, false)] {
        let columns = [InterpretationColumn { quick, ..column("plain", |_| {}) }];
        let figures = figures::of_interpretations(&columns).expect("figures");
        let stem = "interpretations-continuous-plate";
        let figure = figures.iter().find(|figure| figure.stem == stem).expect("a figure");
        let got = figure.svg.contains("Laboratory, range");
        assert_eq!(got, expected, "law: at full size alone (got left)");
        assert_eq!(figure.caption.contains("range is not drawn"), quick, "law: said");
    }
}
