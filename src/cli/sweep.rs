//! `pluvia sweep` runs a scenario at many values of its fields and puts the results into one table.

use super::*;
use crate::plain::in_shell;
use crate::report::Sweep;
use crate::study::{
    Design, Factor, SNAKEFILE, SampledRange, SlurmJob, SlurmRequest, SweepOptions, SweepStudy,
    submit_to_slurm, this_program, write_snakefile,
};

/// Run a scenario at many values of its fields and put the results into one table
#[derive(Debug, Args)]
#[command(after_help = "\
--over gives a field its values; several make a grid of all combinations, or with --one-at-a-time
each field is varied by itself around the scenario. --samples latin-hypercube:N draws N points from
the ranges of --range. --configurations alone gives means of the scenario as it is. Leaves
plan.json, sweep.csv (one row per run), sweep.json, sweep.md, report.html, figures/ and runs/ in
DIR. Finished stages there are reused; the same command with more --configurations adds to it. A run
that fails is a row with the reason.
--design varies the parameters of a sensitivity design, one at a time, and leaves sensitivity.md,
sensitivity.csv and sensitivity.json as well, as every sweep does that varies one thing at a time.
--slurm submits what is not stored yet to a cluster, --snakemake writes a Snakefile; --status and
--collect need only --out.

Examples:
  pluvia sweep scenarios/quick/pluviation.json --over contact.grain_grain_friction=0.4,0.6,0.8 \\
      --over stages.1.falling_height_mm=0,50,200 --configurations 3 --out out/sweep
  pluvia sweep scenarios/quick/vibration.json --one-at-a-time --configurations 3 \\
      --over contact.grain_wall_friction=0.3,0.7 --over contact.restitution=0.1,0.5
  pluvia sweep scenarios/quick/pluviation.json --samples latin-hypercube:20 \\
      --range contact.grain_grain_friction=0.3..0.9 --range contact.restitution=0.1..0.6
  pluvia sweep scenarios/quick/pluviation.json --over contact.restitution=0.1,0.3,0.5 \\
      --configurations 10 --slurm --time 00:30:00 --out out/cluster
  pluvia sweep --status --out out/cluster
  pluvia sweep --design scenarios/studies/sensitivity.json --quick --out out/sensitivity
  pluvia sweep scenarios/quick/pluviation.json --over contact.restitution=0.1,0.3,0.5 \\
      --snakemake --out out/flow")]
pub(super) struct SweepArgs {
    /// The scenario file
    #[arg(value_name = "SCENARIO.json", required_unless_present_any = ["design", "status", "collect"])]
    scenario: Option<PathBuf>,
    /// A field of the scenario and its values (repeatable)
    #[arg(long, value_name = "path=v1,v2,...")]
    over: Vec<Factor>,
    /// Vary each field by itself around the scenario, in place of all combinations
    #[arg(long, conflicts_with = "samples")]
    one_at_a_time: bool,
    /// Draw N points that cover each range evenly
    #[arg(long, value_name = "latin-hypercube:N", value_parser = samples, requires = "range")]
    samples: Option<usize>,
    /// A number of the scenario and the range from which it is drawn (repeatable)
    #[arg(long, value_name = "path=low..high", requires = "samples")]
    range: Vec<SampledRange>,
    /// A design as `pluvia sensitivity` reads it, in place of scenario and fields
    #[arg(long, value_name = "FILE",
          conflicts_with_all = ["scenario", "over", "one_at_a_time", "samples", "range"])]
    design: Option<PathBuf>,
    /// The smaller specimen of the design
    #[arg(long, requires = "design")]
    quick: bool,
    /// Realisations per point, each a new random arrangement of the same grains; the same at
    /// every point [default: 1, or the design's]
    #[arg(long, value_name = "N", value_parser = whole(1_u32, 1000), allow_negative_numbers = true)]
    configurations: Option<u32>,
    /// Only write plan.json, which lists every run
    #[arg(long)]
    plan_only: bool,
    /// Only write plan.json and a Snakefile that runs it
    #[arg(long, conflicts_with_all = ["status", "collect", "jobs"])]
    snakemake: bool,
    /// Print the progress of the sweep in DIR
    #[arg(long, conflicts_with_all = OF_A_PLAN, conflicts_with = "collect")]
    status: bool,
    /// Collect the stored results of the sweep in DIR without running anything
    #[arg(long, conflicts_with_all = OF_A_PLAN)]
    collect: bool,
    #[command(flatten)]
    slurm: SlurmArgs,
    #[command(flatten)]
    changes: Changes,
    #[command(flatten)]
    jobs: Jobs,
    /// Folder for the results, created if needed
    #[arg(long, value_name = "DIR", default_value = "out/sweep")]
    out: PathBuf,
}

/// Options that say what is planned: of a sweep that is there the plan says it.
const OF_A_PLAN: [&str; 12] = [
    "scenario",
    "over",
    "one_at_a_time",
    "samples",
    "range",
    "design",
    "quick",
    "configurations",
    "plan_only",
    "backend",
    "seed",
    "set",
];

/// What jobs ask of a cluster.
#[derive(Debug, Args)]
struct SlurmArgs {
    /// Submit the stages as Slurm job arrays; only what is not stored yet
    #[arg(long, conflicts_with_all = ["plan_only", "snakemake", "status", "collect", "jobs"])]
    slurm: bool,
    #[command(flatten)]
    request: SlurmRequest,
}

fn samples(text: &str) -> Result<usize, String> {
    let count = text.strip_prefix("latin-hypercube:").and_then(|n| n.parse().ok());
    count
        .filter(|n| (2..=10_000).contains(n))
        .ok_or_else(|| format!("`{text}` is not latin-hypercube:N with N from 2 to 10000"))
}

pub(super) fn run(args: &SweepArgs, context: &Context) -> Result<ExitStatus, CliError> {
    let run = context.run_options(&args.out, args.jobs);
    if args.status {
        return status(&SweepTasks::read(run)?, context);
    }
    if args.collect {
        return tell(args, &SweepTasks::read(run)?.collect()?, context);
    }
    let study = SweepStudy::new(options(args)?)?;
    if !(args.plan_only || args.snakemake || args.slurm.slurm) {
        return carry_out(study.study(), &run, context, |found| tell(args, found, context));
    }
    let _at_work = asked::begin(&args.out, "sweep", &asked::ANYTHING)?;
    let plan = study.write_plan(&run)?;
    if args.slurm.slurm {
        return on_slurm(&args.slurm.request, &SweepTasks::read(run)?, context);
    }
    let runs = counted(plan.runs.len(), "run");
    let mut text = format!("{runs} planned in {}\n", plain_path(&args.out));
    if args.snakemake {
        write_snakefile(&SweepTasks::read(run)?, &this_program()?)?;
        let file = args.out.join(SNAKEFILE).display().to_string();
        text += &format!("snakemake --cores 2 --snakefile {}\n", in_shell(&file));
    }
    context.done(&text, &json!({ "runs": plan.runs.len() }))
}

fn options(args: &SweepArgs) -> Result<SweepOptions, CliError> {
    let changes = args.changes.overrides()?;
    if let Some(design) = &args.design {
        return Ok(SweepOptions::of_design(design, args.quick, &changes, args.configurations)?);
    }
    let several = args.configurations.is_some_and(|count| count > 1) && !args.one_at_a_time;
    if args.over.is_empty() && args.samples.is_none() && !several {
        let text = "nothing is varied; allowed are --over <path=v1,v2,...>, --samples \
                    <latin-hypercube:N> with --range <path=low..high>, --design <FILE>, or \
                    --configurations of at least 2 for realisations of the scenario as it is";
        return Err(CliError::Usage(text.to_owned()));
    }
    let Some(scenario) = args.scenario.clone() else {
        return Err(CliError::Usage("no scenario is given".to_owned()));
    };
    Ok(SweepOptions {
        scenario,
        changes,
        over: args.over.clone(),
        parameters: Vec::new(),
        quick: false,
        ranges: args.range.clone(),
        design: match args.samples {
            Some(count) => Design::LatinHypercube(count),
            None if args.one_at_a_time => Design::OneAtATime,
            None => Design::Grid,
        },
        configurations: args.configurations.unwrap_or(1),
        folder: PathBuf::new(),
    })
}

fn on_slurm(
    request: &SlurmRequest,
    tasks: &SweepTasks,
    context: &Context,
) -> Result<ExitStatus, CliError> {
    let jobs = submit_to_slurm(tasks, &this_program()?, request)?;
    let line = |job: &SlurmJob| match job.level {
        Some(level) => {
            format!("job {}: {} of level {level}\n", job.id, counted(job.tasks, "stage"))
        }
        None => format!("job {}: collects the results when all have ended\n", job.id),
    };
    context.done(&jobs.iter().map(line).collect::<String>(), &jobs)
}

fn status(tasks: &SweepTasks, context: &Context) -> Result<ExitStatus, CliError> {
    let status = tasks.status();
    let mut text = format!(
        "{} of {} stored, {} of {} complete\n",
        status.stored,
        counted(status.stages, "stage"),
        status.complete,
        counted(status.runs, "run")
    );
    for (stage, why) in &status.failed {
        text += &format!("failed: {stage}: {why}\n");
    }
    context.done_asked(&text, &status)
}

/// Prints what was found.
fn tell(args: &SweepArgs, found: &Sweep, context: &Context) -> Result<ExitStatus, CliError> {
    let mut text =
        page_until(&args.out.join("sweep.md"), &["\n## Figures", "\n## How to read it"])?;
    let with_result = found.runs.len() - found.failed().count();
    text += &last_line::of_study((found.left_out().count(), with_result));
    context.print(&text, found)?;
    Ok(ExitStatus::by(with_result > 0))
}
