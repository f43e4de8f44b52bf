//! Interpretations of the paper: what its authors may have meant or typed, each as
//! changes to the programme, built into the program.

use serde::Deserialize;
use serde_json::{Map, Value};

use crate::scenario::{Override, StageSpec};
use crate::study::{StudyError, preset};

/// An interpretation of the paper: its name, and its file under `scenarios/interpretations/`.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Interpretation {
    /// Name, as `--interpretation` takes it.
    #[serde(skip)]
    pub name: &'static str,
    /// What it is, in a few words.
    pub title: String,
    /// What it stands for.
    pub meaning: String,
    /// Where it comes from.
    pub source: String,
    /// Another interpretation, over which what this one changes is laid.
    #[serde(default)]
    like: Option<String>,
    /// What is laid over every scenario of the programme.
    #[serde(default)]
    changes: Map<String, Value>,
    /// What is laid over every stage that vibrates.
    #[serde(default)]
    vibration: Map<String, Value>,
}

macro_rules! files {
    ($($name:literal),* $(,)?) => {
        [$(($name, include_str!(concat!("../../../scenarios/interpretations/", $name, ".json")))),*]
    };
}

/// Name and text of each file, in the order in which they are shown.
const FILES: [(&str, &str); 15] = files![
    "converged",
    "half_stroke",
    "full_stroke",
    "per_body",
    "bullet_stock",
    "blender_2014_m",
    "blender_2014_dm",
    "blender_2014_cm",
    "blender_2014_mm",
    "blender_2014_cm_awake",
    "blender_2014_m_frames",
    "blender_2014_dm_frames",
    "blender_2014_cm_frames",
    "blender_2014_mm_frames",
    "blender_2014_cm_awake_frames",
];

impl Interpretation {
    fn parse(name: &'static str, text: &str) -> Result<Self, StudyError> {
        let file: Self = serde_json::from_str(text)
            .map_err(|e| StudyError::Scenario(format!("the interpretation `{name}`: {e}")))?;
        Ok(Self { name, ..file })
    }

    /// Every interpretation, in the order in which they are shown.
    ///
    /// # Errors
    /// When a built-in file has a fault.
    pub fn all() -> Result<Vec<Self>, StudyError> {
        FILES.into_iter().map(|(name, text)| Self::parse(name, text)).collect()
    }

    /// The interpretation of a name.
    ///
    /// # Errors
    /// [`StudyError::Scenario`] listing the names, for one that is not there.
    pub fn named(name: &str) -> Result<Self, StudyError> {
        let known = FILES.into_iter().find(|(known, _)| *known == name);
        let (name, text) = known.ok_or_else(|| {
            let names: Vec<&str> = Self::names().collect();
            StudyError::Scenario(format!(
                "there is no interpretation `{name}` (allowed: {})",
                names.join(", ")
            ))
        })?;
        Self::parse(name, text)
    }

    /// The names, in order.
    pub fn names() -> impl Iterator<Item = &'static str> {
        FILES.into_iter().map(|(name, _)| name)
    }

    /// The interpretation's changes of a built-in scenario.
    pub(super) fn changes_of(&self, scenario: &str) -> Result<Vec<Override>, StudyError> {
        let mut changes = match &self.like {
            // Files are built in: one that is like itself would be seen by the tests.
            Some(like) => Self::named(like)?.changes_of(scenario)?,
            None => Vec::new(),
        };
        leaves(&mut Vec::new(), &self.changes, &mut changes);
        if self.vibration.is_empty() {
            return Ok(changes);
        }
        for (index, stage) in preset(scenario, &[])?.stages.iter().enumerate() {
            if matches!(stage, StageSpec::Vibrate { .. }) {
                let index = index.to_string();
                let change =
                    |(f, v): (&String, &Value)| Override::new(&["stages", &index, f], v.clone());
                changes.extend(self.vibration.iter().map(change));
            }
        }
        Ok(changes)
    }
}

/// Every value of nested objects as a change of its own, so that what an interpretation
/// does not name stays.
fn leaves<'a>(path: &mut Vec<&'a str>, fields: &'a Map<String, Value>, into: &mut Vec<Override>) {
    for (name, value) in fields {
        path.push(name);
        match value {
            Value::Object(fields) => leaves(path, fields, into),
            value => into.push(Override::new(path, value.clone())),
        }
        path.pop();
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::{ConvexPolyhedron, MassProperties, Pose, Vector};
    use crate::protocol::Setup;
    use crate::scenario::{Scenario, is_of_coarse_steps, warnings};
    use crate::world::{Body, BodyState, Material, Motion, create};

    fn scenario(interpretation: &str, of: &str) -> Scenario {
        let interpretation = Interpretation::named(interpretation).expect("an interpretation");
        preset(of, &interpretation.changes_of(of).expect("changes")).expect("a scenario")
    }

    #[test]
    fn every_interpretation_makes_valid_scenarios_and_says_what_it_is() {
        let interpretations = Interpretation::all().expect("they can be read");
        assert_eq!(interpretations.len(), FILES.len());
        for interpretation in &interpretations {
            for text in [&interpretation.title, &interpretation.meaning, &interpretation.source] {
                assert!(text.len() > 10, "{}: a text is missing", interpretation.name);
            }
            for of in ["paper/pluviation.json", "paper/vibration-intermittent.json"] {
                let scenario = scenario(interpretation.name, of);
                let coarse = interpretation.name.starts_with("blender");
                let warnings = warnings(&scenario);
                let warned = !warnings.is_empty();
                let of_steps = warnings.iter().any(|warning| is_of_coarse_steps(warning));
                assert_eq!(of_steps, coarse, "law: {} of {of}: {warnings:?}", interpretation.name);
                assert_eq!(
                    warned, coarse,
                    "{} of {of}: coarse steps warned of",
                    interpretation.name
                );
            }
        }
    }

    /// Law: a text that names Blender's box says whether it is ticked, as its setting has it.
    #[test]
    fn grains_sleep_only_where_the_box_is_said_to_be_ticked() {
        for of in Interpretation::all().expect("they can be read") {
            let sleeps = scenario(of.name, "paper/pluviation.json").engine.stock.sleeping;
            let titled = of.title.contains("slow grains sleep");
            assert_eq!(titled, sleeps, "law: `{}` of {} says that grains sleep", of.title, of.name);
            if of.name.starts_with("blender") && of.like.is_none() {
                let ticked = of.meaning.contains("with the box Enable Deactivation ticked");
                assert_eq!(ticked, sleeps, "law: {} says that it is ticked", of.name);
                let source = "sleeping only where Enable Deactivation is ticked";
                assert!(of.source.contains(source), "law: `{source}` in {}", of.name);
                assert!(of.meaning.contains("stays awake"), "law: {} says what is new", of.name);
            }
        }
    }

    #[test]
    fn a_wrong_name_is_refused_with_the_right_ones() {
        let error =
            Interpretation::named("blender").expect_err("no such interpretation").to_string();
        for name in Interpretation::names().chain(["`blender`"]) {
            assert!(error.contains(name), "{name} is not in: {error}");
        }
    }

    #[test]
    fn strokes_are_those_of_their_names() {
        for (name, half_stroke_mm) in
            [("converged", 25.0), ("half_stroke", 25.0), ("full_stroke", 12.5)]
        {
            let vibration = scenario(name, "paper/vibration-continuous.json").motion();
            let got = 1e3 * vibration.expect("it vibrates").amplitude;
            assert!(
                (got - half_stroke_mm).abs() < 1e-9,
                "law: {name} moves by {half_stroke_mm} mm to either side, got {got} mm"
            );
        }
        let [converged, half] = ["converged", "half_stroke"]
            .map(|name| scenario(name, "paper/vibration-continuous.json"));
        assert_eq!(
            converged, half,
            "law: two names of one interpretation share every stored stage"
        );
    }

    #[test]
    fn frames_are_those_of_their_interpretation_and_a_video() {
        for name in Interpretation::names().filter(|name| name.ends_with("_frames")) {
            let of = "paper/vibration-continuous.json";
            let mut framed = scenario(name, of);
            let motion = framed.motion().expect("it vibrates");
            assert_eq!(motion.frames_per_s, Some(25.0), "law: 0.08 s are two frames, {name}");
            for stage in &mut framed.stages {
                if let StageSpec::Vibrate(stage) = stage {
                    stage.video_frames = None;
                }
            }
            let plain = scenario(name.trim_end_matches("_frames"), of);
            assert_eq!(framed, plain, "law: nothing else differs, {name}");
        }
    }

    /// A world of the interpretation with one grain of 0.5 g: what it holds.
    fn held(name: &str) -> crate::world::EffectiveSettings {
        let setup = Setup::new(&scenario(name, "paper/pluviation.json")).expect("a laboratory");
        let gravity = Vector::new(0.0, 0.0, -setup.gravity);
        let mut world = create(&setup.engine, gravity, &setup.pairs).expect("a world");
        let side = (0.5e-3 / 2673.9_f64).cbrt();
        let shape = ConvexPolyhedron::cuboid(Vector::repeat(side)).expect("a cube");
        let properties = MassProperties::of(&shape);
        let mut grain = || {
            world.add(&Body {
                shape: shape.clone().into(),
                motion: Motion::Free {
                    mass: 2673.9 * properties.volume,
                    inertia: properties.inertia_per_density.diagonal() * 2673.9,
                },
                material: Material::Grain,
                state: BodyState::at_rest(Pose::identity()),
            })
        };
        let (a, b) = (grain().expect("a grain"), grain().expect("a grain"));
        let pair = world.pair_coefficients(a, b).expect("a pair");
        let mut held = world.effective();
        held.insert("pair_friction".into(), pair.friction.into());
        held.insert("pair_restitution".into(), pair.restitution.into());
        held
    }

    /// Law: with values of each body, walls and plate keep their friction, and every pair has the
    /// product of the restitutions.
    #[test]
    fn values_of_each_body_change_the_restitution_of_every_pair() {
        use Material::{Grain, Plate, Wall};
        let pairs = |name: &str| {
            Setup::new(&scenario(name, "paper/pluviation.json")).expect("a laboratory").pairs
        };
        let (of_pairs, of_bodies) = (pairs("converged"), pairs("per_body"));
        for (a, b) in [(Grain, Grain), (Grain, Wall), (Grain, Plate), (Plate, Wall)] {
            let [was, is] = [&of_pairs, &of_bodies].map(|table| table.get(a, b));
            let factor = if (a, b) == (Grain, Grain) { 0.793 } else { 1.0 };
            for (what, expected, got) in [
                ("restitution", 0.315 * was.restitution, is.restitution),
                ("friction", factor * was.friction, is.friction),
            ] {
                assert!(
                    (got - expected).abs() < 1e-9,
                    "law: {what} of {a:?} on {b:?}: expected {expected}, got {got}, tolerance 1e-9"
                );
            }
        }
    }

    #[test]
    fn each_interpretation_is_in_the_engine_what_it_says() {
        let _turn = crate::world::exclusive_turn();
        let margin = 0.04; // in length units
        let side_m = (0.5e-3 / 2673.9_f64).cbrt();
        // The box of a cube with a margin m: (a + 2m)² a²⁻¹ of the exact inertia.
        let stale = |scale: f64| ((side_m * scale + 2.0 * margin) / (side_m * scale)).powi(2);
        let cases: [(&str, &[(&str, f64)]); 6] = [
            (
                "converged",
                &[
                    ("pair_friction", 0.793),
                    ("pair_restitution", 0.315),
                    ("sleeping", 0.0),
                    ("substeps", 3.0),
                ],
            ),
            ("per_body", &[("pair_friction", 0.628_849), ("pair_restitution", 0.099_225)]),
            (
                "bullet_stock",
                &[("pair_friction", 0.793), ("time_step_s", 1.0 / 480.0), ("iterations", 20.0)],
            ),
            (
                "blender_2014_m",
                &[
                    ("pair_friction", 0.628_849),
                    ("time_step_s", 1.0 / 60.0),
                    ("iterations", 10.0),
                    ("length_scale_units_per_m", 1.0),
                    ("linear_damping", 0.04),
                    ("angular_damping", 0.1),
                    ("split_impulse", 0.0),
                    ("sleeping", 1.0),
                    ("sleeping_speed_m_per_s", 0.4),
                    ("sleeping_spin_rad_per_s", 0.5),
                    ("sleeping_time_s", 2.0),
                    ("relative_contact_threshold", 0.02),
                    ("collision_margin_m", 0.0),
                    ("lightest_free_body_kg", 1e-3),
                    ("largest_inertia_over_exact", stale(1.0)),
                ],
            ),
            (
                "blender_2014_mm",
                &[
                    ("length_scale_units_per_m", 1000.0),
                    ("sleeping_speed_m_per_s", 0.4e-3),
                    ("lightest_free_body_kg", 0.5e-3),
                    ("largest_inertia_over_exact", stale(1000.0)),
                ],
            ),
            ("blender_2014_cm_awake", &[("sleeping", 0.0)]),
        ];
        for (name, expected) in cases {
            let held = held(name);
            for (setting, expected) in expected {
                let got = held.get(*setting).and_then(Value::as_f64).unwrap_or(f64::NAN);
                assert!(
                    (got - expected).abs() <= 1e-6 * expected.abs(),
                    "law: {name} has {setting} {expected}, got {got}, tolerance 1e-6 of it"
                );
            }
        }
    }
}
