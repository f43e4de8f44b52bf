//! A small run made up for the tests of this module.

use serde_json::json;

use super::parts::parts;
use super::*;
use crate::scenario::GrainsSpec;
use crate::specimen::FunnelState;

/// Speed of every grain along z, in m/s.
pub(super) const SPEED: f64 = 0.5;

/// A laboratory, and thirty grams of two sieve fractions.
pub(crate) fn laboratory() -> (Setup, Arc<GrainSet>) {
    let value = json!({
        "name": "made up",
        "grains": {
            "total_mass_g": 30, "density_kg_per_m3": 2673.9,
            "sieve_table": [
                { "passing_mm": 16, "retained_mm": 12.5, "mass_percent": 40 },
                { "passing_mm": 12.5, "retained_mm": 10, "mass_percent": 60 },
            ]
        },
        "stages": [{ "stage": "fill_funnel" }, { "stage": "pour", "falling_height_mm": 0 }],
    });
    let scenario: Scenario = serde_json::from_value(value).expect("a scenario");
    let GrainsSpec::Sieved(sieved) = &scenario.grains else { panic!("grains by sieve") };
    let grains = Arc::new(grains::generate(sieved, 1).expect("grains"));
    (Setup::new(&scenario).expect("a laboratory"), grains)
}

/// Stages, each with its number of frames, `step` s apart: grains rise with [`SPEED`]
/// on a table that moves along x, the second of them is gone, a funnel without
/// lid stands in the first stage, and the plate lies from the second on.
pub(super) fn moments(frames: &[usize], step: f64) -> Moments {
    let (setup, grains) = laboratory();
    let mut time = 0.0;
    let mut stages = Vec::new();
    for (number, &count) in frames.iter().enumerate() {
        let times = (0..count).map(|n| time + step * n as f64);
        let states: Vec<SpecimenState> =
            times.map(|t| state(t, number, grains.grains.len())).collect();
        let frames: Vec<Frame> = states.iter().map(Frame::of).collect();
        let end = states.into_iter().last().expect("a frame");
        time = end.time;
        let begin = frames.first().cloned();
        stages.push(StageMoments { name: format!("stage_{number}"), frames, begin, end });
    }
    let parts = parts(&setup, &grains, None).expect("an apparatus");
    Moments { scenario: "made up".to_owned(), setup, grains, parts, stages }
}

/// Displacement of the table in m.
pub(super) fn table_x(time: f64) -> f64 {
    0.02 * (7.0 * time).sin()
}

fn state(time: f64, stage: usize, grains: usize) -> SpecimenState {
    let table_x = table_x(time);
    let pose = |n: usize| {
        let (row, column) = ((n / 5) as f64, (n % 5) as f64);
        let at = Vector::new(0.02 * (column - 2.0) + table_x, 0.02 * row, 0.01 + SPEED * time);
        Pose::new(at, Vector::z() * (time * (1.0 + n as f64)))
    };
    let bodies = (0..grains).map(|n| GrainState {
        body: BodyState { linear_velocity: Vector::z() * SPEED, ..BodyState::at_rest(pose(n)) },
        fate: if n == 1 { Fate::Spilled } else { Fate::Present },
    });
    let contact = |first, second, force: [f64; 3]| SavedContact {
        between: [first, second],
        point_m: Vector::new(0.01, 0.0, 0.02),
        normal: Vector::z(),
        force_n: force.into(),
        warm_start: 1.0,
        feature: [0, 0],
    };
    SpecimenState {
        bodies: bodies.collect(),
        funnel: (stage == 0).then_some(FunnelState { opening_height: 0.2, lid: false }),
        cylinder: true,
        top_plate: (stage > 0).then(|| BodyState::at_rest(Pose::translation(table_x, 0.0, 0.1))),
        contacts: vec![
            contact(Party::Grain(0), Party::Grain(2), [3.0, 0.0, 4.0]),
            contact(Party::Grain(2), Party::Grain(0), [0.0, 0.0, -1.0]),
            contact(Party::Grain(0), Party::Other(Other::Cylinder(48)), [0.0, 0.0, 2.0]),
            contact(Party::Other(Other::TopPlate), Party::Grain(3), [0.0, 0.0, 1.0]),
        ],
        table_x,
        time,
        ..SpecimenState::before_everything(0)
    }
}
