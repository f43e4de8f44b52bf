//! Values changed for one run: `--set engine.rate_hz=960`, or left out: `--set engine.rate_hz=null`.

use std::str::FromStr;

use super::*;

/// One value laid over the scenario's.
#[derive(Debug, Clone, PartialEq)]
pub struct Override {
    path: Vec<Step>,
    value: Value,
    text: String,
    /// The option that it was typed with.
    option: &'static str,
    /// Where relative names of files in it lead from; empty: the working directory.
    folder: PathBuf,
}

/// The option of a change by itself.
const SET: &str = "--set";

#[derive(Debug, Clone, PartialEq)]
enum Step {
    /// A field, or the number of an element: what stands there decides.
    Name(String),
    /// The number of an element.
    Index(usize),
}

impl Step {
    /// Whether both lead to the same value, whatever stands there.
    fn is(&self, other: &Self) -> bool {
        match (self.index(), other.index()) {
            (None, None) => self == other,
            (index, others) => index == others,
        }
    }

    /// The number of an element, also where it is written as a field.
    fn index(&self) -> Option<usize> {
        match self {
            Self::Name(name) => name.parse().ok(),
            Self::Index(index) => Some(*index),
        }
    }
}

/// An override that cannot be read.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum NotAnOverride {
    /// A text without path or value.
    #[error(
        "`{0}` is not of the form path=value, as engine.rate_hz=960 or stages.1.falling_height_mm=50"
    )]
    Form(String),
    /// A value with a field that is given twice, with both: only one would count.
    #[error("{0}")]
    Twice(String),
    /// A path of more steps than are read.
    #[error("the path has {0} steps; at most 128 are read")]
    Deep(usize),
}

/// Most steps of a path: JSON in JSON is read as deep.
const MOST_STEPS: usize = 128;

impl FromStr for Override {
    type Err = NotAnOverride;

    /// Reads `path=value`. Steps of the path are divided by dots, elements of
    /// lists are numbered from 0 (`stages.1` or `stages[1]`). The value is
    /// JSON, or else taken as text.
    fn from_str(text: &str) -> Result<Self, NotAnOverride> {
        let bad = || NotAnOverride::Form(text.to_owned());
        let (path, value) = text.split_once('=').ok_or_else(bad)?;
        let mut steps = Vec::new();
        for part in path.split('.') {
            let mut pieces = part.split('[');
            let name = pieces.next().filter(|name| !name.is_empty()).ok_or_else(bad)?;
            steps.push(Step::Name(name.trim().to_owned()));
            for piece in pieces {
                let index = piece.strip_suffix(']').and_then(|i| i.parse().ok()).ok_or_else(bad)?;
                steps.push(Step::Index(index));
            }
        }
        if steps.len() > MOST_STEPS {
            return Err(NotAnOverride::Deep(steps.len()));
        }
        let value = value.trim();
        let json = parse_value(path.trim(), value);
        let json = json.map_err(|twice| NotAnOverride::Twice(twice.to_string()))?;
        let value = json.unwrap_or_else(|| Value::String(value.to_owned()));
        Ok(Self { path: steps, value, text: text.to_owned(), option: SET, folder: PathBuf::new() })
    }
}

impl Override {
    /// Sets the field at the end of a chain of fields, `["engine", "backend"]`.
    pub fn new(fields: &[&str], value: Value) -> Self {
        let text = format!("{}={value}", fields.join("."));
        let path = fields.iter().map(|name| Step::Name((*name).to_owned())).collect();
        Self { path, value, text, option: SET, folder: PathBuf::new() }
    }

    /// The same typed with another option than `--set`, which faults name.
    #[must_use]
    pub fn typed_with(self, option: &'static str) -> Self {
        Self { option, ..self }
    }

    /// The same with names of files that lead from a folder; of an empty path, from the working
    /// directory.
    #[must_use]
    pub fn naming_files_in(self, folder: &Path) -> Self {
        Self { folder: folder.to_owned(), ..self }
    }

    /// The change as a person types it, `engine.rate_hz=960`.
    pub fn text(&self) -> &str {
        &self.text
    }

    /// The path of what it changes, as a person types it.
    pub fn path(&self) -> &str {
        self.text.split_once('=').map_or(&*self.text, |(path, _)| path.trim())
    }

    /// What stands in a scenario's JSON where the change would go; `None` where
    /// nothing does.
    pub fn value_before<'a>(&self, scenario: &'a Value) -> Option<&'a Value> {
        self.path.iter().try_fold(scenario, |at, step| match (at, step) {
            (Value::Array(items), step) => items.get(step.index()?),
            (other, Step::Name(name)) => other.get(name),
            (_, Step::Index(_)) => None,
        })
    }

    /// Whether one of two changes reaches the other's value: their paths are the same, or one begins
    /// with the other. `stages.1` and `stages[1]` are the same step.
    pub fn overlaps(&self, other: &Self) -> bool {
        self.path.iter().zip(&other.path).all(|(a, b)| a.is(b))
    }

    /// Whether it changes only a part of what another changes.
    pub fn is_part_of(&self, other: &Self) -> bool {
        self.path.len() > other.path.len() && self.overlaps(other)
    }

    /// Whether both change the same value.
    pub fn is_where(&self, other: &Self) -> bool {
        self.path.len() == other.path.len() && self.overlaps(other)
    }

    /// Whether it gives the value at a path of a fault, or one around it.
    pub fn gives(&self, path: &str) -> bool {
        let place = format!("{path}=").parse::<Self>();
        place.is_ok_and(|place| place.is_where(self) || place.is_part_of(self))
    }

    /// A fault of the change as a whole.
    pub(super) fn fault(&self, message: &str, allowed: &str) -> Fault {
        Fault::new(message, shown(&self.value), allowed).at(self.path()).of(self.origin())
    }

    fn origin(&self) -> Origin {
        Origin::Set(format!("{} {}", self.option, self.text), self.folder.clone())
    }

    /// Lays the value over the document; `null` leaves the field out. A field that is not there is
    /// made; whether the scenario knows it is found when everything is checked.
    pub(super) fn apply(&self, document: &mut Document) -> Result<(), Fault> {
        if let Some(Step::Name(name)) = self.path.first()
            && name == "extends"
        {
            let allowed = "a field of the scenario, or another scenario file";
            return Err(self.fault("what a scenario extends cannot be changed", allowed));
        }
        let origin = self.origin();
        let (mut path, mut made) = (String::new(), Vec::new());
        let mut at = &mut document.value;
        for step in &self.path {
            if at.is_null() {
                *at = Value::Object(Map::new());
            }
            let nowhere = |path: &str, found: &Value, allowed: &str| {
                Fault::new("the path leads nowhere", shown(found), allowed).at(path).of(&origin)
            };
            at = match (at, step) {
                (Value::Object(map), Step::Name(name)) => {
                    path = field_path(&path, name);
                    if !map.contains_key(name) {
                        made.push(path.clone());
                    }
                    map.entry(name.clone()).or_insert(Value::Null)
                }
                (Value::Object(_), Step::Index(index)) => {
                    return Err(nowhere(&path, &Value::from(*index), "the name of a field"));
                }
                (Value::Array(items), step) => {
                    let index = step.index();
                    let Some(index) = index.filter(|index| *index < items.len()) else {
                        let found = match (index, step) {
                            (None, Step::Name(name)) => Value::from(name.as_str()),
                            _ => Value::from(index),
                        };
                        let allowed = match items.len() {
                            0 => "no element: the list is empty".to_owned(),
                            1 => "0, the only element of the list".to_owned(),
                            many => format!("0 to {}, the elements of the list", many - 1),
                        };
                        return Err(nowhere(&path, &found, &allowed));
                    };
                    path = format!("{path}[{index}]");
                    &mut items[index]
                }
                (other, _) => {
                    return Err(nowhere(&path, other, "nothing below this value"));
                }
            };
        }
        let leaves_out = self.value.is_null();
        if leaves_out && path.ends_with(']') {
            let allowed = "a value, or the whole list without this element";
            let fault = Fault::new("an element of a list cannot be left out", &self.value, allowed);
            return Err(fault.at(path).of(&origin));
        }
        *at = self.value.clone();
        // A field that no scenario has stays: the check refuses it.
        let is_known = || !structure::allowed_at(&document.value, &path).is_empty();
        if leaves_out && (made.is_empty() || is_known()) {
            take_out(&mut document.value, made.first().unwrap_or(&path));
            if !made.is_empty() {
                // Nobody gave it.
                return Ok(());
            }
        }
        for path in made {
            document.set_origin(&path, &Value::Null, origin.clone());
        }
        document.set_origin(&path, &self.value, origin);
        Ok(())
    }
}

/// Takes out the field at the end of a dotted path.
fn take_out(value: &mut Value, path: &str) {
    let (group, name) = path.rsplit_once('.').unwrap_or(("", path));
    let group = if group.is_empty() { Some(value) } else { value.pointer_mut(&pointer(group)) };
    if let Some(Value::Object(fields)) = group {
        fields.shift_remove(name);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_are_json_or_text() {
        for (text, expected) in [
            ("a=1", Value::from(1)),
            ("a=1.5e2", Value::from(150)),
            ("a=0.5", Value::from(0.5)),
            ("a=true", Value::from(true)),
            ("a=full_stroke", Value::from("full_stroke")),
            ("a=\"1\"", Value::from("1")),
            ("a=x=y", Value::from("x=y")),
            ("a=", Value::from("")),
        ] {
            let got = text.parse::<Override>().expect("an override").value;
            assert_eq!(got, expected, "law: the value of `{text}`");
        }
    }

    /// Law: a value is read as a file is: of a field given twice none is chosen.
    #[test]
    fn fields_given_twice_are_refused() {
        for (text, said) in [
            (
                r#"contact={"restitution":0.3,"restitution":0.4}"#,
                "contact.restitution: the field is given twice (found 0.3, then 0.4; allowed: each \
                 field once)",
            ),
            (
                r#"stages[1]={"a":[{"b":1,"c":2,"b":3}]}"#,
                "stages[1].a[0].b: the field is given twice (found 1, then 3; allowed: each field \
                 once)",
            ),
        ] {
            let got = text.parse::<Override>().expect_err("law: refused").to_string();
            assert_eq!(got, said, "law: what is said of `{text}`");
        }
        let text = r#"name={"a":1,"a":2"#;
        let got = text.parse::<Override>().expect("law: what is no JSON is text").value;
        assert_eq!(got, Value::from(r#"{"a":1,"a":2"#));
    }

    #[test]
    fn what_is_no_override_is_refused() {
        for text in ["", "a", "=1", "a..b=1", "a[x]=1", "a[1=1", "[1]=2"] {
            assert!(text.parse::<Override>().is_err(), "`{text}` must be refused");
        }
    }

    /// Law: a path may be as deep as JSON, and no deeper: everything that follows it is recursive.
    #[test]
    fn paths_without_end_are_refused() {
        let deep = |steps: usize| format!("{}=1", vec!["a"; steps].join(".")).parse::<Override>();
        assert!(deep(MOST_STEPS).is_ok(), "law: {MOST_STEPS} steps are read");
        let got = deep(20_000).expect_err("law: refused");
        assert_eq!(got, NotAnOverride::Deep(20_000), "law: how many there are is said");
    }

    #[test]
    fn what_stood_there_before_is_found() {
        let scenario = serde_json::json!({ "a": [{ "b": 7 }], "c": 1 });
        for (text, expected) in [
            ("a[0].b=1", Some(Value::from(7))),
            ("a.0.b=1", Some(Value::from(7))),
            ("c=2", Some(Value::from(1))),
            ("a[1].b=1", None),
            ("d=1", None),
            ("c.d=1", None),
        ] {
            let change: Override = text.parse().expect("an override");
            assert_eq!(change.value_before(&scenario).cloned(), expected, "before `{text}`");
        }
    }

    /// Law: paths are compared step by step, whatever they look like as texts.
    #[test]
    fn changes_of_the_same_value_are_known() {
        for (a, b, same, part) in [
            ("stages[1].x", "stages.1.x", true, false),
            ("stages.01.x", "stages[1].x", true, false),
            ("stages. 1 .x", "stages[1].x", true, false),
            ("contact.restitution", "contact", false, true),
            ("stages[1].x", "stages.1", false, true),
            ("stages[1].x", "stages[2].x", false, false),
            ("contact.restitution", "contact.rest", false, false),
            ("contacts", "contact", false, false),
            ("a.0", "a.b", false, false),
        ] {
            let change = |path: &str| format!("{path}=1").parse::<Override>().expect("a change");
            let (one, other) = (change(a), change(b));
            assert_eq!(one.is_where(&other), same, "law: whether `{a}` is where `{b}` is");
            assert_eq!(one.is_part_of(&other), part, "law: whether `{a}` is part of `{b}`");
            assert!(!other.is_part_of(&one), "law: `{b}` is no part of `{a}`");
            let overlap = same || part;
            assert_eq!(one.overlaps(&other), overlap, "law: whether `{a}` reaches `{b}`");
            assert_eq!(other.overlaps(&one), overlap, "law: and the other way round");
        }
    }

    /// Law: a change gives what stands at its path and below it.
    #[test]
    fn changes_give_what_lies_at_and_below_their_paths() {
        for (change, path, expected) in [
            ("engine.rate_hz=1", "engine.rate_hz", true),
            ("pieces.0.shape={}", "pieces[0].shape.hopper.wall_mm", true),
            ("pieces.1.shape={}", "pieces[0].shape.hopper.wall_mm", false),
            ("stages.0.stage=rest", "stages[0]", false),
            ("name=a", "", false),
        ] {
            let got = change.parse::<Override>().expect("a change").gives(path);
            assert_eq!(got, expected, "law: whether `{change}` gives `{path}`");
        }
    }

    #[test]
    fn both_ways_to_number_elements_are_read() {
        let index: Override = "stages[1].x=2".parse().expect("an override");
        assert_eq!(index.path[1], Step::Index(1));
        let name: Override = "stages.1.x=2".parse().expect("an override");
        assert_eq!(name.path[1], Step::Name("1".into()));
    }
}
