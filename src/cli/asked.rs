//! Whose results a folder holds, and the answer to which question: no other command writes there,
//! nor the same one when it is asked something else.

use std::ffi::OsStr;

use super::*;
use crate::record::at_work_in;
use crate::study::{MEANWHILE, WORDS};

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

/// Files by which results of studies are known there; reports are those of several.
const STUDIES: [(&str, &str); 12] = [
    ("plan.json", "sweep"),
    ("sweep.json", "sweep"),
    ("targets.json", "targets"),
    ("claims.json", "reproduce"),
    ("interpretations.json", "interpretations"),
    ("compare.json", "compare"),
    ("calibrate.json", "calibrate"),
    ("density.json", "density"),
    ("convergence.json", "converge"),
    ("sensitivity.json", "sensitivity"),
    ("verify.json", "verify"),
    ("report.html", ""),
];

/// What a command is asked where it asks nothing that this could compare.
pub(super) const ANYTHING: Value = Value::Null;

/// Begins a command in a folder, which is made ([`output_folder::prepare`]). `question` is what its
/// results answer; what stands there under [`AT_LEAST`] was asked for no more than this, and what
/// stands under [`MEANWHILE`] may differ. The command is at work there until what is given back is
/// dropped; the same one may be, several times, if it is asked the same.
///
/// # Errors
/// [`FileError`], refused, where the folder holds results of another command or the answer to
/// another question, or one of these is at work there; the system's where it cannot be written.
pub(super) fn begin(folder: &Path, command: &str, question: &Value) -> Result<RunLock, FileError> {
    const WRITE: &str = "write results into";
    output_folder::prepare(folder)?;
    // No lock is left in a folder of others.
    if let Some(held) = held(folder, command, question, AtWork::Nobody) {
        return Err(in_the_way(WRITE, folder, &held));
    }
    RunLock::take(folder, |at_work| {
        if let Some(held) = held(folder, command, question, at_work) {
            return Err(in_the_way(WRITE, folder, &with_others(held, at_work)));
        }
        write_json(&folder.join(FILE), &json!({ "command": command, "question": question }))
            .map_err(|error| FileError::new("write", &folder.join(FILE), error))
    })
}

/// Refuses a folder for files of a command that asks no question, where another command has left
/// results or is at work.
///
/// # Errors
/// [`FileError`], refused, that says what the folder holds.
pub(super) fn refuse(folder: &Path, command: &str) -> Result<(), FileError> {
    let at_work = at_work_in(folder);
    match held(folder, command, &ANYTHING, at_work) {
        None => Ok(()),
        Some(held) => Err(in_the_way("write files into", folder, &with_others(held, at_work))),
    }
}

/// What a folder holds of a study, among which files of a run must not stand; none where it holds
/// nothing of one.
pub(super) fn study_in(folder: &Path, at_work: AtWork) -> Option<String> {
    let is_file = |file: &str| folder.join(file).is_file();
    // A run that took over the folder of a study that had left nothing.
    let is_run = ["manifest.json", "unfinished.json"].into_iter().any(is_file);
    let held = if let Some((file, of)) = STUDIES.iter().find(|(file, _)| is_file(file)) {
        let of = match *of {
            "" => "another command".to_owned(),
            of => format!("`pluvia {of}`"),
        };
        format!("it holds the results of {of} ({file})")
    } else if !is_run && is_there(folder, at_work) {
        match read_json::<Value>(&folder.join(FILE)) {
            Ok(there) => results_of(&there),
            Err(_) => format!("it holds results whose {FILE} cannot be read"),
        }
    } else {
        return None;
    };
    Some(with_others(held, at_work))
}

/// The study whose `runs` a folder is or is in, there or not yet: its folder, and what that holds.
pub(super) fn study_around(folder: &Path) -> Option<(PathBuf, String)> {
    let folder = folder.canonicalize().or_else(|_| std::path::absolute(folder)).ok()?;
    let runs = folder.ancestors().take(2).find(|above| above.ends_with("runs"))?;
    let study = runs.parent()?;
    // A report alone, beside a folder of this name, may be anybody's.
    let named = STUDIES.iter().filter(|(_, of)| !of.is_empty()).map(|(file, _)| *file);
    let is_known = named.chain([FILE]).any(|file| study.join(file).is_file());
    let held = study_in(study, at_work_in(study)).filter(|_| is_known)?;
    Some((study.to_owned(), held))
}

/// What a folder holds by what it says of its command.
fn results_of(there: &Value) -> String {
    let of = there["command"].as_str().unwrap_or_default();
    format!("it holds the results of `pluvia {of}`")
}

/// Gives a folder that holds nothing of a study, and where none is at work, to a run.
pub(super) fn give_up(folder: &Path) {
    // Where it stays, the files of the run say whose the folder is.
    let _ = std::fs::remove_file(folder.join(FILE));
}

/// What a folder holds, and whether somebody is at work there.
fn with_others(held: String, at_work: AtWork) -> String {
    match at_work {
        AtWork::Somebody => held + ", and a command is at work there",
        AtWork::Nobody | AtWork::Unknown => held,
    }
}

fn in_the_way(action: &'static str, folder: &Path, held: &str) -> FileError {
    error::refused(action, folder, format!("{held}; choose another folder with --out"))
}

/// Whether a command is at work in a folder, or has left more there than that it began: locks are
/// nothing.
fn is_there(folder: &Path, at_work: AtWork) -> bool {
    let is_left = |name: &OsStr| name != FILE && !name.to_string_lossy().starts_with('.');
    let mut entries = std::fs::read_dir(folder).into_iter().flatten().flatten();
    folder.join(FILE).is_file()
        && (at_work == AtWork::Somebody || entries.any(|entry| is_left(&entry.file_name())))
}

/// What a folder holds that a command would write over; none where it may write.
fn held(folder: &Path, command: &str, question: &Value, at_work: AtWork) -> Option<String> {
    let path = folder.join(FILE);
    if is_there(folder, at_work) {
        let Ok(there) = read_json::<Value>(&path) else {
            return Some(format!("it holds results whose {FILE} cannot be read"));
        };
        if there["command"].as_str() != Some(command) {
            return Some(results_of(&there));
        }
        let there = &there["question"];
        let held = if there.is_null() { None } else { other_answer(command, there, question) };
        // Two that ask for different results write the same files.
        let is_other = || first_difference("", there, question).is_some();
        let meanwhile = || format!("another `pluvia {command}` has begun there");
        return held.or_else(|| (at_work == AtWork::Somebody && is_other()).then(meanwhile));
    }
    // A command that was interrupted has left grains beside its stages; an export has other names.
    let is_bare = !folder.join("stages").is_dir() && command != "export";
    let found = KNOWN.iter().find(|(file, of)| {
        *of != command && folder.join(file).is_file() && (*of != "grains" || is_bare)
    });
    found.map(|(file, of)| format!("it holds the results of `pluvia {of}` ({file})"))
}

/// Why results are no part of the answer to a question of now; none where they are.
fn other_answer(command: &str, there: &Value, now: &Value) -> Option<String> {
    let ([same, more], [same_now, more_now]) = (parted(there), parted(now));
    match first_difference("", &same, &same_now) {
        None => lost(&more, &more_now)
            .map(|what| format!("it holds more results of `pluvia {command}`: {what}")),
        Some(field) => {
            let other = format!("it holds the results of another `pluvia {command}`");
            Some(if field.is_empty() { other } else { format!("{other}: `{field}` differs") })
        }
    }
}

/// What must be the same of a question, and what may grow.
fn parted(question: &Value) -> [Value; 2] {
    let mut same = question.clone();
    let mut more = None;
    if let Some(fields) = same.as_object_mut() {
        more = fields.remove(AT_LEAST);
        fields.remove(MEANWHILE);
    }
    [same, more.unwrap_or_default()]
}

/// The first field in which two values differ; text for the reader does not count.
pub(super) fn first_difference(path: &str, a: &Value, b: &Value) -> Option<String> {
    let within = |field: &str| match path {
        "" => field.to_owned(),
        path => format!("{path}.{field}"),
    };
    match (a, b) {
        (Value::Object(one), Value::Object(two)) => {
            let fields = one.keys().chain(two.keys().filter(|key| !one.contains_key(*key)));
            let mut fields = fields.filter(|f| !path.is_empty() || !WORDS.contains(&f.as_str()));
            // What is not there is as good as null.
            let of = |value: &serde_json::Map<String, Value>, field: &str| {
                value.get(field).cloned().unwrap_or_default()
            };
            fields.find_map(|f| first_difference(&within(f), &of(one, f), &of(two, f)))
        }
        (Value::Array(one), Value::Array(two)) if one.len() == two.len() => {
            let mut pairs = one.iter().zip(two).enumerate();
            pairs.find_map(|(n, (a, b))| first_difference(&format!("{path}[{n}]"), a, b))
        }
        // 20 and 20.0 are one number.
        (Value::Number(one), Value::Number(two)) if one.as_f64() == two.as_f64() => None,
        (a, b) => (a != b).then(|| path.to_owned()),
    }
}

/// What was asked for and is no longer: an element of a list, a field of an object, or a larger
/// number.
fn lost(there: &Value, now: &Value) -> Option<String> {
    there.as_object()?.iter().find_map(|(field, was)| {
        let now = now.get(field).unwrap_or(&Value::Null);
        match was {
            Value::Number(was) => {
                let is_less = now.as_f64() < was.as_f64();
                is_less.then(|| format!("`{field}` was {was}, and is {now}"))
            }
            Value::Array(was) => {
                let now = now.as_array();
                let gone = was.iter().find(|one| !now.is_some_and(|now| now.contains(one)))?;
                let gone = gone.as_str().map_or_else(|| gone.to_string(), str::to_owned);
                Some(format!("`{field}` lacks `{gone}`"))
            }
            Value::Object(was) => {
                let is_there = |name: &str, one: &Value| now.get(name) == Some(one);
                let (name, _) = was.iter().find(|(name, one)| !is_there(name, one))?;
                Some(format!("`{field}.{name}` is missing or differs"))
            }
            _ => None,
        }
    })
}

#[cfg(test)]
mod tests {
    use std::fs;

    use super::*;
    use crate::plain::assert_holds;

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

    /// Law: of two commands that begin at once one begins, though neither has left a result; while
    /// it is at work, the same command may join it, and no other.
    #[test]
    fn a_command_at_work_is_left_alone() {
        let folder = tempfile::tempdir().expect("a folder");
        let out = folder.path();
        let (own, other) = (json!({ "wanted": 0.8 }), json!({ "wanted": 0.9 }));
        let at_once = std::sync::Barrier::new(2);
        let begun = |question: &Value| {
            at_once.wait();
            begin(out, "calibrate", question)
        };
        let [first, second] = std::thread::scope(|scope| {
            let both = [&own, &other].map(|question| scope.spawn(move || begun(question)));
            both.map(|thread| thread.join().expect("it does not panic"))
        });
        let own = if first.is_ok() { own } else { other };
        let (kept, refused) = if first.is_ok() { (first, second) } else { (second, first) };
        let kept = kept.expect("law: one begins");
        let why = refused.err().map(|e| e.to_string()).unwrap_or_default();
        assert!(why.contains("`wanted` differs") && why.contains("at work"), "law: got `{why}`");
        let written: Value = read_json(&out.join(FILE)).expect("it says what is asked");
        assert_eq!(written["question"], own, "law: by the one that began");
        let why = said(out, "density", &ANYTHING);
        assert!(why.contains("`pluvia calibrate`") && why.contains("at work"), "law: got `{why}`");
        assert_eq!(said(out, "calibrate", &own), "", "law: the same joins in");
        drop(kept);
        assert_eq!(said(out, "density", &ANYTHING), "", "law: nothing was left");
    }

    /// Law: a question that grows, or that may differ later, is refused while a smaller or another
    /// one is at work.
    #[test]
    fn what_is_at_work_grows_later() {
        let at_least = |n: u32| json!({ "limit": 1, (AT_LEAST): { "configurations": n } });
        let meanwhile = |quick: bool| json!({ (MEANWHILE): { "quick": quick } });
        for [first, second] in [[2, 5].map(at_least), [true, false].map(meanwhile)] {
            let folder = tempfile::tempdir().expect("a folder");
            let out = folder.path();
            let kept = begin(out, "density", &first).expect("law: nobody is there");
            fs::write(out.join("density.csv"), "").expect("written");
            assert_eq!(said(out, "density", &first), "", "law: the same joins in");
            let words = ["another `pluvia density` has begun there", "a command is at work"];
            assert_holds(&said(out, "density", &second), &words);
            drop(kept);
            assert_eq!(said(out, "density", &second), "", "law: nobody is at work any more");
        }
    }

    /// Law: an answer may grow; what was asked for stays, and a refusal names what would be
    /// lost.
    #[test]
    fn answers_grow_and_do_not_shrink() {
        let folder = tempfile::tempdir().expect("a folder");
        let out = folder.path();
        let question = |cases: &[&str], configurations: u32, rate: f64| {
            json!({ "limit": 1, (AT_LEAST): {
                "cases": cases, "configurations": configurations, "variations": { "a": [rate] } } })
        };
        assert_eq!(said(out, "verify", &question(&["a"], 2, 1.0)), "");
        fs::write(out.join("verify.csv"), "").expect("written");
        let more = question(&["b", "a"], 3, 1.0);
        assert_eq!(said(out, "verify", &more), "", "law: more may be added");
        for (less, words) in [
            (question(&["b"], 3, 1.0), "`cases` lacks `a`"),
            (question(&["a", "b"], 2, 1.0), "`configurations` was 3, and is 2"),
            (question(&["a", "b"], 3, 2.0), "`variations.a` is missing or differs"),
            (json!({ "limit": 1 }), "`cases` lacks `b`"),
            (json!({ "limit": 2 }), "`limit` differs"),
        ] {
            let got = said(out, "verify", &less);
            assert!(got.contains(words), "law: `{words}` is said of {less}, got `{got}`");
        }
        assert_eq!(said(out, "verify", &more), "", "law: a refusal changes nothing");
        let earlier = json!({ "command": "verify", "question": null });
        fs::write(out.join(FILE), earlier.to_string()).expect("written");
        assert_eq!(said(out, "verify", &more), "", "law: what an earlier build left goes on");
    }

    /// Law: files of commands that ask nothing stay out of folders with results of others.
    #[test]
    fn files_are_kept_out_of_results() {
        let folder = tempfile::tempdir().expect("a folder");
        let out = folder.path();
        let refused = |command: &str| refuse(out, command).err().map(|e| e.to_string());
        assert_eq!(refused("grains"), None, "law: an empty folder");
        fs::write(out.join("grains.json"), "").expect("written");
        assert_eq!(refused("export"), None, "law: grains have other names than exports");
        let got = said(out, "sweep", &ANYTHING);
        assert!(got.contains("`pluvia grains`"), "law: grains are kept, got `{got}`");
        fs::remove_file(out.join("grains.json")).expect("removed");
        let at_work = begin(out, "sweep", &ANYTHING).expect("law: an empty folder");
        for command in ["grains", "export"] {
            let got = refused(command).unwrap_or_default();
            let begun =
                got.contains("`pluvia sweep`") && got.contains("a command is at work there");
            assert!(begun, "law: a command that has begun is left alone, got `{got}`");
        }
        drop(at_work);
        assert_eq!(refused("grains"), None, "law: it has ended, and left nothing");
        fs::write(out.join("sweep.csv"), "").expect("written");
        for command in ["grains", "export"] {
            let got = refused(command).unwrap_or_default();
            assert!(got.contains("`pluvia sweep`") && got.contains("--out"), "got `{got}`");
        }
    }

    /// Law: what a study has left, or is at work on, is no run's; where it has left nothing, or a
    /// run has begun since, it is.
    #[test]
    fn folders_of_studies_are_known() {
        let folder = tempfile::tempdir().expect("a folder");
        let out = folder.path();
        assert_eq!(study_in(out, AtWork::Nobody), None, "law: an empty folder");
        drop(begin(out, "density", &ANYTHING).expect("law: an empty folder"));
        assert_eq!(study_in(out, AtWork::Nobody), None, "law: nothing is left");
        let got = study_in(out, AtWork::Somebody).unwrap_or_default();
        assert!(got.contains("`pluvia density`") && got.contains("at work"), "law: got `{got}`");
        fs::write(out.join("grains.json"), "").expect("written");
        let got = study_in(out, AtWork::Nobody).unwrap_or_default();
        assert!(got.contains("`pluvia density`"), "law: its grains are left, got `{got}`");
        fs::write(out.join("manifest.json"), "").expect("written");
        assert_eq!(study_in(out, AtWork::Nobody), None, "law: a run has been there since");
        for (file, of) in STUDIES {
            let folder = tempfile::tempdir().expect("a folder");
            // Files of a run that stand there do not make it a run's.
            for file in [file, "manifest.json"] {
                fs::write(folder.path().join(file), "").expect("written");
            }
            let got = study_in(folder.path(), AtWork::Nobody).unwrap_or_default();
            assert!(got.contains(file) && got.contains(of), "law: `{file}` is named, got `{got}`");
        }
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
