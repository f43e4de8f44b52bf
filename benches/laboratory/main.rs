//! The laboratory: standard tests of granular material against published numbers.
//!
//! `make laboratory` runs it; `docs/results/laboratory.md` shows what came of it. Each test is a
//! scenario of `scenarios/validation/` at several points, each in several realisations, run through
//! the store of stages: what is done is not done again.

mod beads;
mod bench;
#[path = "../programs/beside.rs"]
mod beside;
mod column;
mod density;
mod hopper;
mod legend;
mod oedometer;
mod references;
mod relative;
mod repose;
mod row;
mod rows;
mod shear;
mod shear_lines;
#[allow(dead_code, unused_imports)] // its tests are those of tests/it/standard_tests.rs
mod standard_tests;
#[path = "../programs/tree.rs"]
mod tree;
mod triaxial;

use std::{cell::RefCell, path::PathBuf, process::ExitCode};

use clap::{Parser, ValueEnum};
use pluvia::record::create_folder;

use bench::{Bench, Design};
use row::Row;

/// Run the standard tests and compare them with published numbers.
#[derive(Debug, Parser)]
#[command(name = "make laboratory ARGS=...")]
struct Options {
    /// Small specimens, few points, one realisation: about ten minutes on two cores
    #[arg(long, conflicts_with = "small")]
    quick: bool,
    /// Small specimens, fewer realisations: the design of docs/results/laboratory.md
    #[arg(long)]
    small: bool,
    /// Only these tests, with commas between; rows of the others stay in the file
    #[arg(long, value_enum, value_delimiter = ',', default_values_t = Part::value_variants())]
    only: Vec<Part>,
    /// Realisations of each point [default: 5, small 3, quick 1]
    #[arg(long, value_parser = clap::value_parser!(u32).range(1..=100))]
    configurations: Option<u32>,
    /// Stages that run at the same time [default: one per core]
    #[arg(long, value_parser = clap::value_parser!(u32).range(1..=256))]
    jobs: Option<u32>,
    /// File for the rows; runs lie in a folder of its name
    #[arg(long, default_value = "out/laboratory.json")]
    out: PathBuf,
    /// Keep rows and figures in docs/results/ as well, for the pages
    #[arg(long, conflicts_with = "quick")]
    keep: bool,
    /// Run nothing: judge the rows of the file again by the references of today
    #[arg(long, conflicts_with_all = ["quick", "small", "only", "configurations", "jobs", "keep"])]
    judge: bool,
}

/// A standard test.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Part {
    /// Discharge of a flat-bottomed bin
    Hopper,
    /// The same with spheres, of which the usual constants are
    HopperSpheres,
    /// Collapse of a column
    Column,
    /// Angle of repose by three methods
    Repose,
    /// Loosest and densest state
    Density,
    /// The vibration of ASTM D4253, whose steps are many
    D4253,
    /// Direct shear at three stresses
    DirectShear,
    /// Direct shear of steel beads
    Beads,
    /// Compression in an oedometer
    Oedometer,
    /// Triaxial compression of loose and dense specimens
    Triaxial,
}

impl std::fmt::Display for Part {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(self.to_possible_value().expect("none is skipped").get_name())
    }
}

fn main() -> ExitCode {
    match run(&Options::parse()) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("error: {error}");
            ExitCode::FAILURE
        }
    }
}

fn run(options: &Options) -> Result<(), String> {
    if options.judge {
        return judge_again(&options.out);
    }
    let (design, configurations) = match (options.quick, options.small) {
        (true, _) => (Design::Quick, 1),
        (_, true) => (Design::Small, 3),
        _ => (Design::Full, 5),
    };
    let out = beside::folder_of(&options.out)?;
    create_folder(&out).map_err(|e| e.to_string())?;
    let bench = Bench {
        design,
        configurations: options.configurations.unwrap_or(configurations),
        jobs: options.jobs.map_or_else(pluvia::study::available_cores, |jobs| jobs as usize),
        left_out: RefCell::default(),
        shaken: RefCell::new(bench::noted_shaken(&out)?),
        out,
    };
    let kept = tree::root().join("docs/results");
    let kept_file = kept.join("laboratory.json");
    let names = names();
    let mut rows = earlier(&options.out)?;
    let mut kept_rows = if options.keep { earlier(&kept_file)? } else { Vec::new() };
    // Nothing is judged by the beads, which are many, nor by the vibration of the standard, and
    // spheres say little at one realisation: only who asks for them has them quick.
    let is_all = options.only.len() == Part::value_variants().len();
    let are_long = |part: &Part| matches!(part, Part::Beads | Part::HopperSpheres | Part::D4253);
    let is_left_out = |part: &Part| bench.is_quick() && is_all && are_long(part);
    let parts = Part::value_variants().iter().filter(|part| options.only.contains(part));
    for part in parts.filter(|part| !is_left_out(part)) {
        let name = part.to_string();
        let mut found = match part {
            Part::Hopper => hopper::with_angular(&bench),
            Part::HopperSpheres => hopper::with_spheres(&bench),
            Part::Column => column::carry_out(&bench),
            Part::Repose => repose::carry_out(&bench),
            Part::Density => density::carry_out(&bench),
            Part::D4253 => density::vibrate_as_in_the_standard(&bench),
            Part::DirectShear => shear::carry_out(&bench),
            Part::Beads => beads::carry_out(&bench),
            Part::Oedometer => oedometer::carry_out(&bench),
            Part::Triaxial => triaxial::carry_out(&bench),
        }
        .map_err(|e| format!("{part}: {e}"))?;
        if bench.is_quick() {
            found.rows.retain(|row| row.ours.is_some());
        }
        let left_out = bench.left_out.take();
        for row in &mut found.rows {
            bench.design().clone_into(&mut row.design);
            if !left_out.is_empty() {
                row.note += &format!("; left out of this test: {}", left_out.join("; "));
            }
        }
        rows::renew(&mut rows, &name, &found.rows, &names, &options.out)?;
        if options.keep {
            rows::renew(&mut kept_rows, &name, &found.rows, &names, &kept_file)?;
        }
        for chart in found.charts {
            let figure = chart.figure().map_err(|e| e.to_string())?;
            figure.write(&bench.out.join("figures")).map_err(|e| e.to_string())?;
            if options.keep {
                let file = kept.join(format!("laboratory/{}.svg", figure.stem));
                create_folder(&kept.join("laboratory")).map_err(|e| e.to_string())?;
                pluvia::record::write_file(&file, figure.svg.as_bytes())
                    .map_err(|e| e.to_string())?;
            }
        }
        print!("{}", row::table(rows.iter().filter(|row| row.test == name)));
    }
    if options.keep {
        println!("kept in docs/results/; `make results ARGS=--fill` fills the pages");
    }
    println!("all of it in {}", options.out.display());
    Ok(())
}

/// Judges kept rows by the references of today; what they measured stays.
fn judge_again(file: &std::path::Path) -> Result<(), String> {
    let mut rows = earlier(file)?;
    if rows.is_empty() {
        return Err(format!("{} has no rows to judge; run the tests first", file.display()));
    }
    rows.iter_mut().for_each(Row::judge);
    rows::write(&mut rows, &names(), file)?;
    print!("{}", row::table(rows.iter()));
    println!("judged again in {}", file.display());
    Ok(())
}

/// Names of all tests, in the order of their rows.
fn names() -> Vec<String> {
    Part::value_variants().iter().map(Part::to_string).collect()
}

/// Rows of tests that are not run now.
fn earlier(file: &std::path::Path) -> Result<Vec<Row>, String> {
    if !file.exists() {
        return Ok(Vec::new());
    }
    pluvia::record::read_json(file).map_err(|e| format!("{e}; move it away to begin anew"))
}
