//! `series.csv` and `grains.csv`.

use super::*;
use crate::grains::grain_name;
use crate::measure::Place;
use crate::specimen::Specimen;
use crate::units::{to_g, to_mm3};

/// Rows as CSV with a header of field names, which carry their units.
///
/// # Errors
/// The writer's; writing to memory does not fail for flat rows.
pub fn to_csv<T: Serialize>(rows: impl IntoIterator<Item = T>) -> Result<Vec<u8>, csv::Error> {
    let mut writer = csv::Writer::from_writer(Vec::new());
    for row in rows {
        writer.serialize(row)?;
    }
    writer.into_inner().map_err(|e| e.into_error().into())
}

/// Adds columns to a table, by the number of the row; a cell without a number is empty.
pub(super) fn with_columns(
    table: &[u8],
    names: &[String],
    cells: impl Fn(usize) -> Vec<Option<f64>>,
) -> Result<Vec<u8>, csv::Error> {
    let mut reader = csv::Reader::from_reader(table);
    let mut writer = csv::Writer::from_writer(Vec::new());
    let mut header = reader.headers()?.clone();
    header.extend(names);
    writer.write_record(&header)?;
    for (n, record) in reader.records().enumerate() {
        let mut record = record?;
        let text = |cell: Option<f64>| cell.map(|cell| cell.to_string()).unwrap_or_default();
        record.extend(cells(n).into_iter().map(text));
        writer.write_record(&record)?;
    }
    writer.into_inner().map_err(|e| e.into_error().into())
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

/// One row of `grains.csv`.
#[derive(Debug, Serialize)]
struct GrainRow {
    grain: String,
    passing_mm: f64,
    retained_mm: f64,
    volume_mm3: f64,
    mass_g: f64,
    equivalent_diameter_mm: f64,
    vertices: usize,
    faces: usize,
    fate: Fate,
    x_mm: f64,
    y_mm: f64,
    z_mm: f64,
    rotation_x: f64,
    rotation_y: f64,
    rotation_z: f64,
    rotation_w: f64,
    speed_mm_per_s: f64,
    turned_deg: Option<f64>,
    sieve_size_mm: f64,
    sieve_size_at_end_mm: Option<f64>,
    longest_mm: f64,
    intermediate_mm: f64,
    shortest_mm: f64,
    elongation: f64,
    flatness: f64,
    sphericity: f64,
    roundness: f64,
}

/// One row a grain: what it is, where it is (centroid, m to mm, orientation of its principal axes
/// as a unit quaternion) and how fast; the smallest square opening it passes, as generated and with
/// the shape that the engine held at the end; and its shape. `places`, by which the summary counts
/// and which give the fate, `sieved`, `shapes`, `sieved_at_end_mm` and `turned`, the angles in rad
/// by which grains turned in the last stage, are in the order of the grains; what is not known of a
/// grain is empty.
///
/// # Errors
/// As [`to_csv`].
pub fn grains_csv(
    specimen: &Specimen,
    places: &[Place],
    sieved: &[Sieved],
    shapes: &[GrainShape],
    sieved_at_end_mm: &[Option<f64>],
    turned: &[Option<f64>],
) -> Result<Vec<u8>, csv::Error> {
    let set = &specimen.grains;
    let known = sieved.iter().zip(shapes);
    to_csv(set.grains.iter().zip(&specimen.state.bodies).zip(known).enumerate().map(
        |(index, ((grain, state), (sieved, shape)))| {
            let block = &set.blocks[grain.fraction];
            let at = state.body.pose.translation.vector;
            let q = state.body.pose.rotation.coords;
            GrainRow {
                grain: grain_name(index),
                passing_mm: to_mm(block.passing),
                retained_mm: to_mm(block.retained),
                volume_mm3: to_mm3(grain.volume),
                mass_g: to_g(grain.mass),
                equivalent_diameter_mm: to_mm(grain.equivalent_diameter),
                vertices: shape.vertices,
                faces: shape.faces,
                fate: places.get(index).map_or(state.fate, |place| place.fate(state.fate)),
                x_mm: to_mm(at.x),
                y_mm: to_mm(at.y),
                z_mm: to_mm(at.z),
                rotation_x: q.x,
                rotation_y: q.y,
                rotation_z: q.z,
                rotation_w: q.w,
                speed_mm_per_s: to_mm(state.body.linear_velocity.norm()),
                turned_deg: turned.get(index).copied().flatten().map(f64::to_degrees),
                sieve_size_mm: to_mm(sieved.size),
                sieve_size_at_end_mm: sieved_at_end_mm.get(index).copied().flatten(),
                longest_mm: to_mm(shape.longest),
                intermediate_mm: to_mm(shape.intermediate),
                shortest_mm: to_mm(shape.shortest),
                elongation: shape.ratio(ShapeRatio::Elongation),
                flatness: shape.ratio(ShapeRatio::Flatness),
                sphericity: shape.ratio(ShapeRatio::Sphericity),
                roundness: shape.roundness,
            }
        },
    ))
}
