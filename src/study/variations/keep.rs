//! Rows of both builds in one folder: what the program in single precision
//! found stands beside what the program in double precision found.

use std::{fs, path::Path};

use serde::{Deserialize, Serialize};

use super::super::StudyError;
use crate::record::{FileError, RunRow, create_folder, read_json, write_json};

/// Folder of the rows in the output folder.
const FOLDER: &str = "rows";

/// The rows of one build.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
struct Rows {
    /// Hash of what was done, the engine's build aside.
    programme: String,
    rows: Vec<RunRow>,
}

/// Rows of all builds.
#[derive(Debug, Clone, PartialEq)]
pub(in crate::study) struct Kept {
    /// Those of double precision first.
    pub rows: Vec<RunRow>,
    /// Files that are left out: with rows of another programme, or unreadable.
    pub left_out: Vec<String>,
}

/// Keeps the rows of this build, and gives them with those that other builds
/// left of the same programme.
///
/// # Errors
/// When the folder cannot be read or written.
pub(in crate::study) fn keep_and_read(
    out: &Path,
    programme: &str,
    rows: &[RunRow],
) -> Result<Kept, StudyError> {
    let folder = out.join(FOLDER);
    create_folder(&folder)?;
    let precision = rows.first().map_or("none", |r| r.precision.as_str());
    let own = folder.join(format!("{precision}.json"));
    write_json(&own, &Rows { programme: programme.to_owned(), rows: rows.to_vec() })?;
    let unreadable = |e: std::io::Error| FileError::new("read", &folder, e);
    let mut kept = Kept { rows: rows.to_vec(), left_out: Vec::new() };
    for entry in fs::read_dir(&folder).map_err(unreadable)? {
        let path = entry.map_err(unreadable)?.path();
        if path == own || path.extension().is_none_or(|e| e != "json") {
            continue;
        }
        // What another version wrote may not be read any more.
        match read_json::<Rows>(&path) {
            Ok(other) if other.programme == programme => kept.rows.extend(other.rows),
            _ => kept.left_out.push(path.display().to_string()),
        }
    }
    kept.left_out.sort();
    // A stable sort: within a precision the order stays.
    kept.rows.sort_by(|a, b| a.precision.cmp(&b.precision));
    Ok(kept)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scenario::Scenario;

    fn row(variation: &str, precision: &str) -> RunRow {
        let scenario: Scenario = serde_json::from_value(serde_json::json!({
            "name": "s", "grains": { "file": "g.json" }, "stages": [{ "stage": "fill_funnel" }]
        }))
        .expect("a scenario");
        let row = RunRow::of_scenario("r", variation, "group", &scenario);
        RunRow { precision: precision.to_owned(), ..row }
    }

    #[test]
    fn builds_stand_together_where_they_did_the_same() {
        let folder = tempfile::tempdir().expect("a folder");
        let keep = |programme, rows: &[RunRow]| {
            keep_and_read(folder.path(), programme, rows).expect("kept")
        };
        let [a, b] = [row("a", "single"), row("a", "double")];
        assert_eq!(keep("p", std::slice::from_ref(&a)).rows, std::slice::from_ref(&a));
        let both = keep("p", std::slice::from_ref(&b));
        assert_eq!(both.rows, [b.clone(), a.clone()], "law: double first, then single");
        let again = keep("p", std::slice::from_ref(&b));
        assert_eq!(again, both, "law: a build's rows replace its own");
        let other = keep("q", std::slice::from_ref(&b));
        assert_eq!(other.rows, [b], "law: another programme does not stand beside");
        assert_eq!(other.left_out.len(), 1, "and that is told: {:?}", other.left_out);
        fs::write(folder.path().join("rows/single.json"), "{}").expect("written");
        let unreadable = keep("q", &other.rows);
        assert_eq!(unreadable, other, "law: what cannot be read is left out and told");
    }
}
