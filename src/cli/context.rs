//! What every subcommand needs beside its own arguments.

use std::io::{self, IsTerminal, Write};
use std::sync::atomic::Ordering;

use tracing::Level;

use super::*;
use crate::protocol::Silent;

/// How to tell of progress, print results, and stop.
pub struct Context {
    /// Print nothing but errors, and what `json` asks for.
    pub quiet: bool,
    /// Print results as JSON.
    pub json: bool,
    /// Becomes true when the user asks to stop.
    pub cancel: Arc<AtomicBool>,
    /// Told of what goes on.
    pub progress: Arc<dyn Progress>,
    /// What was printed, where it is kept for another program.
    kept: Option<Arc<Mutex<String>>>,
}

impl Context {
    /// For the given global options. Messages go to the standard error, and
    /// progress as bars where that is a terminal.
    pub fn new(quiet: bool, json: bool, verbose: u8) -> Self {
        log(verbose);
        let progress: Arc<dyn Progress> = if quiet {
            Arc::new(Silent)
        } else if io::stderr().is_terminal() {
            Arc::new(progress::Bars::default())
        } else {
            Arc::new(lines::Lines::new(io::stderr()))
        };
        Self { quiet, json, cancel: Arc::new(AtomicBool::new(false)), progress, kept: None }
    }

    /// For a command within another program, which sets `cancel` itself, hears of progress and
    /// gets what is printed: signals and standard streams stay its own.
    pub(super) fn within(
        cancel: Arc<AtomicBool>,
        progress: Arc<dyn Progress>,
        kept: Arc<Mutex<String>>,
    ) -> Self {
        Self { quiet: false, json: true, cancel, progress, kept: Some(kept) }
    }

    /// From here on, Ctrl-C sets [`Context::cancel`]: of a command that stores finished stages.
    pub fn stop_on_ctrl_c(&self) {
        self.on_ctrl_c(stop::Words {
            begins: "stopping; finished stages are kept. Ctrl-C again stops at once",
            ends: "stopped; run the same command again to resume",
        });
    }

    /// The same of a command that has no stages.
    pub(super) fn stop_without_stages(&self) {
        self.on_ctrl_c(stop::Words {
            begins: "stopping. Ctrl-C again stops at once",
            ends: "stopped; what is not written yet is left out",
        });
    }

    /// Whether the user has asked to stop.
    pub(super) fn is_stopped(&self) -> bool {
        self.cancel.load(Ordering::SeqCst)
    }

    /// Goes on to write the files of a command that leaves all of them or none.
    ///
    /// # Errors
    /// [`CliError::Stopped`] where the user has asked to stop.
    pub(super) fn go_on(&self) -> Result<(), CliError> {
        if self.is_stopped() { Err(CliError::Stopped) } else { Ok(()) }
    }

    fn on_ctrl_c(&self, words: stop::Words) {
        if self.kept.is_none() {
            stop::on_ctrl_c(self.cancel.clone(), self.progress.clone(), words);
        }
    }

    /// How a command that leaves its results in a folder runs its simulations.
    pub(super) fn run_options(&self, out: &Path, jobs: Jobs) -> RunOptions {
        RunOptions {
            out: out.to_owned(),
            jobs: jobs.cores(),
            frames: false,
            cancel: self.cancel.clone(),
            progress: self.progress.clone(),
        }
    }

    /// Prints a result as [`Context::print`] does: the command has done what it was asked.
    pub(super) fn done(&self, text: &str, value: &impl Serialize) -> Result<ExitStatus, CliError> {
        self.print(text, value)?;
        Ok(ExitStatus::Done)
    }

    /// Prints a result: the text, or the value as JSON where that was asked for. Quietly, the
    /// text is left out, but for a last line that says what is not valid: the standard error has it.
    ///
    /// # Errors
    /// When the standard output cannot be written; a reader that closed it
    /// early, as `head` does, is no error.
    pub fn print(&self, text: &str, value: &impl Serialize) -> io::Result<()> {
        if self.quiet && !self.json {
            text.lines().last().filter(|line| last_line::warns(line)).into_iter().for_each(say);
            return Ok(());
        }
        self.print_asked(text, value)
    }

    /// The same of what a command is there to print, which is printed quietly, too.
    ///
    /// # Errors
    /// As [`Context::print`].
    pub fn print_asked(&self, text: &str, value: &impl Serialize) -> io::Result<()> {
        let mut out = if self.json {
            serde_json::to_string_pretty(value).map_err(io::Error::other)?
        } else {
            text.to_owned()
        };
        if !out.ends_with('\n') {
            out.push('\n');
        }
        // In JSON a code point says the same as the character.
        let out = if self.json { plain_lines(&out).into_owned() } else { paint::shown(&out) };
        if let Some(kept) = &self.kept {
            progress::lock(kept).push_str(&out);
            return Ok(());
        }
        // Takes colours out where there is no terminal to show them.
        write_all(&mut anstream::stdout().lock(), out.as_bytes())
    }

    /// Prints as [`Context::print_asked`] does: the command has done what it was asked.
    pub(super) fn done_asked(
        &self,
        text: &str,
        value: &impl Serialize,
    ) -> Result<ExitStatus, CliError> {
        self.print_asked(text, value)?;
        Ok(ExitStatus::Done)
    }
}

/// Writes what a reader may have closed early, as `head` does, which is no error.
pub(super) fn write_all(out: &mut impl Write, content: &[u8]) -> io::Result<()> {
    match out.write_all(content).and_then(|()| out.flush()) {
        Err(error) if error.kind() == io::ErrorKind::BrokenPipe => Ok(()),
        other => other,
    }
}

fn log(verbose: u8) {
    let levels = [Level::WARN, Level::INFO, Level::DEBUG, Level::TRACE];
    // A second context in one process keeps the log of the first.
    let _ = tracing_subscriber::fmt()
        .with_max_level(levels[usize::from(verbose).min(3)])
        .with_writer(io::stderr)
        .with_target(false)
        .try_init();
}
