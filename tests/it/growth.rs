//! What `make bench` measures (`benches/growth/`): worlds that run at once, and the rows of its
//! results.

use std::io::{BufReader, Write, pipe};

use serde_json::Value;

#[allow(dead_code)] // nothing is measured here
#[path = "../../benches/growth/measured.rs"]
mod measured;
#[allow(dead_code)]
#[path = "../../benches/growth/process.rs"]
mod process;
#[allow(dead_code)]
#[path = "../../benches/growth/rows.rs"]
mod rows;

use measured::{Measured, State, Step};
use process::Beside;
use rows::{Kind, Row};

/// A measurement of 100 grains whose steps take these times in s.
fn measurement(steps: &[f64]) -> Measured {
    let step = |&time: &f64| Step {
        phases: [0.0, 0.0, time, 0.0],
        whole: time,
        shared: time / 2.0,
        shared_on: [(2, time / 4.0), (8, time / 16.0), (16, time / 32.0)],
    };
    Measured {
        grains: 100,
        rate_hz: 480.0,
        contacts_per_grain: 3.0,
        memory_kib_per_grain: None,
        steps: steps.iter().map(step).collect(),
    }
}

/// What the rows of a specimen that is shaken say: alone on one thread and on two, and two at once.
fn shaken(kinds: [(usize, u32, &[&[f64]]); 3]) -> [Value; 3] {
    let mut rows = kinds.map(|(specimens, threads, rounds)| {
        let kind = Kind { state: State::Shaken, specimens, threads };
        let rounds = rounds.iter().map(|steps| Row::new(kind, measurement(steps)));
        rounds.reduce(Row::better).expect("a round")
    });
    rows::compare(&mut rows);
    rows.map(|row| row.json())
}

fn near(value: &Value, expected: f64) -> bool {
    value.as_f64().is_some_and(|value| (value - expected).abs() < 1e-9 * expected)
}

/// Law: the speed-up of two worlds at once is what both do per second over what one does alone: 2 ×
/// (time alone) / (time while both run), both of whole measurements, since single steps are short
/// by chance where worlds share cores; one world counts with the shortest time of each step.
#[test]
fn two_worlds_at_once_are_compared_with_one_alone() {
    let [one, two_threads, at_once] = shaken([
        (1, 1, &[&[2.0, 4.0], &[3.0, 2.0]]),
        (1, 2, &[&[2.0, 1.0]]),
        // Steps of both worlds: in the first round 16 s in all, in the second 14 s.
        (2, 1, &[&[1.0, 6.0, 4.0, 5.0], &[4.0, 3.0, 3.0, 4.0]]),
    ]);
    for (row, specimens, threads, ms_per_step) in
        [(&one, 1_u64, 1_u64, 2000.0), (&two_threads, 1, 2, 1500.0), (&at_once, 2, 1, 3500.0)]
    {
        assert_eq!([&row["specimens"], &row["threads"]], [specimens, threads], "law: of {row}");
        assert!(near(&row["ms_per_step"], ms_per_step), "law: {ms_per_step} ms, got {row}");
        assert_eq!(row["grains"], 100, "law: of one specimen, got {row}");
    }
    assert!(one["speed_up"].is_null(), "law: it is what others are compared with, got {one}");
    assert!(near(&two_threads["speed_up"], 2.0 / 1.5), "law: shortest steps, got {two_threads}");
    assert!(two_threads["alone_us_per_grain_step"].is_null(), "law: got {two_threads}");
    // The faster whole measurement of one world takes 5 s for two steps.
    assert!(near(&at_once["speed_up"], 2.0 * 2.5 / 3.5), "law: whole ones, got {at_once}");
    assert!(near(&at_once["alone_us_per_grain_step"], 2.5e6 / 100.0), "law: got {at_once}");
    for field in ["serial_share", "expected_speed_up"] {
        assert!(!one[field].is_null(), "law: {field} is known of one world, got {one}");
        assert!(at_once[field].is_null(), "law: {field} is of one world alone, got {at_once}");
    }
}

/// Law: without a world alone there is nothing to compare with.
#[test]
fn two_worlds_at_once_have_no_speed_up_without_one_alone() {
    let kind = Kind { state: State::Rest, specimens: 2, threads: 1 };
    let mut rows = [Row::new(kind, measurement(&[1.0]))];
    rows::compare(&mut rows);
    let row = rows[0].json();
    assert!(row["speed_up"].is_null() && near(&row["growth"], 1.0), "law: got {row}");
}

/// Law: no process measures before all are ready, and each stays busy until all have measured, also
/// if one is slower before or after.
#[cfg(unix)]
#[test]
fn processes_measure_while_all_are_busy() {
    let folder = tempfile::tempdir().expect("a folder");
    let log = folder.path().join("log");
    let command = |name: &str, before: &str, measuring: &str| {
        let text = format!(
            "note() {{ echo \"$1 {name}\" >> \"$LOG\"; }}\n\
             sleep {before}; note ready; echo ready\n\
             read word; note \"$word\"; sleep {measuring}; note done; echo done\n\
             while read word; do :; done\n\
             note over; echo 'the result of {name}'\n"
        );
        let mut command = std::process::Command::new("sh");
        command.args(["-c", &text]).env("LOG", &log);
        command
    };
    let commands = vec![command("a", "0", "0.6"), command("b", "0.4", "0")];
    let said = process::together(commands).expect("law: both measure");
    assert_eq!(said, ["the result of a\n", "the result of b\n"], "law: each has its result");
    let log = std::fs::read_to_string(&log).expect("a log");
    let lines: Vec<&str> = log.lines().collect();
    let at = |line: &str| {
        let found = lines.iter().position(|l| *l == line);
        found.unwrap_or_else(|| panic!("law: `{line}` is in the log, got {lines:?}"))
    };
    for (earlier, later) in [("ready", "begin"), ("done", "over")] {
        for (one, other) in [("a", "b"), ("b", "a")] {
            let (earlier, later) = (format!("{earlier} {one}"), format!("{later} {other}"));
            assert!(at(&earlier) < at(&later), "law: {earlier}, then {later}, got {lines:?}");
        }
    }
}

/// Law: a process that fails is reported with what it said, and no other goes on by itself.
#[cfg(unix)]
#[test]
fn a_process_that_fails_ends_all() {
    let command = |text: &str| {
        let mut command = std::process::Command::new("sh");
        command.args(["-c", text]);
        command
    };
    let folder = tempfile::tempdir().expect("a folder");
    let mark = folder.path().join("measured");
    let mut waits = command("echo ready; read word && : > \"$MARK\"");
    waits.env("MARK", &mark);
    let broken = command("echo 'no such specimen' >&2; exit 3");
    let why = process::together(vec![waits, broken]).expect_err("law: one has not measured");
    assert_eq!(why, "no such specimen\n", "law: what it said");
    assert!(!mark.exists(), "law: the other one did not begin");
    let silent = process::together(vec![command("echo ready; read word; echo no")]);
    let why = silent.expect_err("law: it has not measured");
    assert_eq!(why, "expected `done`, got `no`", "law: what was expected");
}

/// Law: a process that measures at once with others says that it is ready, waits, says that it has
/// measured, and works on until its input ends.
#[test]
fn a_process_works_on_until_its_input_ends() {
    let (input, mut commands) = pipe().expect("a pipe");
    let mut said = Vec::new();
    writeln!(commands, "begin").expect("written");
    let beside = Beside::begin(BufReader::new(input), &mut said).expect("law: it may begin");
    let (mut steps, mut commands) = (0, Some(commands));
    beside
        .stay_busy(|| {
            steps += 1;
            if steps >= 5 {
                drop(commands.take());
                std::thread::yield_now();
            }
        })
        .expect("law: it ends with its input");
    assert!(steps >= 5, "law: it works while its input is open, got {steps} steps");
    assert_eq!(said, b"ready\ndone\n", "law: what it says");
    let refused = Beside::begin(BufReader::new(std::io::empty()), Vec::<u8>::new());
    assert!(refused.is_err(), "law: none measures where nobody says that all are ready");
}

/// Law: where nothing was measured, earlier results stay, and it is an error.
#[test]
fn no_measurement_replaces_no_results() {
    let folder = tempfile::tempdir().expect("a folder");
    let out = folder.path().join("new/bench.json");
    let kind = Kind { state: State::Shaken, specimens: 1, threads: 1 };
    let rows = [Row::new(kind, measurement(&[1.0]))];
    rows::write(&rows, &out).expect("law: rows are written");
    let read = || std::fs::read_to_string(&out).expect("it is there");
    let before = read();
    let why = rows::write(&[], &out).expect_err("law: nothing is no result");
    assert!(why.contains("nothing was measured"), "law: it says so, got: {why}");
    assert_eq!(read(), before, "law: earlier results stay");
}
