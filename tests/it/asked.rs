//! Results of another command, or of another question, are kept, and what is wrong with a question
//! is said before a folder is made.

use std::{fmt::Write, fs, process::Stdio};

use super::{
    export::small_run,
    program::{self, Folder, pluvia, said, text},
    small,
};

/// Runs a command with its results in a folder.
fn done(args: &[&str], out: &str) {
    program::done(&[args, &["--quiet", "--out", out]].concat());
}

fn refused(args: &[&str], out: &str, words: &[&str]) {
    program::refused(&[args, &["--quiet", "--out", out]].concat(), 2, words);
}

/// Law: a table of cases grows, and loses none.
#[test]
fn cases_of_verify_are_added_and_not_lost() {
    let folder = Folder::new();
    let out = folder.out("out");
    let [one, other] = ["spin-slide-0", "spin-slide-25"].map(|case| ["--case", case]);
    let of = |cases: &[[&'static str; 2]]| {
        let cases = cases.iter().flatten().copied();
        ["verify", "--backend", "bullet"].into_iter().chain(cases).collect::<Vec<_>>()
    };
    let table = || folder.text("out/verify.csv");
    done(&of(&[one]), &out);
    let before = table();
    refused(&of(&[other]), &out, &["`cases` lacks `spin-slide-0`", "--out"]);
    assert_eq!(table(), before, "law: nothing was written over");
    done(&of(&[other, one]), &out);
    let (rows, were) = (table().lines().count() - 1, before.lines().count() - 1);
    assert_eq!(rows, 2 * were, "law: a second case, as many rows again");
}

/// A table of a finished sweep of two factors.
fn swept(folder: &Folder) -> String {
    let mut csv =
        "run,point,configuration,a,b,settlement_mm.final,left_out_of_means,failure\n".to_owned();
    for n in 0..25_u32 {
        let (a, b) = (n % 5, n / 5);
        let noise = f64::from((a + 2 * b) % 5) / 10.0;
        let _ = writeln!(csv, "r{n},p{n},1,{a},{b},{},,", f64::from(10 * a) + noise);
    }
    fs::write(folder.path("sweep.csv"), csv).expect("a table");
    folder.out("sweep.csv")
}

/// Law: another range is another question; the same one is answered again.
#[test]
fn targets_are_kept() {
    let folder = Folder::new();
    let (out, runs) = (folder.out("out"), format!("t={}", swept(&folder)));
    let of = |target: &'static str| ["targets", "--runs", &runs, "--target", target];
    let [first, other] = ["t:settlement_mm.final=18..22", "t:settlement_mm.final=18..23"].map(of);
    done(&first, &out);
    let found = folder.bytes("out/targets.json");
    refused(&other, &out, &["target[0].high", "--out"]);
    done(&first, &out);
    assert!(folder.bytes("out/targets.json") == found, "law: the same answer");

    fs::create_dir(folder.path("run")).expect("a folder");
    fs::write(folder.path("run/manifest.json"), "{}").expect("written");
    refused(&first, &folder.out("run"), &["`pluvia run`"]);
}

/// Law: of two sweeps that begin in one folder at the same time, one is planned, and the other is
/// refused.
#[test]
fn two_sweeps_do_not_begin_in_one_folder() {
    let folder = Folder::new();
    let out = folder.out("out");
    let scenario = folder.scenario("small.json", &small::layer(30.0));
    let both = ["seed=1,2", "seed=3,4"].map(|over| {
        let mut command = pluvia();
        command.args(["sweep", &scenario, "--over", over, "--plan-only", "--quiet", "--out", &out]);
        command.stdout(Stdio::null()).stderr(Stdio::piped());
        command.spawn().expect("the program starts")
    });
    let ended = both.map(|child| child.wait_with_output().expect("it ends"));
    let mut codes: Vec<_> = ended.iter().map(|output| output.status.code()).collect();
    codes.sort_unstable();
    assert_eq!(codes, [Some(0), Some(2)], "law: one is planned");
    let refused = ended.iter().find(|output| !output.status.success()).expect("one is refused");
    program::assert_holds(&said(refused), &["another sweep"]);
}

/// Law: what is no sweep leaves nothing in a sweep's folder.
#[test]
fn a_sweep_is_left_alone() {
    let folder = Folder::new();
    let (out, runs) = (folder.out("out"), format!("t={}", swept(&folder)));
    let scenario = folder.scenario("small.json", &small::layer(30.0));
    done(&["sweep", &scenario, "--over", "seed=1,2", "--plan-only"], &out);
    let files = || {
        let entries = fs::read_dir(&out).expect("a folder").flatten();
        let mut names: Vec<_> = entries.map(|entry| entry.file_name()).collect();
        names.sort();
        names
    };
    let before = files();
    let target = "t:settlement_mm.final=18..22";
    for args in [
        &["targets", "--runs", &runs, "--target", target][..],
        &["grains", &scenario],
        &["grains", &scenario, "--force"],
        &["export", text(small_run()), "--format", "csv"],
        &["export", text(small_run()), "--format", "glb", "--force"],
        &["export", text(small_run()), "--format", "vtk"],
        &["verify", "--case", "spin-slide-0"],
        &["run", &scenario],
        &["run", &scenario, "--force"],
    ] {
        refused(args, &out, &["`pluvia sweep`", "another folder"]);
        assert_eq!(files(), before, "law: {args:?} leaves nothing there");
    }
    for out in ["out/runs", "out/runs/point-0001-c1"] {
        let words = ["the runs of a study", "`pluvia sweep`", "another folder"];
        refused(&["run", &scenario, "--force"], &folder.out(out), &words);
        assert_eq!(files(), before, "law: nor is a folder left among its runs");
    }
}

/// Law: the option is named that was typed, and no folder is made for what cannot be.
#[test]
fn a_density_that_cannot_be_found_leaves_nothing() {
    let folder = Folder::new();
    let (scenario, out) = (folder.scenario("small.json", &small::layer(60.0)), folder.out("out"));
    refused(&["density", &scenario, "--seconds", "1.03"], &out, &["--seconds: ", "1.03"]);
    let few = ["density", &scenario, "--set", "grains.total_mass_g=4"];
    refused(&few, &out, &["grains: ", "too few grains", "total_mass_g"]);
    assert!(!folder.path("out").exists(), "law: faults are found before anything is written");
}

/// Law: what does not fit into the paper's programme is reported before a folder is made.
#[test]
fn a_programme_that_cannot_be_run_leaves_nothing() {
    let folder = Folder::new();
    for command in ["reproduce", "interpretations"] {
        let args = [command, "--quick", "--set", "engine.rate_hz=-1"];
        refused(&args, &folder.out("out"), &["engine.rate_hz", "-1"]);
        let is_there = folder.path("out").exists();
        assert!(!is_there, "law: `{command}` finds faults before anything is written");
    }
}
