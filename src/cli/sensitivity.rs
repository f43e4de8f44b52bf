//! `pluvia sensitivity` varies each choice that the paper leaves open, one at a time, and ranks
//! the effects.

use super::*;
use crate::study::sensitivity;

/// Vary each choice that the paper leaves open, one at a time, and rank the effects
#[derive(Debug, Args)]
#[command(after_help = "\
Varies one parameter at a time around the default, over the range that the design gives
(scenarios/studies/sensitivity.json is built in), each in several realisations. Leaves
sensitivity.md, sensitivity.csv, sensitivity.json, figures/, variations.csv, variation-runs.csv,
variations.json and runs/ in DIR. Finished stages there are reused.

Examples:
  pluvia sensitivity --quick --out out/sensitivity-quick
  pluvia sensitivity --configurations 5 --jobs 4 --out out/sensitivity
  pluvia sensitivity --design my-design.json --out out/mine")]
pub(super) struct SensitivityArgs {
    #[command(flatten)]
    designed: DesignedArgs,
    /// Folder for the results, created if needed
    #[arg(long, value_name = "DIR", default_value = "out/sensitivity")]
    out: PathBuf,
}

pub(super) fn run(args: &SensitivityArgs, context: &Context) -> Result<ExitStatus, CliError> {
    let run = context.run_options(&args.out, args.designed.jobs);
    let study = sensitivity(&args.designed.options())?;
    carry_out(study, &run, context, |found| {
        let page = page_until(&args.out.join("sensitivity.md"), &["\n## Ranges"])?;
        let lines = page.lines().filter(|line| !line.starts_with("!["));
        let text: String = lines.map(|line| format!("{line}\n")).collect();
        context.done(&(text + &last_line::of_study((found.left_out, found.with_result))), found)
    })
}
