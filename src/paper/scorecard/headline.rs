//! What is reproduced, what is not, and why, in words made from the rows and the runs.

use super::{RowCounts, ScoreRow};
use crate::in_order::{each_once, grouped};
use crate::paper::{StudyView, Verdict, constants::GRAIN_COUNT, uncertainty::trend};
use crate::record::{RunRecord, left_out_in_words};
use crate::report::text::number;

/// What moves the settlement of the plate and its shares at full size, as far as it was measured:
/// numbers of `targets.json` and `intermittent-1.csv` in `docs/results/joint`.
pub(super) const MOVES_SETTLEMENT: &str = "At full size a gradual start and stop of the table \
     lowers the settlement and its share in the first 5 s, and raises the share in the first \
     period; with it 4 of 8 specimens, without it none of 8, have the paper's share in the first \
     period. Friction, cell shape, amplitude and crank over rod showed no effect beyond the wide \
     scatter (docs/studies.md).";

/// What moves the settlement of the smaller specimen's plate, as its page says.
pub(super) const MOVES_QUICK_SETTLEMENT: &str = "On the quick specimen no parameter by itself \
     moves the settlement of the plate beyond scatter (docs/results/sensitivity-quick.md).";

/// Why piles are steeper than the friction of their grains' surfaces: numbers of `calibrate.json`
/// in `docs/results/calibration`.
pub(super) const CALIBRATED: &str = "Angular grains interlock: for 38.40° piles of 364 grains need a \
                                     friction coefficient of 0.35 (95 % confidence 0.26 to 0.40), \
                                     not the tangent of that angle, 0.793, as in the paper \
                                     (docs/repose.md).";

/// The row of the pile.
const ANGLE: &str = "angle-of-repose";

/// What is reproduced, what is not and what is not decided, a line each.
pub(super) fn paragraph(study: &StudyView, rows: &[ScoreRow]) -> String {
    let mut sentences = Vec::new();
    if study.quick {
        sentences.push(format!(
            "This is the quick study, of {} grains instead of {GRAIN_COUNT}, shaken for less time: it \
             tries the whole programme. What depends on the full size is shown, and not compared \
             with the paper.",
            study.grain_count
        ));
    }
    if study.runs.is_empty() {
        sentences.push("No run is finished yet; only what needs no run is shown.".to_owned());
        return sentences.join("\n");
    }
    let of = |verdict| rows.iter().filter(move |r| r.stands() == Some(verdict));
    let reproduced: Vec<String> = of(Verdict::Within).map(reproduced).collect();
    sentences.extend(said("Reproduced", &reproduced));
    let missed: Vec<String> = of(Verdict::Outside).map(missed).collect();
    sentences.extend(said("Not reproduced", &missed));
    let open: Vec<String> = rows.iter().filter(|r| r.stands().is_none()).map(undecided).collect();
    sentences.extend(said("Not decided (runs are too few, or scatter too much)", &open));
    if !reproduced.is_empty() && missed.is_empty() && open.is_empty() {
        sentences.push("Nothing that could be compared is missed.".to_owned());
    }
    if sentences.is_empty() {
        sentences.push("Nothing could be compared.".to_owned());
    }
    sentences.join("\n")
}

/// Why, what was not compared, and how far the runs can be believed; a line each.
pub(super) fn reasons(
    study: &StudyView,
    counting: &StudyView,
    rows: &[ScoreRow],
    tally: &RowCounts,
) -> String {
    if study.runs.is_empty() {
        return String::new();
    }
    let of = |verdict| rows.iter().filter(move |r| r.stands() == Some(verdict));
    let not_decided = rows.iter().filter(|r| r.stands().is_none());
    let why = why(counting, of(Verdict::Outside).chain(not_decided));
    let mut others = Vec::new();
    for (verdict, what) in [(Verdict::NotComparable, "Not compared"), (Verdict::NotRun, "Not run")]
    {
        others.extend(by_reason(what, of(verdict)));
    }
    let runs = vec![creep(study, counting), standard(study), format!("{}.", tally.in_words())];
    let lines = [why, others, runs].map(|sentences| sentences.join(" "));
    lines.into_iter().filter(|line| !line.is_empty()).collect::<Vec<_>>().join("\n")
}

/// "Reproduced: a; b." where there is something.
fn said(what: &str, items: &[String]) -> Option<String> {
    (!items.is_empty()).then(|| format!("{what}: {}.", items.join("; ")))
}

/// A statement within a sentence.
fn lower(statement: &str) -> String {
    let mut letters = statement.chars();
    letters.next().map_or_else(String::new, |first| first.to_lowercase().chain(letters).collect())
}

/// Ours, of a count without its mean; of the angle of repose also by what it is judged.
fn reproduced(row: &ScoreRow) -> String {
    if row.paper == "all" {
        let count = row.in_words.split(';').next().unwrap_or_default();
        return format!("{} ({count})", lower(row.statement));
    }
    let by = match row.interval {
        Some(i) if row.id == ANGLE => format!(
            "; our interval of ±{}° holds the paper's {}, and one that scatters more would all the \
             more",
            number(0.5 * (i.high - i.low), 1),
            row.paper
        ),
        _ => String::new(),
    };
    format!("{} ({}{by})", lower(row.statement), row.in_words)
}

/// Ours beside the paper's where the runs are too few, or scatter too much, to say more.
fn undecided(row: &ScoreRow) -> String {
    if row.paper == "all" {
        return format!("{} ({})", lower(row.statement), row.in_words);
    }
    format!("{} ({}; the paper's {})", lower(row.statement), row.in_words, row.paper)
}

fn missed(row: &ScoreRow) -> String {
    if row.paper == "all" {
        return format!("{} (only {})", lower(row.statement), row.in_words);
    }
    let side = if row.beyond < 0.0 { "less" } else { "more" };
    format!("{} ({}, {side} than the paper's {})", lower(row.statement), row.in_words, row.paper)
}

/// A sentence on statements, those with the same reason together; none without any.
fn by_reason<'a>(what: &str, rows: impl Iterator<Item = &'a ScoreRow>) -> Option<String> {
    let groups = grouped(rows.map(|row| (row.reason.as_str(), lower(row.statement))));
    let group = |(reason, statements): &(&str, Vec<String>)| {
        // "Not run" says itself that it was not run.
        let because = if reason.is_empty() || what.eq_ignore_ascii_case(reason) {
            String::new()
        } else {
            format!(" ({reason})")
        };
        format!("{}{because}", statements.join("; "))
    };
    said(what, &groups.iter().map(group).collect::<Vec<_>>())
}

/// What is measured of the causes of each row that is missed or not decided, and what is not.
fn why<'a>(counting: &StudyView, rows: impl Iterator<Item = &'a ScoreRow>) -> Vec<String> {
    let mut found: Vec<String> = Vec::new();
    let mut not_investigated = Vec::new();
    for row in rows {
        found.extend(match row.id {
            "standing-height-falls" => vec![trend(counting).verdict],
            "continuous-final-settlement" => {
                vec![MOVES_SETTLEMENT.to_owned(), MOVES_QUICK_SETTLEMENT.to_owned()]
            }
            "continuous-share-after-5-s" | "intermittent-share-in-first-period" => {
                vec![MOVES_SETTLEMENT.to_owned()]
            }
            ANGLE => vec![CALIBRATED.to_owned()],
            _ => {
                not_investigated.push(lower(row.statement));
                continue;
            }
        });
    }
    let mut found = each_once(found);
    found.extend(said("What moves it was not investigated", &not_investigated));
    found
}

/// How fast the specimens sink at rest, and how far that would carry them in the time of their
/// vibration: of the runs that count, and where none does, of all.
fn creep(study: &StudyView, counting: &StudyView) -> String {
    let runs = if counting.runs.is_empty() { study.runs } else { counting.runs };
    let rate = |r: &RunRecord| r.summary.creep_um_per_s.map(f64::abs).filter(|v| v.is_finite());
    let Some(most) = runs.iter().filter_map(rate).reduce(f64::max) else {
        return "Numerical creep was not measured.".to_owned();
    };
    let over_vibration = |r: &RunRecord| {
        let (first, last) = r.summary.shaken_s()?;
        Some(1e-3 * rate(r)? * (last - first)).filter(|mm| mm.is_finite())
    };
    let vibrated = runs.iter().filter(|r| r.kind.is_vibration());
    let mm = vibrated.filter_map(over_vibration).reduce(f64::max);
    let meanwhile = mm.map_or_else(String::new, |mm| {
        let mm = at_most(mm);
        format!(
            "; shaken specimens would creep numerically by {mm} mm in the time of their vibration"
        )
    });
    format!("Numerical creep at rest: {} µm/s{meanwhile}.", at_most(most))
}

/// A largest value, with two decimals, rounded up: what is said holds.
fn at_most(value: f64) -> String {
    if value < 0.01 {
        return "less than 0.01".to_owned();
    }
    // What arithmetic leaves behind the digits is no reason for a higher last one.
    let hundredths = (100.0 * value - 1e-9).ceil();
    format!("at most {}", number(hundredths / 100.0, 2))
}

/// How many runs can be believed.
fn standard(study: &StudyView) -> String {
    let all = study.runs.len();
    let left_out = study.runs.iter().filter(|r| !r.counts_in_means()).count();
    match left_out_in_words(left_out, all) {
        None => {
            let runs =
                if all == 1 { "The one run is".to_owned() } else { format!("All {all} runs are") };
            format!(
                "{runs} valid: the accuracy standard is met and no run-time check found anything."
            )
        }
        Some(said) => {
            let first = study.runs.iter().find(|r| !r.counts_in_means());
            let first = first.map_or_else(String::new, |run| {
                format!("; the first, {}: {}", run.name, run.summary.why_left_out().join("; "))
            });
            format!("{said}{first}.")
        }
    }
}

#[cfg(test)]
mod tests {
    use super::at_most;

    /// Law: the bound that is said is not below the value.
    #[test]
    fn a_bound_is_rounded_up() {
        for (value, expected) in [
            (0.0, "less than 0.01"),
            (0.009, "less than 0.01"),
            (0.01, "at most 0.01"),
            (0.014, "at most 0.02"),
            (0.29, "at most 0.29"),
            (0.8, "at most 0.80"),
            (1.001, "at most 1.01"),
        ] {
            let got = at_most(value);
            assert_eq!(got, expected, "law: a bound of {value}: expected {expected}, got {got}");
        }
    }
}
