//! Slopes of factors whose values were drawn, by a linear model of all factors, and which of these
//! the runs cannot tell apart.

use super::*;
use crate::measure::statistics::mean;

/// Smallest singular value, over the largest, of a direction in which runs differ. Ours: far above
/// rounding, and far below what is drawn by chance.
const LEAST: f64 = 1e-9;

/// Share of a direction, squared, that is no rounding.
const ROUNDING: f64 = 1e-6;

/// What the runs say of one factor.
pub(super) struct Drawn {
    /// Its slope in each configuration that has one.
    pub slopes: Vec<f64>,
    /// The factors that change together with it, where no configuration tells them apart.
    pub together_with: Vec<String>,
}

/// The coefficient of the n-th factor in a linear model of all factors, fitted to each configuration
/// by itself.
pub(super) fn drawn(
    factors: &[SweepFactor],
    n: usize,
    outcome: &str,
    configurations: &[u32],
    runs: &[&SweepRun],
) -> Drawn {
    let (mut slopes, mut together) = (Vec::new(), BTreeSet::new());
    for configuration in configurations {
        let of = runs.iter().copied().filter(|run| run.configuration == *configuration);
        match fitted(factors, n, outcome, &of.collect::<Vec<_>>()) {
            Some(Ok(slope)) => slopes.push(slope),
            Some(Err(others)) => together.extend(others),
            None => {}
        }
    }
    if !slopes.is_empty() {
        together.clear();
    }
    let together_with = together.into_iter().map(|other| factors[other].path.clone()).collect();
    Drawn { slopes, together_with }
}

/// The slope along the n-th factor in the runs of one configuration, or the factors that change
/// together with it there; none where the runs are too few, or it does not vary.
fn fitted(
    factors: &[SweepFactor],
    n: usize,
    outcome: &str,
    runs: &[&SweepRun],
) -> Option<Result<f64, Vec<usize>>> {
    if runs.len() < factors.len() + 2 {
        return None;
    }
    let number = |run: &SweepRun, factor: usize| factors[factor].number(&run.values[factor]);
    let of_all = |factor: usize| runs.iter().map(|run| number(run, factor)).collect::<Vec<f64>>();
    // One that has the same value everywhere is part of the constant.
    let varies = |factor: &usize| {
        let numbers = of_all(*factor);
        numbers.iter().any(|number| *number != numbers[0])
    };
    let varying: Vec<usize> = (0..factors.len()).filter(varies).collect();
    let own = varying.iter().position(|factor| *factor == n)? + 1;
    let centre: Vec<f64> =
        varying.iter().map(|factor| mean(&of_all(*factor))).collect::<Option<_>>()?;
    let model = DMatrix::from_fn(runs.len(), varying.len() + 1, |row, column| match column {
        0 => 1.0,
        c => number(runs[row], varying[c - 1]) - centre[c - 1],
    });
    let results = DVector::from_iterator(runs.len(), runs.iter().map(|r| r.outcomes[outcome]));
    // Columns of very different size are brought to one before they are compared with rounding.
    let sizes: Vec<f64> = model.column_iter().map(|c| c.norm()).collect();
    let scaled = DMatrix::from_fn(model.nrows(), model.ncols(), |r, c| model[(r, c)] / sizes[c]);
    let svd = scaled.svd(true, true);
    let others = together(svd.v_t.as_ref()?, &svd.singular_values, own);
    if !others.is_empty() {
        return Some(Err(others.into_iter().map(|column| varying[column - 1]).collect()));
    }
    let solved = svd.solve(&results, 1e-12).ok()?;
    Some(Ok(solved[own] / sizes[own]))
}

/// The columns of a model that cannot be told apart from one of them: of its unit vector, what lies
/// in directions in which no row differs from another has parts along them.
fn together(directions: &DMatrix<f64>, sizes: &DVector<f64>, own: usize) -> Vec<usize> {
    let least = LEAST * sizes.max();
    let told: Vec<usize> = (0..sizes.len()).filter(|n| sizes[*n] > least).collect();
    let untold = |column: usize| {
        let of = |n: &usize| directions[(*n, own)] * directions[(*n, column)];
        let unit = if column == own { 1.0 } else { 0.0 };
        unit - told.iter().map(of).sum::<f64>()
    };
    if untold(own) < ROUNDING {
        return Vec::new();
    }
    (1..directions.ncols()).filter(|c| *c != own && untold(*c).abs() > ROUNDING).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    const RESULT: &str = "void_ratio";

    /// Runs in two configurations of factors a, b and so on, with 2 a + 3 b + 5 c + 7 d as result.
    fn found(rows: &[[f64; 4]], n: usize) -> Drawn {
        let factor = |path: &str| SweepFactor {
            path: path.to_owned(),
            values: vec![json!(0.0), json!(9.0)],
            sampled: true,
            numeric: true,
        };
        let run = |row: &[f64; 4], configuration: u32| {
            let result = 2.0 * row[0] + 3.0 * row[1] + 5.0 * row[2] + 7.0 * row[3];
            SweepRun {
                run: String::new(),
                point: String::new(),
                configuration,
                values: row.iter().map(|value| Value::from(*value)).collect(),
                outcomes: BTreeMap::from([(RESULT.to_owned(), result)]),
                ..SweepRun::counted()
            }
        };
        let each = [1, 2].into_iter().flat_map(|c| rows.iter().map(move |row| run(row, c)));
        let runs: Vec<SweepRun> = each.collect();
        let runs: Vec<&SweepRun> = runs.iter().collect();
        drawn(&["a", "b", "c", "d"].map(factor), n, RESULT, &[1, 2], &runs)
    }

    /// Law: of factors that change together in all runs none has a slope, and each names the others;
    /// the slope of what changes by itself is its own, and what is the same everywhere hides none.
    #[test]
    fn what_changes_together_has_no_slope_of_its_own() {
        let apart = [4.0, 0.0, 3.0, 1.0, 5.0, 2.0];
        // b is 8 − 2 a, d is 6.
        let rows: Vec<[f64; 4]> = (0..6_u32)
            .map(|n| (f64::from(n), apart[n as usize]))
            .map(|(a, c)| [a, 8.0 - 2.0 * a, c, 6.0])
            .collect();
        for (n, expected) in [(0, "b"), (1, "a")] {
            let Drawn { slopes, together_with } = found(&rows, n);
            assert!(slopes.is_empty(), "law: no slope of factor {n}, got {slopes:?}");
            assert_eq!(together_with, [expected], "law: what factor {n} changes together with");
        }
        let Drawn { slopes, together_with } = found(&rows, 2);
        assert!(together_with.is_empty(), "law: c changes by itself, got {together_with:?}");
        let sound = slopes.len() == 2 && slopes.iter().all(|slope| (slope - 5.0).abs() < 1e-9);
        assert!(sound, "law: slope of c, expected 5 twice, got {slopes:?}, tolerance 1e-9");
        let same = found(&rows, 3);
        assert!(same.slopes.is_empty() && same.together_with.is_empty(), "law: d does not vary");
        let mut apart = rows;
        apart[3][1] += 1.0;
        let Drawn { slopes, together_with } = found(&apart, 1);
        let sound = slopes.len() == 2 && slopes.iter().all(|slope| (slope - 3.0).abs() < 1e-6);
        assert!(sound, "law: one run tells b apart, expected 3 twice, got {slopes:?} within 1e-6");
        assert!(together_with.is_empty(), "law: and it does, got {together_with:?}");
    }
}
