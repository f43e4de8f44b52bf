//! Many variations of one scenario, one table.
//!
//! A variation is a name and what it changes in a base scenario. Every variation is run in the same
//! configurations, so that runs can be compared pair by pair; stages that variations share are done
//! once, and what is stored is not done again.

mod keep;
#[cfg(test)]
mod tests;

pub(super) use keep::keep_and_read;

use super::plan::stage_label;
use super::*;
use crate::record::{variations_csv, write_csv};
use crate::report::NOT_STORED;

/// A variation of a scenario.
#[derive(Debug, Clone, PartialEq)]
pub struct Variation {
    /// Its name, also of its runs' folders: letters, digits, dots and dashes.
    pub name: String,
    /// What it is part of, a ladder for one.
    pub group: String,
    /// What it changes.
    pub changes: Vec<Override>,
    /// Most configurations, where they are costly.
    pub configurations: Option<u32>,
}

impl Variation {
    /// A variation in as many configurations as any.
    pub fn new(name: impl Into<String>, group: impl Into<String>, changes: Vec<Override>) -> Self {
        Self { name: name.into(), group: group.into(), changes, configurations: None }
    }

    /// Whether it is run in the n-th configuration, counted from 0.
    fn has(&self, number: u32) -> bool {
        self.configurations.is_none_or(|most| number < most)
    }
}

/// A base scenario and its variations, loaded and checked.
#[derive(Debug, Clone)]
pub struct Varied {
    /// The scenario as it is without a variation.
    pub base: Scenario,
    /// Each variation with its scenario.
    pub all: Vec<(Variation, Scenario)>,
}

impl Varied {
    /// Loads a scenario, changed by what all variations share, and lays each variation over it.
    ///
    /// # Errors
    /// As [`load_scenario`]: the faults of the base scenario, or else those of all
    /// variations, each with the variation's name.
    pub fn load(
        base: &Path,
        common: &[Override],
        variations: Vec<Variation>,
    ) -> Result<Self, ScenarioErrors> {
        Self::load_told(base, common, variations, |variation, f| Fault {
            file: format!("variation `{}`: {}", variation.name, f.file),
            ..f
        })
    }

    /// The same, with the faults of a variation as a function says them.
    ///
    /// # Errors
    /// As [`Varied::load`].
    pub(super) fn load_told(
        base: &Path,
        common: &[Override],
        variations: Vec<Variation>,
        told: impl Fn(&Variation, Fault) -> Fault,
    ) -> Result<Self, ScenarioErrors> {
        let scenario = load_scenario(base, common)?.scenario;
        let mut faults = Vec::new();
        let mut all = Vec::new();
        for variation in variations {
            let changes = [common, &variation.changes].concat();
            match load_scenario(base, &changes) {
                Ok(loaded) => all.push((variation, loaded.scenario)),
                Err(ScenarioErrors::Faults(found)) => {
                    faults.extend(found.into_iter().map(|fault| told(&variation, fault)));
                }
                Err(unreadable) => return Err(unreadable),
            }
        }
        if !faults.is_empty() {
            return Err(ScenarioErrors::Faults(faults));
        }
        Ok(Self { base: scenario, all })
    }

    /// The scenario of each variation.
    pub fn scenarios(&self) -> impl Iterator<Item = &Scenario> {
        self.all.iter().map(|(_, scenario)| scenario)
    }

    /// Every variation in all configurations, one variation after the other.
    pub(super) fn runs(&self, configurations: u32) -> Result<Vec<PlannedRun>, StudyError> {
        let mut grains = GrainSets::default();
        let mut runs = Vec::new();
        for (variation, scenario) in &self.all {
            let set = grains.of(scenario)?;
            let run = |number| planned_run(variation, scenario, number, set.clone());
            runs.extend((0..configurations).map(run));
        }
        Ok(runs)
    }

    /// What a study is asked that has every variation in a number of configurations.
    pub(super) fn question(&self, configurations: u32) -> Value {
        let texts =
            |changes: &[Override]| -> Value { changes.iter().map(Override::text).collect() };
        let changes = self.all.iter().map(|(of, _)| (of.name.clone(), texts(&of.changes)));
        let variations: Value = changes.collect();
        json!({
            "scenario": in_question(&self.base),
            (AT_LEAST): { "configurations": configurations, "variations": variations },
        })
    }

    /// A hash of everything that is to be done, the engine's precision aside, of results as this
    /// build computes them.
    pub fn programme(&self, configurations: u32) -> String {
        self.programme_of_format(configurations, STAGE_FORMAT)
    }

    fn programme_of_format(&self, configurations: u32, format: u32) -> String {
        let named: Vec<(&str, Option<u32>, &Scenario)> =
            self.all.iter().map(|(v, s)| (v.name.as_str(), v.configurations, s)).collect();
        hash_json(&(named, configurations, format))
    }
}

/// Writes `variations.json`, `variations.csv` with one row a variation and
/// `variation-runs.csv` with one a run.
///
/// # Errors
/// When a file cannot be written.
pub fn write_variations(out: &Path, runs: &[RunRow]) -> Result<(), StudyError> {
    let variations = VariationRow::of(runs);
    write_csv(&out.join("variations.csv"), variations_csv(&variations))?;
    write_csv(&out.join("variation-runs.csv"), to_csv(runs))?;
    let both = json!({ "runs": runs, "variations": variations });
    Ok(write_json(&out.join("variations.json"), &both)?)
}

/// Runs every variation in configurations 1 to `configurations` of its scenario and gives one row a
/// run. The first configuration of all comes first, then the second, so that what there is after an
/// interruption is a whole table; where variations are few for the cores, several configurations
/// together. `so_far` is reported all rows whenever some are added.
///
/// # Errors
/// When grains cannot be made, files not be written, or everything is stopped.
/// A run that fails is a row that says so.
pub fn carry_out_variations(
    varied: &Varied,
    configurations: u32,
    options: &RunOptions,
    so_far: &mut dyn FnMut(&[RunRow]) -> Result<(), StudyError>,
) -> Result<Vec<RunRow>, StudyError> {
    let ranges = ranges(configurations, varied.all.len(), options.jobs);
    carry_out_in(&crate::world::create, varied, &ranges, options, so_far)
}

/// Runs of a range for each core, at least: at its end cores wait for the longest run, which may be
/// several times as long as the others.
const RUNS_PER_CORE: usize = 4;

/// Ranges of configurations that run together, large enough for every core to have several runs,
/// which is faster than several threads of one.
fn ranges(configurations: u32, variations: usize, cores: usize) -> Vec<Range<u32>> {
    let runs = cores.saturating_mul(RUNS_PER_CORE);
    let together = runs.div_ceil(variations.max(1)).max(1);
    let together = u32::try_from(together).unwrap_or(u32::MAX);
    let begin = (0..configurations).step_by(together as usize);
    begin.map(|first| first..first.saturating_add(together).min(configurations)).collect()
}

/// Carries out variations and, whenever more of them are done, makes of all rows so far what they
/// say together; the last of it.
pub(super) fn conclude_so_far<T>(
    varied: &Varied,
    configurations: u32,
    options: &RunOptions,
    mut conclude: impl FnMut(&[RunRow]) -> Result<T, StudyError>,
) -> Result<T, StudyError> {
    let mut found = None;
    carry_out_variations(varied, configurations, options, &mut |rows| {
        found = Some(conclude(rows)?);
        Ok(())
    })?;
    found.ok_or_else(|| StudyError::Scenario("there is nothing to be run".to_owned()))
}

/// The same in ranges of configurations, counted from 0, one range after the
/// other and all of a range together, in worlds of the caller's making.
pub(super) fn carry_out_in(
    make_world: WorldMaker,
    varied: &Varied,
    configurations: &[Range<u32>],
    options: &RunOptions,
    so_far: &mut dyn FnMut(&[RunRow]) -> Result<(), StudyError>,
) -> Result<Vec<RunRow>, StudyError> {
    let (mut grains, store) = open(varied, options)?;
    let of = |number: u32| varied.all.iter().filter(|(variation, _)| variation.has(number)).count();
    let in_all: usize = configurations.iter().flat_map(Range::clone).map(of).sum();
    let mut work = None;
    let mut rows = Vec::new();
    for together in configurations {
        let mut all = Vec::new();
        for number in together.clone() {
            all.extend(planned(varied, number, &mut grains)?);
        }
        for batch in batches(all) {
            let (runs, begun): (Vec<_>, Vec<_>) = batch.into_iter().unzip();
            let plan = Plan::named(&runs)?;
            // What there is to do in all follows from the first batch and the numbers of runs.
            let expected = plan.expected() * in_all as f64 / runs.len().max(1) as f64;
            work.get_or_insert_with(|| Work::begin(options.progress.as_ref(), expected));
            rows.extend(carry_out_batch(make_world, &plan, &runs, begun, &store, options)?);
            so_far(&rows)?;
        }
    }
    Ok(rows)
}

/// The output folder of a study: sets of grains with that of the base scenario,
/// which is written there, and the store.
fn open(varied: &Varied, options: &RunOptions) -> Result<(GrainSets, StageStore), StudyError> {
    let mut grains = GrainSets::default();
    let own = grains.of(&varied.base)?;
    // What cannot be built is refused before a file is written.
    let first = planned(varied, 0, &mut grains)?;
    let first: Vec<PlannedRun> = first.into_iter().map(|(run, _)| run).collect();
    Plan::new(&first)?;
    write_shared_grains(&options.out, &varied.base, &own)?;
    let store = StageStore::open(&options.out.join("stages"))?;
    Ok((grains, store))
}

/// The rows of runs whose stages are all stored, by whatever program carried
/// them out; the others say in `failure` what is missing.
pub(super) fn collect_stored(
    varied: &Varied,
    configurations: u32,
    options: &RunOptions,
) -> Result<Vec<RunRow>, StudyError> {
    let (mut grains, store) = open(varied, options)?;
    let mut rows = Vec::new();
    for number in 0..configurations {
        for planned in planned(varied, number, &mut grains)? {
            let (run, row) = planned;
            let plan = Plan::named(std::slice::from_ref(&run))?;
            let missing = held(&plan, &store).into_iter().position(|held| !held);
            rows.extend(match missing {
                Some(missing) => {
                    let node = &plan.nodes[missing];
                    let why = store.failure(node.key());
                    let why = why.map_or_else(String::new, |why| format!(": {why}"));
                    let is_rest_test = plan.runs[0].rest_test == Some(missing);
                    let label = stage_label(&node.stage, is_rest_test);
                    let failure = format!("{label} {NOT_STORED}{why}");
                    vec![RunRow { failure: Some(failure), ..row }]
                }
                None => {
                    let _work = Work::begin(options.progress.as_ref(), plan.expected());
                    let make = &crate::world::create;
                    carry_out_batch(make, &plan, &[run], vec![row], &store, options)?
                }
            });
        }
    }
    Ok(rows)
}

/// Every variation in its n-th configuration, counted from 0, with the row that it will complete.
fn planned(
    varied: &Varied,
    number: u32,
    grains: &mut GrainSets,
) -> Result<Vec<Planned>, StudyError> {
    let mut planned = Vec::new();
    for (variation, scenario) in &varied.all {
        if !variation.has(number) {
            continue;
        }
        let run = planned_run(variation, scenario, number, grains.of(scenario)?);
        let mut row =
            RunRow::of_scenario(&run.name, &variation.name, &variation.group, &run.scenario);
        // Pairs are told by their number, whatever mixing a variation begins with.
        row.configuration = number + 1;
        row.changes = variation.changes.iter().map(Override::text).collect::<Vec<_>>().join("; ");
        planned.push((run, row));
    }
    Ok(planned)
}

/// Sets of grains, each made once.
#[derive(Default)]
struct GrainSets(Vec<(String, Arc<GrainSet>)>);

impl GrainSets {
    fn of(&mut self, scenario: &Scenario) -> Result<Arc<GrainSet>, StudyError> {
        let key = hash_json(&(&scenario.grains, scenario.seed, &scenario.begin));
        if let Some((_, set)) = self.0.iter().find(|(known, _)| *known == key) {
            return Ok(set.clone());
        }
        let set = Arc::new(make_grains(scenario)?);
        self.0.push((key, set.clone()));
        Ok(set)
    }
}

/// A run of a variation in its n-th configuration, counted from 0.
fn planned_run(
    variation: &Variation,
    scenario: &Scenario,
    number: u32,
    grains: Arc<GrainSet>,
) -> PlannedRun {
    let mut scenario = scenario.clone();
    scenario.configuration = scenario.configuration.saturating_add(number);
    let precision = crate::world::info(scenario.engine.backend).precision;
    let suffix = if precision == "single" { "-single" } else { "" };
    let name = format!("{}-c{}{suffix}", variation.name, number + 1);
    PlannedRun::new(name, scenario, grains)
}

/// A run with the row that it will complete.
type Planned = (PlannedRun, RunRow);

/// Runs whose worlds may live at the same time: Bullet keeps the contact
/// threshold, in its own units of length, once for a process.
fn batches(planned: Vec<Planned>) -> Vec<Vec<Planned>> {
    let threshold = |(run, _): &Planned| {
        let engine = &run.scenario.engine;
        (engine.backend == Backend::Bullet)
            .then(|| (engine.contact_threshold_mm * engine.length_scale).to_bits())
    };
    let batches = grouped(planned.into_iter().map(|one| (threshold(&one), one)));
    batches.into_iter().map(|(_, batch)| batch).collect()
}

/// Runs the runs of a plan together and completes their rows.
fn carry_out_batch(
    make_world: WorldMaker,
    plan: &Plan,
    runs: &[PlannedRun],
    begun: Vec<RunRow>,
    store: &StageStore,
    options: &RunOptions,
) -> Result<Vec<RunRow>, StudyError> {
    let each = carry_out_each(make_world, plan, runs, store, options)?;
    let mut rows = Vec::new();
    for ((run, row), result) in runs.iter().zip(begun).zip(each) {
        rows.push(match result {
            Ok(record) => row.with_results(&record.summary),
            Err(why) => {
                options.progress.message(&format!("{} failed: {why}", run.name));
                RunRow { failure: Some(why), ..row }
            }
        });
    }
    Ok(rows)
}
