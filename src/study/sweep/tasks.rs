//! The stages of a planned sweep one by one, for engines that spread them over
//! many machines with a folder in common.

use super::super::variations::collect_stored;
use super::*;

/// The stages of a sweep, in levels: those of a level need only such of the
/// levels before, so that a level can be run all at once.
pub struct SweepTasks {
    study: SweepStudy,
    run: RunOptions,
    plan: Plan,
    /// To be read: who asks what is stored writes nothing.
    store: StageStore,
    levels: Vec<Vec<usize>>,
}

/// A stage of a planned sweep.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct SweepStage<'a> {
    /// Name in the store.
    pub key: &'a str,
    /// Name of the stage that it goes on from; none of the first of a run.
    pub parent: Option<&'a str>,
    /// For people: `point-0001-c1, pour from 50 mm`.
    pub label: &'a str,
}

/// How far a sweep is.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct SweepStatus {
    /// Stages of all runs, shared ones once.
    pub stages: usize,
    /// How many are stored.
    pub stored: usize,
    /// Runs of the plan.
    pub runs: usize,
    /// Runs whose stages are all stored.
    pub complete: usize,
    /// Stages that failed when they were last run: name and reason.
    pub failed: Vec<(String, String)>,
}

impl SweepTasks {
    /// Reads the plan of a folder and makes its stages again; nothing is written.
    ///
    /// # Errors
    /// [`StudyError`]; [`StudyError::Scenario`] where the scenario, or the
    /// program, is no longer what it was when the plan was made.
    pub fn read(run: RunOptions) -> Result<Self, StudyError> {
        let file = SweepPlan::read(&run.out)?;
        let study = SweepStudy::new(file.options(&run.out)?)?;
        let now = study.plan()?;
        edited::refuse_planned(&run.out, &file, &now)?;
        let runs = study.varied.runs(study.options.configurations)?;
        let plan = Plan::named(&runs)?;
        let mut depth = vec![0; plan.nodes.len()];
        let mut levels: Vec<Vec<usize>> = Vec::new();
        // Parents come before children.
        for (n, node) in plan.nodes.iter().enumerate() {
            depth[n] = node.parent.map_or(0, |parent| depth[parent] + 1);
            levels.resize(levels.len().max(depth[n] + 1), Vec::new());
            levels[depth[n]].push(n);
        }
        let store = StageStore::to_be_read(&run.out.join("stages")).with_frames(run.frames);
        Ok(Self { study, run, plan, store, levels })
    }

    /// Puts what is stored of the sweep into its files, whoever carried it out; a run that is not
    /// whole is a row that says so.
    ///
    /// # Errors
    /// [`StudyError`].
    pub fn collect(&self) -> Result<Sweep, StudyError> {
        let Self { study, run, .. } = self;
        let rows = collect_stored(&study.varied, study.options.configurations, run)?;
        study.write(&rows, &run.out)
    }

    /// How many stages each level has.
    pub fn levels(&self) -> Vec<usize> {
        self.levels.iter().map(Vec::len).collect()
    }

    /// The stages of a level, in their order.
    pub fn stages(&self, level: usize) -> Vec<SweepStage<'_>> {
        let node = |n: usize| &self.plan.nodes[n];
        let stage = |n: &usize| SweepStage {
            key: node(*n).key(),
            parent: node(*n).parent.map(|parent| node(parent).key()),
            label: &node(*n).label,
        };
        self.levels.get(level).map_or_else(Vec::new, |nodes| nodes.iter().map(stage).collect())
    }

    /// Cores that a stage of a level needs: the threads that its scenario asks for.
    pub fn cores(&self, level: usize) -> u32 {
        let nodes = self.levels.get(level).into_iter().flatten();
        let threads = |n: &usize| self.plan.nodes[*n].setup.engine.native.threads;
        nodes.filter_map(threads).max().unwrap_or(1)
    }

    /// Level and number, within it, of the stage whose key begins so.
    ///
    /// # Errors
    /// [`StudyError::Scenario`] where no stage has such a key, or several have.
    pub fn find(&self, key: &str) -> Result<(usize, usize), StudyError> {
        let mut found = self.levels.iter().enumerate().flat_map(|(level, nodes)| {
            let of_level = nodes.iter().enumerate();
            let fits = of_level.filter(|(_, n)| self.plan.nodes[**n].key().starts_with(key));
            fits.map(move |(task, _)| (level, task))
        });
        match (found.next(), found.next()) {
            (Some(only), None) => Ok(only),
            (None, _) => refused(format!("the plan has no stage `{key}`")),
            (Some(_), Some(_)) => refused(format!(
                "keys of several stages of the plan begin with `{key}`; give more of the key"
            )),
        }
    }

    /// Numbers, within their level, of the stages of a level that are not stored.
    pub fn missing(&self, level: usize) -> Vec<usize> {
        let Some(nodes) = self.levels.get(level) else { return Vec::new() };
        let held = held(&self.plan, &self.store);
        nodes.iter().enumerate().filter(|(_, n)| !held[**n]).map(|(task, _)| task).collect()
    }

    /// Runs one stage and stores it; one that is stored is left alone.
    ///
    /// # Errors
    /// [`StudyError::Scenario`] for a stage that there is not, or one whose
    /// beginning is not stored; [`StudyError`] of the stage.
    pub fn carry_out(&self, level: usize, task: usize) -> Result<String, StudyError> {
        let node = self.levels.get(level).and_then(|nodes| nodes.get(task)).copied();
        let node = node.ok_or_else(|| {
            let levels = self.levels();
            let has =
                levels.iter().enumerate().map(|(n, stages)| format!("level {n} has {stages}"));
            let has = has.collect::<Vec<_>>().join(", ");
            let what = format!("the plan has no stage {task} on level {level}: {has}");
            StudyError::Scenario(what)
        })?;
        let (chain, label) = (self.chain(node), self.plan.nodes[node].label.clone());
        let store = StageStore::open(&self.run.out.join("stages"))?.with_frames(self.run.frames);
        let is_held = held(&chain, &store);
        let before = chain.nodes.len() - 1;
        if let Some(needed) = (0..before).find(|n| !is_held[*n]).map(|n| &chain.nodes[n]) {
            return refused(format!("{label} needs {}, which is not stored", needed.label));
        }
        let shop = Shop::new(&store, &crate::world::create, &self.run);
        Shop { cores: 1, ..shop }.execute(&chain)?;
        Ok(label)
    }

    /// A stage with all that it goes on from, as a plan of its own.
    fn chain(&self, node: usize) -> Plan {
        let mut numbers = vec![node];
        while let Some(parent) = self.plan.nodes[numbers[numbers.len() - 1]].parent {
            numbers.push(parent);
        }
        numbers.reverse();
        Plan { nodes: self.plan.part(&numbers), runs: Vec::new() }
    }

    /// How far it is.
    pub fn status(&self) -> SweepStatus {
        let is_held = held(&self.plan, &self.store);
        let all = |run: &&RunNodes| run.stages.iter().chain(&run.rest_test).all(|n| is_held[*n]);
        let complete = self.plan.runs.iter().filter(all);
        let nodes = self.plan.nodes.iter();
        let failed = nodes.zip(&is_held).filter(|(_, held)| !**held).map(|(node, _)| node);
        SweepStatus {
            stages: self.plan.nodes.len(),
            stored: is_held.iter().filter(|held| **held).count(),
            runs: self.plan.runs.len(),
            complete: complete.count(),
            failed: failed
                .filter_map(|node| Some((node.label.clone(), self.store.failure(node.key())?)))
                .collect(),
        }
    }

    /// Folder of the sweep.
    pub fn folder(&self) -> &Path {
        &self.run.out
    }
}
