//! Inputs without end, systems that give no threads, and requests to stop: each ends soon,
//! with one message and the exit code that fits.

use std::{
    fs,
    path::Path,
    process::{Command, Output, Stdio},
    thread,
    time::Duration,
};

use serde_json::{Value, json};

use super::{
    export::small_run,
    interruption::{copy, write_scenario},
    program::{self, Folder, assert_holds, said, text},
    same::assert_same_bytes,
    small,
};

/// Longest that anything here may take; without an end it takes for ever, and a whole run takes
/// long on a busy machine.
const SOON: Duration = Duration::from_secs(180);

/// Waits for a program to end; kills one that does not.
fn ended(mut command: Command, what: &str) -> Output {
    command.stdout(Stdio::null()).stderr(Stdio::piped());
    program::ended(program::spawned(command), SOON, what)
}

fn pluvia(args: &[&str], out: &Path) -> Command {
    let mut command = program::pluvia();
    command.args(args).arg("--out").arg(out).arg("--quiet");
    command
}

/// Ends soon, without a panic, with an exit code and words.
fn refused(command: Command, expected: i32, words: &[&str], what: &str) {
    let output = ended(command, what);
    let said = said(&output);
    assert_eq!(output.status.code(), Some(expected), "law: {what}: the exit code, got: {said}");
    assert!(!said.contains("panicked"), "law: {what}: no panic, got: {said}");
    assert_holds(&said, words);
}

fn scenario(grains: Value) -> Value {
    json!({ "name": "endless", "grains": grains, "stages": [{ "stage": "fill_funnel" }] })
}

#[cfg(target_os = "linux")]
fn of_mesh(file: &str) -> Value {
    scenario(json!({ "meshes": [file], "mesh_unit": "mm", "density_kg_per_m3": 2650 }))
}

#[cfg(target_os = "linux")]
#[test]
fn inputs_without_end_are_refused_whoever_names_them() {
    let folder = Folder::new();
    let fifo = folder.out("fifo.stl");
    assert!(Command::new("mkfifo").arg(&fifo).status().is_ok_and(|s| s.success()), "mkfifo");
    std::os::unix::fs::symlink("/dev/zero", folder.path("zero.stl")).expect("a link");
    let extends = folder.scenario("extends.json", &json!({ "extends": "/dev/zero" }));
    let grains = folder.scenario("grains.json", &scenario(json!({ "file": "/dev/zero" })));
    let mesh = folder.scenario("mesh.json", &of_mesh("zero.stl"));
    let pipe = folder.scenario("pipe.json", &of_mesh("fifo.stl"));
    let out = folder.path("out");
    let only = "only regular files are read";
    for args in [
        ["run", "/dev/zero"],
        ["run", &fifo],
        ["grains", "/dev/full"],
        ["run", &extends],
        ["run", &grains],
        ["grains", &mesh],
        ["grains", &pipe],
        ["compare", &fifo],
        ["sweep", "/dev/zero"],
        ["calibrate", "/dev/zero"],
    ] {
        let what = args.join(" ");
        let mut command = pluvia(&args, &out);
        match args[0] {
            "sweep" => drop(command.args(["--over", "seed=1,2"])),
            "calibrate" => drop(command.args(["--angle-of-repose", "35"])),
            _ => {}
        }
        refused(command, 2, &[only], &what);
    }
    for command in ["converge", "sensitivity"] {
        refused(pluvia(&[command, "--design", "/dev/zero"], &out), 2, &[only], command);
    }
    // A file of the kernel, regular by name: reading it waits for ever.
    let kernel = pluvia(&["run", "/proc/kmsg"], &out);
    // Whoever may open it finds no JSON in it; to everybody else the system refuses it.
    let may_open = fs::File::open("/proc/kmsg").is_ok();
    refused(kernel, if may_open { 2 } else { 4 }, &["/proc/kmsg"], "run /proc/kmsg");
}

/// Law: what a file is or holds is usage (2), what the system does not let be read is not (4).
#[cfg(target_os = "linux")]
#[test]
fn each_refusal_has_one_exit_code() {
    let folder = Folder::new();
    let at = |name: &str| folder.out(name);
    let large = |name: &str, bytes: u64| {
        let file = fs::File::create(at(name)).expect("made");
        file.set_len(bytes).expect("a hole takes no room");
    };
    large("large.json", (4 << 20) + 1);
    large("large.stl", (512 << 20) + 1);
    fs::write(at("words.json"), "no JSON").expect("written");
    let from_file = |file: &str| scenario(json!({ "file": file }));
    folder.scenario("of-words.json", &from_file("words.json"));
    folder.scenario("of-folder.json", &from_file("."));
    folder.scenario("of-missing.json", &from_file("missing.json"));
    folder.scenario("of-large-mesh.json", &of_mesh("large.stl"));
    folder.scenario("of-missing-mesh.json", &of_mesh("missing.stl"));
    folder.scenario("extends-missing.json", &json!({ "extends": "missing.json" }));
    let rest = json!([{ "stage": "rest", "duration_s": 1 }]);
    let begun = json!({ "name": "begun", "begin": { "specimen": "missing" }, "stages": rest });
    folder.scenario("of-missing-run.json", &begun);
    for name in ["stages", "grains.json"] {
        let part = folder.path(&format!("without-{name}"));
        copy(small_run(), &part);
        fs::rename(part.join(name), part.join("moved")).expect("it is moved");
        let begun = json!({ "name": "begun", "begin": { "specimen": part }, "stages": rest });
        folder.scenario(&format!("of-run-without-{name}"), &begun);
    }
    let mut shaken = small::scenario(30.0, 0.25, 0.1);
    shaken["stages"][3] = json!({ "stage": "vibrate", "waveform": "file",
        "motion_file": "missing.csv" });
    folder.scenario("of-missing-motion.json", &shaken);
    copy(small_run(), &folder.path("run"));
    fs::write(at("run/manifest.json"), "{}").expect("written");
    let (run, none) = (at("run"), at("none"));
    let (device, file) = ("/dev/zero".to_owned(), at("words.json"));
    let (export, png) = (["--format", "csv"], at("x.png"));
    let to_png = ["--out", &*png];
    type Case<'a> = (&'a str, &'a str, &'a [&'a str], i32, &'a [&'a str]);
    let cases: [Case; 26] = [
        ("run", &at("large.json"), &[], 2, &["large.json", "4.0 MiB", "at most 4.0 MiB"]),
        ("run", &at("."), &[], 2, &["a folder", "regular files"]),
        ("run", &at("words.json"), &[], 2, &["words.json", "not JSON"]),
        ("run", &at("of-words.json"), &[], 2, &["words.json", "grains.file"]),
        ("run", &at("of-folder.json"), &[], 2, &["a folder", "regular files"]),
        ("grains", &at("of-large-mesh.json"), &[], 2, &["large.stl", "at most 512 MiB"]),
        ("run", &none, &[], 4, &["none", "No such file"]),
        ("run", &at("of-missing.json"), &[], 4, &["missing.json", "No such file", "grains.file"]),
        ("grains", &at("of-missing-mesh.json"), &[], 4, &["missing.stl", "grains.meshes"]),
        ("run", &at("extends-missing.json"), &[], 4, &["missing.json", "No such file"]),
        ("run", &at("of-missing-run.json"), &[], 2, &["begin.specimen", "is not there"]),
        ("run", &at("of-run-without-stages"), &[], 2, &["begin.specimen", "stages is not there"]),
        (
            "run",
            &at("of-run-without-grains.json"),
            &[],
            2,
            &["begin.specimen", "json is not there"],
        ),
        ("run", &at("of-missing-motion.json"), &[], 2, &["missing.csv", "motion_file"]),
        ("export", &run, &export, 2, &["manifest.json", "as Pluvia writes it"]),
        ("export", &device, &export, 2, &["/dev/zero", "a device", "a folder is read here"]),
        ("export", &file, &export, 2, &["words.json", "a file", "a folder is read here"]),
        ("export", &none, &export, 4, &["none", "No such file"]),
        ("stage", &none, &["--list"], 4, &["none", "No such file"]),
        ("view", &run, &["--save", "x.html"], 2, &["manifest.json", "as Pluvia writes it"]),
        ("view", &device, &["--save", "x.html"], 2, &["/dev/zero", "a device"]),
        ("view", &none, &["--save", "x.html"], 4, &["none", "No such file"]),
        ("picture", &device, &to_png, 2, &["a device"]),
        ("picture", &run, &to_png, 2, &["as Pluvia writes it"]),
        ("picture", &file, &to_png, 2, &["words.json"]),
        ("picture", &none, &to_png, 4, &["No such file"]),
    ];
    for (command, subject, more, code, words) in cases {
        let what = format!("{command} {subject}");
        let mut program = program::pluvia();
        program.arg(command).arg(subject).args(more).arg("--quiet").current_dir(at(""));
        if !["view", "stage", "picture"].contains(&command) {
            program.arg("--out").arg(at("out"));
        }
        refused(program, code, words, &what);
    }
}

/// Law: a command that is refused leaves no folder that it made.
#[test]
fn refusals_leave_no_folders() {
    let folder = Folder::new();
    let path = folder.scenario("s.json", &scenario(json!({ "file": "missing.json" })));
    for command in ["run", "grains"] {
        let command = pluvia(&[command, &path], &folder.path("a/b"));
        refused(command, 4, &["missing.json"], "grains that are not there");
        assert!(!folder.path("a").exists(), "law: neither the folder nor the one above it is left");
    }
}

/// Law: for each command that reads a folder, one that is there and of another kind is a wrong
/// argument (2), as a file in its place is; one that is not there cannot be read (4).
#[test]
fn folders_of_another_kind_are_wrong_arguments() {
    let folder = Folder::new();
    for name in ["empty", "several/runs", "rows", "loose"] {
        fs::create_dir_all(folder.path(name)).expect("made");
    }
    fs::write(folder.path("loose/grains.json"), r#"{ "blocks": [] }"#).expect("written");
    fs::write(folder.path("rows/series.csv"), "time_s,stage,a\n0,0,1\n1,1,2\n").expect("written");
    let path = folder.scenario("small.json", &small::layer(30.0));
    let planned = folder.path("planned");
    let plan = program::words("--over seed=1,2 --plan-only");
    let plan = [&["sweep", &*path][..], &plan[..]].concat();
    let output = ended(pluvia(&plan, &planned), "a plan");
    assert_eq!(output.status.code(), Some(0), "law: it is planned, got: {}", said(&output));
    const NO_RUN: &str = "it is no folder of a run";
    const NO_SWEEP: &str = "it is no folder of a sweep";
    // Arguments with the folder as PATH, and what is said of an empty one.
    for (line, of_empty) in [
        ("export PATH --format csv --out out", NO_RUN),
        ("export PATH --format glb --out out", NO_RUN),
        ("export PATH --format vtk --out out", NO_RUN),
        ("export PATH --format json --stage pour --out out", NO_RUN),
        ("picture PATH --out x.png", NO_RUN),
        ("picture PATH --grains --out x.png", NO_RUN),
        ("picture PATH --animate x.png", NO_RUN),
        ("view PATH --save x.html", NO_RUN),
        ("plot PATH --list", "no table `series`"),
        ("store check PATH", "there is no store"),
        ("stage PATH --list", NO_SWEEP),
        ("sweep --status --out PATH", NO_SWEEP),
        ("sweep --collect --out PATH", NO_SWEEP),
        ("targets --runs t=PATH --target t:void_ratio=1..2 --out out", NO_SWEEP),
    ] {
        let check = |name: &str, code: i32, words: &[&str]| {
            let line = line.replace("PATH", name);
            let mut command = program::pluvia();
            command.args(program::words(&line)).arg("--quiet").current_dir(folder.path(""));
            refused(command, code, words, &line);
        };
        check("empty", 2, &["empty", of_empty]);
        check("small.json", 2, &["small.json"]);
        check("nowhere", 4, &["nowhere"]);
        if of_empty == NO_RUN {
            check("planned", 2, &["planned", NO_RUN]);
            check("several", 2, &["several", "it holds several runs"]);
            let shown = "`pluvia picture loose/grains.json --out grains.png` shows them";
            check("loose", 2, &["it holds grains alone", shown, "`pluvia run`"]);
        }
    }
    let mut of_rows = program::pluvia();
    of_rows.args(program::words("plot rows --x time_s --y a --stage pour --out x.svg"));
    of_rows.current_dir(folder.path(""));
    refused(of_rows, 2, &["rows", NO_RUN], "a stage of rows that are no run's");
    for file in ["out", "x.png", "x.html", "x.svg"] {
        assert!(!folder.path(file).exists(), "law: {file} is not made");
    }
}

#[cfg(target_os = "linux")]
#[test]
fn files_of_a_run_without_end_are_refused() {
    let folder = Folder::new();
    for name in ["manifest.json", "grains.json", "specimen.json"] {
        let run = folder.path(name);
        copy(small_run(), &run);
        fs::remove_file(run.join(name)).expect("removed");
        std::os::unix::fs::symlink("/dev/zero", run.join(name)).expect("a link");
        let command = pluvia(&["export", text(&run), "--format", "csv"], &folder.path("out"));
        refused(command, 2, &[name, "only regular files are read"], name);
    }
}

/// Law: a folder may have any name; JSON, which is UTF-8, has a mark for what is not.
#[cfg(target_os = "linux")]
#[test]
fn folders_whose_names_are_no_utf_8_are_named_in_json() {
    use std::{ffi::OsStr, os::unix::ffi::OsStrExt};
    let folder = Folder::new();
    let path = folder.scenario("s.json", &small::layer(30.0));
    let mut command = program::pluvia();
    command.args(["grains", &path, "--json", "--out"]);
    command.arg(folder.path("").join(OsStr::from_bytes(b"Kr\xfcmel")));
    let output = command.output().expect("it runs");
    assert_eq!(output.status.code(), Some(0), "law: they are made, got: {}", said(&output));
    let made: Value = serde_json::from_slice(&output.stdout).expect("law: JSON is printed");
    let file = made["files"][0].as_str().unwrap_or_default();
    assert!(file.contains("Kr\u{fffd}mel/"), "law: the files are named, got {made}");
}

/// Law: a system that gives no threads is reported as one, at once.
#[test]
fn without_threads_one_message_says_so() {
    let folder = Folder::new();
    let scenario = write_scenario(&folder.path(""));
    let mut command = pluvia(&["run", text(&scenario)], &folder.path("out"));
    // A stack for which there is no room: no thread of Rust's starts.
    command.env("RUST_MIN_STACK", (1_u64 << 46).to_string());
    refused(command, 3, &["no thread could be started"], "a run without threads");
}

/// Law: more threads or jobs than there are cores are as many as the cores, with one warning
/// each; where the engine gets no threads of its own it computes on one. The bits are the same.
#[test]
#[ignore = "slow: make test-all"]
fn threads_that_are_not_there_change_no_bit() {
    let folder = Folder::new();
    let scenario = write_scenario(&folder.path(""));
    let program = env!("CARGO_BIN_EXE_pluvia");
    let run = |name: &str, limit: &str, more: &[&str]| {
        let out = folder.path(name);
        let mut command = Command::new("bash");
        command.arg("-c").arg(format!("{limit} exec \"$0\" \"$@\"")).arg(program);
        command.arg("run").arg(&scenario).arg("--out").arg(&out).args(more);
        let output = ended(command, name);
        let said = said(&output);
        assert_eq!(output.status.code(), Some(0), "law: {name} is run: {said}");
        (out, said)
    };
    let (plain, _) = run("plain", "", &["--jobs", "1"]);
    let (many, said) = run("many", "", &["--jobs", "1024", "--set", "engine.native.threads=1024"]);
    let cores = thread::available_parallelism().map_or(1, usize::from);
    if cores < 1024 {
        for words in ["--jobs 1024 exceeds", "engine.native.threads = 1024 exceeds"] {
            assert_eq!(said.matches(words).count(), 1, "law: one warning, got: {said}");
        }
    }
    let assert_same = |other: &Path, what: &str| {
        assert_same_bytes(&plain, other, &["specimen.json", "series.csv", "grains.csv"], what);
    };
    assert_same(&many, "as many threads as there are cores");
    // The engine's threads have stacks as large as the limit says, for which there is no room.
    let stack = "ulimit -Ss 137438953472 &&";
    let (alone, _) = run("alone", stack, &["--set", "engine.native.threads=2"]);
    assert_same(&alone, "no threads of the engine's own");
}

/// Law: a run that misses the accuracy standard, or whose checks found something, cannot be
/// read as valid: the last line says so, and so does the summary.
#[test]
fn the_last_line_of_a_run_that_is_not_valid_says_so() {
    let folder = Folder::new();
    let mut scenario = small::scenario(40.0, 0.5, 0.2);
    // Numerical creep is not measured then, which the standard asks for.
    scenario["rest_test_s"] = json!(0);
    let path = folder.scenario("unmeasured.json", &scenario);
    // Also quietly: nothing else is said then.
    let args = ["run", &path, "--no-figures", "--quiet", "--out", &folder.out("out")];
    let (_, printed, said) = program::run(&args);
    assert!(printed.is_empty(), "law: quiet");
    let last = said.lines().last().unwrap_or_default();
    assert!(last.contains("NOT VALID") && last.contains("standard"), "law: got `{last}`");
    let summary = folder.json("out/summary.json");
    assert_eq!(summary["meets_standard"], json!(false), "law: the summary says so, too");
    assert_eq!(summary["valid"], json!(false), "law: what misses the standard is not valid");
    let why = summary["left_out_of_means"][0].as_str().unwrap_or_default();
    assert!(why.contains("standard"), "law: and is left out of means, got {summary}");
}
