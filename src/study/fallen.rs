//! Grains that fall out of a laboratory of pieces though nothing in its scenario says that they shall.

use super::*;
use super::{begin::Begun, lids::rim_mm};
use crate::scenario::{BoxSide, PieceSpec, ShapeSpec};

/// How many grains deposits let fall beside the container of a laboratory, which is not full. None
/// where they may have another place to go, or run over its rim by design: where anything stands but
/// one open container, rings on it and pieces that are pressed, or an opening is measured.
pub(super) fn beside_container(
    scenario: &Scenario,
    grains: &Arc<GrainSet>,
    stages: &[&StoredStage],
) -> Option<usize> {
    let (container, rim_mm) = container_with_rim(scenario)?;
    let fills =
        |stage: &&StageSpec| matches!(stage, StageSpec::Deposit(_) | StageSpec::Rest { .. });
    let filling = scenario.stages.iter().take_while(fills).count();
    let state = &stages.get(..filling)?.last()?.state;
    let specimen = Specimen { grains: grains.clone(), state: state.clone() };
    // What lies on the rim itself says nothing of what is within.
    let is_full = specimen.present().any(|grain| {
        specimen.top(grain) >= from_mm(rim_mm) && is_over(container, &specimen.centroid(grain))
    });
    (!is_full).then(|| spilled(state))
}

/// Whether a place in m is above or within the inside of a container.
fn is_over(container: &PieceSpec, place: &Vector) -> bool {
    let [x, y, _] = container.at_mm;
    let (x, y) = (to_mm(place.x) - x, to_mm(place.y) - y);
    match &container.shape {
        ShapeSpec { cylinder: Some(c), .. } => x.hypot(y) < c.inner_diameter_mm / 2.0,
        ShapeSpec { r#box: Some(b), .. } => {
            x.abs() < b.inner_mm[0] / 2.0 && y.abs() < b.inner_mm[1] / 2.0
        }
        _ => false,
    }
}

/// The only container of a scenario, and the height in mm of its rim or of that of the rings on it.
fn container_with_rim(scenario: &Scenario) -> Option<(&PieceSpec, f64)> {
    if scenario.begin.is_some() || !scenario.measures.openings.is_empty() {
        return None;
    }
    let is_pressed = |name: &str| {
        let mut loads = scenario.stages.iter().flat_map(|stage| match stage {
            StageSpec::Press(press) => &press.loads[..],
            _ => &[],
        });
        loads.any(|load| load.piece == name)
    };
    let (mut containers, mut rim) = (Vec::new(), f64::NEG_INFINITY);
    for piece in &scenario.pieces {
        match (rim_mm(piece), has_floor(piece)) {
            (Some(own), Some(floor)) => {
                containers.extend(floor.then_some(piece));
                rim = rim.max(own);
            }
            _ if is_pressed(&piece.name) => {}
            _ => return None,
        }
    }
    let [container] = containers[..] else { return None };
    Some((container, rim))
}

/// Whether a piece with whole walls has a floor, and is not a ring; none of one without walls.
fn has_floor(piece: &PieceSpec) -> Option<bool> {
    if let Some(cylinder) = &piece.shape.cylinder {
        return Some(!cylinder.open_bottom);
    }
    let open = &piece.shape.r#box.as_ref()?.open;
    let walls = [BoxSide::LowX, BoxSide::HighX, BoxSide::LowY, BoxSide::HighY];
    let is_whole = !walls.iter().any(|wall| open.contains(wall));
    is_whole.then(|| !open.contains(&BoxSide::Bottom))
}

/// What there is to say of grains that fell out in stages that do not say so themselves, as deposits
/// do, while nothing had been removed, let go or turned over, no hopper stands, and no opening is
/// measured.
pub(super) fn unexplained(
    scenario: &Scenario,
    begun: Option<&Begun>,
    stages: &[&StoredStage],
    rest_test: Option<&StoredStage>,
) -> Vec<String> {
    let has_hopper = scenario.pieces.iter().any(|piece| piece.shape.hopper.is_some());
    if scenario.pieces.is_empty() || has_hopper || !scenario.measures.openings.is_empty() {
        return Vec::new();
    }
    let mut done = scenario.begin.iter().flat_map(|begin| &begin.after);
    // How a piece was moved before, its run knows.
    let mut has_way_out = done.any(|stage| matches!(stage.as_str(), "move" | "release" | "remove"));
    let mut before = begun.map(|begun| &begun.state);
    let mut found = Vec::new();
    let specs = scenario.stages.iter().map(Some).chain([None]);
    let all = stages.iter().copied().chain(rest_test);
    for (n, (spec, stage)) in specs.zip(all).enumerate() {
        has_way_out |= match spec {
            Some(StageSpec::Remove(_) | StageSpec::Release(_)) => true,
            Some(StageSpec::Move(motion)) => motion.rotation.is_some(),
            _ => false,
        };
        let fell = spilled(&stage.state).saturating_sub(before.map_or(0, spilled));
        let is_deposit = matches!(spec, Some(StageSpec::Deposit(_)));
        if fell > 0 && !has_way_out && !is_deposit {
            let place = match spec {
                Some(spec) => format!("stage {n}, {}", spec.name()),
                None => "the rest test".to_owned(),
            };
            let there = with_fate(&stage.state, Fate::Present) + fell;
            found.push(format!(
                "{place}: {fell} of {} fell out of the laboratory, and no opening measures {}",
                counted(there, "grain"),
                in_number(fell, "it", "them")
            ));
        }
        before = Some(&stage.state);
    }
    found
}

fn spilled(state: &SpecimenState) -> usize {
    with_fate(state, Fate::Spilled)
}

fn with_fate(state: &SpecimenState, fate: Fate) -> usize {
    state.bodies.iter().filter(|grain| grain.fate == fate).count()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Pose;
    use crate::study::tests::planned;

    /// A change of a scenario.
    type Change<'a> = &'a dyn Fn(&mut Value);

    /// A laboratory of a box and a lid that is pressed, as it is changed.
    fn scenario(change: impl Fn(&mut Value)) -> Scenario {
        let mut scenario = json!({
            "name": "box",
            "grains": { "total_mass_g": 15, "density_kg_per_m3": 2650, "sieve_table":
                [{ "passing_mm": 10, "retained_mm": 8, "mass_percent": 100 }] },
            "pieces": [
                { "name": "box", "shape": { "box": { "inner_mm": [60, 60, 50] } } },
                { "name": "lid", "shape": { "plate": { "size_mm": [58, 58, 5] } },
                  "at_mm": [0, 0, 90] }
            ],
            "stages": [
                { "stage": "deposit", "at_mm": [0, 0, 70], "area_mm": [40, 40], "rate_g_per_s": 60 },
                { "stage": "press", "loads": [{ "piece": "lid", "force_n": 1 }] }
            ]
        });
        change(&mut scenario);
        serde_json::from_value(scenario).expect("a scenario")
    }

    /// The ends of stages, by the number of grains that have fallen out until then; the others lie
    /// with their centroids at a height in m.
    fn ends(count: usize, fallen: &[usize], height: f64) -> Vec<StoredStage> {
        let end = |fallen: &usize| {
            let mut state = SpecimenState::before_everything(count);
            for (n, grain) in state.bodies.iter_mut().enumerate() {
                grain.body.pose = Pose::translation(0.001 * n as f64, 0.0, height);
                grain.fate = if n < *fallen { Fate::Spilled } else { Fate::Present };
            }
            StoredStage { record: StageRecord::default(), state, series: Vec::new() }
        };
        fallen.iter().map(end).collect()
    }

    /// Law: what misses the one container there is, which is not full, is missing; what runs over a
    /// full one, or may have another place to go, is not.
    #[test]
    fn grains_that_miss_the_container_are_missing() {
        let of = |change: &dyn Fn(&mut Value), height: f64| {
            let run = planned(scenario(change));
            let ends = ends(run.grains.grains.len(), &[5, 7], height);
            let stages: Vec<&StoredStage> = ends.iter().collect();
            beside_container(&run.scenario, &run.grains, &stages)
        };
        let plain = |_: &mut Value| ();
        assert_eq!(of(&plain, 0.01), Some(5), "law: those of the deposit, none of the press");
        assert_eq!(of(&plain, 0.06), None, "law: a full box may run over");
        let aside = |s: &mut Value| s["pieces"][0]["at_mm"] = json!([-35, 0, 0]);
        assert_eq!(of(&aside, 0.06), Some(5), "law: grains that lie on its rim do not fill it");
        let push = |s: &mut Value, piece: Value| {
            s["pieces"].as_array_mut().expect("a list").push(piece);
        };
        let ring = |s: &mut Value| {
            let shape = json!({ "box": { "inner_mm": [60, 60, 30], "open": ["top", "bottom"] } });
            push(s, json!({ "name": "ring", "shape": shape, "at_mm": [0, 0, 50] }));
        };
        assert_eq!(of(&ring, 0.06), Some(5), "law: with a ring on it the rim is higher");
        let base = |s: &mut Value| {
            let shape = json!({ "plate": { "size_mm": [300, 300, 10] } });
            push(s, json!({ "name": "base", "shape": shape, "at_mm": [0, 0, -15] }));
        };
        let second = |s: &mut Value| {
            let shape = json!({ "cylinder": { "inner_diameter_mm": 60, "height_mm": 50 } });
            push(s, json!({ "name": "pot", "shape": shape, "at_mm": [200, 0, 0] }));
        };
        let no_wall = |s: &mut Value| {
            s["pieces"][0]["shape"]["box"]["open"] = json!(["top", "high_x"]);
        };
        let turned = |s: &mut Value| s["pieces"][0]["rotation_deg"] = json!([0, 20, 0]);
        let measured = |s: &mut Value| {
            let edge = json!({ "name": "edge", "at_mm": [0, 0, -20], "diameter_mm": 300 });
            s["measures"] = json!({ "openings": [edge] });
        };
        let begun = |s: &mut Value| s["begin"] = json!({ "specimen": "run" });
        let moved = |s: &mut Value| s["stages"].as_array_mut().expect("a list").swap(0, 1);
        let cases: [(&str, Change); 7] = [
            ("a base takes them", &base),
            ("two containers", &second),
            ("a box without a wall", &no_wall),
            ("a box that leans", &turned),
            ("an opening measures them", &measured),
            ("it is begun with", &begun),
            ("there is no deposit before the press", &moved),
        ];
        for (what, change) in cases {
            assert_eq!(of(change, 0.01), None, "law: nothing is known, {what}");
        }
    }

    /// Law: what falls out in a press, a motion or a rest is said with its stage, unless a way out
    /// was made, stands or is measured; what a deposit loses it says itself.
    #[test]
    fn grains_that_fall_out_without_a_cause_are_reported_with_their_stage() {
        let said = |change: &dyn Fn(&mut Value), fallen: &[usize]| {
            let scenario = scenario(change);
            let ends = ends(10, fallen, 0.01);
            let (rest_test, stages) = ends.split_last().expect("ends");
            let stages: Vec<&StoredStage> = stages.iter().collect();
            unexplained(&scenario, None, &stages, Some(rest_test))
        };
        let plain = |_: &mut Value| ();
        assert_eq!(said(&plain, &[3, 3, 3]), [""; 0], "law: the deposit says it");
        let told = said(&plain, &[3, 5, 6]);
        let starts = ["stage 1, press: 2 of 7 grains fell", "the rest test: 1 of 5 grains fell"];
        let sound = told.len() == 2 && told.iter().zip(starts).all(|(t, s)| t.starts_with(s));
        assert!(sound, "law: {starts:?}, got {told:?}");
        let turned = |s: &mut Value| {
            s["stages"][1] = json!({ "stage": "move", "travel_deg": 90,
                "rotation": { "axis": [0, 1, 0], "deg_per_s": 90 } });
        };
        let removed =
            |s: &mut Value| s["stages"][1] = json!({ "stage": "remove", "pieces": ["box"] });
        for change in [&turned as &dyn Fn(&mut Value), &removed] {
            assert_eq!(said(change, &[0, 5, 6]), [""; 0], "law: they are let out");
        }
        let shaken = |s: &mut Value| {
            s["stages"][1] = json!({ "stage": "move", "duration_s": 1,
                "sine": { "amplitude_mm": [0, 0, 5], "frequency_hz": 10 } });
        };
        assert_eq!(said(&shaken, &[0, 5, 5]).len(), 1, "law: they are thrown out");
    }
}
