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
    #[command(flatten)]
    single: SetArgs,
}

/// The option of every command that loads a scenario.
#[derive(Debug, Args)]
pub(super) struct SetArgs {
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

/// A number of an option.
pub(super) fn number(text: &str) -> Result<f64, String> {
    let number = text.parse::<f64>().ok().filter(|n| n.is_finite());
    number.ok_or_else(|| "allowed are numbers, with a decimal point, as in 0.5".to_owned())
}

impl Changes {
    /// As changes of a scenario.
    ///
    /// # Errors
    /// Where several options change the same value.
    pub(super) fn overrides(&self) -> Result<Vec<Override>, CliError> {
        let set = self.single.overrides()?;
        let backend = self.backend.and_then(|b| serde_json::to_value(b).ok());
        let backend = backend.map(|b| ("--backend", Override::new(&["engine", "backend"], b)));
        let seed = self.seed.map(|n| ("--seed", Override::new(&["seed"], n.into())));
        let own: Vec<(&str, Override)> = backend.into_iter().chain(seed).collect();
        for (option, change) in &own {
            refuse_lost(option, change, set, "give one of them")?;
        }
        Ok(own.into_iter().map(|(_, change)| change).chain(set.iter().cloned()).collect())
    }
}

impl SetArgs {
    /// As changes of a scenario.
    ///
    /// # Errors
    /// Where several change the same value.
    pub(super) fn overrides(&self) -> Result<&[Override], CliError> {
        refuse_twice(&self.set)?;
        Ok(&self.set)
    }
}

/// Refuses changes of the same value, of which only the last would count, however its path is
/// written, and changes of a part of a value that a later one replaces as a whole.
fn refuse_twice(set: &[Override]) -> Result<(), CliError> {
    let numbered = set.iter().enumerate();
    let twice = numbered.filter_map(|(n, change)| {
        let earlier = set[..n].iter().find(|earlier| change.is_where(earlier))?;
        Some(format!("`{}` and `{}`", earlier.text(), change.text()))
    });
    let twice: Vec<String> = twice.collect();
    if !twice.is_empty() {
        return Err(CliError::Usage(format!(
            "--set changes the same value twice: {}; give each path one value",
            twice.join(", ")
        )));
    }
    let mut numbered = set.iter().enumerate();
    numbered.try_for_each(|(n, change)| {
        let typed = format!("--set {}", change.text());
        refuse_lost(&typed, change, &set[n + 1..], "give it after that")
    })
}

/// Refuses what was typed to make a change that one of the later changes undoes, with what to do
/// instead.
fn refuse_lost(
    typed: &str,
    change: &Override,
    later: &[Override],
    instead: &str,
) -> Result<(), CliError> {
    let undoes = |later: &&Override| change.is_where(later) || change.is_part_of(later);
    let Some(later) = later.iter().find(undoes) else { return Ok(()) };
    Err(CliError::Usage(format!(
        "{typed}: it would be lost, for --set {} replaces all of `{}`; {instead}",
        later.text(),
        later.path()
    )))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Law: a value is changed once, whatever its path looks like; what is refused is said with path
    /// and values. A value and another within it are two.
    #[test]
    fn a_value_that_is_set_twice_is_refused() {
        let said = |texts: &[&str]| {
            let set: Vec<Override> =
                texts.iter().map(|text| text.parse().expect("a change")).collect();
            refuse_twice(&set).err().map(|error| (error.exit_code(), error.to_string()))
        };
        for (texts, words) in [
            (
                &["engine.rate_hz=480", "seed=2", "engine.rate_hz=960"][..],
                "`engine.rate_hz=480` and `engine.rate_hz=960`",
            ),
            (&["stages[1].x=1", "stages.1.x=1"], "`stages[1].x=1` and `stages.1.x=1`"),
            (
                &["contact.restitution=0.2", "seed=2", "contact={}"],
                "--set contact.restitution=0.2: it would be lost, for --set contact={} replaces",
            ),
        ] {
            let (code, text) = said(texts).expect("law: refused");
            assert_eq!(code, 2, "law: exit code of {texts:?}, expected 2, got {code}");
            assert!(text.contains(words), "law: `{words}` is said of {texts:?}, got `{text}`");
        }
        for texts in [
            &["engine.rate_hz=480", "seed=2"][..],
            &["contact={}", "contact.restitution=0.2"],
            &["stages[1].x=1", "stages[2].x=1"],
            &[],
        ] {
            assert_eq!(said(texts), None, "law: {texts:?} are different values");
        }
    }

    /// Law: no option is lost to `--set`.
    #[test]
    fn a_value_that_another_option_gives_is_not_set() {
        let overrides = |set: &str| {
            let single = SetArgs { set: vec![set.parse().expect("a change")] };
            Changes { backend: Some(Backend::Bullet), seed: Some(3), single }.overrides()
        };
        for (set, words) in [
            ("seed=3", "--seed: it would be lost, for --set seed=3 replaces all of `seed`"),
            ("engine.backend=rapier", "--backend: it would be lost"),
            ("engine={}", "--backend: it would be lost"),
        ] {
            let said = overrides(set).expect_err("law: refused").to_string();
            assert!(said.contains(words), "law: `{words}` is said of {set}, got `{said}`");
        }
        let changes = overrides("engine.rate_hz=960").expect("law: three values");
        let texts: Vec<&str> = changes.iter().map(Override::text).collect();
        assert_eq!(texts, ["engine.backend=\"bullet\"", "seed=3", "engine.rate_hz=960"]);
    }
}
