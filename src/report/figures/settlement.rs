//! Settlement of the top plate and of the grains over time.

use super::*;
use crate::report::{
    quality::found_in,
    settlement::{SETTLEMENTS, settlement_curve},
};

/// The settlement of one run, for its own folder; `None` where it was not vibrated.
pub(super) fn of_run(run: &RunRecord) -> Result<Option<Figure>, ReportError> {
    if !run.series.iter().any(SeriesRow::is_shaken) {
        return Ok(None);
    }
    let (plot, table) = curves(&[run], 0.0);
    let mut caption = format!("Settlement under vibration. {}", finals(&[run]));
    if goes_on(run) {
        caption += " The specimen had been shaken in an earlier run: curves count from its first \
                    vibration there, final values from the first one of this run.";
    }
    Figure::new("settlement", "Settlement under vibration", caption, &[plot], &table).map(Some)
}

/// Whether the specimen had settled in an earlier run, from whose first vibration rows count.
fn goes_on(run: &RunRecord) -> bool {
    let first = run.series.iter().find(|r| r.is_shaken());
    let settled = |mm: Option<f64>| mm.is_some_and(|mm| mm != 0.0);
    first.is_some_and(|r| settled(r.settlement_mm) || settled(r.surface_settlement_mm))
}

/// Plate and surface of every run; `at_least_s` is the least length of the time axis.
pub(crate) fn curves(runs: &[&RunRecord], at_least_s: f64) -> (Plot, Table) {
    let mut plot = Plot::of_settlement();
    plot.x = plot.x.holding([at_least_s]);
    // An empty figure still has the laboratory's scale.
    plot.y = plot.y.holding(runs.is_empty().then_some(20.0));
    for (n, run) in runs.iter().enumerate() {
        let look = Look::spaced(n);
        let thin = look.dash(style::DASHED).thin().every(2.5 * style::MARKER_SPACING);
        plot.add("", thin, settlement_curve(run, |row| row.surface_settlement_mm));
        let mark = match (run.counts_in_means(), run.summary.valid) {
            (true, _) => "",
            (false, true) => " (left out)",
            (false, false) => " (not valid)",
        };
        let label = format!("Configuration {}, plate{mark}", run.configuration);
        plot.add(label, look, settlement_curve(run, |row| row.settlement_mm));
    }
    let shaken = runs.iter().flat_map(|run| {
        let rows = run.series.iter().filter(|r| r.is_shaken());
        let start = rows.clone().next().map_or(0.0, |r| r.time_s);
        rows.map(move |r| (run, r, r.time_s - start))
    });
    let table = table!(shaken, |(run, row, time)| {
        "run" => &run.name,
        "configuration" => run.configuration,
        "time_s" => time,
        "plate_settlement_mm" => row.settlement_mm,
        "surface_settlement_mm" => row.surface_settlement_mm,
        "left_out_of_means" => run.summary.why_left_out().join("; "),
    });
    plot.add_key_of_thin("Mean surface (same colours)");
    (plot, table)
}

/// The final settlements in a sentence.
pub(crate) fn finals(runs: &[&RunRecord]) -> String {
    let found = SETTLEMENTS.into_iter().filter_map(|(what, settlement)| {
        let counting = runs.iter().filter(|r| r.counts_in_means());
        let of = Interval::of(counting.filter_map(|r| Some(settlement(r)?.final_mm)))?;
        let (low, high) = (number(of.low, 1), number(of.high, 1));
        let shown = if low == high { low } else { format!("{low} to {high}") };
        Some(format!("of the {what}: {shown} mm"))
    });
    let found: Vec<String> = found.collect();
    let said = (!found.is_empty()).then(|| format!("Final settlement {}.", found.join("; ")));
    found_in(runs, said, "these numbers", "No such run was done.")
}

#[cfg(test)]
mod tests {
    use roxmltree::Document;

    use super::*;
    use crate::record::canned;

    /// Law: where rows count from a vibration of an earlier run and final values do not, the
    /// caption says so, and nowhere else.
    #[test]
    fn a_specimen_shaken_before_has_its_two_beginnings_in_the_caption() {
        for (settled, said) in [(0.0, false), (3.0, true)] {
            let mut run = canned::runs().remove(4);
            for row in &mut run.series {
                row.settlement_mm = row.settlement_mm.map(|mm| mm + settled);
                row.surface_settlement_mm = row.surface_settlement_mm.map(|mm| mm + settled);
            }
            let figure = of_run(&run).expect("it can be drawn").expect("it was shaken");
            let got = figure.caption.contains("in an earlier run");
            assert_eq!(got, said, "law: {settled} mm before, {}", figure.caption);
        }
    }

    /// Law: a run is not said to be missing where it is there without a final settlement, as one
    /// that only rests after a vibration of an earlier run; nor is it called not valid.
    #[test]
    fn a_run_without_a_final_settlement_is_there() {
        let mut run = canned::valid_runs().remove(4);
        let with = finals(&[&run]);
        assert!(
            with.starts_with("Final settlement of the plate: "),
            "law: it has one, got `{with}`"
        );
        (run.summary.settlement_mm, run.summary.surface_settlement_mm) = (None, None);
        let expected = "No run that counts has a value.";
        assert_eq!(finals(&[&run]), expected, "law: left what is said, right what is so");
        run.summary.valid = false;
        assert_eq!(finals(&[&run]), "There is no valid run.", "law: it does not count");
        assert_eq!(finals(&[]), "No such run was done.", "law: there is none");
    }

    /// Law: the time axis of a specimen that was shaken for 20 s and came to rest soon after ends
    /// there, as the numbers in the figure say: the next one, 25 s, would leave a fifth of it empty.
    #[test]
    fn the_time_axis_ends_where_the_data_end() {
        let run = canned::runs().remove(4);
        let curve = settlement_curve(&run, |row| row.settlement_mm);
        let end = curve.last().expect("a curve").0;
        assert!((20.3..20.5).contains(&end), "expected data that end soon after 20 s, got {end}");
        let figure = of_run(&run).expect("it can be drawn").expect("it was shaken");
        let svg = Document::parse(&figure.svg).expect("XML");
        // Numbers below the frame stand in the middle of their ticks, those beside it end there.
        let ticks: Vec<(f64, f64)> = svg
            .descendants()
            .filter(|node| node.tag_name().name() == "text")
            .filter(|node| node.attribute("text-anchor") == Some("middle"))
            .filter_map(|node| {
                let number = node.text()?.trim().parse().ok()?;
                Some((node.attribute("x")?.parse().ok()?, number))
            })
            .collect();
        let numbers: Vec<f64> = ticks.iter().map(|tick| tick.1).collect();
        assert_eq!(numbers, [0.0, 5.0, 10.0, 15.0, 20.0], "law: no number beyond the data");
        let (first, last) = (ticks[0], ticks[ticks.len() - 1]);
        let right = f64::from(style::WIDTH) - f64::from(style::RIGHT);
        let of_data = first.0 + (last.0 - first.0) * (end - first.1) / (last.1 - first.1);
        let empty = (right - of_data) / (right - first.0);
        assert!((-0.01..0.05).contains(&empty), "law: 5 % at most is empty, got {empty}");
    }
}
