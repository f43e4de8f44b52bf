//! What `make results` is asked.

use std::path::PathBuf;

use clap::Parser;

/// Results that pages quote, from the files of docs/results/.
#[derive(Debug, Parser)]
#[command(name = "make results ARGS=...")]
pub struct Options {
    /// List results, with the command, the build and whether the files are there
    #[arg(long, conflicts_with_all = ["fill", "only", "older", "targets", "pictures"])]
    pub list: bool,
    /// Compare pages and files; compute and write nothing
    #[arg(long,
          conflicts_with_all = ["list", "fill", "only", "older", "targets", "built", "pictures"])]
    pub check: bool,
    /// Fill the pages; compute nothing
    #[arg(long, conflicts_with_all = ["only", "older", "targets", "pictures"])]
    pub fill: bool,
    /// Compute these anew, with commas between, also where their files are there; make targets are
    /// called
    #[arg(long, value_delimiter = ',', value_name = "NAME,NAME")]
    pub only: Vec<String>,
    /// Compute also what is of an older build
    #[arg(long, conflicts_with = "only")]
    pub older: bool,
    /// Call also make targets, which take long
    #[arg(long, conflicts_with = "only")]
    pub targets: bool,
    /// Record that these are of this build, with commas between, and fill the pages; compute
    /// nothing
    #[arg(long, value_delimiter = ',', value_name = "NAME,NAME",
          conflicts_with_all = ["list", "only", "older", "targets", "pictures"])]
    pub built: Vec<String>,
    /// Draw the pictures of docs/pictures/ anew that a command of the tree makes
    #[arg(long)]
    pub pictures: bool,
    /// Where runs are kept; the same command resumes them
    #[arg(long, default_value = "out/results", value_name = "DIR")]
    pub out: PathBuf,
    /// The program that computes
    #[arg(long, default_value = "target/release/pluvia", value_name = "FILE")]
    pub program: PathBuf,
}
