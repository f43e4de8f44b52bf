//! A table of a run by its columns: names with units, ranges, the numbers of chosen rows.

use crate::in_order::each_once;
use crate::record::FileError;
use crate::scenario::{nearest, renamed_result};
use std::path::Path;

/// A table as it stands in a CSV file.
#[derive(Debug, Clone, PartialEq)]
pub struct ColumnTable {
    names: Vec<String>,
    rows: Vec<Vec<String>>,
}

/// What a column holds.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
pub struct ColumnRange {
    /// Its name.
    pub name: String,
    /// Number of rows with a number.
    pub numbers: usize,
    /// Its smallest number; none of text.
    pub smallest: Option<f64>,
    /// Its largest number.
    pub largest: Option<f64>,
    /// Up to six different texts where it holds no numbers.
    pub texts: Vec<String>,
}

/// Endings of names and what they mean, the longer ones first.
const UNITS: [(&str, &str); 31] = [
    ("_s_per_simulated_s", "s/s"),
    ("_grains_per_s", "grains/s"),
    ("_kg_per_m3", "kg/m³"),
    ("_mm_per_s2", "mm/s²"),
    ("_m_per_s2", "m/s²"),
    ("_mm_per_s", "mm/s"),
    ("_um_per_s", "µm/s"),
    ("_rad_per_s", "rad/s"),
    ("_deg_per_s", "°/s"),
    ("_g_per_s", "g/s"),
    ("_m_per_s", "m/s"),
    ("_n_per_m", "N/m"),
    ("_n_m", "N m"),
    ("_percent", "%"),
    ("_degrees", "°"),
    ("_per_s", "1/s"),
    ("_kpa", "kPa"),
    ("_mm3", "mm³"),
    ("_cm3", "cm³"),
    ("_deg", "°"),
    ("_rad", "rad"),
    ("_mib", "MiB"),
    ("_mm", "mm"),
    ("_um", "µm"),
    ("_hz", "Hz"),
    ("_kg", "kg"),
    ("_g", "g"),
    ("_j", "J"),
    ("_n", "N"),
    ("_s", "s"),
    ("_m", "m"),
];

/// The words of a column's name, and its unit; empty where it has none. A path, as of a field or of a
/// result, stays a path; its unit is that of the last of its parts that has one.
pub fn quantity_and_unit(name: &str) -> (String, &'static str) {
    // In `after_5_s` the name has a time; its unit is not that.
    let is_number = |word: &str| word.bytes().all(|byte| byte.is_ascii_digit());
    let found = UNITS.iter().find_map(|(ending, unit)| {
        let quantity = name.strip_suffix(ending)?;
        let ends_in_number = quantity.rsplit(['_', '.']).next().is_some_and(is_number);
        // Something per metre is no length.
        let is_part_of_unit = quantity.ends_with("_per");
        (!ends_in_number && !is_part_of_unit).then_some((quantity, *unit))
    });
    if let Some((_, last)) = name.rsplit_once('.') {
        // A share of a length in mm is no length.
        let is_pure = last.starts_with("share_");
        let unit = name.rsplit('.').map(unit_of).find(|unit| !unit.is_empty() && !is_pure);
        return (name.to_owned(), unit.unwrap_or(""));
    }
    let (quantity, unit) = found.unwrap_or((name, ""));
    (quantity.replace('_', " "), unit)
}

/// The unit that a name ends in, or is; empty where there is none.
pub fn unit_of(name: &str) -> &'static str {
    quantity_and_unit(&format!("of_{name}")).1
}

/// The number in a cell; none where it is empty, text, or not finite.
fn number(cell: &str) -> Option<f64> {
    cell.trim().parse().ok().filter(|number: &f64| number.is_finite())
}

impl ColumnTable {
    /// Reads a table from the content of a CSV file; spaces around names and cells do not count.
    ///
    /// # Errors
    /// [`FileError`] with the line that is none of a table.
    pub fn read(path: &Path, content: &[u8]) -> Result<Self, FileError> {
        let mut reader = csv::ReaderBuilder::new().trim(csv::Trim::All).from_reader(content);
        let text = |record: &csv::StringRecord| record.iter().map(str::to_owned).collect();
        let malformed = |e: csv::Error| FileError::malformed(path, e);
        let names: Vec<String> = text(reader.headers().map_err(malformed)?);
        let rows: Result<Vec<Vec<String>>, csv::Error> =
            reader.records().map(|record| record.map(|record| text(&record))).collect();
        let table = Self { names, rows: rows.map_err(malformed)? };
        if table.names.iter().all(String::is_empty) {
            return Err(FileError::unfit(path, "it has no columns"));
        }
        Ok(table)
    }

    /// Names of the columns, in order.
    pub fn names(&self) -> &[String] {
        &self.names
    }

    /// Number of rows.
    pub fn len(&self) -> usize {
        self.rows.len()
    }

    /// Whether it has no rows.
    pub fn is_empty(&self) -> bool {
        self.rows.is_empty()
    }

    /// Number of a column by its name.
    ///
    /// # Errors
    /// With the name that was meant, where one is near, and the columns there are.
    pub fn find(&self, name: &str) -> Result<usize, String> {
        if let Some(found) = self.names.iter().position(|known| known == name) {
            return Ok(found);
        }
        let now = renamed_result(name).filter(|now| self.names.contains(now));
        let near = || nearest(name, self.names.iter().map(String::as_str));
        let near = now.as_deref().or_else(near);
        let meant = near.map_or(".".to_owned(), |near| format!("; did you mean `{near}`?"));
        Err(format!("there is no such column{meant} There are: {}", self.names.join(", ")))
    }

    /// The rows whose cell in a column is a text, or the number that the text is.
    #[must_use]
    pub fn where_is(&self, column: usize, value: &str) -> Self {
        let asked = number(value);
        let fits = |cell: &str| cell == value || (asked.is_some() && number(cell) == asked);
        let rows = self.rows.iter().filter(|row| row.get(column).is_some_and(|cell| fits(cell)));
        Self { names: self.names.clone(), rows: rows.cloned().collect() }
    }

    /// These rows, and then others of the same columns.
    #[must_use]
    pub fn and(mut self, others: Self) -> Self {
        self.rows.extend(others.rows);
        self
    }

    /// Different texts of a column, in the order in which they come.
    pub fn texts(&self, column: usize) -> Vec<&str> {
        let cells = self.rows.iter().filter_map(|row| row.get(column)).map(String::as_str);
        each_once(cells.filter(|cell| !cell.is_empty()))
    }

    /// The cells of a column, row by row; none where a row is too short.
    pub fn cells(&self, column: usize) -> Vec<Option<&str>> {
        self.rows.iter().map(|row| row.get(column).map(String::as_str)).collect()
    }

    /// The numbers of a column, row by row.
    pub fn numbers(&self, column: usize) -> Vec<Option<f64>> {
        self.rows.iter().map(|row| number(row.get(column)?)).collect()
    }

    /// What every column holds.
    pub fn ranges(&self) -> Vec<ColumnRange> {
        let of = |(column, name): (usize, &String)| {
            let numbers: Vec<f64> = self.numbers(column).into_iter().flatten().collect();
            let texts = match numbers.is_empty() {
                true => self.texts(column).into_iter().take(6).map(str::to_owned).collect(),
                false => Vec::new(),
            };
            ColumnRange {
                name: name.clone(),
                numbers: numbers.len(),
                smallest: numbers.iter().copied().min_by(f64::total_cmp),
                largest: numbers.iter().copied().max_by(f64::total_cmp),
                texts,
            }
        };
        self.names.iter().enumerate().map(of).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn table() -> ColumnTable {
        let csv =
            b"time_s,stage,box_force_z_n,fate\n0,0,,present\n0.5,0,-2,spilled\n1,1,NaN,present\n";
        ColumnTable::read(Path::new("a.csv"), csv).expect("a table")
    }

    #[test]
    fn names_end_in_their_units() {
        for (name, expected) in [
            ("time_s", ("time", "s")),
            ("box_force_z_n", ("box force z", "N")),
            ("drum_moment_y_n_m", ("drum moment y", "N m")),
            ("largest_speed_m_per_s", ("largest speed", "m/s")),
            ("contact_stiffness_n_per_m", ("contact stiffness", "N/m")),
            ("wall_s_per_simulated_s", ("wall", "s/s")),
            ("density_kg_per_m3", ("density", "kg/m³")),
            ("feed_rate_grains_per_s", ("feed rate", "grains/s")),
            ("linear_damping_per_s", ("linear damping", "1/s")),
            ("length_scale_units_per_m", ("length scale units per m", "")),
            ("wall_s_per_pour", ("wall s per pour", "")),
            ("core_stress_xx_kpa", ("core stress xx", "kPa")),
            ("core_void_ratio", ("core void ratio", "")),
            ("volume_mm3", ("volume", "mm³")),
            ("turned_deg", ("turned", "°")),
            ("grains_in_cylinder", ("grains in cylinder", "")),
            ("stage", ("stage", "")),
            ("d50_mm", ("d50", "mm")),
            ("_mm", (" mm", "")),
            ("after_5_s", ("after 5 s", "")),
            ("settlement_after_5_s_mm", ("settlement after 5 s", "mm")),
            ("contact.grain_grain_friction", ("contact.grain_grain_friction", "")),
            ("stages.1.falling_height_mm", ("stages.1.falling_height_mm", "mm")),
            ("settlement_mm.after_5_s", ("settlement_mm.after_5_s", "mm")),
            ("settlement_mm.share_after_5_s", ("settlement_mm.share_after_5_s", "")),
        ] {
            let (quantity, unit) = quantity_and_unit(name);
            assert_eq!((quantity.as_str(), unit), expected, "law: of {name}");
        }
    }

    #[test]
    fn columns_are_found_and_near_names_are_told() {
        let table = table();
        assert_eq!(table.find("fate"), Ok(3));
        let near = table.find("bx_force_z_n").expect_err("law: no such column");
        assert!(near.contains("did you mean `box_force_z_n`? There are: time_s"), "{near}");
        let far = table.find("unlikely_quantity").expect_err("law: no such column");
        assert!(far.starts_with("there is no such column. There are: time_s, stage"), "{far}");
        let checks = ColumnTable::read(Path::new("a.csv"), b"checks.passed\n1\n").expect("a table");
        let old = checks.find("guards.passed").expect_err("law: no such column");
        assert!(old.contains("did you mean `checks.passed`?"), "law: today's name, got `{old}`");
    }

    /// Law: a table edited by hand, with spaces before or after its commas, is the same table.
    #[test]
    fn spaces_around_cells_do_not_count() {
        let csv = b"time_s , stage,box_force_z_n ,fate\n0, 0, ,present \n0.5,0,-2, spilled\n\
                    1,1 ,NaN,present\n";
        let spaced = ColumnTable::read(Path::new("a.csv"), csv).expect("a table");
        assert_eq!(spaced, table());
    }

    #[test]
    fn cells_without_a_number_have_none_and_rows_are_chosen() {
        let table = table();
        assert_eq!(table.numbers(2), [None, Some(-2.0), None], "law: NaN is no number");
        assert_eq!(table.where_is(3, "present").numbers(0), [Some(0.0), Some(1.0)]);
        assert_eq!(table.where_is(0, "0.50").len(), 1, "law: 0.50 is 0.5");
        assert!(table.where_is(3, "lost").is_empty());
        let ranges = table.ranges();
        assert_eq!((ranges[0].smallest, ranges[0].largest), (Some(0.0), Some(1.0)));
        assert_eq!((ranges[2].numbers, ranges[3].texts.len()), (1, 2));
        let empty = ColumnTable::read(Path::new("a.csv"), b"");
        assert!(empty.is_err(), "law: nothing is no table, got {empty:?}");
    }
}
