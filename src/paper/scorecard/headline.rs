//! What is reproduced, what is not and why, in one paragraph made from the rows and the runs.

use super::{ResultCounts, ScoreRow};
use crate::paper::{StudyView, Verdict, constants::GRAIN_COUNT, text::number, uncertainty::trend};
use crate::record::{RunRecord, left_out_in_words};

/// What the text leaves open and may move a settlement; said where ours misses.
const OPEN: &str = "The text leaves open what may explain it: how the table starts and stops, how \
                    the plate was laid on the gravel, the sieve curve and the funnel.";

/// Why the angle of rigid, angular grains lies above that of their friction coefficient.
const INTERLOCK: &str = "Rigid, angular grains interlock, so that a pile is steeper than the \
                         friction of their surfaces alone would make it; the paper takes the \
                         measured angle for the friction of the surfaces.";

pub(super) fn paragraph(
    study: &StudyView,
    counting: &StudyView,
    rows: &[ScoreRow],
    results: &ResultCounts,
) -> String {
    let mut sentences = Vec::new();
    if study.quick {
        sentences.push(format!(
            "This is the quick study, of {} grains instead of {GRAIN_COUNT}: it shows that everything \
             works, and compares nothing that depends on the full size.",
            study.grain_count
        ));
    }
    if study.runs.is_empty() {
        sentences.push("No run is finished yet; only what needs no run is shown.".to_owned());
        return sentences.join(" ");
    }
    let of = |verdict| rows.iter().filter(move |r| r.verdict == verdict && !r.is_undecided());
    let reproduced: Vec<String> =
        of(Verdict::Within).map(|r| format!("{} ({})", lower(r.statement), r.in_words)).collect();
    sentences.extend(said("Reproduced", &reproduced));
    let missed: Vec<String> = of(Verdict::Outside).map(missed).collect();
    sentences.extend(said("Not reproduced", &missed));
    let open: Vec<String> = rows.iter().filter(|r| r.is_undecided()).map(undecided).collect();
    sentences.extend(said("Not decided, as the interval reaches across the paper's range", &open));
    if !reproduced.is_empty() && missed.is_empty() && open.is_empty() {
        sentences.push("Nothing that could be compared is missed.".to_owned());
    }
    let outside = |row: &&ScoreRow| row.verdict == Verdict::Outside;
    sentences.extend(why(counting, rows.iter().filter(outside)));
    for (verdict, what) in [(Verdict::NotComparable, "Not compared"), (Verdict::NotRun, "Not run")]
    {
        sentences.extend(by_reason(what, of(verdict)));
    }
    sentences.push(standard(study));
    sentences.push(format!("{}.", results.in_words()));
    sentences.join(" ")
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

/// Ours beside the paper's where the runs are too few, or scatter too much, to say more.
fn undecided(row: &ScoreRow) -> String {
    format!("{} ({}; the paper's {})", lower(row.statement), row.in_words, row.paper)
}

fn missed(row: &ScoreRow) -> String {
    if row.paper == "all" {
        return format!("{} ({} only)", lower(row.statement), row.in_words);
    }
    let side = if row.beyond < 0.0 { "less" } else { "more" };
    format!("{} ({}, {side} than the paper's {})", lower(row.statement), row.in_words, row.paper)
}

/// Statements with the same reason, together.
fn by_reason<'a>(what: &str, rows: impl Iterator<Item = &'a ScoreRow>) -> Vec<String> {
    let mut groups: Vec<(&str, Vec<String>)> = Vec::new();
    for row in rows {
        let statement = lower(row.statement);
        match groups.iter_mut().find(|(reason, _)| *reason == row.reason) {
            Some((_, statements)) => statements.push(statement),
            None => groups.push((&row.reason, vec![statement])),
        }
    }
    let sentence = |(reason, statements): &(&str, Vec<String>)| {
        // "Not run" says itself that it was not run.
        let because = if reason.is_empty() || what.eq_ignore_ascii_case(reason) {
            String::new()
        } else {
            format!(" ({reason})")
        };
        format!("{what}: {}{because}.", statements.join("; "))
    };
    groups.iter().map(sentence).collect()
}

/// What the runs themselves say of the results that are missed, and what they cannot say.
fn why<'a>(counting: &StudyView, missed: impl Iterator<Item = &'a ScoreRow>) -> Vec<String> {
    let mut said = Vec::new();
    for row in missed {
        let sentence = match row.id {
            "standing-height-falls" => trend(counting).verdict,
            "continuous-final-settlement" => [at_rest(counting), Some(OPEN.to_owned())]
                .into_iter()
                .flatten()
                .collect::<Vec<_>>()
                .join(" "),
            "angle-of-repose" if row.beyond > 0.0 => INTERLOCK.to_owned(),
            "continuous-share-after-5-s" | "intermittent-share-in-first-period" => OPEN.to_owned(),
            _ => continue,
        };
        // Settlement and shares miss for the same want of knowledge, said once.
        let new = |s: &&str| !said.iter().any(|known: &String| known.contains(*s));
        if let Some(sentence) = Some(&*sentence).filter(new) {
            said.push(sentence.to_owned());
        }
    }
    said
}

/// How far numerical creep could have carried the specimens in the time of their vibration.
fn at_rest(counting: &StudyView) -> Option<String> {
    let sinks = |r: &RunRecord| {
        let (first, last) = r.summary.shaken_s()?;
        Some(1e-3 * r.summary.creep_um_per_s?.abs() * (last - first)).filter(|mm| mm.is_finite())
    };
    let vibrated = counting.runs.iter().filter(|r| r.kind.is_vibration());
    let most = vibrated.filter_map(sinks).reduce(f64::max)?;
    Some(format!(
        "Numerical creep accounts for at most {} mm of the settlement (rest tests).",
        number(most, 2)
    ))
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
        Some(said) => format!("{said}, being not valid or short of grains."),
    }
}
