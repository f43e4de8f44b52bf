//! A made-up study of the made-up runs of `record`, for tests of claims and reports.

use super::{StudyView, constants};
use crate::grains::GrainShape;
use crate::motion::TableMotion;
use crate::record::RunRecord;
pub use crate::record::canned::*;

/// A study of these runs, with the paper's grains.
pub fn study(runs: &[RunRecord]) -> StudyView<'_> {
    let sieve = vec![(8.0, 0.0), (10.0, 33.05), (12.5, 85.0), (16.0, 100.0)];
    let sieved_grains =
        vec![(7.0, 1.0), (8.0, 6.0), (10.0, 38.0), (12.5, 83.0), (16.0, 99.0), (20.0, 100.0)];
    StudyView {
        runs,
        left_out: &[],
        configurations: 3,
        sieved_grains,
        sieve,
        grain_count: constants::GRAIN_COUNT,
        total_mass_g: constants::TOTAL_MASS_G,
        solids_volume_cm3: constants::TOTAL_MASS_G / constants::SOLID_DENSITY_KG_PER_M3 * 1e3,
        gradation: gradation([8.56, 9.79, 10.76, 11.23], [1.31, 1.0]),
        generated: Some(sieve_summary().generated),
        shapes: vec![
            GrainShape {
                roundness: 0.0,
                longest: 14e-3,
                intermediate: 11e-3,
                shortest: 9e-3,
                surface: 500e-6,
                volume: 700e-9,
                faces: 15,
                vertices: 26,
            };
            3
        ],
        intermittent: TableMotion { periods: 4, rest: 1.0, ..TableMotion::sine(0.025, 3.0, 5.0) },
        pile_friction: constants::FRICTION_COEFFICIENT,
        quick: false,
        departures: Vec::new(),
    }
}
