//! The points of a sweep: which values of all factors go together.

use super::factor::same;
use super::*;
use crate::grains::streams::{shuffle, stream, uniform};
use crate::scenario::renamed_field;

/// Most points of a sweep: more is a slip of the hand.
const MOST_POINTS: usize = 10_000;

/// One point of a sweep.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Point {
    /// `point-0001` and so on; the folders of its runs begin so.
    pub name: String,
    /// The value of each factor, in their order.
    pub values: Vec<Value>,
    /// What it changes in the scenario.
    pub changes: Vec<Override>,
    /// The factor that differs from the scenario, where they are varied one at
    /// a time; none of the scenario itself, and in other sweeps.
    pub varies: Option<usize>,
}

impl Point {
    /// The same with one more value, and what that changes.
    fn with(&self, value: &Value, change: &Override) -> Self {
        let mut point = self.clone();
        point.values.push(value.clone());
        point.changes.push(change.clone());
        point
    }
}

/// How points are made of values.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Design {
    /// Every value of each factor with every value of the others.
    Grid,
    /// The scenario itself, then each value of each factor by itself.
    OneAtATime,
    /// A number of points that fill the ranges evenly.
    LatinHypercube(usize),
}

/// Makes the points. `parameters` are factors after those of `factors`, varied
/// one at a time and only then; `ranges` are factors after both, sampled and only then.
pub(super) fn points(
    design: Design,
    factors: &[Factor],
    parameters: &[Parameter],
    ranges: &[SampledRange],
    base: &Scenario,
) -> Result<Vec<Point>, StudyError> {
    let points = match design {
        Design::Grid => grid(factors)?,
        Design::OneAtATime => one_at_a_time(factors, parameters, base)?,
        Design::LatinHypercube(count) => {
            let mut all = Vec::new();
            let samples = latin_hypercube(count, ranges, base)?;
            for at in grid(factors)? {
                all.extend(samples.iter().map(|sample| Point {
                    values: [at.values.as_slice(), &sample.values].concat(),
                    changes: [at.changes.as_slice(), &sample.changes].concat(),
                    ..Point::default()
                }));
            }
            all
        }
    };
    if points.len() > MOST_POINTS {
        let count = points.len();
        return refused(format!("the sweep has {count} points, at most {MOST_POINTS} are allowed"));
    }
    let named = points.into_iter().enumerate();
    Ok(named.map(|(n, point)| Point { name: format!("point-{:04}", n + 1), ..point }).collect())
}

fn grid(factors: &[Factor]) -> Result<Vec<Point>, StudyError> {
    let count = factors.iter().try_fold(1_usize, |n, f| n.checked_mul(f.values.len()));
    if count.is_none_or(|n| n > MOST_POINTS) {
        return refused(format!("the values of --over make more than {MOST_POINTS} points"));
    }
    let mut points = vec![Point::default()];
    for factor in factors {
        let mut extended = Vec::new();
        for point in points {
            extended.extend(factor.values.iter().map(|(value, change)| point.with(value, change)));
        }
        points = extended;
    }
    Ok(points)
}

fn one_at_a_time(
    factors: &[Factor],
    parameters: &[Parameter],
    base: &Scenario,
) -> Result<Vec<Point>, StudyError> {
    let own = factors.iter().map(|f| value_in(base, &f.path));
    let own = own.chain(parameters.iter().map(|p| Ok(json_number(p.default))));
    let own: Vec<Value> = own.collect::<Result<_, _>>()?;
    let mut points = vec![Point { values: own.clone(), ..Point::default() }];
    let mut add = |n: usize, value: Value, changes: Vec<Override>| {
        let mut values = own.clone();
        values[n] = value;
        points.push(Point { values, changes, varies: Some(n), ..Point::default() });
    };
    for (n, factor) in factors.iter().enumerate() {
        for (value, change) in factor.values.iter().filter(|(value, _)| !same(value, &own[n])) {
            add(n, value.clone(), vec![change.clone()]);
        }
    }
    for (n, parameter) in (factors.len()..).zip(parameters) {
        let ends =
            [(parameter.low, &parameter.low_changes), (parameter.high, &parameter.high_changes)];
        // An end without changes is the scenario's own value.
        for (value, changes) in ends.into_iter().filter(|(_, changes)| !changes.is_empty()) {
            let made: Result<Vec<Override>, _> = changes.iter().map(|text| text.parse()).collect();
            let made = made.map_err(|e| StudyError::Scenario(format!("`{}`: {e}", parameter.name)));
            add(n, json_number(value), made?);
        }
    }
    Ok(points)
}

/// A number as a person types it: 480, not 480.0.
pub(super) fn json_number(value: f64) -> Value {
    if value.fract() == 0.0 && value.abs() < 1e15 {
        Value::from(value as i64)
    } else {
        Value::from(value)
    }
}

/// What the scenario has at a path.
fn value_in(scenario: &Scenario, path: &str) -> Result<Value, StudyError> {
    let json = serde_json::to_value(scenario).unwrap_or_default();
    let place: Override = format!("{path}=0")
        .parse()
        .map_err(|e| StudyError::Scenario(format!("--over {path}: {e}")))?;
    place.value_before(&json).filter(|v| !v.is_null()).cloned().ok_or_else(|| {
        StudyError::Scenario(match renamed_field(path) {
            Some(now) => format!("{path}: this field is now called `{now}`"),
            None => format!(
                "the scenario has no value at `{path}` around which it could be varied; give it \
                 one with --set {path}=..."
            ),
        })
    })
}

/// A latin hypercube sample (McKay, Beckman & Conover 1979): each range is cut into as many equal
/// parts as there are samples, and each part is drawn from once. The draws come from a stream named
/// after the path, so that another range does not shift them.
fn latin_hypercube(
    count: usize,
    ranges: &[SampledRange],
    base: &Scenario,
) -> Result<Vec<Point>, StudyError> {
    let mut samples = vec![Point::default(); count];
    for range in ranges {
        let own = value_in(base, &range.path)?;
        let whole = own.is_i64() || own.is_u64();
        let mut rng = stream(base.seed, &format!("sweep {}", range.path));
        let mut parts: Vec<usize> = (0..count).collect();
        shuffle(&mut rng, &mut parts);
        for (sample, part) in samples.iter_mut().zip(parts) {
            let share = (part as f64 + uniform(&mut rng)) / count as f64;
            let value = range.low + share * (range.high - range.low);
            let digits = if whole { 0 } else { digits(range, count) };
            let text = format!("{value:.digits$}");
            let (value, change) =
                Factor::value(&range.path, &text, "--range").map_err(StudyError::Scenario)?;
            *sample = sample.with(&value, &change);
        }
    }
    let mut known = BTreeSet::new();
    let typed = |sample: &Point| -> Vec<String> {
        sample.changes.iter().map(|change| change.text().to_owned()).collect()
    };
    let twice = samples.iter().map(typed).find(|sample| !known.insert(sample.clone()));
    match twice {
        None => Ok(samples),
        Some(twice) => refused(format!(
            "--samples latin-hypercube:{count}: {} is drawn twice, rounded to whole numbers; draw \
             fewer points or from wider ranges, or list the values with --over",
            twice.join(" ")
        )),
    }
}

/// Digits behind the point that leave a hundred numbers to each part of a range, at least six. The
/// numbers can be typed again.
fn digits(range: &SampledRange, count: usize) -> usize {
    let part = (range.high - range.low) / count as f64;
    (100.0 / part).log10().ceil().clamp(6.0, 300.0) as usize
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::*;
    use crate::study::tests::bare_scenario as base;

    fn over(list: &[&str]) -> Vec<Factor> {
        list.iter().map(|text| text.parse().expect("a factor")).collect()
    }

    #[test]
    fn a_grid_has_every_combination_once() {
        let factors = over(&["engine.rate_hz=480,960", "seed=1,2,3"]);
        let all = points(Design::Grid, &factors, &[], &[], &base()).expect("points");
        assert_eq!(all.len(), 6, "law: 2 × 3");
        assert_eq!(all[0].name, "point-0001");
        assert_eq!(all[5].values, [json!(960), json!(3)], "law: the last factor runs fastest");
        let changes: Vec<&str> = all[1].changes.iter().map(Override::text).collect();
        assert_eq!(changes, ["engine.rate_hz=480", "seed=2"]);
    }

    #[test]
    fn one_at_a_time_begins_with_the_scenario_itself() {
        let factors = over(&["engine.rate_hz=240,480,960", "contact.restitution=0.2"]);
        let all = points(Design::OneAtATime, &factors, &[], &[], &base()).expect("points");
        let varies: Vec<_> = all.iter().map(|p| p.varies).collect();
        assert_eq!(varies, [None, Some(0), Some(0), Some(1)], "law: the default is not repeated");
        assert_eq!(all[3].values, [json!(480.0), json!(0.2)], "law: all else as it is");
        assert!(all[0].changes.is_empty(), "law: the first is the scenario");
    }

    #[test]
    fn a_latin_hypercube_draws_once_from_each_part() {
        let ranges: Vec<SampledRange> = ["contact.restitution=0..1", "seed=1..100"]
            .iter()
            .map(|t| t.parse().expect("a range"))
            .collect();
        let all = points(Design::LatinHypercube(10), &[], &[], &ranges, &base()).expect("points");
        let mut parts: Vec<usize> =
            all.iter().map(|p| (p.values[0].as_f64().expect("a number") * 10.0) as usize).collect();
        parts.sort_unstable();
        assert_eq!(parts, (0..10).collect::<Vec<_>>(), "law: one a tenth");
        assert!(all.iter().all(|p| p.values[1].is_u64()), "law: seeds are whole numbers");
        let again = points(Design::LatinHypercube(10), &[], &[], &ranges, &base()).expect("points");
        assert_eq!(all, again, "law: the same sample every time");
    }

    /// Law: numbers are drawn from each part of a range also where it is narrower than a millionth.
    #[test]
    fn a_narrow_range_is_drawn_from_as_a_wide_one() {
        for text in ["contact.restitution=1e-7..9e-7", "contact.restitution=0.3..0.3000001"] {
            let range: SampledRange = text.parse().expect("a range");
            let (low, tenth) = (range.low, (range.high - range.low) / 10.0);
            let all = points(Design::LatinHypercube(10), &[], &[], &[range], &base());
            let all = all.expect("points");
            let mut drawn: Vec<f64> = all.iter().filter_map(|p| p.values[0].as_f64()).collect();
            drawn.sort_by(f64::total_cmp);
            assert_eq!(drawn.len(), 10);
            for (part, value) in drawn.iter().enumerate() {
                let (from, at) = (part as f64, (value - low) / tenth);
                let inside = (from - 0.01..=from + 1.01).contains(&at);
                assert!(inside, "law: one a tenth of {text}, got part {at} in the place of {from}");
            }
        }
    }

    /// Law: points that are the same run are refused, and say what was drawn twice.
    #[test]
    fn a_point_is_not_drawn_twice() {
        let ranges: Vec<SampledRange> = vec!["seed=1..3".parse().expect("a range")];
        let refused = points(Design::LatinHypercube(5), &[], &[], &ranges, &base());
        let refused = refused.expect_err("law: five points of three numbers").to_string();
        assert!(refused.contains("latin-hypercube:5: seed="), "law: which, got `{refused}`");
        assert!(refused.contains("is drawn twice"), "law: what is wrong, got `{refused}`");
    }

    /// Law: an old name is refused with the new one, and no value is asked for under it.
    #[test]
    fn a_field_that_is_renamed_is_called_as_it_is_now() {
        for (old, now) in
            [("control_s", "rest_test_s"), ("engine.native.sweeps", "engine.native.iterations")]
        {
            let factors = over(&[&format!("{old}=1,2")]);
            let alone = points(Design::OneAtATime, &factors, &[], &[], &base());
            let ranges: Vec<SampledRange> = vec![format!("{old}=1..2").parse().expect("a range")];
            let sampled = points(Design::LatinHypercube(4), &[], &[], &ranges, &base());
            for made in [alone, sampled] {
                let said = made.expect_err("law: refused").to_string();
                let expected = format!("{old}: this field is now called `{now}`");
                assert!(said.contains(&expected), "law: expected `{expected}`, got `{said}`");
            }
        }
    }

    #[test]
    fn what_cannot_be_is_told() {
        let too_many: Vec<String> = (0..101).map(|n| n.to_string()).collect();
        let many = format!("seed={}", too_many.join(","));
        let factors = over(&[&many, &many.replace("seed", "configuration")]);
        let refused = points(Design::Grid, &factors, &[], &[], &base()).expect_err("too many");
        assert!(refused.to_string().contains("10000"), "{refused}");
        let nowhere = over(&["grains.total_mass_g=1"]);
        let refused =
            points(Design::OneAtATime, &nowhere, &[], &[], &base()).expect_err("no value");
        assert!(refused.to_string().contains("grains.total_mass_g"), "{refused}");
    }
}
