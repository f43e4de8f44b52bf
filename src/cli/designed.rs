//! Options of studies whose design is in a file.

use super::*;
use crate::study::{StudyOptions, Varied};

/// What both studies ask for.
#[derive(Debug, Args)]
pub(super) struct DesignedArgs {
    /// A few hundred grains instead of 1456, and fewer variations if the design says so
    #[arg(long)]
    quick: bool,
    /// Number of configurations, each a new random arrangement of the same grains
    /// [default: the design's]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=1000))]
    configurations: Option<u32>,
    #[command(flatten)]
    jobs: Jobs,
    /// A design of your own in place of the built-in one
    #[arg(long, value_name = "FILE")]
    design: Option<PathBuf>,
}

impl DesignedArgs {
    /// As options of a study that leaves its results in a folder.
    pub(super) fn options(&self, out: &Path, context: &Context) -> StudyOptions {
        StudyOptions {
            design: self.design.clone(),
            quick: self.quick,
            configurations: self.configurations,
            run: context.run_options(out, self.jobs),
        }
    }
}

/// What a study of variations is asked: the scenario, and what varies it how often.
pub(super) fn question_of(varied: &Varied, configurations: u32) -> Value {
    let texts = |changes: &[Override]| -> Value { changes.iter().map(Override::text).collect() };
    let changes = varied.all.iter().map(|(of, _)| (of.name.clone(), texts(&of.changes)));
    let variations: Value = changes.collect();
    json!({
        "scenario": asked::scenario(&varied.base),
        (asked::AT_LEAST): { "configurations": configurations, "variations": variations },
    })
}

/// The page of a study for a terminal: its tables, up to the first of the headings that is there;
/// what comes after them is for the file.
pub(super) fn page_until(page: &Path, headings: &[&str]) -> Result<String, FileError> {
    let text = String::from_utf8_lossy(&read_file(page)?).into_owned();
    let end = headings.iter().find_map(|heading| text.find(heading)).unwrap_or(text.len());
    Ok(format!("{}\nfull results in {}\n", &text[..end], plain_path(page)))
}
