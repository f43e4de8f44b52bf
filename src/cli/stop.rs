//! Ctrl-C: once to stop cleanly, twice to stop at once.

use std::sync::{
    Arc,
    atomic::{AtomicBool, Ordering},
};

use super::context::say;
use crate::protocol::Progress;

/// Exit code of a program that Ctrl-C ended, as shells have it: 128 + SIGINT.
const INTERRUPTED: i32 = 130;

/// Sets `cancel` at the first Ctrl-C, ends the process at the second.
pub(super) fn on_ctrl_c(cancel: Arc<AtomicBool>, progress: Arc<dyn Progress>) {
    let handler = move || {
        if cancel.swap(true, Ordering::SeqCst) {
            std::process::exit(INTERRUPTED);
        }
        progress.message("stopping; finished stages are kept. Ctrl-C again stops at once");
    };
    if let Err(error) = ctrlc::set_handler(handler) {
        say(&format!("warning: Ctrl-C will stop at once, not cleanly: {error}"));
    }
}
