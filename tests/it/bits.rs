//! The same bits, release after release: hashes of a tiny run, and the rule for
//! changing them (ARCHITECTURE.md, "Same input, same bits").
//!
//! `PLUVIA_WRITE=1` adds or replaces this machine's hashes in `bits.json`.

use std::{collections::BTreeMap, fs, path::Path};

use serde_json::Value;

use super::{interruption::finished, program::skipped};

/// Hashes by platform and file.
type Stored = BTreeMap<String, BTreeMap<String, String>>;

/// What the bits may depend on: processor, engine, its precision.
fn platform() -> String {
    let info = pluvia::world::info(pluvia::scenario::Backend::Bullet);
    let (arch, os) = (std::env::consts::ARCH, std::env::consts::OS);
    format!("{arch}-{os}, {} {}, {}", info.name, info.version, info.precision)
}

/// The hashes of the run, stage by stage.
fn hashes(out: &Path) -> BTreeMap<String, String> {
    let manifest = fs::read(out.join("manifest.json")).expect("a manifest");
    let manifest: Value = serde_json::from_slice(&manifest).expect("JSON");
    let mut hashes = BTreeMap::new();
    let stages = manifest["stages"].as_array().expect("stages");
    for (number, stage) in stages.iter().chain([&manifest["rest_test"]]).enumerate() {
        for what in ["specimen_sha256", "series_sha256"] {
            let hash = stage[what].as_str().expect("a hash").to_owned();
            let name = stage["stage"].as_str().expect("a name");
            hashes.insert(format!("{number} {name} {what}"), hash);
        }
    }
    let grains = manifest["files_sha256"]["grains.json"].as_str().expect("a hash").to_owned();
    hashes.insert("grains.json".to_owned(), grains);
    hashes
}

#[test]
fn a_tiny_run_has_the_stored_hashes() {
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/it/bits.json");
    let text = fs::read_to_string(&file).unwrap_or_else(|_| "{}".to_owned());
    let mut stored: Stored = serde_json::from_str(&text).expect("bits.json");
    let got = hashes(finished());
    let here = platform();
    if std::env::var_os("PLUVIA_WRITE").is_some() {
        stored.insert(here.clone(), got.clone());
        let text = serde_json::to_string_pretty(&stored).expect("JSON") + "\n";
        fs::write(&file, text).expect("written");
    }
    assert!(!stored.is_empty(), "law: some platform has stored hashes");
    let Some(expected) = stored.get(&here) else {
        let why = format!("no hashes are stored for {here}; this run has {got:#?}");
        return skipped("that the bits are those of before", &why);
    };
    assert_eq!(
        &got, expected,
        "law: the same bits as before on {here}; if they are meant to change, see \
         ARCHITECTURE.md, \"Same input, same bits\""
    );
}
