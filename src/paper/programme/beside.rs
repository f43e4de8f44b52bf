//! What other engines and settings made of the same programme: kept in the
//! output folder, so that the report of one shows the others.

use serde::de::DeserializeOwned;

use super::*;
use crate::protocol::Progress;
use crate::record::{Beside, hash_json, keep_beside};
use crate::study::STAGE_FORMAT;

/// Folder of the columns in the output folder.
const FOLDER: &str = "beside";

/// What a programme, or an interpretation of it, with an engine is called: in words, and in names of
/// runs and files.
pub(super) fn names(
    interpretation: Option<&str>,
    own: &EngineSettings,
    engine: &EngineSettings,
) -> (String, String) {
    match interpretation {
        None => (label(own, engine), suffix(own, engine)),
        Some(name) => {
            let label = interpretation_label(name, own, engine);
            let suffix = dashed(&label);
            (label, suffix)
        }
    }
}

/// The engine in words: who carries the grains and finds the contacts, and every setting that is
/// not that of a programme's own engine.
pub(super) fn label(own: &EngineSettings, engine: &EngineSettings) -> String {
    let from = EngineSettings {
        backend: engine.backend,
        contact_solver: engine.contact_solver,
        ..own.clone()
    };
    with_changes(engine.solver_name().to_owned(), &from, engine)
}

/// An interpretation of the paper, whose own engine is given, in words: its name, and every
/// setting of the engine that is changed beside it.
fn interpretation_label(name: &str, own: &EngineSettings, engine: &EngineSettings) -> String {
    with_changes(format!("interpretation {name}"), own, engine)
}

/// A name followed by the settings of an engine that are not those of another.
fn with_changes(name: String, from: &EngineSettings, to: &EngineSettings) -> String {
    let as_json = |e: &EngineSettings| serde_json::to_value(e).unwrap_or(Value::Null);
    let mut changed = Vec::new();
    differences(&as_json(from), &as_json(to), "", &mut changed);
    std::iter::once(name).chain(changed).collect::<Vec<_>>().join(", ")
}

/// The leaves of `b` that are not those of `a`, as `path value`.
fn differences(a: &Value, b: &Value, path: &str, found: &mut Vec<String>) {
    match b {
        Value::Object(fields) => {
            for (name, value) in fields {
                let path = if path.is_empty() { name.clone() } else { format!("{path}.{name}") };
                differences(&a[name], value, &path, found);
            }
        }
        leaf if leaf != a => found.push(match leaf {
            Value::String(text) => format!("{path} {text}"),
            other => format!("{path} {other}"),
        }),
        _ => {}
    }
}

/// What a programme is called in names of runs and files: nothing for its own engine, else its label
/// with dashes.
fn suffix(own: &EngineSettings, engine: &EngineSettings) -> String {
    let label = label(own, engine);
    // By label, not by settings: threads change no result, and no name.
    if label == self::label(own, own) { String::new() } else { dashed(&label) }
}

/// Most letters of a label in names: names of files have at most 255.
const LONGEST: usize = 120;

/// A label as a part of names of runs and files; a long one is cut short, with a hash of it.
fn dashed(label: &str) -> String {
    let letters = label.chars().map(|c| if c.is_ascii_alphanumeric() { c } else { '-' });
    let mut name = String::from("-");
    for letter in letters {
        if !(letter == '-' && name.ends_with('-')) {
            name.push(letter);
        }
    }
    if name.len() > LONGEST {
        let hash = hash_json(&label);
        let hash = &hash[..hash.len().min(12)];
        name.truncate(LONGEST - 1 - hash.len());
        name = format!("{name}-{hash}");
    }
    name
}

/// A hash of a programme without its engine, of results as this build computes them: those of a
/// build that computes others do not stand beside them.
pub(super) fn programme_hash(scenarios: &[&Scenario], configurations: u32) -> String {
    hash_of_format(scenarios, configurations, STAGE_FORMAT)
}

fn hash_of_format(scenarios: &[&Scenario], configurations: u32, format: u32) -> String {
    let without: Vec<Scenario> = scenarios
        .iter()
        .map(|s| Scenario { engine: EngineSettings::default(), ..(*s).clone() })
        .collect();
    hash_json(&(without, configurations, format))
}

/// A hash of a programme, which is given by its own, with an engine.
pub(super) fn programme_and_engine_hash(programme: &str, engine: &EngineSettings) -> String {
    hash_json(&(programme, engine))
}

/// Keeps something in a folder, and gives what others left there of the same programme; what is
/// damaged is reported and left out.
pub(super) fn keep<T: Serialize + DeserializeOwned>(
    folder: &Path,
    name: &str,
    own: &T,
    programme: impl Fn(&T) -> &str,
    progress: &dyn Progress,
) -> Result<Vec<T>, StudyError> {
    let Beside { mut others, damaged } = keep_beside(folder, name, own)?;
    damaged.iter().for_each(|said| progress.message(said));
    others.retain(|other| programme(other) == programme(own));
    Ok(others)
}

/// Keeps a column, and gives those of the same programme by other engines, by label.
pub(super) fn keep_and_read(
    out: &Path,
    suffix: &str,
    column: &Column,
    progress: &dyn Progress,
) -> Result<Vec<Column>, StudyError> {
    let name = format!("claims{suffix}.json");
    let mut columns = keep(&out.join(FOLDER), &name, column, |c| &c.programme, progress)?;
    columns.retain(|other| other.label != column.label);
    columns.sort_by(|a, b| a.label.cmp(&b.label));
    Ok(columns)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scenario::ContactSolver;

    fn column(label: &str, programme: &str) -> Column {
        Column {
            label: label.to_owned(),
            programme: programme.to_owned(),
            claims: Vec::new(),
            stock_bullet: false,
            settlement: None,
        }
    }

    #[test]
    fn labels_name_who_and_what_is_not_default() {
        let default = EngineSettings::default();
        let stock = EngineSettings { contact_solver: ContactSolver::Stock, ..default.clone() };
        let rapier = EngineSettings { backend: Backend::Rapier, ..stock.clone() };
        let faster = EngineSettings { rate_hz: 960.0, ..default.clone() };
        let mut threads = default.clone();
        threads.native.threads = Some(2);
        for (engine, words, name) in [
            (&default, "native", ""),
            (&threads, "native", ""),
            (&stock, "stock", "-stock"),
            (&rapier, "rapier", "-rapier"),
            (&faster, "native, rate_hz 960.0", "-native-rate-hz-960-0"),
        ] {
            assert_eq!(label(&default, engine), words, "law: the label of {engine:?}");
            assert_eq!(suffix(&default, engine), name, "law: the name of {engine:?}");
            assert_eq!(engine.is_stock(), words == "stock", "law: of Bullet alone: {engine:?}");
        }
    }

    /// Law: a label with many changes is still a name of a file, and another one another name.
    #[test]
    fn long_labels_are_cut_short_and_stay_apart() {
        let [one, other] =
            ["1", "2"].map(|last| dashed(&format!("{}{last}", "a.b 0.125 ".repeat(40))));
        assert_eq!((one.len(), other.len()), (LONGEST, LONGEST), "law: at most {LONGEST} letters");
        assert_ne!(one, other, "law: labels that end otherwise have other names");
    }

    /// Law: an interpretation is known by its name and by what is changed of its own engine.
    #[test]
    fn labels_of_interpretations_name_what_is_changed_beside_them() {
        let own = EngineSettings { rate_hz: 960.0, ..EngineSettings::default() };
        let stock = EngineSettings { contact_solver: ContactSolver::Stock, ..own.clone() };
        for (engine, words, name) in [
            (&own, "interpretation full_stroke", "-interpretation-full-stroke"),
            (
                &stock,
                "interpretation full_stroke, contact_solver stock",
                "-interpretation-full-stroke-contact-solver-stock",
            ),
        ] {
            let label = interpretation_label("full_stroke", &own, engine);
            assert_eq!((label.as_str(), dashed(&label).as_str()), (words, name), "law: {engine:?}");
        }
    }

    #[test]
    fn only_the_same_programme_stands_beside() {
        let folder = tempfile::tempdir().expect("a folder");
        let stock = EngineSettings::default();
        let engine = |rate_hz| EngineSettings { rate_hz, ..stock.clone() };
        let keep = |rate, column: &Column| {
            let progress = &crate::protocol::Silent;
            keep_and_read(folder.path(), &suffix(&engine(480.0), &engine(rate)), column, progress)
                .expect("kept")
        };
        assert!(keep(100.0, &column("a", "p")).is_empty(), "law: nothing beside the first");
        assert!(keep(200.0, &column("b", "q")).is_empty(), "law: not another programme");
        let beside = keep(300.0, &column("c", "p"));
        assert_eq!(beside, [column("a", "p")], "law: the same programme by another engine");
        let again = keep(100.0, &column("a", "p"));
        assert_eq!(again, [column("c", "p")], "law: a column is not beside itself");
        let path = folder.path().join("beside/claims-native-rate-hz-300-0.json");
        let edited = std::fs::read_to_string(&path).expect("a file").replace("\"c\"", "\"d\"");
        std::fs::write(&path, edited).expect("edited");
        let beside = keep(100.0, &column("a", "p"));
        assert!(beside.is_empty(), "law: an edited column is left out, got {beside:?}");
    }

    #[test]
    fn the_hash_is_of_everything_but_the_engine() {
        let scenario = crate::study::preset("quick/pluviation.json", &[]).expect("a scenario");
        let mut engine = scenario.clone();
        engine.engine.rate_hz = 960.0;
        let mut seed = scenario.clone();
        seed.seed += 1;
        let hash = |s: &Scenario, n| programme_hash(&[s], n);
        assert_eq!(hash(&scenario, 3), hash(&engine, 3), "law: the engine does not count");
        assert_ne!(hash(&scenario, 3), hash(&seed, 3), "law: the seed counts");
        assert_ne!(hash(&scenario, 3), hash(&scenario, 2), "law: configurations count");
        let earlier = hash_of_format(&[&scenario], 3, STAGE_FORMAT - 1);
        assert_ne!(hash(&scenario, 3), earlier, "law: the format of results counts");
    }
}
