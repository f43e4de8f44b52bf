//! Results that pages quote: computes what is missing, keeps it in `docs/results/`, draws pictures
//! anew and fills numbers and tables into the pages. `make results` runs it; `--check` computes
//! nothing and fails where a page quotes another number than its results file gives.

mod builds;
mod derived;
mod joint;
mod laboratory;
mod list;
mod make;
mod marks;
mod missed;
mod options;
mod pages;
mod pictures;
mod referee;
mod scan;
mod sources;
mod speed;
mod tables;
#[path = "../programs/tree.rs"]
mod tree;
mod value;

use std::{path::Path, process::ExitCode};

use clap::Parser;

use options::Options;

fn main() -> ExitCode {
    match run(&Options::parse(), tree::root()) {
        Ok(code) => code,
        Err(fault) => {
            eprintln!("error: {fault}");
            ExitCode::from(2)
        }
    }
}

fn run(options: &Options, root: &Path) -> Result<ExitCode, String> {
    if options.list {
        print!("{}", make::list(root)?);
        return Ok(ExitCode::SUCCESS);
    }
    if options.check {
        let faults = pages::faults(root)?;
        for fault in &faults {
            eprintln!("{fault}");
        }
        println!("{} faults", faults.len());
        return Ok(if faults.is_empty() { ExitCode::SUCCESS } else { ExitCode::FAILURE });
    }
    make::built(root, &options.built)?;
    let mut failed = Vec::new();
    let mut is_left = false;
    if !options.fill && options.built.is_empty() {
        let Options { only, older, targets, .. } = options;
        let asked = make::Asked { only: only.clone(), older: *older, targets: *targets };
        let chosen = make::chosen(root, &asked)?;
        for why in &chosen.left {
            println!("{why}");
        }
        is_left = !only.is_empty() && !chosen.left.is_empty();
        let maker = make::Maker { root, out: &options.out, program: &options.program };
        for kept in chosen.to_make {
            // One that fails does not keep the others from being made.
            if let Err(why) = maker.make(kept) {
                eprintln!("error: {why}");
                failed.push(kept.name);
            }
        }
        if options.pictures
            && let Err(why) = maker.pictures()
        {
            eprintln!("error: {why}");
            failed.push("pictures");
        }
    }
    for page in pages::fill(root)? {
        println!("{page}: filled");
    }
    let faults = pages::faults(root)?;
    for fault in &faults {
        eprintln!("{fault}");
    }
    if !failed.is_empty() {
        return Err(format!("not made: {}", failed.join(", ")));
    }
    if is_left {
        return Err("--only: not all that was asked for is made; lines above say why".to_owned());
    }
    Ok(if faults.is_empty() { ExitCode::SUCCESS } else { ExitCode::FAILURE })
}
