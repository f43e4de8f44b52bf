//! The figures of a single run, for its own folder.

use super::settlement;
use super::*;

/// `heights`, `energy` and, where the run was vibrated, `settlement`.
pub(crate) fn of_run(run: &RunRecord) -> Result<Vec<Figure>, ReportError> {
    let mut figures = vec![heights(run)?, energy(run)?];
    figures.extend(settlement::of_run(run)?);
    Ok(figures)
}

type Value = fn(&SeriesRow) -> Option<f64>;

/// A value over the time of a run, where there is one.
fn points(run: &RunRecord, value: Value) -> Vec<(f64, f64)> {
    let points = run.series.iter().filter_map(|r| Some((r.time_s, value(r)?)));
    points.filter(|(t, v)| t.is_finite() && v.is_finite()).collect()
}

/// Time axis and the beginning of every stage but the first.
fn over_time(run: &RunRecord, y: Axis) -> Plot {
    let x = Axis::linear("Time (s)").holding(run.series.iter().map(|r| r.time_s)).from_zero();
    let mut plot = Plot::new(x, y);
    let begin = run.series.windows(2).filter(|w| w[1].stage != w[0].stage);
    plot.mark_upright("Beginning of a stage", begin.map(|w| w[1].time_s));
    plot
}

fn heights(run: &RunRecord) -> Result<Figure, ReportError> {
    let heights: [(&str, Value); 4] = [
        ("Mean surface", |r| r.mean_surface_mm),
        ("Mean height of the grains", |r| r.mean_grain_height_mm),
        ("Lower face of the plate", |r| r.plate_height_mm),
        ("Top of the pile above its base", |r| r.pile_height_mm),
    ];
    // A laboratory of pieces has no floor of its own.
    let name = match run.summary.laboratory {
        Some(_) => "Height above z = 0 (mm)",
        None => "Height above the floor (mm)",
    };
    let mut plot = over_time(run, Axis::linear(name).from_zero());
    for (n, (label, height)) in heights.into_iter().enumerate() {
        plot.add_some(label, Look::spaced(n), points(run, height));
    }
    let table = table!(&run.series, |r| {
        "time_s" => r.time_s,
        "stage" => r.stage,
        "mean_surface_mm" => r.mean_surface_mm,
        "mean_grain_height_mm" => r.mean_grain_height_mm,
        "plate_height_mm" => r.plate_height_mm,
        "grains_in_cylinder" => r.grains_in_cylinder,
        "pile_height_mm" => r.pile_height_mm,
    });
    let caption = "Heights over the time of the run.";
    Figure::new("heights", "Heights over time", caption, &[plot], &table)
}

fn energy(run: &RunRecord) -> Result<Figure, ReportError> {
    let mut plot = over_time(run, Axis::logarithmic("Kinetic energy (J)"));
    plot.add("", Look::line(0), points(run, |r| Some(r.kinetic_energy_j)));
    let table = table!(&run.series, |r| {
        "time_s" => r.time_s,
        "stage" => r.stage,
        "kinetic_energy_j" => r.kinetic_energy_j,
        "largest_speed_m_per_s" => r.largest_speed_m_per_s,
    });
    let caption = "Kinetic energy of grains and plate relative to the table.";
    Figure::new("energy", "Kinetic energy over time", caption, &[plot], &table)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::record::{Balance, LaboratorySummary, canned};

    /// Law: heights are named by what they are counted from: the floor of the cylinder, or z = 0 of a
    /// laboratory, which has no floor of its own.
    #[test]
    fn heights_are_named_by_what_they_count_from() {
        let mut run = canned::valid_runs().remove(0);
        let svg = |run: &RunRecord| heights(run).expect("a figure").svg;
        let (floor, zero) = ("Height above the floor (mm)", "Height above z = 0 (mm)");
        assert!(svg(&run).contains(floor), "law: expected `{floor}` with the cylinder");
        let balance =
            Balance { weight_n: 0.0, carried_n: 0.0, sideways_n: 0.0, difference_percent: None };
        let (pieces, groups, openings, regions) = Default::default();
        run.summary.laboratory =
            Some(LaboratorySummary { pieces, groups, balance, openings, regions });
        let got = svg(&run);
        assert!(got.contains(zero) && !got.contains(floor), "law: expected `{zero}` of pieces");
    }
}
