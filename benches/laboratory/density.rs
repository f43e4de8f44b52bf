//! The loosest and the densest state of grains.

use pluvia::study::{DensityOptions, IndexDensities, IndexState, index_densities};

use super::{
    bench::{Bench, root},
    row::{Found, Published, Row, Rule},
};

const NOT_SEEN: &str = "not seen: Mathematical Problems in Engineering 2021, 5092612, Table 1, after \
    Youd, was asked for and not found; gravel 7.5 to 19.2 mm, roundness 0.30 to 0.59";

/// A vertical vibration.
struct Vibration {
    /// Folder of its runs.
    name: &'static str,
    surcharge_kpa: f64,
    frequency_hz: f64,
    double_amplitude_mm: f64,
    /// How long it is in the quick design, and in all of it, in s.
    duration_s: [f64; 2],
    /// At most so many realisations.
    most: u32,
}

/// What makes grains dense within seconds.
const STRONG: Vibration = Vibration {
    name: "density",
    surcharge_kpa: 0.0,
    frequency_hz: 12.0,
    double_amplitude_mm: 10.0,
    duration_s: [8.0, 60.0],
    most: u32::MAX,
};

/// As ASTM D4253 has it, but for its 8 minutes.
const STANDARD: Vibration = Vibration {
    name: "density-d4253",
    surcharge_kpa: 13.8,
    frequency_hz: 60.0,
    double_amplitude_mm: 0.33,
    duration_s: [4.0, 60.0],
    most: 1,
};

/// Runs the test.
pub fn carry_out(bench: &Bench) -> Result<Found, String> {
    let found = states(bench, &STRONG)?;
    let standard = states(bench, &STANDARD)?;
    let row = |id: &str, quantity: &str, published: Option<f64>, state: &IndexState| {
        let published = published.map(|value| Published::Value { value });
        let mut note = format!("{} grains, {}", found.grains, state.method);
        for failure in &state.failures {
            note += &format!("; {failure}");
        }
        let mut row = Row::of("density", id, quantity, Rule::Unseen(published), &state.values)
            .seen(if published.is_some() { NOT_SEEN } else { "none is published" })
            .noted(note);
        row.decimals = 3;
        bench.design().clone_into(&mut row.design);
        row
    };
    let loosest = "void ratio of the loosest state";
    let densest = "void ratio of the densest state";
    let vibrated = "void ratio, vibrated as in ASTM D4253, but for seconds";
    let bound = "void ratio without friction, a bound";
    // Whether it has come to an end.
    let vibrated_row = |id: &str, quantity: &str, of: &IndexDensities| {
        let mut row = row(id, quantity, Some(0.546), &of.e_min);
        if let Some(change) = pluvia::measure::statistics::mean(&of.second_half) {
            row.note += &format!("; it fell by {change:.3} in the second half of that time");
        }
        row
    };
    let rows = vec![
        row("density-e-max", loosest, Some(0.774), &found.e_max),
        vibrated_row("density-e-min", densest, &found),
        vibrated_row("density-d4253", vibrated, &standard),
        row("density-frictionless", bound, None, &found.frictionless),
    ];
    Ok(Found { rows, charts: Vec::new() })
}

fn states(bench: &Bench, vibration: &Vibration) -> Result<IndexDensities, String> {
    let name = if bench.quick { "quick" } else { "paper" };
    index_densities(&DensityOptions {
        scenario: root().join(format!("scenarios/{name}/pluviation.json")),
        changes: Vec::new(),
        configurations: bench.configurations.min(vibration.most),
        surcharge_kpa: vibration.surcharge_kpa,
        frequency_hz: vibration.frequency_hz,
        double_amplitude_mm: vibration.double_amplitude_mm,
        duration_s: vibration.duration_s[usize::from(!bench.quick)],
        run: bench.options(vibration.name),
    })
    .map_err(|e| e.to_string())
}
