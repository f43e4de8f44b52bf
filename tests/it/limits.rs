//! What the system gives is not exceeded: threads that are typed stop at the cores, threads that
//! are refused are done without, and long lists are answered at once.

use std::{
    fs, io,
    os::unix::fs::PermissionsExt,
    path::{Path, PathBuf},
    process::{Command, Output, Stdio},
    thread::sleep,
    time::Duration,
};

use serde_json::json;

use super::{
    interruption::{prepared, write_scenario},
    program::{assert_holds, said, skipped, text},
    same::assert_same_bytes,
    small,
};

/// What is the same whatever a run is run with.
const FILES: [&str; 3] = ["specimen.json", "series.csv", "grains.csv"];

/// The output of a command, and the most threads that it had at a time.
fn watched(mut command: Command) -> io::Result<(Output, usize)> {
    let mut child = command.stdout(Stdio::null()).stderr(Stdio::piped()).spawn()?;
    let tasks = format!("/proc/{}/task", child.id());
    let mut most = 0;
    while child.try_wait()?.is_none() {
        most = most.max(fs::read_dir(&tasks).map_or(0, Iterator::count));
        sleep(Duration::from_millis(1));
    }
    Ok((child.wait_with_output()?, most))
}

/// The first two cores that this process may use, as taskset takes them: a container may have
/// others than the first of the machine.
fn two_cores() -> Option<String> {
    let status = fs::read_to_string("/proc/self/status").ok()?;
    let list = status.lines().find_map(|line| line.strip_prefix("Cpus_allowed_list:"))?;
    let mut cores = Vec::new();
    for range in list.trim().split(',') {
        let (first, last) = range.split_once('-').unwrap_or((range, range));
        cores.extend(first.parse::<u32>().ok()?..=last.parse::<u32>().ok()?);
    }
    Some(format!("{},{}", cores.first()?, cores.get(1)?))
}

/// Law: three and four typed threads on two cores are two, with one warning, and no bit changes.
#[test]
#[ignore = "slow: make test-all"]
fn typed_threads_stop_at_the_cores() {
    let (folder, scenario) = prepared();
    const WHY: &str = "it takes two cores, and taskset";
    let Some(on_two) = two_cores() else { return skipped("threads on two cores", WHY) };
    let run = |name: &str, threads: u32| {
        let out = folder.path().join(name);
        let mut command = Command::new("taskset");
        command.args(["-c", &on_two, env!("CARGO_BIN_EXE_pluvia"), "run"]).arg(&scenario);
        command.arg("--out").arg(&out).arg("--set");
        command.arg(format!("engine.native.threads={threads}"));
        (watched(command), out)
    };
    let cores = std::thread::available_parallelism().map_or(1, usize::from);
    let (two, plain) = run("two", 2);
    let Some((two, with_two)) = two.ok().filter(|_| cores > 1) else {
        return skipped("threads on two cores", WHY);
    };
    assert_eq!(two.status.code(), Some(0), "law: it can be run, got {}", said(&two));
    assert!(!said(&two).contains("exceeds the"), "law: two threads are not too many");
    for threads in [3, 4] {
        let (output, out) = run(&threads.to_string(), threads);
        let (output, with_more) = output.expect("it starts");
        let told = said(&output);
        assert_eq!(output.status.code(), Some(0), "law: it is run, got {told}");
        let warning =
            format!("engine.native.threads = {threads} exceeds the 2 available cores; using 2");
        assert_eq!(told.matches(&warning).count(), 1, "law: one warning, got {told}");
        assert_same_bytes(&plain, &out, &FILES, &format!("{threads} threads"));
        assert_eq!(with_more, with_two, "law: {threads} typed threads make no more than two do");
    }
}

/// The program where any user may run it.
fn program_for_anybody(folder: &Path) -> PathBuf {
    let program = folder.join("pluvia");
    // By another process: a file that this one writes is open in all that other tests begin at that
    // moment, too, and a program that is open for writing cannot be started.
    let copied = Command::new("cp").arg(env!("CARGO_BIN_EXE_pluvia")).arg(&program).status();
    assert!(copied.is_ok_and(|status| status.success()), "the program is copied");
    for path in [folder, &program] {
        fs::set_permissions(path, fs::Permissions::from_mode(0o755)).expect("opened");
    }
    program
}

/// Law: where the system gives few threads or none, a run ends with the same bytes or with one message;
/// it never fails by itself. The limit counts processes of a user, and holds nobody who may do everything.
#[test]
#[ignore = "slow: make test-all"]
fn threads_that_are_refused_end_in_no_panic() {
    let folder = tempfile::tempdir().expect("a folder");
    let program = program_for_anybody(folder.path());
    let scenario = write_scenario(folder.path());
    let results = folder.path().join("results");
    fs::create_dir(&results).expect("a folder");
    fs::set_permissions(&results, fs::Permissions::from_mode(0o777)).expect("opened");
    let limited = |most: Option<u32>, args: &[&str], name: &str| {
        let mut command = Command::new("setpriv");
        // A user that nobody is: what others run as `nobody`, 65534, would count.
        command.args(["--reuid=58321", "--regid=58321", "--clear-groups"]);
        if let Some(most) = most {
            command.arg("prlimit").arg(format!("--nproc={most}:{most}"));
        }
        command.arg(&program).args(args).arg("--out").arg(results.join(name)).arg("--quiet");
        command.output()
    };
    let scenario = text(&scenario);
    let run = ["run", scenario, "--set", "engine.native.threads=2"];
    let plain = match limited(None, &run, "plain") {
        Ok(output) if output.status.success() => results.join("plain"),
        Ok(output) => return skipped("a limit of processes", &said(&output)),
        Err(error) => return skipped("a limit of processes", &error.to_string()),
    };
    let (mut refused, mut done) = (0, 0);
    for most in 1..=7 {
        let name = most.to_string();
        let output = limited(Some(most), &run, &name).expect("it starts");
        let (code, told) = (output.status.code(), said(&output));
        let what = format!("{most} processes");
        for fault in ["panicked", "a fault of the program"] {
            assert!(!told.contains(fault), "law: {what}: no panic, got {code:?}: {told}");
        }
        match code {
            Some(0) => {
                done += 1;
                assert_same_bytes(&plain, &results.join(&name), &FILES, &what);
            }
            Some(3) => {
                refused += 1;
                assert!(told.contains("no thread could be started"), "law: {what}: got {told}");
            }
            other => panic!("law: {what}: exit code 0 or 3, got {other:?}: {told}"),
        }
    }
    assert!(refused > 0 && done > 0, "law: the limit is felt: {refused} refused, {done} done");
    // Other commands than `run`.
    for args in
        [&["verify", "--case", "spin-slide-0"][..], &["sweep", scenario, "--over", "seed=1,2"]]
    {
        for most in [1, 2, 3] {
            let output = limited(Some(most), args, &format!("{}-{most}", args[0])).expect("starts");
            let (code, told) = (output.status.code(), said(&output));
            let is_fault = told.contains("panicked") || told.contains("a fault of the program");
            assert!(!is_fault, "law: {args:?}, {most}: no panic, got {code:?}: {told}");
        }
    }
}

/// Law: a sieve table of as many fractions as a scenario can hold is answered within ten seconds of
/// a processor, with how many are allowed. What takes longer is killed.
#[test]
#[ignore = "slow: make test-all"]
fn a_sieve_table_of_very_many_fractions_is_answered_soon() {
    let folder = tempfile::tempdir().expect("a folder");
    let largest = 4 << 20; // bytes of a scenario
    let fraction = |n: usize| {
        let (above, below) = (9000.0 - 0.25 * n as f64, 9000.0 - 0.25 * (n + 1) as f64);
        json!({ "passing_mm": above, "retained_mm": below, "mass_percent": 0.001 }).to_string()
    };
    type Element<'a> = &'a dyn Fn(usize) -> String;
    let elements: [(&str, Element); 5] = [
        ("fractions", &fraction),
        ("the shortest", &|_| "1".to_owned()),
        ("objects", &|_| "{}".to_owned()),
        ("unknown fields", &|n| format!("{{\"field{n}\":0}}")),
        ("lists", &|_| "[]".to_owned()),
    ];
    for (what, element) in elements {
        let mut scenario = small::layer(30.0);
        scenario["grains"]["sieve_table"] = json!(["FRACTIONS"]);
        let (begin, end) = {
            let text = scenario.to_string();
            let (begin, end) = text.split_once("\"FRACTIONS\"").expect("the table");
            (begin.to_owned(), end.to_owned())
        };
        let mut text = begin;
        let mut count = 0;
        loop {
            let next = element(count);
            if text.len() + next.len() + 1 + end.len() > largest {
                break;
            }
            if count > 0 {
                text.push(',');
            }
            text += &next;
            count += 1;
        }
        text += &end;
        assert!((largest - 200..=largest).contains(&text.len()), "just below the limit");
        let path = folder.path().join("many.json");
        fs::write(&path, text).expect("written");
        let mut command = Command::new("sh");
        command.args(["-c", "ulimit -t 10; exec \"$0\" grains \"$1\" --out \"$2\""]);
        command.arg(env!("CARGO_BIN_EXE_pluvia")).arg(&path).arg(folder.path().join("out"));
        let output = command.output().expect("it starts");
        let told = said(&output);
        assert_eq!(output.status.code(), Some(2), "law: {count} {what} are refused, got {told}");
        assert_holds(&told, &["grains.sieve_table", "the list is too long", "1 to 100 elements"]);
        // A hundred faults are written out at most, each in a line.
        assert!(told.len() < 40_000, "law: {count} {what}: in few words, got {}", told.len());
    }
}
