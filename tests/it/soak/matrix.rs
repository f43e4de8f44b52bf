//! The same bits whatever it is carried out with: jobs, threads, instructions, killed or not.

use std::{
    fs,
    path::Path,
    process::{Command, Stdio},
    thread::sleep,
};

use rand::RngExt;

use super::{
    Ground,
    log::{ENDED, KILLED},
    trials::{PATIENCE, ended, legs, message, program, spawned},
};

const CLASS: &str = "determinism";

/// What must have the same bytes; the other files say what a run was carried out with.
const FILES: [&str; 5] =
    ["grains.json", "specimen.json", "series.csv", "grains.csv", "control.csv"];

/// How a run is carried out.
#[derive(Debug, Clone, Copy)]
struct With {
    jobs: u32,
    threads: u32,
    portable: bool,
    kill: bool,
}

impl With {
    fn command(self, out: &Path) -> Command {
        let scenario = legs().whole.with_file_name("legs.json");
        let mut command = Command::new(program());
        command.arg("run").arg(scenario).arg("--out").arg(out);
        command.args(["--jobs", &self.jobs.to_string()]);
        command.args(["--set", &format!("engine.manifold.threads={}", self.threads)]);
        command.args(["--set", &format!("engine.manifold.portable={}", self.portable)]);
        command.stdout(Stdio::null()).stderr(Stdio::piped());
        command
    }

    fn differs(self, out: &Path) -> Vec<&'static str> {
        let differs = |name: &&str| {
            fs::read(out.join(name)).expect("law: it is there")
                != fs::read(legs().whole.join(name)).expect("a file")
        };
        FILES.into_iter().filter(differs).collect()
    }

    fn carried_out(self, ground: &mut Ground) {
        let out = ground.place();
        let what = format!("{self:?}");
        if self.kill {
            let mut run = spawned(self.command(&out));
            sleep(legs().takes.mul_f64(ground.rng.random::<f64>()));
            let _ = run.kill();
            ended(run, PATIENCE, &what);
        }
        let output = ended(spawned(self.command(&out)), PATIENCE, &what);
        assert!(output.status.success(), "law: {what} is carried out: {}", message(&output));
        let differs = self.differs(&out);
        assert!(differs.is_empty(), "law: {what}: the same bytes, got others in {differs:?}");
        let Self { jobs, threads, portable, kill } = self;
        let phase = format!("jobs {jobs}, threads {threads}, portable {portable}");
        ground.log.case(CLASS, &phase, if kill { KILLED } else { ENDED });
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
fn jobs_threads_instructions_and_kills_change_no_byte() {
    let mut ground = Ground::quick(11);
    let with = With { jobs: 2, threads: 2, portable: true, kill: true };
    with.carried_out(&mut ground);
    assert_eq!(ground.log.of_class(CLASS), 1, "law: it is noted");
    assert_eq!(all().count(), 16);
    // The comparison can fail: another seed is another result.
    let out = ground.place();
    let mut other = with.command(&out);
    assert!(other.args(["--set", "seed=2"]).status().expect("started").success());
    assert!(!with.differs(&out).is_empty(), "law: another seed, other bytes");
}
