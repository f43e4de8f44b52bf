//! `pluvia verify` compares the engines with analytical solutions.

use super::*;
use crate::verify::{SuiteOptions, builtin, run_suite, settings};

/// Compare the engines with analytical solutions
#[derive(Debug, Args)]
#[command(after_help = "\
Leaves verify.json, verify.csv, report.html with a figure per case, and figures/ in DIR. What an
engine is known to miss is shown as a known failure with its reason; exit code 1 means that a case
has an unexpected outcome.

Examples:
  pluvia verify --out out/verify
  pluvia verify --backend bullet --case incline-holds --case rebound --out out/two-cases")]
pub(super) struct VerifyArgs {
    /// Only this engine [default: all that are built in]
    #[arg(long, value_name = "B", value_parser = backend)]
    backend: Option<Backend>,
    /// Only this setting, by its name in the table (repeatable)
    #[arg(long, value_name = "NAME")]
    setting: Vec<String>,
    /// Only this case (repeatable)
    #[arg(long, value_name = "ID")]
    case: Vec<String>,
    /// Experiments at the same time [default: the number of cores]
    #[arg(long, value_name = "N", value_parser = whole(1_u16, 1024), allow_negative_numbers = true)]
    jobs: Option<u16>,
    /// Folder for the results, created if needed
    #[arg(long, value_name = "DIR", default_value = "out/verify")]
    out: PathBuf,
}

/// Keeps what was named; names that nothing has are an error that lists those there are.
fn choose<T>(
    what: &str,
    all: Vec<T>,
    named: &[String],
    name: impl Fn(&T) -> &str,
) -> Result<Vec<T>, CliError> {
    let known: Vec<String> = all.iter().map(|t| name(t).to_owned()).collect();
    let missing: Vec<&str> =
        named.iter().filter(|n| !known.contains(n)).map(String::as_str).collect();
    if !missing.is_empty() {
        return Err(CliError::Usage(format!(
            "there is no {what} {}; there are: {}",
            missing.join(", "),
            known.join(", ")
        )));
    }
    Ok(all.into_iter().filter(|t| named.is_empty() || named.iter().any(|n| n == name(t))).collect())
}

pub(super) fn run(args: &VerifyArgs, context: &Context) -> Result<ExitStatus, CliError> {
    let cases = choose("case", builtin()?, &args.case, |c| &c.id)?;
    let offered = settings()
        .into_iter()
        .filter(|s| args.backend.is_none_or(|b| s.engine.backend == b))
        .collect();
    let settings = choose("setting", offered, &args.setting, |s| &s.name)?;
    let ids: Vec<&str> = cases.iter().map(|case| case.id.as_str()).collect();
    let names: Vec<&str> = settings.iter().map(|setting| setting.name.as_str()).collect();
    let question = json!({ (AT_LEAST): { "cases": ids, "settings": names } });
    let _at_work = asked::begin(&args.out, "verify", &question)?;
    context.stop_without_stages();
    let options = SuiteOptions {
        cases,
        settings,
        out: Some(args.out.clone()),
        jobs: cores_for(args.jobs),
        cancel: context.cancel.clone(),
        progress: context.progress.clone(),
    };
    let verdicts = run_suite(&options, &world::create)?;
    let mut text = table::of_verdicts(&verdicts);
    text += &format!("report in {}\n", plain_path(&args.out.join("report.html")));
    context.print(&text, &verdicts)?;
    Ok(ExitStatus::by(verdicts.iter().all(|verdict| verdict.status.as_expected())))
}
