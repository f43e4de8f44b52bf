//! How near the native solver comes: at one instant, and over those of a scene.

use pluvia::measure::statistics::{mean, percentile};
use serde::{Deserialize, Serialize};
use serde_json::Value;

use super::program::number;

/// Residual at which the reference is solved (`main.cpp`).
const SOLVED: f64 = 1e-10;

/// One instant, as it is kept in `steps.jsonl`.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Instant {
    pub scene: String,
    pub engine: String,
    /// Of the stage.
    pub step: u64,
    /// Fingerprint of what computed it.
    pub by: String,
    pub time_s: f64,
    pub grains: usize,
    pub contacts: f64,
    /// Of every touched body: distance of its velocity from the reference in the
    /// kinetic norm, over the root mean square of what contacts change.
    pub velocity_errors: Vec<f64>,
    /// Natural-map residuals of the reference and of what was found.
    pub residual: f64,
    pub engine_residual: f64,
    /// Siconos' measure of the reference's error.
    pub siconos_error: f64,
    /// How far the velocities are from those that the impulses give.
    pub inconsistency: f64,
    /// 99th percentile of the distance between the solutions from what was found
    /// and from nothing.
    pub other_solution_p99: Option<f64>,
    /// Wall time of the reference.
    pub wall_s: f64,
}

impl Instant {
    /// From the referee's answer.
    pub fn of(
        answer: &Value,
        scene: &str,
        engine: &str,
        step: u64,
        by: &str,
        grains: usize,
    ) -> Result<Self, String> {
        let number = |field| number(answer, field);
        let errors = answer["velocity_errors"].as_array().into_iter().flatten();
        Ok(Self {
            scene: scene.to_owned(),
            engine: engine.to_owned(),
            step,
            by: by.to_owned(),
            time_s: number("time_s")?,
            grains,
            contacts: number("contacts")?,
            velocity_errors: errors.filter_map(Value::as_f64).collect(),
            residual: number("residual")?,
            engine_residual: number("residual_given")?,
            siconos_error: number("siconos_error")?,
            inconsistency: number("inconsistency")?,
            other_solution_p99: answer["afresh_p99"].as_f64(),
            wall_s: number("wall_s")?,
        })
    }

    /// Percentile of the bodies' errors, in %.
    pub fn error_percent(&self, rank: f64) -> f64 {
        100.0 * percentile(&self.velocity_errors, rank).unwrap_or(f64::NAN)
    }

    /// Distance of all velocities together from the reference, over all that
    /// contacts change, in %.
    pub fn whole_error_percent(&self) -> f64 {
        let squares: Vec<f64> = self.velocity_errors.iter().map(|e| e * e).collect();
        100.0 * mean(&squares).unwrap_or(f64::NAN).sqrt()
    }
}

/// How near the native solver comes in one scene.
#[derive(Debug, Clone, Serialize)]
pub struct Nearness {
    pub scene: String,
    pub grains: usize,
    /// Contact points, mean of the instants.
    pub contacts: f64,
    pub engine: String,
    pub instants: usize,
    /// Those whose reference is solved; all are compared.
    pub instants_below_1e_10: usize,
    /// Over all touched bodies of all instants.
    pub velocity_error_median_percent: f64,
    pub velocity_error_p99_percent: f64,
    pub velocity_error_worst_percent: f64,
    /// Of an instant's velocities as a whole: median and worst of the instants.
    pub instant_error_median_percent: f64,
    pub instant_error_worst_percent: f64,
    /// The worst of the instants: residual of the reference, and of what was found.
    pub reference_residual: f64,
    pub engine_residual: f64,
    /// Worst of the instants.
    pub siconos_error_worst: f64,
    /// Worst of the instants; `null` unless solved twice.
    pub other_solution_p99_percent: Option<f64>,
    pub inconsistency: f64,
    pub reference_wall_s_per_instant: f64,
}

/// Sums up the instants of a scene; `None` of none.
pub fn summary(scene: &str, engine: &str, instants: &[&Instant]) -> Option<Nearness> {
    let first = instants.first()?;
    let all = |value: &dyn Fn(&Instant) -> f64| -> Vec<f64> {
        instants.iter().map(|i| value(i)).collect()
    };
    let average = |value: &dyn Fn(&Instant) -> f64| mean(&all(value)).unwrap_or(f64::NAN);
    let worst = |value: &dyn Fn(&Instant) -> f64| all(value).into_iter().fold(0.0, f64::max);
    let errors: Vec<f64> =
        instants.iter().flat_map(|i| i.velocity_errors.iter().copied()).collect();
    let error = |rank| 100.0 * percentile(&errors, rank).unwrap_or(f64::NAN);
    let whole = all(&|i| i.whole_error_percent());
    let others: Vec<f64> = instants.iter().filter_map(|i| i.other_solution_p99).collect();
    Some(Nearness {
        scene: scene.to_owned(),
        grains: first.grains,
        contacts: average(&|i| i.contacts).round(),
        engine: engine.to_owned(),
        instants: instants.len(),
        instants_below_1e_10: instants.iter().filter(|i| i.residual < SOLVED).count(),
        velocity_error_median_percent: error(50.0),
        velocity_error_p99_percent: error(99.0),
        velocity_error_worst_percent: error(100.0),
        instant_error_median_percent: percentile(&whole, 50.0).unwrap_or(f64::NAN),
        instant_error_worst_percent: percentile(&whole, 100.0).unwrap_or(f64::NAN),
        reference_residual: worst(&|i| i.residual),
        engine_residual: worst(&|i| i.engine_residual),
        siconos_error_worst: worst(&|i| i.siconos_error),
        other_solution_p99_percent: others.into_iter().reduce(f64::max).map(|o| 100.0 * o),
        inconsistency: worst(&|i| i.inconsistency),
        reference_wall_s_per_instant: average(&|i| i.wall_s),
    })
}
