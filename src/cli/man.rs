//! `pluvia man` writes the manual pages, from the same descriptions as `--help`.

use clap::{Command, CommandFactory};
use clap_mangen::Man;
use clap_mangen::roff::{Roff, roman};

use super::*;

/// Write the manual pages
#[derive(Debug, Args)]
#[command(after_help = "\
Without --out the page of pluvia itself goes to the standard output; with it, that page and one of
every subcommand go into DIR, as pluvia.1, pluvia-run.1 and so on.

Examples:
  pluvia man | man -l -
  pluvia man --out ~/.local/share/man/man1    # then: man pluvia-export")]
pub(super) struct ManArgs {
    /// Folder for the pages, created if needed
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
}

pub(super) fn run(args: &ManArgs, context: &Context) -> Result<ExitStatus, CliError> {
    let Some(out) = &args.out else {
        let (_, page) = page(program())?;
        write_all(&mut io::stdout().lock(), &page)?;
        return Ok(ExitStatus::Done);
    };
    output_folder::prepare(out)?;
    let mut files = Vec::new();
    for (name, page) in pages()? {
        let path = out.join(name);
        write_file(&path, &page)?;
        files.push(path);
    }
    let text: String = files.iter().map(|file| format!("{}\n", plain_path(file))).collect();
    let files: Vec<_> = files.iter().map(|file| file.to_string_lossy()).collect();
    context.done(&text, &files)
}

/// The whole command, with the names under which its subcommands are called.
fn program() -> Command {
    let mut command = Cli::command().disable_help_subcommand(true);
    command.build();
    command
}

/// Name of the file and text of a page. What stands below the options in
/// `--help` comes last, line by line as it is there.
fn page(command: Command) -> io::Result<(String, Vec<u8>)> {
    let notes = command.get_after_help().map(ToString::to_string).unwrap_or_default();
    let man = Man::new(command.after_help(None::<&'static str>));
    let mut text = Vec::new();
    man.render(&mut text)?;
    let mut below = Roff::new();
    below.control("SH", ["NOTES"]).control("nf", []);
    for line in notes.lines() {
        below.text([roman(line)]);
    }
    below.control("fi", []);
    text.extend(below.to_roff().into_bytes());
    Ok((man.get_filename(), text))
}

/// The page of the program and those of its subcommands.
fn pages() -> io::Result<Vec<(String, Vec<u8>)>> {
    with_all_below(program()).into_iter().map(page).collect()
}

/// A command, its subcommands and theirs.
fn with_all_below(command: Command) -> Vec<Command> {
    let below: Vec<Command> = command.get_subcommands().cloned().flat_map(with_all_below).collect();
    std::iter::once(command).chain(below).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_subcommand_has_a_page_with_its_options_and_examples() {
        let pages = pages().expect("pages");
        let commands = with_all_below(program());
        assert_eq!(pages.len(), commands.len(), "law: a page a subcommand, and the program's");
        for command in &commands {
            let name = format!("{}.1", command.get_display_name().unwrap_or("pluvia"));
            let found = pages.iter().find(|(file, _)| *file == name);
            let (_, text) = found.unwrap_or_else(|| panic!("no page {name}"));
            let text = String::from_utf8(text.clone()).expect("text").replace('\\', "");
            assert!(text.contains("pluvia"), "{name} names the program");
            assert!(text.contains("Example"), "{name} shows an example");
            let options = command.get_arguments().filter_map(|a| a.get_long());
            for option in options.filter(|o| *o != "help") {
                assert!(text.contains(&format!("--{option}")), "{name} explains --{option}");
            }
        }
    }
}
