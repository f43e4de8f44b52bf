//! How runs of shear tests are read, and their lines in figures.

use pluvia::{
    report::{Axis, Look, Plot},
    units::{from_mm, to_mm},
};

use super::{
    bench::{Bench, Run},
    legend::names,
    standard_tests::{Sheared, between_samples},
};

/// Stage in which the lower half is drawn aside.
pub const SHEARING: f64 = 3.0;
const GRAVITY: f64 = 9.81;

/// Displacement, forces on the lower half and height of the lid while it is sheared, half way
/// between samples. The weight of the grains in the lower half, below the height of the plane in m,
/// is no force across it.
pub fn moments(run: &Run, plane: f64) -> Result<Vec<Sheared>, String> {
    let rows = run.series([
        "time_s",
        "stage",
        "lower_x_mm",
        "lower_force_x_n",
        "lower_force_z_n",
        "lid_z_mm",
    ])?;
    let before = run.specimen(Some("2"))?;
    let below = |i: &usize| before.state.bodies[*i].body.pose.translation.z < plane;
    let mass: f64 = before.present().filter(below).map(|i| before.grains.grains[i].mass).sum();
    let sample = |row: &[f64; 6]| {
        let (displacement, height) = (from_mm(row[2]), from_mm(row[5]));
        let (shear, normal) = (-row[3], -row[4] - mass * GRAVITY);
        (row[0], Sheared { displacement, shear, normal, height })
    };
    // The first is at the moment at which the half begins to move.
    let shearing = rows.iter().filter(|row| row[1] == SHEARING);
    Ok(between_samples(&shearing.map(sample).collect::<Vec<_>>()))
}

/// What must be known of a largest mean. How much it is too large does not follow from a test: what
/// of a dozen samples is noise depends on the line that is drawn through them.
pub const NOISE: &str = "of means that scatter the largest is taken, so that noise raises the peak";

/// Says that a run has no peak or no end.
pub fn leave_out(bench: &Bench, run: &Run) {
    let run = run.folder.file_name().unwrap_or_default().to_string_lossy();
    bench.leave_out(format!("{run} (not sheared)"));
}

/// What stresses in kPa are called in a figure.
pub fn called(stresses: &[f64]) -> Vec<String> {
    stresses.iter().map(|stress| format!("{stress} kPa")).collect()
}

/// Stress ratio and rise of the lid against displacement: of each test the number of its kind, by
/// which its line looks, and its moments.
pub fn panels(kinds: &[String], tests: &[(usize, &[Sheared])]) -> Vec<Plot> {
    let lines: Vec<usize> = tests.iter().map(|test| test.0).collect();
    let panel = |name: &str, y: fn(&Sheared, &Sheared) -> f64| {
        let x = Axis::linear("Displacement (mm)").from_zero();
        let mut plot = Plot::new(x, Axis::linear(name).from_zero());
        for ((kind, moments), name) in tests.iter().zip(names(kinds, &lines)) {
            let points = moments.iter().map(|m| (to_mm(m.displacement), y(&moments[0], m)));
            plot.add(name, Look::marked(*kind), points.collect());
        }
        plot
    };
    vec![
        panel("Stress ratio τ/σ", |_, m| m.ratio()),
        panel("Rise of the lid (mm)", |first, m| to_mm(m.height - first.height)),
    ]
}
