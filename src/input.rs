//! How files that users name are read, all of them: regular files alone, and no
//! larger than can be meant. A device, a pipe or a file of the system may go on for
//! ever, and would be read until there is no memory left. And the hash by which a file is
//! known to be as it was.

use std::{
    fs::{self, File},
    io::{self, Read},
    path::Path,
};

use sha2::{Digest, Sha256};

/// Largest scenario or design in bytes: some hundred times the longest that makes sense.
pub const LARGEST_SCENARIO: u64 = 4 << 20;

/// Largest mesh in bytes: one of some five million triangles. What a rigid body can
/// use of it fits into a thousandth.
pub const LARGEST_MESH: u64 = 512 << 20;

/// Largest file in bytes of grains, of a run, or of its stages: the frames of a
/// hundred thousand grains over ten minutes.
pub const LARGEST_OF_RUN: u64 = 16 << 30;

/// Why a file is not read that could be: because of what it is.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("it {found}; {allowed}")]
pub struct Refusal {
    /// What it is.
    pub found: String,
    /// What is read.
    pub allowed: String,
}

impl Refusal {
    fn of(found: &str, allowed: &str) -> io::Error {
        io::Error::other(Self { found: found.to_owned(), allowed: allowed.to_owned() })
    }

    /// The refusal in an error of this module; none where the system is the reason.
    pub fn within(error: &io::Error) -> Option<&Self> {
        error.get_ref()?.downcast_ref()
    }
}

/// What is allowed where something else is found.
const REGULAR: &str = "only regular files are read";

/// Opens a regular file; gives its length in bytes, too.
///
/// # Errors
/// Whatever the system says; a [`Refusal`] with what the file is, where it is no regular one, or its
/// size, and what is allowed.
pub fn open(path: &Path, largest: u64) -> io::Result<(File, u64)> {
    // Asked before it is opened: opening a pipe waits for somebody to write into it.
    let found = fs::metadata(path)?;
    regular(&found, largest)?;
    let file = File::open(path)?;
    let length = regular(&file.metadata()?, largest)?;
    Ok((file, length))
}

/// Reads a regular file as long as the system says that it is: one of the system's own
/// (`/proc/kmsg`) has no length, and no end.
///
/// # Errors
/// As [`open()`].
pub fn read(path: &Path, largest: u64) -> io::Result<Vec<u8>> {
    let (file, length) = open(path, largest)?;
    let mut content = Vec::new();
    file.take(length).read_to_end(&mut content)?;
    Ok(content)
}

/// SHA-256 of bytes, in lower-case hexadecimal.
pub fn sha256(bytes: &[u8]) -> String {
    hexadecimal(&Sha256::digest(bytes))
}

/// Bytes in lower-case hexadecimal.
pub fn hexadecimal(bytes: &[u8]) -> String {
    bytes.iter().map(|b| format!("{b:02x}")).collect()
}

/// Whether a folder is there.
///
/// # Errors
/// What the system says; a [`Refusal`] for what is no folder.
pub fn is_folder(path: &Path) -> io::Result<()> {
    let kind = fs::metadata(path)?.file_type();
    if kind.is_dir() {
        return Ok(());
    }
    let found = if kind.is_file() { "a file" } else { special(kind) };
    Err(Refusal::of(&format!("is {found}"), "a folder is read here"))
}

fn regular(found: &fs::Metadata, largest: u64) -> io::Result<u64> {
    let kind = found.file_type();
    if !kind.is_file() {
        return Err(Refusal::of(&format!("is {}", special(kind)), REGULAR));
    }
    let length = found.len();
    if length > largest {
        let (found, most) = (size(length), size(largest));
        return Err(Refusal::of(&format!("has {found}"), &format!("at most {most} are read")));
    }
    Ok(length)
}

#[cfg(unix)]
fn special(kind: fs::FileType) -> &'static str {
    use std::os::unix::fs::FileTypeExt;
    match () {
        () if kind.is_dir() => "a folder",
        () if kind.is_fifo() => "a pipe",
        () if kind.is_char_device() || kind.is_block_device() => "a device",
        () if kind.is_socket() => "a socket",
        () => "something else",
    }
}

#[cfg(not(unix))]
fn special(kind: fs::FileType) -> &'static str {
    if kind.is_dir() { "a folder" } else { "something else" }
}

/// A size for people.
fn size(bytes: u64) -> String {
    match bytes {
        0..1024 => format!("{bytes} bytes"),
        1024..0x10_0000 => format!("{:.1} KiB", bytes as f64 / 1024.0),
        0x10_0000..0x4000_0000 => format!("{:.1} MiB", bytes as f64 / 1_048_576.0),
        _ => format!("{:.1} GiB", bytes as f64 / 1_073_741_824.0),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn regular_files_are_read_up_to_the_limit() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("a");
        fs::write(&path, b"12345").expect("written");
        assert_eq!(read(&path, 5).expect("it is small enough"), b"12345");
        let said = read(&path, 4).expect_err("it is too large").to_string();
        assert_eq!(said, "it has 5 bytes; at most 4 bytes are read", "law: size and limit");
        let large = File::create(folder.path().join("large")).expect("made");
        large.set_len(LARGEST_SCENARIO + 1).expect("a hole takes no room");
        let said = read(&folder.path().join("large"), LARGEST_SCENARIO).expect_err("too large");
        assert!(said.to_string().contains("at most 4.0 MiB"), "law: the limit is named: {said}");
        let folder = read(folder.path(), 4).expect_err("a folder");
        let refusal = Refusal::within(&folder).expect("law: refused because of what it is");
        assert_eq!((&*refusal.found, &*refusal.allowed), ("is a folder", REGULAR));
        let missing = read(Path::new("no/such/file"), 4).expect_err("missing");
        assert_eq!(missing.kind(), io::ErrorKind::NotFound);
        assert_eq!(Refusal::within(&missing), None, "law: the system's reason is none of ours");
    }

    #[cfg(target_os = "linux")]
    #[test]
    fn what_has_no_end_is_not_read() {
        for device in ["/dev/zero", "/dev/full", "/dev/null"] {
            let said = read(Path::new(device), 1 << 20).expect_err("a device").to_string();
            assert_eq!(said, "it is a device; only regular files are read", "{device}");
        }
        // Regular by name; a read of it waits for the kernel's next message.
        if Path::new("/proc/kmsg").exists() && File::open("/proc/kmsg").is_ok() {
            assert_eq!(read(Path::new("/proc/kmsg"), 1 << 20).expect("no bytes"), b"");
        }
        let (_, pipe) = io::pipe().expect("a pipe");
        let name = format!("/dev/fd/{}", std::os::fd::AsRawFd::as_raw_fd(&pipe));
        let said = read(Path::new(&name), 1 << 20).expect_err("a pipe").to_string();
        assert_eq!(said, "it is a pipe; only regular files are read", "law: no waiting for it");
    }
}
