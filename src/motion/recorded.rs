//! A motion as it was recorded: displacement over time from a table.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::geometry::Vector;
use crate::units::from_mm;

use super::Course;

/// Most rows of a recorded motion.
pub const MOST_ROWS: usize = 100_000;

/// Points an interval at which the largest speed of a spline is looked for, beside its own ends.
pub(super) const POINTS_AN_INTERVAL: u32 = 16;

/// Rows of time in s and displacement in mm along x, y and z.
pub type Rows = Vec<[f64; 4]>;

/// How a recorded displacement goes between two rows.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Interpolation {
    // One spline a direction, whose acceleration is 0 at both ends and largest at a row.
    /// Natural cubic splines: no jump of position, velocity or acceleration.
    #[default]
    Cubic,
    /// Straight lines: the velocity jumps at every row.
    Linear,
}

/// What is wrong with the rows of a recorded motion.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[error("{what}")]
pub struct RowFault {
    /// The row, counted from 0, where it is one's.
    pub row: Option<usize>,
    /// What is wrong, for a reader.
    pub what: String,
    /// What was found.
    pub found: String,
    /// What is allowed.
    pub allowed: &'static str,
}

/// A recorded motion, from its first row.
#[derive(Debug, Clone, PartialEq)]
pub struct RecordedMotion {
    interpolation: Interpolation,
    /// Time since the first row in s.
    times: Vec<f64>,
    /// Displacement from the first row in m.
    places: Vec<Vector>,
    /// Second derivatives at the rows; empty of straight lines.
    bends: Vec<Vector>,
}

/// How far a motion may end from where it began, as a share of its largest displacement: the
/// table is brought back from there in one step.
const OPEN: f64 = 0.01;

impl RecordedMotion {
    /// A motion of rows in time order.
    ///
    /// # Errors
    /// All faults: too few or too many rows, numbers that are not finite, times that do not
    /// grow, an end far from the beginning.
    pub fn new(rows: &[[f64; 4]], interpolation: Interpolation) -> Result<Self, Vec<RowFault>> {
        let motion = Self::of_piece(rows, interpolation)?;
        is_open(rows).map_or(Ok(motion), |fault| Err(vec![fault]))
    }

    /// The same of a piece, which stays where its last row is.
    ///
    /// # Errors
    /// All faults but an end far from the beginning.
    pub fn of_piece(
        rows: &[[f64; 4]],
        interpolation: Interpolation,
    ) -> Result<Self, Vec<RowFault>> {
        let faults = faults(rows);
        if !faults.is_empty() {
            return Err(faults);
        }
        let [start, x, y, z] = rows[0];
        let times: Vec<f64> = rows.iter().map(|r| r[0] - start).collect();
        let place = |r: &[f64; 4]| Vector::new(r[1] - x, r[2] - y, r[3] - z).map(from_mm);
        let places: Vec<Vector> = rows.iter().map(place).collect();
        let bends = match interpolation {
            Interpolation::Cubic => natural_spline(&times, &places),
            Interpolation::Linear => Vec::new(),
        };
        Ok(Self { interpolation, times, places, bends })
    }

    /// Length in s.
    pub fn duration(&self) -> f64 {
        self.times[self.times.len() - 1]
    }

    /// Whether it moves along y, and along z.
    pub(super) fn moves_along_y_z(&self) -> [bool; 2] {
        [1, 2].map(|axis| self.places.iter().any(|p| p[axis] != 0.0))
    }

    /// Name for readers.
    pub(super) fn name(&self) -> String {
        let how = match self.interpolation {
            Interpolation::Cubic => "natural cubic splines",
            Interpolation::Linear => "straight lines",
        };
        format!("recorded, {} rows joined by {how}", self.times.len())
    }

    /// Where the table is at a time in s since the first row; the last interval holds the end.
    pub(super) fn at(&self, t: f64) -> Course {
        let after = self.times.partition_point(|row| *row <= t);
        let i = after.clamp(1, self.times.len() - 1) - 1;
        self.in_interval(i, t - self.times[i])
    }

    /// The same, a time in s after the row `i`, up to the next.
    fn in_interval(&self, i: usize, since: f64) -> Course {
        let h = self.times[i + 1] - self.times[i];
        let (from, to) = (self.places[i], self.places[i + 1]);
        let (b, line) = (since / h, (to - from) / h);
        let (Some(m), Some(n)) = (self.bends.get(i), self.bends.get(i + 1)) else {
            let displacement = from + (to - from) * b;
            return Course { displacement, velocity: line, acceleration: Vector::zeros() };
        };
        let a = 1.0 - b;
        let sixth = h * h / 6.0;
        Course {
            displacement: from * a + to * b + (m * (a * a * a - a) + n * (b * b * b - b)) * sixth,
            velocity: line + (n * (3.0 * b * b - 1.0) - m * (3.0 * a * a - 1.0)) * (h / 6.0),
            acceleration: m * a + n * b,
        }
    }

    /// A speed in m/s that is never exceeded: of the largest speeds along each direction.
    pub(super) fn peak_speed(&self) -> f64 {
        let mut most = Vector::zeros();
        for i in 0..self.times.len() - 1 {
            let h = self.times[i + 1] - self.times[i];
            let mut note = |b: f64| {
                most = most.sup(&self.in_interval(i, b * h).velocity.abs());
            };
            note(0.0);
            note(1.0);
            // Along each direction the velocity is a parabola: it may peak where the acceleration is 0.
            if let (Some(m), Some(n)) = (self.bends.get(i), self.bends.get(i + 1)) {
                for axis in 0..3 {
                    let b = m[axis] / (m[axis] - n[axis]);
                    if b > 0.0 && b < 1.0 {
                        note(b);
                    }
                }
            }
        }
        most.norm()
    }

    /// Height in m that it never gets below, from the first row: at a row, or where a spline turns.
    pub(super) fn lowest(&self) -> f64 {
        let mut lowest = self.places.iter().map(|place| place.z).fold(f64::INFINITY, f64::min);
        for (i, bends) in self.bends.windows(2).enumerate() {
            let (h, m, n) = (self.interval(i), bends[0].z, bends[1].z);
            let line = (self.places[i + 1].z - self.places[i].z) / h;
            // The vertical velocity within the interval, 6/h times: a parabola in b, the share of it
            // that has passed.
            let (square, single) = (3.0 * (n - m), 6.0 * m);
            let constant = 6.0 * line / h - n - 2.0 * m;
            let root = (single * single - 4.0 * square * constant).sqrt();
            let q = -0.5 * (single + root.copysign(single));
            // What is no number is no place within the interval.
            for b in [q / square, constant / q] {
                if b > 0.0 && b < 1.0 {
                    lowest = lowest.min(self.in_interval(i, b * h).displacement.z);
                }
            }
        }
        lowest
    }

    /// Largest acceleration upwards in m/s²: of splines, whose is largest at a row; of straight lines,
    /// whose velocity jumps, the mean from the middle of a line to the middle of the next.
    pub fn upward_acceleration(&self) -> f64 {
        let speed = |i: usize| (self.places[i + 1].z - self.places[i].z) / self.interval(i);
        match self.interpolation {
            Interpolation::Cubic => self.bends.iter().map(|bend| bend.z).fold(0.0, f64::max),
            Interpolation::Linear => (1..self.times.len() - 1)
                .map(|i| {
                    2.0 * (speed(i) - speed(i - 1)) / (self.interval(i - 1) + self.interval(i))
                })
                .fold(0.0, f64::max),
        }
    }

    /// Time in s from a row to the next.
    fn interval(&self, i: usize) -> f64 {
        self.times[i + 1] - self.times[i]
    }

    /// Largest speed in m/s looked for at and between the rows, largest acceleration in m/s²,
    /// which is at a row, and largest jump of the velocity in m/s at one.
    pub(super) fn peaks(&self) -> (f64, f64, f64) {
        let (mut speed, mut acceleration, mut jump) = (0.0_f64, 0.0_f64, 0.0_f64);
        let mut before: Option<Vector> = None;
        for i in 0..self.times.len() - 1 {
            let h = self.times[i + 1] - self.times[i];
            for n in 0..=POINTS_AN_INTERVAL {
                let at = self.in_interval(i, h * f64::from(n) / f64::from(POINTS_AN_INTERVAL));
                speed = speed.max(at.velocity.norm());
                acceleration = acceleration.max(at.acceleration.norm());
            }
            let (begins, ends) = (self.in_interval(i, 0.0), self.in_interval(i, h));
            if let (Some(v), Interpolation::Linear) = (before, self.interpolation) {
                jump = jump.max((begins.velocity - v).norm());
            }
            before = Some(ends.velocity);
        }
        (speed, acceleration, jump)
    }
}

fn fault(row: Option<usize>, what: String, found: String, allowed: &'static str) -> RowFault {
    RowFault { row, what, found, allowed }
}

fn faults(rows: &[[f64; 4]]) -> Vec<RowFault> {
    /// Faults of one kind that are said: the first few say enough.
    const SAID: usize = 5;
    if rows.len() < 2 || rows.len() > MOST_ROWS {
        return vec![fault(
            None,
            "a motion of too few or too many rows".into(),
            match rows.len() {
                1 => "1 row".to_owned(),
                // Of a file with more, no more are read.
                n if n > MOST_ROWS => format!("more than {MOST_ROWS} rows"),
                n => format!("{n} rows"),
            },
            "2 to 100000 rows",
        )];
    }
    let numbers = rows.iter().enumerate().filter(|(_, r)| r.iter().any(|v| !v.is_finite()));
    let mut faults: Vec<RowFault> = numbers
        .take(SAID)
        .map(|(n, r)| {
            let what = format!("row {} holds what is no finite number", n + 1);
            fault(Some(n), what, format!("{r:?}"), "finite numbers")
        })
        .collect();
    let times = rows.windows(2).enumerate().filter(|(_, w)| w[1][0] <= w[0][0]);
    faults.extend(times.take(SAID).map(|(n, w)| {
        let what = format!("the time of row {} does not grow", n + 2);
        fault(
            Some(n + 1),
            what,
            format!("{} s after {} s", w[1][0], w[0][0]),
            "times that grow from row to row",
        )
    }));
    // Within less than this, speeds are no finite numbers.
    const SOON: f64 = 1e-9;
    let gaps = rows.windows(2).map(|w| w[1][0] - w[0][0]).enumerate();
    let soon = gaps.filter(|(_, gap)| *gap > 0.0 && *gap < SOON);
    faults.extend(soon.take(SAID).map(|(n, gap)| {
        let what = format!("row {} follows too soon", n + 2);
        fault(Some(n + 1), what, format!("{gap:e} s later"), "at least 1e-9 s from row to row")
    }));
    // Beyond this nothing is a laboratory, and squares overflow.
    const FAR: f64 = 1e4;
    const LONG: f64 = 3600.0;
    let far = rows.iter().enumerate().filter(|(_, r)| r[1..].iter().any(|v| v.abs() > FAR));
    faults.extend(far.take(SAID).map(|(n, r)| {
        let what = format!("row {} lies far from any laboratory", n + 1);
        fault(Some(n), what, format!("{:?} mm", &r[1..]), "at most 10000 mm to either side")
    }));
    if !faults.is_empty() {
        return faults;
    }
    let (first, last) = (rows[0], rows[rows.len() - 1]);
    let length = last[0] - first[0];
    if length > LONG {
        let what = "the motion takes too long".into();
        faults.push(fault(None, what, format!("{length} s"), "at most 3600 s"));
    }
    faults
}

/// A table that would jump back.
fn is_open(rows: &[[f64; 4]]) -> Option<RowFault> {
    let (first, last) = (rows[0], rows[rows.len() - 1]);
    let off = |r: &[f64; 4]| Vector::new(r[1] - first[1], r[2] - first[2], r[3] - first[3]).norm();
    let reach = rows.iter().map(off).fold(0.0, f64::max);
    (off(&last) > OPEN * reach).then(|| {
        fault(
            Some(rows.len() - 1),
            "the motion ends far from where it began: the table would jump back".into(),
            format!("{} mm from the first row", off(&last)),
            "at most 1 % of the largest displacement from the first row",
        )
    })
}

/// Second derivatives of the natural cubic spline through points, each direction by itself
/// (de Boor 1978, *A Practical Guide to Splines*, chapter IV): a tridiagonal system, solved by elimination.
fn natural_spline(times: &[f64], places: &[Vector]) -> Vec<Vector> {
    let n = times.len();
    let mut bends = vec![Vector::zeros(); n];
    let mut pivots = vec![0.0; n];
    for i in 1..n - 1 {
        let (h, k) = (times[i] - times[i - 1], times[i + 1] - times[i]);
        let right = ((places[i + 1] - places[i]) / k - (places[i] - places[i - 1]) / h) * 6.0;
        let pivot = 2.0 * (h + k) - h * pivots[i - 1];
        pivots[i] = k / pivot;
        bends[i] = (right - bends[i - 1] * h) / pivot;
    }
    for i in (1..n - 1).rev() {
        let next = bends[i + 1];
        bends[i] -= next * pivots[i];
    }
    bends
}

/// What is wrong with a first line that is no header of a CSV: of a table whose columns no commas
/// separate, or of numbers alone.
fn no_header(first: &csv::StringRecord) -> Option<String> {
    let other = [(';', "semicolons"), ('\t', "tabs")];
    let found = other.into_iter().find(|(mark, _)| first.len() == 1 && first[0].contains(*mark));
    if let Some((_, marks)) = found {
        return Some(format!(
            "{marks} separate the columns: commas have to, and numbers have decimal points"
        ));
    }
    let of_numbers = !first.is_empty() && first.iter().all(|text| text.parse::<f64>().is_ok());
    of_numbers.then(|| "the first line holds numbers: names of the columns have to".to_owned())
}

/// Reads rows from CSV with a header: `time_s`, `x_mm`, and optionally `y_mm` and `z_mm`, in any
/// order; spaces around values do not count.
///
/// # Errors
/// What is wrong with header, lines or numbers, the first few of each.
pub fn rows_from_csv(content: &[u8]) -> Result<Rows, Vec<String>> {
    const KNOWN: [&str; 4] = ["time_s", "x_mm", "y_mm", "z_mm"];
    const SAID: usize = 5;
    let content = content.strip_prefix("\u{feff}".as_bytes()).unwrap_or(content);
    let mut reader = csv::ReaderBuilder::new().trim(csv::Trim::All).from_reader(content);
    let header = reader.headers().map_err(|e| vec![e.to_string()])?.clone();
    if let Some(fault) = no_header(&header) {
        return Err(vec![fault]);
    }
    let mut faults: Vec<String> = header
        .iter()
        .enumerate()
        .filter_map(|(n, name)| match () {
            () if !KNOWN.contains(&name) => Some(format!("the column {name:?} is not known")),
            () if header.iter().take(n).any(|earlier| earlier == name) => {
                Some(format!("the column `{name}` is there twice"))
            }
            () => None,
        })
        .take(SAID)
        .collect();
    let column = |name: &str| header.iter().position(|h| h == name);
    faults.extend(
        KNOWN[..2]
            .iter()
            .filter(|name| column(name).is_none())
            .map(|name| format!("there is no column `{name}`")),
    );
    if !faults.is_empty() {
        return Err(faults);
    }
    let columns = KNOWN.map(column);
    let mut rows = Rows::new();
    for record in reader.records() {
        let record = match record {
            Ok(record) => record,
            Err(error) => {
                faults.push(error.to_string());
                if faults.len() >= SAID { break } else { continue }
            }
        };
        let line = record.position().map_or(0, csv::Position::line);
        let mut row = [0.0; 4];
        for (value, (column, name)) in row.iter_mut().zip(columns.iter().zip(KNOWN)) {
            let Some(text) = column.and_then(|c| record.get(c)) else { continue };
            match text.parse() {
                Ok(number) => *value = number,
                Err(_) => faults.push(format!("line {line}: `{name}` is no number: {text:?}")),
            }
        }
        rows.push(row);
        if faults.len() >= SAID || rows.len() > MOST_ROWS {
            break;
        }
    }
    if faults.is_empty() { Ok(rows) } else { Err(faults) }
}
