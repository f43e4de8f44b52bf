//! Faults of every class: a few cases of each in every test run, and as many as there is time
//! for by `make soak`, which notes what became of each.
//!
//! `PLUVIA_SOAK=MINUTES` makes them, each class for as long as the others; the class that had
//! least time is next. `PLUVIA_SOAK_KILLS` and `PLUVIA_SOAK_INPUTS` give least numbers of kills
//! and inputs, which go on after that time; `PLUVIA_SOAK_ONLY=kills,disk` tries those classes
//! alone; `PLUVIA_SOAK_SEED` draws other random numbers.

mod crafted;
mod disk;
mod durable;
pub mod image;
mod kills;
mod limits;
mod log;
mod matrix;
mod page;
mod power;
mod several;
mod signals;
mod suspended;
mod trials;

use std::{
    env, fs,
    panic::{AssertUnwindSafe, catch_unwind},
    path::PathBuf,
    time::{Duration, Instant},
};

use rand::SeedableRng;
use rand_pcg::Pcg64;
use tempfile::TempDir;

use log::{ENDED, FAULT, KILLED, Log, SKIPPED};

/// What a class needs: a place, random numbers, and where to note what happened.
pub struct Ground {
    folder: TempDir,
    places: u32,
    pub log: Log,
    pub rng: Pcg64,
}

impl Ground {
    /// For a few cases in a test run; what is skipped is said aloud.
    pub fn quick(seed: u64) -> Self {
        Self::with(Log::default(), seed)
    }

    fn with(log: Log, seed: u64) -> Self {
        let folder = tempfile::tempdir().expect("a folder");
        Self { folder, places: 0, log, rng: Pcg64::seed_from_u64(seed) }
    }

    /// Notes what could not be tried, and why.
    pub fn skip(&mut self, class: &str, phase: &str, why: &str) {
        self.log.case(class, phase, &format!("{SKIPPED}{why}"));
    }

    /// A place where nothing is.
    pub fn place(&mut self) -> PathBuf {
        self.places += 1;
        self.folder.path().join(self.places.to_string())
    }
}

/// Faults of a kind.
pub struct Class {
    name: &'static str,
    /// Tries some cases.
    round: fn(&mut Ground),
    /// How often; for ever else.
    rounds: Option<u32>,
}

const fn class(name: &'static str, round: fn(&mut Ground)) -> Class {
    Class { name, round, rounds: None }
}

/// Classes in which processes are killed, by their beginning.
const KILLS: [&str; 2] = ["kills", "durable points"];

/// How the classes of readers begin.
pub const INPUTS: &str = "inputs";

/// What becomes of a good input.
pub const ANSWERED: &str = "read or refused";

static CLASSES: [Class; 14] = [
    class("kills", kills::round),
    class("durable points", durable::round),
    class("inputs", super::fuzz::round),
    class("crafted stores", crafted::round),
    class("several processes", several::round),
    class("disk", disk::round),
    class("limits", limits::round),
    class("signals", signals::round),
    class("suspended", suspended::round),
    class("power cut", power::round),
    class("determinism", matrix::round),
    class("worlds", super::leaks::round),
    Class { name: "power cut without fsync", round: power::control, rounds: Some(3) },
    Class { name: "memory", round: super::memory::round, rounds: Some(1) },
];

fn number(name: &str) -> Option<f64> {
    let given = env::var(name).ok()?;
    Some(given.parse().unwrap_or_else(|_| panic!("{name} is a number, got `{given}`")))
}

/// What is asked of a soak beside its time.
struct Wanted {
    until: Instant,
    kills: u64,
    inputs: u64,
}

impl Wanted {
    /// Whether a class still has something to do.
    fn asks_for(&self, class: &Class, rounds: u32, log: &Log) -> bool {
        if class.rounds.is_some_and(|most| rounds >= most) {
            return false;
        }
        let more = if KILLS.contains(&class.name) {
            KILLS.iter().map(|name| log.sum(name, KILLED)).sum::<u64>() < self.kills
        } else {
            class.name == INPUTS && log.sum(INPUTS, ANSWERED) < self.inputs
        };
        rounds == 0 || more || Instant::now() < self.until
    }
}

/// `make soak`.
#[test]
fn soak() {
    let Some(minutes) = number("PLUVIA_SOAK") else { return };
    let seed = number("PLUVIA_SOAK_SEED").unwrap_or(1.0) as u64;
    let only = env::var("PLUVIA_SOAK_ONLY").ok();
    let only: Option<Vec<&str>> = only.as_ref().map(|names| names.split(',').collect());
    let chosen = |class: &&Class| only.as_ref().is_none_or(|only| only.contains(&class.name));
    let classes: Vec<&Class> = CLASSES.iter().filter(chosen).collect();
    assert!(!classes.is_empty(), "PLUVIA_SOAK_ONLY={only:?} names no class");
    let wanted = Wanted {
        until: Instant::now() + Duration::from_secs_f64(60.0 * minutes),
        kills: number("PLUVIA_SOAK_KILLS").unwrap_or(0.0) as u64,
        inputs: number("PLUVIA_SOAK_INPUTS").unwrap_or(0.0) as u64,
    };
    let file = log::place();
    let mut ground = Ground::with(Log::begin(&file, seed), seed);
    let mut spent = vec![(0, Duration::ZERO); classes.len()];
    loop {
        let asks = |n: &usize| wanted.asks_for(classes[*n], spent[*n].0, &ground.log);
        let Some(next) = (0..classes.len()).filter(asks).min_by_key(|&n| spent[n].1) else {
            break;
        };
        let begun = Instant::now();
        let class = classes[next];
        // One that fails is noted, and the others go on.
        let tried = catch_unwind(AssertUnwindSafe(|| (class.round)(&mut ground)));
        if let Err(what) = tried {
            let text = what.downcast_ref::<String>().map_or("a panic", String::as_str);
            ground.log.case(class.name, "-", &format!("{FAULT}{text}"));
            keep(&mut ground);
        } else {
            ground = clean(ground);
        }
        spent[next].0 += 1;
        spent[next].1 += begun.elapsed();
    }
    for count in ground.log.counts() {
        println!("soak, {}, {}: {}, {}", count.class, count.phase, count.outcome, count.count);
    }
    for name in KILLS {
        println!("soak, {name}: {} kills in all", ground.log.sum(name, KILLED));
    }
    println!("soak, {INPUTS}: {} in all", ground.log.sum(INPUTS, ANSWERED));
    println!("soak: logged in {}", file.display());
    let faults = ground.log.faults();
    assert!(faults.is_empty(), "law: nothing is lost, hangs or panics, got {faults:#?}");
}

/// Keeps the place of a round that failed, and begins another.
fn keep(ground: &mut Ground) {
    let folder = tempfile::tempdir().expect("a folder");
    let kept = std::mem::replace(&mut ground.folder, folder).keep();
    eprintln!("what the round left is in {}", kept.display());
}

/// The same without what a round left.
fn clean(ground: Ground) -> Ground {
    for entry in fs::read_dir(ground.folder.path()).expect("a folder").flatten() {
        let path = entry.path();
        let removed =
            if path.is_dir() { fs::remove_dir_all(&path) } else { fs::remove_file(&path) };
        if let Err(error) = removed {
            eprintln!("{} stays: {error}", path.display());
        }
    }
    ground
}

/// Law: what proves nothing is not counted as what does, and limits of rounds hold.
#[test]
fn a_soak_goes_on_until_it_has_what_is_asked_for() {
    let mut log = Log::default();
    let over = Wanted { until: Instant::now(), kills: 2, inputs: 0 };
    let [kills, inputs] = [&CLASSES[0], &CLASSES[2]];
    assert!(over.asks_for(inputs, 0, &log), "law: each class is tried once");
    assert!(!over.asks_for(inputs, 1, &log), "law: the time is over");
    log.case("kills", "-", KILLED);
    log.case("kills", "-", ENDED);
    assert!(over.asks_for(kills, 9, &log), "law: one kill is not two");
    log.case("durable points", "-", KILLED);
    assert!(!over.asks_for(kills, 9, &log), "law: two kills are there");
    let later = Wanted { until: Instant::now() + Duration::from_secs(60), kills: 0, inputs: 0 };
    let memory = CLASSES.last().expect("classes");
    assert!(later.asks_for(kills, 9, &log) && !later.asks_for(memory, 1, &log), "law: once");
}
