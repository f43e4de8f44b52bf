//! Pieces that do not suit the grains: reported, not refused.

use super::{
    Fault, Grading, Scenario,
    unusual::{JAMS_BELOW, LOOSE},
    validate::{fault, short},
};
use crate::units::to_mm;

/// Openings that jam, and containers that run over.
pub(super) fn unusual_pieces(scenario: &Scenario, grading: &Grading, found: &mut Vec<Fault>) {
    let least = JAMS_BELOW * to_mm(grading.sizes.median);
    for (i, piece) in scenario.pieces.iter().enumerate() {
        let Some(hopper) = &piece.shape.hopper else { continue };
        if hopper.opening_diameter_mm < least {
            found.push(fault(
                &format!("pieces[{i}].shape.hopper.opening_diameter_mm"),
                short(hopper.opening_diameter_mm),
                format!("at least {} mm", short(least)),
                format!(
                    "the hopper may jam: its opening is narrower than {JAMS_BELOW} median grain sizes"
                ),
            ));
        }
    }
    // A floor, a hopper or a ramp beside them may take what does not go in.
    let holds: Vec<f64> = scenario.pieces.iter().filter_map(|p| p.shape.holds_mm3()).collect();
    let (room, needed) = (holds.iter().sum::<f64>(), grading.solids * 1e9 * (1.0 + LOOSE));
    if !holds.is_empty() && room < needed {
        found.push(fault(
            "pieces",
            format!("{} cm³", short(room / 1e3)),
            format!("at least {} cm³", short(needed / 1e3)),
            format!("grains may fall over the rims: containers hold less than all grains take with a void ratio of {LOOSE}"),
        ));
    }
}
