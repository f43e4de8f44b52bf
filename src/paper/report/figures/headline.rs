//! The one figure of the report's head: settlement of the plate against time, of all runs and of
//! stock Bullet, with the laboratory's range where it was read; beside it how the surface of the
//! same specimens sinks in the rest test, unshaken and without a plate.

use super::*;
use crate::report::{plot::Envelope, style::Dash, text::capital};

/// Half the length of the strokes at the ends of the laboratory's bracket, in s.
const STROKE_S: f64 = 0.35;

/// What stock Bullet made of the programme, and what it is called.
type Stock<'a> = (String, &'a MeanSettlement);

/// What a column of stock Bullet is called: with its settings, where they are not the default, or
/// the name of its interpretation.
fn name(of: &Column) -> String {
    let mine = ["stock", "interpretation "].iter().find_map(|start| of.label.strip_prefix(start));
    let label = mine.unwrap_or(&of.label).trim_start_matches(", ");
    if label.is_empty() { "stock Bullet".to_owned() } else { format!("stock Bullet ({label})") }
}

/// The figure of a study, beside what other engines made of the same programme.
pub(in crate::paper::report) fn figure(
    study: &StudyView,
    beside: &[Column],
) -> Result<Figure, ReportError> {
    let ours = MeanSettlement::of(study);
    let stock = beside.iter().filter(|c| c.stock_bullet);
    let stock: Vec<Stock> = stock.filter_map(|c| Some((name(c), c.settlement.as_ref()?))).collect();
    let laboratory = bands::FINAL_SETTLEMENT_MM;
    // The quick study shakes a smaller specimen for less time: nothing of it stands at 20 s.
    let bracket = no_range(study).is_none();
    let mut plot = Plot::of_settlement();
    let mut table = Table::new(["curve", "time_s", "mean_mm", "lowest_mm", "highest_mm"]);
    if let Some(m) = &ours {
        // One run is no band.
        if m.band_runs > 1 {
            plot.envelopes.push(Envelope {
                label: format!("{}, lowest to highest", counted(m.band_runs, "run")),
                edges: m.shaken.iter().map(|r| (r[0], r[2], r[3])).collect(),
            });
        }
        add(&mut plot, "Ours", m, 0, style::SOLID);
        rows_of(&mut table, "ours", m);
    }
    for (n, (name, m)) in stock.iter().enumerate() {
        add(&mut plot, &capital(name), m, n + 1, style::DASHED);
        rows_of(&mut table, name, m);
    }
    if bracket {
        let (at, low, high) = (CONTINUOUS_S, laboratory.low, laboratory.high);
        let label = format!("Laboratory, {} to {} mm", compact(low), compact(high));
        let look = Look { width: 2 * style::CURVE, ..Look::of(style::INK) };
        plot.add_interval(&label, look, [(at, low), (at, high)], (STROKE_S, 0.0));
    }
    let caption = caption(study, ours.as_ref(), &stock);
    let rests = ours.iter().chain(stock.iter().map(|of| of.1)).any(|m| !m.unshaken.is_empty());
    let title = if rests {
        "Settlement of the top plate (dotted: of the surface at rest, without a plate)"
    } else {
        "Settlement of the top plate"
    };
    Figure::new("settlement", title, caption, &[plot], &table)
}

/// Adds the mean settlement of the plate, and beside it that of the surface of the same specimens
/// in the rest test, which has no plate and an end of its own.
fn add(plot: &mut Plot, name: &str, m: &MeanSettlement, n: usize, dash: Dash) {
    let mark = if m.valid { "" } else { " (not valid)" };
    let of = if m.runs == 1 { "one run".to_owned() } else { format!("mean of {} runs", m.runs) };
    let label = format!("{name}, {of}{mark}");
    plot.add(label, Look::line(n).dash(dash), m.shaken.iter().map(|r| (r[0], r[1])).collect());
    let end = m.unshaken.last().map_or(0.0, |p| p.0);
    let label = format!("{name}: surface, no plate");
    // Beside settings there is no room for more.
    let is_long = name.contains('(');
    let label = if is_long { label } else { format!("{label}; rest test ends at {end:.1} s") };
    plot.add_some(label, Look::line(n).dash(style::DOTTED), m.unshaken.iter().copied());
}

fn rows_of(table: &mut Table, name: &str, m: &MeanSettlement) {
    for r in &m.shaken {
        table.row(row![name, r[0], r[1], r[2], r[3]]);
    }
    for (time, drop) in &m.unshaken {
        table.row(row![format!("{name}, surface at rest"), *time, *drop, "", ""]);
    }
}

fn caption(study: &StudyView, ours: Option<&MeanSettlement>, stock: &[Stock]) -> String {
    let Some(m) = ours else { return "No run was vibrated continuously.".to_owned() };
    let mut said = vec!["Settlement under continuous vibration, downwards.".to_owned()];
    said.push(
        no_range(study)
            .unwrap_or_else(|| "Bracket: the laboratory's range, read after 20 s.".to_owned()),
    );
    if m.band_runs > m.runs {
        said.push(
            "The mean is of the programme's runs; the band holds other placements of the plate as \
             well."
                .to_owned(),
        );
    }
    let rest = |m: &MeanSettlement| {
        let (seconds, drop) = m.unshaken.last()?;
        Some(format!("{} mm in {} s", thousandths(*drop), number(*seconds, 1)))
    };
    if let Some(rest) = rest(m) {
        said.push(format!(
            "Dotted: not the plate, but the mean surface of the same specimens as poured, unshaken and \
             without a plate. The curve ends with their rest tests ({rest}); --set rest_test_s={} makes \
             these as long as the vibration.",
            without_zeros(&number(shaken_s(study), 2))
        ));
    }
    if stock.is_empty() && !is_another_engine(study) {
        said.push(
            "Not drawn, as it was not run: stock Bullet. Into the same folder (--out), run this report's \
             command with --set engine.contact_solver=stock added, then once more without it."
                .to_owned(),
        );
    }
    for (name, rest) in stock.iter().filter_map(|(name, m)| Some((name, rest(m)?))) {
        said.push(format!("With {name} that surface sinks by {rest}."));
    }
    if m.left_out > 0 && m.valid {
        let are = if m.left_out == 1 { "is" } else { "are" };
        let runs = counted(m.left_out, "run");
        said.push(format!("{runs} {are} left out, not counting in means."));
    }
    said.join(" ")
}

/// How long the specimens were shaken, in s.
fn shaken_s(study: &StudyView) -> f64 {
    let mut continuous = study.of_kind(RunKind::VibrationContinuous);
    let shaken = continuous.find_map(|r| r.summary.shaken_s());
    shaken.map_or(CONTINUOUS_S, |(first, last)| last - first)
}

/// Whether the study is of stock Bullet itself, or of an engine without its contacts.
fn is_another_engine(study: &StudyView) -> bool {
    study.runs.iter().any(|r| matches!(r.summary.contact_solver.as_str(), "stock" | "rapier"))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::paper::canned;

    /// Law: the bracket is the laboratory's, and the quick study, which has nothing at 20 s, has
    /// none; stock Bullet and the unshaken specimens are there where they were run.
    #[test]
    fn what_was_run_is_drawn_and_nothing_else() {
        let runs = canned::valid_runs();
        let study = canned::study(&runs);
        let alone = figure(&study, &[]).expect("a figure");
        let rest = "Ours: surface, no plate; rest test ends at 2.0 s";
        for shown in ["Laboratory, 14 to 19.61 mm", "Ours, mean of 3 runs", rest] {
            assert!(alone.svg.contains(shown), "law: `{shown}` in the legend");
        }
        assert!(alone.title.contains("without a plate"), "law: got {}", alone.title);
        let command = "--set engine.contact_solver=stock added";
        assert!(!alone.svg.contains("Stock Bullet") && alone.caption.contains(command));
        let column = |stock_bullet| Column {
            label: "stock".to_owned(),
            programme: "p".to_owned(),
            claims: Vec::new(),
            stock_bullet,
            settlement: MeanSettlement::of(&study),
        };
        let with = figure(&study, &[column(true)]).expect("a figure");
        assert!(with.svg.contains("Stock Bullet, mean of 3 runs"), "law: it was run");
        assert!(with.svg.contains("Stock Bullet: surface, no plate"), "law: so was its rest test");
        let command = "--set rest_test_s=20 makes";
        assert!(with.caption.contains(command), "law: as long as here: {}", with.caption);
        let rapier = figure(&study, &[column(false)]).expect("a figure");
        assert!(!rapier.svg.contains("Stock Bullet"), "law: another engine is not stock Bullet");
        let quick = StudyView { quick: true, ..study.clone() };
        let quick = figure(&quick, &[]).expect("a figure");
        assert!(!quick.svg.contains("Laboratory"), "law: nothing of it stands at 20 s");
        let mut unrested = runs.clone();
        unrested.iter_mut().for_each(|r| r.rest_test.clear());
        let unrested = figure(&canned::study(&unrested), &[]).expect("a figure");
        assert!(!unrested.svg.contains("no plate"), "law: no rest test, no curve");
        assert_eq!(unrested.title, "Settlement of the top plate", "law: nor a word of it");
        let none = figure(&canned::study(&[]), &[]).expect("a figure");
        assert!(none.caption.contains("No run") && !none.svg.contains("Ours"));
        let spoilt: Vec<_> = canned::runs().into_iter().filter(|r| r.configuration == 3).collect();
        let spoilt = figure(&canned::study(&spoilt), &[]).expect("a figure");
        assert!(spoilt.svg.contains("(not valid)"), "law: what does not count is marked");
    }

    /// Law: curves of stock Bullet under other settings have names of their own, in the legend and
    /// in the file.
    #[test]
    fn every_curve_of_stock_bullet_has_its_name() {
        let runs = canned::valid_runs();
        let study = canned::study(&runs);
        let column = |label: &str| Column {
            label: label.to_owned(),
            programme: "p".to_owned(),
            claims: Vec::new(),
            stock_bullet: true,
            settlement: MeanSettlement::of(&study),
        };
        let labels = ["interpretation bullet_stock", "stock", "stock, rate_hz 960.0"];
        let got = figure(&study, &labels.map(column)).expect("a figure");
        let csv = String::from_utf8(got.csv).expect("text");
        for name in ["", " (bullet_stock)", " (rate_hz 960.0)"] {
            let legend = format!("Stock Bullet{name}, mean of 3 runs");
            assert!(got.svg.contains(&legend), "law: `{legend}` in the legend");
            let row = format!("stock Bullet{name},");
            assert!(csv.lines().any(|line| line.starts_with(&row)), "law: `{row}` in the file");
            let said = format!("With stock Bullet{name} that surface sinks by");
            assert!(got.caption.contains(&said), "law: `{said}` in {}", got.caption);
        }
    }

    /// Law: stock Bullet is not called missing where the study is its own, and the rest test that is
    /// advised is as long as the study's vibration.
    #[test]
    fn what_the_caption_advises_fits_the_study() {
        for (solver, expected) in [("native", true), ("stock", false), ("rapier", false)] {
            let mut runs = canned::valid_runs();
            for run in &mut runs {
                run.summary.contact_solver = solver.to_owned();
                for [begin, end] in run.summary.vibrations.iter_mut().flat_map(|v| &mut v.periods_s)
                {
                    *end = *begin + 0.1 * (*end - *begin);
                }
            }
            let caption = figure(&canned::study(&runs), &[]).expect("a figure").caption;
            let got = caption.contains("Not drawn, as it was not run: stock Bullet");
            assert_eq!(got, expected, "law: of {solver} (got left): {caption}");
            let said = "--set rest_test_s=2 makes";
            assert!(caption.contains(said), "law: `{said}` in {caption}");
        }
    }
}
