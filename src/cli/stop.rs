//! Ctrl-C and SIGTERM: once to stop cleanly, within seconds in any case; twice to stop at once.

use std::sync::atomic::Ordering;

use super::*;

/// Exit code of a program that Ctrl-C ended, as shells have it: 128 + SIGINT.
const INTERRUPTED: i32 = 130;

/// How long a clean stop may take. Work looks at `cancel` many times a second; a step of very
/// many grains, making grains or a page of figures may take longer. Whatever is being
/// written is then left out, and files are there whole or not at all.
const CLEANLY: Duration = Duration::from_secs(7);

/// Sets `cancel` at the first Ctrl-C, says so in these words, and ends the process where that is
/// not enough; ends it at once at the second.
pub(super) fn on_ctrl_c(cancel: Arc<AtomicBool>, progress: Arc<dyn Progress>, words: &'static str) {
    let handler = move || {
        if cancel.swap(true, Ordering::SeqCst) {
            std::process::exit(INTERRUPTED);
        }
        end_after(CLEANLY);
        // Whoever reads the messages may have stopped reading: nobody waits for this thread.
        let progress = progress.clone();
        let told = named("stopping").spawn(move || progress.message(words));
        drop(told);
    };
    // A handler for which there is no thread would swallow the signals, so one is tried first.
    let tried = named("trial").spawn(|| ()).map(|thread| drop(thread.join()));
    let set = tried.map_err(|e| e.to_string());
    let set = set.and_then(|()| ctrlc::set_handler(handler).map_err(|e| e.to_string()));
    if let Err(error) = set {
        say(&format!("warning: Ctrl-C will stop at once, not cleanly: {error}"));
    }
}

/// Ends the process when the time is up, or now where there is no thread to wait.
pub(super) fn end_after(time: Duration) {
    let waiting = named("last-resort").spawn(move || {
        thread::sleep(time);
        std::process::exit(INTERRUPTED);
    });
    if waiting.is_err() {
        std::process::exit(INTERRUPTED);
    }
}

fn named(name: &str) -> thread::Builder {
    thread::Builder::new().name(name.to_owned())
}
