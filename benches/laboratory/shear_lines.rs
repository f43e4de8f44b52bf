//! Lines of shear tests in figures.

use pluvia::{
    report::{Axis, Look, Plot},
    units::to_mm,
};

use super::standard_tests::Sheared;

/// What stresses in kPa are called in a figure.
pub fn called(stresses: &[f64]) -> Vec<String> {
    stresses.iter().map(|stress| format!("{stress} kPa")).collect()
}

/// Names of lines in a figure, each of a kind by its number: the first of a kind has its name, the
/// others have none.
pub fn names(kinds: &[String], lines: &[usize]) -> Vec<String> {
    let name = |(n, kind): (usize, &usize)| {
        let is_first = !lines[..n].contains(kind);
        if is_first { kinds[*kind].clone() } else { String::new() }
    };
    lines.iter().enumerate().map(name).collect()
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
