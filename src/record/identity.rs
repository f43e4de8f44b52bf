//! What a stage is, as it says itself: so that none is taken for another.

use super::*;

/// Letters of a key in messages.
const SHOWN: usize = 12;

/// What a stage is: of which grains, after which stage, and everything else
/// that determines its result.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct StageIdentity {
    /// Name in the store: SHA-256 of `determined_by` as JSON in one line.
    pub key: String,
    /// Name of the stage as in the scenario.
    pub stage: String,
    /// Number of grains.
    pub grains: usize,
    /// SHA-256 of the grains.
    pub grains_sha256: String,
    /// Key of the stage before; none for the first of a run.
    pub parent: Option<String>,
    /// Everything that determines the result: versions, engine and its settings,
    /// apparatus, contact, seed, the stage, and as `parent` the key of the stage
    /// before or, for the first, the hash of the grains.
    pub determined_by: Value,
}

impl StageIdentity {
    /// Names a stage by everything that determines it, which must hold in `parent`
    /// the key of the stage before or the hash of the grains.
    ///
    /// # Panics
    /// When `determined_by` has no JSON form.
    pub fn new(
        stage: &str,
        (grains, grains_sha256): (usize, &str),
        parent: Option<&str>,
        determined_by: &impl Serialize,
    ) -> Self {
        let determined_by =
            serde_json::to_value(determined_by).expect("what determines a stage has a JSON form");
        Self {
            key: hash_json(&determined_by),
            stage: stage.to_owned(),
            grains,
            grains_sha256: grains_sha256.to_owned(),
            parent: parent.map(str::to_owned),
            determined_by,
        }
    }

    /// Whether it fits itself; what does not.
    ///
    /// # Errors
    /// What is wrong, in words.
    pub fn check(&self) -> Result<(), String> {
        if hash_json(&self.determined_by) != self.key {
            return Err(format!("its key {} is not that of what determined it", short(&self.key)));
        }
        let before = self.parent.as_ref().unwrap_or(&self.grains_sha256);
        if self.determined_by.get("parent").and_then(Value::as_str) != Some(before) {
            return Err("it names another stage before it than determined it".to_owned());
        }
        Ok(())
    }

    /// Whether it is the stage that is asked for; in what it is not.
    ///
    /// # Errors
    /// What is wrong, in words.
    pub fn is(&self, asked: &Self) -> Result<(), String> {
        let parent = |of: &Self| of.parent.as_deref().map_or("none".to_owned(), short);
        let fields = [
            ("stage", self.stage.clone(), asked.stage.clone()),
            ("number of grains", self.grains.to_string(), asked.grains.to_string()),
            ("hash of the grains", short(&self.grains_sha256), short(&asked.grains_sha256)),
            ("key of the stage before", parent(self), parent(asked)),
            ("key", short(&self.key), short(&asked.key)),
        ];
        let differs = fields.iter().find(|(_, own, other)| own != other);
        if let Some((what, own, other)) = differs {
            return Err(format!("it is another stage: its {what} is {own}, expected is {other}"));
        }
        self.check()?;
        if self != asked {
            return Err("it is another stage, determined by other settings".to_owned());
        }
        Ok(())
    }
}

/// A hash as messages show it.
pub(super) fn short(hash: &str) -> String {
    hash.chars().take(SHOWN).collect()
}

/// What the specimen was at the end of a stage, to know it again.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct StageEnd {
    /// Grains that took part still.
    pub grains: usize,
    /// Their kinetic energy in J.
    pub kinetic_energy_j: f64,
    /// Their potential energy in J.
    pub potential_energy_j: f64,
    /// Pairs of grains that overlapped.
    pub overlapping_pairs: usize,
    /// Their mean overlap in percent of the mean equivalent diameter.
    pub overlap_mean_percent: f64,
    /// Their largest overlap.
    pub overlap_max_percent: f64,
}

/// How far numbers of [`StageEnd`] may differ, relative and in their units:
/// another machine may round other digits.
const ROUNDING: f64 = 1e-6;
const NOTHING: f64 = 1e-12;

impl StageEnd {
    /// Whether it is the end that was recorded; in what it is not.
    ///
    /// # Errors
    /// What is wrong, in words.
    pub fn is(&self, recorded: &Self) -> Result<(), String> {
        let numbers = [
            ("grains that take part", self.grains as f64, recorded.grains as f64),
            ("kinetic energy in J", self.kinetic_energy_j, recorded.kinetic_energy_j),
            ("potential energy in J", self.potential_energy_j, recorded.potential_energy_j),
            (
                "number of overlapping pairs",
                self.overlapping_pairs as f64,
                recorded.overlapping_pairs as f64,
            ),
            ("mean overlap in %", self.overlap_mean_percent, recorded.overlap_mean_percent),
            ("largest overlap in %", self.overlap_max_percent, recorded.overlap_max_percent),
        ];
        for (what, found, noted) in numbers {
            let allowed = NOTHING + ROUNDING * noted.abs();
            // Written so that what is no number differs.
            if !((found - noted).abs() <= allowed) {
                return Err(format!(
                    "its specimen's {what} is {found:.6e}, recorded is {noted:.6e}"
                ));
            }
        }
        Ok(())
    }
}
