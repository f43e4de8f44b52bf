//! Factors varied one at a time as `pluvia sensitivity` has them: the same rows
//! by the same rules, whichever of the two commands run the runs.

use super::*;
use crate::study::sensitivity::table;

/// The table of a sweep that varies one thing at a time; none of other sweeps,
/// nor where no factor is a number.
pub(super) fn sensitivity(
    study: &SweepStudy,
    factors: &[SweepFactor],
    runs: &[RunRow],
) -> Option<Sensitivity> {
    if study.options.design != Design::OneAtATime {
        return None;
    }
    let of_over = factors.iter().take(study.options.over.len());
    let numbered = of_over.enumerate().filter_map(|(n, factor)| {
        let own = study.points.first()?.values[n].as_f64()?;
        Some((n, parameter(factor, own)?))
    });
    let designed = (study.options.over.len()..).zip(study.options.parameters.iter().cloned());
    let (places, parameters): (Vec<usize>, Vec<Parameter>) = numbered.chain(designed).unzip();
    if parameters.is_empty() {
        return None;
    }
    let variation = |parameter: &Parameter, end: End| {
        let place = parameters.iter().position(|p| p == parameter).map(|n| places[n]);
        let value = match end {
            End::Low => parameter.low,
            End::Default => parameter.default,
            End::High => parameter.high,
        };
        let point = study.points.iter().find(|point| match point.varies {
            None => value == parameter.default,
            varies => {
                varies == place && place.and_then(|n| point.values[n].as_f64()) == Some(value)
            }
        });
        point.map_or_else(String::new, |p| p.name.clone())
    };
    let own = study.points.first().map_or("", |p| p.name.as_str());
    let quick = study.options.quick;
    Some(table(&study.scenario, quick, &parameters, variation, own, runs))
}

/// A factor with listed values as a parameter from the least of them to the
/// largest; none where they are no numbers, or but one.
fn parameter(factor: &SweepFactor, default: f64) -> Option<Parameter> {
    let numbers: Vec<f64> =
        factor.values.iter().map(serde_json::Value::as_f64).collect::<Option<_>>()?;
    let low = numbers.iter().copied().fold(default, f64::min);
    let high = numbers.iter().copied().fold(default, f64::max);
    (low < high).then(|| Parameter {
        name: factor.path.clone(),
        title: factor.path.clone(),
        reason: "given on the command line".to_owned(),
        path: factor.path.clone(),
        low,
        default,
        high,
        ..Parameter::default()
    })
}
