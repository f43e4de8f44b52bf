//! What is checked of options before hours are spent on what they ask for.

use std::path::Path;

use pluvia::record::create_folder;

/// A number above zero.
///
/// # Errors
/// Another number, or none.
pub fn positive(text: &str) -> Result<f64, String> {
    let number: f64 = text.parse().map_err(|_| "it is no number".to_owned())?;
    match number > 0.0 && number.is_finite() {
        true => Ok(number),
        false => Err("allowed are numbers above 0".to_owned()),
    }
}

/// Makes the folder of a file of results.
///
/// # Errors
/// Where it cannot be made, or a folder stands in the place of the file.
pub fn prepare(out: &Path) -> Result<(), String> {
    if out.is_dir() {
        return Err(format!("--out {}: it is a folder, a file is needed", out.display()));
    }
    match out.parent().filter(|folder| !folder.as_os_str().is_empty()) {
        Some(folder) => create_folder(folder).map_err(|e| e.to_string()),
        None => Ok(()),
    }
}
