//! Runs of a scenario at several points and realisations, and what they leave.

use std::{
    cell::RefCell,
    collections::BTreeMap,
    path::{Path, PathBuf},
    sync::{Arc, atomic::AtomicBool},
};

use pluvia::{
    export::read_run,
    protocol::{Progress, spring_energy},
    record::{Summary, read_json, write_json},
    scenario::{EngineSettings, Override},
    specimen::Specimen,
    study::{RunOptions, Variation, Varied, carry_out_variations},
};

use super::tree::root;

/// Says in the folder of runs which realisations of each vibration have a value.
const SHAKEN: &str = "shaken.json";

/// How much is run.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Design {
    /// Small specimens, few points, nothing that is only tried.
    Quick,
    /// Small specimens.
    Small,
    /// Specimens of the size that the tests ask for, and more points.
    Full,
}

/// What is to be done.
pub struct Bench {
    /// Folder of runs.
    pub out: PathBuf,
    /// How much is run.
    pub design: Design,
    /// Realisations of each point.
    pub configurations: u32,
    /// Stages at a time.
    pub jobs: usize,
    /// What nothing was read of since this was last taken, and why: see [`Bench::leave_out`].
    pub left_out: RefCell<Vec<String>>,
    /// Realisations with a value of the vibrations that were run, now or by earlier commands, by
    /// the name of their folder: see [`Bench::note_shaken`].
    pub shaken: RefCell<BTreeMap<String, Vec<u32>>>,
}

/// A point of a design: its name, and what it changes in the scenario.
#[derive(Clone)]
pub struct Point {
    pub name: String,
    pub changes: Vec<String>,
    /// Largest number of realisations, of what is only tried.
    pub most: Option<u32>,
}

/// A run that came to its end.
pub struct Run {
    /// Number of its point.
    pub point: usize,
    /// Which realisation, from 1.
    pub configuration: u32,
    /// Where its files are.
    pub folder: PathBuf,
}

impl Bench {
    /// `quick`, `small` or `full`.
    pub fn design(&self) -> &'static str {
        match self.design {
            Design::Quick => "quick",
            Design::Small => "small",
            Design::Full => "full",
        }
    }

    /// Whether specimens are small.
    pub fn is_small(&self) -> bool {
        self.design != Design::Full
    }

    /// Whether only the least is run.
    pub fn is_quick(&self) -> bool {
        self.design == Design::Quick
    }

    /// What the quick design leaves out.
    pub fn unless_quick<T>(&self, of: Vec<T>) -> Vec<T> {
        if self.is_quick() { Vec::new() } else { of }
    }

    /// Says that nothing is read of a run, and why, as `study, run (why)`: on the terminal, and in
    /// the rows of the test.
    pub fn leave_out(&self, text: String) {
        eprintln!("left out: {text}");
        self.left_out.borrow_mut().push(text);
    }

    /// Notes the realisations of a vibration that have a value; none while it is run anew, whose
    /// runs are those of no row. Later commands with other tests read what is noted.
    pub fn note_shaken(&self, name: &str, realisations: Option<Vec<u32>>) -> Result<(), String> {
        let mut shaken = self.shaken.borrow_mut();
        let folder = self.folder(name);
        let _ = match realisations {
            Some(realisations) => shaken.insert(folder, realisations),
            None => shaken.remove(&folder),
        };
        write_json(&self.out.join(SHAKEN), &*shaken).map_err(|e| e.to_string())
    }

    /// The realisations of a vibration that have a value, as far as they are noted.
    pub fn shaken(&self, name: &str) -> Vec<u32> {
        self.shaken.borrow().get(&self.folder(name)).cloned().unwrap_or_default()
    }

    /// The folder of a study.
    fn folder(&self, name: &str) -> String {
        format!("{name}-{}", self.design())
    }

    /// Options of a study in a folder of its own.
    pub fn options(&self, name: &str) -> RunOptions {
        RunOptions {
            out: self.out.join(self.folder(name)),
            jobs: self.jobs,
            frames: false,
            cancel: Arc::new(AtomicBool::new(false)),
            progress: Arc::new(Lines),
        }
    }

    /// Runs a scenario at all points in all realisations. Runs that fail, and those in which a
    /// check found something, grains are missing, or a pile had not settled, are left out.
    pub fn run(&self, name: &str, scenario: &str, points: &[Point]) -> Result<Vec<Run>, String> {
        let change = |text: &String| text.parse::<Override>().map_err(|e| e.to_string());
        let variations = points.iter().map(|point| {
            Ok(Variation {
                name: point.name.clone(),
                group: name.to_owned(),
                changes: point.changes.iter().map(change).collect::<Result<_, String>>()?,
                configurations: point.most,
            })
        });
        let variations = variations.collect::<Result<Vec<_>, String>>()?;
        let varied = Varied::load(&root().join(scenario), &[], variations)
            .map_err(|e| format!("{scenario}: {e}"))?;
        let options = self.options(name);
        let rows = carry_out_variations(&varied, self.configurations, &options, &mut |_| Ok(()))
            .map_err(|e| e.to_string())?;
        let mut runs = Vec::new();
        for row in rows {
            let point = points.iter().position(|p| p.name == row.variation);
            let (configuration, folder) =
                (row.configuration, options.out.join("runs").join(&row.run));
            let run = point.map(|point| Run { point, configuration, folder });
            let why = match (&row.failure, &run) {
                (None, Some(run)) => run.why_left_out()?,
                (failure, _) => Some(failure.clone().unwrap_or_else(|| "unknown".to_owned())),
            };
            match why {
                None => runs.extend(run),
                Some(why) => self.leave_out(format!("{name}, {} ({why})", row.run)),
            }
        }
        Ok(runs)
    }
}

/// What earlier commands have noted of vibrations in the folder of runs.
pub fn noted_shaken(out: &Path) -> Result<BTreeMap<String, Vec<u32>>, String> {
    let file = out.join(SHAKEN);
    if file.exists() { read_json(&file).map_err(|e| e.to_string()) } else { Ok(BTreeMap::new()) }
}

impl Run {
    /// Why nothing is to be read of the run, if so. Tests that are read in motion have no rest
    /// test: that their numerical creep is not known is nothing against them, and no stage of
    /// theirs says whether it settled, as that of a pile does. Where they begin with a rest, as
    /// triaxial compression does, the check watches the numerical creep of that.
    fn why_left_out(&self) -> Result<Option<String>, String> {
        let summary: Summary =
            read_json(&self.folder.join("summary.json")).map_err(|e| e.to_string())?;
        let found = summary.checks.as_ref().filter(|checks| checks.passed == Some(false));
        let found = found.map(|checks| format!("checks {}", checks.line()));
        let too_few = summary.grains.too_few_in_place(summary.laboratory.is_some());
        let why: Vec<String> =
            found.into_iter().chain(summary.read_while_moving()).chain(too_few).collect();
        Ok((!why.is_empty()).then(|| why.join("; ")))
    }

    /// Its name: that of its folder.
    pub fn name(&self) -> String {
        self.folder.file_name().unwrap_or_default().to_string_lossy().into_owned()
    }

    /// Columns of `series.csv` by their names.
    pub fn series<const N: usize>(&self, names: [&str; N]) -> Result<Vec<[f64; N]>, String> {
        let path = self.folder.join("series.csv");
        let fault = |e: csv::Error| format!("{}: {e}", path.display());
        let mut reader = csv::Reader::from_path(&path).map_err(fault)?;
        let header = reader.headers().map_err(fault)?.clone();
        let mut columns = [0; N];
        for (column, name) in columns.iter_mut().zip(names) {
            *column = header
                .iter()
                .position(|h| h == name)
                .ok_or_else(|| format!("{}: no column {name}", path.display()))?;
        }
        let mut rows = Vec::new();
        for record in reader.records() {
            let record = record.map_err(fault)?;
            let cell = |n: usize| record.get(n).and_then(|c| c.parse().ok()).unwrap_or(f64::NAN);
            rows.push(columns.map(cell));
        }
        Ok(rows)
    }

    /// The specimen at the end of a stage, or of the last one.
    pub fn specimen(&self, stage: Option<&str>) -> Result<Specimen, String> {
        Ok(read_run(&self.folder, stage).map_err(|e| e.to_string())?.specimen)
    }

    /// A number of `summary.json`.
    pub fn summary(&self, pointer: &str) -> Result<Option<f64>, String> {
        let path = self.folder.join("summary.json");
        let summary: serde_json::Value = read_json(&path).map_err(|e| e.to_string())?;
        Ok(summary.pointer(pointer).and_then(serde_json::Value::as_f64))
    }

    /// Settings of the engine.
    fn engine(&self) -> Result<EngineSettings, String> {
        let path = self.folder.join("manifest.json");
        let mut manifest: serde_json::Value = read_json(&path).map_err(|e| e.to_string())?;
        serde_json::from_value(manifest["scenario"]["engine"].take()).map_err(|e| e.to_string())
    }

    /// Stiffness of a contact point in N/m.
    pub fn contact_stiffness(&self) -> Result<f64, String> {
        Ok(self.engine()?.native.contact_stiffness_n_per_m)
    }

    /// Energy in J that contacts hold as springs at the end of a stage, by its number.
    pub fn stored_in_springs(&self, stage: usize) -> Result<f64, String> {
        let specimen = self.specimen(Some(&stage.to_string()))?;
        Ok(spring_energy(&specimen.state.contacts, &self.engine()?))
    }
}

/// Tells of stages, a line each.
struct Lines;

impl Progress for Lines {
    fn begin_stage(&self, _: u64, name: &str, _: f64) {
        eprintln!("{name}");
    }
    fn message(&self, text: &str) {
        eprintln!("{text}");
    }
}
