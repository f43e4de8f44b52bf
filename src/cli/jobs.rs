//! How many cores a command may use.

use std::thread::available_parallelism;

use clap::Args;

#[derive(Debug, Clone, Copy, Args)]
pub(super) struct Jobs {
    /// Cores to use: so many stages run at the same time or, where fewer are left, on several
    /// threads each; results do not depend on it [default: all cores]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024))]
    jobs: Option<u16>,
}

impl Jobs {
    pub(super) fn cores(self) -> usize {
        self.jobs.map_or_else(cores, usize::from)
    }
}

/// The processors that this process may use: by its affinity mask and its control group's quota.
pub(super) fn cores() -> usize {
    available_parallelism().map_or(1, usize::from)
}
