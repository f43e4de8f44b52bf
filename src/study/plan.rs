//! From runs to the stages they share.
//!
//! A run is a chain of stages. Runs that begin alike share their first stages, so that a plan is a
//! forest: every stage has one parent at most. A stage is named by the hash of everything that
//! determines it, its parent's name included.

use super::*;
use super::{
    begin::Begun,
    stage_key::{grains_hash, identity},
};
use crate::plain::four_digits;
use crate::protocol::segments;
use crate::scenario::{DepositKind, DepositSpec};

/// A run to run.
#[derive(Debug, Clone)]
pub struct PlannedRun {
    /// Name of its folder.
    pub name: String,
    /// What it is in the paper's programme.
    pub kind: RunKind,
    /// What is done.
    pub scenario: Scenario,
    /// Its grains, shared by runs that have the same.
    pub grains: Arc<GrainSet>,
    /// Stages run by another engine than the scenario's, for runs that
    /// begin with a specimen which that one made.
    pub prepared: Option<Prepared>,
}

impl PlannedRun {
    /// A run by the scenario's engine alone, of the kind that its stages say.
    pub fn new(name: String, scenario: Scenario, grains: Arc<GrainSet>) -> Self {
        Self { name, kind: kind_of(&scenario), scenario, grains, prepared: None }
    }
}

/// What a scenario is in the paper's programme, by its stages.
fn kind_of(scenario: &Scenario) -> RunKind {
    let of_stage = |stage: &StageSpec| match stage {
        StageSpec::Vibrate(stage) => stage.periods,
        _ => 0,
    };
    if scenario.stages.iter().any(|stage| matches!(stage, StageSpec::SlowPluviation { .. })) {
        return RunKind::Repose;
    }
    match scenario.stages.iter().map(of_stage).sum::<u32>() {
        0 => RunKind::Pluviation,
        1 => RunKind::VibrationContinuous,
        _ => RunKind::VibrationIntermittent,
    }
}

/// The beginning of a run by another engine.
#[derive(Debug, Clone)]
pub struct Prepared {
    /// How many of the first stages.
    pub stages: usize,
    /// The engine.
    pub engine: EngineSettings,
}

/// One stage of a plan.
#[derive(Debug, Clone)]
pub struct Node {
    /// What it is in the store.
    pub identity: StageIdentity,
    /// Index of the stage before; `None` for the first of a run.
    pub parent: Option<usize>,
    /// The specimen of another run that the first stage of a run begins with.
    pub begun: Option<Arc<Begun>>,
    /// What is done.
    pub stage: StageSpec,
    /// The laboratory.
    pub setup: Arc<Setup>,
    /// The grains.
    pub grains: Arc<GrainSet>,
    /// Whether it may take longer than one segment, and can go on from their ends.
    pub has_segments: bool,
    /// For people: `realisation 1, pour from 50 mm`.
    pub label: String,
    /// Simulated time expected, in s.
    pub expected: f64,
    /// Simulated time expected from here to the end of the longest chain, in s.
    pub remaining: f64,
}

impl Node {
    /// Name in the store.
    pub fn key(&self) -> &str {
        &self.identity.key
    }
}

/// Which stages make a run.
#[derive(Debug, Clone)]
pub struct RunNodes {
    /// The scenario's stages, in order.
    pub stages: Vec<usize>,
    /// The rest test after the last of them.
    pub rest_test: Option<usize>,
    /// The specimen of another run that it begins with.
    pub begun: Option<Arc<Begun>>,
}

/// Stages and the runs made of them.
#[derive(Debug, Clone)]
pub struct Plan {
    /// Every stage once; parents before children.
    pub nodes: Vec<Node>,
    /// In the order of the planned runs.
    pub runs: Vec<RunNodes>,
}

impl Plan {
    /// Plans runs; an error where a scenario's apparatus cannot be built.
    pub fn new(runs: &[PlannedRun]) -> Result<Self, StudyError> {
        let mut plan = Self { nodes: Vec::new(), runs: Vec::new() };
        let mut known: HashMap<String, usize> = HashMap::new();
        // Runs share their grains: each set is named once.
        let mut names: HashMap<*const GrainSet, String> = HashMap::new();
        for PlannedRun { name, scenario, grains, prepared, .. } in runs {
            let laboratory = |of: &Scenario| {
                let built = Setup::new(of).map(Arc::new);
                built.map_err(|error| StudyError::apparatus(name, &error))
            };
            let grains_hash: &str =
                names.entry(Arc::as_ptr(grains)).or_insert_with(|| grains_hash(grains));
            let own = laboratory(scenario)?;
            let other = prepared.as_ref().map(|Prepared { stages, engine }| {
                let scenario = Scenario { engine: engine.clone(), ..scenario.clone() };
                Ok::<_, StudyError>((*stages, laboratory(&scenario)?))
            });
            let other = other.transpose()?;
            let by = |index: usize| match &other {
                Some((stages, laboratory)) if index < *stages => laboratory,
                _ => &own,
            };
            let begin = scenario.begin.as_ref();
            let begun = begin.map(|spec| Begun::read(spec, grains, grains_hash, by(0)));
            let begun = begun.transpose()?;
            begun.iter().try_for_each(|begun| begun.refuse_other_name(scenario))?;
            let has_rest_test = scenario.rest_test_s > 0.0;
            let rest = StageSpec::Rest { duration_s: scenario.rest_test_s };
            let rest_test = has_rest_test.then_some(&rest);
            let mut nodes: Vec<usize> = Vec::new();
            for (index, stage) in scenario.stages.iter().chain(rest_test).enumerate() {
                let setup = &in_stage(by(index), stage);
                let parent = nodes.last().copied();
                let begun = begun.as_ref().filter(|_| parent.is_none());
                let before = parent.map(|parent| plan.nodes[parent].key());
                let before = before.or(begun.map(|begun| begun.key.as_str()));
                let segment_steps = segments(setup, grains.grains.len(), stage);
                let of_grains = (&**grains, grains_hash);
                let identity = identity(scenario, setup, of_grains, before, stage, segment_steps);
                let next = plan.nodes.len();
                let node = *known.entry(identity.key.clone()).or_insert(next);
                nodes.push(node);
                // Stages that runs have in common are planned once.
                if node < next {
                    continue;
                }
                let before = &scenario.stages[..index];
                let expected = expected_time(stage, before, setup, grains);
                plan.nodes.push(Node {
                    identity,
                    parent,
                    begun: begun.cloned(),
                    stage: stage.clone(),
                    setup: setup.clone(),
                    grains: grains.clone(),
                    has_segments: segment_steps.is_some(),
                    label: format!(
                        "realisation {}, {}",
                        scenario.configuration,
                        stage_label(stage, index == scenario.stages.len())
                    ),
                    expected,
                    remaining: expected,
                });
            }
            let rest_test = if has_rest_test { nodes.pop() } else { None };
            plan.runs.push(RunNodes { stages: nodes, rest_test, begun });
        }
        for index in (0..plan.nodes.len()).rev() {
            let remaining = plan.nodes[index].remaining;
            if let Some(parent) = plan.nodes[index].parent {
                let node = &mut plan.nodes[parent];
                node.remaining = node.remaining.max(node.expected + remaining);
            }
        }
        Ok(plan)
    }

    /// The same, each stage called after the first run that needs it.
    pub fn named(runs: &[PlannedRun]) -> Result<Self, StudyError> {
        let mut plan = Self::new(runs)?;
        for (run, nodes) in runs.iter().zip(&plan.runs).rev() {
            for (index, &node) in nodes.stages.iter().chain(&nodes.rest_test).enumerate() {
                let node = &mut plan.nodes[node];
                let label = stage_label(&node.stage, index == nodes.stages.len());
                node.label = format!("{}, {label}", run.name);
            }
        }
        Ok(plan)
    }

    /// Simulated time that its stages are expected to take together, in s.
    pub fn expected(&self) -> f64 {
        self.nodes.iter().map(|node| node.expected).sum()
    }

    /// The same of the stages that need a node, without it.
    pub fn expected_after(&self, node: usize) -> f64 {
        let mut need_it = vec![false; self.nodes.len()];
        need_it[node] = true;
        let mut expected = 0.0;
        for (n, stage) in self.nodes.iter().enumerate() {
            if stage.parent.is_some_and(|parent| need_it[parent]) {
                need_it[n] = true;
                expected += stage.expected;
            }
        }
        expected
    }

    /// The plan of one of its runs alone, and which of the nodes its nodes are.
    pub fn alone(&self, run: usize) -> (Self, Vec<usize>) {
        let RunNodes { stages, rest_test, begun } = &self.runs[run];
        let kept: Vec<usize> = stages.iter().chain(rest_test).copied().collect();
        let nodes = self.part(&kept);
        let runs = vec![RunNodes {
            stages: (0..stages.len()).collect(),
            rest_test: rest_test.map(|_| stages.len()),
            begun: begun.clone(),
        }];
        (Self { nodes, runs }, kept)
    }

    /// Some of its nodes, as nodes of a plan that has no others.
    pub fn part(&self, kept: &[usize]) -> Vec<Node> {
        let place = |node: usize| kept.iter().position(|&k| k == node);
        let node = |&n: &usize| {
            let node = self.nodes[n].clone();
            Node { parent: node.parent.and_then(place), ..node }
        };
        kept.iter().map(node).collect()
    }
}

/// The laboratory of a stage, which may have settings of its own.
fn in_stage(setup: &Arc<Setup>, stage: &StageSpec) -> Arc<Setup> {
    let own_speed = match stage {
        StageSpec::Deposit(deposit) => deposit.max_depenetration_velocity_m_per_s,
        _ => None,
    };
    let Some(speed) = own_speed else { return setup.clone() };
    let mut own = (**setup).clone();
    own.engine.native.max_depenetration_velocity_m_per_s = speed;
    Arc::new(own)
}

/// A stage in words: `pour from 50 mm`.
pub fn stage_label(stage: &StageSpec, is_rest_test: bool) -> String {
    match stage {
        StageSpec::FillFunnel { .. } => "fill the funnel".into(),
        StageSpec::SlowPluviation(stage) => {
            let rate = four_digits(stage.feed_rate_grains_per_s);
            format!("slow pluviation of {rate} grains a second")
        }
        StageSpec::Pour { falling_height_mm, .. } => {
            format!("pour from {} mm", four_digits(*falling_height_mm))
        }
        StageSpec::PlaceTopPlate(stage) => match stage.placement {
            0 => "place the top plate".into(),
            placement => format!("place the top plate, placement {placement}"),
        },
        StageSpec::Vibrate(vibrate) => {
            let duration = stage.motion().map_or(0.0, |motion| motion.duration);
            format!("vibrate {} × {} s", vibrate.periods, (duration * 100.0).round() / 100.0)
        }
        StageSpec::Deposit { .. } => "deposit grains".into(),
        StageSpec::Move(stage) if stage.pieces.is_empty() => "move everything".into(),
        StageSpec::Move(stage) => format!("move {}", stage.pieces.join(", ")),
        StageSpec::Press(stage) => {
            let names: Vec<&str> = stage.loads.iter().map(|load| load.piece.as_str()).collect();
            format!("press {}", names.join(", "))
        }
        StageSpec::Release(stage) => format!("release {}", stage.pieces.join(", ")),
        StageSpec::Remove(stage) => format!("remove {}", stage.pieces.join(", ")),
        StageSpec::Rest { duration_s } if is_rest_test => format!("rest test, {duration_s} s"),
        StageSpec::Rest { duration_s } => format!("rest, {duration_s} s"),
    }
}

/// How long grains take to settle once the last has been fed, in times that everything must be at rest
/// to count as settled: about 1 s for the paper's gravel.
const SETTLES_WITHIN: f64 = 4.0;

/// Simulated time a stage is expected to take, in s. What is fed at a rate takes its time; other stages
/// that end when the grains have settled usually take half of their limit. `before` are the stages of
/// the run before it.
fn expected_time(stage: &StageSpec, before: &[StageSpec], setup: &Setup, grains: &GrainSet) -> f64 {
    let fed_s = match stage {
        StageSpec::SlowPluviation(pile) => {
            Some(grains.grains.len() as f64 / pile.feed_rate_grains_per_s)
        }
        StageSpec::Deposit(deposit) if deposit.how == DepositKind::Rain => {
            deposit.rate_g_per_s.map(|rate| deposited_g(deposit, before, grains) / rate)
        }
        _ => None,
    };
    if let Some(fed_s) = fed_s {
        return (fed_s + SETTLES_WITHIN * setup.settle.hold).min(stage.longest());
    }
    match *stage {
        StageSpec::Rest { duration_s } => duration_s,
        StageSpec::Vibrate { .. } | StageSpec::Move { .. } => {
            stage.longest() - stage.settle_limit() / 2.0
        }
        _ => stage.longest() / 2.0,
    }
}

/// Mass in g that a deposit lets go: what it asks for, at most what earlier ones of its sizes left.
fn deposited_g(deposit: &DepositSpec, before: &[StageSpec], grains: &GrainSet) -> f64 {
    let sizes = deposit.sizes_mm.map(|sizes| sizes.map(from_mm));
    let chosen = (0..grains.grains.len()).filter(|grain| grains.is_between(*grain, sizes));
    let all = to_g(chosen.map(|grain| grains.grains[grain].mass).sum());
    let earlier = before.iter().filter_map(|stage| match stage {
        StageSpec::Deposit(earlier) if earlier.sizes_mm == deposit.sizes_mm => {
            Some(earlier.mass_g.unwrap_or(all))
        }
        _ => None,
    });
    let left = (all - earlier.sum::<f64>()).max(0.0);
    deposit.mass_g.map_or(left, |mass| mass.min(left))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::study::tests::planned;

    /// Law: what is fed at a rate takes its mass, or its number, over that rate, and 1 s to settle; at
    /// most its limit. A lattice takes half of it.
    #[test]
    fn what_is_fed_is_expected_to_take_its_time() {
        let scenario: Scenario = serde_json::from_value(json!({
            "name": "s",
            "grains": { "total_mass_g": 40, "density_kg_per_m3": 2673.9, "sieve_table":
                [{ "passing_mm": 12.5, "retained_mm": 10, "mass_percent": 100 }] },
            "stages": [{ "stage": "fill_funnel" }]
        }))
        .expect("a scenario");
        let setup = Setup::new(&scenario).expect("a laboratory");
        assert_eq!(setup.settle.hold, 0.25, "the check has the paper's gravel");
        let grains = planned(scenario).grains;
        let (count, rate) = (grains.grains.len() as f64, 1000.0_f64.sqrt());
        let stage =
            |fields: Value| -> StageSpec { serde_json::from_value(fields).expect("a stage") };
        let pile = |limit: f64| {
            stage(json!({ "stage": "slow_pluviation", "feed_rate_grains_per_s": rate,
                "base_diameter_mm": 100, "time_limit_s": limit }))
        };
        let deposit = |how: &str, rate: Option<f64>, mass_g: Option<f64>| {
            stage(json!({ "stage": "deposit", "how": how, "at_mm": [0, 0, 90],
                "area_mm": [40, 40], "rate_g_per_s": rate, "mass_g": mass_g }))
        };
        let layer = deposit("rain", Some(10.0), Some(15.0));
        for (stage, before, expected) in [
            (pile(120.0), &[][..], count / rate + 1.0),
            (pile(1.1), &[], 1.1),
            (layer.clone(), &[], 2.5),
            (deposit("rain", Some(10.0), None), &[], 5.0),
            (deposit("rain", Some(10.0), None), std::slice::from_ref(&layer), 3.5),
            (deposit("rain", Some(1.0), None), &[], 10.0),
            (deposit("lattice", None, None), &[], 5.0),
        ] {
            let got = expected_time(&stage, before, &setup, &grains);
            let off = (got - expected).abs();
            assert!(off < 1e-6, "law: {stage:?} takes {expected} s, got {got} s");
        }
        assert_eq!(stage_label(&pile(1.0), false), "slow pluviation of 31.62 grains a second");
    }

    /// Law: a stage `rest` is not taken for the rest test.
    #[test]
    fn a_rest_is_no_rest_test() {
        let scenario: Scenario = serde_json::from_value(json!({
            "name": "s",
            "grains": { "total_mass_g": 15, "density_kg_per_m3": 2673.9, "sieve_table":
                [{ "passing_mm": 12.5, "retained_mm": 10, "mass_percent": 100 }] },
            "stages": [{ "stage": "fill_funnel" }, { "stage": "rest", "duration_s": 0.3 }],
            "rest_test_s": 0.5
        }))
        .expect("a scenario");
        let run = planned(scenario);
        let ends = ["fill the funnel", ", rest, 0.3 s", ", rest test, 0.5 s"];
        for plan in [Plan::new(std::slice::from_ref(&run)), Plan::named(&[run])] {
            let plan = plan.expect("a plan");
            let labels: Vec<&str> = plan.nodes.iter().map(|node| node.label.as_str()).collect();
            let named = labels.iter().zip(ends).all(|(label, end)| label.ends_with(end));
            assert!(named && labels.len() == ends.len(), "law: {ends:?}, got {labels:?}");
        }
    }
}
