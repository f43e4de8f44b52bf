//! Peaks and jumps of what a scenario moves: the table, and the pieces of a laboratory.

use super::*;
use crate::apparatus::RigidPiece;
use crate::motion::{Path as MotionPath, PieceMotion};

/// Of each stage that moves something, with its number and its name.
pub(super) fn motions<'a>(
    scenario: &'a Scenario,
    setup: &'a Setup,
) -> impl Iterator<Item = (usize, &'static str, MotionFacts)> + 'a {
    let stages = scenario.stages.iter().enumerate();
    stages.filter_map(move |(n, stage)| {
        let facts = of_table(stage, setup).or_else(|| of_pieces(stage, setup))?;
        Some((n, stage.name(), facts))
    })
}

/// Of a stage that shakes the table; none of another.
pub(super) fn of_table(stage: &StageSpec, setup: &Setup) -> Option<MotionFacts> {
    Some(MotionFacts::of(&stage.motion()?, 1.0 / setup.engine.rate_hz))
}

/// Of a stage that moves pieces; none of another. Of a rotation those of the farthest point of its
/// pieces, where they are put up.
pub(super) fn of_pieces(stage: &StageSpec, setup: &Setup) -> Option<MotionFacts> {
    let StageSpec::Move(spec) = stage else { return None };
    let motion = stage.piece_motion()?;
    let is_moved =
        |piece: &&RigidPiece| spec.pieces.is_empty() || spec.pieces.contains(&piece.name);
    let reach = setup.pieces.iter().filter(is_moved).map(|piece| reach_from_axis(piece, &motion));
    Some(MotionFacts::of_pieces(&motion, reach.fold(0.0, f64::max)))
}

/// Distance in m of the farthest point of a piece from the axis of a rotation; 0 of another motion.
fn reach_from_axis(piece: &RigidPiece, motion: &PieceMotion) -> f64 {
    let MotionPath::Rotation { axis, about, .. } = &motion.path else { return 0.0 };
    let axis = piece.at.inverse_transform_vector(axis);
    piece.reach_from(&axis, &piece.at.inverse_transform_point(about))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Law: every motion of pieces is reported, a recorded one as the others; a block that turns about
    /// a lower edge is fastest at the upper edge across.
    #[test]
    fn motions_of_pieces_are_reported() {
        let scenario: Scenario = serde_json::from_value(json!({
            "name": "moves",
            "grains": { "total_mass_g": 40, "density_kg_per_m3": 2650, "sieve_table":
                [{ "passing_mm": 10, "retained_mm": 8, "mass_percent": 100 }] },
            "pieces": [
                { "name": "block", "shape": { "plate": { "size_mm": [30, 50, 40] } },
                  "at_mm": [15, 0, 20] },
                { "name": "far", "shape": { "plate": { "size_mm": [10, 10, 10] } },
                  "at_mm": [900, 0, 0] }
            ],
            "stages": [
                { "stage": "rest", "duration_s": 1 },
                { "stage": "move", "pieces": ["block"], "travel_deg": 90,
                  "rotation": { "axis": [0, 3, 0], "deg_per_s": -90 } },
                { "stage": "move",
                  "motion_rows": [[0, 0, 0, 0], [1, 1, 0, 0], [2, 3, 0, 0]] }
            ]
        }))
        .expect("a scenario");
        let setup = Setup::new(&scenario).expect("a laboratory");
        let found: Vec<(usize, &str, MotionFacts)> = motions(&scenario, &setup).collect();
        let stages: Vec<(usize, &str)> = found.iter().map(|(n, name, _)| (*n, *name)).collect();
        assert_eq!(stages, [(1, "move"), (2, "move")], "law: those that move pieces");
        let turned = found[0].2.peak_speed_m_per_s;
        let expected = std::f64::consts::FRAC_PI_2 * 0.05;
        assert!((turned - expected).abs() < 1e-12, "law: ω r with r 50 mm, got {turned} m/s");
        let recorded = &found[1].2;
        let speed = recorded.peak_speed_m_per_s;
        assert!((speed - 2.25e-3).abs() < 1e-12, "law: 2 + M₁/6 mm/s at its end, got {speed} m/s");
        let acceleration = recorded.peak_acceleration_m_per_s2;
        assert!((acceleration - 1.5e-3).abs() < 1e-12, "law: M₁ = 1.5 mm/s², got {acceleration}");
    }
}
