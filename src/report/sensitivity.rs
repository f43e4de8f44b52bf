//! What a sensitivity study found: how far each parameter moves height and
//! settlement, as tables and a ranked figure.

use super::convergence::specimen;
use super::*;
use crate::{grains::table_csv, record::write_csv, scenario::Scenario};

/// How far a parameter moves a length, in mm. Differences are paired by
/// configuration.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Effect {
    /// At the low end less at the default.
    pub low_mm: Option<Estimate>,
    /// At the high end less at the default.
    pub high_mm: Option<Estimate>,
    /// At the high end less at the low end.
    pub range_mm: Option<Estimate>,
    /// That over the range, for one unit of the parameter; `None` where its numbers only name
    /// realisations.
    pub per_unit_mm: Option<Estimate>,
    /// Half of its 95 % confidence interval by Student's t; `None` of a single configuration.
    pub per_unit_half_width_95_mm: Option<f64>,
    /// The largest of the three differences, by which parameters are ranked.
    pub largest_mm: Option<Estimate>,
    /// Whether none of the three can be told from zero, at 95 % for all of them together (one
    /// where an end of the range is the default); `None` of a single configuration.
    pub inside_scatter: Option<bool>,
}

impl Effect {
    fn size(&self) -> f64 {
        self.largest_mm.map_or(-1.0, |l| l.mean.abs())
    }
}

/// One parameter.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ParameterRow {
    /// Its short name.
    pub parameter: String,
    /// What it is.
    pub title: String,
    /// Unit of its values.
    pub unit: String,
    /// Why it was varied so far.
    pub reason: String,
    /// Path of its value in the scenario; empty where several are changed.
    pub path: String,
    /// Low end of its range.
    pub low: f64,
    /// The scenario's value.
    pub default: f64,
    /// High end of its range.
    pub high: f64,
    /// Runs at its ends that failed.
    pub failed: usize,
    /// Runs at its ends whose results are left out of the differences.
    pub left_out: usize,
    /// Runs at its ends that count.
    pub valid: usize,
    /// Grains of a run that are not in the cylinder at the end, in the mean
    /// over the runs of the end that has more of them.
    pub grains_outside: Option<f64>,
    /// On the height of the mean surface after pouring.
    pub height: Effect,
    /// On the settlement of the plate after 5 s, or at the end of a shorter vibration.
    pub plate: Effect,
    /// On that of the mean surface.
    pub surface: Effect,
}

/// What a parameter moves: its name in tables, its title, which effect of a row that is, and its
/// mean without a change.
type Outcome = (
    &'static str,
    &'static str,
    fn(&ParameterRow) -> Effect,
    fn(&VariationRow) -> Option<Estimate>,
);

const OUTCOMES: [Outcome; 3] = [
    ("height", "Height after pouring", |r| r.height, |d| d.poured_height_mm),
    ("plate_settlement", "Settlement of the plate", |r| r.plate, |d| d.plate_settlement_mm),
    (
        "surface_settlement",
        "Settlement of the mean surface",
        |r| r.surface,
        |d| d.surface_settlement_mm,
    ),
];

/// `sensitivity.json`.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Sensitivity {
    /// Name of the scenario.
    pub scenario: String,
    /// Whether it was run on the smaller specimen.
    pub quick: bool,
    /// Number of grains of a run.
    pub grains: Option<usize>,
    /// Number of configurations.
    pub configurations: u32,
    /// Runs that have a result.
    pub with_result: usize,
    /// How many of them are left out of the differences.
    pub left_out: usize,
    /// The scenario without a change.
    pub default: Option<VariationRow>,
    /// The parameters, in the order of the design.
    pub parameters: Vec<ParameterRow>,
}

impl Sensitivity {
    /// What page and figure show: outcomes that some run has, as no settlement of a scenario that
    /// does not vibrate; all of them where no run has any.
    pub(super) fn shown(&self) -> Vec<Outcome> {
        let has = |(_, _, effect, mean): &&Outcome| {
            self.parameters.iter().any(|row| effect(row).largest_mm.is_some())
                || self.default.as_ref().and_then(mean).is_some()
        };
        let measured: Vec<Outcome> = OUTCOMES.iter().filter(has).copied().collect();
        if measured.is_empty() { OUTCOMES.to_vec() } else { measured }
    }
}

/// The parameters, that with the largest effect first; those without one last.
pub(super) fn ranked(
    rows: &[ParameterRow],
    effect: impl Fn(&ParameterRow) -> Effect,
) -> Vec<&ParameterRow> {
    let mut ranked: Vec<&ParameterRow> = rows.iter().collect();
    ranked.sort_by(|a, b| effect(b).size().total_cmp(&effect(a).size()));
    ranked
}

/// Writes `sensitivity.json`, `sensitivity.csv`, `sensitivity.md` and the figure.
///
/// # Errors
/// [`ReportError`] naming the file or the figure.
pub fn write_sensitivity(out: &Path, of: &Sensitivity) -> Result<(), ReportError> {
    write_csv(&out.join("sensitivity.csv"), table_csv(records(of)))?;
    write_json(&out.join("sensitivity.json"), of)?;
    page(of, figures::of_sensitivity(of)?).write(out, &["sensitivity.md"])
}

fn records(of: &Sensitivity) -> impl Iterator<Item = Vec<(String, String)>> {
    of.parameters.iter().map(|row| {
        let mut record = Record::default();
        record.add("parameter", &row.parameter);
        record.add("unit", &row.unit);
        record.add("path", &row.path);
        record.add("low", row.low);
        record.add("default", row.default);
        record.add("high", row.high);
        record.add("failed", row.failed);
        record.add("left_out", row.left_out);
        record.add("grains_outside", row.grains_outside);
        for (outcome, _, effect, _) in OUTCOMES {
            let e = effect(row);
            record.add_estimate(&format!("{outcome}_low_minus_default_mm"), e.low_mm);
            record.add_estimate(&format!("{outcome}_high_minus_default_mm"), e.high_mm);
            record.add_estimate(&format!("{outcome}_high_minus_low_mm"), e.range_mm);
            record.add_estimate(&format!("{outcome}_per_unit_mm"), e.per_unit_mm);
            record.add_estimate(&format!("{outcome}_largest_mm"), e.largest_mm);
            let half_width = e.per_unit_half_width_95_mm;
            record.add(format!("{outcome}_per_unit_mm_half_width_95"), half_width);
            record.add(format!("{outcome}_inside_scatter"), e.inside_scatter);
        }
        record.0
    })
}

fn page(of: &Sensitivity, figure: Figure) -> Page {
    let intro = format!(
        "{}, {}. Each parameter is varied by itself, all others at their defaults. \
         Differences in mm ± standard error, paired by realisation: runs of a pair have the same \
         grains in the same order; changes of `seed` or `configuration` make no such pairs, and \
         scatter as single runs do. A packing is chaotic, so that pairs scatter; \"~\" marks an \
         effect that lies inside that scatter: none of its differences (both ends and the range, \
         or one where an end is the default) can be told from zero, at 95 % for all of them together \
         (Student's t, Bonferroni). Parameters are ranked by their largest difference. Grains \
         outside are those that do not lie in the cylinder at the end: a jam in the funnel lowers \
         the specimen by what is stuck there. Runs that do not count in means are left out of \
         every difference with their pair (docs/accuracy.md), and counted.",
        specimen(&of.scenario, of.grains, of.quick),
        counted(of.configurations as usize, "realisation"),
    );
    let default = of.default.as_ref().map(without_a_change).unwrap_or_default();
    let ranges = table!(&of.parameters, |p| {
        "parameter" => &p.title,
        "from" => with_unit(&compact(p.low), &p.unit),
        "default" => with_unit(&compact(p.default), &p.unit),
        "to" => with_unit(&compact(p.high), &p.unit),
        "why" => &p.reason,
    });
    let mut page = Page::new("Sensitivity", [Block::Text(intro), Block::Text(default)]).figures(
        "figure",
        "Figure",
        [figure],
    );
    for (outcome, title, effect, _) in of.shown() {
        page = page.section(outcome, title, [Block::Table(effects(of, effect))]);
    }
    page.section("ranges", "Ranges", [Block::Table(ranges)])
}

/// Results of the scenario as it is.
fn without_a_change(default: &VariationRow) -> String {
    let spread = |e: Option<Estimate>| {
        let Some(e) = e else { return missing(default.has_no_valid_run()) };
        let deviation = e.standard_error.map(|error| error * (e.count as f64).sqrt());
        match deviation {
            Some(s) => format!("{} (standard deviation {})", scattered(e.mean, s), scattered(s, s)),
            None => compact(e.mean),
        }
    };
    let left_out = match default.left_out {
        0 => String::new(),
        n => format!("; left out of these means: {n} of {}", counted(default.runs, "run")),
    };
    format!(
        "Without a change, over realisations, in mm: height {}, settlement of the plate {}, of the \
         surface {}{left_out}.",
        spread(default.poured_height_mm),
        spread(default.plate_settlement_mm),
        spread(default.surface_settlement_mm),
    )
}

fn effects(of: &Sensitivity, effect: fn(&ParameterRow) -> Effect) -> Table {
    let default_left_out = of.default.as_ref().is_some_and(|d| d.left_out > 0);
    let rows = ranked(&of.parameters, effect).into_iter().map(|row| (row, effect(row)));
    let change = |row: &ParameterRow, e: Option<Estimate>, shown: fn(Estimate) -> String| match e {
        Some(e) => shown(e),
        None if row.left_out > 0 && row.valid == 0 => missing(true),
        None if row.left_out > 0 || default_left_out => "no valid pair".to_owned(),
        None => dash(),
    };
    let shown = |e: Estimate| mean_within(e.mean, e.standard_error);
    // What is compared with itself is no result.
    let at_end = |row: &ParameterRow, value: f64, e: Option<Estimate>| {
        if value == row.default { "default".to_owned() } else { change(row, e, shown) }
    };
    let for_one_unit =
        |row: &ParameterRow, e: Option<Estimate>| match Scenario::names_realisations(&row.path) {
            true => NO_UNIT.to_owned(),
            false => change(row, e, shown),
        };
    table!(rows, |(row, e)| {
        "parameter" => &row.title,
        "range" => with_unit(&from_to(row.low, row.high), &row.unit),
        "at the low end" => Cell::number(at_end(row, row.low, e.low_mm)),
        "at the high end" => Cell::number(at_end(row, row.high, e.high_mm)),
        "over the range" => Cell::number(change(row, e.range_mm, shown)),
        "for one unit" => Cell::number(for_one_unit(row, e.per_unit_mm)),
        "remarks" => remarks(row, &e),
    })
}

fn remarks(row: &ParameterRow, effect: &Effect) -> String {
    let scatter = match (effect.largest_mm, effect.inside_scatter) {
        (_, Some(true)) => Some("~".to_owned()),
        (Some(_), None) => Some("scatter unknown".to_owned()),
        (_, Some(false)) | (None, None) => None,
    };
    let failed = (row.failed > 0).then(|| format!("{} failed", row.failed));
    let left_out = (row.left_out > 0).then(|| format!("{} left out", row.left_out));
    let outside = row.grains_outside.filter(|g| *g >= 0.5);
    let outside = outside.map(|g| format!("grains outside: {}", number(g, 1)));
    [failed, left_out, scatter, outside].into_iter().flatten().collect::<Vec<_>>().join(", ")
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A row whose parameter moves every length by as much.
    fn row(name: &str, low: Option<f64>, high: Option<f64>) -> ParameterRow {
        let of = |mean: Option<f64>| {
            mean.map(|mean| Estimate { mean, standard_error: Some(0.4), count: 3 })
        };
        let range = low.zip(high).map(|(l, h)| h - l);
        let largest =
            [range, low, high].into_iter().flatten().max_by(|a, b| a.abs().total_cmp(&b.abs()));
        let effect = Effect {
            low_mm: of(low),
            high_mm: of(high),
            range_mm: of(range),
            per_unit_mm: of(range),
            per_unit_half_width_95_mm: of(range).and_then(|e| e.half_width_95()),
            largest_mm: of(largest),
            inside_scatter: of(largest).and_then(|e| e.inside_scatter()),
        };
        ParameterRow {
            parameter: name.to_owned(),
            title: format!("Title of {name}"),
            unit: "mm".to_owned(),
            reason: "A reason.".to_owned(),
            path: "a.path".to_owned(),
            low: 1.0,
            default: 2.0,
            high: 3.0,
            failed: 0,
            left_out: 0,
            valid: 6,
            grains_outside: Some(0.0),
            height: effect,
            plate: effect,
            surface: effect,
        }
    }

    fn study(parameters: Vec<ParameterRow>) -> Sensitivity {
        Sensitivity {
            scenario: "test".to_owned(),
            quick: false,
            grains: Some(364),
            configurations: 3,
            with_result: 0,
            left_out: 0,
            default: None,
            parameters,
        }
    }

    /// The page of a study.
    fn page_of(study: &Sensitivity) -> String {
        page(study, figures::of_sensitivity(study).expect("a figure")).markdown()
    }

    #[test]
    fn the_largest_effect_comes_first_whatever_its_sign() {
        let rows = [
            row("small", Some(-0.5), Some(0.5)),
            row("failed", None, None),
            row("falls", Some(4.0), Some(-3.0)),
            row("rises", Some(-2.0), Some(3.0)),
        ];
        let names: Vec<&str> =
            ranked(&rows, |r| r.height).iter().map(|r| r.parameter.as_str()).collect();
        assert_eq!(names, ["falls", "rises", "small", "failed"], "law: by size, unknown last");
    }

    #[test]
    fn every_file_is_written_and_says_what_lies_inside_the_scatter() {
        let folder = tempfile::tempdir().expect("a folder");
        let rows = vec![row("small", Some(-0.5), Some(0.5)), row("rises", Some(-2.0), Some(3.0))];
        write_sensitivity(folder.path(), &study(rows)).expect("written");
        for file in ["sensitivity.csv", "sensitivity.json", "figures/sensitivity.png"] {
            assert!(folder.path().join(file).is_file(), "{file} is written");
        }
        let figure = std::fs::read_to_string(folder.path().join("figures/sensitivity.svg"));
        let figure = figure.expect("a figure");
        for entry in ["At the low end", "At the high end"] {
            assert!(figure.contains(entry), "law: entries of legends begin so: `{entry}`");
        }
        let page = std::fs::read_to_string(folder.path().join("sensitivity.md")).expect("a page");
        let line = |name: &str| {
            page.lines().find(|l| l.starts_with(&format!("| Title of {name}"))).expect("a row")
        };
        assert!(line("small").contains('~'), "law: 1 ± 0.4 of three is marked: {page}");
        assert!(!line("rises").contains('~'), "law: 5 ± 0.4 of three is not: {page}");
        assert!(
            page.find("Title of rises") < page.find("Title of small"),
            "law: the largest first: {page}"
        );
    }

    /// Law: of a specimen of sand, whose heights differ by hundredths of a millimetre, the page says by
    /// how many.
    #[test]
    fn differences_are_shown_to_the_second_digit_of_their_error() {
        let folder = tempfile::tempdir().expect("a folder");
        let of = |mean, error| Some(Estimate { mean, standard_error: Some(error), count: 3 });
        let sand = row("sand", Some(-0.0234), Some(0.0312));
        let height = Effect {
            low_mm: of(-0.0234, 0.0112),
            high_mm: of(0.0312, 0.0087),
            range_mm: of(0.0546, 0.0049),
            ..sand.height
        };
        let sand = ParameterRow { height, ..sand };
        write_sensitivity(folder.path(), &study(vec![sand])).expect("written");
        let page = std::fs::read_to_string(folder.path().join("sensitivity.md")).expect("a page");
        let expected = "| −0.023 ± 0.011 | 0.0312 ± 0.0087 | 0.0546 ± 0.0049 |";
        assert!(page.contains(expected), "law: {expected}, got {page}");
    }

    /// Law: the scatter of an effect that was measured once is not known; of none there is nothing to
    /// be known.
    #[test]
    fn what_has_no_effect_has_no_scatter() {
        let mut once = row("once", Some(-0.5), Some(0.5));
        once.height.inside_scatter = None;
        let never = row("never", None, None);
        let page = page_of(&study(vec![once, never]));
        let table = page.split("## Height").nth(1).unwrap_or_default();
        let line = |name: &str| table.lines().find(|l| l.contains(name)).unwrap_or_default();
        assert!(line("of once").ends_with("| scatter unknown |"), "law: once, got {table}");
        assert!(line("of never").ends_with("|  |"), "law: never, got {table}");
    }

    /// Law: what no run has is left out of page and figure, unless no run has anything.
    #[test]
    fn what_is_not_measured_has_no_table() {
        let none = row("none", None, None).plate;
        let poured = ParameterRow { plate: none, surface: none, ..row("poured", Some(1.0), None) };
        let titles = OUTCOMES.map(|(_, title, ..)| title);
        for (of, expected) in [
            (study(vec![poured]), vec![titles[0]]),
            (study(vec![row("failed", None, None)]), titles.to_vec()),
        ] {
            let figure = figures::of_sensitivity(&of).expect("a figure").svg;
            let page = page_of(&of);
            for title in titles {
                let is_there = page.contains(&format!("## {title}"));
                assert_eq!(is_there, expected.contains(&title), "law: table of {title}: {page}");
                let is_drawn = figure.contains(&format!("{title}, change (mm)"));
                assert_eq!(is_drawn, expected.contains(&title), "law: panel of {title}");
            }
        }
    }

    /// Law: an end that is the default is not compared with itself.
    #[test]
    fn an_end_that_is_the_default_says_so() {
        let low = ParameterRow { low: 2.0, ..row("low", Some(0.0), Some(1.0)) };
        let high = ParameterRow { high: 2.0, ..row("high", Some(-1.0), Some(0.0)) };
        let page = page_of(&study(vec![low, high]));
        for expected in ["| 2 to 3 mm | default | 1.00 ± 0.40 |", "| −1.00 ± 0.40 | default |"]
        {
            assert!(page.contains(expected), "law: `{expected}`, got {page}");
        }
    }

    /// Law: a number that only names a realisation has no unit.
    #[test]
    fn a_realisation_has_no_change_for_one_unit() {
        let row = row("chance", Some(-0.5), Some(0.5));
        let of = |path: &str| {
            let row = ParameterRow { path: path.to_owned(), ..row.clone() };
            page_of(&study(vec![row]))
        };
        let changes = "| −0.50 ± 0.40 | 0.50 ± 0.40 | 1.00 ± 0.40 | ";
        for path in ["seed", "configuration"] {
            let page = of(path);
            let expected = format!("{changes}none: its numbers only name realisations |");
            assert!(page.contains(&expected), "law: `{expected}`, got {page}");
        }
        let page = of("contact.restitution");
        let expected = format!("{changes}1.00 ± 0.40 |");
        assert!(page.contains(&expected), "law: `{expected}`, got {page}");
    }

    #[test]
    fn what_is_left_out_is_told_and_no_effect_is_no_dash() {
        let folder = tempfile::tempdir().expect("a folder");
        let some = ParameterRow { left_out: 1, valid: 5, ..row("some", Some(-0.5), Some(0.5)) };
        let all = ParameterRow { left_out: 6, valid: 0, ..row("all", None, None) };
        write_sensitivity(folder.path(), &study(vec![some, all])).expect("written");
        let page = std::fs::read_to_string(folder.path().join("sensitivity.md")).expect("a page");
        let line = |name: &str| {
            page.lines().find(|l| l.starts_with(&format!("| Title of {name}"))).expect("a row")
        };
        assert!(line("some").contains("1 left out"), "law: counted: {page}");
        assert!(!line("some").contains("no valid run"), "law: five count: {page}");
        let all = line("all");
        assert!(all.contains("6 left out") && all.contains("| no valid run |"), "law: {page}");
        assert!(!all.contains('–'), "law: no dash: {page}");
    }

    #[test]
    fn a_study_of_which_everything_failed_is_still_written() {
        let folder = tempfile::tempdir().expect("a folder");
        let of = study(vec![row("failed", None, None)]);
        write_sensitivity(folder.path(), &of).expect("written");
    }
}
