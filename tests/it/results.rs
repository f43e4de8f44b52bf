//! Pages quote what the files of `docs/results/` give (`benches/results/`), and say nothing
//! measured outside of marks but where the list allows it; what is missing or of an older build is
//! made anew.

use std::{fs, path::Path};

mod at_rest;
#[path = "../../benches/results/builds.rs"]
mod builds;
#[path = "../../benches/results/derived.rs"]
mod derived;
#[path = "../../benches/results/joint.rs"]
mod joint;
#[path = "../../benches/results/laboratory.rs"]
mod laboratory;
#[path = "../../benches/results/list.rs"]
mod list;
mod made;
#[allow(dead_code)]
#[path = "../../benches/results/make.rs"]
mod make;
#[path = "../../benches/results/marks.rs"]
mod marks;
#[path = "../../benches/results/missed.rs"]
mod missed;
#[allow(dead_code)] // the test writes nothing
#[path = "../../benches/results/pages.rs"]
mod pages;
#[path = "../../benches/results/pictures.rs"]
mod pictures;
mod pours;
mod quoted;
#[allow(dead_code)]
#[path = "../../benches/results/referee.rs"]
mod referee;
#[path = "../../benches/results/scan.rs"]
mod scan;
#[path = "../../benches/results/sources.rs"]
mod sources;
#[path = "../../benches/results/speed.rs"]
mod speed;
mod standard_tests;
mod steps;
#[path = "../../benches/results/tables.rs"]
mod tables;
#[path = "../../benches/results/value.rs"]
mod value;
mod words;

use super::program::root;
use builds::Build;
use make::{Asked, Maker};
use pluvia::study::STAGE_FORMAT;
use scan::{Allowed, Kind};
use serde_json::{Value, json};
use value::Results;

#[test]
fn pages_quote_their_results() {
    let faults = pages::faults(root()).expect("pages and results can be read");
    assert!(
        faults.is_empty(),
        "law: pages quote what docs/results/ holds, measured numbers have marks, every results file \
         is listed. `make results ARGS=--fill` fills marks; benches/results/scan.rs says what needs \
         one.\n{}",
        faults.join("\n")
    );
}

/// A tree with one results file.
fn tree() -> (tempfile::TempDir, Results) {
    let folder = tempfile::tempdir().expect("a folder");
    let results = folder.path().join(list::FOLDER).join("quick");
    fs::create_dir_all(&results).expect("made");
    let rows = "run,settlement_mm.final,engine\na,7.04,bullet\nb,8.36,rapier\n";
    fs::write(results.join("vibration.csv"), rows).expect("written");
    let results = Results::of(folder.path());
    (folder, results)
}

/// Law: another number in the page is found, and so is another number in the file.
#[test]
fn a_page_that_differs_from_its_file_is_found_whichever_changed() {
    const KEY: &str = "quick:a/settlement_mm.final:.1";
    let page = |number: &str| format!("# A\n\nIt is <!--r {KEY}-->{number}<!--/r--> mm.\n");
    let (folder, results) = tree();
    let (same, faults) = marks::filled(&page("7.0"), &results);
    assert_eq!((same, faults.len()), (page("7.0"), 0), "law: what agrees stays as it is");

    let (filled, faults) = marks::filled(&page("7.1"), &results);
    assert_eq!(filled, page("7.0"), "law: the file's number is filled in");
    let said: Vec<String> = faults.iter().map(ToString::to_string).collect();
    assert_eq!(said, [format!("3: `{KEY}`: expected `7.0`, got `7.1`")], "law: line, key, both");

    let file = folder.path().join(list::FOLDER).join("quick/vibration.csv");
    fs::write(&file, "run,settlement_mm.final\na,7.14\n").expect("written");
    let faults = marks::filled(&page("7.0"), &Results::of(folder.path())).1;
    assert_eq!(faults.len(), 1, "law: a changed file is found: {faults:?}");
    fs::remove_file(&file).expect("removed");
    let faults = marks::filled(&page("7.0"), &Results::of(folder.path())).1;
    assert!(faults[0].expected.is_err(), "law: a missing file is found: {faults:?}");
}

#[test]
fn marks_that_lead_nowhere_or_do_not_end_are_faults() {
    let (_folder, results) = tree();
    for mark in [
        "It is <!--r quick:c/settlement_mm.final:.1-->7.0<!--/r-->",
        "It is <!--r quick:a/other:.1-->7.0<!--/r-->",
        "It is <!--r nowhere:a:.1-->7.0<!--/r-->",
        "It is <!--r quick:a/settlement_mm.final:often-->7.0<!--/r-->",
        "It is <!--r quick:a/settlement_mm.final:.1-->7.0",
        "It is\n<!--r quick:a/settlement_mm.final:.1-->7.0<!--/r-->",
        "<!-- results: nothing -->\n| a |\n<!-- /results -->",
    ] {
        let (page, faults) = marks::filled(mark, &results);
        assert_eq!(faults.len(), 1, "law: `{mark}` is a fault");
        assert!(faults[0].expected.is_err(), "law: with its reason: {faults:?}");
        assert!(page.contains("7.0") || page.contains("| a |"), "law: the page keeps its text");
    }
}

#[test]
fn values_are_written_as_their_formats_say() {
    let (_folder, results) = tree();
    for (key, expected) in [
        ("quick:b/settlement_mm.final:.0", "8"),
        ("quick:b/settlement_mm.final:+.1", "+8.4"),
        ("quick:b/settlement_mm.final:.1*-1", "−8.4"),
        ("quick:b/settlement_mm.final:.3*0.001", "0.008"),
        ("quick:*settlement_mm.final:range.1", "7.0 to 8.4"),
        ("quick:*settlement_mm.final:range.0*0.1", "1"),
        ("quick:*settlement_mm.final:mean.2", "7.70"),
        // Student's t of two values: 12.706 · 0.66.
        ("quick:*settlement_mm.final:±.1", "7.7 ± 8.4"),
        ("quick:engine=rapier/*settlement_mm.final:list.1", "8.4"),
        ("quick:engine=rapier:count", "1"),
        ("quick:a/engine:text", "bullet"),
    ] {
        assert_eq!(results.quote(key).as_deref(), Ok(expected), "law: {key}");
    }
}

#[test]
fn measured_numbers_without_a_mark_are_found() {
    let count = |line: &str| scan::unmarked(line).values().map(Vec::len).sum::<usize>();
    for line in [
        "It settles by 7.6 mm.",
        "It settles by 7.6 to 8 mm.",
        "It creeps by 12 µm/s.",
        "A share of 63 % remains.",
        "The void ratio is 0.91.",
        "It takes 13 minutes.",
        "| poured | 161.1 |",
        "4 ± 2 mm",
        "Three runs of format 14 settle more.",
    ] {
        assert!(count(line) > 0, "law: `{line}` quotes a result");
        assert_eq!(count(&format!("```text\n{line}\n```")), 0, "law: code quotes none");
    }
    for line in [
        "The table moves by 25 mm at 3 Hz for 5 s.",
        "The paper has 14 to 19.61 mm.",
        "Friction 0.793, restitution 0.315, confidence 95 %.",
        "It settles by <!--r a:b:c-->7.6 to 8.1<!--/r--> mm.",
        "<!-- results: x -->\n| poured | 161.1 |\n<!-- /results -->",
        "`7.6 mm` and [text](page-7.6 mm.md)",
        "Bullet 3.24, section 2, format <!--r builds:a/format:-->14<!--/r-->.",
    ] {
        assert_eq!(count(line), 0, "law: `{line}` quotes no result: {:?}", scan::unmarked(line));
    }
}

#[test]
fn the_list_allows_no_more_than_it_says() {
    let page = "# A\n\n7.6 mm\n\n# B\n\nNumbers of an earlier build: 7.6 mm\n";
    let pages = [("p.md".to_owned(), page.to_owned())];
    let row = |section: &str, most, kind| Allowed {
        page: "p.md".to_owned(),
        section: section.to_owned(),
        most,
        kind,
        why: String::new(),
    };
    let good = [row("A", 1, Kind::Input), row("B", 1, Kind::Earlier)];
    assert_eq!(scan::faults(&pages, &good), Vec::<String>::new(), "law: as listed is well");
    for (bad, law) in [
        ([row("A", 0, Kind::Input), row("B", 1, Kind::Earlier)], "one too many"),
        ([row("A", 1, Kind::Earlier), row("B", 1, Kind::Earlier)], "A does not say earlier"),
    ] {
        assert_eq!(scan::faults(&pages, &bad).len(), 1, "law: {law}");
    }
    let gone = [&good[..], &[row("C", 1, Kind::Input)]].concat();
    assert_eq!(scan::faults(&pages, &gone).len(), 1, "law: a section that is gone is a fault");
    assert_eq!(scan::lowered(&pages, &gone), good, "law: the list is lowered to what is there");
}

/// A tree with every file of the list, of today's build but for these.
fn kept(older: &[(&str, &str)]) -> tempfile::TempDir {
    let folder = tempfile::tempdir().expect("a folder");
    let results = folder.path().join(list::FOLDER);
    for (file, _) in list::KEPT.iter().flat_map(|kept| kept.files) {
        let file = results.join(file);
        fs::create_dir_all(file.parent().expect("a folder")).expect("made");
        fs::write(file, "").expect("written");
    }
    fs::write(results.join("builds.csv"), "name,day,format\n").expect("written");
    for kept in list::KEPT.iter().rev() {
        let format = older.iter().find(|(name, _)| *name == kept.name);
        let format = format.map_or_else(|| STAGE_FORMAT.to_string(), |of| of.1.to_owned());
        let (name, day) = (kept.name.to_owned(), "2000-01-01".to_owned());
        builds::record(folder.path(), Build { name, day, format }).expect("recorded");
    }
    folder
}

/// Law: what is missing is made, with `--older` what is of an older build, too; make targets are
/// called where they are asked for, and what cannot be made keeps nothing else from being made.
#[test]
fn results_to_make_are_those_asked_for() {
    let folder = kept(&[("grains", "13"), ("bench", "17"), ("stock", "1")]);
    let root = folder.path();
    assert_eq!(builds::faults(root), Ok(Vec::new()), "law: in order, each once");
    let chosen = |only: &[&str], older: bool, targets: bool| {
        let only = only.iter().map(|name| (*name).to_owned()).collect();
        let chosen = make::chosen(root, &Asked { only, older, targets }).expect("known names");
        let names: Vec<&str> = chosen.to_make.iter().map(|kept| kept.name).collect();
        (names, chosen.left)
    };
    assert_eq!(chosen(&[], false, false), (vec![], vec![]), "law: nothing is missing");
    let (names, left) = chosen(&[], true, false);
    assert_eq!(names, ["grains"], "law: of an older build");
    assert!(left.len() == 2 && left[0].starts_with("stock: not made: "), "law: got {left:?}");
    let unasked = "bench: not made unasked: takes ten minutes (`make bench ";
    assert!(left[1].starts_with(unasked), "law: listed, got {left:?}");
    assert_eq!(chosen(&[], true, true).0, ["grains", "bench"], "law: targets that are asked for");
    let (names, left) = chosen(&["bench", "stock", "verify"], false, false);
    assert_eq!(names, ["verify", "bench"], "law: those named, whatever is there");
    assert!(left.len() == 1 && left[0].starts_with("stock: "), "law: got {left:?}");
    for file in ["grains.json", "bench.json", "claims.json"] {
        fs::remove_file(root.join(list::FOLDER).join(file)).expect("removed");
    }
    let (names, left) = chosen(&[], false, false);
    assert_eq!(names, ["grains", "programme"], "law: what is missing");
    assert!(left.len() == 1 && left[0].starts_with("bench: "), "law: got {left:?}");
    let asked = Asked { only: vec!["grain".to_owned()], ..Asked::default() };
    let why = make::chosen(root, &asked).err().unwrap_or_default();
    assert!(why.contains("no result is named grain;"), "law: an unknown name, got {why}");
}

/// Law: the list says the format of each result beside today's, marks older ones, and names files
/// that are missing.
#[test]
fn results_are_listed_with_their_builds() {
    let folder = kept(&[("grains", "13")]);
    let file = folder.path().join(list::FOLDER).join("bench.json");
    fs::remove_file(file).expect("removed");
    let listed = make::list(folder.path()).expect("it can be listed");
    let line = |name: &str| {
        let line = listed.lines().find(|line| line.starts_with(&format!("{name}: ")));
        line.expect("every result is listed")
    };
    for (name, end) in [
        ("grains", format!("(of 2000-01-01, format 13, today {STAGE_FORMAT}: OLDER)")),
        ("verify", format!("format {STAGE_FORMAT}, today {STAGE_FORMAT})")),
        ("bench", format!("today {STAGE_FORMAT}; missing: bench.json)")),
    ] {
        assert!(line(name).ends_with(&end), "law: `{end}`, got `{}`", line(name));
    }
}

/// Law: a result that was made has its files in their places, and today's build in the table; a
/// make target gets its variables and the output folder.
#[cfg(unix)]
#[test]
fn what_is_made_is_kept_with_its_build() {
    let folder = kept(&[("grains", "13"), ("bench", "17")]);
    let root = folder.path();
    let makefile = "bench:\n\t@mkdir -p out && echo '$(ARGS) in $(OUT)' > out/bench.json\n";
    fs::write(root.join("Makefile"), makefile).expect("written");
    // A program that says what it is asked.
    let maker = Maker { root, out: Path::new("out/results"), program: Path::new("/bin/echo") };
    let made = |name: &str, file: &str| {
        let kept = list::KEPT.iter().find(|kept| kept.name == name).expect("it is listed");
        maker.make(kept).expect("law: it is made");
        fs::read_to_string(root.join(list::FOLDER).join(file)).expect("law: it is kept")
    };
    let out = format!("out/results/format-{STAGE_FORMAT}");
    assert_eq!(
        made("grains", "grains.json"),
        format!("grains scenarios/paper/pluviation.json --json --out {out}/grains\n"),
        "law: a file that is kept names no folder of this machine"
    );
    let root_shown = root.display();
    assert_eq!(
        made("bench", "bench.json"),
        format!(
            "--quick --most-grains 1500 --states rest,shaken,pour in {root_shown}/{out}/bench\n"
        )
    );
    let builds = builds::read(root).expect("builds");
    for name in ["grains", "bench"] {
        let build = builds::of(&builds, name).expect("it has a row");
        assert_eq!(build.format, STAGE_FORMAT.to_string(), "law: {name} is of today's build");
        assert_ne!(build.day, "2000-01-01", "law: {name} was made today");
    }
    assert_eq!(builds::faults(root), Ok(Vec::new()), "law: in order, each once");
}

/// Law: days are those of the calendar; a result of parts is as old as its oldest one.
#[test]
fn builds_have_their_day_and_age() {
    for (seconds, expected) in [
        (0, "1970-01-01"),
        (951_782_400, "2000-02-29"),
        (1_795_737_600, "2026-11-27"),
        (1_798_675_199, "2026-12-30"),
        (4_102_444_800, "2100-01-01"),
    ] {
        assert_eq!(builds::day(seconds), expected, "law: {seconds} s after 1970 began");
    }
    for (format, is_older) in [
        ("15", false),
        ("14", true),
        ("14, 15 and 19", true),
        ("15 and 16", false),
        ("before 15", true),
        ("", true),
    ] {
        let build = Build { name: String::new(), day: String::new(), format: format.to_owned() };
        assert_eq!(build.is_older(15), is_older, "law: `{format}` is older than 15");
    }
}

/// What a table of the page of the standard tests says of rows.
fn said(table: &str, rows: &[Value]) -> String {
    let folder = tempfile::tempdir().expect("a folder");
    let results = folder.path().join(list::FOLDER);
    fs::create_dir_all(&results).expect("made");
    let text = json!(rows).to_string();
    fs::write(results.join("laboratory.json"), text).expect("written");
    tables::named(table, &Results::of(folder.path())).expect("a table")
}

/// Law: what the page of the standard tests says of its rows follows from them, and nothing is said
/// of rows that are not there.
#[test]
fn sentences_of_the_standard_tests_follow_from_their_rows() {
    let row = |id: &str, ours: f64, values: &[f64]| json!({ "id": id, "ours": ours, "values": values, "decimals": 1 });
    let within = |mut row: Value, low: f64, high: f64| {
        row["interval"] = json!({ "low": low, "high": high });
        row
    };
    let peak = row("direct-shear-dilation", 10.5, &[10.5, 10.5]);
    let end = |ours: f64, values: &[f64]| row("direct-shear-dilation-end", ours, values);
    let far = [
        row("direct-shear-far-end", 41.04, &[41.04]),
        row("direct-shear-far-dilation-end", 0.5, &[0.5]),
    ];
    let rises = within(end(7.4, &[7.2, 7.6]), 4.9, 9.9);
    let sinks = within(end(-0.2, &[-0.21, -0.19]), -0.3, -0.1);
    // Its interval does not tell it from none.
    let rises_little = within(end(0.1, &[0.05, 0.15]), -0.5, 0.7);
    for (end, expected) in [
        (rises.clone(), "at 7.4° (4.9 to 9.9°) on average, against 10.5° at the peak"),
        (rises.clone(), "in 2 of 2 realisations: **the end of such a test is not the critical"),
        (sinks, "in 0 of 2 realisations: **the end of such a test is not the critical"),
        (rises_little, "in 2 of 2 realisations: the interval does not tell"),
        (end(7.4, &[7.4]), "in 1 of 1 realisations: too few to tell"),
    ] {
        let text = said("laboratory-shear", &[peak.clone(), end]);
        assert!(text.contains(expected), "law: `{expected}`, got {text}");
        assert!(text.contains("No row of a test that goes twice as far"), "law: got {text}");
    }
    let text = said("laboratory-shear", &[vec![peak, rises], far.to_vec()].concat());
    let expected = "twice as far ends at 41.0°, with the lid rising at 0.5°;";
    assert!(text.contains(expected), "law: `{expected}`, got {text}");
    assert_eq!(said("laboratory-shear", &[]), "", "law: no row, no sentence");
}

/// Law: a miss stands with what was tried about it, and with what has no result yet; runs that were
/// left out have none.
#[test]
fn misses_of_the_standard_tests_stand_with_what_was_tried() {
    let judged = |id: &str, verdict: &str, note: &str| {
        json!({ "id": id, "quantity": "e", "verdict": verdict, "decimals": 1,
            "published": { "low": 1.0, "high": 2.0 }, "ours": 0.5, "values": [0.5], "note": note })
    };
    let within = judged("a", "within", "");
    assert_eq!(
        said("laboratory-missed", std::slice::from_ref(&within)),
        "No row misses.\n",
        "law: no miss"
    );
    let one = "Tried: with longer and flatter grains -0.1";
    let other = "no result yet: friction between grains of 1.0, both together";
    let all =
        "no result yet: longer and flatter grains, friction between grains of 1.0, both together";
    for (id, note, expected) in [
        ("a", format!(". {one}"), one.to_owned()),
        ("a", String::new(), "nothing".to_owned()),
        ("density-basalt-e-max", format!(". {one}"), format!("{one}; {other}")),
        ("density-basalt-e-min", String::new(), all.to_owned()),
    ] {
        let note = format!("417 grains{note}; left out of this test: a-c1 (checks NOT passed)");
        let text = said("laboratory-missed", &[within.clone(), judged(id, "outside", &note)]);
        let expected = format!("| e | 1.0 to 2.0 | 0.5 | {expected} |");
        assert_eq!(text.lines().next_back(), Some(&expected[..]), "law: of {id}, note `{note}`");
        assert_eq!(text.lines().count(), 3, "law: a row beside the head, got {text}");
    }
    let column =
        "To where a tenth of a ring is covered: 0.7; left out of this test: spheres-1.2-c1 (creep)";
    let text = said("laboratory-missed", &[judged("column-run-out-1.2", "outside", column)]);
    let expected = "| To where a tenth of a ring is covered: 0.7; left out by a check: spheres; no result yet: \
                    friction 0.2 in place of 0.5, a column twice as wide |";
    assert!(
        text.contains(expected),
        "law: what ran and was left out is not without a run, got {text}"
    );
    let basalt = judged("density-basalt-e-max", "outside", &format!("417 grains. {one}"));
    let text = said("laboratory-density-tried", &[basalt]);
    let expected = format!("- e: {one}.\n- crushed basalt, {other}.\n- river gravel, {all}.\n");
    assert_eq!(text, expected, "law: of what rows say, and do not");
}

/// Law: void ratios stand beside the published one, or the middle of the range about it; rows of
/// other grains and those without a number do not.
#[test]
fn void_ratios_stand_beside_the_published_ones() {
    let row = |id: &str, published: Value, ours: Value| {
        json!({ "id": id, "quantity": format!("void ratio of {id}"), "published": published,
            "ours": ours, "decimals": 3 })
    };
    let range = || json!({ "low": 0.724, "high": 0.824 });
    let text = said(
        "laboratory-density",
        &[
            row("density-gravel-e-max", range(), json!(0.594)),
            row("density-gravel-range", json!({ "value": 0.228 }), json!(0.25)),
            row("density-gravel-e-min", range(), Value::Null),
            row("density-gravel-frictionless", Value::Null, json!(0.4)),
            row("density-e-max", range(), json!(0.9)),
        ],
    );
    let rows: Vec<&str> = text.lines().skip(2).collect();
    let expected = [
        "| density-gravel-e-max | 0.774 | 0.594 | −0.180 |",
        "| density-gravel-range | 0.228 | 0.250 | +0.022 |",
    ];
    assert_eq!(rows, expected, "law: left what the table has, right what its rows give");
}

/// Law: which rows are of an earlier build follows from the rows, or else from the build of all,
/// which may name tests; what has no row has no result yet.
#[test]
fn rows_of_earlier_builds_are_named() {
    let build = |format: &str, rows: &[Value]| {
        let [name, day] = ["laboratory", "2000-01-01"].map(str::to_owned);
        let build = Build { name, day, format: format.to_owned() };
        laboratory::build(&[build], &json!(rows))
    };
    let row = |test: &str, format: Value| json!({ "id": format!("{test}-a"), "test": test, "format": format, "values": [1.0] });
    let (column, shear) = (row("column", Value::Null), row("direct-shear", Value::Null));
    let today = row("column", json!(STAGE_FORMAT));
    const OLDER: &str = "before the rule that leaves runs out: column.";
    const UNDER_LOAD: &str = "with values that may change: direct shear.";
    const SEVERAL: &str = "of different builds";
    for (format, rows, there) in [
        ("19", [&column, &shear], [false, false, false]),
        ("14 and 15", [&column, &shear], [true, true, true]),
        ("4 to 14", [&column, &shear], [true, true, true]),
        ("14 and 15, column 19", [&column, &shear], [false, true, true]),
        ("19, column 14", [&column, &shear], [true, false, true]),
        ("14 and 15", [&today, &shear], [false, true, true]),
    ] {
        let text = build(format, &rows.map(Value::clone));
        let got = [OLDER, UNDER_LOAD, SEVERAL].map(|words| text.contains(words));
        assert_eq!(got, there, "law: older, under load, several of `{format}`, got {text}");
        assert!(text.contains("by test: column 1, direct shear 1."), "law: how many, got {text}");
    }
    let far = json!({ "id": "direct-shear-far-end", "test": "direct-shear", "values": [41, 42] });
    let text = build("19", &[shear, far]);
    assert!(text.contains("direct shear 1 to 2."), "law: from the least to the most, got {text}");
    assert!(!text.contains("twice as far"), "law: that was run, got {text}");
    let text = build("19", &[column]);
    assert!(text.contains("No result yet: ") && text.contains("twice as far"), "law: got {text}");
}
