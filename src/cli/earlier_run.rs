//! Other results in the folder for those of a run: what another run left is kept unless `--force`
//! says otherwise, what a study left is kept.

use std::fs;

use super::asked::first_difference;
use super::*;
use crate::record::at_work_in;
use crate::scenario::of_earlier_version;

/// The action that is refused, as errors name it.
const WRITE: &str = "write results into";

/// Says which scenario a folder's unfinished run is of; removed once the run is finished.
const UNFINISHED: &str = "unfinished.json";

/// What says which scenario a folder's finished run is of.
const MANIFEST: &str = "manifest.json";

/// Files by which results of other commands than studies are known, and runs that say of no
/// scenario.
const RESULTS: [&str; 5] =
    ["summary.json", "series.csv", "specimen.json", "grains.json", "scene.json"];

/// Files of a run that the next one may not write again: `--force` removes them. Grains stay,
/// which the scenario may be read from; the run writes its own over them.
const REMOVED: [&str; 10] = [
    MANIFEST,
    "summary.json",
    "series.csv",
    "rest_test.csv",
    "grains.csv",
    "specimen.json",
    "sieve.csv",
    "stones.csv",
    "void_profile.csv",
    "distributions.csv",
];

/// Begins a run of a scenario in a folder, unless this holds what would be written over: the
/// results of another scenario, finished or not, or of another command. A run of the same
/// scenario goes on, or is done again from its stored stages; several programs may do so together.
/// The run lasts until what is given back is dropped. The folder of a study is refused, by force,
/// too: a run replaces files of a run alone, and its own would stand among those of the study. So is
/// the folder of a run of a study ([`refuse_run_of_study`]).
///
/// # Errors
/// [`FileError`], refused, that says what the folder holds; the system's where it does not let
/// the folder be written.
pub(super) fn begin(folder: &Path, scenario: &Scenario, force: bool) -> Result<RunLock, CliError> {
    let own = serde_json::to_value(scenario).map_err(std::io::Error::other)?;
    // No lock is left in a folder of others.
    refuse_study(folder, AtWork::Nobody)?;
    RunLock::take(folder, |at_work| {
        refuse_study(folder, at_work)?;
        refuse_held(folder, &own, at_work, force)?;
        // What the others of the same run have written is this one's, too.
        if force && at_work != AtWork::Somebody {
            remove(folder)?;
        }
        if at_work == AtWork::Nobody {
            asked::give_up(folder);
        }
        Ok(write_json(&folder.join(UNFINISHED), &json!({ "scenario": own }))?)
    })
}

/// Refuses at once what [`begin`] would refuse, though the work that comes before it takes long.
/// What others do meanwhile is seen there.
///
/// # Errors
/// [`FileError`], refused, that says what the folder holds.
pub(super) fn refuse(folder: &Path, scenario: &Scenario, force: bool) -> Result<(), CliError> {
    let own = serde_json::to_value(scenario).map_err(std::io::Error::other)?;
    let at_work = at_work_in(folder);
    refuse_study(folder, at_work)?;
    refuse_held(folder, &own, at_work, force)
}

/// Refuses the `runs` of a study and every folder in it, there or not yet: what stands there is
/// taken for the study's.
///
/// # Errors
/// [`FileError`], refused, that says what the study holds.
pub(super) fn refuse_run_of_study(folder: &Path) -> Result<(), FileError> {
    let Some((study, held)) = asked::study_around(folder) else { return Ok(()) };
    let held = held.trim_start_matches("it ");
    let study = study.display();
    let why = format!(
        "it belongs to the runs of a study: {study} {held}; choose another folder with --out"
    );
    Err(error::refused(WRITE, folder, why))
}

/// Refuses the folder of the specimen that a run begins with, by force, too: its stage would not be
/// found there again.
///
/// # Errors
/// [`FileError`], refused.
pub(super) fn refuse_beginning(folder: &Path, scenario: &Scenario) -> Result<(), FileError> {
    let Some(begin) = &scenario.begin else { return Ok(()) };
    let from = begin.folder();
    let from = if from.as_os_str().is_empty() { Path::new(".") } else { from.as_path() };
    let there = folder.canonicalize().ok();
    if there.is_none() || from.canonicalize().ok() != there {
        return Ok(());
    }
    let why = "the run begins with the specimen in it; choose another folder with --out";
    Err(error::refused(WRITE, folder, why))
}

fn refuse_study(folder: &Path, at_work: AtWork) -> Result<(), FileError> {
    refuse_run_of_study(folder)?;
    let Some(held) = asked::study_in(folder, at_work) else { return Ok(()) };
    let why = format!("{held}; a run replaces no study, choose another folder with --out");
    Err(error::refused(WRITE, folder, why))
}

/// Refuses what a folder holds that a run would write over, unless by force; where somebody is at
/// work there, by force, too: two runs that write over each other would leave the results of neither.
fn refuse_held(folder: &Path, own: &Value, at_work: AtWork, force: bool) -> Result<(), CliError> {
    let Some(held) = held(folder, own, at_work) else { return Ok(()) };
    let why = match at_work {
        AtWork::Somebody => format!("{held}, and a command is at work there; name another folder"),
        _ if force => return Ok(()),
        _ => format!("{held}; name another folder, or give --force to replace them"),
    };
    Err(error::refused(WRITE, folder, why).into())
}

/// Says that the run of a folder is finished.
pub(super) fn finished(folder: &Path) {
    // Where it stays, the manifest beside it says the same.
    let _ = fs::remove_file(folder.join(UNFINISHED));
}

/// What a folder holds that a run of a scenario would write over; none where it may write.
fn held(folder: &Path, own: &Value, at_work: AtWork) -> Option<String> {
    for (file, what) in [(MANIFEST, "a run"), (UNFINISHED, "an unfinished run")] {
        let path = folder.join(file);
        if !path.is_file() {
            continue;
        }
        if file == UNFINISHED && at_work == AtWork::Nobody && !has_stages(folder) {
            return None;
        }
        let Ok(Value::Object(mut of)) = read_json::<Value>(&path) else {
            return Some(format!("it holds {what} whose {file} cannot be read"));
        };
        let mut other = of.remove("scenario").unwrap_or_default();
        Scenario::remove_what_changes_no_bit(&mut other);
        if let Some(why) = of_earlier_version(&other) {
            return Some(format!("it holds the results of {what}, and {why}"));
        }
        return match first_difference("", &other, own) {
            None => None,
            Some(field) if field == "name" => {
                let name = other["name"].as_str().unwrap_or_default();
                Some(format!("it holds the results of {what} of another scenario, `{name}`"))
            }
            Some(field) => Some(format!(
                "it holds the results of {what} of another scenario: `{field}` differs"
            )),
        };
    }
    let there = RESULTS.iter().find(|name| folder.join(name).is_file());
    there.map(|there| format!("it holds the results of another command ({there})"))
}

/// Whether a stage is stored in a folder: a run that ended before left nothing to lose.
fn has_stages(folder: &Path) -> bool {
    let entries = fs::read_dir(folder.join("stages")).into_iter().flatten().flatten();
    entries.into_iter().any(|entry| entry.path().is_dir())
}

/// Removes what another run left that the next one may not write again.
fn remove(folder: &Path) -> Result<(), FileError> {
    let figures = fs::read_dir(folder.join("figures")).into_iter().flatten().flatten();
    let drawn = figures.map(|entry| entry.path()).filter(|path| {
        path.extension().is_some_and(|e| ["svg", "png", "csv"].iter().any(|of| e == *of))
    });
    let files = REMOVED.iter().map(|name| folder.join(name)).chain(drawn);
    for path in files.collect::<Vec<PathBuf>>() {
        match fs::remove_file(&path) {
            Err(error) if error.kind() != std::io::ErrorKind::NotFound => {
                return Err(FileError::new("remove", &path, error));
            }
            _ => {}
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::plain::assert_holds;

    fn scenario(name: &str, rate_hz: f64) -> Scenario {
        let value = json!({
            "name": name,
            "grains": { "total_mass_g": 30, "density_kg_per_m3": 2673.9, "sieve_table":
                [{ "passing_mm": 12.5, "retained_mm": 10, "mass_percent": 100 }] },
            "engine": { "rate_hz": rate_hz },
            "stages": [{ "stage": "fill_funnel" }]
        });
        serde_json::from_value(value).expect("a scenario")
    }

    fn said(folder: &Path, scenario: &Scenario) -> String {
        begin(folder, scenario, false).err().map(|e| e.to_string()).unwrap_or_default()
    }

    /// Law: what another run left is written over by `--force` alone; the same run goes on.
    #[test]
    fn results_of_another_run_are_kept() {
        let folder = tempfile::tempdir().expect("a folder");
        let out = folder.path();
        let own = scenario("a", 480.0);
        assert_eq!(said(out, &own), "", "law: an empty folder");
        assert_eq!(said(out, &own), "", "law: an unfinished run goes on");
        let told = Scenario { description: "in other words".into(), ..own.clone() };
        assert_eq!(said(out, &told), "", "law: words change no result");
        assert_eq!(said(out, &scenario("b", 480.0)), "", "law: without a stage nothing is lost");
        assert_eq!(said(out, &own), "", "law: that one, too");
        fs::create_dir_all(out.join("stages/0123456789abcdef")).expect("made");
        assert!(said(out, &scenario("b", 480.0)).contains("`a`"), "law: an unfinished run is kept");
        write_json(&out.join(MANIFEST), &json!({ "scenario": own })).expect("written");
        fs::write(out.join("rest_test.csv"), "").expect("written");
        finished(out);
        assert!(!out.join(UNFINISHED).exists(), "law: it is finished");
        assert_eq!(said(out, &own), "", "law: the same run may be done again");
        let mut threads = own.clone();
        threads.engine.native.threads = Some(2);
        let typed = json!({ "scenario": threads.as_typed() });
        write_json(&out.join(MANIFEST), &typed).expect("written");
        assert_eq!(said(out, &own), "", "law: threads change no result");
        let said = said(out, &scenario("a", 240.0));
        assert_holds(&said, &["engine.rate_hz", "--force", "another scenario"]);
        assert!(out.join("rest_test.csv").exists(), "law: nothing is removed by a refusal");
        begin(out, &scenario("a", 240.0), true).expect("law: --force replaces them");
        assert!(!out.join("rest_test.csv").exists(), "law: nothing of the other run stays");
    }

    /// Law: a run does not write over the specimen that it begins with.
    #[test]
    fn what_a_run_begins_with_is_kept() {
        let folders = [(); 2].map(|()| tempfile::tempdir().expect("a folder"));
        let [from, other] = folders.each_ref().map(|folder| folder.path());
        let begun = |specimen: &Path| -> Scenario {
            let mut value = serde_json::to_value(scenario("a", 480.0)).expect("JSON");
            value["begin"] = json!({ "specimen": specimen });
            serde_json::from_value(value).expect("a scenario")
        };
        for specimen in [from.to_owned(), from.join("specimen.json"), from.join(".")] {
            let error = refuse_beginning(from, &begun(&specimen)).expect_err("law: it is kept");
            assert!(error.to_string().contains("begins with the specimen in it"), "got `{error}`");
        }
        for out in [other.to_owned(), from.join("new"), from.join("..")] {
            let found = refuse_beginning(&out, &begun(from)).map_err(|e| e.to_string());
            assert_eq!(found, Ok(()), "law: {} is another folder", out.display());
        }
        let found = refuse_beginning(from, &scenario("a", 480.0)).map_err(|e| e.to_string());
        assert_eq!(found, Ok(()), "law: others may be asked to replace it");
    }

    /// Law: while a run is at work in a folder, before its first stage and after, another scenario
    /// is refused there, by force, too; the same scenario is not.
    #[test]
    fn a_run_at_work_is_left_alone() {
        let folder = tempfile::tempdir().expect("a folder");
        let out = folder.path();
        let (own, other) = (scenario("a", 480.0), scenario("b", 480.0));
        let first = begin(out, &own, false).expect("law: nobody is there");
        for force in [false, true] {
            // At once, and after grains were cut.
            for refused in [refuse(out, &other, force), begin(out, &other, force).map(drop)] {
                let said = refused.expect_err("law: somebody is there").to_string();
                assert!(said.contains("`a`") && said.contains("at work"), "law: got `{said}`");
                assert!(!said.contains("--force"), "law: no force helps, got `{said}`");
            }
        }
        assert!(refuse(out, &own, false).is_ok(), "law: the same run may join in");
        fs::write(out.join("series.csv"), "").expect("written");
        let second = begin(out, &own, true).expect("law: the same run goes on together");
        assert!(out.join("series.csv").exists(), "law: and removes nothing of the first");
        drop(first);
        assert!(begin(out, &other, true).is_err(), "law: the second is at work still");
        drop(second);
        assert_eq!(said(out, &other), "", "law: both are gone, and left no stage");
    }

    /// Law: of a run of an earlier version the names that have changed are said, not where the
    /// scenarios differ.
    #[test]
    fn runs_of_earlier_versions_are_known() {
        let folder = tempfile::tempdir().expect("a folder");
        let old = json!({ "name": "a", "engine": { "contact_path": "bullet" } });
        write_json(&folder.path().join(MANIFEST), &json!({ "scenario": old })).expect("written");
        let said = said(folder.path(), &scenario("a", 480.0));
        assert_holds(&said, &["earlier version", "now called `engine.contact_solver`", "--force"]);
        assert!(!said.contains("differs"), "law: a name is no difference, got `{said}`");
    }

    /// Law: no file of a run comes into the folder of a study, by force either, and nothing there is
    /// removed; the refusal says what the folder holds.
    #[test]
    fn a_run_stays_out_of_the_folder_of_a_study() {
        let names = |folder: &Path| {
            let entries = fs::read_dir(folder).expect("a folder").flatten();
            let mut names: Vec<_> = entries.map(|entry| entry.file_name()).collect();
            names.sort();
            names
        };
        let own = scenario("a", 480.0);
        for (files, words) in [
            // Interrupted, of this build and of one that did not say its command; finished; with a
            // run's files among its own; of an unknown study.
            (&[asked::FILE, "grains.json"][..], "`pluvia sweep`"),
            (&["plan.json", "grains.json", "figures"][..], "`pluvia sweep` (plan.json)"),
            (&[asked::FILE, "compare.json", "report.html"][..], "`pluvia compare` (compare.json)"),
            (&["plan.json", MANIFEST, "summary.json"][..], "`pluvia sweep` (plan.json)"),
            (&["report.html"][..], "another command (report.html)"),
        ] {
            let folder = tempfile::tempdir().expect("a folder");
            let out = folder.path();
            for file in files {
                let asked = json!({ "command": "sweep", "question": null, "scenario": own });
                write_json(&out.join(file), &asked).expect("written");
            }
            let before = names(out);
            for force in [false, true] {
                let begun = begin(out, &own, force).map(drop);
                for refused in [begun, refuse(out, &own, force)] {
                    let why = refused.expect_err("law: a run stays out");
                    assert_eq!(why.exit_code(), 2, "law: the folder is refused, got `{why}`");
                    let why = why.to_string();
                    let folder = out.to_string_lossy();
                    assert_holds(&why, &[words, &folder, "--out"]);
                    assert!(!why.contains("--force"), "law: force does not help, got `{why}`");
                    assert_eq!(names(out), before, "law: the folder is as it was");
                }
            }
        }
    }

    /// Law: the runs of a study are its own: no other run replaces one of them or stands among them,
    /// by force either, whether its folder is there or not. Beside what is no study `runs` is a name
    /// like any other.
    #[test]
    fn a_run_stays_out_of_the_runs_of_a_study() {
        let folder = tempfile::tempdir().expect("a folder");
        let (study, own) = (folder.path(), scenario("a", 480.0));
        let out = study.join("runs/point-0001-c1");
        let absent = study.join("runs/mine");
        fs::create_dir_all(&out).expect("made");
        fs::write(study.join("report.html"), "").expect("written");
        drop(begin(&out, &own, false).expect("law: no study is known there"));
        write_json(&out.join(MANIFEST), &json!({ "scenario": own })).expect("written");
        finished(&out);
        fs::write(study.join("plan.json"), "").expect("written");
        let before = fs::read(out.join(MANIFEST)).expect("it is there");
        for (at, name) in [(&out, "a"), (&out, "b"), (&absent, "a"), (&study.join("runs"), "a")] {
            let of = scenario(name, 480.0);
            for force in [false, true] {
                let begun = begin(at, &of, force).map(drop);
                for refused in [begun, refuse(at, &of, force)] {
                    let why = refused.expect_err("law: a run stays out");
                    assert_eq!(why.exit_code(), 2, "law: the folder is refused, got `{why}`");
                    let why = why.to_string();
                    let holds = "holds the results of `pluvia sweep` (plan.json)";
                    assert_holds(&why, &["the runs of a study", holds, "--out"]);
                }
            }
        }
        let after = fs::read(out.join(MANIFEST)).expect("law: it is there still");
        assert!(after == before && !absent.exists(), "law: the study's runs are as they were");
        let aside = study.join("mine/runs/a");
        fs::create_dir_all(&aside).expect("made");
        assert_eq!(said(&aside, &own), "", "law: not of that study");
    }

    #[test]
    fn results_of_another_command_are_kept() {
        for file in ["report.html", "grains.json"] {
            let folder = tempfile::tempdir().expect("a folder");
            fs::write(folder.path().join(file), "").expect("written");
            let said = said(folder.path(), &scenario("a", 480.0));
            assert!(said.contains(file), "law: `{file}` is named, got `{said}`");
        }
        let folder = tempfile::tempdir().expect("a folder");
        let at_work = asked::begin(folder.path(), "density", &asked::ANYTHING).expect("it begins");
        let told = said(folder.path(), &scenario("a", 480.0));
        assert_holds(&told, &["the results of `pluvia density`", "a command is at work"]);
        drop(at_work);
        assert_eq!(said(folder.path(), &scenario("a", 480.0)), "", "law: it left nothing");
        let is_asked = folder.path().join(asked::FILE).exists();
        assert!(!is_asked, "law: the folder is a run's from now on");
        let folder = tempfile::tempdir().expect("a folder");
        fs::write(folder.path().join(MANIFEST), "torn").expect("written");
        let said = said(folder.path(), &scenario("a", 480.0));
        assert!(said.contains("cannot be read"), "law: it may be anything, got `{said}`");
    }
}
