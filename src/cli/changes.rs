//! What options change in scenarios.

use std::fmt;
use std::str::FromStr;

use super::*;

/// Options of commands that run scenarios.
#[derive(Debug, Args)]
pub(super) struct Changes {
    /// Physics engine, in place of the scenario's: bullet or rapier
    #[arg(long, value_name = "B", value_parser = backend)]
    backend: Option<Backend>,
    /// Seed of the random streams, in place of the scenario's
    #[arg(long, value_name = "N", value_parser = whole(0, u64::MAX), allow_negative_numbers = true)]
    seed: Option<u64>,
    /// Change one value of the scenario (repeatable)
    #[arg(long, value_name = "path=value")]
    set: Vec<Override>,
}

/// The engine of a name, as in scenario files.
pub(super) fn backend(name: &str) -> Result<Backend, String> {
    serde_json::from_value(Value::from(name))
        .map_err(|_| "allowed are bullet and rapier".to_owned())
}

/// A reader of whole numbers from `low` to `high`, for an option.
pub(super) fn whole<N>(
    low: N,
    high: N,
) -> impl Fn(&str) -> Result<N, String> + Clone + Send + Sync + 'static
where
    N: FromStr + PartialOrd + fmt::Display + Copy + Send + Sync + 'static,
{
    move |text: &str| {
        let number = text.parse::<N>().ok().filter(|n| (low..=high).contains(n));
        number.ok_or_else(|| format!("allowed are whole numbers from {low} to {high}"))
    }
}

impl Changes {
    /// As changes of a scenario; `--set` has the last word.
    pub(super) fn overrides(&self) -> Vec<Override> {
        let backend = self.backend.and_then(|b| serde_json::to_value(b).ok());
        let backend = backend.map(|b| Override::new(&["engine", "backend"], b));
        let seed = self.seed.map(|n| Override::new(&["seed"], n.into()));
        backend.into_iter().chain(seed).chain(self.set.iter().cloned()).collect()
    }
}
