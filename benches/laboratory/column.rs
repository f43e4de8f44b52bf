//! The collapse of a column: how far the grains run out.

use pluvia::{
    measure::height_cell,
    report::{Axis, Chart, Look, Plot},
};

use super::{
    bench::{Bench, Design, Point, Run},
    references::Published,
    row::{Found, Row},
    standard_tests::{column_height, deposit_edge, run_out_of_lube, run_out_of_slope},
};

const SCENARIO: &str = "scenarios/validation/column-collapse.json";
/// Mean equivalent diameter of the grains in m.
const SIZE: f64 = 0.009;
/// Share of a ring that is covered where the deposit ends.
const COVERED: f64 = 0.5;
/// The same for a second look, not judged.
const THINLY: f64 = 0.1;
/// Number of the column with which reasons are tried, and the lower friction.
const TRIED: usize = 1;
const SLIPPERY: f64 = 0.2;
/// By how much run-outs may differ from the published ones.
const TOLERANCE: f64 = 0.15;
/// Angle of repose in degrees of grains with such friction, 0.5: docs/repose.md, between 0.39 and
/// 0.57; a test compares it with the kept piles.
const REPOSE: f64 = 42.0;

/// Runs the test.
pub fn carry_out(bench: &Bench) -> Result<Found, String> {
    let (radius_mm, aspects): (f64, &[f64]) = match bench.design {
        Design::Quick => (50.0, &[0.6, 1.2]),
        Design::Small => (50.0, &[0.6, 1.2, 2.4]),
        Design::Full => (90.0, &[0.5, 1.0, 1.5, 2.0, 3.0, 4.0]),
    };
    let points = aspects.iter().map(|a| Point {
        name: format!("aspect-{a}"),
        changes: column(radius_mm, *a),
        most: None,
    });
    // What may be why it misses, each with one column.
    let tried = |what: &'static str, radius_mm: f64, aspect: usize, more: &[String]| {
        let mut changes = column(radius_mm, aspects[aspect]);
        changes.extend_from_slice(more);
        let name = format!("{}-{}", what.replace(' ', "-"), aspects[aspect]);
        Tried { what, aspect, radius_mm, point: Point { name, changes, most: Some(1) } }
    };
    let slippery = [
        format!("contact.grain_grain_friction={SLIPPERY}"),
        format!("pieces.0.friction={SLIPPERY}"),
    ];
    let tried = [
        tried("friction 0.2 in place of 0.5", radius_mm, TRIED, &slippery),
        tried("spheres", radius_mm, TRIED, &["grains.shape=spheres".to_owned()]),
        tried("a column twice as wide", 2.0 * radius_mm, 0, &[]),
        tried("a column twice as wide", 2.0 * radius_mm, TRIED, &[]),
    ];
    // Twice as wide as those of the full design are, a run takes an hour.
    let tried = match bench.design {
        Design::Quick => &[],
        Design::Small => &tried[..],
        Design::Full => &tried[..2],
    };
    let points: Vec<Point> = points.chain(tried.iter().map(|t| t.point.clone())).collect();
    let runs = bench.run("column", SCENARIO, &points)?;
    let mut found: Vec<Collapse> = Vec::new();
    for run in &runs {
        let radius_mm =
            run.point.checked_sub(aspects.len()).map_or(radius_mm, |n| tried[n].radius_mm);
        match collapse(run, radius_mm * 1e-3)? {
            Some(collapse) => found.push(collapse),
            None => bench.leave_out(format!("column, {} (no deposit)", run.name())),
        }
    }
    let others: Vec<(&Tried, f64)> = found
        .iter()
        .filter_map(|f| Some((tried.get(f.point.checked_sub(aspects.len())?)?, f.run_out)))
        .collect();
    found.retain(|f| f.point < aspects.len());
    let across = 2e-3 * radius_mm / SIZE;
    let mut rows = Vec::new();
    for (n, asked) in aspects.iter().enumerate() {
        let own: Vec<&Collapse> = found.iter().filter(|f| f.point == n).collect();
        let (Some(aspect), Some(thinly)) =
            (mean(own.iter().map(|o| o.aspect)), mean(own.iter().map(|o| o.thinly)))
        else {
            continue;
        };
        let law = run_out_of_lube(aspect);
        let published =
            Published::Range { low: (1.0 - TOLERANCE) * law, high: (1.0 + TOLERANCE) * law };
        let values: Vec<f64> = own.iter().map(|o| o.run_out).collect();
        let of = |(tried, run_out): &(&Tried, f64)| format!("with {} {run_out:.2}", tried.what);
        let told: Vec<String> = others.iter().filter(|t| t.0.aspect == n).map(of).collect();
        let told = match told.is_empty() {
            true => String::new(),
            false => format!(". Tried, one realisation each: {}", told.join(", ")),
        };
        let quantity = format!("column, run-out (r∞ − r₀)/r₀ at a = {aspect:.2}");
        let id = format!("column-run-out-{asked}");
        let high = aspect * 1e-3 * radius_mm / SIZE;
        let slumped = run_out_of_slope(aspect, REPOSE.to_radians().tan());
        let note = format!(
            "The column is {across:.0} grains wide and {high:.0} high, the tube vanishes at once. \
             To where a tenth of a ring is covered: {thinly:.2}. A deposit at {REPOSE}°, the angle \
             of repose of such grains, would end at {slumped:.2} by its volume alone{told}"
        );
        rows.push(Row::of("column", &id, &quantity, &values).beside(published).noted(note));
    }
    Ok(Found { rows, charts: vec![chart(&found)] })
}

fn mean(values: impl Iterator<Item = f64>) -> Option<f64> {
    pluvia::measure::statistics::mean(&values.collect::<Vec<_>>())
}

/// What may be why the law is missed.
struct Tried {
    what: &'static str,
    /// Number of the column with which it is tried.
    aspect: usize,
    radius_mm: f64,
    point: Point,
}

/// A column of a radius in mm and about an aspect ratio, at the bulk density that grains have there.
fn column(radius_mm: f64, aspect: f64) -> Vec<String> {
    let height_mm = aspect * radius_mm;
    let area_mm2 = std::f64::consts::PI * radius_mm * radius_mm;
    // 1.45 g/cm³.
    let mass_g = (1.45e-3 * area_mm2 * height_mm).round();
    // Loose columns stand higher.
    let above = 1.15 * height_mm + 50.0;
    vec![
        format!("grains.total_mass_g={mass_g}"),
        format!("pieces.1.shape.cylinder.inner_diameter_mm={}", 2.0 * radius_mm),
        format!("pieces.1.shape.cylinder.height_mm={}", (above + 20.0).round()),
        format!("stages.0.at_mm=[0,0,{}]", above.round()),
        format!("stages.0.diameter_mm={}", 2.0 * radius_mm - 10.0),
        "stages.0.time_limit_s=10".to_owned(),
        format!("stages.0.rate_g_per_s={}", (mass_g / 1.5).clamp(400.0, 3000.0).round()),
    ]
}

/// A column and its deposit.
struct Collapse {
    /// Number of its point.
    point: usize,
    /// h₀/r₀, to the mean surface no nearer to the tube than half a grain.
    aspect: f64,
    /// (r∞ − r₀)/r₀.
    run_out: f64,
    /// The same, to where only a tenth of a ring is covered.
    thinly: f64,
}

fn collapse(run: &Run, radius: f64) -> Result<Option<Collapse>, String> {
    let column = run.specimen(Some("0"))?;
    let height = column_height(&column, radius, SIZE / 2.0, height_cell(&column.grains))
        .map_err(|e| e.to_string())?;
    let deposit = run.specimen(None)?;
    let distances: Vec<f64> = deposit
        .present()
        .map(|i| deposit.state.bodies[i].body.pose.translation.vector.xy().norm())
        .collect();
    // The tube, at r₀, is where grains end, half a grain beyond their centroids.
    let edge =
        |share: f64| Some((deposit_edge(&distances, SIZE, share)? + SIZE / 2.0) / radius - 1.0);
    Ok(edge(COVERED).zip(edge(THINLY)).map(|(run_out, thinly)| Collapse {
        point: run.point,
        aspect: height / radius,
        run_out,
        thinly,
    }))
}

fn chart(found: &[Collapse]) -> Chart {
    let law: Vec<(f64, f64)> =
        (1..=90).map(|n| 0.05 * f64::from(n)).map(|a| (a, run_out_of_lube(a))).collect();
    let end = |share: f64| law.iter().map(|(a, r)| (*a, share * r)).collect();
    let mut plot = Plot::new(
        Axis::linear("Aspect ratio a = h₀/r₀").from_zero(),
        Axis::linear("Run-out (r∞ − r₀)/r₀").from_zero(),
    );
    let measured = found.iter().map(|f| (f.aspect, f.run_out)).collect();
    plot.add("Measured", Look::points(0), measured);
    plot.add("Lube et al. 2004", Look::law(1), law.clone());
    plot.add("± 15 %", Look::law(4), end(1.15));
    plot.add("", Look::law(4), end(0.85));
    Chart::new(
        "column",
        "Run-out of collapsed columns",
        "Run-out against the aspect ratio, each realisation a point, and the law of Lube et al. \
         with ends 15 % to either side.",
        vec![plot],
    )
}
