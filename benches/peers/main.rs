//! The same specimens in Pluvia, stock Bullet and other engines: what a second
//! of simulated time costs, and what the grains look like afterwards.
//!
//! `make bench-peers` runs it; `docs/peers.md` says how each engine is set and
//! why. Each engine runs in a process of its own, one after the other, and
//! writes its poses; all are measured here by the same exact check.

mod asked;
#[allow(dead_code)] // each benchmark uses a part of it
#[path = "../common/mod.rs"]
mod common;
mod engines;
mod handed;
mod measured;
mod ours;
mod specimens;
mod table;
#[path = "../programs/tree.rs"]
mod tree;
mod verdict;

use std::{
    path::{Path, PathBuf},
    process::ExitCode,
};

use clap::{Parser, ValueEnum};
use pluvia::record::{create_folder, read_json, write_json};

use asked::positive;
use engines::{Engine, Job};
use measured::{Row, measure};
use specimens::Size;

/// Folder for what peers are built into and for the scenes they read.
fn workshop() -> PathBuf {
    tree::root().join("target/peers")
}

/// Compare engines on the same grains.
#[derive(Debug, Parser)]
#[command(name = "make bench-peers ARGS=...")]
struct Options {
    /// How many grains: a quarter of the paper's specimen (364) or all of it (1456)
    #[arg(long, value_enum, default_value_t = Size::Whole)]
    grains: Size,
    /// Only these engines, with commas between
    #[arg(long, value_delimiter = ',')]
    only: Vec<String>,
    /// Only these scenes, with commas between
    #[arg(long, value_enum, value_delimiter = ',', default_values_t = SceneName::value_variants())]
    scenes: Vec<SceneName>,
    /// Simulated time of every scene in s; else 2 s of rest, 1 s of the others
    #[arg(long, value_parser = positive)]
    simulated_s: Option<f64>,
    /// Wall time in s after which an engine stops stepping and is judged by
    /// what it managed; of one that never gets through, a minute
    #[arg(long, default_value_t = 600.0, value_parser = positive)]
    limit_s: f64,
    /// Another rate than each engine's own, for trying out
    #[arg(long, value_parser = positive)]
    rate_hz: Option<f64>,
    /// Other iterations than each engine's own, for trying out
    #[arg(long)]
    iterations: Option<u32>,
    /// Take the specimens that the last run with as many grains made
    #[arg(long)]
    reuse: bool,
    /// File for the results
    #[arg(long, default_value = "out/peers.json")]
    out: PathBuf,
}

/// What the grains go through.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum SceneName {
    /// A settled packing left alone
    Rest,
    /// The same on the shaking table, 3 Hz and ±25 mm
    Shaken,
    /// The lid just removed from the filled funnel
    Pour,
}

impl SceneName {
    /// Simulated time in s. Numerical creep is that of the second half of `rest`.
    fn duration(self) -> f64 {
        if self == Self::Rest { 2.0 } else { 1.0 }
    }
}

impl std::fmt::Display for SceneName {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(self.to_possible_value().expect("none is skipped").get_name())
    }
}

fn main() -> ExitCode {
    let mut args = std::env::args().skip(1);
    let outcome = if args.next().as_deref() == Some(ours::CARRY) {
        ours::carry(&args.collect::<Vec<_>>())
    } else {
        compare(&Options::parse())
    };
    match outcome {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("error: {error}");
            ExitCode::FAILURE
        }
    }
}

fn compare(options: &Options) -> Result<(), String> {
    let engines = chosen(options)?;
    asked::prepare(&options.out)?;
    let workshop = workshop();
    create_folder(&workshop).map_err(|e| e.to_string())?;
    let (ready, unready) = prepare(engines);
    let scenes = scenes(options, &workshop)?;
    let mut rows: Vec<Row> = Vec::new();
    let mut notes = unready;
    for engine in &ready {
        for (name, file) in scenes.iter().filter(|(name, _)| options.scenes.contains(name)) {
            let job = Job {
                scene: file.clone(),
                result: workshop.join(format!("{}-{name}.json", engine.name)),
                rate_hz: options.rate_hz.unwrap_or(engine.rate_hz),
                iterations: options.iterations.or(engine.iterations),
                seconds: options.simulated_s.unwrap_or(name.duration()),
                limit_s: options.limit_s.min(engine.patience_s),
            };
            eprintln!("{}, {name} ...", engine.name);
            let scene = read_json(file).map_err(|e| e.to_string())?;
            let result = engine.carry_out(&job);
            let rest = rows.iter().find(|r| r.engine == engine.name && r.scene == "rest");
            let creep = rest.and_then(|r| r.creep_um_per_s);
            let measured = measure(engine, *name, &job, &scene, result, creep);
            eprintln!("    {}", table::line(&measured.row));
            let told = measured.notes.into_iter();
            notes.extend(told.map(|note| format!("{}, {name}: {note}", engine.name)));
            rows.push(measured.row);
        }
    }
    write_json(&options.out, &rows).map_err(|e| e.to_string())?;
    print!("{}", table::of(&rows));
    for note in notes {
        println!("{note}");
    }
    println!("results in {}", options.out.display());
    Ok(())
}

fn chosen(options: &Options) -> Result<Vec<Engine>, String> {
    let all = engines::all();
    let names: Vec<&str> = all.iter().map(|e| e.name).collect();
    if let Some(unknown) = options.only.iter().find(|n| !names.contains(&n.as_str())) {
        return Err(format!("--only {unknown}: there are {}", names.join(", ")));
    }
    let wanted = |e: &Engine| options.only.is_empty() || options.only.iter().any(|n| n == e.name);
    Ok(all.into_iter().filter(wanted).collect())
}

/// The engines that are or could be installed, and why the others could not.
fn prepare(engines: Vec<Engine>) -> (Vec<Engine>, Vec<String>) {
    let mut unready = Vec::new();
    let mut ready = Vec::new();
    for engine in engines {
        match engine.prepare() {
            Ok(()) => ready.push(engine),
            Err(why) => {
                eprintln!("{} is left out: {why}", engine.name);
                unready.push(format!("{} is left out: {why}", engine.name));
            }
        }
    }
    (ready, unready)
}

/// The scenes' files, made anew or taken from the last run.
fn scenes(options: &Options, workshop: &Path) -> Result<Vec<(SceneName, PathBuf)>, String> {
    let size = options.grains;
    let file = |name: SceneName| workshop.join(format!("{size}-{name}-scene.json"));
    let files: Vec<_> = SceneName::value_variants().iter().map(|n| (*n, file(*n))).collect();
    if options.reuse && files.iter().all(|(_, file)| file.exists()) {
        return Ok(files);
    }
    eprintln!("making the specimens ...");
    let made = specimens::make(size)?;
    for ((name, file), scene) in files.iter().zip([&made.rest, &made.shaken, &made.pour]) {
        write_json(file, scene).map_err(|e| format!("{name}: {e}"))?;
    }
    Ok(files)
}
