//! How the cost of a step grows with the number of grains in one specimen, how it falls with
//! threads, and where it goes: 364 and 1456 grains poured and settled, 10 000 and 100 000 made
//! of copies (`specimens.rs`), at rest, shaken and, of the first two, poured; two worlds at once,
//! which show what two cores of the machine can give; and shaken where threads have to share
//! cores. Writes `out/bench.json`.
//!
//! `make bench` runs it; `--quick` leaves out 100 000 grains and measures less often. What it says
//! on making a specimen tells whether that has come to rest: 10 000 grains of copies had not.

#[allow(dead_code)] // each benchmark uses a part of it
#[path = "../common/mod.rs"]
mod common;
mod laboratory;
mod measured;
mod process;
mod rows;
mod specimens;

use std::{
    path::{Path, PathBuf},
    process::ExitCode,
    time::Instant,
};

use clap::{Parser, ValueEnum};
use pluvia::record::create_folder;

use measured::State;
use process::MEASURE;
use rows::{Kind, Row};
use specimens::{SIZES, copies, poured};

/// Folder for the specimens that one process hands to another.
const WORKSHOP: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/target/growth");

/// Worlds at once, and threads of each: one world, and two that share nothing but the machine.
const WORLDS: [(usize, u32); 3] = [(1, 1), (1, 2), (2, 1)];

/// Grains of the largest specimen that is measured in two worlds at once: twice the largest does
/// not fit into every machine.
const MOST_AT_ONCE: usize = 10_000;

/// Grains of the largest specimen with `--quick`.
const MOST_QUICK: usize = 10_000;

/// How often worlds of as many grains are measured: the larger, the longer a round takes, and
/// the less a moment's work of another program counts in it.
fn rounds(size: usize, quick: bool) -> usize {
    let rounds = match size {
        ..5_000 => 3,
        5_000..50_000 => 2,
        _ => 1,
    };
    if quick { rounds - 1 } else { rounds }
}

/// The growth of a step's cost with the number of grains.
#[derive(Debug, Parser)]
#[command(name = "make bench ARGS=...")]
struct Options {
    /// Without the largest specimen, and with fewer rounds
    #[arg(long)]
    quick: bool,
    /// Only these states, with commas between
    #[arg(long, value_enum, value_delimiter = ',', default_values_t = State::value_variants())]
    states: Vec<State>,
    /// No more grains than this
    #[arg(long, default_value_t = usize::MAX)]
    most_grains: usize,
    /// File for the results
    #[arg(long, default_value = "out/bench.json")]
    out: PathBuf,
    /// Cargo says so to every benchmark
    #[arg(long, hide = true)]
    bench: bool,
}

/// What is measured, and the best of it so far.
struct Case {
    file: PathBuf,
    size: usize,
    kind: Kind,
    row: Option<Row>,
}

fn main() -> ExitCode {
    let mut args = std::env::args().skip(1);
    if args.next().as_deref() == Some(MEASURE) {
        laboratory::measure(&args.collect::<Vec<_>>());
        return ExitCode::SUCCESS;
    }
    let options = Options::parse();
    let mut cases = cases(&options);
    // Other programs on the machine make single times longer by tens of percent. A world that
    // begins alike does the same in every step: all are measured in turns, and of each step
    // and phase the shortest time counts.
    for round in 0..rounds(0, options.quick) {
        for case in cases.iter_mut().filter(|case| round < rounds(case.size, options.quick)) {
            eprintln!("round {}, {} grains, {} ...", round + 1, case.size, case.kind);
            measure(case);
        }
    }
    let mut rows: Vec<Row> = cases.into_iter().filter_map(|case| case.row).collect();
    rows::compare(&mut rows);
    print!("{}", rows::table(&rows));
    if let Err(why) = rows::write(&rows, &options.out) {
        eprintln!("error: {why}");
        return ExitCode::FAILURE;
    }
    println!("results in {}", options.out.display());
    ExitCode::SUCCESS
}

/// Makes the specimens, and says what of each is measured.
fn cases(options: &Options) -> Vec<Case> {
    let workshop = Path::new(WORKSHOP);
    create_folder(workshop).expect("a folder for specimens");
    let mut cases = Vec::new();
    let mut add = |size: usize, file: &Path, states: &[State]| {
        let wanted = states.iter().filter(|state| options.states.contains(state));
        let kinds = wanted.flat_map(|&state| {
            let kind = |(specimens, threads)| Kind { state, specimens, threads };
            WORLDS.map(kind)
        });
        let kinds = kinds.filter(|&kind| is_measured(kind, size));
        cases.extend(kinds.map(|kind| Case { file: file.to_owned(), size, kind, row: None }));
    };
    let mut whole = None;
    let most = if options.quick { MOST_QUICK } else { usize::MAX }.min(options.most_grains);
    for size in SIZES.into_iter().filter(|size| *size <= most) {
        eprintln!("making {size} grains ...");
        let begun = Instant::now();
        let file = workshop.join(format!("{size}.json"));
        let stored = if size <= SIZES[1] {
            let (full, settled) = poured(size);
            let full_file = workshop.join(format!("{size}-full.json"));
            full.write(&full_file);
            add(size, &full_file, &[State::Pour]);
            settled
        } else {
            let (of, radius) = whole.as_ref().expect("poured before");
            copies(of, *radius, size)
        };
        eprintln!(
            "    {:.0} s, root mean square speed {:.2} mm/s",
            begun.elapsed().as_secs_f64(),
            stored.rms_speed()
        );
        stored.write(&file);
        add(size, &file, &[State::Rest, State::Shaken]);
        if size == SIZES[1] {
            add(size, &file, &[State::ShakenBusy, State::ShakenOneCore]);
            whole = Some((stored.specimen(), specimens::setup(size).cylinder.radius));
        }
    }
    cases
}

/// Whether a kind is measured with as many grains.
fn is_measured(kind: Kind, size: usize) -> bool {
    let is_apart = matches!(kind.state, State::Rest | State::Shaken | State::Pour);
    kind.specimens == 1 || is_apart && size <= MOST_AT_ONCE
}

fn measure(case: &mut Case) {
    let Kind { state, specimens, threads } = case.kind;
    let measured = match specimens {
        1 => process::alone(&case.file, state, threads),
        _ => process::at_once(specimens, &case.file, state, threads),
    };
    let measured = match measured {
        Ok(measured) => measured,
        Err(why) => {
            println!("{}: not measured: {why}", case.kind);
            return;
        }
    };
    let row = Row::new(case.kind, measured);
    case.row = Some(match case.row.take() {
        None => row,
        Some(before) => before.better(row),
    });
}
