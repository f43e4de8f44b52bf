//! The report's section on how sure its numbers are.

use maud::html;

use super::*;
use crate::paper::uncertainty::{
    LaboratoryScatter, Quantity, SettledRun, Trend, p_in_words, p_value,
};

/// Interval, tests, numerical creep and the laboratory's scatter.
pub(super) fn section(of: &Uncertainty) -> Vec<Block> {
    let heading = |text: &str| Block::Heading(text.to_owned());
    let of_all = note_of_all(&of.quantities);
    let reading = html! {
        p.soft {
            @if let Some(note) = of_all { (note) " " }
            "Intervals are those of the mean over the configurations, by Student's t, 95 % confidence. "
            "SD: standard deviation of a single configuration. Runs that do not count (docs/accuracy.md) "
            "are left out; the table of runs says why. The same as numbers: "
            a href="uncertainty.json" { "uncertainty.json" } "."
        }
    };
    let mut blocks = vec![
        Block::Text(of.trend.verdict.clone()),
        Block::Html(reading),
        Block::Table(quantities(&of.quantities, of_all)),
        heading("Does the standing height fall with the falling height?"),
        Block::Table(trend(&of.trend)),
        Block::Soft(SOURCES.to_owned()),
    ];
    if !of.placements.is_empty() {
        let reading = "The same poured specimens, each under plates laid anew with a drawn offset and \
                       rotation, shaken continuously. Standard deviations with their 95 % intervals, by \
                       a one-way analysis of variance with random specimens; the interval of the mean \
                       holds both.";
        blocks.extend([
            heading("Scatter of specimens and of placements of the plate"),
            Block::Soft(reading.to_owned()),
            Block::Table(placements(&of.placements)),
        ]);
    }
    let reading = "Numerical creep is that of the second half of the rest test, and what it would make \
                   over as long as the vibration took. It is shown, and not subtracted: a shaken specimen need \
                   not sink as a resting one does.";
    blocks.extend([
        heading("Settlement beside the numerical creep of the specimen at rest"),
        Block::Soft(reading.to_owned()),
        match of.settlements.as_slice() {
            [] => Block::Text("No specimen was shaken.".to_owned()),
            runs => Block::Table(settlements(runs)),
        },
    ]);
    let left_out = of.settlements.iter().filter(|run| !run.left_out_of_means.is_empty());
    let why = left_out.map(|run| format!("{}: {}", run.run, run.left_out_of_means.join("; ")));
    let laboratory = Block::Table(laboratory(&of.laboratory));
    blocks.extend([Block::List(why.collect()), heading("The laboratory's scatter"), laboratory]);
    blocks
}

const SOURCES: &str = "Sources: Student's one-sample test (1908) of each configuration's least squares \
    slope, since a configuration is poured from every height; E. B. Page (1963), Ordered hypotheses for \
    multiple treatments, Journal of the American Statistical Association 58, 216–230; power of the t-test \
    after Cohen (1988), Statistical Power Analysis for the Behavioral Sciences. A scatter estimated from \
    three configurations is itself uncertain by a factor of two and more, and the number of \
    configurations with it.";

fn range(interval: Option<Interval>, decimals: usize) -> String {
    interval.map_or_else(dash, |i| match [i.low, i.high].map(|end| number(end, decimals)) {
        [low, high] if low == high => low,
        [low, high] => format!("{low} to {high}"),
    })
}

/// The note that all quantities with values have, which then is said once.
fn note_of_all(of: &[Quantity]) -> Option<&str> {
    let mut notes = of.iter().filter(|q| !q.values.is_empty()).map(|q| q.note.as_str());
    let first = notes.next().filter(|note| !note.is_empty())?;
    notes.all(|note| note == first).then_some(first)
}

fn quantities(of: &[Quantity], of_all: Option<&str>) -> Table {
    let table = table!(of, |q| {
        "Quantity" => format!("{}, {}", q.name, q.unit),
        "Configurations" => q.values.len(),
        "Mean" => match q.mean {
            None if !q.left_out.is_empty() => Cell::number(NO_VALID_RUN),
            mean => Cell::fixed(mean, 1),
        },
        "Range" => Cell::number(range(q.range.filter(|_| q.values.len() > 1), 1)),
        "SD" => Cell::fixed(q.standard_deviation, 1),
        "95 % confidence" => Cell::number(range(q.interval, 1)),
        "Mind" => Some(&q.note).filter(|note| Some(note.as_str()) != of_all),
    });
    table.class("quantities")
}

fn placements(of: &[PlacementScatter]) -> Table {
    let with = |value: Option<f64>, ends: Option<Interval>| {
        let shown = value.map(|v| format!("{} ({})", number(v, 2), range(ends, 2)));
        Cell::number(shown.unwrap_or_else(dash))
    };
    table!(of, |q| {
        "Quantity" => format!("{}, {}", q.name, q.unit),
        "Specimens" => q.specimens.iter().filter(|s| !s.values.is_empty()).count(),
        "Placements" => q.specimens.iter().map(|s| s.values.len()).sum::<usize>(),
        "Mean" => with(q.mean, q.interval),
        "Between specimens" => with(q.standard_deviation_of_specimens, q.interval_of_specimens),
        "Between placements" => with(q.standard_deviation_of_placements, q.interval_of_placements),
        "p" => Cell::number(q.p_of_equal_specimens.map_or_else(dash, p_value)),
        "Mind" => &q.note,
    })
}

fn trend(of: &Trend) -> Table {
    let slopes = of.configurations.iter().zip(&of.slopes_mm_per_cm);
    let slopes: Vec<String> =
        slopes.map(|(c, s)| format!("{} (configuration {c})", number(*s, 3))).collect();
    let slope = of.slope.as_ref().map(|t| {
        format!(
            "mean {}, 95 % {}, t = {} with {} of freedom, two-sided {}",
            number(t.mean_mm_per_cm, 3),
            range(Some(t.interval), 3),
            t.t.map_or_else(dash, |t| number(t, 2)),
            counted(t.freedom as usize, "degree"),
            p_in_words(t.p)
        )
    });
    let page = of.page.as_ref().map(|p| {
        format!(
            "L = {} for {} configurations and {} heights, exact one-sided {}",
            number(p.l, 1),
            p.configurations,
            p.heights,
            p_in_words(p.p)
        )
    });
    let needed = of.configurations_needed;
    let needed = needed.map(|n| format!("{n}, were the measured slope and scatter the true ones"));
    let or = |said: Option<String>, without: &str| said.unwrap_or_else(|| without.to_owned());
    let slopes = if slopes.is_empty() { dash() } else { slopes.join(", ") };
    let rows = [
        ("Slopes, mm per cm of falling height", slopes),
        ("t-test of the slopes", or(slope, "Not possible with fewer than two configurations.")),
        (
            "Page's trend test, ranks only",
            or(page, "Not possible with fewer than two configurations or three heights."),
        ),
        (
            "Configurations for 80 % power",
            or(needed, "Not known: it asks for three configurations and a slope that is not 0."),
        ),
    ];
    Table::of_pairs(rows.map(|(name, said)| (name.to_owned(), said))).class("cards")
}

fn settlements(runs: &[SettledRun]) -> Table {
    table!(runs, |run| {
        "Run" => match run.left_out_of_means.is_empty() {
            true => run.run.clone(),
            false => format!("{} (left out)", run.run),
        },
        "Plate, mm" => Cell::fixed(run.plate_mm, 2),
        "Mean surface, mm" => Cell::fixed(run.surface_mm, 2),
        "Numerical creep, µm/s" => Cell::fixed(run.creep_um_per_s, 1),
        "The same over the vibration, mm" => Cell::fixed(run.creep_over_vibration_mm, 3),
        "Plate in the rest test, mm" => Cell::fixed(run.rest_test_plate_drop_mm, 3),
        "Rest test, s" => Cell::fixed(run.rest_test_s, 1),
    })
}

fn laboratory(of: &[LaboratoryScatter]) -> Table {
    let table = table!(of, |l| {
        "Quantity" => format!("{}, {}", l.quantity, l.unit),
        "Laboratory" => match l.stated_range {
            None => "not stated".to_owned(),
            stated => range(stated, 2),
        },
        "Ours" => range(l.ours, 1),
        "What is known" => &l.note,
    });
    table.class("cards")
}
