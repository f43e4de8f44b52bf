//! Values of result files: where a key leads, and how the value is written.
//!
//! A key is `SOURCE:PATH:FORMAT`. `SOURCE` is a name of `sources::SOURCES` or of `derived.rs`. `PATH`
//! has segments between slashes: a field; the element of an array with that `name`, `id` or
//! `run`, or that number from 0; `FIELD=VALUE`, the elements of an array that have it (`FIELD=`: an empty one); `*FIELD`,
//! that field of all elements. `FORMAT` is how it is written, see [`Format`].

use std::{
    cell::RefCell,
    collections::HashMap,
    fs,
    path::{Path, PathBuf},
    rc::Rc,
};

use pluvia::measure::inference::MeanTest;
use serde_json::{Map, Value};

use super::{derived, list, sources};

/// The result files under a root folder.
pub struct Results {
    root: PathBuf,
    read: RefCell<HashMap<String, Rc<Value>>>,
}

impl Results {
    /// Those of a tree.
    pub fn of(root: impl Into<PathBuf>) -> Self {
        Self { root: root.into(), read: RefCell::default() }
    }

    /// Root of the tree.
    pub fn root(&self) -> &Path {
        &self.root
    }

    /// A whole source.
    pub fn source(&self, name: &str) -> Result<Rc<Value>, String> {
        if let Some(value) = self.read.borrow().get(name) {
            return Ok(Rc::clone(value));
        }
        let file = sources::SOURCES.iter().find(|(source, _)| *source == name).map(|s| s.1);
        let value = match (file, derived::named(name)) {
            (Some(file), _) => self.file(file)?,
            (None, Some(work_out)) => work_out(self)?,
            (None, None) => return Err(format!("no source is named `{name}`")),
        };
        let value = Rc::new(value);
        self.read.borrow_mut().insert(name.to_owned(), Rc::clone(&value));
        Ok(value)
    }

    fn file(&self, file: &str) -> Result<Value, String> {
        let path = self.root.join(list::FOLDER).join(file);
        let text = fs::read_to_string(&path).map_err(|e| format!("{}: {e}", path.display()))?;
        let value = match file.rsplit('.').next() {
            Some("json") => serde_json::from_str(&text).map_err(|e| e.to_string()),
            Some("csv") => rows(&text),
            _ => Ok(table(&text)),
        };
        value.map_err(|e| format!("{}: {e}", path.display()))
    }

    /// What a key leads to, as a page shows it.
    pub fn quote(&self, key: &str) -> Result<String, String> {
        let (source, rest) = key.split_once(':').ok_or("a key is SOURCE:PATH:FORMAT")?;
        let (path, format) = rest.rsplit_once(':').ok_or("a key is SOURCE:PATH:FORMAT")?;
        let mut value = (*self.source(source)?).clone();
        for segment in path.split('/').filter(|s| !s.is_empty()) {
            value = step(&value, segment)
                .ok_or_else(|| format!("`{segment}` is not there in `{source}`"))?;
        }
        Format::read(format)?.write(&value).ok_or_else(|| format!("not to be written `{format}`"))
    }
}

/// Rows of a CSV as objects; what reads as a number is one, an empty cell is null.
fn rows(text: &str) -> Result<Value, String> {
    let mut reader = csv::Reader::from_reader(text.as_bytes());
    let names = reader.headers().map_err(|e| e.to_string())?.clone();
    let row = |record: csv::StringRecord| -> Value {
        let cell = |text: &str| match (text, text.parse::<f64>()) {
            ("", _) => Value::Null,
            (_, Ok(number)) => number.into(),
            _ => text.into(),
        };
        names
            .iter()
            .zip(&record)
            .map(|(n, c)| (n.to_owned(), cell(c)))
            .collect::<Map<_, _>>()
            .into()
    };
    reader.records().map(|r| r.map(row).map_err(|e| e.to_string())).collect()
}

/// The first table of a page whose columns have names, by its headings in bold, its rows and its
/// columns. Rows above the first heading stand under an empty one.
fn table(text: &str) -> Value {
    let cells = |line: &str| -> Vec<String> {
        line.trim().trim_matches('|').split('|').map(|c| c.trim().to_owned()).collect()
    };
    let mut lines = text.lines().skip_while(|l| !l.starts_with("| ") || cells(l).len() < 3);
    let names = lines.next().map(cells).unwrap_or_default();
    let (mut heading, mut found) = (String::new(), Map::new());
    for line in lines.skip(1).take_while(|l| l.starts_with('|')) {
        let row = cells(line);
        if let Some(bold) = row[0].strip_prefix("**") {
            heading = bold.trim_end_matches("**").to_owned();
            continue;
        }
        let columns: Map<_, _> =
            names.iter().zip(&row).skip(1).map(|(n, c)| (n.clone(), c.clone().into())).collect();
        let section = found.entry(heading.clone()).or_insert_with(|| Map::new().into());
        if let Some(section) = section.as_object_mut() {
            section.insert(row[0].clone(), columns.into());
        }
    }
    found.into()
}

fn same(value: Option<&Value>, wanted: &str) -> bool {
    match value {
        Some(Value::String(text)) => text == wanted,
        Some(Value::Number(n)) => wanted.parse::<f64>().is_ok_and(|w| n.as_f64() == Some(w)),
        Some(Value::Bool(b)) => b.to_string() == wanted,
        Some(Value::Null) => wanted.is_empty(),
        _ => false,
    }
}

fn step(value: &Value, segment: &str) -> Option<Value> {
    let Value::Array(items) = value else { return value.get(segment).cloned() };
    if let Some(field) = segment.strip_prefix('*') {
        return items
            .iter()
            .map(|i| i.get(field).cloned())
            .collect::<Option<Vec<_>>>()
            .map(Into::into);
    }
    if let Some((field, wanted)) = segment.split_once('=') {
        let kept: Vec<_> = items.iter().filter(|i| same(i.get(field), wanted)).cloned().collect();
        return Some(kept.into());
    }
    if let Ok(index) = segment.parse::<usize>() {
        return items.get(index).cloned();
    }
    items.iter().find(|i| ["name", "id", "run"].iter().any(|f| same(i.get(*f), segment))).cloned()
}

/// How a value is written: a word, decimals after a point, a factor after `*`, as in `±.1`,
/// `range.2*0.001`.
///
/// Of a number: nothing, `+` with its sign always, `abs` without. Of several numbers: `mean`,
/// `sd`, `max`, `range` ("9.8 to 12.9"), `list` ("1.0, 2.0"), `slashes` ("1.0 / 2.0"), `count`, `±` (mean
/// and half the 95 % confidence interval by Student's t). Of an object: `±` of its `mean` and
/// `interval` or `half`, `range` of its `low` and `high`. `text` is a text as it is.
pub struct Format {
    word: String,
    decimals: usize,
    factor: f64,
}

impl Format {
    /// Reads one.
    pub fn read(text: &str) -> Result<Self, String> {
        let fault = || format!("`{text}` is no format");
        let (form, factor) = match text.split_once('*') {
            Some((form, factor)) => (form, factor.parse().map_err(|_| fault())?),
            None => (text, 1.0),
        };
        let (word, decimals) = match form.split_once('.') {
            Some((word, decimals)) => (word, decimals.parse().map_err(|_| fault())?),
            None => (form, 0),
        };
        Ok(Self { word: word.to_owned(), decimals, factor })
    }

    fn number(&self, value: f64) -> String {
        let text = format!("{:.*}", self.decimals, value * self.factor);
        let bare = text.trim_start_matches('-');
        let zero = bare.chars().all(|c| c == '0' || c == '.');
        match (text.starts_with('-') && !zero, self.word.starts_with('+') && !zero) {
            (true, _) => format!("−{bare}"),
            (_, true) => format!("+{bare}"),
            _ => bare.to_owned(),
        }
    }

    fn write(&self, value: &Value) -> Option<String> {
        let several = || -> Option<Vec<f64>> {
            let all = value.as_array()?.iter().map(Value::as_f64).collect::<Option<Vec<_>>>()?;
            (!all.is_empty()).then_some(all)
        };
        let test = || MeanTest::of(&several()?, 0.95);
        let of = |field: &str| value.get(field).and_then(Value::as_f64);
        let join = |between: &str| -> Option<String> {
            Some(several()?.iter().map(|v| self.number(*v)).collect::<Vec<_>>().join(between))
        };
        Some(match self.word.as_str() {
            "text" => value.as_str()?.to_owned(),
            "" | "+" => self.number(value.as_f64()?),
            "abs" => self.number(value.as_f64()?.abs()),
            "count" => value.as_array()?.len().to_string(),
            "list" => join(", ")?,
            "slashes" => join(" / ")?,
            "mean" => self.number(match of("mean") {
                Some(mean) => mean,
                None => several()?.iter().sum::<f64>() / several()?.len() as f64,
            }),
            "max" => self.number(several()?.into_iter().reduce(f64::max)?),
            "sd" => self.number(test()?.standard_deviation),
            "range" | "absrange" => {
                let (low, high) = match (of("low"), of("high")) {
                    (Some(low), Some(high)) => (low, high),
                    _ => {
                        let values = several()?;
                        (
                            values.iter().copied().reduce(f64::min)?,
                            values.iter().copied().reduce(f64::max)?,
                        )
                    }
                };
                let (low, high) =
                    if self.word == "absrange" && high < 0.0 { (-high, -low) } else { (low, high) };
                let (low, high) = (self.number(low), self.number(high));
                // Ends that read alike are one number.
                if low == high { low } else { format!("{low} to {high}") }
            }
            "±" | "+±" | "abs±" => {
                let (mean, half) = match (of("mean"), of("half"), value.get("interval")) {
                    (Some(mean), Some(half), _) => (mean, half),
                    (Some(mean), _, Some(interval)) => {
                        let end = |e: &str| interval.get(e).and_then(Value::as_f64);
                        (mean, (end("high")? - end("low")?) / 2.0)
                    }
                    _ => test().map(|t| (t.estimate.mean, t.half_width))?,
                };
                let mean = if self.word == "abs±" { mean.abs() } else { mean };
                let half = Self { word: String::new(), ..*self }.number(half);
                format!("{} ± {half}", self.number(mean))
            }
            _ => return None,
        })
    }
}
