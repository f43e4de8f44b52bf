//! Refuses studies that would count one specimen several times, as if it were independent
//! realisations: of a scenario that begins with a specimen and draws nothing at random itself, or of
//! variations that share runs.

use super::*;

/// How a study is asked for several realisations.
#[derive(Clone, Copy)]
pub(super) struct Asked {
    /// The option that says how many.
    option: &'static str,
    /// What to do where there is only one.
    instead: &'static str,
}

/// Of a study that may take one.
pub(super) const CONFIGURATIONS: Asked = Asked {
    option: "--configurations",
    instead: "take one, or begin with several specimens, which a sweep takes for realisations: \
              --over begin.specimen=RUN1,RUN2",
};

/// Of a calibration, which needs scatter.
pub(super) const REALISATIONS: Asked = Asked {
    option: "--realisations",
    instead: "a calibration needs scatter: let the scenario make its own specimen, without `begin`",
};

/// Refuses several realisations of a variation that has but one, and a seed or a configuration
/// that changes nothing: equal results would be taken for independent ones.
///
/// # Errors
/// [`StudyError::Scenario`] with what was asked, why it is refused, and what to do.
pub(super) fn refuse_repeats(
    varied: &Varied,
    Asked { option, instead }: Asked,
    count: u32,
) -> Result<(), StudyError> {
    for (variation, scenario) in varied.all.iter().filter(|(_, s)| !s.has_realisations()) {
        let mut changed = variation.changes.iter().map(Override::path);
        let of_chance = changed.find(|path| Scenario::names_realisations(path));
        let most = variation.configurations.map_or(count, |most| most.min(count));
        let asked = match of_chance {
            Some(path) => format!("`{path}` cannot be varied"),
            None if most > 1 => format!("{option} {most} cannot be taken"),
            None => continue,
        };
        return refused(format!(
            "{asked}: `{}` begins with one specimen, and none of its own stages draws anything at \
             random, so that every realisation is the same run; {instead}",
            scenario.name
        ));
    }
    Ok(())
}

/// Refuses variations that differ in their configuration alone, by less than the number of
/// realisations, which count up from there: their pairs would share runs.
///
/// # Errors
/// [`StudyError::Scenario`] with both variations, and what is allowed.
pub(super) fn refuse_shared(varied: &Varied, count: u32) -> Result<(), StudyError> {
    let otherwise = |of: &Scenario| Scenario { configuration: 1, ..of.clone() };
    let is_moved = |variation: &Variation| {
        variation.changes.iter().any(|change| change.path() == "configuration")
    };
    let taken = |variation: &Variation, scenario: &Scenario| {
        let most = variation.configurations.map_or(count, |most| most.min(count));
        scenario.configuration..scenario.configuration.saturating_add(most)
    };
    for (variation, scenario) in varied.all.iter().filter(|(variation, _)| is_moved(variation)) {
        let own = taken(variation, scenario);
        let shares = |other: &Variation, of: &Scenario| {
            let others = taken(other, of);
            own.start != others.start
                && own.start < others.end
                && others.start < own.end
                && otherwise(scenario) == otherwise(of)
        };
        if let Some((other, of)) = varied.all.iter().find(|(other, of)| shares(other, of)) {
            return refused(format!(
                "--configurations {count} cannot be taken: `{}` begins with configuration {} and \
                 `{}` with {}, so that some runs would belong to both (allowed: values of \
                 `configuration` at least {count} apart)",
                variation.name, scenario.configuration, other.name, of.configuration
            ));
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use serde_json::{Value, json};

    use super::*;
    use crate::scenario::Scenario;
    use crate::study::variations::Variation;

    fn scenario(begins: bool, stage: &Value) -> Scenario {
        let mut value = json!({ "name": "s", "grains": { "file": "g.json" }, "stages": [stage] });
        if begins {
            value["begin"] = json!({ "specimen": "out/first" });
        }
        serde_json::from_value(value).expect("a scenario")
    }

    /// One variation with a change, at most so often.
    fn varied(scenario: &Scenario, change: &str, most: Option<u32>) -> Varied {
        let changes = vec![change.parse().expect("a change")];
        let variation =
            Variation { configurations: most, ..Variation::new("point-0001", "sweep", changes) };
        Varied { base: scenario.clone(), all: vec![(variation, scenario.clone())] }
    }

    /// Law: what is the same run again is refused, whether it is asked for by number, seed or
    /// configuration; what draws, or is done once, is not.
    #[test]
    fn the_same_run_is_not_taken_for_realisations() {
        let rest = json!({ "stage": "rest", "duration_s": 1 });
        let plate = json!({ "stage": "place_top_plate", "placement": 2 });
        let friction = "contact.restitution=0.2";
        let refused = |of: &Scenario, change: &str, most: Option<u32>, asked, count| {
            let refused = refuse_repeats(&varied(of, change, most), asked, count).err();
            refused.map_or(String::new(), |error| error.to_string())
        };
        let begun = scenario(true, &rest);
        for (change, asked, count, words) in [
            (friction, CONFIGURATIONS, 3, "--configurations 3 cannot be taken"),
            (friction, REALISATIONS, 5, "a calibration needs scatter"),
            ("seed=2", CONFIGURATIONS, 1, "`seed` cannot be varied"),
            ("configuration=2", CONFIGURATIONS, 1, "`configuration` cannot be varied"),
        ] {
            let said = refused(&begun, change, None, asked, count);
            assert!(
                said.contains(words) && said.contains("`s` begins"),
                "law: {words}, got {said}"
            );
        }
        let configurations = |of: &Scenario, change: &str, most, count| {
            refused(of, change, most, CONFIGURATIONS, count)
        };
        assert_eq!(configurations(&begun, friction, None, 1), "", "law: one run is one");
        assert_eq!(configurations(&begun, friction, Some(1), 3), "", "law: its ladder takes one");
        for draws in [scenario(true, &plate), scenario(false, &rest)] {
            for change in [friction, "seed=2"] {
                assert_eq!(configurations(&draws, change, None, 3), "", "law: each is another");
            }
        }
    }
    /// Law: realisations of two variations share no run; those that are the same runs anyhow, or
    /// differ in more than their configuration, are free.
    #[test]
    fn variations_share_no_realisation() {
        let base = scenario(false, &json!({ "stage": "rest", "duration_s": 1 }));
        let of = |name: &str, configuration: u32, seed: u64| {
            let change = format!("configuration={configuration}").parse().expect("a change");
            let scenario = Scenario { configuration, seed, ..base.clone() };
            (Variation::new(name, "group", vec![change]), scenario)
        };
        let said = |all: &[(Variation, Scenario)], count| {
            let varied = Varied { base: base.clone(), all: all.to_vec() };
            refuse_shared(&varied, count).err().map_or(String::new(), |error| error.to_string())
        };
        let near = [of("default", 1, 1), of("order-high", 3, 1)];
        let got = said(&near, 3);
        for words in ["--configurations 3", "`order-high`", "`default`", "at least 3 apart"] {
            assert!(got.contains(words), "law: `{words}` is said, got `{got}`");
        }
        assert_eq!(said(&near, 2), "", "law: 1 and 2, 3 and 4 share none");
        let mut few = near.clone();
        few[0].0.configurations = Some(2);
        assert_eq!(said(&few, 3), "", "law: 1 and 2 alone, where no more are taken");
        few[1].0.configurations = Some(1);
        few[0].0.configurations = None;
        assert!(!said(&few, 3).is_empty(), "law: 3 is in 1 to 3");
        let free = [of("default", 1, 1), of("again", 1, 1), of("seed-high", 2, 2)];
        assert_eq!(said(&free, 3), "", "law: the same runs, and other grains");
    }
}
