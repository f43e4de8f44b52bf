//! File systems of a test's own: ext4 in a file, tmpfs of a size. Mounting them takes leave that
//! tests seldom have.

use std::{
    fs,
    path::{Path, PathBuf},
    process::{Command, Stdio},
    thread::sleep,
    time::Duration,
};

use super::super::program::{root, text};

/// A mounted file system, which is unmounted when it is dropped.
#[derive(Debug)]
pub struct Mounted {
    at: PathBuf,
    image: Option<PathBuf>,
    is_mounted: bool,
}

fn done(program: &str, args: &[&str]) -> bool {
    let mut command = Command::new(program);
    command.args(args).stdout(Stdio::null()).stderr(Stdio::null());
    command.status().is_ok_and(|status| status.success())
}

impl Mounted {
    /// A file system in memory of a size in KiB; none where none can be mounted.
    pub fn tmpfs(place: &Path, kib: u64) -> Option<Self> {
        fs::create_dir_all(place).expect("a folder");
        let size = format!("size={kib}k");
        let mounted = done("mount", &["-t", "tmpfs", "-o", &size, "tmpfs", text(place)]);
        mounted.then(|| Self { at: place.to_owned(), image: None, is_mounted: true })
    }

    /// Gives a file system in memory another size.
    pub fn resize(&self, kib: u64) {
        let options = format!("remount,size={kib}k");
        assert!(done("mount", &["-o", &options, text(&self.at)]), "law: it can be made larger");
    }

    /// A new ext4 in a file beside `place`, mounted with options; none where that cannot be.
    pub fn ext4(place: &Path, options: &str) -> Option<Self> {
        fs::create_dir_all(place).expect("a folder");
        let image = place.with_extension("ext4");
        fs::File::create(&image).and_then(|file| file.set_len(32 << 20)).expect("an image");
        let made = done("mkfs.ext4", &["-q", "-F", text(&image)]);
        let mut mounted = Self { at: place.to_owned(), image: Some(image), is_mounted: true };
        if made && mounted.mount(options) {
            return Some(mounted);
        }
        mounted.image = None;
        std::mem::forget(mounted);
        None
    }

    fn mount(&self, options: &str) -> bool {
        let image = self.image.as_deref().expect("law: it is in a file");
        done("mount", &["-o", &format!("loop,{options}"), text(image), text(&self.at)])
    }

    /// Unmounts it and mounts it anew, after a check of its structure where that is wanted.
    pub fn again(&self, check: bool, options: &str) {
        self.let_go();
        let image = self.image.as_deref().expect("law: it is in a file");
        if check {
            // 1 says that faults were corrected.
            let status = Command::new("e2fsck").args(["-p", text(image)]).output();
            let code = status.expect("e2fsck starts").status.code();
            assert!(matches!(code, Some(0 | 1)), "law: the file system is sound, got {code:?}");
        }
        assert!(self.mount(options), "law: it can be mounted again");
    }

    /// Unmounts it for good: nobody may hold a file there any more.
    pub fn unmount(mut self) {
        self.let_go();
        self.is_mounted = false;
    }

    fn let_go(&self) {
        for _ in 0..200 {
            if done("umount", &[text(&self.at)]) {
                return;
            }
            sleep(Duration::from_millis(50));
        }
        panic!("law: nobody holds a file in {}", self.at.display());
    }

    /// Has an ext4 find an error, at which it makes itself read-only; whether it could be asked to.
    pub fn break_down(&self) -> bool {
        let source = Command::new("findmnt").args(["-n", "-o", "SOURCE", text(&self.at)]).output();
        let source = source.map(|o| String::from_utf8_lossy(&o.stdout).trim().to_owned());
        let device = source.unwrap_or_default();
        let device = device.rsplit('/').next().unwrap_or_default();
        let switch = Path::new("/sys/fs/ext4").join(device).join("trigger_fs_error");
        !device.is_empty() && fs::write(switch, "1").is_ok()
    }

    /// Cuts its power; whether that can be done.
    pub fn cut(&self) -> bool {
        let script = root().join("scripts/power-cut.py");
        done("python3", &[text(&script), text(&self.at)])
    }
}

impl Drop for Mounted {
    fn drop(&mut self) {
        // After a failure somebody may still hold a file.
        let unmounted = !self.is_mounted
            || done("umount", &[text(&self.at)])
            || done("umount", &["-l", text(&self.at)]);
        if !unmounted {
            eprintln!("{} stays mounted", self.at.display());
        }
        if let Some(image) = &self.image {
            let _ = fs::remove_file(image);
        }
    }
}
