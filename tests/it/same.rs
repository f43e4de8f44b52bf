//! Whether two folders of results hold the same.

use std::{
    collections::BTreeSet,
    fs,
    path::{Path, PathBuf},
};

use serde_json::Value;

/// What depends on the machine's speed, and the sum of a record that holds it.
const TIMINGS: [&str; 4] = ["wall_s", "engine_s", "peak_memory_mib", "record_sha256"];

/// A JSON value without what depends on the machine's speed.
fn timeless(value: &mut Value) {
    match value {
        Value::Object(fields) => {
            fields.retain(|name, _| !TIMINGS.contains(&name.as_str()));
            fields.values_mut().for_each(timeless);
        }
        Value::Array(values) => values.iter_mut().for_each(timeless),
        _ => {}
    }
}

/// Whether a text is a wall time as reports have it: `0.4 s`, `12.0 min`, `1.5 h`.
fn is_time(text: &str) -> bool {
    let parts = text.split_once(' ');
    parts.is_some_and(|(number, unit)| {
        ["s", "min", "h"].contains(&unit) && number.parse::<f64>().is_ok()
    })
}

/// A page without the wall times that end rows of its tables.
fn timeless_page(text: &str) -> String {
    const END: &str = "</td></tr>";
    let mut rows = text.split(END).peekable();
    let mut page = String::with_capacity(text.len());
    while let Some(row) = rows.next() {
        let cell = row.rfind('>').map_or(0, |at| at + 1);
        let is_last = rows.peek().is_none();
        page += if !is_last && is_time(&row[cell..]) { &row[..cell] } else { row };
        if !is_last {
            page += END;
        }
    }
    page
}

/// A table without the columns that depend on the machine's speed.
fn timeless_table(bytes: &[u8]) -> Option<Vec<Vec<String>>> {
    let mut reader = csv::ReaderBuilder::new().has_headers(false).from_reader(bytes);
    let rows: Vec<csv::StringRecord> = reader.records().collect::<Result<_, _>>().ok()?;
    let kept: Vec<usize> = (0..rows.first()?.len())
        .filter(|&column| !TIMINGS.contains(&rows[0].get(column).unwrap_or_default()))
        .collect();
    let row = |row: &csv::StringRecord| {
        kept.iter().map(|&column| row.get(column).unwrap_or_default().to_owned()).collect()
    };
    Some(rows.iter().map(row).collect())
}

/// Whether two files hold the same but for timings.
fn same_content(a: &Path, b: &Path) -> bool {
    let (Ok(one), Ok(two)) = (fs::read(a), fs::read(b)) else { return false };
    if one == two {
        return true;
    }
    match a.extension().and_then(|e| e.to_str()) {
        Some("json") => {
            let parsed = |bytes: &[u8]| {
                let mut value: Value = serde_json::from_slice(bytes).ok()?;
                timeless(&mut value);
                Some(value)
            };
            parsed(&one).is_some_and(|one| Some(one) == parsed(&two))
        }
        Some("html") => {
            let page = |bytes| std::str::from_utf8(bytes).ok().map(timeless_page);
            page(&one).is_some_and(|one| Some(one) == page(&two))
        }
        Some("csv") => {
            // Bytes that are cut off may leave the same cells.
            let ended = one.ends_with(b"\n") && two.ends_with(b"\n");
            ended && timeless_table(&one).is_some_and(|one| Some(one) == timeless_table(&two))
        }
        _ => false,
    }
}

/// The files under a folder, relative to it, without those of a temporary name.
pub fn files(folder: &Path) -> BTreeSet<PathBuf> {
    let mut found = BTreeSet::new();
    let mut below = vec![PathBuf::new()];
    while let Some(at) = below.pop() {
        for entry in fs::read_dir(folder.join(&at)).into_iter().flatten().flatten() {
            let name = entry.file_name();
            if name.to_string_lossy().starts_with('.') {
                continue;
            }
            let path = at.join(name);
            if entry.path().is_dir() {
                below.push(path);
            } else {
                found.insert(path);
            }
        }
    }
    found
}

/// What is on its way under a folder, or was when its writer was killed: all
/// whose name begins with a dot, but locks.
pub fn half_written(folder: &Path) -> Vec<PathBuf> {
    let mut found = Vec::new();
    let mut below = vec![folder.to_owned()];
    while let Some(at) = below.pop() {
        for entry in fs::read_dir(at).into_iter().flatten().flatten() {
            let name = entry.file_name().to_string_lossy().into_owned();
            if name.starts_with('.') && !name.ends_with(".lock") {
                found.push(entry.path());
            } else if entry.path().is_dir() {
                below.push(entry.path());
            }
        }
    }
    found
}

/// What is in one folder and not, or not the same, in another.
fn differences(part: &Path, whole: &Path) -> Vec<PathBuf> {
    let differs = |f: &PathBuf| !same_content(&part.join(f), &whole.join(f));
    files(part).into_iter().filter(differs).collect()
}

/// Same files with the same bytes, but for timings.
pub fn assert_same_files(a: &Path, b: &Path, what: &str) {
    assert_eq!(files(a), files(b), "law: {what}: the same files");
    let differ = differences(a, b);
    assert!(differ.is_empty(), "law: {what}: the same bytes, got others in {differ:?}");
}

/// The same bytes in some files of two folders.
pub fn assert_same_bytes(a: &Path, b: &Path, files: &[&str], what: &str) {
    for file in files {
        let [one, two] = [a, b].map(|out| fs::read(out.join(file)).expect("written"));
        assert!(one == two, "law: {what}: the same bytes in {file}");
    }
}

/// What is there is whole: the same bytes as in the finished folder; of a stage that failed on the
/// way, which is not there, its last good state; and which scenario the unfinished run is of.
pub fn assert_whole_files(part: &Path, finished: &Path, what: &str) {
    let on_the_way = |f: &PathBuf| {
        let name = f.file_name().unwrap_or_default().to_string_lossy();
        let kept = fs::read(part.join(f)).unwrap_or_default();
        (name.starts_with("failed-") || name == "unfinished.json")
            && serde_json::from_slice::<serde_json::Value>(&kept).is_ok()
    };
    let mut differ = differences(part, finished);
    differ.retain(|f| !on_the_way(f));
    assert!(differ.is_empty(), "law: {what}: every file there is whole, not so {differ:?}");
}

#[test]
fn differences_are_found_and_timings_are_none() {
    let folder = tempfile::tempdir().expect("a folder");
    let [a, b] = ["a", "b"].map(|name| folder.path().join(name));
    for (out, wall, height) in [(&a, 1, 5), (&b, 2, 5)] {
        fs::create_dir_all(out.join("runs")).expect("a folder");
        let json = format!("{{\"x\": [{{\"wall_s\": {wall}, \"height\": {height}}}]}}");
        fs::write(out.join("runs/a.json"), json).expect("written");
        fs::write(out.join("b.csv"), "1,2").expect("written");
        fs::write(out.join(".part"), format!("{wall}")).expect("written");
    }
    assert_same_files(&a, &b, "but for timings");
    fs::write(b.join("b.csv"), "1,3").expect("written");
    assert_eq!(differences(&a, &b), [PathBuf::from("b.csv")], "law: a byte is seen");
    fs::write(b.join("runs/a.json"), "{\"x\": [{\"height\": 6}]}").expect("written");
    assert_eq!(differences(&a, &b).len(), 2, "law: a number is seen");
    fs::remove_file(a.join("b.csv")).expect("removed");
    assert_eq!(differences(&a, &b).len(), 1, "law: what is not there is not torn");
    assert_ne!(files(&a), files(&b), "law: a file that is missing is seen");
}

#[test]
fn a_torn_or_changed_report_is_found_and_its_times_are_none() {
    let folder = tempfile::tempdir().expect("a folder");
    let [a, b] = ["a", "b"].map(|name| folder.path().join(name));
    let page = |height: f64, wall: &str| {
        format!("<table><tr><td>{height} mm</td><td class=\"n\">{wall}</td></tr></table><p>End</p>")
    };
    let whole = page(1.0, "0.4 s");
    let cut = &whole[..whole.len() - 3];
    let [longer, higher, of_wall] = [page(1.0, "12.0 min"), page(1.1, "0.4 s"), page(1.0, "soon")];
    for (other, same) in [
        (whole.as_str(), true),
        (longer.as_str(), true),
        (higher.as_str(), false),
        (of_wall.as_str(), false),
        (cut, false),
        ("", false),
    ] {
        for (out, content) in [(&a, whole.as_str()), (&b, other)] {
            fs::create_dir_all(out).expect("a folder");
            fs::write(out.join("report.html"), content).expect("written");
        }
        assert_eq!(differences(&a, &b).is_empty(), same, "law: only times may differ: {other}");
    }
    for (other, same) in
        [("run,wall_s\na,2\n", true), ("run,wall_s\nb,1\n", false), ("run,wall_s\na,1", false)]
    {
        let [one, two] = [&a, &b].map(|out| out.join("times.csv"));
        fs::write(&one, "run,wall_s\na,1\n").expect("written");
        fs::write(&two, other).expect("written");
        assert_eq!(same_content(&one, &two), same, "law: of a table, too: {other:?}");
    }
}
