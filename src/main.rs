//! The `pluvia` program.

use std::process::ExitCode;

fn main() -> ExitCode {
    pluvia::cli::main()
}
