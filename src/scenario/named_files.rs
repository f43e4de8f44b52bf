//! Files that a scenario names: by a text, from the folder of the file that gives it.

use super::*;

/// Faults of names that lead from a folder whose path is no text, and so to another place.
pub(super) fn faults(document: &Document) -> Vec<Fault> {
    let leads_astray = |(place, name): &(String, &str)| {
        !Path::new(name).is_absolute() && document.folder(place).to_str().is_none()
    };
    let fault = |(place, name): (String, &str)| {
        let why = "the file that names it lies in a folder whose path is not UTF-8, from which \
                   nothing is found";
        let allowed = "an absolute path, or the scenario given by its name alone, after `cd` into \
                       its folder";
        document.with_origin(Fault::new(why, Value::from(name), allowed).at(place))
    };
    names(&document.value).into_iter().filter(leads_astray).map(fault).collect()
}

/// The names of files in a scenario's JSON, with their places.
fn names(value: &Value) -> Vec<(String, &str)> {
    let list = |pointer: &str| value.pointer(pointer).and_then(Value::as_array);
    let elements = |pointer: &str| list(pointer).into_iter().flatten().enumerate();
    let alone = ["begin.specimen", "grains.file"].into_iter().map(|place| {
        let pointer = format!("/{}", place.replace('.', "/"));
        (place.to_owned(), value.pointer(&pointer))
    });
    let meshes = elements("/grains/meshes").map(|(i, m)| (format!("grains.meshes[{i}]"), Some(m)));
    let motions = elements("/stages")
        .map(|(i, stage)| (format!("stages[{i}].motion_file"), stage.get("motion_file")));
    let pieces = elements("/pieces").map(|(i, piece)| {
        (format!("pieces[{i}].shape.mesh.file"), piece.pointer("/shape/mesh/file"))
    });
    let all = alone.chain(meshes).chain(motions).chain(pieces);
    all.filter_map(|(place, name)| Some((place, name?.as_str()?))).collect()
}
