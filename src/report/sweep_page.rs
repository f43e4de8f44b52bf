//! The files of a sweep: tables, and the page as Markdown and as HTML.

use super::sweep_outcomes::all_outcomes;
use super::sweep_reading::how_to_read;
use super::sweep_reasons::{if_not_all, reasons, withheld, withheld_in_row, without};
use super::*;
use crate::in_order::each_once;

/// What stands in the place of a change for one unit of values that are no numbers.
const NO_NUMBERS: &str = "none: its values are no numbers";

/// The one result that is another each time, and has a table of its own.
const WALL_TIME: &str = "wall_s";

/// Writes `sweep.csv`, `sweep-times.csv`, `sweep.json`, `sweep.md`, `report.html` and `figures/`.
///
/// # Errors
/// [`ReportError`] naming the file or the figure.
pub fn write_sweep(out: &Path, of: &Sweep) -> Result<(), ReportError> {
    table(of).write(&out.join("sweep.csv"))?;
    times(of).write(&out.join("sweep-times.csv"))?;
    write_json(&out.join("sweep.json"), of)?;
    page(of, figures::of_sweep(of)?).write(out, &["sweep.md", "report.html"])
}

/// The column of the realisation, and the field that says which it is.
const CONFIGURATION: &str = "configuration";

/// `sweep.csv`: one row a run, one column a factor and result. The same sweep
/// gives the same bytes, wherever and in whatever order it was run.
fn table(of: &Sweep) -> Table {
    let all = all_outcomes(&of.runs);
    let results = || all.iter().copied().filter(|path| *path != WALL_TIME);
    // Where `configuration` is varied, realisations count up from its value: one column says both.
    let varied = of.factors.iter().position(|factor| factor.path == CONFIGURATION);
    let realisation = |run: &SweepRun| {
        let first = varied.and_then(|n| run.values.get(n)?.as_u64()).unwrap_or(1);
        let realisation = (first + u64::from(run.configuration)).saturating_sub(1);
        Cell::number(realisation.to_string())
    };
    let factors = of.factors.iter().map(|f| f.path.as_str()).filter(|path| *path != CONFIGURATION);
    let specimen = (!of.specimens.is_empty()).then_some(SPECIMEN);
    let first = ["run", "point", CONFIGURATION].into_iter().chain(specimen);
    let header = first.chain(factors).chain(results());
    let last = ["meets_standard", "valid", "left_out_of_means", "failure", "withheld"];
    let mut table = Table::new(header.chain(last));
    for run in &of.runs {
        let mut cells = row![&run.run, &run.point, realisation(run)];
        cells.extend(run.specimen.iter().map(|specimen| Cell::from(shown(specimen))));
        let others = run.values.iter().enumerate().filter(|(n, _)| Some(*n) != varied);
        cells.extend(others.map(|(_, value)| Cell::from(shown(value))));
        cells.extend(results().map(|path| run.outcomes.get(path).copied().into()));
        let why = [&run.left_out_of_means, &run.failure].map(Clone::clone);
        cells.extend(row![run.meets_standard, run.valid]);
        cells.extend(why.map(Cell::from));
        cells.push(withheld_in_row(run).into());
        table.row(cells);
    }
    table
}

/// Wall times, which no two machines have alike, by themselves.
fn times(of: &Sweep) -> Table {
    table!(&of.runs, |run| {
        "run" => &run.run,
        WALL_TIME => run.outcomes.get(WALL_TIME).copied(),
    })
}

fn page(of: &Sweep, figures: Vec<Figure>) -> Page {
    let without = of.failed().count();
    let to_be_run = of.failed().filter(|run| run.is_to_be_run()).count();
    let (failed, done) = (without - to_be_run, of.runs.len() - without);
    // What has run out of a laboratory is valid without an end to judge.
    let is_below = |r: &&SweepRun| r.meets_standard == Some(false) && r.valid != Some(true);
    let below = of.runs.iter().filter(is_below).count();
    let not_valid = of.runs.iter().filter(|r| r.valid == Some(false)).count();
    let is_found = |r: &&SweepRun| r.meets_standard == Some(true) && r.valid == Some(false);
    let found = of.runs.iter().filter(is_found).count();
    let left_out = of.left_out().count();
    let [do_not, that_do] = [below, found].map(|count| in_number(count, "does", "do"));
    const STANDARD: &str = "meet the accuracy standard for overlap and numerical creep";
    const FOUND: &str = "a run-time check found something or grains had not settled";
    let against = [
        (failed, format!(", {failed} failed")),
        (to_be_run, format!(", {to_be_run} not run so far")),
        (below, format!("; {below} {do_not} not {STANDARD}")),
        (found, format!("; in {found} that {that_do} {FOUND}")),
        (not_valid, format!("; not valid: {not_valid} of {done}")),
    ];
    let against = against.into_iter().filter(|(count, _)| *count > 0).map(|(_, said)| said);
    let (together, not_given) = (together(of), withheld_in_words(of));
    let apart = together.iter().map(|factors| {
        format!("; {} change together, and cannot be told apart", factors.join(" and "))
    });
    let lead = format!(
        "{} in {}: {done} of {} {} results{}{}{}.{}",
        counted(of.points.len(), "point"),
        counted(of.configurations as usize, of.realisation()),
        counted(of.planned, "run"),
        in_number(done, "has", "have"),
        against.collect::<String>(),
        [left_out_in_words(left_out, done), not_given.clone()]
            .map(|said| said.map_or(String::new(), |said| format!("; {said}")))
            .concat(),
        apart.collect::<String>(),
        shown_to_change(of),
    );
    let is_whole = left_out == 0 && not_given.is_none();
    let is_well = without == 0 && not_valid == 0 && is_whole && together.is_empty();
    let why_left_out = reasons(of, of.left_out(), |r| r.left_out_of_means.as_ref());
    let why_failed = reasons(of, of.failed(), |r| r.failure.as_ref());
    Page::new(format!("Sweep of {}", plain(&of.scenario)), [Block::lead(lead, is_well)])
        .section("effects", "What each factor moves", [Block::Table(effects(of))])
        .section("points", "Points", [Block::Table(points(of))])
        .section("left-out", "Runs left out of means", [Block::Table(why_left_out)])
        .section("withheld", "Results withheld", withheld(of))
        .section("failures", "Runs without result", [Block::Table(why_failed)])
        .figures("figures", "Figures", figures)
        .section("reading", "How to read it", how_to_read(of))
}

/// Factors that no run tells apart, set by set, each in the order of the factors.
fn together(of: &Sweep) -> Vec<Vec<&str>> {
    let sets = of.effects.iter().filter(|effect| !effect.together_with.is_empty()).map(|effect| {
        let is_one = |path: &&str| {
            *path == effect.factor || effect.together_with.iter().any(|other| other == *path)
        };
        of.factors.iter().map(|factor| factor.path.as_str()).filter(is_one).collect::<Vec<&str>>()
    });
    each_once(sets)
}

/// Which changes for one unit differ from zero, of those that are tested; nothing where none is.
fn shown_to_change(of: &Sweep) -> String {
    const MOST_NAMED: usize = 5;
    let tested = of.effects.iter().filter_map(|e| e.slope_p).count();
    let differ = of.effects.iter().filter(|e| e.slope_p.is_some_and(|p| p < 0.05));
    let mut named: Vec<String> = differ
        .map(|e| {
            let result = in_words(&e.outcome, &of.names);
            format!("{} moves {result} by {} for one unit", e.factor, slope(e, &of.factors))
        })
        .collect();
    if tested == 0 {
        return String::new();
    }
    if named.is_empty() {
        return format!(
            " No change for one unit differs from zero with p < 0.05, of {tested} tested."
        );
    }
    let more = besides(named.len().saturating_sub(MOST_NAMED), "more");
    named.truncate(MOST_NAMED);
    let tested = counted(tested, "change");
    format!(" With p < 0.05, of {tested} tested: {}{more}.", named.join("; "))
}

fn probability(p: Option<f64>) -> Cell {
    match p {
        Some(p) if p < 0.001 => Cell::number("< 0.001"),
        p => Cell::fixed(p, 3),
    }
}

fn effects(of: &Sweep) -> Table {
    table!(&of.effects, |e| {
        "factor" => &e.factor,
        "result" => in_words(&e.outcome, &of.names),
        "change for one unit" => Cell::number(slope(e, &of.factors)),
        "p" => probability(e.slope_p),
        "p by ranks" => probability(e.page_p),
        "realisations needed" => match e.configurations_needed {
            Some(n) => Cell::from(n),
            None => Cell::number(dash()),
        },
    })
}

fn slope(of: &SweepEffect, factors: &[SweepFactor]) -> String {
    let factor = factors.iter().find(|factor| factor.path == of.factor);
    match of.slope.map(|slope| mean_within(slope, of.slope_half_width)) {
        Some(shown) => shown + &without(of),
        None if !of.together_with.is_empty() => {
            format!("none: it changes together with {}", of.together_with.join(", "))
        }
        None if factor.is_some_and(|factor| !factor.numeric) => NO_NUMBERS.to_owned(),
        None if factor.is_some_and(|factor| !factor.has_slope()) => NO_UNIT.to_owned(),
        None if of.withheld > 0 => {
            let counting = counted(of.runs + of.withheld, "run");
            format!("{} (withheld in {} of {counting})", dash(), of.withheld)
        }
        None if of.left_out > 0 && of.runs > 0 => "too few valid runs".to_owned(),
        None => missing(of.left_out > 0),
    }
}

fn estimate(of: &SweepPoint, e: Option<&SweepEstimate>) -> Cell {
    let shown = e.map(|e| mean_within(e.mean, e.t_high.map(|high| high - e.mean)));
    let none = || missing(of.left_out > 0 && of.left_out == of.runs);
    Cell::number(shown.unwrap_or_else(none) + &if_not_all(of, e.map_or(0, |e| e.count)))
}

fn points(of: &Sweep) -> Table {
    let outcomes = main_outcomes(&of.runs);
    let factors = of.factors.iter().map(|f| f.path.clone());
    let counts = ["runs", "valid", "left out"].map(str::to_owned);
    let words = outcomes.iter().map(|path| in_words(path, &of.names));
    let first = ["point".to_owned()].into_iter();
    let mut table = Table::new(first.chain(factors).chain(counts).chain(words));
    for p in &of.points {
        let mut cells = row![&p.point];
        cells.extend(p.values.iter().map(|value| match value.is_number() {
            true => Cell::number(shown(value)),
            false => Cell::from(shown(value)),
        }));
        let runs = format!("{}{}", p.runs, besides(p.failed, "without result"));
        cells.extend(row![Cell::number(runs), p.valid, p.left_out]);
        cells.extend(outcomes.iter().map(|path| estimate(p, p.outcomes.get(*path))));
        table.row(cells);
    }
    table
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeMap;

    use serde_json::Value;

    use super::*;
    use crate::{record::LaboratoryNames, report::SweepFactor};

    /// A sweep of one point in four configurations: valid, below the standard,
    /// not valid for another reason, and failed.
    fn sweep() -> Sweep {
        let states = [Some((true, true)), Some((false, false)), Some((true, false)), None];
        let run = |(n, state): (u32, Option<(bool, bool)>)| SweepRun {
            run: format!("point-0001-c{n}"),
            point: "point-0001".into(),
            configuration: n,
            values: vec![1.into()],
            meets_standard: state.map(|s| s.0),
            valid: state.map(|s| s.1),
            left_out_of_means: state.filter(|s| !s.1).map(|_| "not valid".to_owned()),
            failure: state.is_none().then(|| "it blew up".to_owned()),
            ..SweepRun::default()
        };
        Sweep {
            scenario: "s".into(),
            design: "grid",
            factors: vec![SweepFactor {
                path: "seed".into(),
                values: vec![1.into()],
                sampled: false,
                numeric: true,
            }],
            configurations: 4,
            planned: 4,
            runs: (1..).zip(states).map(run).collect(),
            points: vec![SweepPoint {
                point: "point-0001".into(),
                values: vec![1.into()],
                runs: 3,
                valid: 1,
                left_out: 2,
                failed: 1,
                outcomes: BTreeMap::new(),
            }],
            effects: Vec::new(),
            specimens: Vec::new(),
            names: LaboratoryNames::default(),
        }
    }

    #[test]
    fn the_table_says_of_every_run_whether_it_is_valid() {
        let written = table(&sweep()).csv().expect("written");
        let mut reader = csv::Reader::from_reader(&written[..]);
        let names = reader.headers().expect("names").clone();
        let place = |name: &str| names.iter().position(|n| n == name).expect(name);
        assert_eq!(place("valid"), place("meets_standard") + 1, "law: one beside the other");
        let got: Vec<(String, String)> = reader
            .records()
            .map(|r| r.expect("a row"))
            .map(|r| (r[place("meets_standard")].to_owned(), r[place("valid")].to_owned()))
            .collect();
        let expected = [("true", "true"), ("false", "false"), ("true", "false"), ("", "")];
        let expected = expected.map(|(met, valid)| (met.to_owned(), valid.to_owned()));
        assert_eq!(got, expected, "law: as each run has it; nothing of one without result");
        let json = serde_json::to_value(sweep()).expect("JSON");
        assert_eq!(json["runs"][2]["valid"], Value::Bool(false), "law: sweep.json says so, too");
    }

    /// Law: a name is that of one column. Where `configuration` is varied, it has the realisation of
    /// each run, which counts up from the value of its point.
    #[test]
    fn a_varied_configuration_has_one_column() {
        let mut of = sweep();
        let place = SweepFactor { path: CONFIGURATION.into(), ..of.factors[0].clone() };
        of.factors.insert(0, place);
        for (n, run) in of.runs.iter_mut().enumerate() {
            let first = if n < 2 { 1 } else { 101 };
            run.configuration = n as u32 % 2 + 1;
            run.values = vec![first.into(), 7.into()];
        }
        let written = table(&of).csv().expect("written");
        let mut reader = csv::Reader::from_reader(&written[..]);
        let names: Vec<String> =
            reader.headers().expect("names").iter().map(str::to_owned).collect();
        assert_eq!(names[..4], ["run", "point", CONFIGURATION, "seed"], "law: the factors by path");
        let named = names.iter().filter(|name| *name == CONFIGURATION).count();
        assert_eq!(named, 1, "law: columns of this name, expected 1, got {named}");
        let rows = reader.records().map(|row| row.expect("a row"));
        let got: Vec<(String, String)> =
            rows.map(|row| (row[2].to_owned(), row[3].to_owned())).collect();
        let expected =
            ["1", "2", "101", "102"].map(|realisation| (realisation.to_owned(), "7".to_owned()));
        assert_eq!(got, expected, "law: realisation and seed of each run");
    }

    /// Law: where specimens are the realisations, table, page and first paragraph name them.
    #[test]
    fn specimens_that_are_realisations_are_named() {
        let mut of = sweep();
        of.specimens = ["a", "b", "c", "d"].map(Value::from).into();
        for (run, specimen) in of.runs.iter_mut().zip(&of.specimens) {
            run.specimen = Some(specimen.clone());
        }
        let written = String::from_utf8(table(&of).csv().expect("written")).expect("text");
        for said in ["run,point,configuration,begin.specimen,seed,", "-c2,point-0001,2,b,1,"] {
            assert!(written.contains(said), "law: `{said}`, got:\n{written}");
        }
        let text = page(&of, vec![]).markdown();
        for said in ["1 point in 4 specimens", "begin.specimen=b seed=1 | not valid"] {
            assert!(text.contains(said), "law: `{said}`, got:\n{text}");
        }
    }

    #[test]
    fn the_page_counts_runs_below_the_standard_and_others_that_are_not_valid() {
        let of = sweep();
        let page = page(&of, vec![]);
        let text = page.markdown();
        for said in [
            "; 1 does not meet the accuracy standard for overlap and numerical creep; in 1 that does a \
             run-time check found something or grains had not settled; not valid: 2 of 3; 2 of 3 runs with a \
             result are left out of means.",
            "| point | seed | runs | valid | left out |",
            "| point-0001 | 1 | 3, 1 without result | 1 | 2 |",
            "| point-0001-c2 | seed=1 | not valid |",
        ] {
            assert!(text.contains(said), "law: `{said}`, got:\n{text}");
        }
        let valid = Sweep {
            runs: vec![of.runs[0].clone()],
            points: vec![SweepPoint { runs: 1, left_out: 0, failed: 0, ..of.points[0].clone() }],
            planned: 1,
            ..of
        };
        let page = super::page(&valid, vec![]);
        let lead = page.markdown().lines().nth(2).unwrap_or_default().to_owned();
        assert!(lead.contains("1 point in 4 realisations"), "law: one of them, got {lead}");
        assert!(lead.ends_with("1 of 1 run has results."), "law: nothing to warn of, got {lead}");
        assert!(page.html().contains("p class=\"lead\""), "law: no banner");
    }

    /// Law: of factors that no run tells apart the page says so, and no slope as if it were known.
    #[test]
    fn factors_that_change_together_are_said_to() {
        let mut of = sweep();
        of.factors = ["a", "b", "c"]
            .map(|path| SweepFactor { path: path.into(), ..of.factors[0].clone() })
            .to_vec();
        let effect = |factor: &str, together_with: &[&str], slope| SweepEffect {
            factor: factor.into(),
            outcome: "void_ratio".into(),
            runs: 6,
            together_with: together_with.iter().map(|name| (*name).to_owned()).collect(),
            slope,
            ..SweepEffect::default()
        };
        of.effects =
            vec![effect("a", &["c"], None), effect("b", &[], Some(2.0)), effect("c", &["a"], None)];
        of.points.clear();
        let text = page(&of, vec![]).markdown();
        let said = "; a and c change together, and cannot be told apart.";
        assert_eq!(text.matches(said).count(), 1, "law: `{said}` once, got:\n{text}");
        for (start, said) in [
            ("| a |", "| none: it changes together with c |"),
            ("| b |", "| 2 |"),
            ("| c |", "| none: it changes together with a |"),
        ] {
            let got = text.lines().find(|line| line.starts_with(start)).unwrap_or_default();
            assert!(got.contains(said), "law: `{said}`, got `{got}`");
        }
    }

    /// Law: the first paragraph says what was found: which changes are shown, of how many, or that
    /// none is; nothing where none could be tested.
    #[test]
    fn the_first_paragraph_says_what_was_found() {
        let mut of = sweep();
        let effect = |slope_p| SweepEffect {
            factor: "contact.restitution".into(),
            outcome: "void_ratio".into(),
            slope: Some(-0.1234),
            slope_half_width: Some(0.021),
            slope_p,
            ..SweepEffect::default()
        };
        let lead = |of: &Sweep| page(of, vec![]).markdown().lines().nth(2).unwrap_or("").to_owned();
        for (effects, expected) in [
            (vec![effect(None)], None),
            (vec![effect(Some(0.2)), effect(None)], Some("p < 0.05, of 1 tested.")),
            (
                vec![effect(Some(0.2)), effect(Some(0.01))],
                Some(
                    "With p < 0.05, of 2 changes tested: contact.restitution moves Void ratio by \
                     \u{2212}0.123 ± 0.021 for one unit.",
                ),
            ),
        ] {
            of.effects = effects;
            let got = lead(&of);
            match expected {
                Some(expected) => assert!(got.contains(expected), "law: `{expected}`, got {got}"),
                None => assert!(!got.contains("tested"), "law: nothing is tested, got {got}"),
            }
        }
        of.effects = vec![effect(Some(0.01)); 7];
        assert!(lead(&of).contains("unit, 2 more."), "law: five are named, got {}", lead(&of));
    }

    /// Law: a run of which a stage has not been run so far did not fail.
    #[test]
    fn runs_that_are_still_to_be_run_did_not_fail() {
        let mut of = sweep();
        let lead = |of: &Sweep| page(of, vec![]).markdown().lines().nth(2).map(str::to_owned);
        let said = lead(&of).expect("a lead");
        assert!(said.contains("3 of 4 runs have results, 1 failed"), "law: got `{said}`");
        of.runs[3].failure = Some(format!("pour from 50 mm {NOT_STORED}"));
        let said = lead(&of).expect("a lead");
        assert!(said.contains("3 of 4 runs have results, 1 not run so far"), "law: got `{said}`");
        of.runs[3].failure = Some(format!("pour from 50 mm {NOT_STORED}: it blew up"));
        let said = lead(&of).expect("a lead");
        assert!(said.contains(", 1 failed"), "law: what failed did, got `{said}`");
    }

    /// Law: a mean or slope of which every run is left out is no dash, and no number.
    #[test]
    fn where_no_run_is_valid_the_page_says_so() {
        let mut of = sweep();
        for run in &mut of.runs {
            run.outcomes.insert("void_ratio".into(), 0.9);
        }
        let effect = |factor: &str, slope: Option<f64>, runs, left_out| SweepEffect {
            factor: factor.into(),
            outcome: "void_ratio".into(),
            runs,
            left_out,
            slope,
            ..SweepEffect::default()
        };
        let line = |of: &Sweep, start: &str| {
            let page = page(of, vec![]).markdown();
            page.lines().find(|l| l.starts_with(start)).unwrap_or_default().to_owned()
        };
        of.points[0].valid = 0;
        of.points[0].left_out = 3;
        for (slope, runs, left_out, said) in [
            (Some(2.0), 3, 0, "| 2 |"),
            (Some(2.0), 2, 1, "| 2 (left out: 1) |"),
            (None, 0, 3, "| no valid run |"),
            (None, 1, 2, "| too few valid runs |"),
            (None, 1, 0, "| – |"),
        ] {
            of.effects = vec![effect("contact.restitution", slope, runs, left_out)];
            let got = line(&of, "| contact.restitution |");
            assert!(got.contains(said), "law: `{said}`, got `{got}`");
        }
        of.effects = vec![effect("seed", None, 6, 0)];
        let got = line(&of, "| seed |");
        let said = "| none: its numbers only name realisations |";
        assert!(got.contains(said), "law: no dash without a reason, got `{got}`");
        (of.factors[0].path, of.factors[0].numeric) = ("engine.backend".to_owned(), false);
        of.effects = vec![effect("engine.backend", None, 1, 2)];
        let got = line(&of, "| engine.backend |");
        let said = "| none: its values are no numbers |";
        assert!(got.contains(said), "law: more valid runs would give none, got `{got}`");
        of.factors[0].path = "seed".to_owned();
        let got = line(&of, "| point-0001 |");
        assert!(
            got.ends_with("| 3, 1 without result | 0 | 3 | no valid run |"),
            "law: no dash, got `{got}`"
        );
    }
}
