//! One scenario, from grains to figures.

use super::*;
use super::{
    begin::{GRAINS_FILE, grains_of, read_grains},
    execute::Executed,
    motions::motions,
    summarise::{Summarised, summarise},
};
use crate::record::{
    distributions, grains_csv, hash_bytes, json_text, read_file, run_file, series_csv, with_energy,
    with_laboratory,
};

/// A scenario whose grains are made and whose laboratory is built: what can refuse it has been
/// tried, and nothing is written yet.
pub struct ReadyRun {
    run: PlannedRun,
    plan: Plan,
}

impl ReadyRun {
    /// Makes or reads the grains of a scenario and builds its laboratory.
    ///
    /// # Errors
    /// [`StudyError`] where one of them cannot be had.
    pub fn new(scenario: &Scenario) -> Result<Self, StudyError> {
        let grains = Arc::new(make_grains(scenario)?);
        let run = PlannedRun::new(scenario.name.clone(), scenario.clone(), grains);
        let plan = Plan::new(std::slice::from_ref(&run))?;
        Ok(Self { run, plan })
    }

    /// Runs the scenario and writes `manifest.json`, `summary.json`,
    /// `series.csv`, `rest_test.csv`, `grains.csv`, `grains.json` and `specimen.json`.
    ///
    /// # Errors
    /// [`StudyError`].
    pub fn carry_out(&self, options: &RunOptions) -> Result<RunRecord, StudyError> {
        let PlannedRun { scenario, grains, .. } = &self.run;
        for warning in of_grains(scenario, grains) {
            options.progress.message(&format!("warning: {warning}"));
        }
        let setup = self.plan.nodes.first().map(|node| &node.setup);
        for (n, name, facts) in setup.into_iter().flat_map(|setup| motions(scenario, setup)) {
            options.progress.message(&format!("stage {n}, {name}: {}", facts.line()));
        }
        let runs = std::slice::from_ref(&self.run);
        let (mut records, _) = carry_out(&self.plan, runs, options, |_| options.out.clone())?;
        Ok(records.remove(0))
    }

    /// Draws figures and pictures of what the run left.
    ///
    /// # Errors
    /// [`StudyError`] where they cannot be written.
    pub fn draw(&self, record: &RunRecord, options: &RunOptions) -> Result<(), StudyError> {
        const ID: u64 = 0;
        options.progress.begin_pieces(ID, "figures and pictures", 3);
        let drawn = self.draw_each(record, options, |done| {
            options.progress.update(ID, f64::from(done), "");
        });
        options.progress.end_stage(ID);
        drawn
    }

    /// The same, telling how many kinds of them are drawn.
    fn draw_each(
        &self,
        record: &RunRecord,
        options: &RunOptions,
        tell: impl Fn(u32),
    ) -> Result<(), StudyError> {
        let grains = &self.run.grains;
        let (figures, known) = (options.out.join("figures"), described(grains));
        crate::report::run_figures(&figures, record)?;
        tell(1);
        let specified = grains.specified();
        crate::report::grain_figures(&figures, &known.sieved, specified.as_ref(), &known.shapes)?;
        tell(2);
        match crate::picture::of_run(&options.out) {
            Ok(pictures) => pictures.iter().try_for_each(|p| p.write(&figures))?,
            // The numbers are there; a run is not lost for want of a picture.
            Err(error) => options.progress.message(&format!("there are no pictures: {error}")),
        }
        Ok(())
    }
}

/// Runs the runs of a plan, all of the same grains, taking from the store in the output folder what
/// is there, and writes the grains, and each run's files into its folder. Gives the records in the
/// order of the runs, and the engine's settings as read back in the first stage. Grains of earlier
/// runs in the output folder stay, unless it is the run's own.
pub(crate) fn carry_out(
    plan: &Plan,
    runs: &[PlannedRun],
    options: &RunOptions,
    folder: impl Fn(&PlannedRun) -> PathBuf,
) -> Result<(Vec<RunRecord>, EffectiveSettings), StudyError> {
    let same = |two: &[PlannedRun]| Arc::ptr_eq(&two[0].grains, &two[1].grains);
    debug_assert!(runs.windows(2).all(same), "one grains.json is that of all runs");
    if let Some(first) = runs.first() {
        if folder(first) == options.out {
            write_grains(&options.out, &first.scenario, &first.grains)?;
        } else {
            write_shared_grains(&options.out, &first.scenario, &first.grains)?;
        }
    }
    let store = StageStore::open(&options.out.join("stages"))?.with_frames(options.frames);
    let done = Shop::new(&store, &crate::world::create, options).execute(plan)?;
    let records = runs
        .iter()
        .zip(&plan.runs)
        .map(|(run, nodes)| write_run(&folder(run), run, plan, nodes, &done))
        .collect::<Result<_, StudyError>>()
        .map_err(|error| error.keeping(&store))?;
    let effective = done.first().map(|d| d.record.effective.clone()).unwrap_or_default();
    Ok((records, effective))
}

/// Runs all runs of a plan, as a part of work that has begun, and writes their folders under
/// `runs/`, each by itself: its record, or why it has none. One that fails does not keep the others
/// from going on.
///
/// # Errors
/// [`StudyError`] where the fault is not a run's own.
pub(crate) fn carry_out_each(
    make_world: WorldMaker,
    plan: &Plan,
    runs: &[PlannedRun],
    store: &StageStore,
    options: &RunOptions,
) -> Result<Vec<Result<RunRecord, String>>, StudyError> {
    let Executed { done, failed, cancelled } =
        Shop::new(store, make_world, options).execute_each(plan);
    let mut reasons = HashMap::new();
    for (node, error) in failed {
        if !is_of_the_run(&error) {
            return Err(error);
        }
        reasons.insert(node, error.to_string());
    }
    if cancelled {
        return Err(StudyError::Cancelled);
    }
    let each = runs.iter().enumerate().map(|(index, run)| {
        let (alone, nodes) = plan.alone(index);
        let finished: Option<Vec<_>> = nodes.iter().map(|&n| done[n].clone()).collect();
        let Some(finished) = finished else {
            // The first stage that is missing is the one that failed.
            let why = nodes.iter().find_map(|n| reasons.get(n).cloned());
            return Ok(Err(why.unwrap_or_else(|| "a stage was not run".to_owned())));
        };
        let folder = folder_of(&options.out, &run.name);
        match write_run(&folder, run, &alone, &alone.runs[0], &finished) {
            Ok(record) => Ok(Ok(record)),
            Err(error) if is_of_the_run(&error) => Ok(Err(error.to_string())),
            Err(error) => Err(error.keeping(store)),
        }
    });
    each.collect()
}

/// Whether a fault is a run's own, so that others can go on.
fn is_of_the_run(error: &StudyError) -> bool {
    matches!(
        error,
        StudyError::Simulation { .. }
            | StudyError::Fault { .. }
            | StudyError::Stage { .. }
            | StudyError::Measure(_)
    )
}

/// Folder of a run in the output folder, by its name.
pub(crate) fn folder_of(out: &Path, run: &str) -> PathBuf {
    out.join("runs").join(run)
}

/// The grains of a scenario: cut from its sieve data, read from its file, with the shapes of its
/// meshes, or those of the run that it begins with.
///
/// # Errors
/// When they cannot be made or read.
pub fn make_grains(scenario: &Scenario) -> Result<GrainSet, StudyError> {
    if let Some(begin) = &scenario.begin {
        let own = match &scenario.grains {
            GrainsSpec::File(file) => Some(Path::new(&file.file)),
            GrainsSpec::Sieved(_) | GrainsSpec::Meshes(_) => None,
        };
        return grains_of(begin, own);
    }
    match &scenario.grains {
        GrainsSpec::Sieved(sieved) => {
            grains::generate(sieved, scenario.seed).map_err(StudyError::grains)
        }
        GrainsSpec::File(file) => {
            let named = |e: FileError| FileError {
                reason: format!("{} (grains.file of `{}` names it)", e.reason, scenario.name),
                ..e
            };
            Ok(read_grains(Path::new(&file.file)).map_err(named)?)
        }
        GrainsSpec::Meshes(meshes) => {
            // The file of such a field is not known any more.
            let named = |fault: Fault| match fault.file.is_empty() {
                true => fault.of(&scenario.name),
                false => fault,
            };
            let made = grains::from_meshes(meshes, scenario.seed);
            Ok(made.map_err(|errors| errors.each(named))?)
        }
    }
}

/// The files that describe a set of grains, by name: `grains.json`, and the tables of its kind.
///
/// # Errors
/// When one of them cannot be made.
pub fn grain_files(
    scenario: &Scenario,
    set: &GrainSet,
) -> Result<Vec<(&'static str, Vec<u8>)>, StudyError> {
    let mut files = vec![(GRAINS_FILE, json_text(Path::new(GRAINS_FILE), &grains::to_json(set))?)];
    let mut add = |name, table: Result<Vec<u8>, String>| {
        let made = table.map_err(|why| FileError::new("write", Path::new(name), why));
        made.map(|content| files.push((name, content)))
    };
    let sieved = match &scenario.grains {
        GrainsSpec::Sieved(sieved) => Some(sieved.clone()),
        GrainsSpec::Meshes(meshes) => meshes.as_sieved(),
        GrainsSpec::File(_) => None,
    };
    if let Some(sieved) = sieved {
        let distribution = ParticleSizeDistribution::new(&sieved).map_err(StudyError::grains)?;
        let table = grains::sieve_csv(&distribution, set);
        add("sieve.csv", table.map_err(|e| e.to_string()))?;
    }
    if matches!(scenario.grains, GrainsSpec::Meshes(_)) {
        let table = grains::meshes_csv(&set.meshes);
        add("stones.csv", table.map_err(|e| e.to_string()))?;
    }
    Ok(files)
}

/// Writes the files of [`grain_files`] into a folder, which is made if needed.
///
/// # Errors
/// When one of them cannot be made or written.
fn write_grains(out: &Path, scenario: &Scenario, set: &GrainSet) -> Result<(), StudyError> {
    create_folder(out)?;
    for (name, content) in grain_files(scenario, set)? {
        write_file(&out.join(name), &content)?;
    }
    Ok(())
}

/// The same beside `runs/`, where runs look for grains that are not in their folders; where earlier
/// runs have other grains there, these stay, and each run keeps its own ([`write_run`]).
///
/// # Errors
/// As [`write_grains`].
pub(crate) fn write_shared_grains(
    out: &Path,
    scenario: &Scenario,
    set: &GrainSet,
) -> Result<(), StudyError> {
    let path = out.join(GRAINS_FILE);
    let own = json_text(&path, &grains::to_json(set))?;
    // What is no file of grains is nobody's.
    if read_file(&path).is_ok_and(|there| there != own) && read_grains(&path).is_ok() {
        return Ok(());
    }
    write_grains(out, scenario, set)
}

/// Measures a finished run and writes its files into a folder.
pub(super) fn write_run(
    out: &Path,
    run: &PlannedRun,
    plan: &Plan,
    nodes: &RunNodes,
    done: &[Arc<StoredStage>],
) -> Result<RunRecord, StudyError> {
    create_folder(out)?;
    let last = *nodes
        .stages
        .last()
        .ok_or_else(|| StudyError::Scenario("a scenario needs at least one stage".to_owned()))?;
    let Summarised { summary, specimen, fates, series, laboratory, rest_test, void_profile } =
        summarise(run, &plan.nodes[last].setup, nodes, done)?;
    let stages: Vec<&StoredStage> = nodes.stages.iter().map(|&n| &*done[n]).collect();
    let mut written = BTreeMap::new();
    let mut write = |name: &str, content: Result<Vec<u8>, csv::Error>| {
        let path = out.join(name);
        let content = content.map_err(|e| FileError::new("write", &path, e))?;
        written.insert(name.to_owned(), hash_bytes(&content));
        write_file(&path, &content)
    };
    let table = |series: &[SeriesRow], stages: &[&StoredStage], pieces: &[LaboratoryRow]| {
        let energy = inside::energy_rows(stages);
        let csv = series_csv(series).and_then(|csv| with_energy(&csv, &energy));
        match pieces {
            [] => csv,
            pieces => with_laboratory(&csv?, &laboratory::names(&run.scenario), pieces),
        }
    };
    write("series.csv", table(&series, &stages, &laboratory))?;
    let known = described(&run.grains);
    let at_end = &done[last].record.sieved_mm;
    let turned = inside::turned_in_last(&stages, nodes.begun.as_deref().map(|b| &b.state));
    let sieved = known.sieved.grains();
    let grains = grains_csv(&specimen, &fates, sieved, &known.shapes, at_end, &turned);
    write("grains.csv", grains)?;
    if !rest_test.is_empty() {
        let stage = nodes.rest_test.map(|n| &*done[n]);
        let pieces = stage.map_or(&[][..], |stage| &stage.record.laboratory);
        write("rest_test.csv", table(&rest_test, stage.as_slice(), pieces))?;
    }
    if !void_profile.is_empty() {
        write("void_profile.csv", to_csv(&void_profile))?;
    }
    let classes = distributions(&summary);
    if !classes.is_empty() {
        write("distributions.csv", to_csv(&classes))?;
    }
    let text = json_text(&out.join("specimen.json"), &specimen.state)?;
    write("specimen.json", Ok(text))?;
    let grains = json_text(&out.join(GRAINS_FILE), &grains::to_json(&run.grains))?;
    // Those that runs share are written already; other grains stand with their run.
    let is_there = read_file(&run_file(out, GRAINS_FILE)).is_ok_and(|there| there == grains);
    if !is_there {
        write_grains(out, &run.scenario, &run.grains)?;
    }
    written.insert(GRAINS_FILE.to_owned(), hash_bytes(&grains));
    write_json(&out.join("manifest.json"), &manifest(run, plan, nodes, done, &written))?;
    write_json(&out.join("summary.json"), &summary)?;
    if let Some(pile) = &summary.angle_of_repose {
        crate::report::pile_figures(&out.join("figures"), &specimen, pile)?;
    }
    Ok(RunRecord {
        name: run.name.clone(),
        kind: run.kind,
        configuration: run.scenario.configuration,
        falling_height_mm: summary.falling_height_mm.unwrap_or(0.0),
        summary,
        series,
        rest_test,
    })
}

/// What made a run: scenario, versions, settings as the engine held them,
/// stages by name and hash, and the hashes of files that are read again.
fn manifest(
    run: &PlannedRun,
    plan: &Plan,
    nodes: &RunNodes,
    done: &[Arc<StoredStage>],
    written: &BTreeMap<String, String>,
) -> serde_json::Value {
    let stage = |&n: &usize| {
        let record = &done[n].record;
        json!({
            "stage": record.stage,
            "key": plan.nodes[n].key(),
            "steps": record.steps,
            "simulated_s": record.simulated_s,
            "wall_s": record.wall_s,
            "engine_s": record.engine_s,
            "specimen_sha256": record.specimen_sha256,
            "series_sha256": record.series_sha256,
            "warnings": record.warnings,
        })
    };
    let last = nodes.stages.last().copied();
    let motions_of = |stage: &str| -> Vec<serde_json::Value> {
        let all = last.into_iter().flat_map(|n| motions(&run.scenario, &plan.nodes[n].setup));
        let of = all.filter(|(_, name, _)| *name == stage);
        of.map(|(n, _, facts)| json!({ "stage": n, "motion": facts })).collect()
    };
    let effective = last.map(|n| &done[n].record.effective);
    json!({
        "pluvia": env!("CARGO_PKG_VERSION"),
        "backend": crate::world::info(run.scenario.engine.backend),
        "target": format!("{}-{}", std::env::consts::ARCH, std::env::consts::OS),
        "scenario": run.scenario.as_typed(),
        // Null where it began with loose grains.
        "began_with": run.scenario.begin.as_ref().map(|begin| json!({
            "run": begin.folder(),
            "after": begin.after,
            "key": begin.key,
            "specimen_sha256": begin.specimen_sha256,
        })),
        "scale": scale::read_back(&run.grains.scale(run.scenario.gravity_m_per_s2)),
        "engine_settings_read_back": effective,
        "vibrations": motions_of("vibrate"),
        "moves": motions_of("move"),
        "stages": nodes.stages.iter().map(stage).collect::<Vec<_>>(),
        "rest_test": nodes.rest_test.as_ref().map(stage),
        "files_sha256": written,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::study::tests::{planned, run_options, scenario};

    /// Law: the grains of each run in a folder are those that its manifest has the hash of, also
    /// after another command ran there with other grains, and the earlier one again.
    #[test]
    fn later_grains_leave_those_of_earlier_runs() {
        let _turn = crate::world::shared_turn();
        let folder = tempfile::tempdir().expect("a folder");
        let options = run_options(folder.path().join("out"));
        let made = |name: &str, seed: u64| {
            let mut scenario = Scenario { seed, rest_test_s: 0.1, ..scenario(0.0) };
            scenario.stages.truncate(1);
            let runs = [PlannedRun { name: name.to_owned(), ..planned(scenario) }];
            let plan = Plan::new(&runs).expect("a plan");
            let found = carry_out(&plan, &runs, &options, |of| folder_of(&options.out, &of.name));
            found.unwrap_or_else(|e| panic!("{name}: {e}"));
        };
        let check = |names: &[&str], when: &str| {
            for name in names {
                let folder = folder_of(&options.out, name);
                let manifest: serde_json::Value =
                    read_json(&folder.join("manifest.json")).expect("a manifest");
                let expected = manifest["files_sha256"][GRAINS_FILE].as_str().expect("a hash");
                let got = hash_bytes(&read_file(&run_file(&folder, GRAINS_FILE)).expect("grains"));
                assert_eq!(got, expected, "law: {when}, {name} has its grains");
            }
        };
        made("first", 1);
        made("second", 2);
        check(&["first", "second"], "after other grains");
        made("second", 1);
        made("third", 1);
        check(&["first", "second", "third"], "after the earlier grains again");
    }
}
