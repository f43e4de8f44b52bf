//! `scripts/joint.sh`, with a program in place of Pluvia that computes nothing.

use std::{
    fs,
    path::Path,
    process::{Command, Output},
};

use super::program::{assert_holds, root, said, script};

/// Says its build, leaves a table of two points with two piles each, one of which is left out, and
/// the targets that it was asked for.
const PROGRAM: &str = r#"#!/bin/sh
command=$1
asked=$*
while [ $# -gt 0 ]; do
    [ "$1" = --out ] && out=$2
    shift
done
case $command in
info) printf '{\n  "cores": 2,\n  "stage_format": %s\n}\n' "$FORMAT" ;;
sweep)
    mkdir -p "$out"
    printf '%s\n' "$asked" > "$out/asked"
    cat > "$out/sweep.csv" <<TABLE
run,point,configuration,contact.grain_grain_friction,grains.cells.relaxation_steps,angle_of_repose.degrees,valid,left_out_of_means,failure
point-0001-c1,point-0001,1,0.3,2,36.5,true,,
point-0002-c1,point-0002,1,0.8,1,44,true,,
point-0001-c2,point-0001,2,0.3,2,40.5,true,,
point-0002-c2,point-0002,2,0.8,1,60,false,"checks NOT passed, overlap",
TABLE
    ;;
targets)
    mkdir -p "$out"
    printf '%s\n' "$asked" > "$out/targets.json"
    ;;
esac
"#;

fn joint(folder: &Path, format: &str, batches: &str) -> Output {
    Command::new("bash")
        .arg("scripts/joint.sh")
        .args([folder.join("out"), folder.join("tables")])
        .arg(batches)
        .current_dir(root())
        .env("PLUVIA", folder.join("program"))
        .env("FORMAT", format)
        .output()
        .expect("bash starts")
}

/// Law: the angle of a point is the mean of its piles that count, and friction goes from below the
/// 0.33 that calibration finds; rows of two builds are not pooled, and the refusal names them.
#[test]
fn rows_of_two_builds_are_not_pooled() {
    let folder = tempfile::tempdir().expect("a folder");
    script(&folder.path().join("program"), PROGRAM);
    let read = |file: &str| fs::read_to_string(folder.path().join(file)).expect("it is there");
    let first = joint(folder.path(), "18", "1");
    assert!(first.status.success(), "law: an empty folder: {}", said(&first));
    assert_eq!(
        read("tables/pile-1.csv"),
        "run,point,configuration,contact.grain_grain_friction,grains.cells.relaxation_steps,\
         angle_of_repose.degrees,piles\n\
         point-0001-c1,point-0001,1,0.3,2,38.500000,2\n\
         point-0002-c1,point-0002,1,0.8,1,44.000000,1\n",
        "law: means of 36.5 and 40.5, and of 44 alone"
    );
    let asked = read("out/pile-1/asked");
    let words = ["contact.grain_grain_friction=0.25..0.9", "--configurations 4", "--seed 1"];
    assert_holds(&asked, &words);
    assert_eq!(
        read("tables/builds.csv"),
        "table,format\npile-1,18\ncontinuous-1,18\nintermittent-1,18\n",
        "law: each table has its build"
    );
    let again = joint(folder.path(), "19", "1");
    assert!(again.status.success(), "law: tables of one build are pooled: {}", said(&again));
    assert!(!read("tables/targets.json").contains("builds.csv"), "law: and these alone");

    let more = joint(folder.path(), "19", "2");
    assert!(!more.status.success(), "law: rows of two builds are refused");
    let words = ["format 18: ", "pile-1.csv", "format 19: ", "pile-2.csv, to be made"];
    assert_holds(&said(&more), &words);
    assert!(!folder.path().join("out/pile-2").exists(), "law: before anything is computed");

    fs::remove_file(folder.path().join("tables/builds.csv")).expect("removed");
    let unknown = joint(folder.path(), "18", "1");
    assert!(!unknown.status.success(), "law: rows of builds that nobody knows are refused");
}
