//! The command line: one file a subcommand.

mod error;
mod grains;
mod info;
mod progress;
mod reproduce;
mod run;
mod schema;
mod table;

pub use error::CliError;

use std::{
    path::Path,
    process::ExitCode,
    sync::{
        Arc,
        atomic::{AtomicBool, Ordering},
    },
};

use clap::{Parser, Subcommand, ValueEnum};

use crate::protocol::{Progress, Silent};
use crate::record::{FileError, create_folder};
use crate::scenario::Backend;

/// Simulates granular soil as rigid convex polyhedra: how grains pack, pour and settle.
#[derive(Debug, Parser)]
#[command(version, about, max_term_width = 100)]
struct Arguments {
    #[command(subcommand)]
    command: Command,
    /// Print no progress.
    #[arg(long, global = true)]
    quiet: bool,
    /// Print results as JSON.
    #[arg(long, global = true)]
    json: bool,
}

#[derive(Debug, Subcommand)]
enum Command {
    Reproduce(reproduce::Arguments),
    Run(run::Arguments),
    Grains(grains::Arguments),
    Schema(schema::Arguments),
    Info(info::Arguments),
}

/// Engines as typed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum BackendName {
    /// Debian's Bullet.
    Bullet,
}

impl From<BackendName> for Backend {
    fn from(name: BackendName) -> Self {
        match name {
            BackendName::Bullet => Self::Bullet,
        }
    }
}

/// What every subcommand is given.
struct Context {
    json: bool,
    cancel: Arc<AtomicBool>,
    progress: Arc<dyn Progress>,
}

/// How a command that did its work ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Ended {
    /// As expected.
    Well,
    /// With an expectation missed (exit code 1).
    Missed,
}

/// Reads the command line, carries it out, and gives the process's exit code:
/// 0 done, 1 done with an expectation missed, 2 bad usage or scenario, 3 the
/// simulation failed, 4 files could not be read or written, 130 interrupted.
pub fn main() -> ExitCode {
    // clap prints its own message and exits with 2 on bad usage.
    let arguments = Arguments::parse();
    let cancel = Arc::new(AtomicBool::new(false));
    listen_for_interrupts(&cancel);
    let progress: Arc<dyn Progress> =
        if arguments.quiet { Arc::new(Silent) } else { Arc::new(progress::Terminal::new()) };
    let context = Context { json: arguments.json, cancel, progress };
    let result = match arguments.command {
        Command::Reproduce(a) => reproduce::run(&a, &context),
        Command::Run(a) => run::run(&a, &context),
        Command::Grains(a) => grains::run(&a, &context),
        Command::Schema(_) => schema::run(),
        Command::Info(_) => info::run(&context),
    };
    match result {
        Ok(Ended::Well) => ExitCode::SUCCESS,
        Ok(Ended::Missed) => ExitCode::from(1),
        Err(error) => {
            eprintln!("pluvia: {error}");
            ExitCode::from(error.exit_code())
        }
    }
}

/// The first Ctrl-C asks the work to stop where it can go on later, the second ends at once.
fn listen_for_interrupts(cancel: &Arc<AtomicBool>) {
    let cancel = cancel.clone();
    let set = ctrlc::set_handler(move || {
        if cancel.swap(true, Ordering::Relaxed) {
            std::process::exit(130);
        }
    });
    if let Err(error) = set {
        eprintln!("pluvia: Ctrl-C will end the program at once: {error}");
    }
}

/// Creates the output folder and finds out whether files can be written there,
/// before anything is computed.
fn usable_folder(path: &Path) -> Result<(), CliError> {
    create_folder(path)?;
    tempfile::tempfile_in(path).map_err(|e| FileError::new("write into the folder", path, e))?;
    Ok(())
}

/// Number of threads to use when none is given: one a core.
fn cores() -> usize {
    std::thread::available_parallelism().map_or(1, std::num::NonZero::get)
}

/// Prints to stdout. A reader that has gone away, as `head` does, is no error of ours.
fn print(text: &str) {
    use std::io::Write as _;
    let _ = writeln!(std::io::stdout(), "{text}");
}

/// Prints a value as indented JSON.
fn print_json(value: &impl serde::Serialize) {
    print(&serde_json::to_string_pretty(value).unwrap_or_default());
}
