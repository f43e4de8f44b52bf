//! From file names and patterns to the objects that the files hold.

use super::*;
use crate::input;

/// The files that names and patterns stand for, in the order given, those of a
/// pattern in the order of their names; a file that is met again is left out. A pattern that no file
/// matches is a name that is not there.
pub(super) fn files(
    entries: &[String],
    faults: &mut Vec<Fault>,
    unreadable: &mut Vec<(PathBuf, String)>,
) -> Vec<PathBuf> {
    let mut files: Vec<PathBuf> = Vec::new();
    for (index, entry) in entries.iter().enumerate() {
        let fault = |message: String| {
            let allowed = "a file, or a pattern such as \"stones/*.stl\" that files match";
            let path = format!("grains.meshes[{index}]");
            Fault { path, ..Fault::new(message, format!("\"{entry}\""), allowed) }
        };
        // A file may be called what would be a pattern.
        if !entry.contains(['*', '?', '[']) || Path::new(entry).exists() {
            files.push(PathBuf::from(entry));
            continue;
        }
        match glob::glob(entry) {
            Err(error) => faults.push(fault(format!("this is no pattern of file names: {error}"))),
            Ok(paths) => {
                let found: Vec<PathBuf> = paths.flatten().filter(|path| path.is_file()).collect();
                if found.is_empty() {
                    unreadable.push((PathBuf::from(entry), "no file has such a name".to_owned()));
                }
                files.extend(found);
            }
        }
    }
    let mut seen = std::collections::HashSet::new();
    files.retain(|path| seen.insert(path.clone()));
    files
}

/// The objects of a file, by the ending of its name.
pub(super) fn objects(path: &Path) -> Result<Vec<Object>, ReadError> {
    let ending = path.extension().and_then(|e| e.to_str()).unwrap_or_default().to_lowercase();
    let parse = match ending.as_str() {
        "obj" => obj::parse,
        "stl" => stl::parse,
        "ply" => ply::parse,
        _ => {
            let message = "the ending of the file's name tells its format, and this one is unknown";
            return Err(ReadError::fault(message, format!(".{ending}"), ".obj, .stl or .ply"));
        }
    };
    let unreadable = |e: std::io::Error| match input::Refusal::within(&e) {
        Some(refusal) => ReadError::Fault(Fault::refused(path, refusal, "")),
        None => ReadError::Unreadable(e.to_string()),
    };
    let size = std::fs::metadata(path).map_err(unreadable)?.len();
    if size > input::LARGEST_MESH {
        let allowed = format!("at most {} MiB", input::LARGEST_MESH >> 20);
        return Err(ReadError::fault(
            "the file is too large: simplify the mesh first",
            format!("{} MiB", size >> 20),
            &allowed,
        ));
    }
    let bytes = input::read(path, input::LARGEST_MESH).map_err(unreadable)?;
    if bytes.is_empty() {
        return Err(ReadError::fault("the file is empty", "0 bytes", "a mesh"));
    }
    let objects = parse(&bytes)?;
    if objects.iter().all(|object| object.faces.is_empty()) {
        return Err(ReadError::fault("the file holds no faces", "0 faces", "at least 4 faces"));
    }
    Ok(objects.into_iter().filter(|object| !object.faces.is_empty()).collect())
}
