//! Which values of the factors of finished sweeps meet several targets together.
//!
//! A target is a result, or the share of one in another, and the range in which it is wanted. To
//! the runs of each target a linear model of all factors is fitted ([`LinearModel`]); the
//! probability that a run at some point meets a target is that of the model with its scatter. That
//! of several targets is the product: their residuals are taken to be independent. The points
//! searched fill the ranges of all factors evenly (Halton 1960).

use std::{
    collections::{BTreeMap, BTreeSet},
    path::{Path, PathBuf},
    str::FromStr,
};

use super::{StudyError, design::range};
use crate::measure::{inference::wilson_interval, regression::LinearModel};
use crate::record::read_file;
use crate::report::{ColumnTable, OUTCOMES, Target, TargetFound, TargetsFound, Together};

/// Points that are searched.
const POINTS: usize = 20_000;

/// Runs of one experiment: finished sweeps over the same factors.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct TargetRuns {
    /// What targets call it.
    pub name: String,
    /// Folder of a sweep, or its table.
    pub path: PathBuf,
}

impl FromStr for TargetRuns {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        match text.split_once('=') {
            Some((name, path)) if is_name(name) && !path.is_empty() => {
                Ok(Self { name: name.to_owned(), path: PathBuf::from(path) })
            }
            _ => Err(format!(
                "`{text}` is not NAME=PATH, with a name of letters, digits and _ and the folder \
                 of a sweep or its sweep.csv"
            )),
        }
    }
}

/// Names, each once and in order.
fn listed<'a>(names: impl Iterator<Item = &'a String>) -> String {
    let names: BTreeSet<&str> = names.map(String::as_str).collect();
    names.into_iter().collect::<Vec<_>>().join(", ")
}

fn is_name(text: &str) -> bool {
    !text.is_empty() && text.chars().all(|c| c.is_ascii_alphanumeric() || c == '_')
}

impl FromStr for Target {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let wrong = || {
            format!(
                "`{text}` is not NAME:RESULT=LOW..HIGH or NAME:RESULT/RESULT=LOW..HIGH, with LOW \
                 below HIGH"
            )
        };
        let (what, ends) = text.split_once('=').ok_or_else(wrong)?;
        let (runs, result) = what.split_once(':').ok_or_else(wrong)?;
        let (low, high) = range(ends).ok_or_else(wrong)?;
        let (result, share_of) = match result.split_once('/') {
            Some((result, of)) => (result, Some(of.to_owned())),
            None => (result, None),
        };
        let named = is_name(runs) && !result.is_empty() && share_of.as_deref() != Some("");
        if !named || low >= high {
            return Err(wrong());
        }
        Ok(Self { runs: runs.to_owned(), result: result.to_owned(), share_of, low, high })
    }
}

/// The runs of a name: factors, and rows of factors with results by column.
struct Runs {
    factors: Vec<String>,
    /// Columns of factors, those that stand for chance or do not vary among them.
    columns: Vec<String>,
    rows: Vec<(Vec<f64>, BTreeMap<String, f64>)>,
}

/// Seeks what meets all targets; `chance` names factors that are none, but stand for chance.
///
/// # Errors
/// [`StudyError`] where a file cannot be read, is no table of a sweep, lacks a result, or has too
/// few runs for a model of its factors.
pub fn meet_targets(
    runs: &[TargetRuns],
    targets: &[Target],
    chance: &[String],
) -> Result<TargetsFound, StudyError> {
    let mut tables: BTreeMap<String, Runs> = BTreeMap::new();
    for of in runs {
        let read = read(&of.path, chance)?;
        match tables.get_mut(&of.name) {
            None => drop(tables.insert(of.name.clone(), read)),
            Some(known) if known.factors == read.factors => known.rows.extend(read.rows),
            Some(known) => {
                return Err(StudyError::Scenario(format!(
                    "{}: its factors are {}, those of other runs named `{}` {}",
                    of.path.display(),
                    read.factors.join(", "),
                    of.name,
                    known.factors.join(", ")
                )));
            }
        }
    }
    let is_column = |name: &&String| tables.values().any(|table| table.columns.contains(name));
    if let Some(name) = chance.iter().find(|name| !is_column(name)) {
        let there = listed(tables.values().flat_map(|table| &table.columns));
        return Err(StudyError::Scenario(format!(
            "--chance {name}: no sweep has this factor (there are {there})"
        )));
    }
    let mut models = Vec::new();
    let mut found = Vec::new();
    for target in targets {
        let table = tables.get(&target.runs).ok_or_else(|| {
            StudyError::Scenario(format!(
                "--target {}: no runs have the name `{}` (--runs gives {})",
                target.title(),
                target.runs,
                listed(tables.keys())
            ))
        })?;
        let (model, of_target) = model(target, table)?;
        models.push((model, table.factors.clone()));
        found.push(of_target);
    }
    Ok(search(&tables, models, found))
}

/// The rows of a sweep that count in means.
fn read(path: &Path, chance: &[String]) -> Result<Runs, StudyError> {
    let file = if path.is_dir() { path.join("sweep.csv") } else { path.to_owned() };
    let table = ColumnTable::read(&file, &read_file(&file)?)?;
    let unfit = |what: &str| StudyError::Scenario(format!("{}: {what}", file.display()));
    let names = table.names();
    let place = |name: &str| names.iter().position(|n| n == name);
    let first = place("configuration").ok_or_else(|| unfit("no table of a sweep"))? + 1;
    let is_result = |name: &String| OUTCOMES.iter().any(|(path, _)| path == name);
    let end = names[first..].iter().position(is_result).map(|n| n + first);
    let end = end.filter(|end| *end > first).ok_or_else(|| unfit("no table of a sweep"))?;
    let excluded: Vec<Vec<Option<&str>>> = ["left_out_of_means", "failure"]
        .iter()
        .filter_map(|name| place(name))
        .map(|column| table.cells(column))
        .collect();
    let columns: Vec<Vec<Option<f64>>> = (0..names.len()).map(|n| table.numbers(n)).collect();
    let varies = |n: &usize| {
        let mut values = columns[*n].iter().flatten();
        values.next().is_some_and(|first| values.any(|other| other != first))
    };
    let counts = |n: &usize| !chance.contains(&names[*n]) && varies(n);
    let factors: Vec<usize> = (first..end).filter(counts).collect();
    let mut rows = Vec::new();
    for row in 0..table.len() {
        if excluded.iter().any(|why| why[row].is_some_and(|why| !why.is_empty())) {
            continue;
        }
        let values: Option<Vec<f64>> = factors.iter().map(|n| columns[*n][row]).collect();
        let values = values.ok_or_else(|| unfit("a factor is no number in every run"))?;
        let results = (end..names.len()).filter_map(|n| Some((names[n].clone(), columns[n][row]?)));
        rows.push((values, results.collect()));
    }
    let columns = names[first..end].to_vec();
    Ok(Runs { factors: factors.into_iter().map(|n| names[n].clone()).collect(), columns, rows })
}

/// The value of a target in a row.
fn value(target: &Target, results: &BTreeMap<String, f64>) -> Option<f64> {
    let result = *results.get(&target.result)?;
    let Some(of) = &target.share_of else { return Some(result) };
    Some(100.0 * result / results.get(of)?).filter(|share| share.is_finite())
}

fn model(target: &Target, table: &Runs) -> Result<(LinearModel, TargetFound), StudyError> {
    let rows: Vec<(Vec<f64>, f64)> =
        table.rows.iter().filter_map(|(x, r)| Some((x.clone(), value(target, r)?))).collect();
    let title = target.title();
    for result in [Some(&target.result), target.share_of.as_ref()].into_iter().flatten() {
        if !table.rows.iter().any(|(_, results)| results.contains_key(result)) {
            let there = listed(table.rows.iter().flat_map(|(_, results)| results.keys()));
            return Err(StudyError::Scenario(format!(
                "--target {title}: no run that counts has `{result}` (there are {there})"
            )));
        }
    }
    let fitted = LinearModel::fit(&rows).ok_or_else(|| {
        StudyError::Scenario(format!(
            "--target {title}: {} runs that count have it, too few to tell the {} factors {} \
             apart (at least {} are needed, not all along one line)",
            rows.len(),
            table.factors.len(),
            table.factors.join(", "),
            table.factors.len() + 3
        ))
    })?;
    let values = || rows.iter().map(|r| r.1);
    let meeting = values().filter(|v| target.met(*v)).count();
    let found = TargetFound {
        target: target.clone(),
        runs_counted: rows.len(),
        runs_meeting: meeting,
        share_meeting: wilson_interval(meeting, rows.len()),
        values: [values().fold(f64::MAX, f64::min), values().fold(f64::MIN, f64::max)],
        fit: fitted.quality(),
        effects: table.factors.iter().cloned().zip(fitted.effects()).collect(),
        best: 0.0,
    };
    Ok((fitted, found))
}

fn search(
    tables: &BTreeMap<String, Runs>,
    models: Vec<(LinearModel, Vec<String>)>,
    mut targets: Vec<TargetFound>,
) -> TargetsFound {
    let mut factors: BTreeMap<String, [f64; 2]> = BTreeMap::new();
    for table in tables.values() {
        for (n, name) in table.factors.iter().enumerate() {
            let range = factors.entry(name.clone()).or_insert([f64::MAX, f64::MIN]);
            for (x, _) in &table.rows {
                *range = [range[0].min(x[n]), range[1].max(x[n])];
            }
        }
    }
    let names: Vec<&String> = factors.keys().collect();
    let ranges: Vec<[f64; 2]> = factors.values().copied().collect();
    let places: Vec<Vec<usize>> = models
        .iter()
        .map(|(_, own)| own.iter().filter_map(|f| names.iter().position(|n| *n == f)).collect())
        .collect();
    let point = |number: usize| -> Vec<f64> {
        let of = |(n, range): (usize, &[f64; 2])| {
            range[0] + (range[1] - range[0]) * halton(number + 1, PRIMES[n % PRIMES.len()])
        };
        ranges.iter().enumerate().map(of).collect()
    };
    let mut chances: Vec<Vec<f64>> = Vec::with_capacity(POINTS);
    for number in 0..POINTS {
        let at = point(number);
        let of = |n: usize| {
            let own: Vec<f64> = places[n].iter().map(|place| at[*place]).collect();
            models[n].0.probability(&own, targets[n].target.low, targets[n].target.high)
        };
        chances.push((0..models.len()).map(of).collect());
    }
    for (n, found) in targets.iter_mut().enumerate() {
        found.best = chances.iter().map(|c| c[n]).fold(0.0, f64::max);
    }
    let together = |which: Vec<usize>| {
        let chance = |n: usize| which.iter().map(|t| chances[n][*t]).product::<f64>();
        let best = (0..POINTS)
            .map(|n| (n, chance(n)))
            .fold((0, -1.0), |best, this| if this.1 > best.1 { this } else { best });
        let at = names.iter().map(|n| (*n).clone()).zip(point(best.0)).collect();
        let mean = (0..POINTS).map(chance).sum::<f64>() / POINTS as f64;
        let wanted: Vec<&Target> = which.iter().map(|t| &targets[*t].target).collect();
        Together { runs: counted(tables, &wanted), targets: which, mean, best: best.1, at }
    };
    let count = targets.len();
    let mut pairs: Vec<Together> =
        (0..count).flat_map(|a| (a + 1..count).map(move |b| vec![a, b])).map(together).collect();
    pairs.sort_by(|a, b| a.best.total_cmp(&b.best));
    let all = together((0..count).collect());
    TargetsFound { factors, targets, pairs, all, points: POINTS }
}

/// Runs that meet all targets, of those that have all results, where they are of one table.
fn counted(tables: &BTreeMap<String, Runs>, targets: &[&Target]) -> Option<(usize, usize)> {
    let name = &targets.first()?.runs;
    if targets.iter().any(|t| t.runs != *name) {
        return None;
    }
    let values = |results: &BTreeMap<String, f64>| -> Option<Vec<f64>> {
        targets.iter().map(|t| value(t, results)).collect()
    };
    let whole: Vec<Vec<f64>> =
        tables.get(name)?.rows.iter().filter_map(|(_, r)| values(r)).collect();
    let met = |v: &&Vec<f64>| v.iter().zip(targets).all(|(v, t)| t.met(*v));
    Some((whole.iter().filter(met).count(), whole.len()))
}

const PRIMES: [usize; 12] = [2, 3, 5, 7, 11, 13, 17, 19, 23, 29, 31, 37];

/// Element of the van der Corput sequence of a base, from 0 to 1 (Halton 1960).
fn halton(mut number: usize, base: usize) -> f64 {
    let (mut share, mut value) = (1.0, 0.0);
    while number > 0 {
        share /= base as f64;
        value += share * (number % base) as f64;
        number /= base;
    }
    value
}

#[cfg(test)]
#[path = "targets_tests.rs"]
mod tests;
