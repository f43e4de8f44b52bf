//! Stages in checkpoint segments on a real world, and on one that is watched.

#[macro_use]
#[path = "../world/testing/handed_on.rs"]
mod handed_on;

use std::sync::{Arc, Mutex, atomic::AtomicBool};

use super::testing::*;
use super::*;
use crate::geometry::{ConvexPolyhedron, MassProperties};
use crate::scale::Scale;
use crate::scenario::{BaseKind, BaseSpec, Scenario, SlowPluviationSpec};
use crate::world::{
    self, Contact, PairCoefficients, PhaseTimes, RememberedContact, World, scripted::ScriptedWorld,
};

fn scenario(checkpoint_every_s: Option<f64>) -> Scenario {
    let grains = json!({ "total_mass_g": 60, "density_kg_per_m3": 2673.9 });
    let mut scenario = scenario_of(json!({ "grains": grains }));
    scenario.engine.native.checkpoint_every_s = checkpoint_every_s;
    scenario
}

fn before_everything() -> Specimen {
    specimen_of(&scenario(None), 1)
}

/// One flat block on the floor of the cylinder.
fn block() -> Specimen {
    let shape = ConvexPolyhedron::cuboid(Vector::new(0.03, 0.03, 0.01)).expect("a block");
    let properties = MassProperties::of(&shape);
    let grain = Grain {
        volume: properties.volume,
        mass: 2673.9 * properties.volume,
        inertia: properties.inertia_per_density.diagonal() * 2673.9,
        shape: Arc::new(shape),
        ..before_everything().grains.grains[0].clone()
    };
    let set = GrainSet { grains: vec![grain], ..(*before_everything().grains).clone() };
    let mut state = SpecimenState::before_everything(1);
    state.cylinder = true;
    state.bodies[0].body.pose = Pose::translation(0.0, 0.0, 0.005);
    Specimen { grains: Arc::new(set), state }
}

/// What one world was told and did.
#[derive(Debug, Default, Clone)]
struct Log {
    moved: Vec<(BodyId, Pose)>,
    recalled_drives: Vec<(BodyId, [Pose; 3])>,
    recalled: Vec<RememberedContact>,
    /// When it was asked last.
    remembered: Vec<RememberedContact>,
    /// Velocities of all bodies along x after each step.
    velocities: Vec<Vec<f64>>,
}

type Logs = Mutex<Vec<Arc<Mutex<Log>>>>;

/// A world that records its calls.
struct Spy {
    inner: Box<dyn World + Send>,
    log: Arc<Mutex<Log>>,
}

impl Spy {
    fn watch(inner: Box<dyn World + Send>, logs: &Logs) -> Box<dyn World + Send> {
        let log = Arc::new(Mutex::new(Log::default()));
        logs.lock().expect("alone").push(Arc::clone(&log));
        Box::new(Self { inner, log })
    }

    fn log(&self) -> std::sync::MutexGuard<'_, Log> {
        self.log.lock().expect("alone")
    }
}

impl World for Spy {
    handed_on!(inner:
        fn add(&mut self, body: &Body) -> Result<BodyId, WorldError>;
        fn remove(&mut self, id: BodyId) -> Result<(), WorldError>;
        fn press(&mut self, id: BodyId, force: f64) -> Result<(), WorldError>;
        fn join(&mut self, part: BodyId, whole: BodyId) -> Result<(), WorldError>;
        fn read_body(&self, id: BodyId) -> Result<BodyState, WorldError>;
        fn time_step(&self) -> f64;
        fn read(&self, into: &mut Snapshot);
        fn contacts(&self, into: &mut Vec<Contact>);
        fn corners(&self, into: &mut Vec<Option<HeldShape>>);
        fn phases(&self) -> Option<PhaseTimes>;
        fn solver_residual(&self) -> Option<f64>;
        fn pair_coefficients(&self, a: BodyId, b: BodyId) -> Result<PairCoefficients, WorldError>;
        fn effective(&self) -> EffectiveSettings;
    );

    fn drive(&mut self, id: BodyId, pose: &Pose) -> Result<(), WorldError> {
        self.log().moved.push((id, *pose));
        self.inner.drive(id, pose)
    }

    fn recall_drive(&mut self, id: BodyId, ends: &[Pose; 3]) -> Result<(), WorldError> {
        self.log().recalled_drives.push((id, *ends));
        self.inner.recall_drive(id, ends)
    }

    fn step(&mut self) -> Result<(), WorldError> {
        self.inner.step()?;
        let mut states = Snapshot::new();
        self.inner.read(&mut states);
        let velocities = states.iter().flatten().map(|s| s.linear_velocity.x).collect();
        self.log().velocities.push(velocities);
        Ok(())
    }

    fn remember(&self, into: &mut Vec<RememberedContact>) {
        self.inner.remember(into);
        self.log().remembered.clone_from(into);
    }

    fn recall(&mut self, contacts: &[RememberedContact]) -> Result<(), WorldError> {
        self.log().recalled = contacts.to_vec();
        self.inner.recall(contacts)
    }
}

/// Makes an empty world.
type Maker = fn(&EngineSettings, Vector, &PairTable) -> Result<Box<dyn World + Send>, WorldError>;

/// Runs a stage, in segments of a simulated time in s where one is given;
/// gives its end and what each of its worlds was told and did.
fn carry_out(
    specimen: Specimen,
    stage: &StageSpec,
    checkpoint_every_s: Option<f64>,
    make: Maker,
) -> (StageOutcome, Vec<Log>) {
    let mut setup = Setup::new(&scenario(checkpoint_every_s)).expect("a laboratory");
    // With which a check comes every ten steps.
    setup.scale = Scale::PAPER;
    let logs = Logs::default();
    let make = |settings: &_, gravity, pairs: &_| {
        make(settings, gravity, pairs).map(|world| Spy::watch(world, &logs))
    };
    let never = AtomicBool::new(false);
    let outcome = run(&setup, &make, specimen, stage, None, &mut (), &never);
    let outcome = outcome.expect("it runs");
    let logs = logs.into_inner().expect("alone");
    (outcome, logs.iter().map(|log| log.lock().expect("alone").clone()).collect())
}

fn shaken(duration_s: f64) -> StageSpec {
    // Without the rest after it.
    StageSpec::sine(4.0, 3.0, duration_s, 0.0)
}

#[test]
fn a_segment_is_told_where_the_table_was_in_the_last_steps_of_the_one_before() {
    let still: Maker = |_, _, _| Ok(Box::new(ScriptedWorld::still(STEP)));
    let (_, logs) = carry_out(block(), &shaken(0.5), Some(0.1), still);
    assert_eq!(logs.len(), 5, "law: half a second in segments of a tenth");
    assert!(logs[0].recalled_drives.is_empty(), "law: at the beginning nothing was before");
    for pair in logs.windows(2) {
        let (before, after) = (&pair[0], &pair[1]);
        let on_table = after.recalled_drives.len();
        assert!(on_table > 1, "law: every piece on the table is recalled");
        for (id, ends) in &after.recalled_drives {
            let moved: Vec<Pose> =
                before.moved.iter().filter(|(other, _)| other == id).map(|(_, p)| *p).collect();
            let last: [Pose; 3] = moved[moved.len() - 3..].try_into().expect("three");
            assert_eq!(*ends, last, "law: the same poses to the bit");
        }
    }
}

/// The block is carried by friction: its velocity is that of the table at the
/// ends of the solver's sub-steps, which changes steadily through a step.
#[test]
fn a_shaken_block_goes_on_through_segments_as_without_them() {
    let _turn = world::shared_turn();
    let of = |every| {
        let (_, logs) = carry_out(block(), &shaken(0.5), every, world::create);
        let steps: Vec<f64> =
            logs.iter().flat_map(|l| &l.velocities).map(|v| *v.last().expect("a block")).collect();
        (logs.len(), steps)
    };
    let ((one, whole), (five, segments)) = (of(None), of(Some(0.1)));
    assert_eq!((one, five, whole.len(), segments.len()), (1, 5, 240, 240));
    let differences = whole.iter().zip(&segments).map(|(a, b)| (a - b).abs());
    let largest = differences.fold(0.0, f64::max);
    assert!(
        largest < 1e-5,
        "law: the same velocities after every step to 1e-5 m/s, got a difference of {largest} m/s"
    );
}

/// A pile has its grains in the order in which they were fed, its later segments in
/// that of the set.
#[test]
fn a_pile_takes_all_its_contacts_from_segment_to_segment() {
    let _turn = world::shared_turn();
    let stage = StageSpec::SlowPluviation(SlowPluviationSpec {
        feed_rate_grains_per_s: 20.0,
        drop_height_mm: 12.0,
        spout_diameter_mm: 30.0,
        base: BaseSpec { kind: BaseKind::Plane, friction: Some(0.5) },
        base_diameter_mm: 200.0,
        time_limit_s: 30.0,
    });
    let (whole, _) = carry_out(before_everything(), &stage, None, world::create);
    let (pile, logs) = carry_out(before_everything(), &stage, Some(0.5), world::create);
    assert!(logs.len() > 3, "the check has seams, {} worlds", logs.len());
    let mut swapped = 0;
    for (before, after) in logs.iter().zip(&logs[1..]) {
        assert_eq!(before.remembered.len(), after.recalled.len(), "law: every contact is recalled");
        let forces =
            |contacts: &[RememberedContact]| contacts.iter().map(|c| c.force.norm()).sum::<f64>();
        assert_eq!(forces(&before.remembered), forces(&after.recalled), "law: with its force");
        swapped += after.recalled.iter().filter(|c| c.a > c.b).count();
    }
    assert!(swapped > 3, "the check sees pairs told the other way round, {swapped}");
    let present = |o: &StageOutcome| o.specimen.present().count();
    assert_eq!(present(&whole), present(&pile), "law: as many grains as without segments");
}
