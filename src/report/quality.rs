//! How good a run is as a simulation, whatever it shows.

use serde::Serialize;

use crate::record::{NO_VALID_RUN, RunRecord, left_out_in_words};

/// The accuracy standard (`docs/accuracy.md`): what a run must stay below.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Standard {
    /// Mean overlap in percent of the equivalent diameter.
    pub overlap_mean_percent: f64,
    /// 99th percentile of the overlap in percent of the equivalent diameter.
    pub overlap_p99_percent: f64,
    /// Numerical creep in the rest test in µm/s, up or down.
    pub creep_um_per_s: f64,
}

/// What does not count of the runs behind a number.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub(crate) struct LeftOut {
    /// How many runs do not count.
    pub(crate) runs: usize,
    /// Whether none counts, so that the number is theirs.
    pub(crate) all: bool,
}

/// Of runs those that count in means; where none does, all of them, which are then to be
/// marked: valid runs and others never stand in one mean.
pub(crate) fn never_mixed<'a>(
    runs: impl Iterator<Item = &'a RunRecord>,
) -> (Vec<&'a RunRecord>, LeftOut) {
    let (counting, others): (Vec<_>, Vec<_>) = runs.partition(|r| r.counts_in_means());
    let left_out = LeftOut { runs: others.len(), all: counting.is_empty() && !others.is_empty() };
    (if left_out.all { others } else { counting }, left_out)
}

/// What was found of the runs that count, followed by how many runs do not count and are left out
/// of means and of `these`; where nothing was found, why.
pub(crate) fn found_in(
    runs: &[&RunRecord],
    found: Option<String>,
    these: &str,
    without_runs: &str,
) -> String {
    let left_out = runs.iter().filter(|r| !r.counts_in_means()).count();
    let end = format!(" and from {these}, each for the reason in the table of runs");
    match found {
        Some(found) => found + &sentence_of_left_out(left_out, runs.len(), &end),
        None if runs.is_empty() => without_runs.to_owned(),
        None if left_out == runs.len() => format!("There is {NO_VALID_RUN}."),
        None => "No run that counts has a value.".to_owned(),
    }
}

/// That runs are left out of means, as another sentence with how it ends; nothing where none is.
pub(crate) fn sentence_of_left_out(left_out: usize, of: usize, end: &str) -> String {
    left_out_in_words(left_out, of).map_or(String::new(), |said| format!(" {said}{end}."))
}
