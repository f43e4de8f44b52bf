//! The rows, each made from its statement's claims and from what the runs measured.

use super::*;
use crate::paper::{
    claims::{edge_ratio, why_not_comparable},
    constants::PERIOD_S,
    uncertainty::{SETTLEMENT_OF_PLATE, SHARE_AFTER_5_S, placement_scatter},
};

/// A row before its value is known.
struct Row<'a> {
    id: &'static str,
    statement: &'static str,
    claims: Vec<&'a Claim>,
}

/// The rows of a study, of the runs that count; `all` are its runs with those that do not.
pub(super) fn rows(all: &StudyView, study: &StudyView, claims: &[Claim]) -> Vec<ScoreRow> {
    let of = |id, statement, wanted: &dyn Fn(&str) -> bool| Row {
        id,
        statement,
        claims: claims.iter().filter(|c| wanted(&c.id)).collect(),
    };
    let one = |id: &'static str, statement| of(id, statement, &|name| name == id);
    // "…-1", "…-2": one claim a configuration.
    let each = |id: &'static str, statement| {
        of(id, statement, &|name| {
            let number = name.strip_prefix(id).and_then(|rest| rest.strip_prefix('-'));
            number.is_some_and(|n| n.parse::<u32>().is_ok())
        })
    };
    let settled =
        |kind, value: fn(&Settlement) -> Option<f64>| study.values(kind, move |r| value(plate(r)?));
    let (continuous, intermittent) = (RunKind::VibrationContinuous, RunKind::VibrationIntermittent);
    let placements = placement_scatter(all, study);
    let stands_alone = why_not_comparable(all, "continuous-").is_none();
    let under_plates = |own: &[f64], name: &str| Measured {
        stands_alone,
        ..Measured::under_plates(own, &placements, name)
    };
    let after_20_s = settled(continuous, |s| Some(s.final_mm));
    let after_5_s = settled(continuous, |s| Some(100.0 * s.share_after_5_s?));
    let of_first = |s: &Settlement| share_percent(*s.after_each_period.first()?, s.final_mm);
    let after_first = settled(intermittent, of_first);
    let after_last = settled(intermittent, |s| Some(s.final_mm));
    let angles = study.values(RunKind::Repose, angle_of_repose);
    let for_s = |what: &str, s: f64| format!("Ours {what} {} s.", without_zeros(&number(s, 2)));
    let continuously = &shaken_otherwise(study, continuous, CONTINUOUS_S)
        .map_or_else(String::new, |s| for_s("is shaken for", s));
    let in_periods = &shaken_otherwise(study, intermittent, PERIOD_S)
        .map_or_else(String::new, |s| for_s("has periods of", s));
    [
        one("standing-height-falls", "Gravel that falls from higher stands lower")
            .counted()
            .map(|row| falls(row, study)),
        one("denser-after-vibration", "Gravel is denser after vibration").counted(),
        each("continuous-final-settlement", "Settlement of the plate after 20 s of vibration")
            .mean(under_plates(&after_20_s, SETTLEMENT_OF_PLATE), "mm", 1)
            .map(|row| row.noting(continuously)),
        each("continuous-share-after-5-s", "Share of the settlement in the first 5 s")
            .mean(under_plates(&after_5_s, SHARE_AFTER_5_S), "%", 0)
            .map(|row| row.noting(continuously)),
        each(
            "intermittent-share-in-first-period",
            "Share in the first of four periods of vibration",
        )
        .mean(Measured::under_one_plate(&after_first), "%", 0)
        .map(|row| row.noting(in_periods)),
        one("intermittent-fluctuation-at-ends", "The plate moves most as a period begins and ends")
            .counted()
            .map(|row| moves_most_at_ends(row, study)),
        one("intermittent-in-laboratory-range", "Settlement of the plate after four periods")
            .mean(Measured::under_one_plate(&after_last), "mm", 1)
            .map(|row| row.noting(in_periods)),
        one("angle-of-repose", "Angle of repose").mean(Measured::of(&angles), "°", 1),
    ]
    .into_iter()
    .flatten()
    .collect()
}

/// Length in s of the first period of a run that is not as long as the paper's; none where all are.
fn shaken_otherwise(study: &StudyView, kind: RunKind, paper_s: f64) -> Option<f64> {
    let first = |run: &RunRecord| {
        let [begin, end] = *run.summary.vibrations.first()?.periods_s.first()?;
        Some(end - begin)
    };
    // A period ends with a step.
    study.values(kind, first).into_iter().find(|s| (s - paper_s).abs() > 0.01 * paper_s)
}

fn in_brackets(interval: Interval, decimals: usize) -> String {
    format!("[{} … {}]", number(interval.low, decimals), number(interval.high, decimals))
}

/// What a row's mean is made from.
struct Measured {
    mean: Option<f64>,
    interval: Option<Interval>,
    /// Number of runs behind it.
    count: usize,
    /// What there is one of, where there is no interval.
    one: &'static str,
    /// Runs left out, where they are others than those of the claims.
    left_out: Option<usize>,
    /// Whether it is judged also where no run of the claims counts in means.
    stands_alone: bool,
    note: String,
}

impl Measured {
    /// One value a specimen.
    fn of(values: &[f64]) -> Self {
        let test = MeanTest::of(values, CONFIDENCE);
        Self {
            mean: mean(values),
            interval: test.map(|t| Interval::around(t.estimate.mean, t.half_width)),
            count: values.len(),
            one: "run",
            left_out: None,
            stands_alone: false,
            note: String::new(),
        }
    }

    /// The same, each of the one plate on a specimen.
    fn under_one_plate(values: &[f64]) -> Self {
        let note = "One placement of the plate per specimen.".to_owned();
        Self { note, ..Self::of(values) }
    }

    /// A quantity under the plates that were laid anew on each specimen, with the interval that
    /// holds the scatter of specimens and of placements; without any, of the programme's own.
    fn under_plates(own: &[f64], placements: &[PlacementScatter], name: &str) -> Self {
        let Some(placed) = placements.iter().find(|q| q.name == name) else {
            return Self::under_one_plate(own);
        };
        let means: Vec<f64> = placed.specimens.iter().filter_map(|s| mean(&s.values)).collect();
        let count = placed.specimens.iter().map(|s| s.values.len()).sum();
        let placements = counted(count, "placement");
        let left_out: usize = placed.specimens.iter().map(|s| s.left_out.len()).sum();
        let note = match placed.interval {
            Some(_) => format!(
                "Mean of {} specimens' means over {placements} of the plate; its interval \
                 holds the scatter of both.",
                means.len()
            ),
            None => format!("Mean over {placements} of the plate on one specimen."),
        };
        Self {
            mean: mean(&means),
            interval: placed.interval,
            count,
            one: "specimen",
            left_out: Some(left_out),
            stands_alone: false,
            note,
        }
    }
}

/// Why a mean that was judged by a range is not decided.
fn undecided(within: bool, range: Interval, of: &Measured, unit: &str) -> String {
    let side = if within { "within" } else { "outside" };
    let Some(interval) = of.interval else {
        return format!("The mean is {side}; one {} has no interval.", of.one);
    };
    let ends = [range.low, range.high].into_iter().filter(|end| interval.contains(*end));
    let ends: Vec<String> = ends.map(compact).collect();
    format!("The mean is {side}; its interval reaches across {} {unit}.", ends.join(" and "))
}

/// The count of heights that fall, with their mean slope.
fn falls(mut row: ScoreRow, study: &StudyView) -> ScoreRow {
    let slope = trend(study).slope;
    if let Some(slope) = slope {
        let mean = number(slope.mean_mm_per_cm, 2);
        row.in_words += &format!("; {mean} mm per cm {}", in_brackets(slope.interval, 2));
    }
    row.decide_by(slope.map(|s| s.interval), |slope| slope < 0.0);
    row
}

/// The count of plates that move most at the ends of periods, with the mean ratio of their
/// fluctuation there to that in between; of ratios the mean of the logarithms is taken.
fn moves_most_at_ends(mut row: ScoreRow, study: &StudyView) -> ScoreRow {
    let kind = RunKind::VibrationIntermittent;
    let ratios = Measured::of(&study.values(kind, |r| edge_ratio(study, r).map(f64::ln)));
    let interval = ratios.interval.map(|i| Interval::new(i.low.exp(), i.high.exp()));
    if let Some(mean) = ratios.mean {
        row.in_words += &format!("; ratio {}", number(mean.exp(), 2));
        row.in_words += &interval.map_or_else(String::new, |i| format!(" {}", in_brackets(i, 2)));
        row.add_note(
            "A run counts where the ratio of the plate's fluctuation near the ends of the periods \
             to that in between is above 1; the mean is geometric.",
        );
    }
    row.decide_by(interval, |ratio| ratio > 1.0);
    row
}

impl ScoreRow {
    /// With another sentence in the note, where the simulation has a value.
    fn noting(mut self, sentence: &str) -> Self {
        if self.ours.is_some() {
            self.add_note(sentence);
        }
        self
    }

    /// Of a count: its verdict is more than chance where both ends of the interval of what was
    /// counted say the same.
    fn decide_by(&mut self, interval: Option<Interval>, shows: impl Fn(f64) -> bool) {
        if !matches!(self.verdict, Verdict::Within | Verdict::Outside) {
            return;
        }
        let is_shown = self.verdict == Verdict::Within;
        let agrees = |i: Interval| [i.low, i.high].into_iter().all(|end| shows(end) == is_shown);
        let decided = interval.is_some_and(agrees);
        self.decided = Some(decided);
        if !decided {
            let side = if is_shown { "within" } else { "outside" };
            let but = match interval {
                Some(_) => "the interval of the mean does not say the same",
                None => "fewer than two configurations have no interval",
            };
            self.add_note(&format!("The count is {side}; {but}."));
        }
    }
}

impl Row<'_> {
    /// A mean over configurations; none where no claim is of it.
    fn mean(self, of: Measured, unit: &str, decimals: usize) -> Option<ScoreRow> {
        let mut row = self.begun(unit, false)?;
        let space = if unit == "°" { "" } else { " " };
        row.in_words = match (of.mean, of.interval) {
            (None, _) => "–".to_owned(),
            (Some(m), None) => format!("{}{space}{unit} (one {})", number(m, decimals), of.one),
            (Some(m), Some(i)) => {
                format!("{}{space}{unit} {}", number(m, decimals), in_brackets(i, decimals))
            }
        };
        (row.ours, row.interval, row.count) = (of.mean, of.interval, of.count);
        row.left_out = of.left_out.unwrap_or(row.left_out);
        let Some(ours) = of.mean else { return Some(row) };
        row.add_note(&of.note);
        let is_comparable = of.stands_alone && row.verdict == Verdict::NotComparable;
        if is_comparable {
            row.reason.clear();
        }
        let is_judged = is_comparable || matches!(row.verdict, Verdict::Within | Verdict::Outside);
        let first = self.claims.first()?;
        match (first.read_as, first.paper) {
            (Some(band), _) => {
                row.beyond =
                    if ours < band.low { ours - band.low } else { (ours - band.high).max(0.0) };
                // One claim a configuration: the row's verdict is of their mean.
                if is_judged {
                    let within = band.contains(ours);
                    row.verdict = if within { Verdict::Within } else { Verdict::Outside };
                    let decided = of.interval.is_some_and(|i| match within {
                        true => band.contains(i.low) && band.contains(i.high),
                        false => i.high < band.low || i.low > band.high,
                    });
                    row.decided = Some(decided);
                    if !decided {
                        row.add_note(&undecided(within, band, &of, unit));
                    }
                }
            }
            // The angle of repose has no band: it is compared by our own interval.
            (None, Some(PaperValue::Value { value })) => {
                row.beyond = ours - value;
                if let (true, Some(i)) = (is_judged, of.interval) {
                    row.add_note(&format!(
                        "Within where our interval, ±{}{space}{unit}, holds the paper's number, \
                         which has no scatter: the more ours scatters, the more easily it passes.",
                        number(0.5 * (i.high - i.low), decimals)
                    ));
                }
            }
            _ => {}
        }
        Some(row)
    }

    /// A count of what shows it.
    fn counted(self) -> Option<ScoreRow> {
        let claim = *self.claims.first()?;
        let mut row = self.begun(&claim.unit, true)?;
        let expected = claim.read_as.map_or(0.0, |i| i.high);
        row.ours = claim.ours;
        row.count = expected as usize;
        row.in_words = claim.ours.map_or("–".to_owned(), |ours| {
            let unit = unit_of(expected, &claim.unit);
            format!("{} of {} {unit}", number(ours, 0), number(expected, 0))
        });
        row.beyond = claim.ours.map_or(0.0, |ours| ours - expected);
        Some(row)
    }

    /// The row without its value; none where no claim is of it.
    fn begun(&self, unit: &str, all: bool) -> Option<ScoreRow> {
        let first = self.claims.first()?;
        let judged = |verdict| self.claims.iter().find(|c| c.verdict == verdict);
        // What was compared counts; what was not has its reason.
        let speaks = [Verdict::Outside, Verdict::Within, Verdict::NotComparable, Verdict::NotRun]
            .into_iter()
            .find_map(judged)
            .unwrap_or(first);
        let mut left_out: Vec<&String> = self.claims.iter().flat_map(|c| &c.left_out).collect();
        left_out.sort();
        left_out.dedup();
        let paper = match first.paper {
            None => "–".to_owned(),
            Some(_) if all => "all".to_owned(),
            Some(PaperValue::Range(i)) => {
                format!("{} to {} {unit}", compact(i.low), compact(i.high))
            }
            Some(PaperValue::Value { value }) if unit == "°" => format!("{}°", number(value, 2)),
            Some(PaperValue::Value { value }) => format!("about {} {unit}", compact(value)),
        };
        Some(ScoreRow {
            id: self.id,
            statement: self.statement,
            source: first.source.clone(),
            paper,
            unit: unit.to_owned(),
            verdict: speaks.verdict,
            reason: speaks.reason.clone(),
            left_out: left_out.len(),
            claims: self.claims.iter().map(|c| c.id.clone()).collect(),
            ..ScoreRow::default()
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Law: a count is decided where the whole interval of what is counted says the same; without
    /// an interval nothing is, and what was not judged is not asked.
    #[test]
    fn a_count_is_decided_by_the_interval_of_its_mean() {
        use Verdict::{NotRun, Outside, Within};
        let of = |low, high| Some(Interval::new(low, high));
        for (verdict, interval, expected) in [
            (Within, of(1.2, 1.6), Some(true)),
            (Within, of(0.9, 1.6), Some(false)),
            (Within, None, Some(false)),
            (Outside, of(0.5, 0.9), Some(true)),
            (Outside, of(0.9, 1.6), Some(false)),
            (Outside, of(1.2, 1.6), Some(false)),
            (NotRun, of(1.2, 1.6), None),
        ] {
            let mut row = ScoreRow { verdict, ..ScoreRow::default() };
            row.decide_by(interval, |ratio| ratio > 1.0);
            assert_eq!(row.decided, expected, "law: {verdict:?} with {interval:?} above 1");
            assert_eq!(row.note.is_empty(), expected != Some(false), "law: why: {row:?}");
        }
    }
}
