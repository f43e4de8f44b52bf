//! Segments: a long stage in pieces of fixed simulated length, so that one that is
//! interrupted goes on from the end of a piece.
//!
//! At the end of a segment the specimen is read back with its contacts, and the
//! next segment builds its world from it, whether the stage was interrupted there
//! or not. So it makes no difference to the bits whether it was.

use super::*;

/// What a segment should take one core, in s: so much work is lost at most when a
/// run is killed, and it is long enough that storing costs nothing beside it.
const SEGMENT_WALL: f64 = 60.0;

/// What a grain takes one core in a step, in s, on the native contact solver
/// at its default settings (docs/contacts.md), to the order of magnitude. A
/// faster machine has shorter segments; the bits must not depend on it.
const GRAIN_STEP: f64 = 12e-6;

/// Where a stage is between two of its segments: all that it needs to go on, beside its grains.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct Midway {
    /// The specimen.
    pub state: SpecimenState,
    /// Time in s since the first stage began at which this stage did.
    pub began_s: f64,
    /// Engine steps taken in this stage.
    pub steps: u64,
    /// Height of the funnel's collar in m.
    pub collar_m: f64,
    /// Time since the stage began at which the next look is due, in s.
    #[serde(rename = "next_sample_s")]
    pub next_look_s: f64,
    /// Time since the stage began from which on everything was slow enough to
    /// count as settled, in s; none where something is not.
    pub calm_since_s: Option<f64>,
    /// Wall time inside the engine so far, in s.
    pub engine_s: f64,
    /// Findings so far.
    pub warnings: Vec<String>,
    /// What was watched so far; not in a checkpoint of before this was.
    #[serde(default)]
    pub watch: Watch,
    /// Solver residuals, one a look (see `World::solver_residual`).
    #[serde(default)]
    pub residuals: Vec<f64>,
    /// The grains still in the spout of slow pluviation.
    pub fed: Option<Fed>,
    /// Which part of a stage of several it is in, from 0.
    #[serde(default)]
    pub part: u32,
    /// Steps that had been taken when that part began.
    #[serde(default)]
    pub part_began: u64,
    /// Where the pieces of a laboratory were when the stage began.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub pieces_began: Vec<PieceState>,
    /// What was seen of the condition that ends the stage.
    #[serde(default, skip_serializing_if = "Judged::is_empty")]
    pub judged: Judged,
    /// The mean stress that the stage keeps.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub kept_stress: Option<KeptStress>,
}

impl Midway {
    /// Whether a stage of a number of grains can go on from here: what was read from a
    /// file may be of other grains, or hold numbers that no stage comes to.
    ///
    /// # Errors
    /// What does not fit, for a reader.
    pub fn check(&self, grains: usize) -> Result<(), String> {
        self.state.check(grains)?;
        if Duration::try_from_secs_f64(self.engine_s).is_err() {
            return Err(format!("`engine_s` is {:e}", self.engine_s));
        }
        // Far beyond what the longest stage takes, and far from where counting ends.
        if self.steps > u64::from(u32::MAX) {
            return Err(format!("`steps` is {}", self.steps));
        }
        if self.pieces_began.len() != self.state.pieces.len() {
            return Err("`pieces_began` is of other pieces than `state`".to_owned());
        }
        if self.part_began > self.steps {
            return Err(format!("`part_began` is {}, after `steps`", self.part_began));
        }
        self.judged.check()?;
        self.kept_stress.iter().try_for_each(KeptStress::check)?;
        self.fed.as_ref().map_or(Ok(()), |fed| fed.check(grains))
    }

    pub(super) fn at_start(state: SpecimenState, collar_m: f64, setup: &Setup) -> Self {
        Self {
            began_s: state.time,
            pieces_began: state.pieces.clone(),
            state,
            collar_m,
            next_look_s: setup.look_interval,
            ..Self::default()
        }
    }

    pub(super) fn next_part(&mut self) {
        self.part += 1;
        self.part_began = self.steps;
        self.calm_since_s = None;
        self.watch.begin_anew();
    }
}

/// Steps of a length in s between two checks, at which checks look and grains are
/// counted; segments end there.
pub(super) fn steps_a_check(setup: &Setup, step: f64) -> u64 {
    (scale::CHECK_INTERVAL.at(&setup.scale) / step).round().max(1.0) as u64
}

/// Engine steps of a segment, by the engine's settings and the number of grains alone; none where
/// the engine cannot be told of contacts, so that a packing would feel the seam.
pub(super) fn segment_steps(setup: &Setup, grains: usize) -> Option<u64> {
    let engine = &setup.engine;
    if !engine.is_native() {
        return None;
    }
    let check = steps_a_check(setup, 1.0 / engine.rate_hz);
    let steps = match engine.native.checkpoint_every_s {
        Some(time) => time * engine.rate_hz,
        None => SEGMENT_WALL / (GRAIN_STEP * grains.max(1) as f64),
    };
    Some(((steps / check as f64).round() as u64).max(1).saturating_mul(check))
}

/// Engine steps of the segments of a stage; none where it is over within one at the latest.
pub fn segments(setup: &Setup, grains: usize, stage: &StageSpec) -> Option<u64> {
    segment_steps(setup, grains)
        .filter(|segment| stage.longest() * setup.engine.rate_hz > *segment as f64)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::protocol::testing::*;
    use crate::scenario::{Backend, ContactSolver, Scenario};

    fn setup(change: impl Fn(&mut Scenario)) -> Setup {
        let mut scenario = scenario_of(json!({
            "grains": { "total_mass_g": 60, "density_kg_per_m3": 2673.9,
                "sieve_table": [{ "passing_mm": 10, "retained_mm": 8, "mass_percent": 100 }] }
        }));
        change(&mut scenario);
        Setup::new(&scenario).expect("a laboratory")
    }

    #[test]
    fn a_checkpoint_that_no_stage_comes_to_is_refused() {
        let sound = Midway::at_start(SpecimenState::before_everything(2), 0.0, &setup(|_| ()));
        assert_eq!(sound.check(2), Ok(()));
        assert!(sound.check(3).is_err_and(|why| why.contains("`bodies` has 2")), "law: its grains");
        for engine_s in [-1.0, f64::NAN, f64::INFINITY, 1e300] {
            let got = Midway { engine_s, ..sound.clone() }.check(2);
            assert!(got.is_err_and(|why| why.contains("engine_s")), "law: a time, got {engine_s}");
        }
        let got = Midway { steps: u64::MAX, ..sound.clone() }.check(2);
        assert!(got.is_err_and(|why| why.contains("steps")), "law: steps can be counted on");
        let rng = serde_json::to_string(&crate::grains::streams::stream(1, "any")).expect("JSON");
        let fed = format!("\"fed\":{{\"count\":3,\"falling\":[],\"rng\":{rng}}}");
        let stored = serde_json::to_string(&sound).expect("JSON").replace("\"fed\":null", &fed);
        let fed: Midway = serde_json::from_str(&stored).expect("a checkpoint");
        assert!(fed.check(2).is_err_and(|why| why.contains("fed.count")), "law: no more than all");
    }

    #[test]
    fn a_segment_is_about_a_minute_and_ends_at_a_check() {
        for (rate, grains) in [(480.0, 364), (480.0, 2000), (960.0, 50), (77.7, 100_000)] {
            let setup = setup(|s| s.engine.rate_hz = rate);
            let steps = segment_steps(&setup, grains).expect("segments");
            let check = steps_a_check(&setup, 1.0 / rate);
            let wall = steps as f64 * grains as f64 * GRAIN_STEP;
            let one = check as f64 * grains as f64 * GRAIN_STEP;
            assert_eq!(steps % check, 0, "law: segments end at a check");
            assert!(
                (wall - SEGMENT_WALL).abs() <= one,
                "law: a segment takes {SEGMENT_WALL} s to the nearest check, of {one:.2} s; got {wall:.2} s"
            );
        }
    }

    #[test]
    fn engines_that_forget_contacts_have_no_segments() {
        let forgetful: [fn(&mut Scenario); 2] = [
            |s| s.engine.contact_solver = ContactSolver::Stock,
            |s| s.engine.backend = Backend::Rapier,
        ];
        for change in forgetful {
            assert_eq!(segment_steps(&setup(change), 1000), None);
        }
    }

    #[test]
    fn only_stages_longer_than_a_segment_have_segments() {
        let setup = setup(|s| s.engine.native.checkpoint_every_s = Some(0.5));
        for (duration_s, expected) in [(0.1, None), (0.5, None), (0.51, Some(240))] {
            let stage = StageSpec::Rest { duration_s };
            assert_eq!(segments(&setup, 1, &stage), expected, "a rest of {duration_s} s");
        }
    }
}
