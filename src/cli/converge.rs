//! `pluvia converge` refines the engine's settings step by step and finds the cheapest
//! that is fine enough.

use super::*;
use crate::study::converge;

/// Refine the engine's settings step by step, and find the cheapest that is fine enough
#[derive(Debug, Args)]
#[command(after_help = "\
Varies time step, solver tolerance, sub-steps, contact stiffness and contact solver as the design
says (scenarios/studies/convergence.json is built in), each setting in several realisations. Leaves
convergence.md, convergence.csv, convergence.json, figures/, variations.csv, variation-runs.csv,
variations.json and runs/ in DIR. Finished stages there are reused. Precision is that of the build;
results of the same design in DIR from a build in the other precision are included.

Examples:
  pluvia converge --quick --out out/convergence-quick
  pluvia converge --configurations 3 --jobs 4 --out out/convergence
  pluvia converge --design my-design.json --out out/mine")]
pub(super) struct ConvergeArgs {
    #[command(flatten)]
    designed: DesignedArgs,
    /// Folder for the results, created if needed
    #[arg(long, value_name = "DIR", default_value = "out/convergence")]
    out: PathBuf,
}

pub(super) fn run(args: &ConvergeArgs, context: &Context) -> Result<ExitStatus, CliError> {
    let run = context.run_options(&args.out, args.designed.jobs);
    let study = converge(&args.designed.options())?;
    carry_out(study, &run, context, |found| {
        let text = page_until(&args.out.join("convergence.md"), &["\n## How to read it"])?;
        context.done(&(text + &last_line::of_study(found.left_out())), found)
    })
}
