//! Which values of the factors of sweeps meet several targets together: what was found, and its
//! files.

use std::collections::BTreeSet;

use super::*;
use crate::measure::{inference::wilson_interval, regression::LinearFit};

/// A result and the range in which it is wanted.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Target {
    /// Which runs have it.
    pub runs: String,
    /// Column of their table.
    pub result: String,
    /// Column by which it is divided, in percent of that; none of the result itself.
    pub share_of: Option<String>,
    /// Lower end of the range, in the result's unit, or in percent.
    pub low: f64,
    /// Upper end.
    pub high: f64,
}

impl Target {
    /// As it was typed, without the range.
    pub fn title(&self) -> String {
        let of = self.share_of.as_ref().map(|of| format!("/{of}")).unwrap_or_default();
        format!("{}:{}{of}", self.runs, self.result)
    }

    /// The range with its unit, where that is percent.
    pub fn range(&self) -> String {
        let unit = if self.share_of.is_some() { " %" } else { "" };
        format!("{} to {}{unit}", self.low, self.high)
    }

    /// Whether a value, in percent of a share, lies in the range.
    pub fn met(&self, value: f64) -> bool {
        (self.low..=self.high).contains(&value)
    }
}

/// What was found of one target.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct TargetFound {
    /// The target.
    #[serde(flatten)]
    pub target: Target,
    /// Runs that have the result and count.
    pub runs_counted: usize,
    /// All others: left out of means, failed, or without the result.
    pub runs_left_out: usize,
    /// How many of these count in means, and lack the result.
    pub runs_without_result: usize,
    /// How many of those that count meet it.
    pub runs_meeting: usize,
    /// 95 % interval of that share (Wilson 1927), in which runs of one specimen count as one.
    pub share_meeting: [f64; 2],
    /// Specimens of the runs that count: runs of one pour, or of one stored specimen, are of one.
    pub specimens: usize,
    /// Smallest and largest value.
    pub values: [f64; 2],
    /// How well the linear model fits.
    pub fit: LinearFit,
    /// Change of the result over the range of each factor in these runs, with half of its 95 %
    /// confidence interval.
    pub effects: BTreeMap<String, (f64, f64)>,
    /// Those ranges: narrower than the ones searched where other runs reach farther.
    pub ranges: BTreeMap<String, [f64; 2]>,
    /// Degrees of freedom of each of these intervals.
    pub freedom: BTreeMap<String, f64>,
    /// Factors that are judged by differences within specimens, all others by means of these.
    pub within_specimens: Vec<String>,
    /// Largest probability of meeting it, anywhere.
    pub best: f64,
}

impl TargetFound {
    /// A value of it, to the digit by which runs scatter about the model.
    fn shown(&self, value: f64) -> String {
        scattered(value, self.fit.residual_standard_deviation)
    }

    /// What a factor moves, with the range in these runs where that is not the one shown.
    fn change(&self, factor: &str, shown: [f64; 2]) -> Option<Cell> {
        let (by, half) = self.effects.get(factor)?;
        let [own, all] = [self.ranges.get(factor)?, &shown].map(|[low, high]| from_to(*low, *high));
        let over = if own == all { String::new() } else { format!(" over {own}") };
        Some(Cell::number(mean_within(*by, Some(*half)) + &over))
    }
}

/// Two targets, or all.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Together {
    /// Which, by their place in the list of targets, from 0.
    pub targets: Vec<usize>,
    /// Mean probability of meeting them over all points.
    pub mean: f64,
    /// The largest.
    pub best: f64,
    /// Values of the factors where it is.
    pub at: BTreeMap<String, f64>,
    /// Points that meet them all; none where no point has all results.
    pub points: Option<PointsMet>,
}

/// Points of sweeps that meet targets. A point is a run, or runs of several sweeps with the same
/// values of all factors that they share.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct PointsMet {
    /// How many meet them all.
    pub met: usize,
    /// How many have all results.
    pub of: usize,
    /// 95 % interval of the share (Wilson 1927), in which points that share a specimen count as
    /// one.
    pub share: [f64; 2],
    /// How many groups of points there are of which no two share a specimen.
    pub independent: usize,
}

impl PointsMet {
    /// `met` of `of` points, `independent` of them or of their groups; none of none.
    pub fn new(met: usize, of: usize, independent: usize) -> Option<Self> {
        let share = || wilson_interval(met as f64 / of as f64, independent);
        (of > 0).then(|| Self { met, of, share: share(), independent })
    }

    fn text(self) -> String {
        share(self.met, self.of, self.share)
    }
}

/// A point that meets all targets.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct MetAt {
    /// Values of the factors.
    pub at: BTreeMap<String, f64>,
    /// Values of the targets, in their order.
    pub values: Vec<f64>,
}

/// Everything found.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct TargetsFound {
    /// Factors and the ranges searched.
    pub factors: BTreeMap<String, [f64; 2]>,
    /// One a target.
    pub targets: Vec<TargetFound>,
    /// Correlations of the residuals of all targets at points that have them all; none where
    /// these are too few, and residuals are taken to be independent.
    pub correlations: Option<Vec<Vec<f64>>>,
    /// Every pair of targets, the least likely first.
    pub pairs: Vec<Together>,
    /// All targets.
    pub all: Together,
    /// Points that meet all targets.
    pub met_at: Vec<MetAt>,
    /// Number of places searched.
    pub searched: usize,
}

/// Below this probability everywhere two targets are said to exclude each other, unless a point
/// meets both. Ours: one run in twenty, the usual level of a test.
pub const EXCLUDED_BELOW: f64 = 0.05;

/// Steps that the range of a factor is divided into at least, where a page says where a probability
/// is largest. Ours: linear models do not tell places apart that are nearer.
const STEPS: f64 = 20.0;

impl TargetsFound {
    /// What it comes to, in a sentence or two.
    pub fn answer(&self) -> String {
        let points = self.all.points.map(PointsMet::text);
        let mut said: Vec<String> = Vec::new();
        said.extend(points.map(|points| format!("Points that meet all targets: {points}.")));
        said.push(match self.all.best < EXCLUDED_BELOW {
            true => format!(
                "By the linear models a run nowhere in these ranges meets all targets with more \
                 than {}.",
                percent(self.all.best.max(0.001))
            ),
            false => format!(
                "By the linear models a run meets all targets with {} at best{}.",
                percent(self.all.best),
                match self.all.at.is_empty() {
                    true => String::new(),
                    false => format!(", at {}", self.place(&self.all.at)),
                }
            ),
        });
        // What has been met can be met, whatever the models say.
        let unmet = self.targets.iter().filter(|t| t.runs_meeting == 0);
        let alone = unmet.map(|t| (t.target.title(), t.best));
        let is_unmet = |pair: &&Together| pair.points.is_none_or(|points| points.met == 0);
        let pairs = self.pairs.iter().filter(is_unmet);
        let pairs = pairs.map(|pair| (self.names(&pair.targets), pair.best));
        said.extend(excluded("Not met anywhere by itself", alone));
        said.extend(excluded("Targets that exclude each other", pairs));
        said.extend(self.without_result());
        let is_of_one = |t: &&TargetFound| t.specimens == 1 && t.runs_counted > 1;
        let of_one: Vec<String> =
            self.targets.iter().filter(is_of_one).map(|t| t.target.title()).collect();
        if !of_one.is_empty() {
            said.push(format!("Of one specimen, and no measure of others: {}.", of_one.join(", ")));
        }
        said.join(" ")
    }

    /// Which targets are judged without runs that count, in a sentence or two; none where none is.
    fn without_result(&self) -> Option<String> {
        let without = self.targets.iter().filter(|t| t.runs_without_result > 0);
        let each: Vec<String> = without
            .map(|t| {
                let counting = t.runs_counted + t.runs_without_result;
                format!("{} in {} of {counting}", t.target.title(), t.runs_without_result)
            })
            .collect();
        (!each.is_empty()).then(|| {
            format!(
                "Runs that count and lack a result: {}. All that is said of it is of the other \
                 runs, and biased where it is withheld (column `withheld` of sweep.csv says why): \
                 such runs are not random.",
                each.join(", ")
            )
        })
    }

    /// A place that was found, each factor to at least a twentieth of its range.
    fn place(&self, at: &BTreeMap<String, f64>) -> String {
        let shown = |(name, x): (&String, &f64)| {
            let range = self.factors.get(name).map_or(0.0, |[low, high]| high - low);
            let decimals = (STEPS / range).log10().ceil();
            let value = match decimals <= 8.0 {
                true => number(*x, decimals.max(0.0) as usize),
                false => compact(*x),
            };
            format!("{name} {value}")
        };
        at.iter().map(shown).collect::<Vec<_>>().join(", ")
    }

    fn titles(&self) -> impl Iterator<Item = String> {
        self.targets.iter().map(|t| t.target.title())
    }

    fn names(&self, which: &[usize]) -> String {
        let names: Vec<String> = which.iter().map(|t| self.targets[*t].target.title()).collect();
        names.join(" and ")
    }

    fn alone(&self) -> Table {
        table!(&self.targets, |t| {
            "target" => t.target.title(),
            "wanted" => t.target.range(),
            "smallest to largest" => t.values.map(|value| t.shown(value)).join(" to "),
            "runs that meet it" => share(t.runs_meeting, t.runs_counted, t.share_meeting),
            "specimens" => t.specimens,
            "left out" => Cell::number(format!(
                "{}{}",
                t.runs_left_out,
                besides(t.runs_without_result, "of them without the result")
            )),
            "fit" => format!("{:.2}, {} unseen", t.fit.explained, predicted(t)).replace('-', "−"),
            "best" => Cell::number(percent(t.best)),
        })
    }

    fn effects(&self) -> Table {
        let first = ["factor", "range"].map(str::to_owned);
        let mut table = Table::new(first.into_iter().chain(self.titles()));
        for (name, [low, high]) in &self.factors {
            let mut cells = row![name, from_to(*low, *high)];
            cells.extend(self.targets.iter().map(|t| t.change(name, [*low, *high]).into()));
            table.row(cells);
        }
        table
    }

    fn together(&self) -> Table {
        let pairs = self.pairs.iter().filter(|pair| pair.targets.len() < self.targets.len());
        table!(pairs.chain([&self.all]), |found| {
            "together" => match found.targets.len() == self.targets.len() {
                true => "all".to_owned(),
                false => self.names(&found.targets),
            },
            "points that meet them" => found.points.map(PointsMet::text),
            "mean" => Cell::number(percent(found.mean)),
            "best" => Cell::number(percent(found.best)),
            "at" => self.place(&found.at),
        })
    }

    fn correlated(&self) -> Option<Table> {
        let correlations = self.correlations.as_ref()?;
        let mut table = Table::new([String::new()].into_iter().chain(self.titles()));
        for (title, of) in self.titles().zip(correlations) {
            let mut cells = row![title];
            cells.extend(of.iter().map(|r| Cell::number(format!("{r:+.2}").replace('-', "−"))));
            table.row(cells);
        }
        Some(table)
    }

    fn met_at(&self) -> Table {
        let mut table = Table::new(self.factors.keys().cloned().chain(self.titles()));
        for point in &self.met_at {
            let at = |name: &String| point.at.get(name).map(|x| Cell::number(compact(*x))).into();
            let mut cells: Vec<Cell> = self.factors.keys().map(at).collect();
            let values = self.targets.iter().zip(&point.values);
            cells.extend(values.map(|(target, value)| Cell::number(target.shown(*value))));
            table.row(cells);
        }
        table
    }

    /// How the intervals of effects were found.
    fn of_effects(&self) -> String {
        let within: BTreeSet<&str> =
            self.targets.iter().flat_map(|t| &t.within_specimens).map(String::as_str).collect();
        let said = "Change of each result over the range of a factor, or over that of its own \
                    runs where another is named, ± half of its 95 % confidence interval";
        if within.is_empty() {
            return format!("{said}.");
        }
        let within = within.into_iter().collect::<Vec<_>>().join(", ");
        format!(
            "{said}: of {within} by the scatter of differences within specimens, of all others by \
             that of the means of specimens."
        )
    }

    /// `targets.md`.
    pub(crate) fn page(&self) -> Page {
        let alone = "Runs that meet a target, with the 95 % interval of their share, in which \
                     runs of one specimen count as one; specimens: runs of one pour, or of one \
                     stored specimen, are of one; left out: runs that do not count in means, \
                     failed, or lack the result; fit: share of the variance that a linear model of \
                     all factors explains, and of specimens that it has not seen; best: largest \
                     probability that a run meets the target, by that model with its scatter.";
        let effects = self.of_effects();
        let dependence = match self.correlations {
            Some(_) => "Residuals of different targets go together as in the last table",
            None => "Residuals of different targets are taken to be independent",
        };
        let together = format!(
            "Points that meet targets together (runs with the same values of all factors that \
             their sweeps share; in brackets the 95 % interval of that share, in which points that \
             share a specimen count as one), and the probability by the linear models, over {} \
             places that fill the ranges: on average, at best, and where that is. {dependence}.",
            self.searched
        );
        let met_at = "Factors and results of the points that meet all targets.";
        let correlated = "Correlations of the residuals of two targets at the same point.";
        let section = |said: &str, table| [Block::Text(said.to_owned()), Block::Table(table)];
        let mut page = Page::new("Targets met together", [Block::Lead(self.answer())])
            .section("alone", "Each target by itself", section(alone, self.alone()))
            .section("effects", "What each factor moves", section(&effects, self.effects()))
            .section("together", "Together", section(&together, self.together()));
        if !self.met_at.is_empty() {
            page = page.section("met", "Where all are met", section(met_at, self.met_at()));
        }
        if let Some(table) = self.correlated() {
            page = page.section("correlations", "Correlations", section(correlated, table));
        }
        page
    }
}

/// What is met nowhere with a probability to speak of, in a sentence; none where nothing is.
fn excluded(said: &str, each: impl Iterator<Item = (String, f64)>) -> Option<String> {
    let each: Vec<String> = each
        .filter(|(_, best)| *best < EXCLUDED_BELOW)
        .map(|(name, best)| format!("{name} ({})", percent(best)))
        .collect();
    (!each.is_empty()).then(|| format!("{said}: {}.", each.join("; ")))
}

/// How many of all, with the interval of their share.
fn share(met: usize, of: usize, interval: [f64; 2]) -> String {
    let [low, high] = interval.map(percent);
    format!("{met} of {of} ({low} to {high})")
}

fn percent(share: f64) -> String {
    match 100.0 * share {
        p if p > 0.0 && p < 0.1 => "< 0.1 %".to_owned(),
        p if p < 10.0 => format!("{p:.1} %"),
        p => format!("{p:.0} %"),
    }
}

/// How much of the variance is predicted, where that is known.
fn predicted(target: &TargetFound) -> String {
    match target.fit.predicted {
        share if share.is_finite() => format!("{share:.2}"),
        _ => "unknown".to_owned(),
    }
}

/// Writes `targets.json` and `targets.md`.
///
/// # Errors
/// [`ReportError`] naming the file.
pub fn write_targets(out: &Path, found: &TargetsFound) -> Result<(), ReportError> {
    write_json(&out.join("targets.json"), found)?;
    found.page().write(out, &["targets.md"])
}

#[cfg(test)]
#[path = "targets_tests.rs"]
mod tests;
