//! How the top plate lies once a specimen has been shaken.

use super::*;
use crate::record::{PlateTilt, Settlement};

/// Tilt in degrees from which on a reader is warned. Ours: one edge of the paper's plate lies about
/// two grains higher than the other, by more than the plate settles. Half of that is common, at full
/// size, too, and such plates settle no otherwise than level ones.
const TILTED_DEG: f64 = 10.0;

/// How the plate lay when the shaking ended, at a time in s, and lies at the end of a series; none
/// without a plate.
pub(super) fn plate_tilt(series: &[SeriesRow], shaken_until: f64) -> Option<PlateTilt> {
    let with_plate = || series.iter().filter_map(|row| Some((row.time_s, row.plate_tilt_deg?)));
    let shaken = with_plate().rfind(|(time, _)| *time <= shaken_until);
    let (_, final_deg) = with_plate().next_back()?;
    Some(PlateTilt { end_of_shaking: shaken.map(|(_, tilt)| tilt), final_deg })
}

/// What a reader must know of a plate that lies askew.
pub(super) fn warning(tilt: PlateTilt, plate: &Settlement, surface: &Settlement) -> Option<String> {
    (tilt.final_deg > TILTED_DEG).then(|| {
        format!(
            "the top plate lies {:.1}° off the horizontal: its centre has settled by {:.2} mm, the \
             mean surface by {:.2} mm",
            tilt.final_deg, plate.final_mm, surface.final_mm
        )
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Law: the tilt is that of the last sample while the table shook, and of the last of all; only a
    /// plate that lies askew at the end is warned of, with both settlements.
    #[test]
    fn a_plate_that_lies_askew_is_reported_with_both_settlements() {
        let row = |time_s: f64, plate_tilt_deg: Option<f64>| SeriesRow {
            time_s,
            plate_tilt_deg,
            ..SeriesRow::default()
        };
        let series =
            [row(0.0, None), row(1.0, Some(0.5)), row(1.08, Some(9.0)), row(2.0, Some(16.8))];
        let got = plate_tilt(&series, 1.1).expect("a plate");
        assert_eq!((got.end_of_shaking, got.final_deg), (Some(9.0), 16.8), "law: of both moments");
        assert_eq!(plate_tilt(&series[..1], 1.1), None, "law: none without a plate");
        let settled = |final_mm: f64| Settlement {
            final_mm,
            end_of_shaking: None,
            after_5_s: None,
            share_after_5_s: None,
            after_each_period: Vec::new(),
        };
        let expected = "the top plate lies 16.8° off the horizontal: its centre has settled by 6.40 mm, \
                        the mean surface by 0.95 mm";
        let said = warning(got, &settled(6.4), &settled(0.95));
        assert_eq!(said.as_deref(), Some(expected));
        let usual = PlateTilt { final_deg: 8.4, ..got };
        assert_eq!(
            warning(usual, &settled(6.4), &settled(0.95)),
            None,
            "law: of what is common none"
        );
    }
}
