//! The loosest and the densest state of grains in a laboratory's standard tests.

use super::*;

parts! {
/// Void ratios of the loosest and the densest state, as `pluvia density` or a laboratory finds
/// them. With them `summary.json` gives relative densities.
#[derive(Copy)]
pub struct IndexDensitiesSpec {
    /// Void ratio of the loosest state.
    pub e_max: f64, above 0.0 to 100.0;
    /// Void ratio of the densest state, less than that of the loosest.
    pub e_min: f64, above 0.0 to 100.0;
}
}

impl IndexDensitiesSpec {
    /// Relative density D_r = (e_max − e)/(e_max − e_min) of a void ratio: 0 of the loosest state,
    /// 1 of the densest.
    pub fn relative_density(&self, void_ratio: f64) -> f64 {
        (self.e_max - void_ratio) / (self.e_max - self.e_min)
    }

    /// What a reader should know of a void ratio of something that is looser than the loosest state
    /// or denser than the densest; none where it lies between.
    pub fn beyond(&self, of: &str, void_ratio: f64) -> Option<String> {
        let Self { e_max, e_min } = *self;
        let (than, limit) = match () {
            () if void_ratio > e_max => ("looser than the loosest state, e_max", e_max),
            () if void_ratio < e_min => ("denser than the densest state, e_min", e_min),
            () => return None,
        };
        let relative = self.relative_density(void_ratio);
        Some(format!(
            "relative density {relative:.2} of {of}: with a void ratio of {void_ratio:.3} it is {than} \
             {limit}; `index_densities` are void ratios of the same grains, and near walls grains lie \
             looser"
        ))
    }

    /// What of it makes no sense, in the JSON of a scenario.
    pub(super) fn check(value: &Value, faults: &mut Faults) {
        let Some(Ok(spec)) = value.get("index_densities").map(Self::deserialize) else { return };
        let Self { e_max, e_min } = spec;
        let allowed = format!("less than e_max, {e_max}");
        let why = "the densest state has less voids than the loosest";
        faults.add_if(e_min >= e_max, "index_densities.e_min", e_min, allowed, why);
    }
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::*;

    #[test]
    fn relative_density_goes_from_the_loosest_to_the_densest_state() {
        let of = IndexDensitiesSpec { e_max: 1.0, e_min: 0.6 };
        for (e, expected) in [(1.0, 0.0), (0.6, 1.0), (0.8, 0.5), (1.1, -0.25), (0.5, 1.25)] {
            let got = of.relative_density(e);
            assert!((got - expected).abs() < 1e-12, "law: e {e} is D_r {expected}, got {got}");
        }
    }

    /// Law: a state that no specimen of the grains has is reported with what it is beyond.
    #[test]
    fn a_void_ratio_beyond_both_states_is_reported() {
        let of = IndexDensitiesSpec { e_max: 1.0, e_min: 0.6 };
        for e in [0.6, 0.8, 1.0] {
            assert_eq!(of.beyond("the specimen", e), None, "law: e {e} lies between");
        }
        for (e, words) in [(1.2, "looser than the loosest state, e_max 1;"), (0.5, "e_min 0.6;")] {
            let told = of.beyond("`core`", e).expect("law: it is reported");
            assert!(told.contains(words) && told.contains("`core`"), "law: {words}, got `{told}`");
        }
        // Percentages of porosity in place of void ratios.
        let percent = IndexDensitiesSpec { e_max: 49.0, e_min: 38.0 };
        let told = percent.beyond("the specimen", 0.8).expect("law: it is reported");
        assert!(told.starts_with("relative density 4.38 of the specimen"), "got `{told}`");
    }

    #[test]
    fn a_densest_state_that_is_the_looser_one_is_a_fault() {
        let faults_of = |e_max: f64, e_min: f64| {
            let mut faults = Vec::new();
            let value = json!({ "index_densities": { "e_max": e_max, "e_min": e_min } });
            IndexDensitiesSpec::check(&value, &mut Faults::of(&mut faults));
            faults.iter().map(ToString::to_string).collect::<Vec<_>>()
        };
        assert!(faults_of(1.0, 0.6).is_empty(), "law: denser is less void");
        let told = faults_of(0.6, 0.6);
        assert_eq!(told.len(), 1, "law: equal states are a fault: {told:?}");
        assert!(told[0].contains("index_densities.e_min"), "law: it is named: {told:?}");
        let mut none = Vec::new();
        IndexDensitiesSpec::check(&json!({}), &mut Faults::of(&mut none));
        assert!(none.is_empty(), "law: they may be left out");
    }
}
