//! Energy balance of a run, beside the rows of its series.

use super::*;
use crate::motion::MotionFacts;

/// One moment, in J. Work and loss are counted from the beginning of the stage.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct EnergyRow {
    /// m g z of grains and plate above z = 0.
    pub potential_energy_j: f64,
    /// Work of the table, of moving pieces and of a weight that seats the plate on them.
    pub work_input_j: f64,
    /// What friction and impacts have taken.
    pub dissipated_j: f64,
}

const COLUMNS: [&str; 3] = ["potential_energy_j", "work_input_j", "dissipated_j"];

/// Adds the columns of energy to a table that has a row for each; none where nothing is known.
///
/// # Errors
/// The reader's and the writer's; there are none of what this program wrote.
pub fn with_energy(table: &[u8], rows: &[Option<EnergyRow>]) -> Result<Vec<u8>, csv::Error> {
    if rows.iter().all(Option::is_none) {
        return Ok(table.to_vec());
    }
    let cells = |n: usize| {
        let row = rows.get(n).copied().flatten();
        let numbers = row.map(|r| [r.potential_energy_j, r.work_input_j, r.dissipated_j]);
        (0..COLUMNS.len()).map(|k| numbers.map(|numbers| numbers[k])).collect()
    };
    with_columns(table, &COLUMNS.map(str::to_owned), cells)
}

/// A stage of a run: what was put into it and what became of it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct StageSummary {
    /// Name of the stage as in the scenario.
    pub stage: String,
    /// Its simulated time in s.
    pub duration_s: f64,
    /// Energy in it; null where the stage was stored before this was recorded.
    pub energy: Option<StageEnergy>,
    /// How far the grains have turned in it, of those present at both ends; null where there are
    /// none.
    pub rotation: Option<RotationSummary>,
    /// What came of the condition that was to end it; none of a stage without `until`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub until: Option<UntilFound>,
    /// How a pour, a pile, a plate or a vibration came to rest; none of another stage, and where
    /// that was not recorded.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub settling: Option<Settling>,
    /// How far grains sank that a deposit let go above a surface; none of another stage.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub fall: Option<Fall>,
    /// Peaks and jumps of the motion of pieces, of a rotation those of their farthest point where
    /// they are put up; none of a stage that moves none.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub motion: Option<MotionFacts>,
}

/// Energy balance of a stage in J: what is put in, and what grains bring that are let go, is
/// stored or dissipated.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct StageEnergy {
    /// Work of the table, of moving pieces and of a weight that seats the plate on grains, plate
    /// and free pieces.
    pub work_input_j: f64,
    /// What friction and impacts took.
    pub dissipated_j: f64,
    /// Potential energy at the end, m g z of grains, plate and free pieces above z = 0.
    pub potential_energy_j: f64,
    /// Kinetic energy at the end, relative to the table.
    pub kinetic_energy_j: f64,
}

/// Angles between the orientations of grains at two moments, from 0 to 180 degrees.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct RotationSummary {
    /// Number of grains.
    pub grains: usize,
    /// Mean.
    pub mean_deg: f64,
    /// Median (nearest rank).
    pub p50_deg: f64,
    /// 90th percentile.
    pub p90_deg: f64,
    /// Largest.
    pub max_deg: f64,
}

impl RotationSummary {
    /// Of angles in rad; none of none.
    pub fn of(angles: impl IntoIterator<Item = f64>) -> Option<Self> {
        let mut sorted: Vec<f64> = angles.into_iter().map(f64::to_degrees).collect();
        sorted.sort_by(f64::total_cmp);
        let rank = |share: f64| (share * sorted.len() as f64).ceil().max(1.0) as usize - 1;
        let max_deg = *sorted.last()?;
        Some(Self {
            grains: sorted.len(),
            mean_deg: sorted.iter().sum::<f64>() / sorted.len() as f64,
            p50_deg: sorted[rank(0.5)],
            p90_deg: sorted[rank(0.9)],
            max_deg,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn columns_stand_where_something_is_known() {
        let row = EnergyRow { potential_energy_j: 2.5, work_input_j: 0.0, dissipated_j: 0.25 };
        let table = b"time_s\n0\n1\n";
        let text = |rows: &[Option<EnergyRow>]| {
            String::from_utf8(with_energy(table, rows).expect("CSV")).expect("text")
        };
        let expected = "time_s,potential_energy_j,work_input_j,dissipated_j\n0,,,\n1,2.5,0,0.25\n";
        assert_eq!(text(&[None, Some(row)]), expected);
        assert_eq!(text(&[None, None]).as_bytes(), table, "law: a table of an older stage stays");
    }

    #[test]
    fn rotations_are_ranked_in_degrees() {
        let quarter = std::f64::consts::FRAC_PI_2;
        let got = RotationSummary::of([0.0, quarter, 2.0 * quarter, 0.0]).expect("angles");
        assert_eq!((got.grains, got.mean_deg, got.max_deg), (4, 67.5, 180.0));
        assert_eq!((got.p50_deg, got.p90_deg), (0.0, 180.0), "law: nearest rank");
        assert_eq!(RotationSummary::of([]), None);
    }
}
