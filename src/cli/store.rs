//! `pluvia store` checks the stored stages of an output folder.

use super::*;
use crate::record::{StoreReport, StoredItem, StoredState, check_store, refuse_no_folder};

/// Manage the stored stages of an output folder
#[derive(Debug, Args)]
#[command(after_help = "\
Example:
  pluvia store check out/first")]
pub(super) struct StoreArgs {
    #[command(subcommand)]
    action: StoreAction,
}

#[derive(Debug, Subcommand)]
enum StoreAction {
    Check(CheckArgs),
}

/// Check every stored stage and checkpoint
#[derive(Debug, Args)]
#[command(after_help = "\
Reads a whole store and changes nothing. Checks of every stage that it is complete, that its files
have the recorded hashes, that it is the stage that its folder names, that it continues the stored
stage before it, also where that is another run's, and that it has as many bodies as grains; the
same of checkpoints. Lists what is half written. A damaged stage is never used: the command that
needs it reports it and runs it again.

Exit codes: 0 nothing is damaged; 1 something is; 2 DIR holds no store; 4 it is not there, or could
not be read.

Examples:
  pluvia store check out/first
  pluvia store check out/reproduce/stages --json")]
struct CheckArgs {
    /// Output folder of a command, or its folder stages/
    #[arg(value_name = "DIR")]
    folder: PathBuf,
}

pub(super) fn run(args: &StoreArgs, context: &Context) -> Result<ExitStatus, CliError> {
    let StoreAction::Check(args) = &args.action;
    let report = check_store(&store_in(&args.folder)?)?;
    context.print(&text(&report), &report)?;
    Ok(ExitStatus::by(report.damaged == 0))
}

/// The store of an output folder, or the folder itself where that is one.
fn store_in(folder: &Path) -> Result<PathBuf, CliError> {
    refuse_no_folder(folder)?;
    let below = folder.join("stages");
    if below.is_dir() {
        return Ok(below);
    }
    // A folder that may not be looked into may hold one.
    let is_store = folder.join(".lock").try_exists().map_err(|e| FileError::unread(folder, &e))?;
    if folder.is_dir() && !is_store {
        return Err(CliError::Usage(format!(
            "{}: there is no store; give the output folder of a command, with its stages/",
            plain_path(folder)
        )));
    }
    Ok(folder.to_owned())
}

fn text(report: &StoreReport) -> String {
    let mut text = format!("store {}\n", plain_path(&report.store));
    for (title, items) in [
        ("stages", &report.stages),
        ("checkpoints", &report.checkpoints),
        ("half written", &report.unfinished),
    ] {
        if items.is_empty() {
            continue;
        }
        text += &format!("\n{title}\n");
        let head = ["name", "stage", "grains", "after", "state"].map(str::to_owned);
        let rows: Vec<[String; 5]> = std::iter::once(head).chain(items.iter().map(row)).collect();
        text += &table::columns(&rows);
        for item in items {
            if let Some(note) = &item.note {
                text += &format!("  {}: {}\n", plain(&item.name), plain(note));
            }
        }
    }
    let whole = report.stages.iter().filter(|i| i.state == StoredState::Whole).count();
    let verdict = match report.damaged {
        0 => paint::good("nothing is damaged"),
        n => paint::bad(format!("{n} damaged")),
    };
    let stages = counted(report.stages.len(), "stage");
    text += &format!("\n{whole} of {stages} whole, {verdict}\n");
    text
}

fn row(item: &StoredItem) -> [String; 5] {
    let nothing = || "-".to_owned();
    let state = match item.state {
        StoredState::Whole => paint::good("whole"),
        StoredState::Damaged => paint::bad("DAMAGED"),
        StoredState::Earlier => paint::notable("of an earlier version, not used any more"),
        StoredState::Expected => paint::faint("not stored yet"),
        StoredState::BeingWritten => paint::notable("being written"),
        StoredState::Abandoned => paint::notable("abandoned, the next command removes it"),
    };
    [
        plain(&item.name).into_owned(),
        item.stage.as_ref().map_or_else(nothing, |stage| plain(stage).into_owned()),
        item.grains.map_or_else(nothing, |n| n.to_string()),
        item.parent.as_ref().map_or_else(nothing, |key| {
            plain(&key.chars().take(12).collect::<String>()).into_owned()
        }),
        state,
    ]
}
