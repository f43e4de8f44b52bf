//! The program `pluvia`; `pluvia --help` says what it can do.

use std::process::ExitCode;

fn main() -> ExitCode {
    pluvia::cli::main()
}
