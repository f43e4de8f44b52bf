//! The specimens: poured ones of 364 and 1456 grains, and larger ones made of copies.

use std::{fs::File, io::BufWriter, path::Path, sync::Arc};

use nalgebra::{Translation3, UnitQuaternion};
use pluvia::{
    geometry::{Pose, Vector},
    grains::{Grain, GrainSet, generate, load_scenario},
    protocol::Setup,
    scenario::{Scenario, StageSpec},
    specimen::{Fate, GrainState, Specimen, SpecimenState},
    world::BodyState,
};
use serde::{Deserialize, Serialize};

use super::common::{QUARTER, WHOLE, filled, lifted, scenario, settled, sieved, stage};

/// Grains asked for. The first two are poured.
pub const SIZES: [usize; 4] = [364, 1456, 10_000, 100_000];

/// Gap in m between copies, and between them and the wall, before they settle.
const GAP: f64 = 1e-3;

/// Simulated time in s in which copies settle.
const SETTLING: f64 = 0.75;

/// How much higher than its scenario's the cylinder of copies is: they take more room than a
/// poured specimen until they have settled.
const HIGHER: f64 = 1.5;

/// A specimen as one process hands it to another.
#[derive(Serialize, Deserialize)]
pub struct Stored {
    /// Which of [`SIZES`].
    pub size: usize,
    /// Which grain of the poured specimen each is a copy of.
    prototypes: Vec<usize>,
    state: SpecimenState,
}

impl Stored {
    /// Of a specimen whose grains were generated.
    fn poured(size: usize, specimen: Specimen) -> Self {
        Self {
            size,
            prototypes: (0..specimen.grains.grains.len()).collect(),
            state: specimen.state,
        }
    }

    pub fn write(&self, path: &Path) {
        let file = File::create(path).expect("a file for a specimen");
        serde_json::to_writer(BufWriter::new(file), self).expect("a specimen");
    }

    pub fn read(path: &Path) -> Self {
        serde_json::from_slice(&std::fs::read(path).expect("a specimen")).expect("a specimen")
    }

    pub fn specimen(self) -> Specimen {
        let base = generate(sieved(&scenario(source(self.size))), 1).expect("grains");
        Specimen { grains: Arc::new(copied(&base, &self.prototypes)), state: self.state }
    }

    /// Root mean square speed of the grains in mm/s.
    pub fn rms_speed(&self) -> f64 {
        let present = || self.state.bodies.iter().filter(|g| g.fate == Fate::Present);
        let sum: f64 = present().map(|g| g.body.linear_velocity.norm_squared()).sum();
        1e3 * (sum / present().count() as f64).sqrt()
    }
}

/// The grains' mass and their cylinder: what a specimen is poured or copied from.
fn source(size: usize) -> (f64, f64) {
    if size == SIZES[0] { QUARTER } else { WHOLE }
}

/// The scenario of a size, whose container is stretched with the number of grains.
fn scenario_of(size: usize) -> Scenario {
    if size <= SIZES[1] {
        return scenario(source(size));
    }
    let path = format!("scenarios/load/{size}-grains.json");
    let mut scenario = load_scenario(Path::new(&path), &[]).expect("a scenario").scenario;
    scenario.apparatus.cylinder.height_mm *= HIGHER;
    scenario
}

/// The laboratory of a size.
pub fn setup(size: usize) -> Setup {
    Setup::new(&scenario_of(size)).expect("a laboratory")
}

/// A filled funnel as the stage `pour` begins, and the grains poured from it and settled.
pub fn poured(size: usize) -> (Stored, Stored) {
    let setup = setup(size);
    let full = filled(&scenario_of(size), &setup);
    let specimen = settled(&setup, full.clone());
    (Stored::poured(size, lifted(&setup, full)), Stored::poured(size, specimen))
}

/// A specimen of copies of `of`: a square is cut from its middle, copies of it stand in rows
/// and layers, each turned by another quarter, and settle together. To pour as many would
/// take an hour or more.
pub fn copies(of: &Specimen, radius: f64, size: usize) -> Stored {
    let setup = setup(size);
    let block = Block::cut(of, radius);
    let room = setup.cylinder.radius - GAP;
    let rows = (room / block.pitch).ceil() as i32;
    let mut placed: Vec<(usize, Pose)> = Vec::new();
    let mut layer = 0;
    while placed.len() < size + block.grains.len() {
        let before = placed.len();
        for (i, j) in (-rows..=rows).flat_map(|i| (-rows..=rows).map(move |j| (i, j))) {
            let to = Vector::new(f64::from(i), f64::from(j), 0.0) * block.pitch
                + Vector::new(0.0, 0.0, GAP + f64::from(layer) * block.height);
            let quarter = f64::from((i + 2 * j + 3 * layer).rem_euclid(4));
            let turn = quarter * std::f64::consts::FRAC_PI_2;
            let frame = Pose::from_parts(
                Translation3::from(to),
                UnitQuaternion::from_axis_angle(&Vector::z_axis(), turn),
            );
            placed.extend(block.grains.iter().filter_map(|(n, pose)| {
                let pose = frame * pose;
                let inside = |v: &Vector| (pose * nalgebra::Point3::from(*v)).xy().coords.norm();
                let shape = &of.grains.grains[*n].shape;
                shape.vertices().iter().all(|v| inside(&v.coords) < room).then_some((*n, pose))
            }));
        }
        assert!(placed.len() > before, "a layer holds grains");
        layer += 1;
    }
    // The lowest ones: the surface is level.
    placed.sort_by(|a, b| a.1.translation.z.total_cmp(&b.1.translation.z));
    placed.truncate(size);
    let prototypes: Vec<usize> = placed.iter().map(|(n, _)| *n).collect();
    let mut state = SpecimenState::before_everything(size);
    state.cylinder = true;
    for (grain, (_, pose)) in state.bodies.iter_mut().zip(&placed) {
        *grain = GrainState { body: BodyState::at_rest(*pose), fate: Fate::Present };
    }
    let grains = Arc::new(copied(&of.grains, &prototypes));
    let rest = StageSpec::Rest { duration_s: SETTLING };
    let state = stage(&setup, Specimen { grains, state }, &rest).specimen.state;
    Stored { size, prototypes, state }
}

fn copied(base: &GrainSet, prototypes: &[usize]) -> GrainSet {
    let grains: Vec<Grain> = prototypes.iter().map(|&n| base.grains[n].clone()).collect();
    GrainSet { grains, blocks: Vec::new(), density: base.density, meshes: Vec::new() }
}

/// Grains around the axis of a specimen, and the room that they take.
struct Block {
    grains: Vec<(usize, Pose)>,
    /// From one block to the next beside it, in m.
    pitch: f64,
    /// From one layer to the next, in m.
    height: f64,
}

impl Block {
    fn cut(of: &Specimen, radius: f64) -> Self {
        let half = radius / std::f64::consts::SQRT_2;
        let mut grains = Vec::new();
        let (mut widest, mut low, mut high) = (0.0_f64, f64::INFINITY, f64::NEG_INFINITY);
        for n in of.present() {
            let pose = of.state.bodies[n].body.pose;
            if pose.translation.x.abs() > half || pose.translation.y.abs() > half {
                continue;
            }
            for v in of.grains.grains[n].shape.vertices() {
                let at = pose * v;
                widest = widest.max(at.x.abs()).max(at.y.abs());
                (low, high) = (low.min(at.z), high.max(at.z));
            }
            grains.push((n, pose));
        }
        for (_, pose) in &mut grains {
            pose.translation.z -= low;
        }
        Self { grains, pitch: 2.0 * widest + GAP, height: high - low + GAP }
    }
}
