//! Files on their way, and what is left of them when their writer was killed.
//!
//! A writer holds the lock of the file that it writes, so that one which nobody
//! holds is abandoned, on whatever machine its writer ran. Where the file system
//! has no locks, nothing is known to be abandoned, and nothing is removed.

use tempfile::{Builder, NamedTempFile};

use super::*;

/// How the names of files on their way begin and end.
const BEGINS: &str = ".pluvia-";
const ENDS: &str = ".part";

/// Letters between the dot and the end in names that earlier versions gave.
const LETTERS: usize = 6;

/// Folders below the output folder of a command into which files are written,
/// but those of each run; the last four are those of an export for VTK.
const FOLDERS: [&str; 10] = [
    "figures",
    "rows",
    "interpretations",
    "beside",
    "slurm",
    "stages",
    "grains",
    "apparatus",
    "contacts",
    "force_chains",
];

/// A new file in a folder that nobody takes for abandoned while it is open; it
/// is removed unless it is given another name.
///
/// # Errors
/// When it cannot be made.
pub fn begin_file(folder: &Path) -> io::Result<NamedTempFile> {
    begin(folder, || ())
}

fn begin(folder: &Path, mut made: impl FnMut()) -> io::Result<NamedTempFile> {
    loop {
        let file = make_file(Builder::new().prefix(BEGINS).suffix(ENDS), folder)?;
        made();
        wait_alone(file.as_file());
        // Somebody may have removed it before it was held.
        if has_name(file.as_file()) {
            return Ok(file);
        }
    }
}

/// A new file with another name, that only its owner may read. An error says what the system said,
/// without that name, which no reader knows.
///
/// # Errors
/// When it cannot be made.
pub(super) fn make_file(named: &Builder<'_, '_>, folder: &Path) -> io::Result<NamedTempFile> {
    let mut options = File::options();
    options.read(true).write(true).create_new(true);
    #[cfg(unix)]
    {
        use std::os::unix::fs::OpenOptionsExt;
        options.mode(0o600);
    }
    named.make_in(folder, |path| options.open(path))
}

fn is_on_its_way(name: &str) -> bool {
    let Some(inner) = name.strip_suffix(ENDS) else { return false };
    let earlier = |letters: &str| {
        letters.len() == LETTERS && letters.bytes().all(|b| b.is_ascii_alphanumeric())
    };
    inner.starts_with(BEGINS) || inner.strip_prefix('.').is_some_and(earlier)
}

/// Files in a folder that are on their way or abandoned, in order of name.
pub(super) fn unfinished_in(folder: &Path) -> Vec<String> {
    let entries = fs::read_dir(folder).into_iter().flatten().flatten();
    let files = entries.filter(|e| e.file_type().is_ok_and(|t| t.is_file()));
    let mut names: Vec<String> = files
        .map(|e| e.file_name().to_string_lossy().into_owned())
        .filter(|name| is_on_its_way(name))
        .collect();
    names.sort();
    names
}

/// Removes from a folder what writers that are gone left in it. What cannot be
/// removed does no harm.
pub(super) fn remove_abandoned_in(folder: &Path) {
    for name in unfinished_in(folder) {
        let path = folder.join(name);
        // Locks of network file systems ask for a file that can be written.
        let Ok(file) = File::options().read(true).write(true).open(&path) else { continue };
        if ask_alone(&file) == AtWork::Nobody {
            let _ = fs::remove_file(&path);
        }
    }
}

/// Removes what writers that are gone left in the output folder of a command:
/// in itself, in its folders of figures and results, and in those of its runs.
pub fn remove_abandoned(out: &Path) {
    remove_abandoned_in(out);
    FOLDERS.iter().for_each(|name| remove_abandoned_in(&out.join(name)));
    for run in fs::read_dir(out.join("runs")).into_iter().flatten().flatten() {
        remove_abandoned_in(&run.path());
        remove_abandoned_in(&run.path().join("figures"));
    }
    remove_abandoned_in(&out.join("runs"));
}

#[cfg(test)]
mod tests {
    use super::*;

    fn names(folder: &Path) -> Vec<String> {
        let entries = fs::read_dir(folder).expect("a folder").flatten();
        let mut names: Vec<String> =
            entries.map(|e| e.file_name().to_string_lossy().into_owned()).collect();
        names.sort();
        names
    }

    #[test]
    fn what_a_killed_writer_left_goes_and_what_is_being_written_stays() {
        let out = tempfile::tempdir().expect("a folder");
        let of_vtk = ["grains", "apparatus", "contacts", "force_chains"];
        let folders = ["", "figures", "runs", "runs/a", "runs/a/figures", "stages", "rows"];
        let folders = [&folders[..], &of_vtk].concat();
        for folder in &folders {
            let folder = out.path().join(folder);
            fs::create_dir_all(&folder).expect("a folder");
            for left in [".pluvia-Abc123.part", ".Abc123.part"] {
                fs::write(folder.join(left), "half").expect("a leftover");
            }
        }
        let kept = [".Abc12.part", ".Abc-23.part", "Abc123.part", ".pluvia-x", ".part", "a.csv"];
        for name in kept {
            fs::write(out.path().join(name), "of others").expect("a file");
        }
        let being_written = begin_file(out.path()).expect("a file");
        let path = being_written.path().to_owned();
        remove_abandoned(out.path());
        for folder in &folders[1..] {
            let left = unfinished_in(&out.path().join(folder));
            assert!(left.is_empty(), "law: nothing is left in {folder}, got {left:?}");
        }
        let mut expected: Vec<String> = kept.map(str::to_owned).to_vec();
        expected.extend(["figures", "rows", "runs", "stages"].map(str::to_owned));
        expected.extend(of_vtk.map(str::to_owned));
        expected.extend(path.file_name().map(|n| n.to_string_lossy().into_owned()));
        expected.sort();
        assert_eq!(names(out.path()), expected, "law: what is no leftover stays");
        drop(being_written);
        assert!(!path.exists(), "law: one that was given up is removed");
    }

    #[test]
    fn a_file_that_is_removed_before_it_is_held_is_begun_anew() {
        let folder = tempfile::tempdir().expect("a folder");
        let mut removed = 0;
        let file = begin(folder.path(), || {
            // As another program does between making and holding it, but twice.
            if removed < 2 {
                remove_abandoned_in(folder.path());
                removed += 1;
            }
        })
        .expect("a file");
        remove_abandoned_in(folder.path());
        let place = folder.path().join("a.json");
        file.persist(&place).expect("law: the file that is given is there");
        assert_eq!((removed, names(folder.path())), (2, vec!["a.json".to_owned()]));
    }
}
