//! How often a run is sampled: more or fewer rows, and not another bit of what happens.

use std::sync::{Arc, atomic::AtomicBool};

use pluvia::{
    grains::{self, load_scenario},
    protocol::{self, Moment, Observer, Setup},
    scenario::GrainsSpec,
    specimen::{Specimen, SpecimenState},
    world,
};
use serde_json::{Value, json};

use super::{program::Folder, small};

/// Times of what is shown of a stage, in s since it began, and how often it is looked at.
#[derive(Default)]
struct Seen {
    shown: Vec<f64>,
    looks: usize,
}

impl Observer for Seen {
    fn observe(&mut self, specimen: &Specimen, moment: Moment) {
        let is_there = specimen.present().all(|n| specimen.centroid(n).z.is_finite());
        assert!(is_there, "law: what is shown has a place");
        self.shown.push(moment.stage_time);
    }

    fn look(&mut self, _: &Specimen, _: f64) {
        self.looks += 1;
    }
}

/// The specimen at the end of all stages of a scenario, and what was seen of each; all at an
/// interval in s, where one is given.
fn gone(mut scenario: Value, every: Option<f64>) -> (SpecimenState, Vec<Seen>, f64) {
    if let Some(every) = every {
        scenario["sample_interval_s"] = json!(every);
    }
    let folder = Folder::new();
    let loaded = load_scenario(folder.scenario("s.json", &scenario).as_ref(), &[]);
    let scenario = loaded.unwrap_or_else(|e| panic!("{e}")).scenario;
    let setup = Setup::new(&scenario).expect("a laboratory");
    let GrainsSpec::Sieved(sieved) = &scenario.grains else { panic!("sieved") };
    let grains = Arc::new(grains::generate(sieved, scenario.seed).expect("grains"));
    let state = SpecimenState::before_everything(grains.grains.len());
    let mut specimen = Specimen { grains, state };
    let mut seen = Vec::new();
    for stage in &scenario.stages {
        let (mut of_stage, never) = (Seen::default(), AtomicBool::new(false));
        let make = &world::create;
        let outcome = protocol::run(&setup, make, specimen, stage, None, &mut of_stage, &never)
            .expect("it runs");
        specimen = outcome.specimen;
        seen.push(of_stage);
    }
    (specimen.state, seen, 1.0 / scenario.engine.rate_hz)
}

/// A layer under a plate that is shaken.
fn shaken() -> Value {
    let mut layer = small::layer(20.0);
    let stages = layer["stages"].as_array_mut().expect("stages");
    stages
        .push(json!({ "stage": "vibrate", "frequency_hz": 3, "amplitude_mm": 5, "duration_s": 1 }));
    layer["rest_test_s"] = json!(4);
    layer
}

/// Grains under a lid that is pressed on, held, and pressed on again from what it bears.
fn pressed() -> Value {
    let press = |force: f64| {
        json!({ "stage": "press",
            "loads": [{ "piece": "lid", "force_n": force, "mass_g": 100 }] })
    };
    json!({
        "name": "pressed",
        "grains": small::fine(20.0),
        "pieces": [
            { "name": "box", "shape": { "box": { "inner_mm": [50, 50, 100] } } },
            { "name": "lid", "shape": { "plate": { "size_mm": [48, 48, 10] } },
              "at_mm": [0, 0, 130] }
        ],
        "stages": [
            { "stage": "deposit", "at_mm": [0, 0, 90], "area_mm": [40, 40], "rate_g_per_s": 400,
              "time_limit_s": 2 },
            press(2.0),
            { "stage": "move", "pieces": ["lid"], "velocity_mm_per_s": [0, 0, -1],
              "duration_s": 0.2 },
            press(4.0)
        ],
        "rest_test_s": 0
    })
}

/// Law: an interval of samples gives a row for each of them and at the ends, and everything moves to
/// the bit as without it; nor are there more or fewer looks.
#[test]
fn samples_change_nothing_of_what_happens() {
    for scenario in [shaken(), pressed()] {
        let name = scenario["name"].clone();
        let (plain, seen, step) = gone(scenario.clone(), None);
        for every in [0.01, 0.4] {
            let (got, finer, _) = gone(scenario.clone(), Some(every));
            assert!(got == plain, "law: {name} ends in the same state at {every} s");
            for (n, (seen, finer)) in seen.iter().zip(&finer).enumerate() {
                assert_eq!(finer.looks, seen.looks, "law: as many looks, stage {n} of {name}");
                let [end, same] = [seen, finer].map(|of| of.shown.last().copied().unwrap_or(0.0));
                assert_eq!(same, end, "law: the end is shown, stage {n} of {name}");
                let (expected, got) = ((end / every).floor() + 1.0, finer.shown.len() as f64);
                // The ends of shaking and stage, and one that is due a step after the end.
                assert!(
                    (-1.0..=2.0).contains(&(got - expected)),
                    "law: a row every {every} s and at ends, stage {n} of {name}, {end} s long: \
                     expected {expected}, at most two more, got {got}"
                );
                let gap = finer.shown.windows(2).map(|pair| pair[1] - pair[0]).fold(0.0, f64::max);
                assert!(
                    gap < every + 1.01 * step,
                    "law: rows {every} s apart to a step, stage {n} of {name}, got {gap} s"
                );
            }
        }
    }
}
