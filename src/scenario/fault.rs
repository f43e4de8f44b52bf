//! What can be wrong with a scenario, said so that it can be mended.

use std::{borrow::Cow, fmt, path::PathBuf};

/// One fault of a scenario.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Fault {
    /// The file that holds the value, or the `--set` that gave it.
    pub file: String,
    /// Dotted path of the value in the file, `grains.sieve_table[1].passing_mm`;
    /// line and column where the text is no JSON; empty for the file as a whole.
    pub path: String,
    /// The value found there, as JSON; empty where nothing was found.
    pub found: String,
    /// What is allowed there, in plain words.
    pub allowed: String,
    /// What is wrong.
    pub message: String,
}

/// Whether a character is not seen but changes what is: one that controls a
/// terminal, begins another line, or turns the direction of what follows
/// (Unicode's `Bidi_Control`), so that a name reads as another.
pub(super) fn misleads(c: char) -> bool {
    c.is_control()
        || matches!(c, '\u{61c}' | '\u{200e}' | '\u{200f}' | '\u{2028}'..='\u{202e}' | '\u{2066}'..='\u{2069}')
}

/// A text with every character that misleads by its code point.
fn plain(text: &str) -> Cow<'_, str> {
    if !text.contains(misleads) {
        return Cow::Borrowed(text);
    }
    let mut plain = String::with_capacity(text.len());
    for c in text.chars() {
        if misleads(c) {
            plain += &format!("\\u{:04x}", u32::from(c));
        } else {
            plain.push(c);
        }
    }
    Cow::Owned(plain)
}

impl fmt::Display for Fault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&plain(&self.as_line()))
    }
}

impl Fault {
    fn as_line(&self) -> String {
        let mut line = String::new();
        for place in [&self.file, &self.path] {
            if !place.is_empty() {
                line += &format!("{}: ", shortened(place));
            }
        }
        line += &self.message;
        line += &match (self.found.is_empty(), self.allowed.is_empty()) {
            (true, true) => String::new(),
            (false, true) => format!(" (found {})", self.found),
            (true, false) => format!(" (allowed: {})", self.allowed),
            (false, false) => format!(" (found {}; allowed: {})", self.found, self.allowed),
        };
        line
    }
}

/// Longest place that is written out, in characters.
const LONGEST_PLACE: usize = 400;

/// Most faults that are written out.
const MOST_FAULTS: usize = 100;

/// A place without its middle, where nobody would read it all.
fn shortened(place: &str) -> Cow<'_, str> {
    let count = place.chars().count();
    if count <= LONGEST_PLACE {
        return Cow::Borrowed(place);
    }
    let begin: String = place.chars().take(LONGEST_PLACE / 2).collect();
    let end: String = place.chars().skip(count - LONGEST_PLACE / 4).collect();
    Cow::Owned(format!("{begin}…{end}"))
}

/// Why a scenario was not accepted.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum ScenarioErrors {
    /// A file could not be read.
    Unreadable {
        /// The file.
        file: PathBuf,
        /// What the system said, and who asked for the file.
        reason: String,
    },
    /// The files were read; these are all faults found in them, at least one.
    Faults(Vec<Fault>),
}

impl ScenarioErrors {
    /// The faults; none where a file could not be read.
    pub fn faults(&self) -> &[Fault] {
        match self {
            Self::Unreadable { .. } => &[],
            Self::Faults(faults) => faults,
        }
    }
}

impl fmt::Display for ScenarioErrors {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Unreadable { file, reason } => {
                let line = format!("cannot read {}: {reason}", file.display());
                f.write_str(&plain(&line))
            }
            Self::Faults(faults) if faults.len() == 1 => faults[0].fmt(f),
            Self::Faults(faults) => {
                write!(f, "{} faults", faults.len())?;
                faults.iter().take(MOST_FAULTS).try_for_each(|fault| write!(f, "\n  {fault}"))?;
                match faults.len().checked_sub(MOST_FAULTS) {
                    Some(more @ 1..) => write!(f, "\n  … and {more} more"),
                    _ => Ok(()),
                }
            }
        }
    }
}

impl std::error::Error for ScenarioErrors {}

/// The entry of `known` that `word` is most likely a misspelling of: at most
/// a third of its letters, and at least one, may differ.
pub(super) fn nearest<'a>(word: &str, known: &[&'a str]) -> Option<&'a str> {
    let (distance, best) = known.iter().map(|k| (edit_distance(word, k), *k)).min()?;
    (distance <= (word.chars().count() / 3).max(1)).then_some(best)
}

/// Number of letters to insert, delete or replace to turn one word into the other (Levenshtein).
fn edit_distance(a: &str, b: &str) -> usize {
    let b: Vec<char> = b.chars().collect();
    let mut row: Vec<usize> = (0..=b.len()).collect();
    for (i, x) in a.chars().enumerate() {
        let mut diagonal = row[0];
        row[0] = i + 1;
        for (j, &y) in b.iter().enumerate() {
            let replaced = diagonal + usize::from(x != y);
            diagonal = row[j + 1];
            row[j + 1] = replaced.min(diagonal + 1).min(row[j] + 1);
        }
    }
    row[b.len()]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn edit_distances() {
        for (a, b, expected) in
            [("", "abc", 3), ("kitten", "sitting", 3), ("rate_hz", "rate_hz", 0), ("ab", "ba", 2)]
        {
            let got = edit_distance(a, b);
            assert_eq!(got, expected, "law: edits from {a:?} to {b:?} are {expected}, got {got}");
        }
    }

    #[test]
    fn only_near_spellings_are_suggested() {
        let known = ["rate_hz", "iterations", "length_scale"];
        assert_eq!(nearest("iteration", &known), Some("iterations"));
        assert_eq!(nearest("rate_Hz", &known), Some("rate_hz"));
        assert_eq!(nearest("colour", &known), None);
    }

    #[test]
    fn what_misleads_is_shown_by_its_code_point() {
        for (text, expected) in [
            ("gravel 8\u{2013}16 mm, \u{540d}\u{524d} \u{1f327}", None),
            ("a\u{200d}b", None), // joins letters, and is part of many a sign
            ("a\u{7}b", Some("a\\u0007b")),
            ("a\u{85}b", Some("a\\u0085b")),
            ("a\u{202e}b", Some("a\\u202eb")),
            ("\u{2066}a\u{2069}", Some("\\u2066a\\u2069")),
            ("a\u{200f}\u{61c}\u{2028}", Some("a\\u200f\\u061c\\u2028")),
        ] {
            let expected = expected.unwrap_or(text);
            assert_eq!(plain(text), expected, "law: only what misleads is shown otherwise");
        }
    }

    #[test]
    fn faults_read_as_one_line() {
        let fault = Fault {
            file: "a.json".into(),
            path: "engine.rate_hz".into(),
            found: "-1".into(),
            allowed: "a number of at least 30".into(),
            message: "the value is out of range".into(),
        };
        let expected = "a.json: engine.rate_hz: the value is out of range (found -1; allowed: a number of at \
             least 30)";
        assert_eq!(fault.to_string(), expected);
        let two = ScenarioErrors::Faults(vec![fault.clone(), fault]).to_string();
        assert_eq!(two.lines().count(), 3, "a heading and one line a fault, got {two}");
    }
}
