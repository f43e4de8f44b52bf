//! Inputs without end, systems that give no threads, and requests to stop: each ends soon,
//! with one message and the exit code that fits.

use std::{
    fs,
    path::Path,
    process::{Command, Output, Stdio},
    thread,
    time::{Duration, Instant},
};

use serde_json::{Value, json};

use super::{
    export::small_run,
    interruption::{copy, write_scenario},
};

/// Longest that anything here may take; without an end it takes for ever.
const SOON: Duration = Duration::from_secs(60);

/// Waits for a program to end; kills one that does not.
fn ended(mut command: Command, what: &str) -> Output {
    let mut child =
        command.stdout(Stdio::null()).stderr(Stdio::piped()).spawn().expect("it starts");
    let begun = Instant::now();
    while child.try_wait().expect("its state").is_none() {
        if begun.elapsed() > SOON {
            child.kill().expect("killed");
            panic!("law: {what} ends; expected within seconds, got nothing in {SOON:?}");
        }
        thread::sleep(Duration::from_millis(20));
    }
    child.wait_with_output().expect("its output")
}

fn pluvia(args: &[&str], out: &Path) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_pluvia"));
    command.args(args).arg("--out").arg(out).arg("--quiet");
    command
}

/// One line with the words, and the exit code.
fn refused(output: &Output, expected: i32, words: &[&str], what: &str) {
    let said = String::from_utf8_lossy(&output.stderr).into_owned();
    let code = output.status.code();
    assert_eq!(code, Some(expected), "law: {what}: the exit code, got: {said}");
    assert!(!said.contains("panicked"), "law: {what}: no panic, got: {said}");
    for word in words {
        assert!(said.contains(word), "law: {what}: the message holds `{word}`, got: {said}");
    }
}

fn scenario(grains: Value) -> Value {
    json!({ "name": "endless", "grains": grains, "stages": [{ "stage": "fill_funnel" }] })
}

#[cfg(target_os = "linux")]
#[test]
fn inputs_without_end_are_refused_whoever_names_them() {
    let folder = tempfile::tempdir().expect("a folder");
    let at = |name: &str| folder.path().join(name).to_str().expect("UTF-8").to_owned();
    let write = |name: &str, content: &Value| {
        fs::write(at(name), content.to_string()).expect("written");
    };
    let fifo = at("fifo.stl");
    assert!(Command::new("mkfifo").arg(&fifo).status().is_ok_and(|s| s.success()), "mkfifo");
    std::os::unix::fs::symlink("/dev/zero", at("zero.stl")).expect("a link");
    write("extends.json", &json!({ "extends": "/dev/zero" }));
    write("grains.json", &scenario(json!({ "file": "/dev/zero" })));
    let mesh = |file: &str| {
        scenario(json!({ "meshes": [file], "mesh_unit": "mm", "density_kg_per_m3": 2650 }))
    };
    write("mesh.json", &mesh("zero.stl"));
    write("pipe.json", &mesh("fifo.stl"));
    let out = folder.path().join("out");
    let only = "only regular files are read";
    for args in [
        ["run", "/dev/zero"],
        ["run", &fifo],
        ["grains", "/dev/full"],
        ["run", &at("extends.json")],
        ["run", &at("grains.json")],
        ["grains", &at("mesh.json")],
        ["grains", &at("pipe.json")],
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
        refused(&ended(command, &what), 2, &[only], &what);
    }
    for command in ["converge", "sensitivity"] {
        let output = ended(pluvia(&[command, "--design", "/dev/zero"], &out), command);
        refused(&output, 2, &[only], command);
    }
    // A file of the kernel, regular by name: reading it waits for ever.
    let output = ended(pluvia(&["run", "/proc/kmsg"], &out), "run /proc/kmsg");
    // Whoever may open it finds no JSON in it; to everybody else the system refuses it.
    let may_open = fs::File::open("/proc/kmsg").is_ok();
    refused(&output, if may_open { 2 } else { 4 }, &["/proc/kmsg"], "run /proc/kmsg");
}

/// Law: what a file is or holds is usage (2), what the system does not let be read is not (4).
#[cfg(target_os = "linux")]
#[test]
fn each_refusal_has_one_exit_code() {
    let folder = tempfile::tempdir().expect("a folder");
    let at = |name: &str| folder.path().join(name).to_str().expect("UTF-8").to_owned();
    let large = |name: &str, bytes: u64| {
        let file = fs::File::create(at(name)).expect("made");
        file.set_len(bytes).expect("a hole takes no room");
    };
    large("large.json", (4 << 20) + 1);
    large("large.stl", (512 << 20) + 1);
    fs::write(at("words.json"), "no JSON").expect("written");
    let write = |name: &str, grains: Value| {
        fs::write(at(name), scenario(grains).to_string()).expect("written");
    };
    for (name, file) in [
        ("of-words.json", "words.json"),
        ("of-folder.json", "."),
        ("of-missing.json", "missing.json"),
    ] {
        write(name, json!({ "file": file }));
    }
    for (name, file) in
        [("of-large-mesh.json", "large.stl"), ("of-missing-mesh.json", "missing.stl")]
    {
        write(name, json!({ "meshes": [file], "mesh_unit": "mm", "density_kg_per_m3": 2650 }));
    }
    let run = folder.path().join("run");
    copy(small_run(), &run);
    fs::write(run.join("manifest.json"), "{}").expect("written");
    let (run, none) = (at("run"), at("none"));
    let (device, file) = ("/dev/zero".to_owned(), at("words.json"));
    let export = ["--format", "csv"];
    type Case<'a> = (&'a str, &'a str, &'a [&'a str], i32, &'a [&'a str]);
    let cases: [Case; 17] = [
        ("run", &at("large.json"), &[], 2, &["large.json", "4.0 MiB", "at most 4.0 MiB"]),
        ("run", folder.path().to_str().expect("UTF-8"), &[], 2, &["a folder", "regular files"]),
        ("run", &at("words.json"), &[], 2, &["words.json", "not JSON"]),
        ("run", &at("of-words.json"), &[], 2, &["words.json", "grains.file"]),
        ("run", &at("of-folder.json"), &[], 2, &["a folder", "regular files"]),
        ("grains", &at("of-large-mesh.json"), &[], 2, &["large.stl", "at most 512 MiB"]),
        ("run", &none, &[], 4, &["none", "No such file"]),
        ("run", &at("of-missing.json"), &[], 4, &["missing.json", "No such file", "grains.file"]),
        ("grains", &at("of-missing-mesh.json"), &[], 4, &["missing.stl", "grains.meshes"]),
        ("export", &run, &export, 2, &["manifest.json", "as Pluvia writes it"]),
        ("export", &device, &export, 2, &["/dev/zero", "a device", "a folder is read here"]),
        ("export", &file, &export, 2, &["words.json", "a file", "a folder is read here"]),
        ("export", &none, &export, 4, &["none", "No such file"]),
        ("stage", &none, &["--list"], 4, &["none", "No such file"]),
        ("view", &run, &["--save", "x.html"], 2, &["manifest.json", "as Pluvia writes it"]),
        ("view", &device, &["--save", "x.html"], 2, &["/dev/zero", "a device"]),
        ("view", &none, &["--save", "x.html"], 4, &["none", "No such file"]),
    ];
    for (command, subject, more, code, words) in cases {
        let what = format!("{command} {subject}");
        let mut program = Command::new(env!("CARGO_BIN_EXE_pluvia"));
        program.arg(command).arg(subject).args(more).arg("--quiet").current_dir(folder.path());
        if !["view", "stage"].contains(&command) {
            program.arg("--out").arg(at("out"));
        }
        refused(&ended(program, &what), code, words, &what);
    }
    for (subject, code, words) in [
        ("/dev/zero", 2, "a device"),
        (&*run, 2, "as Pluvia writes it"),
        (&*file, 2, "words.json"),
        (&*none, 4, "No such file"),
    ] {
        let mut program = Command::new(env!("CARGO_BIN_EXE_pluvia"));
        program.args(["picture", subject, "--out", &at("x.png"), "--quiet"]);
        refused(&ended(program, subject), code, &[words], &format!("picture {subject}"));
    }
}

#[cfg(target_os = "linux")]
#[test]
fn files_of_a_run_without_end_are_refused() {
    let folder = tempfile::tempdir().expect("a folder");
    for name in ["manifest.json", "grains.json", "specimen.json"] {
        let run = folder.path().join(name);
        copy(small_run(), &run);
        fs::remove_file(run.join(name)).expect("removed");
        std::os::unix::fs::symlink("/dev/zero", run.join(name)).expect("a link");
        let run = run.to_str().expect("UTF-8").to_owned();
        let command = pluvia(&["export", &run, "--format", "csv"], &folder.path().join("out"));
        let output = ended(command, name);
        refused(&output, 2, &[name, "only regular files are read"], name);
    }
}

/// Law: a specimen that speaks of grains that are not there is refused with the field,
/// by whatever reads it.
#[test]
fn a_specimen_of_other_grains_is_refused() {
    let folder = tempfile::tempdir().expect("a folder");
    type Change = fn(&mut Value);
    let changes: [(&str, Change); 2] = [
        ("bodies", |state| {
            let bodies = state["bodies"].as_array_mut().expect("a list");
            bodies.extend(bodies.clone());
        }),
        ("fixed_grains[0].grain", |state| {
            let pose = state["bodies"][0]["pose"].clone();
            state["base"] = json!({
                "radius": 0.1, "friction": null,
                "fixed_grains": [{ "grain": 1_000_000, "pose": pose }]
            });
        }),
    ];
    for (n, (field, change)) in changes.into_iter().enumerate() {
        let run = folder.path().join(n.to_string());
        copy(small_run(), &run);
        let path = run.join("specimen.json");
        let text = fs::read(&path).expect("a specimen");
        let mut state: Value = serde_json::from_slice(&text).expect("JSON");
        change(&mut state);
        fs::write(&path, state.to_string()).expect("written");
        // As if it had been written so.
        let manifest = run.join("manifest.json");
        let text = fs::read(&manifest).expect("a manifest");
        let mut content: Value = serde_json::from_slice(&text).expect("JSON");
        content["files_sha256"].as_object_mut().expect("hashes").remove("specimen.json");
        fs::write(&manifest, content.to_string()).expect("written");
        for format in ["vtk", "obj", "glb", "csv"] {
            let run = run.to_str().expect("UTF-8");
            let out = folder.path().join("out");
            let output =
                ended(pluvia(&["export", run, "--force", "--format", format], &out), field);
            // Formats of the whole run read the stages, which are as they were.
            if output.status.code() != Some(0) {
                refused(&output, 2, &["specimen.json", field], field);
            } else {
                assert!(matches!(format, "vtk" | "glb"), "law: {format} refuses `{field}`");
            }
        }
    }
}

/// Law: a system that gives no threads is reported as one, at once.
#[test]
fn without_threads_one_message_says_so() {
    let folder = tempfile::tempdir().expect("a folder");
    let scenario = write_scenario(folder.path());
    let run = ["run", scenario.to_str().expect("UTF-8")];
    let mut command = pluvia(&run, &folder.path().join("out"));
    // A stack for which there is no room: no thread of Rust's starts.
    command.env("RUST_MIN_STACK", (1_u64 << 46).to_string());
    let output = ended(command, "a run without threads");
    refused(&output, 3, &["no thread could be started"], "a run without threads");
}

/// Law: more threads or jobs than there are cores are as many as the cores, with one warning
/// each; where the engine gets no threads of its own it computes on one. The bits are the same.
#[test]
#[ignore = "slow: make test-all"]
fn threads_that_are_not_there_change_no_bit() {
    let folder = tempfile::tempdir().expect("a folder");
    let scenario = write_scenario(folder.path());
    let program = env!("CARGO_BIN_EXE_pluvia");
    let run = |name: &str, limit: &str, more: &[&str]| {
        let out = folder.path().join(name);
        let mut command = Command::new("bash");
        command.arg("-c").arg(format!("{limit} exec \"$0\" \"$@\"")).arg(program);
        command.arg("run").arg(&scenario).arg("--out").arg(&out).args(more);
        let output = ended(command, name);
        let said = String::from_utf8_lossy(&output.stderr).into_owned();
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
        for name in ["specimen.json", "series.csv", "grains.csv"] {
            let read = |out: &Path| fs::read(out.join(name)).expect("a file");
            assert!(read(&plain) == read(other), "law: {what}: the same bytes of {name}");
        }
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
    let folder = tempfile::tempdir().expect("a folder");
    let mut scenario: Value =
        serde_json::from_slice(&fs::read(write_scenario(folder.path())).expect("a scenario"))
            .expect("JSON");
    // Creep is not measured then, which the standard asks for.
    scenario["rest_test_s"] = json!(0);
    let path = folder.path().join("unmeasured.json");
    fs::write(&path, scenario.to_string()).expect("written");
    let out = folder.path().join("out");
    let mut command = pluvia(&["run", path.to_str().expect("UTF-8"), "--no-figures"], &out);
    let output = command.output().expect("it starts");
    // Also quietly: nothing else is said then.
    assert!(output.stdout.is_empty(), "law: quiet");
    let said = String::from_utf8_lossy(&output.stderr).into_owned();
    let last = said.lines().last().unwrap_or_default();
    assert!(last.contains("NOT VALID") && last.contains("standard"), "law: got `{last}`");
    let summary = fs::read(out.join("summary.json")).expect("a summary");
    let summary: Value = serde_json::from_slice(&summary).expect("JSON");
    assert_eq!(summary["meets_standard"], json!(false), "law: the summary says so, too");
    assert_eq!(summary["valid"], json!(false), "law: what misses the standard is not valid");
    let why = summary["left_out_of_means"][0].as_str().unwrap_or_default();
    assert!(why.contains("standard"), "law: and is left out of means, got {summary}");
}
