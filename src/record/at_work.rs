//! Who is at work in the folder of a run or study, known by a lock that ends with the program.

use super::*;

/// Held by whoever begins there, one after the other.
const TURN: &str = ".begin.lock";

/// Held by everybody who runs there, together with others.
const RUN: &str = ".run.lock";

/// A folder that somebody is at work in until this is dropped.
#[derive(Debug)]
pub struct RunLock {
    _held: File,
}

impl RunLock {
    /// Has `begin` decide, told who is at work in a folder, whether to begin there, and write what
    /// says so; then holds the folder, together with others. All who begin do so one after the
    /// other: each sees what those before it have written.
    ///
    /// # Errors
    /// What `begin` says; [`FileError`] where the locks cannot be made.
    pub fn take<E: From<FileError>>(
        folder: &Path,
        begin: impl FnOnce(AtWork) -> Result<(), E>,
    ) -> Result<Self, E> {
        // A lock of its own: one that is held alone cannot be turned into a shared one without
        // letting others in between.
        let turn = open_lock(folder, TURN)?;
        wait_alone(&turn);
        let held = open_lock(folder, RUN)?;
        let at_work = ask_alone(&held);
        if at_work == AtWork::Nobody {
            let _ = held.unlock();
        }
        begin(at_work)?;
        wait_shared(&held);
        Ok(Self { _held: held })
    }
}

/// Who is at work in a folder, where nothing is left by asking: whoever begins makes both locks.
pub fn at_work_in(folder: &Path) -> AtWork {
    let there = |name: &str| File::options().append(true).open(folder.join(name));
    let (Ok(turn), Ok(held)) = (there(TURN), there(RUN)) else { return AtWork::Nobody };
    // Whoever begins meanwhile waits, and does not take this for somebody at work.
    wait_alone(&turn);
    ask_alone(&held)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn take(folder: &Path, expected: AtWork) -> RunLock {
        let begin = |found: AtWork| {
            assert_eq!(found, expected, "law: who is at work");
            Ok::<(), FileError>(())
        };
        RunLock::take(folder, begin).expect("law: all who may begin hold it together")
    }

    /// Law: whoever begins learns of those who have begun before and have not ended.
    #[test]
    fn those_at_work_are_known() {
        let folder = tempfile::tempdir().expect("a folder");
        assert_eq!(at_work_in(folder.path()), AtWork::Nobody, "law: nobody has begun");
        let left = fs::read_dir(folder.path()).expect("a folder").count();
        assert_eq!(left, 0, "law: nothing is left by asking");
        let first = take(folder.path(), AtWork::Nobody);
        let second = take(folder.path(), AtWork::Somebody);
        drop(first);
        assert_eq!(at_work_in(folder.path()), AtWork::Somebody, "law: the second is");
        let third = take(folder.path(), AtWork::Somebody);
        drop((second, third));
        assert_eq!(at_work_in(folder.path()), AtWork::Nobody, "law: all have ended");
        let refuse = |_: AtWork| Err(FileError::new("begin in", folder.path(), "refused"));
        let refused = RunLock::take(folder.path(), refuse);
        assert!(refused.is_err(), "law: what is refused is not begun");
        drop(take(folder.path(), AtWork::Nobody));
    }
}
