//! Ctrl-C and SIGTERM: once to stop cleanly, within seconds in any case; twice to stop at once.

use std::sync::{atomic::Ordering, mpsc};

use super::*;

/// Exit code of a program that Ctrl-C ended, as shells have it: 128 + SIGINT.
const INTERRUPTED: i32 = 130;

/// How long a clean stop may take. Work looks at `cancel` many times a second; a step of very
/// many grains, making grains or a page of figures may take longer. Whatever is being
/// written is then left out, and files are there whole or not at all.
const CLEANLY: Duration = Duration::from_secs(7);

/// How long saying the last words may take: whoever reads them may have stopped reading.
const SAYING: Duration = Duration::from_secs(1);

/// What is said of a stop.
#[derive(Debug, Clone, Copy)]
pub(super) struct Words {
    /// At the first Ctrl-C.
    pub begins: &'static str,
    /// At the end of a command that does not end by itself.
    pub ends: &'static str,
}

/// Sets `cancel` at the first Ctrl-C, says so, and ends the process where that is not enough; ends
/// it at once at the second.
pub(super) fn on_ctrl_c(cancel: Arc<AtomicBool>, progress: Arc<dyn Progress>, words: Words) {
    let made = output_folder::made();
    let handler = move || {
        if cancel.swap(true, Ordering::SeqCst) {
            end(&made, words.ends);
        }
        end_after(CLEANLY, made.clone(), words.ends);
        // Whoever reads the messages may have stopped reading: nobody waits for this thread.
        let progress = progress.clone();
        let told = named("stopping").spawn(move || progress.message(words.begins));
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
fn end_after(time: Duration, made: output_folder::Made, words: &'static str) {
    let at_once = made.clone();
    let waiting = named("last-resort").spawn(move || {
        thread::sleep(time);
        end(&made, words);
    });
    if waiting.is_err() {
        end(&at_once, words);
    }
}

/// Ends the process: says that it was stopped, and leaves no empty folder that the command made.
fn end(made: &output_folder::Made, words: &'static str) -> ! {
    made.remove_empty();
    let (said, is_said) = mpsc::channel();
    let saying = named("stopped").spawn(move || {
        say_error(words);
        said.send(())
    });
    if saying.is_ok() {
        let _ = is_said.recv_timeout(SAYING);
    }
    std::process::exit(INTERRUPTED);
}

fn named(name: &str) -> thread::Builder {
    thread::Builder::new().name(name.to_owned())
}
