//! `pluvia completions` prints a script that lets a shell complete commands and options.

use clap::CommandFactory;
use clap_complete::{Shell, generate};

use super::*;

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

pub(super) fn run(args: &CompletionsArgs, _: &Context) -> Result<ExitStatus, CliError> {
    let mut script = Vec::new();
    generate(args.shell, &mut Cli::command(), "pluvia", &mut script);
    write_all(&mut io::stdout().lock(), &script)?;
    Ok(ExitStatus::Done)
}
