//! What the paper does not give, what was chosen, and why.

use serde::Serialize;

use crate::{
    motion::MotionFacts,
    paper::text::compact,
    scenario::{
        Backend, ContactSolver, EngineSettings, GrainsSpec, Scenario, StageSpec, StockSettings,
        StrokeKind,
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

pub(super) fn choice(parameter: &str, value: String, reason: &str, sensitivity: &str) -> Choice {
    Choice {
        parameter: parameter.to_owned(),
        value,
        reason: reason.to_owned(),
        sensitivity: sensitivity.to_owned(),
    }
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
    choice(
        "Sieve table",
        value,
        "In Figure 1, which was not available to us (only the paper's text was). Usual sieves; fractions such that the text's numbers come out: 1456 \
         grains of 2343 g, 55 to 65 in 100 g, poorly graded.",
        "Other tables meet the same numbers; a wider grading packs more densely. Not varied here.",
    )
}

fn apparatus(scenario: &Scenario) -> Vec<Choice> {
    let (f, c) = (&scenario.apparatus.funnel, &scenario.apparatus.cylinder);
    vec![
        choice(
            "Funnel",
            format!(
                "opening {} mm, top {} mm, wall {}° from the vertical",
                compact(f.opening_diameter_mm),
                compact(f.top_diameter_mm),
                compact(f.half_angle_deg)
            ),
            "The text gives no size. The opening is about eight grains wide, below which arches are \
             expected; the rest holds all grains and lets them out.",
            "The opening sets the rate of pouring and with it the density: a slower rain packs more \
             densely. Too narrow, and grains hang.",
        ),
        choice(
            "Round walls",
            format!("{} flat pieces, of the circle's area", c.wall_pieces),
            "Convex pieces are what the engine collides exactly; the area keeps the void ratio.",
            "Less than a grain's roughness at this number.",
        ),
    ]
}

fn contact(scenario: &Scenario) -> Vec<Choice> {
    let c = &scenario.contact;
    vec![
        choice(
            "Meaning of friction 0.793 and restitution 0.315",
            format!(
                "values of the pair: {} and {} between grains",
                compact(c.grain_grain_friction),
                compact(c.restitution)
            ),
            "The friction ratio is the tangent of the measured angle of repose, a property of grain \
             on grain. Typed into the engine of the time for each body, it would have been \
             multiplied: 0.629 and 0.099 at the contact.",
            "Less friction gives a denser packing and more settlement.",
        ),
        choice(
            "Friction of grains on cylinder, floor, funnel and lid",
            compact(c.grain_wall_friction),
            "Not given; a usual value for stone on smooth plastic.",
            "More of it carries grains at the wall and keeps the packing looser.",
        ),
        choice(
            "Friction of grains on the top plate; of the plate on the cylinder",
            format!("{}; {}", compact(c.grain_plate_friction), compact(c.plate_wall_friction)),
            "Not given; the plate must be free to follow the grains.",
            "A plate that sticks to the wall settles less than the grains below it.",
        ),
        choice(
            "Restitution of walls and plate",
            compact(c.restitution),
            "The text gives one value, for limestone; it is used for every pair.",
            "Small: grains hit walls rarely in a dense specimen.",
        ),
    ]
}

fn stages(scenario: &Scenario) -> Vec<Choice> {
    let mut choices = Vec::new();
    let stage = |wanted: fn(&StageSpec) -> bool| scenario.stages.iter().find(|s| wanted(s));
    if stage(|s| matches!(s, StageSpec::PlaceTopPlate { .. })).is_some() {
        choices.push(choice(
            "Placing of the top plate",
            "laid on the highest grain and let go at rest, after pouring".to_owned(),
            "Section 2 places it before pouring, section 3 lets it fall slowly on the grains; only \
             the latter can be meant for the simulations.",
            "It rests tilted on a few high grains: its settlement varies by millimetres with them. \
             The settlement of the surface is shown beside it.",
        ));
    }
    let shaken = stage(|s| matches!(s, StageSpec::Vibrate { .. }));
    if let Some(StageSpec::Vibrate { amplitude_mm, stroke, periods, rest_s, .. }) = shaken {
        let reading = match stroke {
            StrokeKind::HalfStroke => "half stroke: the table moves by as much to either side",
            StrokeKind::FullStroke => "full stroke: the table moves by as much from end to end",
        };
        choices.push(choice(
            "Meaning of the amplitude",
            amplitude_mm.map_or_else(
                || "as recorded".to_owned(),
                |amplitude| format!("{} mm, {reading}", compact(amplitude)),
            ),
            "\"Amplitude\" in its usual sense; the text does not say which.",
            "The other meaning halves or doubles speed and acceleration.",
        ));
        choices.push(choice(
            "Motion of the table",
            shaken.and_then(StageSpec::motion).map_or_else(String::new, |motion| {
                MotionFacts::of(&motion, 1.0 / scenario.engine.rate_hz).line()
            }),
            "Not given but for \"sinusoidal\"; every period starts and ends at the table's place.",
            "An abrupt start and stop of the table at either end of each period loosens the grains; a \
             ramp in its place makes the intermittent settlement smaller (--set, ramp_s).",
        ));
        if *periods > 1 {
            choices.push(choice(
                "Rest between periods",
                format!("{} s", compact(*rest_s)),
                "Not given; in the laboratory the plate was read meanwhile. Long enough for the \
                 grains to come to rest.",
                "None, where the specimen does not creep.",
            ));
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
        "Damping",
        format!("{} linear, {} angular", compact(e.linear_damping), compact(e.angular_damping)),
        "Not given; the tool's defaults slowed grains like a liquid would.",
        "Damping hides creep without curing it.",
    ));
    choices
}

fn native_contacts(e: &EngineSettings) -> Vec<Choice> {
    let m = &e.native;
    vec![
        choice(
            "Contacts",
            "native: Pluvia's own on Bullet".to_owned(),
            "The paper used its tool's own contacts, with which a packing at rest creeps by as \
             much as the settlement that is to be measured.",
            "Among the largest effects; Bullet's own can stand beside these in the report.",
        ),
        choice(
            "Time step",
            format!("{} steps a second in {} sub-steps", compact(e.rate_hz), m.substeps(e.rate_hz)),
            "Not given; the tool's default of the time was 60.",
            "Longer steps resolve impacts less well; docs/accuracy.md says how far void ratio and \
             settlement depend on it.",
        ),
        choice(
            "Solver iterations",
            format!(
                "at least {} iterations a sub-step, until one changes no contact by more than {} %",
                m.iterations,
                compact(100.0 * m.solver_tolerance)
            ),
            "Not given; the tool's default of the time was 10.",
            "Fewer: contacts give way under the weight above them.",
        ),
        choice(
            "Contact spring",
            format!(
                "{} N/m a point, damping ratio {}, pushed apart with at most {} m/s",
                compact(m.contact_stiffness_n_per_m),
                compact(m.contact_damping_ratio),
                compact(m.max_depenetration_velocity_m_per_s)
            ),
            "Not in the paper, whose grains are rigid: soft enough for the solver, stiff enough \
             for overlaps of a hundredth of a millimetre.",
            "At rest a point sinks in by its load over the stiffness. Softer: a shaken specimen \
             settles more (docs/parameters.md).",
        ),
    ]
}

fn rapier_contacts(e: &EngineSettings) -> Vec<Choice> {
    let r = &e.rapier;
    vec![
        choice(
            "Contacts",
            "rapier's own".to_owned(),
            "Another engine, to tell soil from engine.",
            "Among the largest effects.",
        ),
        choice(
            "Time step",
            format!("{} steps a second in {} sub-steps", compact(e.rate_hz), r.substeps),
            "Not given.",
            "Too long, and springs that stiff shake the packing.",
        ),
        choice(
            "Contact spring",
            format!(
                "{} Hz, damping ratio {}",
                compact(r.contact_frequency_hz),
                compact(r.contact_damping_ratio)
            ),
            "Not in the paper; with rapier's defaults grains of 10 mm sink into each other.",
            "Softer: grains overlap more.",
        ),
    ]
}

fn bullet_contacts(e: &EngineSettings) -> Vec<Choice> {
    let mut choices = vec![
        choice(
            "Contacts",
            format!(
                "{}, {} friction directions",
                as_typed(e.contact_solver),
                e.friction_directions
            ),
            "The paper used its tool's defaults. With one friction direction, the engine's default, \
             grains slide freely across it.",
            "Among the largest effects: one direction packs far too densely.",
        ),
        choice(
            "Time step",
            format!("{} steps a second", compact(e.rate_hz)),
            "Not given; the tool's default of the time was 60, at which grains of 10 mm sink into \
             each other.",
            "Settlement under vibration falls as the step gets shorter, more than with any other \
             setting.",
        ),
        choice(
            "Solver iterations",
            e.iterations.to_string(),
            "Not given; the tool's default of the time was 10.",
            "More make contacts stiffer and the packing somewhat looser.",
        ),
        choice(
            "Length scale",
            format!("{} engine units in a metre", compact(e.length_scale)),
            "Not given. The engine's absolute tolerances are made for bodies of about one unit.",
            "Too few units in a metre: overlaps are missed and grains leave through walls.",
        ),
        choice(
            "Contact threshold",
            format!("{} mm", compact(e.contact_threshold_mm)),
            "The engine's default is absolute and larger than a grain's roughness; set so that \
             contacts persist from step to step.",
            "Too small, and the packing collapses.",
        ),
        choice(
            "Correction of overlaps, warm start",
            format!(
                "{} of the overlap a step, {} of the last impulses, split impulse {}",
                compact(e.erp),
                compact(e.warm_start),
                if e.split_impulse { "on" } else { "off" }
            ),
            "Not given.",
            "What the solver forgets from step to step feeds creep; the rest test measures it.",
        ),
    ];
    if e.stock != StockSettings::default() {
        choices.push(choice(
            "Margin, inertia, least mass, relative threshold, sleeping",
            as_typed(&e.stock),
            "What the tool of the time did beside Bullet's own defaults, where an interpretation of the paper \
             asks for it; by default none of it.",
            "Sleeping hides creep; inertia that is too large keeps grains from rolling; a margin \
             makes them larger.",
        ));
    }
    choices
}

fn procedure(scenario: &Scenario) -> Vec<Choice> {
    let s = &scenario.settle;
    vec![
        choice(
            "Settled",
            format!(
                "root mean square speed below {} mm/s and every speed below {} mm/s for {} s",
                compact(s.rms_speed_mm_per_s),
                compact(s.largest_speed_mm_per_s),
                compact(s.hold_s)
            ),
            "\"Settled in a static state\" in the text, without a measure.",
            "A looser criterion ends a stage earlier; what still moves then settles in the next.",
        ),
        choice(
            "Gravity",
            format!("{} m/s²", compact(scenario.gravity_m_per_s2)),
            "Not given.",
            "None worth mention.",
        ),
        choice(
            "Mixing and seed",
            format!("configuration {}, seed {}", scenario.configuration, scenario.seed),
            "\"Additional mixing\" in the text: order and orientation are drawn anew, the grains \
             stay the same.",
            "The spread over configurations in Figures 7, 9 and 10.",
        ),
        choice(
            "Rest test",
            if scenario.rest_test_s > 0.0 {
                format!("{} s after the end", compact(scenario.rest_test_s))
            } else {
                "none".to_owned()
            },
            "Not in the paper: settlement cannot be told from creep without it.",
            "None on the results; it comes after them.",
        ),
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
