//! Scenarios that begin with a specimen of another run.
//!
//! What the file leaves out is as in that run: its scenario is laid under the file's, stages,
//! name and words aside. Which stage of it is meant is looked up in the run's `manifest.json` and
//! noted in the scenario, so that a run folder says what it began with.

use super::*;

parts! {
/// The specimen that a scenario begins with, in place of its first stages.
#[derive(Eq)]
pub struct BeginSpec {
    /// Folder of a run, as `pluvia run` leaves it, or the `specimen.json` in it, or that of one of
    /// its stored stages; relative to the scenario file that names it, once loaded to the working
    /// directory.
    pub specimen: String, schemars(length(min = 1));
    /// The stage at whose end the specimen is taken: its number from 0 as a text (`"0"`), its name,
    /// or `rest_test`; left out, the last one of the scenario.
    pub stage: Option<String>, skip "Option::is_none",
        schemars(length(min = 1), extend("x-allowed" = "a text: the name of a stage, \"rest_test\", \
            or a number from 0 in double quotes, \"0\""));
    /// Stages that the specimen has been through, in order. Filled in when the scenario is loaded.
    pub after: Vec<String>, skip "Vec::is_empty",
        schemars(length(max = 200), extend("x-filled-in" = true));
    /// Key of the last of them in the run's store. Filled in when the scenario is loaded; where it
    /// is given, no other stage is taken.
    pub key: Option<String>, skip "Option::is_none", schemars(extend("x-filled-in" = true));
    /// SHA-256 of the specimen, likewise.
    pub specimen_sha256: Option<String>, skip "Option::is_none",
        schemars(extend("x-filled-in" = true));
    /// Paths of contact settings that are as in the run, or, where they were automatic there,
    /// larger if the scenario's own loads ask for that. Filled in when the scenario is loaded; a path
    /// with another value than that is refused.
    pub taken_over: Vec<String>, skip "Vec::is_empty",
        schemars(length(max = 10), extend("x-filled-in" = true));
}
}

/// Fields of a run's scenario that are not taken from it.
const OWN: [&str; 5] = ["name", "description", "notes", "stages", "begin"];

/// Largest manifest in bytes, scenario with a recorded motion included.
const LARGEST_MANIFEST: u64 = 64 << 20;

/// Name of the file that holds a run's grains.
const GRAINS_FILE: &str = "grains.json";

/// Name of the file that may be named in place of a run's folder.
const SPECIMEN_FILE: &str = "specimen.json";

impl BeginSpec {
    /// Folder of the run.
    pub fn folder(&self) -> PathBuf {
        run_folder(Path::new(&self.specimen)).0
    }
}

/// Folder of a run from a folder or file that names it, and the stage that a stored stage's file
/// means, by the beginning of its key.
fn run_folder(named: &Path) -> (PathBuf, Option<String>) {
    if named.is_dir() {
        return (named.to_owned(), None);
    }
    let folder = named.parent().unwrap_or(Path::new(""));
    if folder.join("stage.json").is_file() {
        let stored = folder.file_name().map(|name| name.to_string_lossy().into_owned());
        return (folder.join("../.."), stored);
    }
    (folder.to_owned(), None)
}

/// Looks up what a document begins with, where it does: fills in what it leaves out from that
/// run, and which stage it is. The run's scenario, and the faults of what cannot be begun with.
pub(super) fn read(document: &mut Document) -> (Option<Map<String, Value>>, Vec<Fault>) {
    let Some(begin) = document.value.get("begin") else { return (None, Vec::new()) };
    let has_form =
        |spec: &BeginSpec| !spec.specimen.is_empty() && spec.stage.as_deref() != Some("");
    let Some(mut spec) = BeginSpec::deserialize(begin).ok().filter(has_form) else {
        // The schema reports faults of form.
        put_grains(document);
        return (None, Vec::new());
    };
    match found(document, &mut spec) {
        Ok(scenario) => {
            let mut found = begun::contradictions(&scenario, &document.value);
            found.extend(begun::other_apparatus(&scenario, &document.value, &spec.after));
            // Grains that are refused are not judged as a mixture with those of the run.
            if let Value::Object(fields) = &mut document.value
                && found.iter().any(|fault| fault.path.starts_with("grains"))
            {
                fields.remove("grains");
            }
            // A scenario that was loaded before has values, too, and says itself which of them are
            // taken over: whether they are is seen by `begun::stiffen`.
            for path in begun::taken_over(&scenario, &document.value) {
                if !spec.taken_over.contains(&path) {
                    spec.taken_over.push(path);
                }
            }
            let faults = found.into_iter().map(|fault| document.with_origin(fault)).collect();
            take_over(document, scenario.clone(), &spec);
            (Some(scenario), faults)
        }
        Err(fault) => {
            let fault = document.with_origin(fault);
            put_grains(document);
            (None, vec![fault])
        }
    }
}

/// Puts grains where nobody typed any: without them a scenario whose specimen cannot be looked up
/// would have a second fault.
fn put_grains(document: &mut Document) {
    let from_nowhere = json!({ "file": "grains.json" });
    if let Value::Object(fields) = &mut document.value {
        fields.entry("grains").or_insert(from_nowhere);
    }
}

/// The run's scenario; the stage is noted in the specification.
fn found(document: &Document, spec: &mut BeginSpec) -> Result<Map<String, Value>, Fault> {
    let fault = |field: &str, found: &str, allowed: &str, message: String| {
        Fault::new(message, Value::from(found), allowed).at(format!("begin.{field}"))
    };
    let named = placed(&spec.specimen, document);
    let (folder, stored) = run_folder(&named);
    let file = folder.join("manifest.json");
    let runs = "a folder of a finished run, as `pluvia run` leaves it, or its specimen.json";
    let of_specimen = |message: String| fault("specimen", &spec.specimen, runs, message);
    if !named.exists() {
        return Err(of_specimen(format!("{} is not there", named.display())));
    }
    let is_file = !named.is_dir();
    if is_file && named.file_name().is_none_or(|name| name != SPECIMEN_FILE) {
        return Err(of_specimen(format!("{} is no specimen of a run", named.display())));
    }
    let manifest = input::read(&file, LARGEST_MANIFEST).map_err(|e| e.to_string());
    let mut manifest: Value = manifest
        .and_then(|text| serde_json::from_slice(&text).map_err(|e| e.to_string()))
        .map_err(|why| of_specimen(format!("{} cannot be used: {why}", file.display())))?;
    // Whoever begins with the specimen says by how many threads.
    if let Some(scenario) = manifest.get_mut("scenario") {
        Scenario::remove_what_changes_no_bit(scenario);
    }
    let scenario = manifest["scenario"].as_object().cloned();
    let scenario =
        scenario.ok_or_else(|| of_specimen(format!("{} has no scenario in it", file.display())))?;
    if let Some(why) = renamed::of_earlier_version(&manifest["scenario"]) {
        return Err(of_specimen(format!("{} cannot be used: {why}", file.display())));
    }
    if !scenario.get("grains").is_some_and(Value::is_object) {
        return Err(of_specimen(format!("{} has no grains in it", file.display())));
    }
    let entries: Vec<&Value> = manifest["stages"].as_array().into_iter().flatten().collect();
    let rest_test = Some(&manifest["rest_test"]).filter(|rest_test| rest_test.is_object());
    let text = |entry: &Value, field: &str| entry[field].as_str().unwrap_or_default().to_owned();
    let key = |entry: &Value| text(entry, "key");
    let mut after: Vec<String> = entries.iter().map(|entry| text(entry, "stage")).collect();
    // Number of the stage; `None` stands for the rest test.
    let number = match (spec.stage.as_deref(), &stored) {
        (None, None) => entries.len().checked_sub(1),
        (None, Some(stored)) => {
            let mut all = entries.iter().copied().map(Some).chain([rest_test]);
            let place = all.position(|e| e.is_some_and(|e| key(e).starts_with(stored)));
            let place = place.ok_or_else(|| {
                of_specimen(format!("the run in {} has no such stage", folder.display()))
            })?;
            Some(place).filter(|place| *place < entries.len())
        }
        (Some(asked), Some(_)) => {
            let message = "`specimen` is the file of one stage already".to_owned();
            return Err(fault("stage", asked, "the field left out", message));
        }
        (Some("rest_test"), None) if rest_test.is_some() => None,
        (Some(asked), None) => {
            let is_noted = |n: usize| spec.key == Some(key(entries[n]));
            Some(number_of(asked, &after, rest_test.is_some(), is_noted)?)
        }
    };
    let entry = match number {
        Some(number) => {
            after.truncate(number + 1);
            entries.get(number).copied()
        }
        None => {
            after.push("rest".to_owned());
            rest_test
        }
    };
    let entry = entry.ok_or_else(|| of_specimen("the run has no stage".to_owned()))?;
    if is_file {
        let noted = match &stored {
            Some(_) => &entry["specimen_sha256"],
            None => &manifest["files_sha256"][SPECIMEN_FILE],
        };
        check_unchanged(&named, noted).map_err(of_specimen)?;
    }
    // Runs of one command share them, in the folder that holds `runs/`.
    let lies_in = |place: &Path| ["stages", GRAINS_FILE].map(|name| place.join(name));
    let mut needed = lies_in(&folder).into_iter().zip(lies_in(&folder.join("../..")));
    if let Some((missing, _)) = needed.find(|(own, shared)| !own.exists() && !shared.exists()) {
        let why = "is not there, and the specimen is read from it";
        return Err(of_specimen(format!("{} {why}", missing.display())));
    }
    // What a specimen began with itself has been done, too.
    let earlier = scenario.get("begin").and_then(|begin| begin["after"].as_array());
    let earlier = earlier.into_iter().flatten().filter_map(Value::as_str).map(str::to_owned);
    spec.after = earlier.chain(after).collect();
    for (field, typed) in [("key", &mut spec.key), ("specimen_sha256", &mut spec.specimen_sha256)] {
        let own = text(entry, field);
        if let Some(typed) = typed.as_ref().filter(|typed| **typed != own) {
            let message = "the run holds another specimen by now".to_owned();
            return Err(fault(field, typed, &format!("{own}, or the field left out"), message));
        }
        *typed = Some(own);
    }
    Ok(scenario)
}

/// Number of the stage that is asked for among those of these names; of several of one name the
/// one that is noted, as in a scenario that was loaded before.
fn number_of(
    asked: &str,
    names: &[String],
    has_rest_test: bool,
    is_noted: impl Fn(usize) -> bool,
) -> Result<usize, Fault> {
    let fault = |message: String, allowed: String| {
        Fault::new(message, Value::from(asked), allowed).at("begin.stage")
    };
    match MeantStage::of(asked, names.iter().map(String::as_str)) {
        MeantStage::One(number) => Ok(number),
        MeantStage::Several(numbers) => {
            let noted = numbers.iter().copied().find(|n| is_noted(*n));
            noted.ok_or_else(|| {
                let allowed = format!("its number, as a text: {}", MeantStage::choice(&numbers));
                fault("the run has several stages of this name".to_owned(), allowed)
            })
        }
        MeantStage::None => {
            let mut known: Vec<&str> = names.iter().map(String::as_str).collect();
            known.extend(has_rest_test.then_some("rest_test"));
            let message = match (renamed::stage(asked), nearest(asked, known.iter().copied())) {
                (Some(now), _) if known.contains(&now) => {
                    format!("this stage is now called `{now}`")
                }
                (_, Some(near)) => format!("the run has no such stage, did you mean `{near}`?"),
                (_, None) => "the run has no such stage".to_owned(),
            };
            Err(fault(message, format!("one of {}", known.join(", "))))
        }
    }
}

/// Whether a file is as its run wrote it: what is begun with is read from the run's store, and who
/// names another file means another specimen.
fn check_unchanged(file: &Path, noted: &Value) -> Result<(), String> {
    let Some(noted) = noted.as_str() else {
        return Err(format!(
            "the run's manifest does not say what {} held: name the folder of the run",
            file.display()
        ));
    };
    let content = input::read(file, input::LARGEST_OF_RUN)
        .map_err(|why| format!("{} cannot be read: {why}", file.display()))?;
    if input::sha256(&content) != noted {
        return Err(format!("{} is not what the run has written", file.display()));
    }
    Ok(())
}

/// A path of a document from here.
fn placed(path: &str, document: &Document) -> PathBuf {
    document.folder("begin.specimen").join(path)
}

/// Lays a document over the scenario of the run that it begins with.
fn take_over(document: &mut Document, mut scenario: Map<String, Value>, spec: &BeginSpec) {
    scenario.retain(|field, _| !OWN.contains(&field.as_str()));
    // The run's grains lie in it, wherever it took them from itself.
    let is_sieved = scenario
        .get("grains")
        .is_some_and(|grains| grains.get("file").is_none() && grains.get("meshes").is_none());
    if !is_sieved {
        let (named, _) = run_folder(Path::new(&spec.specimen));
        let (here, _) = run_folder(&placed(&spec.specimen, document));
        let shared = !here.join(GRAINS_FILE).is_file();
        let folder = if shared { named.join("../..") } else { named };
        let file = folder.join(GRAINS_FILE).to_string_lossy().into_owned();
        let grains = json!({ "file": file });
        // A name of the document's own leads from where it is given. What else it says of grains
        // repeats the run's, or would be a contradiction.
        let own = document.value.get("grains").and_then(|grains| grains.get("file"));
        if own.is_none() {
            let origin = document.origin("begin.specimen");
            document.set_origin("grains", &grains, origin);
            if let Value::Object(fields) = &mut document.value {
                fields.remove("grains");
            }
        }
        scenario.insert("grains".to_owned(), grains);
    }
    let mut value = Value::Object(scenario);
    merge(&mut value, document.value.take(), "");
    if let Ok(begin) = serde_json::to_value(spec) {
        value["begin"] = begin;
    }
    document.value = value;
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Law: grains that a run has not made itself lie in it; who begins there may name another file
    /// of them, which leads from where it is named, or repeat what the run says of them.
    #[test]
    fn grains_of_meshes_are_found_in_the_run() {
        let folder = tempfile::tempdir().expect("a folder");
        let (file, begun) = (folder.path().join("s.json"), folder.path().join("run"));
        std::fs::create_dir(&begun).expect("a folder");
        std::fs::write(begun.join("grains.json"), "{}").expect("written");
        let meshes = json!({ "meshes": ["/a.stl"], "density_kg_per_m3": 2650 });
        let in_run = begun.join("grains.json").to_string_lossy().into_owned();
        for (own, expected, from) in [
            (json!({}), &*in_run, Path::new("")),
            (json!({ "density_kg_per_m3": 2650 }), &*in_run, Path::new("")),
            (json!({ "file": "own.json" }), "own.json", folder.path()),
        ] {
            let text = json!({ "grains": own }).to_string();
            std::fs::write(&file, text).expect("written");
            let mut document = source::read(&file).expect("a scenario");
            let change = format!("begin.specimen={}", begun.display());
            let change: Override = change.parse().expect("a change");
            change.apply(&mut document).expect("it is made");
            let spec = BeginSpec::deserialize(&document.value["begin"]).expect("a beginning");
            let run = Map::from_iter([("grains".to_owned(), meshes.clone())]);
            take_over(&mut document, run, &spec);
            let got = &document.value["grains"];
            assert_eq!(*got, json!({ "file": expected }), "law: the grains where {own} is typed");
            let got = document.folder("grains.file");
            assert_eq!(got, from, "law: where its name leads from, where {own} is typed");
        }
    }
}
