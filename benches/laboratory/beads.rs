//! Direct shear of steel beads, in the box of the paper's first author's later work.

use pluvia::{
    plain::counted,
    report::Chart,
    units::{from_kpa, from_mm},
};

use super::{
    bench::{Bench, Point},
    row::{Found, Row},
    shear::{angles, changes},
    shear_lines::{NOISE, called, leave_out, moments, panels},
    standard_tests::{Sheared, inertial_number, shear_strength},
};

const SCENARIO: &str = "scenarios/validation/direct-shear-beads.json";
/// Stresses in kPa.
const STRESSES: [f64; 3] = [25.0, 50.0, 100.0];
/// Other frictions between beads, tried at the second stress.
const FRICTIONS: [f64; 2] = [0.1, 0.4];
const TRIED: usize = 1;
/// Displacement in m, and parts of it: the mobilised angle is a mean from the first on, that of
/// the end from the second.
const TRAVEL: f64 = 6e-3;
const MOBILISED: f64 = 0.2;
const END: f64 = 2.0 / 3.0;
/// Moments that count together as the peak.
const TOGETHER: usize = 3;
/// Height in m of the plane between the halves.
const PLANE: f64 = 0.015_25;
const SIZE_MM: f64 = 4.0;
const SPEED_MM_PER_S: f64 = 6.0;
const SOLIDS: f64 = 7800.0;

/// A sheared specimen.
struct Test {
    point: usize,
    configuration: u32,
    moments: Vec<Sheared>,
    /// Mean stress ratios: mobilised, at the peak, at the end.
    ratios: [f64; 3],
}

/// Runs the test.
pub fn carry_out(bench: &Bench) -> Result<Found, String> {
    let at = |stress: f64, more: Vec<String>, name: String, most| Point {
        name,
        changes: [vec![format!("stages.2.loads.0.stress_kpa={stress}")], more].concat(),
        most,
    };
    let mut points: Vec<Point> =
        STRESSES.iter().map(|s| at(*s, Vec::new(), format!("stress-{s}"), None)).collect();
    let others = FRICTIONS.map(|friction| {
        let more = vec![format!("contact.grain_grain_friction={friction}")];
        at(STRESSES[TRIED], more, format!("friction-{friction}"), bench.is_small().then_some(1))
    });
    points.extend(bench.unless_quick(others.to_vec()));
    let mut tests = Vec::new();
    for run in bench.run("beads", SCENARIO, &points)? {
        let moments = moments(&run, PLANE)?;
        let Some(strength) = shear_strength(&moments, TOGETHER, END * TRAVEL) else {
            leave_out(bench, &run);
            continue;
        };
        let from = |part: f64| moments.partition_point(|m| m.displacement < part * TRAVEL);
        let mobilised: Vec<f64> = moments[from(MOBILISED)..].iter().map(Sheared::ratio).collect();
        let mobilised = pluvia::measure::statistics::mean(&mobilised).unwrap_or(f64::NAN);
        let ratios = [mobilised, strength.peak, strength.end];
        tests.push(Test { point: run.point, configuration: run.configuration, moments, ratios });
    }
    Ok(Found { rows: rows(bench, &tests), charts: vec![chart(&tests)] })
}

fn rows(bench: &Bench, tests: &[Test]) -> Vec<Row> {
    let of = |point: usize, configuration: u32| {
        tests.iter().find(|t| t.point == point && t.configuration == configuration)
    };
    let ratio = |which: usize| move |point: usize, c: u32| Some(of(point, c)?.ratios[which]);
    let change = |point: usize| changes(bench, [TRIED, point], ratio(0));
    let changes: Vec<String> = FRICTIONS
        .iter()
        .enumerate()
        .filter_map(|(n, friction)| {
            let changes = change(STRESSES.len() + n);
            let mean = pluvia::measure::statistics::mean(&changes)?;
            Some(format!("{friction}: {mean:+.1}° ({})", counted(changes.len(), "realisation")))
        })
        .collect();
    let inertial = inertial_number(
        SPEED_MM_PER_S / (5.0 * SIZE_MM),
        from_mm(SIZE_MM),
        SOLIDS,
        from_kpa(STRESSES[TRIED]),
    );
    let note = format!(
        "25, 50 and 100 kPa, regression through the origin; 4 mm beads in a box of 60 x 60 x 30 mm, \
         {SPEED_MM_PER_S} mm/s, I {inertial:.0e} at 50 kPa. Friction between beads 0.2, ours; at 50 \
         kPa, poured anew while lid, floor and lower walls keep 0.2, the mobilised angle changes \
         with one of {}",
        changes.join(", of ")
    );
    let loads: Vec<(usize, f64)> = STRESSES.into_iter().enumerate().collect();
    [
        ("mobilised", "direct shear of steel beads, mean mobilised friction angle, °"),
        ("peak", "direct shear of steel beads, friction angle at the peak, °"),
        ("end", "direct shear of steel beads, friction angle at the end of the test, °"),
    ]
    .iter()
    .enumerate()
    .map(|(which, (id, quantity))| {
        let values = angles(bench, &loads, ratio(which));
        let row = Row::of("beads", &format!("beads-{id}"), quantity, &values);
        let of_peak = format!(". The peak is the largest mean of {TOGETHER} samples: {NOISE}");
        let more = if *id == "peak" { of_peak.as_str() } else { "" };
        let row = row.noted(note.clone() + more);
        Row { decimals: 1, ..row }
    })
    .collect()
}

fn chart(tests: &[Test]) -> Chart {
    let at_stresses = tests.iter().filter(|test| test.point < STRESSES.len());
    let curves: Vec<(usize, &[Sheared])> =
        at_stresses.map(|test| (test.point, &test.moments[..])).collect();
    let seen = "Stress ratio and height of the lid against displacement, each realisation a line.";
    let panels = panels(&called(&STRESSES), &curves);
    Chart::new("beads", "Direct shear of steel beads", seen, panels)
}
