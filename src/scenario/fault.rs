//! What can be wrong with a scenario, said so that it can be fixed.

use std::borrow::Cow;
use std::fmt::{self, Display};
use std::io;

use strsim::levenshtein;

use super::*;
use crate::input::Refusal;
use crate::plain::plain;

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

impl Fault {
    /// What is wrong, what was found and what is allowed, of a place that is not known here.
    pub fn new(
        message: impl Into<String>,
        found: impl ToString,
        allowed: impl Into<String>,
    ) -> Self {
        let (found, allowed, message) = (found.to_string(), allowed.into(), message.into());
        Self { found, allowed, message, ..Self::default() }
    }

    /// The same at a path.
    pub fn at(self, path: impl Into<String>) -> Self {
        Self { path: path.into(), ..self }
    }

    /// The same in a file, or by an override.
    pub fn of(self, file: impl ToString) -> Self {
        Self { file: file.to_string(), ..self }
    }

    /// Of a file that is refused because of what it is.
    pub fn refused(file: &Path, refusal: &Refusal, by: &str) -> Self {
        Self::new(format!("the file cannot be read: {refusal}{by}"), "", "").of(file.display())
    }
}

impl fmt::Display for Fault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
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
        f.write_str(&plain(&line))
    }
}

/// A value that its type does not take, though it fits the schema.
pub(super) fn unusable(
    error: &serde_path_to_error::Error<serde_json::Error>,
    allowed: impl Into<String>,
) -> Fault {
    let message = format!("the value cannot be used: {}", error.inner());
    Fault::new(message, "", allowed).at(error.path().to_string())
}

/// Notes the faults of a part of a scenario, each below the place of that part; the file is not
/// known there.
pub(super) struct Faults<'a> {
    place: String,
    found: &'a mut Vec<Fault>,
}

impl<'a> Faults<'a> {
    /// Those of a whole scenario.
    pub fn of(found: &'a mut Vec<Fault>) -> Self {
        Self { place: String::new(), found }
    }

    /// Those of a part, as `stages[1]`.
    pub fn at(&mut self, place: impl Display) -> Faults<'_> {
        Faults { place: field_path(&self.place, &place.to_string()), found: self.found }
    }

    /// A field at fault: what was found, what is allowed, what is wrong.
    pub fn add(
        &mut self,
        field: &str,
        found: impl ToString,
        allowed: impl Into<String>,
        message: impl Into<String>,
    ) {
        self.found.push(Fault::new(message, found, allowed).at(field_path(&self.place, field)));
    }

    /// The same where something is wrong.
    pub fn add_if(
        &mut self,
        is_wrong: bool,
        field: &str,
        found: impl ToString,
        allowed: impl Into<String>,
        message: impl Into<String>,
    ) {
        if is_wrong {
            self.add(field, found, allowed, message);
        }
    }

    /// Whether one is noted at a path.
    pub fn has(&self, path: &str) -> bool {
        self.found.iter().any(|fault| fault.path == path)
    }

    /// A field that means nothing there, where it is given.
    pub fn idle(&mut self, field: &str, found: Option<impl ToString>, why: impl Into<String>) {
        if let Some(found) = found {
            self.add(field, found, "the field left out", why);
        }
    }

    /// Numbers of a vector that must have a length: a direction, a velocity.
    pub fn not_zero(&mut self, field: &str, numbers: impl AsRef<[f64]>, why: &str) {
        let numbers = numbers.as_ref();
        let allowed = match numbers.iter().all(|x| *x == 0.0) {
            true => "numbers that are not all 0",
            false => "numbers that are not all 0, and whose squares a computer can hold",
        };
        self.add_if(!has_length(numbers), field, format!("{numbers:?}"), allowed, why);
    }
}

/// Whether the length of a vector is known: its square is neither 0 nor rounded away, and finite.
pub(super) fn has_length(numbers: &[f64]) -> bool {
    numbers.iter().map(|x| x * x).sum::<f64>().is_normal()
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
    /// A file that was not read: a fault where it is refused because of what it is. `by`
    /// says who asked for it, or is empty.
    pub(super) fn unread(file: &Path, error: &io::Error, by: &str) -> Self {
        match Refusal::within(error) {
            Some(refusal) => Self::Faults(vec![Fault::refused(file, refusal, by)]),
            None => Self::Unreadable { file: file.to_owned(), reason: format!("{error}{by}") },
        }
    }

    /// The faults; none where a file could not be read.
    pub fn faults(&self) -> &[Fault] {
        match self {
            Self::Unreadable { .. } => &[],
            Self::Faults(faults) => faults,
        }
    }

    /// The same with each of its faults changed.
    #[must_use]
    pub fn each(self, change: impl FnMut(Fault) -> Fault) -> Self {
        match self {
            Self::Faults(faults) => Self::Faults(faults.into_iter().map(change).collect()),
            unreadable => unreadable,
        }
    }
}

impl fmt::Display for ScenarioErrors {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Unreadable { file, reason } => {
                f.write_str(&plain(&format!("cannot read {}: {reason}", file.display())))
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
/// a third of its letters, and at least one, may differ. Or the only entry of whose words
/// it is some in a row, as `diameter_mm` of `inner_diameter_mm`.
pub fn nearest<'a>(word: &str, known: impl IntoIterator<Item = &'a str>) -> Option<&'a str> {
    let known: Vec<&str> = known.into_iter().collect();
    let (distance, best) = known.iter().map(|k| (levenshtein(word, k), *k)).min()?;
    if distance <= (word.chars().count() / 3).max(1) {
        return Some(best);
    }
    let part = format!("_{word}_");
    let mut whole = known.into_iter().filter(|known| {
        let words = format!("_{}_", known.replace('.', "_"));
        !word.is_empty() && words.contains(&part)
    });
    whole.next().filter(|_| whole.next().is_none())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_near_spellings_are_suggested() {
        let known = ["rate_hz", "iterations", "length_scale"];
        assert_eq!(nearest("iteration", known), Some("iterations"));
        assert_eq!(nearest("rate_Hz", known), Some("rate_hz"));
        assert_eq!(nearest("colour", known), None);
        assert_eq!(nearest("rate", known), Some("rate_hz"), "a unit is left out");
        assert_eq!(nearest("length", known), Some("length_scale"));
        assert_eq!(nearest("hz", known), Some("rate_hz"));
        assert_eq!(nearest("scal", known), None, "half a word");
        assert_eq!(nearest("", known), None);
        let two = ["inner_diameter_mm", "top_diameter_mm", "height_mm"];
        assert_eq!(nearest("diameter_mm", two), None, "which of them is not known");
        assert_eq!(nearest("diameter_mm", two[1..].iter().copied()), Some("top_diameter_mm"));
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

    /// Law: a direction is one whose length can be computed: neither 0, nor squares that are.
    #[test]
    fn directions_have_a_length() {
        for (direction, expected) in [
            ([0.0, 0.0, -1.0], true),
            ([1e-100, 0.0, 0.0], true),
            ([0.0, 1e150, -1e150], true),
            ([0.0, 0.0, -0.0], false),
            ([0.0, 1e-200, 0.0], false),
            ([0.0, 1e-160, 0.0], false),
            ([1e200, 0.0, 0.0], false),
        ] {
            let mut found = Vec::new();
            Faults::of(&mut found).not_zero("direction", direction, "it has no direction");
            let got = found.is_empty();
            assert_eq!(got, expected, "law: whether {direction:?} has a length, got {found:?}");
        }
    }
}
