//! How commands run studies, and options of those whose design is in a file.

use super::*;
use crate::study::{Study, StudyOptions};

/// Carries a study out in its folder, unless this holds other results ([`asked::begin`]). `end`
/// prints what was found and says whether it is what was expected; until then the command is at
/// work there.
pub(super) fn carry_out<T>(
    study: Study<T>,
    run: &RunOptions,
    context: &Context,
    end: impl FnOnce(&T) -> Result<ExitStatus, CliError>,
) -> Result<ExitStatus, CliError> {
    let _at_work = asked::begin(&run.out, study.command, &study.question)?;
    context.stop_on_ctrl_c();
    let found = study.carry_out(run)?;
    end(&found)
}

/// What `converge` and `sensitivity` ask for.
#[derive(Debug, Args)]
pub(super) struct DesignedArgs {
    /// A few hundred grains instead of 1456, and fewer variations if the design says so
    #[arg(long)]
    quick: bool,
    /// Number of realisations, each a new random arrangement of the same grains
    /// [default: the design's]
    #[arg(long, value_name = "N", value_parser = whole(1_u32, 1000), allow_negative_numbers = true)]
    configurations: Option<u32>,
    #[command(flatten)]
    pub(super) jobs: Jobs,
    /// A design of your own in place of the built-in one
    #[arg(long, value_name = "FILE")]
    design: Option<PathBuf>,
}

impl DesignedArgs {
    /// As options of a study.
    pub(super) fn options(&self) -> StudyOptions {
        let Self { quick, configurations, design, .. } = self;
        StudyOptions { design: design.clone(), quick: *quick, configurations: *configurations }
    }
}

/// The page of a study for a terminal: its tables, up to the first of the headings that is there;
/// what comes after them is for the file.
pub(super) fn page_until(page: &Path, headings: &[&str]) -> Result<String, FileError> {
    let text = String::from_utf8_lossy(&read_file(page)?).into_owned();
    let end = headings.iter().find_map(|heading| text.find(heading)).unwrap_or(text.len());
    Ok(format!("{}\nfull results in {}\n", &text[..end], plain_path(page)))
}
