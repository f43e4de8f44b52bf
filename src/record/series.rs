//! `series.csv`: the state of the experiment, moment by moment.

use super::*;

/// One row of `series.csv`: the state of the experiment at one moment.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct SeriesRow {
    /// Simulated time since the beginning of the run's first stage, in s.
    pub time_s: f64,
    /// Which stage of the run it belongs to, counted from 0.
    pub stage: u32,
    /// Height of the centre of the top plate's lower face above the floor in mm; empty without a plate.
    pub plate_height_mm: Option<f64>,
    /// Drop of the plate's centre since the first vibration with a plate began, in whichever run
    /// (positive downwards) in mm, through all later stages; empty before.
    pub settlement_mm: Option<f64>,
    /// Drop of the mean surface since the first vibration began in mm; empty before.
    pub surface_settlement_mm: Option<f64>,
    /// Kinetic energy of grains, plate, free and pressed pieces relative to the table, in J.
    pub kinetic_energy_j: f64,
    /// Displacement of the table in mm.
    pub table_x_mm: f64,
    /// Height of the mean surface above the floor in mm (height map); empty in a laboratory of
    /// pieces, which has no floor of its own.
    pub mean_surface_mm: Option<f64>,
    /// Mean height of the centroids of the grains in the cylinder in mm, of all grains before it
    /// stands; empty without grains.
    pub mean_grain_height_mm: Option<f64>,
    /// Grains with their centroid inside the cylinder.
    pub grains_in_cylinder: u32,
    /// Tilt of the plate from the horizontal in degrees; empty without a plate.
    pub plate_tilt_deg: Option<f64>,
    /// Largest speed of any grain relative to the table, in m/s.
    pub largest_speed_m_per_s: f64,
    /// Height of a pile above the mean height of its base in mm, to the highest corner of a grain
    /// that does not move just then; empty without a base.
    pub pile_height_mm: Option<f64>,
    /// Displacement of the table along y in mm; no column where it never has any.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub table_y_mm: Option<f64>,
    /// The same along z.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub table_z_mm: Option<f64>,
}

impl SeriesRow {
    /// Whether settlement is measured at it.
    pub fn is_shaken(&self) -> bool {
        self.settlement_mm.is_some() || self.surface_settlement_mm.is_some()
    }
}

/// Rows of a series, which may be of several stages: the table's displacement along y and z has a
/// column where any stage moves it there.
///
/// # Errors
/// As [`to_csv`].
pub fn series_csv(rows: &[SeriesRow]) -> Result<Vec<u8>, csv::Error> {
    let has = |of: fn(&SeriesRow) -> Option<f64>| rows.iter().any(|r| of(r).is_some());
    let (y, z) = (has(|r| r.table_y_mm), has(|r| r.table_z_mm));
    let still = |column: bool, value: Option<f64>| column.then(|| value.unwrap_or(0.0));
    to_csv(rows.iter().map(|row| SeriesRow {
        table_y_mm: still(y, row.table_y_mm),
        table_z_mm: still(z, row.table_z_mm),
        ..*row
    }))
}

/// Reads `series.csv`.
///
/// # Errors
/// The reader's, with line and field.
pub fn series_from_csv(content: &[u8]) -> Result<Vec<SeriesRow>, csv::Error> {
    csv::Reader::from_reader(content).deserialize().collect()
}
