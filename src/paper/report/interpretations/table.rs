//! The table of interpretations: its rows, from which every form of it is made.

use super::*;
use crate::in_order::each_once;
use crate::paper::report::sections::paper_value;
use crate::report::settlement::SETTLEMENTS;
use crate::scenario::is_of_coarse_steps;

/// A row of the table.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct InterpretationRow {
    /// Which part of the table it stands in.
    pub part: String,
    /// What is shown.
    pub quantity: String,
    /// Unit of its numbers; empty for pure numbers and words.
    pub unit: String,
    /// What the paper's text has for it; empty where it has nothing, `all` where another number is
    /// expected of each interpretation.
    pub paper: String,
    /// One cell an interpretation, in the order of the interpretations.
    pub cells: Vec<InterpretationCell>,
}

/// A cell of the table.
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
pub struct InterpretationCell {
    /// Mean over the runs that count in means, where it is a number; where none counts, over
    /// those that do not, and `not_valid` says so.
    pub value: Option<f64>,
    /// Smallest and largest, where several make it.
    pub spread: Option<Interval>,
    /// Words, where it is none.
    pub words: String,
    /// Whether a claim is met.
    pub verdict: Option<Verdict>,
    /// Runs that have it and do not count in means.
    pub left_out: usize,
    /// Whether the number is of runs that do not count, there being no other.
    pub not_valid: bool,
}

impl InterpretationCell {
    fn words(words: impl Into<String>) -> Self {
        Self { words: words.into(), ..Self::default() }
    }

    /// Mean and range of a value over runs, valid ones and others never in one.
    fn of_runs<'a>(
        runs: impl Iterator<Item = &'a RunRecord>,
        value: impl Fn(&RunRecord) -> Option<f64>,
    ) -> Self {
        let finite = |r: &RunRecord| value(r).filter(|v| v.is_finite());
        let (shown, left_out) = never_mixed(runs.filter(|r| finite(r).is_some()));
        let of = Self::of(shown.into_iter().filter_map(finite));
        Self { left_out: left_out.runs, not_valid: left_out.all, ..of }
    }

    /// Mean and range of numbers.
    fn of(values: impl IntoIterator<Item = f64>) -> Self {
        let values: Vec<f64> = values.into_iter().filter(|v| v.is_finite()).collect();
        let spread = Interval::of(values.iter().copied()).filter(|i| i.high > i.low);
        Self { value: mean(&values), spread, ..Self::default() }
    }

    fn of_claim(own: &Claim) -> Self {
        let spread = own.not_valid.map_or(own.spread, |n| n.spread);
        Self {
            value: own.ours.or(own.not_valid.map(|n| n.value)),
            spread: spread.filter(|s| s.high > s.low),
            words: Self::without_value(own).to_owned(),
            verdict: Some(own.verdict),
            left_out: own.left_out.len(),
            not_valid: own.not_valid.is_some(),
        }
    }

    /// Why a claim has no value.
    fn without_value(own: &Claim) -> &str {
        match own.verdict {
            // It says whether it was run and did not tell, or was too short to.
            Verdict::NotRun if !own.reason.is_empty() => &own.reason,
            Verdict::NotStated if own.full_size && !own.runs.is_empty() => "not compared",
            _ if !own.runs.is_empty() => "not measured",
            _ if own.left_out.is_empty() => "not run",
            _ => NO_VALID_RUN,
        }
    }

    /// For readers.
    pub(super) fn text(&self, decimals: Option<usize>) -> String {
        let shown = |v: f64| decimals.map_or_else(|| compact(v), |d| number(v, d));
        match (self.value, self.spread) {
            (None, _) if self.words.is_empty() => "–".to_owned(),
            (None, _) => self.words.clone(),
            (Some(v), None) => shown(v),
            (Some(v), Some(s)) => format!("{} [{} … {}]", shown(v), shown(s.low), shown(s.high)),
        }
    }

    /// What is to be minded of the runs behind the number; empty where nothing is.
    pub(super) fn mark(&self) -> String {
        match (self.value, self.not_valid, self.left_out) {
            (Some(_), true, _) => "not valid".to_owned(),
            (Some(_), false, n) if n > 0 => format!("{n} left out"),
            _ => String::new(),
        }
    }
}

/// Decimals in which a row's numbers are shown; four digits that count elsewhere. Overlaps are a
/// hundredth of what is measured otherwise.
pub(super) fn decimals(row: &InterpretationRow) -> Option<usize> {
    match row.unit.as_str() {
        "mm" | "%" if row.quantity.contains("overlap") => Some(2),
        "mm" | "%" | "% of the final settlement" | "µm/s" => Some(1),
        _ => None,
    }
}

/// The one result among what tells whether an interpretation can be believed.
const VOID_RATIO: &str = "void ratio after pouring";

pub(super) fn rows(columns: &[InterpretationColumn]) -> Vec<InterpretationRow> {
    let mut table = Rows { columns, part: "Outcome", rows: Vec::new() };
    table.words("runs made", |c| format!("{} of {}", c.runs.len(), c.planned_runs));
    table.words("runs that failed", |c| match c.failures.len() {
        0 => "none".to_owned(),
        n => format!("{n}, see {}", c.name),
    });
    table.add("runs that lost every grain", "", "", |c| {
        InterpretationCell::of([c.emptied().count() as f64])
    });
    table.words("steps too coarse for the motion", |c| {
        let is_coarse = c.warnings.iter().any(|warning| is_of_coarse_steps(warning));
        if is_coarse { "yes" } else { "no" }.to_owned()
    });
    table.part = "Figure 7: standing height, mean surface";
    for fh in constants::FALLING_HEIGHTS_MM {
        let quantity = format!("from {} cm", number(fh / 10.0, 0));
        let height = |r: &RunRecord| r.summary.standing_height_mm.mean();
        table.add(&quantity, "mm", "", |c| InterpretationCell::of_runs(c.poured_from(fh), height));
    }
    table.add_settlements("Figure 9: continuous vibration", RunKind::VibrationContinuous);
    table.add_settlements("Figure 10: intermittent vibration", RunKind::VibrationIntermittent);
    table.add_trust();
    table.add_claims();
    table.rows
}

/// The table as it grows.
struct Rows<'a> {
    columns: &'a [InterpretationColumn],
    part: &'static str,
    rows: Vec<InterpretationRow>,
}

impl Rows<'_> {
    fn add(
        &mut self,
        quantity: &str,
        unit: &str,
        paper: &str,
        cell: impl Fn(&InterpretationColumn) -> InterpretationCell,
    ) {
        self.rows.push(InterpretationRow {
            part: self.part.to_owned(),
            quantity: quantity.to_owned(),
            unit: unit.to_owned(),
            paper: paper.to_owned(),
            cells: self.columns.iter().map(cell).collect(),
        });
    }

    fn words(&mut self, quantity: &str, words: impl Fn(&InterpretationColumn) -> String) {
        self.add(quantity, "", "", |c| InterpretationCell::words(words(c)));
    }

    /// Settlement of plate and surface: early, in the end, and the one as a share of the other.
    fn add_settlements(&mut self, part: &'static str, kind: RunKind) {
        self.part = part;
        let is_continuous = kind == RunKind::VibrationContinuous;
        let first = if is_continuous { "after 5 s" } else { "after the first period" };
        let early = |s: &Settlement| match is_continuous {
            true => s.after_5_s,
            false => s.after_each_period.first().copied(),
        };
        for (what, settlement) in SETTLEMENTS {
            // The paper speaks of the plate.
            let (lab, share) = match (what, is_continuous) {
                ("plate", true) => ("14 to 19.61", "about 80"),
                ("plate", false) => ("", "about 85"),
                _ => ("", ""),
            };
            let cell = |c: &InterpretationColumn, value: &dyn Fn(&Settlement) -> Option<f64>| {
                InterpretationCell::of_runs(c.of_kind(kind), |r| value(settlement(r)?))
            };
            self.add(&format!("{what}, {first}"), "mm", "", |c| cell(c, &early));
            let last = |s: &Settlement| Some(s.final_mm);
            self.add(&format!("{what}, final"), "mm", lab, |c| cell(c, &last));
            let of_final = |s: &Settlement| share_percent(early(s)?, s.final_mm);
            self.add(&format!("{what}, share {first}"), "%", share, |c| cell(c, &of_final));
        }
    }

    /// What tells whether the results can be believed.
    fn add_trust(&mut self) {
        self.part = "Credibility";
        type Of = fn(&RunRecord) -> Option<f64>;
        let quantities: [(&str, &str, Of); 9] = [
            ("overlap of grains, mean", "%", |r| Some(r.summary.overlap.mean_percent)),
            ("overlap of grains, 99th percentile", "%", |r| Some(r.summary.overlap.p99_percent)),
            ("largest overlap", "mm", |r| Some(r.summary.overlap.max_mm)),
            ("numerical creep at rest", "µm/s", |r| r.summary.creep_um_per_s),
            (VOID_RATIO, "", |r| r.summary.void_ratio.filter(|_| r.kind == RunKind::Pluviation)),
            ("grains in the cylinder", "", |r| Some(r.summary.grains.in_cylinder as f64)),
            ("grains through walls or floor", "", |r| Some(r.summary.grains.escaped as f64)),
            ("grains over the rim", "", |r| Some(r.summary.grains.spilled as f64)),
            ("grains left in the funnel", "", |r| Some(r.summary.grains.left_in_funnel as f64)),
        ];
        for (quantity, unit, value) in quantities {
            self.add(quantity, unit, "", |c| match quantity {
                VOID_RATIO => InterpretationCell::of_runs(c.runs.iter(), value),
                // Of all runs, by which they are judged, also of those that lost every grain.
                _ => InterpretationCell::of(c.runs.iter().filter_map(value)),
            });
        }
        self.words("runs that meet the accuracy standard", |c| {
            format!("{} of {}", c.meeting_standard(), c.runs.len())
        });
        self.words("runs left out of means", |c| format!("{} of {}", c.left_out(), c.runs.len()));
    }

    /// Every claim that any interpretation has, and the tally of results.
    fn add_claims(&mut self) {
        self.part = "The paper's statements";
        let mut known: Vec<&str> = Vec::new();
        for claim in self.columns.iter().flat_map(|c| &c.claims) {
            if known.contains(&claim.id.as_str()) {
                continue;
            }
            known.push(&claim.id);
            let unit = if claim.unit == "–" { "" } else { &claim.unit };
            // What is left out of a column is not expected of it.
            let same = self.columns.iter().flat_map(|c| &c.claims).filter(|c| c.id == claim.id);
            let paper = match each_once(same.filter_map(paper_value)).as_slice() {
                [] => String::new(),
                [paper] => paper.clone(),
                _ => "all".to_owned(),
            };
            self.add(claim.statement.trim_end_matches('.'), unit, &paper, |c| {
                let own = c.claims.iter().find(|other| other.id == claim.id);
                own.map(InterpretationCell::of_claim).unwrap_or_default()
            });
        }
        self.words("results within / outside / not run / not comparable", |c| {
            let of = ResultCounts::of(&c.claims);
            format!("{} / {} / {} / {}", of.within, of.outside, of.not_run, of.not_comparable)
        });
    }
}
