//! Results against the rate, deviations of every setting, cost against error.

use super::*;
use crate::in_order::grouped;
use crate::report::convergence::with_precision;

/// Height given to a setting, in SVG units.
const ROW: u32 = 66;

pub(in crate::report) fn of_convergence(of: &Convergence) -> Result<Vec<Figure>, ReportError> {
    let lines = lines(of);
    let mut figures = Vec::new();
    if !lines.is_empty() {
        for shown in &SHOWN {
            figures.push(against_rate(of, &lines, shown)?);
        }
    }
    figures.extend([deviations(of)?, cost(of)?]);
    Ok(figures)
}

type Value = fn(&VariationRow) -> Option<Estimate>;

/// What a figure against the rate shows; on a logarithmic axis where there are limits.
struct Shown {
    stem: &'static str,
    title: &'static str,
    axis: &'static str,
    caption: &'static str,
    value: Value,
    percentile: Option<Value>,
    limits: fn(&Standard) -> Vec<(String, f64)>,
}

const LENGTH: Shown = Shown {
    stem: "convergence-height",
    title: "Standing height against the step rate",
    axis: "Height of the mean surface (mm)",
    caption: "Height of the mean surface after pouring.",
    value: |v| v.poured_height_mm,
    percentile: None,
    limits: |_| Vec::new(),
};

const SHOWN: [Shown; 5] = [
    LENGTH,
    Shown {
        stem: "convergence-plate-settlement",
        title: "Settlement of the plate against the step rate",
        axis: "Settlement of the plate (mm)",
        caption: "Settlement of the top plate after 5 s of vibration, or at the end of a shorter one.",
        value: |v| v.plate_settlement_mm,
        ..LENGTH
    },
    Shown {
        stem: "convergence-surface-settlement",
        title: "Settlement of the mean surface against the step rate",
        axis: "Settlement of the surface (mm)",
        caption: "Settlement of the mean surface after 5 s of vibration, or at the end of a shorter one.",
        value: |v| v.surface_settlement_mm,
        ..LENGTH
    },
    Shown {
        stem: "convergence-overlap",
        title: "Overlap against the step rate",
        axis: "Overlap (% of the equivalent diameter)",
        caption: "Overlap at the end, exact, measured outside the engine: mean (solid) and 99th \
                  percentile (dashed). What the accuracy standard allows: dotted in the mean, dashed \
                  and dotted at the percentile.",
        value: |v| v.overlap_mean_percent,
        percentile: Some(|v| v.overlap_p99_percent),
        limits: |s| {
            vec![
                (format!("Standard, mean: {} %", s.overlap_mean_percent), s.overlap_mean_percent),
                (format!("99th percentile: {} %", s.overlap_p99_percent), s.overlap_p99_percent),
            ]
        },
    },
    Shown {
        stem: "convergence-creep",
        title: "Numerical creep against the step rate",
        axis: "Numerical creep at rest (µm/s)",
        caption: "Numerical creep in the rest test, without its sign. Dotted: what the accuracy standard \
                  allows.",
        value: |v| v.creep_um_per_s,
        limits: |s| vec![(format!("Standard: {} µm/s", s.creep_um_per_s), s.creep_um_per_s)],
        ..LENGTH
    },
];

/// A ladder in a precision: its name, with the precision where there are several, and its rungs.
type Ladder<'a> = (String, Vec<&'a ConvergenceRow>);

/// Ladders that refine the rate, in every precision.
fn lines(of: &Convergence) -> Vec<Ladder<'_>> {
    ladders(of)
        .into_iter()
        .filter(|(_, rows)| rows.iter().any(|r| r.result.rate_hz != rows[0].result.rate_hz))
        .collect()
}

/// Every ladder in every precision.
fn ladders(of: &Convergence) -> Vec<Ladder<'_>> {
    grouped(of.rows.iter().map(|row| (with_precision(&row.ladder, row, of), row)))
}

fn against_rate(of: &Convergence, lines: &[Ladder], shown: &Shown) -> Result<Figure, ReportError> {
    let limits = (shown.limits)(&of.standard);
    let is_log = !limits.is_empty();
    let mut curves: Vec<(&str, Dash, Value)> = vec![("", style::SOLID, shown.value)];
    curves.extend(shown.percentile.map(|value| ("99th percentile", style::DASHED, value)));
    let mut plot = Plot::new(rate_axis(lines), Axis::scaled(is_log, shown.axis));
    let mut table = Table::new(["line", "rate_hz", "what", "value", "standard_error", "runs"]);
    for (n, (line, rows)) in lines.iter().enumerate() {
        for (name, dash, value) in &curves {
            let mut points = Vec::new();
            for row in rows {
                let rate = row.result.rate_hz;
                let Some(Estimate { mean, standard_error, count }) = value(&row.result) else {
                    continue;
                };
                points.push((rate, mean));
                if let Some(error) = standard_error {
                    // On a logarithmic axis zero has no place.
                    let low = if is_log && mean - error <= 0.0 { mean } else { mean - error };
                    let ends = vec![(rate, low), (rate, mean + error)];
                    plot.add("", Look::line(n).thin(), ends);
                }
                table.row(row![line, rate, *name, mean, standard_error, count]);
            }
            let label = if name.is_empty() { line.as_str() } else { "" };
            plot.add_some(label, Look::marked(n).dash(dash), points);
        }
    }
    limits.into_iter().for_each(|(label, at)| plot.mark_level(label, at));
    let caption = format!(
        "{} Means over realisations; upright lines: ± standard error. One line a ladder of rates.",
        shown.caption
    );
    Figure::new(shown.stem, shown.title, caption, &[plot], &table)
}

/// A logarithmic axis numbered at the rates themselves.
fn rate_axis(lines: &[Ladder]) -> Axis {
    let mut rates: Vec<f64> =
        lines.iter().flat_map(|(_, rows)| rows.iter().map(|r| r.result.rate_hz)).collect();
    rates.sort_by(f64::total_cmp);
    rates.dedup();
    let name = "Steps per second (Hz)";
    let (Some(low), Some(high)) = (rates.first(), rates.last()) else {
        return Axis::logarithmic(name);
    };
    let (from, to) = (low / 1.15, high * 1.15);
    Axis::divided(name, Scale { from, to, log: true, ticks: rates, minor: Vec::new() })
}

/// What deviates: its entry in the legend, its name in the table, its value,
/// and how far it is drawn below the middle of its line.
type Part = (&'static str, &'static str, fn(&ConvergenceRow) -> Deviation, f64);

/// Deviations from the finest rung of each ladder, one line a setting.
fn deviations(of: &Convergence) -> Result<Figure, ReportError> {
    let (names, rows): (Vec<String>, Vec<&ConvergenceRow>) = ladders(of)
        .into_iter()
        .flat_map(|(name, rows)| rows.into_iter().map(move |r| (format!("{name}: {}", r.rung), r)))
        .filter(|(_, row)| !row.finest_of_ladder)
        .unzip();
    let parts: [Part; 3] = [
        ("Height", "height", |r| r.from_ladder.height, -0.22),
        ("Settlement of the plate", "plate", |r| r.from_ladder.plate, 0.0),
        ("Settlement of the surface", "surface", |r| r.from_ladder.surface, 0.22),
    ];
    let x = Axis::linear("Deviation from the finest rung (%)");
    let mut plot = Plot::of_rows(x, names.clone(), ROW);
    let mut table =
        Table::new(["setting", "what", "deviation_percent", "standard_error", "inside_scatter"]);
    for (n, (label, what, value, offset)) in parts.into_iter().enumerate() {
        let mut points = Vec::new();
        for (i, (setting, row)) in names.iter().zip(&rows).enumerate() {
            let deviation = value(row);
            let Some(Estimate { mean, standard_error, .. }) = deviation.percent else { continue };
            let at = i as f64 + offset;
            points.push((mean, at));
            if let Some(error) = standard_error {
                plot.add("", Look::line(n).thin(), vec![(mean - error, at), (mean + error, at)]);
            }
            table.row(row![setting, what, mean, standard_error, deviation.inside_scatter]);
        }
        plot.add_some(label, Look::points(n), points);
    }
    for limit in [of.height_limit_percent, of.settlement_limit_percent] {
        plot.mark_bounds(&format!("± {limit} %"), limit);
    }
    let title = "Deviation of every setting from the finest of its ladder";
    let caption = format!(
        "Deviations from the finest rung of each ladder, paired by realisation, ± standard \
         error. Dotted: {} % for the height; dashed and dotted: {} % for the settlements.",
        of.height_limit_percent, of.settlement_limit_percent
    );
    Figure::new("convergence-deviations", title, caption, &[plot], &table)
}

/// What a setting costs, and how far it is from what is allowed.
fn cost(of: &Convergence) -> Result<Figure, ReportError> {
    let ladders = ladders(of);
    let point = |r: &ConvergenceRow| {
        let error = r.error_over_limit.filter(|_| !r.finest_of_study)?;
        Some((r.result.wall_s_per_simulated_s?.mean, error))
    };
    let x = Axis::logarithmic("Wall time of a simulated second (s)");
    // What is allowed is 1; that is not to lie on the frame.
    let y = Axis::logarithmic("Largest error over what is allowed").holding([0.5]);
    let mut plot = Plot::new(x, y);
    let mut table =
        Table::new(["ladder", "setting", "wall_s_per_simulated_s", "error_over_limit", "meets"]);
    for (n, (name, rows)) in ladders.iter().enumerate() {
        plot.add_some(name, Look::marked(n), rows.iter().filter_map(|r| point(r)));
        for r in rows {
            let cost = r.result.wall_s_per_simulated_s.map(|c| c.mean);
            table.row(row![name, &r.rung, cost, r.error_over_limit, r.meets]);
        }
    }
    plot.mark_level("What is allowed", 1.0);
    let caption = "The largest of overlap, numerical creep and deviations, each over what the standard \
                   allows, against wall time; below the dotted line a setting meets the whole standard, unless a \
                   run failed, a run-time check found something or grains had not settled. Lines join the \
                   rungs of a ladder in order. The setting that the study is compared with is left \
                   out: it cannot deviate from itself.";
    Figure::new("convergence-cost", "Cost against error", caption, &[plot], &table)
}

#[cfg(test)]
mod tests {
    use roxmltree::Document;

    use super::*;
    use crate::record::RunRow;

    /// A rung of a ladder with one run that counts; three times what is allowed.
    fn row(ladder: &str, rate_hz: f64, height_mm: Option<f64>) -> ConvergenceRow {
        let run = RunRow {
            variation: format!("{ladder} {rate_hz}"),
            rate_hz,
            poured_height_mm: height_mm,
            wall_s_per_simulated_s: Some(1.0),
            meets_standard: Some(true),
            valid: Some(true),
            ..RunRow::default()
        };
        let none = Deviation::judged(None, 1.0);
        let none = Deviations { height: none, plate: none, surface: none };
        ConvergenceRow {
            ladder: ladder.to_owned(),
            rung: format!("{rate_hz} Hz"),
            finest_of_ladder: false,
            finest_of_study: false,
            result: VariationRow::of(&[run]).remove(0),
            from_ladder: none,
            from_study: none,
            error_over_limit: Some(3.0),
            meets: Some(false),
            open: None,
        }
    }

    fn study() -> Convergence {
        Convergence {
            scenario: "s".to_owned(),
            quick: false,
            grains: Some(100),
            standard: Standard {
                overlap_mean_percent: 0.5,
                overlap_p99_percent: 3.0,
                creep_um_per_s: 5.0,
            },
            height_limit_percent: 1.0,
            settlement_limit_percent: 5.0,
            reference: "Native".to_owned(),
            rows: vec![
                row("Native", 240.0, Some(160.0)),
                row("Native", 480.0, Some(162.0)),
                row("Stock", 240.0, None),
                row("Stock", 480.0, None),
            ],
            cheapest: Cheapest::default(),
        }
    }

    /// The texts of each figure by its stem.
    fn texts() -> Vec<(String, Vec<String>)> {
        let texts = |figure: Figure| {
            let svg = Document::parse(&figure.svg).expect("XML");
            let found = svg.descendants().filter_map(|node| node.text());
            (figure.stem.clone(), found.map(|text| text.trim().to_owned()).collect())
        };
        of_convergence(&study()).expect("figures").into_iter().map(texts).collect()
    }

    fn says(stem: &str, text: &str) -> bool {
        let all = texts();
        let of = all.iter().find(|(name, _)| name == stem).expect(stem);
        of.1.iter().any(|said| said == text)
    }

    /// Law: a legend names the ladders that are drawn, and no other.
    #[test]
    fn legends_name_what_is_drawn() {
        for (stem, ladder, expected) in [
            ("convergence-height", "Native", true),
            ("convergence-height", "Stock", false),
            ("convergence-deviations", "Height", false),
            ("convergence-cost", "Stock", true),
        ] {
            assert_eq!(says(stem, ladder), expected, "law: `{ladder}` in {stem} (got left)");
        }
    }

    /// Law: the caption promises the standard below the line of no setting whose runs are spoilt, of
    /// which the error says nothing.
    #[test]
    fn the_caption_says_what_the_error_leaves_out() {
        let said =
            "unless a run failed, a run-time check found something or grains had not settled";
        let got = cost(&study()).expect("a figure").caption;
        assert!(got.contains(said), "law: expected `{said}`, got `{got}`");
    }

    /// Law: the line of what is allowed stands clear of the frame where every error is larger.
    #[test]
    fn what_is_allowed_is_not_on_the_frame() {
        assert!(says("convergence-cost", "What is allowed"), "law: the legend names the line");
        assert!(says("convergence-cost", "0.1"), "law: the axis begins below 1, at 0.1");
    }
}
