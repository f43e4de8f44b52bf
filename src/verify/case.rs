//! The file of a verification case.

use serde::{Deserialize, Serialize};

use super::{VerifyError, experiment::Experiment};

/// A law and the experiment that must obey it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Case {
    /// Short name, that of the file.
    pub id: String,
    /// What is done, in a few words.
    pub title: String,
    /// The law, in words and symbols.
    pub law: String,
    /// Where law, expected value and tolerance come from.
    pub source: String,
    /// What is measured.
    pub quantity: String,
    /// What the law says, in `unit`.
    pub expected: f64,
    /// Largest difference that passes, in `unit`.
    pub tolerance: f64,
    /// The same in single precision, where rounding alone exceeds `tolerance`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub tolerance_single: Option<f64>,
    /// Unit of the values; empty for pure numbers.
    pub unit: String,
    /// The experiment.
    pub experiment: Experiment,
    /// Engines known to miss the law.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub known_failures: Vec<KnownFailure>,
}

/// An engine's known failure, with its reason.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct KnownFailure {
    /// Name of a setting; a `*` in it stands for anything.
    pub setting: String,
    /// Why it fails.
    pub reason: String,
}

impl KnownFailure {
    /// Whether it is about this setting.
    pub fn covers(&self, setting: &str) -> bool {
        match self.setting.split_once('*') {
            Some((beginning, end)) => {
                setting.strip_prefix(beginning).is_some_and(|rest| rest.ends_with(end))
            }
            None => self.setting == setting,
        }
    }
}

impl Case {
    /// Reads a case; `file` names it in errors.
    ///
    /// # Errors
    /// [`VerifyError::Case`] with the place in the file.
    pub fn from_json(file: &str, text: &str) -> Result<Self, VerifyError> {
        let fault = |reason: String| VerifyError::Case { file: file.to_owned(), reason };
        let mut reader = serde_json::Deserializer::from_str(text);
        let case: Self = serde_path_to_error::deserialize(&mut reader)
            .map_err(|e| fault(format!("{}: {}", e.path(), e.inner())))?;
        reader.end().map_err(|e| fault(e.to_string()))?;
        let sound =
            case.expected.is_finite() && case.tolerance.is_finite() && case.tolerance >= 0.0;
        if !sound {
            return Err(fault(format!(
                "expected {} and tolerance {} must be finite, the tolerance not negative",
                case.expected, case.tolerance
            )));
        }
        let name = file.rsplit('/').next().unwrap_or(file);
        if name != format!("{}.json", case.id) {
            return Err(fault(format!("the file must be named after its id, {}.json", case.id)));
        }
        Ok(case)
    }
}

/// The files of the cases, a line about one thing.
macro_rules! files {
    ($($id:literal)*) => {
        const FILES: &[(&str, &str)] = &[$((
            concat!("scenarios/verification/", $id, ".json"),
            include_str!(concat!("../../scenarios/verification/", $id, ".json")),
        )),*];
    };
}

files! {
    "mass-properties" "free-fall" "projectile" "tumbling-momentum" "tumbling-energy" "tumbling-flip"
    "collision-momentum"
    "incline-holds" "incline-slides" "slide-stops" "slide-pair-friction" "touches-exactly"
    "inner-edge" "inner-edge-strips" "inner-edge-spinning" "drag-joint" "drag-step"
    "spin-slide-0" "spin-slide-25" "spin-slide-50" "spin-slide-100" "spin-slide-200"
    "spin-slide-angle" "spin-slide-angles" "spin-slide-time" "spin-slide-times" "spin-slide-large"
    "spin-slide-rough" "spin-slide-slippery" "spin-slide-oblong" "spin-stops"
    "table-sticks" "table-slips" "rebound" "rebound-none" "rebound-again"
    "impact-tilted" "impact-tilted-plastic" "impact-tilted-slips"
    "impact-tilted-slips-back" "impact-tilted-slip-stops" "impact-tilted-reversal"
    "impact-tilted-reversal-energetic" "impact-tilted-slip-stops-energetic"
    "impact-tilted-corner" "impact-at-several-points" "impact-flat-plastic" "impact-flat-sliding"
    "impact-two-supports" "impact-one-side"
    "approach-arrested" "approach-arrested-near" "approach-arrested-half"
    "approach-arrested-far" "approach-arrested-slow" "approach-arrested-wedged"
    "approach-arrested-piled" "approach-arrested-dropped" "approach-arrested-again"
    "approach-arrested-lifted"
    "approach-arrested-met" "approach-arrested-met-near" "approach-arrested-met-far"
    "approach-arrested-met-wedged" "approach-arrested-met-piled"
    "rocking-block" "rocking-block-slender" "rocking-block-flying"
    "pivot-on-edge" "pivot-on-corner" "top-precesses" "top-keeps-tilt" "top-sleeps"
    "ball-rolls" "ball-slips" "ball-slides-then-rolls" "ball-off-ball" "ball-off-edge"
    "ball-off-corner" "ball-off-rounded-edge" "rounded-corners-meet" "rounded-block-topples"
    "arch-critical-friction" "arch-critical-friction-flat" "ladder-critical-friction"
    "cube-rests" "grain-rests" "grain-on-three" "stack-of-ten"
    "column-of-ten" "floor-carries-weight"
    "packing-rests" "packing-keeps-grains" "packing-energy" "packing-walls-hold"
    "packing-order" "packing-reload" "packing-turned" "packing-size"
    "table-turned" "spin-slide-turned" "spin-slide-mirrored" "spin-slide-order"
    "spin-slide-boosted" "impact-tilted-turned" "impact-tilted-mirrored" "impact-tilted-order"
    "impact-tilted-boosted"
    "slide-length-scale" "slide-size" "spin-slide-size" "impact-tilted-size"
}

/// The cases under `scenarios/verification/`, built into the program so that
/// it needs no other file; in the order of the table.
///
/// # Errors
/// [`VerifyError::Case`] for a file with a fault.
pub fn builtin() -> Result<Vec<Case>, VerifyError> {
    FILES.iter().map(|(file, text)| Case::from_json(file, text)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_file_of_the_folder_is_a_case() {
        let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/scenarios/verification");
        let mut on_disk: Vec<String> = std::fs::read_dir(folder)
            .expect("the folder is there")
            .map(|e| e.expect("an entry").file_name().to_string_lossy().into_owned())
            .collect();
        on_disk.sort();
        let cases = builtin().expect("the cases are sound");
        let mut built_in: Vec<String> = cases.iter().map(|c| format!("{}.json", c.id)).collect();
        built_in.sort();
        assert_eq!(built_in, on_disk, "built-in cases left, files of the folder right");
        assert!(cases.len() >= 45, "at least 45 cases, got {}", cases.len());
    }

    #[test]
    fn faults_name_file_and_place() {
        let good = include_str!("../../scenarios/verification/free-fall.json");
        let read = |text: &str| Case::from_json("a/free-fall.json", text);
        read(good).expect("sound");
        for (text, part) in [
            (good.replace("\"expected\": ", "\"expectd\": "), "expectd"),
            (good.replace("\"height_mm\": ", "\"height\": "), "experiment"),
            (good.replace("\"tolerance\": ", "\"tolerance\": -"), "not negative"),
            (good.replace("\"id\": \"free-fall\"", "\"id\": \"other\""), "named after"),
            (format!("{good} 1"), "trailing"),
        ] {
            let error = read(&text).expect_err("a fault").to_string();
            assert!(error.starts_with("a/free-fall.json: "), "{error}");
            assert!(error.contains(part), "`{part}` is not named in: {error}");
        }
    }

    #[test]
    fn a_star_covers_anything() {
        let known = |setting: &str| KnownFailure { setting: setting.into(), reason: "".into() };
        assert!(known("stock").covers("stock") && !known("stock").covers("stock-1000"));
        assert!(known("stock*").covers("stock-1000") && !known("stock*").covers("rapier"));
        let single = known("stock*-single");
        assert!(single.covers("stock-single") && single.covers("stock-960-single"));
        assert!(!single.covers("stock") && !single.covers("native-single"));
        assert!(!known("abc*cd").covers("abcd"), "law: the parts do not share letters");
    }
}
