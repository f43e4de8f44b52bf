//! What a study is: the one description that every command of many runs gives of itself.
//!
//! A function reads and checks all that is asked, so that faults in fields are reported before a
//! file is written, and gives a [`Study`]: its question, its scenarios, and what it concludes from
//! its runs. Where all of them have the same grains, it makes these and the plan as well;
//! variations make theirs when they are carried out. For runs it asks by `run::carry_out` (all or
//! none), by `run::carry_out_each` (one that fails has a reason in place of results), or, of
//! variations of a scenario, by the functions of `variations` (one that fails is a row that says
//! so).

use super::*;

/// The part of a question that may grow: what it lists may become more, and its numbers larger.
pub const AT_LEAST: &str = "at_least";

/// The part of a question that may be another once nobody is at work any more: of commands whose
/// answers stand side by side there, or replace pages and tables that the same question brings back
/// from the stored stages.
pub const MEANWHILE: &str = "meanwhile";

/// Fields of a scenario for the reader alone, which are no part of a question.
pub const WORDS: [&str; 2] = ["description", "notes"];

/// What makes findings of runs.
type Conclude<T> = Box<dyn FnOnce(&RunOptions) -> Result<T, StudyError>>;

/// A study that was read and checked; nothing is run and no file is written yet.
pub struct Study<T> {
    /// The command that carries it out.
    pub command: &'static str,
    /// What its results answer: a folder that holds some is taken for the same question alone. What
    /// stands there under [`AT_LEAST`] was no more than this, what stands under [`MEANWHILE`] may
    /// differ once nobody is at work there, all else is equal; null for a study that compares by
    /// itself.
    pub question: Value,
    /// The scenarios whose warnings are reported before anything runs.
    pub scenarios: Vec<Scenario>,
    /// Asks for its runs, writes its files and gives what it found.
    pub conclude: Conclude<T>,
}

impl<T> Study<T> {
    /// Carries it out, from its warnings to its files. Finished stages in the folder are reused.
    ///
    /// # Errors
    /// [`StudyError`]. A failed run is an error only where the study needs all of its runs.
    pub fn carry_out(self, run: &RunOptions) -> Result<T, StudyError> {
        tell_warnings(&self.scenarios, run.progress.as_ref());
        (self.conclude)(run)
    }
}

/// A scenario as part of a question.
pub(super) fn in_question(scenario: &Scenario) -> Value {
    let mut value = serde_json::to_value(scenario).unwrap_or_default();
    if let Some(fields) = value.as_object_mut() {
        WORDS.iter().for_each(|word| drop(fields.remove(*word)));
    }
    value
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::study::tests::bare_scenario;

    /// Law: other words for the reader are no other question, another name is one.
    #[test]
    fn words_are_no_part_of_a_question() {
        let own = bare_scenario();
        let told = Scenario { description: "in other words".into(), ..own.clone() };
        assert_eq!(in_question(&own), in_question(&told), "law: words change no result");
        let other = Scenario { name: "other".into(), ..own.clone() };
        assert_ne!(in_question(&own), in_question(&other), "law: the scenario is asked for");
    }
}
