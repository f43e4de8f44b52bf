//! The loosest and the densest state of grains.

use pluvia::{
    report::{Axis, Chart, Look, Plot},
    study::{DensityOptions, DensityStudy, IndexDensities, IndexState},
};

use super::{
    bench::{Bench, Run, root},
    row::{Found, Row, Rule},
};

const TABLE: &str = "Mathematical Problems in Engineering 2021, 5092612, Table 1, after Youd, seen";

/// How far from a published void ratio ours may be.
const WANTED: f64 = 0.05;

/// A material whose index densities are published.
struct Material {
    /// The scenario's name, and that of its rows.
    name: &'static str,
    /// What it is called in rows.
    title: &'static str,
    roundness: f64,
    e_max: f64,
    e_min: f64,
    /// What the table says of it.
    seen: &'static str,
}

const MATERIALS: [Material; 2] = [
    Material {
        name: "basalt",
        title: "crushed basalt",
        roundness: 0.19,
        e_max: 1.257,
        e_min: 0.705,
        seen: "CB-Mix No. 1, two halves of 0.5 to 0.7 and 0.7 to 1 mm, roundness 0.19",
    },
    Material {
        name: "gravel",
        title: "river gravel",
        roundness: 0.45,
        e_max: 0.774,
        e_min: 0.546,
        seen: "G2-8, 7.49 to 19.21 mm in four fractions of roundness 0.30, 0.41, 0.59, 0.59",
    },
];

/// A vertical vibration.
struct Vibration {
    /// Ending of its folder of runs.
    name: &'static str,
    surcharge_kpa: f64,
    frequency_hz: f64,
    double_amplitude_mm: f64,
    /// How long it is in the small designs, and in the full one, in s.
    duration_s: [f64; 2],
    /// At most so many realisations.
    most: u32,
}

/// What makes grains dense within seconds.
const STRONG: Vibration = Vibration {
    name: "vibrated",
    surcharge_kpa: 0.0,
    frequency_hz: 12.0,
    double_amplitude_mm: 8.0,
    duration_s: [8.0, 60.0],
    most: u32::MAX,
};

/// As ASTM D4253 has it, but for its 8 minutes.
const STANDARD: Vibration = Vibration {
    name: "d4253",
    surcharge_kpa: 13.8,
    frequency_hz: 60.0,
    double_amplitude_mm: 0.33,
    duration_s: [4.0, 60.0],
    most: 1,
};

/// Runs the test: of the paper's grains, and of those that are published.
pub fn carry_out(bench: &Bench) -> Result<Found, String> {
    let paper = format!("{}/pluviation", if bench.is_small() { "quick" } else { "paper" });
    let found = states(bench, &paper, &STRONG)?;
    let standard = match bench.is_quick() {
        true => None,
        false => Some(states(bench, &paper, &STANDARD)?),
    };
    let none = |id: &str, state: &str, of: &IndexState, note: String| {
        let quantity = format!("void ratio of the paper's grains, {state}");
        row(bench, &format!("density-{id}"), &quantity, Rule::Unseen(None), of)
            .seen("none is published")
            .noted(note)
    };
    let mut rows = vec![
        none("e-max", "loosest", &found.states.e_max, made(&found, &found.states.e_max)),
        none(
            "e-min",
            "densest",
            &found.states.e_min,
            made(&found, &found.states.e_min) + &still_falls(&found),
        ),
        none(
            "frictionless",
            BOUND,
            &found.states.frictionless,
            made(&found, &found.states.frictionless),
        ),
    ];
    rows.extend(standard.iter().map(|standard| {
        none(
            "d4253",
            "vibrated as in ASTM D4253, but for seconds",
            &standard.states.e_min,
            made(standard, &standard.states.e_min) + &still_falls(standard),
        )
    }));
    let mut points = Vec::new();
    let materials = if bench.is_quick() { &MATERIALS[1..] } else { &MATERIALS[..] };
    for material in materials {
        let found = states(bench, &format!("validation/density-{}", material.name), &STRONG)?;
        let of = |id: &str, state: &str, of: &IndexState, published: Option<f64>| {
            let rule = match published {
                Some(value) => Rule::Range(value - WANTED, value + WANTED),
                None => Rule::Unseen(None),
            };
            let id = format!("density-{}-{id}", material.name);
            let quantity = format!("void ratio of {}, {state}", material.title);
            let source = match published {
                Some(value) => format!("{TABLE}: {}: {value}. ± {WANTED} is ours", material.seen),
                None => "none is published".to_owned(),
            };
            let note = format!(
                "{}; roundness {}, friction between grains 0.5",
                made(&found, of),
                material.roundness
            );
            row(bench, &id, &quantity, rule, of).seen(&source).noted(note)
        };
        rows.push(of("e-max", "loosest", &found.states.e_max, Some(material.e_max)));
        let mut densest = of("e-min", "densest", &found.states.e_min, Some(material.e_min));
        densest.note += &still_falls(&found);
        rows.push(densest);
        rows.push(of("frictionless", BOUND, &found.states.frictionless, None));
        points.push((material, found));
    }
    Ok(Found { rows, charts: vec![chart(&points), settling(bench, &paper)?] })
}

const BOUND: &str = "without friction, a bound";

fn row(bench: &Bench, id: &str, quantity: &str, rule: Rule, state: &IndexState) -> Row {
    let mut row = Row::of("density", id, quantity, rule, &state.values);
    row.decimals = 3;
    bench.design().clone_into(&mut row.design);
    row
}

/// How a state was made.
fn made(found: &IndexDensities, state: &IndexState) -> String {
    let mut note = format!("{} grains, {}", found.grains, state.method);
    for failure in &state.failures {
        note += &format!("; {failure}");
    }
    note
}

/// Share of a cycle within which two moments are the same.
const SAME_MOMENT: f64 = 0.02;

/// Whether the vibration has come to an end.
fn still_falls(found: &IndexDensities) -> String {
    match pluvia::measure::statistics::mean(&found.second_half) {
        Some(change) => format!("; it fell by {change:.3} in the second half of that time"),
        None => String::new(),
    }
}

/// The folder of a scenario's runs, in that of all.
fn folder(scenario: &str, vibration: &Vibration) -> String {
    format!("{}-{}", scenario.replace("validation/", "").replace('/', "-"), vibration.name)
}

/// How specimens sink while they are vibrated.
fn settling(bench: &Bench, paper: &str) -> Result<Chart, String> {
    let mut plot = Plot::new(
        Axis::linear("Time of vibration (s)").from_zero(),
        Axis::linear("Mean surface over its height at the end"),
    );
    let own = [(paper, "The paper's grains", &STRONG), (paper, "The same, 60 Hz", &STANDARD)];
    let scenarios: Vec<String> =
        MATERIALS.iter().map(|material| format!("validation/density-{}", material.name)).collect();
    let published = scenarios.iter().zip(&MATERIALS).map(|(path, m)| (&path[..], m.title, &STRONG));
    for (kind, (scenario, title, vibration)) in own.into_iter().chain(published).enumerate() {
        let out = bench.options(&folder(scenario, vibration)).out;
        for configuration in 1..=bench.configurations.min(vibration.most) {
            let folder = out.join(format!("runs/densest-c{configuration}"));
            if !folder.join("series.csv").exists() {
                continue;
            }
            let run = Run { point: 0, configuration, folder };
            let rows = run.series(["time_s", "stage", "mean_surface_mm"])?;
            let Some(last) = rows.last() else { continue };
            let shaken: Vec<&[f64; 3]> = rows.iter().filter(|row| row[1] == last[1]).collect();
            // Beds heave with the table: only heights at the same moment of its cycle compare.
            let off = |time: f64| {
                let cycles = time * vibration.frequency_hz;
                (cycles - cycles.round()).abs()
            };
            let points = shaken.iter().map(|row| (row[0] - shaken[0][0], row[2] / last[2]));
            let points = points.filter(|(time, _)| off(*time) < SAME_MOMENT);
            let name = if configuration == 1 { title } else { "" };
            plot.add(name, Look::marked(kind), points.collect());
        }
    }
    Ok(Chart {
        stem: "density-vibration".into(),
        title: "How specimens sink while they are vibrated".into(),
        caption: "Mean surface against time, at the same moment of the table's cycle, each \
                  realisation a line. Where it still falls, the densest state is not reached."
            .into(),
        panels: vec![plot],
    })
}

fn states(bench: &Bench, scenario: &str, vibration: &Vibration) -> Result<IndexDensities, String> {
    let options = DensityOptions {
        scenario: root().join(format!("scenarios/{scenario}.json")),
        changes: Vec::new(),
        configurations: bench.configurations.min(vibration.most),
        surcharge_kpa: vibration.surcharge_kpa,
        frequency_hz: vibration.frequency_hz,
        double_amplitude_mm: vibration.double_amplitude_mm,
        duration_s: vibration.duration_s[usize::from(!bench.is_small())],
        run: bench.options(&folder(scenario, vibration)),
    };
    DensityStudy::new(&options).and_then(|study| study.carry_out()).map_err(|e| e.to_string())
}

fn chart(found: &[(&Material, IndexDensities)]) -> Chart {
    type Value = fn(&(&Material, IndexDensities)) -> Vec<f64>;
    let mut plot = Plot::new(Axis::linear("Roundness"), Axis::linear("Void ratio"));
    let mut add = |name: &str, look, values: Value| {
        let points =
            found.iter().flat_map(|of| values(of).into_iter().map(|e| (of.0.roundness, e)));
        plot.add(name, look, points.collect());
    };
    add("Loosest", Look::points(0), |of| of.1.states.e_max.values.clone());
    add("Densest", Look::points(1), |of| of.1.states.e_min.values.clone());
    add("Without friction", Look::points(2), |of| of.1.states.frictionless.values.clone());
    add("Published, loosest", Look::dots(0), |of| vec![of.0.e_max]);
    add("Published, densest", Look::dots(1), |of| vec![of.0.e_min]);
    Chart {
        stem: "density".into(),
        title: "Loosest and densest states of published materials".into(),
        caption: "Void ratio over roundness: each realisation, and what is published.".into(),
        panels: vec![plot],
    }
}
