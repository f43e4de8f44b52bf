//! What the paper does not give, what was chosen, and why: `choices.json` says it, with the values
//! of a scenario in the place of what stands in braces.

use std::borrow::Cow;

use super::*;
use crate::motion::MotionFacts;
use crate::scenario::{BaseKind, SievedShape, StockSettings, StrokeKind};

/// A value the paper does not give.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Choice {
    /// What it is.
    pub parameter: String,
    /// Of which scenarios it is: what their engine, or a stage of theirs, is called; of all where
    /// it is empty.
    #[serde(default, skip_serializing)]
    of: String,
    /// What was chosen, with its unit.
    pub value: String,
    /// Why.
    pub reason: String,
    /// What it moves, as far as is known.
    pub sensitivity: String,
}

/// The stage of a pile, whose choices stand by themselves.
const PILE: &str = "slow_pluviation";

fn said() -> &'static [Choice] {
    static SAID: LazyLock<Vec<Choice>> =
        LazyLock::new(|| serde_json::from_str(include_str!("choices.json")).unwrap_or_default());
    &SAID
}

/// The choices in a scenario, from grains to rest test.
pub fn choices(scenario: &Scenario) -> Vec<Choice> {
    chosen(scenario, |of| of != PILE)
}

/// The choices of a scenario that builds a pile; none of one that does not.
pub fn pile_choices(scenario: &Scenario) -> Vec<Choice> {
    chosen(scenario, |of| of == PILE)
}

fn chosen(scenario: &Scenario, wanted: impl Fn(&str) -> bool) -> Vec<Choice> {
    let facts = facts(scenario);
    let of_scenario = |of: &str| of.is_empty() || facts.get(of).is_some_and(|is| *is != false);
    let those = said().iter().filter(|choice| wanted(&choice.of) && of_scenario(&choice.of));
    those.map(|choice| Choice { value: filled(&choice.value, &facts), ..choice.clone() }).collect()
}

/// A text with values in the place of their paths in braces.
fn filled(text: &str, facts: &Value) -> String {
    let mut parts = text.split('{');
    let mut filled = parts.next().unwrap_or_default().to_owned();
    for (path, rest) in parts.filter_map(|part| part.split_once('}')) {
        let value = path.split('.').fold(facts, |at, step| &at[step]);
        filled += &match value {
            Value::String(text) => Cow::from(text),
            Value::Bool(is_on) => (if *is_on { "on" } else { "off" }).into(),
            Value::Number(number) if number.is_f64() => {
                compact(number.as_f64().unwrap_or(f64::NAN)).into()
            }
            other => other.to_string().into(),
        };
        filled += rest;
    }
    filled
}

/// A scenario as JSON, its first stage of each name and its engine by that name, and what its
/// fields do not say themselves.
fn facts(scenario: &Scenario) -> Value {
    let engine = &scenario.engine;
    let mut facts = serde_json::to_value(scenario).unwrap_or_default();
    for stage in scenario.stages.iter().rev() {
        facts[stage.name()] = serde_json::to_value(stage).unwrap_or_default();
        match stage {
            StageSpec::Vibrate(vibrate) => {
                facts["amplitude"] = amplitude(vibrate.amplitude_mm, vibrate.stroke).into();
                facts["periods"] = (vibrate.periods > 1).into();
                let motion = stage.motion();
                let line = motion.map(|m| MotionFacts::of(&m, 1.0 / engine.rate_hz).line());
                facts["motion"] = line.unwrap_or_default().into();
            }
            StageSpec::SlowPluviation(pile) => {
                let base = &pile.base;
                facts["pile_base"] = match base.kind {
                    BaseKind::FixedGrains => "a layer of the same grains, fixed".into(),
                    BaseKind::Plane => {
                        format!("a plane of friction {}", base.friction.unwrap_or(0.0)).into()
                    }
                };
            }
            _ => {}
        }
    }
    let is_stock = engine.is_stock();
    for (name, value) in [
        ("native", engine.is_native().into()),
        ("bullet", (engine.backend == Backend::Bullet).into()),
        ("stock", is_stock.into()),
        ("rapier", (engine.backend == Backend::Rapier).into()),
        ("stock_settings", (is_stock && engine.stock != StockSettings::default()).into()),
        ("native_substeps", engine.native.substeps(engine.rate_hz).into()),
        ("native_tolerance_percent", json!(100.0 * engine.native.solver_tolerance)),
        ("sieve_table", grains(&scenario.grains).into()),
        ("voronoi", is_voronoi(&scenario.grains).into()),
        (
            "rest_test",
            match scenario.rest_test_s {
                rest if rest > 0.0 => format!("{} s after the end", compact(rest)).into(),
                _ => "none".into(),
            },
        ),
    ] {
        facts[name] = value;
    }
    facts
}

/// Whether grains are cut as Voronoi cells.
fn is_voronoi(grains: &GrainsSpec) -> bool {
    matches!(grains, GrainsSpec::Sieved(sieved) if sieved.shape == SievedShape::Cells)
}

fn amplitude(amplitude_mm: Option<f64>, stroke: StrokeKind) -> String {
    let reading = match stroke {
        StrokeKind::HalfStroke => "half stroke: the table moves by as much to either side",
        StrokeKind::FullStroke => "full stroke: the table moves by as much from end to end",
    };
    amplitude_mm.map_or_else(
        || "as recorded".to_owned(),
        |amplitude| format!("{} mm, {reading}", compact(amplitude)),
    )
}

fn grains(grains: &GrainsSpec) -> String {
    match grains {
        GrainsSpec::Sieved(s) => {
            let fractions = s.sieve_table.iter().map(|f| {
                let (from, to) = (compact(f.retained_mm), compact(f.passing_mm));
                format!("{from} to {to} mm: {} %", compact(f.mass_percent))
            });
            fractions
                .chain((s.shape == SievedShape::Spheres).then(|| "spheres".to_owned()))
                .chain((s.cells.rounding > 0.0).then(|| format!("roundness {}", s.cells.rounding)))
                .collect::<Vec<_>>()
                .join("; ")
        }
        GrainsSpec::File(f) => format!("grains read from {}", f.file),
        GrainsSpec::Meshes(m) => format!("grains with the shapes of {}", m.meshes.join(", ")),
    }
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;
    use crate::scenario::ContactSolver;

    /// Stages of a specimen under its plate.
    pub const VIBRATED: &str = r#"{"stage": "place_top_plate"}, {"stage": "vibrate",
        "frequency_hz": 3, "amplitude_mm": 25, "duration_s": 5, "periods": 4, "rest_s": 1}"#;

    pub fn scenario(stages: &str) -> Scenario {
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
        assert_eq!(value(&c, "Time step").as_deref(), Some("960 steps per second in 2 sub-steps"));
        assert_eq!(value(&c, "Sieve table").as_deref(), Some("8 to 10 mm: 100 %"));
        assert_eq!(value(&c, "Rest between periods").as_deref(), Some("1.5 s"));
        let amplitude = value(&c, "Meaning of the amplitude").expect("vibrated");
        assert!(amplitude.starts_with("12.5 mm, full stroke"), "got {amplitude}");
    }

    /// Law: every text of `choices.json` is that of a choice, and every choice has one.
    #[test]
    fn every_choice_is_explained() {
        let pile = r#"{"stage": "slow_pluviation", "base_diameter_mm": 300}"#;
        let mut s = scenario(&format!("{VIBRATED}, {pile}"));
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
        for text in said() {
            let is_told = |c: &Choice| (&c.parameter, &c.reason) == (&text.parameter, &text.reason);
            assert!(all.iter().any(is_told), "law: `{}` is a choice", text.parameter);
        }
        let unfilled = all.iter().find(|c| c.value.is_empty() || c.value.contains("null"));
        assert_eq!(unfilled, None, "law: every path in braces is there");
    }

    /// Law: what a choice moves is said without a number, as results belong to runs, and a text
    /// keeps those of an earlier solver; but for the friction of the calibration (below).
    #[test]
    fn no_result_is_quoted() {
        let mut s = scenario(VIBRATED);
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

    /// Law: the friction that a pile of 38.40° needs is quoted as it was measured.
    #[test]
    fn the_calibrated_friction_is_that_of_the_calibration() {
        let text = include_str!("../../../docs/results/calibration/calibrate.json");
        let found: Value = serde_json::from_str(text).expect("JSON");
        let number = |at: &str| {
            let number = found.pointer(at).and_then(Value::as_f64);
            format!("{:.2}", number.unwrap_or_else(|| panic!("no number at {at}")))
        };
        let expected = format!(
            "angle of repose of {}° needs a coefficient of {} (confidence interval {} to {})",
            number("/wanted"),
            number("/solution/value"),
            number("/solution/interval_95/low"),
            number("/solution/interval_95/high")
        );
        let quoted = said().iter().any(|choice| choice.sensitivity.contains(&expected));
        assert!(quoted, "law: `{expected}` in choices.json");
    }

    /// Law: the choices that quote the page of the sensitivity name what moves which of its three
    /// results beyond scatter: height, settlement of the plate, settlement of the surface.
    #[test]
    fn what_moves_the_quick_specimen_is_as_its_page_says() {
        let page = include_str!("../../../docs/results/sensitivity-quick.md");
        let tables: Vec<&str> = page.split("\n## ").skip(1).take(3).collect();
        let moves = |parameter: &str| {
            let line = |table: &&str| {
                let is_row = |line: &&str| line.starts_with(&format!("| {parameter} |"));
                let row = table.lines().find(is_row);
                !row.unwrap_or_else(|| panic!("no {parameter} in {table}")).contains('~')
            };
            tables.iter().map(line).collect::<Vec<_>>()
        };
        let (none, surface) = ([false; 3], [false, false, true]);
        let height = [true, false, false];
        for (choice, text, parameters, expected) in [
            ("Sieve table", "neither height nor settlement", &["Coarse fraction"][..], none),
            (
                "Funnel",
                "opening and half angle move neither height nor settlement",
                &["Funnel opening", "Funnel half angle"],
                none,
            ),
            (
                "Friction of grains on cylinder",
                "moves the height, which less of it lowers, and no settlement",
                &["Friction on walls"],
                height,
            ),
            (
                "Friction of grains on the top plate",
                "no effect of either",
                &["Friction on the plate", "Plate on wall friction"],
                none,
            ),
            ("Restitution", "moves neither height nor settlement", &["Restitution"], none),
            ("Meaning of the amplitude", "the surface", &["Table amplitude"], surface),
            ("Damping", "move nothing", &["Damping", "Angular damping"], none),
            ("Settled", "no effect", &["Settling criterion"], none),
            ("Time step", "neither height nor settlement", &["Step rate"], none),
            ("Contact spring", "neither height nor settlement", &["Contact stiffness"], none),
        ] {
            let mut said = said().iter().filter(|c| c.parameter.starts_with(choice));
            assert!(said.any(|c| c.sensitivity.contains(text)), "law: `{text}` of {choice}");
            for parameter in parameters {
                assert_eq!(moves(parameter), expected, "law: {parameter}, said of {choice}");
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
