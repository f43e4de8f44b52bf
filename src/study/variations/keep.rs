//! Rows of both builds in one folder: what the program in single precision
//! found stands beside what the program in double precision found.

use super::*;

/// Folder of the rows in the output folder.
const FOLDER: &str = "rows";

/// The rows of one build.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
struct Rows {
    /// Hash of what was done, the engine's precision aside.
    programme: String,
    rows: Vec<RunRow>,
}

/// Keeps the rows of this build, and gives them with those that other builds left of the same
/// programme, double precision first; and what is said of files that are left out: with rows of
/// another programme, or damaged.
pub(in crate::study) fn keep_and_read(
    out: &Path,
    programme: &str,
    rows: &[RunRow],
) -> Result<(Vec<RunRow>, Vec<String>), StudyError> {
    let precision = rows.first().map_or("none", |r| r.precision.as_str());
    let own = Rows { programme: programme.to_owned(), rows: rows.to_vec() };
    let name = format!("{precision}.json");
    let Beside { others, damaged: mut left_out } = keep_beside(&out.join(FOLDER), &name, &own)?;
    let mut all = rows.to_vec();
    for other in others {
        if other.programme == programme {
            all.extend(other.rows);
        } else {
            let precision = other.rows.first().map_or("none", |r| r.precision.as_str());
            left_out.push(format!(
                "{FOLDER}/{precision}.json is of another design or version and left out"
            ));
        }
    }
    // A stable sort: within a precision the order stays.
    all.sort_by(|a, b| a.precision.cmp(&b.precision));
    Ok((all, left_out))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::study::tests::bare_scenario;

    fn row(variation: &str, precision: &str) -> RunRow {
        let row = RunRow::of_scenario("r", variation, "group", &bare_scenario());
        RunRow { precision: precision.to_owned(), ..row }
    }

    #[test]
    fn builds_stand_together_where_they_did_the_same() {
        let folder = tempfile::tempdir().expect("a folder");
        let keep = |programme, rows: &[RunRow]| {
            keep_and_read(folder.path(), programme, rows).expect("kept")
        };
        let [a, b] = [row("a", "single"), row("a", "double")];
        assert_eq!(keep("p", std::slice::from_ref(&a)).0, std::slice::from_ref(&a));
        let both = keep("p", std::slice::from_ref(&b));
        assert_eq!(both.0, [b.clone(), a.clone()], "law: double first, then single");
        let again = keep("p", std::slice::from_ref(&b));
        assert_eq!(again, both, "law: a build's rows replace its own");
        let other = keep("q", std::slice::from_ref(&b));
        assert_eq!(
            other.0,
            std::slice::from_ref(&b),
            "law: another programme does not stand beside"
        );
        assert_eq!(other.1.len(), 1, "and that is reported: {:?}", other.1);
        let single = folder.path().join("rows/single.json");
        let whole = std::fs::read_to_string(&single).expect("a file");
        let edited = whole.replace("\"variation\": \"a\"", "\"variation\": \"b\"");
        assert_ne!(edited, whole, "the row is changed");
        std::fs::write(&single, edited).expect("written");
        let got = keep("p", std::slice::from_ref(&b));
        assert_eq!(got.0, other.0, "law: an edited row enters no table");
        assert!(got.1[0].contains("single.json"), "law: it is reported, got {:?}", got.1);
        assert_eq!(keep("p", std::slice::from_ref(&a)).0.len(), 2, "law: its build makes it anew");
        assert_eq!(keep("p", &[b]).1, [""; 0], "law: then nothing is left out");
    }
}
