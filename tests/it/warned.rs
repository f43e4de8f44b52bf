//! What is typed and does not suit the grains is reported before anything runs, by every command
//! that runs scenarios, once however many runs share it.

use std::{
    fs,
    path::Path,
    sync::{Arc, Mutex, atomic::AtomicBool},
};

use pluvia::{
    grains::load_scenario,
    paper::{Interpretation, InterpretationsOptions, ReproduceOptions, interpretations, reproduce},
    protocol::Progress,
    scenario::{Backend, Override, warnings},
    study::{
        CalibrationOptions, Design, RunOptions, StudyError, StudyOptions, SweepOptions, SweepStudy,
        calibrate, compare, converge, sensitivity,
    },
};
use serde_json::{Value, json};

use super::{
    program::{self, Folder, assert_holds, write},
    small,
};

/// What is said, in order.
#[derive(Default)]
struct Heard(Mutex<Vec<String>>);

impl Progress for Heard {
    fn message(&self, text: &str) {
        self.0.lock().expect("held by one").push(text.to_owned());
    }
}

/// Stopped before the first step: what is heard was said before the run.
fn stopped(out: &Path) -> (RunOptions, Arc<Heard>) {
    fs::create_dir_all(out).expect("a folder");
    let heard = Arc::new(Heard::default());
    let options = RunOptions {
        out: out.to_owned(),
        jobs: 1,
        frames: false,
        cancel: Arc::new(AtomicBool::new(true)),
        progress: heard.clone(),
    };
    (options, heard)
}

fn warned(heard: &Heard) -> Vec<String> {
    let said = heard.0.lock().expect("held by none");
    said.iter().filter(|line| line.starts_with("warning: ")).cloned().collect()
}

/// A tenth of the sub-steps that these grains ask for.
const COARSE: &str = "engine.native.substep_rate_hz=100";

/// What is reported of a scenario's file.
fn reported(scenario: &Value) -> Vec<String> {
    let folder = Folder::new();
    let loaded = load_scenario(folder.scenario("s.json", scenario).as_ref(), &[]);
    let loaded = loaded.unwrap_or_else(|e| panic!("{scenario}: {e}"));
    warnings(&loaded.scenario).iter().map(ToString::to_string).collect()
}

#[test]
fn every_command_warns_once_before_it_runs() {
    let folder = tempfile::tempdir().expect("a folder");
    let scenario = write(folder.path(), "small.json", &small::layer(30.0));
    let specimen = json!({ "scenario": "small.json", "changes": [COARSE], "configurations": 2 });
    let ranges = json!({
        "full": specimen,
        "parameters": [{
            "name": "restitution", "title": "Restitution", "reason": "Any.",
            "path": "contact.restitution", "low": 0.2, "high": 0.4
        }]
    });
    let ladders = json!({
        "full": specimen, "reference": "rate",
        "limits": { "height_percent": 1, "settlement_percent": 1 },
        "ladders": [{
            "name": "rate", "title": "Rate", "rungs": [
                { "name": "240", "title": "240 Hz", "changes": ["engine.rate_hz=240"] },
                { "name": "480", "title": "480 Hz", "changes": ["engine.rate_hz=480"] }
            ]
        }]
    });
    let ranges = write(folder.path(), "ranges.json", &ranges);
    let ladders = write(folder.path(), "ladders.json", &ladders);
    let coarse = || vec![COARSE.parse::<Override>().expect("an override")];
    let two = || Interpretation::all().expect("interpretations").into_iter().take(2).collect();
    let of_design = |design: &Path| StudyOptions {
        design: Some(design.to_owned()),
        quick: false,
        configurations: None,
    };
    type Carry<'a> = &'a dyn Fn(RunOptions) -> Result<(), StudyError>;
    let commands: [(&str, Carry); 7] = [
        ("sweep", &|run| {
            SweepStudy::new(SweepOptions {
                scenario: scenario.clone(),
                changes: coarse(),
                over: vec!["contact.restitution=0.2,0.3".parse().expect("a factor")],
                parameters: Vec::new(),
                quick: false,
                ranges: Vec::new(),
                design: Design::Grid,
                configurations: 2,
                folder: "".into(),
            })?
            .study()
            .carry_out(&run)
            .map(|_| ())
        }),
        ("calibrate", &|run| {
            calibrate(CalibrationOptions {
                scenario: scenario.clone(),
                changes: coarse(),
                target: "void_ratio=0.9".parse().expect("a target"),
                unknown: "contact.restitution".to_owned(),
                between: "0.2..0.4".parse().expect("a range"),
                realisations: 2,
                tolerance: None,
                most_runs: None,
            })?
            .carry_out(&run)
            .map(|_| ())
        }),
        ("compare", &|run| {
            let loaded = load_scenario(&scenario, &coarse())?;
            let backends = [Backend::Bullet, Backend::Bullet];
            compare(loaded, &[], &backends)?.carry_out(&run).map(|_| ())
        }),
        ("converge", &|run| converge(&of_design(&ladders))?.carry_out(&run).map(|_| ())),
        ("sensitivity", &|run| sensitivity(&of_design(&ranges))?.carry_out(&run).map(|_| ())),
        ("reproduce", &|run| {
            let options = ReproduceOptions {
                changes: coarse(),
                interpretation: None,
                quick: true,
                configurations: 2,
                placements: 1,
            };
            reproduce(options)?.carry_out(&run).map(|_| ())
        }),
        ("interpretations", &|run| {
            let options = InterpretationsOptions {
                changes: coarse(),
                quick: true,
                configurations: 1,
                interpretations: two(),
            };
            interpretations(options)?.carry_out(&run).map(|_| ())
        }),
    ];
    for (name, command) in commands {
        let (options, heard) = stopped(&folder.path().join(name));
        let ended = command(options);
        assert!(
            matches!(ended, Err(StudyError::Cancelled)),
            "law: `{name}` is stopped before its first step, got {ended:?}"
        );
        let told = warned(&heard);
        let of_substeps = told.iter().filter(|w| w.contains("substep_rate_hz")).count();
        assert_eq!(of_substeps, 1, "law: `{name}` warns once before it runs: {told:?}");
    }
}

#[test]
fn the_program_prints_them_and_a_plan_has_them_too() {
    let folder = Folder::new();
    let mut layer = small::layer(30.0);
    layer["settle"] = json!({ "largest_speed_mm_per_s": 100 });
    let scenario = folder.scenario("small.json", &layer);
    let (run, over) = (vec!["run"], "contact.restitution=0.2,0.3");
    for command in [run, vec!["sweep", "--over", over, "--plan-only"]] {
        let out = folder.out(command[0]);
        let (code, _, said) = program::run(&[&command[..], &["--out", &out, &scenario]].concat());
        assert_eq!(code, Some(0), "{command:?}: {said}");
        let count = said.matches("warning: settle.largest_speed_mm_per_s: ").count();
        assert_eq!(count, 1, "law: {command:?} says it once: {said}");
    }
}

/// What is said of a field of 10 mm gravel that is typed.
fn said_of(engine: &Value, settle: &Value) -> Vec<String> {
    let mut scenario = small::layer(30.0);
    scenario["engine"] = engine.clone();
    scenario["settle"] = settle.clone();
    for stage in scenario["stages"].as_array_mut().expect("stages") {
        stage["time_limit_s"] = json!(20);
    }
    reported(&scenario)
}

/// Automatic values for grains of 10 to 12.5 mm, with what goes wrong below and above.
#[test]
fn typed_values_are_warned_of_in_both_directions() {
    let native = |field: &str, value: f64| (json!({ field: value }), json!({}));
    let solver = |field: &str, value: f64| (json!({ "native": { field: value } }), json!({}));
    let settle = |field: &str, value: f64| (json!({}), json!({ field: value }));
    let rapier = |field: &str, value: f64| {
        (json!({ "backend": "rapier", "rapier": { field: value } }), json!({}))
    };
    let stock = |field: &str, value: f64| {
        let leave = json!({ "contact_solver": "stock", field: value });
        (leave, json!({}))
    };
    type Typed<'a> = &'a dyn Fn(&str, f64) -> (Value, Value);
    let cases: [(Typed, &str, f64, &str, &str); 16] = [
        (&native, "grain_size_mm", 10.0, "found late", "notice"),
        (&native, "rate_hz", 432.0, "sink into each other", "takes longer"),
        (
            &native,
            "length_scale",
            80.0,
            "smaller than an engine unit",
            "larger than an engine unit",
        ),
        (&native, "restitution_velocity_threshold_m_per_s", 0.0022, "rebounding", "do not"),
        (&stock, "contact_threshold_mm", 1.25, "found late", "bear nothing"),
        (&solver, "substep_rate_hz", 1288.0, "too coarsely", "takes longer"),
        (&solver, "contact_stiffness_n_per_m", 11_000.0, "sink into each other", "more sub-steps"),
        (&solver, "max_depenetration_velocity_m_per_s", 0.335, "last", "burst"),
        (&settle, "rms_speed_mm_per_s", 22.4, "time limit", "still moves"),
        (&settle, "largest_speed_mm_per_s", 559.0, "time limit", "still fall"),
        (&settle, "hold_s", 0.28, "bounce", "longer than it needs"),
        (&rapier, "contact_frequency_hz", 447.0, "sink into each other", "substeps"),
        (&rapier, "engine_unit_mm", 12.5, "needlessly", "no longer there"),
        (&rapier, "prediction_mm", 0.375, "before they are met", "costs time"),
        (&rapier, "corrective_speed_m_per_s", 3.35, "last", "burst"),
        (&rapier, "recycling_distance_mm", 0.25, "creeps numerically", "out of date"),
    ];
    for (typed, field, automatic, low, high) in cases {
        for (factor, words) in [(0.2, Some(low)), (0.3, None), (3.3, None), (5.0, Some(high))] {
            let (mut engine, settle) = typed(field, automatic * factor);
            // Whether steps are too coarse to be run at all is another question.
            engine["allow_coarse_steps"] = json!(true);
            let of_coarse = |w: &String| w.contains("allow_coarse_steps");
            let said: Vec<String> =
                said_of(&engine, &settle).into_iter().filter(|w| !of_coarse(w)).collect();
            match words {
                None => assert!(said.is_empty(), "law: {factor} × {field} is usual: {said:?}"),
                Some(words) => assert!(
                    said.len() == 1 && said[0].contains(field) && said[0].contains(words),
                    "law: {factor} × {field} is unusual, and `{words}` is said: {said:?}"
                ),
            }
        }
    }
}

#[test]
fn automatic_values_are_usual_under_any_gravity() {
    for gravity in [1e-6, 0.01, 1.62, 100.0] {
        let mut scenario = small::layer(30.0);
        scenario["engine"] = json!({});
        scenario["gravity_m_per_s2"] = json!(gravity);
        for stage in scenario["stages"].as_array_mut().expect("stages") {
            stage["time_limit_s"] = json!(20);
        }
        let said = reported(&scenario);
        assert!(said.is_empty(), "law: what nobody typed is usual, {gravity} m/s²: {said:?}");
    }
}

#[test]
fn fields_that_nothing_reads_are_not_warned_of() {
    for engine in [
        json!({ "rapier": { "prediction_mm": 100 } }),
        json!({ "contact_solver": "stock", "native": { "substep_rate_hz": 100 } }),
        json!({ "backend": "rapier", "length_scale": 1 }),
        // The native contacts' own margin is shorter.
        json!({ "contact_threshold_mm": 9 }),
        json!({ "contact_solver": "stock", "contact_threshold_mm": 0.01,
                "stock": { "relative_contact_threshold": 0.02 } }),
    ] {
        let said = said_of(&engine, &json!({}));
        assert!(said.is_empty(), "law: {engine} changes nothing: {said:?}");
    }
}

/// A box with a deposit that is pressed later: what is said of the speed at which overlaps are
/// pushed apart, with engine settings and a speed of the deposit's own.
fn said_of_deposit(engine: Value, own: Option<f64>, is_pressed: bool) -> Vec<String> {
    let mut scenario = json!({
        "name": "pressed",
        "grains": small::fine(20.0),
        "pieces": [
            { "name": "box", "shape": { "box": { "inner_mm": [50, 50, 50] } } },
            { "name": "lid", "shape": { "plate": { "size_mm": [48, 48, 5] } }, "at_mm": [0, 0, 100] }
        ],
        "engine": engine,
        "stages": [
            { "stage": "deposit", "at_mm": [0, 0, 60], "area_mm": [40, 40], "rate_g_per_s": 50 },
            { "stage": "press", "loads": [{ "piece": "lid", "stress_kpa": 50 }] }
        ]
    });
    if let Some(own) = own {
        scenario["stages"][0]["max_depenetration_velocity_m_per_s"] = json!(own);
    }
    if !is_pressed {
        scenario["stages"][1] = json!({ "stage": "rest", "duration_s": 1 });
    }
    let said = reported(&scenario).into_iter();
    said.filter(|warning| warning.contains("max_depenetration_velocity_m_per_s")).collect()
}

/// Law: a speed typed for a load is warned of where a deposit before the load has it, and so is one of
/// the deposit's own that does not suit grains without a load; what suits them, or nobody typed, is
/// not.
#[test]
fn deposits_before_a_load_at_the_speed_of_the_load_are_warned_of() {
    let typed = |speed: f64| json!({ "native": { "max_depenetration_velocity_m_per_s": speed } });
    let own = "stages[0].max_depenetration_velocity_m_per_s: ";
    let all = "engine.native.max_depenetration_velocity_m_per_s: ";
    // Grains of 8 to 10 mm: 0.3 m/s, and 3 m/s under the load.
    for (engine, of_deposit, is_pressed, expected) in [
        (json!({}), None, true, None),
        (typed(3.0), None, true, Some((own, "engine.native, 3 m/s"))),
        (typed(3.0), Some(0.3), true, None),
        (typed(0.9), None, true, None),
        (typed(30.0), None, true, Some((all, "burst"))),
        (json!({}), Some(3.0), true, Some((own, "burst"))),
        (json!({}), Some(0.05), true, Some((own, "impacts leave last"))),
        (json!({}), Some(3.0), false, Some((own, "burst"))),
        (typed(3.0), None, false, Some((all, "burst"))),
    ] {
        let said = said_of_deposit(engine.clone(), of_deposit, is_pressed);
        let case = format!("{engine}, a deposit with {of_deposit:?}, pressed: {is_pressed}");
        match expected {
            None => assert!(said.is_empty(), "law: {case} is usual: {said:?}"),
            Some((path, words)) => assert!(
                said.len() == 1 && said[0].starts_with(path) && said[0].contains(words),
                "law: {case} is warned of at `{path}` with `{words}`: {said:?}"
            ),
        }
    }
}

/// Law: rapier and stock contacts do not read a deposit's own speed, and say so; native contacts do.
#[test]
fn a_speed_of_a_deposit_that_contacts_do_not_read_is_warned_of() {
    for (engine, who) in [
        (json!({ "backend": "rapier" }), "engine.rapier.corrective_speed_m_per_s"),
        (json!({ "contact_solver": "stock" }), "stock Bullet contacts"),
    ] {
        let said = said_of_deposit(engine.clone(), Some(0.3), false);
        let path = "stages[0].max_depenetration_velocity_m_per_s: without effect";
        assert!(
            said.len() == 1 && said[0].starts_with(path) && said[0].contains(who),
            "law: {engine} does not read it: {said:?}"
        );
        assert!(said_of_deposit(engine, None, false).is_empty(), "law: what nobody typed");
    }
    assert!(
        said_of_deposit(json!({}), Some(0.3), false).is_empty(),
        "law: native contacts read it"
    );
}

/// Law: openings of less than five grain diameters are warned of before the run.
#[test]
fn openings_that_are_narrow_for_the_grains_are_warned_of() {
    let said = |cylinder: f64, opening: f64| {
        let mut scenario = small::layer(30.0);
        scenario["apparatus"]["cylinder"]["inner_diameter_mm"] = json!(cylinder);
        scenario["apparatus"]["funnel"]["opening_diameter_mm"] = json!(opening);
        reported(&scenario)
    };
    // Grains of 10 to 12.5 mm.
    assert!(said(75.0, 72.0).is_empty(), "law: six grains are wide enough");
    let narrow = said(45.0, 40.0);
    for field in ["cylinder.inner_diameter_mm", "funnel.opening_diameter_mm"] {
        let told = narrow.iter().filter(|w| w.contains(field)).count();
        assert_eq!(told, 1, "law: `{field}` of four grains is warned of once: {narrow:?}");
    }
}

/// Law: contacts are as stiff as the load that seats the plate asks for; stiffness that is typed
/// for the plate alone is warned of.
#[test]
fn a_seating_load_asks_for_stiff_contacts() {
    let folder = tempfile::tempdir().expect("a folder");
    let load = |seating_n: f64, stiffness: Option<f64>| {
        let mut scenario = small::scenario(60.0, 0.5, 0.0);
        scenario["stages"][2]["seating_load_n"] = json!(seating_n);
        if let Some(typed) = stiffness {
            scenario["engine"] = json!({ "native": { "contact_stiffness_n_per_m": typed } });
        }
        let path = write(folder.path(), "s.json", &scenario);
        let loaded = load_scenario(&path, &[]).unwrap_or_else(|e| panic!("{e}"));
        let said: Vec<String> =
            warnings(&loaded.scenario).iter().map(ToString::to_string).collect();
        let of_stiffness = said.iter().filter(|w| w.contains("contact_stiffness")).count();
        (loaded.scenario.engine.native.contact_stiffness_n_per_m, of_stiffness)
    };
    let (alone, said) = load(0.0, None);
    assert_eq!(said, 0, "law: what nobody typed is usual");
    let (once, said) = load(200.0, None);
    assert!(once > 5.0 * alone, "law: stiffer under 200 N, expected 5 × {alone}, got {once} N/m");
    assert_eq!(said, 0, "law: what nobody typed is usual under a load, too");
    let (twice, _) = load(400.0, None);
    let ratio = twice / once;
    assert!((1.9..2.1).contains(&ratio), "law: as the stress, expected 2 times, got {ratio}");
    assert_eq!(load(0.0, Some(alone)).1, 0, "law: it suits the plate alone");
    assert_eq!(load(200.0, Some(alone)).1, 1, "law: too soft under 200 N, which is said once");
}

/// Law: where no stiffness that is allowed bears the load, as of grains in a box whose sizes were
/// typed in metres, no message asks to leave out a field that is left out, or to type what is refused.
#[test]
fn a_load_that_no_contact_bears_asks_for_units() {
    let mut scenario = json!({
        "name": "metres",
        "grains": small::fine(100.0),
        "pieces": [{ "name": "box", "shape": { "box": { "inner_mm": [0.01, 0.01, 0.1] } } }],
        "stages": [{ "stage": "deposit", "how": "lattice", "at_mm": [0, 0, 50], "area_mm": [9, 9] }],
    });
    let said = |scenario: &Value| -> Vec<String> {
        reported(scenario).into_iter().filter(|text| text.contains("too soft")).collect()
    };
    let [told] = &said(&scenario)[..] else { panic!("law: told once") };
    assert_holds(told, &["found 1000000000;", "less load", "units"]);
    assert!(!told.contains("left out"), "law: it is left out already: {told}");
    scenario["pieces"][0]["shape"]["box"]["inner_mm"] = json!([50, 50, 100]);
    scenario["engine"] = json!({ "native": { "contact_stiffness_n_per_m": 1 } });
    let typed = reported(&scenario);
    assert!(typed.iter().any(|text| text.contains("field left out")), "law: or so: {typed:?}");
}

/// Law: cells of one cube have about one size, so a fraction of 10 to 40 mm gives grains of about
/// 25 mm (D50 25.6 mm where 20 are specified); spheres spread over it, and so do narrower fractions.
#[test]
fn a_fraction_too_wide_for_cells_is_reported() {
    let said = |shape: &str, rows: &[[f64; 3]]| {
        let mut table = Vec::new();
        for [passing, retained, percent] in rows {
            table.push(json!({
                "passing_mm": passing, "retained_mm": retained, "mass_percent": percent
            }));
        }
        let scenario = json!({
            "name": "wide",
            "grains": {
                "shape": shape, "total_mass_g": 2000, "density_kg_per_m3": 2650,
                "sieve_table": table,
            },
            "stages": [{ "stage": "fill_funnel" }],
        });
        let said = reported(&scenario).into_iter();
        said.filter(|text| text.contains("too wide for cells")).collect::<Vec<_>>()
    };
    let wide = said("cells", &[[40.0, 10.0, 100.0]]);
    let [wide] = &wide[..] else { panic!("law: said once: {wide:?}") };
    let words = ["grains.sieve_table[0].retained_mm", "25 mm", "found 10;", "at least 16 mm"];
    assert_holds(wide, &words);
    let none: [String; 0] = [];
    assert_eq!(said("spheres", &[[40.0, 10.0, 100.0]]), none, "law: spheres spread over it");
    assert_eq!(said("cells", &[[40.0, 20.0, 50.0], [20.0, 10.0, 50.0]]), none, "law: narrower");
    let gap = [[40.0, 20.0, 50.0], [20.0, 6.0, 0.0], [6.0, 4.0, 50.0]];
    assert_eq!(said("cells", &gap), none, "law: where no grains are, none are missing");
}

/// Law: where the table vibrates faster than the paper's, samples too far apart to show it are warned
/// of, with an interval that shows it.
#[test]
fn samples_that_do_not_show_a_vibration_are_warned_of() {
    let said = |frequency_hz: f64, every: Option<f64>| -> Vec<String> {
        let mut scenario = small::scenario(30.0, 1.0, 1.0);
        scenario["stages"][3]["frequency_hz"] = json!(frequency_hz);
        scenario["stages"][3]["amplitude_mm"] = json!(2);
        if let Some(every) = every {
            scenario["sample_interval_s"] = json!(every);
        }
        reported(&scenario).into_iter().filter(|text| text.contains("sample_interval_s")).collect()
    };
    assert_eq!(said(3.0, None), [""; 0], "law: the paper's vibration as it was read");
    assert_eq!(said(10.0, Some(0.0125)), [""; 0], "law: eight samples a cycle");
    let told = said(10.0, None);
    assert_eq!(told.len(), 1, "law: said once, got {told:?}");
    let words = ["sample_interval_s", "10 Hz has 1.25 samples a cycle", "found 0.08", "0.012"];
    assert_holds(&told[0], &words);
}
