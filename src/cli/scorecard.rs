//! The scorecard of `pluvia reproduce` on a terminal: what is reproduced and why not, which ends with
//! the tally, the rows, and how they were judged.

use super::*;
use crate::in_order::grouped;
use crate::paper::{Scorecard, Verdict};

/// Columns that a line of words takes at most.
const WIDTH: usize = 96;

/// The words, the rows and their notes.
pub(super) fn of(card: &Scorecard) -> String {
    let mut rows = vec![["statement", "paper", "ours", "verdict"].map(str::to_owned)];
    for row in &card.rows {
        let left_out = match row.left_out {
            0 => String::new(),
            n => format!(" (left out: {n})"),
        };
        rows.push([
            row.statement.to_owned(),
            row.paper.clone(),
            format!("{}{left_out}", row.in_words),
            row.stands().map_or_else(|| paint::notable("not decided"), verdict),
        ]);
    }
    let words: String = card.paragraph.lines().chain(card.reasons.lines()).map(wrapped).collect();
    words + "\n" + &table::columns(&rows) + &notes(card)
}

/// How rows were judged, those together that say the same.
fn notes(card: &Scorecard) -> String {
    let noted = card.rows.iter().filter(|row| !row.note.is_empty());
    let said = grouped(noted.map(|row| (&row.note, row.statement)));
    let lines = said.iter().map(|(note, of)| wrapped(&format!("{}: {note}", of.join("; "))));
    let lines: String = lines.collect();
    if lines.is_empty() { lines } else { format!("\n{lines}") }
}

fn verdict(of: Verdict) -> String {
    match of {
        Verdict::Within => paint::good("within"),
        Verdict::Outside => paint::bad("outside"),
        Verdict::NotStated => paint::faint("not stated"),
        Verdict::NotRun => paint::notable("not run"),
        Verdict::NotComparable => paint::faint("not comparable"),
    }
}

/// A text in lines; a word longer than a line has one to itself.
fn wrapped(text: &str) -> String {
    let mut lines = vec![String::new()];
    for word in text.split(' ') {
        let line = lines.last().map_or(0, |l| paint::width(l));
        if line > 0 && line + 1 + paint::width(word) > WIDTH {
            lines.push(String::new());
        }
        if let Some(line) = lines.last_mut() {
            if !line.is_empty() {
                line.push(' ');
            }
            line.push_str(word);
        }
    }
    lines.iter().map(|line| format!("{line}\n")).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::paper::{StudyView, canned, claims, scorecard};

    fn shown(study: &StudyView) -> String {
        paint::colourless(&of(&scorecard(study, &claims(study))))
    }

    /// Law: first the words, which end with the tally of rows, then the rows, then the notes.
    #[test]
    fn the_terminal_has_words_with_tally_and_scorecard() {
        let runs = canned::valid_runs();
        let text = shown(&canned::study(&runs));
        let place = |what: &str| text.find(what).unwrap_or_else(|| panic!("no `{what}` in {text}"));
        assert_eq!(place("Reproduced: "), 0, "law: the words are first");
        assert!(place("Reproduced: ") < place("statement  "), "law: {text}");
        let (above, rows) = text.split_at(place("statement  "));
        let words = above.split_whitespace().collect::<Vec<_>>().join(" ");
        let tally = "7 rows: 4 within, 1 outside, 1 not decided, 1 not stated.";
        assert!(words.ends_with(tally), "law: rows are counted, got {words}");
        assert!(!rows.contains("7 rows"), "law: said once, got {rows}");
        let note = "its interval reaches across 14 and 19.61 mm.";
        let words = rows.split_whitespace().collect::<Vec<_>>().join(" ");
        assert!(words.contains(note), "law: why it is not decided, got {rows}");
        let row = text.lines().find(|l| l.starts_with("Settlement of the plate after 20 s"));
        let row = row.expect("a row");
        assert!(row.contains("  14 to 19.61 mm  18.0 mm [13.0 … 23.0]  "), "got {row}");
        assert!(row.ends_with("  not decided"), "law: 13 to 23 holds 14 and 19.61, got {row}");
        assert!(!row.contains("within"), "law: no verdict beside it, got {row}");
        assert!(text.lines().all(|l| paint::width(l) <= 160), "law: lines are short:\n{text}");
    }

    /// Law: a newcomer's first screen, of the quick study, has nothing outside for its size.
    #[test]
    fn the_quick_study_is_not_outside() {
        let runs = canned::valid_runs();
        let study = StudyView { quick: true, grain_count: 364, ..canned::study(&runs) };
        let text = shown(&study);
        assert!(!text.contains("  outside"), "law: {text}");
        assert!(text.contains("not comparable") && text.contains("0 outside"), "law: {text}");
        // The third configuration is left out, and counted.
        let spoilt = canned::runs();
        let text = shown(&canned::study(&spoilt));
        assert!(text.contains("(left out: 1)"), "law: {text}");
    }

    #[test]
    fn paragraphs_are_wrapped_between_words() {
        let words = "abcdefghi ".repeat(30);
        let text = wrapped(words.trim_end());
        assert!(text.lines().all(|l| l.len() <= WIDTH && !l.starts_with(' ')), "{text}");
        assert_eq!(text.split_whitespace().count(), 30, "law: no word is lost");
        let long = "x".repeat(200);
        assert_eq!(wrapped(&long), format!("{long}\n"), "law: one word, one line");
    }
}
