//! The pages of the tree and the list of what they may quote without a mark.

use std::{
    fs,
    path::{Path, PathBuf},
};

use super::{
    builds, list, marks,
    scan::{self, Allowed},
    value::Results,
};

/// Pages with their text, by their paths from the root.
pub fn read(root: &Path) -> Result<Vec<(String, String)>, String> {
    let mut open: Vec<PathBuf> = list::PAGES.iter().map(|p| root.join(p)).collect();
    let mut pages = Vec::new();
    while let Some(path) = open.pop() {
        let fault = |e| format!("{}: {e}", path.display());
        if path.is_dir() {
            for entry in fs::read_dir(&path).map_err(fault)? {
                open.push(entry.map_err(fault)?.path());
            }
            continue;
        }
        let name = path.strip_prefix(root).unwrap_or(&path).to_string_lossy().into_owned();
        if name.ends_with(".md") && !list::PRINTED.contains(&name.as_str()) {
            pages.push((name, fs::read_to_string(&path).map_err(fault)?));
        }
    }
    pages.sort();
    Ok(pages)
}

/// The list of what may be quoted without a mark.
pub fn allowed(root: &Path) -> Result<Vec<Allowed>, String> {
    let path = root.join(list::FOLDER).join("unmarked.csv");
    let mut reader = csv::Reader::from_path(&path).map_err(|e| e.to_string())?;
    reader.deserialize().map(|row| row.map_err(|e| format!("{}: {e}", path.display()))).collect()
}

/// Files of `docs/results/`, from there.
pub fn files(root: &Path) -> Result<Vec<String>, String> {
    let folder = root.join(list::FOLDER);
    let (mut open, mut found) = (vec![folder.clone()], Vec::new());
    while let Some(path) = open.pop() {
        if path.is_dir() {
            for entry in fs::read_dir(&path).map_err(|e| format!("{}: {e}", path.display()))? {
                open.push(entry.map_err(|e| e.to_string())?.path());
            }
        } else {
            let name = path.strip_prefix(&folder).unwrap_or(&path);
            found.push(name.to_string_lossy().replace('\\', "/"));
        }
    }
    found.sort();
    Ok(found)
}

/// Files of the list.
pub fn listed() -> Vec<&'static str> {
    let kept = list::KEPT.iter().flat_map(|k| k.files.iter().map(|f| f.0));
    kept.chain(list::OTHERS.iter().map(|o| o.0)).collect()
}

/// Everything that is wrong with pages, marks and files, a line each.
pub fn faults(root: &Path) -> Result<Vec<String>, String> {
    let (pages, results) = (read(root)?, Results::of(root));
    let mut faults = Vec::new();
    for (page, text) in &pages {
        faults.extend(marks::filled(text, &results).1.iter().map(|f| format!("{page}:{f}")));
    }
    faults.extend(scan::faults(&pages, &allowed(root)?));
    faults.extend(builds::faults(root)?);
    let (there, listed) = (files(root)?, listed());
    for file in there.iter().filter(|f| !listed.contains(&f.as_str())) {
        faults.push(format!("{}/{file}: benches/results/list.rs does not list it", list::FOLDER));
    }
    for file in listed.iter().filter(|f| !there.iter().any(|t| t == *f)) {
        faults.push(format!("{}/{file}: it is not there; `make results` makes it", list::FOLDER));
    }
    Ok(faults)
}

/// Fills every mark and lowers what may be quoted without one. Says which files changed.
pub fn fill(root: &Path) -> Result<Vec<String>, String> {
    let results = Results::of(root);
    let mut changed = Vec::new();
    let mut write = |name: &str, text: &str| {
        let path = root.join(name);
        if fs::read_to_string(&path).is_ok_and(|old| old == text) {
            return Ok(());
        }
        changed.push(name.to_owned());
        fs::write(&path, text).map_err(|e| format!("{name}: {e}"))
    };
    let mut pages = read(root)?;
    for (page, text) in &mut pages {
        *text = marks::filled(text, &results).0;
        write(page, text)?;
    }
    let mut table = csv::Writer::from_writer(Vec::new());
    for row in scan::lowered(&pages, &allowed(root)?) {
        table.serialize(row).map_err(|e| e.to_string())?;
    }
    let bytes = table.into_inner().map_err(|e| e.to_string())?;
    let text = String::from_utf8(bytes).map_err(|e| e.to_string())?;
    write(&format!("{}/unmarked.csv", list::FOLDER), &text)?;
    Ok(changed)
}
