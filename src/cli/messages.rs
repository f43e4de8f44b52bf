//! Lines that commands say beside their results: on the standard error, or to who listens.

use std::cell::RefCell;
use std::io::Write;

use super::*;

thread_local! {
    /// Who hears what commands of this thread would write to the standard error.
    static LISTENER: RefCell<Option<Arc<dyn Progress>>> = const { RefCell::new(None) };
}

/// From here on, lines that this thread says go to a listener.
pub(super) fn listen(listener: Option<Arc<dyn Progress>>) {
    LISTENER.set(listener);
}

/// Writes a line to the standard error, or says it to who listens; there is nobody left to tell
/// when that fails.
pub(super) fn say(line: &str) {
    if let Some(listener) = LISTENER.with_borrow(Clone::clone) {
        listener.message(&paint::colourless(line));
        return;
    }
    let _ = writeln!(anstream::stderr(), "{}", paint::shown(line));
}

/// Says why a command has not done what it was asked.
pub(super) fn say_error(what: &str) {
    say(&format!("{}: {}", paint::bad("error"), plain_lines(what)));
}
