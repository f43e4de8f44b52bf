//! What the paper does not give, what was chosen, and why.

use std::{collections::BTreeMap, sync::LazyLock};

use serde::{Deserialize, Serialize};

use crate::{
    motion::MotionFacts,
    paper::text::compact,
    scenario::{
        Backend, BaseKind, ContactSolver, EngineSettings, GrainsSpec, Scenario, StageSpec,
        StockSettings, StrokeKind,
    },
};

/// A value the paper does not give.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct Choice {
    /// What it is.
    pub parameter: String,
    /// What was chosen, with its unit.
    pub value: String,
    /// Why.
    pub reason: String,
    /// What it moves, as far as is known.
    pub sensitivity: String,
}

/// What is said of each choice, whatever its value is.
#[derive(Debug, Clone, Default, PartialEq, Eq, Deserialize)]
#[serde(deny_unknown_fields)]
struct Said {
    parameter: String,
    reason: String,
    sensitivity: String,
}

fn said() -> &'static BTreeMap<String, Said> {
    static SAID: LazyLock<BTreeMap<String, Said>> =
        LazyLock::new(|| serde_json::from_str(include_str!("choices.json")).unwrap_or_default());
    &SAID
}

/// A choice by its name in `choices.json`.
fn choice(name: &str, value: impl Into<String>) -> Choice {
    let Said { parameter, reason, sensitivity } = said().get(name).cloned().unwrap_or_default();
    Choice { parameter, value: value.into(), reason, sensitivity }
}

/// The choices in a scenario, from grains to rest test.
pub fn choices(scenario: &Scenario) -> Vec<Choice> {
    let mut choices = vec![grains(scenario)];
    choices.extend(apparatus(scenario));
    choices.extend(contact(scenario));
    choices.extend(stages(scenario));
    choices.extend(engine(scenario));
    choices.extend(procedure(scenario));
    choices
}

fn grains(scenario: &Scenario) -> Choice {
    let value = match &scenario.grains {
        GrainsSpec::Sieved(s) => s
            .sieve_table
            .iter()
            .map(|f| {
                format!(
                    "{} to {} mm: {} %",
                    compact(f.retained_mm),
                    compact(f.passing_mm),
                    compact(f.mass_percent)
                )
            })
            .chain((!s.shape.is_default()).then(|| "spheres".to_owned()))
            .chain((s.cells.rounding > 0.0).then(|| format!("roundness {}", s.cells.rounding)))
            .collect::<Vec<_>>()
            .join("; "),
        GrainsSpec::File(f) => format!("grains read from {}", f.file),
        GrainsSpec::Meshes(m) => format!("stones of {}", m.meshes.join(", ")),
    };
    choice("sieve_table", value)
}

fn apparatus(scenario: &Scenario) -> Vec<Choice> {
    let (f, c) = (&scenario.apparatus.funnel, &scenario.apparatus.cylinder);
    vec![
        choice(
            "funnel",
            format!(
                "opening {} mm, top {} mm, wall {}° from the vertical",
                compact(f.opening_diameter_mm),
                compact(f.top_diameter_mm),
                compact(f.half_angle_deg)
            ),
        ),
        choice("round_walls", format!("{} flat pieces, of the circle's area", c.wall_pieces)),
    ]
}

fn contact(scenario: &Scenario) -> Vec<Choice> {
    let c = &scenario.contact;
    vec![
        choice(
            "grain_contact",
            format!(
                "values of the pair: {} and {} between grains",
                compact(c.grain_grain_friction),
                compact(c.restitution)
            ),
        ),
        choice("wall_friction", compact(c.grain_wall_friction)),
        choice(
            "plate_friction",
            format!("{}; {}", compact(c.grain_plate_friction), compact(c.plate_wall_friction)),
        ),
        choice("wall_restitution", compact(c.restitution)),
    ]
}

fn stages(scenario: &Scenario) -> Vec<Choice> {
    let mut choices = Vec::new();
    let stage = |wanted: fn(&StageSpec) -> bool| scenario.stages.iter().find(|s| wanted(s));
    if stage(|s| matches!(s, StageSpec::PlaceTopPlate { .. })).is_some() {
        choices.push(choice(
            "placing",
            "laid on the highest grain and let go at rest, after pouring".to_owned(),
        ));
    }
    let shaken = stage(|s| matches!(s, StageSpec::Vibrate { .. }));
    if let Some(StageSpec::Vibrate { amplitude_mm, stroke, periods, rest_s, .. }) = shaken {
        let reading = match stroke {
            StrokeKind::HalfStroke => "half stroke: the table moves by as much to either side",
            StrokeKind::FullStroke => "full stroke: the table moves by as much from end to end",
        };
        choices.push(choice(
            "amplitude",
            amplitude_mm.map_or_else(
                || "as recorded".to_owned(),
                |amplitude| format!("{} mm, {reading}", compact(amplitude)),
            ),
        ));
        choices.push(choice(
            "motion",
            shaken.and_then(StageSpec::motion).map_or_else(String::new, |motion| {
                MotionFacts::of(&motion, 1.0 / scenario.engine.rate_hz).line()
            }),
        ));
        if *periods > 1 {
            choices.push(choice("rest", format!("{} s", compact(*rest_s))));
        }
    }
    choices
}

/// A value as it stands in the scenario file.
fn as_typed(value: impl Serialize) -> String {
    match serde_json::to_value(value) {
        Ok(serde_json::Value::String(s)) => s,
        Ok(other) => other.to_string(),
        Err(_) => String::new(),
    }
}

/// What every engine and contact solver asks for.
fn engine(scenario: &Scenario) -> Vec<Choice> {
    let e = &scenario.engine;
    let mut choices = match (e.backend, e.contact_solver) {
        (Backend::Bullet, ContactSolver::Stock) => bullet_contacts(e),
        (Backend::Bullet, ContactSolver::Native) => native_contacts(e),
        (Backend::Rapier, _) => rapier_contacts(e),
    };
    choices.push(choice(
        "damping",
        format!("{} linear, {} angular", compact(e.linear_damping), compact(e.angular_damping)),
    ));
    choices
}

fn native_contacts(e: &EngineSettings) -> Vec<Choice> {
    let m = &e.native;
    vec![
        choice("native_contacts", "native: Pluvia's own on Bullet".to_owned()),
        choice(
            "native_time_step",
            format!("{} steps a second in {} sub-steps", compact(e.rate_hz), m.substeps(e.rate_hz)),
        ),
        choice(
            "native_iterations",
            format!(
                "at least {} iterations a sub-step, until one changes no contact by more than {} %",
                m.iterations,
                compact(100.0 * m.solver_tolerance)
            ),
        ),
        choice(
            "native_spring",
            format!(
                "{} N/m a point, damping ratio {}, pushed apart with at most {} m/s",
                compact(m.contact_stiffness_n_per_m),
                compact(m.contact_damping_ratio),
                compact(m.max_depenetration_velocity_m_per_s)
            ),
        ),
    ]
}

fn rapier_contacts(e: &EngineSettings) -> Vec<Choice> {
    let r = &e.rapier;
    vec![
        choice("rapier_contacts", "rapier's own".to_owned()),
        choice(
            "rapier_time_step",
            format!("{} steps a second in {} sub-steps", compact(e.rate_hz), r.substeps),
        ),
        choice(
            "rapier_spring",
            format!(
                "{} Hz, damping ratio {}",
                compact(r.contact_frequency_hz),
                compact(r.contact_damping_ratio)
            ),
        ),
    ]
}

fn bullet_contacts(e: &EngineSettings) -> Vec<Choice> {
    let mut choices = vec![
        choice(
            "stock_contacts",
            format!(
                "{}, {} friction directions",
                as_typed(e.contact_solver),
                e.friction_directions
            ),
        ),
        choice("stock_time_step", format!("{} steps a second", compact(e.rate_hz))),
        choice("stock_iterations", e.iterations.to_string()),
        choice("length_scale", format!("{} engine units in a metre", compact(e.length_scale))),
        choice("threshold", format!("{} mm", compact(e.contact_threshold_mm))),
        choice(
            "correction",
            format!(
                "{} of the overlap a step, {} of the last impulses, split impulse {}",
                compact(e.erp),
                compact(e.warm_start),
                if e.split_impulse { "on" } else { "off" }
            ),
        ),
    ];
    if e.stock != StockSettings::default() {
        choices.push(choice("of_the_tool", as_typed(&e.stock)));
    }
    choices
}

fn procedure(scenario: &Scenario) -> Vec<Choice> {
    let s = &scenario.settle;
    vec![
        choice(
            "settled",
            format!(
                "root mean square speed below {} mm/s and every speed below {} mm/s for {} s",
                compact(s.rms_speed_mm_per_s),
                compact(s.largest_speed_mm_per_s),
                compact(s.hold_s)
            ),
        ),
        choice("gravity", format!("{} m/s²", compact(scenario.gravity_m_per_s2))),
        choice(
            "mixing",
            format!("configuration {}, seed {}", scenario.configuration, scenario.seed),
        ),
        choice(
            "rest_test",
            if scenario.rest_test_s > 0.0 {
                format!("{} s after the end", compact(scenario.rest_test_s))
            } else {
                "none".to_owned()
            },
        ),
    ]
}

/// The choices of a scenario that builds a pile; none of one that does not.
pub fn pile_choices(scenario: &Scenario) -> Vec<Choice> {
    let Some(StageSpec::SlowPluviation {
        feed_rate_grains_per_s,
        drop_height_mm,
        spout_diameter_mm,
        base,
        base_diameter_mm,
        ..
    }) = scenario.stages.iter().find(|s| matches!(s, StageSpec::SlowPluviation { .. }))
    else {
        return Vec::new();
    };
    let base_value = match (base.kind, base.friction) {
        (BaseKind::FixedGrains, _) => "a layer of the same grains, fixed".to_owned(),
        (BaseKind::Plane, friction) => format!("a plane of friction {}", friction.unwrap_or(0.0)),
    };
    vec![
        choice("pile_feed", format!("{feed_rate_grains_per_s} grains a second")),
        choice(
            "pile_drop",
            format!("{drop_height_mm} mm above its top, within {spout_diameter_mm} mm"),
        ),
        choice("pile_base", format!("{base_value}, {base_diameter_mm} mm in diameter")),
    ]
}

#[cfg(test)]
mod tests {
    use super::*;

    fn scenario(stages: &str) -> Scenario {
        let text = format!(
            r#"{{"name": "s", "grains": {{"total_mass_g": 2343, "density_kg_per_m3": 2673.9,
            "sieve_table": [{{"passing_mm": 10, "retained_mm": 8, "mass_percent": 100}}]}},
            "stages": [{stages}]}}"#
        );
        serde_json::from_str(&text).expect("a scenario")
    }

    fn value(choices: &[Choice], parameter: &str) -> Option<String> {
        choices.iter().find(|c| c.parameter == parameter).map(|c| c.value.clone())
    }

    #[test]
    fn values_are_those_of_the_scenario() {
        let mut s = scenario(
            r#"{"stage": "vibrate", "frequency_hz": 3, "amplitude_mm": 12.5,
            "stroke": "full_stroke", "duration_s": 5, "periods": 4, "rest_s": 1.5}"#,
        );
        s.engine.rate_hz = 960.0;
        let c = choices(&s);
        assert_eq!(value(&c, "Time step").as_deref(), Some("960 steps a second in 2 sub-steps"));
        assert_eq!(value(&c, "Sieve table").as_deref(), Some("8 to 10 mm: 100 %"));
        assert_eq!(value(&c, "Rest between periods").as_deref(), Some("1.5 s"));
        let amplitude = value(&c, "Meaning of the amplitude").expect("vibrated");
        assert!(amplitude.starts_with("12.5 mm, full stroke"), "got {amplitude}");
    }

    /// Law: every text of `choices.json` is that of a choice, and every choice has one.
    #[test]
    fn every_choice_is_explained() {
        let mut s = scenario(
            r#"{"stage": "place_top_plate"}, {"stage": "vibrate", "frequency_hz": 3,
            "amplitude_mm": 25, "duration_s": 5, "periods": 4, "rest_s": 1},
            {"stage": "slow_pluviation", "base_diameter_mm": 300}"#,
        );
        let mut all = Vec::new();
        for (backend, solver) in [
            (Backend::Bullet, ContactSolver::Native),
            (Backend::Bullet, ContactSolver::Stock),
            (Backend::Rapier, ContactSolver::Native),
        ] {
            (s.engine.backend, s.engine.contact_solver) = (backend, solver);
            s.engine.stock.collision_margin_mm = 1.0;
            all.extend(choices(&s));
        }
        all.extend(pile_choices(&s));
        let unexplained = all.iter().find(|c| c.parameter.is_empty() || c.reason.is_empty());
        assert_eq!(unexplained, None, "law: every choice has a text");
        for (name, text) in said() {
            let is_told = |c: &Choice| (&c.parameter, &c.reason) == (&text.parameter, &text.reason);
            assert!(all.iter().any(is_told), "law: `{name}` is a choice");
        }
    }

    /// Law: what a choice moves is said without a number: results belong to runs, and a text
    /// keeps those of an earlier solver.
    #[test]
    fn no_result_is_quoted() {
        let mut s = scenario(
            r#"{"stage": "place_top_plate"}, {"stage": "vibrate", "frequency_hz": 3,
            "amplitude_mm": 25, "duration_s": 5, "periods": 4, "rest_s": 1}"#,
        );
        let stock = |s: &mut Scenario| s.engine.contact_solver = ContactSolver::Stock;
        let rapier = |s: &mut Scenario| s.engine.backend = Backend::Rapier;
        let quotes = |text: &str| {
            let words: Vec<&str> = text.split_whitespace().collect();
            words.windows(2).any(|w| {
                w[0].ends_with(|c: char| c.is_ascii_digit())
                    && ["mm", "%", "µm/s"].iter().any(|unit| w[1].starts_with(unit))
            })
        };
        assert!(quotes("it was 11.6 mm, without 19.6 mm"), "the check can fail");
        for change in [|_: &mut Scenario| (), stock, rapier] {
            change(&mut s);
            for c in choices(&s) {
                assert!(!quotes(&c.sensitivity), "law: {}: {}", c.parameter, c.sensitivity);
            }
        }
    }

    #[test]
    fn choices_of_stages_that_are_not_there_are_left_out() {
        let c = choices(&scenario(r#"{"stage": "pour", "falling_height_mm": 50}"#));
        for parameter in
            ["Rest between periods", "Meaning of the amplitude", "Placing of the top plate"]
        {
            assert_eq!(value(&c, parameter), None, "{parameter} without such a stage");
        }
        assert!(c.iter().all(|c| !c.value.is_empty() && !c.reason.is_empty()), "{c:#?}");
    }
}
