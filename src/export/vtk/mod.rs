//! A run for ParaView and other programs on VTK: a `.vtp` file for every
//! moment, and `.pvd` files that list them by time.

mod scene;
#[cfg(test)]
mod tests;
mod xml;

use std::path::{Path, PathBuf};

use super::moments::Moments;
use crate::record::{FileError, create_folder, write_file};
use xml::{PolyData, collection};

pub(super) use scene::sieve_sizes;

/// What was written.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct VtkFiles {
    /// The `.pvd` files, to open in ParaView.
    pub lists: Vec<PathBuf>,
    /// The `.vtp` files they list.
    pub data: Vec<PathBuf>,
    /// Their size together, in bytes.
    pub bytes: u64,
}

/// The lists that [`write_vtk`] writes last, each of the files of one kind.
pub const VTK_LISTS: [&str; 4] =
    ["grains.pvd", "apparatus.pvd", "contacts.pvd", "force_chains.pvd"];

/// The series of loaded contacts, and that of the lines of force.
const CONTACTS: &str = "contacts";
const CHAINS: &str = "force_chains";

/// A series of files of one kind: `grains/grains_0000.vtp` and so on.
struct Series<'a> {
    folder: &'a Path,
    name: &'static str,
    entries: Vec<(f64, String)>,
}

impl<'a> Series<'a> {
    fn new(folder: &'a Path, name: &'static str) -> Result<Self, FileError> {
        create_folder(&folder.join(name))?;
        clear(folder, name)?;
        Ok(Self { folder, name, entries: Vec::new() })
    }

    fn add(&mut self, time: f64, data: &PolyData, files: &mut VtkFiles) -> Result<(), FileError> {
        let name = self.name;
        let file = format!("{name}/{name}_{:04}.vtp", self.entries.len());
        let path = self.folder.join(&file);
        let bytes = data.to_bytes(time).map_err(|e| FileError::new("write", &path, e))?;
        write_file(&path, &bytes)?;
        files.bytes += bytes.len() as u64;
        files.data.push(path);
        self.entries.push((time, file));
        Ok(())
    }

    fn list(&self, files: &mut VtkFiles) -> Result<(), FileError> {
        let path = self.folder.join(self.name).with_extension("pvd");
        let text = collection(&self.entries);
        write_file(&path, text.as_bytes())?;
        files.bytes += text.len() as u64;
        files.lists.push(path);
        Ok(())
    }
}

/// Removes what an earlier export left of a series: more files than there will be, or files of
/// another run.
fn clear(folder: &Path, name: &str) -> Result<(), FileError> {
    let is_of_moment = |path: &PathBuf| {
        let stem = path.file_stem().and_then(|s| s.to_str()).unwrap_or_default();
        let number = stem.strip_prefix(name).and_then(|s| s.strip_prefix('_'));
        number.is_some_and(|n| n.bytes().all(|b| b.is_ascii_digit()))
            && path.extension().is_some_and(|e| e == "vtp")
    };
    let earlier = std::fs::read_dir(folder.join(name)).into_iter().flatten().flatten();
    let data = earlier.map(|entry| entry.path()).filter(is_of_moment);
    let list = folder.join(name).with_extension("pvd");
    for path in data.chain(list.is_file().then_some(list)) {
        std::fs::remove_file(&path).map_err(|e| FileError::new("remove", &path, e))?;
    }
    Ok(())
}

/// Removes a series with its folder.
fn remove(folder: &Path, name: &str) -> Result<(), FileError> {
    clear(folder, name)?;
    // Files of others in it keep the folder.
    let _ = std::fs::remove_dir(folder.join(name));
    Ok(())
}

/// Writes the moments of a run, about `every` s apart, into a folder: grains and apparatus at each,
/// contacts and force chains at the ends of stages where the engine gave contacts. `go_on` hears how
/// many of how many moments are done; where it says no, nothing is given back. What was written is
/// removed then, and where a file cannot be written.
///
/// # Errors
/// When a file cannot be written.
pub fn write_vtk(
    moments: &Moments,
    every: f64,
    out: &Path,
    go_on: impl FnMut(usize, usize) -> bool,
) -> Result<Option<VtkFiles>, FileError> {
    let written = write_series(moments, every, out, go_on);
    if matches!(written, Ok(Some(_))) {
        return written;
    }
    let names = ["grains", "apparatus", CONTACTS, CHAINS];
    let removed = names.into_iter().try_for_each(|name| remove(out, name));
    written.and_then(|none| removed.map(|()| none))
}

fn write_series(
    moments: &Moments,
    every: f64,
    out: &Path,
    mut go_on: impl FnMut(usize, usize) -> bool,
) -> Result<Option<VtkFiles>, FileError> {
    let sizes = sieve_sizes(&moments.grains);
    let taken = moments.thinned(every);
    let mut files = VtkFiles::default();
    let mut grains = Series::new(out, "grains")?;
    let mut apparatus = Series::new(out, "apparatus")?;
    let bearing = moments.stages.iter().any(|s| !s.end.contacts.is_empty());
    let mut of_contacts = if bearing {
        Some([Series::new(out, CONTACTS)?, Series::new(out, CHAINS)?])
    } else {
        for name in [CONTACTS, CHAINS] {
            remove(out, name)?;
        }
        None
    };
    for (n, moment) in taken.iter().enumerate() {
        if !go_on(n, taken.len()) {
            return Ok(None);
        }
        let time = moment.frame.time;
        grains.add(time, &scene::grains(moment, &moments.grains, &sizes), &mut files)?;
        apparatus.add(time, &scene::apparatus(moment, &moments.parts), &mut files)?;
        if let (Some(end), Some([contacts, chains])) = (moment.end, &mut of_contacts) {
            contacts.add(time, &scene::contacts(&moments.setup, end), &mut files)?;
            chains.add(time, &scene::chains(&moments.setup, end), &mut files)?;
        }
    }
    for series in [&grains, &apparatus].into_iter().chain(of_contacts.iter().flatten()) {
        series.list(&mut files)?;
    }
    Ok(Some(files))
}
