//! Everything a stage needs to know about the laboratory, in SI units.

use super::*;
use crate::apparatus;
use crate::scale::Scale;
use crate::scenario::{ContactSpec, FunnelSpec, MeasuresSpec, SAMPLE_INTERVAL, Scenario};
use crate::world::PairCoefficients;

/// The laboratory as the stages see it.
#[derive(Debug, Clone, PartialEq)]
pub struct Setup {
    /// Gravitational acceleration in m/s².
    pub gravity: f64,
    /// What our lengths, speeds and times follow from.
    pub scale: Scale,
    /// Engine settings.
    pub engine: EngineSettings,
    /// Friction and restitution of each pair of materials.
    pub pairs: PairTable,
    /// The container.
    pub cylinder: Cylinder,
    /// The funnel's dimensions; it is built where a stage puts it.
    pub funnel: FunnelSpec,
    /// The top plate.
    pub plate: TopPlate,
    /// The pieces that stand in place of these; none where these do.
    pub pieces: Vec<RigidPiece>,
    /// What each of the pieces is made of.
    pub piece_materials: Vec<Material>,
    /// What is measured of them beside their forces.
    pub measures: MeasuresSpec,
    /// When a specimen counts as settled.
    pub settle: SettleCriterion,
    /// Seed of the random streams.
    pub seed: u64,
    /// Which realisation, counted from 1.
    pub configuration: u32,
    /// Interval in s between looks beside the checks: stages settle, grains leave and are let go, and
    /// loads are averaged by them, whatever is recorded.
    pub look_interval: f64,
    /// Interval between observations in s; where it is none, each look is one.
    pub sample_interval: Option<f64>,
}

/// When a specimen counts as settled, in SI units.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SettleCriterion {
    /// Largest root mean square speed in m/s.
    pub rms_speed: f64,
    /// Largest speed of any body in m/s.
    pub largest_speed: f64,
    /// How long both must hold, in s.
    pub hold: f64,
}

impl Setup {
    /// The laboratory of a scenario.
    ///
    /// # Errors
    /// When a dimension makes a piece of the apparatus impossible.
    pub fn new(scenario: &Scenario) -> Result<Self, ApparatusError> {
        let settle = &scenario.settle;
        let mut pairs = pair_table(&scenario.contact);
        let restitution = scenario.contact.restitution;
        let materials = scenario.pieces.iter().map(|piece| {
            let own = piece.friction.map(|friction| PairCoefficients { friction, restitution });
            own.and_then(|own| pairs.add_piece(own)).unwrap_or(Material::Wall)
        });
        let piece_materials = materials.collect();
        let mut pieces: Vec<RigidPiece> =
            scenario.pieces.iter().map(RigidPiece::new).collect::<Result<_, _>>()?;
        apparatus::overlapping(&pieces)?;
        // What is let go lies among the grains, whatever its shape.
        for stage in &scenario.stages {
            let StageSpec::Release(release) = stage else { continue };
            let named = |piece: &&mut RigidPiece| release.pieces.contains(&piece.name);
            pieces.iter_mut().filter(named).for_each(|piece| piece.is_wall = false);
        }
        Ok(Self {
            gravity: scenario.gravity_m_per_s2,
            scale: scenario.scale(),
            engine: scenario.engine.clone(),
            pairs,
            cylinder: Cylinder::new(&scenario.apparatus.cylinder)?,
            funnel: scenario.apparatus.funnel.clone(),
            plate: TopPlate::new(&scenario.apparatus.top_plate)?,
            pieces,
            piece_materials,
            measures: scenario.measures.clone(),
            settle: SettleCriterion {
                rms_speed: from_mm(settle.rms_speed_mm_per_s),
                largest_speed: from_mm(settle.largest_speed_mm_per_s),
                hold: settle.hold_s,
            },
            seed: scenario.seed,
            configuration: scenario.configuration,
            look_interval: SAMPLE_INTERVAL,
            sample_interval: scenario.sample_interval_s.filter(|s| *s != SAMPLE_INTERVAL),
        })
    }

    /// Interval in s at which a stage is observed.
    pub fn observed_every(&self) -> f64 {
        self.sample_interval.unwrap_or(self.look_interval)
    }

    /// Whether an observation is due at a step of a length in s; at a look it is, unless the
    /// observations have an interval of their own.
    pub(super) fn is_sampled(&self, step: u64, dt: f64, at_look: bool) -> bool {
        let Some(every) = self.sample_interval else { return at_look };
        let samples = |step: u64| ((step as f64 + 0.5) * dt / every).floor();
        step > 0 && samples(step) > samples(step - 1)
    }

    /// Number of a piece by its name.
    pub(super) fn number(&self, name: &str) -> Option<usize> {
        self.pieces.iter().position(|piece| piece.name == name)
    }

    /// Numbers of pieces by their names; none where one is not known.
    pub(super) fn numbers(&self, names: &[String]) -> Option<Vec<usize>> {
        names.iter().map(|name| self.number(name)).collect()
    }
}

fn pair_table(contact: &ContactSpec) -> PairTable {
    use Material::{Grain, Plate, Wall};
    let with = |friction| PairCoefficients { friction, restitution: contact.restitution };
    let mut table = PairTable::uniform(with(contact.grain_wall_friction));
    table.set(Grain, Grain, with(contact.grain_grain_friction));
    table.set(Grain, Plate, with(contact.grain_plate_friction));
    table.set(Plate, Wall, with(contact.plate_wall_friction));
    table.set(Plate, Plate, with(contact.plate_wall_friction));
    table
}
