//! Disks that are full, folders that are read-only, in the way or gone: one
//! message that names the file and what is kept, exit code 4, and the same
//! command goes on when there is room again.

use std::{
    fs,
    path::{Path, PathBuf},
    process::{Command, Output, Stdio},
};

use super::{
    interruption::{
        copy, finished, pluvia, prepared, stages, stored, wait_for_stages, with_results,
    },
    program::{self, assert_holds, said, text},
    same::assert_same_files,
    soak::image::Mounted,
};

/// Runs the program under a limit of the size of any file, in blocks of 1 KiB:
/// what it writes beyond is refused, as on a full disk.
fn limited(scenario: &Path, out: &Path, blocks: u32) -> Output {
    let script = format!("trap '' XFSZ; ulimit -f {blocks}; exec \"$0\" \"$@\"");
    let mut command = Command::new("bash");
    command.arg("-c").arg(script).arg(env!("CARGO_BIN_EXE_pluvia")).arg("run");
    command.arg(scenario).arg("--out").arg(out).arg("--quiet");
    command.output().expect("bash starts")
}

/// Exit code 4 and one line that holds all the words; gives the line.
fn refused(output: &Output, words: &[&str]) -> String {
    let said = said(output);
    assert_eq!(output.status.code(), Some(4), "law: exit code 4 for files, got: {said}");
    assert_eq!(said.trim().lines().count(), 1, "law: one message, got: {said}");
    assert!(!said.contains("panicked"), "law: no panic, got: {said}");
    assert_holds(&said, words);
    said
}

/// Runs it whole.
fn run(scenario: &Path, out: &Path) -> Output {
    pluvia(scenario, out).stderr(Stdio::piped()).output().expect("the program starts")
}

#[test]
#[ignore = "slow: make test-all"]
fn a_full_disk_ends_a_run_that_goes_on_when_there_is_room() {
    let (folder, scenario) = prepared();
    let (whole, full) = (finished(), folder.path().join("full"));
    // Too little for the grains; for the pictures.
    let largest = |name: &str| fs::metadata(whole.join(name)).expect("a file").len() / 1024;
    let grains = u32::try_from(largest("grains.json")).expect("small");
    refused(&limited(&scenario, &full, grains / 2), &["cannot write", "grains.json", "too large"]);
    let said = refused(&limited(&scenario, &full, grains + 2), &["cannot write", "figures"]);
    assert!(stages(&full) == 5, "law: what was finished before is there, after: {said}");
    assert!(run(&scenario, &full).status.success(), "law: with room it goes on");
    assert_same_files(whole, &full, "a disk that was full twice");
}

#[test]
fn a_disk_that_fills_up_between_stages_keeps_them() {
    let (folder, scenario) = prepared();
    let Some(mounted) = Mounted::tmpfs(&folder.path().join("small"), 180) else {
        return program::skipped("a small disk", "no file system can be mounted");
    };
    let out = folder.path().join("small/out");
    let output = run(&scenario, &out);
    let said = refused(&output, &["No space left on device", "finished stage"]);
    let kept = stages(&out);
    // Asserts that nobody holds a file there.
    mounted.unmount();
    assert!((1..5).contains(&kept), "law: some stages fit into 180 KiB, got {kept}; {said}");
}

#[test]
fn what_is_in_the_way_is_named() {
    let (folder, scenario) = prepared();
    for blocked in ["", "stages", "stages/.lock", "figures", "summary.json", "grains.json"] {
        let out = folder.path().join(format!("out-{}", blocked.replace('/', "-")));
        let place = if blocked.is_empty() { out.clone() } else { out.join(blocked) };
        if blocked == "figures" || blocked == "summary.json" {
            // Only this is to be done again.
            copy(&finished().join("stages"), &out.join("stages"));
        }
        fs::create_dir_all(place.parent().expect("a folder")).expect("made");
        // A file where a folder is to be made, a folder where a file is.
        if blocked.contains('.') {
            fs::create_dir_all(place.join("inside")).expect("made");
        } else {
            fs::write(&place, "").expect("made");
        }
        let name = place.file_name().map_or("", |n| n.to_str().expect("UTF-8"));
        let named = if name == ".lock" { "stages" } else { name };
        refused(&run(&scenario, &out), &["cannot", named]);
    }
}

#[test]
fn a_folder_that_cannot_be_written_into_is_told_at_once() {
    use std::os::unix::fs::PermissionsExt;
    let (folder, scenario) = prepared();
    let closed = folder.path().join("closed");
    fs::create_dir(&closed).expect("a folder");
    fs::set_permissions(&closed, fs::Permissions::from_mode(0o555)).expect("closed");
    // Whoever may do everything is not held up by permissions; /proc holds up everybody.
    let all_powerful = fs::write(closed.join("probe"), "").is_ok();
    let place = if all_powerful { PathBuf::from("/proc/pluvia") } else { closed.join("out") };
    let words = ["cannot create the folder", text(&place)];
    refused(&run(&scenario, &place), &words);
}

#[test]
fn a_folder_that_is_removed_under_way_is_told() {
    let (folder, scenario) = prepared();
    let out = folder.path().join("out");
    let mut command = pluvia(&scenario, &out);
    command.stderr(Stdio::piped());
    let run = command.spawn().expect("started");
    wait_for_stages(&out, 1);
    // Files may come while the folder is being emptied.
    while fs::remove_dir_all(&out).is_err() && out.exists() {}
    let output = run.wait_with_output().expect("ended");
    refused(&output, &["cannot", "out"]);
}

#[test]
fn standard_output_that_is_full_is_told() {
    let full = fs::File::options().write(true).open("/dev/full");
    let Ok(full) = full else {
        return program::skipped("a full standard output", "there is no /dev/full");
    };
    let output = program::pluvia().args(["info", "--json"]).stdout(full).output();
    refused(&output.expect("it starts"), &["standard output", "No space left"]);
}

/// Damage to what a finished run has in store.
type Damage = fn(&Path);

#[test]
fn a_damaged_stage_is_told_and_done_again() {
    let (_folder, scenario, hurt) = with_results();
    let damages: [(&str, Damage); 3] = [
        ("frames.bin", |file| {
            let length = fs::metadata(file).expect("a file").len();
            let open = fs::File::options().write(true).open(file).expect("opened");
            open.set_len(length - 7).expect("cut off");
        }),
        ("specimen.json", |file| {
            let content = fs::read_to_string(file).expect("a file");
            fs::write(file, content.replacen("0.0", "0.1", 1)).expect("changed");
        }),
        ("stage.json", |file| {
            let content = fs::read_to_string(file).expect("a file");
            fs::write(file, content.replacen("\"steps\": ", "\"steps\": 1", 1)).expect("changed");
        }),
    ];
    for ((name, damage), stage) in damages.iter().zip(stored(&hurt)) {
        damage(&stage.join(name));
    }
    let (code, _, said) = program::run(&["run", text(&scenario), "--out", text(&hurt)]);
    assert_eq!(code, Some(0), "law: damage does not end a run, got {said}");
    for (name, _) in damages {
        let told = said.lines().any(|l| l.contains("damaged and done again") && l.contains(name));
        assert!(told, "law: `{name}` is reported, got {said}");
    }
    assert_same_files(finished(), &hurt, "three damaged stages");
}
