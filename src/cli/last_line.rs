//! The last line of a command: whether its runs are valid and count in means.

use super::*;
use crate::record::{left_out_in_words, left_out_with_reasons};

/// How a last line begins that says of results that they are none to quote.
const WARNINGS: [&str; 2] = ["NOT VALID", "LEFT OUT OF MEANS"];

/// Whether a line is a last line that warns: also those read it who asked for no output.
pub(super) fn warns(line: &str) -> bool {
    let shown = paint::colourless(line);
    WARNINGS.iter().any(|words| shown.starts_with(words))
}

/// The last line of a run: why it is not valid or left out of means; nothing where it is neither.
pub(super) fn of_run(summary: &Summary) -> String {
    let why = summary.why_left_out();
    let head = match (why.is_empty(), summary.valid) {
        (true, _) => return String::new(),
        (false, true) => "LEFT OUT OF MEANS",
        (false, false) => "NOT VALID, no result to quote",
    };
    format!("{}: {}\n", paint::bad(head), why.join("; "))
}

/// The last line of several runs: whether they are valid, and why they are not.
pub(super) fn of_runs<'a>(runs: impl Iterator<Item = (&'a str, &'a Summary)>) -> String {
    const MOST: usize = 6;
    let all: Vec<(&str, &Summary)> = runs.collect();
    let against = left_out_with_reasons(all.iter().copied());
    if against.is_empty() {
        return match all.len() {
            0 => "no run has a result\n".to_owned(),
            n => format!("valid runs: {n} of {n}\n"),
        };
    }
    let more = against.len().saturating_sub(MOST);
    let more = if more > 0 { format!(" and {more} more") } else { String::new() };
    format!(
        "{}: {}{more}\n",
        paint::bad(format!(
            "NOT VALID or short of grains, left out of means: {} of {}",
            against.len(),
            counted(all.len(), "run")
        )),
        against[..against.len().min(MOST)].join(", ")
    )
}

/// The last line of a study: how many runs are left out of its means, and how many have a result.
pub(super) fn of_study((left_out, with_result): (usize, usize)) -> String {
    match left_out_in_words(left_out, with_result) {
        None => format!("valid runs: {with_result} of {with_result}\n"),
        Some(said) => format!("{}: {said}\n", paint::bad("NOT VALID or short of grains")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::record::{RunRecord, canned};

    /// Law: what is not valid warns, whatever its colour; what is valid does not.
    #[test]
    fn only_what_is_not_valid_warns() {
        assert!(warns(&format!("{}: the standard is missed", paint::bad("NOT VALID"))));
        assert!(warns("LEFT OUT OF MEANS: 3 grains are missing"));
        assert!(!warns("valid runs: 3 of 3") && !warns("results in NOT VALID"));
    }

    /// Law: the last line says of every command whether its runs are valid, and why not.
    #[test]
    fn last_lines_say_whether_runs_are_valid() {
        let plain = |text: String| paint::colourless(&text);
        let runs = canned::runs();
        let valid = canned::valid_runs();
        let all =
            |runs: &[RunRecord]| plain(of_runs(runs.iter().map(|r| (r.name.as_str(), &r.summary))));
        assert_eq!(all(&valid), "valid runs: 18 of 18\n");
        assert_eq!(all(&[]), "no run has a result\n");
        let said = all(&runs);
        let start =
            "NOT VALID or short of grains, left out of means: 6 of 18 runs: pluviation-fh00-c3 (";
        assert!(said.starts_with(start) && said.contains("standard is not met"), "law: {said}");
        let twice = [runs.clone(), runs.clone()].concat();
        assert!(all(&twice).trim_end().ends_with("and 6 more"), "law: short: {}", all(&twice));
        let of = |summary: &Summary| plain(of_run(summary));
        assert_eq!(of(&valid[0].summary), "", "law: nothing against it");
        assert!(of(&runs[17].summary).starts_with("NOT VALID, no result to quote: the accuracy"));
        let mut jammed = valid[0].summary.clone();
        jammed.grains.missing = Some(100);
        assert!(
            of(&jammed).starts_with("LEFT OUT OF MEANS: 100 of 1456 grains"),
            "{}",
            of(&jammed)
        );
        assert_eq!(plain(of_study((0, 4))), "valid runs: 4 of 4\n");
        let said = plain(of_study((1, 4)));
        assert!(said.ends_with("1 of 4 runs with a result is left out of means\n"), "{said}");
    }
}
