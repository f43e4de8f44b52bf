//! The readers of `fuzz/targets.rs` on the corpora of `fuzz/corpus/` and what
//! becomes of these by mutation: some of each in every test run, and very many
//! by `make soak`. It needs no nightly compiler, and knows
//! nothing of coverage, unlike cargo-fuzz.

#[path = "../../fuzz/targets.rs"]
mod targets;

use std::{
    collections::BTreeSet,
    env, fs,
    panic::{AssertUnwindSafe, catch_unwind},
    path::{Path, PathBuf},
    process::Command,
    time::{Duration, Instant},
};

use rand::{Rng, RngExt, SeedableRng};
use rand_pcg::Pcg64;

use super::{
    program::{page, root, script},
    soak::{ANSWERED, Ground, INPUTS},
};

type Target = (&'static str, fn(&[u8]));

const TARGETS: [Target; 10] = [
    ("scenario", targets::scenario),
    ("mesh", targets::mesh),
    ("specimen", targets::specimen),
    ("grains", targets::grains),
    ("stage", targets::stage),
    ("checkpoint", targets::checkpoint),
    ("manifest", targets::manifest),
    ("design", targets::design),
    ("plan", targets::plan),
    ("request", targets::request),
];

/// No input may take longer, whatever the machine does beside.
const LONGEST: Duration = Duration::from_secs(20);

/// Pieces that formats give a meaning to.
const TOKENS: [&[u8]; 24] = [
    b"0",
    b"-1",
    b"1e308",
    b"1e-320",
    b"NaN",
    b"inf",
    b"null",
    b"[]",
    b"{}",
    b"\"\"",
    b",",
    b":",
    b"\n",
    b"v 0 0 0\n",
    b"f 1 2 3\n",
    b"solid",
    b"endfacet",
    b"element face 4294967295\n",
    b"end_header\n",
    b"\xff\xff\xff\xff",
    b"\0\0\0\0",
    b"extends",
    b"\xc0\x7f\0\0",
    b"PLUVFRM1",
];

fn corpus(target: &str) -> Vec<Vec<u8>> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("fuzz/corpus").join(target);
    let mut files: Vec<PathBuf> =
        fs::read_dir(&folder).expect("a corpus").flatten().map(|e| e.path()).collect();
    files.sort();
    files.iter().map(|file| fs::read(file).expect("a file")).collect()
}

/// One of the corpus, changed at a few places.
fn mutated(corpus: &[Vec<u8>], rng: &mut impl Rng) -> Vec<u8> {
    let pick = |rng: &mut dyn Rng| &corpus[rng.random_range(0..corpus.len())];
    let mut data = pick(rng).clone();
    for _ in 0..rng.random_range(1..6) {
        let at = rng.random_range(0..=data.len());
        let end = (at + rng.random_range(1..32)).min(data.len());
        match rng.random_range(0..7) {
            0 if at < data.len() => data[at] ^= 1 << rng.random_range(0..8),
            1 if at < data.len() => data[at] = rng.random(),
            2 => drop(data.drain(at..end)),
            3 => {
                let piece = data[at..end].to_vec();
                data.splice(at..at, piece);
            }
            4 => {
                let token = TOKENS[rng.random_range(0..TOKENS.len())];
                data.splice(at..end.min(at + token.len()), token.iter().copied());
            }
            5 => {
                let other = pick(rng);
                let from = rng.random_range(0..=other.len());
                let to = (from + rng.random_range(1..64)).min(other.len());
                data.splice(at..at, other[from..to].iter().copied());
            }
            _ => data.truncate(at),
        }
    }
    data.truncate(1 << 16);
    data
}

/// Feeds one input; one that fails is kept, so that it can be fed again.
fn feed((name, target): Target, data: &[u8]) {
    let started = Instant::now();
    let survived = catch_unwind(AssertUnwindSafe(|| target(data))).is_ok();
    let took = started.elapsed();
    if !survived || took > LONGEST {
        let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("fuzz");
        fs::create_dir_all(&folder).expect("a folder");
        let file = folder.join(format!("{name}-{}", pluvia::record::hash_bytes(data)));
        fs::write(&file, data).expect("written");
        panic!(
            "law: any bytes are read or refused, and soon; {} bytes for `{name}` were {} after \
             {took:?}; they are in {}",
            data.len(),
            if survived { "answered" } else { "not answered" },
            file.display()
        );
    }
}

#[test]
fn corpora_are_read_or_refused() {
    for target in TARGETS {
        let corpus = corpus(target.0);
        assert!(corpus.len() >= 3, "law: {} has something to begin with", target.0);
        corpus.iter().for_each(|data| feed(target, data));
    }
}

/// Mutations of each corpus in every test run.
const FEW: usize = 300;

#[test]
fn a_few_mutations_of_them_are_too() {
    for target in TARGETS {
        let (corpus, mut rng) = (corpus(target.0), Pcg64::seed_from_u64(3));
        // The same ones on every machine, however fast.
        for _ in 0..FEW {
            feed(target, &mutated(&corpus, &mut rng));
        }
    }
}

/// Most inputs of a reader in a round: quick ones must not make up the numbers of slow ones.
const MOST: u64 = 2000;

/// `make soak`: mutations for every reader, for half a second or [`MOST`] of them.
pub fn round(ground: &mut Ground) {
    for target in TARGETS {
        let (corpus, begun) = (corpus(target.0), Instant::now());
        let mut fed = 0;
        while fed < MOST && begun.elapsed() < Duration::from_millis(500) {
            feed(target, &mutated(&corpus, &mut ground.rng));
            fed += 1;
        }
        ground.log.cases(INPUTS, target.0, ANSWERED, fed);
    }
}

/// Law: what fuzzing begins with is sound, or mutations of it would all be refused at once. (Of
/// `grains` any bytes are.)
#[test]
fn corpora_hold_inputs_that_are_read() {
    type Reads = fn(&[u8]) -> bool;
    let readers: [(&str, Reads, usize); 9] = [
        // Poured, shaken, a pile, grains from meshes, and two that were found.
        ("scenario", targets::reads_scenario, 6),
        // OBJ, STL as text and binary, PLY as text and binary.
        ("mesh", targets::reads_mesh, 6),
        // A state, grains and frames.
        ("specimen", targets::reads_specimen, 3),
        ("stage", targets::reads_stage, 4),
        ("checkpoint", targets::reads_checkpoint, 3),
        ("manifest", targets::reads_manifest, 2),
        ("design", targets::reads_design, 3),
        ("plan", targets::reads_plan, 3),
        ("request", targets::reads_request, 2),
    ];
    for (name, reads, expected) in readers {
        let read = corpus(name).iter().filter(|data| reads(data)).count();
        assert!(read >= expected, "law: {expected} of {name} are read, got {read}");
        assert!(!reads(b"\0"), "law: what is none is not");
    }
}

/// Law: what cargo builds, the files of that, and the corpora are of the targets that are tested here.
/// `make fuzz` asks cargo for its list.
#[test]
fn targets_are_the_same_everywhere() {
    let manifest = page("fuzz/Cargo.toml");
    let field = |of: &str, start: &str| {
        let found = of.lines().find_map(|line| line.strip_prefix(start)?.strip_suffix('"'));
        found.unwrap_or_else(|| panic!("law: a target has `{start}`, got {of}")).to_owned()
    };
    let built = manifest.split("[[bin]]").skip(1);
    let built: BTreeSet<String> = built
        .map(|of| {
            let (name, path) = (field(of, "name = \""), field(of, "path = \""));
            assert_eq!(path, format!("fuzz_targets/{name}.rs"), "law: the file of {name}");
            name
        })
        .collect();
    let names_in = |folder: &str| -> BTreeSet<String> {
        let entries = fs::read_dir(root().join(folder)).expect("a folder");
        let paths = entries.map(|entry| entry.expect("an entry").path());
        paths.filter_map(|path| Some(path.file_stem()?.to_string_lossy().into_owned())).collect()
    };
    let expected: BTreeSet<String> = TARGETS.iter().map(|(name, _)| (*name).to_owned()).collect();
    for (what, got) in [
        ("[[bin]] of fuzz/Cargo.toml", built),
        ("files of fuzz/fuzz_targets/", names_in("fuzz/fuzz_targets")),
        ("folders of fuzz/corpus/", names_in("fuzz/corpus")),
    ] {
        assert_eq!(got, expected, "law: {what} (left) are the targets of tests/it/fuzz.rs (right)");
    }
}

#[test]
fn an_input_that_fails_is_kept() {
    let target: Target = ("test", |data| assert_ne!(data, b"bad"));
    feed(target, b"good");
    let said = catch_unwind(|| feed(target, b"bad")).expect_err("law: a panic is noticed");
    let said = said.downcast_ref::<String>().expect("a message");
    let file = said.rsplit(' ').next().expect("a file");
    assert_eq!(fs::read(file).expect("kept"), b"bad", "law: the input is kept");
    fs::remove_file(file).expect("removed");
}

/// Law: `make fuzz` has the readers that are fed here, and fails where libFuzzer tried no input.
#[test]
fn a_reader_counts_as_fuzzed_only_where_inputs_were_tried() {
    let number = "stat::number_of_executed_units:";
    for (said, expected) in
        [(format!("{number} 12"), true), (format!("{number} 0"), false), ("Done".into(), false)]
    {
        let folder = tempfile::tempdir().expect("a folder");
        let at = |name: &str| folder.path().join(name);
        for name in ["scripts", "fuzz", "bin"] {
            fs::create_dir(at(name)).expect("a folder");
        }
        fs::copy(root().join("scripts/fuzz.sh"), at("scripts/fuzz.sh")).expect("copied");
        fs::write(at("Cargo.lock"), "").expect("written");
        script(&at("bin/cargo"), &format!("#!/bin/sh\necho '{said}'\n"));
        let path = env::var("PATH").expect("a path");
        let output = Command::new("bash")
            .arg(at("scripts/fuzz.sh"))
            .args(["1", "mesh"])
            .env("PATH", format!("{}:{path}", at("bin").display()))
            .output()
            .expect("bash");
        let text = String::from_utf8_lossy(&[output.stdout, output.stderr].concat()).into_owned();
        let got = output.status.success();
        assert_eq!(got, expected, "law: {said}: expected {expected}, got {got}: {text}");
    }
}
