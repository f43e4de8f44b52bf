//! What a convergence study found: every setting beside the finest of its
//! ladder and of the study, as tables and figures.

use super::*;
use crate::{grains::table_csv, record::write_csv};

/// Deviation of a result from a converged one.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Deviation {
    /// In percent of the converged value, over the configurations that both
    /// have; `None` where they have none in common.
    pub percent: Option<Estimate>,
    /// Largest that passes, in percent.
    pub limit_percent: f64,
    /// Whether it passes: the mean, without regard to its scatter.
    pub within: Option<bool>,
    /// Whether it cannot be told from zero, at 95 %; `None` of a single configuration.
    pub inside_scatter: Option<bool>,
    /// Whether scatter leaves open if it passes, at 95 %; `None` of a single configuration.
    pub open: Option<bool>,
}

impl Deviation {
    /// Judges a deviation in percent.
    pub fn judged(percent: Option<Estimate>, limit_percent: f64) -> Self {
        let half = percent.and_then(|p| p.half_width_95());
        let open = percent.zip(half).map(|(p, half)| {
            let size = p.mean.abs();
            size - half <= limit_percent && limit_percent < size + half
        });
        Self {
            percent,
            limit_percent,
            within: percent.map(|p| p.mean.abs() <= limit_percent),
            inside_scatter: percent.and_then(|p| p.inside_scatter()),
            open,
        }
    }

    /// Whether it passes, or may do so for all that is known.
    pub fn may_pass(&self) -> Option<bool> {
        self.within.map(|within| within || self.open == Some(true))
    }
}

/// Deviations of the three lengths that are measured.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Deviations {
    /// Of the height after pouring.
    pub height: Deviation,
    /// Of the settlement of the plate.
    pub plate: Deviation,
    /// Of the settlement of the mean surface.
    pub surface: Deviation,
}

/// One rung of a ladder, judged.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ConvergenceRow {
    /// What the ladder refines.
    pub ladder: String,
    /// The setting in words.
    pub rung: String,
    /// Whether its ladder is compared with it.
    pub finest_of_ladder: bool,
    /// Whether the study is compared with it.
    pub finest_of_study: bool,
    /// Its settings and means.
    pub result: VariationRow,
    /// From the finest rung of its ladder.
    pub from_ladder: Deviations,
    /// From the finest rung of the study.
    pub from_study: Deviations,
    /// The largest of overlap, numerical creep and deviations, each over what is
    /// allowed: 1 at the limit. Where one is not known, that of the others if they
    /// miss by themselves (it is at least as large), else `None`. This and what
    /// follows holds in every ladder that has the setting.
    pub error_over_limit: Option<f64>,
    /// Whether it meets the whole standard by its means.
    pub meets: Option<bool>,
    /// Whether the scatter of a deviation, of overlap or of numerical creep leaves that open; `None`
    /// where the scatter of one is not known.
    pub open: Option<bool>,
}

impl ConvergenceRow {
    /// Whether another row is of the same setting, as a rung of another ladder.
    pub fn same_setting(&self, other: &Self) -> bool {
        self.result.experiment == other.result.experiment
            && self.result.precision == other.result.precision
    }
}

/// Which settings are the cheapest, as numbers of rows.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize)]
pub struct Cheapest {
    /// The cheapest that meets the whole standard by its means.
    pub meeting: Option<usize>,
    /// The cheapest that meets it whatever the scatter.
    pub surely_meeting: Option<usize>,
    /// The cheapest that is not shown to miss it.
    pub not_shown_to_miss: Option<usize>,
}

/// `convergence.json`.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Convergence {
    /// Name of the scenario.
    pub scenario: String,
    /// Whether it was run on the smaller specimen.
    pub quick: bool,
    /// Number of grains of a run.
    pub grains: Option<usize>,
    /// The accuracy standard for overlap and numerical creep.
    pub standard: Standard,
    /// Largest deviation of the height that passes, in percent.
    pub height_limit_percent: f64,
    /// Largest deviation of the settlements that passes, in percent.
    pub settlement_limit_percent: f64,
    /// The ladder whose finest rung stands for the study.
    pub reference: String,
    /// Every rung of every ladder in every precision.
    pub rows: Vec<ConvergenceRow>,
    /// The cheapest settings.
    pub cheapest: Cheapest,
}

impl Convergence {
    /// Runs that are left out of the means, and runs with a result; a setting that stands in
    /// several ladders once.
    pub fn left_out(&self) -> (usize, usize) {
        let settings = self.settings();
        let results = settings.iter().map(|row| &row.result);
        results.fold((0, 0), |(out, all), v| (out + v.left_out, all + v.runs - v.failed))
    }

    /// Every setting once, though it may stand in several ladders.
    pub(super) fn settings(&self) -> Vec<&ConvergenceRow> {
        let mut settings: Vec<&ConvergenceRow> = Vec::new();
        for row in &self.rows {
            if !settings.iter().any(|known| known.same_setting(row)) {
                settings.push(row);
            }
        }
        settings
    }
}

/// Writes `convergence.json`, `convergence.csv`, `convergence.md` and figures.
///
/// # Errors
/// [`ReportError`] naming the file or the figure.
pub fn write_convergence(out: &Path, of: &Convergence) -> Result<(), ReportError> {
    write_csv(&out.join("convergence.csv"), table_csv(records(of)))?;
    write_json(&out.join("convergence.json"), of)?;
    page(of, figures::of_convergence(of)?).write(out, &["convergence.md"])
}

fn records(of: &Convergence) -> impl Iterator<Item = Vec<(String, String)>> {
    of.rows.iter().map(|row| {
        let v = &row.result;
        let mut record = Record::default();
        record.add("ladder", &row.ladder);
        record.add("rung", &row.rung);
        record.add("precision", &v.precision);
        record.add("contact_solver", &v.contact_solver);
        record.add("rate_hz", v.rate_hz);
        record.add("iterations", v.iterations);
        record.add("substeps", v.substeps);
        record.add("contact_stiffness_n_per_m", v.contact_stiffness_n_per_m);
        record.add("runs", v.runs);
        record.add("failed", v.failed);
        record.add("left_out", v.left_out);
        record.add_estimate("poured_height_mm", v.poured_height_mm);
        record.add_estimate("plate_settlement_mm", v.plate_settlement_mm);
        record.add_estimate("surface_settlement_mm", v.surface_settlement_mm);
        record.add_estimate("overlap_mean_percent", v.overlap_mean_percent);
        record.add_estimate("overlap_p99_percent", v.overlap_p99_percent);
        record.add_estimate("creep_um_per_s", v.creep_um_per_s);
        record.add_estimate("wall_s_per_simulated_s", v.wall_s_per_simulated_s);
        for (from, of) in [("ladder", &row.from_ladder), ("study", &row.from_study)] {
            record.add_estimate(&format!("height_from_{from}_percent"), of.height.percent);
            record.add_estimate(&format!("plate_from_{from}_percent"), of.plate.percent);
            record.add_estimate(&format!("surface_from_{from}_percent"), of.surface.percent);
        }
        record.add("error_over_limit", row.error_over_limit);
        record.add("meets", row.meets);
        record.add("open", row.open);
        record.0
    })
}

fn page(of: &Convergence, figures: Vec<Figure>) -> Page {
    let specimen = specimen(&of.scenario, of.grains, of.quick);
    let (left_out, with_result) = of.left_out();
    let said = left_out_in_words(left_out, with_result)
        .map(|said| format!("{said}; why, each run's own summary says (left_out_of_means)."));
    let intro = format!(
        "{specimen}. Heights and settlements in mm, of the mean surface after pouring, of the plate and \
         of the mean surface after 5 s of vibration (at its end, where it is shorter). Means over \
         realisations ± standard error."
    );
    let head = [Block::Text(intro), Block::Banner(said.unwrap_or_default())]
        .into_iter()
        .chain(cheapest(of));
    let mut page = Page::new("Convergence", head);
    let ladders: Vec<&str> = of.rows.iter().map(|row| row.ladder.as_str()).collect();
    for (n, ladder) in ladders.iter().enumerate().filter(|(n, l)| !ladders[..*n].contains(l)) {
        let rows: Vec<&ConvergenceRow> = of.rows.iter().filter(|r| r.ladder == *ladder).collect();
        let table = ladder_table(&rows, of);
        page = page.section(&format!("ladder-{n}"), ladder, [Block::Table(table)]);
    }
    let deviations = format!("Deviations from the finest rung of \"{}\".", of.reference);
    page.section(
        "settings",
        "Every setting, the cheapest first",
        [Block::Text(deviations), Block::Table(against_the_study(of))],
    )
    .section("reading", "How to read it", [Block::Text(how_to_read(of))])
    .figures("figures", "Figures", figures)
}

/// Which specimen a study is of.
pub(super) fn specimen(scenario: &str, grains: Option<usize>, quick: bool) -> String {
    let grains = grains.map_or_else(|| "grains".to_owned(), |n| counted(n, "grain"));
    format!("Scenario `{scenario}`, {grains}{}", if quick { ", the smaller specimen" } else { "" })
}

/// A ladder or rung of a row, with the row's precision where there are several in the study.
pub(super) fn with_precision(name: &str, row: &ConvergenceRow, of: &Convergence) -> String {
    let precision = &row.result.precision;
    match of.rows.iter().any(|r| r.result.precision != of.rows[0].result.precision) {
        true => format!("{name}, {precision}"),
        false => name.to_owned(),
    }
}

/// A ladder and a rung of it.
fn setting(row: &ConvergenceRow, of: &Convergence) -> String {
    let rung = with_precision(&row.rung, row, of);
    let ending = if rung == row.rung { "" } else { " precision" };
    format!("{}: {rung}{ending}", row.ladder)
}

fn cheapest(of: &Convergence) -> [Block; 2] {
    let said = |number: Option<usize>| {
        let Some(row) = number.and_then(|n| of.rows.get(n)) else { return "none".to_owned() };
        let cost = row.result.wall_s_per_simulated_s.map_or(f64::NAN, |c| c.mean);
        let name = setting(row, of);
        let finest = match row.finest_of_study {
            true => ", which is what all others are compared with",
            false => "",
        };
        format!("**{name}** ({} s per simulated second{finest})", compact(cost))
    };
    let standard = format!(
        "The whole standard: overlap below {} % in the mean and {} % at its 99th percentile, numerical \
         creep below {} µm/s, the height within {} % and both settlements within {} % of the finest rung, of \
         the setting's own ladder and of the ladder \"{}\".",
        compact(of.standard.overlap_mean_percent),
        compact(of.standard.overlap_p99_percent),
        compact(of.standard.creep_um_per_s),
        compact(of.height_limit_percent),
        compact(of.settlement_limit_percent),
        of.reference,
    );
    let settings = [
        ("cheapest setting that meets it by its means", of.cheapest.meeting),
        ("cheapest of which scatter leaves no doubt", of.cheapest.surely_meeting),
        ("cheapest that is not shown to miss it", of.cheapest.not_shown_to_miss),
    ];
    let settings = settings.map(|(what, row)| format!("{what}: {}", said(row)));
    [Block::Text(standard), Block::List(settings.into())]
}

fn ladder_table(rows: &[&ConvergenceRow], of: &Convergence) -> Table {
    table!(rows.iter().map(|row| (row, &row.result, row.from_ladder)), |(row, v, from)| {
        "setting" => with_precision(&row.rung, row, of),
        "runs; grains outside" => runs(v),
        "height" => length(v, v.poured_height_mm),
        "%" => deviation(&from.height, v, v.poured_height_mm, row.finest_of_ladder),
        "plate" => length(v, v.plate_settlement_mm),
        "%" => deviation(&from.plate, v, v.plate_settlement_mm, row.finest_of_ladder),
        "surface" => length(v, v.surface_settlement_mm),
        "%" => deviation(&from.surface, v, v.surface_settlement_mm, row.finest_of_ladder),
        "overlap mean / p99, %" => [v.overlap_mean_percent, v.overlap_p99_percent]
            .map(rounded)
            .join(" / "),
        "numerical creep, µm/s" => Cell::number(rounded(v.creep_um_per_s)),
        "s per simulated s" => Cell::compact(mean(v.wall_s_per_simulated_s)),
        "standard" => verdict(row),
    })
}

fn runs(v: &VariationRow) -> String {
    let outside = v.grains_outside.filter(|g| g.mean > 0.0);
    let outside = outside.map_or_else(String::new, |g| format!("; {}", number(g.mean, 1)));
    format!("{}{}{}{outside}", v.runs, besides(v.failed, "failed"), besides(v.left_out, "left out"))
}

fn against_the_study(of: &Convergence) -> Table {
    let mut rows = of.settings();
    let cost = |r: &ConvergenceRow| mean(r.result.wall_s_per_simulated_s).unwrap_or(f64::MAX);
    rows.sort_by(|a, b| cost(a).total_cmp(&cost(b)));
    table!(rows.iter().map(|row| (row, &row.result, row.from_study)), |(row, v, from)| {
        "setting" => setting(row, of),
        "s per simulated s" => Cell::compact(mean(v.wall_s_per_simulated_s)),
        "height, %" => deviation(&from.height, v, v.poured_height_mm, row.finest_of_study),
        "plate, %" => deviation(&from.plate, v, v.plate_settlement_mm, row.finest_of_study),
        "surface, %" => deviation(&from.surface, v, v.surface_settlement_mm, row.finest_of_study),
        "largest error over its limit" => Cell::compact(row.error_over_limit),
        "standard" => verdict(row),
    })
}

fn how_to_read(of: &Convergence) -> String {
    format!(
        "A packing is chaotic: one bit changed gives another packing. Deviations are means over \
         realisations, paired, with their standard error. \"~\" marks a deviation that lies \
         inside the scatter: its 95 % confidence interval (Student's t) contains zero. **Bold** is \
         beyond the limit of {} % (height) or {} % (settlements); \"?\" says that scatter leaves \
         open whether it is. Values without ± are of one run, which gives no scatter. \
         \"reference\" is the finest rung, from which nothing can deviate: what its own ladder \
         does not refine may still be wrong. Left out are runs with a result that do not count \
         in means (docs/accuracy.md): heights, settlements and deviations are without \
         them; overlap, numerical creep, grains outside and times are of all runs; otherwise a setting \
         could pass because its bad runs are left out. A setting with a run in which a run-time check \
         found something or grains had not settled misses the standard, as one with a run that failed. \
         Grains outside are \
         those that do not lie in the cylinder at the end, in the mean over runs: a jam in the \
         funnel lowers the specimen by what is stuck there. Numerical creep is without its sign. \
         \"standard\" takes everything together, with the deviations from both references: \
         \"open\" where the 95 % confidence interval of a deviation, or of a mean of overlap or \
         numerical creep, contains its limit.",
        compact(of.height_limit_percent),
        compact(of.settlement_limit_percent)
    )
}

fn verdict(row: &ConvergenceRow) -> &'static str {
    match (row.meets, row.open) {
        (Some(true), Some(false)) => "met",
        (Some(true), Some(true)) => "met, open",
        (Some(true), None) => "met, scatter unknown",
        (Some(false), _) => "missed",
        (None, _) => "not known",
    }
}

fn mean(estimate: Option<Estimate>) -> Option<f64> {
    estimate.map(|e| e.mean)
}

/// A mean without its standard error, to the second digit of that.
fn rounded(of: Option<Estimate>) -> String {
    of.map_or_else(dash, |e| scattered(e.mean, e.standard_error.unwrap_or_default()))
}

fn length(of: &VariationRow, mean: Option<Estimate>) -> String {
    let shown = |e: Estimate| mean_within(e.mean, e.standard_error);
    mean.map_or_else(|| missing(of.has_no_valid_run()), shown)
}

/// A deviation, bold beyond its limit, marked where scatter explains it or leaves it open.
fn deviation(d: &Deviation, of: &VariationRow, own: Option<Estimate>, reference: bool) -> String {
    match (own, d.percent) {
        (None, _) if of.has_no_valid_run() => missing(true),
        // Not measured, as the plate of a scenario without one: no reference either.
        (None, None) => dash(),
        _ if reference => "reference".to_owned(),
        // Its own runs count, and none of the reference's of the same configurations.
        (Some(_), None) => "no valid pair".to_owned(),
        (_, Some(percent)) => {
            let bold = if d.within == Some(false) { "**" } else { "" };
            let scatter = if d.inside_scatter == Some(true) { " ~" } else { "" };
            let open = if d.open == Some(true) { " ?" } else { "" };
            let shown = mean_within(percent.mean, percent.standard_error);
            format!("{bold}{shown}{bold}{scatter}{open}")
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::record::RunRow;

    /// Law: means and deviations have the second digit of their standard error, as those of sand,
    /// which differ by hundredths of a millimetre; of one run, four digits.
    #[test]
    fn digits_follow_from_the_scatter() {
        let of = |mean, standard_error| Estimate { mean, standard_error, count: 3 };
        let run = RunRow {
            poured_height_mm: Some(3.5),
            meets_standard: Some(true),
            valid: Some(true),
            ..RunRow::default()
        };
        let v = VariationRow::of(&[run]).remove(0);
        for (mean, error, expected) in [
            (3.53, Some(0.0104), "3.530 ± 0.010"),
            (162.38, Some(0.74), "162.38 ± 0.74"),
            (162.38, None, "162.4"),
        ] {
            let got = length(&v, Some(of(mean, error)));
            assert_eq!(got, expected, "law: {mean} within {error:?}");
        }
        for (mean, error, expected) in [
            (-0.0234, Some(0.0112), "\u{2212}0.023 ± 0.011 ~"),
            (2.0, Some(0.0112), "**2.000 ± 0.011**"),
            (0.02341, None, "0.02341"),
        ] {
            let d = Deviation::judged(Some(of(mean, error)), 1.0);
            let got = deviation(&d, &v, v.poured_height_mm, false);
            assert_eq!(got, expected, "law: a deviation of {mean} % within {error:?}");
        }
        for (error, expected) in [(Some(0.03), "0.214"), (Some(0.0021), "0.2136"), (None, "0.2136")]
        {
            let got = rounded(Some(of(0.213_58, error)));
            assert_eq!(got, expected, "law: an overlap within {error:?}");
        }
        assert_eq!(rounded(None), "–", "law: what was not measured has no digits");
        let none = Deviation::judged(None, 1.0);
        for (own, expected) in [(v.poured_height_mm, "reference"), (None, "–")] {
            let got = deviation(&none, &v, own, true);
            assert_eq!(got, expected, "law: the finest rung is the reference of what it has");
        }
    }
}
