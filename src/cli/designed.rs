//! Options of studies whose design is in a file.

use std::path::PathBuf;

use clap::Args;

use super::{Context, jobs::Jobs};
use crate::study::{RunOptions, StudyOptions};

/// What both studies ask for.
#[derive(Debug, Args)]
pub(super) struct DesignedArgs {
    /// A few hundred grains instead of 1456, and what the design leaves out for it
    #[arg(long)]
    quick: bool,
    /// Number of configurations, each the same grains mixed anew [default: the design's]
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
    pub(super) fn options(&self, out: &std::path::Path, context: &Context) -> StudyOptions {
        StudyOptions {
            design: self.design.clone(),
            quick: self.quick,
            configurations: self.configurations,
            run: RunOptions {
                out: out.to_owned(),
                jobs: self.jobs.cores(),
                frames: false,
                cancel: context.cancel.clone(),
                progress: context.progress.clone(),
            },
        }
    }
}
