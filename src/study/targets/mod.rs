//! Which values of the factors of finished sweeps meet several targets together.
//!
//! A target is a result, or the share of one in another, and the range in which it is wanted. To
//! the runs of each target a linear model of all factors is fitted ([`LinearModel`]); the
//! probability that a run at some point meets a target is that of the model with its scatter. Runs
//! of different sweeps belong together where their factors agree ([`points`]): such points are
//! counted, and say how residuals of different targets go together ([`together`]).
//!
//! Runs of one pour, or of one stored specimen, are of one specimen ([`specimens`]): the model keeps
//! their scatter apart from that between specimens, and intervals of shares count them once.

mod points;
mod specimens;
mod spelling;
mod together;

use super::*;
use crate::measure::{
    inference::wilson_interval,
    regression::{Effect, LinearModel, vary_within},
};
use crate::plain::counted;
use crate::record::{read_file, refuse_without};
use crate::report::{ColumnTable, OUTCOMES, Target, TargetFound, TargetsFound};
use crate::scenario::renamed_result;
use points::agree;
use spelling::Spellings;

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
        // Columns number lists as `a.0.b`; a path may say `a[0].b` elsewhere.
        let column = |path: &str| path.replace('[', ".").replace(']', "");
        let (result, share_of) = (column(result), share_of.as_deref().map(column));
        Ok(Self { runs: runs.to_owned(), result, share_of, low, high })
    }
}

/// The runs of a name: factors, and rows of factors with results by column.
struct Runs {
    factors: Vec<String>,
    /// Columns of factors, those that stand for chance or do not vary among them.
    columns: Vec<String>,
    /// What stands in these columns, also of runs that do not count.
    planned: Vec<BTreeMap<String, String>>,
    rows: Vec<Row>,
}

impl Runs {
    /// These runs, and those of another sweep: of both a run counts once.
    fn and(mut self, other: Self) -> Self {
        let Self { columns, mut planned, rows, .. } = other;
        let (again, new): (Vec<Row>, Vec<Row>) =
            rows.into_iter().partition(|row| self.rows.iter().any(|known| known.is_again(row)));
        for row in again {
            if let Some(n) = planned.iter().position(|run| *run == row.columns) {
                planned.remove(n);
            }
        }
        self.columns = each_once(self.columns.into_iter().chain(columns));
        self.planned.extend(planned);
        self.rows.extend(new);
        self
    }

    /// With what varies among all of them as factors, where it is not chance.
    fn with_factors(mut self, name: &str, chance: &[String]) -> Result<Self, StudyError> {
        let is_chance =
            |column: &&String| chance.contains(column) || Scenario::names_realisations(column);
        for column in self.columns.iter().filter(|column| !is_chance(column)) {
            let cells: BTreeSet<&String> =
                self.planned.iter().filter_map(|run| run.get(column)).collect();
            let numbers: Option<Vec<f64>> = cells.iter().map(|cell| finite(cell)).collect();
            match numbers {
                None if cells.len() > 1 => {
                    return refused(format!(
                        "--runs {name}: `{column}` has values that are no numbers, which no \
                         linear model takes: make a sweep of each value, or count it as chance \
                         with --chance {column}"
                    ));
                }
                Some(numbers) if numbers.iter().any(|number| *number != numbers[0]) => {
                    self.factors.push(column.clone());
                }
                _ => {}
            }
        }
        for row in &mut self.rows {
            let value = |factor: &String| {
                row.columns.get(factor).and_then(|cell| finite(cell)).ok_or_else(|| factor.clone())
            };
            let values: Result<Vec<f64>, String> = self.factors.iter().map(value).collect();
            row.factors = values.map_err(|factor| {
                StudyError::Scenario(format!(
                    "--runs {name}: `{factor}` varies, but is no column of all of its sweeps"
                ))
            })?;
        }
        Ok(self)
    }
}

/// The finite number that a cell is.
fn finite(cell: &str) -> Option<f64> {
    cell.parse().ok().filter(|number: &f64| number.is_finite())
}

/// A run that counts.
struct Row {
    configuration: String,
    /// Value of every column of the table that is a factor.
    columns: BTreeMap<String, String>,
    /// Values of the factors, in their order.
    factors: Vec<f64>,
    results: BTreeMap<String, f64>,
    /// Number of its specimen among those of the runs of its name.
    specimen: usize,
}

impl Row {
    /// Whether another row is of the same run, which the program repeats to the last bit.
    fn is_again(&self, other: &Self) -> bool {
        self.results == other.results && agree(self, other)
    }
}

/// A target and the model of its runs.
struct Modelled<'a> {
    target: &'a Target,
    /// The table that has them.
    table: &'a Runs,
    model: LinearModel,
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
    let mut spellings = Spellings::default();
    let chance: Vec<String> = chance.iter().map(|name| spellings.known(name)).collect();
    let same = |a: &TargetRuns, b: &TargetRuns| {
        let whole = |path: &Path| path.canonicalize().unwrap_or_else(|_| path.to_owned());
        a.name == b.name && whole(&a.path) == whole(&b.path)
    };
    for (n, of) in runs.iter().enumerate() {
        if runs[..n].iter().any(|earlier| same(earlier, of)) {
            return refused(format!("--runs {}={}: it is given twice", of.name, of.path.display()));
        }
        let wanted = targets.iter().filter(|target| target.runs == of.name);
        let read = read(&of.path, &wanted.collect::<Vec<_>>(), &mut spellings)?;
        let together = match tables.remove(&of.name) {
            None => read,
            Some(known) => known.and(read),
        };
        tables.insert(of.name.clone(), together);
    }
    let with_factors = |(name, table): (String, Runs)| -> Result<(String, Runs), StudyError> {
        let mut table = table.with_factors(&name, &chance)?;
        specimens::number(&mut table.rows);
        Ok((name, table))
    };
    let tables: BTreeMap<String, Runs> =
        tables.into_iter().map(with_factors).collect::<Result<_, StudyError>>()?;
    // Every sweep has configurations, and they are always chance.
    let is_column = |name: &&String| {
        *name == "configuration" || tables.values().any(|table| table.columns.contains(name))
    };
    if let Some(name) = chance.iter().find(|name| !is_column(name)) {
        let there = listed(tables.values().flat_map(|table| &table.columns));
        return refused(format!("--chance {name}: no sweep has this factor (there are {there})"));
    }
    let varied: BTreeSet<&String> = tables.values().flat_map(|table| &table.factors).collect();
    for (count, what) in [(varied.len(), "factor"), (targets.len(), "target")] {
        if count > together::MOST {
            return refused(format!(
                "{}: at most {} can be searched together",
                counted(count, what),
                together::MOST
            ));
        }
    }
    for (n, target) in targets.iter().enumerate() {
        let title = target.title();
        if targets[..n].iter().any(|earlier| earlier.title() == title) {
            return refused(format!("--target {title}: it is given twice; give it one range"));
        }
    }
    let mut models = Vec::new();
    let mut found: Vec<TargetFound> = Vec::new();
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
        models.push(Modelled { target, table, model });
        found.push(of_target);
    }
    Ok(together::search(&models, found))
}

/// The runs of a sweep, their factors not yet known; `targets` are those that ask for them.
fn read(path: &Path, targets: &[&Target], spellings: &mut Spellings) -> Result<Runs, StudyError> {
    const TABLE: &str = "sweep.csv";
    let file = if path.is_dir() {
        refuse_without(path, TABLE, "it is no folder of a sweep with results: no sweep.csv")?;
        path.join(TABLE)
    } else {
        path.to_owned()
    };
    let table = ColumnTable::read(&file, &read_file(&file)?)?;
    let unfit = |what: &str| StudyError::Scenario(format!("{}: {what}", file.display()));
    let no_sweep = || {
        unfit(
            "no table of a sweep: its columns are `run`, `point`, `configuration`, then the \
             factors, then the results",
        )
    };
    let names = table.names();
    let place = |name: &str| names.iter().position(|n| n == name);
    let first = place("configuration").ok_or_else(no_sweep)? + 1;
    let is_result = |name: &String| OUTCOMES.iter().any(|(path, _)| path == name);
    let end = names[first..].iter().position(is_result).map(|n| n + first);
    // Where nothing but the configuration is varied, its column is the only factor.
    let has_points = place("point").is_some();
    let end = end.filter(|end| *end > first || has_points).ok_or_else(no_sweep)?;
    let mut names = names.to_vec();
    for n in first..end {
        let known = spellings.known(&names[n]);
        if names[first..n].contains(&known) {
            return Err(unfit(&format!("it has `{known}` twice, as `{}`, too", names[n])));
        }
        names[n] = known;
    }
    let excluded: Vec<Vec<Option<&str>>> = ["left_out_of_means", "failure"]
        .iter()
        .filter_map(|name| place(name))
        .map(|column| table.cells(column))
        .collect();
    let counts =
        |row: &usize| !excluded.iter().any(|why| why[*row].is_some_and(|why| !why.is_empty()));
    let columns: Vec<Vec<Option<f64>>> = (0..names.len()).map(|n| table.numbers(n)).collect();
    let cells: Vec<Vec<Option<&str>>> = (0..names.len()).map(|n| table.cells(n)).collect();
    let is_wanted = |name: &String| {
        targets.iter().any(|of| of.result == *name || of.share_of.as_ref() == Some(name))
    };
    for n in (end..names.len()).filter(|n| is_wanted(&names[*n])) {
        let text = |row: &usize| {
            let cell = cells[n][*row].filter(|cell| !cell.is_empty())?;
            columns[n][*row].is_none().then_some((*row + 1, cell))
        };
        let texts: Vec<(usize, &str)> =
            (0..table.len()).filter(counts).filter_map(|row| text(&row)).collect();
        if let Some((row, cell)) = texts.first() {
            return Err(unfit(&format!(
                "`{}` is no number in {} of the runs that count (found `{cell}` in run {row} of \
                 the table; allowed: a number with a decimal point, or an empty cell)",
                names[n],
                texts.len()
            )));
        }
    }
    let cell = |n: usize, row: usize| cells[n][row].unwrap_or_default().to_owned();
    let planned = |row: usize| -> BTreeMap<String, String> {
        (first..end).map(|n| (names[n].clone(), cell(n, row))).collect()
    };
    let rows = (0..table.len()).filter(counts).map(|row| {
        let results = (end..names.len()).filter_map(|n| Some((names[n].clone(), columns[n][row]?)));
        Row {
            configuration: cell(first - 1, row),
            columns: planned(row),
            factors: Vec::new(),
            results: results.collect(),
            specimen: 0,
        }
    });
    Ok(Runs {
        factors: Vec::new(),
        columns: names[first..end].to_vec(),
        planned: (0..table.len()).map(planned).collect(),
        rows: rows.collect(),
    })
}

/// The value of a target in a row.
fn value(target: &Target, row: &Row) -> Option<f64> {
    let result = *row.results.get(&target.result)?;
    let Some(of) = &target.share_of else { return Some(result) };
    Some(100.0 * result / row.results.get(of)?).filter(|share| share.is_finite())
}

fn model(target: &Target, table: &Runs) -> Result<(LinearModel, TargetFound), StudyError> {
    let rows: Vec<(Vec<f64>, f64)> =
        table.rows.iter().filter_map(|r| Some((r.factors.clone(), value(target, r)?))).collect();
    let title = target.title();
    for result in [Some(&target.result), target.share_of.as_ref()].into_iter().flatten() {
        let is_there = |name: &String| table.rows.iter().any(|r| r.results.contains_key(name));
        if !is_there(result) {
            if let Some(now) = renamed_result(result).filter(is_there) {
                let what = format!("`{result}` is now called `{now}`");
                return refused(format!("--target {title}: {what}"));
            }
            let there = listed(table.rows.iter().flat_map(|row| row.results.keys()));
            let there = match there.is_empty() {
                true => "no run has a result".to_owned(),
                false => format!("there are {there}"),
            };
            return refused(format!(
                "--target {title}: no run that counts has `{result}` ({there})"
            ));
        }
    }
    let own: Vec<usize> =
        table.rows.iter().filter(|r| value(target, r).is_some()).map(|r| r.specimen).collect();
    let specimens = own.iter().collect::<BTreeSet<_>>().len();
    let fitted = LinearModel::fit(&rows, &own).ok_or_else(|| {
        let why = too_few(&rows, &own, specimens, &table.factors);
        StudyError::Scenario(format!("--target {title}: {why}"))
    })?;
    let values = || rows.iter().map(|r| r.1);
    let meeting = values().filter(|v| target.met(*v)).count();
    let effects = || table.factors.iter().cloned().zip(fitted.effects());
    let within = effects().filter(|(_, effect)| effect.is_within_specimens);
    let found = TargetFound {
        target: target.clone(),
        runs_counted: rows.len(),
        runs_left_out: table.planned.len() - rows.len(),
        runs_without_result: table.rows.len() - rows.len(),
        runs_meeting: meeting,
        specimens,
        share_meeting: wilson_interval(meeting as f64 / rows.len() as f64, specimens),
        values: [values().fold(f64::MAX, f64::min), values().fold(f64::MIN, f64::max)],
        fit: fitted.quality(),
        effects: effects().map(|(name, of)| (name, (of.change, of.half_width_95))).collect(),
        ranges: effects().map(|(name, Effect { range, .. })| (name, range)).collect(),
        freedom: effects().map(|(name, Effect { freedom, .. })| (name, freedom)).collect(),
        within_specimens: within.map(|(name, _)| name).collect(),
        best: 0.0,
    };
    Ok((fitted, found))
}

/// Why runs have no linear model.
fn too_few(
    rows: &[(Vec<f64>, f64)],
    own: &[usize],
    specimens: usize,
    factors: &[String],
) -> String {
    let count = factors.len();
    let spread = if count == 1 { "at several values of it" } else { "not all along one line" };
    let runs = format!(
        "{} that {} and {} it",
        counted(rows.len(), "run"),
        in_number(rows.len(), "counts", "count"),
        in_number(rows.len(), "has", "have")
    );
    if specimens < 2 || specimens == rows.len() {
        return format!(
            "{runs}, too few for a linear model of {}, {} (at least {} are needed, {spread})",
            counted(count, "factor"),
            factors.join(", "),
            count + 3
        );
    }
    let is_within = vary_within(rows, own);
    let of = |wanted: bool| -> Vec<&str> {
        let are = factors.iter().zip(&is_within).filter(|(_, is)| **is == wanted);
        are.map(|(name, _)| name.as_str()).collect()
    };
    let (between, within) = (of(false), of(true));
    let all = |factors: &[&str]| match factors.len() {
        0 => "no factor".to_owned(),
        count => format!("{}, {}", counted(count, "factor"), factors.join(", ")),
    };
    format!(
        "{runs}, of {specimens} specimens, too few for a linear model: between specimens of {} (at \
         least {} specimens are needed, {spread}), within them of {} (at least {} runs are needed, \
         {spread})",
        all(&between),
        between.len() + 2,
        all(&within),
        specimens + within.len() + 1
    )
}

#[cfg(test)]
mod shared_tests;
#[cfg(test)]
mod tests;
