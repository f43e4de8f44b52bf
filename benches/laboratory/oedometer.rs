//! An oedometer: void ratio against stress, and which part of the compression comes back.

use std::f64::consts::PI;

use pluvia::{
    report::{Axis, Chart, Look, Plot},
    units::{from_kpa, from_mm},
};

use super::{
    bench::{Bench, Point, Run},
    legend::names,
    row::{Found, Row},
    standard_tests::{Compressed, Rebound, compression_index, rebound, void_ratio_of_height},
};

const SCENARIO: &str = "scenarios/validation/oedometer.json";
/// Number of the first stage that presses; ten more follow.
const FIRST: usize = 2;
const STEPS: usize = 11;
/// Numbers of states among them: 12.5, 50 and 200 kPa loaded first, then 50 and 12.5 unloaded, and
/// 200 loaded again.
const START: usize = 0;
const MIDDLE: usize = 2;
const TOP: usize = 4;
const DOWN: usize = 6;
const END: usize = 8;
const AGAIN: usize = 10;
/// Height in mm of the middle of the lid above its lower side.
const HALF_LID_MM: f64 = 5.0;

/// A test of a realisation.
struct Test {
    states: Vec<Compressed>,
    /// Void ratio of each.
    void_ratios: Vec<f64>,
}

impl Test {
    fn rebound(&self) -> Option<Rebound> {
        rebound(&self.states[START], &self.states[TOP], &self.states[END])
    }

    fn index(&self, one: usize, other: usize) -> Option<f64> {
        let state = |n: usize| (self.states[n].stress, self.void_ratios[n]);
        compression_index(state(one), state(other))
    }
}

/// Runs the test.
pub fn carry_out(bench: &Bench) -> Result<Found, String> {
    let (diameter_mm, changes) =
        if bench.is_small() { (100.0, Vec::new()) } else { (200.0, wide()) };
    let area = PI / 4.0 * from_mm(diameter_mm).powi(2);
    let as_it_is = Point { name: "loaded".into(), changes: changes.clone(), most: None };
    let runs = bench.run("oedometer", SCENARIO, &[as_it_is])?;
    let stiffness = runs.first().map(Run::contact_stiffness).transpose()?.unwrap_or(0.0);
    // Whether what comes back is the springs: were it springs alone, it would be half with
    // contacts twice as stiff.
    let mut stiffer = changes;
    stiffer.push(format!("engine.native.contact_stiffness_n_per_m={}", 2.0 * stiffness));
    let most = bench.is_small().then_some(1);
    let stiffer = Point { name: "stiffer".into(), changes: stiffer, most };
    let stiff_runs = match bench.is_quick() {
        true => Vec::new(),
        false => bench.run("oedometer-stiffer", SCENARIO, &[stiffer])?,
    };
    let tests = |runs: &[Run]| -> Result<Vec<Test>, String> {
        runs.iter().map(|run| test(run, area)).collect()
    };
    let (own, stiff) = (tests(&runs)?, tests(&stiff_runs)?);
    let rows = rows(&own, &stiff, stiffness, diameter_mm);
    Ok(Found { rows, charts: vec![chart(&own)] })
}

/// Twice as wide and as high.
fn wide() -> Vec<String> {
    [
        "grains.total_mass_g=4000",
        "pieces.0.shape.cylinder.inner_diameter_mm=200",
        "pieces.0.shape.cylinder.height_mm=200",
        "pieces.1.shape.disc.diameter_mm=199",
        "pieces.1.at_mm=[0,0,240]",
        "stages.0.at_mm=[0,0,190]",
        "stages.0.diameter_mm=190",
        "stages.0.rate_g_per_s=2000",
    ]
    .map(str::to_owned)
    .to_vec()
}

fn test(run: &Run, area: f64) -> Result<Test, String> {
    let rows = run.series(["stage", "lid_z_mm", "lid_pressed_n", "lid_pressed_kpa"])?;
    let solids = run.summary("/grains/solids_volume_cm3")?.ok_or("no volume of solids")? * 1e-6;
    let mut states = Vec::new();
    for stage in FIRST..FIRST + STEPS {
        let last = rows.iter().rfind(|row| row[0] == stage as f64);
        let [_, lid_mm, force, kpa] = last.ok_or_else(|| format!("no stage {stage}"))?;
        states.push(Compressed {
            stress: from_kpa(*kpa),
            force: *force,
            height: from_mm(lid_mm - HALF_LID_MM),
            stored: run.stored_in_springs(stage)?,
        });
    }
    let void_ratios =
        states.iter().map(|state| void_ratio_of_height(state.height, area, solids)).collect();
    Ok(Test { states, void_ratios })
}

fn rows(tests: &[Test], stiff: &[Test], stiffness: f64, diameter_mm: f64) -> Vec<Row> {
    let values = |tests: &[Test], of: fn(&Rebound) -> f64| -> Vec<f64> {
        tests.iter().filter_map(Test::rebound).map(|r| 100.0 * of(&r)).collect()
    };
    let indices = |tests: &[Test], one: usize, other: usize| -> Vec<f64> {
        tests.iter().filter_map(|test| test.index(one, other)).collect()
    };
    let begin: Vec<f64> =
        tests.iter().filter_map(|test| test.void_ratios.first().copied()).collect();
    let again: Vec<f64> = tests
        .iter()
        .map(|t| {
            let height = |n: usize| t.states[n].height;
            100.0 * (height(END) - height(AGAIN)) / (height(START) - height(TOP))
        })
        .collect();
    let first = pluvia::measure::statistics::mean(
        &stiff.iter().filter_map(Test::rebound).map(|r| 100.0 * r.came_back).collect::<Vec<_>>(),
    );
    let springs = pluvia::measure::statistics::mean(&values(stiff, |r| r.of_springs));
    let stiffer = match first.zip(springs) {
        Some((back, springs)) => format!(
            ". With contacts twice as stiff {back:.0} %, of the springs {springs:.0} % ({})",
            match stiff.len() {
                1 => "one realisation".to_owned(),
                n => format!("{n} realisations"),
            }
        ),
        None => String::new(),
    };
    let row = |id: &str, quantity: &str, values: &[f64], note: &str, decimals| {
        let id = format!("oedometer-{id}");
        let mut row = Row::of("oedometer", &id, quantity, values).noted(note);
        row.decimals = decimals;
        row
    };
    let how = format!(
        "12.5 to 200 kPa and back, {diameter_mm:.0} mm wide; contacts of {:.0} kN/m. The rest of \
         the compression stays: grains that have moved for good, and springs that friction holds",
        stiffness * 1e-3
    );
    vec![
        row(
            "came-back",
            "oedometer, share of the compression that comes back, %",
            &values(tests, |r| r.came_back),
            &(how + &stiffer),
            0,
        ),
        row(
            "springs",
            "oedometer, share that the springs of contacts can give back, %",
            &values(tests, |r| r.of_springs),
            "Energy ½ f²/k of all contacts that unloading sets free, over the mean force of the lid: \
             a bound, since friction takes a part of it where grains slide back",
            0,
        ),
        row(
            "again",
            "oedometer, loaded again, compression over that of the first loading, %",
            &again,
            "12.5 to 200 kPa both times",
            0,
        ),
        row(
            "compression-index",
            "oedometer, compression index, 50 to 200 kPa",
            &indices(tests, MIDDLE, TOP),
            "Fall of the void ratio for ten times the stress, by the height of the lid",
            3,
        ),
        row(
            "swelling-index",
            "oedometer, swelling index, 200 to 50 kPa",
            &indices(tests, TOP, DOWN),
            "The same on unloading. Were it the springs alone, it would halve with contacts twice as \
             stiff: see the row below",
            3,
        ),
        row(
            "swelling-index-stiffer",
            "oedometer, swelling index, 200 to 50 kPa, contacts twice as stiff",
            &indices(stiff, TOP, DOWN),
            "Another specimen of the same grains, poured anew: its void ratio differs, too",
            3,
        ),
        row(
            "void-ratio",
            "oedometer, void ratio at 12.5 kPa, loaded first",
            &begin,
            "By the height of the lid",
            3,
        ),
    ]
}

fn chart(tests: &[Test]) -> Chart {
    let mut plot = Plot::new(Axis::logarithmic("Stress (kPa)"), Axis::linear("Void ratio"));
    let kinds = ["Loaded", "Unloaded", "Loaded again"].map(str::to_owned);
    let ends = [(START, TOP), (TOP, END), (END, AGAIN)];
    let lines: Vec<usize> = tests.iter().flat_map(|_| 0..ends.len()).collect();
    let mut names = names(&kinds, &lines).into_iter();
    for test in tests {
        let point = |n: usize| (test.states[n].stress * 1e-3, test.void_ratios[n]);
        for (kind, (from, to)) in ends.into_iter().enumerate() {
            let name = names.next().unwrap_or_default();
            plot.add(name, Look::marked(kind), (from..=to).map(point).collect());
        }
    }
    let seen = "Void ratio, by the height of the lid, against its stress, each realisation a line.";
    Chart::new("oedometer", "Oedometer", seen, vec![plot])
}
