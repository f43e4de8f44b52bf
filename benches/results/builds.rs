//! Of which build each kept result is: `docs/results/builds.csv`, one row per result, by name.

use std::{fs, path::Path};

use super::list::{FOLDER, KEPT};

/// The file, in `docs/results/`.
const FILE: &str = "builds.csv";

/// A result and its build.
#[derive(Debug, Clone, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub struct Build {
    /// Name of the result.
    pub name: String,
    /// When its files were made.
    pub day: String,
    /// `FORMAT` of `src/study/stage_key.rs` then, which rises whenever results change; several, as
    /// in `14 and 15`, where its parts are of several builds, or `14 and 15, oedometer 19` where
    /// one of them is known by its name, and `before 5` where that is all that is known.
    pub format: String,
}

impl Build {
    /// Whether a part of the result is older than a format.
    pub fn is_older(&self, today: u32) -> bool {
        let numbers = self.format.split(|c: char| !c.is_ascii_digit());
        let numbers: Vec<u32> = numbers.filter_map(|n| n.parse().ok()).collect();
        let is_known = !numbers.is_empty() && !self.format.starts_with("before");
        !is_known || numbers.iter().any(|n| *n < today)
    }
}

/// All rows.
pub fn read(root: &Path) -> Result<Vec<Build>, String> {
    let path = root.join(FOLDER).join(FILE);
    let fault = |e: csv::Error| format!("{}: {e}", path.display());
    let mut reader = csv::Reader::from_path(&path).map_err(fault)?;
    reader.deserialize().map(|row| row.map_err(fault)).collect()
}

/// The row of a result.
pub fn of<'a>(builds: &'a [Build], name: &str) -> Option<&'a Build> {
    builds.iter().find(|build| build.name == name)
}

/// Records of which build a result is from now on.
pub fn record(root: &Path, made: Build) -> Result<(), String> {
    let mut builds = read(root)?;
    builds.retain(|build| build.name != made.name);
    builds.push(made);
    builds.sort_by(|a, b| a.name.cmp(&b.name));
    let mut table = csv::Writer::from_writer(Vec::new());
    for build in builds {
        table.serialize(build).map_err(|e| e.to_string())?;
    }
    let bytes = table.into_inner().map_err(|e| e.to_string())?;
    let path = root.join(FOLDER).join(FILE);
    fs::write(&path, bytes).map_err(|e| format!("{}: {e}", path.display()))
}

/// Results without a build, builds of no result, and rows out of order, a line each.
pub fn faults(root: &Path) -> Result<Vec<String>, String> {
    let builds = read(root)?;
    let mut faults = Vec::new();
    for kept in KEPT.iter().filter(|kept| of(&builds, kept.name).is_none()) {
        faults.push(format!("{FOLDER}/{FILE}: no row says the build of `{}`", kept.name));
    }
    for build in builds.iter().filter(|build| !KEPT.iter().any(|kept| kept.name == build.name)) {
        faults.push(format!("{FOLDER}/{FILE}: no result is named `{}`", build.name));
    }
    if builds.windows(2).any(|two| two[0].name >= two[1].name) {
        faults.push(format!("{FOLDER}/{FILE}: rows are not in order of their names, each once"));
    }
    Ok(faults)
}

/// The day in UTC, `seconds` after the start of 1970, as 2026-11-27 (`civil_from_days` of Hinnant,
/// *chrono-compatible low-level date algorithms*, 2021).
pub fn day(seconds: u64) -> String {
    // Years begin in March, so that a leap day is the last.
    let days = seconds / 86_400 + 719_468;
    let (era, of_era) = (days / 146_097, days % 146_097);
    let year = (of_era - of_era / 1_460 + of_era / 36_524 - of_era / 146_096) / 365;
    let of_year = of_era - (365 * year + year / 4 - year / 100);
    let month = (5 * of_year + 2) / 153;
    let day = of_year - (153 * month + 2) / 5 + 1;
    let (month, next) = if month < 10 { (month + 3, 0) } else { (month - 9, 1) };
    format!("{:04}-{month:02}-{day:02}", 400 * era + year + next)
}
