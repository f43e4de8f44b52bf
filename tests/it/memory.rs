//! Memory does not grow with the simulated time: results go to disk as they come.

use std::{fs, path::Path, thread::sleep, time::Duration};

use super::{interruption::pluvia, small, soak::Ground};

/// How much more memory, in MiB, a run of three times the length may take: what
/// is held of a series and drawn of it is some 400 bytes a row, 0.2 MiB for 500
/// rows, and allocators differ by some tenths. Frames of the 110 grains, were
/// they held, would take 4 MiB.
const TOLERANCE_MIB: f64 = 2.0;

/// Whether memory is flat; else what was found.
fn flat(short_mib: f64, long_mib: f64) -> Result<(), String> {
    let more = long_mib - short_mib;
    // Written so that what is no number is not flat.
    if short_mib > 0.0 && more <= TOLERANCE_MIB {
        return Ok(());
    }
    Err(format!(
        "law: memory does not grow with the simulated time; expected {short_mib:.1} MiB and up to \
         {TOLERANCE_MIB} more, got {long_mib:.1} MiB"
    ))
}

#[test]
fn growth_is_found_and_none_is_not() {
    assert_eq!(flat(40.0, 41.9), Ok(()));
    assert_eq!(flat(40.0, 35.0), Ok(()), "law: less is no growth");
    assert_eq!(peak_of("VmPeak:\t 9 kB\nVmHWM:\t  512 kB\n"), Some(512.0));
    for (short, long) in [(40.0, 42.1), (40.0, f64::NAN), (0.0, 0.0)] {
        assert!(flat(short, long).is_err(), "law: {short} and {long} are not flat");
    }
}

/// Peak memory in MiB of a run with frames that is shaken for so long, in s;
/// figures and pictures, which it makes last, included.
fn peak_mib(folder: &Path, shaken_s: f64) -> f64 {
    let file = folder.join(format!("{shaken_s}.json"));
    fs::write(&file, small::scenario(220.0, shaken_s, 0.5).to_string()).expect("a scenario");
    let out = folder.join(format!("out-{shaken_s}"));
    let mut run = pluvia(&file, &out).spawn().expect("started");
    let status = format!("/proc/{}/status", run.id());
    let mut peak = f64::NAN;
    let ended = loop {
        if let Some(ended) = run.try_wait().expect("it can be waited for") {
            break ended;
        }
        // The system keeps the peak itself: only the last milliseconds are missed.
        let text = fs::read_to_string(&status).unwrap_or_default();
        peak = peak_of(&text).map_or(peak, |kib| kib / 1024.0);
        sleep(Duration::from_millis(5));
    };
    assert!(ended.success(), "law: it is run");
    peak
}

/// Peak memory in KiB of a process whose status the system tells.
fn peak_of(status: &str) -> Option<f64> {
    let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:"))?;
    line.split_whitespace().next()?.parse().ok()
}

/// `make soak`: 20 s and 60 s of shaking.
pub fn round(ground: &mut Ground) {
    let folder = tempfile::tempdir().expect("a folder");
    let [short, long] = [20.0, 60.0].map(|shaken_s| peak_mib(folder.path(), shaken_s));
    println!("soak, memory: {short:.1} MiB for 20 s of shaking, {long:.1} MiB for 60 s");
    if let Err(found) = flat(short, long) {
        panic!("{found}");
    }
    ground.log.case("memory", "20 s and 60 s of shaking", "no more for the longer");
}
