//! Pieces that are pressed down into a container that they do not fit into: where they meet its rim,
//! the run ends.

use super::*;
use crate::apparatus::{RigidPiece, overlaps};
use crate::scenario::{BoxSide, PieceSpec, ShapeSpec};

/// Heights in mm that differ by less are the same.
const ROUNDING: f64 = 1e-6;

/// What there is to say of the pieces that a scenario presses down: of those that no stage has
/// handled before, over containers that none has.
pub(super) fn too_wide(scenario: &Scenario) -> Vec<String> {
    // Where the pieces of a begun specimen are, its run knows.
    if scenario.begin.is_some() {
        return Vec::new();
    }
    let mut found = Vec::new();
    for (i, stage) in scenario.stages.iter().enumerate() {
        let StageSpec::Press(press) = stage else { continue };
        let stays = |name: &str| scenario.stages[..i].iter().all(|stage| !handles(stage, name));
        for (k, load) in press.loads.iter().enumerate() {
            let [x, y, z] = load.direction;
            let by_force = load.force_n.is_some() || load.stress_kpa.is_some();
            let is_down = x == 0.0 && y == 0.0 && z < 0.0;
            let lid = scenario.pieces.iter().find(|piece| piece.name == load.piece);
            let lid = lid.filter(|lid| by_force && is_down && stays(&lid.name));
            let container = lid.and_then(|lid| too_narrow(&scenario.pieces, lid));
            let is_alone = |of: &&PieceSpec| {
                stays(&of.name) && !press.loads.iter().any(|l| l.piece == of.name)
            };
            let Some(container) = container.filter(is_alone) else { continue };
            let (lid, container) = (&load.piece, &container.name);
            let why = format!(
                "`{lid}` does not fit into `{container}`, above which it begins: pressed down to the \
                 rim it would get into the walls, which ends the run with an error"
            );
            let allowed = format!("a piece that fits into `{container}`");
            let place = format!("stages[{i}].loads[{k}].piece");
            found.push(Fault::new(why, format!("{lid:?}"), allowed).at(place).to_string());
        }
    }
    found
}

/// Whether a stage moves, presses, releases or removes a piece.
fn handles(stage: &StageSpec, name: &str) -> bool {
    let is_in = |names: &[String]| names.iter().any(|of| of == name);
    match stage {
        StageSpec::Move(stage) => stage.pieces.is_empty() || is_in(&stage.pieces),
        StageSpec::Press(stage) => stage.loads.iter().any(|load| load.piece == name),
        StageSpec::Release(stage) => is_in(&stage.pieces),
        StageSpec::Remove(stage) => is_in(&stage.pieces),
        _ => false,
    }
}

/// The container above whose rim a piece begins, of several the highest, where the piece does not
/// fit into it.
fn too_narrow<'a>(pieces: &'a [PieceSpec], lid: &PieceSpec) -> Option<&'a PieceSpec> {
    let [low, high] = ends_mm(lid)?;
    let is_below = |[from, to]: [Vector; 2]| (0..2).all(|k| from[k] < high[k] && to[k] > low[k]);
    let others = pieces.iter().filter(|piece| piece.name != lid.name);
    let containers = others.filter_map(|piece| Some((piece, rim_mm(piece)?, ends_mm(piece)?)));
    let below = containers.filter(|(.., ends)| is_below(*ends));
    let (container, rim, _) = below.max_by(|a, b| a.1.total_cmp(&b.1))?;
    if low.z < rim - ROUNDING {
        return None;
    }
    let half_in = (high.z - low.z).min(rim - container.at_mm[2]) / 2.0;
    let mut sunk = lid.clone();
    sunk.at_mm[2] -= low.z - rim + half_in;
    (!overlaps(&[container.clone(), sunk]).is_empty()).then_some(container)
}

/// Height in mm of the rim of a container that stands upright and is open above; none of another
/// piece.
pub(super) fn rim_mm(piece: &PieceSpec) -> Option<f64> {
    let height = match &piece.shape {
        ShapeSpec { r#box: Some(b), .. } if b.open.contains(&BoxSide::Top) => b.inner_mm[2],
        ShapeSpec { cylinder: Some(c), .. } if c.open_top => c.height_mm,
        _ => return None,
    };
    (piece.rotation_deg == [0.0; 3]).then_some(piece.at_mm[2] + height)
}

/// Lowest and highest coordinates in mm of a piece as it is put up; none of one that cannot be
/// built.
fn ends_mm(spec: &PieceSpec) -> Option<[Vector; 2]> {
    let piece = RigidPiece::new(spec).ok()?;
    let parts = piece.parts.iter().map(|part| {
        let (low, high) = part.shape.transformed(&(piece.at * part.pose)).bounding_box();
        [low, high].map(|end| end.coords.map(to_mm))
    });
    parts.reduce(|one, other| [one[0].inf(&other[0]), one[1].sup(&other[1])])
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A change of a scenario.
    type Change<'a> = &'a dyn Fn(&mut Value);

    /// What is said of a box of 90 mm and a lid over it, as the scenario is changed.
    fn said(lid_mm: [f64; 2], change: impl Fn(&mut Value)) -> Vec<String> {
        let [a, b] = lid_mm;
        let mut scenario = json!({
            "name": "pressed",
            "grains": { "file": "g.json" },
            "pieces": [
                { "name": "box", "shape": { "box": { "inner_mm": [90, 90, 60] } } },
                { "name": "lid", "shape": { "plate": { "size_mm": [a, b, 8] } },
                  "at_mm": [0, 0, 100] }
            ],
            "stages": [
                { "stage": "deposit", "at_mm": [0, 0, 80], "area_mm": [60, 60], "rate_g_per_s": 60 },
                { "stage": "press", "loads": [{ "piece": "lid", "stress_kpa": 10 }] }
            ]
        });
        change(&mut scenario);
        too_wide(&serde_json::from_value(scenario).expect("a scenario"))
    }

    /// Law: a lid that is wider than its box in either direction is known before it is pressed, one
    /// that fits is fine, and so is one of which only a run shows where it is.
    #[test]
    fn a_lid_that_does_not_fit_into_its_box_is_known_before_the_run() {
        let plain = |_: &mut Value| ();
        for wide in [[100.0, 88.0], [88.0, 100.0], [90.1, 90.1]] {
            let told = said(wide, plain);
            let sound = told.len() == 1
                && told[0].starts_with("stages[1].loads[0].piece: `lid` does not fit into `box`");
            assert!(sound, "law: a lid of {wide:?} mm, got {told:?}");
        }
        for fits in [[88.0, 88.0], [90.0, 90.0]] {
            assert_eq!(said(fits, plain), [""; 0], "law: a lid of {fits:?} mm fits");
        }
        let aside = |s: &mut Value| s["pieces"][1]["at_mm"] = json!([3, 0, 100]);
        assert_eq!(said([88.0, 88.0], aside).len(), 1, "law: it meets one wall");
        let beside = |s: &mut Value| s["pieces"][1]["at_mm"] = json!([300, 0, 100]);
        let crosses = |s: &mut Value| s["pieces"][1]["may_cross"] = json!(true);
        let locked = |s: &mut Value| {
            s["stages"][1]["loads"][0] = json!({ "piece": "lid", "locked": true });
        };
        let moved = |s: &mut Value| {
            s["stages"][0] =
                json!({ "stage": "move", "velocity_mm_per_s": [1, 0, 0], "travel_mm": 9 });
        };
        let begun = |s: &mut Value| s["begin"] = json!({ "specimen": "run" });
        let ring = |s: &mut Value| {
            let ring = json!({ "name": "ring", "at_mm": [0, 0, 60], "shape":
                { "box": { "inner_mm": [120, 120, 20], "open": ["top", "bottom"] } } });
            s["pieces"].as_array_mut().expect("a list").push(ring);
        };
        let cases: [(&str, Change); 6] = [
            ("beside it", &beside),
            ("it may cross it", &crosses),
            ("it is held", &locked),
            ("all has moved", &moved),
            ("it is begun with", &begun),
            ("it fits into the ring above", &ring),
        ];
        for (what, change) in cases {
            assert_eq!(said([100.0, 100.0], change), [""; 0], "law: {what}");
        }
    }

    /// Law: round walls are judged as they stand, flat by flat: a disc of the same circle fits.
    #[test]
    fn a_disc_in_a_cylinder_is_judged_by_its_flats() {
        let round = |diameter: f64| {
            said([1.0, 1.0], |s| {
                s["pieces"][0]["shape"] =
                    json!({ "cylinder": { "inner_diameter_mm": 80, "height_mm": 60 } });
                s["pieces"][1]["shape"] =
                    json!({ "disc": { "diameter_mm": diameter, "thickness_mm": 8 } });
            })
            .len()
        };
        assert_eq!([79.0, 80.0, 80.5, 99.0].map(round), [0, 0, 1, 1], "law: up to 80 mm it fits");
    }
}
