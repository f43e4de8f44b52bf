//! The command line: one file a subcommand, each a function of its arguments
//! and a [`Context`].

mod asked;
mod calibrate;
mod changes;
mod compare;
mod completions;
mod context;
mod converge;
mod density;
mod earlier_run;
mod embedded;
mod error;
mod export;
mod field_page;
mod grains;
mod info;
mod interpretations;
mod jobs;
mod last_line;
mod lines;
mod man;
mod messages;
mod output_folder;
mod overall;
mod paint;
mod picture;
mod plot;
mod progress;
mod renamed;
mod reproduce;
mod run;
mod schema;
mod scorecard;
mod sensitivity;
mod stage;
mod stop;
mod store;
mod studies;
mod sweep;
mod table;
mod targets;
mod verify;
mod view;

pub use context::Context;
pub use embedded::{Ended, News, embedded};
pub use error::{CliError, ExitStatus};

// What subcommands are made of, too.
use std::collections::HashMap;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::sync::atomic::AtomicBool;
use std::sync::{Arc, Mutex};
use std::time::{Duration, Instant};
use std::{io, thread};

use clap::{Args, Parser, Subcommand, ValueEnum};
use serde::Serialize;
use serde_json::{Value, json};

use crate::caught::{caught, note_panics};
use crate::export::ExportError;
use crate::grains::load_scenario;
use crate::paper::Interpretation;
use crate::plain::{
    components, counted, four_digits, grams, json_path, json_paths, plain, plain_lines, plain_path,
    three_decimals, without_zeros,
};
use crate::protocol::Progress;
use crate::record::{
    AtWork, FileError, RunLock, Summary, read_file, read_json, remove_abandoned, write_file,
    write_json,
};
use crate::scenario::{Backend, Override, Scenario};
use crate::study::{AT_LEAST, RunOptions, StudyError, SweepTasks, available_cores};
use crate::world::{self, BackendInfo};
use {
    changes::*, context::*, field_page::*, jobs::*, messages::*, overall::*, picture::*,
    progress::*, studies::*,
};

const EXIT_CODES: &str = "\
Exit codes: 0 done, valid or not (the last line and summary.json say which); 1 done, but an
expectation of verify, compare, calibrate or --strict is not met, no run of a sweep or of density
has a result, or store check found damage; 2 wrong usage, a fault in the scenario (a motion_file,
the mesh of a piece or a begin.specimen that is not there is one), or a file or folder of the wrong
kind; 3 the simulation failed, its last good state is kept; 4 other files or folders are not there,
or could not be read or written, as an --out that is a file; 130 stopped by Ctrl-C.

Example:
  pluvia run scenarios/quick/pluviation.json --out out/first";

/// Granular soil as rigid convex grains: pour, shake and measure it.
#[derive(Debug, Parser)]
#[command(name = "pluvia", version, about, after_help = EXIT_CODES)]
struct Cli {
    #[command(flatten)]
    global: Global,
    #[command(subcommand)]
    command: Command,
}

/// Options of every subcommand.
#[derive(Debug, Clone, Copy, Args)]
struct Global {
    /// Print only errors, runs left out and what is asked for
    #[arg(long, global = true)]
    quiet: bool,
    /// Print results as JSON
    #[arg(long, global = true)]
    json: bool,
    /// Print more detail; twice for even more
    #[arg(short, long, action = clap::ArgAction::Count, global = true)]
    verbose: u8,
}

/// The subcommands: each a module with its arguments and a function `run`.
macro_rules! commands {
    ($($name:ident: $module:ident::$arguments:ident,)*) => {
        #[derive(Debug, Subcommand)]
        enum Command {
            $($name(Box<$module::$arguments>),)*
        }

        fn command(cli: &Cli, context: &Context) -> Result<ExitStatus, CliError> {
            if cli.command.computes() {
                jobs::start_pool()?;
            }
            match &cli.command {
                $(Command::$name(arguments) => $module::run(arguments, context),)*
            }
        }
    };
}

commands! {
    Reproduce: reproduce::ReproduceArgs,
    Interpretations: interpretations::InterpretationsArgs,
    Run: run::RunArgs,
    Grains: grains::GrainsArgs,
    Compare: compare::CompareArgs,
    Calibrate: calibrate::CalibrateArgs,
    Density: density::DensityArgs,
    Converge: converge::ConvergeArgs,
    Sensitivity: sensitivity::SensitivityArgs,
    Sweep: sweep::SweepArgs,
    Targets: targets::TargetsArgs,
    Stage: stage::StageArgs,
    Store: store::StoreArgs,
    Verify: verify::VerifyArgs,
    Export: export::ExportArgs,
    Picture: picture::PictureArgs,
    Plot: plot::PlotArgs,
    View: view::ViewArgs,
    Schema: schema::SchemaArgs,
    Info: info::InfoArgs,
    Completions: completions::CompletionsArgs,
    Man: man::ManArgs,
}

impl Command {
    /// Whether it may share work among threads.
    fn computes(&self) -> bool {
        !matches!(self, Self::Schema(_) | Self::Info(_) | Self::Completions(_) | Self::Man(_))
    }
}

/// The command line: its subcommands with their options.
pub fn command_line() -> clap::Command {
    <Cli as clap::CommandFactory>::command()
}

/// Runs the program on the arguments of the process.
pub fn main() -> ExitCode {
    let words: Vec<_> = std::env::args_os().skip(1).collect();
    let done = match renamed::refused(&words) {
        Some(what) => Err(CliError::Usage(what)),
        None => {
            let cli = Cli::parse();
            note_panics();
            let Global { quiet, json, verbose } = cli.global;
            carried_out(&cli, || Context::new(quiet, json, verbose))
        }
    };
    match done {
        Ok(status) => status.into(),
        Err(error) => {
            say_error(&error.to_string());
            error.exit_code().into()
        }
    }
}

/// Carries a command out, whole: a panic is an error, results are where they belong, and a command
/// that fails leaves no folder that it made and wrote nothing into.
fn carried_out(cli: &Cli, context: impl FnOnce() -> Context) -> Result<ExitStatus, CliError> {
    let done = caught(|| command(cli, &context()));
    let done = done.unwrap_or_else(|what| Err(CliError::Fault(what)));
    let status = done.inspect_err(|_| output_folder::made().remove_empty())?;
    output_folder::still_there()?;
    Ok(status)
}

#[cfg(test)]
mod tests {
    use clap::CommandFactory;

    use super::*;

    #[test]
    fn the_command_line_is_sound() {
        Cli::command().debug_assert();
    }

    /// Law: a number below what is allowed is refused with what is, not as an option that is not
    /// there.
    #[test]
    fn every_option_of_a_number_takes_a_minus_sign() {
        const NUMBERS: [&str; 10] =
            ["N", "S", "PX", "MB", "DEG", "DEGREES", "KPA", "HZ", "MM", "WIDTH"];
        let mut count = 0;
        for command in Cli::command().get_subcommands() {
            for option in command.get_opts() {
                let name = option.get_long().unwrap_or_default();
                let values = option.get_value_names().unwrap_or_default();
                let is_number = ["port", "stage"].contains(&name);
                if !is_number && !values.iter().any(|value| NUMBERS.contains(&value.as_str())) {
                    continue;
                }
                let command = command.get_name();
                assert!(option.is_allow_negative_numbers_set(), "law: `{command} --{name} -1`");
                count += 1;
            }
        }
        assert!(count >= 30, "expected the options of numbers, found {count}");
    }

    /// Law: help calls a new arrangement of the same grains a realisation, but for the option.
    #[test]
    fn help_speaks_of_realisations() {
        for command in Cli::command().get_subcommands() {
            let mut command = command.clone();
            let help = command.render_long_help().to_string();
            let prose = help.replace("--configurations", "").to_lowercase();
            let is_so = !prose.contains("configurations");
            assert!(is_so, "law: expected realisations in the help of `{}`", command.get_name());
        }
    }

    #[test]
    fn every_subcommand_shows_an_example() {
        let cli = Cli::command();
        let mut count = 0;
        for command in cli.get_subcommands() {
            let help = command.get_after_help().map(ToString::to_string).unwrap_or_default();
            let example = format!("pluvia {}", command.get_name());
            assert!(help.contains(&example), "`{example} --help` shows no example");
            let widest = help.lines().map(|line| line.chars().count()).max();
            assert!(widest <= Some(100), "law: `{example} --help` breaks no example in two");
            count += 1;
        }
        assert!(count >= 5, "expected at least five subcommands, found {count}");
    }
}
