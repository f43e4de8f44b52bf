//! Whose results a folder holds, and the answer to which question: no other command writes there,
//! nor the same one when it is asked something else.

use super::earlier_run::first_difference;
use super::*;
use crate::record::write_json;

/// Says which command left a folder's results, and what it was asked.
pub(super) const FILE: &str = "command.json";

/// Files by which results are known in folders that do not say.
const KNOWN: [(&str, &str); 5] = [
    ("manifest.json", "run"),
    ("unfinished.json", "run"),
    ("plan.json", "sweep"),
    ("targets.json", "targets"),
    ("grains.json", "grains"),
];

/// What a command is asked where more of the same may be added to its results.
pub(super) const ANYTHING: Value = Value::Null;

/// Begins a command in a folder. `question` is what its results answer; [`ANYTHING`] where the
/// command itself adds to what is there.
///
/// # Errors
/// [`FileError`], refused, where the folder holds results of another command or the answer to
/// another question; the system's where it cannot be written.
pub(super) fn begin(folder: &Path, command: &str, question: &Value) -> Result<(), FileError> {
    if let Some(held) = held(folder, command, question) {
        let reason = format!("{held}; choose another folder with --out");
        let error = FileError::new("write results into", folder, reason);
        return Err(FileError { refused: true, ..error });
    }
    write_json(&folder.join(FILE), &json!({ "command": command, "question": question }))
        .map_err(|error| FileError::new("write", &folder.join(FILE), error))
}

/// Whether a command has left more in a folder than that it began.
pub(super) fn is_there(folder: &Path) -> bool {
    let entries = || std::fs::read_dir(folder).into_iter().flatten().flatten();
    folder.join(FILE).is_file() && entries().any(|entry| entry.file_name() != FILE)
}

/// What a folder holds that a command would write over; none where it may write.
pub(super) fn held(folder: &Path, command: &str, question: &Value) -> Option<String> {
    let path = folder.join(FILE);
    if is_there(folder) {
        let Ok(there) = read_json::<Value>(&path) else {
            return Some(format!("it holds results whose {FILE} cannot be read"));
        };
        let of = there["command"].as_str().unwrap_or_default();
        if of != command {
            return Some(format!("it holds the results of `pluvia {of}`"));
        }
        return match first_difference("", &there["question"], question) {
            None => None,
            Some(field) if field.is_empty() => {
                Some(format!("it holds the results of another `pluvia {command}`"))
            }
            Some(field) => Some(format!(
                "it holds the results of another `pluvia {command}`: `{field}` differs"
            )),
        };
    }
    // A command that was interrupted has left grains beside its stages.
    let is_bare = !folder.join("stages").is_dir();
    let found = KNOWN.iter().find(|(file, of)| {
        *of != command && folder.join(file).is_file() && (*of != "grains" || is_bare)
    });
    found.map(|(file, of)| format!("it holds the results of `pluvia {of}` ({file})"))
}

/// A scenario as part of a question: without words for the reader.
pub(super) fn scenario(of: &Scenario) -> Value {
    let mut value = serde_json::to_value(of).unwrap_or_default();
    if let Some(fields) = value.as_object_mut() {
        earlier_run::WORDS.iter().for_each(|word| drop(fields.remove(*word)));
    }
    value
}

#[cfg(test)]
mod tests {
    use std::fs;

    use super::*;

    fn said(folder: &Path, command: &str, question: &Value) -> String {
        begin(folder, command, question).err().map(|e| e.to_string()).unwrap_or_default()
    }

    /// Law: a command goes on where its own answer to the same question is; results of another
    /// command, or of another question, are kept.
    #[test]
    fn answers_to_another_question_are_kept() {
        let folder = tempfile::tempdir().expect("a folder");
        let out = folder.path();
        let question = |wanted: f64| json!({ "target": "void_ratio", "wanted": wanted });
        assert_eq!(said(out, "density", &ANYTHING), "", "law: an empty folder");
        assert_eq!(said(out, "calibrate", &question(0.8)), "", "law: nothing is there but a name");
        fs::write(out.join("grains.json"), "").expect("written");
        assert_eq!(said(out, "calibrate", &question(0.8)), "", "law: the same goes on");
        let other = said(out, "calibrate", &question(0.9));
        assert!(
            other.contains("`wanted` differs") && other.contains("--out"),
            "law: got `{other}`"
        );
        let other = said(out, "density", &ANYTHING);
        assert!(other.contains("`pluvia calibrate`"), "law: its command is named, got `{other}`");
        fs::write(out.join(FILE), "torn").expect("written");
        let torn = said(out, "calibrate", &question(0.8));
        assert!(torn.contains("cannot be read"), "law: it may be anything, got `{torn}`");
    }

    /// Law: results in folders that do not say whose they are are known by their files.
    #[test]
    fn results_of_runs_and_grains_are_kept() {
        for (file, of) in KNOWN {
            let folder = tempfile::tempdir().expect("a folder");
            fs::write(folder.path().join(file), "").expect("written");
            let got = said(folder.path(), "density", &ANYTHING);
            assert!(got.contains(file) && got.contains(of), "law: `{file}` is named, got `{got}`");
            assert_eq!(said(folder.path(), of, &ANYTHING), "", "law: {of} may go on");
        }
        let folder = tempfile::tempdir().expect("a folder");
        fs::write(folder.path().join("grains.json"), "").expect("written");
        fs::create_dir(folder.path().join("stages")).expect("made");
        assert_eq!(said(folder.path(), "density", &ANYTHING), "", "law: it was interrupted");
    }
}
