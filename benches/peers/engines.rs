//! The engines, how each is set, and how it is started.

use std::{
    path::{Path, PathBuf},
    process::{Command, Stdio},
    thread::sleep,
    time::{Duration, Instant},
};

use pluvia::record::read_json;
use pluvia::scenario::{Backend, EngineSettings, NativeSettings};
use pluvia::world;
use serde::{Deserialize, Serialize};

use super::{handed, ours, tree::root, workshop};

/// Wall time in s that an engine may take beside stepping: reading, building
/// hulls, writing. Some build 1456 hulls slowly.
const BESIDE_STEPPING: f64 = 600.0;

/// What an engine is asked to do.
pub struct Job {
    /// File with the scene.
    pub scene: PathBuf,
    /// File for the result.
    pub result: PathBuf,
    /// Steps a second of simulated time; 0 lets the engine choose.
    pub rate_hz: f64,
    /// Iterations a step, where the engine has any.
    pub iterations: Option<u32>,
    /// Simulated time in s.
    pub seconds: f64,
    /// Wall time of stepping in s after which it stops.
    pub limit_s: f64,
}

/// What an engine writes.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct PeerResult {
    /// Of the engine, with its precision where it has a choice.
    pub version: String,
    /// Steps taken.
    pub steps: u64,
    /// Simulated time in s.
    pub simulated_s: f64,
    /// Wall time of stepping alone, in s.
    pub wall_s: f64,
    /// Peak memory of its process.
    pub peak_memory_mib: f64,
    /// Displacement of the table at the end, in m.
    pub table_x_m: f64,
    /// Pose of every grain of the scene at the end: position in m, unit
    /// quaternion with the scalar last. Not finite comes as null.
    pub poses: Vec<[Option<f64>; 7]>,
    /// Heights in the course of time.
    pub series: Vec<Sample>,
}

/// Heights of all grains at a time.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Sample {
    /// Time since the scene began, in s.
    pub time_s: f64,
    /// Heights of the grains' centroids in m.
    pub z_m: Vec<Option<f64>>,
}

/// An engine of the comparison.
pub struct Engine {
    /// Name in the results.
    pub name: &'static str,
    /// Its steps a second; 0 where it chooses.
    pub rate_hz: f64,
    /// Its iterations a step.
    pub iterations: Option<u32>,
    /// Wall time in s of stepping beyond which waiting tells nothing more.
    pub patience_s: f64,
    by: By,
}

/// Who runs the job.
enum By {
    /// This program, with these settings.
    Us(Box<EngineSettings>),
    /// A program and its first arguments.
    Program(Vec<String>),
}

/// Every engine, the one that the others are compared with first.
pub fn all() -> Vec<Engine> {
    let script = |name: &str| format!("{}/benches/peers/{name}", root().display());
    let own = |name: &str| format!("{}/{name}", workshop().display());
    let program = |words: &[&str], last: String| {
        By::Program(words.iter().map(ToString::to_string).chain([last]).collect())
    };
    let python = own("venv/bin/python");
    let patience_s = f64::INFINITY;
    let engine =
        |name, rate_hz, iterations, by| Engine { name, rate_hz, iterations, patience_s, by };
    let yade = program(&["yade", "-n", "-x", "-j1", "-f2"], script("yade_peer.py"));
    // The last word is the number of threads.
    let box3d = |name, threads: &str| program(&[&own(name)], threads.to_owned());
    let blender = ["blender", "-b", "--factory-startup", "-P"];
    let pluvia = EngineSettings::default();
    let native = |native| EngineSettings { native, ..pluvia.clone() };
    let two_threads = native(NativeSettings { threads: Some(2), ..pluvia.native.clone() });
    // As the others: iterations that are counted, not a solution that is asked for.
    let counted = NativeSettings { solver_tolerance: 1.0, ..pluvia.native.clone() };
    let counted_two_threads = native(NativeSettings { threads: Some(2), ..counted.clone() });
    let counted = native(counted);
    let rapier = EngineSettings { backend: Backend::Rapier, ..pluvia.clone() };
    let rate = pluvia.rate_hz;
    let iterations = Some(pluvia.native.iterations * pluvia.native.substeps(rate));
    let substeps = Some(rapier.rapier.substeps);
    let us = |settings| By::Us(Box::new(settings));
    vec![
        engine("bullet", 960.0, Some(10), program(&[], own("bullet-float64"))),
        engine("bullet-single", 960.0, Some(10), program(&[], own("bullet"))),
        engine("pluvia", rate, iterations, us(pluvia.clone())),
        engine("pluvia-2-threads", rate, iterations, us(two_threads)),
        engine("pluvia-counted", rate, iterations, us(counted)),
        engine("pluvia-counted-2-threads", rate, iterations, us(counted_two_threads)),
        engine("rapier", rate, substeps, us(rapier)),
        engine("box3d", 480.0, Some(8), box3d("box3d", "1")),
        engine("box3d-2-threads", 480.0, Some(8), box3d("box3d", "2")),
        engine("box3d-patched", 480.0, Some(8), box3d("box3d-patched", "1")),
        engine("box3d-patched-2-threads", 480.0, Some(8), box3d("box3d-patched", "2")),
        engine("mujoco", 2000.0, Some(30), program(&[&python], script("mujoco_peer.py"))),
        engine("pybullet", 960.0, Some(10), program(&[&python], script("pybullet_peer.py"))),
        // A second and more for each of a hundred thousand steps.
        Engine { patience_s: 60.0, ..engine("yade", 0.0, None, yade) },
        engine("blender", 960.0, Some(10), program(&blender, script("blender_peer.py"))),
    ]
}

impl Engine {
    /// Makes the engine ready to run, installing what is missing.
    ///
    /// # Errors
    /// Why it cannot be had here.
    pub fn prepare(&self) -> Result<(), String> {
        if let By::Us(settings) = &self.by {
            let built_in = world::built_in().contains(&settings.backend);
            return if built_in { Ok(()) } else { Err("not built in".to_owned()) };
        }
        let output = Command::new("bash")
            .arg(root().join("scripts/peers.sh"))
            .arg(self.name)
            .stdin(Stdio::null())
            .output()
            .map_err(|e| format!("bash does not start: {e}"))?;
        if output.status.success() {
            return Ok(());
        }
        let said = String::from_utf8_lossy(&output.stderr);
        Err(said.lines().last().unwrap_or("scripts/peers.sh failed").to_owned())
    }

    /// Runs a job in a process of its own.
    ///
    /// # Errors
    /// What went wrong.
    pub fn carry_out(&self, job: &Job) -> Result<PeerResult, String> {
        // A result of an earlier run must not pass for one of this.
        let _ = std::fs::remove_file(&job.result);
        let mut command = self.command(job)?;
        let log = job.result.with_extension("log");
        let file = || std::fs::File::create(&log).map_err(|e| format!("{}: {e}", log.display()));
        let output = file()?;
        let errors = output.try_clone().map_err(|e| e.to_string())?;
        command.stdin(Stdio::null()).stdout(output).stderr(errors);
        // One thread each; who uses two says so by name.
        for variable in ["OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "RAYON_NUM_THREADS"] {
            command.env(variable, "1");
        }
        let mut child = command.spawn().map_err(|e| format!("it does not start: {e}"))?;
        let started = Instant::now();
        let status = loop {
            if let Some(status) = child.try_wait().map_err(|e| e.to_string())? {
                break status;
            }
            if started.elapsed().as_secs_f64() > job.limit_s + BESIDE_STEPPING {
                // Both fail only where it has just ended by itself.
                let _ = child.kill();
                let _ = child.wait();
                return Err(format!("stopped after {:.0} s", started.elapsed().as_secs_f64()));
            }
            sleep(Duration::from_millis(100));
        };
        // Blender and YADE end with success whatever a script does.
        if !job.result.exists() {
            return Err(format!("it ended without a result ({status}): {}", last_line(&log)));
        }
        read_json(&job.result).map_err(|e| e.to_string())
    }

    fn command(&self, job: &Job) -> Result<Command, String> {
        let mut command = match &self.by {
            By::Us(_) => {
                let mut us = Command::new(std::env::current_exe().map_err(|e| e.to_string())?);
                us.arg(ours::CARRY);
                us
            }
            By::Program(words) => {
                let mut command = Command::new(&words[0]);
                command.args(&words[1..]);
                // What follows is the script's, not Blender's.
                if words[0] == "blender" {
                    command.arg("--");
                }
                command
            }
        };
        command.arg(&job.scene).arg(&job.result);
        command.args(
            [job.rate_hz, f64::from(job.iterations.unwrap_or(0)), job.seconds, job.limit_s]
                .map(|number| number.to_string()),
        );
        if let By::Us(settings) = &self.by {
            command.args(handed::words(settings)?);
        }
        Ok(command)
    }
}

fn last_line(log: &Path) -> String {
    let text = std::fs::read_to_string(log).unwrap_or_default();
    text.lines().rfind(|l| !l.trim().is_empty()).unwrap_or_default().to_owned()
}
