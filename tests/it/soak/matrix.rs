//! The same bits whatever it is run with: jobs, threads, instructions, killed or not.

use std::{
    fs,
    os::unix::process::ExitStatusExt,
    path::Path,
    process::{Command, Stdio},
    thread::sleep,
};

use rand::RngExt;

use super::{
    Ground,
    log::{ENDED, KILLED},
    trials::{PATIENCE, ended, program, said, segments, spawned},
};

const CLASS: &str = "determinism";

/// What must have the same bytes; the other files say what a run was run with.
const FILES: [&str; 4] = ["specimen.json", "series.csv", "grains.csv", "rest_test.csv"];

/// Where a sweep of one point has its run.
const RUN: &str = if cfg!(feature = "double-precision") {
    "runs/point-0001-c1"
} else {
    "runs/point-0001-c1-single"
};

/// How a run is run.
#[derive(Debug, Clone, Copy)]
struct With {
    jobs: u32,
    threads: u32,
    portable: bool,
    kill: bool,
}

impl With {
    fn command(self, out: &Path) -> Command {
        let scenario = segments().whole.with_file_name("segments.json");
        let mut command = Command::new(program());
        // A sweep draws no pictures, which take longer than all stages.
        command.arg("sweep").arg(scenario).arg("--out").arg(out);
        command.args(["--over", "seed=1", "--jobs", &self.jobs.to_string()]);
        command.args(["--set", &format!("engine.native.threads={}", self.threads)]);
        command.args(["--set", &format!("engine.native.portable={}", self.portable)]);
        command.stdout(Stdio::null()).stderr(Stdio::piped());
        command
    }

    fn differs(self, out: &Path) -> Vec<&'static str> {
        let differs = |name: &&str| {
            fs::read(out.join(RUN).join(name)).expect("law: it is there")
                != fs::read(segments().whole.join(name)).expect("a file")
        };
        FILES.into_iter().filter(differs).collect()
    }

    fn carried_out(self, ground: &mut Ground) {
        let out = ground.place();
        let what = format!("{self:?}");
        let mut killed = false;
        if self.kill {
            let mut run = spawned(self.command(&out));
            // Pictures, which this draws none of, take two thirds of the time.
            sleep(segments().takes.mul_f64(0.3 * ground.rng.random::<f64>()));
            let _ = run.kill();
            killed = ended(run, PATIENCE, &what).status.signal() == Some(9);
        }
        let output = ended(spawned(self.command(&out)), PATIENCE, &what);
        assert!(output.status.success(), "law: {what} is run: {}", said(&output));
        let differs = self.differs(&out);
        assert!(differs.is_empty(), "law: {what}: the same bytes, got others in {differs:?}");
        let Self { jobs, threads, portable, .. } = self;
        let phase = format!("jobs {jobs}, threads {threads}, portable {portable}");
        ground.log.case(CLASS, &phase, if killed { KILLED } else { ENDED });
    }
}

/// Every combination.
fn all() -> impl Iterator<Item = With> {
    (0..16).map(|n| With {
        jobs: 1 + (n & 1),
        threads: 1 + ((n >> 1) & 1),
        portable: n & 4 != 0,
        kill: n & 8 != 0,
    })
}

/// `make soak`: every combination once.
pub fn round(ground: &mut Ground) {
    all().for_each(|with| with.carried_out(ground));
}

#[test]
#[ignore = "slow: make test-all"]
fn jobs_threads_instructions_and_kills_change_no_byte() {
    let mut ground = Ground::quick(11);
    let with = With { jobs: 2, threads: 2, portable: true, kill: true };
    with.carried_out(&mut ground);
    assert_eq!(ground.log.of_class(CLASS), 1, "law: it is noted");
    assert_eq!(all().count(), 16);
    // The comparison can fail: another friction is another result.
    let out = ground.place();
    let mut other = with.command(&out);
    other.args(["--set", "contact.grain_wall_friction=0.4"]);
    assert!(other.status().expect("started").success(), "law: it is run");
    assert!(!with.differs(&out).is_empty(), "law: another friction, other bytes");
}
