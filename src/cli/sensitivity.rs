//! `pluvia sensitivity`.

use std::path::PathBuf;

use clap::Args;

use super::{CliError, Context, ExitStatus, designed::DesignedArgs, last_line, output_folder};
use crate::plain::plain_path;
use crate::record::read_file;
use crate::study::SensitivityStudy;

/// Vary each choice that the paper does not give by itself, and rank what it moves
#[derive(Debug, Args)]
#[command(after_help = "\
Varies one parameter at a time around the default, over the range that the design gives
(scenarios/studies/sensitivity.json is built in), each in several configurations. Leaves
sensitivity.md, sensitivity.csv, sensitivity.json, figures/, variations.csv, variation-runs.csv,
variations.json and runs/ in DIR. What is already done there is not done again.

Examples:
  pluvia sensitivity --quick --out out/sensitivity-quick
  pluvia sensitivity --configurations 5 --jobs 4 --out out/sensitivity
  pluvia sensitivity --design my-design.json --out out/mine")]
pub(super) struct SensitivityArgs {
    #[command(flatten)]
    designed: DesignedArgs,
    /// Folder for the results; it is made if needed
    #[arg(long, value_name = "DIR", default_value = "out/sensitivity")]
    out: PathBuf,
}

pub(super) fn run(args: &SensitivityArgs, context: &Context) -> Result<ExitStatus, CliError> {
    let options = args.designed.options(&args.out, context);
    let study = SensitivityStudy::read(&options)?;
    output_folder::prepare(&args.out)?;
    context.stop_on_ctrl_c();
    let found = study.carry_out(&options.run)?;
    let page = args.out.join("sensitivity.md");
    let text = String::from_utf8_lossy(&read_file(&page)?).into_owned();
    let tables = text.split("\n## Ranges").next().unwrap_or_default();
    let lines = tables.lines().filter(|l| !l.starts_with("!["));
    let tables: String = lines.map(|l| format!("{l}\n")).collect();
    let text = format!("{tables}\nall of it in {}\n", plain_path(&page));
    let (left_out, with_result) = found.left_out();
    context.print(&(text + &last_line::of_study(left_out, with_result)), &found)?;
    Ok(ExitStatus::Done)
}
