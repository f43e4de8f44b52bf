//! `pluvia completions`.

use std::io::{self, Write};

use clap::{Args, CommandFactory};
use clap_complete::{Shell, generate};

use super::{Cli, CliError, ExitStatus};

/// Print a script that lets a shell complete commands and options
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  pluvia completions bash > ~/.local/share/bash-completion/completions/pluvia
  pluvia completions zsh > ~/.zfunc/_pluvia      # a folder of $fpath, before compinit
  pluvia completions fish > ~/.config/fish/completions/pluvia.fish")]
pub(super) struct CompletionsArgs {
    /// The shell
    #[arg(value_enum)]
    shell: Shell,
}

pub(super) fn run(args: &CompletionsArgs) -> Result<ExitStatus, CliError> {
    let mut script = Vec::new();
    generate(args.shell, &mut Cli::command(), "pluvia", &mut script);
    match io::stdout().lock().write_all(&script) {
        Err(error) if error.kind() != io::ErrorKind::BrokenPipe => Err(error.into()),
        _ => Ok(ExitStatus::Done),
    }
}
