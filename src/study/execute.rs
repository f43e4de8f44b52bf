//! Runs a plan on several threads, taking from the store what is there.

use std::{
    cell::RefCell,
    sync::{
        Condvar, MutexGuard,
        atomic::{AtomicBool, Ordering},
    },
    thread,
};

use rayon::prelude::*;

use super::recorder::{Recorder, note};
use super::*;
use crate::caught::caught;
use crate::grains::sieve_size_of;
use crate::protocol::{StageError, run as run_stage};
use crate::scenario::automatic_threads;
use crate::world::HeldShape;

/// What the threads share.
struct Board {
    executed: Executed,
    /// Nodes nobody has begun and whose parent is finished.
    ready: Vec<usize>,
    running: usize,
}

/// What became of a plan.
#[derive(Default)]
pub struct Executed {
    /// Finished stages, by node; none where it failed or was not begun.
    pub done: Vec<Option<Arc<StoredStage>>>,
    /// Nodes that failed, in the order in which they did.
    pub failed: Vec<(usize, StudyError)>,
    /// Whether it was stopped.
    pub cancelled: bool,
}

/// How to run runs.
#[derive(Clone)]
pub struct RunOptions {
    /// Folder for results; what is finished there is not done again.
    pub out: PathBuf,
    /// Cores: as many stages that do not need each other run at the same time; where there are
    /// fewer stages, each gets its share of the cores as threads of its world.
    pub jobs: usize,
    /// Whether stages keep frames, for pictures and the viewer: about 20 bytes a
    /// grain and sample.
    pub frames: bool,
    /// Set to stop at the next check.
    pub cancel: Arc<AtomicBool>,
    /// Told of what goes on.
    pub progress: Arc<dyn Progress>,
}

/// What every thread works with.
pub struct Shop<'a> {
    /// Where stages are stored.
    pub store: &'a StageStore,
    /// Makes the worlds.
    pub make_world: WorldMaker<'a>,
    /// Set to stop at the next check.
    pub cancel: &'a AtomicBool,
    /// Told of what goes on.
    pub progress: &'a dyn Progress,
    /// Cores, at least 1: each runs a stage or, where fewer stages are left, a thread of one.
    pub cores: usize,
}

impl<'a> Shop<'a> {
    /// With the cores, the progress and the means to stop that these options give.
    pub fn new(store: &'a StageStore, make_world: WorldMaker<'a>, options: &'a RunOptions) -> Self {
        let RunOptions { jobs, cancel, progress, .. } = options;
        Self { store, make_world, cancel, progress: progress.as_ref(), cores: (*jobs).max(1) }
    }

    /// Runs every stage of a plan; gives the finished stages by node.
    ///
    /// When a stage fails, the stages that need it are not begun, all others are finished and
    /// stored, and the first failure is returned.
    pub fn execute(&self, plan: &Plan) -> Result<Vec<Arc<StoredStage>>, StudyError> {
        let _work = Work::begin(self.progress, plan.expected());
        let mut executed = self.execute_each(plan);
        if !executed.failed.is_empty() {
            return Err(executed.failed.remove(0).1);
        }
        executed.done.into_iter().collect::<Option<Vec<_>>>().ok_or(StudyError::Cancelled)
    }

    /// The same as a part of work that has begun, giving what was finished also where something
    /// failed.
    pub fn execute_each(&self, plan: &Plan) -> Executed {
        let roots = (0..plan.nodes.len()).filter(|&n| plan.nodes[n].parent.is_none()).collect();
        let executed = Executed { done: vec![None; plan.nodes.len()], ..Executed::default() };
        let board = Mutex::new(Board { executed, ready: roots, running: 0 });
        let changed = Condvar::new();
        tell_of_threads(plan, self.progress);
        thread::scope(|scope| {
            let work = || self.work(plan, &board, &changed);
            // This thread is one of them, so that work is done even where there is no other.
            for at_once in 1..self.cores.min(plan.nodes.len()) {
                let thread = thread::Builder::new().name("stages".to_owned());
                if let Err(error) = thread.spawn_scoped(scope, work) {
                    self.progress.message(&format!(
                        "warning: only {at_once} of {} stages {} in parallel: {error}",
                        self.cores,
                        in_number(at_once, "runs", "run")
                    ));
                    break;
                }
            }
            work();
        });
        let executed = board.into_inner().unwrap_or_else(PoisonError::into_inner).executed;
        self.tell_of_stages_before(plan, &executed);
        executed
    }

    /// Says what a reader must know of the stages before one that failed: no summary will.
    fn tell_of_stages_before(&self, plan: &Plan, executed: &Executed) {
        let mut before = BTreeSet::new();
        for (failed, _) in &executed.failed {
            let mut parent = plan.nodes[*failed].parent;
            while let Some(node) = parent {
                before.insert(node);
                parent = plan.nodes[node].parent;
            }
        }
        for node in before {
            let label = &plan.nodes[node].label;
            for warning in executed.done[node].iter().flat_map(|stage| &stage.record.warnings) {
                self.progress.message(&format!("{label}: warning: {warning}"));
            }
        }
    }

    /// Takes one stage after the other until none is left.
    fn work(&self, plan: &Plan, board: &Mutex<Board>, changed: &Condvar) {
        loop {
            let (node, parent, at_once) = {
                let mut held = lock(board);
                loop {
                    if self.cancel.load(Ordering::Relaxed) {
                        held.executed.cancelled = true;
                        held.ready.clear();
                    }
                    // The stage with the longest chain behind it goes first.
                    let next = (0..held.ready.len()).max_by(|&a, &b| {
                        let time = |i: usize| plan.nodes[held.ready[i]].remaining;
                        time(a).total_cmp(&time(b)).then(b.cmp(&a))
                    });
                    if let Some(next) = next {
                        let node = held.ready.swap_remove(next);
                        held.running += 1;
                        let done = &held.executed.done;
                        let parent = plan.nodes[node].parent.and_then(|p| done[p].clone());
                        let at_once = (held.running + held.ready.len()).min(self.cores);
                        break (node, parent, at_once);
                    }
                    if held.running == 0 {
                        changed.notify_all();
                        return;
                    }
                    held = changed.wait(held).unwrap_or_else(PoisonError::into_inner);
                }
            };
            let of_plan = &plan.nodes[node];
            let cores = self.cores / at_once;
            // Whoever waits for this stage waits for ever if a panic keeps it from being counted.
            let result = caught(|| self.finish(node, of_plan, parent.as_deref(), cores));
            let result = result.unwrap_or_else(|what| {
                Err(StudyError::Fault { stage: of_plan.label.clone(), what })
            });
            if let Err(error) = &result {
                let _ = caught(|| self.progress.leave_stage(node as u64));
                if !matches!(error, StudyError::Cancelled) {
                    let _ = caught(|| self.progress.left_out(plan.expected_after(node)));
                }
            }
            let mut held = lock(board);
            held.running -= 1;
            match result {
                Ok(stage) => {
                    held.executed.done[node] = Some(Arc::new(stage));
                    let children =
                        (0..plan.nodes.len()).filter(|&n| plan.nodes[n].parent == Some(node));
                    held.ready.extend(children);
                }
                Err(StudyError::Cancelled) => held.executed.cancelled = true,
                Err(error) => held.executed.failed.push((node, error)),
            }
            drop(held);
            changed.notify_all();
        }
    }

    /// Takes a stage from the store, or runs it on a number of cores and stores it.
    fn finish(
        &self,
        index: usize,
        node: &Node,
        parent: Option<&StoredStage>,
        cores: usize,
    ) -> Result<StoredStage, StudyError> {
        let Self { store, progress, .. } = self;
        let begun = node.begun.as_ref();
        let before_it = parent.map(|parent| (&parent.record, &parent.state));
        let before_it = before_it.or_else(|| begun.map(|begun| (&begun.record, &begun.state)));
        let before = match before_it {
            Some((_, state)) => state.clone(),
            None => SpecimenState::before_everything(node.grains.grains.len()),
        };
        let plausible = |stored: &StoredStage| believed::stage(node, &before, stored);
        let asked = AskedStage {
            identity: &node.identity,
            began_with: before_it.map(|(record, _)| record.specimen_sha256.as_str()),
            plausible: &plausible,
        };
        let (stored, damaged) = store.load(&asked);
        if let Some(why) = damaged {
            progress.message(&format!("{}: {why}", node.label));
        }
        if let Some(stored) = stored {
            progress.already_done(node.expected);
            return Ok(stored);
        }
        let specimen = Specimen { grains: node.grains.clone(), state: before.clone() };
        let id = index as u64;
        progress.begin_stage(id, &node.label, node.expected);
        let began = specimen.state.time;
        let kept = |error| StudyError::File(store.keeping(error));
        let checkpoints =
            if node.has_segments { store.checkpoints(&asked).map_err(kept)? } else { None };
        let sound = |midway: &Midway| believed::midway(node, &before, midway);
        let last = |c: &Checkpoints| c.last(store.keeps_frames(), &sound);
        let (resumed, damaged) = checkpoints.as_ref().map_or_else(Default::default, last);
        for why in damaged {
            progress.message(&format!("{}: a checkpoint is damaged: {why}", node.label));
        }
        let (midway, observed, frames) = match resumed {
            Some(resumed) => (Some(resumed.midway), Some(resumed.observed), resumed.frames),
            None => (None, None, self.frames(node, checkpoints.as_ref()).map_err(kept)?),
        };
        let so_far = midway.as_ref().map_or_else(Vec::new, |midway| midway.warnings.clone());
        let warnings = RefCell::new(so_far);
        let tell = |finding: &str| {
            warnings.borrow_mut().push(finding.to_owned());
            progress.message(&format!("{}: {finding}", node.label));
        };
        let mut recorder = Recorder::new(&node.setup, &node.stage, frames, |row| {
            let time = row.time_s - began;
            progress.update(id, time, &note(row, node.grains.grains.len()));
        });
        recorder.start = began;
        recorder.observed.reference.before_vibration_mm =
            before_it.and_then(|(record, _)| record.before_vibration_mm);
        recorder.on_finding = &tell;
        recorder.checkpoints = checkpoints.as_ref();
        if let (Some(midway), Some(observed)) = (&midway, observed) {
            let done = midway.steps as f64 / node.setup.engine.rate_hz;
            progress.message(&format!("{}: resumes at {done:.2} s", node.label));
            progress.resume_stage(id, done);
            let specimen = Specimen { grains: node.grains.clone(), state: midway.state.clone() };
            recorder.go_on(observed, &specimen);
        }
        let mut setup = Setup::clone(&node.setup);
        let automatic = automatic_threads(cores, node.grains.grains.len());
        let settings = &mut setup.engine.native;
        settings.may_leave_threads = settings.threads.is_none();
        settings.threads = Some(threads_of(settings.threads, automatic, available_cores()));
        let outcome = run_stage(
            &setup,
            self.make_world,
            specimen,
            &node.stage,
            midway,
            &mut recorder,
            self.cancel,
        );
        if let Some(error) = recorder.fault() {
            return Err(kept(error));
        }
        let outcome = outcome.map_err(|error| match error {
            StageError::Cancelled => StudyError::Cancelled,
            StageError::World { source, last_good } => {
                let what = source.to_string();
                let warnings = warnings.borrow();
                match store.keep_failed(node.key(), &last_good.state, &what, &warnings) {
                    Ok(kept) => StudyError::Simulation { stage: node.label.clone(), what, kept },
                    Err(error) => {
                        let reason = format!("{}; what failed was {what}", error.reason);
                        kept(FileError { reason, ..error })
                    }
                }
            }
            other => StudyError::Stage { stage: node.label.clone(), what: other.to_string() },
        })?;
        recorder.end(&outcome.specimen, outcome.simulated);
        let (observed, frames) = recorder.into_parts();
        let sunk = observed.sinking.sunk;
        let creep = checks::creep(&node.stage, &observed.rows, &sunk, &node.setup.scale);
        let checks = StageChecks::of(&outcome.watch, observed.overlap, creep);
        let mut warnings = outcome.warnings;
        warnings.extend(checks::warnings(&checks, &node.stage, &observed.rows, &node.setup.scale));
        let record = StageRecord {
            begun_in: begun.map(|begun| begun.run.to_string_lossy().into_owned()),
            stage: node.stage.name().into(),
            steps: outcome.steps,
            simulated_s: outcome.simulated,
            wall_s: observed.wall_s,
            engine_s: outcome.engine_time.as_secs_f64(),
            warnings,
            checks: Some(checks),
            solver_residuals: outcome.residuals,
            effective: outcome.effective,
            settling: outcome.settling,
            fall: outcome.fall,
            until: outcome.until,
            before_vibration_mm: observed.reference.before_vibration_mm,
            sunk,
            sieved_mm: sieved_mm(&outcome.corners),
            laboratory: observed.laboratory.rows,
            energy: if observed.energy.len() == observed.rows.len() {
                observed.energy
            } else {
                // It went on from a checkpoint of before it was recorded.
                Vec::new()
            },
            end: Some(stage_end::end_of(node.setup.gravity, &outcome.specimen)),
            ..StageRecord::default()
        };
        let series = observed.rows;
        let stage = StoredStage { record, state: outcome.specimen.state, series };
        let (stored, note) = store.save(&asked, stage, frames).map_err(kept)?;
        if let Some(note) = note {
            progress.message(&format!("{}: {note}", node.label));
        }
        if let Some(checkpoints) = checkpoints {
            checkpoints.remove();
        }
        // Not before it is on the disk: whoever reads that it ended relies on it.
        progress.end_stage(id);
        Ok(stored)
    }

    /// Where the frames of a stage are written that begins: beside its
    /// checkpoints, where it has some.
    fn frames(
        &self,
        node: &Node,
        checkpoints: Option<&Checkpoints>,
    ) -> Result<Option<FrameWriter>, FileError> {
        let (grains, pieces) = (node.grains.grains.len(), node.setup.pieces.len());
        match checkpoints {
            Some(checkpoints) if self.store.keeps_frames() => {
                checkpoints.frames(grains, pieces).map(Some)
            }
            Some(_) => Ok(None),
            None => self.store.frames(grains, pieces),
        }
    }
}

/// The processors that this process may use: by its affinity mask and its control group's quota.
pub fn available_cores() -> usize {
    thread::available_parallelism().map_or(1, usize::from)
}

/// Warns once of scenarios that ask for more threads than can run at the same time.
fn tell_of_threads(plan: &Plan, progress: &dyn Progress) {
    static TOLD: AtomicBool = AtomicBool::new(false);
    let there = available_cores();
    let asked = plan.nodes.iter().filter_map(|node| node.setup.engine.native.threads).max();
    let asked = asked.filter(|asked| *asked as usize > there);
    if let Some(asked) = asked.filter(|_| !TOLD.swap(true, Ordering::Relaxed)) {
        progress.message(&format!(
            "warning: engine.native.threads = {asked} exceeds the {there} available cores; using \
             {there}"
        ));
    }
}

/// Threads of a world: those typed or else as many as help, but no more than there are cores.
fn threads_of(typed: Option<u32>, automatic: u32, cores: usize) -> u32 {
    typed.unwrap_or(automatic).min(u32::try_from(cores).unwrap_or(u32::MAX))
}

fn lock(board: &Mutex<Board>) -> MutexGuard<'_, Board> {
    board.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Sieves the grains that the engine held; nothing where it held none.
fn sieved_mm(corners: &[Option<HeldShape>]) -> Vec<Option<f64>> {
    if corners.iter().all(Option::is_none) {
        return Vec::new();
    }
    let size = |held: &HeldShape| sieve_size_of(&held.corners) + 2.0 * held.rounding;
    corners.par_iter().map(|held| Some(to_mm(size(held.as_ref()?)))).collect()
}

#[cfg(test)]
mod tests {
    use std::sync::atomic::AtomicU32;

    use super::*;
    use crate::study::tests::{Heard, planned, scenario, shop};
    use crate::world::{BodyState, World, WorldError, scripted::ScriptedWorld};

    /// Law: where a stage fails, the warnings of those before it are said, each once.
    #[test]
    fn warnings_of_finished_stages_are_said_where_a_later_one_fails() {
        let plan = Plan::new(&[planned(scenario(0.0))]).expect("a plan");
        let folder = tempfile::tempdir().expect("a folder");
        let store = StageStore::open(folder.path()).expect("a store");
        let worlds = AtomicU32::new(0);
        // The grains of the first stage move to its end; the second has no world.
        let failing = |_: &EngineSettings, _, _: &_| {
            if worlds.fetch_add(1, Ordering::Relaxed) > 0 {
                return Err(WorldError::Engine("refused".into()));
            }
            let script = |_, state: &BodyState, _, _| BodyState {
                linear_velocity: Vector::new(0.5, 0.0, 0.0),
                ..*state
            };
            Ok(Box::new(ScriptedWorld::new(1.0 / 240.0, Box::new(script))) as Box<dyn World + Send>)
        };
        let heard = Heard::default();
        let executed = shop(&store, 1, &failing, &heard).execute_each(&plan);
        let failed: Vec<usize> = executed.failed.iter().map(|(node, _)| *node).collect();
        assert_eq!(failed, [plan.runs[0].stages[1]], "law: the pour fails");
        let told = heard.told();
        let of_filling = |text: &&String| {
            text.starts_with("realisation 1, fill the funnel: warning: ")
                && text.contains("had not settled")
        };
        assert_eq!(told.iter().filter(of_filling).count(), 1, "law: said once, got {told:?}");
    }

    /// Keeps what is said, and from where stages go on.
    #[derive(Default)]
    struct GoesOn(Heard, Mutex<Vec<f64>>);

    impl Progress for GoesOn {
        fn resume_stage(&self, _: u64, simulated: f64) {
            self.1.lock().expect("nobody panicked").push(simulated);
        }
        fn message(&self, text: &str) {
            self.0.message(text);
        }
    }

    /// Law: of a stage that goes on from a checkpoint the progress knows from where.
    #[test]
    fn a_stage_that_goes_on_says_from_where() {
        let mut scenario = scenario(0.0);
        scenario.stages.truncate(1);
        scenario.engine.native.checkpoint_every_s = Some(0.1);
        let plan = Plan::new(&[planned(scenario)]).expect("a plan");
        let folder = tempfile::tempdir().expect("a folder");
        let store = StageStore::open(folder.path()).expect("a store");
        let (cancel, worlds) = (AtomicBool::new(false), AtomicU32::new(0));
        // Each segment has a world of its own: the first run is stopped in the third.
        let make_world = |settings: &EngineSettings, _, _: &_| {
            cancel.fetch_or(worlds.fetch_add(1, Ordering::Relaxed) == 2, Ordering::Relaxed);
            let script = |_, state: &BodyState, _, _| BodyState {
                linear_velocity: Vector::new(0.5, 0.0, 0.0),
                ..*state
            };
            let world = ScriptedWorld::new(1.0 / settings.rate_hz, Box::new(script));
            Ok::<_, WorldError>(Box::new(world) as Box<dyn World + Send>)
        };
        let heard = Heard::default();
        let stopped = Shop { cancel: &cancel, ..shop(&store, 1, &make_world, &heard) };
        assert!(stopped.execute_each(&plan).cancelled, "law: stopped on its way");
        let told = GoesOn::default();
        shop(&store, 1, &make_world, &told).execute(&plan).expect("it goes on");
        let (said, from) = (told.0.told(), told.1.into_inner().expect("nobody panicked"));
        let words = from.first().map(|time| format!("resumes at {time:.2} s"));
        let is_said = words.is_some_and(|words| said.iter().any(|text| text.ends_with(&words)));
        assert!(is_said && from.len() == 1 && from[0] > 0.0, "law: once, got {from:?}, {said:?}");
    }

    #[test]
    fn threads_stop_at_the_cores() {
        for (typed, automatic, cores, expected) in [
            (Some(3), 1, 2, 2),
            (Some(4), 2, 2, 2),
            (Some(1), 2, 2, 1),
            (Some(1024), 1, 1, 1),
            (None, 3, 2, 2),
            (None, 1, 8, 1),
        ] {
            let got = threads_of(typed, automatic, cores);
            assert_eq!(got, expected, "law: {typed:?} typed threads on {cores} cores");
        }
    }
}
