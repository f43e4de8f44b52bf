//! From files to one JSON value: reading, duplicate keys, `extends`.

use std::cell::RefCell;
use std::collections::HashMap;
use std::fmt;
use std::iter;

use serde::de::{DeserializeSeed, Deserializer, MapAccess, SeqAccess, Visitor};
use serde_json::Number;

use super::json_text::{column_shown, encoding_fault, hint, line, without_comments};
use super::*;

/// Longest chain of files that extend each other.
const LONGEST_CHAIN: usize = 8;

/// Where a value was given.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) enum Origin {
    File(PathBuf),
    /// By an override, as typed with its option, which names files from a folder.
    Set(String, PathBuf),
}

impl fmt::Display for Origin {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::File(path) => path.display().fmt(f),
            Self::Set(text, _) => f.write_str(text),
        }
    }
}

/// A scenario's JSON after `extends`, and where each of its values was given.
#[derive(Debug)]
pub(super) struct Document {
    /// The merged value, without `extends` and `$schema`.
    pub value: Value,
    /// Files read, the scenario's own first, then the one it extends, and so on.
    pub files: Vec<PathBuf>,
    /// Faults that do not keep the rest from being checked.
    pub faults: Vec<Fault>,
    origins: HashMap<String, Origin>,
}

impl Document {
    /// Where the value at a path was given: the origin of the nearest value
    /// around it that was given anywhere.
    pub fn origin(&self, path: &str) -> Origin {
        let mut around = iter::successors(Some(path), |at| Some(&at[..at.rfind(['.', '['])?]));
        let given = around.find_map(|at| self.origins.get(at));
        given.cloned().unwrap_or_else(|| Origin::File(self.files[0].clone()))
    }

    /// A fault with where its value was given.
    pub fn with_origin(&self, fault: Fault) -> Fault {
        let origin = self.origin(&fault.path);
        fault.of(origin)
    }

    /// The folder in which the value at a path names files: that of the file that gives it, or that of
    /// an override, by itself the working directory.
    pub fn folder(&self, path: &str) -> PathBuf {
        match self.origin(path) {
            Origin::File(given_in) => given_in.parent().unwrap_or(Path::new("")).to_owned(),
            Origin::Set(_, folder) => folder,
        }
    }

    /// Notes that a value and everything in it came from an override, in place of what was there.
    pub fn set_origin(&mut self, path: &str, value: &Value, origin: Origin) {
        let within =
            |at: &str| at.strip_prefix(path).is_some_and(|rest| rest.starts_with(['.', '[']));
        self.origins.retain(|at, _| !within(at));
        note_origins(path, value, &origin, &mut self.origins);
    }

    /// Forgets where values were given that are no longer there: lists are replaced whole.
    fn forget_replaced(&mut self) {
        let (mut there, any) = (HashMap::new(), Origin::Set(String::new(), PathBuf::new()));
        note_origins("", &self.value, &any, &mut there);
        self.origins.retain(|at, _| there.contains_key(at));
    }
}

/// Notes where a value and all its fields were given. What a list holds was given with the list,
/// which is replaced whole.
fn note_origins(path: &str, value: &Value, origin: &Origin, into: &mut HashMap<String, Origin>) {
    if !path.is_empty() {
        into.insert(path.to_owned(), origin.clone());
    }
    for (key, value) in value.as_object().into_iter().flatten() {
        note_origins(&field_path(path, key), value, origin, into);
    }
}

/// Reads a scenario file and the files it extends.
pub(super) fn read(path: &Path) -> Result<Document, ScenarioErrors> {
    let mut chain = Chain::default();
    chain.read(path, None)?;
    let mut document = Document {
        value: Value::Object(Map::new()),
        files: chain.links.iter().map(|link| link.file.clone()).collect(),
        faults: chain.faults,
        origins: HashMap::new(),
    };
    for link in chain.links.into_iter().rev() {
        let origin = Origin::File(link.file);
        let content = Value::Object(link.content);
        note_origins("", &content, &origin, &mut document.origins);
        merge(&mut document.value, content, "");
    }
    document.forget_replaced();
    Ok(document)
}

/// Reads a file that extends no other: its JSON and the keys given twice.
pub(super) fn read_alone(file: &Path) -> Result<(Value, Vec<Fault>), ScenarioErrors> {
    let text = input::read(file, input::LARGEST_SCENARIO);
    let text = text.map_err(|e| ScenarioErrors::unread(file, &e, ""))?;
    let mut faults = Vec::new();
    let value = parse(file, &text, &mut faults)?;
    Ok((value, faults))
}

/// Files that extend each other, the last one first.
#[derive(Default)]
struct Chain {
    links: Vec<Link>,
    faults: Vec<Fault>,
}

struct Link {
    file: PathBuf,
    canonical: PathBuf,
    content: Map<String, Value>,
}

impl Chain {
    fn read(&mut self, file: &Path, extended_by: Option<&Path>) -> Result<(), ScenarioErrors> {
        let by = extended_by.map(|by| format!(" ({} extends it)", by.display()));
        let by = by.unwrap_or_default();
        let unread = |e: std::io::Error| ScenarioErrors::unread(file, &e, &by);
        let text = input::read(file, input::LARGEST_SCENARIO).map_err(unread)?;
        let canonical = file.canonicalize().map_err(unread)?;
        let mut content = match parse(file, &text, &mut self.faults)? {
            Value::Object(content) => content,
            other => {
                let fault =
                    Fault::new("a scenario is an object", shown(&other), "an object, { ... }");
                return Err(self.fail(fault.of(file.display())));
            }
        };
        if let Some(fault) = other_files::fault(&content) {
            return Err(self.fail(fault.of(file.display())));
        }
        // Editors put the schema's address there.
        content.shift_remove("$schema");
        let base = content.shift_remove("extends");
        self.links.push(Link { file: file.to_owned(), canonical, content });
        let fault = |found: &Value, allowed: &str, message: String| {
            Fault::new(message, shown(found), allowed).at("extends").of(file.display())
        };
        let base = match base {
            None => return Ok(()),
            Some(Value::String(base)) if !base.is_empty() => base,
            Some(other) => {
                let allowed = "a text, the path of another scenario relative to this one";
                let is_text = other.is_string();
                let message = if is_text { "it is empty" } else { "the value has the wrong type" };
                self.faults.push(fault(&other, allowed, message.into()));
                return Ok(());
            }
        };
        let path = file.parent().unwrap_or(Path::new("")).join(&base);
        let (found, met) = (Value::String(base), path.canonicalize().ok());
        if self.links.iter().any(|link| Some(&link.canonical) == met.as_ref()) {
            let files = self.links.iter().map(|link| &link.file).chain([&path]);
            let circle: Vec<String> = files.map(|file| file.display().to_string()).collect();
            let message = format!("files extend each other in a circle: {}", circle.join(" → "));
            return Err(self.fail(fault(&found, "a file that does not lead back", message)));
        }
        if self.links.len() >= LONGEST_CHAIN {
            let message =
                format!("more than {LONGEST_CHAIN} files extend each other one after the other");
            return Err(self.fail(fault(&found, "a shorter chain", message)));
        }
        self.read(&path, Some(file))
    }

    fn fail(&mut self, fault: Fault) -> ScenarioErrors {
        self.faults.push(fault);
        ScenarioErrors::Faults(std::mem::take(&mut self.faults))
    }
}

/// A value as JSON, shortened to what fits in a line.
pub(super) fn shown(value: &Value) -> String {
    const LONGEST: usize = 60;
    let text = value.to_string();
    match text.char_indices().nth(LONGEST) {
        Some((end, _)) => format!("{}…", &text[..end]),
        None => text,
    }
}

/// Lays what a file says over what it extends: objects field by field, all
/// else replaced. Grains from a file, from meshes and from sieve data replace
/// each other whole.
pub(super) fn merge(base: &mut Value, over: Value, path: &str) {
    match (base, over) {
        (Value::Object(base), Value::Object(over)) => {
            let other_source = path == "grains"
                && !over.is_empty()
                && (over.contains_key("file") != base.contains_key("file")
                    || is_other_mesh_source(base, &over));
            if other_source {
                *base = over;
                return;
            }
            for (key, value) in over {
                let place = field_path(path, &key);
                // What lies under nothing is laid over null.
                merge(base.entry(key).or_insert(Value::Null), value, &place);
            }
        }
        (base, over) => *base = over,
    }
}

/// Whether grains that are laid over others are meshes where those are not, or
/// the other way round. Fields that all of them may have say nothing: a
/// scenario may change only the mass of the grains it extends.
fn is_other_mesh_source(base: &Map<String, Value>, over: &Map<String, Value>) -> bool {
    if over.contains_key("meshes") {
        return !base.contains_key("meshes");
    }
    let complete = ["total_mass_g", "density_kg_per_m3", "sieve_table"];
    base.contains_key("meshes") && complete.iter().all(|field| over.contains_key(*field))
}

/// Parses JSON; keys given twice become faults.
fn parse(file: &Path, text: &[u8], faults: &mut Vec<Fault>) -> Result<Value, ScenarioErrors> {
    let label = file.display().to_string();
    // Some editors put a byte order mark before the text.
    let text = text.strip_prefix("\u{feff}".as_bytes()).unwrap_or(text);
    let text = &*without_comments(text);
    let (parsed, found) = read_value("", &label, text);
    faults.extend(found);
    parsed.map_err(|error| {
        let message = error.to_string();
        let message = message.rsplit_once(" at line ").map_or(message.as_str(), |(m, _)| m);
        let (row, column) = (line(text, error.line()), error.column());
        let place = format!("line {}, column {}", error.line(), column_shown(row, column));
        let hint = hint(row, column);
        let message = format!("this is not JSON: {message}{hint}");
        let fault = encoding_fault(text, error.line());
        let fault = fault.unwrap_or_else(|| Fault::new(message, "", "").at(place));
        faults.push(fault.of(&label));
        ScenarioErrors::Faults(std::mem::take(faults))
    })
}

/// Parses JSON that is to stand at a path, as a file's is parsed; `None` where the text is none.
///
/// # Errors
/// The first key that is given twice.
pub(super) fn parse_value(path: &str, text: &str) -> Result<Option<Value>, Fault> {
    let (parsed, found) = read_value(path, "", text.as_bytes());
    // A key given twice in what is no JSON is part of a text.
    let Ok(value) = parsed else { return Ok(None) };
    found.into_iter().next().map_or(Ok(Some(value)), Err)
}

/// The value of a text that stands at a path of a file, and its keys that are given twice.
fn read_value(path: &str, file: &str, text: &[u8]) -> (serde_json::Result<Value>, Vec<Fault>) {
    let faults = RefCell::new(Vec::new());
    let mut parser = serde_json::Deserializer::from_slice(text);
    let node = Node { path: path.to_owned(), file, faults: &faults };
    let value = node.deserialize(&mut parser).and_then(|value| parser.end().map(|()| value));
    (value, faults.into_inner())
}

/// Builds the value at a path and notes keys given twice.
struct Node<'a> {
    path: String,
    file: &'a str,
    faults: &'a RefCell<Vec<Fault>>,
}

impl<'de> DeserializeSeed<'de> for Node<'_> {
    type Value = Value;

    fn deserialize<D: Deserializer<'de>>(self, deserializer: D) -> Result<Value, D::Error> {
        deserializer.deserialize_any(self)
    }
}

impl<'de> Visitor<'de> for Node<'_> {
    type Value = Value;

    fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str("a JSON value")
    }

    fn visit_unit<E>(self) -> Result<Value, E> {
        Ok(Value::Null)
    }

    fn visit_bool<E>(self, value: bool) -> Result<Value, E> {
        Ok(Value::Bool(value))
    }

    fn visit_i64<E>(self, value: i64) -> Result<Value, E> {
        Ok(Value::Number(value.into()))
    }

    fn visit_u64<E>(self, value: u64) -> Result<Value, E> {
        Ok(Value::Number(value.into()))
    }

    fn visit_f64<E: serde::de::Error>(self, value: f64) -> Result<Value, E> {
        // 20.0 is the whole number 20, exactly so below 2^53; above, a number has the value that is
        // read, and a seed may be as large as 2^64.
        if value.fract() == 0.0 && value.abs() < 9_007_199_254_740_992.0 {
            return Ok(Value::Number((value as i64).into()));
        }
        if (0.0..18_446_744_073_709_551_616.0).contains(&value) && value.fract() == 0.0 {
            return Ok(Value::Number((value as u64).into()));
        }
        let number = Number::from_f64(value);
        number.map(Value::Number).ok_or_else(|| E::custom("a number is not finite"))
    }

    fn visit_str<E>(self, value: &str) -> Result<Value, E> {
        Ok(Value::String(value.to_owned()))
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut items: A) -> Result<Value, A::Error> {
        let mut array = Vec::new();
        while let Some(item) = items.next_element_seed(Node {
            path: format!("{}[{}]", self.path, array.len()),
            file: self.file,
            faults: self.faults,
        })? {
            array.push(item);
        }
        Ok(Value::Array(array))
    }

    fn visit_map<A: MapAccess<'de>>(self, mut entries: A) -> Result<Value, A::Error> {
        let mut object = Map::new();
        while let Some(key) = entries.next_key::<String>()? {
            let path = field_path(&self.path, &key);
            let node = Node { path: path.clone(), file: self.file, faults: self.faults };
            let value = entries.next_value_seed(node)?;
            if let Some(first) = object.get(&key) {
                let found = format!("{}, then {}", shown(first), shown(&value));
                let fault = Fault::new("the field is given twice", found, "each field once");
                self.faults.borrow_mut().push(fault.at(path).of(self.file));
            } else {
                object.insert(key, value);
            }
        }
        Ok(Value::Object(object))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn parsed(text: &str) -> Result<Value, String> {
        let mut faults = Vec::new();
        let value = parse(Path::new("a.json"), text.as_bytes(), &mut faults);
        value.map_err(|error| error.to_string())
    }

    /// Law: comments say nothing, and text that only looks like one is no comment.
    #[test]
    fn comments_are_left_out() {
        let text =
            "// first\n{ /* two\nlines */ \"a\": 1, // b\n \"c\": \"http://d /* e */\" }\n// last";
        let expected = serde_json::json!({ "a": 1, "c": "http://d /* e */" });
        assert_eq!(parsed(text), Ok(expected), "law: as without its comments");
    }

    /// Law: a number without decimals is whole however it is written, up to the largest seed.
    #[test]
    fn whole_numbers_are_whole_however_they_are_written() {
        for (text, expected) in [
            ("20.0", serde_json::json!(20)),
            ("-2e1", serde_json::json!(-20)),
            ("1e19", serde_json::json!(10_000_000_000_000_000_000_u64)),
            ("9007199254740994.0", serde_json::json!(9_007_199_254_740_994_u64)),
            ("2e19", serde_json::json!(2e19)),
            ("0.5", serde_json::json!(0.5)),
        ] {
            assert_eq!(parsed(text), Ok(expected), "law: {text}");
        }
    }

    /// Law: what people often type in place of JSON is answered with what they meant.
    #[test]
    fn habits_are_answered() {
        for (text, words) in [
            (
                "{ \"a\": {\n\"b\": 5,6 } }",
                "line 2, column 8: this is not JSON: key must be a string; \
              decimals follow a point",
            ),
            ("{ 'a': 1 }", "double quotes"),
            ("{ \"a\": 'b' }", "double quotes"),
            ("# mine\n{ \"a\": 1 }", "comments begin with //"),
        ] {
            let said = parsed(text).expect_err("it is not JSON");
            assert!(said.contains(words), "law: {text:?} is answered by `{words}`, got `{said}`");
        }
        let said = parsed("{ \"a\": [1,2,], }").expect_err("it is not JSON");
        assert!(!said.contains(';'), "law: nothing is guessed, got `{said}`");
    }

    /// Law: a fault stands where an editor shows it.
    #[test]
    fn faults_after_comments_keep_their_places() {
        for (text, place) in [
            ("{ /* a\nb\n*/ \"c\": x }", "line 3, column 9"),
            ("// a\n{ \"c\": // b\n }", "line 3, column 2"),
            ("{ \"a\": 1 / 2 }", "line 1, column 10"),
            ("{ \"a\": 1 } /* without an end", "line 1, column 12"),
            ("{ \"µ\": \"Größe\", x }", "line 1, column 17"),
            ("{ \"a\": µ }", "line 1, column 8"),
        ] {
            let said = parsed(text).expect_err("it is not JSON");
            assert!(said.contains(place), "law: {text:?} has a fault at {place}, got `{said}`");
        }
    }

    /// Law: what a list holds was given with the list, but for what is changed in it, of which a
    /// list given anew knows nothing; what is replaced by another kind of value leaves no trace.
    #[test]
    fn elements_of_lists_are_of_who_gave_them_last() {
        let folder = tempfile::tempdir().expect("a folder");
        let base = serde_json::json!({
            "stages": [{ "file": "a", "rows": [[1, 2], [3]] }, { "loads": [{ "of": 1 }] }],
            "notes": [1, { "of": 2 }], "contact": { "of": { "of": 3 } }, "settle": [{ "of": 4 }]
        });
        let top = serde_json::json!({
            "extends": "base/s.json",
            "notes": { "of": 5 }, "contact": [{ "of": [6] }], "settle": [7, { "of": 8 }]
        });
        std::fs::create_dir(folder.path().join("base")).expect("a folder");
        for (name, value) in [("base/s.json", base), ("s.json", top)] {
            std::fs::write(folder.path().join(name), value.to_string()).expect("written");
        }
        let own = || Origin::File(folder.path().join("s.json"));
        let extended = || Origin::File(folder.path().join("base/s.json"));
        let set = |change: &str| Origin::Set(format!("--set {change}"), PathBuf::new());
        let (element, field) = ("stages.1={\"of\":[9]}", "stages[0].rows[1][0]=9");
        let (list, name) = ("stages=[{},{\"of\":9}]", "stages[1].loads[0].of=9");
        for (changes, path, expected) in [
            (vec![], "stages[0].file", extended()),
            (vec![], "stages[0].rows[0][1]", extended()),
            (vec![], "stages[1].loads[0].of", extended()),
            (vec![], "notes.of", own()),
            (vec![], "notes[1].of", own()),
            (vec![], "contact.of.of", own()),
            (vec![], "settle[1].of", own()),
            (vec![field], "stages[0].rows[1][0]", set(field)),
            (vec![field], "stages[0].rows[1]", extended()),
            (vec![element], "stages[1].of[0]", set(element)),
            (vec![element], "stages[1].lacks", set(element)),
            (vec![element], "stages[0].file", extended()),
            (vec![name, element], "stages[1].loads[0].of", set(element)),
            (vec![name, element, list], "stages[1].of[0]", set(list)),
            (vec![name, list], "stages[1].loads[0].of", set(list)),
            (vec![list, "stages.1.of=10"], "stages[1].of", set("stages.1.of=10")),
            (vec![list, "stages.1.of=10"], "stages[0].of", set(list)),
        ] {
            let mut document = read(&folder.path().join("s.json")).expect("a scenario");
            for change in &changes {
                let change: Override = change.parse().expect("a change");
                change.apply(&mut document).expect("it is made");
            }
            let got = document.origin(path);
            assert_eq!(got, expected, "law: who gave `{path}` after {changes:?}");
        }
    }
}
