//! Tables as CSV: made of rows, and with columns added.

use super::*;

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

/// A header of columns, separated by commas, and rows with as many cells; groups of cells within a
/// row lie flat.
///
/// # Errors
/// As [`to_csv`].
pub fn csv_of<T: Serialize>(
    columns: &str,
    rows: impl IntoIterator<Item = T>,
) -> Result<Vec<u8>, csv::Error> {
    let mut writer = csv::WriterBuilder::new().has_headers(false).from_writer(Vec::new());
    writer.write_record(columns.split(','))?;
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
