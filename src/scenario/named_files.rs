//! Files that a scenario names: by a text, from the folder of the file that gives it.

use super::*;

/// Faults of names that lead from a folder whose path is no text, and so to another place.
pub(super) fn faults(document: &Document) -> Vec<Fault> {
    let fault = |place: String| {
        let name = field(&document.value, &pointer(&place)).as_str()?;
        if Path::new(name).is_absolute() || document.folder(&place).to_str().is_some() {
            return None;
        }
        let why = "the file that names it lies in a folder whose path is not UTF-8, from which \
                   nothing is found";
        let allowed = "an absolute path, or the scenario given by its name alone, after `cd` into \
                       its folder";
        Some(document.with_origin(Fault::new(why, Value::from(name), allowed).at(place)))
    };
    places(&document.value).into_iter().filter_map(fault).collect()
}

/// Makes the names of files in a scenario's JSON ones that mean the same from elsewhere; `folder`
/// tells in which folder the value at a place names files.
pub(super) fn place(value: &mut Value, folder: impl Fn(&str) -> PathBuf) {
    for place in places(value) {
        let Some(Value::String(name)) = value.pointer_mut(&pointer(&place)) else { continue };
        let folder = folder(&place);
        *name = match place.starts_with("grains.meshes") {
            true => placed_pattern(&folder, name),
            false => folder.join(&*name).to_string_lossy().into_owned(),
        };
    }
}

/// Where a scenario's JSON may name files.
fn places(value: &Value) -> Vec<String> {
    let count = |pointer: &str| field(value, pointer).as_array().map_or(0, Vec::len);
    let alone = ["begin.specimen", "grains.file"].map(str::to_owned);
    let meshes = (0..count("/grains/meshes")).map(|i| format!("grains.meshes[{i}]"));
    let motions = (0..count("/stages")).map(|i| format!("stages[{i}].motion_file"));
    let pieces = (0..count("/pieces")).map(|i| format!("pieces[{i}].shape.mesh.file"));
    alone.into_iter().chain(meshes).chain(motions).chain(pieces).collect()
}

/// A file name or pattern in a folder. Letters of the folder's name that mean
/// something in a pattern stand for themselves.
fn placed_pattern(folder: &Path, name: &str) -> String {
    let plain = folder.join(name).to_string_lossy().into_owned();
    let is_pattern = name.contains(['*', '?', '[']);
    if !is_pattern || Path::new(&plain).exists() || Path::new(name).is_absolute() {
        return plain;
    }
    let folder = glob::Pattern::escape(&folder.to_string_lossy());
    Path::new(&folder).join(name).to_string_lossy().into_owned()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_scenario_without_pieces_stays_as_it_is_and_files_become_absolute() {
        let mut without = json!({ "name": "a" });
        place(&mut without, |_| "/there".into());
        assert_eq!(without, json!({ "name": "a" }), "law: nothing is added");
        let of = |file: &str| json!({ "pieces": [{ "shape": { "mesh": { "file": file } } }] });
        let mut value = of("a.stl");
        place(&mut value, |_| "/there".into());
        assert_eq!(value, of("/there/a.stl"), "law: beside the file that names it");
    }
}
