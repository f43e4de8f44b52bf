//! Reads a scenario and answers with every fault at once.

use super::*;

/// A scenario as loaded.
#[derive(Debug, Clone, PartialEq)]
pub struct Loaded {
    /// The scenario.
    pub scenario: Scenario,
    /// The files it was read from: its own first, then the one it extends, and so on.
    pub files: Vec<PathBuf>,
    /// What the files say and nothing reads, for who wrote them.
    pub notes: Vec<String>,
}

/// Tells of grains that have no sieve table what values follow from; `None` where they
/// cannot be read, which whoever makes the grains then says.
pub type GradingOf = fn(&GrainsSpec) -> Option<Grading>;

/// Who reads what a scenario names, and builds its pieces.
#[derive(Debug, Clone, Copy)]
pub struct Readers {
    /// Tells of grains that have no sieve table.
    pub grading: GradingOf,
    /// Reads the convex parts of pieces from mesh files.
    pub parts: PartsOf,
    /// Finds pieces that begin within each other.
    pub overlaps: OverlapsOf,
}

/// Loads a scenario: reads the file and those it extends, lays the overrides
/// over them, fills in what follows from the grains, and checks everything, from
/// spelling to whether the time step can resolve the motion.
///
/// Relative paths in `extends`, `begin.specimen`, `grains.file`, `grains.meshes`, `motion_file` and
/// `shape.mesh.file` begin at the file that gives them, those of overrides at the working directory.
///
/// # Errors
/// [`ScenarioErrors::Unreadable`] for a file that cannot be read, and else
/// [`ScenarioErrors::Faults`] with all faults found.
pub fn load_with(
    path: &Path,
    overrides: &[Override],
    readers: Readers,
) -> Result<Loaded, ScenarioErrors> {
    let mut document = source::read(path)?;
    lay_over(&mut document, overrides);
    load_document_with(document, readers, |_| true)
}

/// Lays overrides over a document; those that do not fit are faults of it.
fn lay_over(document: &mut Document, overrides: &[Override]) {
    for change in overrides {
        if let Err(fault) = change.apply(document) {
            document.faults.push(fault);
        }
    }
}

/// What a scenario says beside its grains.
const BESIDE_GRAINS: [&str; 11] = [
    "apparatus",
    "pieces",
    "measures",
    "index_densities",
    "contact",
    "engine",
    "settle",
    "gravity_m_per_s2",
    "stages",
    "rest_test_s",
    "sample_interval_s",
];

/// Whether what stands at a path says nothing of the grains, under its name of today or an old one.
fn is_beside_grains(path: &str) -> bool {
    let name = path.split(['.', '[']).next().unwrap_or_default().trim();
    let now = renamed_field(name);
    BESIDE_GRAINS.contains(&now.as_deref().unwrap_or(name))
}

/// Loads a scenario for its grains alone: apparatus, contacts, engine and stages are left as if
/// nothing had been typed, whatever stands there. A field that no scenario has is a fault still: it
/// may be a misspelt one of the grains. So is an override of what is left: it would change nothing.
///
/// # Errors
/// As [`load_with`], of what is not left.
pub fn load_grains_with(
    path: &Path,
    overrides: &[Override],
    readers: Readers,
) -> Result<Loaded, ScenarioErrors> {
    let mut document = source::read(path)?;
    if let Value::Object(fields) = &mut document.value {
        fields.retain(|name, _| !is_beside_grains(name));
    }
    document.faults.retain(|fault| !is_beside_grains(&fault.path));
    // Which arrangement of the grains is used says nothing of them.
    let is_idle =
        |change: &Override| is_beside_grains(change.path()) || change.path() == "configuration";
    let (idle, changes): (Vec<Override>, Vec<Override>) =
        overrides.iter().cloned().partition(is_idle);
    document.faults.extend(idle.iter().map(|change| {
        let now = renamed_field(change.path());
        let now = now.map(|now| format!("this field is now called `{now}`; "));
        let what = now.unwrap_or_default() + "the grains do not depend on it";
        change.fault(&what, "a field of `grains`, or `seed`")
    }));
    lay_over(&mut document, &changes);
    if let Value::Object(fields) = &mut document.value {
        // Any will do that may follow.
        let any = match fields.contains_key("begin") {
            true => json!([{ "stage": "rest", "duration_s": 1 }]),
            false => json!([{ "stage": "fill_funnel" }]),
        };
        fields.insert("stages".to_owned(), any);
    }
    // What nobody typed follows from the grains, and may be out of range with them.
    load_document_with(document, readers, |path| !is_beside_grains(path))
}

/// The scenario of a document; of the faults of its values those count whose paths do.
fn load_document_with(
    mut document: Document,
    readers: Readers,
    counts: fn(&str) -> bool,
) -> Result<Loaded, ScenarioErrors> {
    let mut faults = std::mem::take(&mut document.faults);
    let notes = idle_apparatus(&document).into_iter().collect();
    let astray = named_files::faults(&document);
    if !astray.is_empty() {
        faults.extend(astray);
        return Err(ScenarioErrors::Faults(faults));
    }
    let (begun_with, found) = begin::read(&mut document);
    faults.extend(found);
    let of_document = faults.len();
    let mut unread = motion_file::read(&mut document);
    unread.extend(mesh_pieces::read(&mut document, readers.parts));
    let grading = grading_of(&document, readers.grading);
    let is_filled = match &grading {
        Some(grading) => {
            if let Some(run) = &begun_with {
                let found = begun::stiffen(&mut document.value, run, grading);
                faults.extend(found.into_iter().map(|fault| document.with_origin(fault)));
            }
            automatic::fill(&mut document.value, grading);
            true
        }
        None => faulty_grains::fill_by_sizes(&mut document.value),
    };
    if let Err(found) = check_value(&document.value, grading.as_ref(), is_filled) {
        faults.extend(found.into_iter().map(|fault| document.with_origin(fault)));
    }
    faults.extend(unread);
    faults.extend(overlapping_pieces::faults(&document, readers.overlaps, &faults));
    let of_values = faults.split_off(of_document).into_iter();
    let (counted, left): (Vec<Fault>, Vec<Fault>) =
        of_values.partition(|fault| counts(&fault.path));
    faults.extend(counted);
    if !faults.is_empty() {
        return Err(ScenarioErrors::Faults(faults));
    }
    let mut value = document.value.take();
    named_files::place(&mut value, |place| document.folder(place));
    let Some(mut scenario) = read::<Scenario>(&value) else {
        assert!(!left.is_empty(), "what was checked is a scenario");
        return Err(ScenarioErrors::Faults(left));
    };
    scenario.found = grading.filter(|_| scenario.grading_by_sieves().is_none());
    Ok(Loaded { scenario, files: document.files, notes })
}

/// Says that nothing reads an `apparatus` in a file with `pieces`, which stand in its place. It is no
/// fault, as it may come from what a file extends, also merged into one file where a sweep keeps it; of
/// the scenario that a manifest has, which gives every field, it is not said.
fn idle_apparatus(document: &Document) -> Option<String> {
    let value = &document.value;
    let typed = value.get("apparatus")?.as_object().filter(|typed| !typed.is_empty())?;
    let has_pieces = value.get("pieces")?.as_array().is_some_and(|pieces| !pieces.is_empty());
    let in_one_file = document.origin("apparatus") == document.origin("pieces");
    let all = serde_json::to_value(ApparatusSpec::default()).ok()?;
    let is_whole = all.as_object()?.iter().all(|(part, fields)| {
        let given = typed.get(part).and_then(Value::as_object);
        given.is_some_and(|given| {
            fields.as_object().into_iter().flatten().all(|(field, _)| given.contains_key(field))
        })
    });
    (has_pieces && in_one_file && !is_whole).then(|| {
        "apparatus: it means nothing with `pieces`, which stand in place of the funnel, the cylinder \
         and the top plate (allowed: the field left out)"
            .to_owned()
    })
}

/// A scenario's JSON as its files give it: after `extends`, before defaults and
/// overrides, and with the names of files made absolute, so that it means the
/// same wherever it is kept. [`load_with`] alone reports faults.
///
/// # Errors
/// [`ScenarioErrors::Unreadable`] for a file that cannot be read, and
/// [`ScenarioErrors::Faults`] for one that is not JSON.
pub fn gathered(path: &Path) -> Result<Value, ScenarioErrors> {
    let document = source::read(path)?;
    let mut value = document.value.clone();
    let folder = |place: &str| {
        let folder = document.folder(place);
        std::path::absolute(if folder.as_os_str().is_empty() { ".".into() } else { folder })
            .unwrap_or_default()
    };
    named_files::place(&mut value, folder);
    Ok(value)
}

/// Checks a scenario that a program put together; the faults carry its name
/// in place of a file.
///
/// # Errors
/// [`ScenarioErrors::Faults`] with all faults found.
pub fn check(scenario: &Scenario) -> Result<(), ScenarioErrors> {
    let named = |fault: Fault| fault.of(&scenario.name);
    let value = serde_json::to_value(scenario).map_err(|error| {
        let message = format!("the scenario has no JSON form: {error}");
        ScenarioErrors::Faults(vec![named(Fault::new(message, "", ""))])
    })?;
    let checked = check_value(&value, scenario.found.as_ref(), true).map(|_| ());
    checked.map_err(|faults| ScenarioErrors::Faults(faults.into_iter().map(named).collect()))
}

/// The scenario of a JSON value, or all its faults; `grading` is that of its grains. Where values
/// are not filled in that follow from them, they are not judged.
fn check_value(
    value: &Value,
    grading: Option<&Grading>,
    is_filled: bool,
) -> Result<Scenario, Vec<Fault>> {
    let structure::Checked { mut faults, cleaned } = structure::check(value);
    let sound = faults.is_empty();
    // A value that has a fault already needs no second one about its meaning.
    let mut meaning = match is_filled {
        true => validate::faults(&cleaned, grading),
        false => faulty_grains::faults(&cleaned),
    };
    meaning.retain(|fault| !faults.iter().any(|known| known.path == fault.path));
    faults.extend(meaning);
    if sound {
        match serde_path_to_error::deserialize::<_, Scenario>(value) {
            Ok(scenario) if faults.is_empty() => return Ok(scenario),
            Ok(_) => {}
            Err(error) => {
                let allowed = structure::allowed_at(value, &error.path().to_string());
                faults.push(unusable(&error, allowed));
            }
        }
    }
    Err(faults)
}

/// What automatic values follow from, where it is known.
fn grading_of(document: &Document, of_others: GradingOf) -> Option<Grading> {
    let grains = document.value.get("grains")?;
    if let Some(grading) = Grading::of_json(grains) {
        return Some(grading);
    }
    let mut value = json!({ "grains": grains });
    named_files::place(&mut value, |place| document.folder(place));
    of_others(&read(&value["grains"])?)
}
