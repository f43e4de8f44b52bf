//! The loosest and the densest state of grains.

use pluvia::study::{DensityOptions, IndexState, index_densities};

use super::{
    bench::{Bench, root},
    row::{Found, Published, Row, Rule},
};

const NOT_SEEN: &str = "not seen: Mathematical Problems in Engineering 2021, 5092612, Table 1, after Youd, \
    was asked for and not found; gravel 7.5 to 19.2 mm, roundness 0.30 to 0.59";

/// Runs the test.
pub fn carry_out(bench: &Bench) -> Result<Found, String> {
    let scenario = if bench.quick {
        "scenarios/quick/pluviation.json"
    } else {
        "scenarios/paper/pluviation.json"
    };
    let found = index_densities(&DensityOptions {
        scenario: root().join(scenario),
        changes: Vec::new(),
        configurations: bench.configurations,
        surcharge_kpa: 13.8,
        frequency_hz: 60.0,
        double_amplitude_mm: 0.33,
        duration_s: if bench.quick { 4.0 } else { 60.0 },
        run: bench.options("density"),
    })
    .map_err(|e| e.to_string())?;
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
    let rows = vec![
        row("density-e-max", "void ratio of the loosest state", Some(0.774), &found.e_max),
        row("density-e-min", "void ratio of the densest state", Some(0.546), &found.e_min),
        row(
            "density-frictionless",
            "void ratio without friction, a bound",
            None,
            &found.frictionless,
        ),
    ];
    Ok(Found { rows, charts: Vec::new() })
}
