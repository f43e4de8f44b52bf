//! A pile's angle of repose, in the units of `summary.json`.

use super::StudyError;
use crate::measure::{NoPile, pile_surface};
use crate::record::{AngleOfRepose, AzimuthAngle};
use crate::specimen::{Fate, Specimen};
use crate::units::{to_cm3, to_mm};

/// The angle of repose of a specimen that lies on a base, or why it has none;
/// `None` without a base.
///
/// # Errors
/// When the surface cannot be measured.
pub(super) fn angle_of_repose(
    specimen: &Specimen,
) -> Result<Option<Result<AngleOfRepose, NoPile>>, StudyError> {
    let Some(surface) = pile_surface(specimen).map_err(StudyError::measure)? else {
        return Ok(None);
    };
    let fallen_off = specimen.state.bodies.iter().filter(|g| g.fate == Fate::Spilled).count();
    Ok(Some(surface.repose().map(|pile| {
        AngleOfRepose {
            degrees: pile.angle.to_degrees(),
            standard_deviation_degrees: pile.standard_deviation.to_degrees(),
            confidence_low_degrees: pile.confidence.0.to_degrees(),
            confidence_high_degrees: pile.confidence.1.to_degrees(),
            by_volume_degrees: pile.by_volume.to_degrees(),
            pile_height_mm: to_mm(pile.height),
            base_radius_mm: to_mm(pile.base_radius),
            flank_radii_mm: [to_mm(pile.flank.0), to_mm(pile.flank.1)],
            volume_cm3: to_cm3(pile.volume),
            axis_mm: [to_mm(pile.axis.0), to_mm(pile.axis.1)],
            fallen_off,
            by_azimuth: pile
                .sectors
                .iter()
                .map(|s| AzimuthAngle {
                    azimuth_degrees: s.azimuth.to_degrees(),
                    degrees: s.angle.map(f64::to_degrees),
                    toe_radius_mm: s.toe.map(to_mm),
                })
                .collect(),
        }
    })))
}
