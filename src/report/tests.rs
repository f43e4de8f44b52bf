//! Figures of made-up runs.

use std::fs;

use super::*;
use crate::record::canned;

#[test]
fn a_run_has_its_own_figures() {
    let out = tempfile::tempdir().expect("a folder");
    let runs = canned::runs();
    let names = |folder: &Path| {
        let mut names: Vec<String> = fs::read_dir(folder)
            .expect("a folder")
            .map(|e| e.expect("an entry").file_name().to_string_lossy().into_owned())
            .collect();
        names.sort();
        names.join(" ")
    };
    let [poured, vibrated] = [out.path().join("p"), out.path().join("v")];
    run_figures(&poured, &runs[0]).expect("figures");
    run_figures(&vibrated, &runs[4]).expect("figures");
    assert_eq!(
        names(&poured),
        "energy.csv energy.png energy.svg heights.csv heights.png heights.svg"
    );
    assert!(names(&vibrated).contains("settlement.svg"), "got {}", names(&vibrated));
}
